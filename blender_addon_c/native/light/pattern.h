/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What a lamp shines by the direction in which it does: a picture of all directions, whose middle
 * is along the lamp's own x axis and whose rows go up along its z, as a factor of its colour. Of a
 * ball whose normals are asked for the direction is that where it is met [measured in Cycles 5.0].
 * Or, of an area lamp, by the place on its face: a picture of that. Its light may fall off as
 * artists wish, not as light does, by the distance to where it is met.
 */
#ifndef LIBSHADE_LIGHT_PATTERN_H
#define LIBSHADE_LIGHT_PATTERN_H

#include <math.h>

#include "batch/leaf.h"
#include "light/common.h"

struct light_pattern {
  int width, height;
  vec3 middle;     /* of the lamp */
  float radius;    /* of such a ball, else 0 */
  vec3 axis[3];    /* of the lamp, unit */
  bool face;       /* it is a picture of an area lamp's */
  bool flat, ball; /* an area lamp, or a ball; else bulbs are discs that face what they light */
  vec3 normal;     /* of an area lamp */
  vec3 across[2]; /* a point's place on it, -1 to 1, along axis k is across[k] . (point - middle) */
  float bulb;     /* radius of a bulb */
  int gain;       /* power of the distance by which light falls off less than light does */
  float smooth;   /* and what is added to the distance squared */
  float *texel;   /* red, green, blue; rows from below; the caller of light_pattern_free owns it */
};

/* Of a place in the picture, in texels from the middle of the first. */
static inline void light_pattern_at(const light_pattern *p, float u, float v, float rgb[3]) {
  if (!(fabsf(u) < 1e9f && fabsf(v) < 1e9f)) /* of no number */
    u = v = 0.0f;
  if (p->face)
    u = clampf(u, 0.0f, (float)(p->width - 1));
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

/* Factors of the light that goes this way, unit. */
static inline void light_pattern_along(const light_pattern *p, vec3 d, float rgb[3]) {
  float x = dot(d, p->axis[0]), y = dot(d, p->axis[1]), z = dot(d, p->axis[2]);
  float u = 0.5f - atan2f(y, x) * (0.5f / LIGHT_PI);
  float v = 0.5f + asinf(clampf(z, -1.0f, 1.0f)) * (1.0f / LIGHT_PI);
  light_pattern_at(p, u * (float)p->width - 0.5f, v * (float)p->height - 0.5f, rgb);
}

/* How far it is from o, c from the lamp's middle, in the direction d to where the lamp is met. */
static inline float light_pattern_far(const light_pattern *p, vec3 c, vec3 d) {
  float along = -dot(c, d), d2 = dot(c, c);
  if (p->flat) {
    float cosine = -dot(d, p->normal);
    return cosine > 1e-9f ? dot(c, p->normal) / cosine : sqrtf(d2);
  }
  if (!(p->bulb > 0.0f && along > 0.0f))
    return sqrtf(d2);
  if (!p->ball)
    return d2 / along;
  float chord2 = p->bulb * p->bulb - (d2 - along * along);
  return along - sqrtf(chord2 > 0.0f ? chord2 : 0.0f);
}

/* What is left at a distance, beside what light by itself has there. */
static inline float light_pattern_gain(const light_pattern *p, float far) {
  float far2 = far * far, gain = p->gain == 0 ? 1.0f : p->gain == 1 ? far : far2;
  if (p->smooth > 0.0f && far2 < 1e18f)
    gain *= far2 / (p->smooth + far2);
  return gain < 1e18f ? gain : 1e18f;
}

/* Of what goes to o, which sees it in the direction d, unit. */
static inline void light_pattern_seen(const light_pattern *p, vec3 o, vec3 d, float rgb[3]) {
  vec3 way = {-d.x, -d.y, -d.z};
  vec3 c = {o.x - p->middle.x, o.y - p->middle.y, o.z - p->middle.z};
  bool falls = p->gain > 0 || p->smooth > 0.0f;
  float far = p->face || falls ? light_pattern_far(p, c, d) : 0.0f;
  if (p->face) {
    vec3 q = {c.x + far * d.x, c.y + far * d.y, c.z + far * d.z};
    float u = 0.5f + 0.5f * dot(q, p->across[0]), v = 0.5f + 0.5f * dot(q, p->across[1]);
    light_pattern_at(p, u * (float)p->width - 0.5f, v * (float)p->height - 0.5f, rgb);
  } else if (p->radius > 0.0f) {
    float along = dot(c, d);
    vec3 off = {c.x - along * d.x, c.y - along * d.y, c.z - along * d.z};
    float chord2 = p->radius * p->radius - dot(off, off);
    float deep = sqrtf(chord2 > 0.0f ? chord2 : 0.0f);
    vec3 normal = {off.x - deep * d.x, off.y - deep * d.y, off.z - deep * d.z};
    way = make_unit(&normal) ? normal : way;
  }
  if (!p->face)
    light_pattern_along(p, way, rgb);
  float gain = falls ? light_pattern_gain(p, far) : 1.0f;
  for (int k = 0; k < 3; k++)
    rgb[k] *= gain;
}

/* About what goes to o, for the choice among lights: not nothing, since other parts of the lamp are
 * elsewhere. */
static inline float light_pattern_weight(const light_pattern *p, vec3 o) {
  vec3 way = {o.x - p->middle.x, o.y - p->middle.y, o.z - p->middle.z};
  float rgb[3];
  float gain = light_pattern_gain(p, sqrtf(dot(way, way)));
  if (p->face || !make_unit(&way))
    return gain > 1e-6f ? gain : 1e-6f;
  light_pattern_along(p, way, rgb);
  float mean = (rgb[0] + rgb[1] + rgb[2]) * (1.0f / 3.0f);
  return (mean > 0.05f ? mean : 0.05f) * (gain > 1e-6f ? gain : 1e-6f);
}

#endif
