/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A field of scratches, as scratch.c draws and evaluates it, scratch_bins.c finds its pits and
 * scratch_table.c averages them. Private to src/.
 */
#ifndef SHADE_SRC_SCRATCH_H
#define SHADE_SRC_SCRATCH_H

#include "shade/maps.h"
#include "batch/isa.h"
#include "src/moments.h"

/* What evaluation reads of one pit. */
typedef struct pit {
  double x, y;       /* centre, in tile widths */
  double along[2];   /* unit, along the scratch */
  double half_along; /* half axes of the rim */
  double half_across;
  double reach[2];  /* along x and y, to either side */
  double k2, rim;   /* k^2; sqrt(1 - k^2) */
  double scale;     /* r/k */
  double gradient1; /* k/s */
  double gradient2; /* k */
  double depth;     /* nothing of it lies lower */
  uint32_t number;  /* of all pits, in the order of the layers */
} pit;

struct shade_scratch_field {
  double aspect;
  size_t pits;
  pit *pit;        /* the deepest first */
  int across, up;  /* bins */
  uint32_t *start; /* bins + 1: where a bin's list begins */
  uint32_t *list;  /* pits over each bin, the deepest first */
  int has_table;
  int steps;         /* points along a cell's side that two lie across a mean radius */
  int columns, rows; /* of samples of a cell of the table */
  uint64_t seed;
  moment_pyramid table;
};

static inline uint64_t scratch_mix(uint64_t z) { /* splitmix64's */
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* 0, or -1 when out of memory. */
int shade_scratch_fill_bins(shade_scratch_field *f);

/*
 * The table that answers footprints, `cells` along the tile's longer side; f->columns x f->rows
 * samples a cell, so that even narrow pits are met. Sample (ki, kj) of cell (i, j) from the upper
 * left lies at
 *
 *   u = (i + (ki + (shuffled(kj, rows) + 1/4 + a/2)/rows)/columns)/width,
 *   v = 1 - (j + (kj + (shuffled(ki, columns) + 1/4 + b/2)/columns)/rows)/height,
 *
 * a and b the upper and lower 32 bits of mix(mix(seed ^ 0x7461626c65) ^ ((j width + i) 64 + kj
 * columns + ki)), over 2^32: each has a column and a row of the cell to itself, so that scratches
 * along u or v are met at as many different places as there are samples, and lies in the middle
 * half of where they cross. [Chiu1994]
 */
int shade_scratch_make_table(shade_scratch_field *f, int cells, const shade_isa_table *isa);

#endif
