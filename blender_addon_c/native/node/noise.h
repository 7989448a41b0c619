/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Perlin's noise [Perlin2002] in one to four dimensions and sums and products of its octaves
 * [Musgrave2003], as Cycles has them: `dimensions`; `at`, four operands; `what`, a word of the
 * table; `detail`, `roughness`, `lacunarity`, `offset` and `gain`, an operand each. `detail`
 * octaves follow the first, or with `first` come in all; the last is there in part. `even`: a sum
 * is brought to [0, 1]. Writes `out`, one number.
 */
#ifndef LIBSHADE_NODE_NOISE_H
#define LIBSHADE_NODE_NOISE_H

#include "node/common.h"
#include "node/hash.h"

#define NOISE_TABLE(ROW)                                                                           \
  ROW(FBM, fbm)                                                                                    \
  ROW(MULTIFRACTAL, product)                                                                       \
  ROW(HETERO_TERRAIN, terrain)                                                                     \
  ROW(HYBRID_MULTIFRACTAL, hybrid)                                                                 \
  ROW(RIDGED_MULTIFRACTAL, ridged)

#define NOISE_NUMBER(WORD, name) NOISE_##WORD,
#define NOISE_WORD(WORD, name) #WORD,
enum { NOISE_TABLE(NOISE_NUMBER) NOISE_MOST = 15 /* octaves after the first */ };

typedef struct node_noise {
  int dimensions, what, out;
  bool even, first;
  operand at[LATTICE_DIMENSIONS], detail, roughness, lacunarity, offset, gain;
} node_noise;

static inline bool node_noise_read(reader *r, node_noise *n, graph *g) {
  static const char *const words[] = {NOISE_TABLE(NOISE_WORD) NULL};
  return reader_integer(r, "dimensions", 1, LATTICE_DIMENSIONS, &n->dimensions) &&
         reader_word(r, "what", words, &n->what) && reader_flag(r, "even", &n->even) &&
         reader_flag(r, "first", &n->first) &&
         graph_operands(r, g, "at", LATTICE_DIMENSIONS, n->at) &&
         graph_operands(r, g, "detail", 1, &n->detail) &&
         graph_operands(r, g, "roughness", 1, &n->roughness) &&
         graph_operands(r, g, "lacunarity", 1, &n->lacunarity) &&
         graph_operands(r, g, "offset", 1, &n->offset) &&
         graph_operands(r, g, "gain", 1, &n->gain) && graph_outputs(r, g, "out", 1, &n->out);
}

/* One coordinate: its cell, where in it, and how much of the next one's corner is mixed in. */
typedef struct noise_cell {
  uint32_t cell;
  float x, share;
} noise_cell;

/* The lattice repeats each 100,000, where numbers grow too coarse; what is no number is 0. */
LEAF noise_cell noise_find(float x) {
  x = fabsf(x) < 3.4e38f ? x : 0.0f;
  float repeats = x * 1e-5f;
  repeats = fabsf(repeats) < 2097152.0f ? repeats : 0.0f;
  float whole = (float)(int32_t)repeats * 1e5f;
  float shift = fabsf(x) >= 1e6f ? 0.5f : 0.0f;
  x = clampf(fabsf(x) < 1e5f ? x : x - whole + shift, -2e5f, 2e5f);
  float low = floor_small(x), t = x - low;
  return (noise_cell){(uint32_t)(int32_t)low, t, t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f)};
}

LEAF float signed_by(uint32_t h, uint32_t bit, float x) {
  return h & bit ? -x : x;
}

LEAF float noise_slope1(uint32_t h, float x) {
  return signed_by(h, 8, 1.0f + (float)(int32_t)(h & 7)) * x;
}
LEAF float noise_slope2(uint32_t h, float x, float y) {
  bool low = (h & 7) < 4;
  float u = low ? x : y, v = 2.0f * (low ? y : x);
  return signed_by(h, 1, u) + signed_by(h, 2, v);
}
LEAF float noise_slope3(uint32_t h, float x, float y, float z) {
  h &= 15;
  float u = h < 8 ? x : y, v = h < 4 ? y : (((h == 12) | (h == 14)) ? x : z);
  return signed_by(h, 1, u) + signed_by(h, 2, v);
}
LEAF float noise_slope4(uint32_t h, float x, float y, float z, float w) {
  h &= 31;
  float u = h < 24 ? x : y, v = h < 16 ? y : z, s = h < 8 ? z : w;
  return signed_by(h, 1, u) + signed_by(h, 2, v) + signed_by(h, 4, s);
}

/* Signed noise, about [-1, 1]. */
LEAF float noise_1(vec4 p) {
  noise_cell x = noise_find(p.x);
  return 0.25f * lerp(noise_slope1(jenkins(1, x.cell, 0, 0, 0), x.x),
                      noise_slope1(jenkins(1, x.cell + 1, 0, 0, 0), x.x - 1.0f), x.share);
}
LEAF float noise_line2(noise_cell x, uint32_t cell, float y) {
  return lerp(noise_slope2(jenkins(2, x.cell, cell, 0, 0), x.x, y),
              noise_slope2(jenkins(2, x.cell + 1, cell, 0, 0), x.x - 1.0f, y), x.share);
}
LEAF float noise_2(vec4 p) {
  noise_cell x = noise_find(p.x), y = noise_find(p.y);
  return 0.6616f *
         lerp(noise_line2(x, y.cell, y.x), noise_line2(x, y.cell + 1, y.x - 1.0f), y.share);
}
LEAF float noise_line3(noise_cell x, uint32_t row, float y, uint32_t layer, float z) {
  return lerp(noise_slope3(jenkins(3, x.cell, row, layer, 0), x.x, y, z),
              noise_slope3(jenkins(3, x.cell + 1, row, layer, 0), x.x - 1.0f, y, z), x.share);
}
LEAF float noise_plane3(noise_cell x, noise_cell y, uint32_t layer, float z) {
  return lerp(noise_line3(x, y.cell, y.x, layer, z),
              noise_line3(x, y.cell + 1, y.x - 1.0f, layer, z), y.share);
}
LEAF float noise_3(vec4 p) {
  noise_cell x = noise_find(p.x), y = noise_find(p.y), z = noise_find(p.z);
  return 0.982f *
         lerp(noise_plane3(x, y, z.cell, z.x), noise_plane3(x, y, z.cell + 1, z.x - 1.0f), z.share);
}
LEAF float noise_line4(noise_cell x, uint32_t row, float y, uint32_t layer, float z, uint32_t time,
                       float w) {
  return lerp(noise_slope4(jenkins(4, x.cell, row, layer, time), x.x, y, z, w),
              noise_slope4(jenkins(4, x.cell + 1, row, layer, time), x.x - 1.0f, y, z, w), x.share);
}
LEAF float noise_plane4(noise_cell x, noise_cell y, uint32_t layer, float z, uint32_t time,
                        float w) {
  return lerp(noise_line4(x, y.cell, y.x, layer, z, time, w),
              noise_line4(x, y.cell + 1, y.x - 1.0f, layer, z, time, w), y.share);
}
LEAF float noise_space4(noise_cell x, noise_cell y, noise_cell z, uint32_t time, float w) {
  return lerp(noise_plane4(x, y, z.cell, z.x, time, w),
              noise_plane4(x, y, z.cell + 1, z.x - 1.0f, time, w), z.share);
}
LEAF float noise_4(vec4 p) {
  noise_cell x = noise_find(p.x), y = noise_find(p.y), z = noise_find(p.z), w = noise_find(p.w);
  return 0.8344f * lerp(noise_space4(x, y, z, w.cell, w.x),
                        noise_space4(x, y, z, w.cell + 1, w.x - 1.0f), w.share);
}

/* What is carried from octave to octave. */
typedef struct noise_sum {
  float value, total; /* of what is there in whole */
  float power, weight, signal;
  float part, part_total; /* and with the octave that is there in part */
} noise_sum;

/* An octave's noise n, its number k, of which the share `of` counts; 0: of an octave that ends the
 * row none does. */
LEAF noise_sum noise_fbm(noise_sum s, float n, bool begins, float of, float roughness, float offset,
                         float gain) {
  (void)begins, (void)offset, (void)gain;
  bool whole = of == 1.0f;
  float value = s.value + n * s.power, total = s.total + s.power;
  s.part = whole ? s.part : value;
  s.part_total = whole ? s.part_total : total;
  s.value = whole ? value : s.value;
  s.total = whole ? total : s.total;
  s.power *= roughness;
  return s;
}
LEAF noise_sum noise_product(noise_sum s, float n, bool begins, float of, float roughness,
                             float offset, float gain) {
  (void)offset, (void)gain;
  s.value = (begins ? 1.0f : s.value) * (of * s.power * n + 1.0f);
  s.power *= roughness;
  return s;
}
LEAF noise_sum noise_terrain(noise_sum s, float n, bool begins, float of, float roughness,
                             float offset, float gain) {
  (void)gain;
  s.value = begins ? n + offset : s.value + of * (n + offset) * s.power * s.value;
  s.power *= roughness;
  return s;
}
LEAF noise_sum noise_hybrid(noise_sum s, float n, bool begins, float of, float roughness,
                            float offset, float gain) {
  float weight = begins ? 1.0f : (s.weight < 1.0f ? s.weight : 1.0f);
  float signal = (n + offset) * s.power;
  bool over = !begins & !(s.weight > 0.001f);
  s.value = over ? s.value : s.value + of * weight * signal;
  s.weight = over ? 0.0f : weight * gain * signal;
  s.power *= roughness;
  return s;
}
/* Has no octaves in part. */
LEAF noise_sum noise_ridged(noise_sum s, float n, bool begins, float of, float roughness,
                            float offset, float gain) {
  float weight = begins ? 1.0f : clampf(s.signal * gain, 0.0f, 1.0f);
  float signal = offset - fabsf(n);
  signal *= signal * weight;
  s.value = begins ? signal : s.value + (of == 1.0f ? signal * s.power : 0.0f);
  s.signal = signal;
  s.power *= roughness;
  return s;
}

/* The numbers of so many lanes at once. */
#define NOISE_SUM(ROW)                                                                             \
  ROW(value) ROW(total) ROW(power) ROW(weight) ROW(signal) ROW(part) ROW(part_total)
#define NOISE_LANE(name) float name[LATTICE_LANES];
typedef struct noise_lanes {
  float x[LATTICE_DIMENSIONS][LATTICE_LANES];
  float noise[LATTICE_LANES], frequency[LATTICE_LANES], octaves[LATTICE_LANES];
  NOISE_SUM(NOISE_LANE)
} noise_lanes;

#define NOISE_LOAD(name) .name = l->name[i],
#define NOISE_STORE(name) l->name[i] = there ? s.name : l->name[i];
#define NOISE_OCTAVE(dimensions)                                                                   \
  case dimensions:                                                                                 \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      float f = l->frequency[i];                                                                   \
      l->noise[i] = noise_##dimensions(                                                            \
          (vec4){f * l->x[0][i], f * l->x[1][i], f * l->x[2][i], f * l->x[3][i]});                 \
      l->frequency[i] = f * lacunarity[i];                                                         \
    }                                                                                              \
    break;
#define NOISE_ADD(WORD, name)                                                                      \
  case NOISE_##WORD:                                                                               \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      noise_sum s = {NOISE_SUM(NOISE_LOAD)};                                                       \
      float of = clampf(l->octaves[i] - (float)k, 0.0f, 1.0f);                                     \
      bool there = (of > 0.0f) | (k == 0);                                                         \
      s = noise_##name(s, l->noise[i], k == 0, of, roughness[i], offset[i], gain[i]);              \
      NOISE_SUM(NOISE_STORE)                                                                       \
    }                                                                                              \
    break;

LEAF void node_noise_run(const node_noise *n, lane_run g, const corners *corner,
                         const surfaces *point, inputs *at) {
  const float *x[LATTICE_DIMENSIONS], *details = lane_of(at, n->detail, 4, g);
  const float *rough = lane_of(at, n->roughness, 5, g), *lacuna = lane_of(at, n->lacunarity, 6, g);
  const float *offsets = lane_of(at, n->offset, 7, g), *gains = lane_of(at, n->gain, 8, g);
  const bool even = n->even, sums = n->what == NOISE_FBM;
  const float begins = n->first ? 0.0f : 1.0f;
  /* a terrain's first octave is what the others stand on */
  const float least = n->what == NOISE_HETERO_TERRAIN ? 1.0f : 0.0f;
  noise_lanes lanes, *l = &lanes;
  (void)corner, (void)point;
  for (int d = 0; d < LATTICE_DIMENSIONS; d++)
    x[d] = lane_of(at, n->at[d], d, g);
  for (size_t begin = g.begin; begin < g.end; begin += LATTICE_LANES) {
    const size_t count = g.end - begin < LATTICE_LANES ? g.end - begin : LATTICE_LANES;
    const float *lacunarity = lacuna + begin, *roughness = rough + begin;
    const float *offset = offsets + begin, *gain = gains + begin, *detail = details + begin;
    float *out = at->at[n->out] + begin, most = 0.0f;
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      float octaves = clampf(detail[i], 0.0f, (float)NOISE_MOST) + begins;
      l->octaves[i] = octaves < least ? octaves + 1.0f : octaves;
      l->frequency[i] = l->power[i] = 1.0f;
      l->value[i] = l->total[i] = l->weight[i] = l->signal[i] = 0.0f;
      l->part[i] = l->part_total[i] = 0.0f;
    }
    for (int d = 0; d < LATTICE_DIMENSIONS; d++)
      for (size_t i = 0; i < count; i++)
        l->x[d][i] = x[d][begin + i];
    for (size_t i = 0; i < count; i++)
      most = l->octaves[i] > most ? l->octaves[i] : most;
    for (int k = 0; k == 0 || (float)k < most; k++) {
      switch (n->dimensions) {
        NOISE_OCTAVE(1)
        NOISE_OCTAVE(2)
        NOISE_OCTAVE(3)
        NOISE_OCTAVE(4)
      }
      switch (n->what) { NOISE_TABLE(NOISE_ADD) }
    }
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      noise_sum s = {NOISE_SUM(NOISE_LOAD)};
      float part = l->octaves[i] - floor_small(l->octaves[i]);
      float whole = even ? 0.5f + 0.5f * s.value / (s.total != 0.0f ? s.total : 1.0f) : s.value;
      float all =
          even ? 0.5f + 0.5f * s.part / (s.part_total != 0.0f ? s.part_total : 1.0f) : s.part;
      out[i] = sums ? lerp(whole, part > 0.0f ? all : whole, part) : s.value;
    }
  }
}

#endif
