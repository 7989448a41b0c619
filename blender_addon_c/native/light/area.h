/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A rectangle or an ellipse that shines to one side: `intensity` is that along its normal. A grid
 * of slats before it may narrow its spread: radiance falls with the tangent of the angle.
 */
#ifndef LIBSHADE_LIGHT_AREA_H
#define LIBSHADE_LIGHT_AREA_H

#include "light/common.h"

typedef struct light_area {
  vec3 center;
  vec3 axis[2];      /* from the middle to the edges */
  vec3 across[2];    /* a point's place along axis k is across[k] . (point - center) */
  vec3 normal;       /* where it shines, unit */
  float area;        /* 0: a point */
  float slope, gain; /* radiance: gain (1 - slope tan), of the angle to the normal */
  uint32_t round;    /* for either() */
} light_area;

static inline bool light_area_read(reader *r, light_common *common, light_area *l) {
  float center[3], u[3], v[3], n[3], spread;
  if (!reader_floats(r, "intensity", 3, common->color) ||
      !reader_floats(r, "position", 3, center) || !reader_floats(r, "axis_u", 3, u) ||
      !reader_floats(r, "axis_v", 3, v) || !reader_floats(r, "direction", 3, n) ||
      !reader_number_within(r, "spread", 0, 3.1416, &spread) ||
      !light_switch_read(r, "round", &l->round))
    return false;
  l->center = (vec3){center[0], center[1], center[2]};
  l->axis[0] = (vec3){u[0], u[1], u[2]};
  l->axis[1] = (vec3){v[0], v[1], v[2]};
  l->normal = (vec3){n[0], n[1], n[2]};
  if (!make_unit(&l->normal))
    return reader_expected(r, "direction", "a direction");
  vec3 w = cross(l->axis[0], l->axis[1]);
  float size = sqrtf(dot(w, w));
  l->area = (l->round ? LIGHT_PI : 4.0f) * size;
  common->soft = l->area > 1e-18f && l->area < 1e18f;
  if (common->soft) {
    vec3 n2 = scaled(w, 1.0f / (size * size));
    l->across[0] = cross(l->axis[1], n2);
    l->across[1] = cross(n2, l->axis[0]);
    float side = dot(w, l->normal) < 0.0f ? -1.0f : 1.0f;
    l->normal = scaled(w, side / size);
  }
  /* the power of the whole stays what it is: the integral of cos (1 - slope tan) over the cone */
  double half = fmax(0.5 * (double)spread, 1e-3);
  l->slope = half < 1.5707 ? (float)(1.0 / tan(half)) : 0.0f;
  l->gain = (float)(1.0 / (1.0 - half * (double)l->slope));
  return true;
}

/* Radiance towards where the normal's cosine is this, as a part of that without slats. */
LEAF float light_area_part(const light_area *l, float cosine) {
  float c = cosine > 1e-9f ? cosine : 1e-9f, sine2 = 1.0f - c * c;
  float part = 1.0f - l->slope * sqrtf(sine2 > 0.0f ? sine2 : 0.0f) / c;
  return ((cosine > 0.0f) & (part > 0.0f)) ? l->gain * part : 0.0f;
}

LEAF light_sample light_area_sample(const light_area *l, bool spread, float x, float y, vec3 p) {
  float a = 0.0f, b = 0.0f;
  if (spread) {
    disc_point(x, y, &a, &b);
    a = either(l->round, a, 2.0f * x - 1.0f);
    b = either(l->round, b, 2.0f * y - 1.0f);
  }
  const vec3 *u = &l->axis[0], *v = &l->axis[1];
  vec3 d = {l->center.x - p.x + a * u->x + b * v->x, l->center.y - p.y + a * u->y + b * v->y,
            l->center.z - p.z + a * u->z + b * v->z};
  float d2 = dot(d, d);
  bool apart = d2 > 1e-30f;
  float distance = sqrtf(apart ? d2 : 1.0f), inverse = 1.0f / distance;
  d = scaled(d, inverse);
  d.z = apart ? d.z : 1.0f;
  float cosine = -dot(d, l->normal);
  float e = apart ? cosine * inverse * inverse * light_area_part(l, cosine) : 0.0f;
  float seen = cosine * l->area; /* from there */
  bool shines = e > 0.0f;
  return (light_sample){.direction = d,
                        .distance = distance,
                        .e = e > 0.0f ? e : 0.0f,
                        .pdf = shines ? d2 / (shines ? seen : 1.0f) : 0.0f};
}

LEAF light_intersection light_area_intersect(const light_area *l, vec3 o, vec3 d) {
  vec3 c = {o.x - l->center.x, o.y - l->center.y, o.z - l->center.z};
  float cosine = -dot(d, l->normal), height = dot(c, l->normal);
  bool before = (cosine > 1e-9f) & (height > 0.0f);
  float at = before ? height / cosine : 1.0f;
  vec3 q = {c.x + at * d.x, c.y + at * d.y, c.z + at * d.z};
  float a = dot(q, l->across[0]), b = dot(q, l->across[1]);
  float wide = fabsf(a) > fabsf(b) ? fabsf(a) : fabsf(b);
  bool inside = either(l->round, a * a + b * b, wide) < 1.0f;
  float part = light_area_part(l, cosine);
  bool hit = before & inside & (part > 0.0f);
  return (light_intersection){.distance = hit ? at : -1.0f,
                              .radiance = hit ? part / l->area : 0.0f,
                              .pdf = at * at / ((before ? cosine : 1.0f) * l->area)};
}

/* Nothing behind it; before it as if from its middle, but not less where it is near or seen
 * aslant, since other parts of it are not. */
LEAF float light_area_weight(const light_area *l, vec3 p) {
  vec3 d = {l->center.x - p.x, l->center.y - p.y, l->center.z - p.z};
  float d2 = dot(d, d), height = -dot(d, l->normal), near2 = d2 + 0.25f * l->area;
  near2 = near2 > 1e-18f ? near2 : 1e-18f;
  float cosine = height / sqrtf(near2);
  float part = light_area_part(l, cosine);
  part = part > 0.05f ? part : 0.05f;
  return height > 0.0f ? (cosine + 0.05f) * part / near2 : 0.0f;
}

#endif
