/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all kinds of light have in common. */
#ifndef LIBSHADE_LIGHT_COMMON_H
#define LIBSHADE_LIGHT_COMMON_H

#include "batch/leaf.h"
#include "scene/reader.h"

#define LIGHT_PI 3.14159265358979f

typedef struct light_pattern light_pattern;

typedef struct light_common {
  float color[3]; /* of a sample's e: sun: irradiance; others: intensity */
  float power;    /* brightness of the colour, for the choice among lights */
  bool soft;      /* it has an extent, over which samples are spread */
  bool shadow;
  uint32_t hidden; /* ray_kinds that do not see it; the camera never does */
  uint32_t link;   /* 0, or the bit of instances that it does not light */
  uint32_t shade;  /* 0, or the bit of those that do not shade it */
  bool mis;        /* rays that surfaces draw meet it: these and its samples share its light */
  light_pattern *pattern; /* by the direction in which it shines, or NULL: evenly; its own */
} light_common;

/* What one point of a light gives to one point of a surface. */
typedef struct light_sample {
  vec3 direction; /* to the light, unit */
  float distance;
  float e;   /* irradiance as a part of the light's colour */
  float pdf; /* density of the direction, 1/sr; 0 where the light has no extent */
} light_sample;

/* Where a ray meets a light. */
typedef struct light_intersection {
  float distance; /* negative: it does not */
  float radiance; /* as a part of the light's colour, 1/sr */
  float pdf;      /* with which samples of the light find this direction, 1/sr */
} light_intersection;

#define LIGHT_MISSED ((light_intersection){-1.0f, 0.0f, 0.0f})

/* A point of the unit disc from one of the unit square. */
LEAF void disc_point(float x, float y, float *a, float *b) {
  float radius = sqrtf(x), s, c;
  turn(y, &s, &c);
  *a = radius * c;
  *b = radius * s;
}

/* A bulb, of which every point of space sees a disc that faces it or, if it is a ball, its half:
 * the same radiance everywhere, intensity 1. */
typedef struct light_bulb {
  float position[3];
  float radius;  /* 0 is sharp */
  uint32_t ball; /* for either() */
} light_bulb;

/* A flag for either(); one that is missing is off. */
static inline bool light_switch_read(reader *r, const char *key, uint32_t *mask) {
  bool on = false;
  if (!reader_may_flag(r, key, &on))
    return false;
  *mask = on ? UINT32_MAX : 0;
  return true;
}

static inline bool light_bulb_read(reader *r, light_common *common, light_bulb *l) {
  bool good = reader_floats(r, "intensity", 3, common->color) &&
              reader_floats(r, "position", 3, l->position) &&
              reader_number_within(r, "radius", 0, 1e18, &l->radius) &&
              light_switch_read(r, "ball", &l->ball);
  l->radius = l->radius > 1e-12f ? l->radius : 0.0f; /* its square must be a number to divide by */
  common->soft = l->radius > 0.0f;
  return good;
}

LEAF light_sample light_bulb_sample(const light_bulb *l, bool spread, float x, float y, vec3 p) {
  vec3 d = {l->position[0] - p.x, l->position[1] - p.y, l->position[2] - p.z};
  float d2 = dot(d, d), radius2 = l->radius * l->radius;
  bool apart = d2 > 1e-30f; /* a light on the surface itself gives none */
  float middle = sqrtf(apart ? d2 : 1.0f);
  vec3 w = scaled(d, 1.0f / middle);
  w.z = apart ? w.z : 1.0f;
  if (!spread)
    return (light_sample){.direction = w, .distance = middle, .e = apart ? 1.0f / d2 : 0.0f};
  vec3 u, v;
  across(w, &u, &v);
  float s, c;
  turn(y, &s, &c);
  /* of the disc an even point, of the ball's cone an even direction */
  float r2 = x * radius2;
  float sine2 = radius2 / (apart ? d2 : 1.0f);
  bool outside = sine2 < 1.0f;
  float cosine = sqrtf(outside ? 1.0f - sine2 : 0.0f);
  float narrow = x * sine2 / (1.0f + cosine); /* 1 - cosine of the draw, without its rounding */
  float sine_ball = sqrtf(clampf(narrow * (2.0f - narrow), 0.0f, 1.0f));
  float far_disc = sqrtf((apart ? d2 : 1.0f) + r2), inverse = 1.0f / far_disc;
  float sine_drawn = either(l->ball, sine_ball, sqrtf(r2) * inverse);
  float cosine_drawn = either(l->ball, 1.0f - narrow, middle * inverse);
  float chord2 = radius2 - d2 * sine_ball * sine_ball;
  float far_ball = middle * cosine_drawn - sqrtf(chord2 > 0.0f ? chord2 : 0.0f);
  float a = sine_drawn * c, b = sine_drawn * s;
  float e_disc = middle * inverse * inverse * inverse, area = LIGHT_PI * radius2;
  float e_ball = 2.0f * sine2 / (radius2 * (1.0f + cosine));
  float e = either(l->ball, outside ? e_ball : 0.0f, e_disc);
  return (light_sample){.direction = {cosine_drawn * w.x + a * u.x + b * v.x,
                                      cosine_drawn * w.y + a * u.y + b * v.y,
                                      cosine_drawn * w.z + a * u.z + b * v.z},
                        .distance = either(l->ball, far_ball, far_disc),
                        .e = apart ? e : 0.0f,
                        .pdf = (apart & (e > 0.0f)) ? 1.0f / (e * area) : 0.0f};
}

LEAF light_intersection light_bulb_intersect(const light_bulb *l, vec3 o, vec3 d) {
  vec3 c = {l->position[0] - o.x, l->position[1] - o.y, l->position[2] - o.z};
  float d2 = dot(c, c), along = dot(c, d), radius2 = l->radius * l->radius;
  bool before = (along > 0.0f) & (d2 > 1e-30f);
  float at_disc = before ? d2 / along : 1.0f; /* where the ray crosses the disc's plane */
  float at = either(l->ball, along, at_disc);
  vec3 off = {at * d.x - c.x, at * d.y - c.y, at * d.z - c.z};
  float off2 = dot(off, off);
  float sine2 = radius2 / (before ? d2 : 1.0f);
  bool inside = (off2 < radius2) & (either(l->ball, sine2, 0.0f) < 1.0f);
  float area = LIGHT_PI * radius2; /* it is soft, or no ray would ask */
  float middle = sqrtf(before ? d2 : 1.0f), chord2 = radius2 - off2;
  float depth = sqrtf(chord2 > 0.0f ? chord2 : 0.0f);
  float cosine = sqrtf(sine2 < 1.0f ? 1.0f - sine2 : 0.0f);
  float pdf_ball = (1.0f + cosine) / (2.0f * LIGHT_PI * sine2);
  float pdf_disc = at * at * at / (middle * area);
  bool hit = before & inside;
  return (light_intersection){.distance = hit ? (either(l->ball, at - depth, at)) : -1.0f,
                              .radiance = hit ? 1.0f / area : 0.0f,
                              .pdf = either(l->ball, pdf_ball, pdf_disc)};
}

/* About what it gives, for the choice among lights: > 0 wherever it gives something. */
LEAF float light_bulb_weight(const light_bulb *l, vec3 p) {
  vec3 d = {l->position[0] - p.x, l->position[1] - p.y, l->position[2] - p.z};
  float d2 = dot(d, d) + l->radius * l->radius;
  return 1.0f / (d2 > 1e-18f ? d2 : 1e-18f);
}

#endif
