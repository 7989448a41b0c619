# SPDX-License-Identifier: Apache-2.0
"""`setup/bench_pairs.py`: its verdict on tools whose times are known, and how it ends."""
import csv
import importlib.util
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import pytest

COST = 2.2

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "setup/bench_pairs.py"
# $8 is the distribution; each call leaves a line in $CALLS
TOOL = """#!/bin/sh
case $1 in
--version) echo 'shade 9 (avx2)'; exit ;;
eval)
  echo '  --mdf      ggx | ward   (default ggx)'
  echo '  --horizon  hard | estevez   (default hard)'
  exit ;;
esac
echo "$0 $*" >>"$CALLS"
calls=$(grep -c "^$0 " "$CALLS")
echo what,method,distribution,precision,isa,set,ns,ratio_perturb,ratio_stream,max_error
{body}
"""
ROW = 'echo "$6,rotate,$8,float,$4,${10},%s,1,1,1e-6"'


@pytest.fixture
def tool(tmp_path, monkeypatch):
    monkeypatch.setenv("CALLS", str(tmp_path / "calls"))

    def make(name, body):
        path = tmp_path / name
        path.write_text(TOOL.replace("{body}", body))
        path.chmod(0o755)
        return str(path)
    return make


def pairs(*arguments, script=SCRIPT, **options):
    return subprocess.run([sys.executable, str(script), *map(str, arguments)], capture_output=True, text=True, timeout=60, **options)


def test_a_slower_row_is_named(tool, tmp_path):
    before = tool("before", ROW % "2.0")
    after = tool("after", f"if [ $8 = ward ]; then {ROW % '2.1'}; else {ROW % '2.0'}; fi")
    out = tmp_path / "out.csv"
    said = pairs(before, after, "--pairs", 3, "--what", "D", "f", "-o", out)
    assert said.returncode == 1, said.stderr
    slow = "avx2    cache  {:16s} float  ward              rotate                   1.050 (1.050 to 1.050)  least 1.050: 2 -> 2.1 ns"
    of_all = "avx2    {:16s} median of   2 rows 1.025, 1.000 to 1.050; over 1.03: 1"
    assert said.stdout.splitlines() == ["2 rows over 1.03 at first; taken again:", *(text.format(what) for text in (slow, of_all) for what in "Df")]
    turns = [f"{done} of {total} turns, 0 min left" for each, total in ((4, 12), (2, 6)) for done in range(each, total + 1, each)]
    assert said.stderr.splitlines() == turns  # a line a pair; those that are slow alone the second time
    asked = [line.split()[1:] for line in (tmp_path / "calls").read_text().splitlines()]
    assert asked[0] == "bench --csv --isa avx2 --what D --mdf ggx --set cache".split() and len(asked) == 2 * (12 + 6)
    rows = {(row["question"], row["distribution"]): row for row in csv.DictReader(out.open())}
    assert {key: float(row["ratio"]) for key, row in rows.items()} == {
        ("D", "ggx"): 1, ("D", "ward"): 1.05, ("f", "ggx"): 1, ("f", "ward"): 1.05}
    assert rows["D", "ward"]["ns_before"] == "2.0" and rows["D", "ward"]["pairs"] == "3"
    assert pairs(before, after, "--pairs", 3, "--what", "D", "--limit", 1.06).returncode == 0
    assert pairs(after, before, "--pairs", 3, "--what", "D").returncode == 0


def test_the_median_counts_and_turns_alternate(tool, tmp_path):
    before = tool("before", ROW % "2")
    after = tool("after", f"if [ $calls = 2 ]; then {ROW % '9'}; else {ROW % '2'}; fi")
    said = pairs(before, after, "--pairs", 3, "--what", "D", "--mdf", "ggx")
    assert said.returncode == 0, said.stdout
    calls = [line.split()[0] for line in (tmp_path / "calls").read_text().splitlines()]
    assert calls == [before, after, after, before, before, after]
    assert pairs(before, after, "--pairs", 1, "--what", "D", "--mdf", "ggx", "-o", "here.csv", cwd=tmp_path).returncode == 0
    assert (tmp_path / "here.csv").read_text().startswith("question,")
    (tmp_path / "folder").mkdir()
    said = pairs(before, after, "--pairs", 1, "--what", "D", "--mdf", "ggx", "-o", "folder", cwd=tmp_path)
    assert said.returncode == 2 and "bench_pairs.py: folder: Is a directory" in said.stderr and not list(tmp_path.glob("folder.*"))


def test_progress_on_a_terminal(monkeypatch, capsys):
    """One line, which is written over and gone at the end."""
    spec = importlib.util.spec_from_file_location("bench_pairs", SCRIPT)
    bench = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(bench)
    now = iter((100, 130, 190))
    monkeypatch.setattr(bench.time, "monotonic", lambda: next(now))
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    progress = bench.Progress(10)
    progress.step("--what f", False)
    progress.step("--what D", True)
    progress.clear()
    assert capsys.readouterr().err == "".join(f"\r{text}\033[K" for text in (
        "1 of 10 turns, 4 min left  --what f", "2 of 10 turns, 6 min left  --what D", ""))


@pytest.mark.parametrize("count, low, median, high", [(1, 1, 1, 1), (3, 1, 2, 3), (5, 2, 3, 4), (8, 3, 4.5, 6)])
def test_quarters_of_the_ratios(tool, tmp_path, count, low, median, high):
    """Of pairs that are once, twice, … as slow."""
    before, after, out = tool("before", ROW % "2"), tool("after", ROW % "$((2 * calls))"), tmp_path / "out.csv"
    pairs(before, after, "--pairs", count, "--what", "D", "--mdf", "ggx", "--once", "-o", out)
    row, = csv.DictReader(out.open())
    assert [float(row[name]) for name in ("low", "ratio", "high")] == [low, median, high]


def test_what_is_slow_once_is_taken_again(tool):
    before = tool("before", ROW % "2")
    after = tool("after", f"if [ $calls -le 3 ]; then {ROW % '3'}; else {ROW % '2'}; fi")
    said = pairs(before, after, "--pairs", 3, "--what", "D", "--mdf", "ggx")
    assert said.returncode == 0 and "taken again" in said.stdout
    pathlib.Path(os.environ["CALLS"]).unlink()
    assert pairs(before, after, "--pairs", 3, "--what", "D", "--mdf", "ggx", "--once").returncode == 1


def test_default_questions_and_rows_of_one_tool(tool, tmp_path):
    before = tool("before", ROW % "2")
    after = tool("after", (ROW % "2") + '\necho "$6,none,$8,float,$4,${10},1,1,1,0"')
    said = pairs(before, after, "--pairs", 1)
    assert said.returncode == 0, said.stderr
    asked = {tuple(line.split()[i] for i in (6, 8)) for line in (tmp_path / "calls").read_text().splitlines()}
    assert asked == {(what, mdf) for what in ("D", "f", "D_call", "f_call", "f_estevez") for mdf in ("ggx", "ward")}
    assert said.stdout.count(f"only in {after}: ") == len(asked)
    (tmp_path / "calls").unlink()
    said = pairs(before, before, "--pairs", 1, "--isa", "sse2", "scalar", "--mdf", "ward", "--set", "memory")
    calls = [line.split()[3:] for line in (tmp_path / "calls").read_text().splitlines()]
    assert said.returncode == 0 and calls[::2] == calls[1::2] == [  # in cache alone more than D and f
        f"--isa {isa} --what {what} --mdf ward --set memory".split() for isa in ("sse2", "scalar") for what in "Df"]
    said = pairs(before, before, "--pairs", 1, "--what", "lanes", "cloth")  # of no distribution
    assert said.returncode == 0 and (tmp_path / "calls").read_text().splitlines()[-1] == f"{before} bench --csv --isa avx2 --what cloth"


@pytest.mark.parametrize("body, arguments, words", [
    ("exit 3", [], "status 3"),
    ("echo wrong >&2; exit 1", [], "wrong"),
    ("seq 12 >&2; exit 1", [], "status 1\n5\n6\n7\n8\n9\n10\n11\n12\n"),  # the last eight lines
    ('echo "D,rotate"', [], "without a time"),
    (ROW % "2", ["--pairs", "0"], "--pairs 0: expected 1 or more"),
    (ROW % "2", ["--limit", "-1"], "--limit -1.0: expected more than 0"),
    (ROW % "2", ["-o", "/no/such/folder/x.csv"], "/no/such/folder"),
    (ROW % "2", ["--cpu", "99999"], "--cpu 99999: expected one of"),
])
def test_errors(tool, body, arguments, words):
    said = pairs(tool("before", body), tool("after", body), "--what", "D", *arguments)
    assert said.returncode == 2 and words in said.stderr and "Traceback" not in said.stderr


def test_what_is_no_tool(tool, tmp_path):
    other = tmp_path / "other"
    other.write_text("#!/bin/sh\necho hello\n")
    other.chmod(0o755)
    for words, arguments in (("neither a program nor a commit", ["nosuch"]), ("is it the shade tool?", [other]),
                             ("neither", ["--", "--upload-pack=x"])):
        said = pairs(*arguments)
        assert said.returncode == 2 and words in said.stderr, said.stderr
    said = pairs(tool("before", ROW % "2"), other, "--what", "D")
    assert said.returncode == 2 and "not the columns" in said.stderr


def test_broken_off_it_says_what_it_has(tool, tmp_path):
    before = tool("before", ROW % "2")
    after = tool("after", f"[ $calls = 2 ] && exec sleep 30\n{ROW % '3'}")
    out = tmp_path / "out.csv"
    run = subprocess.Popen([sys.executable, str(SCRIPT), before, after, "--what", "D", "--mdf", "ggx", "-o", str(out)],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
                           preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))  # it may be ignored, as of jobs behind &
    end = time.monotonic() + 30
    while (tmp_path / "calls").read_text().count(after) < 2 if (tmp_path / "calls").exists() else True:
        assert time.monotonic() < end
        time.sleep(0.02)
    os.killpg(run.pid, signal.SIGINT)
    said, wrong = run.communicate(timeout=20)
    assert run.returncode == 130 and "broken off" in wrong and "Traceback" not in wrong
    assert " 1.500 (" in said
    assert [row["ratio"] for row in csv.DictReader(out.open())] == ["1.5"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["after", "before", "calls", "out.csv"]


def test_a_tool_that_fails_late_loses_nothing(tool, tmp_path):
    before = tool("before", ROW % "2")
    after = tool("after", f"[ $calls = 3 ] && exit 7\n{ROW % '3'}")
    out = tmp_path / "out.csv"
    said = pairs(before, after, "--pairs", 5, "--what", "D", "--mdf", "ggx", "-o", out)
    assert said.returncode == 2 and "status 7" in said.stderr and " 1.500 (" in said.stdout
    assert [(row["ratio"], row["pairs"]) for row in csv.DictReader(out.open())] == [("1.5", "2")]


def test_a_commit_is_built_once_and_whole(tool, tmp_path, monkeypatch):
    """In a repository of its own, whose shade is a script."""
    home = tmp_path / "home"
    (home / "setup").mkdir(parents=True)
    script = home / "setup/bench_pairs.py"
    shutil.copy(SCRIPT, script)
    shutil.copy(tool("shade.sh", ROW % "2"), home)
    (home / "Makefile").write_text("build/shade:\n\tmkdir -p build\n\tcp shade.sh build/shade\n\techo >>$(BUILDS)\n")
    git = ["git", "-C", str(home), "-c", "user.name=a", "-c", "user.email=a@example.org"]
    keep = lambda: [subprocess.run(git + words, check=True, capture_output=True)
                    for words in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "x"])]
    keep()
    monkeypatch.setenv("BUILDS", str(tmp_path / "builds"))
    for _ in range(2):
        said = pairs("HEAD", home / "shade.sh", "--pairs", 1, "--what", "D", script=script)
        assert said.returncode == 0, said.stderr
    assert (tmp_path / "builds").read_text() == "\n"
    (home / "Makefile").write_text("build/shade:\n\tmkdir -p build; cp shade.sh build/shade; echo no luck; false\n")
    keep()
    said = pairs("HEAD", home / "shade.sh", "--pairs", 1, "--what", "D", script=script)
    assert said.returncode == 2 and "no luck" in said.stderr
    assert len(list((home / "build/pairs").iterdir())) == 1  # of the first commit
