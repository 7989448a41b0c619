/* SPDX-License-Identifier: Apache-2.0 */
/* D and 1 + 2 Lambda of a material's lobe. */
#ifndef SHADE_MODEL_LOBE_H
#define SHADE_MODEL_LOBE_H

#include "bsdf.h"
#include "mdf.h"

/* What a distribution reads, SLOPES or RATIO, after another word. */
#define BY_FORM_(what, form) what##form
#define BY_FORM(what, form) BY_FORM_(what, form)

/* D of h, which is unit for the warps. */
LEAF real lobe(const bsdf *b, triple n, triple h) {
  const real kx = numbers_of(b)->kx, ky = numbers_of(b)->ky, peak = numbers_of(b)->peak;
  const lobe_ratio r = detail(b->carry.map, n, h);
  real d = 0;
  switch (b->mdf) {
#define READ_RATIO(r) (r)
#define READ_SLOPES(r) lobe_at(r)
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    d = word(BY_FORM(READ_, SHADE_MDF_##NAME##_FORM)(r), kx, ky, peak);                            \
    break;
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
#undef READ_SLOPES
#undef READ_RATIO
  case SHADE_MDF_COUNT:
    break;
  }
  if (b->conserve)
    d *= warp_stretch(n.x, n.y, n.z, h.x, h.y, h.z, b->warp == SHADE_WARP_SMOOTH, b->projected);
  return d;
}

/* 1 + 2 Lambda of w. */
LEAF real smith(const bsdf *b, triple n, triple w) {
  lobe_point p = lobe_at(detail(b->carry.shadow, n, w));
  real slope2 = numbers_of(b)->gx * p.xx + numbers_of(b)->gy * p.yy;
  switch (b->mdf) {
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    return smith_##word(slope2);
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
  return 1;
}

#endif
