# SPDX-License-Identifier: Apache-2.0
"""`shade eval`: values worked out here, the three precisions, and bad input."""
import math
import os
import pathlib
import re
import subprocess

import pytest

COST = 2

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHADE = os.environ.get("SHADE", str(ROOT / "build" / "shade"))
PRECISIONS = {"float": 3e-6, "double": 1e-12, "reference": 1e-12}


def run(queries, *options):
    return subprocess.run(
        [SHADE, "eval", *options], input=queries, capture_output=True, text=True, timeout=60
    )


def evaluate(vectors, *options):
    lines = "".join(" ".join(repr(float(x)) for x in v) + "\n" for v in vectors)
    result = run(lines, *options)
    assert result.returncode == 0, result.stderr
    return [float(x) for x in result.stdout.split()]


def ashikhmin_shirley(x, y, z, ex, ey):
    """D long-hand in the lobe's own frame."""
    sin2 = x * x + y * y
    exponent = (ex * x * x + ey * y * y) / sin2 if sin2 else 0
    return math.sqrt((ex + 1) * (ey + 1)) / (2 * math.pi) * z**exponent


def by_hand(mdf, x, y, z, ax, ay):
    """The other distributions long-hand in the lobe's own frame."""
    slope2 = (x / ax) ** 2 + (y / ay) ** 2
    return {
        "ward": math.exp(-slope2 / z**2),
        "ward-half": math.exp(-2 * slope2 / (1 + z)),
        "beckmann": math.exp(-slope2 / z**2) / z**4,
        "ggx": 1 / (slope2 + z * z) ** 2,
    }[mdf] / (math.pi * ax * ay)


def unit(x, y, z):
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_d_of_a_flat_surface(precision):
    n, h = (0, 0, 1), unit(0.1, -0.2, 1)
    (got,) = evaluate([n + h], "--mdf", "ashikhmin-shirley", "--ex", "200", "--ey", "10",
                      "--detail", "none", "--what", "D", "--precision", precision)
    assert got == pytest.approx(ashikhmin_shirley(*h, 200, 10), rel=PRECISIONS[precision])


def test_fast_is_float():
    """A word of older versions: the answers of float, and a note."""
    query = "0.28 0 0.96  0.6 0.48 0.64\n0.6 0 0.8  0.36 0.48 0.8\n"
    fast, single = (run(query, "--precision", word) for word in ("fast", "float"))
    assert fast.returncode == single.returncode == 0 and fast.stdout == single.stdout != run(query).stdout
    assert fast.stderr.count("float") == 1 and not single.stderr


@pytest.mark.parametrize("mdf", ["ward", "ward-half", "beckmann", "ggx"])
@pytest.mark.parametrize("precision", PRECISIONS)
def test_d_of_the_distributions_with_alphas(mdf, precision):
    vectors = [unit(0.1, -0.2, 1), unit(0.5, 0.4, 1), unit(-0.02, 0.9, 1), (0, 0, 1)]
    answers = evaluate([(0, 0, 1) + h for h in vectors], "--mdf", mdf, "--ax", "0.2", "--ay", "0.5",
                       "--detail", "none", "--what", "D", "--precision", precision)
    for got, h in zip(answers, vectors):
        assert got == pytest.approx(by_hand(mdf, *h, 0.2, 0.5), rel=PRECISIONS[precision])


@pytest.mark.parametrize("precision", PRECISIONS)
def test_rotate_follows_the_height_field(precision):
    """x' = dP/du of the plane whose normal is n, y' = n x x'."""
    n, h = unit(0.4, -0.3, 1), unit(0.45, -0.2, 1)
    x = unit(n[2], 0, -n[0])
    y = (n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0])
    local = [sum(a * b for a, b in zip(axis, h)) for axis in (x, y, n)]
    (got,) = evaluate([n + h], "--ex", "200", "--ey", "10", "--detail", "rotate",
                      "--precision", precision)
    assert got == pytest.approx(ashikhmin_shirley(*local, 200, 10), rel=3 * PRECISIONS[precision])


@pytest.mark.parametrize("precision", PRECISIONS)
def test_peak_where_half_vector_is_normal(precision):
    normals = [unit(0.3, 0, 1), unit(0, 5, 1), unit(-2, 3, 0.01), (0, 1, 1e-9), (0, 0, 1)]
    peak = math.sqrt(201 * 11) / (2 * math.pi)
    for got in evaluate([n + n for n in normals], "--ex", "200", "--ey", "10",
                        "--detail", "rotate", "--precision", precision):
        assert got == pytest.approx(peak, rel=PRECISIONS[precision])


@pytest.mark.parametrize("precision", PRECISIONS)
def test_f_with_and_without_fresnel(precision):
    n, wi, wo = (0, 0, 1), (0, 0.6, 0.8), (0, -0.6, 0.8)
    plain, schlick = (
        evaluate([n + wi + wo], "--ex", "3", "--ey", "15", "--detail", "none", "--what", "f",
                 "--brdf", "ashikhmin-shirley", "--precision", precision, *more)[0]
        for more in ((), ("--f0", "0.04"))
    )
    peak = math.sqrt(4 * 16) / (2 * math.pi)
    assert plain == pytest.approx(peak / (4 * 0.8 * 0.8), rel=PRECISIONS[precision])
    assert schlick / plain == pytest.approx(0.04 + 0.96 * 0.2**5, rel=PRECISIONS[precision])


@pytest.mark.parametrize("brdf, factor", [
    ("ashikhmin-shirley", 1 / (4 * math.cos(0.3) * math.cos(0.1))),
    ("ward-1992", 1 / (4 * math.sqrt(math.cos(0.7) * math.cos(0.1)))),
    ("ward-dur", 1 / (4 * math.cos(0.7) * math.cos(0.1))),
    ("ward-bounded", 4 * math.cos(0.3) ** 2 / (math.cos(0.7) + math.cos(0.1)) ** 4),
])
@pytest.mark.parametrize("precision", PRECISIONS)
def test_brdfs_by_hand(brdf, factor, precision):
    """wi and wo in the plane of y, 0.7 and 0.1 rad from z on one side: h at 0.4, h.wo = cos 0.3."""
    wi, wo = (0, math.sin(0.7), math.cos(0.7)), (0, math.sin(0.1), math.cos(0.1))
    (got,) = evaluate([(0, 0, 1) + wi + wo], "--mdf", "ward", "--ax", "0.2", "--ay", "0.5",
                      "--detail", "none", "--what", "f", "--brdf", brdf, "--precision", precision)
    d = by_hand("ward", 0, math.sin(0.4), math.cos(0.4), 0.2, 0.5)
    assert got == pytest.approx(d * factor, rel=PRECISIONS[precision])


@pytest.mark.parametrize("precision", PRECISIONS)
def test_smith_by_hand(precision):
    wi, wo = (0.6, 0, 0.8), (0, 0.28, 0.96)
    length = math.sqrt(0.36 + 0.28**2 + 1.76**2)
    h = (0.6 / length, 0.28 / length, 1.76 / length)
    li = math.sqrt(1 + (0.2 * 0.6 / 0.8) ** 2)
    lo = math.sqrt(1 + (0.5 * 0.28 / 0.96) ** 2)
    (got,) = evaluate([(0, 0, 1) + wi + wo], "--mdf", "ggx", "--ax", "0.2", "--ay", "0.5",
                      "--detail", "none", "--what", "f", "--precision", precision)  # brdf auto: its own
    want = by_hand("ggx", *h, 0.2, 0.5) * 2 / (li + lo) / (4 * 0.8 * 0.96)
    assert got == pytest.approx(want, rel=PRECISIONS[precision])


@pytest.mark.parametrize("precision", ["double", "reference"])
def test_defaults_by_version(precision):
    """The BRDF that goes with Ward's distribution, and that of version 0, wherever the version stands."""
    wi, wo = (0, math.sin(0.7), math.cos(0.7)), (0, math.sin(0.1), math.cos(0.1))

    def ratio(*options):
        got = evaluate([(0, 0, 1) + wi + wo], "--mdf", "ward", "--ax", "0.2", "--ay", "0.5", "--detail", "none",
                       "--what", "f", "--precision", precision, *options)[0]
        return got / by_hand("ward", 0, math.sin(0.4), math.cos(0.4), 0.2, 0.5)
    bounded = 4 * math.cos(0.3) ** 2 / (math.cos(0.7) + math.cos(0.1)) ** 4
    assert ratio() == pytest.approx(bounded) and ratio("--defaults", "1") == pytest.approx(bounded)
    assert ratio("--defaults", "0") == pytest.approx(1 / (4 * math.cos(0.3) * math.cos(0.1)))
    dur = 1 / (4 * math.cos(0.7) * math.cos(0.1))
    assert ratio("--brdf", "ward-dur", "--defaults", "0") == pytest.approx(dur)
    for bad in ("2", "-1", "new"):
        result = run("", "--defaults", bad)
        assert result.returncode == 2 and f"--defaults '{bad}': expected a whole number from 0 to 1" in result.stderr


@pytest.mark.parametrize("precision", PRECISIONS)
def test_fresnel_of_metals(precision):
    def fresnel(vectors, *options):
        query = [(0, 0, 1) + v for v in vectors]
        common = ("--ex", "0", "--ey", "0", "--detail", "none", "--what", "f",
                  "--precision", precision)
        return [a / b for a, b in zip(evaluate(query, *common, *options),
                                      evaluate(query, *common))]

    z = (0, 0, 1)
    steep = math.sqrt(1 - 1 / 49)
    grazing = (steep, 0, 1 / 7, -steep, 0, 1 / 7)
    tolerance = 3 * PRECISIONS[precision]
    assert fresnel([z + z], "--eta", "0.2", "--k", "3") == pytest.approx(
        [(0.64 + 9) / (1.44 + 9)], rel=tolerance)
    schlick = 0.6 + 0.4 * (6 / 7) ** 5
    assert fresnel([z + z, grazing], "--f0", "0.6", "--f82", "0.7") == pytest.approx(
        [0.6, 0.7 * schlick], rel=tolerance)


# l = (0.6, 0.64, 0.48), v = z. fibre-view: ((pi - psi) C + S) / 4, C = 0.48, S = 0.64, psi = angle
DIFFUSE = {
    "lambert": 0.48,
    "max-normal": 0.8,
    "fibre": (0.8 + 0.48) / math.pi,
    "fibre-view": ((math.pi - math.atan2(0.64, 0.48)) * 0.48 + 0.64) / 4,
    "ashikhmin-shirley": 28 / 23 * (1 - 0.76**5) * (31 / 32) * 0.48,
}


@pytest.mark.parametrize("model", DIFFUSE)
@pytest.mark.parametrize("precision", PRECISIONS)
def test_diffuse_by_hand(model, precision):
    line = (0.6, 0.64, 0.48) + ((0, 0, 1) if model in ("fibre-view", "ashikhmin-shirley") else ())
    (got,) = evaluate([line], "--what", "diffuse", "--diffuse", model, "--precision", precision)
    assert got == pytest.approx(DIFFUSE[model], rel=PRECISIONS[precision])


@pytest.mark.parametrize("precision", PRECISIONS)
def test_what_is_reflected_is_not_diffuse(precision):
    """Of the models that say so; without a Fresnel term there is no f0."""
    for model, left in (("ashikhmin_shirley", 0.7), ("lambert", 1)):
        words = ("--what", "diffuse", "--diffuse", model, "--precision", precision)
        query = [(0.36, 0.48, 0.8) + ((0.6, 0, 0.8) if model != "lambert" else ())]
        (whole,), (less,) = evaluate(query, *words), evaluate(query, *words, "--f0", "0.3")
        assert less == pytest.approx(left * whole, rel=PRECISIONS[precision])


def test_diffuse_part_of_f():
    query = [(0, 0, 1, 0, 0.6, 0.8, 0.6, 0, 0.8)]
    plain, with_fibres = (evaluate(query, "--what", "f", "--diffuse", "fibre", *more)[0]
                          for more in ((), ("--kd", "0.5")))
    assert with_fibres - plain == pytest.approx(0.5 * (0.8 + 1) / math.pi**2 / 0.8, rel=1e-12)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_horizon(precision):
    """n at atan(1/2), light beyond its horizon: black, but for the two facets' mirror."""
    n = (0, 1 / math.sqrt(5), 2 / math.sqrt(5))
    options = ("--what", "f", "--ex", "5", "--ey", "5", "--precision", precision)
    behind, image = (*n, 0, -0.96, 0.28, 0, 0, 1), (*n, 0, 0.96, 0.28, 0, 0, 1)
    for horizon in ("hard", "valid-reflection", "estevez", "chiang"):
        assert evaluate([behind], *options, "--horizon", horizon) == [0]
    (plain,) = evaluate([image], *options)
    (mirrored,) = evaluate([behind], *options, "--horizon", "schuessler")
    assert mirrored == pytest.approx(plain * n[2], rel=PRECISIONS[precision])


@pytest.mark.parametrize("precision", PRECISIONS)
def test_bumps_that_shade_each_other(precision):
    """Seen from above n = z is shown whole, and Smith's 1/(1 + Lambda) of the slopes is let through; no facet of such a
    narrow lobe sends light so low that another bump keeps it back. Without slopes it is hard."""
    query = [(0, 0, 1, 0.8, 0, 0.6, 0, 0, 1)]
    options = ("--what", "f", "--ax", "0.15", "--ay", "0.15", "--mdf", "ggx", "--precision", precision, "--horizon")
    (plain,) = evaluate(query, *options, "hard")
    assert evaluate(query, *options, "mutual") == [plain]
    a = 0.6 / math.sqrt(2 * 0.5 * 1.0002 * 0.64)
    masked = plain / (1 + (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a))
    (bumpy,) = evaluate(query, *options, "mutual", "--slopes", "0,0,0.5,0,0.5")
    assert bumpy == pytest.approx(masked, rel=max(PRECISIONS[precision], 1e-12))


def test_horizon_is_hard_unless_asked_for():
    """The plain formula at n: no bending, no fading, whatever the library starts with."""
    n, wi, wo = (0.6, 0, 0.8), (0.6, 0, 0.8), (0.6, 0, 0.8)
    options = ("--what", "f", "--ex", "200", "--ey", "10")
    (plain,) = evaluate([n + wi + wo], *options)
    assert plain == pytest.approx(math.sqrt(201 * 11) / (2 * math.pi) / 4, rel=1e-12)
    (kinder,) = evaluate([n + wi + wo], *options, "--horizon", "valid-estevez")
    assert kinder == pytest.approx(plain * 2 / (1 + math.sqrt(1 + 0.75**4 / 8)), rel=1e-12)


def test_poulin_fournier_is_in_the_reference():
    """Touching neighbours: nothing hidden from above; the library proper gives fibre_view."""
    above, slanted = (0, 0, 1, 0, 0, 1), (0, 0.96, 0.28, 0, 0, 1)
    true = evaluate([above, slanted], "--what", "diffuse", "--diffuse", "poulin-fournier",
                    "--precision", "reference")
    assert true[0] == pytest.approx(math.pi / 4, rel=1e-12)
    alone = evaluate([slanted], "--what", "diffuse", "--diffuse", "fibre-view")
    assert true[1] < alone[0]


def test_alphas_are_exponents():
    query = [unit(0.1, 0.2, 1) + unit(0.2, 0.1, 1)]
    by_alpha = evaluate(query, "--ax", "0.1", "--ay", "0.5")
    by_exponent = evaluate(query, "--ex", "198", "--ey", "6")
    assert by_alpha == pytest.approx(by_exponent, rel=1e-12)


def test_digits_blank_lines_and_comments():
    result = run("\ufeff# a comment\n\n0 0 1 0 0 1\n", "--precision", "float", "--ex", "1", "--ey", "2")
    assert result.stdout.strip() == "%.9g" % float(result.stdout)
    result = run("0 0 1 0 0 1\n", "--ex", "1", "--ey", "2")
    assert result.stdout.strip() == "%.17g" % float(result.stdout)
    lines = "".join(f"0 0 1 0 {math.sin(.1 * k)} {math.cos(.1 * k)}\n" for k in range(10))
    for precision, digits in (("float", 9), ("double", 17), ("reference", 17)):
        said = run(lines, "--precision", precision, "--ex", "3", "--ey", "2").stdout.split()
        assert max(len(re.sub(r"e.*|\D", "", number).lstrip("0")) for number in said) == digits


@pytest.mark.parametrize("line, word", [
    ("0 0 1 0 0", "too few"),
    ("0 0 1 0 0 1 7", "too many"),
    ("0 0 1 0 0 1x", "not a number"),
    ("0 0 1 0 zero 1", "not a number"),
    ("0 0 1 0 0 nan", "not finite"),
    ("0 0 1 0 0 1e999", "not finite"),
])
def test_malformed_line_is_named(line, word):
    result = run("0 0 1 0 0 1\n" + line + "\n0 0 1 0 0 1\n")
    assert result.returncode == 1
    assert "line 2" in result.stderr and word in result.stderr
    assert "nx ny nz hx hy hz" in result.stderr
    assert len(result.stdout.split()) == 1


@pytest.mark.parametrize("options, expected", [
    (("--detail", "rotated"), "gram_schmidt"),
    (("--mdf", "phong"), "ashikhmin_shirley"),
    (("--ex", "-1", "--ey", "1"), "out of range"),
    (("--ex", "many"), "a number"),
    (("--ax", "0.1"), "go together"),
    (("--ex", "100"), "go together"),
    (("--ex", "5", "--ax", "0.1", "--ay", "0.1"), "not both"),
    (("--f0", "2"), "out of range"),
    (("--f82", "0.5"), "--f0 and --f82"),
    (("--eta", "0.5"), "--eta and --k"),
    (("--eta", "0.5", "--k", "3", "--f0", "1"), "--eta and --k"),
    (("--eta", "0", "--k", "3"), "out of range"),
    (("--what", "g"), "D, f, diffuse, pdf or sample"),
    (("--diffuse", "velvet"), "max_normal"),
    (("--horizon", "event"), "schuessler"),
    (("--slopes", "0,0,1,0"), "x,y,xx,xy,yy"),
    (("--slopes", "0,0,1,2,1"), "sqrt(xx yy)"),
    (("--precision", "half"), "float"),
    (("--colour", "1"), "unknown option"),
    (("--fresnel", "schlick"), "unknown option"),  # it follows from the numbers
    (("--ex",), "'--ex' lacks its value"),
    (("--colour",), "unknown option '--colour'"),
    (("what",), "unexpected argument"),
])
def test_bad_usage(options, expected):
    result = run("", *options)
    assert result.returncode == 2
    assert expected in result.stderr


@pytest.mark.parametrize("numbers, stated", [
    (("f0", "f82", "eta", "k"), [(), ("f0",), ("f0", "f82"), ("eta", "k")]),
    (("ex", "ey", "ax", "ay"), [(), ("ex", "ey"), ("ax", "ay")]),
])
def test_fresnel_and_lobe_are_stated_whole(numbers, stated):
    """Of all subsets of their numbers only those that state one choice; the help names them."""
    usage = run("", "--help").stdout
    for bits in range(1 << len(numbers)):
        given = tuple(n for i, n in enumerate(numbers) if bits >> i & 1)
        options = [word for n in given for word in ("--" + n, "0.5")]
        assert run("", *options).returncode == (0 if given in stated else 2), given
        if len(given) > 1:
            assert (" and ".join("--" + n for n in given) in usage) == (given in stated), given


def test_help_names_every_choice():
    result = run("", "--help")
    assert result.returncode == 0
    for word in ("none", "perturb", "gram_schmidt", "rotate", "auto", "--precision", "--f0"):
        assert word in result.stdout
    # and the one that is taken without the option
    lines = {line.split()[0]: line for line in result.stdout.splitlines() if "(default" in line}
    point = [(0.36, 0.48, 0.8, 0.6, 0, 0.8)]
    for option in ("--mdf", "--detail", "--groove"):
        word = lines[option].split("(default ")[1].rstrip(")")
        assert evaluate(point, option, word) == evaluate(point), option
    top = subprocess.run([SHADE, "--help"], capture_output=True, text=True)
    assert top.returncode == 0 and "eval" in top.stdout and "check" in top.stdout
    assert subprocess.run([SHADE], capture_output=True).returncode == 2
    assert subprocess.run([SHADE, "polish"], capture_output=True).returncode == 2


HELP = {  # of each command, as a person reads it: what an option takes, its range or unit, and what goes without saying
    "eval": ["--what D|f|diffuse|pdf|sample (default D)", "--precision float|double|reference (default double; fast, of older versions, is float)",
             "--ex Exponent along the tangent; larger is narrower, 0 to 1e+06", "--ey Exponent across the tangent; larger is narrower, 0 to 1e+06",
             "--ax Roughness alpha along the tangent, 0.0001 to 10", "--ay Roughness alpha across the tangent, 0.0001 to 10",
             "--f0 Reflectance at normal incidence, linear RGB, 0 to 1, in every channel", "--kd Diffuse reflectance, linear RGB, 0 to 1, in every channel", "(default --ex 200 --ey 10)", "(default 0,0,0,0,0)",
             "the version of the defaults (default 1)", "The lobe is stated by --ex and --ey, or --ax and --ay. Fresnel is 1; with --f0 schlick; "
             "with --f0 and --f82 f82; with --eta and --k conductor. f includes the diffuse part with --kd.",
             "D: lines of nx ny nz hx hy hz -> D' in 1/sr f: lines of nx ny nz wix wiy wiz wox woy woz -> f in 1/sr", "(and vx vy vz, for the models that depend on the eye) -> Phi; fibre along x, normal z",
             "pdf: lines as for f -> density of drawing wi, in 1/sr sample: lines of nx ny nz wox woy woz u1 u2 -> wi, pdf and f; all 0 where the draw finds no direction.",
             "Frame: x tangent, z unperturbed normal, n perturbed normal; unit vectors, wi to the light, wo to the eye. Blank lines and lines that begin with # are skipped.",
             "Answers are in %.17g (float: %.9g).", "x,y,xx,xy,yy: of the map, for --horizon mutual: its mean slope, and the second moment of slopes about it"],
    "bench": ["--output FILE these columns into a file, beside what is printed", "--isa NAME avx512, avx2, sse2, neon or scalar (default: that of shade --version)",
              "--all every instruction set of this CPU", "--mdf NAME one distribution only", "--set NAME cache or memory only", "--ex E --ey E exponents (default 200, 10)",
              "Times are the best of many runs, in ns."],
    "check": ["--tolerance E largest error to pass, beyond that (default 1e-4)", "--mean-tolerance E largest mean error of a material under a light to pass, beyond that (default 1e-5)",
              "--all fail also when a material of the header or a light has nothing to compare", "--json the result as JSON", "--threads N (default: one a CPU); the result is the same",
              "every value S above 1e-4 of the largest of its material and light, in either, unless both are below 1.2e-38", "An error is |S - reference| over the larger of the two.",
              "a value by 15 and 5 % of itself or a tenth of the largest, the sum of eight hits or more by 2 and 4 %. Where there is much of it the mean is of 256 points; what is over the limit then, of 4096.",
              "Exit status: 0 within tolerance; 1 over it, or a bad dump; 2 bad usage."],
    "weave": ["--draft FILE.wif a Weaving Information File", "--print the draft: X warp, . weft on top, the first pick at the bottom", "--size W[xH] pixels (the longer side 512 by default)",
              "--cells W[xH] crossings in the map (default: one repeat)", "--bits 8|16 of a PNG (8)", "--half EXR in half", "--threads N (default: one a CPU)",
              "N_W ends under the weft, then N_P over it; each next pick shifted by N_S; N_W may be inf: all weft", "reads lines of u v, in crossings (u counts ends, v picks, both repeating)",
              "weft|warp|gap yarn sigma dx dy the pick's or end's number from 0, the position across it, -1 to 1 (a gap: beyond), the tilt along u and v",
              "slant, segments and fibre from the yarn's twist: the angle of its strands to its axis (30), how many lie along a crossing (1)", "--NAME sets warp and weft, --warp-NAME or --weft-NAME one of them",
              "A draft that states thickness and spacing sets width and gap, unless they are given.", "-o MAP.png one of them: --map normal|id|occlusion|color", "--occlusion WORD none | tilt | sky (default tilt)", "--seed N of all variation (0)",
              "--width Width of the yarn, in the unit of the gap (1e-06 to 1e+06, default 1)", "--gap Gap between neighbours (0 to 1e+06, default 0)",
              "--curve Tilt across the yarn, at its edge (0 to 0.98, default 0.5)", "--ridge Tilt along the yarn, of its twisted strands (0 to 0.98, default 0.2)",
              "--slant Slant of the strands: crossings per half width (-100 to 100, default 0.25)", "--segments Strands along one crossing (0 to 1000, default 1)",
              "--crimp Tilt along the yarn where it dives under another (0 to 0.98, default 0)", "--crimp_length Crossings from there to where it lies flat (0.01 to 16, default 0.5)",
              "--vary_brightness Variation of brightness from yarn to yarn (0 to 1, default 0)", "--vary_tilt Variation of tilt from yarn to yarn (0 to 1, default 0)",
              "--along_length Crossings between the knots of that variation (0.01 to 1e+06, default 4)", "--slub Variation of width along the yarn (0 to 1, default 0)",
              "plain, twill_2_1, twill_1_2, twill_3_1, twill_1_3, twill_2_2, herringbone, satin_5, satin_8, sateen_5, sateen_8, basket"],
    "slopes": ["--normals KIND colour (0 to 1 for -1 to 1, default), signed (-1 to 1) or slope (dH/dx, dH/dy in the first two channels)",
               "--wrap KIND repeat (default), clamp or mirror", "--strength S 0 to 100 (default 1)", "--directx green points down",
               "--mdf WORD the lobe's distribution (default ashikhmin_shirley)", "--lobes K that many lobes at most, 1 to 8, instead of one: x, y and angle are those of each; 'weight nx ny nz' of every lobe follow (normals in the map's own axes, not turned by the angle)",
               "Reads lines 'u v' or 'u v du1 dv1 du2 dv2' (a pixel's two sides; u, v are 0 to 1, v upwards) and writes 'nx ny nz cxx cxy cyy'", "With a lobe also 'x y angle'",
               "and its turn from the tangent, in degrees.", "Exit status: 0 done, 1 bad input, 2 bad usage."],
    "scratch": ["-o FILE normal map, 0 to 1 for -1 to 1, green up (OpenGL), without gamma", "--height FILE.exr heights, in widths of the picture, 0 at the plate",
                "--size W[xH] texels (default 1024); H is W if not given", "--pits N how many (default 5000)", "--radius A[,B] half width across the scratch (default 0.0005,0.002)",
                "--stretch A[,B] half length over half width; 1 is round (default 20,60)", "--depth A[,B] depth over half width, 0 to 0.99 (default 0.05,0.25)",
                "--direction DEG of the scratches, from right towards up (default 0)", "--spread DEG to either side of it; 90 is any direction (default 10)",
                "--layer begin another layer; what follows is said of it (8 at most)", "--seed N other scratches of the same kind (default 1)",
                "--samples N average N x N points a texel, 1 to 64 (default 1, its centre)", "--bits 8|16 of a PNG (default 16)", "--half, --float values of an EXR (default float)",
                "--directx green down", "--threads N (default: all CPUs); the files do not depend on it", "Lengths are in widths of the picture. A or A,B: one value, or one drawn between two for each pit.",
                "read lines 'u v' or 'u v du1 dv1 du2 dv2' (a pixel's two sides), write 'height nx ny nz cxx cxy cyy', the last three being the covariance of the slopes. u, v are 0 to 1, v upwards"],
    "fabric": ["--tier auto|near|far|single near: the point; far: a mixture of lobes for the mean; single: one lobe a direction of yarn; auto: by footprint",
               "--precision double|float (default double)", "--no-diffuse the highlights alone", "--info what the far model made of it, and no queries", "Lines of `u v footprint wix wiy wiz wox woy woz` -> `r g b`: radiance towards wo for unit irradiance from wi, f cos in 1/sr.",
               "u (along the weft) and v (along the warp) count crossings; footprint is the pixel's width in crossings; wi to the light, wo to the eye, unit, x along u, y along v, z out of the cloth."],
    "swatch": ["-o FILE PNG (8 bits, sRGB) or EXR (half float, linear)", "--size N pixels along a tile, 16 to 2048 (default 256; --all 192)",
               "--across N --all: presets in a row, 1 to 16 (default 5)", "--threads N 1 to 256 (default: as many as there are processors)",
               "Near a tile is 28 yarns of cloth or 2 cm of metal wide, far 16 cm.", "flat near, flat far, hung in folds near, the same far; from left to right the light moves from the left to the right of the eye.",
               "1 is white, and a white Lambert sheet that faces the key light would show 1.5 of it (metals: 0.4) and 0.4 of the sky (metals: 0.55)."],
    "presets": ["--json as JSON: an array, or the object of that name", "Without a name: all presets, one a line. With one: its numbers, and where they come from."],
}


@pytest.mark.parametrize("command", HELP)
def test_help_tells_ranges_units_and_defaults(command):
    said = " ".join(subprocess.run([SHADE, command, "--help"], capture_output=True, text=True).stdout.split())
    assert [text for text in HELP[command] if text not in said] == []


PAGE = """usage: shade COMMAND [options]
eval evaluate a distribution or BRDF for queries on standard input
bench time every method beside its error
scratch make a map of scratches
presets cloths and metals by name, and their numbers
fabric what a cloth reflects, near and far
swatch pictures of cloths and metals by name
slopes look a normal map up with a footprint
check recompute a renderer's dump with the reference
weave which yarn is on top of a woven cloth, drafts and maps of it
shade COMMAND --help options of a command
shade --version version and instruction set
Exit status: 0 done, 1 bad input, 2 bad usage."""


@pytest.mark.parametrize("words, status, first", [(["--help"], 0, []), ([], 2, []), (["polish"], 2, ["shade: unknown command 'polish'"])])
def test_the_first_page_names_each_command(words, status, first):
    done = subprocess.run([SHADE, *words], capture_output=True, text=True, timeout=60)
    said, other = (done.stdout, done.stderr) if status == 0 else (done.stderr, done.stdout)
    assert done.returncode == status and other == ""
    assert [" ".join(line.split()) for line in said.splitlines() if line] == first + PAGE.split("\n")


def test_what_goes_without_saying_is_as_the_help_says(tmp_path):
    """Each command with its defaults spelt out writes what it writes without them."""
    shade = lambda *words, points="": subprocess.run([SHADE, *map(str, words)], input=points, capture_output=True, text=True, timeout=60)
    points = "".join(f"{u / 7} {v / 5}\n" for u in range(7) for v in range(5))
    assert shade("scratch", "-o", tmp_path / "n.png", "--size", 16).returncode == 0
    yarn = "--width 1 --gap 0 --curve .5 --ridge .2 --slant .25 --segments 1 --fibre 0 --crimp 0 --crimp_length .5 --vary_brightness 0 --vary_tilt 0 --along_length 4 --slub 0 --seed 0"
    for command, defaults in ((["scratch", "--eval"], "--pits 5000 --radius .0005,.002 --stretch 20,60 --depth .05,.25 --direction 0 --spread 10 --seed 1"),
                              (["slopes", tmp_path / "n.png"], "--normals colour --wrap repeat --strength 1"),
                              (["slopes", tmp_path / "n.png", "--ex", "200", "--ey", "10"], "--mdf ashikhmin_shirley --defaults 1"),
                              (["weave", "--name", "twill_2_1"], yarn + " --precision double"), (["weave", "--name", "basket", "--print"], "")):
        plain, spelt = (shade(*command, *words, points=points) for words in ((), defaults.split()))
        assert plain.returncode == 0 and plain.stdout == spelt.stdout != "", (command, plain.stderr, spelt.stderr)
    queries = "".join(f"{k}.3 {k}.6 {0.01 * 9**k} .3 .2 .9 -.2 .1 .95\n" for k in range(4))
    plain, spelt = (shade("fabric", "denim", *words, points=queries) for words in ((), "--tier auto --precision double".split()))
    assert plain.returncode == 0 and plain.stdout == spelt.stdout and len(plain.stdout.splitlines()) == 4
    for command, name, defaults in ((["scratch", "--size", "8"], "s.png", "--samples 1 --bits 16 --pits 5000"), (["scratch", "--size", "8"], "s.exr", "--float"),
                                    (["weave", "--name", "plain", "--map", "normal", "--size", "16"], "w.png", "--cells 2x2 --bits 8 --occlusion tilt " + yarn)):
        made = []
        for words in ((), defaults.split()):
            assert shade(*command, "-o", tmp_path / name, *words).returncode == 0, words
            made.append((tmp_path / name).read_bytes())
        assert made[0] == made[1], name


def test_lost_input_and_output_are_errors():
    with open("/dev/full", "w", encoding="ascii") as full:
        for options in (["eval", "--help"], ["--version"], ["bench", "--help"]):
            out = subprocess.run([SHADE, *options], stdout=full, stderr=subprocess.PIPE, text=True)
            assert out.returncode == 1 and "standard output" in out.stderr
    for command in (["eval"], ["weave", "--name", "plain"], ["scratch", "--eval"],
                    ["fabric", "denim"]):
        folder = os.open("/tmp", os.O_RDONLY)
        out = subprocess.run([SHADE, *command], stdin=folder, capture_output=True, text=True)
        os.close(folder)
        assert out.returncode == 1 and "standard input: Is a directory" in out.stderr
    assert "zero byte" in run("0 0 1 0 0 1\0 5\n").stderr


@pytest.mark.parametrize("precision", ["float", "double", "reference"])
def test_directions_without_meaning_are_named(precision):
    result = run("0 0 1 1 0 0 -1 0 0\n", "--what", "f", "--precision", precision)
    assert result.returncode == 0 and result.stdout == "0\n" and "line 1" in result.stderr


@pytest.mark.parametrize("precision", PRECISIONS)
def test_pdf_by_hand(precision):
    """Half vectors are drawn by D: the density of wi is D / (4 h.wo)."""
    n, wi, wo = (0, 0, 1), unit(0.3, 0.1, 1), unit(-0.2, 0.2, 1)
    h = unit(*(a + b for a, b in zip(wi, wo)))
    h_wo = sum(a * b for a, b in zip(h, wo))
    (got,) = evaluate([n + wi + wo], "--ex", "200", "--ey", "10", "--what", "pdf",
                      "--precision", precision)
    want = ashikhmin_shirley(*h, 200, 10) / (4 * h_wo)
    assert got == pytest.approx(want, rel=PRECISIONS[precision])
    (below,) = evaluate([n + (0.6, 0, -0.8) + wo], "--what", "pdf", "--precision", precision)
    assert below == 0


@pytest.mark.parametrize("precision", PRECISIONS)
def test_sample(precision):
    """u2 = 0 is the lobe's peak, so wi mirrors wo at n; pdf and f are those of their queries."""
    options = ["--ex", "200", "--ey", "10", "--detail", "rotate", "--precision", precision]
    n, wo = unit(0.3, -0.2, 1), unit(0.1, 0.3, 1)
    digits = {"rel": 10 * PRECISIONS[precision], "abs": 10 * PRECISIONS[precision]}
    *wi, pdf, f = evaluate([n + wo + (0.3, 0)], "--what", "sample", *options)
    n_wo = sum(a * b for a, b in zip(n, wo))
    assert wi == pytest.approx([2 * n_wo * a - b for a, b in zip(n, wo)], **digits)
    *wi, pdf, f = evaluate([n + wo + (0.7, 0.4)], "--what", "sample", "--kd", "0.3", *options)
    assert sum(x * x for x in wi) == pytest.approx(1, **digits)
    query = [n + tuple(wi) + wo]
    assert evaluate(query, "--what", "pdf", "--kd", "0.3", *options) == pytest.approx([pdf], **digits)
    assert evaluate(query, "--what", "f", "--kd", "0.3", *options) == pytest.approx([f], **digits)
    assert evaluate([n + (0.6, 0, -0.8) + (0.5, 0.5)], "--what", "sample", *options) == [0] * 5
    result = run("0 0 1 0 0 1 0.5\n", "--what", "sample", *options)
    assert result.returncode == 1 and "u1 u2" in result.stderr


def test_draws_of_the_reference_have_its_own_pdf_and_f():
    """To the last digit those of a query for the same direction; the kernel's are near, not the same."""
    options = ["--ex", "200", "--ey", "10", "--detail", "rotate", "--kd", "0.3"]
    n, wo = unit(0.3, -0.2, 1), unit(0.1, 0.3, 1)
    given = [n + wo + ((k + 0.5) / 20, (7 * k % 20) / 20) for k in range(20)]
    drawn = {}
    for precision in ("double", "reference"):
        numbers = evaluate(given, "--what", "sample", "--precision", precision, *options)
        drawn[precision] = [numbers[5 * k:5 * k + 5] for k in range(20)]
    found = [(k, d) for k, d in enumerate(drawn["reference"]) if d[3] > 0]
    assert len(found) > 10
    query = [n + tuple(d[:3]) + wo for _, d in found]
    for at, what in ((3, "pdf"), (4, "f")):
        got = [d[at] for _, d in found]
        assert got == evaluate(query, "--what", what, "--precision", "reference", *options)
        kernels = [drawn["double"][k][at] for k, _ in found]
        assert got != kernels and got == pytest.approx(kernels, rel=1e-11)
