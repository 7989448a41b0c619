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

static void stage_reflect(size_t count, const float color[3], const light_samples *restrict light,
                          reflections *restrict reflection, lane_c *restrict sum) {
  const float color_r = color[0], color_g = color[1], color_b = color[2];
  lane_c *restrict f = &reflection->f;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float factor = reflection->cosine[i] * light->e[i];
    f->r[i] *= factor * color_r;
    f->g[i] *= factor * color_g;
    f->b[i] *= factor * color_b;
    sum->r[i] += f->r[i];
    sum->g[i] += f->g[i];
    sum->b[i] += f->b[i];
  }
}
