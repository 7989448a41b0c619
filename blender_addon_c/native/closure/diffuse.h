/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A matt surface. It reads `color` (three operands), `roughness` (one) and `normal`. `model` is one
 * of
 *
 *   LAMBERT
 *   OREN_NAYAR   Oren and Nayar's qualitative model, tan replaced, as Cycles has it until 4.2
 *                [Fujii2012]
 *   EON          the same with the light of several bounces, from 4.3 on [Portsmouth2025]; Cycles
 *                takes the colour of these once more than the paper
 *   BURLEY       of the Principled BSDF until 3.6 [Burley2012]
 *
 * `bumps` says what is lit where the normal is not the surface's own, or `own`, another one. It is
 * one of
 *
 *   HARD         what eye and light see of it
 *   SHADED       what light sees of it, less by Smith's shadow of such bumps [Estevez2019]
 *   FADED        what both see, less where it is turned to the light [Chiang2019]
 *   OPEN         all of the hemisphere about the normal, below the surface, too
 */
#ifndef LIBSHADE_CLOSURE_DIFFUSE_H
#define LIBSHADE_CLOSURE_DIFFUSE_H

#include "closure/common.h"
#include "node/common.h"

enum { DIFFUSE_LAMBERT, DIFFUSE_OREN_NAYAR, DIFFUSE_EON, DIFFUSE_BURLEY };
enum { DIFFUSE_HARD, DIFFUSE_SHADED, DIFFUSE_FADED, DIFFUSE_OPEN };

typedef struct closure_diffuse {
  int model, bumps, normal[3], own[3];
  operand color[3], roughness;
} closure_diffuse;

static inline bool closure_diffuse_read(reader *r, closure_diffuse *c, graph *g) {
  static const char *const models[] = {"LAMBERT", "OREN_NAYAR", "EON", "BURLEY", NULL};
  static const char *const bumps[] = {"HARD", "SHADED", "FADED", "OPEN", NULL};
  c->bumps = DIFFUSE_HARD;
  if (reader_has(r, "bumps") && !reader_word(r, "bumps", bumps, &c->bumps))
    return false;
  operand own[3] = {
      {.at = REGISTER_NORMAL}, {.at = REGISTER_NORMAL + 1}, {.at = REGISTER_NORMAL + 2}};
  if (reader_has(r, "own") && !graph_operands(r, g, "own", 3, own))
    return false;
  for (int k = 0; k < 3; k++)
    if ((c->own[k] = own[k].at) < 0)
      return reader_fail(r, "own must be three registers");
  g->bare |= c->bumps != DIFFUSE_HARD; /* it reads the surface's own normal, too */
  return reader_word(r, "model", models, &c->model) && graph_operands(r, g, "color", 3, c->color) &&
         graph_operands(r, g, "roughness", 1, &c->roughness) && graph_normal(r, g, c->normal);
}

static inline float closure_diffuse_color(const closure_diffuse *c, const inputs *in, int k,
                                          size_t i) {
  return closure_color_of(in, c->color[k], (double)c->color[k].number, i);
}

#define DIFFUSE_PI 3.14159265f

LEAF float fifth_power(float x) {
  float q = x * x;
  return q * q * x;
}

/* Integral over the hemisphere of what EON's second term adds, over its factor. */
LEAF float eon_share(float cosine) {
  float c = clampf(cosine, 1e-4f, 1.0f), s = sqrtf(1.0f - c * c);
  float angle = arc_tangent2(s, c);
  return s * (angle - 2.0f / 3.0f - s * c) + 2.0f / 3.0f * (s / c) * (1.0f - s * s * s);
}

/* f times pi of one channel's colour; l, v, n: unit, nl and nv their cosines, above 0. */
LEAF float diffuse_term(int model, float color, float rough, float nl, float nv, float lv) {
  if (model == DIFFUSE_LAMBERT)
    return color;
  if (model == DIFFUSE_BURLEY) {
    float h2 = 0.5f + 0.5f * lv; /* cos^2 of light and half vector */
    float fl = fifth_power(1.0f - nl), fv = fifth_power(1.0f - nv), rr = 2.0f * rough * h2;
    float retro = rr * (fl + fv + fl * fv * (rr - 1.0f));
    return color * ((1.0f - 0.5f * fl) * (1.0f - 0.5f * fv) + retro);
  }
  bool eon = model == DIFFUSE_EON;
  float slope = eon ? 0.5f - 2.0f / (3.0f * DIFFUSE_PI) : 0.5f - 2.0f / (3.0f * DIFFUSE_PI);
  float a = 1.0f / (1.0f + slope * rough), b = rough * a;
  float t = lv - nl * nv, most = nl > nv ? nl : nv;
  float single = a + b * (t > 0.0f ? t / (most > 1e-6f ? most : 1e-6f) : t);
  if (!eon)
    return color * single;
  float mean = a * (1.0f + rough * (2.0f / 3.0f - 28.0f / (15.0f * DIFFUSE_PI)));
  float from = 1.0f - a * (1.0f + rough / DIFFUSE_PI * eon_share(nl));
  float to = 1.0f - a * (1.0f + rough / DIFFUSE_PI * eon_share(nv));
  float lost = 1.0f - mean > 1e-6f ? 1.0f - mean : 1e-6f;
  float again = color * color * mean / (1.0f - color * lost); /* Cycles: the colour twice */
  return color * (single + again * from * to / lost);
}

/* What it reads of a run's points. */
typedef struct diffuse_lanes {
  const float *color[3], *roughness;
} diffuse_lanes;

static inline diffuse_lanes diffuse_lanes_of(const closure_diffuse *c, inputs *given,
                                             lane_run run) {
  diffuse_lanes lanes = {.roughness = lane_of(given, c->roughness, 3, run)};
  for (int k = 0; k < 3; k++)
    lanes.color[k] = lane_of(given, c->color[k], k, run);
  return lanes;
}

LEAF void diffuse_f(int model, const diffuse_lanes *from, size_t i, float nl, float nv, float lv,
                    float part, lane_c *f) {
  float rough = clampf(from->roughness[i], 0.0f, 1.0f);
  float scale = part * (1.0f / DIFFUSE_PI);
  float r = clampf(from->color[0][i], 0.0f, 1.0f), g = clampf(from->color[1][i], 0.0f, 1.0f);
  float b = clampf(from->color[2][i], 0.0f, 1.0f);
  f->r[i] = scale * diffuse_term(model, r, rough, nl, nv, lv);
  f->g[i] = scale * diffuse_term(model, g, rough, nl, nv, lv);
  f->b[i] = scale * diffuse_term(model, b, rough, nl, nv, lv);
}

/* The normal, and that which it is bent from; what of the eye's cosine is enough, and of a
 * direction's height. */
typedef struct diffuse_bent {
  const float *n[3], *own[3];
  float least, lowest, fades, shades;
} diffuse_bent;

static inline diffuse_bent diffuse_bent_of(const closure_diffuse *c, const surfaces *at,
                                           const inputs *given) {
  const float *const lean[] = {at->lean.x, at->lean.y, at->lean.z};
  bool plain = c->normal[0] == REGISTER_NORMAL, away = plain && at->leans == LEANS_AWAY;
  const bool open = c->bumps == DIFFUSE_OPEN;
  bool leans = at->leans == LEANS_FADING && c->own[0] == REGISTER_NORMAL;
  bool fades = c->bumps == DIFFUSE_FADED || (!open && plain && at->leans == LEANS_FADING);
  diffuse_bent made = {.least = away || open || c->bumps == DIFFUSE_SHADED ? -2.0f : 0.0f,
                       .lowest = open ? -2.0f : 0.0f,
                       .fades = fades ? 1.0f : 0.0f,
                       .shades = c->bumps == DIFFUSE_SHADED ? 1.0f : 0.0f};
  for (int k = 0; k < 3; k++) {
    made.n[k] = away ? lean[k] : given->at[c->normal[k]];
    made.own[k] = leans ? lean[k] : given->at[c->own[k]];
  }
  return made;
}

LEAF float diffuse_fade(const diffuse_bent *bent, size_t i, vec3 n, vec3 l) {
  vec3 own = {bent->own[0][i], bent->own[1][i], bent->own[2][i]};
  return 1.0f + bent->fades * (matt_fade(own, n, l) - 1.0f) +
         bent->shades * (matt_shadow(own, n, l) - 1.0f);
}

LEAF void diffuse_eval(int model, const closure_diffuse *c, lane_run run,
                       const surfaces *restrict at, inputs *given, const lane_v *restrict wi,
                       reflections *restrict out) {
  const diffuse_lanes lanes = diffuse_lanes_of(c, given, run);
  const diffuse_bent bent = diffuse_bent_of(c, at, given);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = {bent.n[0][i], bent.n[1][i], bent.n[2][i]}, l = load(wi, i), v = load(&at->wo, i);
    float nl = dot(n, l), nv = dot(n, v);
    bool lit = (nl > 0.0f) & (l.z > bent.lowest) & (nv > bent.least);
    diffuse_f(model, &lanes, i, clampf(nl, 0.0f, 1.0f), clampf(nv, 0.0f, 1.0f), dot(l, v),
              lit ? diffuse_fade(&bent, i, n, l) : 0.0f, &out->f);
    out->cosine[i] = lit ? nl : 0.0f;
    out->pdf[i] = lit ? nl * (1.0f / DIFFUSE_PI) : 0.0f;
  }
}

LEAF void diffuse_draw(int model, const closure_diffuse *c, lane_run run,
                       const surfaces *restrict at, inputs *given, draws *restrict out) {
  const diffuse_lanes lanes = diffuse_lanes_of(c, given, run);
  const diffuse_bent bent = diffuse_bent_of(c, at, given);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = {bent.n[0][i], bent.n[1][i], bent.n[2][i]}, v = load(&at->wo, i);
    float nl, nv = dot(n, v);
    vec3 l = cosine_about(n, out->x[i], out->y[i], &nl);
    bool lit = (nl > 0.0f) & (l.z > bent.lowest) & (nv > bent.least);
    store(&out->wi, i, l);
    diffuse_f(model, &lanes, i, nl, clampf(nv, 0.0f, 1.0f), dot(l, v),
              lit ? diffuse_fade(&bent, i, n, l) : 0.0f, &out->f);
    out->cosine[i] = nl;
    out->pdf[i] = lit ? nl * (1.0f / DIFFUSE_PI) : 0.0f;
  }
}

#define DIFFUSE_OF(what, ...)                                                                      \
  switch (c->model) {                                                                              \
  case DIFFUSE_LAMBERT:                                                                            \
    diffuse_##what(DIFFUSE_LAMBERT, __VA_ARGS__);                                                  \
    break;                                                                                         \
  case DIFFUSE_OREN_NAYAR:                                                                         \
    diffuse_##what(DIFFUSE_OREN_NAYAR, __VA_ARGS__);                                               \
    break;                                                                                         \
  case DIFFUSE_EON:                                                                                \
    diffuse_##what(DIFFUSE_EON, __VA_ARGS__);                                                      \
    break;                                                                                         \
  case DIFFUSE_BURLEY:                                                                             \
    diffuse_##what(DIFFUSE_BURLEY, __VA_ARGS__);                                                   \
  }

LEAF unsigned closure_diffuse_eval(const closure_diffuse *c, lane_run run, const surfaces *at,
                                   inputs *given, const lane_v *wi, bool density,
                                   reflections *out) {
  (void)density;
  DIFFUSE_OF(eval, c, run, at, given, wi, out)
  return 0;
}

LEAF unsigned closure_diffuse_draw(const closure_diffuse *c, lane_run run, const surfaces *at,
                                   inputs *given, draws *out) {
  DIFFUSE_OF(draw, c, run, at, given, out)
  return 0;
}
#undef DIFFUSE_OF

LEAF void closure_diffuse_albedo(const closure_diffuse *c, lane_run run, const surfaces *at,
                                 inputs *given, float *out) {
  const float *r = lane_of(given, c->color[0], 0, run), *g = lane_of(given, c->color[1], 1, run);
  const float *b = lane_of(given, c->color[2], 2, run);
  (void)at;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++)
    out[i] = clampf((r[i] + g[i] + b[i]) * (1.0f / 3.0f), 0.0f, 1.0f);
}

#endif
