# SPDX-License-Identifier: Apache-2.0
"""Every test that docs/ names exists and is run; every public function says what it takes, and is in the manual."""
import pathlib
import re
import sys

import pytest

COST = 0.2

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))
import c_comments  # noqa: E402

PAGES = sorted((ROOT / "docs").rglob("*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_named_tests_exist(page):
    named = re.findall(r"`(test_\w+\.(?:c|py)):(\w+)`", page.read_text())
    if page.name == "papers.md":
        assert len(named) > 20
    for file, function in named:
        path = ROOT / "libshade/test" / file
        assert path.exists(), f"{page.name} names {file}"
        wanted = rf"cmocka_unit_test\({function}\)" if path.suffix == ".c" else rf"^def {function}\("
        assert re.search(wanted, path.read_text(), re.M), f"{page.name} names {file}:{function}"


@pytest.mark.parametrize("page", ("blender", "povray"))
def test_the_way_of_a_sample_can_be_followed(page):
    """Each step names a function and its file; native/ is the add-on's, source/ is POV-Ray's."""
    page = (ROOT / f"docs/develop/architecture-{page}.md").read_text().split("## How a sample travels")[1].split("\n## ")[0]
    steps = re.findall(r"`([\w.:]+)`\s+(?:in\s+|\()([\w/]+\.\w+)", page)
    assert len(steps) == len(re.findall("`[^`]+`", page)) > 4
    for function, file in steps:
        if file.startswith("source/"):
            continue
        file = ROOT / (f"blender_addon_c/{file}" if file.startswith("native/") else file)
        for name in re.split(r"\.|::", function):
            assert re.search(rf"\b{name}\b", file.read_text()), f"{file} has no {name}"


def test_every_printed_formula_is_listed():
    """A test of a printed formula that the page does not mention is of no use to its reader."""
    source = (ROOT / "libshade/test/test_papers.c").read_text()
    page = (ROOT / "docs/theory/papers.md").read_text()
    for function in re.findall(r"cmocka_unit_test\((\w+)\)", source):
        assert f"`test_papers.c:{function}`" in page


HEADERS = sorted(path.name for path in c_comments.HEADERS.glob("*.h") if path.name != "table.h")


def functions(header):
    """{name: (what it returns, names of its parameters)}: all that a header declares, comments left out."""
    text = re.sub(r"/\*.*?\*/", "", (c_comments.HEADERS / header).read_text(), flags=re.S)
    found = {}
    for returned, name, given in re.findall(r"^SHADE_API ([^;(]*?)(shade_\w+)\((.*?)\);$", text, re.S | re.M):
        words = [re.sub(r"\[\d*\]", "", one).split()[-1].lstrip("*") for one in given.split(",")]
        found[name] = returned.strip(), [word for word in words if word != "void"]
    return found


@pytest.mark.parametrize("header", HEADERS)
def test_public_functions_say_what_they_take(header):
    """Parameters by name, what is returned, what threads must know where a function makes, ends or shares something; of a function in
    float that it is one."""
    said = {re.search(r"(shade_\w+)\(", code)[1]: comment for comment, code in c_comments.blocks(header) if "SHADE_API" in code}
    declared = functions(header)
    assert set(said) == set(declared)
    assert "\nThreads. " in "\n" + next(c_comments.blocks(header))[0]
    wrong = []
    for name, (returned, given) in declared.items():
        comment = said[name]
        if comment.startswith("In float"):
            assert comment == f"In float: {name[:-1]}." and functions(header)[name[:-1]][1] == given, name
            continue
        told = [one for listed in re.findall(r"^@param (\w+(?:, \w+)*) ", comment, re.M) for one in listed.split(", ")]
        alone = re.search(r"_(create|free|batch|setup|rows|by)$|^shade_(isa|wif_|draft_from|draft_named|preset_fabric)", name)
        if told != given:
            wrong.append(f"{name}: parameters {told}, not {given}")
        if (returned != "void") != ("\n@return " in comment):
            wrong.append(f"{name}: what it returns")
        if alone and "\nThreads: " not in comment:
            wrong.append(f"{name}: what threads must know")
        if max(len(re.findall("[A-Za-z]{2,}", line)) for line in re.split(r"[.:;]\s", comment.split("@param")[0])) > 35:
            wrong.append(f"{name}: a long sentence")
    assert not wrong, "\n".join(wrong)


def test_every_header_is_in_the_manual():
    page = (ROOT / "docs/library/api.md").read_text()
    assert re.findall(r"^\.\. c:autodoc:: (\S+)$", page, re.M) and set(HEADERS) == set(re.findall(r"autodoc:: (\S+)", page))
    assert sum(len(functions(header)) for header in HEADERS) > 140
