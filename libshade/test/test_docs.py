# SPDX-License-Identifier: Apache-2.0
"""Every test that docs/ names exists and is run."""
import pathlib
import re

import pytest

COST = 0.1

ROOT = pathlib.Path(__file__).resolve().parents[2]
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
