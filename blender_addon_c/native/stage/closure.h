/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each closure's stage, and what it makes of one light: f comes in, S = f cos E goes to the sum. */
#include "batch/leaf.h"
#include "stage/stage.h"

#define CLOSURE_STAGE(TYPE, name)                                                                  \
  static unsigned stage_##name(const segment *g, const surfaces *restrict at,                      \
                               const inputs *restrict given, const light_samples *restrict light,  \
                               bool density, reflections *restrict out) {                          \
    return closure_##name##_eval(&g->material->closure.of.name, g->run, at, given, light, density, \
                                 out);                                                             \
  }
CLOSURE_TABLE(CLOSURE_STAGE)

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
