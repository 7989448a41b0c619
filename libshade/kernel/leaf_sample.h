/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Drawing half vectors. A proposal lobe is drawn in a carried frame and has a density of its
 * own; kx and ky are its exponents (phong) or 1/alpha^2 (the others). Draws are accurate to
 * a few roundings of the type; whatever they miss, the density is that of the direction that
 * was returned.
 */

/* Exclusive upper end of a uniform number, and the least that is not 0. */
#undef BELOW_ONE
#if SHADE_FLOAT
#define BELOW_ONE 0x1.fffffep-1f
#else
#define BELOW_ONE 0x1.fffffffffffffp-1
#endif
#undef LEAST_UNIFORM
#define LEAST_UNIFORM (R(0.5) * (1 - BELOW_ONE))

typedef struct FN(pair) {
  real x, y;
} FN(pair);

typedef struct FN(triple) {
  real x, y, z;
} FN(triple);

/* (cos, sin) of 2 pi u, u in [0, 1]: Taylor's series within an eighth of a turn of an axis. */
LEAF FN(pair) FN(circle)(real u) {
#if SHADE_FLOAT
  const real magic = 12582912; /* adding it rounds to a whole number */
#else
  const real magic = 6755399441055744.0;
#endif
  real shifted = 4 * u + magic;
  real_bits quarter = FN(to_bits)(shifted);
  real a = (4 * u - (shifted - magic)) * R(1.57079632679489661923);
  real z = a * a;
#if SHADE_FLOAT
  real s = a + a * z * (-1 / 6.0f + z * (1 / 120.0f + z * (-1 / 5040.0f + z / 362880.0f)));
  real c = 1 - z * (0.5f - z * (1 / 24.0f - z * (1 / 720.0f - z / 40320.0f)));
#else
  real s = 1 / 6227020800.0 - z / 1307674368000.0;
  s = -1 / 5040.0 + z * (1 / 362880.0 + z * (-1 / 39916800.0 + z * s));
  s = a + a * z * (-1 / 6.0 + z * (1 / 120.0 + z * s));
  real c = 1 / 479001600.0 - z * (1 / 87178291200.0 - z / 20922789888000.0);
  c = 1 / 24.0 - z * (1 / 720.0 - z * (1 / 40320.0 - z * (1 / 3628800.0 - z * c)));
  c = 1 - z * (0.5 - z * c);
#endif
  real sign = (quarter & 2) ? R(-1.0) : R(1.0);
  FN(pair) p = {sign * ((quarter & 1) ? -s : c), sign * ((quarter & 1) ? c : s)};
  return p;
}

/* 1 - exp(-a), a >= 0, without cancellation. */
LEAF real FN(one_less_exp)(real a) {
#if SHADE_FLOAT
  const real limit = 86, magic = 12582912;
  real y = a < limit ? a : limit;
  real shifted = magic - y * SHADE_LOG2E_F;
  real k = shifted - magic;
  real r = (-y - k * SHADE_LN2_HIGH_F) - k * SHADE_LN2_LOW_F;
  real rest = r + r * r * SHADE_EXP_F(r);
  real scale = FN(from_bits)((FN(to_bits)(shifted) + 127u) << 23);
#else
  const real limit = 700, magic = 6755399441055744.0;
  real y = a < limit ? a : limit;
  real shifted = magic - y * SHADE_LOG2E_D;
  real k = shifted - magic;
  real r = (-y - k * SHADE_LN2_HIGH_D) - k * SHADE_LN2_LOW_D;
  real rest = r + r * r * SHADE_EXP_D(r);
  real scale = FN(from_bits)((FN(to_bits)(shifted) + 1023u) << 52);
#endif
  return (1 - scale) - scale * rest;
}

/* -ln(1 - u) and -ln u for u in [0, BELOW_ONE] and [LEAST_UNIFORM, 1]. */
LEAF real FN(log_left)(real u) {
  return FN(log1p_positive)(u / (1 - u));
}
LEAF real FN(minus_log)(real u) {
  return FN(log1p_positive)(FN(maximum)(1 - u, 0) / u);
}

/*
 * Half vectors by D itself: the azimuth by stretching a circle, then cos^(e+1) uniform.
 * Density: Ashikhmin-Shirley's D. [AshikhminShirley2000 Eq. 9-10, in all four quadrants at once]
 */
LEAF FN(triple) FN(draw_phong)(real u1, real u2, real kx, real ky) {
  FN(pair) p = FN(circle)(u1);
  real inverse = p.x * p.x / (kx + 1) + p.y * p.y / (ky + 1); /* 1/(e + 1) */
  real g = FN(log_left)(u2) * inverse;
  real sine = FN(root)(FN(one_less_exp)(2 * g));
  real x = p.x / FN(root)(kx + 1), y = p.y / FN(root)(ky + 1);
  real scale = sine / FN(root)(inverse);
  FN(triple) h = {x * scale, y * scale, FN(exp_negative)(g)};
  return h;
}

LEAF real FN(density_phong)(FN(lobe_point) p, real kx, real ky) {
  real peak = FN(root)((kx + 1) * (ky + 1)) * R(0.15915494309189533577);
  FN(lobe_ratio) r = {p.xx, p.yy, FN(absolute)(p.t), 1, p.t >= 0};
  return FN(ashikhmin_shirley)(r, kx, ky, peak);
}

/*
 * Ward's cheap form: the azimuth as if the lobe were narrow, then its polar angle exactly.
 * Density: D / (1 - exp(-2 k)), k = kx cos^2 + ky sin^2 of the azimuth, the mean over the pole.
 */
LEAF FN(triple) FN(draw_half)(real u1, real u2, real kx, real ky) {
  FN(pair) p = FN(circle)(u1);
  real x = p.x / FN(root)(kx), y = p.y / FN(root)(ky);
  real size2 = x * x + y * y;
  real two_k = 2 / size2;
  real part = u2 * FN(one_less_exp)(two_k);
  real m = FN(minimum)(FN(log_left)(FN(minimum)(part, BELOW_ONE)) / two_k, 1);
  real scale = FN(root)(m * (2 - m) / size2);
  FN(triple) h = {x * scale, y * scale, 1 - m};
  return h;
}

LEAF real FN(density_half)(FN(lobe_point) p, real kx, real ky) {
  real radius = p.xx + p.yy;
  /* without a choice, or both sides would be computed, 0/0 too */
  real k = (kx * p.xx + ky * p.yy + R(0.5) * TINY * (kx + ky)) / (radius + TINY);
  real peak = FN(root)(kx) * FN(root)(ky) * R(0.31830988618379067154);
  return FN(ward_half)(p, kx, ky, peak) / FN(one_less_exp)(2 * k);
}

/* Gaussian and GGX slopes. Density: Beckmann's or GGX's D times h.z. [Walter2007 Eq. 28, 35] */
LEAF FN(triple) FN(draw_gaussian)(real u1, real u2, real kx, real ky) {
  FN(pair) p = FN(circle)(u1);
  real r = FN(root)(FN(log_left)(u2));
  FN(triple) h = {r * p.x / FN(root)(kx), r * p.y / FN(root)(ky), 1};
  return h;
}
LEAF FN(triple) FN(draw_ggx)(real u1, real u2, real kx, real ky) {
  FN(pair) p = FN(circle)(u1);
  real r = FN(root)(u2 / (1 - u2));
  FN(triple) h = {r * p.x / FN(root)(kx), r * p.y / FN(root)(ky), 1};
  return h;
}

LEAF real FN(slope_peak)(real kx, real ky) {
  return FN(root)(kx) * FN(root)(ky) * R(0.31830988618379067154);
}
LEAF real FN(density_gaussian)(FN(lobe_point) p, real kx, real ky) {
  real u = 1 + FN(maximum)(p.t, 0);
  return FN(beckmann)(p, kx, ky, FN(slope_peak)(kx, ky)) / FN(root)(u);
}
LEAF real FN(density_ggx)(FN(lobe_point) p, real kx, real ky) {
  real u = 1 + FN(maximum)(p.t, 0);
  return FN(ggx)(p, kx, ky, FN(slope_peak)(kx, ky)) / FN(root)(u);
}

/*
 * GGX normals as o sees them: a point of the cap that the stretched eye's reflections fill,
 * added to that eye. o is in the lobe's frame. Density of wi: D / (2 o.z (1 + l)), l =
 * 1 + 2 Lambda(o). [DupuyBenyoub2023]
 */
LEAF FN(triple) FN(draw_visible_ggx)(real u1, real u2, real kx, real ky, FN(triple) o) {
  real ax = 1 / FN(root)(kx), ay = 1 / FN(root)(ky);
  real x = ax * o.x, y = ay * o.y;
  real inverse = 1 / FN(root)(FN(maximum)(x * x + y * y + o.z * o.z, TINY));
  x *= inverse;
  y *= inverse;
  real z = FN(minimum)(o.z * inverse, 1);
  FN(pair) p = FN(circle)(u1);
  real rise = (1 - u2) * (1 + z); /* z of the point, plus z */
  real sine = FN(root)(u2 * (1 + z) * (rise + (x * x + y * y) / (1 + z)));
  FN(triple) h = {ax * (sine * p.x + x), ay * (sine * p.y + y), rise};
  return h;
}

/* exp(t^2) erfc(t), t >= 0, where exp(-t^2) still counts. */
LEAF real FN(scaled_erfc)(real t) {
  real y = 1 / (1 + R(0.3) * t);
#if SHADE_FLOAT
  real z = FN(maximum)(y, SHADE_ERFCX_LEAST_F) - SHADE_ERFCX_MIDDLE_F;
  return SHADE_ERFCX_F(z);
#else
  real z = FN(maximum)(y, SHADE_ERFCX_LEAST_D) - SHADE_ERFCX_MIDDLE_D;
  return SHADE_ERFCX_D(z);
#endif
}

/*
 * t with probability u above it under the density (rise + lean t) exp(-t^2), t > -rise/lean:
 * the slope towards an eye of cosine `rise` and sine `lean`, per alpha. lean = 0 gives the
 * plain Gaussian. Newton on the logarithm of the nearer tail, kept inside the bracket it has
 * seen, from the mean of both limits; that of lean = 0 from an inverse of erf good to 2e-3.
 * Error: see test/test_sample.c. [HeitzDEon2014 for the density; Winitzki2008 for that inverse]
 */
typedef struct FN(slope_search) {
  real u, rise, lean, inverse; /* inverse: 1 over the whole integral */
  real low, high, t;
} FN(slope_search);

enum { FN(slope_steps) = SHADE_FLOAT ? 7 : 9 };

LEAF FN(slope_search) FN(slope_start)(real u_in, real rise, real lean) {
  const real half_root_pi = R(0.88622692545275801365), bend = R(0.147);
  FN(slope_search) s;
  s.u = FN(minimum)(FN(maximum)(u_in, LEAST_UNIFORM), BELOW_ONE);
  s.rise = rise;
  s.lean = lean;
  /* the floor: gcc squares before it takes the minimum */
  real a = FN(minimum)(rise / FN(maximum)(lean, R(1e-12)), 100);
  real ea = FN(exp_negative)(a * a);
  real whole = rise * half_root_pi * (2 - ea * FN(scaled_erfc)(a)) + R(0.5) * lean * ea;
  s.inverse = 1 / FN(maximum)(whole, TINY);
  real l = FN(log1p_positive)(FN(maximum)(R(0.25) / (s.u * (1 - s.u)) - 1, 0));
  real middle = R(0.63661977236758134308) / bend - R(0.5) * l;
  real size2 = FN(root)(middle * middle + l / bend) - middle;
  real plain = FN(root)(FN(maximum)(size2, 0));
  plain = s.u < R(0.5) ? plain : -plain;
  s.high = FN(root)(FN(minus_log)(s.u)); /* that of rise = 0, above every other */
  s.low = FN(maximum)(-a, SHADE_FLOAT ? R(-4.3) : R(-6.2));
  s.t = plain + (s.high - plain) / (1 + R(0.7) * a);
  s.t = FN(minimum)(FN(maximum)(s.t, R(0.9) * s.low), s.high);
  return s;
}

LEAF FN(slope_search) FN(slope_step)(FN(slope_search) s) {
  const real half_root_pi = R(0.88622692545275801365);
  real e = FN(exp_negative)(s.t * s.t);
  real tail = e * FN(scaled_erfc)(s.t < 0 ? -s.t : s.t);
  real above =
      (s.rise * half_root_pi * (s.t < 0 ? 2 - tail : tail) + R(0.5) * s.lean * e) * s.inverse;
  real density = FN(maximum)((s.rise + s.lean * s.t) * e * s.inverse, R(1e-30));
  s.low = above > s.u ? s.t : s.low;
  s.high = above > s.u ? s.high : s.t;
  real part = s.u < R(0.5) ? above : FN(maximum)(1 - above, 0);
  real want = s.u < R(0.5) ? s.u : 1 - s.u;
  real step = 2 * (part - want) / (part + want) * part / density;
  real next = s.t + (s.u < R(0.5) ? step : -step);
  s.t = ((next >= s.low) & (next <= s.high)) ? next : R(0.5) * (s.low + s.high);
  return s;
}

/* The eye stretched by alpha: its azimuth (c, s), and the cosine and sine of its angle. */
typedef struct FN(stretched) {
  real c, s, rise, lean;
} FN(stretched);

LEAF FN(stretched) FN(stretch_eye)(real ax, real ay, FN(triple) o) {
  real x = ax * o.x, y = ay * o.y;
  real lean = FN(root)(x * x + y * y);
  int upright = !(lean > R(1e-15));
  real inverse = 1 / (lean + TINY);
  real scale = 1 / FN(root)(lean * lean + o.z * o.z + TINY);
  FN(stretched)
  e = {upright ? 1 : x * inverse, upright ? 0 : y * inverse, o.z * scale, lean * scale};
  return e;
}

/* Beckmann's normals as o sees them, from their slopes along and across it; density as GGX's. */
LEAF FN(triple) FN(visible_gaussian)(real along, real across, real kx, real ky, FN(triple) o) {
  real ax = 1 / FN(root)(kx), ay = 1 / FN(root)(ky);
  FN(stretched) e = FN(stretch_eye)(ax, ay, o);
  FN(triple) h = {ax * (along * e.c - across * e.s), ay * (along * e.s + across * e.c), 1};
  return h;
}

/* D / (2 o.z (1 + l)): half vectors as the eye sees them, as a density of wi. */
LEAF real FN(density_visible)(real d, real cosine, real l) {
  return d / FN(maximum)(2 * cosine * (1 + l), R(1e-25));
}

/* The axes x' and y' of the carried frame; its z' is n. */
typedef struct FN(axes) {
  FN(triple) x, y;
} FN(axes);

/* x' = (nz, 0, -nx)/L and n x x'; near L = 0 as in detail_rotate. */
LEAF FN(axes) FN(axes_rotate)(real nx, real ny, real nz) {
#if SHADE_FLOAT
  const real small = 0x1p-40f, step = 0x1p40f;
#else
  const real small = 0x1p-300, step = 0x1p300;
#endif
  real size = FN(maximum)(nx < 0 ? -nx : nx, nz);
  real scale = size < small ? step : 1;
  scale = size * scale < small ? scale * step : scale;
  real a = nx * scale, c = nz * scale;
  real inverse = 1 / FN(root)(FN(maximum)(a * a + c * c, TINY));
  FN(axes) f = {{c * inverse, 0, -a * inverse}, {0, 0, 0}};
  f.y.x = ny * f.x.z;
  f.y.y = nz * f.x.x - nx * f.x.z;
  f.y.z = -ny * f.x.x;
  return f;
}

LEAF FN(axes) FN(axes_rotate_y)(real nx, real ny, real nz) {
  FN(axes) f = FN(axes_rotate)(ny, nx, nz);
  FN(axes) g = {{f.y.y, f.y.x, f.y.z}, {f.x.y, f.x.x, f.x.z}};
  return g;
}

LEAF FN(axes) FN(axes_shortest_arc)(real nx, real ny, real nz) {
  real turn = 1 / (1 + nz), off = -nx * ny * turn;
  FN(axes) f = {{1 - nx * nx * turn, off, -nx}, {off, 1 - ny * ny * turn, -ny}};
  return f;
}

LEAF FN(axes) FN(axes_none)(real nx, real ny, real nz) {
  (void)nx, (void)ny, (void)nz;
  FN(axes) f = {{1, 0, 0}, {0, 1, 0}};
  return f;
}

/*
 * Where a warp takes the point p of the disc, the inverse of detail_deform_*: p' = p + w delta.
 * Linear: w = 1 - |p|. Smooth: w = 1 - v with v (2 - v) = |p + v (1 - v) delta|, to whose
 * least root Newton climbs from below.
 */
enum { FN(warp_steps) = SHADE_FLOAT ? 7 : 9 };

LEAF real FN(warp_start)(real nx, real ny, real x, real y) {
  return FN(root)(x * x + y * y) / (2 + FN(root)(nx * nx + ny * ny));
}

LEAF real FN(warp_step)(real nx, real ny, real x, real y, real v) {
  real shift = v * (1 - v);
  real ex = x + shift * nx, ey = y + shift * ny;
  real size = FN(root)(ex * ex + ey * ey);
  real lean = (ex * nx + ey * ny) / FN(maximum)(size, R(1e-18));
  real slope = FN(maximum)(2 - 2 * v - (1 - 2 * v) * lean, R(1e-4));
  return FN(maximum)(FN(minimum)(v - (v * (2 - v) - size) / slope, 1), 0);
}

LEAF FN(triple) FN(warp_shifted)(real nx, real ny, real x, real y, real w) {
  x += w * nx;
  y += w * ny;
  FN(triple) h = {x, y, FN(root)(FN(maximum)(1 - x * x - y * y, 0))};
  return h;
}

/*
 * Share of the draws that go to the specular lobe beside a diffuse part: its reflectance at
 * the eye's angle against the diffuse one, and at least a tenth for either.
 */
LEAF real FN(lobe_share)(real s, real grazing, real d, real cosine) {
  real specular = s + grazing * (1 - s) * FN(schlick_weight)(FN(minimum)(cosine, 1));
  real share = specular / FN(maximum)(specular + d, R(1e-20));
  return FN(minimum)(FN(maximum)(share, R(0.1)), R(0.9));
}

/*
 * For facets and upright mirrors: share of the bumped facet's draws that go on to the mirror
 * before they leave. That facet's light w goes past the mirror by nz w.z : side, and the mirror
 * lets out no more than nz w.z of its own: so the split is that of the mirror image of wo,
 * which a narrow lobe surrounds, but not below the one that bounds f cos / pdf by 1 + cot(tilt)
 * times the lobe's own. A share that followed w would need a third uniform number.
 */
LEAF real FN(share_bounced)(real nx, real ny, real nz, real wox, real woy, real woz) {
  real side2 = nx * nx + ny * ny, along = nx * wox + ny * woy;
  real twice = 2 * (along + nz * woz);
  real side = FN(maximum)(twice * side2 - along, 0);
  real past = nz * FN(maximum)(twice * nz - woz, 0);
  real least = FN(minimum)(side, past);
  real here = least / (past + least + TINY);
  real slope = FN(root)(side2);
  return FN(maximum)(here, R(0.5) * slope / (slope + nz));
}
