# SPDX-License-Identifier: Apache-2.0
"""The report's page by its parts: what is counted, escaped, sorted by, linked, and refused."""
import re
import sys
import xml.etree.ElementTree
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import page
import report_page
import study
import style

COST = 1.8


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
    told = [section(figures=[part("late"), part("seen"), part("choice")], tables=[part("t"), part("seen-too")], findings=[SimpleNamespace(figure="seen"), SimpleNamespace(figure="seen-too")])]
    assert page.numbered(told) == {"speed-choice": "Figure 1", "speed-seen": "Figure 2", "speed-late": "Figure 3", "speed-t": "Table 1", "speed-seen-too": "Table 2"}
    with pytest.raises(ValueError, match="two parts are called 'a'"):
        page.numbered([section(figures=[part("a")], tables=[part("a")])])
    assert 'aria-label="a &quot;b&quot;"' in page.figure(sections[0], part("a"), names)
    made = page.table(sections[0], part("t", rows=[(1, "one"), (2, "two")]), names)
    assert made.count("<tr>") == made.count("</tr>") == 3 and made.count("class=number") == 1
    assert page.table(sections[0], part("t", rows=[(1, "one"), (2, 2)]), names).count("class=number") == 1  # a column of words and numbers is none of numbers
    assert page.figure(sections[0], part("a"), names).rstrip().splitlines()[-2] == "<figcaption><b>Figure 1.</b> <code>x</code> &amp; y</figcaption>"
    with pytest.raises(ValueError, match="table t: a row of 1 for 2"):
        page.table(sections[0], part("t", rows=[(1,)]), names)
    linked = page.sentence(sections[1], SimpleNamespace(text="so", figure="a"), names)
    assert 'href="#other-a">Figure&nbsp;3</a>' in linked and "href" not in page.sentence(sections[1], SimpleNamespace(text="so", figure=""), names)
    with pytest.raises(ValueError, match="links 'b'"):
        page.sentence(sections[1], SimpleNamespace(text="so", figure="b"), names)


def test_how_a_section_is_made_again():
    """By command, what it makes: six names at most; the whole of it, and its rows as a file."""
    said = page.remake(section(commands={"make it": [f"task-{k}" for k in range(7)], "other <": ["one"]}, count=12))
    assert '<a href="data/speed.csv" download>data/speed.csv</a>, 12 rows.' in said
    assert "All of this section: <code>build/venv/bin/python compare/report_page.py --only speed</code>" in said
    assert "<li><code>make it</code><span>task-0, task-1, task-2, task-3, task-4, task-5 …</span></li>" in said and "<li><code>other &lt;</code><span>one</span></li>" in said
    assert "commands" not in page.remake(section())


@pytest.mark.parametrize("count, many", [(7, False), (8, True)])
def test_wide_tables_are_set_small(count, many):
    made = page.table(section(), part("t", columns=[f"c{k}" for k in range(count)], rows=[list(range(count))]), {"speed-t": "Table 1"})
    assert ('class="many"' in made) == many and made.count("<th ") == count and '<b>Table 1.</b> <strong>A &lt; B</strong> <code>x</code> &amp; y' in made


def test_a_page_of_its_own_and_the_report():
    """What stands on the report of a study that has its page, in which order, and where each was measured."""
    finding = SimpleNamespace(text="So it is.", figure="", holds=True)
    of = lambda **more: page.Section(**{"name": "speed", "title": "Speed", "intro": "Why.", "findings": [finding], "figures": [part("choice"), part("seen"), part("late")], "tables": [part("t")],
                                        "commands": {}, "count": 3, **more})
    lead = SimpleNamespace(text="See.", figure="seen", holds=True)
    sections = [of(findings=[lead], topic="detail", answers=[SimpleNamespace(surface="is < flat", use="`a`", costs="2 ×", fails="never")]),
                of(name="atlas", title="Where", apart=True, findings=[SimpleNamespace(text="At first.", figure="", holds=True), finding], figures=[part("map")], tables=[part("u")])]
    head = {"machine": "m", "compiler": "c", "commit": "1234", "date": "today", "command": "make compare"}
    text = page.html(sections, head, False)
    order = [text.index(word) for word in ('<a class="skip" href="#answers">To the answers</a>', "libshade · report</p>", "<h1>Speed, accuracy, and where methods fail</h1>",
                                          '<a href="#answers">What to use</a>', '<a href="#speed">Speed</a>', '<a href="#atlas">Where</a>', '<section id="answers">', 'id="speed-choice"',
                                          '<section id="speed">', 'id="speed-seen"', '<section id="atlas">', '<a href="atlas.html">Maps, findings and reasons</a>',
                                          '<section id="appendix">', 'id="speed-late"', '<div class="table" id="speed-t">', "<dt>machine</dt><dd>m</dd>", "<dt>commit</dt><dd>1234</dd>",
                                          "<dt>made by</dt><dd><code>make compare</code></dd>")]
    assert all(word in text for word in ('<html lang="en">', '"viewport" content="width=device-width, initial-scale=1"', '"color-scheme" content="light dark"', '<p id="said" role="status"',
                                         "<details open><summary>Contents</summary>", '<p class="intro">So it is.'))  # a phone's width, dark screens, what a reader aloud is told
    assert order == sorted(order) and "At first." not in text and "<dt>command" not in text and "atlas-u" not in text and "quick report" not in text and page.QUICK[:30] not in text
    assert '<tr><td>is &lt; flat</td><td data-head="use"><a href="#speed">detail</a> <code>a</code></td><td data-head="costs">2 ×</td><td data-head="fails where">never</td></tr>' in text
    assert [head for head in re.findall(r'<th scope="col">(.*?)</th>', text)][:4] == ["If your surface …", "use", "costs", "fails where"]
    assert "Figure&nbsp;2" in text and text.count("<b>Figure 1.</b>") == 1
    assert len(re.findall(r' id="([^"]*)"', text)) == len(set(re.findall(r' id="([^"]*)"', text)))  # each part stands once
    quick = page.html(sections, head, True)
    assert "libshade · quick report" in quick and page.QUICK[:30] in quick
    alone = page.html(sections[1:], head, False, alone=True)
    assert "<h1>Where</h1>" in alone and '<a href="report.html">report</a>' in alone and 'id="atlas-map"' in alone and 'id="atlas-u"' in alone and "So it is." in alone
    assert alone.index('id="atlas-map"') < alone.index('<section id="appendix">') < alone.index('id="atlas-u"')  # no finding leads to it, and there it is
    assert '<a class="skip" href="#atlas">To the text</a>' in alone and 'id="answers"' not in alone


def test_words_of_a_page_are_counted_before_its_appendix():
    """Those of charts among them, tags and what stands around it not; one too many is refused, with both numbers."""
    assert page.words('<p>not</p><main><h2 class="a b">one two</h2><text>three</text> &amp; <b>four</b><section id="appendix">five</section></main>six') == 5
    head = {"command": "make"}
    of = page.Section("speed", "Speed", "", [], [], [], {}, 0)
    fewest = page.words(page.html([of], head, False))
    long = lambda count: page.html([replace(of, intro="word " * count)], head, False)
    assert page.MOST == 6000 and page.words(long(6000 - fewest)) == 6000
    with pytest.raises(ValueError, match="the report has 6001 words before its appendix: expected 6000 at most"):
        long(6001 - fewest)
    page.html([replace(of, intro="word " * 7000)], head, False, alone=True)
    noisy = [replace(of, left=1), replace(of, name="other", left=1)]
    assert "2 sentences about times are left out" in page.html(noisy, head, False) and "left out" not in page.html([of], head, False)


# ---- charts -------------------------------------------------------------------------------------------------


def test_looks_differ_by_more_than_colour():
    """Of two methods that share a chart: colours of Okabe and Ito, and a marker of its own for each colour."""
    assert [style.BLUE, style.SKY, style.GREEN, style.ORANGE, style.VERMILION, style.PURPLE] == [
        "#0072b2", "#56b4e9", "#009e73", "#e69f00", "#d55e00", "#cc79a7"]
    charts = (["displaced", "none", "perturb", "gram_schmidt", "shortest_arc", "rotate", "rotate_approximate", "rotate_literal", "auto", "deform_linear",
               "deform_linear_conserving", "deform_smooth", "deform_smooth_conserving"], ["ashikhmin_shirley", "ward", "ward_half", "beckmann", "ggx"],
              ["float", "double", "reference"], ["hard", "valid_reflection", "estevez", "chiang", "schuessler", "valid_estevez"],
              ["lambert", "max_normal", "max_normal_scaled", "fibre", "fibre_view", "poulin_fournier"], ["near", "far", "far_nodes", "single"],
              ["libshade", "cycles", "cycles_5", "povray", "mitsuba"], [f"lobes_{n}" for n in (1, 2, 3, 4, 6, 8)])
    for words in charts:
        looks = [style.of(word) for word in words]
        assert len({(look.marker, look.hollow) for look in looks}) == len({look.label for look in looks}) == len(words), words
        assert all(look.hollow == (look.points["markerfacecolor"] == style.PAPER) and look.points["markeredgecolor"] == look.colour == look.line["color"] ==
                   look.bars["ecolor"] for look in looks) and not any("_" in look.label for look in looks)
    markers = {}
    for look in [style.of(word) for words in charts for word in words]:
        assert markers.setdefault(look.marker, look.colour) == look.colour, look
    assert style.of("gram-schmidt") is style.of("gram_schmidt") and style.of("never heard of").hollow and style.of("never heard of") is style.of("never heard of")


def drawn(make, **size):
    """Texts of a drawing, {words: (x, y)}, and the drawing."""
    figure, axes = style.figure(**size)
    axes.set(xlim=(0, 10), ylim=(0, 10))
    make(axes)
    text = style.svg(figure)
    root = xml.etree.ElementTree.fromstring(text.replace("xlink:", ""))
    found = {}
    for element in root.iter():
        if element.tag.endswith("text"):
            place = element.get("transform") or f"({element.get('x')} {element.get('y')})"
            found["".join(element.itertext())] = tuple(map(float, re.findall(r"-?[\d.]+", place)[:2]))
    return found, text


def test_a_chart_is_that_large_and_takes_the_pages_colours():
    found, text = drawn(lambda axes: axes.plot([1, 9], [1, 9], **style.of("rotate").line), width=300, height=200)
    assert 'viewBox="0 0 300 200"' in text and '--wide:300"' in text and "var(--blue)" in text and "var(--faint)" in text
    assert not re.search(r"#[0-9a-f]{6}(?![0-9a-f])|<metadata|<style|<!--|font-family|\n", text) and {"0", "2", "10"} <= set(found)
    names = set(re.findall(r' id="([^"]+)"', text))
    assert names and all(name.startswith("f") for name in names) and set(re.findall(r"(?:url\(#|href=\"#)([^)\"]+)", text)) == names
    other = drawn(lambda axes: axes.plot([1, 9], [2, 9], **style.of("rotate").line), width=300, height=200)[1]
    assert not names & set(re.findall(r' id="([^"]+)"', other)), "two drawings on a page have ids of their own"


@pytest.mark.parametrize("low, high, ticks", [(0.5, 5, ["0.5", "1", "2", "5"]), (1e-4, 1, ["10⁻⁴", "0.001", "0.01", "0.1", "1"])])
def test_ticks_of_a_logarithmic_axis(low, high, ticks):
    """Decades; between few of them 2 and 5."""
    def make(axes):
        axes.set(xlim=(low, high))
        style.log_ticks(axes.xaxis)
        axes.set_yticks([])
    found = drawn(make)[0]
    assert sorted(found, key=lambda words: found[words][0]) == ticks


def test_words_beside_points():
    """Each nearest to its own point, in its colour; none on a point, on another, on a line that is told, or outside."""
    points = [(2, 2, "rotate"), (2.2, 2.3, "perturb"), (8, 8, "none"), (9.9, 5, "gram_schmidt"), (5, 9.9, "auto"), (5, 5, "ward")]
    line = [(5, 5), (9, 5)]
    figure, axes = style.figure()
    axes.set(xlim=(0, 10), ylim=(0, 10))
    style.labels(axes, points, lines=[line])
    figure.canvas.draw()
    boxes = {text.get_text(): text.get_window_extent() for text in axes.texts}
    dots = axes.transData.transform([at[:2] for at in points])
    middles = {at[2]: np.array([(b.x0 + b.x1) / 2, (b.y0 + b.y1) / 2]) for at in points for b in [boxes[style.of(at[2]).label]]}
    for (*_at, word), dot in zip(points, dots):
        look, box = style.of(word), boxes[style.of(word).label]
        assert next(text for text in axes.texts if text.get_text() == look.label).get_color() == look.colour
        reach = np.maximum([box.x0 - dot[0], box.y0 - dot[1]], 0) + np.maximum([dot[0] - box.x1, dot[1] - box.y1], 0)
        assert np.hypot(*reach) < 60 * figure.dpi / 72 and not any(box.contains(*other) for other in dots), word
        assert axes.get_window_extent().x0 - 2 < box.x0 and box.y1 < axes.get_window_extent().y1 + 2 and box.x1 < figure.bbox.x1, word
        assert not any(box.overlaps(other) for name, other in boxes.items() if name != look.label), word
    on_line = axes.transData.transform(np.linspace(*line, 50))
    assert not any(boxes["Ward"].contains(*at) for at in on_line) and abs(middles["none"] - dots[2])[1] < 1


def test_words_at_the_ends_of_lines():
    """Right of them, in their order, each at its line where there is room, else above the next by a line of text."""
    figure, axes = style.figure()
    axes.set(xlim=(0, 10), ylim=(0, 10))
    style.ends(axes, [(9, 2.0, "rotate"), (9, 2.1, "perturb"), (9, 8.0, "none"), (9, 2.05, "auto")])
    figure.canvas.draw()
    at = {text.get_text(): (text.get_window_extent().x0, sum(text.get_window_extent().intervaly) / 2) for text in axes.texts}
    step, dot = 11 * figure.dpi / 72, axes.transData.transform((9, 8.0))
    assert at["rotate"][1] + step <= at["auto"][1] and at["auto"][1] + step <= at["perturb"][1] < at["none"][1] and abs(at["none"][1] - dot[1]) < 2
    assert all(dot[0] + 5 < x < dot[0] + 20 for x, _y in at.values()) and [text.get_color() for text in axes.texts].count(style.BLUE) == 1


# ---- how the report is made ------------------------------------------------------------------------------


def test_what_the_report_is_asked(capsys):
    """Where it lands, of which studies and in which order."""
    build = report_page.programs.BUILD.resolve()
    for words, folder in (([], "compare"), (["--quick"], "compare/quick"), (["--output", "x/../y"], None)):
        options = report_page.arguments(words)
        assert options.output == (build / folder if folder else Path("y").resolve())
        assert (options.quick, options.again, options.plan, options.results, options.engine, options.piece) == ("--quick" in words, False, False, False, None, None)
    assert list(options.studies) == "speed precision horizons diffuse lobes cloth frames atlas truth consistency peers".split()
    assert list(report_page.arguments(["--only", "truth", "--only", "speed", "--engine", "slurm", "--results"]).studies) == ["speed", "truth"]
    for words, said in ((["--quick", "--results"], "--results: the quick report is too rough for docs/results/"), (["--only", "none"], "--only none: no such study; there are speed, precision"),
                        (["--engine", "pbs"], "invalid choice: 'pbs'"), (["--fast"], "unrecognized arguments: --fast"), (["--output", __file__], f"--output {__file__}: no folder")):
        with pytest.raises(SystemExit) as end:
            report_page.arguments(words)
        assert end.value.code == 2 and said in capsys.readouterr().err


@pytest.fixture
def made_of(tmp_path, monkeypatch):
    """made_of(tasks, findings) -> options of one study, `atlas`, which stands for any."""
    monkeypatch.setattr(report_page.programs, "BUILD", tmp_path)
    monkeypatch.setattr(report_page.programs, "SHADE", __file__)

    def made(tasks, findings=(), name="atlas"):
        module = SimpleNamespace(NAME=name, TITLE="T", INTRO="I.", __file__=page.__file__, tasks=lambda _quick: tasks, findings=lambda _rows: list(findings),
                                 figures=lambda _rows: [], tables=lambda _rows: [])
        return SimpleNamespace(studies={name: module}, output=tmp_path, quick=False, again=False, engine="slurm", results=False, plan=False, piece=None, stamp=None)
    return made


HEAD = {"date": "today", "machine": "m", "compiler": "c", "commit": "1", "command": "make compare"}


def test_pieces_that_cannot_be(made_of, tmp_path):
    for keys in (("a b",), ("a", "a"), ("",)):
        with pytest.raises(ValueError, match=f"page.py: task '{keys[-1]}': expected letters, digits, - and _, and no key twice"):
            report_page.plan(made_of([study.Task(key, 1, None) for key in keys]), HEAD)
    options = made_of([study.Task("none", 1, lambda _folder, _say: []), study.Task("some", 1, lambda _folder, _say: [{"n": 1}], "make it")])
    none, some = report_page.plan(options, HEAD)
    with pytest.raises(ValueError, match="study atlas, none: no rows"):
        report_page.do(*none[:4], HEAD, None)
    report_page.do(*some[:4], HEAD, None)
    assert report_page.read_rows(some[2]) == ([{"n": 1}], {**HEAD, "command": "make it", "stamp": some[3]}) and not some[2].with_suffix("").exists()
    assert [piece[-1] for piece in report_page.plan(options, HEAD)] == [False, True]


def test_what_is_gathered(made_of, tmp_path, capsys):
    """The rows of all pieces in one file, how each was made; sentences that do not hold are told, all of them; a study of the full report is left out."""
    tasks = [study.Task(key, 1, lambda _folder, _say, key=key: [{"of": key}, {"of": key}], command) for key, command in (("a", "one"), ("b", "one"), ("c", ""))]
    findings = [study.Finding("It is so.", True), study.Finding("It is not.", False), study.Finding("Nor this.", False)]
    options = made_of(tasks, findings[:1])
    report_page.work(report_page.plan(options, HEAD), HEAD)
    lines = capsys.readouterr().err.splitlines()
    assert [re.sub(r"… .*", "", line) for line in lines] == ["[1/3, 3 s left] atlas: a ", "[2/3, 2 s left] atlas: b ", "[3/3, 1 s left] atlas: c "]
    section, = report_page.gather(options, report_page.plan(options, HEAD), HEAD)
    assert (section.name, section.count, section.left, section.apart, dict(section.commands)) == ("atlas", 6, 0, True, {"one": ["a", "b"]})
    assert [report_page.read_rows(tmp_path / f"data/atlas/{key}.csv")[1]["command"] for key in "abc"] == ["one", "one", "make compare"]
    assert report_page.read_rows(tmp_path / "data/atlas.csv") == ([{"of": key} for key in "aabbcc"], HEAD)
    options = made_of(tasks, findings)
    with pytest.raises(ValueError) as wrong:
        report_page.gather(options, report_page.plan(options, HEAD), HEAD)
    assert str(wrong.value).splitlines() == ["no page, since findings do not hold:", *(
        f'  study atlas: does not hold for data/atlas.csv: "{text}"' for text in ("It is not.", "Nor this."))]
    assert report_page.gather(options, [], HEAD) == []

    def fails(_folder, _say):
        raise OSError("disk")
    with pytest.raises(OSError):
        report_page.work(report_page.plan(made_of([study.Task("a", 1, fails)], name="other"), HEAD), HEAD)
    assert capsys.readouterr().err == "[1/1, 1 s left] other: a … failed\n"


def test_pieces_by_a_farm(made_of, tmp_path, monkeypatch, capsys):
    """What it is handed, and what is said where pieces fail, none were taken, or it was broken off."""
    monkeypatch.setattr(report_page.time, "sleep", lambda _seconds: None)
    tasks = [study.Task(key, 1, lambda _folder, _say: [{"n": 1}]) for key in ("a", "b")]
    asked = []

    def farm(options, status=0, wrong=(), submitted=True, finished=True):
        def run(command):
            folder = Path(command[command.index("-o") + 1])
            asked.append((command, folder))
            (folder / "results").mkdir(parents=True)
            if submitted:
                (folder / "job.json").touch()
            if submitted and finished:
                (folder / "finished.json").write_text(report_page.json.dumps({"wrong": list(wrong)}))
            return SimpleNamespace(returncode=status)
        monkeypatch.setattr(report_page.subprocess, "run", run)
        report_page.farm(options, report_page.plan(options, HEAD))
    options = made_of(tasks)
    pieces = report_page.plan(options, HEAD)
    farm(options, 1)
    command, folder = asked[0]
    root = report_page.programs.ROOT
    assert command == ["/usr/bin/python3", f"{root}/farm", "submit", f"{tmp_path}/report-1.items", "-o", f"{tmp_path}/farm.1", "--engine", "slurm"]
    said = report_page.json.loads((tmp_path / "report-1.items").read_text())
    words = [sys.executable, str(root / "compare/report_page.py"), "--output", str(tmp_path)]
    assert said == {"folder": str(root), "inputs": [], "items": [{"name": f"atlas: {key}", "words": [*words, "--piece", f"atlas/{key}", "--stamp", piece[3]]}
                                                               for key, piece in zip("ab", pieces)]}
    assert re.fullmatch(r"2 pieces by slurm … \d+\.\d s\n", capsys.readouterr().err)
    report_page.do(*pieces[0][:4], HEAD, None)
    options.quick = True
    (tmp_path / "farm.x").mkdir()
    with pytest.raises(ValueError) as failed:
        farm(options, wrong=["atlas: b: exit status 1"])
    assert str(failed.value).splitlines() == [f"pieces failed; go on with: /usr/bin/python3 {root}/farm resume {tmp_path}/farm.2", "  atlas: b: exit status 1"]
    assert "… failed" in capsys.readouterr().err and [item["words"][2] for item in report_page.json.loads((tmp_path / "report-2.items").read_text())["items"]] == ["--quick"] * 2
    options.quick = False
    with pytest.raises(ValueError, match="the pieces were not submitted"):
        farm(options, submitted=False)
    assert len(report_page.json.loads((tmp_path / "report-3.items").read_text())["items"]) == 1  # the other is there
    reads = []

    def wait(_seconds):
        folder = asked[-1][1]
        if (folder / "finished.json").exists():
            reads.append("too long")
        elif reads:
            (folder / "results" / "one").touch()
            (folder / "finished.json").write_text('{"wrong": []}')
    monkeypatch.setattr(report_page.time, "sleep", wait)
    monkeypatch.setattr(report_page.report.Progress, "read", lambda _live, text: reads.append(text))
    farm(options, finished=False)
    assert reads == ["0 %", "100 %"]
    with pytest.raises(KeyboardInterrupt):
        farm(options, 130)
    asked.clear()
    farm(made_of(tasks, name="speed"))  # it measures times
    report_page.do(*pieces[1][:4], HEAD, None)
    farm(options)
    assert asked == []


def test_what_the_report_says_and_writes(made_of, tmp_path, monkeypatch, capsys):
    """Its plan, the page and those of studies apart, tables of results where they are asked for."""
    options = made_of([study.Task("a", 100, lambda _folder, say: say("half") or [{"n": 1}])], [study.Finding("So.", True), study.Finding("Late.", False, timed=True)])
    options.quick, kept = True, []
    monkeypatch.setattr(report_page, "arguments", lambda _argv: options)
    monkeypatch.setattr(report_page.results, "surroundings", lambda command: {**HEAD, "command": command})
    monkeypatch.setattr(report_page.results, "write_tables", lambda name, _tables, head: kept.append((name, head["command"])))
    monkeypatch.setattr(report_page, "farm", lambda of, pieces: kept.append(("farm", of.engine, len(pieces))))
    options.engine, options.plan = None, True
    assert report_page.main() == 0 and capsys.readouterr().out == "1 pieces; about 2 min on two idle cores\n" and not (tmp_path / "report.html").exists()
    options.plan, options.piece = False, "atlas/b"
    with pytest.raises(ValueError, match="--piece atlas/b: no such piece"):
        report_page.main()
    options.piece, options.stamp = "atlas/a", "a stamp"
    assert report_page.main() == 0 and capsys.readouterr().out == "half\n" and report_page.read_rows(tmp_path / "data/atlas/a.csv")[1]["stamp"] == "a stamp"
    options.piece = None
    assert report_page.main() == 0
    said = capsys.readouterr()
    assert said.out.splitlines() == ["1 pieces; about 2 min on two idle cores", f"The report: {tmp_path}/report.html"] and kept == []
    assert said.err.splitlines()[1:] == ["One sentence about times is left out: this run was too noisy to tell."]
    pages = [(tmp_path / f"{name}.html").read_text(encoding="utf-8") for name in ("report", "atlas")]
    assert all("<code>make compare-quick</code>" in text for text in pages) and ["quick report</p>" in text for text in pages] == [True, False]
    options.quick, options.results, options.engine, options.again = False, True, "slurm", True
    with pytest.raises(ValueError, match='does not hold for data/atlas.csv: "Late."'):
        report_page.main()
    assert kept == [("farm", "slurm", 1)] and options.again is False
    options.studies["atlas"].findings = lambda _rows: [study.Finding("So.", True)]
    assert report_page.main() == 0 and kept[1:] == [("farm", "slurm", 1), ("atlas", "make compare")]
    monkeypatch.setattr(report_page.programs, "SHADE", str(tmp_path / "none"))
    with pytest.raises(ValueError, match="none: no such file; run make"):
        report_page.main()
