/* SPDX-License-Identifier: Apache-2.0 */
/* Into the frame that half vectors are drawn in, and out of it: a rotation, or through a warp. */
#ifndef SHADE_BATCH_FRAME_BLOCK_H
#define SHADE_BATCH_FRAME_BLOCK_H

#include "../model/frame.h"
#include "vec.h"

LEAF void pass_into(shade_map frame, size_t count, vec n, vec w, real *restrict ox,
                    real *restrict oy) {
  ARRAYS(n);
  ARRAYS(w);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const pair o = into_frame(frame, AT(n), AT(w));
    ox[i] = o.x;
    oy[i] = o.y;
  }
}

/* Visible normals are drawn in rigid frames only. */
static void pass_into_frame(shade_map frame, size_t count, vec n, vec w, real *ox, real *oy){
#define LOOP(frame) pass_into(frame, count, n, w, ox, oy)
    SHADE_LOOP_OF_FRAME(frame)
#undef LOOP
}

LEAF void pass_out(shade_map frame, size_t count, vec n, real *restrict hx, real *restrict hy,
                   real *restrict hz) {
  ARRAYS(n);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const triple h = out_of_frame(frame, AT(n), (triple){hx[i], hy[i], hz[i]});
    hx[i] = h.x;
    hy[i] = h.y;
    hz[i] = h.z;
  }
}

/* From the carried frame to the local one, in place. */
static void pass_out_of_frame(shade_map frame, size_t count, vec n, real *hx, real *hy, real *hz) {
#define LOOP(frame) pass_out(frame, count, n, hx, hy, hz)
  SHADE_LOOP_OF_FRAME(frame)
#undef LOOP
}

#endif
