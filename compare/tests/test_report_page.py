# SPDX-License-Identifier: Apache-2.0
"""The report: the quick one is made once and driven in a browser; the runner with small studies of its own."""
import csv
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import page
import programs
import pytest
import report_page
import sheet
import study
import study_consistency
import study_frames
import style
import whole
from chromium import Page

COST = 108
TOGETHER = "report"

COMPARE = Path(report_page.__file__).parent
RUN = [sys.executable, str(COMPARE / "report_page.py")]


# ---- the quick report -------------------------------------------------------------------------


@pytest.fixture(scope="module")
def quick(report_folder):
    folder = report_folder
    done = subprocess.run([*RUN, "--quick", "--output", folder], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert re.match(r"\d+ pieces; about .* on two idle cores\n", done.stdout)
    return folder


@pytest.fixture(scope="module")
def browser(quick, tmp_path_factory):
    with Page(quick / "report.html", tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def column(browser, table, number):
    return browser.run(f"Array.from(document.querySelectorAll('#{table} tbody tr'), (row) => "
                       f"row.cells[{number}].dataset.value ?? row.cells[{number}].textContent)")


@pytest.mark.parametrize("name", ["report", "atlas"])
def test_page_is_whole(quick, name):
    text = (quick / f"{name}.html").read_text(encoding="utf-8")
    assert not re.search(r"(?:src|href)=\"(?:https?:|//|/)", text) and "@import" not in text
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'href="#([^"]+)"', text)) <= set(ids)
    for name in re.findall(r'href="(data/[^"]+)"', text):
        head = report_page.read_rows(quick / name)[1]
        assert {"machine", "compiler", "commit", "command"} <= set(head) and all(head.values())
    figures = re.findall(r'<figure.*?</figure>', text, re.S)
    assert figures and all(re.search(r'role="img" aria-label="[^"]{40,}"', f) for f in figures)
    assert not re.search(r"\bnan\b|\binf\b", text)  # as Python writes them; sentences speak of NaN
    # lines take the page's colours, but for the rims of letters that lie on a map
    assert not re.search(r"(?<!paint-order: stroke; stroke: )#[0-9a-fA-F]{6}; stroke", text)


def test_the_report_answers_first(quick):
    """A line for each question, then the chart, in few words; each answer leads to its section."""
    text = (quick / "report.html").read_text(encoding="utf-8")
    first, rest = text.split("<main>")[1].split("</section>", 1)
    table = first.split("</table>")[0]
    assert first.strip().startswith('<section id="answers">') and first.count("<figure") == 1 and 'id="speed-choice"' in first
    assert re.findall(r"<td data-head=\"use\"><a href=\"#(\w+)\">", table) == [
        name for name, of in (("speed", 3), ("precision", 2), ("horizons", 2), ("diffuse", 2), ("lobes", 2), ("cloth", 2)) for _ in range(of)]
    assert len(re.findall(r"\d+ % off|·10", table)) > 4 and 'href="atlas.html"' in rest and re.search(r"Of \d+ regions that fail \d+ concern defaults", rest)
    assert 2000 < page.words(text) <= page.MOST


def test_a_report_of_too_many_words_is_not_written():
    section = page.Section("s", "t", "word " * page.MOST, [], [], [], {}, 0)
    with pytest.raises(ValueError, match="words before its appendix"):
        page.html([section], {"command": "make"}, False)


def test_a_table_is_sorted_by_mouse_and_by_key(browser):
    table, heads = "speed-errors", "document.querySelectorAll('#speed-errors th button')"
    before = column(browser, table, 3)
    browser.run(f"{heads}[3].click()")
    up = column(browser, table, 3)
    assert up == sorted(before, key=float) and up != before
    told = lambda: (browser.run("document.getElementById('said').textContent"), browser.run(f"getComputedStyle({heads}[3].firstElementChild, '::after').content"))
    assert told() == ("Sorted by 20°, smallest first", '"↑"')
    browser.run(f"{heads}[3].focus()")
    browser.key("Enter", 13, "\r")
    assert column(browser, table, 3) == sorted(before, key=float, reverse=True)
    assert browser.run(f"{heads}[3].parentElement.getAttribute('aria-sort')") == "descending"
    assert told() == ("Sorted by 20°, largest first", '"↓"')
    browser.key("Tab", 9)
    browser.key(" ", 32, " ")
    assert browser.run(f"{heads}[4].parentElement.getAttribute('aria-sort')") == "ascending"
    browser.run(f"{heads}[1].click()")
    names = column(browser, table, 1)
    assert names == sorted(names, key=str.casefold)
    assert browser.run("document.querySelectorAll('th[aria-sort]').length") == 1
    for sign in (1, -1):  # numbers, then texts, then what is empty, which a click does not bring to the top
        assert browser.run(f"[null, 'b', 3, 'a', null, 20].sort((a, b) => compare(a, b, {sign}))") == [[3, 20, "a", "b"], [20, 3, "b", "a"]][sign < 0] + [None] * 2
    words = """(() => {
      const made = document.createElement("table");
      made.innerHTML = "<thead><tr><th>n</th></tr></thead><tbody>" + ["10 lobes", "", "one", "2 lobes"].map((word) => `<tr><td>${word}</td></tr>`).join("") + "</tbody>";
      document.body.append(made);
      const seen = [0, 1].map(() => (sortBy(made.rows[0].cells[0]), Array.from(made.tBodies[0].rows, (row) => row.textContent)));
      made.remove();
      return seen;
    })()"""
    assert browser.run(words) == [["2 lobes", "10 lobes", "one", ""], ["one", "10 lobes", "2 lobes", ""]]


def styled(opened, *asked):
    """Of the first of each selector, one of its properties, before or after it where there is a third word."""
    return [opened.run(f"getComputedStyle(document.querySelector({one[0]!r}), {one[2] if len(one) > 2 else ''!r}).getPropertyValue({one[1]!r})") for one in asked]


def test_links_lead_somewhere_and_nothing_complains(browser):
    browser.run("document.querySelector('.findings li a').click()")
    target = browser.run("location.hash")
    browser.until(f"Math.abs(document.querySelector('{target}').getBoundingClientRect().top) < innerHeight")
    assert browser.run("document.querySelector(':target') !== null")
    section = browser.run("document.querySelector(':target').closest('main > section').id")
    browser.until(f"document.querySelector('nav a[aria-current]')?.hash === '#{section}'")
    assert browser.run("document.querySelectorAll('nav a[aria-current]').length") == 1
    accent, *seen = styled(browser, ("main a", "color"), (f"{target} h3", "color"), ("nav a[aria-current]", "color"), ("td.number", "text-align"), ("th.number", "text-align"), ("nav", "position"))
    assert seen == [accent, accent, "right", "right", "sticky"]
    browser.run("document.querySelector('.skip').focus()")
    assert browser.run("document.querySelector('.skip').getBoundingClientRect().left") > 0 > browser.run("document.querySelector('#said').getBoundingClientRect().right")
    browser.run("window.dispatchEvent(new Event('beforeprint'))")
    assert browser.run("document.querySelectorAll('details').length") > 5 and browser.run("document.querySelectorAll('details:not([open])').length") == 0
    assert browser.said == []


# What cannot be read in figures: words below 11 px (less a hair), words cut off by their drawing's rim or lying on each
# other, and words or lines too near their ground's brightness: [[figure, what, which]]. Words and outlines on a map have a rim of their own.
HARD_TO_READ = """(() => {
  const wrong = [], channel = (v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  const light = (c) => { const v = c.match(/[\\d.]+/g).map(Number).slice(0, 3).map((x) => channel(x / 255));
                         return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]; };
  const contrast = (a, b) => { const [x, y] = [light(a), light(b)]; return (Math.max(x, y) + 0.05) / (Math.min(x, y) + 0.05); };
  const ground = getComputedStyle(document.body).backgroundColor, probe = document.createElement("i");
  probe.style.color = "var(--faint)";
  document.body.append(probe);
  const faint = getComputedStyle(probe).color;
  probe.remove();
  for (const svg of document.querySelectorAll("main figure svg")) {
    const name = svg.closest("figure").id, box = svg.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
    const boxes = [];
    for (const text of svg.querySelectorAll("text")) {
      const style = getComputedStyle(text), at = text.getBoundingClientRect(), words = text.textContent;
      const rimmed = style.paintOrder.startsWith("stroke"), size = scale * parseFloat(style.fontSize);
      if (size < 10.9) wrong.push([name, "small", size + " " + words]);
      if (at.left < box.left - 2 || at.right > box.right + 2 || at.top < box.top - 2 || at.bottom > box.bottom + 2)
        wrong.push([name, "cut off", words]);
      if (contrast(style.fill, rimmed ? style.stroke : ground) < 4.5) wrong.push([name, "pale", style.fill + " " + words]);
      if (!rimmed)
        for (const [other, said] of boxes) {
          const wide = Math.min(at.right, other.right) - Math.max(at.left, other.left);
          const high = Math.min(at.bottom, other.bottom) - Math.max(at.top, other.top);
          if (wide > 2 && high > 0.45 * Math.min(at.height, other.height)) wrong.push([name, "one on another", words + " / " + said]);
        }
      if (!rimmed) boxes.push([at, words]);
    }
    for (const line of svg.querySelectorAll("path, line, use")) {
      const style = getComputedStyle(line), stroke = style.stroke;
      if (!stroke.startsWith("rgb") || stroke === faint || line.closest("clipPath, defs, .on-map")) continue;
      if (contrast(stroke, ground) < 3) wrong.push([name, "pale line", stroke]);
    }
  }
  return wrong;
})()"""


def wide_parts(phone):
    """Where the page itself, or a table or figure, is wider than its place on the screen."""
    return phone.run("""[document.documentElement.scrollWidth > innerWidth ? ["page", document.documentElement.scrollWidth] : null,
      ...Array.from(document.querySelectorAll(".panels, .scroll"), (box) => box.getBoundingClientRect().right > innerWidth + 1
        || box.scrollWidth > box.clientWidth + 1 ? [box.parentElement.id, box.scrollWidth]
        : null)].filter((wrong) => wrong)""")


@pytest.fixture(scope="module")
def newer(tmp_path_factory):
    """A page of figures that the quick report does not have, from rows that are made up: frames, thumbnails of all lengths."""
    folder = tmp_path_factory.mktemp("newer")
    black = np.zeros((120, 120, 3), np.uint8)
    frames, known = [], report_page.known()
    for shape, light in study_frames.SCENES:
        tiles = [("displaced: the truth", black)]
        for number, (engine, error) in enumerate({"libshade": 0.01, "gram_schmidt": 0.03, "perturb": 0.05, "cycles": 0.1,
                                                  "cycles_5": 0.098, "mitsuba": 0.102, "povray": 0.0101}.items()):
            if engine == "povray" and light == "sky":
                continue
            frames += [{"kind": "frame", "shape": shape, "light": light, "engine": engine, "samples": samples, "run": run,
                        "seconds": 0.1 * (number + 1) * samples * (1 + run / 20), "error": error * (1 + 2 / samples),
                        "noise": 0.001, "version": "1"} for samples in study_frames.SAMPLES[light] for run in range(3)]
            tiles.append((style.of(engine).label, black, "error {}", error))
        frames += sheet.tiles(folder, f"{shape}-{light}", tiles)
    noisy = np.random.default_rng(3).random((50, 90, 3))
    worst = [row for scene, variant in (("povray/lampshade", "in both"), ("scratched_sphere", "as it is"), ("suzanne", "ggx_approximate"))
             for row in study_consistency.worst_tiles(folder, scene, variant, [noisy, noisy[::-1]])]
    sections = [page.Section(name, known[name].TITLE, known[name].INTRO, [], known[name].figures(rows), known[name].tables(rows),
                             {}, len(rows)) for name, rows in (("frames", frames), ("consistency", worst))]
    whole.write_text(folder / "report.html", page.html(sections, {"command": "make compare"}, False))
    return folder


@pytest.mark.parametrize("which,name", [("quick", "report"), ("quick", "atlas"), ("newer", "report")])
@pytest.mark.parametrize("dark", [False, True])
def test_pages_can_be_read(request, tmp_path, which, name, dark):
    with Page(request.getfixturevalue(which) / f"{name}.html", tmp_path, width=390, height=800, dark=dark) as phone:
        assert phone.run("document.querySelector('nav details').open") is False
        ground, ink = (np.array([int(v) for v in re.findall(r"\d+", phone.run(
            f"getComputedStyle(document.body).{what}"))[:3]]) / 255 for what in ("backgroundColor", "color"))
        light = [((c / 12.92 * (c <= .04045) + ((c + .055) / 1.055) ** 2.4 * (c > .04045))
                  @ [.2126, .7152, .0722]) for c in (ground, ink)]
        assert (light[0] < light[1]) == dark and (max(light) + .05) / (min(light) + .05) > 7
        assert wide_parts(phone) == []
        assert phone.run("document.querySelectorAll('main figure svg').length") > 6
        assert phone.run(HARD_TO_READ) == []
        if which == "quick":
            shown = phone.run("Array.from(document.querySelectorAll('td'), (cell) => [cell.textContent === '', getComputedStyle(cell).display === 'none', "
                              "cell.cellIndex && cell.textContent && !getComputedStyle(cell, '::before').content.startsWith(JSON.stringify(cell.dataset.head).slice(0, -1))])")
            assert name != "report" or styled(phone, (".answers td", "content", "::before"), (".answers thead", "display")) == ['"If your surface "', "none"]
            assert any(empty for empty, *_ in shown) and all(empty == hidden and not bare for empty, hidden, bare in shown)
        phone.size(900, 900)
        assert phone.run("fold(), document.querySelector('nav details').open") is False  # the text has all of the width
        phone.size(1280, 900)
        phone.until("document.querySelector('nav details').open")
        assert wide_parts(phone) == [] and phone.run(HARD_TO_READ) == []
        assert phone.said == []


@pytest.mark.parametrize("which,name", [("quick", "report"), ("quick", "atlas"), ("newer", "report")])
def test_paper(request, tmp_path, which, name):
    """A4 less its margins: nothing beyond its edge, or all is printed smaller; words of drawings of 9 px or more."""
    with Page(request.getfixturevalue(which) / f"{name}.html", tmp_path, width=718, height=1000) as sheets:
        sheets.call("Emulation.setEmulatedMedia", media="print", features=[])
        wide = sheets.run("Array.from(document.querySelectorAll('main svg, table'), (part) => "
                          "[part.parentElement.parentElement.id, part.getBoundingClientRect().right]).filter((at) => at[1] > 718)")
        assert styled(sheets, ("nav", "display"), (".skip", "display")) == ["none"] * 2
        assert wide == [] and sheets.run("document.documentElement.scrollWidth") <= 718
        assert sheets.run("""Math.min(...Array.from(document.querySelectorAll("main svg text"), (text) =>
          parseFloat(getComputedStyle(text).fontSize) * text.ownerSVGElement.getBoundingClientRect().width
          / text.ownerSVGElement.viewBox.baseVal.width))""") > 9


def test_what_only_draws_makes_no_rows_old():
    """What a study measures with is part of its rows' stamp, what it draws them with is not."""
    for name, measures, draws in (("atlas", "atlas_measures", "atlas_charts"), ("speed", "fronts", "detail_speed_page")):
        names = {path.stem for path in report_page.sources(COMPARE / f"study_{name}.py")}
        assert f"study_{name}" in names and measures in names and not names & {draws, "style", "page", "answers", "study", "report", "results", "report_page"}


def three(tmp_path, monkeypatch):
    """Options and a head for a study of three tasks, and the files that it depends on."""
    code, need, *built = files = [tmp_path / name for name in ("study_three.py", "program", "libshade.so.1", "shade")]
    for file in files:
        file.write_text("a = 1\n", encoding="utf-8")
    monkeypatch.setattr(programs, "BUILD", tmp_path)
    monkeypatch.setattr(programs, "SHADE", str(built[-1]))
    module = SimpleNamespace(NAME="three", __file__=str(code), tasks=lambda quick: [
        study.Task(f"task-{k}", 100 * k, lambda folder, say: [{"n": 1}], needs=[need]) for k in (1, 2, 3)])
    options = SimpleNamespace(studies={"three": module}, output=tmp_path / "out", quick=False, again=False)
    return options, {"machine": "one, 2 cores", "command": "make compare"}, files


def test_what_makes_rows_old(tmp_path, monkeypatch):
    options, head, files = three(tmp_path, monkeypatch)
    report_page.work(report_page.plan(options, head), head)

    def done(at=head, **changes):
        return [piece[-1] for piece in report_page.plan(SimpleNamespace(**{**vars(options), **changes}), at)]
    assert done() == [True] * 3
    for old in (done({**head, "machine": "another, 2 cores"}), done(quick=True), done(again=True)):
        assert old == [False] * 3
    assert done({**head, "commit": "another", "date": "later"}) == [True] * 3
    for file in files:
        was = file.read_bytes()
        file.write_bytes(was + b"#")
        assert done() == [False] * 3
        file.write_bytes(was)
    assert done() == [True] * 3


def test_a_farm_does_what_is_missing(tmp_path):
    """A process of its own makes the rows that this one makes, under the stamp by which they are found again."""
    options = report_page.arguments(["--quick", "--only", "truth", "--engine", "local", "--output", str(tmp_path)])
    head = report_page.results.surroundings("")
    one, = (piece for piece in report_page.plan(options, head) if piece[1].key == "fibres")
    report_page.farm(options, [one])
    again, = (piece for piece in report_page.plan(options, head) if piece[1].key == "fibres")
    assert again[-1] and report_page.read_rows(again[2])[0] == [
        {key: report_page.plain(value, "") for key, value in row.items()} for row in one[1].run(tmp_path, print)]
    report_page.farm(options, [again])
    assert [path.name for path in tmp_path.glob("farm.*")] == ["farm.1"]


def test_the_time_left_falls(tmp_path, monkeypatch, capsys):
    options, head, _files = three(tmp_path, monkeypatch)
    pieces = report_page.plan(options, head)
    report_page.say_plan(pieces)
    report_page.work(pieces, head)
    said = capsys.readouterr()
    assert said.out == "3 pieces; about 10 min on two idle cores\n"
    assert re.findall(r"\[(.*?) left\] three: (\S+)", said.err) == [
        ("1/3, 10 min", "task-1"), ("2/3, 8 min", "task-2"), ("3/3, 5 min", "task-3")]
    pieces = report_page.plan(options, head)
    report_page.say_plan([(*pieces[0][:-1], False), *pieces[1:]])
    report_page.say_plan(pieces)
    assert capsys.readouterr().out == ("3 pieces, 2 of them done before; about 2 min on two idle cores\n"
                                       "3 pieces, all of them done before\n")


@pytest.mark.parametrize("seconds, words", [(0, "1 s"), (89, "89 s"), (90, "2 min"), (5399, "90 min"), (5400, "1.5 h")])
def test_durations(seconds, words):
    assert report_page.duration(seconds) == words


def test_a_second_run_does_nothing_again(quick):
    """No piece's stamp has changed; that such a piece is not done again is asked of a study that waits."""
    done = subprocess.run([*RUN, "--quick", "--plan", "--output", quick], capture_output=True, text=True)
    assert done.returncode == 0 and "all of them done before" in done.stdout


# ---- findings fall with their rows ---------------------------------------------------------------


def worse(rows, **wanted):
    """The rows, with errors of some a hundred times as large; at most 0.9 of nothing stays small."""
    return [{**row, **{k: 100 * row[k] + 0.9 for k in row if k.startswith("error")}}
            if all(row.get(k) == v for k, v in wanted.items()) else row for row in rows]


def slower(rows, times, **wanted):
    return [{**row, "ns": times * row["ns"]}
            if "ns" in row and all(row.get(k) == v for k, v in wanted.items()) else row for row in rows]


ALTERED = {  # study: how rows are altered, and a word of the sentence that falls
    "speed": [(lambda r: worse(r, method="rotate"), "exactly"),
              (lambda r: slower(r, 3, method="rotate"), "Being exact"),
              (lambda r: worse(r, method="gram_schmidt", tilt=10), "Gram-Schmidt, which"),
              (lambda r: slower(r, 9, method="rotate"), "Deformation"),
              (lambda r: worse(r, method="rotate_approximate", distribution="ashikhmin_shirley"), "worth little"),
              (lambda r: slower(r, 0.05, method="rotate_plain"), "In plain C"),
              (lambda r: worse(r, method="rotate", tilt=45), "front"),
              (lambda r: worse(r, method="perturb", tilt=30), "ranks")],
    "precision": [(lambda r: worse(r, precision="float"), "Use float"),
                  (lambda r: worse(r, precision="reference"), "reference that")],
    "horizons": [(lambda r: worse(r, method="valid_estevez"), "Over all"),
                 (lambda r: slower(r, 0.1, method="schuessler"), "grazes")],
    "diffuse": [(lambda r: worse(r, method="fibre_view"), "Nearest"),
                (lambda r: worse(r, method="fibre"), "maximum normal")],
    "lobes": [(lambda r: worse(r, lobes=6), "Six lobes"), (lambda r: worse(r, lobes=6), "GGX needs")],
    "cloth": [(lambda r: worse(r, method="far"), "far form"), (lambda r: worse(r, method="far"), "One lobe")],
}


@pytest.mark.parametrize("name,number", [(name, k) for name, cases in ALTERED.items() for k in range(len(cases))])
def test_altered_rows_falsify(quick, name, number):
    module = report_page.known()[name]
    rows = report_page.read_rows(quick / "data" / f"{name}.csv")[0]
    alter, words = ALTERED[name][number]
    told = [finding for finding in module.findings(rows) if words in finding.text]
    after = [finding for finding in module.findings(alter(rows)) if words in finding.text]
    assert len(told) == len(after) == 1 and (told[0].holds or told[0].timed) and not after[0].holds


def test_every_finding_has_a_row_that_falsifies_it(quick):
    for name, cases in ALTERED.items():
        rows = report_page.read_rows(quick / "data" / f"{name}.csv")[0]
        texts = [finding.text for finding in report_page.known()[name].findings(rows)]
        assert all(any(words in text for _alter, words in cases) for text in texts), name


def test_noise_leaves_sentences_out_of_the_quick_page_alone():
    findings = [study.Finding("a", True), study.Finding("b", False, timed=True), study.Finding("c", False)]
    assert report_page.sift(findings, True) == ([findings[0], findings[2]], 1)
    assert report_page.sift(findings, False) == (findings, 0)
    section = page.Section("s", "t", "", findings[:1], [], [], {}, 0, 1)
    assert "One sentence about times is left out" in page.html([section], {"command": "make"}, True)


def test_altered_csv_stops_the_page(quick, tmp_path):
    """A piece's rows altered by hand: no page, the sentence is named, the old page stays."""
    subprocess.run(["cp", "-r", f"{quick}/.", tmp_path], check=True)
    path = tmp_path / "data" / "speed" / "error-ashikhmin_shirley-30.csv"
    rows, head = report_page.read_rows(path)
    report_page.write_rows(path, worse(rows, method="rotate"), head)
    old = (tmp_path / "report.html").read_bytes()
    done = subprocess.run([*RUN, "--quick", "--only", "speed", "--output", tmp_path], capture_output=True, text=True)
    assert done.returncode == 1 and "findings do not hold" in done.stderr
    assert "follows the displaced surface exactly" in done.stderr and "data/speed.csv" in done.stderr
    assert (tmp_path / "report.html").read_bytes() == old


# ---- the runner, by a study that waits -------------------------------------------------------------

WAITING = '''
import time
from study import Figure, Finding, Table, Task
NAME, TITLE, INTRO = "waiting", "A study <that> waits", "It waits & counts."
def piece(number):
    def run(folder, say):
        with open(folder / "started", "w") as file:
            file.write("x")
        time.sleep(60 if number == 2 and not (folder.parent / "go").exists() else 0)
        return [{"number": number, "half": number / 2, "word": "a, \\"b\\""}, {"number": 10}]
    return run
def tasks(quick):
    return [Task(f"piece-{n}", 1, piece(n), "sleep 60") for n in range(4)]
def findings(rows):
    return [Finding("All four were counted.", len(rows) == 8, "t")]
def figures(rows):
    return []
def tables(rows):
    return [Table("t", "Numbers", "", ["number", "half"], [[r["number"], r.get("half")] for r in rows])]
'''


@pytest.fixture
def waiting(tmp_path):
    """The runner's script on the study above alone."""
    here = tmp_path / "studies"
    here.mkdir()
    (here / "study_waiting.py").write_text(WAITING, encoding="utf-8")
    script = here / "run.py"
    script.write_text(f"import sys\nsys.path[:0] = [{str(here)!r}, {str(COMPARE)!r}]\nimport programs\n"
                      f"import report_page\nfrom pathlib import Path\nprograms.HERE = Path({str(here)!r})\n"
                      "import report\nreport.run(report_page.main)\n", encoding="utf-8")
    return [sys.executable, str(script), "--output", str(tmp_path / "out")], tmp_path / "out"


def test_interrupted_and_resumed(waiting):
    command, out = waiting
    process = subprocess.Popen(  # a run in the background ignores Ctrl-C, and would hand that on
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    started = out / "data" / "waiting" / "piece-2" / "started"
    end = time.monotonic() + 60
    while not started.exists() and time.monotonic() < end:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _said, wrong = process.communicate(timeout=60)
    assert process.returncode == 130 and "interrupted" in wrong and "Traceback" not in wrong
    kept = sorted(path.name for path in (out / "data" / "waiting").glob("*.csv"))
    assert kept == ["piece-0.csv", "piece-1.csv"] and not (out / "report.html").exists()
    assert not [path for path in out.rglob("*") if path.name.startswith(".")]
    (out / "data" / "waiting" / "go").touch()
    before = (out / "data" / "waiting" / "piece-0.csv").stat().st_mtime_ns
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "4 pieces, 2 of them done before" in done.stdout and "piece-0" not in done.stderr
    assert (out / "data" / "waiting" / "piece-0.csv").stat().st_mtime_ns == before
    text = (out / "report.html").read_text(encoding="utf-8")
    assert "A study &lt;that&gt; waits" in text and "It waits &amp; counts." in text
    with open(out / "data" / "waiting.csv", newline="", encoding="utf-8") as file:
        lines = list(csv.reader(line for line in file if not line.startswith("#")))
    assert lines[0] == ["number", "half", "word"] and len(lines) == 9 and lines[1] == ["0", "0.0", 'a, "b"']
    (out / "data" / "waiting" / "piece-1.csv").write_text("# stamp: old\nnumber\n", encoding="utf-8")
    done = subprocess.run(command, capture_output=True, text=True)
    assert "4 pieces, 3 of them done before" in done.stdout


def test_rows_come_back(tmp_path):
    rows = [{"a": 0.1, "b": "x,\n\"y\"", "c": 3}, {"a": np.float64(1e-300), "c": np.int64(-2), "d": "1e5x"}]
    report_page.write_rows(tmp_path / "r.csv", rows, {"command": "make: it"})
    back, head = report_page.read_rows(tmp_path / "r.csv")
    assert back == [{"a": 0.1, "b": "x,\n\"y\"", "c": 3}, {"a": 1e-300, "c": -2, "d": "1e5x"}]
    assert head == {"command": "make: it"} and os.listdir(tmp_path) == ["r.csv"]
    for wrong in (float("nan"), float("inf"), None):
        with pytest.raises(ValueError, match="column a"):
            report_page.write_rows(tmp_path / "r.csv", [{"a": wrong}], {})


def test_what_cannot_stand_on_a_page():
    def section(**parts):
        return page.Section(**{"name": "s", "title": "t", "intro": "", "findings": [], "figures": [], "tables": [],
                               "commands": {}, "count": 0, **parts})
    table = study.Table("a", "t", "c", ["x", "y"], [[1]])
    figure = study.Figure("a", "t", "c", "<svg></svg>", "alt")
    for bad, word in ((section(tables=[table]), "a row of 1"), (section(figures=[figure, figure]), "two parts"),
                      (section(findings=[study.Finding("so", True, "b")]), "no figure or table")):
        with pytest.raises(ValueError, match=word):
            page.html([bad], {"command": "make"}, False)


def test_numbers_as_shown():
    assert [style.number(v) for v in (0.0, 0.12345, 12.345, 1234.5, 1.5e-7, 0.0012345)] == [
        "0", "0.123", "12.3", "1234", "1.5·10⁻⁷", "0.00123"]
    assert [style.power(v) for v in (1e-6, 0.05, 2e-8, 300, 0)] == ["10⁻⁶", "0.05", "2·10⁻⁸", "300", "0"]
