/* SPDX-License-Identifier: Apache-2.0 */
/* What a footprint holds of each yarn: a summed table of the repeat. In double alone. */
#ifndef CLOTH_COLUMN_H
#define CLOTH_COLUMN_H

/* of pass_weave.h, in double */
static unsigned kernel_weave_batch(const shade_weave *w, size_t total, const double *u,
                                   const double *v, const shade_crossings *out);

LEAF void column_corner(int columns, const double *restrict low, const double *restrict high,
                        const double *restrict right, const double *restrict top,
                        const double *restrict all, size_t line, double a, double b, double ox,
                        double oy, double scale, double *restrict sum) {
#pragma omp simd
  for (int k = 0; k < columns; k++) {
    double corner = (1 - b) * ((1 - a) * low[k] + a * low[COLUMNS + k]) +
                    b * ((1 - a) * high[k] + a * high[COLUMNS + k]);
    double across = (1 - b) * right[k] + b * right[line + (size_t)k];
    double up = (1 - a) * top[k] + a * top[COLUMNS + k];
    sum[k] += scale * (corner + ox * across + oy * up + ox * oy * all[k]);
  }
}

/* The integral of all columns of the table over [0, x] x [0, y], x and y in blocks of the repeat.
 */
static void column_integral(const shade_fabric *f, double x, double y, double scale, double *sum) {
  const double ox = floor(x / f->columns), oy = floor(y / f->rows);
  /* integral = whole repeats above and beside, and what is left */
  const double left[2] = {x - ox * f->columns, y - oy * f->rows};
  const int i = (int)fmin(left[0], f->columns - 1), j = (int)fmin(left[1], f->rows - 1);
  const double a = left[0] - i, b = left[1] - j;
  const double *t = f->table;
  const size_t line = (size_t)(f->columns + 1) * COLUMNS;
  const double *low = t + (size_t)j * line + (size_t)i * COLUMNS, *high = low + line;
  const double *right = t + (size_t)j * line + (size_t)f->columns * COLUMNS;
  const double *top = t + (size_t)f->rows * line + (size_t)i * COLUMNS;
  const double *all = t + (size_t)f->rows * line + (size_t)f->columns * COLUMNS;
  /* a constant count, so that it is a few vectors */
  if (f->transmits)
    column_corner(COLUMNS, low, high, right, top, all, line, a, b, ox, oy, scale, sum);
  else
    column_corner(COLUMNS_OPAQUE, low, high, right, top, all, line, a, b, ox, oy, scale, sum);
}

/* So many repeats that where the footprint lies makes no difference. */
static int column_is_mean(const shade_fabric *f, const double extent[2]) {
  return extent[0] > 64 * f->width && extent[1] > 64 * f->height;
}

/* The mean of all columns over the footprint. */
static void column_mean(const shade_fabric *f, const double uv[2], const double extent[2],
                        double *column) {
  /* below a hundredth of a crossing the difference of integrals would lose digits */
  const double du = fmax(extent[0], 0.01) * f->columns / f->width;
  const double dv = fmax(extent[1], 0.01) * f->rows / f->height;
  memcpy(column, f->mean, sizeof f->mean);
  if (column_is_mean(f, extent))
    return;
  const double u = uv[0] / f->width, v = uv[1] / f->height;
  const double x = (u - floor(u)) * f->columns - 0.5 * du;
  const double y = (v - floor(v)) * f->rows - 0.5 * dv;
  const double scale = 1 / (du * dv);
  double sum[COLUMNS] = {0};
  column_integral(f, x + du, y + dv, scale, sum);
  column_integral(f, x, y + dv, -scale, sum);
  column_integral(f, x + du, y, -scale, sum);
  column_integral(f, x, y, scale, sum);
  for (int k = 0; k < COLUMNS; k++)
    column[k] = fmax(sum[k], 0);
}

/*
 * Yarns that are brighter or darker than others show as streaks long after the weave is too
 * fine to see: their mean over the footprint, from 16 points of it. From 8 to 16 crossings it
 * fades out; what is left of the streaks there is small.
 */
static void column_streaks(const shade_fabric *f, const double uv[2], const double extent[2],
                           double longer, double *column) {
  double sum[2] = {0, 0}, u[FABRIC_POINTS], v[FABRIC_POINTS], brightness[FABRIC_POINTS];
  int count[2] = {0, 0}, top[FABRIC_POINTS];
  for (int k = 0; k < FABRIC_POINTS; k++) {
    u[k] = uv[0] + extent[0] * ((k % 4 + 0.5) / 4 - 0.5);
    v[k] = uv[1] + extent[1] * ((k / 4 + 0.5) / 4 - 0.5);
  }
  const shade_crossings out = {.size = sizeof out, .top = top, .brightness = brightness};
  kernel_weave_batch(f->weave, FABRIC_POINTS, u, v, &out);
  for (int k = 0; k < FABRIC_POINTS; k++)
    if (top[k] != SHADE_TOP_GAP) {
      sum[top[k]] += brightness[k];
      count[top[k]]++;
    }
  const double x = fmin(fmax(log2(longer / 8), 0), 1), share = 1 - x * x * (3 - 2 * x);
  for (int k = 0; k < 2; k++) {
    double *matt = column + COLUMN_MATT + 3 * k;
    double factor = count[k] ? 1 + share * (sum[k] / count[k] - 1) : 1;
    for (int c = 0; c < 3; c++) {
      matt[c] *= factor;
      column[COLUMN_PASS + 3 * k + c] *= factor;
    }
  }
}

/* The mean of all columns over a footprint, streaks of uneven yarns included. */
static void column_of(const shade_fabric *f, const double uv[2], const double extent[2],
                      double column[COLUMNS]) {
  const double longer = fmax(extent[0], extent[1]);
  column_mean(f, uv, extent, column);
  if (f->uneven && longer > 0 && longer < 16)
    column_streaks(f, uv, extent, longer, column);
}

#endif
