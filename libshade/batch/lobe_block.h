/* SPDX-License-Identifier: Apache-2.0 */
/* n and h to D over a block: points of the lobe by the detail pass, then the distribution. */
#ifndef SHADE_BATCH_LOBE_BLOCK_H
#define SHADE_BATCH_LOBE_BLOCK_H

#include "../model/lobe.h"
#include "detail_block.h"

/* The lobe's parameters, an array of each. */
typedef struct lobe_shape {
  const real *kx, *ky, *peak, *gx, *gy;
} lobe_shape;

/* Which lanes has_bumps holds of. */
enum { BUMPS_OF_NONE, BUMPS_OF_ALL, BUMPS_OF_SOME };

/*
 * A block of samples as passes that call passes hand it on: by its address, for a copy reads in
 * vectors what was just written one by one, and waits. Colours are filled where they are read.
 */
typedef struct sample_block {
  size_t count;
  vec n, wi, wo;
  lobe_shape shape;
  const real *f0[3], *tint[3], *k[3], *kd[3];
  int bumps; /* that shade each other, whose slopes are filled */
  const real *slopes[5];
  const struct mutual_room *met; /* what follows of these, where it is known */
} sample_block;

LEAF void pass_mdf(shade_mdf mdf, size_t count, const lobe_shape *s, const real *restrict t,
                   const real *restrict xx, const real *restrict yy, real *restrict d) {
  const real *restrict kx = s->kx, *restrict ky = s->ky, *restrict peak = s->peak;
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    d[i] = mdf_value(mdf, (lobe_point){t[i], xx[i], yy[i]}, kx[i], ky[i], peak[i]);
}

/* The conserving warps: d times their stretch. */
LEAF void pass_stretched(int smooth, int projected, size_t count, vec n, vec h, real *restrict d) {
  ARRAYS(n);
  ARRAYS(h);
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    d[i] *= warp_stretch(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i], smooth, projected);
}
static void pass_stretch(int smooth, int projected, size_t count, vec n, vec h, real *d) {
  if (smooth && projected)
    pass_stretched(1, 1, count, n, h, d);
  else if (smooth)
    pass_stretched(1, 0, count, n, h, d);
  else if (projected)
    pass_stretched(0, 1, count, n, h, d);
  else
    pass_stretched(0, 0, count, n, h, d);
}

/* n and h to D; h is unit for the warps. t, xx and yy are scratch. */
static void pass_lobe(const bsdf *b, const lobe_shape *s, size_t count, vec n, vec h, real *t,
                      real *xx, real *yy, real *d) {
  pass_detail(b->carry.map, count, n, h, t, xx, yy);
#define LOOP(mdf) pass_mdf(mdf, count, s, t, xx, yy, d)
  SHADE_LOOP_OF(MDF, b->mdf)
#undef LOOP
  if (b->conserve)
    pass_stretch(b->warp == SHADE_WARP_SMOOTH, b->projected, count, n, h, d);
}

/* Slopes of a direction, carried as h is, to 1 + 2 Lambda. */
LEAF void pass_smith_of(shade_mdf mdf, size_t count, const lobe_shape *s, const real *restrict xx,
                        const real *restrict yy, real *restrict l) {
  const real *restrict gx = s->gx, *restrict gy = s->gy;
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    l[i] = smith_value(mdf, gx[i] * xx[i] + gy[i] * yy[i]);
}
static void pass_smith(const bsdf *b, const lobe_shape *s, size_t count, const real *xx,
                       const real *yy, real *l) {
#define LOOP(mdf) pass_smith_of(mdf, count, s, xx, yy, l)
  SHADE_LOOP_OF(MDF, b->mdf)
#undef LOOP
}

#endif
