/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What kinds of closure have in common. */
#ifndef LIBSHADE_CLOSURE_COMMON_H
#define LIBSHADE_CLOSURE_COMMON_H

#include "batch/leaf.h"
#include "node/common.h"
#include "scene/graph.h"
#include "scene/material.h"

/* No alpha is below 1e-4. */
#define CLOSURE_LEAST_ALPHA 1.01e-4

/* How sharp a lobe of such an alpha is; one that nodes say counts as wide. */
static inline double alpha_exponent(operand alpha) {
  return alpha.at < 0 ? 2.0 / fmax((double)alpha.number * (double)alpha.number, 1e-8) : 0;
}

/* A colour's channel that is a register, or this number; 0 to 1. */
static inline float closure_color_of(const inputs *in, operand o, double number, size_t i) {
  float x = o.at < 0 ? (float)number : in->at[o.at][i];
  return clampf(x, 0.0f, 1.0f);
}

/* Density and f of a direction that is drawn with certainty: what stands for infinite ones. Its
 * square is a float, and so is 1e-9 of it beside any other density. */
#define CLOSURE_CERTAIN 1e15f

/* The registers of a normal from a run's lanes. */
LEAF vec3 normal_at(const inputs *given, const int normal[3], size_t i) {
  return (vec3){given->at[normal[0]][i], given->at[normal[1]][i], given->at[normal[2]][i]};
}

/* An alpha's lanes, no sharper than the path wants it; axis: of those kept for it. */
static inline const float *blurred_lane(inputs *given, const float *from, int axis, lane_run run) {
  const float *least = given->blur;
  float *to = given->blurred[axis];
  if (!given->blurs)
    return from;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++)
    to[i] = from[i] > least[i] ? from[i] : least[i];
  return to;
}

/* The same of an alpha that is a number or a register. */
static inline const float *alpha_lane(inputs *given, operand alpha, int place, int axis,
                                      lane_run run) {
  return blurred_lane(given, lane_of(given, alpha, place, run), axis, run);
}

/* How much is left of the light from l where a matt surface's normal is bent from `own` to n: the
 * cubic in g = own.l/(n.l n.own) that meets 1 without a kink at g = 1. [Chiang2019] */
LEAF float matt_fade(vec3 own, vec3 n, vec3 l) {
  float cosine = dot(n, own) * dot(n, l), whole = dot(own, l);
  bool full = (whole > 0.0f) & !(whole < cosine);
  float g = full ? 1.0f : clampf(whole, 0.0f, 1.0f) / (cosine > 1e-12f ? cosine : 1e-12f);
  g = clampf(g, 0.0f, 1.0f);
  return g + g * g * (1.0f - g);
}

/* The same by Smith's shadow of facets that have n as often as `own`: 0 where n is behind `own`.
 * [Estevez2019] */
LEAF float matt_shadow(vec3 own, vec3 n, vec3 l) {
  float up = dot(n, own), light = dot(own, l);
  float square = clampf(up * up, 1e-12f, 1.0f), low = clampf(light * light, 1e-12f, 1.0f);
  float alpha2 = clampf(0.125f * (1.0f - square) / square, 0.0f, 1.0f);
  float part = 2.0f / (1.0f + sqrtf(1.0f + alpha2 * (1.0f - low) / low));
  return ((up > -1e-6f) & (light > 0.0f)) ? part : 0.0f;
}

/* A direction about n by the cosine, from a point of the unit square; its density is cos / pi. */
LEAF vec3 cosine_about(vec3 n, float x, float y, float *cosine) {
  float radius = sqrtf(x), s, c;
  vec3 a, b;
  turn(y, &s, &c);
  across(n, &a, &b);
  *cosine = sqrtf(1.0f - x);
  float p = radius * c, q = radius * s, z = *cosine;
  return (vec3){p * a.x + q * b.x + z * n.x, p * a.y + q * b.y + z * n.y,
                p * a.z + q * b.z + z * n.z};
}

#endif
