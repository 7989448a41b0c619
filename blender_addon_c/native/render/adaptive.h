/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Which parts of a picture need no more samples. Blocks of 4 x 4 pixels are judged after each pass
 * by how far apart two halves of their samples are, each pixel by itself; a block that is done is
 * left out of all later passes. A block's fate depends on its own samples alone.
 */
#ifndef LIBSHADE_ADAPTIVE_H
#define LIBSHADE_ADAPTIVE_H

#include "render/sampling.h"

enum { ADAPTIVE_SIDE = 4, ADAPTIVE_PIXELS = 16, ADAPTIVE_BLOCKS = 16 }; /* of a tile */

typedef struct adaptive {
  float threshold;  /* of the error over the root of the brightness; 0: all get all samples */
  size_t least;     /* samples before a block may be done */
  float *half;      /* RGB of the region's pixels: sums over the first half of each pass */
  uint16_t *passes; /* by block: how many are in its sums */
  uint8_t *done;    /* by block */
} adaptive;

/* For this many tiles and pixels of the region. False when out of memory. */
bool adaptive_init(adaptive *a, size_t tiles, size_t pixels);
void adaptive_free(adaptive *a);

/* A pixel's block, in the Z order of the tile. */
static inline size_t adaptive_block(size_t tile, int x, int y) {
  unsigned u = (unsigned)x / ADAPTIVE_SIDE & 3u, v = (unsigned)y / ADAPTIVE_SIDE & 3u;
  return tile * ADAPTIVE_BLOCKS + (u & 1u) + 2 * (v & 1u) + 4 * (u >> 1) + 8 * (v >> 1);
}

/* Samples that a block's pixels have, and those of the halves. */
size_t adaptive_samples(const adaptive *a, const sampling_plan *plan, size_t block, size_t *half);

/* Error of one pixel's mean, of `samples`, as a part of what threshold is of. */
float adaptive_error(const float *sum, const float *half, size_t samples, size_t in_half);

#endif
