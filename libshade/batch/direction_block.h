/* SPDX-License-Identifier: Apache-2.0 */
/* Finds blocks that hold a direction the passes cannot take, and mends a copy. */
#ifndef SHADE_BATCH_DIRECTION_BLOCK_H
#define SHADE_BATCH_DIRECTION_BLOCK_H

#include "../model/direction.h"
#include "vec.h"

/* Whether every v is unit. */
static int are_unit(size_t count, vec v) {
  real_bits off = 0;
  ARRAYS(v);
#pragma omp simd reduction(| : off)
  for (size_t i = 0; i < count; i++)
    off |= off_unit(far_bits(vx[i], vy[i], vz[i]), uneven_bits(vx[i], vy[i], vz[i]));
  return !off;
}

/* Whether the passes take n, a and b (which may be a) as they are; a normal is above the surface:
 * n.z less 1 has the sign bit for 0 and FAR_BIT for -0. One loop, for short blocks: to or the lanes
 * of a vector takes as long as ten samples. */
LEAF int all_flawless(size_t count, vec n, vec a, vec b) {
  real_bits off = 0;
  ARRAYS(n);
  ARRAYS(a);
  ARRAYS(b);
#pragma omp simd reduction(| : off)
  for (size_t i = 0; i < count; i++)
    off |= off_unit(far_bits(nx[i], ny[i], nz[i]) | far_bits(ax[i], ay[i], az[i]) |
                        far_bits(bx[i], by[i], bz[i]),
                    uneven_bits(nx[i], ny[i], nz[i]) | uneven_bits(ax[i], ay[i], az[i]) |
                        uneven_bits(bx[i], by[i], bz[i])) |
           ((to_bits(nz[i]) - 1) & (SIGN_BIT | FAR_BIT));
  return !off;
}

/* Room for the mended copies of a block's directions. */
typedef struct mended_room {
  vec_room v[3];
  unsigned char void_lane[BLOCK]; /* 1: no direction could be made out; the result is 0 */
} mended_room;

static __attribute__((noinline)) unsigned mend_lanes(size_t count, int vectors, const vec v[3],
                                                     mended_room *m) {
  unsigned status = SHADE_OK;
  for (size_t i = 0; i < count; i++) {
    unsigned lane = SHADE_OK;
    for (int k = 0; k < vectors; k++) {
      real w[3] = {v[k].x[i], v[k].y[i], v[k].z[i]};
      lane |= mend_if_needed(w, k == 0);
      m->v[k].x[i] = w[0];
      m->v[k].y[i] = w[1];
      m->v[k].z[i] = w[2];
    }
    m->void_lane[i] = (lane & SHADE_BAD_INPUT) != 0;
    status |= lane;
  }
  return status;
}

/* What is nearly unit made so, the same as mend_if_needed; returns whether all were. */
LEAF int straighten(size_t count, vec v, int is_normal, vec_room *to) {
  real_bits bad = 0;
  ARRAYS(v);
#pragma omp simd reduction(| : bad)
  for (size_t i = 0; i < count; i++) {
    const nearly_unit near = nearly_unit_of(vx[i], vy[i], vz[i]);
    bad |= near.bits | (real_bits)(is_normal && !(vz[i] > 0));
    to->x[i] = near.x;
    to->y[i] = near.y;
    to->z[i] = near.z;
  }
  return !bad;
}

/*
 * Point the directions (*v[0] a normal) at mended copies where the block needs it. Returns status
 * bits; with SHADE_BAD_INPUT void_lane is filled.
 */
static unsigned mend_block(size_t count, int vectors, vec *const v[3], mended_room *m) {
  const vec given[3] = {*v[0], *v[1], *v[vectors - 1]};
  if (all_flawless(count, given[0], given[1], given[2]))
    return SHADE_OK;
  int near = 1;
  for (int k = 0; k < vectors; k++) {
    near = near && straighten(count, given[k], k == 0, &m->v[k]);
    *v[k] = vec_in(&m->v[k]);
  }
  return near ? SHADE_OK : mend_lanes(count, vectors, given, m);
}

#endif
