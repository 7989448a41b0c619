/* SPDX-License-Identifier: Apache-2.0 */
/* multiscatter.h over a block. */
#ifndef SHADE_BATCH_MULTISCATTER_BLOCK_H
#define SHADE_BATCH_MULTISCATTER_BLOCK_H

#include "../model/multiscatter.h"
#include "lobe_block.h"

LEAF void pass_loss_of(shade_mdf mdf, size_t count, const lobe_shape *s, const real *restrict xx,
                       const real *restrict yy, real *restrict loss) {
  const real *restrict gx = s->gx, *restrict gy = s->gy;
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    loss[i] = albedo_loss(mdf, (lobe_point){0, xx[i], yy[i]}, gx[i], gy[i]);
}

LEAF void pass_gain_of(shade_fresnel fresnel, size_t count, const real *restrict f0,
                       const real *restrict tint, const real *restrict k, const real *restrict loss,
                       real *restrict out) {
  const shade_fresnel_traits reads = shade_fresnel_is(fresnel);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const real mean =
        fresnel_mean(fresnel, reads.f0 ? f0[i] : 0, reads.tint ? tint[i] : 0, reads.k ? k[i] : 0);
    out[i] *= multiscatter(mean, loss[i]);
  }
}

/* f, its three channels in `out`, with what leaves after more than one reflection. t, xx, yy and
 * loss are scratch. */
static void multiscatter_block(const bsdf *b, const sample_block *s, real *t, real *xx, real *yy,
                               real *loss, real *const out[3]) {
  pass_detail(b->carry.shadow, s->count, s->n, s->wo, t, xx, yy);
#define LOSS_LOOP(NAME, word)                                                                      \
  if (b->mdf == SHADE_MDF_##NAME)                                                                  \
    pass_loss_of(SHADE_MDF_##NAME, s->count, &s->shape, xx, yy, loss);
  SHADE_MDF_VISIBLE(LOSS_LOOP)
#undef LOSS_LOOP
  for (int c = 0; c < 3; c++) {
#define LOOP(fresnel) pass_gain_of(fresnel, s->count, s->f0[c], s->tint[c], s->k[c], loss, out[c])
    SHADE_LOOP_OF(FRESNEL, b->fresnel)
#undef LOOP
  }
}

#endif
