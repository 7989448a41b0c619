/* SPDX-License-Identifier: Apache-2.0 */
/* Into the frame that half vectors are drawn in, and out of it: a rotation, or through a warp. */
#ifndef SHADE_BATCH_FRAME_BLOCK_H
#define SHADE_BATCH_FRAME_BLOCK_H

#include "../model/brdf.h"
#include "../model/frame.h"
#include "vec.h"

#define FRAME_PASS(NAME, name)                                                                     \
  /* a direction in the frame */                                                                   \
  static void pass_into_##name(size_t count, vec n, vec w, real *restrict ox, real *restrict oy) { \
    ARRAYS(n);                                                                                     \
    ARRAYS(w);                                                                                     \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      axes f = axes_##name(nx[i], ny[i], nz[i]);                                                   \
      ox[i] = f.x.x * wx[i] + f.x.y * wy[i] + f.x.z * wz[i];                                       \
      oy[i] = f.y.x * wx[i] + f.y.y * wy[i] + f.y.z * wz[i];                                       \
    }                                                                                              \
  }                                                                                                \
  /* and back, in place */                                                                         \
  static void pass_out_of_##name(size_t count, vec n, real *restrict hx, real *restrict hy,        \
                                 real *restrict hz) {                                              \
    ARRAYS(n);                                                                                     \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      axes f = axes_##name(nx[i], ny[i], nz[i]);                                                   \
      real x = hx[i], y = hy[i], z = hz[i];                                                        \
      hx[i] = f.x.x * x + f.y.x * y + nx[i] * z;                                                   \
      hy[i] = f.x.y * x + f.y.y * y + ny[i] * z;                                                   \
      hz[i] = f.x.z * x + f.y.z * y + nz[i] * z;                                                   \
    }                                                                                              \
  }

SHADE_FRAME_ROWS(FRAME_PASS)
#undef FRAME_PASS

/* `smooth` is a constant where it is called: chosen in the loop, gcc computes what other lanes
 * held. */
LEAF void pass_forward(size_t count, int smooth, vec n, real *restrict hx, real *restrict hy,
                       real *restrict hz) {
  ROOM v[BLOCK];
  ARRAYS(n);
  (void)nz;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real scale = scale_to_unit(hx[i], hy[i], hz[i]);
    hx[i] *= scale;
    hy[i] *= scale;
    real z = hz[i] * scale;
    real linear = z * z / (1 + root(hx[i] * hx[i] + hy[i] * hy[i]));
    v[i] = smooth ? warp_start(nx[i], ny[i], hx[i], hy[i]) : 1 - linear;
    hz[i] = linear;
  }
  for (int step = 0; smooth && step < warp_steps; step++)
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      v[i] = warp_step(nx[i], ny[i], hx[i], hy[i], v[i]);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real w = smooth ? 1 - v[i] : hz[i];
    triple h = warp_shifted(nx[i], ny[i], hx[i], hy[i], w);
    hx[i] = h.x;
    hy[i] = h.y;
    hz[i] = h.z;
  }
}

/* Visible normals are drawn in rigid frames only. */
static void pass_into_frame(shade_map frame, size_t count, vec n, vec w, real *ox, real *oy) {
  switch (frame) {
#define INTO_CASE(NAME, name)                                                                      \
  case SHADE_MAP_##NAME:                                                                           \
    pass_into_##name(count, n, w, ox, oy);                                                         \
    break;
    SHADE_FRAME_ROWS(INTO_CASE)
#undef INTO_CASE
  default:
    memcpy(ox, w.x, count * sizeof *ox);
    memcpy(oy, w.y, count * sizeof *oy);
  }
}

/* From the carried frame to the local one, in place. */
static void pass_out_of_frame(shade_map frame, size_t count, vec n, real *hx, real *hy, real *hz) {
  switch (frame) {
  case SHADE_MAP_DEFORM_LINEAR:
    pass_forward(count, 0, n, hx, hy, hz);
    break;
  case SHADE_MAP_DEFORM_SMOOTH:
    pass_forward(count, 1, n, hx, hy, hz);
    break;
#define OUT_CASE(NAME, name)                                                                       \
  case SHADE_MAP_##NAME:                                                                           \
    pass_out_of_##name(count, n, hx, hy, hz);                                                      \
    break;
    SHADE_FRAME_ROWS(OUT_CASE)
#undef OUT_CASE
  default: /* that of z */
    break;
  }
}

#endif
