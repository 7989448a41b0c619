/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Ashikhmin and Shirley's distribution: D, its draws. Sees the ratio of the slopes only, so a frame
 * need not be normalised for it.
 */
#ifndef SHADE_MODEL_MDF_ASHIKHMIN_SHIRLEY_H
#define SHADE_MODEL_MDF_ASHIKHMIN_SHIRLEY_H

#include "mdf_parts.h"

/*
 * Worst seen, all with sse2: float 1.1e-5 at exponents (3.06, 364), perturb, n (.693, -.669, .269);
 * 6.6e-5 at (4.4e4, 3.2e3), gram_schmidt, n (.711, -.703, .016); double 3.0e-14.
 */
#define SHADE_MDF_ASHIKHMIN_SHIRLEY_IS                                                             \
  {                                                                                                \
    .ratio = 1, .brdf = SHADE_BRDF_ASHIKHMIN_SHIRLEY, .proposal = 1, .per_slope = 0.5,             \
    .float_1e3 = 2e-5, .float_1e5 = 2e-4, .double_1e4 = 1e-13                                      \
  }

/*
 * Ashikhmin-Shirley: peak * cos^e, e = (ex xx + ey yy)/(xx + yy), with the power
 * as 2^(-e/2 log2(1 + tan^2)): pow(cos, e) would lose e roundings. Integrates
 * to 1 over the hemisphere without a cosine. [AshikhminShirley2000 Eq. 4;
 * docs/theory/conventions.md, Detail]
 */
LEAF real ashikhmin_shirley_ratio(lobe_ratio p, real kx, real ky, real peak) {
  real x = R(0.5) * LOG2_UNIT * kx, y = R(0.5) * LOG2_UNIT * ky;
  real mean = R(0.5) * TINY * (x + y); /* where there is no azimuth */
  real e = (x * p.xx + (y * p.yy + mean)) / (p.xx + (p.yy + TINY));
  real value = peak * exp2_negative(e * log2_1p(p.ss, p.zz + TINY));
  return p.above ? value : 0;
}

LEAF real ashikhmin_shirley(lobe_point p, real kx, real ky, real peak) {
  lobe_ratio r = {p.xx, p.yy, absolute(p.t), 1, p.t >= 0};
  return ashikhmin_shirley_ratio(r, kx, ky, peak);
}

/* Its own paper has none: that of Gaussian slopes with alpha^2 = 2/(e + 2). */
LEAF real smith_ashikhmin_shirley(real w) {
  return smith_gaussian(w);
}

/*
 * Half vectors by D itself: the azimuth by stretching a circle, then cos^(e+1) uniform.
 * Density: Ashikhmin-Shirley's D. [AshikhminShirley2000 Eq. 9-10, in all four quadrants at once]
 */
LEAF triple draw_ashikhmin_shirley(real u1, real u2, real kx, real ky) {
  pair p = circle(u1);
  real inverse = p.x * p.x / (kx + 1) + p.y * p.y / (ky + 1); /* 1/(e + 1) */
  real g = log_left(u2) * inverse;
  real sine = root(one_less_exp(2 * g));
  real x = p.x / root(kx + 1), y = p.y / root(ky + 1);
  real scale = sine / root(inverse);
  triple h = {x * scale, y * scale, exp_negative(g)};
  return h;
}

LEAF real peak_of_exponents(real kx, real ky) {
  return root((kx + 1) * (ky + 1)) * R(0.15915494309189533577);
}
LEAF lobe_numbers numbers_of_exponents(real kx, real ky) {
  return (lobe_numbers){kx, ky, peak_of_exponents(kx, ky), 2 / (kx + 2), 2 / (ky + 2)};
}

LEAF real density_ashikhmin_shirley(lobe_point p, real kx, real ky) {
  return ashikhmin_shirley(p, kx, ky, peak_of_exponents(kx, ky));
}

#endif
