/* SPDX-License-Identifier: Apache-2.0 */
/*
 * n and h to D in one loop, for `fast`; shade_bsdf_setup sets it only for the maps below. Not
 * inlined: among the loops that check directions gcc would keep its constants in memory.
 */
#define FAST_PASS(leaf)                                                                            \
  static __attribute__((noinline)) void pass_fast_##leaf(                                          \
      size_t count, float kx, float ky, float peak, VEC(n), VEC(h), float *restrict d) {           \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) d[i] =                                  \
        fast_##leaf(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i], kx, ky, peak);                       \
  }
FAST_PASS(none)
FAST_PASS(perturb_ratio)
FAST_PASS(rotate_ratio)
#undef FAST_PASS

LEAF void pass_fast(const bsdf *b, size_t count, vecf n, vecf h, float *d) {
  const float kx = b->kxf, ky = b->kyf, peak = b->peakf;
  if (b->carry.map == SHADE_MAP_NONE)
    pass_fast_none(count, kx, ky, peak, XYZ(n), XYZ(h), d);
  else if (b->carry.map == SHADE_MAP_PERTURB_RATIO)
    pass_fast_perturb_ratio(count, kx, ky, peak, XYZ(n), XYZ(h), d);
  else if (b->carry.map == SHADE_MAP_ROTATE_RATIO_X)
    pass_fast_rotate_ratio(count, kx, ky, peak, XYZ(n), XYZ(h), d);
  else
    pass_fast_rotate_ratio(count, ky, kx, peak, XYZ(vec_swappedf(n)), XYZ(vec_swappedf(h)), d);
}

/* The same decision for one sample. */
static inline float fast(const bsdf *b, triplef n, triplef h) {
  if (b->carry.map == SHADE_MAP_NONE)
    return fast_none(XYZ(n), XYZ(h), b->kxf, b->kyf, b->peakf);
  if (b->carry.map == SHADE_MAP_PERTURB_RATIO)
    return fast_perturb_ratio(XYZ(n), XYZ(h), b->kxf, b->kyf, b->peakf);
  if (b->carry.map == SHADE_MAP_ROTATE_RATIO_X)
    return fast_rotate_ratio(XYZ(n), XYZ(h), b->kxf, b->kyf, b->peakf);
  return fast_rotate_ratio(n.y, n.x, n.z, h.y, h.x, h.z, b->kyf, b->kxf, b->peakf);
}
