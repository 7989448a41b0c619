/* SPDX-License-Identifier: Apache-2.0 */
/* Bins over the tile of a field of scratches: lists of the pits over each. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "src/scratch.h"

#define PI 3.14159265358979323846

/*
 * Sides of a bin. A smaller one holds fewer pits that miss the point, but then long pits fill
 * many. Over a bin w wide and h high lie, on average,
 *
 *   sum of (area + 2 (w Y + h X) + w h) / aspect
 *
 * pits that reach X and Y to either side: for a given area w h they are fewest at w/h = sum X/sum
 * Y. So the bins lie along the scratches, and are so large that one holds twice the pits that cover
 * a point, and one more.
 */
static void bin_sides(const shade_scratch_field *f, double *width, double *height) {
  const double most_bins = 4e6, most_listed = 16e6 + 16 * (double)f->pits;
  double covering = 0, x = 0, y = 0;
  for (size_t i = 0; i < f->pits; i++) {
    const pit *p = &f->pit[i];
    covering += PI * p->half_along * p->half_across / f->aspect;
    x += p->reach[0];
    y += p->reach[1];
  }
  *width = fmin(1, f->aspect);
  *height = *width;
  if (f->pits == 0)
    return;
  /* n g^2 + 4 sqrt(x y) g = (covering + 1) aspect, g^2 the area of a bin */
  const double n = (double)f->pits, across = sqrt(x * y), spare = 1.3 * (covering + 1) * f->aspect;
  double g = spare / (2 * across + sqrt(4 * across * across + n * spare));
  for (;; g *= 1.4142135623730951) {
    const double bins = f->aspect / (g * g);
    const double listed = covering + (4 * across * g + n * g * g) / f->aspect;
    if (bins <= most_bins && bins * listed <= most_listed)
      break;
    if (g > 1 && g > f->aspect)
      break;
  }
  *width = fmin(g * sqrt(x / y), 1);
  *height = fmin(g * sqrt(y / x), f->aspect);
}

static int wrap(int i, int n) {
  i %= n;
  return i < 0 ? i + n : i;
}

static double within(double x, double low, double high) {
  x = x > low ? x : low;
  return x < high ? x : high;
}

static int floor_int(double x) { /* to call floor() takes as long as the rest of a row */
  const int i = (int)x;
  return i - (x < i);
}

/* Of a pit in a row of bins: the first, and the last as if the row went on past the seam. */
typedef struct stretch {
  int begin, end;
} stretch;

/* The rows of bins that pits reach, as if they went on past the seam. */
typedef struct pit_rows {
  int first, last;
} pit_rows;

static pit_rows rows_of(const shade_scratch_field *f, const pit *p) {
  const double margin = 1e-9; /* of a bin, against rounding */
  const double rows = f->up / f->aspect;
  return (pit_rows){floor_int((p->y - p->reach[1]) * rows - margin),
                    floor_int((p->y + p->reach[1]) * rows + margin)};
}

/* A pit's bins, row by row. Returns what is after the last of them. */
static stretch *find(const shade_scratch_field *f, const pit *p, pit_rows rows, stretch *to) {
  const double c = p->along[0], s = p->along[1];
  const double a2 = 1 / (p->half_along * p->half_along), b2 = 1 / (p->half_across * p->half_across);
  /* A x^2 + 2 B x y + C y^2 <= 1 */
  const double A = c * c * a2 + s * s * b2, B = c * s * (a2 - b2), C = s * s * a2 + c * c * b2;
  const double det = a2 * b2, reach = p->reach[1], y_right = -B * sqrt(1 / (C * det));
  const double lean = -B / A, half = 1 / A, bend = det / (A * A);
  const double height = f->aspect / f->up;
  const double margin = 1e-9;
  for (int row = rows.first; row <= rows.last; row++) {
    const double y0 = within((row - margin) * height - p->y, -reach, reach);
    const double y1 = within((row + 1 + margin) * height - p->y, -reach, reach);
    /* the right edge bulges most at y_right, the left one at -y_right */
    const double right = within(y_right, y0, y1), left = within(-y_right, y0, y1);
    const double right2 = half - bend * right * right, left2 = half - bend * left * left;
    const double x1 = lean * right + sqrt(right2 > 0 ? right2 : 0);
    const double x0 = lean * left - sqrt(left2 > 0 ? left2 : 0);
    const int begin = floor_int((p->x + x0) * f->across - margin);
    const int end = floor_int((p->x + x1) * f->across + margin);
    const int from = wrap(begin, f->across), most = f->across - 1;
    *to++ = (stretch){from, from + (end - begin < most ? end - begin : most)};
  }
  return to;
}

/*
 * start[bin + 1]: where the bin's list begins. start[bin + 2] is first by how much the bin's count
 * exceeds that of the bin before. Returns how many are listed.
 */
static size_t count_listed(shade_scratch_field *f, const pit_rows *rows, const stretch *at) {
  const int across = f->across;
  for (size_t i = 0; i < f->pits; i++)
    for (int row = rows[i].first; row <= rows[i].last; row++, at++) {
      uint32_t *bin = f->start + 2 + (size_t)wrap(row, f->up) * (size_t)across;
      bin[at->begin]++;
      if (at->end >= across) {
        bin[across]--;
        bin[0]++;
        bin[at->end + 1 - across]--;
      } else {
        bin[at->end + 1]--;
      }
    }
  uint32_t here = 0, total = 0;
  for (size_t bin = 0; bin < (size_t)across * (size_t)f->up; bin++) {
    here += f->start[bin + 2];
    f->start[bin + 1] = total;
    total += here;
  }
  return total;
}

/* The deepest pits come first; start[bin + 1] moves to where the next list begins. */
static void list_pits(shade_scratch_field *f, const pit_rows *rows, const stretch *at) {
  const int across = f->across;
  for (size_t i = 0; i < f->pits; i++)
    for (int row = rows[i].first; row <= rows[i].last; row++, at++) {
      uint32_t *end = f->start + 1 + (size_t)wrap(row, f->up) * (size_t)across;
      const int seam = at->end < across ? at->end : across - 1;
      for (int column = at->begin; column <= seam; column++)
        f->list[end[column]++] = (uint32_t)i;
      for (int column = across; column <= at->end; column++)
        f->list[end[column - across]++] = (uint32_t)i;
    }
}

int shade_scratch_fill_bins(shade_scratch_field *f) {
  double width, height;
  bin_sides(f, &width, &height);
  f->across = (int)fmin(fmax(floor(1 / width), 1), 1e6);
  f->up = (int)fmin(fmax(floor(f->aspect / height), 1), 1e6);
  const size_t bins = (size_t)f->across * (size_t)f->up;
  pit_rows *rows = malloc((f->pits + 1) * sizeof *rows);
  size_t count = 0;
  for (size_t i = 0; rows && i < f->pits; i++) {
    rows[i] = f->pit[i].k2 > 0 ? rows_of(f, &f->pit[i]) : (pit_rows){0, -1};
    count += (size_t)(rows[i].last - rows[i].first + 1);
  }
  stretch *all = malloc((count + 1) * sizeof *all), *to = all;
  f->start = calloc(bins + 3, sizeof *f->start);
  int status = rows && all && f->start ? 0 : -1;
  for (size_t i = 0; status == 0 && i < f->pits; i++)
    if (rows[i].last >= rows[i].first)
      to = find(f, &f->pit[i], rows[i], to);
  if (status == 0) {
    f->list = malloc((count_listed(f, rows, all) + 1) * sizeof *f->list);
    status = f->list ? 0 : -1;
  }
  if (status == 0)
    list_pits(f, rows, all);
  free(rows);
  free(all);
  return status;
}
