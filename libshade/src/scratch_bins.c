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
    const double c = p->along[0], s = p->along[1];
    covering += PI * p->half_along * p->half_across / f->aspect;
    x += hypot(p->half_along * c, p->half_across * s);
    y += hypot(p->half_along * s, p->half_across * c);
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

/*
 * Visit the bins under a pit's ellipse, row by row of bins. Without a list count[bin + 1]
 * grows by one each; with a list the pit is put at list[count[bin]++].
 */
static void visit(const shade_scratch_field *f, uint32_t index, uint32_t *count, uint32_t *list) {
  const pit *p = &f->pit[index];
  const double c = p->along[0], s = p->along[1];
  const double a2 = 1 / (p->half_along * p->half_along), b2 = 1 / (p->half_across * p->half_across);
  /* A x^2 + 2 B x y + C y^2 <= 1 */
  const double A = c * c * a2 + s * s * b2, B = c * s * (a2 - b2), C = s * s * a2 + c * c * b2;
  const double det = a2 * b2, reach = sqrt(A / det), y_right = -B * sqrt(1 / (C * det));
  const double lean = -B / A, half = 1 / A, bend = det / (A * A);
  const double width = 1.0 / f->across, height = f->aspect / f->up;
  const double margin = 1e-9; /* of a bin, against rounding */
  const int first = (int)floor((p->y - reach) / height - margin);
  const int last = (int)floor((p->y + reach) / height + margin);
  int to = wrap(first, f->up);
  for (int row = first; row <= last; row++, to = to + 1 < f->up ? to + 1 : 0) {
    const double y0 = within((row - margin) * height - p->y, -reach, reach);
    const double y1 = within((row + 1 + margin) * height - p->y, -reach, reach);
    /* the right edge bulges most at y_right, the left one at -y_right */
    const double right = within(y_right, y0, y1), left = within(-y_right, y0, y1);
    const double right2 = half - bend * right * right, left2 = half - bend * left * left;
    const double x1 = lean * right + sqrt(right2 > 0 ? right2 : 0);
    const double x0 = lean * left - sqrt(left2 > 0 ? left2 : 0);
    const int begin = (int)floor((p->x + x0) / width - margin);
    int end = (int)floor((p->x + x1) / width + margin);
    if (end - begin >= f->across)
      end = begin + f->across - 1;
    size_t bin = (size_t)to * (size_t)f->across + (size_t)wrap(begin, f->across);
    const size_t past = ((size_t)to + 1) * (size_t)f->across;
    for (int column = begin; column <= end; column++) {
      if (list)
        list[count[bin]++] = index;
      else
        count[bin + 1]++;
      bin = bin + 1 < past ? bin + 1 : past - (size_t)f->across;
    }
  }
}

int scratch_fill_bins(shade_scratch_field *f) {
  double width, height;
  bin_sides(f, &width, &height);
  f->across = (int)fmin(fmax(floor(1 / width), 1), 1e6);
  f->up = (int)fmin(fmax(floor(f->aspect / height), 1), 1e6);
  const size_t bins = (size_t)f->across * (size_t)f->up;
  f->start = calloc(bins + 2, sizeof *f->start);
  if (!f->start)
    return -1;
  /* counted one place on, so that filling moves start[bin + 1] to where bin + 1 begins */
  for (size_t i = 0; i < f->pits; i++)
    if (f->pit[i].k2 > 0)
      visit(f, (uint32_t)i, f->start + 1, NULL);
  for (size_t i = 0; i <= bins; i++)
    f->start[i + 1] += f->start[i];
  const size_t total = f->start[bins + 1];
  f->list = malloc((total + 1) * sizeof *f->list);
  if (!f->list)
    return -1;
  for (size_t i = 0; i < f->pits; i++)
    if (f->pit[i].k2 > 0)
      visit(f, (uint32_t)i, f->start + 1, f->list);
  return 0;
}
