/* SPDX-License-Identifier: Apache-2.0 */
/* ggx.h over a block: one loop. */
#ifndef SHADE_BATCH_GGX_BLOCK_H
#define SHADE_BATCH_GGX_BLOCK_H

#include "../model/ggx.h"
#include "lobe_block.h"

LEAF int pass_ggx(int flat, size_t count, lobe_shape s, vec n, vec wi, vec wo, real *restrict hwo,
                  real *restrict cosi, real *restrict coso, real *restrict f) {
  int opposite = 0;
  const real *restrict kx = s.kx, *restrict ky = s.ky, *restrict peak = s.peak;
  const real *restrict gx = s.gx, *restrict gy = s.gy;
  ARRAYS(n);
  ARRAYS(wi);
  ARRAYS(wo);
#pragma omp simd reduction(| : opposite)
  for (size_t i = 0; i < count; i++) {
    const lobe_numbers lobe = {kx[i], ky[i], peak[i], gx[i], gy[i]};
    const ggx_sample r = ggx_fused(flat, AT(n), AT(wi), AT(wo), lobe);
    hwo[i] = r.hwo;
    cosi[i] = r.cosi;
    coso[i] = r.coso;
    f[i] = r.f;
    opposite |= r.opposite;
  }
  return opposite;
}

/* hwo, the cosines as pass_cosines leaves them, and f without Fresnel; returns as pass_half. */
static int pass_fused(const bsdf *b, const sample_block *s, real *hwo, real *cosi, real *coso,
                      real *f) {
  const lobe_shape l = s->shape, swapped = {l.ky, l.kx, l.peak, l.gy, l.gx};
  if (b->carry.map == SHADE_MAP_NONE)
    return pass_ggx(1, s->count, l, s->n, s->wi, s->wo, hwo, cosi, coso, f);
  if (b->carry.map == SHADE_MAP_ROTATE_X)
    return pass_ggx(0, s->count, l, s->n, s->wi, s->wo, hwo, cosi, coso, f);
  return pass_ggx(0, s->count, swapped, vec_swapped(s->n), vec_swapped(s->wi), vec_swapped(s->wo),
                  hwo, cosi, coso, f);
}

#endif
