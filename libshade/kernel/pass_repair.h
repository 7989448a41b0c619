/* SPDX-License-Identifier: Apache-2.0 */
/* Finds blocks that hold a direction the passes cannot take, and mends a copy. */

/* Nonzero when some direction is off unit. */
LEAF int FN(pass_check)(size_t count, FN(vec) v) {
  real_bits far = 0, uneven = 0;
  ARRAYS(v);
#pragma omp simd reduction(| : far, uneven)
  for (size_t i = 0; i < count; i++) {
    far |= FN(far_bits)(vx[i], vy[i], vz[i]);
    uneven |= FN(uneven_bits)(vx[i], vy[i], vz[i]);
  }
  return FN(off_unit)(far, uneven);
}

/* For normals: nor is z above 0. Less 1, 0 has the sign bit and -0 FAR_BIT. */
LEAF int FN(pass_check_normal)(size_t count, FN(vec) v) {
  real_bits far = 0, uneven = 0, below = 0;
  ARRAYS(v);
#pragma omp simd reduction(| : far, uneven, below)
  for (size_t i = 0; i < count; i++) {
    far |= FN(far_bits)(vx[i], vy[i], vz[i]);
    uneven |= FN(uneven_bits)(vx[i], vy[i], vz[i]);
    below |= FN(to_bits)(vz[i]) - 1;
  }
  return FN(off_unit)(far, uneven) || (below & (SIGN_BIT | FAR_BIT));
}

/* Room for the mended copies of a block's directions. */
typedef struct FN(mended) {
  FN(vec_room) v[3];
  unsigned char void_lane[BLOCK]; /* 1: no direction could be made out; the result is 0 */
} FN(mended);

/*
 * Point the directions (*v[0] a normal) at mended copies where the block needs it. Returns status
 * bits; with SHADE_BAD_INPUT void_lane is filled.
 */
static unsigned FN(mend_block)(size_t count, int vectors, FN(vec) *const v[3], FN(mended) * m) {
  int bad = FN(pass_check_normal)(count, *v[0]);
  for (int k = 1; k < vectors; k++)
    bad |= FN(pass_check)(count, *v[k]);
  if (!bad)
    return SHADE_OK;
  unsigned status = SHADE_OK;
  for (size_t i = 0; i < count; i++) {
    unsigned lane = SHADE_OK;
    for (int k = 0; k < vectors; k++) {
      real w[3] = {v[k]->x[i], v[k]->y[i], v[k]->z[i]};
      lane |= FN(mend_if_needed)(w, k == 0);
      m->v[k].x[i] = w[0];
      m->v[k].y[i] = w[1];
      m->v[k].z[i] = w[2];
    }
    m->void_lane[i] = (lane & SHADE_BAD_INPUT) != 0;
    status |= lane;
  }
  for (int k = 0; k < vectors; k++)
    *v[k] = FN(vec_in)(&m->v[k]);
  return status;
}
