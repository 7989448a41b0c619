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

/*
 * What is wrong with a block's directions, or-ed over its lanes. AVX-512 takes one word, masked in
 * every lane: a mask and an or are one instruction there, and to or the lanes of a register takes
 * as long as ten samples. Elsewhere masks are dear: three words, masked once.
 */
#if defined(__AVX512F__)
#define FLAWS_IN_ONE_WORD 1
#else
#define FLAWS_IN_ONE_WORD 0
#endif
typedef struct flaws {
  real_bits far, uneven, below;
} flaws;

/* Not 0 where a vector is not unit or n not above the surface. `below` is of n.z less 1: 0 has the
 * sign bit and -0 FAR_BIT. */
LEAF real_bits any_flaw(flaws f) {
  return off_unit(f.far, f.uneven) | (f.below & (SIGN_BIT | FAR_BIT));
}

LEAF flaws flaws_of_lane(flaws f) {
  return FLAWS_IN_ONE_WORD ? (flaws){any_flaw(f), 0, 0} : f;
}

LEAF int are_flawless(flaws all) {
  return !(FLAWS_IN_ONE_WORD ? all.far : any_flaw(all));
}

/* Whether the passes take every n, a and b (which may be a) as they are. One loop. */
LEAF int is_mended(size_t count, vec n, vec a, vec b) {
  real_bits far = 0, uneven = 0, below = 0;
  ARRAYS(n);
  ARRAYS(a);
  ARRAYS(b);
#pragma omp simd reduction(| : far, uneven, below)
  for (size_t i = 0; i < count; i++) {
    const flaws lane = flaws_of_lane((flaws){
        .far = far_bits(nx[i], ny[i], nz[i]) | far_bits(ax[i], ay[i], az[i]) |
               far_bits(bx[i], by[i], bz[i]),
        .uneven = uneven_bits(nx[i], ny[i], nz[i]) | uneven_bits(ax[i], ay[i], az[i]) |
                  uneven_bits(bx[i], by[i], bz[i]),
        .below = to_bits(nz[i]) - 1,
    });
    far |= lane.far;
    uneven |= lane.uneven;
    below |= lane.below;
  }
  return are_flawless((flaws){far, uneven, below});
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
 * bits; with SHADE_BAD_INPUT void_lane is filled. The slow paths see copies of the directions, so
 * that they may stay in registers.
 */
LEAF unsigned mend_block(size_t count, int vectors, vec *const v[3], mended_room *m) {
  const vec given[3] = {*v[0], *v[1], *v[vectors - 1]};
  if (is_mended(count, given[0], given[1], given[2]))
    return SHADE_OK;
  int near = 1;
  for (int k = 0; k < vectors; k++) {
    near = near && straighten(count, given[k], k == 0, &m->v[k]);
    *v[k] = vec_in(&m->v[k]);
  }
  return near ? SHADE_OK : mend_lanes(count, vectors, given, m);
}

#endif
