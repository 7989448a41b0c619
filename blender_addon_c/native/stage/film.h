/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums over the samples of each pixel. */
#include "batch/leaf.h"
#include "stage/stage.h"

typedef float row4 __attribute__((vector_size(16), aligned(4), may_alias));

LEAF row4 row_at(const float *from) {
  return *(const row4 *)from;
}

LEAF row4 sum_of_rows(const float *restrict from, size_t count) {
  row4 sum = row_at(from);
  for (size_t i = 4; i < count; i += 4)
    sum += row_at(from + i);
  return sum;
}

/* Sums of four rows, beside each other. */
LEAF row4 sums_of(row4 a, row4 b, row4 c, row4 d) {
  row4 ab = __builtin_shufflevector(a, b, 0, 2, 4, 6) + __builtin_shufflevector(a, b, 1, 3, 5, 7);
  row4 cd = __builtin_shufflevector(c, d, 0, 2, 4, 6) + __builtin_shufflevector(c, d, 1, 3, 5, 7);
  return __builtin_shufflevector(ab, cd, 0, 2, 4, 6) + __builtin_shufflevector(ab, cd, 1, 3, 5, 7);
}

/* Whole pixels of a few samples, a multiple of 4: a loop over samples as wide as a register would
 * be all remainder. */
static void film_of_few(size_t begin, size_t end, size_t samples, const lane_c *restrict color,
                        const float *restrict alpha, float *restrict pixels) {
  for (size_t i = begin; i < end; i += samples, pixels += 4) {
    row4 sum = row_at(pixels) +
               sums_of(sum_of_rows(color->r + i, samples), sum_of_rows(color->g + i, samples),
                       sum_of_rows(color->b + i, samples), sum_of_rows(alpha + i, samples));
    *(row4 *)pixels = sum;
  }
}

/* Of the samples that are in the first half of their pixel's. */
static void film_half(size_t count, size_t first, size_t samples, const lane_c *restrict color,
                      float *restrict half) {
  for (size_t i = 0, number = first % samples, pixel = first / samples; i < count; pixel++) {
    size_t stop = i + samples - number, middle = i + samples / 2 - number;
    float red = 0, green = 0, blue = 0;
    stop = stop < count ? stop : count;
    middle = number >= samples / 2 ? i : middle < count ? middle : count;
#pragma omp simd reduction(+ : red, green, blue)
    for (size_t k = i; k < middle; k++) {
      red += color->r[k];
      green += color->g[k];
      blue += color->b[k];
    }
    half[3 * pixel + 0] += red;
    half[3 * pixel + 1] += green;
    half[3 * pixel + 2] += blue;
    i = stop;
    number = 0;
  }
}

static void stage_film(size_t count, const camera_view *view, const lane_c *restrict color,
                       const paths *restrict path, float *restrict pixels, float *restrict half) {
  enum { FEW = 16 };
  const size_t first = view->first, samples = view->samples;
  const bool few = samples < FEW && samples % 4 == 0;
  size_t pixel = first / samples;
  size_t end = (pixel + 1) * samples - first; /* of this pixel's lanes */
  for (size_t i = 0; i < count; end += samples, pixel++) {
    if (few && end - i == samples && end <= count) {
      size_t whole = (count - i) / samples;
      film_of_few(i, i + whole * samples, samples, color, path->alpha, pixels + 4 * pixel);
      pixel += whole - 1;
      end += (whole - 1) * samples;
      i = end;
      continue;
    }
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
  if (half)
    film_half(count, first, samples, color, half);
}
