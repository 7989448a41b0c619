# SPDX-License-Identifier: Apache-2.0
"""The report's page by its parts: what is counted, escaped, sorted by, linked, and refused."""
from types import SimpleNamespace

import pytest

import page

COST = 0.3


def section(**parts):
    plain = {"name": "speed", "title": "Speed", "intro": "", "findings": (), "figures": (), "tables": (), "commands": {}, "count": 0, "left": 0,
             "alone": False, "apart": False}
    return SimpleNamespace(**{**plain, **parts})


def part(name, **more):
    return SimpleNamespace(**{"id": name, "title": "A < B", "caption": "`x` & y", "alt": 'a "b"', "svg": "<svg/>", "columns": ("n", "w"),
                              "rows": (), **more})


def test_what_is_left_out_is_counted():
    assert page.left_out(1) == "One sentence about times is left out: this run was too noisy to tell."
    assert page.left_out(2) == "2 sentences about times are left out: this run was too noisy to tell."


def test_text_is_escaped():
    assert page.text("a < `b < c` & d") == "a &lt; <code>b &lt; c</code> &amp; d" and page.attribute('"<') == "&quot;&lt;"


@pytest.mark.parametrize("value, said", [
    (None, "<td></td>"), ("", "<td></td>"), ("short", '<td data-head="n &lt;" class=short>short</td>'),
    ("x" * 28, f'<td data-head="n &lt;">{"x" * 28}</td>'),
    (7, '<td class="number" data-head="n &lt;" data-value="7.0">7</td>'), (0, '<td class="number" data-head="n &lt;" data-value="0.0">0</td>')])
def test_cells(value, said):
    assert page.cell(value, "n <") == said


def test_numbers_are_sorted_by_all_their_digits():
    assert 'data-value="0.123456789"' in page.cell(0.123456789, "n") and "0.123456789<" not in page.cell(0.123456789, "n")


def test_figures_and_tables_are_counted_through_the_page():
    sections = [section(figures=[part("a"), part("b")], tables=[part("t")]), section(name="other", figures=[part("a")], tables=[part("u")])]
    names = page.numbered(sections)
    assert names == {"speed-a": "Figure 1", "speed-b": "Figure 2", "other-a": "Figure 3", "speed-t": "Table 1", "other-u": "Table 2"}
    with pytest.raises(ValueError, match="two parts are called 'a'"):
        page.numbered([section(figures=[part("a")], tables=[part("a")])])
    assert 'aria-label="a &quot;b&quot;"' in page.figure(sections[0], part("a"), names)
    made = page.table(sections[0], part("t", rows=[(1, "one"), (2, "two")]), names)
    assert made.count("<tr>") == 3 and made.count("class=number") == 1
    with pytest.raises(ValueError, match="table t: a row of 1 for 2"):
        page.table(sections[0], part("t", rows=[(1,)]), names)
    linked = page.sentence(sections[1], SimpleNamespace(text="so", figure="a"), names)
    assert 'href="#other-a">Figure&nbsp;3</a>' in linked and "href" not in page.sentence(sections[1], SimpleNamespace(text="so", figure=""), names)
    with pytest.raises(ValueError, match="links 'b'"):
        page.sentence(sections[1], SimpleNamespace(text="so", figure="b"), names)
