/* SPDX-License-Identifier: Apache-2.0 */
/* Vectors in long double, and how the reference takes its inputs. */
#ifndef SHADE_REFERENCE_VEC_H
#define SHADE_REFERENCE_VEC_H

#include <math.h>

typedef long double real;
typedef struct vec {
  real x, y, z;
} vec;

static const real pi = 3.14159265358979323846264338327950288L;

static inline real dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline vec cross(vec a, vec b) {
  return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline vec scale(vec a, real s) {
  return (vec){a.x * s, a.y * s, a.z * s};
}
static inline vec minus(vec a, vec b) {
  return (vec){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline vec plus(vec a, vec b) {
  return (vec){a.x + b.x, a.y + b.y, a.z + b.z};
}
/* hypotl is slow, and is needed only where squares leave the range of a long double: those of
   doubles do not */
static inline real length2(real x, real y) {
  return sqrtl(x * x + y * y);
}
static inline real length(vec a) {
  return sqrtl(a.x * a.x + a.y * a.y + a.z * a.z);
}
static inline vec unit(vec a) {
  return scale(a, 1 / length(a));
}

/* 1 when v can be made unit. */
static inline int usable(const double v[3]) {
  return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) &&
         (v[0] != 0 || v[1] != 0 || v[2] != 0);
}

static inline vec direction(const double v[3]) {
  return unit((vec){v[0], v[1], v[2]});
}

/* The perturbed normal; below the horizon it is lifted to z = 1e-4. */
static inline vec normal(const double v[3]) {
  vec n = direction(v);
  if (n.z <= 0) {
    n.z = 1e-4L;
    n = unit(n);
  }
  return n;
}

static inline real within(real x, real low, real high) {
  return x < low ? low : x > high ? high : x;
}

static inline vec in_frame(vec x, vec y, vec z, vec h) {
  return (vec){dot(x, h), dot(y, h), dot(z, h)};
}

static inline real square(real x) {
  return x * x;
}

/* x to the fifth power: powl is slow. */
static inline real fifth(real x) {
  return square(square(x)) * x;
}

/* What a division is kept from. */
static inline real at_least(real x) {
  return x > 1e-20L ? x : 1e-20L;
}

/* The mirror image of w about m. */
static inline vec mirrored(vec w, vec m) {
  return minus(scale(m, 2 * dot(m, w)), w);
}

#endif
