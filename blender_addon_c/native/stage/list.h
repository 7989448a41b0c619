/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stages of lists of closures, and what one light makes of f: S = f cos E goes to the sum. */
#include "batch/leaf.h"
#include "closure/closure.h"
#include "stage/common.h"
#include "stage/stage.h"

/* A weight, never NaN or below 0. */
typedef struct weight_lanes {
  const float *r, *g, *b;
} weight_lanes;
static inline weight_lanes weight_of(const closure *c, inputs *given, lane_run run) {
  return (weight_lanes){.r = lane_of(given, c->weight[0], 0, run),
                        .g = lane_of(given, c->weight[1], 1, run),
                        .b = lane_of(given, c->weight[2], 2, run)};
}
LEAF float weight_at(const float *lane, size_t i) {
  return clampf(lane[i], 0.0f, 1e30f);
}

/* How much a closure draws: by its weight and `albedo`, to *chance; their sum grows. */
static void stage_chance(const closure *c, lane_run run, inputs *given,
                         const float *restrict albedo, float *restrict chance,
                         float *restrict sum) {
  const weight_lanes w = weight_of(c, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float mean = (weight_at(w.r, i) + weight_at(w.g, i) + weight_at(w.b, i)) * (1.0f / 3.0f);
    chance[i] = mean * albedo[i];
    sum[i] += chance[i];
  }
}

/* Chances become probabilities. */
static void stage_share(lane_run run, const float *restrict sum, float *restrict chance) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float total = sum[i];
    chance[i] = total > 0.0f ? chance[i] / total : 0.0f;
  }
}

/* What is left of `choice` beyond closures that are not drawn; the drawn one's is even again. */
static void stage_pick(lane_run run, uint32_t number, const float *restrict chance,
                       uint32_t *restrict drawn, float *restrict choice) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float share = chance[i], left = choice[i];
    bool open = drawn[i] == CLOSURES_MOST, takes = open & (left < share);
    float even = clampf(left / (share > 1e-20f ? share : 1e-20f), 0.0f, 0.99999994f);
    drawn[i] = takes ? number : drawn[i];
    choice[i] = takes ? even : (open ? left - share : left);
  }
}

/* One closure's f and density to those of the whole list, which keep f cos and no cosine. */
static void stage_join_all(const closure *c, lane_run run, inputs *given,
                           const float *restrict chance, const reflections *restrict part,
                           reflections *restrict out) {
  const weight_lanes w = weight_of(c, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float cosine = part->cosine[i];
    out->f.r[i] += weight_at(w.r, i) * cosine * part->f.r[i];
    out->f.g[i] += weight_at(w.g, i) * cosine * part->f.g[i];
    out->f.b[i] += weight_at(w.b, i) * cosine * part->f.b[i];
    out->pdf[i] += chance[i] * part->pdf[i];
  }
}

/* A closure's draws where it is the one that draws. */
static void stage_take(const closure *c, lane_run run, uint32_t number, inputs *given,
                       const choices *restrict choice, const draws *restrict part,
                       draws *restrict out) {
  const weight_lanes w = weight_of(c, given, run);
  const float *chance = choice->chance[number];
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    bool takes = choice->drawn[i] == number;
    float cosine = part->cosine[i];
    store(&out->wi, i, select3(takes, load(&part->wi, i), load(&out->wi, i)));
    out->f.r[i] = takes ? weight_at(w.r, i) * cosine * part->f.r[i] : out->f.r[i];
    out->f.g[i] = takes ? weight_at(w.g, i) * cosine * part->f.g[i] : out->f.g[i];
    out->f.b[i] = takes ? weight_at(w.b, i) * cosine * part->f.b[i] : out->f.b[i];
    out->pdf[i] = takes ? chance[i] * part->pdf[i] : out->pdf[i];
    out->cosine[i] = takes ? 1.0f : out->cosine[i];
    out->kind[i] = takes ? part->kind[i] : out->kind[i];
  }
}

/* What another closure of the list has in the direction that was drawn. */
static void stage_join(const closure *c, lane_run run, uint32_t number, inputs *given,
                       const choices *restrict choice, const reflections *restrict part,
                       draws *restrict out) {
  const weight_lanes w = weight_of(c, given, run);
  const float *chance = choice->chance[number];
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    bool joins =
        (choice->drawn[i] != number) & (out->pdf[i] > 0.0f) & (out->kind[i] != BOUNCE_TRANSPARENT);
    float cosine = joins ? part->cosine[i] : 0.0f;
    float pdf = joins ? part->pdf[i] : 0.0f;
    out->f.r[i] += cosine > 0.0f ? weight_at(w.r, i) * cosine * part->f.r[i] : 0.0f;
    out->f.g[i] += cosine > 0.0f ? weight_at(w.g, i) * cosine * part->f.g[i] : 0.0f;
    out->f.b[i] += cosine > 0.0f ? weight_at(w.b, i) * cosine * part->f.b[i] : 0.0f;
    out->pdf[i] += chance[i] * pdf;
  }
}

/* What a draw counts as: through the surface it is transmission, whatever drew it. */
static void stage_kind(lane_run run, bounce_kind kind, bool sharp, draws *restrict out) {
  const uint32_t here = kind, also = sharp ? BOUNCE_SHARP : 0;
  const uint32_t below = kind == BOUNCE_TRANSPARENT ? here
                         : kind == BOUNCE_DIFFUSE   ? BOUNCE_TRANSMISSION | BOUNCE_MATT
                                                    : BOUNCE_TRANSMISSION;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++)
    out->kind[i] = (out->wi.z[i] < 0.0f ? below : here) | also;
}

/* No mirror image (above), or no view through glass (below), for rays from matt surfaces. */
static void stage_forbid(lane_run run, bool above, bool below, const uint32_t *restrict lane,
                         const path_states *restrict state, const float *restrict z,
                         float *restrict cosine) {
  const uint32_t up = above ? RAY_DIFFUSE : 0, down = below ? RAY_DIFFUSE : 0;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    uint32_t kinds = z[i] < 0.0f ? down : up;
    cosine[i] = state->ray[lane[i]] & kinds ? 0.0f : cosine[i];
  }
}

/* Light samples that bring less than `threshold` are left to chance, in proportion: no shadow ray,
 * or more light. color NULL: each has its own. */
static void stage_shadow_roulette(size_t count, float threshold, const float color[3], bool shared,
                                  const float *restrict lot, const reflections *restrict reflection,
                                  light_samples *restrict light) {
  const lane_c *restrict f = &reflection->f;
  const bool own = !color;
  const float red = own ? 0.0f : color[0], green = own ? 0.0f : color[1];
  const float blue = own ? 0.0f : color[2], inverse = 1.0f / threshold;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float r = fabsf(f->r[i] * (own ? light->color.r[i] : red));
    float g = fabsf(f->g[i] * (own ? light->color.g[i] : green));
    float b = fabsf(f->b[i] * (own ? light->color.b[i] : blue));
    float most = r > g ? r : g, pdf = light->pdf[i];
    most = most > b ? most : b;
    float part = (shared & (pdf > 0.0f)) ? balance(pdf, reflection->pdf[i]) : 1.0f;
    float chance = most * part * reflection->cosine[i] * light->e[i] * inverse;
    bool kept = lot[i] < chance;
    light->ray.tfar[i] = kept ? light->ray.tfar[i] : -1.0f;
    light->e[i] = (kept & (chance < 1.0f)) ? light->e[i] / chance : light->e[i];
  }
}

/* No light that is hidden from these kinds of ray, on the side of the eye or on the other. */
static void stage_exclude(lane_run run, uint32_t above, uint32_t below,
                          const light_samples *restrict light, reflections *restrict out) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    uint32_t kind = light->wi.z[i] < 0.0f ? below : above;
    out->cosine[i] = light->hidden[i] & kind ? 0.0f : out->cosine[i];
  }
}

/* Radiance of a closure that shines. */
static void stage_emit(const closure *c, lane_run run, inputs *given, lane_c *restrict sum) {
  const weight_lanes w = weight_of(c, given, run);
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    sum->r[i] += finite_light(w.r[i]);
    sum->g[i] += finite_light(w.g[i]);
    sum->b[i] += finite_light(w.b[i]);
  }
}

LEAF void reflect(bool own, bool shared, size_t count, const float color[3],
                  const light_samples *restrict light, reflections *restrict reflection,
                  lane_c *restrict sum) {
  const float color_r = own ? 1.0f : color[0], color_g = own ? 1.0f : color[1];
  const float color_b = own ? 1.0f : color[2];
  lane_c *restrict f = &reflection->f;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float factor = reflection->cosine[i] * light->e[i];
    if (shared) {
      float pdf = light->pdf[i];
      factor *= pdf > 0.0f ? balance(pdf, reflection->pdf[i]) : 1.0f;
    }
    f->r[i] *= factor * (own ? light->color.r[i] : color_r);
    f->g[i] *= factor * (own ? light->color.g[i] : color_g);
    f->b[i] *= factor * (own ? light->color.b[i] : color_b);
    sum->r[i] += f->r[i];
    sum->g[i] += f->g[i];
    sum->b[i] += f->b[i];
  }
}

static void stage_reflect(size_t count, const float color[3], bool shared,
                          const light_samples *restrict light, reflections *restrict reflection,
                          lane_c *restrict sum) {
  if (color && shared)
    reflect(false, true, count, color, light, reflection, sum);
  else if (color)
    reflect(false, false, count, color, light, reflection, sum);
  else if (shared)
    reflect(true, true, count, color, light, reflection, sum);
  else
    reflect(true, false, count, color, light, reflection, sum);
}
