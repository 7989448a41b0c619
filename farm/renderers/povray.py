# SPDX-License-Identifier: Apache-2.0
"""POV-Ray's scenes."""

import os
import re
import shutil

import files
import png

GRID = 32  # POV-Ray's own blocks: tiles that end where these do have the pixels of the whole picture
_STRING = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
_COMMENT = re.compile(r'/\*.*?\*/|//[^\n]*|("(?:[^"\\\n]|\\.)*")', re.S)


_LIBRARY = re.compile(r"(?:\+L|Library_Path=)(.+)", re.I)


def _is_ini(word):
    return word.lower().endswith(".ini") and os.path.isfile(word)


def _libraries(words):
    return [os.path.abspath(found[1].strip('"')) for found in map(_LIBRARY.fullmatch, words) if found]


def _read(path):
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        return _COMMENT.sub(lambda found: found[1] or " ", file.read())


def inputs_of(scene, libraries):
    """The scene and all files whose names stand in it, or in what it includes; and its text. Names that are put together while
    it is read are not seen."""
    found, left, text = [], [os.path.abspath(scene)], []
    while left:
        path = left.pop()
        if path in found:
            continue
        found.append(path)
        if os.path.splitext(path)[1].lower() not in (".pov", ".inc", ".mac", ".map", ".ini", ".txt"):
            continue
        text.append(_read(path))
        for name in _STRING.findall(text[-1]):
            for folder in libraries:
                place = os.path.normpath(os.path.join(folder, name))
                if name and os.path.isfile(place):
                    left.append(place)
                    break
    return found, "\n".join(text)


def _size(words):
    """Of +W and +H, or 0: of an .ini file, too."""
    size = [0, 0]
    for word in words:
        for k, (letter, name) in enumerate((("W", "Width"), ("H", "Height"))):
            found = re.fullmatch(rf"(?:[+-]{letter}|{name}=)(\d+)", word, re.I)
            if found:
                size[k] = int(found[1])
    return size


def _ini_words(words):
    """Those of .ini files among them, one a line, before the rest."""
    lines = []
    for word in words:
        if _is_ini(word):
            with open(word, encoding="utf-8", errors="surrogateescape") as file:
                lines += [re.sub(r"\s*=\s*", "=", line.split(";")[0].strip()) for line in file]
    return lines


def examine(scene, options):
    if not os.path.isfile(scene):
        raise files.Refusal(f"{scene}: no such file")
    words = [*_ini_words(options.words), *options.words]
    libraries = _libraries(words)
    inputs, text = inputs_of(scene, [os.path.dirname(scene), *libraries])
    inputs += [os.path.abspath(word) for word in options.words if _is_ini(word)]
    size = _size(words)
    no_tiles = ""
    if not all(size):
        no_tiles = "tiles need the picture's size: give +W and +H behind --"
    elif re.search(r"\bradiosity\s*\{", text):
        no_tiles = "radiosity gathers light over what is rendered, so that tiles would not meet: take whole frames"
    elif any(re.fullmatch(r"\+F[^N].*|Output_File_Type=[^N].*", word, re.I) and not re.match(r"\+FN", word, re.I) for word in words):
        no_tiles = "tiles are joined as PNG (+FN) only"
    return {"frames": [None], "size": size, "samples": 0, "cloth": False, "inputs": inputs, "programs": ["povray"], "rate": 24, "grid": GRID,
            "clock": any(re.match(r"\+KFF|Final_Frame=", word, re.I) for word in words), "libraries": libraries,
            "words": [os.path.abspath(word) if _is_ini(word) else word for word in options.words if not _LIBRARY.fullmatch(word)],
            "no_tiles": no_tiles, "no_shares": "POV-Ray's samples have no numbers, so that there are no shares of them: take --tiles or --frames"}


def _link(path, work, name):
    """POV-Ray's command line takes Latin letters alone: what has others gets a name in the item's folder."""
    os.symlink(path, os.path.join(work, name))
    return name


def render(job, item, work, log):
    said, frame = job.said, item.get("frame")
    scene = job.path(said["scene"])
    words = [f"+L{_link(path, work, f'library{k}')}" for k, path in enumerate([os.path.dirname(scene), *said["libraries"]])]
    words += [_link(word, work, f"words{k}.ini") if _is_ini(word) else word for k, word in enumerate(said["words"])]
    words += ["-D", f"+WT{said['threads']}", f"+I{_link(scene, work, 'scene.pov')}", "+Opicture"]
    if frame is not None:
        # the clock is of the frames that were asked for, unless the words say of which
        words += [] if said["clock"] else [f"+KFI{said['range'][0]}", f"+KFF{said['range'][1]}"]
        words += [f"+SF{frame}", f"+EF{frame}"]
    if item.get("tile"):
        x, y, width, height = item["tile"]
        words += [f"+SC{x + 1}", f"+EC{x + width}", f"+SR{y + 1}", f"+ER{y + height}"]
    log.run([said["programs"]["povray"], *words], folder=work)
    made = sorted(name for name in os.listdir(work) if name.startswith("picture"))
    if len(made) != 1:
        raise files.Refusal(f"POV-Ray wrote {len(made)} pictures, and one was expected")
    name = said["name"] + ("" if frame is None else f"_{frame:04}") + os.path.splitext(made[0])[1]
    os.rename(os.path.join(work, made[0]), os.path.join(work, name))
    return [name]


def merge(job, _frame, parts, work, _log):
    name = os.path.basename(parts[0][1][0])
    png.paste([(paths[0], item["tile"]) for item, paths in parts], os.path.join(work, name))
    return [name]


def pack(scene, inputs, folder, _options):
    """What lies beside the scene keeps its place; what lies elsewhere cannot."""
    home = os.path.dirname(os.path.abspath(scene))
    for path in inputs:
        name = os.path.relpath(path, home)
        if name.startswith(".."):
            raise files.Refusal(f"{path}: --pack takes what lies in the scene's folder or below; put it there")
        place = os.path.join(folder, name)
        os.makedirs(os.path.dirname(place), exist_ok=True)
        shutil.copyfile(path, place)
    return os.path.join(folder, os.path.basename(scene))
