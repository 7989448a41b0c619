/* SPDX-License-Identifier: Apache-2.0 */
/* Ward's cheaper form of his Gaussian: D, its draws. */
#ifndef SHADE_MODEL_MDF_WARD_HALF_H
#define SHADE_MODEL_MDF_WARD_HALF_H

#include "mdf_parts.h"

/*
 * Worst seen, all with sse2: float 1.2e-5 at exponents (3.06, 364), shortest_arc, n (.792, -.516,
 * .327); 6.5e-5 at (4.4e4, 3.2e3), gram_schmidt, n (.711, -.703, .016); double 3.3e-14.
 */
#define SHADE_MDF_WARD_HALF_IS                                                                     \
  {                                                                                                \
    .proposal = 1, .brdf = SHADE_BRDF_WARD_BOUNDED, .per_slope = 1, .float_1e3 = 2e-5,             \
    .float_1e5 = 2e-4, .double_1e4 = 1e-13                                                         \
  }

/*
 * Ward's cheap form, exp(-2 ((x/ax)^2 + (y/ay)^2)/(1 + z)); sin^2/(1 + cos) from tangents
 * is tan^2/(u + sqrt u), u = 1 + tan^2. Round lobes integrate to 1 - exp(-2/alpha^2)
 * without a cosine. [Ward1992 Eq. 5b]
 */
LEAF real ward_half(lobe_point p, real kx, real ky, real peak) {
  real u = 1 + absolute(p.t);
  real value = peak * exp_negative(2 * (kx * p.xx + ky * p.yy) / (u + root(u)));
  return p.t >= 0 ? value : 0;
}

LEAF real smith_ward_half(real w) {
  return smith_gaussian(w);
}

/*
 * Ward's cheap form: the azimuth as if the lobe were narrow, then its polar angle exactly.
 * Density: D / (1 - exp(-2 k)), k = kx cos^2 + ky sin^2 of the azimuth, the mean over the pole.
 */
LEAF triple draw_ward_half(real u1, real u2, real kx, real ky) {
  pair p = circle(u1);
  real x = p.x / root(kx), y = p.y / root(ky);
  real size2 = x * x + y * y;
  real two_k = 2 / size2;
  real part = u2 * one_less_exp(two_k);
  real m = minimum(log_left(minimum(part, BELOW_ONE)) / two_k, 1);
  real scale = root(m * (2 - m) / size2);
  triple h = {x * scale, y * scale, 1 - m};
  return h;
}

LEAF real density_ward_half(lobe_point p, real kx, real ky) {
  real radius = p.xx + p.yy;
  /* without a choice, or both sides would be computed, 0/0 too */
  real k = (kx * p.xx + ky * p.yy + R(0.5) * TINY * (kx + ky)) / (radius + TINY);
  return ward_half(p, kx, ky, slope_peak(kx, ky)) / one_less_exp(2 * k);
}

#endif
