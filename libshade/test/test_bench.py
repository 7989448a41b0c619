# SPDX-License-Identifier: Apache-2.0
"""`shade bench`: its columns, and that the errors it prints are the library's own bounds."""
import csv
import io
import os
import pathlib
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
        assert row["method"] != "perturb" or row["ratio_perturb"] == "1", row
    # a bare pass over the arrays, which computes nothing, and perturb are the same for all methods
    for column in ("ratio_stream", "ratio_perturb"):
        others = {}
        for row in rows:
            others.setdefault((row["what"], row["precision"], row["distribution"]), []).append(float(row["ns"]) / float(row[column]))
        assert all(min(found) > 0.99 * max(found) for found in others.values()), (column, others)


def test_one_horizon():
    rows = read(bench("--csv", "--mdf", "ggx", "--what", "f_valid-estevez"))
    assert {(row["what"], row["method"], row["set"]) for row in rows} == {
        ("f_valid_estevez", "rotate", "cache")}
    assert {row["precision"] for row in rows} == {"float", "double"}


def test_memory_and_instruction_sets():
    rows = read(bench("--csv", "--set", "memory", "--mdf", "ward", "--what", "D"))
    assert {(row["set"], row["distribution"], row["what"]) for row in rows} == {
        ("memory", "ward", "D")}
    rows = read(bench("--csv", "--all", "--set", "cache", "--mdf", "ggx", "--what", "f"))
    isas = list(dict.fromkeys(row["isa"] for row in rows))
    assert isas[-1] == "scalar" and set(isas) <= {"avx512", "avx2", "sse2", "scalar"}
    for isa in isas:
        one = read(bench("--csv", "--isa", isa, "--set", "cache", "--mdf", "ggx", "--what", "f"))
        assert {row["isa"] for row in one} == {isa}


def test_parameters_of_each_sample():
    rows = {(row["what"], row["method"], row["precision"]): row
            for row in read_apart(bench("--csv", "--what", "lanes"))}
    for what in ("f", "pdf", "sample"):
        for method in ("none", "rotate"):
            for precision in ("float", "double"):
                assert float(rows[what, method, precision]["ratio_perturb"]) == 1
                for given in ("_alphas", "_all"):
                    row = rows[what + given, method, precision]
                    assert 0 < float(row["max_error"]) <= (1e-4 if precision == "float" else 1e-11), row
    assert len(rows) == 36


def test_maps():
    rows = {row["what"]: row for row in read_apart(bench("--csv", "--what", "maps"))}
    assert {"slopes_point", "slopes_4", "slopes_64", "slopes_64_by_8", "widen"} <= set(rows)
    for row in rows.values():
        assert row["precision"] == "double" and float(row["ratio_perturb"]) > 0, row
        assert 1 < float(row["ns"]) < 5e4, row  # of one look-up, on any machine
    assert float(rows["slopes_point"]["ratio_perturb"]) == 1


def test_diffuse_and_lobes():
    rows = {(row["method"], row["precision"]): row for row in read_apart(bench("--csv", "--what", "diffuse"))}
    assert {method for method, _ in rows} == {"lambert", "max_normal", "fibre", "fibre_view", "ashikhmin_shirley"}
    for (method, precision), row in rows.items():
        assert 0 < float(row["max_error"]) <= (1e-6 if precision == "float" else 1e-14), row
        assert method != "lambert" or float(row["ratio_perturb"]) == 1
    lobes = read_apart(bench("--csv", "--what", "lobes"))
    assert [row["what"] for row in lobes if row["distribution"] == "ggx"] == [f"lobes_{n}" for n in (1, 2, 3, 4, 6, 8)]
    reference = read_apart(bench("--csv", "--what", "reference"))
    assert len(reference) == 5 and all(row["what"] == "D_reference" and float(row["ns"]) > 0 for row in reference)
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
