/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Detail pass: perturbed normals and half vectors to points of the lobe, one
 * loop per method so that no lane decides anything. Arrays are at most
 * BLOCK long and do not overlap.
 */
#define DETAIL_PASS(method, ...)                                                                   \
  static void FN(pass_##method)(size_t count, const real *restrict nx, const real *restrict ny,    \
                                const real *restrict nz, const real *restrict hx,                  \
                                const real *restrict hy, const real *restrict hz,                  \
                                real *restrict t, real *restrict xx, real *restrict yy) {          \
    (void)nx, (void)ny, (void)nz;                                                                  \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(lobe_point) p = FN(lobe_at)(FN(detail_##method)(__VA_ARGS__));                            \
      t[i] = p.t;                                                                                  \
      xx[i] = p.xx;                                                                                \
      yy[i] = p.yy;                                                                                \
    }                                                                                              \
  }

DETAIL_PASS(none, hx[i], hy[i], hz[i])
DETAIL_PASS(perturb_ratio, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
DETAIL_PASS(perturb, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
DETAIL_PASS(rotate, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
DETAIL_PASS(rotate_approximate, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
DETAIL_PASS(shortest_arc, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
DETAIL_PASS(deform_linear, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
DETAIL_PASS(deform_smooth, nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])
#undef DETAIL_PASS

static void FN(pass_detail)(shade_map map, size_t count, const real *nx, const real *ny,
                            const real *nz, const real *hx, const real *hy, const real *hz, real *t,
                            real *xx, real *yy) {
  switch (map) {
  case SHADE_MAP_NONE:
    FN(pass_none)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    break;
  case SHADE_MAP_PERTURB_RATIO:
    FN(pass_perturb_ratio)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    break;
  case SHADE_MAP_PERTURB:
    FN(pass_perturb)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    break;
  case SHADE_MAP_ROTATE_X:
    FN(pass_rotate)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    break;
  case SHADE_MAP_ROTATE_Y:
    FN(pass_rotate)(count, ny, nx, nz, hy, hx, hz, t, yy, xx);
    break;
  case SHADE_MAP_APPROXIMATE_X:
    FN(pass_rotate_approximate)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    break;
  case SHADE_MAP_APPROXIMATE_Y:
    FN(pass_rotate_approximate)(count, ny, nx, nz, hy, hx, hz, t, yy, xx);
    break;
  case SHADE_MAP_SHORTEST_ARC:
    FN(pass_shortest_arc)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    break;
  case SHADE_MAP_DEFORM_LINEAR:
    FN(pass_deform_linear)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    break;
  case SHADE_MAP_DEFORM_SMOOTH:
    FN(pass_deform_smooth)(count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    break;
  }
}

/* x and y in each other's place. */
LEAF FN(lobe_ratio) FN(swapped)(FN(lobe_ratio) r) {
  return (FN(lobe_ratio)){r.yy, r.xx, r.ss, r.zz, r.above};
}

/* The same decision for one sample. */
LEAF FN(lobe_ratio) FN(detail)(shade_map map, const real n[3], real hx, real hy, real hz) {
  switch (map) {
  case SHADE_MAP_PERTURB_RATIO:
    return FN(detail_perturb_ratio)(n[0], n[1], n[2], hx, hy, hz);
  case SHADE_MAP_PERTURB:
    return FN(detail_perturb)(n[0], n[1], n[2], hx, hy, hz);
  case SHADE_MAP_ROTATE_X:
    return FN(detail_rotate)(n[0], n[1], n[2], hx, hy, hz);
  case SHADE_MAP_ROTATE_Y:
    return FN(swapped)(FN(detail_rotate)(n[1], n[0], n[2], hy, hx, hz));
  case SHADE_MAP_APPROXIMATE_X:
    return FN(detail_rotate_approximate)(n[0], n[1], n[2], hx, hy, hz);
  case SHADE_MAP_APPROXIMATE_Y:
    return FN(swapped)(FN(detail_rotate_approximate)(n[1], n[0], n[2], hy, hx, hz));
  case SHADE_MAP_SHORTEST_ARC:
    return FN(detail_shortest_arc)(n[0], n[1], n[2], hx, hy, hz);
  case SHADE_MAP_DEFORM_LINEAR:
    return FN(detail_deform_linear)(n[0], n[1], n[2], hx, hy, hz);
  case SHADE_MAP_DEFORM_SMOOTH:
    return FN(detail_deform_smooth)(n[0], n[1], n[2], hx, hy, hz);
  case SHADE_MAP_NONE:
  default:
    return FN(detail_none)(hx, hy, hz);
  }
}
