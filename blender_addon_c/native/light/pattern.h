/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a lamp shines by the direction in which it does: a picture of all directions, whose middle
 * is along the lamp's own x axis and whose rows go up along its z, as a factor of its colour. Of a
 * ball whose normals are asked for the direction is that where it is met [measured in Cycles 5.0].
 */
#ifndef LIBSHADE_LIGHT_PATTERN_H
#define LIBSHADE_LIGHT_PATTERN_H

#include <math.h>

#include "batch/leaf.h"
#include "light/common.h"

struct light_pattern {
  int width, height;
  vec3 middle;  /* of the lamp */
  float radius; /* of such a ball, else 0 */
  vec3 axis[3]; /* of the lamp, unit */
  float *texel; /* red, green, blue; rows from below; the caller of light_pattern_free owns it */
};

/* Factors of the light that goes this way, unit. */
static inline void light_pattern_along(const light_pattern *p, vec3 d, float rgb[3]) {
  float x = dot(d, p->axis[0]), y = dot(d, p->axis[1]), z = dot(d, p->axis[2]);
  float u = (0.5f - atan2f(y, x) * (0.5f / LIGHT_PI)) * (float)p->width - 0.5f;
  float v = (0.5f + asinf(clampf(z, -1.0f, 1.0f)) * (1.0f / LIGHT_PI)) * (float)p->height - 0.5f;
  if (!(fabsf(u) < 1e9f && fabsf(v) < 1e9f)) /* of no number */
    u = v = 0.0f;
  v = clampf(v, 0.0f, (float)(p->height - 1));
  float left = floorf(u), below = floorf(v);
  float s = u - left, t = v - below;
  int x0 = ((int)left % p->width + p->width) % p->width, x1 = (x0 + 1) % p->width;
  int y0 = (int)below, y1 = y0 + 1 < p->height ? y0 + 1 : y0;
  const float *a = p->texel + 3 * ((size_t)y0 * (size_t)p->width);
  const float *b = p->texel + 3 * ((size_t)y1 * (size_t)p->width);
  for (int c = 0; c < 3; c++) {
    float low = a[3 * x0 + c] + s * (a[3 * x1 + c] - a[3 * x0 + c]);
    float high = b[3 * x0 + c] + s * (b[3 * x1 + c] - b[3 * x0 + c]);
    rgb[c] = low + t * (high - low);
  }
}

/* Of what goes to o, which sees it in the direction d, unit. */
static inline void light_pattern_seen(const light_pattern *p, vec3 o, vec3 d, float rgb[3]) {
  vec3 way = {-d.x, -d.y, -d.z};
  if (p->radius > 0.0f) {
    vec3 c = {o.x - p->middle.x, o.y - p->middle.y, o.z - p->middle.z};
    float along = dot(c, d);
    vec3 off = {c.x - along * d.x, c.y - along * d.y, c.z - along * d.z};
    float chord2 = p->radius * p->radius - dot(off, off);
    float deep = sqrtf(chord2 > 0.0f ? chord2 : 0.0f);
    vec3 normal = {off.x - deep * d.x, off.y - deep * d.y, off.z - deep * d.z};
    way = make_unit(&normal) ? normal : way;
  }
  light_pattern_along(p, way, rgb);
}

/* About what goes to o, for the choice among lights: not nothing, since other parts of the lamp are
 * elsewhere. */
static inline float light_pattern_weight(const light_pattern *p, vec3 o) {
  vec3 way = {o.x - p->middle.x, o.y - p->middle.y, o.z - p->middle.z};
  float rgb[3];
  if (!make_unit(&way))
    return 1.0f;
  light_pattern_along(p, way, rgb);
  float mean = (rgb[0] + rgb[1] + rgb[2]) * (1.0f / 3.0f);
  return mean > 0.05f ? mean : 0.05f;
}

#endif
