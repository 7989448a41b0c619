/* SPDX-License-Identifier: Apache-2.0 */
/* What an instruction set is given to make one row of a scratch table's cells. Private. */
#ifndef SHADE_BATCH_SCRATCH_ROW_H
#define SHADE_BATCH_SCRATCH_ROW_H

#include <stddef.h>
#include <stdint.h>

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
  SCRATCH_MOMENTS = 6, /* of a cell: MOMENTS of moments.h */
  SCRATCH_BLOCK = 16,  /* samples that are tested together: side by side, or a square */
  SCRATCH_SQUARE = 4,  /* its side */
  SCRATCH_TILE = 64,   /* most blocks that are drawn together: a bit for each */
  SCRATCH_LINES = 8    /* most lines of blocks that are made ready together */
};

/* A block's samples: places, and what has been dug there. A multiple of 64 bytes. */
typedef struct scratch_block {
  float off[SCRATCH_BLOCK]; /* from the block's upper left corner, in samples */
  float down[SCRATCH_BLOCK];
  float depth[SCRATCH_BLOCK], x[SCRATCH_BLOCK], y[SCRATCH_BLOCK]; /* with the slopes */
} scratch_block;

/* Blocks of a line that a stroke may reach: from begin to before end. */
typedef struct scratch_span {
  uint32_t stroke;
  uint16_t begin, end;
} scratch_span;

typedef struct scratch_row {
  int across, down; /* samples a cell */
  int width;        /* cells */
  int wide, tall;   /* of a block, in samples: SCRATCH_BLOCK x 1, or a square */
  int blocks;       /* a line */
  int row, rows;    /* first row of cells, and how many: of SCRATCH_LINES lines at most */
  uint64_t key;     /* of the jitter; cell i, sample k of it: key of (cell * 64 + k) */
  /* of each sample of a line of blocks, block by block: 64 * cell + sample of the cell, and how far
     down it lies before it is jittered */
  const uint32_t *cell64;
  const float *shift;
  const scratch_stroke *pool;
  const uint32_t *stroke; /* those of the pool that reach the rows, the deepest first */
  size_t strokes;
  scratch_span *span; /* SCRATCH_LINES lists, `room` long each */
  size_t room;
  float *sum; /* room for SCRATCH_MOMENTS lines of samples */
  float *to;  /* SCRATCH_MOMENTS for each cell */
} scratch_row;

/* 0…n-1 in an order in which neighbours lie far apart, n up to 8. */
static inline int scratch_shuffled(int i, int n) {
  static const unsigned char order[9][8] = {{0},
                                            {0},
                                            {0, 1},
                                            {0, 2, 1},
                                            {0, 2, 1, 3},
                                            {0, 3, 1, 4, 2},
                                            {0, 3, 1, 4, 2, 5},
                                            {0, 4, 1, 5, 2, 6, 3},
                                            {0, 4, 2, 6, 1, 5, 3, 7}};
  return order[n][i];
}

#endif
