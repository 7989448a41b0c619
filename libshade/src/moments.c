/* SPDX-License-Identifier: Apache-2.0 */
#include "src/moments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- building --------------------------------------------------------------------- */

static int half(int n) {
  return n > 3 ? n / 2 : 1;
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

static int level_room(moment_level *l) {
  l->texels = malloc((size_t)l->width * (size_t)l->height * MOMENTS * sizeof *l->texels);
  return l->texels ? 0 : -1;
}

static int reduce(moment_level *to, int width, int height, moment_row *row, const void *context) {
  const size_t narrow = (size_t)to->width * MOMENTS;
  float *source = malloc((size_t)width * MOMENTS * sizeof *source);
  double *sum = malloc(narrow * sizeof *sum);
  const int status = source && sum && level_room(to) == 0 ? 0 : -1;
  const double ratio = (double)height / to->height;
  for (int j = 0; status == 0 && j < to->height; j++) {
    const double begin = j * ratio, end = j + 1 == to->height ? height : (j + 1) * ratio;
    memset(sum, 0, narrow * sizeof *sum);
    for (int k = (int)begin; k < height && k < end; k++) {
      row(context, k, source);
      reduce_row(source, width, (fmin(end, k + 1) - fmax(begin, k)) / ratio, sum, to->width);
    }
    for (int i = 0; i < to->width; i++)
      for (int c = 0; c < MOMENTS; c++)
        moment_texel(to, i, j)[c] = (float)sum[i * MOMENTS + c];
  }
  free(source);
  free(sum);
  return status;
}

/* As reduce would, where sides are halved: most of them, and the largest. */
static int halve(moment_level *to, const moment_level *from) {
  if (level_room(to) != 0)
    return -1;
  for (int j = 0; j < to->height; j++) {
    const float *upper = moment_texel(from, 0, 2 * j), *lower = moment_texel(from, 0, 2 * j + 1);
    float *mean = moment_texel(to, 0, j);
    for (int i = 0; i < to->width; i++) {
      for (int c = 0; c < MOMENTS; c++)
        mean[c] = (float)(0.25 * ((double)upper[c] + (double)upper[c + MOMENTS] + (double)lower[c] +
                                  (double)lower[c + MOMENTS]));
      upper += 2 * MOMENTS;
      lower += 2 * MOMENTS;
      mean += MOMENTS;
    }
  }
  return 0;
}

static void level_row(const void *context, int j, float *to) {
  const moment_level *l = context;
  memcpy(to, moment_texel(l, 0, j), (size_t)l->width * MOMENTS * sizeof *to);
}

int shade_moments_create(moment_pyramid *p, int width, int height, moment_wrap wrap,
                         moment_row *row, moment_cell *cell, const void *context) {
  memset(p, 0, sizeof *p);
  p->wrap = wrap;
  p->cell = cell;
  p->context = context;
  p->level[0].width = width;
  p->level[0].height = height;
  p->levels = 1;
  if (cell) {
    p->level[1].width = half(width);
    p->level[1].height = half(height);
    p->levels = 2;
  }
  if (reduce(&p->level[p->levels - 1], width, height, row, context) != 0)
    return -1;
  while (p->levels < MOMENT_LEVELS) {
    const moment_level *from = &p->level[p->levels - 1];
    moment_level *to = &p->level[p->levels];
    if (from->width == 1 && from->height == 1)
      break;
    to->width = half(from->width);
    to->height = half(from->height);
    p->levels++;
    const int halved = from->width == 2 * to->width && from->height == 2 * to->height;
    if ((halved ? halve(to, from) : reduce(to, from->width, from->height, level_row, from)) != 0)
      return -1;
  }
  return 0;
}

void shade_moments_free(moment_pyramid *p) {
  for (int i = 0; i < p->levels; i++)
    free(p->level[i].texels);
  p->levels = 0;
}

/* ---- looking up -------------------------------------------------------------------- */

/* Eigenvalues, larger first, of {xx, xy, yy}. */
static void principal(const double m[3], double value[2]) {
  const double mean = (m[0] + m[2]) / 2, root = hypot((m[0] - m[2]) / 2, m[1]);
  value[0] = mean + root;
  value[1] = fmax(mean - root, 0);
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

double shade_moments_extent(const moment_pyramid *p, const double footprint[4]) {
  double m[3], value[2];
  spread(p, footprint, m);
  principal(m, value);
  return sqrt(value[0]);
}

double shade_moments_blend(double extent) {
  /* the filter of level 0 is as wide as a box of sqrt 3 texels */
  const double from = 1.7320508075688772;
  return fmin(fmax(extent / from - 1, 0), 1);
}

/* Sums of weights from a filter's edge inwards, `depth` texels in: of a texel that lies astride the
 * edge some goes to the next one, so that what is linear stays so. */
static double covered(double depth) {
  const double s = fmin(fmax(depth - 1, -1), 1);
  return 1 + s - 0.5 * fabs(s) * (1 + s);
}

/* What a filter of `width` texels takes of one whose middle is `distance` from its own. */
static double cover(double width, double distance) {
  const double half = (width + 1) / 2;
  return covered(half - distance) + covered(half + distance) - 1;
}

/*
 * Width of the filter that spreads, with the texels' boxes, as a footprint whose side is the root
 * of side2: width^2 + 2/width is side2. Within 5e-4 of it from MOMENT_LEAST on, where this is cut.
 */
static double filter_width(double side2) {
  const double square = fmax(side2, MOMENT_LEAST), side = sqrt(square);
  return side * (0.54403 + 0.45597 * sqrt(1 - 5.1961524 / (square * side))) + 0.18635 / square;
}

/*
 * Add what a footprint finds on level k. `m`: twelve times its covariance in the level's texels, y
 * downwards, and `area` the root of that matrix's determinant. The filter is a parallelogram with
 * two sides along the rows, so that each texel is read once. A texel's own box, of which twelve
 * times the variance is 1, is not sheared.
 */
static void add_level(const moment_pyramid *p, int k, double u, double v, const double m[3],
                      double area, double weight, double out[MOMENTS]) {
  const moment_level *l = &p->level[k];
  const double middle = l->texels ? 0.5 : 1; /* cells begin in the middles of texels */
  const double x = u * l->width - middle, y = (1 - v) * l->height - middle;
  const double rows = fmax(m[2], MOMENT_LEAST) - 1, shear = m[1] / rows;
  const double high = filter_width(rows + 1), reach_y = (high + 1) / 2;
  const double wide = filter_width((area * area - m[0]) / rows), reach_x = (wide + 1) / 2;
  const int bottom = (int)floor(y + reach_y);
  for (int j = (int)ceil(y - reach_y); j <= bottom; j++) {
    const double w = weight * cover(high, j - y) / (wide * high), at = x + shear * (j - y);
    const int row = wrap_index(j, l->height, p->wrap);
    const int right = (int)floor(at + reach_x);
    for (int i = (int)ceil(at - reach_x); i <= right; i++) {
      const double part = w * cover(wide, i - at);
      double made[MOMENTS];
      const float *texel = NULL;
      if (l->texels)
        texel = moment_texel(l, wrap_index(i, l->width, p->wrap), row);
      else
        p->cell(p->context, i, j, made);
      for (int c = 0; c < MOMENTS; c++)
        out[c] += part * (texel ? (double)texel[c] : made[c]);
    }
  }
}

/* How much of level 1 there is beside cells: all for footprints as large as its filter is good for.
 */
static double beyond_cells(double area2) {
  const double from = MOMENT_CELLS_NEAR, to = MOMENT_CELLS_FAR;
  return fmin(fmax((sqrt(sqrt(area2)) - from) / (to - from), 0), 1);
}

void shade_moments_lookup(const moment_pyramid *p, double u, double v, const double footprint[4],
                          double out[MOMENTS]) {
  const double w = p->level[0].width, h = p->level[0].height;
  double m[3], value[2];
  spread(p, footprint, m);
  principal(m, value);
  /* squared: the shorter axis, and texels' sides that are small enough for it */
  const double thin = fmax(value[1], value[0] * MOMENT_LONGEST);
  const double side2 = fmax(fmin(thin * MOMENT_ACROSS, sqrt(value[0] * thin) * MOMENT_SQUARE), 1);
  int level = (int)floor(0.5 * log2(side2));
  memset(out, 0, MOMENTS * sizeof *out);
  double next = fmax((sqrt(side2) / ldexp(1, level) - MOMENT_NEXT) / (2 - MOMENT_NEXT), 0);
  if (p->cell && level == 0) {
    next = beyond_cells(value[0] * value[1]);
    level = next >= 1;
    next = level ? 0 : next;
  }
  if (level >= p->levels - 1) {
    for (int c = 0; c < MOMENTS; c++)
      out[c] = (double)p->level[p->levels - 1].texels[c];
    return;
  }
  for (int k = level; k < level + 1 + (next > 0); k++) {
    /* the shorter axis grown to what the finest stored texels can tell, or cells: to where the
     * longer is, at most */
    const double shorter = fmax(thin, p->cell && k > 0 ? 4 * MOMENT_LEAST : MOMENT_LEAST);
    const double grow = fmin((shorter - value[1]) / fmax(value[0] - value[1], 1e-30), 1);
    /* a side of one texel is halved no more, but is the same all along: as if it were */
    const double gx = fmin(p->level[k].width / w, ldexp(1, -k));
    const double gy = fmin(p->level[k].height / h, ldexp(1, -k));
    const double scaled[3] = {gx * gx * (m[0] + grow * (value[0] - m[0])),
                              -gx * gy * (1 - grow) * m[1],
                              gy * gy * (m[2] + grow * (value[0] - m[2]))};
    add_level(p, k, u, v, scaled, gx * gy * sqrt(value[0] * shorter), k > level ? next : 1 - next,
              out);
  }
}

/* ---- moments to slopes --------------------------------------------------------------- */

void shade_moments_add(double sum[MOMENTS], double weight, double height, double x, double y) {
  sum[MOMENT_H] += weight * height;
  sum[MOMENT_X] += weight * x;
  sum[MOMENT_Y] += weight * y;
  sum[MOMENT_XX] += weight * x * x;
  sum[MOMENT_XY] += weight * x * y;
  sum[MOMENT_YY] += weight * y * y;
}

void shade_moments_flat(shade_slopes *s) {
  memset(s, 0, sizeof *s);
  s->normal[2] = 1;
}

void shade_moments_slopes(const double moments[MOMENTS], shade_slopes *s) {
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
