/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/sampling.h"

#include <math.h>
#include <stdlib.h>

/* Sobol's points from initial direction numbers m; dimension 0 is van der Corput's. */
static void sobol_directions(int dimension, uint32_t v[32]) {
  static const struct {
    unsigned degree, coefficients, m[3];
  } table[SAMPLING_DIMENSIONS] = {{0, 0, {0}}, {1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}};
  unsigned degree = table[dimension].degree;
  for (unsigned i = 0; i < 32; i++) {
    if (!degree) {
      v[i] = 1u << (31 - i);
    } else if (i < degree) {
      v[i] = table[dimension].m[i] << (31 - i);
    } else {
      v[i] = v[i - degree] ^ (v[i - degree] >> degree);
      for (unsigned k = 1; k < degree; k++)
        if (table[dimension].coefficients >> (degree - 1 - k) & 1u)
          v[i] ^= v[i - k];
    }
  }
}

static uint32_t sobol_point(const uint32_t v[32], size_t i) {
  uint32_t x = 0;
  for (unsigned bit = 0; bit < 32 && i >> bit; bit++)
    if (i >> bit & 1u)
      x ^= v[bit];
  return x;
}

/* A filter at x in [-1/2, 1/2]; the normal distribution ends at 3 times its width. */
static double filter_at(filter_type filter, double x) {
  if (filter == FILTER_GAUSSIAN)
    return exp(-72 * x * x);
  double a = 6.283185307179586 * (x + 0.5);
  return 0.35875 - 0.48829 * cos(a) + 0.14128 * cos(2 * a) - 0.01168 * cos(3 * a);
}

/* Inverse of the filter's integral, by the trapezoid rule on a fine grid. */
static void fill_warp(float *warp, filter_type filter, double width) {
  enum { STEPS = 16 * FILTER_STEPS };
  double total = 0, sum = 0;
  for (int i = 0; i < STEPS; i++)
    total += filter_at(filter, (i + 0.5) / STEPS - 0.5);
  int step = 0;
  for (int k = 0; k <= FILTER_STEPS; k++) {
    double wanted = total * k / FILTER_STEPS;
    double part = 0;
    while (step < STEPS && sum + (part = filter_at(filter, (step + 0.5) / STEPS - 0.5)) < wanted) {
      sum += part;
      step++;
    }
    double inside = step < STEPS && part > 0 ? (wanted - sum) / part : 0.0;
    warp[k] = (float)(width * ((step + inside) / STEPS - 0.5));
  }
}

/* Samples of the pass that begins with number `first`. */
static size_t pass_length(size_t first, size_t samples) {
  size_t end = first < 4 ? 4 : first < 16 ? 16 : (first / 64 + 1) * 64;
  return (end < samples ? end : samples) - first;
}

/* Points `first` and on of each dimension. */
static bool pass_init(sampling *s, size_t first, size_t run) {
  for (int d = 0; d < SAMPLING_DIMENSIONS; d++) {
    uint32_t v[32];
    s->point[d] = malloc((s->period + run) * sizeof **s->point);
    if (!s->point[d])
      return false;
    sobol_directions(d, v);
    for (size_t i = 0; i < s->period; i++)
      s->point[d][i] = sobol_point(v, first + i);
    for (size_t i = 0; i < run; i++)
      s->point[d][s->period + i] = s->point[d][i];
  }
  return true;
}

static uint32_t *reversed_points(uint32_t mask) {
  uint32_t v[32], *reverse = malloc((mask + (size_t)1) * sizeof *reverse);
  sobol_directions(1, v);
  for (uint32_t i = 0; reverse && i <= mask; i++) {
    uint32_t x = sobol_point(v, i), turned = 0;
    for (unsigned bit = 0; bit < 32; bit++)
      turned |= (x >> bit & 1u) << (31 - bit);
    reverse[i] = turned;
  }
  return reverse;
}

bool sampling_is_cut(size_t samples, size_t at) {
  size_t first = 0;
  while (first < at)
    first += pass_length(first, samples);
  return first == at;
}

bool sampling_init(sampling_plan *s, size_t samples, const size_t share[2], size_t run,
                   filter_type filter, float width) {
  const size_t begin = share ? share[0] : 0, end = share ? share[1] : samples;
  *s = (sampling_plan){.samples = samples, .first = begin};
  for (size_t first = 0; first < end; first += pass_length(first, samples))
    s->passes += first + pass_length(first, samples) > begin;
  uint32_t mask = 0;
  while (mask < samples - 1)
    mask = 2 * mask + 1;
  s->pass = calloc(s->passes, sizeof *s->pass);
  s->reverse = reversed_points(mask);
  if (!s->pass || !s->reverse)
    return false;
  if (width > 0.0f) {
    s->warp = malloc((FILTER_STEPS + 1) * sizeof *s->warp);
    if (!s->warp)
      return false;
    fill_warp(s->warp, filter, (double)width);
  }
  size_t first = 0, length;
  while ((length = pass_length(first, samples)), first + length <= begin)
    first += length;
  for (sampling *p = s->pass; p < s->pass + s->passes; p++) {
    const size_t low = first > begin ? first : begin;
    length = pass_length(first, samples);
    first += length;
    *p = (sampling){.period = (first < end ? first : end) - low,
                    .whole = length,
                    .reverse = s->reverse,
                    .mask = mask,
                    .scramble = UINT32_MAX,
                    .warp = s->warp};
    if (!pass_init(p, low, run))
      return false;
  }
  return true;
}

bool sampling_init_center(sampling_plan *s, size_t run) {
  if (!sampling_init(s, 1, NULL, run, FILTER_BLACKMAN_HARRIS, 0.0f))
    return false;
  s->pass->scramble = 0;
  for (int d = 0; d < SAMPLING_DIMENSIONS; d++)
    for (size_t i = 0; i < 1 + run; i++)
      s->pass->point[d][i] = 0x80000000u;
  return true;
}

void sampling_free(sampling_plan *s) {
  for (size_t k = 0; s->pass && k < s->passes; k++)
    for (int d = 0; d < SAMPLING_DIMENSIONS; d++)
      free(s->pass[k].point[d]);
  free(s->pass);
  free(s->reverse);
  free(s->warp);
}
