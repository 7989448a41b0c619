/* SPDX-License-Identifier: Apache-2.0 */
/* What the kernel is given to make one row of a scratch table's cells. Private. */
#ifndef SHADE_SRC_SCRATCH_ROW_H
#define SHADE_SRC_SCRATCH_ROW_H

#include <stddef.h>
#include <stdint.h>

#include "moments.h"

/*
 * One image of a pit on the endless plane. Places are in samples (x) and lines (y, downwards)
 * of the table from its upper left corner. With (u, v) the way from the centre, a = ax u + ay v and
 * b = bx u + by v are the place over the half axes and e = 1 - a^2 - b^2 is positive inside.
 */
typedef struct scratch_stroke {
  double x, y;
  double reach;                   /* in lines, to either side */
  double lean, half, bend, bulge; /* the rim: u = lean v +- sqrt(half - bend v^2); its right half
                                     reaches furthest at v = bulge, its left one at -bulge */
  float ax, ay, bx, by;
  float depth;
  float linear, square; /* deeper than L where e > L (linear + square L) */
  float rk, k2, rim;    /* L = rk e/(w + rim), w = sqrt(rim^2 + k2 e) */
  float xa, xb, ya, yb; /* slopes: (xa a + xb b)/w and (ya a + yb b)/w */
  uint32_t rank;        /* the deepest first */
} scratch_stroke;

enum {
  SCRATCH_BLOCK = 16, /* samples that are tested together */
  SCRATCH_TILE = 64,  /* most blocks that are drawn together: a bit for each */
  SCRATCH_LINES = 8   /* most lines a row of cells */
};

/* Samples side by side: places, and what has been dug there. A multiple of 64 bytes. */
typedef struct scratch_block {
  float off[SCRATCH_BLOCK];  /* from the first sample's cell, in samples */
  float down[SCRATCH_BLOCK]; /* from the line */
  float depth[SCRATCH_BLOCK], x[SCRATCH_BLOCK], y[SCRATCH_BLOCK]; /* with the slopes */
} scratch_block;

/* Blocks of a line that a stroke may reach: from begin to before end. */
typedef struct scratch_span {
  uint32_t stroke;
  uint16_t begin, end;
} scratch_span;

typedef struct scratch_row {
  int n;                  /* lines a row, samples a cell and line */
  int width;              /* cells */
  int blocks;             /* a line */
  int line;               /* first of the row */
  uint64_t key;           /* of the jitter; cell i, sample k of it: key of (cell * 64 + k) */
  const uint32_t *cell64; /* 64 * cell + sample of the line, for each sample of a line */
  const scratch_stroke *pool;
  const uint32_t *stroke; /* those of the pool that reach the row, the deepest first */
  size_t strokes;
  scratch_span *span; /* n lists, `room` long each */
  size_t room;
  float *sum; /* room for MOMENTS lines of samples */
  float *to;  /* MOMENTS for each cell */
} scratch_row;

#endif
