/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scalar leaves that several stages share. All of them vectorise. */
#ifndef LIBSHADE_LEAF_H
#define LIBSHADE_LEAF_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "batch/lanes.h"

#define LEAF static inline __attribute__((always_inline))

typedef struct vec3 {
  float x, y, z;
} vec3;

LEAF vec3 load(const lane_v *from, size_t i) {
  return (vec3){from->x[i], from->y[i], from->z[i]};
}
LEAF void store(lane_v *to, size_t i, vec3 v) {
  to->x[i] = v.x;
  to->y[i] = v.y;
  to->z[i] = v.z;
}
LEAF float dot(vec3 a, vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
LEAF vec3 scaled(vec3 v, float by) {
  return (vec3){v.x * by, v.y * by, v.z * by};
}
LEAF vec3 select3(bool which, vec3 yes, vec3 no) {
  return (vec3){which ? yes.x : no.x, which ? yes.y : no.y, which ? yes.z : no.z};
}
LEAF vec3 cross(vec3 a, vec3 b) {
  return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* yes where `mask` has all its bits, no where it has none. For what is the same for all lanes: with
 * a bool for it the loop would not vectorise. */
LEAF float either(uint32_t mask, float yes, float no) {
  uint32_t a, b;
  memcpy(&a, &yes, sizeof a);
  memcpy(&b, &no, sizeof b);
  a = (a & mask) | (b & ~mask);
  memcpy(&yes, &a, sizeof yes);
  return yes;
}

/* Every second bit of a Z-order number. */
LEAF uint32_t unzip(uint32_t z) {
  z &= 0x155u;
  z = (z | z >> 1) & 0x133u;
  z = (z | z >> 2) & 0x10fu;
  return (z | z >> 4) & 0x1fu;
}

/* Unit length; false where it has no direction. */
LEAF bool make_unit(vec3 *v) {
  float length = sqrtf(dot(*v, *v));
  *v = (vec3){v->x / length, v->y / length, v->z / length};
  return length > 1e-20f && length < 1e20f;
}

/* Two axes across a unit vector [Duff2017]. */
LEAF void across(vec3 v, vec3 *a, vec3 *b) {
  float sign = v.z < 0.0f ? -1.0f : 1.0f, q = -1.0f / (sign + v.z);
  *a = (vec3){1.0f + sign * v.x * v.x * q, sign * v.x * v.y * q, -sign * v.x};
  *b = (vec3){v.x * v.y * q, sign + v.y * v.y * q, -v.y};
}

/* Clamp to [low, high]; NaN becomes low. */
LEAF float clampf(float x, float low, float high) {
  x = x > low ? x : low;
  return x < high ? x : high;
}
/* Light may be below 0, as in Cycles, but no more than finite, and never NaN. */
LEAF float finite_light(float x) {
  return x == x ? clampf(x, -1e30f, 1e30f) : 0.0f;
}

/* floor for |x| < 2^22, near to x for larger ones; SSE2 has no instruction for it. */
LEAF float floor_small(float x) {
#if defined(__SSE4_1__) || defined(__aarch64__)
  return floorf(x);
#else
  float nearest = (x + 0x1.8p23f) - 0x1.8p23f;
  return nearest > x ? nearest - 1.0f : nearest;
#endif
}

/* A good 32-bit mixer: the finaliser of MurmurHash3. */
LEAF uint32_t mix(uint32_t h) {
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  return h ^ h >> 16;
}

/* [0, 1) from the upper 24 bits. */
LEAF float unit_float(uint32_t x) {
  return (float)(int32_t)(x >> 8) * 0x1p-24f;
}

LEAF uint32_t reversed(uint32_t x) {
  x = x >> 16 | x << 16;
  x = (x & 0x00ff00ffu) << 8 | (x >> 8 & 0x00ff00ffu);
  x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
  x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
  return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
}

/* Owen's scrambling of a number whose bits are reversed: each is turned or not by those below it
 * alone [Burley2020]; constants by Vegdahl. */
LEAF uint32_t scrambled(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= seed >> 16 | 1u;
  x ^= x * 0x05526c56u;
  return x ^ x * 0x53a22864u;
}

/* Two dimensions of point `index` (bits reversed) of Sobol's sequence, in an order of its own for
 * each h and scrambled; reverse: of sampling. */
LEAF void shuffled_point(uint32_t index, const uint32_t *restrict reverse, uint32_t mask,
                         uint32_t h, float *x, float *y) {
  uint32_t number = reversed(scrambled(index, h)) & mask;
  uint32_t h1 = mix(h), h2 = mix(h1);
  *x = unit_float(reversed(scrambled(number, h1)));
  *y = unit_float(reversed(scrambled(reverse[number], h2)));
}

/* sin and cos of 2 pi x, x in [0, 1): 3e-7. Taylor about the quarter turns. */
LEAF void turn(float x, float *sine, float *cosine) {
  int quarter = (int)(x * 4.0f + 0.5f);
  float a = (x - 0.25f * (float)quarter) * 6.28318530718f; /* |a| <= pi/4 */
  float a2 = a * a;
  float s = a * (1.0f + a2 * (-1.0f / 6 + a2 * (1.0f / 120 - a2 * (1.0f / 5040))));
  float c = 1.0f + a2 * (-0.5f + a2 * (1.0f / 24 + a2 * (-1.0f / 720 + a2 * (1.0f / 40320))));
  float odd_s = quarter & 1 ? c : s;
  float odd_c = quarter & 1 ? s : c;
  *sine = quarter & 2 ? -odd_s : odd_s;
  *cosine = (quarter + 1) & 2 ? -odd_c : odd_c;
}

LEAF float float_of_bits(int32_t bits) {
  union {
    int32_t i;
    float f;
  } u = {.i = bits};
  return u.f;
}
LEAF int32_t bits_of_float(float x) {
  union {
    float f;
    int32_t i;
  } u = {.f = x};
  return u.i;
}

/* 2^x, relative error 2e-7: Taylor about the nearest integer. Beyond the range of normal floats it
 * is its end. */
LEAF float exponential2(float x) {
  x = clampf(x, -126.0f, 127.999f);
  float whole = floor_small(x + 0.5f), f = (x - whole) * 0.69314718f; /* |f| <= ln 2 / 2 */
  float p = 1.0f / 720 + f * (1.0f / 5040);
  p = 1.0f + f * (1.0f + f * (0.5f + f * (1.0f / 6 + f * (1.0f / 24 + f * (1.0f / 120 + f * p)))));
  float half = floor_small(0.5f * whole); /* in two steps: 2^128 is no float */
  return p * float_of_bits(((int32_t)half + 127) << 23) *
         float_of_bits(((int32_t)(whole - half) + 127) << 23);
}

/* log2 of x > 0, absolute error 1e-7 and as relative to it; 0 and below count as 2^-126. */
LEAF float logarithm2(float x) {
  x = x > 1.17549435e-38f ? x : 1.17549435e-38f;
  int32_t bits = bits_of_float(x), exponent = (bits - 0x3f3504f3) >> 23; /* from sqrt(1/2) on */
  float f = float_of_bits(bits - exponent * (1 << 23)) - 1.0f;
  float s = f / (2.0f + f), q = s * s; /* log((1 + s) / (1 - s)) */
  float p = 1.0f + q * (1.0f / 3 + q * (1.0f / 5 + q * (1.0f / 7 + q * (1.0f / 9))));
  return (float)exponent + 2.88539008f * s * p;
}

/* The angle of (x, y), 3e-7; 0 for no direction. */
LEAF float arc_tangent2(float y, float x) {
  float ax = fabsf(x), ay = fabsf(y);
  bool steep = ay > ax;
  float high = steep ? ay : ax, low = steep ? ax : ay;
  float q = high > 0.0f ? low / high : 0.0f;
  /* twice the angle of the half: |t| <= tan(pi / 8) */
  float t = q / (1.0f + sqrtf(1.0f + q * q)), t2 = t * t;
  float p = 1.0f / 9 + t2 * (-1.0f / 11 + t2 * (1.0f / 13 - t2 * (1.0f / 15)));
  p = 1.0f + t2 * (-1.0f / 3 + t2 * (1.0f / 5 + t2 * (-1.0f / 7 + t2 * p)));
  float angle = 2.0f * t * p;
  angle = steep ? 1.57079633f - angle : angle;
  angle = x < 0.0f ? 3.14159265f - angle : angle;
  return y < 0.0f ? -angle : angle;
}

/* The angle of (x, y) in turns, [0, 1): 5e-8. */
LEAF float turn_of(float y, float x) {
  float a = arc_tangent2(y, x) * 0.159154943f;
  a = a < 0.0f ? a + 1.0f : a;
  return a < 1.0f ? a : 0.0f;
}

#endif
