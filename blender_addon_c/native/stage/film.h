/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums over the samples of each pixel. */
#include "batch/leaf.h"
#include "stage/stage.h"

typedef float row4 __attribute__((vector_size(16), aligned(4), may_alias));

/* Of a few numbers: a loop as wide as a register would be all remainder. */
LEAF float sum_of_few(const float *restrict from, size_t count) {
  row4 sum = {0};
  size_t i = 0;
  for (; i + 4 <= count; i += 4)
    sum += *(const row4 *)(from + i);
  float rest = 0;
  for (; i < count; i++)
    rest += from[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]) + rest;
}

static void stage_film(size_t count, const camera_view *view, const lane_c *restrict color,
                       const paths *restrict path, float *restrict pixels) {
  enum { FEW = 16 };
  const size_t first = view->first, samples = view->samples;
  size_t pixel = first / samples;
  size_t end = (pixel + 1) * samples - first; /* of this pixel's lanes */
  for (size_t i = 0; i < count; end += samples, pixel++) {
    size_t stop = end < count ? end : count;
    float red = 0, green = 0, blue = 0, opacity = 0;
    if (samples < FEW) {
      red = sum_of_few(color->r + i, stop - i);
      green = sum_of_few(color->g + i, stop - i);
      blue = sum_of_few(color->b + i, stop - i);
      opacity = sum_of_few(path->alpha + i, stop - i);
    } else {
#pragma omp simd reduction(+ : red, green, blue, opacity)
      for (size_t k = i; k < stop; k++) {
        red += color->r[k];
        green += color->g[k];
        blue += color->b[k];
        opacity += path->alpha[k];
      }
    }
    pixels[4 * pixel + 0] += red;
    pixels[4 * pixel + 1] += green;
    pixels[4 * pixel + 2] += blue;
    pixels[4 * pixel + 3] += opacity;
    i = stop;
  }
}
