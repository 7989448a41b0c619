/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Directions that the passes cannot take as they are. The check is cheap and
 * runs on every lane; the mending is a slow path that few samples ever see.
 */

/*
 * Nonzero when the vector's length is more than a few roundings off 1, or it is not
 * finite. rotate's leaf is not homogeneous in n: an excess of s in its length would
 * change D by a factor of about exp(-2 s ln D).
 */
LEAF int FN(off_unit)(real x, real y, real z) {
  const real slack = SHADE_FLOAT ? R(2e-6) : R(1e-14);
  real excess = x * x + y * y + z * z - 1;
  return !(excess > -slack && excess < slack);
}

/*
 * Make v unit. Returns 0, leaving v = z, when v is 0 or not finite. Scaling by the
 * largest component first keeps the square in range. Length and components are off by at most
 * 2e-7 (float) or 3e-16 (double), whatever the size of v.
 */
static inline int FN(make_unit)(real v[3]) {
  real largest = 0;
  int finite = 1;
  for (int i = 0; i < 3; i++) {
    real size = v[i] < 0 ? -v[i] : v[i];
    finite &= size - size == 0;
    largest = FN(maximum)(largest, size);
  }
  if (!finite || largest == 0) {
    v[0] = v[1] = 0;
    v[2] = 1;
    return 0;
  }
  for (int pass = 0; pass < 2; pass++) {
    for (int i = 0; i < 3; i++)
      v[i] /= largest;
    largest = FN(root)(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  return 1;
}

/* Unit, then n.z > 0: the nearest normal the methods are defined for. */
static inline unsigned FN(mend_normal)(real n[3]) {
  unsigned status = FN(make_unit)(n) ? SHADE_OK : SHADE_BAD_INPUT;
  if (!(n[2] > 0)) {
    n[2] = R(1e-4);
    FN(make_unit)(n);
    status |= SHADE_CLAMPED_NORMAL;
  }
  return status;
}

static inline unsigned FN(mend_if_needed)(real v[3], int is_normal) {
  if (is_normal && !(v[2] > 0))
    return FN(mend_normal)(v);
  if (FN(off_unit)(v[0], v[1], v[2]) && !FN(make_unit)(v))
    return SHADE_BAD_INPUT;
  return SHADE_OK;
}
