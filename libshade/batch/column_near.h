/* SPDX-License-Identifier: Apache-2.0 */
/* Streaks of lanes that lie side by side: after column_yarns.h, in float for both precisions. */
#ifndef SHADE_BATCH_COLUMN_NEAR_H
#define SHADE_BATCH_COLUMN_NEAR_H

#include "column_yarns.h"

/*
 * Samples of pixels side by side see much the same yarns in footprints of nearly one size. Where
 * along them a footprint lies changes what it sees of each yarn only slowly: that is found in rows
 * of places, some to a footprint, and interpolated between. Across the yarns each lane has its own
 * footprint; that is where streaks are sharp.
 */
enum { NEAR_ROWS = 29, NEAR_LINE = LATTICE_YARNSf + 2 * LATTICE_VECTORf };
_Static_assert((int)NEAR_ROWS <= (int)STREAK_LANES, "rows are the lanes of a group");
#define NEAR_PER 3.0   /* rows to a footprint */
#define NEAR_ALIKE 1.1 /* the longest extent over the shortest, */
#define NEAR_LEAST 0.7 /* and that in crossings: below, yarns are hidden and seen by turns */
#define NEAR_PLACES (0.5 - 0.5 / STREAK_PLACES) /* from the middle to the last of a footprint */

/* Where the footprints of some lanes lie, across the weft's yarns and the warp's. */
typedef struct column_box {
  double low[2], high[2], least[2], most[2]; /* of centres, of extents */
  size_t count;
} column_box;

/* The least and the most of some numbers, side by side at first: clang reduces no doubles so. */
static void column_range(size_t count, const double *restrict from, double *low, double *high) {
  enum { V = VECTOR_BYTES / sizeof(double) };
  double least[V], most[V];
  for (int v = 0; v < V; v++)
    least[v] = most[v] = from[0];
  size_t i = 0;
  for (; i + V <= count; i += V)
#pragma omp simd
    for (int v = 0; v < V; v++) {
      least[v] = minimum(from[i + (size_t)v], least[v]);
      most[v] = maximum(from[i + (size_t)v], most[v]);
    }
  for (; i < count; i++) {
    least[0] = minimum(from[i], least[0]);
    most[0] = maximum(from[i], most[0]);
  }
  *low = least[0];
  *high = most[0];
  for (int v = 1; v < V; v++) {
    *low = minimum(least[v], *low);
    *high = maximum(most[v], *high);
  }
}

static void column_box_of(const column_group *g, column_box *to) {
  to->count = g->count;
  for (int side = 0; side < 2; side++) {
    column_range(g->count, g->centre[side], &to->low[side], &to->high[side]);
    column_range(g->count, g->extent[side], &to->least[side], &to->most[side]);
  }
}

static column_box column_box_all(size_t count, const column_box *box) {
  column_box all = box[0];
  for (size_t k = 1; k < count; k++) {
    for (int side = 0; side < 2; side++) {
      all.low[side] = minimum(all.low[side], box[k].low[side]);
      all.high[side] = maximum(all.high[side], box[k].high[side]);
      all.least[side] = minimum(all.least[side], box[k].least[side]);
      all.most[side] = maximum(all.most[side], box[k].most[side]);
    }
    all.count += box[k].count;
  }
  return all;
}

/* The rows of one side. */
typedef struct column_near {
  double from, place, step; /* the first yarn; the first row's place along them, and to the next */
  double across, along;     /* extents */
  int yarns, rows;
} column_near;

/* False where lanes lie too far apart for rows to pay. */
static int column_near_of(const shade_fabric *f, const column_box *box, column_near near[2]) {
  enum { V = LATTICE_VECTORf };
  double saved = 0, spent = 0;
  for (int side = 0; side < 2; side++) {
    column_near *n = &near[side];
    const int beside = 1 - side;
    const double low = box->low[beside], high = box->high[beside], way = high - low;
    if (!(box->most[side] <= NEAR_ALIKE * box->least[side]) || box->least[side] < NEAR_LEAST)
      return 0;
    n->across = 0.5 * (box->least[side] + box->most[side]);
    n->along = 0.5 * (box->least[beside] + box->most[beside]);
    n->from = weave_floor(box->low[side] - 0.5 * box->most[side]);
    const double yarns = weave_floor(box->high[side] + 0.5 * box->most[side]) - n->from + 1;
    const double rows = weave_floor(way * NEAR_PER / n->along) + 2;
    const double per = f->weave->yarn[side].along_frequency, half = n->along * NEAR_PLACES;
    const int noisy = n->along * per < NOISE_END;
    const double knots = weave_floor((high + half) * per) - weave_floor((low - half) * per) + 2;
    if (!(yarns <= LATTICE_YARNSf) || !(rows <= NEAR_ROWS) || (noisy && !(knots <= LATTICE_KNOTSf)))
      return 0;
    n->yarns = (int)yarns;
    n->rows = (int)rows;
    n->place = low;
    n->step = way / (rows - 1);
    if (column_varies(f, side)) { /* vectors of yarns, those of a row cost more */
      spent += 1.5 * rows * ((n->yarns + V - 1) / V);
      saved += (double)box->count * ((int)(n->across + V) / V);
    }
  }
  return spent < saved;
}

/* What a row finds of each yarn. */
typedef struct column_table {
  int there, along, slubs; /* whether streaks are, noise along the yarns, noise of their width */
#define ROW [NEAR_ROWS][NEAR_LINE]
  float light ROW, filled ROW, parts ROW;
#undef ROW
} column_table;

/* False where there is no room for the noise after all. */
static __attribute__((noinline)) int column_table_fill(const shade_fabric *f, const column_near *n,
                                                       int side, column_table *to) {
  enum { V = LATTICE_VECTORf, CHUNK = 16 };
  const int weft = side == SHADE_TOP_WEFT, whole = (n->yarns + V - 1) / V * V;
  const column_kind kind = column_kind_of(f, side);
  const double size = weft ? f->height : f->width, first = n->from - floor(n->from / size) * size;
  column_streakf s;
  column_latticef l;
  column_axis beside;
  column_group g = {.count = (size_t)n->rows};
  int lane[NEAR_ROWS];
  for (int r = 0; r < n->rows; r++) {
    lane[r] = r;
    g.centre[side][r] = n->from;
    g.centre[1 - side][r] = n->place + n->step * r;
    g.extent[side][r] = n->across;
    g.extent[1 - side][r] = n->along;
  }
  column_along(g.count, lane, g.centre[1 - side], g.extent[1 - side], weft ? f->width : f->height,
               weft ? f->columns : f->rows, &beside);
  column_streak_setf(f, side, &g, &s);
  to->there = s.count[0] > 0;
  to->along = s.along[0] && (kind.slub > 0 || kind.brighter);
  to->slubs = to->along && kind.slub > 0;
  if (!to->there)
    return 1;
  for (int r = 0; r < n->rows; r++) { /* all yarns, whole */
    s.number[r] = weave_low_bits(n->from);
    s.count[r] = n->yarns;
    s.low[r] = 0;
    s.high[r] = (float)n->yarns;
  }
  if (!column_fitsf(&s, g.count, &l))
    return 0;
  column_lattice_fillf(&kind, s.number[0], s.knot[0], &l);
  for (int r = 0; r < n->rows; r++) {
    float shown[NEAR_LINE + CHUNK];
    int yarn = (int)(first > 0 ? first < size - 1 ? first : size - 1 : 0);
    for (int c = 0; c < whole; c += CHUNK, yarn = (yarn + CHUNK) % (int)size)
      column_shownf(f, side, (size_t)yarn, CHUNK, &beside, (size_t)r, shown + c);
    const int row = to->along ? (int)(s.knot[r] - s.knot[0]) - l.knot : 0;
    column_lane_off(&kind, &l, &s, (size_t)r, 0, row, to->along, 1, shown, to->light[r],
                    to->filled[r], to->parts[r]);
    for (int v = whole; v < whole + V; v++) /* read, and of no weight */
      to->light[r][v] = to->filled[r][v] = to->parts[r][v] = 0;
  }
  return 1;
}

/* From rows r and r + 1, `share` of the latter, the yarns from `yarn` on between low and high. */
LEAF void column_between(const column_table *t, int r, float share, int yarn, int count, float low,
                         float high, int slubs, float *restrict light, float *restrict filled,
                         float *restrict parts) {
  enum { V = LATTICE_VECTORf };
  const float rest = 1 - share;
#define ROW(name) *restrict name##0 = t->name[r] + yarn, *restrict name##1 = t->name[r + 1] + yarn
  const float ROW(light), ROW(filled), ROW(parts);
#undef ROW
  for (int c = 0; c < count; c += V) {
    const float from = (float)c;
#pragma omp simd
    for (int v = 0; v < V; v++) {
      const int j = c + v;
      const float at = from + (float)v;
      const float begin = column_mostf(at, low), end = column_leastf(at + 1, high);
      const float part = column_mostf(end - begin, 0);
      parts[v] = (c ? parts[v] : 0) + part * (rest * parts0[j] + share * parts1[j]);
      light[v] = (c ? light[v] : 0) + part * (rest * light0[j] + share * light1[j]);
      if (slubs)
        filled[v] = (c ? filled[v] : 0) + part * (rest * filled0[j] + share * filled1[j]);
    }
  }
}

static void column_look_rows(const column_near *n, int side, const column_table *t,
                             column_group *g) {
  int yarn[STREAK_LANES], count[STREAK_LANES], row[STREAK_LANES];
  float low[STREAK_LANES], high[STREAK_LANES], share[STREAK_LANES];
  double per_place[STREAK_LANES];
  const float places = t->along ? STREAK_PLACES : 1;
  const double *across = g->extent[side], *centre = g->centre[side], *place = g->centre[1 - side];
  const double from = n->from, first = n->place, per = n->step > 1e-9 ? 1 / n->step : 0;
  const int yarns = n->yarns, last = n->rows - 2;
#pragma omp simd
  for (size_t i = 0; i < g->count; i++) {
    const double begin = centre[i] - 0.5 * across[i], end = begin + across[i];
    const double whole = weave_floor(begin), p = (place[i] - first) * per;
    const int at = (int)(whole - from), own = at > 0 ? at < yarns ? at : yarns - 1 : 0;
    const int all = (int)(weave_floor(end) - whole) + 1, left = yarns - own;
    const int r = (int)p < last ? (int)p : last;
    yarn[i] = own;
    count[i] = all < left ? all : left;
    low[i] = (float)(begin - whole);
    high[i] = (float)(end - whole);
    row[i] = r;
    share[i] = (float)(p - r);
    per_place[i] = 1 / (double)places;
  }
  column_sumsf sums;
  float *restrict filled = sums.filled[0], *restrict parts = sums.parts[0];
  for (size_t i = 0; i < g->count; i++)
    if (t->slubs)
      column_between(t, row[i], share[i], yarn[i], count[i], low[i], high[i], 1, sums.light[i],
                     sums.filled[i], sums.parts[i]);
    else
      column_between(t, row[i], share[i], yarn[i], count[i], low[i], high[i], 0, sums.light[i],
                     sums.filled[i], sums.parts[i]);
  column_foldf(g->count, sums.light[0]);
  column_foldf(g->count, parts);
  if (t->slubs)
    column_foldf(g->count, filled);
  for (size_t i = 0; i < g->count && !t->slubs; i++)
    filled[i] = parts[i] * places;
  column_settlef(&sums, per_place, side, g);
}

/* False, and nothing is done, where the lanes of these groups lie too far apart. */
static __attribute__((noinline)) int column_look_near(const shade_fabric *f, size_t count,
                                                      const column_box *box, column_group *groups) {
  const column_box all = column_box_all(count, box);
  column_near near[2];
  column_table table;
  if (!column_near_of(f, &all, near))
    return 0;
  for (int side = 0; side < 2; side++) {
    table.there = 0;
    if (column_varies(f, side) && !column_table_fill(f, &near[side], side, &table))
      return 0;
    for (size_t k = 0; k < count; k++) {
      column_group *g = &groups[k];
      for (size_t i = 0; i < g->count && !table.there; i++)
        g->brightness[side][i] = g->fill[side][i] = 1;
      if (table.there)
        column_look_rows(&near[side], side, &table, g);
    }
  }
  return 1;
}

/* The yarns of groups one after the other whose lanes lie side by side, or may: of as many at once
 * as do. narrow: in float, where they do not. */
static void column_look_groups(const shade_fabric *f, const column_axis *x, const column_axis *y,
                               int narrow, size_t count, column_group *groups) {
  column_box box[BLOCK / STREAK_LANES];
  for (size_t k = 0; k < count; k++)
    column_box_of(&groups[k], &box[k]);
  for (size_t k = 0, some; k < count; k += some) {
    /* samples come by pixels in Z-order: halves of what is too wide are squares */
    for (some = k ? k & (~k + 1) : BLOCK / STREAK_LANES; some > 0; some /= 2)
      if (column_look_near(f, some < count - k ? some : count - k, box + k, groups + k))
        break;
    if (!some && groups[k].any)
      column_look_group(f, x, y, narrow, &groups[k]);
    some += !some;
  }
}

/* The yarns of all groups; neighbours: whether lanes may lie side by side. */
static void entry_streaks(const shade_fabric *f, const column_axis *x, const column_axis *y,
                          int narrow, int neighbours, size_t count, column_group *groups) {
  if (neighbours)
    column_look_groups(f, x, y, narrow, count, groups);
  for (size_t k = 0; k < count && !neighbours; k++)
    if (groups[k].any)
      column_look_group(f, x, y, narrow, &groups[k]);
}

#endif
