# SPDX-License-Identifier: Apache-2.0
"""`shade bench`: its columns, and that the errors it prints are the library's own bounds."""
import contextlib
import csv
import io
import os
import pathlib
import pty
import re
import subprocess

COST = 15

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHADE = os.environ.get("SHADE", str(ROOT / "build" / "shade"))


COLUMNS = ["what", "method", "distribution", "precision", "isa", "set", "ns", "ratio_perturb",
           "ratio_stream", "max_error"]


def bench(*options):
    out = subprocess.run([SHADE, "bench", *options], capture_output=True, text=True, timeout=300)
    assert out.returncode == 0, out.stderr
    return out.stdout


def read(text):
    rows = list(csv.DictReader(io.StringIO(text)))
    assert list(rows[0]) == COLUMNS
    for row in rows:
        assert float(row["ns"]) > 0
        assert float(row["ratio_perturb"]) > 0 and float(row["ratio_stream"]) > 0
    return rows


def read_apart(text):
    """Rows that stand beside no bare pass over the arrays."""
    rows = list(csv.DictReader(io.StringIO(text)))
    assert list(rows[0]) == COLUMNS
    assert all(float(row["ns"]) > 0 for row in rows)
    return rows


def printed(text, rows):
    """For people: under what its columns are called, the same as in the file."""
    head, *lines = text.splitlines()
    assert head.split() == ["method", "distribution", "type", "isa", "arrays", "ns", "/perturb", "/stream", "error"]
    assert len(lines) == len(rows)
    for line, row in zip(lines, rows):
        said, numbers = line.split()[:6], [float(x) for x in line.split()[6:]]
        assert said == [row[column] for column in COLUMNS[:6]]
        told = [float(row[column]) for column in COLUMNS[6:]]
        if not told[2]:  # beside no bare pass
            del told[2]
        assert all(abs(a - b) <= (.006 if k < len(told) - 1 else .06) * abs(b) for k, (a, b) in enumerate(zip(numbers, told, strict=True))), line


def relative(row, first):
    """Whether a row's ratio is its time beside that of the first, to the digits that are written."""
    return abs(float(row["ratio_perturb"]) * float(first["ns"]) / float(row["ns"]) - 1) < 2e-3


def bound(row):
    """What the kernels state of their errors, for exponents to 1e3 (mdf.h, brdf.h)."""
    if row["precision"] == "double":
        return 1e-12
    return 1e-4 if "deform" in row["method"] else 5e-5


def test_every_row_in_cache(tmp_path):
    rows = read(bench("--csv", "--set", "cache", "--output", str(tmp_path / "bench.csv")))
    assert read((tmp_path / "bench.csv").read_text()) == rows
    assert [path.name for path in tmp_path.iterdir()] == ["bench.csv"]
    listed = subprocess.run([SHADE, "eval", "--help"], capture_output=True, text=True).stdout
    words = lambda option: set(re.search(rf"--{option} +(.*?)(?: +\(default .*)?$", listed, re.M)[1].split(" | "))
    methods, distributions = words("detail"), words("mdf")
    assert len(methods) > 8 and len(distributions) > 4
    have = {(row["what"], row["precision"], row["distribution"], row["method"]) for row in rows}
    for what in ("D", "f", "D_call", "f_call"):
        for precision in ("float", "double"):
            for distribution in distributions:
                for method in methods:
                    assert (what, precision, distribution, method) in have
    horizons = words("horizon") - {"hard"}
    assert len(horizons) == 6
    for horizon in horizons:
        for precision in ("float", "double"):
            for distribution in distributions:
                assert (f"f_{horizon}", precision, distribution, "rotate") in have
    assert {row["method"] for row in rows if row["what"].startswith("f_")
            and row["what"] != "f_call"} == {"rotate"}
    assert {row["what"] for row in rows} == {"D", "f", "D_call", "f_call"} | {
        f"f_{horizon}" for horizon in horizons}
    assert {row["precision"] for row in rows} == {"float", "double"}
    assert ("D", "float", "ashikhmin_shirley", "rotate_literal") in have
    for row in rows:
        assert row["set"] == "cache"
        assert float(row["max_error"]) <= bound(row), row
        assert 0.05 < float(row["ns"]) < 5000, row  # of one sample, on any machine: not of an array
        # something was compared
        assert float(row["max_error"]) > 0, row
    groups = {}
    for row in rows:
        groups.setdefault((row["what"], row["distribution"], row["precision"]), []).append(row)
    for group in groups.values():
        bare = {float(row["ns"]) / float(row["ratio_stream"]) for row in group}
        assert max(bare) < 1.003 * min(bare)
        first = next((row for row in group if row["method"] == "perturb"), None)
        assert first is None or all(relative(row, first) for row in group)


def test_one_horizon(tmp_path):
    text = bench("--mdf", "ggx", "--what", "f_valid-estevez", "--output", str(tmp_path / "one.csv"))
    rows = read((tmp_path / "one.csv").read_text())
    printed(text, rows)
    assert {(row["what"], row["method"], row["set"]) for row in rows} == {
        ("f_valid_estevez", "rotate", "cache")}
    assert {row["precision"] for row in rows} == {"float", "double"}


def test_memory_and_instruction_sets():
    rows = read(bench("--csv", "--set", "memory", "--mdf", "ward", "--what", "D"))
    assert {(row["set"], row["distribution"], row["what"]) for row in rows} == {
        ("memory", "ward", "D")}
    # on a terminal how far it is, where the rows go elsewhere
    terminal, inner = pty.openpty()
    out = subprocess.run([SHADE, "bench", "--csv", "--all", "--set", "cache", "--mdf", "ggx", "--what", "f"], stdout=subprocess.PIPE,
                         stderr=inner, text=True, timeout=300, check=True)
    os.close(inner)
    told = b""
    with contextlib.suppress(OSError):  # Linux says so at its end
        while new := os.read(terminal, 65536):
            told += new
    os.close(terminal)
    told = told.decode()
    rows = read(out.stdout)
    isas = list(dict.fromkeys(row["isa"] for row in rows))
    assert isas[-1] == "scalar" and set(isas) <= {"avx512", "avx2", "sse2", "scalar"}
    bars = re.findall(r"\rshade bench \[(#*) *\] cache (\w+) f ggx *(?=\r)", told)
    assert [(len(bar), isa) for bar, isa in bars] == [(30 * k // len(isas), isa) for k, isa in enumerate(isas)] and told.endswith("\r\033[K")
    for isa in isas:
        exponents = ("200", "10") if isa == isas[0] else ("10", "200")  # the first those that go without saying
        one = read(bench("--csv", "--isa", isa, "--set", "cache", "--mdf", "ggx", "--what", "f", "--ex", exponents[0], "--ey", exponents[1]))
        assert {row["isa"] for row in one} == {isa}
        errors = [[row["max_error"] for row in table if row["isa"] == isa] for table in (one, rows)]
        assert (errors[0] == errors[1]) == (isa == isas[0])


def test_parameters_of_each_sample():
    rows = {(row["what"], row["method"], row["precision"]): row
            for row in read_apart(bench("--csv", "--what", "lanes"))}
    for what in ("f", "pdf", "sample"):
        for method in ("none", "rotate"):
            for precision in ("float", "double"):
                assert float(rows[what, method, precision]["ratio_perturb"]) == 1
                for given in ("_alphas", "_all"):
                    row = rows[what + given, method, precision]
                    assert relative(row, rows[what, method, precision])
                    assert 0 < float(row["max_error"]) <= (1e-4 if precision == "float" else 1e-11), row
    assert len(rows) == 36


def test_maps():
    rows = {row["what"]: row for row in read_apart(bench("--csv", "--what", "maps"))}
    assert {"slopes_point", "slopes_4", "slopes_64", "slopes_64_by_8", "widen"} <= set(rows)
    for row in rows.values():
        assert row["precision"] == "double" and float(row["ratio_perturb"]) > 0, row
        assert 1 < float(row["ns"]) < 5e4, row  # of one look-up, on any machine
    assert float(rows["slopes_point"]["ratio_perturb"]) == 1
    assert all(relative(row, rows["slopes_point"]) for row in rows.values())


def test_diffuse_and_lobes(tmp_path):
    rows = {(row["method"], row["precision"]): row for row in read_apart(bench("--csv", "--what", "diffuse"))}
    assert {method for method, _ in rows} == {"lambert", "max_normal", "fibre", "fibre_view", "ashikhmin_shirley"}
    for (_method, precision), row in rows.items():
        assert 0 < float(row["max_error"]) <= (1e-6 if precision == "float" else 1e-14), row
        assert relative(row, rows["lambert", precision])
    text = bench("--what", "lobes", "--output", str(tmp_path / "lobes.csv"))
    lobes = read_apart((tmp_path / "lobes.csv").read_text())
    printed(text, lobes)
    assert all(relative(row, next(first for first in lobes if first["distribution"] == row["distribution"])) for row in lobes)
    assert [row["what"] for row in lobes if row["distribution"] == "ggx"] == [f"lobes_{n}" for n in (1, 2, 3, 4, 6, 8)]
    reference = read_apart(bench("--csv", "--what", "reference"))
    assert len(reference) == 5 and all(row["what"] == "D_reference" and float(row["ns"]) > 0 for row in reference)
    assert all(float(row["ratio_perturb"]) == 1 for row in reference)
    assert {row["distribution"] for row in lobes} == {"ashikhmin_shirley", "ward", "ward_half", "beckmann", "ggx"}


def test_bad_usage():
    for options in (["--fast"], ["--ex", "-1"], ["--ex", "x"], ["--ex"], ["--isa", "neon"],
                    ["--mdf", "phong"], ["--what", "g"], ["--what", "f_hard"],
                    ["--what", "f_"], ["--what", "f_horizon"], ["--what", "d_call"],
                    ["--what", "f_chiang", "--set", "memory"], ["--set", "memory", "--what", "D_call"], ["--set", "disk"], ["--output"]):
        out = subprocess.run([SHADE, "bench", *options], capture_output=True, text=True)
        assert out.returncode == 2 and "shade bench" in out.stderr and not out.stdout
    out = subprocess.run([SHADE, "bench", "--output", "/nowhere/bench.csv"], capture_output=True,
                         text=True)
    assert out.returncode == 1 and "/nowhere/bench.csv" in out.stderr
    assert subprocess.run([SHADE, "bench", "--help"], capture_output=True).returncode == 0
