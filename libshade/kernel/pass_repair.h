/* SPDX-License-Identifier: Apache-2.0 */
/* Finds blocks that hold a direction the passes cannot take, and mends a copy. */

/* Nonzero when some direction is off unit. */
static int FN(pass_check)(size_t count, const real *restrict x, const real *restrict y,
                          const real *restrict z) {
  real_bits far = 0, uneven = 0;
#pragma omp simd reduction(| : far, uneven)
  for (size_t i = 0; i < count; i++) {
    far |= FN(far_bits)(x[i], y[i], z[i]);
    uneven |= FN(uneven_bits)(x[i], y[i], z[i]);
  }
  return FN(off_unit)(far, uneven);
}

/* For normals: nor is z above 0. Less 1, 0 has the sign bit and -0 FAR_BIT. */
static int FN(pass_check_normal)(size_t count, const real *restrict x, const real *restrict y,
                                 const real *restrict z) {
  real_bits far = 0, uneven = 0, below = 0;
#pragma omp simd reduction(| : far, uneven, below)
  for (size_t i = 0; i < count; i++) {
    far |= FN(far_bits)(x[i], y[i], z[i]);
    uneven |= FN(uneven_bits)(x[i], y[i], z[i]);
    below |= FN(to_bits)(z[i]) - 1;
  }
  return FN(off_unit)(far, uneven) || (below & (SIGN_BIT | FAR_BIT));
}

/* Room for the mended copies of a block's directions. */
typedef struct FN(mended) {
  real x[3][BLOCK], y[3][BLOCK], z[3][BLOCK];
  unsigned char void_lane[BLOCK]; /* 1: no direction could be made out; the result is 0 */
} FN(mended);

/*
 * Point v[k] = {x, y, z} (v[0] the normal, the others directions) at mended copies where
 * the block needs it. Returns status bits; with SHADE_BAD_INPUT void_lane is filled.
 */
static unsigned FN(mend_block)(size_t count, int vectors, const real *v[][3], FN(mended) * m) {
  int bad = FN(pass_check_normal)(count, v[0][0], v[0][1], v[0][2]);
  for (int k = 1; k < vectors; k++)
    bad |= FN(pass_check)(count, v[k][0], v[k][1], v[k][2]);
  if (!bad)
    return SHADE_OK;
  unsigned status = SHADE_OK;
  for (size_t i = 0; i < count; i++) {
    unsigned lane = SHADE_OK;
    for (int k = 0; k < vectors; k++) {
      real w[3] = {v[k][0][i], v[k][1][i], v[k][2][i]};
      lane |= FN(mend_if_needed)(w, k == 0);
      m->x[k][i] = w[0];
      m->y[k][i] = w[1];
      m->z[k][i] = w[2];
    }
    m->void_lane[i] = (lane & SHADE_BAD_INPUT) != 0;
    status |= lane;
  }
  for (int k = 0; k < vectors; k++) {
    v[k][0] = m->x[k];
    v[k][1] = m->y[k];
    v[k][2] = m->z[k];
  }
  return status;
}
