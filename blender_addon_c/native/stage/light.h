/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light samples and shadow rays. */
#include "batch/leaf.h"
#include "light/light.h"
#include "stage/common.h"
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
    const float mis = light->common.mis ? 1.0f : 0.0f;                                             \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      float x = spread ? out->x[i] : 0.5f, y = spread ? out->y[i] : 0.5f;                          \
      light_sample s = light_##name##_sample(&own, spread, x, y, load(&at->p, i));                 \
      store(&out->ray.d, i, s.direction);                                                          \
      out->ray.tfar[i] = s.distance;                                                               \
      out->e[i] = s.e;                                                                             \
      if (spread)                                                                                  \
        out->pdf[i] = mis * s.pdf;                                                                 \
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
  LEAF void chosen_##name(bool spread, size_t begin, size_t end, const light_choices *choice,      \
                          const light *light, const surfaces *restrict at,                         \
                          const light_samples *restrict from, light_draws *restrict out) {         \
    const light_##name own = light->of.name;                                                       \
    const float mis = light->common.mis ? 1.0f : 0.0f;                                             \
    const float tnear = light->common.shadow ? 0.0f : INFINITY;                                    \
    const float red = light->common.color[0], green = light->common.color[1];                      \
    const float blue = light->common.color[2];                                                     \
    const uint32_t *restrict lane = choice->lane;                                                  \
    const float *restrict chances = choice->chance;                                                \
    _Pragma("omp simd") for (size_t k = begin; k < end; k++) {                                     \
      uint32_t i = lane[k];                                                                        \
      vec3 p = {at->p.x[i], at->p.y[i], at->p.z[i]};                                               \
      light_sample s = light_##name##_sample(&own, spread, from->x[i], from->y[i], p);             \
      float chance = chances[i];                                                                   \
      store(&out->d, k, s.direction);                                                              \
      out->tnear[k] = tnear;                                                                       \
      out->tfar[k] = s.distance;                                                                   \
      out->e[k] = s.e / chance;                                                                    \
      out->pdf[k] = mis * s.pdf * chance;                                                          \
      out->color.r[k] = red;                                                                       \
      out->color.g[k] = green;                                                                     \
      out->color.b[k] = blue;                                                                      \
    }                                                                                              \
  }                                                                                                \
  static void stage_chosen_##name(size_t begin, size_t end, const light_choices *choice,           \
                                  const light *light, const surfaces *restrict at,                 \
                                  const light_samples *restrict from, light_draws *restrict out) { \
    if (light->common.soft)                                                                        \
      chosen_##name(true, begin, end, choice, light, at, from, out);                               \
    else                                                                                           \
      chosen_##name(false, begin, end, choice, light, at, from, out);                              \
  }
LIGHT_TABLE(CHOSEN_STAGE)

/* The samples back to their points. */
static void stage_place_samples(size_t count, const light_choices *choice,
                                const light_draws *restrict in, light_samples *restrict out) {
  const uint32_t *restrict place = choice->place;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    uint32_t k = place[i];
    store(&out->ray.d, i, (vec3){in->d.x[k], in->d.y[k], in->d.z[k]});
    out->ray.tnear[i] = in->tnear[k];
    out->ray.tfar[i] = in->tfar[k];
    out->e[i] = in->e[k];
    out->pdf[i] = in->pdf[k];
    out->color.r[i] = in->color.r[k];
    out->color.g[i] = in->color.g[k];
    out->color.b[i] = in->color.b[k];
  }
}

#define WEIGH_STAGE(TYPE, name)                                                                    \
  static void stage_weigh_##name(size_t count, const light *light, const lane_v *restrict p,       \
                                 float *restrict one) {                                            \
    const light_##name own = light->of.name;                                                       \
    const float power = light->common.power;                                                       \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) one[i] =                                \
        clampf(power * light_##name##_weight(&own, load(p, i)), 0.0f, 1e30f);                      \
  }
LIGHT_TABLE(WEIGH_STAGE)

static void stage_add(size_t count, const float *restrict one, float *restrict sum) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    sum[i] += one[i];
}

static void stage_choose(size_t count, uint32_t number, const float *restrict one,
                         light_weights *restrict weight, light_choices *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float total = weight->total[i], sum = weight->sum[i] + one[i];
    bool takes = (out->number[i] == LIGHT_NONE) & (sum > out->random[i] * total);
    out->number[i] = takes ? number : out->number[i];
    out->chance[i] = takes ? one[i] / total : out->chance[i];
    weight->sum[i] = sum;
  }
}

/*
 * Lights stop no rays. How a ray was drawn counts from the point where it was; what it meets, from
 * where it sets out now.
 */
#define HIT_STAGE(TYPE, name)                                                                      \
  LEAF void hit_##name(bool chosen, size_t count, const light *light,                              \
                       const path_states *restrict state, const rays *restrict ray,                \
                       const float *restrict weight, lane_c *restrict emitted) {                   \
    const light_##name own = light->of.name;                                                       \
    const uint32_t hidden = light->common.hidden | RAY_CAMERA;                                     \
    const float red = light->common.color[0], green = light->common.color[1];                      \
    const float blue = light->common.color[2];                                                     \
    _Pragma("omp simd") for (size_t k = 0; k < count; k++) {                                       \
      vec3 from = load(&state->from, k), o = load(&ray->o, k), d = load(&ray->d, k);               \
      vec3 gone = {o.x - from.x, o.y - from.y, o.z - from.z};                                      \
      light_intersection m = light_##name##_intersect(&own, from, d);                              \
      float near = dot(gone, d) * 0.999f;                                                          \
      bool hit_lights = (m.distance > near) & (m.distance - near <= ray->tfar[k]) &                \
                        (m.radiance > 0.0f) & ((state->ray[k] & hidden) == 0);                     \
      bool choice = chosen & (state->lights[k] > 0.0f);                                            \
      float chance = choice ? weight[k] / (choice ? state->lights[k] : 1.0f) : 1.0f;               \
      float part = balance(state->pdf[k], m.pdf * chance);                                         \
      part = hit_lights ? part * m.radiance : 0.0f;                                                \
      emitted->r[k] += part * red;                                                                 \
      emitted->g[k] += part * green;                                                               \
      emitted->b[k] += part * blue;                                                                \
    }                                                                                              \
  }                                                                                                \
  static void stage_hit_##name(size_t count, const light *light,                                   \
                               const path_states *restrict state, const rays *restrict ray,        \
                               const float *restrict weight, lane_c *restrict emitted) {           \
    if (weight)                                                                                    \
      hit_##name(true, count, light, state, ray, weight, emitted);                                 \
    else                                                                                           \
      hit_##name(false, count, light, state, ray, NULL, emitted);                                  \
  }
LIGHT_TABLE(HIT_STAGE)

static void stage_lit_by_sky(size_t begin, size_t end, const light_choices *choice,
                             const lane_v *restrict d, const float *restrict pdf,
                             const lane_c *restrict sky, light_draws *restrict out) {
  const uint32_t *restrict lane = choice->lane;
  const float *restrict chances = choice->chance;
#pragma omp simd
  for (size_t k = begin; k < end; k++) {
    float density = pdf[k - begin] * chances[lane[k]];
    store(&out->d, k, load(d, k - begin));
    out->tnear[k] = 0.0f;
    out->tfar[k] = INFINITY;
    out->e[k] = density > 0.0f ? 1.0f / density : 0.0f;
    out->pdf[k] = density;
    out->color.r[k] = sky->r[k - begin];
    out->color.g[k] = sky->g[k - begin];
    out->color.b[k] = sky->b[k - begin];
  }
}

/* What is met by rays that miss all, one by one: packed, what it takes to reach them costs more. */
static void stage_hit_sky(size_t count, const uint32_t *restrict missed, const float *restrict pdf,
                          const lane_c *restrict sky, const path_states *restrict state,
                          bool chosen, float power, uint32_t hidden, lane_c *restrict emitted) {
  for (size_t k = 0; k < count; k++) {
    size_t i = missed[k];
    float chance = chosen ? power / state->lights[i] : 1.0f;
    float part = state->ray[i] & hidden ? 0.0f : balance(state->pdf[i], pdf[k] * chance);
    emitted->r[i] += part * sky->r[k];
    emitted->g[i] += part * sky->g[k];
    emitted->b[i] += part * sky->b[k];
  }
}

/*
 * The light in the shading frame, and the shadow ray. Light counts that falls on the side of the
 * facet that is seen or, if the material lets light `through`, on the other, and only where the
 * smooth normal agrees; all else casts no ray.
 */
LEAF void lit(bool through, bool lifted, lane_run run, const surfaces *restrict at,
              light_samples *restrict light) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    vec3 l = load(&light->ray.d, i), p = load(&at->p, i), g = load(&at->g, i);
    float height = dot(l, load(&at->n, i));
    float above = dot(l, g);
    float least = lifted ? -at->slack[i] : 0.0f;
    bool seen = (height > 0.0f) & (above > least);
    vec3 start = {p.x + g.x, p.y + g.y, p.z + g.z};
    if (lifted) {
      vec3 lift = load(&at->lift, i);
      start = (vec3){start.x + lift.x, start.y + lift.y, start.z + lift.z};
    }
    if (through) {
      bool behind = (height < 0.0f) & (above < 0.0f);
      seen = seen | behind;
      start = select3(behind, (vec3){p.x - g.x, p.y - g.y, p.z - g.z}, start);
    }
    store(&light->wi, i, (vec3){dot(l, load(&at->t, i)), dot(l, load(&at->b, i)), height});
    store(&light->ray.o, i, start);
    light->ray.tfar[i] = seen ? light->ray.tfar[i] : -1.0f;
  }
}
static void stage_lit(lane_run run, bool through, bool lifted, const surfaces *restrict at,
                      light_samples *restrict light) {
  if (through && lifted)
    lit(true, true, run, at, light);
  else if (through)
    lit(true, false, run, at, light);
  else if (lifted)
    lit(false, true, run, at, light);
  else
    lit(false, false, run, at, light);
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

#define LIGHT_DRAW(TYPE, name) [LIGHT_##TYPE] = stage_##name,
#define LIGHT_CHOSEN(TYPE, name) [LIGHT_##TYPE] = stage_chosen_##name,
#define LIGHT_WEIGH(TYPE, name) [LIGHT_##TYPE] = stage_weigh_##name,
#define LIGHT_HIT(TYPE, name) [LIGHT_##TYPE] = stage_hit_##name,
