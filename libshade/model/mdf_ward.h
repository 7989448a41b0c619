/* SPDX-License-Identifier: Apache-2.0 */
/* Ward's distribution: D; drawn from Ashikhmin and Shirley's lobe, which holds it. */
#ifndef SHADE_MODEL_MDF_WARD_H
#define SHADE_MODEL_MDF_WARD_H

#include "mdf_ashikhmin_shirley.h"

/*
 * Worst seen, all with sse2 and gram_schmidt: float 1.5e-5 at exponents (1.33, .035), n (-.797,
 * .594, .112); 6.8e-5 at (4.4e4, 3.2e3), n (.711, -.703, .016); double 3.2e-14 at (30.6, 3645).
 */
#define SHADE_MDF_WARD_IS                                                                          \
  {                                                                                                \
    .proposal = 2, .brdf = SHADE_BRDF_WARD_BOUNDED, .per_slope = 0.5, .float_1e3 = 2e-5,           \
    .float_1e5 = 2e-4, .double_1e4 = 1e-13                                                         \
  }

/*
 * Ward: a Gaussian of the slope. Close to normalised without a cosine for small alpha
 * only: 0.888 at alpha 0.3. [Ward1992 Eq. 4, with the squares]
 */
LEAF real ward(lobe_point p, real kx, real ky, real peak) {
  real value = peak * exp_negative(kx * p.xx + ky * p.yy);
  return p.t >= 0 ? value : 0;
}

LEAF real smith_ward(real w) {
  return smith_gaussian(w);
}

/* With exponents 2/alpha^2 (`proposal`) Ward's lobe is within Ashikhmin and Shirley's. */
LEAF triple draw_ward(real u1, real u2, real kx, real ky) {
  return draw_ashikhmin_shirley(u1, u2, kx, ky);
}
LEAF real density_ward(lobe_point p, real kx, real ky) {
  return density_ashikhmin_shirley(p, kx, ky);
}

#endif
