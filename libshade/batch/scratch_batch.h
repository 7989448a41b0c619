/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Rows of cells of a scratch table: every pit is drawn over the rows' jittered samples, the
 * deepest pits first, so that blocks of samples which all lie lower already are passed over.
 * Single precision only.
 */
#ifndef SHADE_BATCH_SCRATCH_BATCH_H
#define SHADE_BATCH_SCRATCH_BATCH_H

#include "../model/elementary.h"
#include "scratch_row.h"

/* Of line l of the row: where samples of a block lie before they are jittered. */
typedef struct scratch_places {
  float off[SCRATCH_BLOCK], down[SCRATCH_BLOCK];
} scratch_places;

static scratch_places scratch_places_of(const scratch_row *r, int l) {
  scratch_places p;
  for (int i = 0; i < SCRATCH_BLOCK; i++) {
    const int column = i % r->wide, row = i / r->wide;
    const float part = (float)scratch_shuffled(l * r->tall + row, r->down) + 0.25F;
    p.off[i] = (float)column + part / (float)r->down;
    p.down[i] = (float)row;
  }
  return p;
}

/* Place `blocks` blocks of samples of line l of a row of cells, from the first-th of the line on.
 */
static void scratch_jitter(const scratch_row *r, const scratch_places *p, int row, int l, int first,
                           int blocks, scratch_block *restrict to) {
  const uint64_t number =
      (uint64_t)row * (uint64_t)r->width * 64 + (uint64_t)(l * r->tall * r->across);
  const uint32_t *restrict cell64 = r->cell64 + (size_t)first * SCRATCH_BLOCK;
  const float *restrict shift = r->shift + (size_t)first * SCRATCH_BLOCK;
  const uint64_t key = r->key;
  const float part_x = 0x1p-25f / (float)r->down, part_y = 0x1p-25f / (float)r->across;
  for (int b = 0; b < blocks; b++, to++, cell64 += SCRATCH_BLOCK, shift += SCRATCH_BLOCK) {
    float *restrict off = to->off, *restrict down = to->down;
#pragma omp simd
    for (int i = 0; i < SCRATCH_BLOCK; i++) {
      uint64_t z = (key ^ (number + cell64[i])) + 0x9e3779b97f4a7c15u;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      z ^= z >> 31;
      off[i] = p->off[i] + (float)(int32_t)(z >> 40) * part_x;
      down[i] = p->down[i] + shift[i] + (float)(int32_t)((z & 0xffffffffu) >> 8) * part_y;
    }
    memset(to->depth, 0, sizeof to->depth + sizeof to->x + sizeof to->y);
  }
}

/*
 * Samples of lines of `tall` that the stroke may reach, the first of which begins at `line`: the
 * first and the last, or last < first.
 */
static void scratch_spans(const scratch_stroke *s, int line, int tall, double most,
                          int *restrict first, int *restrict last) {
  const double margin = 1e-3; /* of a sample, against rounding */
  const double reach = s->reach, bulge = s->bulge, half = s->half, bend = s->bend;
  const double from = s->x - margin, to = s->x + margin, lean = s->lean, above = line - s->y;
#pragma omp simd
  for (int i = 0; i < SCRATCH_LINES; i++) {
    double top = above + i * tall - margin, bottom = above + (i + 1) * tall + margin;
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
static inline float scratch_dig(const scratch_stroke *s, float a0, float b0,
                                scratch_block *restrict block) {
  const float *restrict off = block->off, *restrict down = block->down;
  float *restrict depth = block->depth, *restrict x = block->x, *restrict y = block->y;
  const float ax = s->ax, ay = s->ay, bx = s->bx, by = s->by;
  const float k2 = s->k2, rim = s->rim, rim2 = rim * rim, rk = s->rk;
  const float xa = s->xa, xb = s->xb, ya = s->ya, yb = s->yb;
  /* By way of these: a loop that writes back what it may keep stores under a condition. */
  float deeper[SCRATCH_BLOCK], to_x[SCRATCH_BLOCK], to_y[SCRATCH_BLOCK];
#pragma omp simd
  for (int k = 0; k < SCRATCH_BLOCK; k++) {
    const float a = a0 + ax * off[k] + ay * down[k], b = b0 + bx * off[k] + by * down[k];
    const float e = 1 - a * a - b * b, inside = e > 0 ? e : 0, before = depth[k];
    const float w = sqrtf(rim2 + k2 * inside);
    const float inverse = 1 / (w * (w + rim)), over_w = (w + rim) * inverse;
    const float now = rk * inside * (w * inverse);
    const float sx = (xa * a + xb * b) * over_w, sy = (ya * a + yb * b) * over_w;
    deeper[k] = now > before ? now : before;
    to_x[k] = now > before ? sx : x[k];
    to_y[k] = now > before ? sy : y[k];
  }
  float least = deeper[0];
#pragma omp simd reduction(min : least)
  for (int k = 0; k < SCRATCH_BLOCK; k++) {
    depth[k] = deeper[k];
    x[k] = to_x[k];
    y[k] = to_y[k];
    least = deeper[k] < least ? deeper[k] : least;
  }
  return least;
}

/*
 * `sum`: SCRATCH_MOMENTS lines of `line` columns of samples each. Blocks a sample high, side by
 * side.
 */
static void scratch_add_flat(int blocks, const scratch_block *from, size_t line,
                             float *restrict sum) {
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

/* Four floats as one value: loops over so few do not vectorise. */
#if defined(__GNUC__)
typedef float __attribute__((vector_size(16), may_alias)) scratch_four;
enum { SCRATCH_FOURS = 1 };
#else
typedef float scratch_four;
enum { SCRATCH_FOURS = 4 };
#endif

/* The same of square blocks. */
static void scratch_add_square(int blocks, const scratch_block *from, size_t line,
                               float *restrict sum) {
  enum { N = SCRATCH_FOURS }; /* to the next row of the square */
  for (int block = 0; block < blocks; block++, from++, sum += SCRATCH_SQUARE)
    for (int i = 0; i < N; i++) {
      const scratch_four *d = (const scratch_four *)(const void *)from->depth + i,
                         *x = (const scratch_four *)(const void *)from->x + i,
                         *y = (const scratch_four *)(const void *)from->y + i;
      scratch_four *to[SCRATCH_MOMENTS];
      for (int c = 0; c < SCRATCH_MOMENTS; c++)
        to[c] = (scratch_four *)(void *)(sum + (size_t)c * line) + i;
      *to[0] -= (d[0] + d[N]) + (d[2 * N] + d[3 * N]);
      *to[1] += (x[0] + x[N]) + (x[2 * N] + x[3 * N]);
      *to[2] += (y[0] + y[N]) + (y[2 * N] + y[3 * N]);
      *to[3] += (x[0] * x[0] + x[N] * x[N]) + (x[2 * N] * x[2 * N] + x[3 * N] * x[3 * N]);
      *to[4] += (x[0] * y[0] + x[N] * y[N]) + (x[2 * N] * y[2 * N] + x[3 * N] * y[3 * N]);
      *to[5] += (y[0] * y[0] + y[N] * y[N]) + (y[2 * N] * y[2 * N] + y[3 * N] * y[3 * N]);
    }
}

/* For each line of the rows the strokes that meet it, with the blocks from the first to before the
 * last. */
static void scratch_meet(const scratch_row *r, uint32_t count[SCRATCH_LINES]) {
  const int lines = r->rows * (r->down / r->tall);
  memset(count, 0, SCRATCH_LINES * sizeof *count);
  for (uint32_t i = 0; i < r->strokes; i++) {
    int first[SCRATCH_LINES], last[SCRATCH_LINES];
    scratch_spans(&r->pool[r->stroke[i]], r->row * r->down, r->tall, r->across * r->width, first,
                  last);
    for (int l = 0; l < lines; l++) {
      const unsigned begin = (unsigned)first[l] / (unsigned)r->wide;
      const unsigned end = (unsigned)(last[l] + r->wide) / (unsigned)r->wide;
      /* written whether or not it meets, and then written over: faster than a jump */
      r->span[(size_t)l * r->room + count[l]] =
          (scratch_span){r->stroke[i], (uint16_t)begin, (uint16_t)end};
      count[l] += last[l] >= first[l];
    }
  }
}

/*
 * Draw the strokes of a list over `blocks` blocks of the line that begins at `line`. A block that
 * lies as low as a stroke's deepest place is done with: so are all strokes that follow.
 */
LEAF void scratch_draw(const scratch_row *r, const scratch_span *span, uint32_t strokes, int line,
                       int from, int blocks, int square, scratch_block *block) {
  float least[SCRATCH_TILE] = {0};
  uint64_t open = ~(uint64_t)0 >> (64 - blocks);
  for (uint32_t i = 0; i < strokes && open; i++) {
    const int begin = span[i].begin > from ? span[i].begin - from : 0;
    const int end = span[i].end < from + blocks ? span[i].end - from : blocks;
    if (begin >= end)
      continue;
    uint64_t meets = ~(uint64_t)0 >> (64 - (end - begin)) << begin & open;
    if (!meets)
      continue;
    const scratch_stroke *s = &r->pool[span[i].stroke];
    const float v = (float)(line - s->y), av = s->ay * v, bv = s->by * v;
    for (; meets; meets &= meets - 1) {
      const int k = __builtin_ctzll(meets);
      if (least[k] >= s->depth) {
        open &= ~((uint64_t)1 << k);
        continue;
      }
      const float u = (float)((from + k) * r->wide - s->x);
      const float a = s->ax * u + av, b = s->bx * u + bv;
      /* most of a square are reached, and to ask takes half as long as to draw */
      if (square || scratch_reaches(s, a, b, &block[k]))
        least[k] = scratch_dig(s, a, b, &block[k]);
    }
  }
}

static void scratch_draw_flat(const scratch_row *r, const scratch_span *span, uint32_t strokes,
                              int line, int from, int blocks, scratch_block *block) {
  scratch_draw(r, span, strokes, line, from, blocks, 0, block);
}
static void scratch_draw_square(const scratch_row *r, const scratch_span *span, uint32_t strokes,
                                int line, int from, int blocks, scratch_block *block) {
  scratch_draw(r, span, strokes, line, from, blocks, 1, block);
}

/* Means over the cells: SCRATCH_MOMENTS side by side, or one addition would wait for the other. */
static void scratch_cells(const scratch_row *r, size_t line, float *to) {
  const float part = 1 / (float)(r->across * r->down);
  const float *h = r->sum, *x = h + line, *y = x + line, *xx = y + line, *xy = xx + line,
              *yy = xy + line;
  for (int i = 0; i < r->width; i++, to += SCRATCH_MOMENTS) {
    float total[SCRATCH_MOMENTS] = {0};
    for (int k = 0; k < r->across; k++) {
      total[0] += *h++;
      total[1] += *x++;
      total[2] += *y++;
      total[3] += *xx++;
      total[4] += *xy++;
      total[5] += *yy++;
    }
    for (int c = 0; c < SCRATCH_MOMENTS; c++)
      to[c] = part * total[c];
  }
}

static void entry_scratch_row(const scratch_row *r) {
  const size_t columns = (size_t)r->blocks * (size_t)r->wide;
  const int lines = r->down / r->tall;
  _Alignas(64) scratch_block block[SCRATCH_TILE]; /* stays in the first-level cache */
  uint32_t strokes[SCRATCH_LINES];
  scratch_meet(r, strokes);
  for (int row = 0; row < r->rows; row++) {
    memset(r->sum, 0, SCRATCH_MOMENTS * columns * sizeof *r->sum);
    for (int l = 0; l < lines; l++) {
      const int at = row * lines + l, line = (r->row + row) * r->down + l * r->tall;
      const scratch_span *span = r->span + (size_t)at * r->room;
      const scratch_places places = scratch_places_of(r, l);
      for (int from = 0; from < r->blocks; from += SCRATCH_TILE) {
        const int rest = r->blocks - from, blocks = rest < SCRATCH_TILE ? rest : SCRATCH_TILE;
        float *sum = r->sum + (size_t)from * (size_t)r->wide;
        scratch_jitter(r, &places, r->row + row, l, from, blocks, block);
        if (r->tall == 1)
          scratch_draw_flat(r, span, strokes[at], line, from, blocks, block);
        else
          scratch_draw_square(r, span, strokes[at], line, from, blocks, block);
        if (r->tall == 1)
          scratch_add_flat(blocks, block, columns, sum);
        else
          scratch_add_square(blocks, block, columns, sum);
      }
    }
    scratch_cells(r, columns, r->to + (size_t)row * (size_t)r->width * SCRATCH_MOMENTS);
  }
}

#endif
