/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reflected light of one light: f comes in, S = f cos E goes out and to the sum. */
#include "batch/leaf.h"

static void stage_reflect(size_t count, const float color[3], const float *restrict e,
                          const float *restrict cosine, float *restrict r, float *restrict g,
                          float *restrict b, float *restrict sum_r, float *restrict sum_g,
                          float *restrict sum_b) {
  const float color_r = color[0], color_g = color[1], color_b = color[2];
  for (size_t i = 0; i < count; i++) {
    float factor = cosine[i] * e[i];
    r[i] *= factor * color_r;
    g[i] *= factor * color_g;
    b[i] *= factor * color_b;
    sum_r[i] += r[i];
    sum_g[i] += g[i];
    sum_b[i] += b[i];
  }
}
