# SPDX-License-Identifier: Apache-2.0
"""The comments of libshade's headers, as hawkmoth hands them over, in Sphinx's markup.

They are plain text: paragraphs, `code`, lists with -, @code … @endcode, and at their end @param NAMES TEXT and @return TEXT. Names
of the library become links. A structure or an enumeration is followed by its code, with the choices of table.h that it is made of.
"""
import functools
import re
from pathlib import Path

HEADERS = Path(__file__).resolve().parent.parent / "libshade/include/shade"
# a comment and what it stands before: a function, a structure, a macro, or the guard of its header
DECLARED = r"#[^\n]*|[^;{}#]*(?:\{[^\n]*\}[^;{}]*|\{.*?^\}[^;{}]*)?;"
BLOCK = re.compile(rf"^/\*\*(.*?)\*/\n({DECLARED})$", re.S | re.M)


def plain(comment):
    return [re.sub(r"^ \* ?| \*$", "", line) for line in comment.rstrip(" ").splitlines()]


def blocks(header):
    """(comment, declaration) of each in a header."""
    for comment, declared in BLOCK.findall((HEADERS / header).read_text(encoding="utf-8")):
        yield "\n".join(line.rstrip() for line in plain(comment)).strip(), declared


@functools.cache
def declared():
    """{comment: declaration} of all headers."""
    return {comment: code for path in sorted(HEADERS.glob("*.h")) for comment, code in blocks(path.name)}


@functools.cache
def names():
    """{name: role}: functions and types that have a comment."""
    found = {}
    for code in declared().values():
        function = re.search(r"^SHADE_API[^(]*?(shade_\w+)\(", code)
        kind = re.search(r"\}\s*(shade_\w+);|^typedef [^(;{]*?(shade_\w+)(?:\(.*)?;", code, re.S)
        if function:
            found[function[1]] = "func"
        elif kind:
            found[kind[1] or kind[2]] = "type"
    return found


def choices(table, text):
    """(NAME, word, value, label, help) of a list of table.h."""
    whole = re.search(rf"#define {table}\(ROW\)(.*?[^\\])\n", text, re.S)[1].replace("\\\n", "\n")
    for row in re.finditer(r'(\w+)\(ROW\)|ROW\((\w+), (\w+), (\d+), "([^"]*)",\s*"([^"]*)"\)', whole):
        if row[1]:
            yield from choices(row[1], text)
        else:
            yield row.groups()[1:]


def code_of(comment):
    """The code of what is no function, and choices that come from the table."""
    code = declared().get(comment, "")
    if "{" not in code:
        return
    found = re.search(r"(SHADE_TABLE_\w+)\((SHADE_\w+_)ROW_\)", code)
    if not found or found[1] == "SHADE_TABLE_LISTS":
        yield from ["", "::", "", *("   " + line for line in code.splitlines()), ""]
        return
    yield ""
    for name, _, value, _, about in choices(found[1], (HEADERS / "table.h").read_text(encoding="utf-8")):
        yield f"- ``{found[2]}{name}`` ({value}): {marked(about)}."
    yield ""


def marked(line):
    """A line of text: what reST would read as markup is kept as it is, names are links."""
    def linked(found):
        name = found[1]
        return f":c:{names()[name]}:`{name}`\\ " if name in names() else found[0]

    parts = re.split(r"(`[^`]+`)", line)
    for i in range(0, len(parts), 2):
        text = re.sub(r"[*|\\]|(?<=\w)_(?!\w)", lambda found: "\\" + found[0], parts[i])
        parts[i] = re.sub(r"\b(shade_\w+)\b(\(\))?", linked, text)
    return "".join(f"`{part}`" if i % 2 else part for i, part in enumerate(parts))


def converted(lines):
    inside, field, item = False, False, False
    for line in lines:
        command = re.match(r"@(\w+) *(.*)", line)
        if inside:
            inside = not (command and command[1] == "endcode")
            yield "   " + line if inside else ""
        elif not command:
            if line.startswith("- ") or item and not line.startswith("  "):
                yield ""
            item = line.startswith(("- ", "  ")) and bool(line)
            yield ("   " if field and line else "") + marked(line.strip() if field else line)
        elif command[1] == "code":
            inside = True
            yield from ["", ".. code-block:: c", ""]
        elif command[1] == "return":
            yield "" if not field else None
            field = True
            yield f":returns: {marked(command[2])}"
        else:
            named, text = re.match(r"(\w+(?:, \w+)*) +(.*)", command[2]).groups()
            yield from [] if field else [""]
            field = True
            for name in named.split(", "):
                yield f":param {name}: {marked(text)}"


def process(app, lines, transform, options):
    comment = "\n".join(line.rstrip() for line in lines).strip()
    lines[:] = [line for line in converted(lines) if line is not None] + list(code_of(comment))


def setup(app):
    app.connect("hawkmoth-process-docstring", process)
    return {"parallel_read_safe": True}
