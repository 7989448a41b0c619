/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Light in a cone of one brightness with a soft rim: about `normal`, or where `mirrors` about the
 * eye's mirror image by it. `size`, of the cone, and `smooth`, of the rim beyond it, one operand
 * each: parts of a right angle. As Cycles has it: what arrives within cone and rim leaves a cone as
 * wide as both evenly, dimmed towards the rim by the angle. `overcounts`: beside other closures its
 * density is that within the cone everywhere, as 3.4's Cycles has it of what mirrors, by which they
 * lose light.
 */
#ifndef LIBSHADE_CLOSURE_TOON_H
#define LIBSHADE_CLOSURE_TOON_H

#include "closure/common.h"

typedef struct closure_toon {
  bool mirrors, overcounts;
  int normal[3];
  operand size, smooth;
} closure_toon;

static inline bool closure_toon_read(reader *r, closure_toon *c, graph *g) {
  c->overcounts = false;
  if (!reader_may_flag(r, "overcounts", &c->overcounts))
    return false;
  if (!reader_flag(r, "mirrors", &c->mirrors))
    return false;
  g->traits |= c->mirrors ? 0u : CLOSURE_MATT;
  return graph_operands(r, g, "size", 1, &c->size) &&
         graph_operands(r, g, "smooth", 1, &c->smooth) && graph_normal(r, g, c->normal);
}

/* A cone: its angle, that of its rim and of both, and 1 less the cosine of the latter. */
typedef struct toon_cone {
  float size, smooth, edge, cap;
} toon_cone;

LEAF toon_cone toon_cone_of(float size, float smooth) {
  toon_cone cone = {.size = 1.57079633f * clampf(size, 1e-4f, 1.0f),
                    .smooth = 1.57079633f * clampf(smooth, 0.0f, 1.0f)};
  float both = cone.size + cone.smooth, s, c;
  cone.edge = both < 1.57079633f ? both : 1.57079633f;
  turn(cone.edge * 0.0795774715f, &s, &c); /* of half of it: small ones keep their digits */
  cone.cap = 2.0f * s * s;
  return cone;
}

LEAF vec3 toon_axis(bool mirrors, vec3 n, vec3 v) {
  float twice = 2.0f * dot(n, v);
  vec3 mirrored = {twice * n.x - v.x, twice * n.y - v.y, twice * n.z - v.z};
  return select3(mirrors, mirrored, n);
}

/* f cos and density of light from l. */
LEAF float toon_of(toon_cone cone, bool over, vec3 axis, vec3 n, vec3 v, vec3 l, float *pdf) {
  vec3 off = cross(axis, l);
  float angle = arc_tangent2(sqrtf(dot(off, off)), dot(axis, l));
  float nl = dot(n, l), nv = dot(n, v);
  bool above = (nl > 0.0f) & (nv > 0.0f) & (l.z > 0.0f), lit = above & (angle <= cone.edge);
  float part = clampf(1.0f - (angle - cone.size) / (cone.smooth + 1e-9f), 0.0f, 1.0f);
  float within = 0.159154943f / cone.cap;
  *pdf = lit | (over & above) ? within : 0.0f;
  return (lit ? within : 0.0f) * (angle < cone.size ? 1.0f : part);
}

LEAF unsigned closure_toon_eval(const closure_toon *c, lane_run run, const surfaces *restrict at,
                                inputs *given, const lane_v *restrict wi, bool density,
                                reflections *restrict out) {
  const float *size = lane_of(given, c->size, 0, run), *smooth = lane_of(given, c->smooth, 1, run);
  const bool mirrors = c->mirrors, over = c->overcounts;
  (void)density;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, c->normal, i), v = load(&at->wo, i);
    float f = toon_of(toon_cone_of(size[i], smooth[i]), over, toon_axis(mirrors, n, v), n, v,
                      load(wi, i), &out->pdf[i]);
    out->f.r[i] = out->f.g[i] = out->f.b[i] = f;
    out->cosine[i] = 1.0f; /* it is in f */
  }
  return 0;
}

LEAF unsigned closure_toon_draw(const closure_toon *c, lane_run run, const surfaces *restrict at,
                                inputs *given, draws *restrict out) {
  const float *size = lane_of(given, c->size, 0, run), *smooth = lane_of(given, c->smooth, 1, run);
  const bool mirrors = c->mirrors, over = c->overcounts;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 n = normal_at(given, c->normal, i), v = load(&at->wo, i), a, b;
    vec3 axis = toon_axis(mirrors, n, v);
    toon_cone cone = toon_cone_of(size[i], smooth[i]);
    float down = out->x[i] * cone.cap, z = 1.0f - down, radius = sqrtf(down * (2.0f - down)), s, t;
    turn(out->y[i], &s, &t);
    across(axis, &a, &b);
    float p = radius * t, q = radius * s;
    vec3 l = {p * a.x + q * b.x + z * axis.x, p * a.y + q * b.y + z * axis.y,
              p * a.z + q * b.z + z * axis.z};
    float f = toon_of(cone, over, axis, n, v, l, &out->pdf[i]);
    store(&out->wi, i, l);
    out->f.r[i] = out->f.g[i] = out->f.b[i] = f;
    out->cosine[i] = 1.0f;
  }
  return 0;
}

LEAF void closure_toon_albedo(const closure_toon *c, lane_run run, const surfaces *at,
                              inputs *given, float *out) {
  (void)c, (void)at, (void)given;
  for (size_t i = run.begin; i < run.end; i++)
    out[i] = 1.0f;
}

#endif
