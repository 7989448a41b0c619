# SPDX-License-Identifier: Apache-2.0
"""The detail methods of the stability atlas: as papers print them, literally, and as the library has them.

docs/theory/papers.md lists the mistakes. Beside test_papers.c this is the only place of printed formulas. A form's
`value(n, h, shape)` is D'(h) in 1/sr, NaN and infinite as the formula has it. n, h: (…, 3); shape: exponents (ex, ey)
of Ashikhmin-Shirley, or alphas. x lies along the grooves, but for `groove="y"`.
"""
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import programs  # noqa: F401  says where shade is
import shade

EXPONENTS, ALPHAS = (200.0, 10.0), (0.1, 0.4)
PI = np.pi


def dot(a, b):
    """Spelt out: numpy takes five times as long for a sum over three."""
    p = a * b
    return p[..., 0] + p[..., 1] + p[..., 2]


# ---- distributions of a vector (x, y, z), which need not be unit: that is part of what is shown ----

def ashikhmin_shirley(x, y, z, ex, ey, sin2=None):
    """[AshikhminShirley2000 Eq. 4]; sin2: what the exponent's fraction is over, x² + y² unless given."""
    sin2 = x * x + y * y if sin2 is None else sin2
    exponent = np.where(sin2 > 0, (ex * x * x + ey * y * y) / np.where(sin2 > 0, sin2, 1), (ex + ey) / 2)
    power = np.power(above(z), exponent)
    return np.where(z > 0, np.sqrt((ex + 1) * (ey + 1)) / (2 * PI) * power, np.where(np.isnan(z), z, 0))


def above(z):
    """z where it is above 0, else 1: for what is not used there."""
    return np.where(z > 0, z, 1)


def ward(x, y, z, ax, ay):
    return np.where(z > 0, np.exp(-((x / ax) ** 2 + (y / ay) ** 2) / above(z) ** 2) / (PI * ax * ay), 0)


def ward_half(x, y, z, ax, ay):
    return np.where(z > 0, np.exp(-2 * ((x / ax) ** 2 + (y / ay) ** 2) / (1 + above(z))) / (PI * ax * ay), 0)


def ward_half_printed(x, y, z, ax, ay):
    """Eq. 3 of both metal papers: no squares, and no 1/(π αx αy): that is added, so that it can be compared."""
    return np.where(z > 0, np.exp(-2 * (x / ax + y / ay) / (1 + above(z))) / (PI * ax * ay), 0)


def beckmann(x, y, z, ax, ay):
    return ward(x, y, z, ax, ay) / above(z) ** 4


def ggx(x, y, z, ax, ay):
    slope2 = ((x / ax) ** 2 + (y / ay) ** 2) / above(z) ** 2
    return np.where(z > 0, 1 / (PI * ax * ay * above(z) ** 4 * (1 + slope2) ** 2), 0)


LOBES = {"ashikhmin_shirley": ashikhmin_shirley, "ward": ward, "ward_half": ward_half, "beckmann": beckmann,
         "ggx": ggx}


# ---- the truth: the frame of the displaced surface, long-hand ----------------------------------------

def displaced(n, h, groove="x"):
    """h in the frame of the height field whose normal is n: x' along dP/du (groove y: y' along dP/dv)."""
    if groove == "y":
        y, x, z = displaced(n[..., [1, 0, 2]], h[..., [1, 0, 2]])
        return x, y, z
    zero = np.zeros_like(n[..., 0])
    x = np.stack([n[..., 2], zero, -n[..., 0]], -1)
    x = x / np.sqrt(dot(x, x))[..., None]
    y = np.cross(n, x)
    return dot(x, h), dot(y, h), dot(n, h)


def truth(n, h, shape, mdf="ashikhmin_shirley", groove="x"):
    return LOBES[mdf](*displaced(n, h, groove), *shape)


# ---- as printed ---------------------------------------------------------------------------------------

def matrix(n, h, sign=-1):
    """Rows 1 and 2 of Kang and Cho's matrix (Eq. 9, 11) times h, and n·h; sign +1 as printed."""
    nx, ny, nz = np.moveaxis(n, -1, 0)
    hx, hy, hz = np.moveaxis(h, -1, 0)
    return nz * hx - nx * hz, -nx * ny * hx + (1 - ny * ny) * hy + sign * ny * nz * hz, dot(n, h)


def row_two(n, h, shape):
    x, y, z = matrix(n, h, +1)
    return ashikhmin_shirley(x, y, z, *shape)


def row_three(n, h, shape):
    x, y, _z = matrix(n, h)
    return ashikhmin_shirley(x, y, dot(n, n), *shape)


def axis_v(n, h, shape):
    """v' = (0, −nz, ny), said to be w' × u'."""
    x, _y, z = matrix(n, h)
    return ashikhmin_shirley(x, -n[..., 2] * h[..., 1] + n[..., 1] * h[..., 2], z, *shape)


def denominator(n, h, shape):
    x, y, z = matrix(n, h)
    return ashikhmin_shirley(x, y, z, *shape, sin2=1 - z * z)


def always_x(n, h, shape):
    """x' = dP/du where the grooves run along y."""
    x, y, z = matrix(n, h)
    return ashikhmin_shirley(x, y, z, *shape)


def short_of_l(mdf):
    def value(n, h, shape):
        return LOBES[mdf](*matrix(n, h), *shape)
    return value


def without_squares(n, h, shape):
    return ward_half_printed(*displaced(n, h), *shape)


def ward_of_h(n, h, shape):
    """Eq. 8, squares mended: z of the rotated h, x and y of h itself."""
    return ward_half(h[..., 0], h[..., 1], dot(n, h), *shape)


def unnormalised(mdf):
    """(hx, hy, n·h) as the argument of D."""
    def value(n, h, shape):
        return LOBES[mdf](h[..., 0], h[..., 1], dot(n, h), *shape)
    return value


def warped(n, h, root):
    """p of the printed inverse warps (Eq. 5 with its root, the linear one without)."""
    centre, place = n[..., 0] + 1j * n[..., 1], h[..., 0] + 1j * h[..., 1]
    along = (place - centre) / np.abs(place - centre)  # 0/0 at h = n
    b = (along * centre.conj()).real
    reach = -b + np.sqrt(b * b + 1 - np.abs(centre) ** 2)
    fade = 1 - np.abs(place - centre) / reach
    return place - (np.sqrt(fade) if root else fade) * centre


def deformed(root):
    def value(n, h, shape):
        p = warped(n, h, root)
        return ashikhmin_shirley(p.real, p.imag, np.sqrt(1 - np.abs(p) ** 2), *shape)
    return value


def fibre(light):
    """Hast, Wesslén and Seipel's Eq. 10, fibre along x, normal z: (l·n_max)(1 − n_min·b)/π, b = z × t."""
    t, n = np.array([1.0, 0, 0]), np.array([0.0, 0, 1])
    unit = lambda v: v / np.sqrt(dot(v, v))[..., None]  # noqa: E731
    with np.errstate(all="ignore"):
        most = unit(light - dot(light, t)[..., None] * t)
        least = unit(np.cross(light, most))
        return dot(light, most) * (1 - dot(least, np.cross(n, t))) / PI


# ---- the list ---------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Form:
    """word: in rows and commands. printed: value() is a formula of a paper, else the library's method `detail`.
    detail: of the library, what stands in its place. smooth: the warp with the root, where it is a warp."""

    word: str
    label: str
    family: str
    detail: str
    mdf: str = "ashikhmin_shirley"
    printed: Callable | None = None
    source: str = ""
    groove: str = "x"
    warp: str = ""

    @property
    def shape(self):
        first = EXPONENTS if self.mdf == "ashikhmin_shirley" else ALPHAS
        return first if self.groove == "x" else first[::-1]

    def material(self, shape=None, **more):
        names = ("ex", "ey") if self.mdf == "ashikhmin_shirley" else ("ax", "ay")
        return shade.Material(mdf=self.mdf, detail=self.detail, groove=self.groove, fresnel="none",
                              **{"brdf": "ashikhmin_shirley", **dict(zip(names, shape or self.shape)), **more})

    def value(self, n, h, shape=None):
        if self.printed is None:
            return shade.D(self.material(shape), n, h)
        with np.errstate(all="ignore"):
            return self.printed(n, h, shape or self.shape)

    def truth(self, n, h, shape=None):
        return truth(n, h, shape or self.shape, self.mdf, self.groove)

    def peak(self, shape=None):
        a, b = shape or self.shape
        return np.sqrt((a + 1) * (b + 1)) / (2 * PI) if self.mdf == "ashikhmin_shirley" else 1 / (PI * a * b)


ROTATION, WARP, USUAL, SLOPES = "rotation", "warp", "usual", "slopes"
# of the library those that need no slopes of a map, without which `mutual` is `hard`
HORIZONS = tuple(word for word in shade.choices("horizon") if word != "mutual")

FORMS = {form.word: form for form in (
    Form("rotate_row_two", "rotate, row 2 as printed", ROTATION, "rotate", printed=row_two,
         source="Kang and Cho, Eq. 9 and 11"),
    Form("rotate_row_three", "rotate, row 3 as printed", ROTATION, "rotate", printed=row_three,
         source="Kang and Cho, Eq. 11"),
    Form("rotate_axis_v", "rotate, v′ as printed", ROTATION, "rotate", printed=axis_v, source="Kang and Cho, Eq. 9"),
    Form("rotate_denominator", "rotate over 1 − d²", ROTATION, "rotate", printed=denominator,
         source="Kang and Cho, Eq. 7 with Eq. 11"),
    Form("rotate_always_x", "rotate, x′ for grooves on y", ROTATION, "rotate", printed=always_x, groove="y",
         source="Kang and Cho, Fig. 5"),
    Form("rotate", "rotate", ROTATION, "rotate"),
    Form("deform_linear_printed", "deform linear, as printed", WARP, "deform_linear", printed=deformed(False),
         source="Kang, Cho and Kim, Eq. 3", warp="linear"),
    Form("deform_smooth_printed", "deform smooth, as printed", WARP, "deform_smooth", printed=deformed(True),
         source="Kang, Cho and Kim, Eq. 5", warp="smooth"),
    Form("deform_linear", "deform linear", WARP, "deform_linear", warp="linear"),
    Form("deform_smooth", "deform smooth", WARP, "deform_smooth", warp="smooth"),
    Form("deform_linear_conserving", "deform linear, conserving", WARP, "deform_linear_conserving", warp="linear"),
    Form("deform_smooth_conserving", "deform smooth, conserving", WARP, "deform_smooth_conserving", warp="smooth"),
    Form("none", "none", USUAL, "none"),
    Form("perturb", "perturb (Eq. 7 of h)", USUAL, "perturb", source="Kang and Cho, Eq. 7 read of h itself"),
    Form("gram_schmidt", "Gram-Schmidt", USUAL, "gram_schmidt"),
    Form("shortest_arc", "shortest arc", USUAL, "shortest_arc"),
    Form("ward_no_squares", "Ward without squares", SLOPES, "rotate", "ward_half", without_squares,
         "both metal papers, Eq. 3"),
    Form("ward_of_h", "Ward, x and y of h", SLOPES, "rotate", "ward_half", ward_of_h, "Kang and Cho, Eq. 8"),
    Form("beckmann_unnormalised", "Beckmann of (hx, hy, n·h)", SLOPES, "rotate", "beckmann", unnormalised("beckmann")),
    Form("beckmann_short_of_l", "Beckmann rotated without 1/L", SLOPES, "rotate", "beckmann", short_of_l("beckmann"),
         "Kang and Cho, Eq. 11"),
    Form("ggx_unnormalised", "GGX of (hx, hy, n·h)", SLOPES, "rotate", "ggx", unnormalised("ggx")),
    Form("ggx_short_of_l", "GGX rotated without 1/L", SLOPES, "rotate", "ggx", short_of_l("ggx"),
         "Kang and Cho, Eq. 11"),
    Form("ward_half_rotate", "Ward, rotate", SLOPES, "rotate", "ward_half"),
    Form("beckmann_rotate", "Beckmann, rotate", SLOPES, "rotate", "beckmann"),
    Form("ggx_rotate", "GGX, rotate", SLOPES, "rotate", "ggx"),
)}
