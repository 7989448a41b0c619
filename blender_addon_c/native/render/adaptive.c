/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/adaptive.h"

#include <math.h>
#include <stdlib.h>

bool adaptive_init(adaptive *a, size_t tiles, size_t pixels) {
  a->half = calloc(pixels + 1, 3 * sizeof *a->half);
  a->passes = calloc(tiles + 1, ADAPTIVE_BLOCKS * sizeof *a->passes);
  a->done = calloc(tiles + 1, ADAPTIVE_BLOCKS * sizeof *a->done);
  return a->half && a->passes && a->done;
}

void adaptive_free(adaptive *a) {
  free(a->half);
  free(a->passes);
  free(a->done);
}

size_t adaptive_samples(const adaptive *a, const sampling_plan *plan, size_t block, size_t *half) {
  size_t samples = 0;
  *half = 0;
  for (size_t k = 0; k < a->passes[block]; k++) {
    samples += plan->pass[k].period;
    *half += plan->pass[k].period / 2;
  }
  return samples;
}

/* Half the difference of two halves is off as far as their mean is. */
float adaptive_error(const float *sum, const float *half, size_t samples, size_t in_half) {
  float first = 1.0f / (float)in_half, second = 1.0f / (float)(samples - in_half);
  float apart = 0.0f, bright = 0.0f;
  for (int c = 0; c < 3; c++) {
    apart += fabsf(half[c] * first - (sum[c] - half[c]) * second);
    bright += sum[c] > 0.0f ? sum[c] : 0.0f;
  }
  return 0.5f * apart / (1e-4f + sqrtf(bright / (float)samples));
}
