/* SPDX-License-Identifier: Apache-2.0 */
/* What a footprint holds of each yarn: a summed table of the repeat. In double alone. */
#ifndef SHADE_BATCH_COLUMN_H
#define SHADE_BATCH_COLUMN_H

#include "../model/fabric.h"
#include "vec.h"

LEAF double column_most(double a, double b) {
  return a > b ? a : b;
}
LEAF double column_least(double a, double b) {
  return a < b ? a : b;
}

#define STREAKS_FADE 12.0 /* yarns: from here on less, */
#define STREAKS_END 16.0  /* none beyond */

/*
 * The integral along one side of the table for each of some lanes, from end to end of its
 * footprint, as a sum of five entries: those on both sides of either end, and the last, for whole
 * repeats. `per` is 1 over the extent in blocks.
 */
typedef struct column_axis {
  int low[BLOCK], high[BLOCK]; /* the block where an end lies */
  double before_low[BLOCK], after_low[BLOCK], before_high[BLOCK], after_high[BLOCK];
  double repeats[BLOCK], per[BLOCK];
} column_axis;

static void column_along(size_t count, const int *restrict lane, const double *restrict centre,
                         const double *restrict extent, double size, int blocks,
                         column_axis *restrict x) {
  const double scale = blocks / size, most = blocks - 1;
#pragma omp simd
  for (size_t j = 0; j < count; j++) {
    /* below a hundredth of a crossing the difference of integrals would lose digits */
    const double given = extent[lane[j]], wide = scale * (given > 0.01 ? given : 0.01);
    const double u = centre[lane[j]] / size;
    const double low = (u - floor(u)) * blocks - 0.5 * wide, high = low + wide;
    const double first = floor(low / blocks), last = floor(high / blocks);
    /* both may be rounded up to blocks */
    const double a = low - first * blocks, b = high - last * blocks;
    const int i = (int)(a < most ? a : most), k = (int)(b < most ? b : most);
    x->low[j] = i;
    x->high[j] = k;
    x->before_low[j] = a - i - 1;
    x->after_low[j] = i - a;
    x->before_high[j] = 1 - (b - k);
    x->after_high[j] = b - k;
    x->repeats[j] = last - first;
    x->per[j] = 1 / wide;
  }
}

/* All columns over the footprint of lane j. */
LEAF void column_sum(int columns, const shade_fabric *f, const column_axis *x, const column_axis *y,
                     size_t j, double *restrict column) {
  const size_t line = (size_t)(f->columns + 1) * COLUMNS_STEP;
  const double *restrict t = f->table;
  const size_t a = (size_t)x->low[j] * COLUMNS_STEP, b = (size_t)x->high[j] * COLUMNS_STEP;
  const size_t end = (size_t)f->columns * COLUMNS_STEP;
  const double x0 = x->before_low[j], x1 = x->after_low[j], x2 = x->before_high[j];
  const double x3 = x->after_high[j], x4 = x->repeats[j], scale = x->per[j] * y->per[j];
  const double y0 = y->before_low[j], y1 = y->after_low[j], y2 = y->before_high[j];
  const double y3 = y->after_high[j], y4 = y->repeats[j];
  const double *low = t + (size_t)y->low[j] * line, *high = t + (size_t)y->high[j] * line;
  const double *top = t + (size_t)f->rows * line;
#define COLUMN_LINE(t)                                                                             \
  (x0 * (t)[a + k] + x1 * (t)[a + COLUMNS_STEP + k] + x2 * (t)[b + k] +                            \
   x3 * (t)[b + COLUMNS_STEP + k] + x4 * (t)[end + k])
#pragma omp simd
  for (size_t k = 0; k < (size_t)columns; k++) {
    const double sum = y0 * COLUMN_LINE(low) + y1 * COLUMN_LINE(low + line) +
                       y2 * COLUMN_LINE(high) + y3 * COLUMN_LINE(high + line) +
                       y4 * COLUMN_LINE(top);
    column[k] = sum > 0 ? scale * sum : 0;
  }
#undef COLUMN_LINE
}

/* So many repeats that where the footprint lies makes no difference. */
static int column_is_mean(const shade_fabric *f, double du, double dv) {
  return du > 64 * f->width && dv > 64 * f->height;
}

/* Whether single yarns are told apart in a footprint: column_yarns.h. */
static int column_has_streaks(const shade_fabric *f, double du, double dv) {
  const double longer = du > dv ? du : dv, shorter = du > dv ? dv : du;
  return f->uneven && longer > 0 && shorter < STREAKS_END;
}

/* What is seen of the yarns of one direction in a footprint: column_yarns.h. */
typedef struct column_yarns {
  double brightness, fill;
} column_yarns;

/* Lanes that are looked at together. */
enum { STREAK_LANES = 32 };
typedef struct column_group {
  size_t begin, count;                                     /* lanes of the axes */
  int any;                                                 /* has streaks */
  double centre[2][STREAK_LANES], extent[2][STREAK_LANES]; /* across the weft's yarns, the warp's */
  double brightness[2][STREAK_LANES], fill[2][STREAK_LANES]; /* found */
} column_group;

/*
 * What of weft, warp and gaps the footprints of a group show if their yarns fill a and b times what
 * they do everywhere, over what they show if they do not. Where a share p of the crossings has the
 * weft on top it covers A of those, and of the others what the warp leaves: A (p + (1 - p) (1 -
 * B)). seen: of weft and warp, without streaks.
 */
static void column_filled(const shade_fabric *f, const column_group *g,
                          const double (*seen)[STREAK_LANES], double (*factor)[STREAK_LANES]) {
  const double A = f->fills[0], B = f->fills[1];
  const double whole = 1 - 4e-6; /* by a sum in float: else a hidden yarn would have a share left */
  const int fills = A > 0 && B > 0;
#pragma omp simd
  for (size_t i = 0; i < g->count; i++) {
    const double more = g->fill[0][i], more2 = g->fill[1][i], all = seen[0][i] + seen[1][i];
    const int other = fills & (all > 0) & ((more != 1) | (more2 != 1));
    const double a = A * more < whole ? A * more : 1, b = B * more2 < whole ? B * more2 : 1;
    const double weft = seen[0][i] / all * (A + B - A * B); /* of the area */
    const double p = column_least(column_most((weft - A + A * B) / (A * B), 0), 1);
    const double most = column_most(1 / all, 1); /* a footprint within one yarn is filled already */
    const double of_weft = a * (1 - (1 - p) * b) / column_most(A * (1 - (1 - p) * B), 1e-6);
    const double of_warp = b * (1 - p * a) / column_most(B * (1 - p * A), 1e-6);
    const double of_gaps = (1 - a) * (1 - b) / column_most((1 - A) * (1 - B), 1e-6);
    factor[0][i] = other ? column_least(of_weft, most) : 1;
    factor[1][i] = other ? column_least(of_warp, most) : 1;
    factor[2][i] = other ? of_gaps : 1;
  }
}

/* Another lane of a group. */
static void column_group_add(const shade_fabric *f, column_group *g, double u, double v, double du,
                             double dv) {
  const double limit = 4e18; /* as look-ups have it */
  const size_t i = g->count++;
  const int any = column_has_streaks(f, du, dv);
  g->any |= any;
  g->centre[SHADE_TOP_WARP][i] = column_least(column_most(u, -limit), limit);
  g->centre[SHADE_TOP_WEFT][i] = column_least(column_most(v, -limit), limit);
  g->extent[SHADE_TOP_WARP][i] = any ? du : STREAKS_END;
  g->extent[SHADE_TOP_WEFT][i] = any ? dv : STREAKS_END;
}

/* How many are read of a fabric. */
static int column_count(const shade_fabric *f) {
  return f->transmits ? COLUMNS : f->alike ? COLUMNS_ALIKE : COLUMNS_OPAQUE;
}

LEAF void column_fill(int columns, const shade_fabric *f, const column_axis *x,
                      const column_axis *y, size_t begin, size_t count,
                      double (*restrict row)[COLUMNS_STEP]) {
  for (size_t j = 0; j < count; j++)
    column_sum(columns, f, x, y, begin + j, row[j]);
}

/* The means of those columns over the footprints of some lanes of the axes, without streaks: a row
 * each. */
static void column_rows(const shade_fabric *f, const column_axis *x, const column_axis *y,
                        size_t begin, size_t count, double (*restrict row)[COLUMNS_STEP]) {
  if (f->transmits) /* a constant count, so that it is a few vectors; the last two are 0 */
    column_fill(COLUMNS_STEP, f, x, y, begin, count, row);
  else if (f->alike)
    column_fill(COLUMNS_ALIKE, f, x, y, begin, count, row);
  else
    column_fill(COLUMNS_OPAQUE, f, x, y, begin, count, row);
}

#endif
