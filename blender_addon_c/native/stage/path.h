/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From one bounce to the next: where paths go on, and what they bring to their samples. */
#include "batch/leaf.h"
#include "stage/stage.h"

/*
 * The points of one pair of dimensions are the same for all bounces and lights; what makes them
 * independent is that each takes them in another order. Points that were only scrambled would pair
 * the same ones forever, and a pixel would converge to something else.
 */
static void stage_shuffled(size_t count, const shuffle *points, const uint32_t *restrict lane,
                           const path_states *restrict state, const paths *restrict path,
                           float *restrict x, float *restrict y) {
  const uint32_t *restrict index = points->index, *restrict reverse = points->reverse;
  const uint32_t mask = points->mask, salt = points->salt;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    uint32_t sample = state->sample[lane[i]];
    uint32_t h = mix(path->hash[sample] + salt);
    shuffled_point(index[sample], reverse, mask, h, &x[i], &y[i]);
  }
}

/* Of a lobe that a path meets behind a bounce with little density: alpha, as Cycles blurs it. */
static void stage_blur(size_t count, float filter, const uint32_t *restrict lane,
                       const path_states *restrict state, float *restrict blur) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float rest = 1.0f - filter * state->least[lane[i]];
    blur[i] = 0.5f * sqrtf(rest > 0.0f ? rest : 0.0f);
  }
}

LEAF float largest(float a, float b, float c) {
  float ab = a > b ? a : b;
  return ab > c ? ab : c;
}

enum { WALK_ENDS = 16 }; /* beside a bounce_kind */

/*
 * A path goes on where a direction was drawn that leaves the facet too, on the same side as the
 * smooth surface, and where it may still do what it does there; where it may not, its ray looks for
 * lights only, if a scene has any that it `meets`, through transparent surfaces as samples of these
 * lights do; light that it meets after a passage weighs as if nothing had been there. Roulette
 * keeps one whose weight has become w with probability sqrt(w): the square root, because what it
 * may still meet is not known. A draw that was aimed has less weight, not less to meet: it counts
 * as if the surface had drawn it by itself.
 */
static size_t stage_next_paths(size_t count, bool roulette, const bounce_limits *limits,
                               bool hit_lights, const uint32_t *restrict lane,
                               const surfaces *restrict at, const path_states *restrict state,
                               const float *restrict lights, draws *restrict draw,
                               rays *restrict wide, uint32_t *restrict chosen,
                               path_states *restrict next, rays *restrict ray) {
  const uint32_t most_diffuse = limits->kind[BOUNCE_DIFFUSE];
  const uint32_t most_glossy = limits->kind[BOUNCE_GLOSSY];
  const uint32_t most_through = limits->kind[BOUNCE_TRANSMISSION];
  const uint32_t most_passing = limits->kind[BOUNCE_TRANSPARENT], most_all = limits->all;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    uint32_t from = lane[i], kind = draw->kind[i] & BOUNCE_MASK;
    uint32_t diffuse = state->bounces[0][from] + (kind == BOUNCE_DIFFUSE);
    uint32_t glossy = state->bounces[1][from] + (kind == BOUNCE_GLOSSY);
    uint32_t through = state->bounces[2][from] + (kind == BOUNCE_TRANSMISSION);
    uint32_t passing = state->bounces[3][from] + (kind == BOUNCE_TRANSPARENT);
    bool straight = kind == BOUNCE_TRANSPARENT;
    bool within = (diffuse <= most_diffuse) & (glossy <= most_glossy) & (through <= most_through) &
                  (diffuse + glossy + through <= most_all) & (passing <= most_passing);
    bool may = (within | hit_lights) & (passing <= most_passing + 1) &
               (straight | (state->ends[from] == 0));
    draw->kind[i] |= within ? 0 : WALK_ENDS;
    vec3 n = load(&at->n, i), t = load(&at->t, i), b = load(&at->b, i), g = load(&at->g, i);
    vec3 wi = load(&draw->wi, i), p = load(&at->p, i);
    vec3 d = {wi.x * t.x + wi.y * b.x + wi.z * n.x, wi.x * t.y + wi.y * b.y + wi.z * n.y,
              wi.x * t.z + wi.y * b.z + wi.z * n.z};
    float pdf = draw->pdf[i];
    bool below = wi.z < 0.0f;
    vec3 off = scaled(g, below ? -1.0f : 1.0f);
    bool drawn = may & (pdf > 0.0f) & (dot(d, off) > 0.0f);
    float factor = drawn ? draw->cosine[i] / pdf : 0.0f;
    float r = draw->f.r[i] * factor * state->throughput.r[lane[i]];
    float green = draw->f.g[i] * factor * state->throughput.g[lane[i]];
    float blue = draw->f.b[i] * factor * state->throughput.b[lane[i]];
    float most = largest(r, green, blue);
    float worth = most * (pdf / (draw->own[i] > 1e-20f ? draw->own[i] : 1e-20f));
    float chance = (roulette & (worth < 1.0f)) ? sqrtf(worth) : 1.0f;
    bool goes = (most > 0.0f) & (most < 1e30f) & (draw->roulette[i] < chance);
    float scale = goes ? 1.0f / chance : 0.0f;
    store(&wide->d, i, scaled(d, 1.0f / sqrtf(goes ? dot(d, d) : 1.0f)));
    store(&wide->o, i, (vec3){p.x + off.x, p.y + off.y, p.z + off.z});
    draw->f.r[i] = r * scale;
    draw->f.g[i] = green * scale;
    draw->f.b[i] = blue * scale;
    wide->tfar[i] = goes ? 1.0f : 0.0f;
  }
  size_t rays = 0;
  for (size_t i = 0; i < count; i++) {
    chosen[rays] = (uint32_t)i;
    rays += wide->tfar[i] > 0.0f;
  }
#pragma omp simd
  for (size_t k = 0; k < rays; k++) {
    uint32_t i = chosen[k];
    ray->o.x[k] = wide->o.x[i];
    ray->o.y[k] = wide->o.y[i];
    ray->o.z[k] = wide->o.z[i];
    ray->tnear[k] = 0.0f;
    ray->d.x[k] = wide->d.x[i];
    ray->d.y[k] = wide->d.y[i];
    ray->d.z[k] = wide->d.z[i];
    ray->tfar[k] = INFINITY;
    uint32_t from = lane[i], kind = draw->kind[i] & BOUNCE_MASK;
    bool straight = kind == BOUNCE_TRANSPARENT;
    next->sample[k] = state->sample[from];
    next->throughput.r[k] = draw->f.r[i];
    next->throughput.g[k] = draw->f.g[i];
    next->throughput.b[k] = draw->f.b[i];
    next->from.x[k] = straight ? state->from.x[from] : at->p.x[i];
    next->from.y[k] = straight ? state->from.y[from] : at->p.y[i];
    next->from.z[k] = straight ? state->from.z[from] : at->p.z[i];
    next->pdf[k] = straight ? state->pdf[from] : draw->pdf[i];
    float least = state->least[from], own = draw->own[i];
    next->least[k] = (straight | (least < own)) ? least : own;
    next->lights[k] = straight ? state->lights[from] : lights[i];
    uint32_t matt = draw->kind[i] & BOUNCE_MATT ? RAY_DIFFUSE : 0;
    uint32_t sharp = draw->kind[i] & BOUNCE_SHARP ? RAY_SINGULAR : 0;
    next->ray[k] = straight ? state->ray[from] : 2u << kind | matt | sharp;
    for (uint32_t one = 0; one < BOUNCE_KINDS; one++)
      next->bounces[one][k] = state->bounces[one][from] + (kind == one);
    next->ends[k] = draw->kind[i] & WALK_ENDS;
  }
  return rays;
}

/* Infinite light is very bright here: dimmed as it is, it would be no number. */
LEAF void add_dimmed(lane_c *color, uint32_t sample, float most, float r, float g, float b) {
  r = finite_light(r);
  g = finite_light(g);
  b = finite_light(b);
  float mean = (fabsf(r) + fabsf(g) + fabsf(b)) * (1.0f / 3.0f);
  float dim = mean > most ? most / mean : 1.0f;
  color->r[sample] += dim * r;
  color->g[sample] += dim * g;
  color->b[sample] += dim * b;
}

/* A sample has one ray at most: no two lanes write to the same place. */
static void stage_gain(size_t count, const float most[2], uint32_t free,
                       const uint32_t *restrict lane, const path_states *restrict state,
                       const lane_c *restrict sum, lane_c *restrict color) {
  for (size_t i = 0; i < count; i++) {
    uint32_t k = lane[i];
    uint32_t bounced = state->bounces[BOUNCE_DIFFUSE][k] + state->bounces[BOUNCE_GLOSSY][k] +
                       state->bounces[BOUNCE_TRANSMISSION][k];
    add_dimmed(color, state->sample[k], most[bounced > free], state->throughput.r[k] * sum->r[i],
               state->throughput.g[k] * sum->g[i], state->throughput.b[k] * sum->b[i]);
  }
}

static void stage_uncover(size_t count, const uint32_t *restrict record,
                          path_states *restrict state, paths *restrict path) {
  for (size_t k = 0; k < count; k++) {
    bool passed = !(state->bounces[BOUNCE_DIFFUSE][k] | state->bounces[BOUNCE_GLOSSY][k] |
                    state->bounces[BOUNCE_TRANSMISSION][k]);
    if (record[k] != RECORD_MISS || !passed)
      continue;
    float mean =
        (state->throughput.r[k] + state->throughput.g[k] + state->throughput.b[k]) * (1.0f / 3.0f);
    path->alpha[state->sample[k]] -= mean;
    state->throughput.r[k] = state->throughput.g[k] = state->throughput.b[k] = 0.0f;
  }
}

static size_t stage_end(size_t count, const path_states *restrict state, const triangle *triangles,
                        const material *materials, uint32_t *restrict record) {
  uint32_t hits = 0;
  for (size_t k = 0; materials && k < count; k++) {
    bool stays =
        record[k] != RECORD_MISS &&
        (!state->ends[k] || materials[triangles[record[k]].material].traits & CLOSURE_PASSES);
    record[k] = stays ? record[k] : RECORD_MISS;
    hits += stays;
  }
  if (materials)
    return hits;
#pragma omp simd reduction(+ : hits)
  for (size_t k = 0; k < count; k++) {
    record[k] = state->ends[k] ? RECORD_MISS : record[k];
    hits += record[k] != RECORD_MISS ? 1u : 0u;
  }
  return hits;
}

static void stage_mute(size_t count, const uint32_t *restrict lane,
                       const path_states *restrict state, lane_c *restrict sum) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    bool counts = state->ends[lane[i]] == 0;
    sum->r[i] = counts ? sum->r[i] : 0.0f;
    sum->g[i] = counts ? sum->g[i] : 0.0f;
    sum->b[i] = counts ? sum->b[i] : 0.0f;
  }
}

static void stage_escape(size_t count, const uint32_t *restrict record,
                         const path_states *restrict state, uint32_t hidden,
                         const float background[3], const float backdrop[3],
                         lane_c *restrict emitted) {
  const float red = background[0], green = background[1], blue = background[2];
  const float far_red = backdrop[0], far_green = backdrop[1], far_blue = backdrop[2];
#pragma omp simd
  for (size_t k = 0; k < count; k++) {
    uint32_t ray = state->ray[k];
    float missed = record[k] == RECORD_MISS ? 1.0f : 0.0f;
    float near = (ray & (hidden | RAY_CAMERA)) == 0 ? missed : 0.0f;
    float far = (ray & RAY_CAMERA) != 0 ? missed : 0.0f;
    emitted->r[k] = near * red + far * far_red;
    emitted->g[k] = near * green + far * far_green;
    emitted->b[k] = near * blue + far * far_blue;
  }
}
