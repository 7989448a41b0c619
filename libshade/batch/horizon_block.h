/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What the choices of SHADE_TABLE_HORIZON do around the evaluation of `hard`: n bent before it, a
 * factor after it, or three of it.
 */
#ifndef SHADE_BATCH_HORIZON_BLOCK_H
#define SHADE_BATCH_HORIZON_BLOCK_H

#include "../model/horizon.h"
#include "../model/single.h"
#include "bsdf_block.h"

static void pass_bend(size_t count, vec n, vec wo, vec_room *restrict bent) {
  ARRAYS(n);
  ARRAYS(wo);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    normal b = bend(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    bent->x[i] = b.x;
    bent->y[i] = b.y;
    bent->z[i] = b.z;
  }
}

/* factor[i] of a direction w[i] under n[i]. */
#define HORIZON_PASS(name)                                                                         \
  static void pass_##name(size_t count, vec n, vec w, real *restrict factor) {                     \
    ARRAYS(n);                                                                                     \
    ARRAYS(w);                                                                                     \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) factor[i] =                             \
        name(nx[i], ny[i], nz[i], wx[i], wy[i], wz[i]);                                            \
  }

HORIZON_PASS(shadow_estevez)
HORIZON_PASS(shadow_chiang)
HORIZON_PASS(share_bumped)
HORIZON_PASS(share_upright)
#undef HORIZON_PASS

static void pass_mirror(size_t count, vec n, vec w, real *restrict mx, real *restrict my) {
  ARRAYS(n);
  ARRAYS(w);
  (void)nz, (void)wz;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real step = mirror_step(nx[i], ny[i], wx[i], wy[i]);
    mx[i] = multiply_add(-step, nx[i], wx[i]);
    my[i] = multiply_add(-step, ny[i], wy[i]);
  }
}

static void pass_multiply(size_t count, const real *restrict factor, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] *= factor[i];
}

/*
 * nz a b, once for all colours. In the loop over colours the product could be taken of whole
 * scratch arrays, and meet what no lane wrote.
 */
static void pass_weight(size_t count, const real *restrict nz, const real *restrict a,
                        const real *restrict b, real *restrict weight) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    weight[i] = nz[i] * (a[i] * b[i]);
}

static void pass_add_product(size_t count, const real *restrict weight, const real *restrict f,
                             real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] += weight[i] * f[i];
}

/* One block of facets with normal n and of upright mirrors. */
static unsigned facets_block(const bsdf *b, const sample_block *s, const results *out) {
  const size_t size = s->count;
  ROOM x[BLOCK], y[BLOCK], rgb[3][BLOCK], unused[BLOCK], weight[BLOCK];
  ROOM see[2][2][BLOCK]; /* [light, eye][bumped, upright] */
  const results extra = {{rgb[0], rgb[1], rgb[2]}, unused};
  const vec w[2] = {s->wi, s->wo};
  for (int k = 0; k < 2; k++) {
    pass_share_bumped(size, s->n, w[k], see[k][0]);
    pass_share_upright(size, s->n, w[k], see[k][1]);
  }
  unsigned status = hard_block(b, s, out);
  pass_weight(size, s->n.z, see[0][0], see[1][0], weight);
  for (int c = 0; c < 3; c++)
    pass_multiply(size, weight, out->rgb[c]);
  for (int k = 0; k < 2; k++) {
    sample_block mirrored = *s;
    pass_mirror(size, s->n, w[k], x, y);
    *(k == 0 ? &mirrored.wi : &mirrored.wo) = (vec){x, y, w[k].z};
    hard_block(b, &mirrored, &extra);
    pass_weight(size, s->n.z, see[0][k == 0], see[1][k == 1], weight);
    for (int c = 0; c < 3; c++)
      pass_add_product(size, weight, rgb[c], out->rgb[c]);
  }
  for (size_t i = 0; status & SHADE_BAD_INPUT && i < size; i++)
    if (opposite(w[0].x[i], w[0].y[i], w[0].z[i], w[1].x[i], w[1].y[i], w[1].z[i]))
      out->rgb[0][i] = out->rgb[1][i] = out->rgb[2][i] = 0;
  for (size_t i = 0; i < size; i++)
    out->cosine[i] = w[0].z[i] > 0 ? w[0].z[i] : 0;
  return status;
}

/*
 * No bumps here, so that all choices are `hard` (to a rounding for two facets, which are left
 * alone): flat surfaces are not to pay for the others.
 */
static int is_flat(const bsdf *b, size_t count, const real *nx, const real *ny) {
  int bumps = nx[0] != 0 || ny[0] != 0 || shade_horizon_is(b->horizon).facets;
  if (bumps)
    return 0;
#pragma omp simd reduction(| : bumps)
  for (size_t i = 0; i < count; i++)
    bumps |= (nx[i] != 0) | (ny[i] != 0);
  return !bumps;
}

#endif
