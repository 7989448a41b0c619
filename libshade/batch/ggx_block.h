/* SPDX-License-Identifier: Apache-2.0 */
/* ggx.h over a block: one loop. */
#ifndef SHADE_BATCH_GGX_BLOCK_H
#define SHADE_BATCH_GGX_BLOCK_H

#include "../model/ggx.h"
#include "lobe_block.h"

#define GGX_PASS(name, leaf, lobe)                                                                 \
  static int name(size_t count, const lobe_shape *s, int swap, VEC(n), VEC(wi), VEC(wo),           \
                  real *restrict hwo, real *restrict cosi, real *restrict coso,                    \
                  real *restrict f) {                                                              \
    int opposite = 0;                                                                              \
    const ggx_lobe own = ggx_own((lobe_numbers){*s->kx, *s->ky, *s->peak, *s->gx, *s->gy}, swap);  \
    const real *restrict ax = swap ? s->ay : s->ax, *restrict ay = swap ? s->ax : s->ay;           \
    (void)own, (void)ax, (void)ay;                                                                 \
    _Pragma("omp simd reduction(| : opposite)") for (size_t i = 0; i < count; i++) {               \
      real hx = wix[i] + wox[i], hy = wiy[i] + woy[i], hz = wiz[i] + woz[i];                       \
      real hh = hx * hx + hy * hy + hz * hz;                                                       \
      ggx_sample r =                                                                               \
          leaf(nx[i], ny[i], nz[i], wix[i], wiy[i], wiz[i], wox[i], woy[i], woz[i], hh, lobe);     \
      hwo[i] = r.hwo;                                                                              \
      cosi[i] = r.cosi;                                                                            \
      coso[i] = r.coso;                                                                            \
      f[i] = r.f;                                                                                  \
      opposite |= r.opposite;                                                                      \
    }                                                                                              \
    return opposite;                                                                               \
  }
GGX_PASS(pass_ggx_flat, ggx_flat, own)
GGX_PASS(pass_ggx_rotated, ggx_rotated, own)
GGX_PASS(pass_each_ggx_flat, ggx_flat, ggx_of_alphas(ax[i], ay[i]))
GGX_PASS(pass_each_ggx_rotated, ggx_rotated, ggx_of_alphas(ax[i], ay[i]))
#undef GGX_PASS

/* hwo, the cosines as pass_cosines leaves them, and f without Fresnel; returns as pass_half. */
LEAF int pass_fused(const bsdf *b, const sample_block *s, real *hwo, real *cosi, real *coso,
                    real *f) {
  const int varies = s->shape.varies;
  if (b->carry.map == SHADE_MAP_NONE)
    return (varies ? pass_each_ggx_flat : pass_ggx_flat)(
        s->count, &s->shape, 0, XYZ(s->n), XYZ(s->wi), XYZ(s->wo), hwo, cosi, coso, f);
  if (b->carry.map == SHADE_MAP_ROTATE_X)
    return (varies ? pass_each_ggx_rotated : pass_ggx_rotated)(
        s->count, &s->shape, 0, XYZ(s->n), XYZ(s->wi), XYZ(s->wo), hwo, cosi, coso, f);
  return (varies ? pass_each_ggx_rotated : pass_ggx_rotated)(
      s->count, &s->shape, 1, XYZ(vec_swapped(s->n)), XYZ(vec_swapped(s->wi)),
      XYZ(vec_swapped(s->wo)), hwo, cosi, coso, f);
}

#endif
