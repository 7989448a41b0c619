/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Directions that the passes cannot take as they are. The check is cheap and
 * runs on every lane; the mending is a slow path that few samples ever see.
 */
#ifndef SHADE_MODEL_DIRECTION_H
#define SHADE_MODEL_DIRECTION_H

#include "shade/shade.h"
#include "random.h"

/*
 * Whether a vector is unit, in two words to be or-ed over many vectors, so that the check
 * vectorises with no comparison.
 *
 * FAR_BIT, the highest of the exponent, is set in numbers of size 2 or more, infinite and NaN
 * ones too. Without it no square can overflow. With it the vector is far from unit. A minimum in
 * its place would not do, since the square may be taken before it.
 */
#if SHADE_FLOAT
#define FAR_BIT 0x40000000u
#define SIGN_BIT 0x80000000u
#define UNIT_SLACK 0x1p-19f
#define UNIT_BITS 0x1fu /* of the last places of 1: 2 UNIT_SLACK */
#else
#define FAR_BIT 0x4000000000000000u
#define SIGN_BIT 0x8000000000000000u
#define UNIT_SLACK 0x1p-47
#define UNIT_BITS 0x3fu
#endif

LEAF real_bits far_bits(real x, real y, real z) {
  return to_bits(x) | to_bits(y) | to_bits(z);
}

/* Without FAR_BIT: less than 2. */
LEAF real near_part(real x) {
  return from_bits(to_bits(x) & ~FAR_BIT);
}
/* The squared length, and UNIT_SLACK. */
LEAF real slack_square(real x, real y, real z) {
  x = near_part(x), y = near_part(y), z = near_part(z);
  return x * x + UNIT_SLACK + y * y + z * z;
}
/*
 * Bits above UNIT_BITS are set unless the squared length is within UNIT_SLACK of 1, a few
 * roundings. rotate's leaf is not homogeneous in n: an excess of s in its length would change
 * D by a factor of about exp(-2 s ln D).
 */
LEAF real_bits uneven_bits(real x, real y, real z) {
  return to_bits(slack_square(x, y, z)) ^ to_bits(1);
}

/* Not 0 where it is not. */
LEAF real_bits off_unit(real_bits far, real_bits uneven) {
  return (far & FAR_BIT) | (uneven & ~(real_bits)UNIT_BITS);
}

/*
 * A direction of nearly the right length, as one rounded to float or worked out by its caller, made
 * unit: times 1/sqrt(q) of its squared length q, as it is where it is unit already. `bits` are 0
 * where |q - 1| <= 1/32: the series is then off by 7e-9, with a step of Newton's by 1e-16.
 */
typedef struct nearly_unit {
  real x, y, z;
  real_bits bits;
} nearly_unit;
LEAF nearly_unit nearly_unit_of(real x, real y, real z) {
  const real_bits far = far_bits(x, y, z) & FAR_BIT;
  const real square = slack_square(x, y, z), over = square - (1 + UNIT_SLACK);
  const real_bits off = off_unit(far, to_bits(square) ^ to_bits(1));
  real s = multiply_add(over, R(0.2734375), R(-0.3125));
  s = multiply_add(over, multiply_add(over, s, R(0.375)), R(-0.5));
  s = multiply_add(over, s, 1);
#if !SHADE_FLOAT
  s = multiply_add(0.5 * multiply_add(-(over + 1) * s, s, 1), s, s);
#endif
  const real scale = off ? s : 1;
  return (nearly_unit){near_part(x) * scale, near_part(y) * scale, near_part(z) * scale,
                       far | (real_bits) !(over * over <= R(0x1p-10))};
}

/*
 * Make v unit. Returns 0, leaving v = z, when v is 0 or not finite. Scaling by the
 * largest component first keeps the square in range. Length and components are off by at most
 * 2e-7 (float) or 3e-16 (double), whatever the size of v.
 */
static inline int make_unit(real v[3]) {
  real largest = 0;
  int finite = 1;
  for (int i = 0; i < 3; i++) {
    real size = v[i] < 0 ? -v[i] : v[i];
    finite &= size - size == 0;
    largest = maximum(largest, size);
  }
  if (!finite || largest == 0) {
    v[0] = v[1] = 0;
    v[2] = 1;
    return 0;
  }
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < 3; i++)
      v[i] /= largest;
    largest = root(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  return 1;
}

/* Unit, then n.z > 0: the nearest normal the methods are defined for. */
static inline unsigned mend_normal(real n[3]) {
  unsigned status = make_unit(n) ? SHADE_OK : SHADE_BAD_INPUT;
  if (!(n[2] > 0)) {
    n[2] = R(1e-4);
    make_unit(n);
    status |= SHADE_CLAMPED_NORMAL;
  }
  return status;
}

static inline unsigned mend_if_needed(real v[3], int is_normal) {
  const nearly_unit near = nearly_unit_of(v[0], v[1], v[2]);
  if (!near.bits && !(is_normal && !(v[2] > 0))) {
    v[0] = near.x, v[1] = near.y, v[2] = near.z;
    return SHADE_OK;
  }
  real_bits off = off_unit(far_bits(v[0], v[1], v[2]), uneven_bits(v[0], v[1], v[2]));
  if (is_normal) /* n.z may vanish when n is made unit */
    return off || !(v[2] > 0) ? mend_normal(v) : SHADE_OK;
  return off && !make_unit(v) ? SHADE_BAD_INPUT : SHADE_OK;
}

/* The same of a single call, by value: what is not mended, nearly all, never leaves registers. */
typedef struct direction {
  triple v;
  unsigned status;
} direction;
static __attribute__((noinline, cold)) direction mend_direction(triple w, int is_normal) {
  real v[3] = {w.x, w.y, w.z};
  const unsigned status = mend_if_needed(v, is_normal);
  return (direction){{v[0], v[1], v[2]}, status};
}
LEAF direction direction_of(const real v[3], int is_normal) {
  const direction d = {{v[0], v[1], v[2]}, SHADE_OK};
  const real_bits off = off_unit(far_bits(d.v.x, d.v.y, d.v.z), uneven_bits(d.v.x, d.v.y, d.v.z));
  return off || (is_normal && !(d.v.z > 0)) ? mend_direction(d.v, is_normal) : d;
}

/* Into the frame whose x' is the unit (c, s) and whose y' points the other way at side -1; back. */
LEAF triple turned_into(real c, real s, real side, triple v) {
  return (triple){c * v.x + s * v.y, side * (c * v.y - s * v.x), v.z};
}
LEAF triple turned_back(real c, real s, real side, triple v) {
  const real y = side * v.y;
  return (triple){c * v.x - s * y, s * v.x + c * y, v.z};
}

#endif
