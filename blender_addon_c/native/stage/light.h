/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light samples and shadow rays. */
#include "batch/leaf.h"
#include "stage/stage.h"

/* A point of the unit square for each hit. */
static void stage_pair(size_t count, const points *points, const uint32_t *restrict lane,
                       const paths *restrict path, light_samples *restrict out) {
  const uint32_t *restrict point_x = points->x, *restrict point_y = points->y;
  const uint32_t salt = points->salt, scramble = points->scramble;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    uint32_t h = mix(path->hash[lane[i]] + salt);
    out->x[i] = unit_float(point_x[lane[i]] ^ (h & scramble));
    out->y[i] = unit_float(point_y[lane[i]] ^ (mix(h) & scramble));
  }
}

/* The loop around a light's leaf: once for samples spread over it, once for its middle. */
#define LIGHT_STAGE(TYPE, name)                                                                    \
  LEAF void sample_##name(bool spread, size_t count, const light_##name *light,                    \
                          const surfaces *restrict at, light_samples *restrict out) {              \
    const light_##name own = *light;                                                               \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      float x = spread ? out->x[i] : 0.5f, y = spread ? out->y[i] : 0.5f;                          \
      light_sample s = light_##name##_sample(&own, spread, x, y, load(&at->p, i));                 \
      store(&out->ray.d, i, s.direction);                                                          \
      out->ray.tfar[i] = s.distance;                                                               \
      out->e[i] = s.e;                                                                             \
    }                                                                                              \
  }                                                                                                \
  static void stage_##name(size_t count, const light *light, bool spread,                          \
                           const surfaces *restrict at, light_samples *restrict out) {             \
    if (spread)                                                                                    \
      sample_##name(true, count, &light->of.name, at, out);                                        \
    else                                                                                           \
      sample_##name(false, count, &light->of.name, at, out);                                       \
  }
LIGHT_TABLE(LIGHT_STAGE)

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
