/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sphere that shines evenly: irradiance `intensity` / distance². */
#ifndef LIBSHADE_LIGHT_POINT_H
#define LIBSHADE_LIGHT_POINT_H

#include "light/common.h"

typedef struct light_point {
  float position[3];
  float radius; /* 0 is sharp */
} light_point;

static inline bool light_point_read(reader *r, light_common *common, light_point *l) {
  bool good = reader_floats(r, "intensity", 3, common->color) &&
              reader_floats(r, "position", 3, l->position) &&
              reader_number_within(r, "radius", 0, 1e18, &l->radius);
  common->soft = l->radius > 0.0f;
  return good;
}

/* A disc that faces the shaded point: what it sees of a sphere, but for a rim. */
LEAF light_sample light_point_sample(const light_point *l, bool spread, float x, float y, vec3 p) {
  vec3 d = {l->position[0] - p.x, l->position[1] - p.y, l->position[2] - p.z};
  float d2 = dot(d, d);
  if (spread) {
    vec3 w = scaled(d, 1.0f / sqrtf(d2 > 1e-30f ? d2 : 1e-30f));
    /* two axes across it [Duff2017] */
    float sign = w.z < 0.0f ? -1.0f : 1.0f;
    float q = -1.0f / (sign + w.z), r = w.x * w.y * q;
    float a, b;
    disc_point(x, y, &a, &b);
    a *= l->radius;
    b *= l->radius;
    d.x += a * (1.0f + sign * w.x * w.x * q) + b * r;
    d.y += a * sign * r + b * (sign + w.y * w.y * q);
    d.z -= a * sign * w.x + b * w.y;
    d2 = dot(d, d);
  }
  bool apart = d2 > 1e-30f; /* a light on the surface itself gives none */
  float distance = sqrtf(apart ? d2 : 1.0f);
  float inverse = 1.0f / distance;
  d = scaled(d, inverse);
  d.z = apart ? d.z : 1.0f;
  return (light_sample){
      .direction = d, .distance = distance, .e = apart ? inverse * inverse : 0.0f};
}

#endif
