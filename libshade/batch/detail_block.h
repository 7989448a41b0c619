/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Detail pass: perturbed normals and half vectors to points of the lobe, one
 * loop per leaf so that no lane decides anything. Arrays are at most
 * BLOCK long and do not overlap.
 */
#ifndef SHADE_BATCH_DETAIL_BLOCK_H
#define SHADE_BATCH_DETAIL_BLOCK_H

#include "../model/detail.h"
#include "vec.h"

#define DETAIL_PASS(leaf, with)                                                                    \
  static void pass_##leaf(size_t count, VEC(n), VEC(h), real *restrict t, real *restrict xx,       \
                          real *restrict yy) {                                                     \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      lobe_point p = lobe_at(detail_##leaf(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i]));             \
      t[i] = p.t;                                                                                  \
      xx[i] = p.xx;                                                                                \
      yy[i] = p.yy;                                                                                \
    }                                                                                              \
  }
SHADE_MAP_LEAVES(DETAIL_PASS, )
#undef DETAIL_PASS

LEAF void pass_detail(shade_map map, size_t count, vec n, vec h, real *t, real *xx, real *yy) {
  switch (map) {
#define MAP_CASE(NAME, leaf, along_y, kind, frame, with)                                           \
  case SHADE_MAP_##NAME:                                                                           \
    if (along_y)                                                                                   \
      pass_##leaf(count, XYZ(vec_swapped(n)), XYZ(vec_swapped(h)), t, yy, xx);                     \
    else                                                                                           \
      pass_##leaf(count, XYZ(n), XYZ(h), t, xx, yy);                                               \
    break;
    SHADE_MAP_ROWS(MAP_CASE, )
#undef MAP_CASE
  case SHADE_MAP_COUNT:
    break;
  }
}

#endif
