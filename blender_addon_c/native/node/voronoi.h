/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Points, one at random in each cell of a lattice, and what is near them [Worley1996], as Cycles
 * has it: `dimensions`; `at`, four operands; `feature` and `metric`, words of their tables;
 * `exponent` of Minkowski's metric, `smoothness` and `randomness`, an operand each; `whole`: cells
 * draw by whole numbers, as from Blender 5.0 on. Writes `out`, four: the distance and the cell's
 * colour; and `point`, four: where the point is, in the coordinates of `at`.
 */
#ifndef LIBSHADE_NODE_VORONOI_H
#define LIBSHADE_NODE_VORONOI_H

#include "node/common.h"
#include "node/hash.h"
#include "node/math.h"

#define VORONOI_FEATURES(ROW)                                                                      \
  ROW(F1) ROW(F2) ROW(SMOOTH_F1) ROW(DISTANCE_TO_EDGE) ROW(N_SPHERE_RADIUS)
#define VORONOI_METRICS(ROW)                                                                       \
  ROW(EUCLIDEAN, sqrtf(x *x + y * y + z * z + w * w))                                              \
  ROW(MANHATTAN, x + y + z + w)                                                                    \
  ROW(CHEBYCHEV, greatest(greatest(x, y), greatest(z, w)))                                         \
  ROW(MINKOWSKI, power(power(x, e) + power(y, e) + power(z, e) + power(w, e), quotient(1.0f, e)))

#define VORONOI_FEATURE(WORD) VORONOI_##WORD,
#define VORONOI_FEATURE_WORD(WORD) #WORD,
#define VORONOI_METRIC(WORD, formula) VORONOI_##WORD,
#define VORONOI_METRIC_WORD(WORD, formula) #WORD,
enum { VORONOI_FEATURES(VORONOI_FEATURE) };
enum { VORONOI_METRICS(VORONOI_METRIC) };

typedef struct node_voronoi {
  int dimensions, feature, metric, out[8];
  bool whole;
  operand at[LATTICE_DIMENSIONS], exponent, smoothness, randomness;
} node_voronoi;

static inline bool node_voronoi_read(reader *r, node_voronoi *n, graph *g) {
  static const char *const features[] = {VORONOI_FEATURES(VORONOI_FEATURE_WORD) NULL};
  static const char *const metrics[] = {VORONOI_METRICS(VORONOI_METRIC_WORD) NULL};
  return reader_integer(r, "dimensions", 1, LATTICE_DIMENSIONS, &n->dimensions) &&
         reader_word(r, "feature", features, &n->feature) &&
         reader_word(r, "metric", metrics, &n->metric) && reader_flag(r, "whole", &n->whole) &&
         graph_operands(r, g, "at", LATTICE_DIMENSIONS, n->at) &&
         graph_operands(r, g, "exponent", 1, &n->exponent) &&
         graph_operands(r, g, "smoothness", 1, &n->smoothness) &&
         graph_operands(r, g, "randomness", 1, &n->randomness) &&
         graph_outputs(r, g, "out", 8, n->out);
}

LEAF float greatest(float a, float b) {
  return a > b ? a : b;
}

/* What lanes have of their own: a cell and where in it, a neighbour's point and how far it is, and
 * what has been found. Beyond the dimensions all is 0. */
typedef float voronoi_lane[LATTICE_LANES];
typedef struct voronoi_lanes {
  voronoi_lane cell[LATTICE_DIMENSIONS], in[LATTICE_DIMENSIONS], point[LATTICE_DIMENSIONS];
  voronoi_lane about[LATTICE_DIMENSIONS]; /* the cell whose neighbours are gone through */
  voronoi_lane distance, color[3], exponent, randomness, smoothness;
  voronoi_lane best, best_at[LATTICE_DIMENSIONS], best_cell[LATTICE_DIMENSIONS];
  voronoi_lane next, next_at[LATTICE_DIMENSIONS], next_cell[LATTICE_DIMENSIONS];
  voronoi_lane mixed[3];
} voronoi_lanes;

#define VORONOI_POINT(dimensions, function)                                                        \
  {                                                                                                \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      float x = l->about[0][i] + off[0], y = l->about[1][i] + off[1];                              \
      float z = l->about[2][i] + off[2], w = l->about[3][i] + off[3], by = l->randomness[i];       \
      vec4 c = function(dimensions, (vec4){l->cell[0][i] + x, l->cell[1][i] + y,                   \
                                           l->cell[2][i] + z, l->cell[3][i] + w});                 \
      l->point[0][i] = x + c.x * by;                                                               \
      l->point[1][i] = y + c.y * by;                                                               \
      l->point[2][i] = z + c.z * by;                                                               \
      l->point[3][i] = w + c.w * by;                                                               \
    }                                                                                              \
  }
#define VORONOI_POINTS(dimensions)                                                                 \
  case dimensions:                                                                                 \
    if (n->whole && dimensions > 1)                                                                \
      VORONOI_POINT(dimensions, cell_chances)                                                      \
    else                                                                                           \
      VORONOI_POINT(dimensions, chances)                                                           \
    break;

/* A neighbour's points. */
LEAF void voronoi_points(const node_voronoi *n, voronoi_lanes *l, size_t count,
                         const float off[LATTICE_DIMENSIONS]) {
  switch (n->dimensions) {
    VORONOI_POINTS(1)
    VORONOI_POINTS(2)
    VORONOI_POINTS(3)
    VORONOI_POINTS(4)
  }
}

#define VORONOI_COLOR(dimensions, function)                                                        \
  {                                                                                                \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      vec3 c =                                                                                     \
          function(dimensions, (vec4){l->cell[0][i] + cell[0][i], l->cell[1][i] + cell[1][i],      \
                                      l->cell[2][i] + cell[2][i], l->cell[3][i] + cell[3][i]});    \
      l->color[0][i] = c.x;                                                                        \
      l->color[1][i] = c.y;                                                                        \
      l->color[2][i] = c.z;                                                                        \
    }                                                                                              \
  }
#define VORONOI_COLORS(dimensions)                                                                 \
  case dimensions:                                                                                 \
    if (n->whole && dimensions > 1)                                                                \
      VORONOI_COLOR(dimensions, cell_chances3)                                                     \
    else                                                                                           \
      VORONOI_COLOR(dimensions, chances3)                                                          \
    break;

/* The colours of cells. */
LEAF void voronoi_colors_at(const node_voronoi *n, voronoi_lanes *l, size_t count,
                            const voronoi_lane cell[LATTICE_DIMENSIONS]) {
  switch (n->dimensions) {
    VORONOI_COLORS(1)
    VORONOI_COLORS(2)
    VORONOI_COLORS(3)
    VORONOI_COLORS(4)
  }
}
/* Of the same neighbour of all. */
LEAF void voronoi_colors(const node_voronoi *n, voronoi_lanes *l, size_t count,
                         const float off[LATTICE_DIMENSIONS]) {
  for (int d = 0; d < LATTICE_DIMENSIONS; d++)
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      l->next_cell[d][i] = off[d];
  voronoi_colors_at(n, l, count, l->next_cell);
}

#define VORONOI_MEASURE(WORD, formula)                                                             \
  case VORONOI_##WORD:                                                                             \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      float x = fabsf(l->point[0][i] - l->in[0][i]), y = fabsf(l->point[1][i] - l->in[1][i]);      \
      float z = fabsf(l->point[2][i] - l->in[2][i]), w = fabsf(l->point[3][i] - l->in[3][i]);      \
      float e = l->exponent[i];                                                                    \
      (void)e;                                                                                     \
      l->distance[i] = formula;                                                                    \
    }                                                                                              \
    break;

LEAF void voronoi_measure(voronoi_lanes *l, size_t count, int metric) {
  switch (metric) { VORONOI_METRICS(VORONOI_MEASURE) }
}

/* Keep the nearest point and the next. */
LEAF void voronoi_keep(voronoi_lanes *l, size_t count, const float off[LATTICE_DIMENSIONS]) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    bool first = l->distance[i] < l->best[i], second = !first & (l->distance[i] < l->next[i]);
    for (int d = 0; d < LATTICE_DIMENSIONS; d++) {
      float cell = l->about[d][i] + off[d];
      l->next_at[d][i] = first ? l->best_at[d][i] : (second ? l->point[d][i] : l->next_at[d][i]);
      l->next_cell[d][i] = first ? l->best_cell[d][i] : (second ? cell : l->next_cell[d][i]);
      l->best_at[d][i] = first ? l->point[d][i] : l->best_at[d][i];
      l->best_cell[d][i] = first ? cell : l->best_cell[d][i];
    }
    l->next[i] = first ? l->best[i] : (second ? l->distance[i] : l->next[i]);
    l->best[i] = first ? l->distance[i] : l->best[i];
  }
}

/* Mix the points' distances, colours and places, nearer ones more. */
LEAF void voronoi_blend(voronoi_lanes *l, size_t count, bool begins) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float smooth = l->smoothness[i];
    float h = clampf(0.5f + 0.5f * (l->best[i] - l->distance[i]) / smooth, 0.0f, 1.0f);
    h = begins ? 1.0f : h * h * (3.0f - 2.0f * h);
    float less = smooth * h * (1.0f - h), all = less / (1.0f + 3.0f * smooth);
    l->best[i] = lerp(l->best[i], l->distance[i], h) - less;
    for (int c = 0; c < 3; c++)
      l->mixed[c][i] = lerp(l->mixed[c][i], l->color[c][i], h) - all;
    for (int d = 0; d < LATTICE_DIMENSIONS; d++)
      l->best_at[d][i] = lerp(l->best_at[d][i], l->point[d][i], h) - all;
  }
}

/* The planes halfway between the nearest point and the others: keep the nearest. */
LEAF void voronoi_edge(voronoi_lanes *l, size_t count) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float apart = 0.0f, along = 0.0f;
    for (int d = 0; d < LATTICE_DIMENSIONS; d++) {
      float across = l->point[d][i] - l->best_at[d][i];
      apart += across * across;
      along += (0.5f * (l->point[d][i] + l->best_at[d][i]) - l->in[d][i]) * across;
    }
    float far = apart > 1e-4f ? along / sqrtf(apart > 1e-4f ? apart : 1.0f) : 8.0f;
    l->next[i] = far < l->next[i] ? far : l->next[i];
  }
}

enum { VORONOI_NEAREST, VORONOI_BLENDED, VORONOI_EDGES, VORONOI_OTHERS };

/* Through the neighbours up to `reach` cells away, x first: the nearest are kept, or all mixed, or
 * their edges, or what is nearest to the point that was, but itself. */
LEAF void voronoi_round(const node_voronoi *n, voronoi_lanes *l, size_t count, int metric,
                        int what) {
  int reach[LATTICE_DIMENSIONS] = {0}, k[LATTICE_DIMENSIONS];
  for (int d = 0; d < n->dimensions; d++)
    reach[d] = what == VORONOI_BLENDED ? 2 : 1;
  bool begins = true;
  for (k[3] = -reach[3]; k[3] <= reach[3]; k[3]++)
    for (k[2] = -reach[2]; k[2] <= reach[2]; k[2]++)
      for (k[1] = -reach[1]; k[1] <= reach[1]; k[1]++)
        for (k[0] = -reach[0]; k[0] <= reach[0]; k[0]++) {
          const float off[] = {(float)k[0], (float)k[1], (float)k[2], (float)k[3]};
          if (what == VORONOI_OTHERS && !(k[0] | k[1] | k[2] | k[3]))
            continue;
          voronoi_points(n, l, count, off);
          if (what == VORONOI_EDGES) {
            voronoi_edge(l, count);
            continue;
          }
          voronoi_measure(l, count, metric);
          if (what == VORONOI_BLENDED) {
            voronoi_colors(n, l, count, off);
            voronoi_blend(l, count, begins);
          } else {
            voronoi_keep(l, count, off);
          }
          begins = false;
        }
}

LEAF void voronoi_begin(voronoi_lanes *l, size_t count, float far) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    for (int d = 0; d < LATTICE_DIMENSIONS; d++)
      l->about[d][i] = l->best_at[d][i] = l->best_cell[d][i] = l->next_at[d][i] =
          l->next_cell[d][i] = 0.0f;
    for (int c = 0; c < 3; c++)
      l->mixed[c][i] = 0.0f;
    l->best[i] = l->next[i] = far;
  }
}
/* From the point that is nearest, about its cell. */
LEAF void voronoi_step(voronoi_lanes *l, size_t count) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    for (int d = 0; d < LATTICE_DIMENSIONS; d++) {
      l->about[d][i] = l->best_cell[d][i];
      l->in[d][i] = l->best_at[d][i];
    }
    l->best[i] = l->next[i] = 1e8f;
  }
}

LEAF void node_voronoi_run(const node_voronoi *n, lane_run g, const corners *corner,
                           const surfaces *point, inputs *at) {
  const float *x[LATTICE_DIMENSIONS], *exponents = lane_of(at, n->exponent, 4, g);
  const float *smooths = lane_of(at, n->smoothness, 5, g);
  const float *randoms = lane_of(at, n->randomness, 6, g);
  const int feature = n->feature, blends = feature == VORONOI_SMOOTH_F1;
  const bool plain = n->dimensions == 1 || feature == VORONOI_DISTANCE_TO_EDGE ||
                     feature == VORONOI_N_SPHERE_RADIUS;
  const int metric = plain ? VORONOI_EUCLIDEAN : n->metric;
  voronoi_lanes lanes, *l = &lanes;
  (void)corner, (void)point;
  for (int d = 0; d < LATTICE_DIMENSIONS; d++)
    x[d] = lane_of(at, n->at[d], d, g);
  for (size_t begin = g.begin; begin < g.end; begin += LATTICE_LANES) {
    const size_t count = g.end - begin < LATTICE_LANES ? g.end - begin : LATTICE_LANES;
    for (int d = 0; d < LATTICE_DIMENSIONS; d++) {
      const float there = d < n->dimensions ? 1.0f : 0.0f, *from = x[d] + begin;
#pragma omp simd
      for (size_t i = 0; i < count; i++) {
        float p = there * clampf(from[i], -4e6f, 4e6f);
        l->cell[d][i] = floor_small(p);
        l->in[d][i] = p - l->cell[d][i];
      }
    }
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      l->exponent[i] = exponents[begin + i];
      l->smoothness[i] = greatest(smooths[begin + i], 1e-6f);
      l->randomness[i] = clampf(randoms[begin + i], 0.0f, 1.0f);
    }
    voronoi_begin(l, count, blends ? 8.0f : 1e8f); /* mixing with what is larger loses digits */
    const int first = blends ? VORONOI_BLENDED : VORONOI_NEAREST;
    const int then = feature == VORONOI_DISTANCE_TO_EDGE  ? VORONOI_EDGES
                     : feature == VORONOI_N_SPHERE_RADIUS ? VORONOI_OTHERS
                                                          : first;
    for (int what = first;; what = then) { /* once, or then once more */
      voronoi_round(n, l, count, metric, what);
      if (what == then)
        break;
      if (then == VORONOI_OTHERS)
        voronoi_step(l, count);
#pragma omp simd
      for (size_t i = 0; i < count; i++)
        l->next[i] = 1e8f;
    }
    const bool second = (feature == VORONOI_F2) | (feature == VORONOI_DISTANCE_TO_EDGE);
    const voronoi_lane *cells = second ? l->next_cell : l->best_cell;
    const voronoi_lane *points = second ? l->next_at : l->best_at;
    const float *distance = second ? l->next : l->best;
    const float by = feature == VORONOI_N_SPHERE_RADIUS ? 0.5f : 1.0f;
    if (!blends)
      voronoi_colors_at(n, l, count, cells);
    const voronoi_lane *colors = blends ? l->mixed : l->color;
    float *said = at->at[n->out[0]] + begin;
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      said[i] = by * distance[i];
    for (int d = 0; d < LATTICE_DIMENSIONS; d++) {
      float *where = at->at[n->out[1 + d]] + begin;
      const float there = d < n->dimensions ? 1.0f : 0.0f;
#pragma omp simd
      for (size_t i = 0; i < count; i++)
        where[i] = there * (l->cell[d][i] + points[d][i]);
    }
    for (int c = 0; c < 3; c++) {
      float *color = at->at[n->out[5 + c]] + begin;
#pragma omp simd
      for (size_t i = 0; i < count; i++)
        color[i] = colors[c][i];
    }
  }
}

#endif
