# SPDX-License-Identifier: Apache-2.0
"""The committed results: each with its origin, on a page of the manual; README.md's table is what they give."""
import csv
import re
from types import SimpleNamespace

import pytest
import results

COST = 0.3

NAMES = sorted(path.stem for path in results.FOLDER.glob("*.txt"))
PAGES = "".join(path.read_text(encoding="utf-8") for path in results.FOLDER.glob("*.md"))


def test_the_first_page_has_what_the_results_give():
    assert results.between()[1] == results.readme()
    assert len(results.readme().splitlines()) == 2 + 6


@pytest.mark.parametrize("name", NAMES)
def test_a_table_says_where_it_is_from_and_stands_on_one_page(name):
    head, rows = results.read(name)
    assert set(head) == set(results.HEAD) and all(head.values())
    assert rows and all(len(row) == len(rows[0]) for row in rows)
    assert PAGES.count(f"```{{include}} {name}.txt\n") == 1


def test_what_is_kept_is_committed():
    assert {*results.KEPT, "bench", "bumps", "files", "horizons", "materials", "displaced-waves", "displaced-sky", "paths", "plate-time"} == set(NAMES)


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """Results and first page of a copy, which may be written."""
    monkeypatch.setattr(results, "README", tmp_path / "README.md")
    (tmp_path / "README.md").write_text(f"before\n{results.BEGIN}\n\nold\n\n{results.END}\nafter\n", encoding="utf-8")
    for name in NAMES:
        (tmp_path / f"{name}.txt").write_bytes((results.FOLDER / f"{name}.txt").read_bytes())
    monkeypatch.setattr(results, "FOLDER", tmp_path)
    return tmp_path


def test_what_is_written_comes_back_and_reaches_the_first_page(elsewhere):
    head = dict(zip(results.HEAD, ("today", "a | b", "cc", "1234", "make it")))
    rows = [[name, error, None] for name, error in (("rotate", 0.25), (results.CYCLES, 0.5), ("a | b", 1e-7))]
    results.write("displaced-waves", head, ["method", "error", "limit"], rows)
    back, read = results.read("displaced-waves")
    assert back == head and [list(row.values()) for row in read] == [
        ["rotate", "0.250", ""], [results.CYCLES, "0.500", ""], ["a \\| b", "1.0·10⁻⁷", ""]]
    said = (elsewhere / "README.md").read_text(encoding="utf-8")
    assert said.startswith(f"before\n{results.BEGIN}\n\n| what |") and said.endswith(f"|\n\n{results.END}\nafter\n")
    assert "libshade 25.0 % off, Cycles' normal map 50.0 %" in said


def test_what_bench_left_becomes_a_table(elsewhere, tmp_path):
    columns = "what method distribution precision isa set ns ratio_perturb ratio_stream max_error".split()
    rows = [("D", "rotate", "ward", "float", "avx2", "cache", 1.5, 1, 2, 1e-6), ("D", "rotate", "ggx", "float", "avx2", "cache", 2, 1, 2, 3e-6),
            ("D", "rotate", "ggx", "float", "avx2", "memory", 9, 1, 2, 3e-6), ("f", "rotate", "ggx", "float", "avx2", "cache", 4, 1, 2, "")]
    with open(tmp_path / "bench.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([columns, *rows])
    results.bench(tmp_path / "bench.csv")
    _head, read = results.read("bench")
    assert read == [{"what": "`D`", "method": "`rotate`", "precision": "float", "ward, ns": "1.50", "ggx, ns": "2.00", "worst error": "3.0·10⁻⁶"},
                    {"what": "`f`", "method": "`rotate`", "precision": "float", "ward, ns": "", "ggx, ns": "4.00", "worst error": ""}]


def test_surroundings_leave_the_results_themselves_out():
    said = results.surroundings("make it")
    assert set(said) == set(results.HEAD) and said["command"] == "make it" and re.search(r"\d+ cores", said["machine"])


def test_where_and_when(monkeypatch):
    """Of a machine, a compiler and a tree that are known; what cannot be told is left out, or unknown."""
    said = {"git rev-parse": "abc123abc123\n", "git status": "", "gcc-99 --version": "gcc 99\nmore\n", f"{results.programs.SHADE} --version": "shade 9 (avx2)\n"}
    monkeypatch.setenv("CC", "gcc-99")

    def run(command, **_options):
        found = next((text for words, text in said.items() if " ".join(command).startswith(words)), None)
        if found is None:
            raise FileNotFoundError
        return SimpleNamespace(returncode=0, stdout=found)
    monkeypatch.setattr(results.subprocess, "run", run)
    monkeypatch.setattr(results.os, "cpu_count", lambda: 3)
    cpuinfo = "processor: 0\ncpu family\t: 6\nmodel\t\t: 106\nmodel name\t: Some CPU @ 2 GHz\n"
    monkeypatch.setattr(results, "Path", lambda _path: SimpleNamespace(exists=lambda: True, read_text=lambda **_options: cpuinfo))
    found = results.surroundings("make it")
    assert (found["machine"], found["compiler"], found["commit"]) == ("Some CPU @ 2 GHz, family 6 model 106, 3 cores, avx2", "gcc 99", "abc123abc123")
    assert re.fullmatch(r"20\d\d-\d\d-\d\d \d\d:\d\d UTC", found["date"])
    said["git status"] = " M compare/page.py\n"
    assert results.surroundings("")["commit"] == "abc123abc123, changed"
    said.clear()
    found = results.surroundings("")
    assert (found["machine"], found["compiler"], found["commit"]) == ("Some CPU @ 2 GHz, family 6 model 106, 3 cores", "unknown", "unknown")
    monkeypatch.setattr(results.subprocess, "run", lambda command, **_options: SimpleNamespace(returncode=1, stdout="usage\n"))
    assert results.first_line(["false"]) == ""


def test_one_row_and_shares():
    with pytest.raises(ValueError, match=r"docs/results/speed.txt: 0 rows with {'method': 'none such'}: expected one"):
        results.where("speed", method="none such")
    assert [results.share(text) for text in ("1.2·10⁻⁷", "0.0123", "0.5", "2")] == ["0 %", "1.23 %", "50.0 %", "200 %"]


def test_only_the_tables_that_are_kept_are_written(monkeypatch):
    written = []
    monkeypatch.setattr(results, "write", lambda name, head, columns, rows: written.append((name, head, columns, rows)))
    table = lambda name, rows=((1,),): SimpleNamespace(id=name, columns=["n"], rows=rows)
    for study, kept in results.KEPT.items():
        results.write_tables(study, [table("other"), table(kept)], "head")
        results.write_tables(study, [table(kept, ())], "head")
    results.write_tables("atlas", [table("numbers")], "head")
    assert written == [(study, "head", ["n"], ((1,),)) for study in ("speed", "precision", "diffuse", "lobes", "cloth", "consistency")]


@pytest.mark.parametrize("words, said", [([], "required: what"), (["bench"], "bench wants the CSV file, readme none"), (["readme", "x.csv"], "bench wants the CSV file, readme none"),
                                         (["all"], "invalid choice: 'all'")])
def test_what_it_is_asked(words, said, capsys, elsewhere):
    with pytest.raises(SystemExit) as end:
        results.main(words)
    assert end.value.code == 2 and said in capsys.readouterr().err
    assert results.main(["readme"]) == 0 and results.between()[1] == results.readme()
