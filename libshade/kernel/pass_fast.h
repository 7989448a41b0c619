/* SPDX-License-Identifier: Apache-2.0 */
/* n and h to D in one loop, for `fast`; shade_bsdf_setup sets it only for the maps below. */
#define FAST_PASS(method)                                                                          \
  static void pass_fast_##method(size_t count, const float *restrict nx, const float *restrict ny, \
                                 const float *restrict nz, const float *restrict hx,               \
                                 const float *restrict hy, const float *restrict hz, float kx,     \
                                 float ky, float peak, float *restrict d) {                        \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) d[i] =                                  \
        fast_##method(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i], kx, ky, peak);                     \
  }

FAST_PASS(none)
FAST_PASS(perturb)
FAST_PASS(rotate)
#undef FAST_PASS

static void pass_fast(const bsdf *b, size_t count, const float *nx, const float *ny,
                      const float *nz, const float *hx, const float *hy, const float *hz,
                      float *d) {
  if (b->map == SHADE_MAP_NONE)
    pass_fast_none(count, nx, ny, nz, hx, hy, hz, b->kxf, b->kyf, b->peakf, d);
  else if (b->map == SHADE_MAP_PERTURB_RATIO)
    pass_fast_perturb(count, nx, ny, nz, hx, hy, hz, b->kxf, b->kyf, b->peakf, d);
  else if (b->map == SHADE_MAP_APPROXIMATE_X)
    pass_fast_rotate(count, nx, ny, nz, hx, hy, hz, b->kxf, b->kyf, b->peakf, d);
  else
    pass_fast_rotate(count, ny, nx, nz, hy, hx, hz, b->kyf, b->kxf, b->peakf, d);
}

/* The same decision for one sample. */
static inline float fast(const bsdf *b, const float n[3], float hx, float hy, float hz) {
  if (b->map == SHADE_MAP_NONE)
    return fast_none(n[0], n[1], n[2], hx, hy, hz, b->kxf, b->kyf, b->peakf);
  if (b->map == SHADE_MAP_PERTURB_RATIO)
    return fast_perturb(n[0], n[1], n[2], hx, hy, hz, b->kxf, b->kyf, b->peakf);
  if (b->map == SHADE_MAP_APPROXIMATE_X)
    return fast_rotate(n[0], n[1], n[2], hx, hy, hz, b->kxf, b->kyf, b->peakf);
  return fast_rotate(n[1], n[0], n[2], hy, hx, hz, b->kyf, b->kxf, b->peakf);
}
