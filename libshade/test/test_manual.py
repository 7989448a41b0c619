# SPDX-License-Identifier: Apache-2.0
"""The words of the manual: short sentences and paragraphs, no measured figure outside results/ and theory/, terms of the glossary
linked where a page uses them first."""
import functools
import pathlib
import re
import runpy

import pytest

COST = 0.5

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
GUIDES = sorted(page for folder in ("start", "blender", "povray", "library", "develop") for page in (DOCS / folder).rglob("*.md")
                if page.name != "glossary.md") + [DOCS / "index.md"]
FIRST_READ = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "NEWS.md")]  # they link no terms, and sentences of news are long


def each(pages):
    return pytest.mark.parametrize("page", pages, ids=lambda page: str(page.relative_to(DOCS if DOCS in page.parents else ROOT)))


ids = each(GUIDES)
VERSIONS = {"2.28", "2.34", "3.4", "3.7", "3.8", "4.0", "4.1", "4.2", "4.3", "4.4", "4.5", "5.0", "5.1", "5.2", "5.3", "3.10", "3.11", "3.12", "3.13"}


@functools.cache
def parts(page):
    """(line, text) of each paragraph, item and cell of a page; what is in code is left out."""
    found, text, start, fence = [], [], 0, None

    def end():
        if text:
            found.append((start, " ".join(text)))
            text.clear()

    written = page.read_text(encoding="utf-8")
    # README's table of results, which a command writes
    written = re.sub(r"<!-- results:.*?<!-- end of results -->", lambda part: "\n" * part[0].count("\n"), written, flags=re.S)
    for number, line in enumerate(written.splitlines(), 1):
        bare = line.strip()
        opened = re.match(r"(`{3,}|:{3,}|~{3,})", bare)
        if fence:
            if bare == fence:
                fence = None
            continue
        if opened:
            end()
            if not re.match(r":{3,}(\{(note|tip|warning|important|admonition)\}|$)", bare):  # what those hold is read
                fence = opened[1]
            continue
        if re.match(r"(#|<!--|!\[|\(.*\)=$|---)", bare) or not bare or line.startswith("    "):
            end()
            continue
        if bare.startswith("|"):
            end()
            found += [(number, cell.strip()) for cell in bare.strip("|").split("|") if not re.fullmatch(r"[-: ]*", cell)]
            continue
        if re.match(r"([-*+:]|\d+\.) ", bare):
            end()
            bare = re.sub(r"^([-*+:]|\d+\.) +", "", bare)
        if not text:
            start = number
        text.append(bare)
    end()
    return found


def plain(text):
    """Without markup: code is one word, a link is what it shows."""
    text = re.sub(r"\{\w+(?::\w+)*\}`([^`<]*?)\s*(?:<[^`>]*>)?`", r"\1", text)
    text = re.sub(r"`+[^`]*`+", "CODE", text)
    text = re.sub(r"\$[^$]*\$", "FORMULA", text)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"[*_]{1,2}(\S.*?\S|\S)[*_]{1,2}", r"\1", text)


def sentences(text):
    return [part for part in re.split(r"(?<=[.!?:;])\s+(?=[\"'(*]*[A-Z0-9])", text) if part]


def words(text):
    return len(re.findall(r"[^\s–—-]\S*", text))


@each(GUIDES + FIRST_READ[:2])
def test_sentences_and_paragraphs_are_short(page):
    wrong = []
    for line, text in parts(page):
        said = plain(text)
        if words(said) > 90:
            wrong.append(f"{line}: a paragraph of {words(said)} words")
        wrong += [f"{line}: a sentence of {words(one)} words: {one[:60]} …" for one in sentences(said) if words(one) > 35]
    assert not wrong, "\n".join(wrong)


@each(GUIDES + FIRST_READ)
def test_no_measured_figure(page):
    """Decimals stand in code, where they are defaults and what one types; with a unit of length or an angle; or are versions."""
    wrong = []
    for line, text in parts(page):
        said = plain(re.sub(r"[\w.-]+\.\w+", lambda found: found[0] if re.fullmatch(r"[\d.]+", found[0]) else "NAME", text))
        for found in re.finditer(r"(?<![\w.])\d*\.\d+(?!\w)(\s*(mm|cm|m|µm|nm|°|degrees)\b)?", said):
            if not found[1] and found[0].strip() not in VERSIONS:
                wrong.append(f"{line}: {found[0]}: a measured figure belongs in results/, a default in code")
    assert not wrong, "\n".join(wrong)


def terms():
    glossary = (DOCS / "develop/glossary.md").read_text(encoding="utf-8").split("```{glossary}\n")[1].split("\n```")[0]
    return re.findall(r"^(\S.*)$", glossary, re.M)


def test_the_glossary_has_its_terms():
    said = terms()
    assert len(said) >= 60 and said == sorted(said, key=str.lower) and len(said) == len(set(said))


@ids
def test_terms_are_linked_where_they_come_first(page):
    text = " \n".join(said for _, said in parts(page))
    text = re.sub(r"\{term\}`(?:[^`<]*<)?([^`<>]*)>?`", r"⟦\1⟧", text)
    text = re.sub(r"\{\w+\}`[^`]*`|(`+)[^`]*\1|\$[^$]*\$|!?\[[^\]]*\]\([^)]*\)", " ", text)
    wrong = []
    for term in sorted(terms(), key=len, reverse=True):  # the longest first: what holds a shorter one is read once
        word = re.escape(term).replace(r"\ ", r"\s+").replace(r"\-", "[- ]") + "s?"
        found = re.search(rf"⟦{word}⟧|(?<![\w⟦-]){word}(?![\w⟧-])", text, re.I)
        if found and not found[0].startswith("⟦"):
            wrong.append(f"{term}: first as '{text[max(found.start() - 25, 0):found.end() + 15].strip()}'")
        text = re.sub(rf"(?<![\w⟦-]){word}(?![\w⟧-])", "·", text, flags=re.I)
    assert not wrong, "\n".join(wrong)


def test_what_is_supported_is_as_the_exporter_says():
    """`make supported` writes the page from the exporter's own tables, which also say what is not read at all."""
    assert runpy.run_path(str(ROOT / "setup/supported.py"))["Page"]().text() == (DOCS / "blender/supported.md").read_text(encoding="utf-8")
