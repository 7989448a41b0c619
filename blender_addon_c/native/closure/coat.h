/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The clear coat of the Principled BSDF until 3.6: GTR of exponent 1 and width `alpha`, one
 * operand, shadowed as GGX of .25, Fresnel of index 1.5 [Burley2012]. `normal`. */
#ifndef LIBSHADE_CLOSURE_COAT_H
#define LIBSHADE_CLOSURE_COAT_H

#include "closure/diffuse.h"
#include "closure/glass.h"

typedef struct closure_coat {
  operand alpha;
  int normal[3];
} closure_coat;

static inline bool closure_coat_read(reader *r, closure_coat *c, graph *g) {
  if (!graph_operands(r, g, "alpha", 1, &c->alpha))
    return false;
  g->exponent = alpha_exponent(c->alpha);
  return graph_normal(r, g, c->normal);
}

/* From 1 on it is even. */
LEAF float coat_alpha(float alpha) {
  return clampf(alpha, 1e-4f, 0.9999f);
}

/* f cos for a half vector h; *pdf: of draws of h by D cos. */
LEAF float coat_of(float alpha, vec3 n, vec3 v, vec3 l, vec3 h, float *pdf) {
  float nl = dot(n, l), nv = dot(n, v), nh = dot(n, h), vh = dot(v, h), t;
  bool lit = (nl > 0.0f) & (nv > 1e-5f) & (l.z > 0.0f) & (nh > 0.0f) & (vh > 1e-6f);
  /* 1 + (alpha^2 - 1) nh^2, without loss near the peak */
  vec3 off = {h.x - nh * n.x, h.y - nh * n.y, h.z - nh * n.z};
  float a2 = alpha * alpha, under = dot(off, off) + a2 * nh * nh;
  float d = (1.0f - a2) / (-DIFFUSE_PI * 0.69314718f * logarithm2(a2) * under);
  float g = 1.0f / ((1.0f + glass_lambda(nv, 0.25f)) * (1.0f + glass_lambda(nl, 0.25f)));
  float fresnel = dielectric_fresnel(clampf(vh, 0.0f, 1.0f), 1.5f, &t);
  *pdf = lit ? d * nh / (4.0f * vh) : 0.0f;
  return lit ? 0.25f * d * g * fresnel / nv : 0.0f;
}

LEAF unsigned closure_coat_eval(const closure_coat *c, lane_run run, const surfaces *restrict at,
                                inputs *given, const lane_v *restrict wi, bool density,
                                reflections *restrict out) {
  const float *alpha = alpha_lane(given, c->alpha, 0, 0, run);
  (void)density;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, c->normal, i), l = load(wi, i), v = load(&at->wo, i);
    vec3 h = {l.x + v.x, l.y + v.y, l.z + v.z};
    h = scaled(h, 1.0f / sqrtf(dot(h, h) + 1e-20f));
    float f = coat_of(coat_alpha(alpha[i]), n, v, l, h, &out->pdf[i]);
    out->f.r[i] = out->f.g[i] = out->f.b[i] = f;
    out->cosine[i] = 1.0f; /* it is in f */
  }
  return 0;
}

LEAF unsigned closure_coat_draw(const closure_coat *c, lane_run run, const surfaces *restrict at,
                                inputs *given, draws *restrict out) {
  const float *alpha = alpha_lane(given, c->alpha, 0, 0, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, c->normal, i), v = load(&at->wo, i), x, y;
    float own = coat_alpha(alpha[i]), a2 = own * own, s, t;
    across(n, &x, &y);
    /* the integral of D cos up to sine^2 is ln(1 + sine^2 (1 - a2) / a2) / ln(1 / a2) */
    float sine2 = a2 * (exponential2(-out->x[i] * logarithm2(a2)) - 1.0f) / (1.0f - a2);
    sine2 = clampf(sine2, 0.0f, 1.0f);
    float sine = sqrtf(sine2), cosine = sqrtf(1.0f - sine2);
    turn(out->y[i], &s, &t);
    float p = sine * t, q = sine * s;
    vec3 h = {p * x.x + q * y.x + cosine * n.x, p * x.y + q * y.y + cosine * n.y,
              p * x.z + q * y.z + cosine * n.z};
    float twice = 2.0f * dot(v, h);
    vec3 l = {twice * h.x - v.x, twice * h.y - v.y, twice * h.z - v.z};
    float f = coat_of(own, n, v, l, h, &out->pdf[i]);
    store(&out->wi, i, l);
    out->f.r[i] = out->f.g[i] = out->f.b[i] = f;
    out->cosine[i] = 1.0f;
  }
  return 0;
}

LEAF void closure_coat_albedo(const closure_coat *c, lane_run run, const surfaces *restrict at,
                              inputs *given, float *out) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float t, nv = clampf(dot(normal_at(given, c->normal, i), load(&at->wo, i)), 0.0f, 1.0f);
    out[i] = dielectric_fresnel(nv, 1.5f, &t);
  }
}

#endif
