# SPDX-License-Identifier: Apache-2.0
"""`shade weave`: look-ups against the formulas written out here, drafts against threading x tie-up
x treadling worked out here, maps, and what is refused."""
import errno
import math
import os
import pathlib
import random
import resource
import signal
import subprocess
import time

import numpy
import OpenImageIO
import pytest

COST = 2.9

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHADE = os.environ.get("SHADE", str(ROOT / "build" / "shade"))
WEAVES = ROOT / "examples" / "weaves"


def run(*options, text=""):
    return subprocess.run([SHADE, "weave", *map(str, options)], input=text, capture_output=True,
                          text=True, timeout=60)


def look_up(points, *options):
    result = run(*options, text="".join(f"{u!r} {v!r}\n" for u, v in points))
    assert result.returncode == 0, result.stderr
    answers = []
    for line in result.stdout.splitlines():
        top, yarn, *numbers = line.split()
        answers.append((top, int(yarn), *map(float, numbers)))
    assert len(answers) == len(points)
    return answers


def printed(*options):
    """The draft as rows from the first pick on, True where the warp is on top."""
    result = run(*options, "--print")
    assert result.returncode == 0, result.stderr
    return [[c == "X" for c in row] for row in reversed(result.stdout.splitlines())]


# ---- the model, long-hand ------------------------------------------------------------------------

YARN = dict(width=1, gap=0, curve=0.5, ridge=0.2, slant=0.25, segments=1, crimp=0, crimp_length=0.5,
            vary_tilt=0, along_tilt=0, slub=0, along_length=4)


def fract(x):
    return x - math.floor(x)


def noise(seed, channel, yarn, knot):
    """The bits that model/weave.h says."""
    word = 0xFFFFFFFF
    h = (seed * 0x9E3779B1 + channel) & word
    for w in (yarn & word, knot & word, 0x27D4EB2F):
        h = (h ^ w) * 0x85EBCA6B & word
        h ^= h >> 15
        h = h * 0xC2B2AE35 & word
        h ^= h >> 13
    return (h >> 8) * 2.0**-23 - 1


def noise_along(seed, channel, yarn, s, length):
    k = math.floor(s / length)
    t = s / length - k
    a, b = noise(seed, channel, yarn, k), noise(seed, channel, yarn, k + 1)
    return a + (b - a) * t * t * (3 - 2 * t)


def dive(distance, length):
    t = min(distance / length, 1)
    return (1 - t) ** 2 * (1 + 2 * t)


def one_yarn(yarn, over, s, t, number, base, seed):
    """sigma and the tilt along and across of a yarn. `over(k)`: whether it is on top at its
    crossing k; s: where along it, in crossings; t: where across its crossing."""
    share = yarn["width"] / (yarn["width"] + yarn["gap"])
    if yarn["slub"]:
        share = min(share * max(1 + yarn["slub"] * noise_along(seed, base + 6, number, s,
                                                               yarn["along_length"]), 0.05), 1)
    sigma = (2 * t - 1) / share
    along, across = 0.0, yarn["curve"] * sigma
    if yarn["segments"]:
        along += yarn["ridge"] * (2 * fract(yarn["segments"] * (fract(s) - yarn["slant"] * sigma)) - 1)
    here = math.floor(s)
    before = next((s - k - 1 for k in range(here - 1, here - 20, -1) if over(k) != over(here)), 99)
    after = next((k - s for k in range(here + 1, here + 20) if over(k) != over(here)), 99)
    length = min(yarn["crimp_length"], before + after)
    slope = dive(after, length) - dive(before, length)
    along += yarn["crimp"] * (slope if over(here) else -slope)
    along += yarn["vary_tilt"] * noise(seed, base + 1, number, 0)
    across += yarn["vary_tilt"] * noise(seed, base + 2, number, 0)
    along += yarn["along_tilt"] * noise_along(seed, base + 4, number, s, yarn["along_length"])
    across += yarn["along_tilt"] * noise_along(seed, base + 5, number, s, yarn["along_length"])
    length = math.hypot(along, across)
    if length > 0.98:
        along, across = along * 0.98 / length, across * 0.98 / length
    return sigma, along, across


def expected(u, v, rows, weft, warp, seed=0):
    ends, picks = len(rows[0]), len(rows)
    i, j = math.floor(u), math.floor(v)

    def warp_up(end, pick):
        return rows[pick % picks][end % ends]

    found = {
        "weft": one_yarn(weft, lambda k: not warp_up(k, j), u, fract(v), j, 0, seed),
        "warp": one_yarn(warp, lambda k: warp_up(i, k), v, fract(u), i, 7, seed),
    }
    upper, lower = ("warp", "weft") if warp_up(i, j) else ("weft", "warp")
    seen = upper if abs(found[upper][0]) <= 1 else lower
    top = seen if abs(found[seen][0]) <= 1 else "gap"
    seen = upper if top == "gap" else seen
    sigma, along, across = found[seen]
    yarn = j % picks if seen == "weft" else i % ends
    if top == "gap":
        along = across = 0.0
    return (top, yarn, sigma, *((along, across) if seen == "weft" else (across, along)))


def agrees(points, rows, options, weft, warp, seed=0, tolerance=1e-12):
    answers = look_up(points, *options)
    seen = set()
    for (u, v), got in zip(points, answers):
        want = expected(u, v, rows, weft, warp, seed)
        assert got[:2] == want[:2], (u, v)
        assert got[2:] == pytest.approx(want[2:], abs=tolerance), (u, v)
        seen.add(got[0])
    return seen


def random_points(count, seed=1):
    generator = random.Random(seed)
    return [(generator.uniform(-40, 40), generator.uniform(-40, 40)) for _ in range(count)]


@pytest.mark.parametrize("pattern", ["1,1,1", "2,1,1", "2,1,-1", "1,3,1", "1,4,2", "7,1,3", "3,5,2",
                                     "4,0,1"])
def test_pattern_is_the_rule(pattern):
    n_w, n_p, n_s = map(int, pattern.split(","))
    points = random_points(2000)
    for (u, v), (top, yarn, *_) in zip(points, look_up(points, "--pattern", pattern)):
        i, j = math.floor(u), math.floor(v)
        assert top == ("weft" if (i + n_s * j) % (n_w + n_p) < n_w else "warp")
        if top == "warp":
            assert yarn == i % (n_w + n_p)


def test_endless_weft():
    for top, yarn, *_ in look_up(random_points(50), "--pattern", "inf,1,1"):
        assert (top, yarn) == ("weft", 0)


def test_defaults_are_the_papers_formulas():
    """c_f .2, c_y .5, s_f .25, N_s 1, no gap, written out once more and by themselves."""
    (got,) = look_up([(0.3, 0.8)], "--pattern", "2,1,1")
    assert got[0] == "weft"
    assert got[2:] == pytest.approx((0.6, 0.2 * (2 * 0.15 - 1), 0.3), abs=1e-15)
    (got,) = look_up([(2.8, 0.3)], "--pattern", "2,1,1")
    assert got[:2] == ("warp", 2)
    assert got[2:] == pytest.approx((0.6, 0.3, 0.2 * (2 * 0.15 - 1)), abs=1e-15)


@pytest.mark.parametrize("name", ["plain", "twill_3_1", "herringbone", "satin_8", "basket"])
def test_everything_at_once(name):
    weft = dict(YARN, width=0.8, gap=0.3, crimp=0.4, crimp_length=1.6, segments=3, slant=-0.7,
                vary_tilt=0.1, along_tilt=0.2, slub=0.4, along_length=2.5)
    warp = dict(YARN, width=1.1, gap=0.2, curve=0.9, ridge=0.6, crimp=0.3, vary_tilt=0.05,
                along_tilt=0.1)
    options = ["--name", name, "--seed", 77]
    for direction, yarn in (("weft", weft), ("warp", warp)):
        for word, value in yarn.items():
            options += [f"--{direction}-{word.replace('_', '-')}", repr(value)]
    seen = agrees(random_points(4000), printed("--name", name), options, weft, warp, 77)
    assert seen == {"weft", "warp", "gap"}


def test_float_follows_double():
    options = ["--name", "twill-2-2", "--gap", ".2", "--crimp", ".5", "--vary-tilt", ".1"]
    points = [(round(u * 4096) / 4096, round(v * 4096) / 4096) for u, v in random_points(2000, 3)]
    double = look_up(points, *options)
    single = look_up(points, *options, "--precision", "float")
    for a, b in zip(double, single):
        assert a[:2] == b[:2]
        assert b[2:4] == pytest.approx(a[2:4], abs=2e-6)
    assert look_up(points[:9], *options, "--precision", "float", "--precision", "double") == double[:9]  # what is said last


@pytest.mark.parametrize("hand, angle", [("S", 20), ("S", 30), ("Z", 30), ("Z", 55)])
@pytest.mark.parametrize("direction", ["weft", "warp"])
def test_slant_angle_of_the_strands(hand, angle, direction):
    """Follow one ridge across the yarn, in the cloth's own lengths, and measure its angle. Seen
    with the yarn upright, S falls to the right and Z rises to the right."""
    warp_width, weft_width, gap = 0.9, 0.6, 0.25
    options = ["--pattern", "inf,1,1", "--warp-width", warp_width, "--weft-width", weft_width,
               "--gap", gap, "--ridge", ".3", "--twist", f"{hand},{angle},2"]
    across, along = (weft_width, warp_width) if direction == "weft" else (warp_width, weft_width)
    if direction == "warp":
        options[1] = "1,100,0"
    share = across / (across + gap)

    def phase(s, sigma):
        t = 0.5 + 0.5 * sigma * share
        (got,) = look_up([(s, t)] if direction == "weft" else [(50 + t, s)], *options)
        assert got[0] == direction and got[2] == pytest.approx(sigma, abs=1e-12)
        tilt = got[3] if direction == "weft" else got[4]
        return tilt / 0.3

    # the tilt is linear in s and in sigma between the jumps
    step = 1e-3
    ds = (phase(0.2 + step, 0) - phase(0.2, 0)) / step
    dsigma = (phase(0.2, step) - phase(0.2, 0)) / step
    forward = -dsigma / ds * (along + gap)  # length along the yarn per half width across it
    sideways = across / 2
    theta = math.degrees(math.atan(abs(forward) / sideways))
    assert theta == pytest.approx(90 - angle, abs=1e-6)
    s_f = abs(dsigma / ds)
    assert math.tan(math.radians(theta)) == pytest.approx(2 * s_f * (along + gap) / across, rel=1e-9)
    # turned upright: the weft by a quarter to the left, so that u points up and v to the left
    x, y = (-sideways, forward) if direction == "weft" else (sideways, forward)
    assert (y / x > 0) == (hand == "Z")


def test_crimp_is_continuous_where_the_yarn_changes_sides():
    """And zero in the middle of a long float."""
    options = ["--pattern", "3,1,1", "--ridge", 0, "--gap", 1, "--crimp", ".4", "--crimp-length",
               "1.2"]
    s = [-0.5 + 5 * k / 2000 for k in range(2001)]
    answers = look_up([(u, 0.5) for u in s], *options)
    tilt = {u: a[3] for u, a in zip(s, answers) if a[0] == "weft"}
    assert tilt[1.5] == pytest.approx(0, abs=1e-15)
    assert min(tilt.values()) == pytest.approx(-0.4, abs=1e-3)
    # weft below the warp shows beside it, in the gap: the slope goes on there without a jump
    at = look_up([(3 - 1e-9, 0.5), (3 + 1e-9, 0.5), (4 - 1e-9, 0.5), (4 + 1e-9, 0.5)], *options)
    assert [a[0] for a in at] == ["weft"] * 4
    assert at[0][3] == pytest.approx(0.4, abs=1e-6) and at[1][3] == pytest.approx(0.4, abs=1e-6)
    assert at[2][3] == pytest.approx(-0.4, abs=1e-6) and at[3][3] == pytest.approx(-0.4, abs=1e-6)


# ---- WIF -----------------------------------------------------------------------------------------


def wif_draft(threading, tieup, treadling, rising):
    """Over and under from the definition, as sets."""
    rows = []
    for treadles in treadling:
        named = set().union(*(tieup.get(t, set()) for t in treadles)) - {0}
        rows.append([bool(shafts - {0}) and bool(shafts & named) == rising for shafts in threading])
    return rows


@pytest.mark.parametrize("seed", range(12))
def test_drawdown_of_random_wifs(tmp_path, seed):
    random_ = random.Random(seed)
    shafts, treadles = random_.randint(1, 24), random_.randint(1, 20)
    ends, picks = random_.randint(1, 60), random_.randint(1, 60)

    def some(count, most, least=0):
        return set(random_.sample(range(1, count + 1), random_.randint(least, min(most, count))))

    threading = [some(shafts, 2) if seed % 3 == 0 else some(shafts, 1, 1) for _ in range(ends)]
    tieup = {t: some(shafts, shafts) for t in range(1, treadles + 1)}
    treadling = [some(treadles, 3 if seed % 2 else 1, 0 if seed % 3 else 1) for _ in range(picks)]
    rising = seed % 4 != 1
    liftplan = seed % 5 == 2
    sections = {
        "WEAVING": [f"Shafts={shafts}", f"Treadles={treadles}", f"Rising Shed={rising}"],
        "WARP": [f"Threads={ends}"],
        "WEFT": [f"Threads={picks}"],
        "THREADING": [f"{i + 1}={','.join(map(str, s))}" for i, s in enumerate(threading) if s],
    }
    if liftplan:
        lifted = [set().union(*(tieup[t] for t in step)) for step in treadling]
        sections["LIFTPLAN"] = [f"{j + 1}={','.join(map(str, s))}" for j, s in enumerate(lifted) if s]
    else:
        sections["TIEUP"] = [f"{t}={','.join(map(str, s)) or 0}" for t, s in tieup.items()]
        sections["TREADLING"] = [f"{j + 1}={','.join(map(str, s))}" for j, s in enumerate(treadling)]
    names = list(sections)
    random_.shuffle(names)
    for name in names[:2]:
        random_.shuffle(sections[name])
    path = tmp_path / "cloth.wif"
    path.write_text("[WIF]\nVersion=1.1\n" + "".join(
        f"[{name}]\n" + "".join(line + "\n" for line in sections[name]) for name in names))
    rows = printed("--draft", path)
    assert rows == wif_draft(threading, tieup, treadling, rising)
    again = tmp_path / "again.wif"
    assert run("--draft", path, "--wif", again).returncode == 0
    assert printed("--draft", again) == rows
    twice = tmp_path / "twice.wif"
    assert run("--draft", again, "--wif", twice).returncode == 0
    assert twice.read_bytes() == again.read_bytes()


# As several weaving programs write them: what is usual there, none of it from a real file.
DIALECTS = {
    "capitals and a liftplan, colours of 0 to 999": (
        "[WIF]\r\nVERSION=1.1\r\nDATE=April 20, 1997\r\n[CONTENTS]\r\nLIFTPLAN=yes\r\nTIEUP=yes\r\n"
        "[COLOR PALETTE]\r\nRANGE=0,999\r\nENTRIES=2\r\n[COLOR TABLE]\r\n1=999,999,999\r\n2=0,500,0\r\n"
        "[WEAVING]\r\nRISING SHED=TRUE\r\nTREADLES=4\r\nSHAFTS=4\r\n[WARP]\r\nTHREADS=4\r\nCOLOR=2\r\n"
        "UNITS=DECIPOINTS\r\nSPACING=212\r\n[WEFT]\r\nTHREADS=4\r\nCOLOR=1\r\n"
        "[THREADING]\r\n1=4\r\n2=3\r\n3=2\r\n4=1\r\n"
        "[LIFTPLAN]\r\n1=1,2\r\n2=2,3\r\n3=3,4\r\n4=1,4\r\n",
        ["..XX", ".XX.", "XX..", "X..X"]),
    "lists with blanks, comments behind values, [x] notes in the rows' sections as comments": (
        "; made by hand\n[WEAVING]\nShafts = 4 ; four of them\nTreadles=6\nRising Shed = yes ; jack\n"
        "[WARP]\nThreads=8 ; two repeats\nUnits=Centimeters\nSpacing=0,2117\nThickness=0,2117\n"
        "[WEFT]\nThreads=4\n\n[TIEUP]\n1= 1, 3\n2= 2, 4\n3=1, 2\n4=0\n5=\n6=3 ,4\n"
        "; [4]Border\n[THREADING]\n;[8]Ground\n1=1\n2=2\n3=3\n4=4\n5=1\n6=2\n7=3\n8=4\n"
        "[TREADLING]\n1=1\n2=2\n3=1,2\n4=4\n",
        ["X.X.X.X.", ".X.X.X.X", "XXXXXXXX", "........"]),
    "rows left out, a sinking shed, the threading last": (
        "[WEAVING]\nRising Shed=no\nShafts=2\nTreadles=2\n[TREADLING]\n1=1\n3=2\n[TIEUP]\n1=1\n2=1,2\n"
        "[WARP]\nThreads=3\n[WEFT]\nThreads=3\n[NOTES]\n1=Treadle two treads all [down];\nfree text\n"
        "[PRIVATE SOMEONE STUFF]\nkey only\n[THREADING]\n1=1\n3=2\n",
        ["..X", "X.X", "..."]),
}


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("encoding", ["ascii", "utf-8-sig", "utf-16"])
def test_dialects(tmp_path, dialect, encoding):
    text, rows = DIALECTS[dialect]
    path = tmp_path / "cloth.WIF"
    path.write_bytes(text.encode(encoding))
    assert printed("--draft", path) == [[c == "X" for c in row] for row in rows]


# What programs get wrong or do in their own way, one at a time, in a file that is otherwise right:
# from the sections to the file's bytes. None of it changes what is woven.


def as_text(sections):
    return "".join(f"[{name}]\n" + "".join(line + "\n" for line in lines)
                   for name, lines in sections.items())


def from_0(sections, *names):
    """Keys of these sections one less."""
    def one_less(line):
        key, value = line.split("=")
        return f"{int(key) - 1}={value}"

    return {name: [one_less(line) for line in lines] if name in names else lines
            for name, lines in sections.items()}


def all_from_0(sections):
    """Keys, shafts and treadles; an empty list has nothing that could be 0."""
    sections = from_0(sections, "THREADING", "TIEUP", "TREADLING")
    for name in ("THREADING", "TIEUP", "TREADLING"):
        lines = []
        for line in sections[name]:
            key, value = line.split("=")
            lines.append(key + "=" + ",".join(str(int(n) - 1) for n in value.split(",") if n))
        sections[name] = lines
    return sections


def stale(sections):
    """Treadles, ends and picks that were there once."""
    ends, picks, treadles = (len(sections[s]) for s in ("THREADING", "TREADLING", "TIEUP"))
    return dict(sections,
                TIEUP=sections["TIEUP"] + [f"{treadles + 1}=1", f"{treadles + 2}=2"],
                THREADING=sections["THREADING"] + [f"{ends + 1}=1"],
                TREADLING=sections["TREADLING"] + [f"{picks + 1}=1,2"])


def split_up(sections):
    """Each of the three in two places, its rows from the last to the first, one row twice."""
    text = as_text({name: lines for name, lines in sections.items() if "=" not in lines[0][:2]})
    for half in (0, 1):
        for name in ("TREADLING", "TIEUP", "THREADING"):
            text += f"[{name}]\n" + "".join(f"{line}\n" for line in sections[name][::-1][half::2])
        text += "[NOTES]\n1=THREADING\n2=2\n"
    return text + "[THREADING]\n" + sections["THREADING"][0] + "\n"


def untidy(text):
    lines = []
    for k, line in enumerate(text.splitlines()):
        line = line.swapcase() if k % 3 else line.title()
        if line.startswith("["):
            line = f"  [ {line[1:-1]} ] ; a section"
        else:
            line = line.replace("=", (" = ", "= ", "\t=")[k % 3]).replace(",", (" , ", " ", ",,")[k % 3])
            line += ("", "  ;= comment", " # [x]")[k % 3]
        lines += [line, "", "; between = lines", "   "]
    return "\n".join(lines)


def counts(sections, **changed):
    shed = sections["WEAVING"][-1]
    return dict(sections, WEAVING=[f"{key}={value}" for key, value in changed.items()] + [shed])


HABITS = {  # name: (the text, whether it is warned of)
    "as the format has it": (as_text, False),
    "no counts": (lambda s: as_text({k: v for k, v in s.items() if k not in ("WARP", "WEFT")}), False),
    "shafts and treadles not counted": (lambda s: as_text(counts(s)), False),
    "too few shafts and treadles counted": (lambda s: as_text(counts(s, Shafts=2, Treadles=1)), True),
    "too many": (lambda s: as_text(counts(s, Shafts=99, Treadles=64)), False),
    "rows that were there once": (lambda s: as_text(stale(s)), True),
    "keys from 0": (lambda s: as_text(from_0(s, "THREADING", "TREADLING")), True),
    "all from 0": (lambda s: as_text(all_from_0(s)), True),
    "contents denied": (lambda s: "[CONTENTS]\nTIEUP=false\nTHREADING=0\n" + as_text(s), True),
    "contents promised": (lambda s: "[CONTENTS]\nLIFTPLAN=true\n" + as_text(s), True),
    "contents of other programs": (lambda s: "[CONTENTS]\nPRIVATE X Y=true\n" + as_text(s), False),
    "sections in pieces": (split_up, True),
    "untidy": (lambda s: untidy(as_text(s)), False),
    "CR": (lambda s: as_text(s).replace("\n", "\r"), False),
    "CRLF and DOS's end": (lambda s: as_text(s).replace("\n", "\r\n") + "\x1a[THREADING]\r\n1=9", False),
    "UTF-16 without a mark": (lambda s: as_text(s).encode("utf-16-le"), False),
    "Latin-1": (lambda s: ("[TEXT]\nTitle=D\xe9ntelle \xa9\n" + as_text(s)).encode("latin-1"), False),
}


@pytest.mark.parametrize("habit", HABITS)
@pytest.mark.parametrize("seed", range(4))
def test_habits_change_nothing(tmp_path, habit, seed):
    random_ = random.Random(seed)
    shafts, treadles = random_.randint(3, 9), random_.randint(3, 9)
    ends, picks = random_.randint(10, 40), random_.randint(10, 40)

    def some(count, most):
        return sorted(random_.sample(range(1, count + 1), random_.randint(1, most)))

    # all shafts and treadles are used, the first ones too: else it does not show what counts from 0
    threading = [[i % shafts + 1] for i in range(ends)]
    random_.shuffle(threading)
    tieup = {t: some(shafts, shafts - 1) for t in range(1, treadles + 1)}
    tieup[treadles] = [1, shafts]
    treadling = [[j % treadles + 1] for j in range(picks)]
    treadling[-1] = [1, treadles]
    random_.shuffle(treadling)
    rising = seed % 2 == 0

    def rows_of(lists):
        return [f"{k}={','.join(map(str, n))}" for k, n in lists]

    sections = {
        "WEAVING": [f"Shafts={shafts}", f"Treadles={treadles}", f"Rising Shed={'yes' if rising else 'no'}"],
        "WARP": [f"Threads={ends}"],
        "WEFT": [f"Threads={picks}"],
        "THREADING": rows_of(enumerate(threading, 1)),
        "TIEUP": rows_of(tieup.items()),
        "TREADLING": rows_of(enumerate(treadling, 1)),
    }
    write, warned = HABITS[habit]
    text = write(sections)
    path = tmp_path / "cloth.wif"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    result = run("--draft", path, "--print")
    assert result.returncode == 0, result.stderr
    rows = [[c == "X" for c in row] for row in reversed(result.stdout.splitlines())]
    assert rows == wif_draft([set(s) for s in threading], {t: set(s) for t, s in tieup.items()},
                             [set(t) for t in treadling], rising)
    if warned:
        assert result.stderr.startswith(f"shade weave: warning: {path}: mended: ")
        assert result.stderr.count("\n") == 1
    else:
        assert result.stderr == ""
    again = tmp_path / "again.wif"
    assert run("--draft", path, "--wif", again).returncode == 0
    result = run("--draft", again, "--print")
    assert result.stderr == ""
    assert [[c == "X" for c in row] for row in reversed(result.stdout.splitlines())] == rows


def test_wif_thickness_and_spacing_set_the_widths(tmp_path):
    path = tmp_path / "cloth.wif"
    path.write_text("[WARP]\nUnits=inches\nSpacing=.1\nThickness=.08\n[WARP THICKNESS]\n2=.04\n"
                    "[THREADING]\n1=1\n2=1\n[LIFTPLAN]\n1=1\n")
    points = [(0.3, 0.5), (1.3, 0.5), (1.2, 0.5)]
    answers = look_up(points, "--draft", path)
    # shares .08/.1 and .04/.1 of their crossings; the weft takes the warp's, whose mean is .6
    assert answers[0][:2] == ("warp", 0) and answers[0][2] == pytest.approx(-0.4 / 0.8, abs=1e-12)
    assert answers[1][:2] == ("warp", 1) and answers[1][2] == pytest.approx(-0.4 / 0.4, abs=1e-12)
    assert answers[2][:2] == ("weft", 0)
    (given,) = look_up([(0.3, 0.5)], "--draft", path, "--width", 1, "--gap", 0)
    assert given[2] == pytest.approx(-0.4 / (0.08 / 0.06), abs=1e-12) or given[2] == -0.4
    # either of them, of either yarn, is enough for the draft's not to count: the other is that of no draft
    for yarn in ("", "warp-", "weft-"):
        for option, value in (("width", 0.7), ("gap", 0.5)):
            alone = look_up(points, "--draft", path, f"--{yarn}{option}", value)
            both = {f"--{of}{word}": {"width": 1, "gap": 0}[word] for of in ("warp-", "weft-") for word in ("width", "gap")}
            both |= {f"--{of}{option}": value for of in ([yarn] if yarn else ["warp-", "weft-"])}
            assert alone == look_up(points, "--draft", path, *(part for pair in both.items() for part in pair)) != answers, (yarn, option)


# As a weaver draws them, the last pick on top, and the colours of ends from the left and of picks from the first on
LIGHT, DARK = (240, 236, 226), (28, 26, 28)
DRAFTS = {
    "plain": ("X. .X", None, None),
    "basket-liftplan": ("XX.. XX.. ..XX ..XX", None, None),
    "twill-2-2": (".XX. XX.. X..X ..XX", None, None),
    "satin-5": ("XXX.X X.XXX XXXX. XX.XX .XXXX", None, None),
    "satin-8-sinking": ("XXXXX.XX XX.XXXXX XXXXXXX. XXXX.XXX X.XXXXXX XXXXXX.X XXX.XXXX .XXXXXXX", None, None),
    "denim": ("XXX. XX.X X.XX .XXX", [(43, 56, 98)] * 4, [(236, 233, 222)] * 4),
    "herringbone": ("..XX..XX..XX..XX .XX..XX.X..XX..X XX..XX..XX..XX.. X..XX..X.XX..XX.", [(206, 200, 190)] * 16, [(74, 70, 68)] * 4),
    "houndstooth": (".XX..XX. XX..XX.. X..XX..X ..XX..XX " * 2, [DARK] * 4 + [LIGHT] * 4, [DARK] * 4 + [LIGHT] * 4)}


def test_example_drafts(tmp_path):
    assert {path.stem for path in WEAVES.glob("*.wif")} == set(DRAFTS)
    for name, (drawn, ends, picks) in DRAFTS.items():
        draft, rows = WEAVES / f"{name}.wif", drawn.split()
        assert printed("--draft", draft) == [[c == "X" for c in row] for row in reversed(rows)], name
        if ends:  # a pixel of each crossing
            assert run("--draft", draft, "--map", "color", "--size", f"{len(ends)}x{len(picks)}", "-o", tmp_path / "map.png").returncode == 0
            seen = OpenImageIO.ImageBuf(str(tmp_path / "map.png")).get_pixels(OpenImageIO.UINT8)
            assert [[tuple(pixel) for pixel in row] for row in seen] == [
                [end if c == "X" else pick for c, end in zip(row, ends)] for row, pick in zip(rows, reversed(picks))], name
    # denim: ends lie close, picks of .45 mm every .556 mm; between these one sees the end below
    edge = 0.5 - 0.45 / 0.556 / 2
    assert [answer[0] for answer in look_up([(0.5, edge - 0.02), (0.5, edge + 0.02), (1.02, 0.5)], "--draft", WEAVES / "denim.wif")] == ["warp", "weft", "warp"]


# ---- maps ----------------------------------------------------------------------------------------


def test_exr_map_holds_the_look_ups(tmp_path):
    path = tmp_path / "map.exr"
    options = ["--name", "twill-2-1", "--gap", ".3", "--crimp", ".4"]
    assert run(*options, "-o", path, "--size", "37x29", "--cells", "5x4").returncode == 0
    image = OpenImageIO.ImageBuf(str(path))
    names = image.spec().channelnames
    pixels = image.get_pixels(OpenImageIO.FLOAT)
    assert pixels.shape[:2] == (29, 37)
    points = [((x + 0.5) / 37 * 5, (29 - y - 0.5) / 29 * 4) for y in range(29) for x in range(37)]
    want = look_up(points, *options)
    got = pixels.reshape(-1, len(names))
    channel = {name: got[:, k] for k, name in enumerate(names)}
    for name, column in (("sigma", 2), ("N.X", 3), ("N.Y", 4)):
        assert numpy.abs(channel[name] - [w[column] for w in want]).max() < 1e-6
    assert [("weft", "warp", "gap")[int(t)] for t in channel["top.ID"]] == [w[0] for w in want]
    assert [int(t) for t in channel["yarn.ID"]] == [w[1] for w in want]
    length = channel["N.X"] ** 2 + channel["N.Y"] ** 2 + channel["N.Z"] ** 2
    assert numpy.abs(length - 1).max() < 1e-6
    tilt = numpy.hypot(channel["N.X"], channel["N.Y"])
    assert numpy.abs(channel["occlusion"] - (1 - tilt)).max() < 1e-6


@pytest.mark.parametrize("cells, size", [("8", [512, 512]), ("8x2", [512, 128]), ("1x4", [128, 512]), ("900x1", [512, 1])])
def test_the_longer_side_of_a_map_is_512(tmp_path, cells, size):
    assert run("--name", "satin-8", "-o", tmp_path / "map.png", "--map", "id", "--cells", cells).returncode == 0
    spec = OpenImageIO.ImageBuf(str(tmp_path / "map.png")).spec()
    assert [spec.width, spec.height] == size


def test_png_maps(tmp_path):
    exr = tmp_path / "map.exr"
    options = ["--draft", WEAVES / "houndstooth.wif", "--occlusion", "sky", "--cells", "8", "--vary-brightness", ".6"]
    assert run(*options, "-o", exr, "--size", "64").returncode == 0
    image = OpenImageIO.ImageBuf(str(exr))
    channel = dict(zip(image.spec().channelnames,
                       numpy.moveaxis(image.get_pixels(OpenImageIO.FLOAT), 2, 0)))
    truth = {
        "normal": numpy.stack([0.5 + 0.5 * channel["N." + c] for c in "XYZ"], axis=2),
        "occlusion": channel["occlusion"][:, :, None],
        "id": channel["top.ID"][:, :, None] / 2,
    }
    for word, want in truth.items():
        png = tmp_path / f"{word}.png"
        result = run(*options, "-o", png, "--size", "64", "--map", word, "--bits", "16")
        assert result.returncode == 0, result.stderr
        got = OpenImageIO.ImageBuf(str(png)).get_pixels(OpenImageIO.FLOAT)
        assert numpy.abs(got - want).max() < 1e-5, word
        assert b"sRGB" not in png.read_bytes() and b"shade weave" in png.read_bytes(), word
    png = tmp_path / "color.png"
    assert run(*options, "-o", png, "--size", "64", "--map", "color").returncode == 0
    assert b"sRGB" in png.read_bytes()  # how a viewer is to read it
    got = OpenImageIO.ImageBuf(str(png)).get_pixels(OpenImageIO.FLOAT)
    linear = numpy.where(got <= 0.04045, got / 12.92, ((got + 0.055) / 1.055) ** 2.4)
    want = numpy.stack([channel["color." + c] * channel["occlusion"] * channel["brightness"] for c in "RGB"], axis=2)
    assert numpy.abs(linear - numpy.minimum(want, 1)).max() < 0.006 and numpy.ptp(channel["brightness"]) > 0.3


def test_map_does_not_depend_on_the_threads(tmp_path):
    files = [tmp_path / f"{n}.exr" for n in (1, 2, 5)]
    for path, threads in zip(files, (1, 2, 5)):
        run("--name", "plain", "--vary-tilt", ".3", "-o", path, "--size", "100", "--cells", "9",
            "--threads", threads)
    assert len({path.read_bytes() for path in files}) == 1


def test_interrupted_map_leaves_nothing(tmp_path):
    process = subprocess.Popen([SHADE, "weave", "--name", "plain", "-o", str(tmp_path / "m.exr"),
                                "--size", "16384"], stderr=subprocess.PIPE)
    while not list(tmp_path.iterdir()):
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    assert process.wait(30) == 130
    assert "interrupted" in process.stderr.read().decode()
    assert not list(tmp_path.iterdir())


# ---- what is refused -----------------------------------------------------------------------------


@pytest.mark.parametrize("options, message", [
    ([], "expected --pattern, --draft or --name"),
    (["--pattern", "0,1,1"], "N_W of at least 1"),
    (["--pattern", "-2,1,1"], "N_W of at least 1"),
    (["--pattern", "2,-1,1"], "N_P of at least 0"),
    (["--pattern", "5000,1,1"], "at most 4096"),
    (["--pattern", "2,1"], "three whole numbers"),
    (["--pattern", "2,1,1,1"], "three whole numbers"),
    (["--pattern", "2,1,x"], "three whole numbers"),
    (["--pattern", "2.5,1,1"], "three whole numbers"),
    (["--pattern", ""], "three whole numbers"),
    (["--pattern", "2,1,99999999999"], "three whole numbers"),
    (["--name", "tweed"], "expected a weave of"),
    (["--name", "plain", "--pattern", "1,1,1"], "--name and --pattern: expected one of them"),
    (["--name", "plain", "--width", "-1"], "--width '-1': expected a number of 1e-06 to 1e+06"),
    (["--name", "plain", "--weft-gap", "-0.1"], "--weft-gap '-0.1': expected a number of 0"),
    (["--name", "plain", "--warp-curve", "nan"], "expected a number of 0 to 0.98"),
    (["--name", "plain", "--warp-curve", "1"], "expected a number of 0 to 0.98"),
    (["--name", "plain", "--twist", "Q"], "expected S, Z or none"),
    (["--name", "plain", "--twist", "S,0"], "expected S, Z or none"),
    (["--name", "plain", "--twist", "S,30,1,plied,5"], "expected S, Z or none"),
    (["--name", "plain", "--occlusion", "some"], "expected none, tilt or sky"),
    (["--name", "plain", "--colour", "red"], "unknown option '--colour'"),
    (["--name", "plain", "--width"], "'--width' lacks its value"),
    (["--name", "plain", "--weft-twist"], "'--weft-twist' lacks its value"),
    (["--name", "plain", "--weft-colour"], "unknown option '--weft-colour'"),
    (["--name", "plain", "stray"], "unexpected argument 'stray'"),
    (["--name", "plain", "-o", "map.jpg"], "a name that ends in .exr or .png"),
    (["--name", "plain", "-o", "m.exr", "--size", "0"], "1 to 65536 pixels"),
    (["--name", "plain", "-o", "m.exr", "--size", "4x"], "1 to 65536 pixels"),
    (["--name", "plain", "-o", "m.exr", "--map", "id"], "--map chooses what -o writes as .png"),
    (["--name", "plain", "--seed", "-1"], "0 to 4294967295"),
    (["--name", "plain", "-o", "m.exr", "--bits", "16"], "--bits is for PNG; an EXR has --half"),
    (["--name", "plain", "--print", "--bits", "8"], "--bits is for PNG; an EXR has --half"),
    (["--name", "plain", "-o", "m.png", "--half"], "--half is for EXR; a PNG has --bits"),
])
def test_bad_usage(options, message):
    result = run(*options)
    assert result.returncode == 2
    assert message in result.stderr and result.stdout == ""


# Options, values that they take, and values just beyond; a person's, by the help
ENDS = [
    ("--twist", ("S,.6", "z,90,0", "S,30,1000,plied", "none"), ("S,.59", "S,90.1", "Z,30,1000.5", "Z,30,-1", "S,30,1,single", "ZS", "none,")),
    ("--width", ("1e-6", "1e6"), ("9e-7", "1.01e6")), ("--weft-curve", ("0", ".98"), ("-.01", ".981")), ("--warp-slant", ("-100", "100"), ("-100.1", "101")),
    ("--crimp_length", (".01", "16"), (".009", "16.1")), ("--seed", ("0", "4294967295"), ("4294967296", "1.5")), ("--threads", ("1", "256"), ("0", "257")),
    ("--size", ("65536", "1x65536"), ("65537", "1x0", "1x2x3")), ("--cells", ("1", "1000000x1"), ("0", "1000001")), ("--bits", (), ("9", "0", "24")),
    ("--pattern", ("4095,1,0", "1,0,1", "inf,1,1", "1,1,-7"), ("4096,1,0", "0,1,1", "1,inf,1")), ("--precision", ("float",), ("fast",)),
    ("--occlusion", ("none", "sky"), ("tilted",)), ("--map", (), ("colour",))]


@pytest.mark.parametrize("option, taken, beyond", ENDS)
def test_ends_of_ranges(option, taken, beyond):
    of = [] if option == "--pattern" else ["--name", "plain"]
    for value in taken:
        result = run(*of, option, value, text="0 0\n")
        assert result.returncode == 0 and result.stderr == "", (value, result.stderr)
    for value in beyond:
        result = run(*of, option, value, text="0 0\n")
        assert result.returncode == 2 and f"{option} '{value}': expected " in result.stderr, value


def test_a_twist_without_numbers_is_of_30_degrees():
    points = [(0.1 * k, 0.07 * k) for k in range(9)]
    assert look_up(points, "--name", "plain", "--twist", "Z") == look_up(points, "--name", "plain", "--twist", "Z,30,1") != look_up(points, "--name", "plain")
    assert look_up(points, "--name", "plain", "--twist", "Z,45") != look_up(points, "--name", "plain", "--twist", "Z")


@pytest.mark.parametrize("text, message", [
    (None, "No such file or directory"),
    ("", "no [THREADING]"),
    ("[THREADING]\n1=1\n[LIFTPLAN]\n1=1;\n2=one\n", "line 5: 'one' in [LIFTPLAN]"),
    ("[WARP]\nThreads=-5\n", "line 2: Threads=-5"),
    ("[WEFT]\nThickness=-1\n", "line 2: Thickness=-1"),
])
def test_bad_drafts(tmp_path, text, message):
    path, out = tmp_path / "cloth.wif", tmp_path / "out.wif"
    if text is not None:
        path.write_text(text)
    result = run("--draft", path, "--wif", out)
    assert result.returncode == 1
    assert message in result.stderr and str(path) in result.stderr
    assert not out.exists()


@pytest.mark.parametrize("line, message", [
    ("1", "line 2: too few numbers; expected u v"),
    ("1 2 3", "line 2: too many numbers"),
    ("1 x", "line 2: not a number"),
    ("1 2x", "line 2: not a number"),
    ("inf 0", "line 2: a number is not finite"),
])
def test_bad_lines(line, message):
    result = run("--name", "plain", text="0 0\n" + line + "\n0 0\n")
    assert result.returncode == 1
    assert message in result.stderr
    assert len(result.stdout.splitlines()) == 1


def test_far_away_points_are_finite():
    for answer in look_up([(1e300, -1e300), (-1e18, 1e17), (-1e-20, 0.0)], "--name", "satin-5"):
        assert all(math.isfinite(x) for x in answer[2:])


def test_unwritable(tmp_path):
    for option, name in (("-o", "map.exr"), ("--wif", "draft.wif")):
        result = run("--name", "plain", option, tmp_path / "missing" / name)
        assert result.returncode == 1
        assert "cannot write" in result.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("there", [True, False])
def test_a_link_stays_one(tmp_path, there):
    """What it points at is written, also through a second link, in another folder."""
    target, link, second = tmp_path / "target.wif", tmp_path / "in" / "link.wif", tmp_path / "second.wif"
    link.parent.mkdir()
    link.symlink_to("../target.wif")
    second.symlink_to(link)
    if there:
        target.write_text("before")
    assert run("--name", "plain", "--wif", second).returncode == 0
    assert second.is_symlink() and link.is_symlink() and not target.is_symlink()
    assert "[WIF]" in target.read_text()
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["in", "link.wif", "second.wif", "target.wif"]
    target.unlink()
    target.symlink_to(second)  # in a circle
    result = run("--name", "plain", "--wif", second)
    assert result.returncode == 1 and "symbolic links" in result.stderr


@pytest.mark.parametrize("name", ["map.png", "map.exr"])
def test_no_room_for_a_map(tmp_path, name):
    def little_room():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    words = [SHADE, "weave", "--name", "plain", "--size", "512", "--warp-twist", "S", "-o", str(tmp_path / name)]
    result = subprocess.run(words, capture_output=True, text=True, timeout=60, preexec_fn=little_room, check=False)
    assert result.returncode == 1 and os.strerror(errno.EFBIG) in result.stderr
    assert not list(tmp_path.iterdir())


def test_a_device_stays_what_it_is(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    result = run("--name", "plain", "--wif", pipe)
    assert result.returncode == 0 and pipe.is_fifo()
    assert os.read(reader, 65536).startswith(b"[WIF]")
    os.close(reader)
    os.rename(pipe, tmp_path / "pipe.png")
    result = run("--name", "plain", "-o", tmp_path / "pipe.png")
    assert result.returncode == 1 and "is a device or pipe" in result.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["pipe.png"] and (tmp_path / "pipe.png").is_fifo()


def test_help():
    result = run("--help")
    assert result.returncode == 0
    for word in ("--pattern", "--draft", "--crimp", "herringbone", "--occlusion"):
        assert word in result.stdout
