/* SPDX-License-Identifier: Apache-2.0 */
/* What all distributions are made of: mdf.h. */
#ifndef SHADE_MODEL_MDF_PARTS_H
#define SHADE_MODEL_MDF_PARTS_H

#include "shade/shade.h"
#include "brdf.h"
#include "detail.h"
#include "random.h"

typedef struct shade_mdf_traits {
  int ratio;                /* sees neither a common scale of the slopes along x and y, nor L */
  int projected;            /* the integral of D hz is 1, not that of D */
  int visible;              /* the normals that an eye sees can be drawn */
  shade_brdf brdf;          /* that goes with it: what `auto` stands for */
  int tails;                /* D falls slowly: no exponent says where it ends */
  double proposal;          /* times kx and ky: the lobe that half vectors are drawn from */
  double per_slope;         /* of a mixture for `perturb`: how narrow 1/alpha^2 or exponents are */
  double narrowed, blunted; /* of lobes that slopes widen: src/slopes.c */
  /*
   * Relative errors of D, any detail method but the warps, against the reference on the same
   * inputs: D > 1e-12 of the peak, z >= 0.05, tilts to 89.9 degrees, exponents (e = 2/alpha^2 - 2)
   * to 1e3, 1e5, 1e4. Worst where D is smallest and e largest. Through warps: methods.h. Held by
   * test_accuracy, whose worst inputs stand beside the traits.
   */
  double float_1e3, float_1e5, double_1e4;
} shade_mdf_traits;

/* Whether a distribution reads ex and ey, or ax and ay: by the rows of those. What is unknown
 * counts as the first. */
static inline int shade_mdf_reads_exponents(shade_mdf mdf) {
  return (unsigned)mdf >= SHADE_MDF_COUNT || (SHADE_EXPONENTS_ >> mdf & 1);
}

/*
 * kx and ky are the exponents for Ashikhmin-Shirley and 1/alpha^2 for the others; peak is D at
 * the pole: sqrt((ex+1)(ey+1))/(2 pi), or 1/(pi ax ay).
 *
 * Below the horizon t is -1, and its size does as well as 0: the result is 0 there. A maximum would
 * be one more condition on t; see TINY.
 */

LEAF real slope_peak(real kx, real ky) {
  return root(kx) * root(ky) * R(0.31830988618379067154);
}

/* D / (2 o.z (1 + l)): half vectors as the eye sees them, as a density of wi. */
LEAF real density_visible(real d, real cosine, real l) {
  return d / maximum(2 * cosine * (1 + l), R(1e-25));
}

/* A lobe as D and Smith's Lambda read it. */
typedef struct lobe_numbers {
  real kx, ky, peak, gx, gy;
} lobe_numbers;

/* By one division. */
LEAF lobe_numbers numbers_of_alphas(real ax, real ay) {
  real inverse = 1 / (ax * ay), over_x = ay * inverse, over_y = ax * inverse;
  return (lobe_numbers){over_x * over_x, over_y * over_y, R(0.31830988618379067154) * inverse,
                        ax * ax, ay * ay};
}

#endif
