/* SPDX-License-Identifier: Apache-2.0 */
#include "src/moments.h"
#include "src/slope_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- building --------------------------------------------------------------------- */

static int half(int n, int shrink) {
  return n / shrink > 1 ? n / shrink : 1;
}

/* Add `weight` times the source row to the narrower row `to`. */
static void reduce_row(const float *from, int width, double weight, double *to, int narrow) {
  const double ratio = (double)width / narrow;
  for (int i = 0; i < narrow; i++) {
    const double begin = i * ratio, end = i + 1 == narrow ? width : (i + 1) * ratio;
    for (int k = (int)begin; k < width && k < end; k++) {
      const double part = fmin(end, k + 1) - fmax(begin, k);
      for (int c = 0; c < MOMENTS; c++)
        to[i * MOMENTS + c] += weight * part / ratio * (double)from[k * MOMENTS + c];
    }
  }
}

/* The kernel reads eight floats from where a texel begins. */
static float *level_room(size_t floats) {
  float *texels = malloc((floats + 8 - MOMENTS) * sizeof *texels);
  for (size_t i = 0; texels && i < 8 - MOMENTS; i++)
    texels[floats + i] = 0;
  return texels;
}

static int reduce(moment_level *to, int width, int height, moment_row *row, const void *context) {
  const size_t narrow = (size_t)to->width * MOMENTS;
  if (to->width == width && to->height == height) {
    to->texels = level_room(narrow * (size_t)height);
    for (int j = 0; to->texels && j < height; j++)
      row(context, j, to->texels + (size_t)j * narrow);
    return to->texels ? 0 : -1;
  }
  float *source = malloc((size_t)width * MOMENTS * sizeof *source);
  double *sum = malloc(narrow * sizeof *sum);
  to->texels = level_room(narrow * (size_t)to->height);
  const int status = source && sum && to->texels ? 0 : -1;
  const double ratio = (double)height / to->height;
  for (int j = 0; status == 0 && j < to->height; j++) {
    const double begin = j * ratio, end = j + 1 == to->height ? height : (j + 1) * ratio;
    memset(sum, 0, narrow * sizeof *sum);
    for (int k = (int)begin; k < height && k < end; k++) {
      row(context, k, source);
      reduce_row(source, width, (fmin(end, k + 1) - fmax(begin, k)) / ratio, sum, to->width);
    }
    for (size_t i = 0; i < narrow; i++)
      to->texels[(size_t)j * narrow + i] = (float)sum[i];
  }
  free(source);
  free(sum);
  return status;
}

/* As reduce would, where sides are halved: most of them, and the largest. */
static int halve(moment_level *to, const moment_level *from) {
  const size_t narrow = (size_t)to->width * MOMENTS, wide = (size_t)from->width * MOMENTS;
  to->texels = level_room(narrow * (size_t)to->height);
  for (int j = 0; to->texels && j < to->height; j++) {
    const float *upper = from->texels + (size_t)(2 * j) * wide, *lower = upper + wide;
    float *mean = to->texels + (size_t)j * narrow;
    for (int i = 0; i < to->width; i++, upper += 2 * MOMENTS, lower += 2 * MOMENTS)
      for (int c = 0; c < MOMENTS; c++)
        *mean++ = (float)(0.25 * ((double)upper[c] + (double)upper[c + MOMENTS] + (double)lower[c] +
                                  (double)lower[c + MOMENTS]));
  }
  return to->texels ? 0 : -1;
}

static void level_row(const void *context, int j, float *to) {
  const moment_level *l = context;
  const size_t size = (size_t)l->width * MOMENTS;
  memcpy(to, l->texels + (size_t)j * size, size * sizeof *to);
}

int moments_create(moment_pyramid *p, int width, int height, int shrink, moment_wrap wrap,
                   moment_row *row, const void *context) {
  memset(p, 0, sizeof *p);
  p->wrap = wrap;
  p->levels = 1;
  p->level[0].width = half(width, shrink);
  p->level[0].height = half(height, shrink);
  if (reduce(&p->level[0], width, height, row, context) != 0)
    return -1;
  while (p->levels < MOMENT_LEVELS) {
    const moment_level *from = &p->level[p->levels - 1];
    moment_level *to = &p->level[p->levels];
    if (from->width == 1 && from->height == 1)
      break;
    to->width = half(from->width, 2);
    to->height = half(from->height, 2);
    p->levels++;
    const int halved = from->width == 2 * to->width && from->height == 2 * to->height;
    if ((halved ? halve(to, from) : reduce(to, from->width, from->height, level_row, from)) != 0)
      return -1;
  }
  return 0;
}

void moments_free(moment_pyramid *p) {
  for (int i = 0; i < p->levels; i++)
    free(p->level[i].texels);
  p->levels = 0;
}

/* ---- looking up -------------------------------------------------------------------- */

/* Eigenvalues (larger first) of {xx, xy, yy}, and the unit vector of the larger. */
static void principal(const double m[3], double value[2], double axis[2]) {
  const double mean = (m[0] + m[2]) / 2, half_gap = (m[0] - m[2]) / 2;
  const double root = hypot(half_gap, m[1]);
  value[0] = mean + root;
  value[1] = fmax(mean - root, 0);
  const double angle = root > 0 ? 0.5 * atan2(m[1], half_gap) : 0;
  axis[0] = cos(angle);
  axis[1] = sin(angle);
}

/* a a' + b b' of the sides, in texels of level 0: 12 times the parallelogram's covariance. */
static void spread(const moment_pyramid *p, const double footprint[4], double m[3]) {
  const double w = p->level[0].width, h = p->level[0].height;
  const double ax = footprint[0] * w, ay = footprint[1] * h;
  const double bx = footprint[2] * w, by = footprint[3] * h;
  m[0] = ax * ax + bx * bx;
  m[1] = ax * ay + bx * by;
  m[2] = ay * ay + by * by;
}

double moments_extent(const moment_pyramid *p, const double footprint[4]) {
  double m[3], value[2], axis[2];
  spread(p, footprint, m);
  principal(m, value, axis);
  return sqrt(value[0]);
}

double moments_blend(double extent) {
  /* the filter of level 0 is as wide as a box of sqrt 3 texels */
  const double from = 1.7320508075688772;
  return fmin(fmax(extent / from - 1, 0), 1);
}

static void bilinear(const moment_level *l, moment_wrap wrap, double u, double v, double weight,
                     double out[MOMENTS]) {
  const double x = u * l->width - 0.5, y = (1 - v) * l->height - 0.5;
  const double fx = floor(x), fy = floor(y), tx = x - fx, ty = y - fy;
  const int i[2] = {wrap_index((int)fx, l->width, wrap), wrap_index((int)fx + 1, l->width, wrap)};
  const int j[2] = {wrap_index((int)fy, l->height, wrap), wrap_index((int)fy + 1, l->height, wrap)};
  const double wx[2] = {1 - tx, tx}, wy[2] = {1 - ty, ty};
  for (int k = 0; k < 4; k++) {
    const float *texel =
        l->texels + ((size_t)j[k / 2] * (size_t)l->width + (size_t)i[k % 2]) * MOMENTS;
    const double w = weight * wx[k % 2] * wy[k / 2];
    for (int c = 0; c < MOMENTS; c++)
      out[c] += w * (double)texel[c];
  }
}

/* Probes along one axis and the part of its length that they take, so that probes, texels
 * and interpolation together have the footprint's second moment. */
static int probes(double length, double texel, double *part) {
  const double most = 16;
  const int n = (int)fmin(fmax(ceil(length / texel - SLOPE_COUNT_SLACK), 1), most);
  const double rest = 1 - 3 * texel * texel / fmax(length * length, 1e-30);
  *part = n > 1 ? sqrt(fmax(rest, 0) / (1 - 1.0 / (n * n))) : 0;
  return n;
}

void moments_lookup(const moment_pyramid *p, double u, double v, const double footprint[4],
                    double out[MOMENTS]) {
  const double w = p->level[0].width, h = p->level[0].height;
  double m[3], value[2], axis[2];
  spread(p, footprint, m);
  principal(m, value, axis);
  const double ax = footprint[0] * w, ay = footprint[1] * h, side = hypot(ax, ay);
  if (side > 0 && value[0] - value[1] <= MOMENT_ROUND * (value[0] + value[1])) {
    axis[0] = ax / side;
    axis[1] = ay / side;
  }
  const double longer = sqrt(value[0]), shorter = sqrt(value[1]);
  /* texels of a third of the shorter side, and no more than 16 of them along the longer */
  double texel = fmax(fmax(shorter / 3, longer / 16), 1);
  int level = (int)floor(log2(texel));
  double next = 0; /* weight of the next level: mixes squares of texel sides to texel^2 */
  if (level >= p->levels - 1) {
    level = p->levels - 1;
    texel = ldexp(1, level);
  } else {
    next = (texel * texel / ldexp(1, 2 * level) - 1) / 3;
  }
  double part1, part2;
  const int n1 = probes(longer, texel, &part1), n2 = probes(shorter, texel, &part2);
  memset(out, 0, MOMENTS * sizeof *out);
  for (int a = 0; a < n1; a++)
    for (int b = 0; b < n2; b++) {
      const double s = part1 * longer * ((a + 0.5) / n1 - 0.5);
      const double t = part2 * shorter * ((b + 0.5) / n2 - 0.5);
      const double pu = u + (s * axis[0] - t * axis[1]) / w;
      const double pv = v + (s * axis[1] + t * axis[0]) / h;
      bilinear(&p->level[level], p->wrap, pu, pv, (1 - next) / (n1 * n2), out);
      if (next > 0)
        bilinear(&p->level[level + 1], p->wrap, pu, pv, next / (n1 * n2), out);
    }
}

/* ---- moments to slopes --------------------------------------------------------------- */

void moments_add(double sum[MOMENTS], double weight, double height, double x, double y) {
  sum[MOMENT_H] += weight * height;
  sum[MOMENT_X] += weight * x;
  sum[MOMENT_Y] += weight * y;
  sum[MOMENT_XX] += weight * x * x;
  sum[MOMENT_XY] += weight * x * y;
  sum[MOMENT_YY] += weight * y * y;
}

void moments_flat(shade_slopes *s) {
  memset(s, 0, sizeof *s);
  s->normal[2] = 1;
}

void moments_slopes(const double moments[MOMENTS], shade_slopes *s) {
  const double x = moments[MOMENT_X], y = moments[MOMENT_Y];
  const double length = sqrt(x * x + y * y + 1);
  s->mean[0] = x;
  s->mean[1] = y;
  s->normal[0] = -x / length;
  s->normal[1] = -y / length;
  s->normal[2] = 1 / length;
  /* rounding must not leave a negative variance */
  const double xx = fmax(moments[MOMENT_XX] - x * x, 0);
  const double yy = fmax(moments[MOMENT_YY] - y * y, 0);
  const double most = sqrt(xx * yy), xy = moments[MOMENT_XY] - x * y;
  s->covariance[0] = xx;
  s->covariance[1] = fmin(fmax(xy, -most), most);
  s->covariance[2] = yy;
}
