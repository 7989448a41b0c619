/* SPDX-License-Identifier: Apache-2.0 */
/* GGX: D, Smith's Lambda, draws of half vectors and of the normals that an eye sees. */
#ifndef SHADE_MODEL_MDF_GGX_H
#define SHADE_MODEL_MDF_GGX_H

#include "mdf_parts.h"

/*
 * Worst seen, all with sse2: float 1.5e-6 at exponents (885, 690), gram_schmidt, n (.624, .773,
 * .113); 1.3e-5 at (5.3e4, 2.8e3), rotate, n (.701, -.061, .711); double 7.9e-15 at (8849, 6896),
 * perturb.
 */
#define SHADE_MDF_GGX_IS                                                                           \
  {                                                                                                \
    .projected = 1, .visible = 1, .brdf = SHADE_BRDF_MICROFACET, .proposal = 1, .per_slope = 1,    \
    .tails = 1, .narrowed = 0.5, .blunted = 0.4, .float_1e3 = 5e-6, .float_1e5 = 5e-5,             \
    .double_1e4 = 1e-13                                                                            \
  }

/*
 * GGX (Trowbridge-Reitz). Integrates to 1 over the hemisphere with the cosine. The ratio's
 * cap of 1e5 binds only where rotate_approximate's slopes vanish while t does not; it keeps D
 * under 4e17. [Walter2007 Eq. 33; Heitz2014 Eq. 85]
 */
LEAF real ggx(lobe_point p, real kx, real ky, real peak) {
  real t = absolute(p.t);
  real ratio = (1 + t) / maximum(1 + (kx * p.xx + ky * p.yy), R(1e-5) * (1 + t));
  real value = peak * (ratio * ratio);
  return p.t >= 0 ? value : 0;
}

/*
 * 1 + 2 Lambda for GGX; w = (alpha tan)^2 in the direction's azimuth. Relative error: float
 * 1.2e-7, double 2.3e-16. [Heitz2014 Eq. 72]
 */
LEAF real smith_ggx(real w) {
  return root(1 + w);
}

/* Density: D times h.z. [Walter2007 Eq. 35] */
LEAF triple draw_ggx(real u1, real u2, real kx, real ky) {
  pair p = circle(u1);
  real r = root(u2 / (1 - u2));
  triple h = {r * p.x / root(kx), r * p.y / root(ky), 1};
  return h;
}
LEAF real density_ggx(lobe_point p, real kx, real ky) {
  real u = 1 + maximum(p.t, 0);
  return ggx(p, kx, ky, slope_peak(kx, ky)) / root(u);
}

/*
 * GGX normals as o sees them: a point of the cap that the stretched eye's reflections fill,
 * added to that eye. o is in the lobe's frame. Density of wi: D / (2 o.z (1 + l)), l =
 * 1 + 2 Lambda(o). [DupuyBenyoub2023]
 */
LEAF triple draw_visible_ggx(real u1, real u2, real kx, real ky, triple o) {
  real ax = 1 / root(kx), ay = 1 / root(ky);
  real x = ax * o.x, y = ay * o.y;
  real inverse = 1 / root(maximum(x * x + y * y + o.z * o.z, TINY));
  x *= inverse;
  y *= inverse;
  real z = minimum(o.z * inverse, 1);
  pair p = circle(u1);
  real rise = (1 - u2) * (1 + z); /* z of the point, plus z */
  real sine = root(u2 * (1 + z) * (rise + (x * x + y * y) / (1 + z)));
  triple h = {ax * (sine * p.x + x), ay * (sine * p.y + y), rise};
  return h;
}

#endif
