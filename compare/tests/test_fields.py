# SPDX-License-Identifier: Apache-2.0
"""The surfaces of compare's programs in C, of themselves: heights by their formulas, normals by differences, rays by marching."""
import ctypes
import os
import subprocess

import numpy as np
import programs
import pytest

COST = 3.2

VECTOR, DOUBLES, R = ctypes.c_double * 3, ctypes.POINTER(ctypes.c_double), 1 / np.pi
SMOOTH, WAVES, SCRATCHES = range(3)


class Vec(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in "xyz"]


def library(folder, source, *include):
    (folder / "one.c").write_text(source, encoding="utf-8")
    flags = ["-O2", "-fPIC", "-shared", *(f"-I{path}" for path in include)]
    subprocess.run([*os.environ.get("CC", "cc").split(), *flags, folder / "one.c", "-lm", "-o", folder / "one.so"], check=True)
    return ctypes.CDLL(folder / "one.so")


# ---- compare/displaced/surface.c


class Place(ctypes.Structure):
    _fields_ = [("u", ctypes.c_double), ("v", ctypes.c_double), *((name, Vec) for name in ("x", "y", "z", "p", "du", "dv", "n"))]


@pytest.fixture(scope="module")
def surfaces(tmp_path_factory):
    """A function (base, bumps, slope) that gives (at, under, cast, seen, window) of a surface, and its (top, bottom, lipschitz)."""
    made = library(tmp_path_factory.mktemp("surface"), '#include "surface.c"\n#include <stdlib.h>\n' + """
surface *one_make(int base, int bumps, double slope) { surface *s = malloc(sizeof *s); surface_make(s, base, bumps, slope, 3); return s; }
void one_bounds(const surface *s, double to[3]) { to[0] = s->top; to[1] = s->bottom; to[2] = s->lipschitz; }
""", programs.HERE / "displaced")
    made.one_make.restype, made.surface_cast.restype = ctypes.c_void_p, ctypes.c_double

    def surface(base, bumps, slope):
        one = ctypes.c_void_p(made.one_make(base, bumps, ctypes.c_double(slope)))

        def at(u, v):
            place = Place()
            made.surface_at(one, ctypes.c_double(u), ctypes.c_double(v), ctypes.byref(place))
            return {name: np.array([getattr(part, axis) for axis in "xyz"]) for name in ("x", "y", "z", "p", "du", "dv", "n") for part in [getattr(place, name)]}

        def pair(call, *said):
            found = (ctypes.c_double * 3)()
            status = call(one, *said, *(ctypes.byref(found, 8 * k) for k in range(3 if call is made.surface_window else 2)))
            return status, list(found)
        bounds = (ctypes.c_double * 3)()
        made.one_bounds(one, bounds)
        return (at, lambda p: pair(made.surface_under, Vec(*p))[1][:2], lambda p, d: made.surface_cast(one, Vec(*p), Vec(*d)),
                lambda x, y: pair(made.surface_base_seen, ctypes.c_double(x), ctypes.c_double(y)), lambda: pair(made.surface_window)[1], list(bounds))
    return surface


BASES = ("plate", "cylinder", "sphere")


@pytest.mark.parametrize("base", range(3), ids=BASES)
@pytest.mark.parametrize("bumps", [SMOOTH, WAVES, SCRATCHES], ids=["smooth", "waves", "scratches"])
def test_a_displaced_surface(surfaces, base, bumps):
    """Its derivatives are differences of its points, its height is that above a point of the base, and no steeper than asked."""
    at, under, cast, seen, window, (top, bottom, lipschitz) = surfaces(base, bumps, 0.8)
    random = np.random.default_rng(base)
    heights, steepest = [], 0
    for u, v in np.stack([random.uniform(-0.45, 0.45, 70), random.uniform(-0.3, 0.3, 70)], 1):
        here, step = at(u, v), 1e-6
        assert np.allclose([[np.dot(here[a], here[b]) for a in "xyz"] for b in "xyz"], np.eye(3)) and np.allclose(np.cross(here["x"], here["y"]), here["z"])
        along, up = (at(u + step, v)["p"] - at(u - step, v)["p"]) / (2 * step), (at(u, v + step)["p"] - at(u, v - step)["p"]) / (2 * step)
        assert here["du"] == pytest.approx(along, abs=2e-5) and here["dv"] == pytest.approx(up, abs=2e-5)
        assert np.allclose(here["n"], np.cross(along, up) / np.linalg.norm(np.cross(along, up)), atol=3e-5) and np.dot(here["n"], here["z"]) > 0
        a, b = u / R, v / R
        foot = [(u, v, 0), (R * np.sin(a), v, R * np.cos(a)), (R * np.cos(b) * np.sin(a), R * np.sin(b), R * np.cos(b) * np.cos(a))][base]
        height = np.dot(here["p"] - foot, here["z"])
        assert np.allclose(here["p"], foot + height * here["z"]) and under(here["p"]) == pytest.approx([u, v])
        turns, fade = (2 if base == 0 else 7) * 2 * np.pi, np.cos(b) if base == 2 else 1
        if bumps != SCRATCHES:
            assert height == pytest.approx((bumps == WAVES) * 0.8 / turns * np.sin(turns * u) * np.sin(turns * v) * fade)
        rise = np.array([np.dot(along, here["z"]), np.dot(up, here["z"])])
        slope = np.hypot(np.dot(along, here["z"]) / np.linalg.norm(along - rise[0] * here["z"]), np.dot(up, here["z"]) / np.linalg.norm(up - rise[1] * here["z"]))
        assert bottom - 1e-12 <= height <= top + 1e-12 and slope <= lipschitz * (1 + 1e-6)
        heights.append(height)
        steepest = max(steepest, np.hypot(*rise) / fade)
        down = cast(here["p"] + 0.03 * here["z"] + (top - height) * here["z"], -here["z"])
        assert down == pytest.approx(0.03 + top - height, abs=1e-6)
    assert (bumps == SMOOTH) == (np.ptp(heights) < 1e-12) and (bumps == SMOOTH or 0.55 < steepest <= 0.8 + 0.1 * (base == 2))
    assert top == pytest.approx(0.8 / ((2 if base == 0 else 7) * 2 * np.pi) if bumps == WAVES else 0) and (bottom == -top or bumps == SCRATCHES)
    assert window() == pytest.approx([0.5, 0.5, 0.5] if base == 0 else [1.16 * R, 0, 0])
    for x, y in ((0.1, 0.2), (-0.2, 0.3), (0.25, 0.25), (0.5, 0)):
        inside = base == 0 or x * x + y * y * (base == 2) < R * R
        status, (u, v, _none) = seen(x, y)
        assert status == inside and (not inside or np.allclose((at(u, v)["p"] - at(u, v)["z"] * np.dot(at(u, v)["p"] - [u, v, 0], at(u, v)["z"]) if base == 0 else
                                                                at(u, v)["z"] * R)[:1 + (base != 1)], (x, y)[:1 + (base != 1)]))


@pytest.mark.parametrize("base", range(3), ids=BASES)
def test_rays_meet_it_first(surfaces, base):
    """Slanted ones: where they end is on the surface, and nothing of it lay before; what goes away meets nothing."""
    at, under, cast, _seen, _window, (top, _bottom, _lipschitz) = surfaces(base, WAVES, 0.8)
    height = lambda p: np.dot(p - at(*under(p))["p"], at(*under(p))["z"])  # noqa: E731
    random, met = np.random.default_rng(7), 0
    for _ in range(30):
        start = at(*random.uniform(-0.3, 0.3, 2))
        along = -start["z"] + random.uniform(-2.5, 2.5) * start["x"] + random.uniform(-2.5, 2.5) * start["y"]
        along /= np.linalg.norm(along)
        start = start["p"] + (top + 0.05) * start["z"]
        t = cast(start, along)
        far = 0.6 if t < 0 else t
        way = [height(start + s * along) for s in np.linspace(0, far - 1e-6, 40)]
        met += t > 0
        assert min(way) > -2e-4 and (t < 0 or abs(height(start + t * along)) < 1e-6)
        assert cast(start, -along) == -1
    assert met > (20, 12, 4)[base]


# ---- compare/bumps/field.c, its grids small

SINE, NOISE, FRACTAL, LONG_AND_FINE, ROOFS, LETTER, PITS, GROOVES, HALF, ACROSS, ALONG = range(11)
FINE = 256


class Field(ctypes.Structure):
    _fields_ = [("kind", ctypes.c_int), ("side", ctypes.c_int), *((name, ctypes.POINTER(ctypes.c_float)) for name in ("height", "slope_x", "slope_y", "xx_", "xy_", "yy_")),
                *((name, ctypes.c_double) for name in ("low", "high", "steepest", "xx", "xy", "yy"))]


@pytest.fixture(scope="module")
def fields(tmp_path_factory):
    """(a function (kind, slope) that makes a field, its functions)."""
    text = (programs.HERE / "bumps/field.c").read_text(encoding="utf-8")
    small = text.replace("COARSE = 512, FINE = 1024", f"COARSE = 128, FINE = {FINE}")
    assert small != text
    made = library(tmp_path_factory.mktemp("field"), small, programs.HERE / "bumps")
    made.field_normal.restype, made.field_cast.restype, kept = Vec, ctypes.c_double, []

    def field(kind, slope):
        one = Field()
        assert made.field_make(ctypes.byref(one), kind, ctypes.c_double(slope))
        kept.append(one)
        return one
    yield field, made
    for one in kept:
        made.field_free(ctypes.byref(one))
        assert not one.height and one.side == 0


def grid(one, name="height"):
    return np.ctypeslib.as_array(getattr(one, name), (one.side, one.side)).astype(float)  # rows of y


def moment_at(made, one, x, y):
    found = (ctypes.c_double * 3)()
    made.field_moment(ctypes.byref(one), ctypes.c_double(x), ctypes.c_double(y), found)
    return np.array(found)


@pytest.mark.parametrize("kind", [SINE, NOISE, FRACTAL, LONG_AND_FINE, ROOFS, HALF, ACROSS, ALONG])
def test_slopes_of_fields(fields, kind):
    """Twice their variance is the square of what was asked; bounds bound; slopes are those of heights, over the seam as well."""
    field, _made = fields
    one = field(kind, 0.5)
    side, cell = one.side, 2 * np.pi / one.side
    assert side == (FINE if FRACTAL <= kind <= HALF else 128)
    h, sx, sy = (grid(one, name) for name in ("height", "slope_x", "slope_y"))
    assert np.allclose(sx, (np.roll(h, -1, 1) - np.roll(h, 1, 1)) / (2 * cell), atol=1e-5) and np.allclose(sy, (np.roll(h, -1, 0) - np.roll(h, 1, 0)) / (2 * cell), atol=1e-5)
    assert (one.low, one.high) == (h.min(), h.max()) and one.steepest == pytest.approx(1.02 * np.hypot(sx, sy).max())
    assert (one.xx, one.xy, one.yy) == pytest.approx(((sx * sx).mean(), (sx * sy).mean(), (sy * sy).mean()))
    # as waves have it, not the grid's differences
    k = np.fft.fftfreq(side, 1 / side)
    spectrum = np.abs(np.fft.fft2(h) / side**2)**2
    exact = (spectrum * (k[:, None]**2 + k[None]**2))
    x, y = np.meshgrid(*[np.arange(side) * cell] * 2)
    if kind in (SINE, ACROSS, ALONG):
        assert np.allclose(h, 0.5 * np.sin(x) * (np.sin(y) if kind == SINE else 1), atol=1e-6)
    elif kind == ROOFS:  # .86² of the slopes are two roofs'
        roof = np.abs((x + np.pi / 2) % np.pi - np.pi / 2) * 0.5 * 0.86 / np.sqrt(2)
        fine = h - roof
        waves = np.abs(np.fft.fft2(fine) / side**2)**2
        ring = np.hypot(k[:, None], k[None])
        assert waves[(ring < 49.9) | (ring > 70.1)].sum() < 1e-3 * waves.sum() and (waves * ring**2).sum() == pytest.approx((0.51 * 0.5)**2 / 2, rel=0.02)
    elif kind == HALF:
        middle = np.abs(x - np.pi) < np.pi / 2 - 0.15
        assert (h[np.abs(x - np.pi) > np.pi / 2 + 0.16] == 0).all() and np.allclose(h[middle], grid(field(NOISE, 0.5))[::, ::].repeat(2, 0).repeat(2, 1)[middle], atol=0.05)
    else:
        assert exact.sum() == pytest.approx(0.5**2 / 2, rel=0.02)
        ring, waves = np.hypot(k[:, None], k[None]), spectrum > 1e-9 * spectrum.max()
        low, high = {NOISE: (3, 7), FRACTAL: (2, 31), LONG_AND_FINE: (6, 70)}[kind]
        assert ring[waves].min() >= low and ring[waves].max() <= high and (kind != NOISE or waves.sum() > 120)
        if kind == FRACTAL:
            assert [exact[(ring >= 2**o) & (ring < 2**(o + 1)) & waves].sum() for o in (1, 2, 3, 4)] == pytest.approx([0.5**2 / 8] * 4, rel=0.1)
        if kind == LONG_AND_FINE:
            parts = [exact[waves & inside].sum() / 0.125 for inside in (ring < 11, ring > 49)]
            assert parts == pytest.approx([0.64**2, 0.77**2], rel=0.02)
            assert all(25 < (waves & inside).sum() / 2 < 60 for inside in (ring < 11, ring > 49)) and not waves[(ring > 10.1) & (ring < 49.9)].any()


def test_uneven_fields(fields):
    """A letter stands a quarter of its slope high, its edges bevelled; pits are bowls, grooves cosines: as deep as that makes their slopes."""
    field, _made = fields
    cell = 2 * np.pi / FINE
    x, y = np.meshgrid(*[np.arange(FINE) * cell] * 2)
    letter = grid(field(LETTER, 2.0))
    ring, bar = np.abs(np.hypot(x - np.pi, y - np.pi) - 1.7), np.maximum(np.abs(y - np.pi), np.abs(x - np.pi) - 2.3)
    top, flat = (ring < 0.14) | (bar < 0.14), (ring > 0.41) & (bar > 0.41)
    assert np.allclose(letter[top], 0.5) and (letter[flat] == 0).all() and top.mean() + flat.mean() > 0.7
    assert np.hypot(*np.gradient(letter, cell))[~top & ~flat].max() == pytest.approx(2, rel=0.05)
    pits = field(PITS, 0.5)
    h = grid(pits)
    assert h.max() == 0 and -0.5 * 0.5 * 0.2 <= h.min() < -0.048 and 0.05 < (h < 0).mean() < 0.121 and pits.steepest < 0.51 and pits.steepest > 0.3
    i, j = np.unravel_index(np.argmin(h), h.shape)
    below = h[i, (j + np.arange(-4, 5)) % FINE]
    assert np.polyfit(np.arange(-4, 5) * cell, below, 2)[0] == pytest.approx(0.5 * 0.5 / 0.2, rel=0.02)
    one = field(GROOVES, 0.5)
    h, wide = grid(one), 11 * 2 * np.pi / FINE
    assert h.max() == 0 and h.min() == pytest.approx(-0.5 * wide / np.pi, rel=0.02) and one.steepest <= 1.02 * 0.5 * 1.01 and one.steepest > 0.4


@pytest.mark.parametrize("kind", [SINE, NOISE, LETTER, GROOVES])
def test_moments_of_fields(fields, kind):
    """Of an even field those of the whole; of an uneven one those of what is near, whose mean is that of the whole."""
    field, made = fields
    one = field(kind, 1.0)
    whole = np.array([one.xx, one.xy, one.yy])
    near = np.stack([grid(one, name) for name in ("xx_", "xy_", "yy_")])
    assert near.mean((1, 2)) == pytest.approx(whole, rel=1e-4, abs=1e-6)
    if kind in (SINE, NOISE):
        assert np.allclose(near, whole[:, None, None], rtol=1e-5)
        return
    if kind == LETTER:  # which is its own mirror image
        for image in (near[[0, 2]][:, :, (-np.arange(FINE)) % FINE], near[[0, 2]][:, (-np.arange(FINE)) % FINE]):
            assert np.allclose(near[[0, 2]], image, atol=1e-5 * near[0].max())
        assert moment_at(made, one, 0.1, 0.1)[0] < 0.3 * one.xx < one.xx < moment_at(made, one, np.pi + 1.7 * 0.7, np.pi + 1.7 * 0.7)[0]
    # by windows of three boxes, as wide as leaves a fifth of the variance
    slopes = [grid(one, name) for name in ("slope_x", "slope_y")]

    def blurred(values, half):
        k = np.fft.fftfreq(FINE)
        box = np.array([np.cos(2 * np.pi * np.outer(np.arange(-half, half + 1), [f])).mean() for f in k])**3
        return np.fft.ifft2(np.fft.fft2(values) * box[:, None] * box[None]).real
    half = next(half for half in (3, 6, 12, 24, 48) if half >= FINE / 8 or sum((blurred(s, half)**2).mean() for s in slopes) <= 0.2 * (one.xx + one.yy))
    wanted = [blurred(a * b, half) for a, b in ((slopes[0], slopes[0]), (slopes[0], slopes[1]), (slopes[1], slopes[1]))]
    spread = (((wanted[0] + wanted[2]) / (one.xx + one.yy))**2).mean()
    share = np.clip((spread - 1.5) / 0.3, 0, 1)
    for k in range(3):
        assert np.allclose(near[k], whole[k] + share * (wanted[k] - whole[k]), atol=2e-3 * one.xx), (half, spread)
    i, j = 31, 200
    assert moment_at(made, one, (j + 0.25) * 2 * np.pi / FINE, (i + 0.5) * 2 * np.pi / FINE) == pytest.approx(
        0.5 * (0.75 * near[:, i, j] + 0.25 * near[:, i, j + 1]) + 0.5 * (0.75 * near[:, i + 1, j] + 0.25 * near[:, i + 1, j + 1]), rel=1e-4)


@pytest.mark.parametrize("kind", [SINE, ACROSS])
def test_rays_meet_fields(fields, kind):
    """s sin x (sin y): normals, and what rays meet first, by marching over the formula."""
    field, made = fields
    one, random = field(kind, 1.0), np.random.default_rng(4)
    height = lambda x, y: np.sin(x) * (np.sin(y) if kind == SINE else 1)  # noqa: E731
    met = 0
    for _ in range(60):
        x, y, elevation, azimuth = *random.uniform(-9, 9, 2), random.uniform(0.15, 1.5), random.uniform(0, 6)
        n = made.field_normal(ctypes.byref(one), ctypes.c_double(x), ctypes.c_double(y))
        slope = np.array([np.cos(x) * (np.sin(y) if kind == SINE else 1), np.sin(x) * np.cos(y) * (kind == SINE), -1])
        assert np.allclose([n.x, n.y, n.z], -slope / np.linalg.norm(slope), atol=2e-3) and n.x**2 + n.y**2 + n.z**2 == pytest.approx(1)
        along = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), -np.sin(elevation)])
        cast = lambda start, d: made.field_cast(ctypes.byref(one), Vec(*start), Vec(*d))  # noqa: E731
        start = np.array([x, y, 1.1])
        s = np.linspace(0, 2.2 / np.sin(elevation), 4000)
        way = start[:, None] + along[:, None] * s
        under = way[2] < height(way[0], way[1])
        clear = way[2] - height(way[0], way[1])
        t = cast(start, along)
        first = s[np.argmax(under)]
        assert t == pytest.approx(first, abs=0.02 + 0.05 / np.sin(elevation)) or np.abs(clear[: np.argmax(under)]).min() < 3e-3
        assert cast(start, -along) == -1
        up = along * (1, 1, -1)  # from the surface on: hidden by what stands in its way, or not
        foot = np.array([x, y, height(x, y) + 0.02])
        way = foot[:, None] + up[:, None] * np.linspace(0.01, 8, 4000)
        over = (way[2] - height(way[0], way[1])).min()
        if abs(over) > 0.02:
            assert (cast(foot, up) < 0) == (over > 0)
            met += over < 0
    assert met > 5


# ---- compare/horizon.c


@pytest.fixture(scope="module")
def bumps(tmp_path_factory):
    """compare/horizon.c's own functions: field 0 is the sinusoid, 1 the random one."""
    ctypes.CDLL(next(programs.BUILD.glob("libshade.so.*")), ctypes.RTLD_GLOBAL)
    made = library(tmp_path_factory.mktemp("horizon"), """
#define main horizon_main
#include "horizon.c"
int shade_whole_write(const char *path, const char *text, size_t length, char *why, size_t room) { return 0; }
static field of[2];
void one_begin(void) { random_state = 1; of[0] = sinusoid(0.6); of[1] = band_limited(0.6 / sqrt(2)); }
double one_height(int k, double u, double v) { return height(&of[k], u, v); }
vec one_normal(int k, double u, double v) { return normal(&of[k], u, v); }
double one_cast(int k, vec from, vec along) { return cast(&of[k], from, along); }
int one_lit(int k, vec p, vec n, vec wi) { return lit(&of[k], p, n, wi); }
double one_bound(int k, int steepest) { return steepest ? of[k].steepest : of[k].top; }
vec one_at(double elevation, double azimuth) { return at_angles(elevation, azimuth); }
void one_means(int which, vec n, vec wo, int count, double to[4]) {
  const shade_bsdf b = material(which, 0);
  for (int i = 0; i < count; i++) {
    double weight;
    const vec w = sample(which, &b, n, wo, &weight);
    to[0] += weight / count, to[1] += weight * w.x / count, to[2] += weight * w.y / count, to[3] += weight * w.z / count;
  }
}
double one_facet(int which, vec n, vec wi, vec wo) { const shade_bsdf b = material(which, 0); return facet(&b, n, wi, wo); }
""", programs.HERE, programs.ROOT / "libshade", programs.ROOT / "libshade/include")
    for name in ("height", "cast", "bound", "facet"):
        getattr(made, f"one_{name}").restype = ctypes.c_double
    made.one_normal.restype = made.one_at.restype = Vec
    made.one_begin()
    return made


def test_bumps_under_horizons(bumps):
    """Plate.py's sinusoid, and waves of the same mean square slope that meet over the seams; normals by differences."""
    random = np.random.default_rng(3)
    for k in (0, 1):
        height = lambda u, v, k=k: bumps.one_height(k, ctypes.c_double(u), ctypes.c_double(v))  # noqa: E731
        squares = []
        for u, v in random.random((400, 2)):
            step = 1e-6
            slope = np.array([height(u + step, v) - height(u - step, v), height(u, v + step) - height(u, v - step)]) / (2 * step)
            n = bumps.one_normal(k, ctypes.c_double(u), ctypes.c_double(v))
            assert np.allclose(np.array([n.x, n.y]) / n.z, -slope, atol=1e-6) and n.x**2 + n.y**2 + n.z**2 == pytest.approx(1)
            assert height(u + 1, v) == pytest.approx(height(u, v)) == height(u, v - 1) and abs(height(u, v)) <= bumps.one_bound(k, 0) and np.hypot(*slope) <= bumps.one_bound(k, 1)
            assert k or height(u, v) == pytest.approx(0.6 / (4 * np.pi) * np.sin(4 * np.pi * u) * np.sin(4 * np.pi * v))
            squares.append((slope**2).sum())
        assert np.mean(squares) == pytest.approx(0.6**2 / 2, rel=0.1)
    values = np.array([[bumps.one_height(1, ctypes.c_double(u), ctypes.c_double(v)) for u in np.arange(16) / 16] for v in np.arange(16) / 16])
    spectrum, waves = np.abs(np.fft.fft2(values)), np.hypot(*np.meshgrid(*[np.fft.fftfreq(16, 1 / 16)] * 2))
    kept = spectrum > 1e-9 * spectrum.max()
    assert waves[kept].min() >= 2 and waves[kept].max() <= 5 and 12 <= kept.sum() <= 24
    up = bumps.one_at(ctypes.c_double(30), ctypes.c_double(60))
    assert (up.x, up.y, up.z) == pytest.approx((0.75**0.5 / 2, 0.75, 0.5))


def test_rays_over_bumps(bumps):
    random, hidden = np.random.default_rng(5), 0
    for k in (0, 1):
        height = np.vectorize(lambda u, v, k=k: bumps.one_height(k, ctypes.c_double(u), ctypes.c_double(v)))
        top = bumps.one_bound(k, 0)
        for _ in range(30):
            elevation, azimuth = random.uniform(0.1, 1.4), random.uniform(0, 6)
            along = np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])
            u, v = random.random(2)
            foot = np.array([u, v, height(u, v)])
            way = foot[:, None] + along[:, None] * np.linspace(0, (top - foot[2]) / along[2] + 0.01, 120)[2:]
            over = (way[2] - height(way[0], way[1])).min()
            n = bumps.one_normal(k, ctypes.c_double(u), ctypes.c_double(v))
            facing = along @ [n.x, n.y, n.z]
            if abs(over) > 2e-3:
                assert bumps.one_lit(k, Vec(*foot), n, Vec(*along)) == (facing > 0 and over > 0)
                hidden += facing > 0 > over
                assert not bumps.one_lit(k, Vec(*foot), Vec(-n.x, -n.y, -n.z), Vec(*along)) or facing < 0
            start = foot + along * (1.001 * top - foot[2]) / along[2]
            t = bumps.one_cast(k, Vec(*start), Vec(*-along))
            way = start[:, None] - along[:, None] * np.linspace(0, t, 80)[:-1]
            there = start - t * along
            assert there[2] == pytest.approx(float(height(*there[:2])), abs=1e-6) and (way[2] - height(way[0], way[1])).min() > -2e-4
            assert bumps.one_cast(k, Vec(*start), Vec(*along)) == -1
    assert hidden > 1


@pytest.mark.parametrize("which", [0, 1, 2], ids=["ashikhmin_shirley", "ggx", "lambert"])
def test_draws_from_facets(bumps, which):
    """Weights are those of f cos over the density: their mean is the albedo, that of the directions where it is sent; whatever the facet's tilt."""
    z, turn = ((np.arange(90) + 0.5) / 90)[:, None], 2 * np.pi * (np.arange(90) + 0.5) / 90
    local = np.stack(np.broadcast_arrays(np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z), -1).reshape(-1, 3)
    for tilt, eye in (((0, 0, 1), (0.3, 0.4, 0.75**0.5)), ((0.36, 0.48, 0.8), (-0.2, 0.1, 0.95**0.5))):
        n = np.array(tilt, float)
        x = np.array([n[2], 0, -n[0]]) / np.hypot(n[0], n[2])
        around = local @ np.stack([x, np.cross(n, x), n])
        values = np.array([bumps.one_facet(which, Vec(*n), Vec(*w), Vec(*eye)) for w in around]) * 2 * np.pi / len(around)
        means = (ctypes.c_double * 4)()
        bumps.one_means(which, Vec(*n), Vec(*eye), 20000, means)
        assert list(means) == pytest.approx([values.sum(), *(values[:, None] * around).sum(0)], abs=0.015), tilt
        assert which != 2 or means[0] == pytest.approx(1)
