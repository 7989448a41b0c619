/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Detail pass: perturbed normals and half vectors to points of the lobe, one
 * loop per map so that no lane decides anything. Arrays are at most
 * BLOCK long and do not overlap.
 */
#ifndef SHADE_BATCH_DETAIL_BLOCK_H
#define SHADE_BATCH_DETAIL_BLOCK_H

#include "../model/detail.h"
#include "vec.h"

LEAF void pass_detail_of(shade_map map, size_t count, vec n, vec h, real *restrict t,
                         real *restrict xx, real *restrict yy) {
  ARRAYS(n);
  ARRAYS(h);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const lobe_point p = lobe_at(detail(map, AT(n), AT(h)));
    t[i] = p.t;
    xx[i] = p.xx;
    yy[i] = p.yy;
  }
}
static void pass_detail(shade_map map, size_t count, vec n, vec h, real *t, real *xx, real *yy) {
#define LOOP(map) pass_detail_of(map, count, n, h, t, xx, yy)
  SHADE_LOOP_OF_MAP(map)
#undef LOOP
}

#endif
