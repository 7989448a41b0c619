/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One row of cells of a scratch table: every pit is drawn over the row's jittered samples, the
 * deepest pits first, so that blocks of samples which all lie lower already are passed over.
 * Single precision only.
 */
#include "../src/scratch_row.h"

/* Place the samples of line l. */
static void scratch_jitter(const scratch_row *r, int l, scratch_block *restrict to) {
  const uint64_t first =
      (uint64_t)(r->line / r->n) * (uint64_t)r->width * 64 + (uint64_t)(l * r->n);
  const uint32_t *restrict cell64 = r->cell64;
  const uint64_t key = r->key;
  for (int b = 0; b < r->blocks; b++, to++, cell64 += SCRATCH_BLOCK) {
    float *restrict off = to->off, *restrict down = to->down;
#pragma omp simd
    for (int i = 0; i < SCRATCH_BLOCK; i++) {
      uint64_t z = (key ^ (first + cell64[i])) + 0x9e3779b97f4a7c15u;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      z ^= z >> 31;
      /* 24 bits: rounding never gives 1 */
      off[i] = (float)i + (float)(int32_t)(z >> 40) * 0x1p-24f;
      down[i] = (float)(int32_t)((z & 0xffffffffu) >> 8) * 0x1p-24f;
    }
    memset(to->depth, 0, sizeof to->depth + sizeof to->x + sizeof to->y);
  }
}

/* Samples of each line that the stroke may reach: first and last, or last < first. */
static void scratch_spans(const scratch_stroke *s, int line, double most, int *restrict first,
                          int *restrict last) {
  const double margin = 1e-3; /* of a sample, against rounding */
  const double reach = s->reach, bulge = s->bulge, half = s->half, bend = s->bend;
  const double from = s->x - margin, to = s->x + margin, lean = s->lean, above = line - s->y;
#pragma omp simd
  for (int i = 0; i < SCRATCH_LINES; i++) {
    double top = above + i - margin, bottom = above + i + 1 + margin;
    const int meets = top <= reach && bottom >= -reach;
    top = top < -reach ? -reach : top;
    top = top > reach ? reach : top;
    bottom = bottom < -reach ? -reach : bottom;
    bottom = bottom > reach ? reach : bottom;
    double right = bulge < top ? top : bulge, left = -bulge < top ? top : -bulge;
    right = right > bottom ? bottom : right;
    left = left > bottom ? bottom : left;
    double r2 = half - bend * right * right, l2 = half - bend * left * left;
    r2 = r2 > 0 ? r2 : 0;
    l2 = l2 > 0 ? l2 : 0;
    double end = to + lean * right + sqrt(r2), begin = from + lean * left - sqrt(l2);
    begin = begin < 0 ? 0 : begin;
    begin = begin > most ? most : begin;
    end = end < -1 ? -1 : end;
    end = end > most - 1 ? most - 1 : end;
    end = meets ? end : -1;
    first[i] = (int)begin;
    last[i] = (int)end;
  }
}

/* Whether any of a block's samples lies in the pit, deeper than what was there. */
static inline int scratch_reaches(const scratch_stroke *s, float a0, float b0,
                                  const scratch_block *block) {
  const float *restrict off = block->off, *restrict down = block->down;
  const float *restrict depth = block->depth;
  const float ax = s->ax, ay = s->ay, bx = s->bx, by = s->by;
  const float linear = s->linear, square = s->square;
  int found = 0;
#pragma omp simd reduction(| : found)
  for (int k = 0; k < SCRATCH_BLOCK; k++) {
    const float a = a0 + ax * off[k] + ay * down[k], b = b0 + bx * off[k] + by * down[k];
    const float e = 1 - (a * a + b * b);
    found |= e > depth[k] * (linear + square * depth[k]);
  }
  return found;
}

/* Draw it. Returns the least depth of the block. */
static inline float scratch_dig(const scratch_stroke *s, float a0, float b0, scratch_block *block) {
  const float *restrict off = block->off, *restrict down = block->down;
  float *restrict depth = block->depth, *restrict x = block->x, *restrict y = block->y;
  const float ax = s->ax, ay = s->ay, bx = s->bx, by = s->by;
  const float linear = s->linear, square = s->square, k2 = s->k2, rim = s->rim, rk = s->rk;
  const float rim2 = rim * rim, xa = s->xa, xb = s->xb, ya = s->ya, yb = s->yb;
#pragma omp simd
  for (int k = 0; k < SCRATCH_BLOCK; k++) {
    const float a = a0 + ax * off[k] + ay * down[k], b = b0 + bx * off[k] + by * down[k];
    const float e = 1 - (a * a + b * b), inside = e > 0 ? e : 0, before = depth[k];
    const int deeper = e > before * (linear + square * before);
    const float w = sqrtf(rim2 + k2 * inside);
    const float inverse = 1 / (w * (w + rim)), over_w = (w + rim) * inverse;
    const float l = rk * inside * (w * inverse);
    const float sx = (xa * a + xb * b) * over_w, sy = (ya * a + yb * b) * over_w;
    const float ox = x[k], oy = y[k];
    depth[k] = deeper ? l : before;
    x[k] = deeper ? sx : ox;
    y[k] = deeper ? sy : oy;
  }
  float least = depth[0];
#pragma omp simd reduction(min : least)
  for (int k = 0; k < SCRATCH_BLOCK; k++)
    least = depth[k] < least ? depth[k] : least;
  return least;
}

/* `sum`: MOMENTS lines. */
static void scratch_add_line(int blocks, const scratch_block *from, float *restrict sum) {
  const size_t line = (size_t)blocks * SCRATCH_BLOCK;
  for (int b = 0; b < blocks; b++, from++, sum += SCRATCH_BLOCK) {
    const float *restrict depth = from->depth, *restrict x = from->x, *restrict y = from->y;
    float *restrict h = sum, *restrict sx = h + line, *restrict sy = sx + line,
                    *restrict xx = sy + line, *restrict xy = xx + line, *restrict yy = xy + line;
#pragma omp simd
    for (int i = 0; i < SCRATCH_BLOCK; i++) {
      h[i] -= depth[i];
      sx[i] += x[i];
      sy[i] += y[i];
      xx[i] += x[i] * x[i];
      xy[i] += x[i] * y[i];
      yy[i] += y[i] * y[i];
    }
  }
}

static void kernel_scratch_row(const scratch_row *r) {
  const size_t samples = (size_t)r->blocks * SCRATCH_BLOCK;
  for (int l = 0; l < r->n; l++)
    scratch_jitter(r, l, r->block + l * r->blocks);
  memset(r->least, 0, (size_t)(r->n * r->blocks) * sizeof *r->least);
  for (size_t i = 0; i < r->strokes; i++) {
    const scratch_stroke *s = &r->stroke[i];
    const float lowest = s->depth;
    int first[SCRATCH_LINES], last[SCRATCH_LINES];
    scratch_spans(s, r->line, r->n * r->width, first, last);
    for (int l = 0; l < r->n; l++) {
      if (last[l] < first[l])
        continue;
      const float v = (float)(r->line + l - s->y);
      scratch_block *line = r->block + l * r->blocks;
      float *least = r->least + l * r->blocks;
      const int end = last[l] / SCRATCH_BLOCK;
      for (int k = first[l] / SCRATCH_BLOCK; k <= end; k++) {
        if (least[k] >= lowest)
          continue;
        const float u = (float)(k * SCRATCH_BLOCK - s->x);
        const float a = s->ax * u + s->ay * v, b = s->bx * u + s->by * v;
        if (scratch_reaches(s, a, b, &line[k]))
          least[k] = scratch_dig(s, a, b, &line[k]);
      }
    }
  }
  memset(r->sum, 0, MOMENTS * samples * sizeof *r->sum);
  for (int l = 0; l < r->n; l++)
    scratch_add_line(r->blocks, r->block + l * r->blocks, r->sum);
  const float part = 1 / (float)(r->n * r->n);
  for (int i = 0; i < r->width; i++)
    for (int c = 0; c < MOMENTS; c++) {
      const float *s = r->sum + (size_t)c * samples + (size_t)i * (size_t)r->n;
      float total = 0;
      for (int k = 0; k < r->n; k++)
        total += s[k];
      r->to[i * MOMENTS + c] = part * total;
    }
}
