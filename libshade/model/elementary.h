/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Elementary functions without a call, a branch or a table, so that loops over
 * them vectorise. Errors are held by test/test_elementary.c.
 */
#ifndef SHADE_MODEL_ELEMENTARY_H
#define SHADE_MODEL_ELEMENTARY_H

#include <math.h>
#include <string.h>

#include "coefficients.h"
#include "real.h"

LEAF real_bits to_bits(real x) {
  real_bits u;
  memcpy(&u, &x, sizeof u);
  return u;
}

LEAF real from_bits(real_bits u) {
  real x;
  memcpy(&x, &u, sizeof x);
  return x;
}

/* A coefficient of this precision; adding ROUNDER rounds to a whole number. */
#if SHADE_FLOAT
#define COEFFICIENT(name) name##_F
#define ROUNDER 12582912.0f /* 1.5 * 2^23 */
#define MANTISSA 23
#define BIAS 127u
#define ROOT_HALF_BITS 0x3f3504f3u
#define EXP_LIMIT 86
#else
#define COEFFICIENT(name) name##_D
#define ROUNDER 6755399441055744.0 /* 1.5 * 2^52 */
#define MANTISSA 52
#define BIAS 1023u
#define ROOT_HALF_BITS 0x3fe6a09e667f3bcdu
#define EXP_LIMIT 700
#endif

/*
 * log(1 + t) for 0 <= t <= 4e37 (float) or 4e300 (double).
 * Worst relative error: 1.8e-7 near t = 0.42 (float), 3.4e-16 (double).
 */
LEAF real log1p_positive(real t) {
  real u = 1 + t;
  /* k so that u / 2^k lies between sqrt(1/2) and sqrt(2) */
  real_bits k = (to_bits(u) - ROOT_HALF_BITS) >> MANTISSA;
  real scale = from_bits((BIAS - k) << MANTISSA);
#if SHADE_FLOAT
  real kf = (real)(int32_t)k;
#else
  /* SSE2 and AVX2 cannot convert a 64-bit integer: plant it in the mantissa of 2^52 */
  real kf = from_bits(k | 0x4330000000000000u) - 4503599627370496.0;
#endif
  /* t - (u - 1) is what the rounding of 1 + t lost */
  real f = (u * scale - 1) + (t - (u - 1)) * scale;
  real s = f / (2 + f);
  real z = s * s;
  real rest = s * z * COEFFICIENT(SHADE_LOG)(z);
  return kf * COEFFICIENT(SHADE_LN2_HIGH) + (2 * s + (rest + kf * COEFFICIENT(SHADE_LN2_LOW)));
}

/* exp(-a), a >= 0, is 2^k (1 + rest): k in the last bits of `shifted`, at most EXP_LIMIT down. */
typedef struct exp_parts {
  real shifted, rest;
} exp_parts;
LEAF exp_parts exp_parts_of(real a) {
  real y = a < EXP_LIMIT ? a : EXP_LIMIT;
  real shifted = ROUNDER - y * COEFFICIENT(SHADE_LOG2E);
  real k = shifted - ROUNDER;
  real r = (-y - k * COEFFICIENT(SHADE_LN2_HIGH)) - k * COEFFICIENT(SHADE_LN2_LOW);
  return (exp_parts){shifted, r + r * r * COEFFICIENT(SHADE_EXP)(r)};
}

/*
 * exp(-a) for a >= 0; 0 for a > 86 (float) or 700 (double), where the result is below
 * 5e-38 or 1e-304. Worst relative error: 1.2e-7 (float), 2.3e-16 (double).
 */
LEAF real exp_negative(real a) {
  exp_parts e = exp_parts_of(a);
  real value = from_bits(to_bits(1 + e.rest) + (to_bits(e.shifted) << MANTISSA));
  return a <= EXP_LIMIT ? value : 0;
}

/* 1 - exp(-a), a >= 0, without cancellation. */
LEAF real one_less_exp(real a) {
  exp_parts e = exp_parts_of(a);
  real scale = from_bits((to_bits(e.shifted) + BIAS) << MANTISSA);
  return (1 - scale) - scale * e.rest;
}

/*
 * log2(1 + a/b) for a >= 0, b >= TINY and a/b <= 1e30 (float) or 1e291 (double), with one
 * division, in LOG2_UNIT: float bits count it in 2^-23, and what it is multiplied by can take
 * that along. Worst relative error: 2.1e-7 (float), 3.3e-16 (double).
 */
LEAF real log2_1p(real a, real b) {
  /*
   * k so that (1 + a/b) / 2^k lies between 2^-0.59 and 2^0.59: bits, as a whole number, grow as
   * the logarithm does, at most 0.09 off
   */
#if SHADE_FLOAT
  real_bits k = (to_bits(a + b) - to_bits(b) + 0x400000u) & 0xff800000u;
  real kf = (real)(int32_t)k;
  real scale = from_bits(0x3f800000u - k);
#else
  real_bits k = (to_bits(a + b) - to_bits(b) + 0x8000000000000u) >> 52;
  /* SSE2 and AVX2 cannot convert a 64-bit integer: plant it in the mantissa of 2^52 */
  real kf = from_bits(k | 0x4330000000000000u) - 4503599627370496.0;
  real scale = from_bits((1023u - k) << 52);
#endif
  /* f is (1 + a/b)/2^k - 1, times b: nothing is lost but in its one addition */
  real f = a * scale + b * (scale - 1);
  real s = f / (f + 2 * b);
  real z = s * s;
  return kf + s * COEFFICIENT(SHADE_LOG2)(z);
}

/*
 * 2^-a for a >= 0; 0 for a > 124 (float) or 1010 (double).
 * Worst relative error: 1e-7 (float), 2e-16 (double).
 */
LEAF real exp2_negative(real a) {
  const real limit = SHADE_FLOAT ? 124 : 1010;
#if SHADE_FLOAT
  /* the bits of positive numbers compare as they do, in one instruction where floats take two */
  int32_t least = (int32_t)to_bits(a), most = (int32_t)to_bits(limit);
  real y = from_bits((real_bits)(least < most ? least : most));
#else
  real y = a < limit ? a : limit;
#endif
  real shifted = ROUNDER - y;
  real r = (ROUNDER - shifted) - y;
  real p = 1 + r * COEFFICIENT(SHADE_EXP2)(r);
  real value = from_bits(to_bits(p) + (to_bits(shifted) << MANTISSA));
  return a <= limit ? value : 0;
}

/*
 * a b + c: with one rounding wherever the machine has such an instruction, for compilers choose
 * sum by sum, and not as they do in the loop beside. Single calls and batches round alike by it
 * where terms cancel, which is where a rounding can be all that is left.
 */
LEAF real multiply_add(real a, real b, real c) {
#if !defined(__FMA__) && !defined(__FP_FAST_FMA) && !defined(__ARM_FEATURE_FMA)
  return a * b + c;
#elif SHADE_FLOAT
  return __builtin_fmaf(a, b, c);
#else
  return __builtin_fma(a, b, c);
#endif
}
/* a b - c d. */
LEAF real difference(real a, real b, real c, real d) {
  return multiply_add(a, b, -(c * d));
}
LEAF real dot2(real ax, real ay, real bx, real by) {
  return multiply_add(ax, bx, ay * by);
}
LEAF real dot(real ax, real ay, real az, real bx, real by, real bz) {
  return multiply_add(az, bz, dot2(ax, ay, bx, by));
}

LEAF real maximum(real a, real b) {
  return a > b ? a : b;
}
LEAF real minimum(real a, real b) {
  return a < b ? a : b;
}

LEAF real absolute(real x) {
#if SHADE_FLOAT
  return fabsf(x);
#else
  return fabs(x);
#endif
}

LEAF real root(real x) {
#if SHADE_FLOAT
  return sqrtf(x);
#else
  return sqrt(x);
#endif
}

/*
 * The angle of (x, y) from the x axis, y >= 0: 0 to pi. 0 at the origin.
 * Worst absolute error: 3e-7 (float), 5e-16 (double).
 */
LEAF real angle_of(real y, real x) {
  const real pi = R(3.14159265358979323846);
  real ax = absolute(x);
  real low = minimum(y, ax), high = maximum(y, ax);
  int steep = low > R(0.41421356237309504880) * high; /* tan(pi/8) */
  real top = steep ? low - high : low, bottom = steep ? low + high : high;
  real s = top / (bottom + TINY);
  real a = s + s * (s * s) * COEFFICIENT(SHADE_ATAN)((s * s));
  a = steep ? a + pi / 4 : a;
  a = y > ax ? pi / 2 - a : a;
  return x < 0 ? pi - a : a;
}

/* exp(t^2) erfc(t), t >= 0, by y = 1/(1 + 0.3 t), where exp(-t^2) still counts. */
LEAF real scaled_erfc_at(real y) {
  real z = maximum(y, COEFFICIENT(SHADE_ERFCX_LEAST)) - COEFFICIENT(SHADE_ERFCX_MIDDLE);
  return COEFFICIENT(SHADE_ERFCX)(z);
}

/*
 * x where mask is whole, as where its number is above 0, else `other`. By bits: the loop vectorises
 * where no instruction loads for some lanes only.
 */
LEAF real_bits mask_of(real x) {
  return to_bits(x > 0 ? from_bits(~(real_bits)0) : 0); /* sse2 chooses no 64-bit integers */
}

LEAF real kept(real_bits mask, real x, real other) {
  return from_bits((to_bits(x) & mask) | (to_bits(other) & ~mask));
}

#endif
