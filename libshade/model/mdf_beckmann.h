/* SPDX-License-Identifier: Apache-2.0 */
/* Beckmann's distribution: D, draws of half vectors and of the normals that an eye sees. */
#ifndef SHADE_MODEL_MDF_BECKMANN_H
#define SHADE_MODEL_MDF_BECKMANN_H

#include "mdf_parts.h"

/*
 * Worst seen, all with sse2 and gram_schmidt: float 1.4e-5 at exponents (1.33, .035), n (-.797,
 * .594, .112); 6.8e-5 at (4.4e4, 3.2e3), n (.711, -.703, .016); double 3.2e-14 at (30.6, 3645).
 */
#define SHADE_MDF_BECKMANN_IS                                                                      \
  {                                                                                                \
    .projected = 1, .visible = 1, .brdf = SHADE_BRDF_MICROFACET, .proposal = 1, .per_slope = 1,    \
    .narrowed = 1, .float_1e3 = 2e-5, .float_1e5 = 2e-4, .double_1e4 = 1e-13                       \
  }

/*
 * Beckmann. Integrates to 1 over the hemisphere with the cosine. Above the cap of u,
 * alpha = 10, the broadest, is below 1e-420 of its peak; the cap keeps u^2 finite and D
 * under 4e17. [CookTorrance1982 Eq. 14; Heitz2014 Eq. 46]
 */
LEAF real beckmann(lobe_point p, real kx, real ky, real peak) {
  real u = minimum(1 + absolute(p.t), R(1e5));
  real value = peak * (u * u) * exp_negative(kx * p.xx + ky * p.yy);
  return p.t >= 0 ? value : 0;
}

LEAF real smith_beckmann(real w) {
  return smith_gaussian(w);
}

/* Gaussian slopes. Density: D times h.z. [Walter2007 Eq. 28] */
LEAF triple draw_beckmann(real u1, real u2, real kx, real ky) {
  pair p = circle(u1);
  real r = root(log_left(u2));
  triple h = {r * p.x / root(kx), r * p.y / root(ky), 1};
  return h;
}
LEAF real density_beckmann(lobe_point p, real kx, real ky) {
  real u = 1 + maximum(p.t, 0);
  return beckmann(p, kx, ky, slope_peak(kx, ky)) / root(u);
}

/*
 * t with probability u above it under the density (rise + lean t) exp(-t^2), t > -rise/lean:
 * the slope towards an eye of cosine `rise` and sine `lean`, per alpha. lean = 0 gives the
 * plain Gaussian. Newton on the logarithm of the nearer tail, kept inside the bracket it has
 * seen, from the mean of both limits; that of lean = 0 from an inverse of erf good to 2e-3.
 * Error: see test/test_sample.c. [HeitzDEon2014 for the density; Winitzki2008 for that inverse]
 */
typedef struct slope_search {
  real u, rise, lean, inverse; /* inverse: 1 over the whole integral */
  real low, high, t;
} slope_search;

enum { slope_steps = SHADE_FLOAT ? 7 : 9 };

LEAF slope_search slope_start(real u_in, real rise, real lean) {
  const real half_root_pi = R(0.88622692545275801365), bend = R(0.147);
  slope_search s;
  s.u = minimum(maximum(u_in, LEAST_UNIFORM), BELOW_ONE);
  s.rise = rise;
  s.lean = lean;
  /* the floor: no quotient whose square is infinite */
  real a = minimum(rise / maximum(lean, R(1e-12)), 100);
  real ea = exp_negative(a * a);
  real whole =
      rise * half_root_pi * (2 - ea * scaled_erfc_at(1 / (1 + R(0.3) * a))) + R(0.5) * lean * ea;
  s.inverse = 1 / maximum(whole, TINY);
  real l = log1p_positive(maximum(R(0.25) / (s.u * (1 - s.u)) - 1, 0));
  real middle = R(0.63661977236758134308) / bend - R(0.5) * l;
  real size2 = root(middle * middle + l / bend) - middle;
  real plain = root(maximum(size2, 0));
  plain = s.u < R(0.5) ? plain : -plain;
  s.high = root(minus_log(s.u)); /* that of rise = 0, above every other */
  s.low = maximum(-a, SHADE_FLOAT ? R(-4.3) : R(-6.2));
  s.t = plain + (s.high - plain) / (1 + R(0.7) * a);
  s.t = minimum(maximum(s.t, R(0.9) * s.low), s.high);
  return s;
}

LEAF slope_search slope_step(slope_search s) {
  const real half_root_pi = R(0.88622692545275801365);
  real e = exp_negative(s.t * s.t);
  real tail = e * scaled_erfc_at(1 / (1 + R(0.3) * absolute(s.t)));
  real above =
      (s.rise * half_root_pi * (s.t < 0 ? 2 - tail : tail) + R(0.5) * s.lean * e) * s.inverse;
  real density = maximum((s.rise + s.lean * s.t) * e * s.inverse, R(1e-30));
  s.low = above > s.u ? s.t : s.low;
  s.high = above > s.u ? s.high : s.t;
  real part = s.u < R(0.5) ? above : maximum(1 - above, 0);
  real want = s.u < R(0.5) ? s.u : 1 - s.u;
  real step = 2 * (part - want) / (part + want) * part / density;
  real next = s.t + (s.u < R(0.5) ? step : -step);
  s.t = ((next >= s.low) & (next <= s.high)) ? next : R(0.5) * (s.low + s.high);
  return s;
}

/* The eye stretched by alpha: its azimuth (c, s), and the cosine and sine of its angle. */
typedef struct stretched {
  real c, s, rise, lean;
} stretched;

LEAF stretched stretch_eye(real ax, real ay, triple o) {
  real x = ax * o.x, y = ay * o.y;
  real lean = root(x * x + y * y);
  int upright = !(lean > R(1e-15));
  real inverse = 1 / (lean + TINY);
  real scale = 1 / root(lean * lean + o.z * o.z + TINY);
  stretched e = {upright ? 1 : x * inverse, upright ? 0 : y * inverse, o.z * scale, lean * scale};
  return e;
}

LEAF real slope_of(real u, real rise, real lean) {
  slope_search s = slope_start(u, rise, lean);
#if defined(__GNUC__) /* or the loop around it stays scalar */
#pragma GCC unroll 16
#endif
  for (int step = 0; step < slope_steps; step++)
    s = slope_step(s);
  return s.t;
}

/* Beckmann's normals as o sees them, by their slopes along and across it; density as GGX's. */
LEAF triple draw_visible_beckmann(real u1, real u2, real kx, real ky, triple o) {
  const real ax = 1 / root(kx), ay = 1 / root(ky);
  const stretched e = stretch_eye(ax, ay, o);
  const real along = slope_of(u1, e.rise, e.lean), across = slope_of(u2, 1, 0);
  return (triple){ax * (along * e.c - across * e.s), ay * (along * e.s + across * e.c), 1};
}

#endif
