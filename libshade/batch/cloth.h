/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Prepared lanes of cloth: rows of `stride` numbers, one number a lane, of which `count` are
 * used.
 */
#ifndef SHADE_BATCH_CLOTH_H
#define SHADE_BATCH_CLOTH_H

#include <stddef.h>

#include "../model/real.h"

/* What a lane holds. Weft and warp by shade_top. */
enum { CLOTH_WEFT, CLOTH_WARP, CLOTH_GAP, CLOTH_FAR, CLOTH_SINGLE, CLOTH_VOID, CLOTH_KINDS };

/* Those of one side are 0 on the lanes of the other. */
enum {
  CLOTH_N,                   /* normal of the fold, bent where the horizon bends it */
  CLOTH_GIVEN = CLOTH_N + 3, /* as it was given */
  CLOTH_WO = CLOTH_GIVEN + 3,
  CLOTH_TILT = CLOTH_WO + 3,    /* near: the yarn's normal in the frame of its fibres */
  CLOTH_FIBRE = CLOTH_TILT + 3, /* near: the fibres' direction in the frame of the cloth, x and y */
  CLOTH_WEIGHT = CLOTH_FIBRE + 2, /* what the lobe of either side gets */
  CLOTH_KD = CLOTH_WEIGHT + 2,    /* 2 x 3: occlusion and the white share of the surface in it */
  CLOTH_KT = CLOTH_KD + 6,        /* the same of what is let through */
  CLOTH_FLAT = CLOTH_KT + 6,      /* Lambert about n: what gaps show, 3 channels */
  CLOTH_GLOSS = CLOTH_FLAT + 3,   /* of either side */
  CLOTH_NAP = CLOTH_GLOSS + 2,
  CLOTH_COVERAGE,
  CLOTH_PART, /* weight of the lane among the terms of one hit */
  CLOTH_ROWS
};

/* Parts of a draw: the lobes of both sides, what is diffuse, what comes from behind; none. */
enum { CLOTH_DIFFUSE = 2, CLOTH_BEHIND, CLOTH_PARTS, CLOTH_NOTHING = CLOTH_PARTS };

typedef struct SUFFIX(cloth) {
  size_t count, stride;
  unsigned char *kind;
  real *rows;
} cloth;

static inline real *cloth_row(const cloth *c, int row) {
  return c->rows + (size_t)row * c->stride;
}

/* Lane i alone. */
static inline cloth cloth_lane(const cloth *c, size_t i) {
  return (cloth){1, c->stride, c->kind + i, c->rows + i};
}

#endif
