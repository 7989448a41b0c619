/* SPDX-License-Identifier: Apache-2.0 */
/* Which term of its footprint a random number stands for. */
#ifndef SHADE_MODEL_FOOTPRINT_H
#define SHADE_MODEL_FOOTPRINT_H

#include "coefficients.h"
#include "fabric.h"
#include "real.h"

/* The place of point k of the 16 in a footprint about uv: more of them along its longer side. */
typedef struct cloth_place {
  double u, v;
} cloth_place;

LEAF cloth_place cloth_point(cloth_place uv, double du, double dv, double k) {
  double wider = du > 2 * dv ? 2 : 1, higher = dv > 2 * du ? 2 : 1;
  wider = du > 4 * dv ? 4 : wider;
  higher = dv > 4 * du ? 4 : higher;
  /* columns and rows are powers of 2: so are their inverses, by which the products are exact */
  const double columns = 4 * wider * (higher > 2 ? 0.25 : higher > 1 ? 0.5 : 1);
  const double column = 0.25 * higher * (wider > 2 ? 0.25 : wider > 1 ? 0.5 : 1);
  const double row = (double)(int)(k * column);
  uv.u += du * ((k - row * columns + 0.5) * column - 0.5);
  uv.v += dv * ((row + 0.5) * (columns * (1.0 / FABRIC_POINTS)) - 0.5);
  return uv;
}

/* Which of them for a number in [0, 1). */
LEAF double cloth_which(double r) {
  const double k = (double)(int)(FABRIC_POINTS * r);
  return k < FABRIC_POINTS - 1 ? k : FABRIC_POINTS - 1;
}

/* fabric_far_share, for loops over lanes. */
LEAF double cloth_far_share(double extent) {
  const double from = extent > FABRIC_NEAR_TO ? extent : FABRIC_NEAR_TO;
  const double ratio = (from < FABRIC_FAR_FROM ? from : FABRIC_FAR_FROM) * (1 / FABRIC_NEAR_TO);
  /* the logarithm of an octave less where it is nearer to 0 */
  const double whole = ratio > 1.4 ? 1 : 0, r = ratio * (ratio > 1.4 ? 0.5 : 1);
  const double s = (r - 1) / (r + 1), square = s * s;
  const double x = (whole + s * SHADE_LOG2_D(square)) * (1 / 1.4150374992788437); /* log2(8/3) */
  return extent < FABRIC_FAR_FROM ? x * x * (3 - 2 * x) : 1;
}

#define CLOTH_BELOW_ONE 0x1.fffffffffffffp-1

#endif
