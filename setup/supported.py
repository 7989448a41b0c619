# SPDX-License-Identifier: Apache-2.0
"""Writes the tables of docs/blender/supported.md between its marks: of what Cycles has (setup/cycles-has.txt, see cycles_has.py), which
of it the exporter reads (its own tables in blender_addon_c/export), and how near that is (setup/supported.txt)."""
import ast
import re
from pathlib import Path
from types import SimpleNamespace

ROOT = Path(__file__).resolve().parent.parent
EXPORT = ROOT / "blender_addon_c/export"
PAGE = ROOT / "docs/blender/supported.md"
_PASSED_ON = "passed on"  # which the page explains
_SHADERS = ("BSDF", "BSSRDF", "Emission", "Background", "Shader", "Holdout", "Volume")  # what their outputs are called
_TERMS = {"AOV Output": "{term}`AOV` Output", "Bump": "{term}`Bump <bump>`", "Fresnel": "{term}`Fresnel`", "Holdout": "{term}`Holdout <holdout>`",
          "Normal Map": "{term}`Normal Map <normal map>`", "Diffuse BSDF": "Diffuse {term}`BSDF`"}


def lines(path):
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            yield [part.strip() for part in line.split("|")]


# ---- what the exporter reads


def _assigned(name, wanted):
    """The expression that a module of the exporter gives a name."""
    for node in ast.parse((EXPORT / name).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == wanted:
            return node.value
    raise KeyError(f"{name} has no {wanted}")


def _strings(expression):
    """The keys of a dictionary or the parts of a tuple, those that are texts."""
    return {part.value for part in getattr(expression, "keys", getattr(expression, "elts", ())) if isinstance(part, ast.Constant)}


def kinds():
    """By a node's name what the exporter knows of it: properties, inputs, outputs."""
    found = {}
    for row in ast.literal_eval(_assigned("known.py", "_TABLE")).strip().replace("\n    ", " ").split("\n"):
        name, rest = row.split(":", 1)
        properties, *sides = (rest.split("|") + ["", ""])[:3]
        found[name] = [[word.partition("=")[0] for word in properties.split()],
                       *([one.strip() for one in side.split(",") if one.strip()] for side in sides)]
    return found


def passes():
    """Properties that ask for a pass which is rendered."""
    text = (EXPORT / "passes.py").read_text(encoding="utf-8")
    given = {"versions": SimpleNamespace(LONG_PASS_NAMES=True, MORE_TO_DENOISE=True), "OCCLUSION_NAME": "", "groups": None, "of_nodes": None}
    exec(compile(re.sub(r"^from \..*$", "", text, flags=re.M), "passes.py", "exec"), given)  # noqa: S102
    mattes = given["_mattes"](SimpleNamespace(pass_cryptomatte_depth=2))
    return {one.wanted_by for one in (*given["PASSES"], given["_CATCHER"], given["_COUNT"], *given["_LAST"], *mattes)}


class Read:
    def __init__(self):
        self.kinds = kinds()
        self._names = _strings(_assigned("closure.py", "CLOSURES")) | {"ShaderNode" + name for name in self.kinds}
        self._types = {"SWITCH", "INDEX_SWITCH", "REPEAT_OUTPUT"}  # of tree.py, which walks through them
        for path in EXPORT.glob("node_*.py"):
            self._types |= _strings(_assigned(path.name, "NODES"))
        self._others = {"light": _strings(_assigned("light.py", "_LIGHTS")), "pass": passes() | {"use_pass_combined"},
                        "camera": _strings(_assigned("camera.py", "_PANORAMAS")) | {"PERSP", "ORTHO", "PANO"}}

    def __call__(self, kind, identifier, type_):
        return identifier in self._names or type_ in self._types if kind == "node" else identifier in self._others[kind]


# ---- the page


def since(versions, every):
    """In which Blenders, of those that were asked."""
    if versions == every:
        return "all"
    if versions[0] == every[0]:
        return f"until `{versions[-1]}`" if len(versions) > 1 else f"in `{versions[0]}`"
    return f"from `{versions[0]}`" if versions[-1] == every[-1] else f"`{versions[0]}` to `{versions[-1]}`"


def short(identifier):
    """As supported.txt has it."""
    return re.sub(r"^(ShaderNode|GeometryNode|use_pass_)", "", identifier)


def unlinked(text):
    return re.sub(r"\{term\}`([^`<]*?) *(?:<[^>]*>)?`", r"\1", text)


class Page:
    def __init__(self):
        self.read = Read()
        self.said, self.more, self.unused = {}, [], set()
        for kind, name, how, note in lines(ROOT / "setup/supported.txt"):
            if kind.startswith("more "):
                self.more.append((kind[5:], name, how, note))
            else:
                self.said["node" if kind == "shader" else kind, name] = how, note
                self.unused.add(("node" if kind == "shader" else kind, name))
        self.has = list(lines(ROOT / "setup/cycles-has.txt"))
        self.every = sorted({version for row in self.has for version in row[4].split()}, key=lambda v: [int(part) for part in v.split(".")])

    def _said(self, kind, identifier, type_):
        """(how, note); what is said of what is not read must not claim more, nor be missing of what is."""
        key = kind, short(identifier)
        if key not in self.said and kind == "node" and "Volume" in identifier and type_ != "VOLUME_INFO":
            key = kind, "Volume"
        how, note = self.said.get(key, ("", ""))
        self.unused.discard(key)
        read = self.read(kind, identifier, type_)
        if how and not read:
            raise SystemExit(f"supported.txt: {kind} {short(identifier)} is {how}, but the exporter does not read it")
        return (how or "same", note) if read else ("not", note or {"node": _PASSED_ON}.get(kind, "It is named."))

    def rows(self, kind, wanted=lambda row: True):
        """(name, versions, how, note) of a kind."""
        found, others = [], {}
        for row in self.has:
            if row[0] == kind and wanted(row):
                _kind, identifier, type_, name, versions = row[:5]
                how, note = self._said(kind, identifier, type_)
                if note == _PASSED_ON:
                    others.setdefault(since(versions.split(), self.every), []).append(name)
                else:
                    found.append((_TERMS.get(name, name), since(versions.split(), self.every), how, note))
        found.sort(key=lambda row: unlinked(row[0]).lower())
        found += [("others", versions, "not", f"`{', '.join(sorted(names, key=str.lower))}`") for versions, names in sorted(others.items())]
        for of, name, how, note in self.more:
            if of == kind:
                name, _, versions = name.partition(" [")
                found.append((name, versions.rstrip("]") or "all", how, note))
        return found

    def table(self, title, rows):
        yield f"| {title} | Blender | As in Cycles | Note |"
        yield "|---|---|---|---|"
        for row in rows:
            yield "| " + " | ".join(row).rstrip() + " |"

    def sockets(self):
        yield "| Node | Properties | Inputs | Outputs |"
        yield "|---|---|---|---|"
        for _kind, identifier, _type, name, versions, *sides in sorted((row for row in self.has if row[0] == "node"), key=lambda row: row[3].lower()):
            known = self.read.kinds.get(short(identifier))
            if not known:
                continue
            properties, *read = known
            cells = [self._code(properties)]
            for side, names in zip(sides, read):
                by, left = {}, {}
                for socket in side.split(", ") if side else ():
                    socket, _, when = socket.partition(" (")
                    when = when.rstrip(")").split() or versions.split()
                    (by if socket in names else left).setdefault(tuple(when), []).append(socket)
                cells.append(self._by_version(by, versions.split()) + ("; not read: " + self._by_version(left, versions.split()) if left else ""))
            yield f"| {name} | " + " | ".join(cells).rstrip() + " |"

    def _by_version(self, by, versions):
        """Sockets, those of all versions of the node first."""
        order = sorted(by, key=lambda when: (list(when) != versions, self.every.index(when[0]), len(when)))
        return "; ".join(self._code(by[when]) if list(when) == versions else f"{since(list(when), self.every)} {self._code(by[when])}"
                         for when in order)

    @staticmethod
    def _code(names):
        return f"`{', '.join(names)}`" if names else ""

    def parts(self):
        def shades(row):
            return any(output.partition(" (")[0] in _SHADERS for output in row[6].split(", "))
        yield "shaders", self.table("Node", self.rows("node", shades))
        yield "nodes", self.table("Node", self.rows("node", lambda row: not shades(row)))
        yield "sockets", self.sockets()
        for kind in ("light", "camera", "pass"):
            yield kind, self.table(kind.title(), self.rows(kind))

    def text(self):
        text = PAGE.read_text(encoding="utf-8")
        for part, made in self.parts():
            body = "\n".join(re.sub(r" +\|", " |", line) for line in made)
            text, count = re.subn(rf"(<!-- made: {part} -->\n).*?(<!-- end: {part} -->)", lambda m, body=body: f"{m[1]}\n{body}\n\n{m[2]}", text, flags=re.S)
            if count != 1:
                raise SystemExit(f"{PAGE.name} has no marks of {part}")
        if self.unused:
            raise SystemExit(f"supported.txt: no Blender has {sorted(self.unused)}")
        return re.sub(r"(?<=<!-- asked -->).*?(?=<!-- end -->)", ", ".join(f"`{version}`" for version in self.every), text)


if __name__ == "__main__":
    PAGE.write_text(Page().text(), encoding="utf-8")
