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
  float rise = 2.0f * v - 1.0f;
  u = either(s->ball, 0.5f + q.x * scale, u);
  v = either(s->ball, 0.5f + q.z * scale, v);
  v = either(s->dome, 0.5f + 0.5f * copysignf(sqrtf(fabsf(rise)), rise), v);
  v = either(s->ends, clampf(v, 0.0f, 0.99999f), v);
  u -= floor_small(u);
  v -= floor_small(v);
  float half = either(s->closest, 0.0f, 0.5f);
  float width = (float)s->width, height = (float)s->height;
  *x = u * width - half;
  *y = v * height - half;
  *x = *x < 0.0f ? *x + width : *x;
  *y = *y < 0.0f ? either(s->ends, 0.0f, *y + height) : *y;
}

/* Squared distance from the middle of the sun's disc over that of its rim. */
LEAF float sun_distance2(const sky_sun *s, vec3 d) {
  float x = d.x - s->to[0], y = d.y - s->to[1], z = d.z - s->to[2];
  float chord2 = x * x + y * y + z * z;
  return chord2 * (1.0f + chord2 * (1.0f / 12 + chord2 * (1.0f / 90))) / s->half2;
}

/* At the rim there is .4 of the light of the middle, as in Blender. */
static void add_sun(size_t count, const sky *s, const lane_v *restrict d, lane_c *restrict out) {
  const sky_sun own = s->sun;
  const float *m = s->matrix + 8;
  const float m0 = m[0], m1 = m[1], m2 = m[2];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float z = m0 * d->x[i] + m1 * d->y[i] + m2 * d->z[i], far2 = sun_distance2(&own, load(d, i));
    bool seen = (far2 < 1.0f) & (z >= own.low_z);
    float rise = 1.57079633f - arc_tangent2(sqrtf(clampf(1.0f - z * z, 0.0f, 1.0f)), z);
    float by = (rise - own.low) * own.per_rise;
    float limb = seen ? 0.4f + 0.6f * sqrtf(clampf(1.0f - far2, 0.0f, 1.0f)) : 0.0f;
    float sky_there = seen ? either(own.covers, 0.0f, 1.0f) : 1.0f;
    out->r[i] = sky_there * out->r[i] + limb * (own.lower[0] + by * own.more[0]);
    out->g[i] = sky_there * out->g[i] + limb * (own.lower[1] + by * own.more[1]);
    out->b[i] = sky_there * out->b[i] + limb * (own.lower[2] + by * own.more[2]);
  }
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
#if defined(__GNUC__)
    for (size_t k = 0; k < lanes; k++) { /* two texels of a row may lie in two lines of the cache */
      const float *corner = own.texel + 4 * ((size_t)at_y[k] * stride + (size_t)at_x[k]);
      __builtin_prefetch(corner);
      __builtin_prefetch(corner + 4);
      __builtin_prefetch(corner + 4 * stride);
      __builtin_prefetch(corner + 4 * stride + 4);
    }
#endif
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
  if (own.sun.share > 0.0f)
    add_sun(count, s, d, out);
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
  const sky_sun sun = s->sun;
  if (sun.share > 0.0f)
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      pdf[i] = (1.0f - sun.share) * pdf[i] +
               (sun_distance2(&sun, load(d, i)) < 1.0f ? sun.density : 0.0f);
}

/* Of the draws those that go to the sun, evenly over its disc. */
static void draw_sun(size_t count, const sky_sun *s, const uint32_t *restrict lane,
                     const light_samples *restrict from, lane_v *restrict d) {
  const sky_sun own = *s;
  const float per_share = 1.0f / own.share;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float x = from->x[lane[i]], chord2 = own.chord2 * from->y[lane[i]], sine, cosine;
    turn(clampf(x * per_share, 0.0f, 0.99999f), &sine, &cosine);
    float up = 1.0f - 0.5f * chord2, flat = sqrtf(chord2 * (1.0f - 0.25f * chord2));
    float a = flat * cosine, b = flat * sine;
    vec3 to = {up * own.to[0] + a * own.across[0] + b * own.along[0],
               up * own.to[1] + a * own.across[1] + b * own.along[1],
               up * own.to[2] + a * own.across[2] + b * own.along[2]};
    store(d, i, select3(x < own.share, to, load(d, i)));
  }
}

/* The last five steps of a search, without a loop, so that lanes vectorise. */
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
 * the points. Each column's search begins in a table that stays in the cache; what it goes on with
 * is asked for before, for all lanes of a block.
 */
static void stage_sky_draw(size_t count, const sky *s, const uint32_t *restrict lane,
                           const light_samples *restrict from, lane_v *restrict d,
                           float *restrict pdf) {
  const float *restrict row = s->row, *restrict column = s->column;
  const float *restrict coarse = s->coarse, *restrict density = s->density;
  const float share = s->sun.share, others = 1.0f / (1.0f - share);
  enum { BLOCK = 64 };
  for (size_t begin = 0; begin < count; begin += BLOCK) {
    float across[BLOCK], up[BLOCK];
    int lines[BLOCK], cells[BLOCK];
    size_t lanes = count - begin < BLOCK ? count - begin : BLOCK;
#pragma omp simd
    for (size_t k = 0; k < lanes; k++) {
      const uint32_t at = lane[begin + k];
      float x = clampf((from->x[at] - share) * others, 0.0f, 1.0f), y = from->y[at];
      int line = row[256] <= y ? 256 : 0;
      SKY_STEP(line, row, 0, y, 128)
      SKY_STEP(line, row, 0, y, 64)
      SKY_STEP(line, row, 0, y, 32)
      SKY_STEPS(line, row, 0, y)
      int part = 0;
      SKY_STEPS(part, coarse, line * (SKY_COLUMNS / SKY_STRIDE), x)
      across[k] = x;
      up[k] = y;
      lines[k] = line;
      cells[k] = SKY_STRIDE * part;
    }
#if defined(__GNUC__)
    for (size_t k = 0; k < lanes; k++) { /* 33 sums lie in three lines of the cache at most */
      const float *sums = column + lines[k] * (SKY_COLUMNS + 1) + cells[k];
      __builtin_prefetch(sums);
      __builtin_prefetch(sums + 16);
      __builtin_prefetch(sums + 32);
    }
#endif
#pragma omp simd
    for (size_t k = 0; k < lanes; k++) {
      const float x = across[k], y = up[k];
      const int line = lines[k], first = line * (SKY_COLUMNS + 1);
      int cell = cells[k];
      SKY_STEPS(cell, column, first, x)
      float below = row[line], left = column[first + cell];
      float high = row[line + 1] - below, wide = column[first + cell + 1] - left;
      float fy = clampf((y - below) / (high > 0.0f ? high : 1.0f), 0.0f, 1.0f);
      float fx = clampf((x - left) / (wide > 0.0f ? wide : 1.0f), 0.0f, 0.99999f);
      float z = 1.0f - ((float)line + fy) * (2.0f / SKY_ROWS);
      float sine, cosine, flat = sqrtf(clampf(1.0f - z * z, 0.0f, 1.0f));
      turn(((float)cell + fx) * (1.0f / SKY_COLUMNS), &sine, &cosine);
      store(d, begin + k, (vec3){flat * cosine, flat * sine, z});
      cells[k] = cell;
    }
    for (size_t k = 0; k < lanes; k++)
      pdf[begin + k] = density[lines[k] * SKY_COLUMNS + cells[k]];
  }
  if (share > 0.0f) {
    draw_sun(count, &s->sun, lane, from, d);
    stage_sky_pdf(count, s, d, pdf);
  }
}

/* The rays that meet nothing, and where they go. Returns their number. */
static size_t stage_missed(size_t count, const uint32_t *restrict record, const rays *restrict ray,
                           uint32_t *restrict missed, lane_v *restrict toward) {
  size_t found = 0;
  for (size_t i = 0; i < count; i++) {
    missed[found] = (uint32_t)i;
    found += (record[i] == RECORD_MISS) & (ray->tfar[i] >= 0.0f); /* else there was no ray */
  }
#pragma omp simd
  for (size_t k = 0; k < found; k++) {
    toward->x[k] = ray->d.x[missed[k]];
    toward->y[k] = ray->d.y[missed[k]];
    toward->z[k] = ray->d.z[missed[k]];
  }
  return found;
}
