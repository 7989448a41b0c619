/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The image around everything: what is seen there, and directions to where it is bright. */
#include "batch/leaf.h"
#include "scene/sky.h"
#include "stage/stage.h"

/* x and y of an image in texels, of a direction; [0, width) and [0, height). The projections are
 * those of Cycles. */
LEAF void sky_place(const sky *s, vec3 d, float *x, float *y) {
  const float *m = s->matrix;
  vec3 q = {m[0] * d.x + m[1] * d.y + m[2] * d.z + m[3],
            m[4] * d.x + m[5] * d.y + m[6] * d.z + m[7],
            m[8] * d.x + m[9] * d.y + m[10] * d.z + m[11]};
  float flat = sqrtf(q.x * q.x + q.y * q.y);
  float u = 0.5f - turn_of(q.y, q.x); /* (-1/2, 1/2] */
  float v = 1.0f - 2.0f * turn_of(flat, q.z);
  float depth = 2.0f - 2.0f * q.y; /* mirror ball: the normal is halfway to the eye at -y */
  float scale = 0.5f / sqrtf(depth > 1e-12f ? depth : 1e-12f);
  u = either(s->ball, 0.5f + q.x * scale, u);
  v = either(s->ball, 0.5f + q.z * scale, v);
  u -= floor_small(u);
  v -= floor_small(v);
  float half = either(s->closest, 0.0f, 0.5f);
  float width = (float)s->width, height = (float)s->height;
  *x = u * width - half;
  *y = v * height - half;
  *x = *x < 0.0f ? *x + width : *x;
  *y = *y < 0.0f ? *y + height : *y;
}

typedef float texel4 __attribute__((vector_size(16), aligned(4), may_alias));

/* By texels, not by lanes: four loads of a row of four floats. */
static void stage_sky(size_t count, const sky *s, const lane_v *restrict d, lane_c *restrict out) {
  enum { BLOCK = 64 };
  const sky own = *s;
  const size_t stride = (size_t)own.width + 1;
  for (size_t begin = 0; begin < count; begin += BLOCK) {
    float x[BLOCK], y[BLOCK];
    int at_x[BLOCK], at_y[BLOCK];
    size_t lanes = count - begin < BLOCK ? count - begin : BLOCK;
#pragma omp simd
    for (size_t k = 0; k < lanes; k++) {
      sky_place(&own, load(d, begin + k), &x[k], &y[k]);
      int column = (int)x[k], row = (int)y[k];
      bool good = (x[k] >= 0.0f) & (y[k] >= 0.0f); /* no number: the first texel */
      column = good ? column : 0;
      row = good ? row : 0;
      at_x[k] = column < own.width ? column : own.width - 1;
      at_y[k] = row < own.height ? row : own.height - 1;
      float u = x[k] - (float)at_x[k], v = y[k] - (float)at_y[k];
      x[k] = good ? either(own.closest, 0.0f, u) : 0.0f;
      y[k] = good ? either(own.closest, 0.0f, v) : 0.0f;
    }
    for (size_t k = 0; k < lanes; k++) {
      const float *corner = own.texel + 4 * ((size_t)at_y[k] * stride + (size_t)at_x[k]);
      const texel4 *low = (const texel4 *)corner, *high = (const texel4 *)(corner + 4 * stride);
      texel4 below = low[0] + x[k] * (low[1] - low[0]);
      texel4 above = high[0] + x[k] * (high[1] - high[0]);
      texel4 c = below + y[k] * (above - below);
      out->r[begin + k] = c[0];
      out->g[begin + k] = c[1];
      out->b[begin + k] = c[2];
    }
  }
}

/* Density with which sky_draw finds these directions. */
static void stage_sky_pdf(size_t count, const sky *s, const lane_v *restrict d,
                          float *restrict pdf) {
  const float *restrict density = s->density;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float x = turn_of(d->y[i], d->x[i]) * SKY_COLUMNS;
    float y = clampf((0.5f - 0.5f * d->z[i]) * SKY_ROWS, 0.0f, SKY_ROWS - 1);
    x = clampf(x, 0.0f, SKY_COLUMNS - 1);
    pdf[i] = density[(int)y * SKY_COLUMNS + (int)x];
  }
}

/* The last five steps of a search; a loop gcc would leave in the way of vectors. */
#define SKY_STEP(at, sums, first, u, step) at += sums[first + at + step] <= u ? step : 0;
#define SKY_STEPS(at, sums, first, u)                                                              \
  SKY_STEP(at, sums, first, u, 16)                                                                 \
  SKY_STEP(at, sums, first, u, 8)                                                                  \
  SKY_STEP(at, sums, first, u, 4)                                                                  \
  SKY_STEP(at, sums, first, u, 2)                                                                  \
  SKY_STEP(at, sums, first, u, 1)
_Static_assert(SKY_ROWS == 512 && SKY_COLUMNS == 1024 && SKY_STRIDE == 32,
               "the searches have 9 and twice 5 steps");

/*
 * Directions by their cell's share of the light: inverted sums, each step of a search for all
 * lanes; within a cell evenly. Rather than by an alias table, which would break the even spread of
 * the points. Each column's search begins in a table that stays in the cache.
 */
static void stage_sky_draw(size_t count, const sky *s, const uint32_t *restrict lane,
                           const light_samples *restrict from, lane_v *restrict d,
                           float *restrict pdf) {
  const float *restrict row = s->row, *restrict column = s->column;
  const float *restrict coarse = s->coarse, *restrict density = s->density;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float x = from->x[lane[i]], y = from->y[lane[i]];
    int line = row[256] <= y ? 256 : 0;
    SKY_STEP(line, row, 0, y, 128)
    SKY_STEP(line, row, 0, y, 64)
    SKY_STEP(line, row, 0, y, 32)
    SKY_STEPS(line, row, 0, y)
    int part = 0;
    SKY_STEPS(part, coarse, line * (SKY_COLUMNS / SKY_STRIDE), x)
    const int first = line * (SKY_COLUMNS + 1);
    int cell = SKY_STRIDE * part;
    SKY_STEPS(cell, column, first, x)
    float below = row[line], left = column[first + cell];
    float high = row[line + 1] - below, wide = column[first + cell + 1] - left;
    float fy = clampf((y - below) / (high > 0.0f ? high : 1.0f), 0.0f, 1.0f);
    float fx = clampf((x - left) / (wide > 0.0f ? wide : 1.0f), 0.0f, 0.99999f);
    float z = 1.0f - ((float)line + fy) * (2.0f / SKY_ROWS);
    float sine, cosine, flat = sqrtf(clampf(1.0f - z * z, 0.0f, 1.0f));
    turn(((float)cell + fx) * (1.0f / SKY_COLUMNS), &sine, &cosine);
    store(d, i, (vec3){flat * cosine, flat * sine, z});
    pdf[i] = density[line * SKY_COLUMNS + cell];
  }
}

/* The rays that meet nothing, and where they go. Returns their number. */
static size_t stage_missed(size_t count, const uint32_t *restrict record, const rays *restrict ray,
                           uint32_t *restrict missed, lane_v *restrict toward) {
  size_t found = 0;
  for (size_t i = 0; i < count; i++) {
    missed[found] = (uint32_t)i;
    found += record[i] == RECORD_MISS;
  }
#pragma omp simd
  for (size_t k = 0; k < found; k++) {
    toward->x[k] = ray->d.x[missed[k]];
    toward->y[k] = ray->d.y[missed[k]];
    toward->z[k] = ray->d.z[missed[k]];
  }
  return found;
}
