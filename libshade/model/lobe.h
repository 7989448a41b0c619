/* SPDX-License-Identifier: Apache-2.0 */
/* D and 1 + 2 Lambda of a material's lobe. */
#ifndef SHADE_MODEL_LOBE_H
#define SHADE_MODEL_LOBE_H

#include "bsdf.h"
#include "mdf.h"

/* D of h, which is unit for the warps. */
LEAF real lobe(const bsdf *b, triple n, triple h) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  const lobe_point p = lobe_at(detail(b->carry.map, n, h));
  const real d = mdf_value(b->mdf, p, own->kx, own->ky, own->peak);
  if (!b->conserve)
    return d;
  return d * warp_stretch(XYZ(n), XYZ(h), b->warp == SHADE_WARP_SMOOTH, b->projected);
}

/* 1 + 2 Lambda of w. */
LEAF real smith(const bsdf *b, triple n, triple w) {
  const lobe_point p = lobe_at(detail(b->carry.shadow, n, w));
  return smith_value(b->mdf, numbers_of(b)->gx * p.xx + numbers_of(b)->gy * p.yy);
}

#endif
