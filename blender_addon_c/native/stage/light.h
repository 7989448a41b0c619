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
  LEAF void sample_##name(bool spread, size_t count, const light *light,                           \
                          const surfaces *restrict at, light_samples *restrict out) {              \
    const light_##name own = light->of.name;                                                       \
    const float met = light->common.met ? 1.0f : 0.0f;                                             \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      float x = spread ? out->x[i] : 0.5f, y = spread ? out->y[i] : 0.5f;                          \
      light_sample s = light_##name##_sample(&own, spread, x, y, load(&at->p, i));                 \
      store(&out->ray.d, i, s.direction);                                                          \
      out->ray.tfar[i] = s.distance;                                                               \
      out->e[i] = s.e;                                                                             \
      if (spread)                                                                                  \
        out->pdf[i] = met * s.pdf;                                                                 \
    }                                                                                              \
  }                                                                                                \
  static void stage_##name(size_t count, const light *light, bool spread,                          \
                           const surfaces *restrict at, light_samples *restrict out) {             \
    if (spread)                                                                                    \
      sample_##name(true, count, light, at, out);                                                  \
    else                                                                                           \
      sample_##name(false, count, light, at, out);                                                 \
  }
LIGHT_TABLE(LIGHT_STAGE)

/* A light that throws no shadow casts rays that begin beyond their end. */
#define CHOSEN_STAGE(TYPE, name)                                                                   \
  LEAF void chosen_##name(bool spread, size_t count, const uint32_t *restrict lane,                \
                          const light *light, const surfaces *restrict at,                         \
                          light_samples *restrict out) {                                           \
    const light_##name own = light->of.name;                                                       \
    const float met = light->common.met ? 1.0f : 0.0f;                                             \
    const float tnear = light->common.shadow ? 0.0f : INFINITY;                                    \
    const float red = light->common.color[0], green = light->common.color[1];                      \
    const float blue = light->common.color[2];                                                     \
    _Pragma("omp simd") for (size_t k = 0; k < count; k++) {                                       \
      size_t i = lane[k];                                                                          \
      light_sample s = light_##name##_sample(&own, spread, out->x[i], out->y[i], load(&at->p, i)); \
      float chance = out->chance[i];                                                               \
      store(&out->ray.d, i, s.direction);                                                          \
      out->ray.tnear[i] = tnear;                                                                   \
      out->ray.tfar[i] = s.distance;                                                               \
      out->e[i] = s.e / chance;                                                                    \
      out->pdf[i] = met * s.pdf * chance;                                                          \
      out->color.r[i] = red;                                                                       \
      out->color.g[i] = green;                                                                     \
      out->color.b[i] = blue;                                                                      \
    }                                                                                              \
  }                                                                                                \
  static void stage_chosen_##name(size_t count, const uint32_t *restrict lane, const light *light, \
                                  const surfaces *restrict at, light_samples *restrict out) {      \
    if (light->common.soft)                                                                        \
      chosen_##name(true, count, lane, light, at, out);                                            \
    else                                                                                           \
      chosen_##name(false, count, lane, light, at, out);                                           \
  }
LIGHT_TABLE(CHOSEN_STAGE)

#define WEIGH_STAGE(TYPE, name)                                                                    \
  static void stage_weigh_##name(size_t count, const light *light, const lane_v *restrict p,       \
                                 light_weights *restrict weight) {                                 \
    const light_##name own = light->of.name;                                                       \
    const float power = light->common.power;                                                       \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      float one = clampf(power * light_##name##_weight(&own, load(p, i)), 0.0f, 1e30f);            \
      weight->one[i] = one;                                                                        \
      weight->sum[i] += one;                                                                       \
    }                                                                                              \
  }
LIGHT_TABLE(WEIGH_STAGE)

static void stage_weigh_evenly(size_t count, float power, light_weights *restrict weight) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    weight->one[i] = power;
    weight->sum[i] += power;
  }
}

static void stage_choose(size_t count, uint32_t number, const light_weights *restrict weight,
                         light_samples *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float total = weight->total[i];
    bool takes = (out->number[i] == LIGHT_NONE) & (weight->sum[i] > out->lot[i] * total);
    out->number[i] = takes ? number : out->number[i];
    out->chance[i] = takes ? weight->one[i] / total : out->chance[i];
  }
}

/* The share of a way to find light, of two whose densities these are [VeachGuibas1995]. */
LEAF float balance(float own, float other) {
  float sum = own + other;
  return own / (sum > 1e-30f ? sum : 1e-30f);
}

/*
 * Lights stop no rays. How a ray was drawn counts from the point where it was; what it meets, from
 * where it sets out now.
 */
#define MEET_STAGE(TYPE, name)                                                                     \
  LEAF void meet_##name(bool chosen, size_t count, const light *light, const walks *restrict walk, \
                        const rays *restrict ray, const light_weights *restrict weight,            \
                        lane_c *restrict met) {                                                    \
    const light_##name own = light->of.name;                                                       \
    const float red = light->common.color[0], green = light->common.color[1];                      \
    const float blue = light->common.color[2];                                                     \
    _Pragma("omp simd") for (size_t k = 0; k < count; k++) {                                       \
      vec3 from = load(&walk->from, k), o = load(&ray->o, k), d = load(&ray->d, k);                \
      vec3 gone = {o.x - from.x, o.y - from.y, o.z - from.z};                                      \
      light_meeting m = light_##name##_meet(&own, from, d);                                        \
      float near = dot(gone, d) * 0.999f;                                                          \
      bool meets =                                                                                 \
          (m.distance > near) & (m.distance - near <= ray->tfar[k]) & (m.radiance > 0.0f);         \
      float chance = chosen ? weight->one[k] / weight->total[k] : 1.0f;                            \
      float part = balance(walk->pdf[k], m.pdf * chance);                                          \
      part = meets ? part * m.radiance : 0.0f;                                                     \
      met->r[k] += part * red;                                                                     \
      met->g[k] += part * green;                                                                   \
      met->b[k] += part * blue;                                                                    \
    }                                                                                              \
  }                                                                                                \
  static void stage_meet_##name(size_t count, const light *light, const walks *restrict walk,      \
                                const rays *restrict ray, const light_weights *restrict weight,    \
                                lane_c *restrict met) {                                            \
    if (weight)                                                                                    \
      meet_##name(true, count, light, walk, ray, weight, met);                                     \
    else                                                                                           \
      meet_##name(false, count, light, walk, ray, NULL, met);                                      \
  }
LIGHT_TABLE(MEET_STAGE)

static void stage_lit_by_sky(size_t count, const uint32_t *restrict lane, const lane_v *restrict d,
                             const float *restrict pdf, const lane_c *restrict sky,
                             light_samples *restrict out) {
#pragma omp simd
  for (size_t k = 0; k < count; k++) {
    size_t i = lane[k];
    float chance = out->chance[i];
    store(&out->ray.d, i, load(d, k));
    out->ray.tnear[i] = 0.0f;
    out->ray.tfar[i] = INFINITY;
    out->e[i] = pdf[k] > 0.0f ? 1.0f / (pdf[k] * chance) : 0.0f;
    out->pdf[i] = pdf[k] * chance;
    out->color.r[i] = sky->r[k];
    out->color.g[i] = sky->g[k];
    out->color.b[i] = sky->b[k];
  }
}

LEAF void met_sky(bool chosen, size_t count, const uint32_t *restrict missed,
                  const float *restrict pdf, const lane_c *restrict sky, const walks *restrict walk,
                  float power, const light_weights *restrict weight, lane_c *restrict met) {
#pragma omp simd
  for (size_t k = 0; k < count; k++) {
    size_t i = missed[k];
    float chance = chosen ? power / weight->total[i] : 1.0f;
    float part = balance(walk->pdf[i], pdf[k] * chance);
    met->r[i] += part * sky->r[k];
    met->g[i] += part * sky->g[k];
    met->b[i] += part * sky->b[k];
  }
}

static void stage_met_sky(size_t count, const uint32_t *restrict missed, const float *restrict pdf,
                          const lane_c *restrict sky, const walks *restrict walk, float power,
                          const light_weights *restrict weight, lane_c *restrict met) {
  if (weight)
    met_sky(true, count, missed, pdf, sky, walk, power, weight, met);
  else
    met_sky(false, count, missed, pdf, sky, walk, power, NULL, met);
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
