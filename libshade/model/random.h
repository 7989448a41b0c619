/* SPDX-License-Identifier: Apache-2.0 */
/*
 * From uniform numbers: circles, logarithms. Draws are accurate to a few roundings of the type;
 * whatever they miss, the density is that of the direction that was returned.
 */
#ifndef SHADE_MODEL_RANDOM_H
#define SHADE_MODEL_RANDOM_H

#include "elementary.h"

/* Exclusive upper end of a uniform number, and the least that is not 0. */
#if SHADE_FLOAT
#define BELOW_ONE 0x1.fffffep-1f
#else
#define BELOW_ONE 0x1.fffffffffffffp-1
#endif
#define LEAST_UNIFORM (R(0.5) * (1 - BELOW_ONE))

typedef struct pair {
  real x, y;
} pair;

typedef struct triple {
  real x, y, z;
} triple;
#define XYZ(v) (v).x, (v).y, (v).z /* as arguments */

/* With x and y in each other's place, or as it is. */
LEAF triple exchanged(triple v, int swap) {
  return (triple){swap ? v.y : v.x, swap ? v.x : v.y, v.z};
}

/* Within [0, 1). */
LEAF real uniform_of(real u) {
  return minimum(maximum(u, 0), BELOW_ONE);
}

/* (cos, sin) of 2 pi u, u in [0, 1]: Taylor's series within an eighth of a turn of an axis. */
LEAF pair circle(real u) {
  real shifted = 4 * u + ROUNDER;
  real_bits quarter = to_bits(shifted);
  real a = (4 * u - (shifted - ROUNDER)) * R(1.57079632679489661923);
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
  pair p = {sign * ((quarter & 1) ? -s : c), sign * ((quarter & 1) ? c : s)};
  return p;
}

/* -ln(1 - u) and -ln u for u in [0, BELOW_ONE] and [LEAST_UNIFORM, 1]. */
LEAF real log_left(real u) {
  return log1p_positive(u / (1 - u));
}
LEAF real minus_log(real u) {
  return log1p_positive(maximum(1 - u, 0) / u);
}

/*
 * Split u where the first `share` of it means yes: both halves are uniform again. The floor
 * and the cap keep what is left in [0, 1).
 */
LEAF real remapped(real u, real share, int yes) {
  real v = yes ? u / maximum(share, R(1e-20)) : (u - share) / maximum(1 - share, R(1e-20));
  return minimum(maximum(v, 0), BELOW_ONE);
}

#endif
