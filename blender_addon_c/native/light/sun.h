/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light from afar: a disc, as large from everywhere. `irradiance` is that of a surface facing it.
 */
#ifndef LIBSHADE_LIGHT_SUN_H
#define LIBSHADE_LIGHT_SUN_H

#include "light/common.h"

typedef struct light_sun {
  vec3 to;       /* unit */
  vec3 axis[2];  /* across it, unit */
  float radius;  /* tan(angle / 2) */
  float cosine;  /* cos(angle / 2) */
  uint32_t even; /* the same radiance from all of it; else as much from each part of a disc that
                   is tangent to the sphere of directions, as in Cycles 3.4 */
} light_sun;

static inline bool light_sun_read(reader *r, light_common *common, light_sun *l) {
  float angle = 0, v[3];
  if (!reader_floats(r, "irradiance", 3, common->color) || !reader_floats(r, "direction", 3, v) ||
      !reader_number_within(r, "angle", 0, 3.1416, &angle) ||
      !light_switch_read(r, "even", &l->even))
    return false;
  l->to = (vec3){v[0], v[1], v[2]};
  if (!make_unit(&l->to))
    return reader_expected(r, "direction", "a direction");
  angle = fminf(angle, 3.14f);
  l->radius = tanf(angle / 2);
  l->cosine = cosf(angle / 2);
  common->soft = l->radius > 0.0f;
  across(l->to, &l->axis[0], &l->axis[1]);
  return true;
}

/* 1 - the cosine of half its angle, also where that is small. */
LEAF float light_sun_depth(const light_sun *l) {
  float sine = l->radius * l->cosine;
  return sine * sine / (1.0f + l->cosine);
}

/* Density of a direction, by its cosine with the middle's. */
LEAF float light_sun_pdf(const light_sun *l, float cosine) {
  float r2 = l->radius * l->radius, even = 2.0f * light_sun_depth(l);
  float area = LIGHT_PI * (either(l->even, even, r2 * cosine * cosine * cosine));
  return 1.0f / (area > 1e-30f ? area : 1e-30f);
}

/* Irradiance of a sample: with the density above that of the whole is 1. */
LEAF float light_sun_e(const light_sun *l) {
  return either(l->even, 2.0f / (1.0f + l->cosine), 1.0f);
}

LEAF light_sample light_sun_sample(const light_sun *l, bool spread, float x, float y, vec3 p) {
  (void)p; /* it is as far from every point */
  if (!spread)
    return (light_sample){.direction = l->to, .distance = INFINITY, .e = 1.0f};
  float narrow = x * light_sun_depth(l), r2 = x * l->radius * l->radius;
  float disc = 1.0f / sqrtf(1.0f + r2), s, c;
  float sine = either(l->even, sqrtf(narrow * (2.0f - narrow)), sqrtf(r2) * disc);
  float cosine = either(l->even, 1.0f - narrow, disc);
  turn(y, &s, &c);
  const vec3 *u = &l->axis[0], *v = &l->axis[1];
  float a = sine * c, b = sine * s;
  return (light_sample){.direction = {cosine * l->to.x + a * u->x + b * v->x,
                                      cosine * l->to.y + a * u->y + b * v->y,
                                      cosine * l->to.z + a * u->z + b * v->z},
                        .distance = INFINITY,
                        .e = light_sun_e(l),
                        .pdf = light_sun_pdf(l, cosine)};
}

/* By the sine: of small angles the cosine says little. */
LEAF light_intersection light_sun_intersect(const light_sun *l, vec3 o, vec3 d) {
  (void)o;
  float cosine = dot(d, l->to), sine = l->radius * l->cosine;
  vec3 off = cross(d, l->to);
  bool hit = (cosine > 0.0f) & (dot(off, off) < sine * sine);
  float pdf = light_sun_pdf(l, cosine);
  return (light_intersection){.distance = hit ? INFINITY : -1.0f,
                              .radiance = hit ? light_sun_e(l) * pdf : 0.0f,
                              .pdf = pdf};
}

LEAF float light_sun_weight(const light_sun *l, vec3 p) {
  (void)l, (void)p;
  return 1.0f;
}

#endif
