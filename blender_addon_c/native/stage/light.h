/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light samples and shadow rays. */
#include "batch/leaf.h"
#include "stage/stage.h"

/* Points of the unit disc. */
static void stage_disc(size_t count, const points *points, const uint32_t *restrict lane,
                       const paths *restrict path, light_samples *restrict out) {
  const uint32_t *restrict point_x = points->x, *restrict point_y = points->y;
  const uint32_t salt = points->salt, scramble = points->scramble;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    uint32_t h = mix(path->hash[lane[i]] + salt);
    float radius = sqrtf(unit_float(point_x[lane[i]] ^ (h & scramble)));
    float s, c;
    turn(unit_float(point_y[lane[i]] ^ (mix(h) & scramble)), &s, &c);
    out->a[i] = radius * c;
    out->b[i] = radius * s;
  }
}

static void stage_sun(size_t count, const light *light, const surfaces *restrict at,
                      light_samples *restrict out) {
  (void)at; /* it is as far from every hit */
  const float vx = light->vector[0], vy = light->vector[1], vz = light->vector[2];
  const float ax = light->axis[0][0], ay = light->axis[0][1], az = light->axis[0][2];
  const float bx = light->axis[1][0], by = light->axis[1][1], bz = light->axis[1][2];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float a = out->a[i], b = out->b[i];
    vec3 l = {vx + a * ax + b * bx, vy + a * ay + b * by, vz + a * az + b * bz};
    store(&out->ray.d, i, scaled(l, 1.0f / sqrtf(dot(l, l))));
    out->e[i] = 1.0f;
    out->ray.tfar[i] = INFINITY;
  }
}

/* A disc that faces the shaded point: what it sees of a sphere, but for a rim. */
static void stage_point(size_t count, const light *light, const surfaces *restrict at,
                        light_samples *restrict out) {
  const float vx = light->vector[0], vy = light->vector[1], vz = light->vector[2];
  const float radius = light->radius;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    vec3 p = load(&at->p, i), l = {vx - p.x, vy - p.y, vz - p.z};
    float d2 = dot(l, l);
    vec3 w = scaled(l, 1.0f / sqrtf(d2 > 1e-30f ? d2 : 1e-30f));
    /* two axes across it [Duff2017] */
    float sign = w.z < 0.0f ? -1.0f : 1.0f;
    float q = -1.0f / (sign + w.z), r = w.x * w.y * q;
    float ra = radius * out->a[i], rb = radius * out->b[i];
    l.x += ra * (1.0f + sign * w.x * w.x * q) + rb * r;
    l.y += ra * sign * r + rb * (sign + w.y * w.y * q);
    l.z -= ra * sign * w.x + rb * w.y;
    d2 = dot(l, l);
    bool apart = d2 > 1e-30f; /* a light on the surface itself gives none */
    float d = sqrtf(apart ? d2 : 1.0f);
    float inverse = 1.0f / d;
    l = scaled(l, inverse);
    l.z = apart ? l.z : 1.0f;
    store(&out->ray.d, i, l);
    out->e[i] = apart ? inverse * inverse : 0.0f;
    out->ray.tfar[i] = d;
  }
}

/*
 * The light in the shading frame, and the shadow ray. Light counts that falls on the side of the
 * facet that is seen, and only where the smooth normal sees it too; all else casts no ray.
 */
static void stage_lit(size_t count, const surfaces *restrict at, light_samples *restrict light) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    vec3 l = load(&light->ray.d, i), p = load(&at->p, i), g = load(&at->g, i);
    float height = dot(l, load(&at->n, i));
    float above = dot(l, g);
    store(&light->wi, i, (vec3){dot(l, load(&at->t, i)), dot(l, load(&at->b, i)), height});
    store(&light->ray.o, i, (vec3){p.x + g.x, p.y + g.y, p.z + g.z});
    light->ray.tfar[i] = ((height > 0.0f) & (above > 0.0f)) ? light->ray.tfar[i] : -1.0f;
  }
}

static size_t stage_shadow(size_t count, light_samples *restrict light) {
  uint32_t lit = 0;
#pragma omp simd reduction(+ : lit)
  for (size_t i = 0; i < count; i++) {
    bool sees = light->ray.tfar[i] > 0.0f;
    light->e[i] = sees ? light->e[i] : 0.0f;
    lit += sees ? 1u : 0u;
  }
  return lit;
}
