/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Fibres that stand up from a surface; `normal`; `model`, one of
 *   SCHLICK  a rim by Schlick's Fresnel, of the Principled BSDF until 3.6 [Burley2012]
 *   VELVET   slopes by an inverse Gaussian of width `sigma`, one operand [AshikhminPremoze2000]
 *   FIBRES   the cosine's lobe as a matrix stretches and leans it [Zeltner2022], by `a` and `b`, an
 *            operand each, from node FIBRES; its albedo, that node's too, is in the weight
 */
#ifndef LIBSHADE_CLOSURE_SHEEN_H
#define LIBSHADE_CLOSURE_SHEEN_H

#include "closure/diffuse.h"

enum { SHEEN_SCHLICK, SHEEN_VELVET, SHEEN_FIBRES };

typedef struct closure_sheen {
  int model, normal[3];
  operand sigma, a, b;
} closure_sheen;

static inline bool closure_sheen_read(reader *r, closure_sheen *c, graph *g) {
  static const char *const models[] = {"SCHLICK", "VELVET", "FIBRES", NULL};
  c->sigma = c->a = (operand){.at = OPERAND_NUMBER, .number = 1.0f};
  c->b = (operand){.at = OPERAND_NUMBER};
  if (!reader_word(r, "model", models, &c->model))
    return false;
  if (c->model == SHEEN_VELVET && !graph_operands(r, g, "sigma", 1, &c->sigma))
    return false;
  if (c->model == SHEEN_FIBRES &&
      !(graph_operands(r, g, "a", 1, &c->a) && graph_operands(r, g, "b", 1, &c->b)))
    return false;
  return graph_normal(r, g, c->normal);
}

/* f cos. */
LEAF float sheen_rim(float nl, float lh) {
  return fifth_power(clampf(1.0f - lh, 0.0f, 1.0f)) * nl;
}

LEAF float sheen_velvet(float sigma, float nl, float nv, float nh, float lh) {
  float per_width = 1.0f / (sigma * sigma);
  float sine2 = clampf(1.0f - nh * nh, 2e-5f, 1.0f);
  float d = exponential2(-1.44269504f * per_width * nh * nh / sine2) * per_width /
            (DIFFUSE_PI * sine2 * sine2);
  float way = 2.0f * nh / (lh > 1e-5f ? lh : 1e-5f);
  float g = way * nl < way * nv ? way * nl : way * nv;
  return 0.25f * d * (g < 1.0f ? g : 1.0f) / nv;
}

/* Across the eye's plane, along it away from the eye, along the normal. */
LEAF float sheen_fibres(float a, float b, float along, float side, float up) {
  float lean = a * along + b * up, wide = a * side;
  float square = lean * lean + wide * wide + up * up, share = a / square;
  return 0.318309886f * up * share * share;
}

/* The eye's side of the surface: unit, across n. */
LEAF vec3 sheen_along(vec3 n, vec3 v, float nv) {
  vec3 t = {v.x - nv * n.x, v.y - nv * n.y, v.z - nv * n.z}, any, other;
  float square = dot(t, t);
  across(n, &any, &other);
  bool slanted = square > 1e-10f;
  return scaled(select3(slanted, t, any), 1.0f / sqrtf(slanted ? square : 1.0f));
}

typedef struct sheen_lanes {
  const float *sigma, *a, *b;
} sheen_lanes;
static inline sheen_lanes sheen_lanes_of(const closure_sheen *c, inputs *given, lane_run run) {
  return (sheen_lanes){.sigma = lane_of(given, c->sigma, 0, run),
                       .a = lane_of(given, c->a, 1, run),
                       .b = lane_of(given, c->b, 2, run)};
}

/* f cos and density of light from l. */
LEAF float sheen_of(int model, const sheen_lanes *from, size_t i, vec3 n, vec3 v, vec3 l,
                    float *pdf) {
  float nl = dot(n, l), nv = dot(n, v);
  bool lit = (nl > 0.0f) & (nv > 1e-5f) & (l.z > 0.0f);
  float f;
  if (model == SHEEN_FIBRES) {
    vec3 along = sheen_along(n, v, nv), side = cross(n, along);
    float a = clampf(from->a[i], 1e-4f, 1e4f), b = clampf(from->b[i], -1e4f, 1e4f);
    f = *pdf = sheen_fibres(a, b, dot(l, along), dot(l, side), nl);
  } else {
    vec3 h = {l.x + v.x, l.y + v.y, l.z + v.z};
    h = scaled(h, 1.0f / sqrtf(dot(h, h) + 1e-20f));
    float lh = dot(l, h);
    f = model == SHEEN_SCHLICK ? sheen_rim(nl, lh)
                               : sheen_velvet(clampf(from->sigma[i], 0.01f, 1e4f), nl,
                                              nv > 1e-5f ? nv : 1e-5f, dot(n, h), lh);
    *pdf = model == SHEEN_SCHLICK ? nl * 0.318309886f : 0.159154943f;
  }
  *pdf = lit ? *pdf : 0.0f;
  return lit ? f : 0.0f;
}

LEAF void sheen_eval(int model, const closure_sheen *c, lane_run run, const surfaces *restrict at,
                     inputs *given, const lane_v *restrict wi, reflections *restrict out) {
  const sheen_lanes from = sheen_lanes_of(c, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, c->normal, i);
    float f = sheen_of(model, &from, i, n, load(&at->wo, i), load(wi, i), &out->pdf[i]);
    out->f.r[i] = out->f.g[i] = out->f.b[i] = f;
    out->cosine[i] = 1.0f; /* it is in f */
  }
}

LEAF unsigned closure_sheen_eval(const closure_sheen *c, lane_run run, const surfaces *restrict at,
                                 inputs *given, const lane_v *restrict wi, bool density,
                                 reflections *restrict out) {
  (void)density;
  if (c->model == SHEEN_SCHLICK)
    sheen_eval(SHEEN_SCHLICK, c, run, at, given, wi, out);
  else if (c->model == SHEEN_VELVET)
    sheen_eval(SHEEN_VELVET, c, run, at, given, wi, out);
  else
    sheen_eval(SHEEN_FIBRES, c, run, at, given, wi, out);
  return 0;
}

/* By the cosine, evenly, or by the cosine's lobe as it is stretched. */
LEAF void sheen_draw(int model, const closure_sheen *c, lane_run run, const surfaces *restrict at,
                     inputs *given, draws *restrict out) {
  const sheen_lanes from = sheen_lanes_of(c, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, c->normal, i), v = load(&at->wo, i);
    vec3 along = sheen_along(n, v, dot(n, v)), side = cross(n, along);
    float x = out->x[i], z = model == SHEEN_VELVET ? x : sqrtf(1.0f - x), s, t;
    float radius = model == SHEEN_VELVET ? sqrtf(1.0f - x * x) : sqrtf(x);
    turn(out->y[i], &s, &t);
    vec3 d = {radius * t, radius * s, z};
    if (model == SHEEN_FIBRES) {
      float a = clampf(from.a[i], 1e-4f, 1e4f), b = clampf(from.b[i], -1e4f, 1e4f);
      d = (vec3){d.x - b * d.z, d.y, a * d.z};
      d = scaled(d, 1.0f / sqrtf(dot(d, d)));
    }
    vec3 l = {d.x * along.x + d.y * side.x + d.z * n.x, d.x * along.y + d.y * side.y + d.z * n.y,
              d.x * along.z + d.y * side.z + d.z * n.z};
    float f = sheen_of(model, &from, i, n, v, l, &out->pdf[i]);
    store(&out->wi, i, l);
    out->f.r[i] = out->f.g[i] = out->f.b[i] = f;
    out->cosine[i] = 1.0f;
  }
}

LEAF unsigned closure_sheen_draw(const closure_sheen *c, lane_run run, const surfaces *restrict at,
                                 inputs *given, draws *restrict out) {
  if (c->model == SHEEN_SCHLICK)
    sheen_draw(SHEEN_SCHLICK, c, run, at, given, out);
  else if (c->model == SHEEN_VELVET)
    sheen_draw(SHEEN_VELVET, c, run, at, given, out);
  else
    sheen_draw(SHEEN_FIBRES, c, run, at, given, out);
  return 0;
}

/* A rim is dark head-on. */
LEAF void closure_sheen_albedo(const closure_sheen *c, lane_run run, const surfaces *restrict at,
                               inputs *given, float *out) {
  const float low = c->model == SHEEN_FIBRES ? 1.0f : 0.1f;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float dark = 1.0f - clampf(dot(normal_at(given, c->normal, i), load(&at->wo, i)), 0.0f, 1.0f);
    out[i] = low + (1.0f - low) * dark * dark;
  }
}

#endif
