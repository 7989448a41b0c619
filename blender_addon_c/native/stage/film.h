/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums over the samples of each pixel. */
#include "batch/leaf.h"
#include "stage/stage.h"

static void stage_film(size_t count, const camera_view *view, const lane_c *restrict color,
                       const paths *restrict path, float *restrict pixels) {
  const size_t first = view->first, samples = view->samples;
  size_t pixel = first / samples;
  size_t end = (pixel + 1) * samples - first; /* of this pixel's lanes */
  for (size_t i = 0; i < count; end += samples, pixel++) {
    size_t stop = end < count ? end : count;
    float red = 0, green = 0, blue = 0, opacity = 0;
#pragma omp simd reduction(+ : red, green, blue, opacity)
    for (size_t k = i; k < stop; k++) {
      red += color->r[k];
      green += color->g[k];
      blue += color->b[k];
      opacity += path->alpha[k];
    }
    pixels[4 * pixel + 0] += red;
    pixels[4 * pixel + 1] += green;
    pixels[4 * pixel + 2] += blue;
    pixels[4 * pixel + 3] += opacity;
    i = stop;
  }
}
