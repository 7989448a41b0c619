/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Leaves of woven cloth: pure functions of one point on one yarn. s is the position along
 * the yarn in crossings, sigma that across it, -1 to 1.
 * In float all that they give is within 4e-4 of double for |u|, |v| <= 100 and equal input,
 * but at the jumps of the ridges and at edges (test/test_weave.c); the worst is noise with
 * knots .01 crossings apart, 1e-6 without it.
 */
#ifndef SHADE_MODEL_WEAVE_H
#define SHADE_MODEL_WEAVE_H

#include "elementary.h"

/*
 * 32 well mixed bits of a yarn's index, a knot along it and a channel. Multiplications by odd
 * constants and shifts only, so that other languages give the same bits. In two steps, of which the
 * first holds for all knots.
 */
LEAF uint32_t weave_mix(uint32_t h, uint32_t word) {
  h = (h ^ word) * 0x85ebca6bu;
  h ^= h >> 15;
  h *= 0xc2b2ae35u;
  return h ^ h >> 13;
}
LEAF uint32_t weave_hash_of_yarn(uint32_t seed, uint32_t channel, uint32_t yarn) {
  return weave_mix(seed * 0x9e3779b1u + channel, yarn);
}
LEAF uint32_t weave_hash_at(uint32_t yarn_hash, uint32_t knot) {
  return weave_mix(weave_mix(yarn_hash, knot), 0x27d4eb2fu);
}
LEAF uint32_t weave_hash(uint32_t seed, uint32_t channel, uint32_t yarn, uint32_t knot) {
  return weave_hash_at(weave_hash_of_yarn(seed, channel, yarn), knot);
}

/* One noise per use, for weft; those of warp follow. */
enum {
  WEAVE_VARY_BRIGHTNESS,
  WEAVE_VARY_TILT_ALONG,
  WEAVE_VARY_TILT_ACROSS,
  WEAVE_ALONG_BRIGHTNESS,
  WEAVE_ALONG_TILT_ALONG,
  WEAVE_ALONG_TILT_ACROSS,
  WEAVE_SLUB,
  WEAVE_CHANNELS
};

/* -1 <= r < 1, uniform. The top 24 bits: exact in float. */
LEAF real weave_random_of(uint32_t hash) {
  return (real)(int32_t)(hash >> 8) * R(0x1p-23) - 1;
}
LEAF real weave_random(uint32_t seed, uint32_t channel, uint32_t yarn, uint32_t knot) {
  return weave_random_of(weave_hash(seed, channel, yarn, knot));
}

LEAF real weave_floor(real x) {
#if defined(__SSE2__) && !defined(__SSE4_1__)
  /* no such instruction: adding 2^23 (2^52) leaves no place for a fraction */
  const real magic = SHADE_FLOAT ? R(8388608.0) : R(4503599627370496.0);
  const real size = absolute(x), near = (size + magic) - magic;
  const real nearest = x < 0 ? -near : near;
  const real below = nearest > x ? nearest - 1 : nearest;
  return size < magic ? below : x;
#elif SHADE_FLOAT
  return floorf(x);
#else
  return floor(x);
#endif
}

/* x - floor(x), in [0, 1]: 1 where x is below 0 by less than a rounding of 1. */
LEAF real weave_fract(real x) {
  return x - weave_floor(x);
}

/* A whole number modulo 2^32. All of it is exact, whatever the size. */
LEAF uint32_t weave_low_bits(real k) {
  const real range = R(4294967296.0), size = absolute(k);
  const real rest = size - weave_floor(size * (1 / range)) * range;
  const real low = rest >= range / 2 ? rest - range : rest;
  const int32_t bits = (int32_t)low;
  return k < 0 ? 0u - (uint32_t)bits : (uint32_t)bits;
}

/* The knot before p, and how far along the cubic with level ends to the next p is. Beyond 4e18 the
 * last knot. */
LEAF void weave_knot(real p, uint32_t *knot, real *ease) {
  const real limit = R(4e18);
  const real k = minimum(maximum(weave_floor(p), -limit), limit);
  const real t = minimum(maximum(p - k, 0), 1);
  *knot = weave_low_bits(k);
  *ease = t * t * (3 - 2 * t);
}

/* Noise along a yarn: random values at knots, joined by cubics. -1 <= result < 1. */
LEAF real weave_along(uint32_t seed, uint32_t channel, uint32_t yarn, uint32_t knot, real ease) {
  real a = weave_random(seed, channel, yarn, knot);
  real b = weave_random(seed, channel, yarn, knot + 1u);
  return a + (b - a) * ease;
}

/*
 * Saw teeth of the twisted strands: 2 fract(segments (s - slant sigma)) - 1, in [-1, 1].
 * [KangFabric, its twist term corrected: sigma runs across the yarn]
 */
LEAF real weave_ridge(real segments, real slant, real s, real sigma) {
  return 2 * weave_fract(segments * (s - slant * sigma)) - 1;
}

/* w(d) of shade_yarn_params' crimp: 1 at d = 0, 0 from d = length on, smooth and level at both. */
LEAF real weave_dive(real distance, real per_length) {
  real rest = 1 - minimum(distance * per_length, 1);
  return rest * rest * (3 - 2 * rest);
}

/* Shorten (x, y) to at most .98, a tilt of 78.5 degrees. */
LEAF void weave_clamp(real *x, real *y) {
  real square = *x * *x + *y * *y;
  real scale = square > R(0.9604) ? R(0.98) / root(square) : 1;
  *x *= scale;
  *y *= scale;
}

/*
 * Share of an even sky, weighted by the cosine, that reaches sigma on an arc of tilt
 * `curve` sigma between equal arcs, in the plane across the yarns: (1 + cos(tau + eps))/2 with
 * tau the tilt and eps the elevation of the line that touches the neighbour on the side of
 * the lean. `share`: width over distance of the yarns. 0 <= sigma^2 <= 1.
 * With the arc's radius as the unit, that neighbour's centre lies 2 curve/share away.
 */
LEAF real weave_sky(real curve, real share, real sigma) {
  real sine = curve * (sigma < 0 ? -sigma : sigma);
  real cosine = root(1 - sine * sine);
  real away = 2 * curve / share;
  /* D^2 - 1, D the distance from the point to that centre */
  real square = maximum(away * (away - 2 * sine), 0);
  real across = away - sine, reach = root(square);
  /* eps = asin(1/D) - kappa, kappa the centre's depression: tan kappa = cosine/across */
  real inverse = 1 / (square + 1);
  real cos_eps = (reach * across + cosine) * inverse;
  real sin_eps = (across - reach * cosine) * inverse;
  return (1 + cosine * cos_eps - sine * sin_eps) / 2;
}

/*
 * The same at the bottom of a gap between two walls, half a yarn's width deep: sigma from 1
 * (or -1), at the yarn's edge, to 2/share - 1, at its neighbour's.
 */
LEAF real weave_sky_gap(real share, real sigma) {
  real near = maximum((sigma < 0 ? -sigma : sigma) - 1, 0);
  real far = maximum(2 / share - 2 - near, 0);
  return (near / root(near * near + 1) + far / root(far * far + 1)) / 2;
}

#endif
