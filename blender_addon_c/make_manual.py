# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual as one page for a browser, with the pictures that it shows beside it.

usage: make_manual.py MANUAL.md FOLDER
Links to other files of the repository become plain text: they are not in the add-on.
"""

import os
import re
import shutil
import sys

from markdown_it import MarkdownIt

_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>libshade in Blender</title><style>
body {{ max-width: 50em; margin: 2em auto; padding: 0 1em; font: 16px/1.5 sans-serif; color: #222; background: #fff }}
img {{ max-width: 100% }} code {{ background: #eee }} pre {{ background: #eee; padding: .5em; overflow-x: auto }}
table {{ border-collapse: collapse }} td, th {{ border-bottom: 1px solid #ccc; padding: .2em .8em .2em 0; text-align: left; vertical-align: top }}
nav {{ columns: 2 }} nav a {{ display: block }}
</style></head><body>
<nav>{contents}</nav>
{text}</body></html>
"""


def anchor(title):
    """As code hosts make it of a heading."""
    return re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-")


def page(markdown):
    """(the page, pictures that it shows)"""
    reader = MarkdownIt("commonmark").enable("table")
    tokens, pictures, contents = reader.parse(markdown), [], []
    for heading, title in zip(tokens, tokens[1:]):
        if heading.type == "heading_open":
            heading.attrSet("id", anchor(title.content))
            contents.append(f'<a href="#{anchor(title.content)}">{title.content}</a>')
    for token in tokens:
        inside, closed = token.children or (), False
        for part in inside:
            if part.type == "image":
                pictures.append(part.attrs["src"])
                part.attrs["src"] = os.path.basename(part.attrs["src"])
            elif part.type == "link_open":
                closed = not re.match(r"https?:|#", part.attrs["href"])
                part.hidden = closed
            elif part.type == "link_close":
                part.hidden = closed
        if inside:
            token.children = [part for part in inside if not part.hidden]
    return _PAGE.format(contents="\n".join(contents), text=reader.renderer.render(tokens, reader.options, {})), pictures


def write(path, folder):
    with open(path, encoding="utf-8") as file:
        text, pictures = page(file.read())
    os.makedirs(folder, exist_ok=True)
    for picture in pictures:
        shutil.copyfile(os.path.join(os.path.dirname(path), picture), os.path.join(folder, os.path.basename(picture)))
    part = os.path.join(folder, f"index.{os.getpid()}.part")
    try:
        with open(part, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(part, os.path.join(folder, "index.html"))  # last: make looks at it
    finally:  # also after Ctrl-C
        if os.path.exists(part):
            os.unlink(part)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    write(*sys.argv[1:])
