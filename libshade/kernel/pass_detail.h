/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Detail pass: perturbed normals and half vectors to points of the lobe, one
 * loop per leaf so that no lane decides anything. Arrays are at most
 * BLOCK long and do not overlap.
 */
#define DETAIL_PASS(leaf, with)                                                                    \
  static void FN(pass_##leaf)(size_t count, VEC(n), VEC(h), real *restrict t, real *restrict xx,   \
                              real *restrict yy) {                                                 \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(lobe_point) p = FN(lobe_at)(FN(detail_##leaf)(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i])); \
      t[i] = p.t;                                                                                  \
      xx[i] = p.xx;                                                                                \
      yy[i] = p.yy;                                                                                \
    }                                                                                              \
  }
SHADE_MAP_LEAVES(DETAIL_PASS, )
#undef DETAIL_PASS

LEAF void FN(pass_detail)(shade_map map, size_t count, FN(vec) n, FN(vec) h, real *t, real *xx,
                          real *yy) {
  switch (map) {
#define MAP_CASE(NAME, leaf, along_y, kind, frame, with)                                           \
  case SHADE_MAP_##NAME:                                                                           \
    if (along_y)                                                                                   \
      FN(pass_##leaf)(count, XYZ(FN(vec_swapped)(n)), XYZ(FN(vec_swapped)(h)), t, yy, xx);         \
    else                                                                                           \
      FN(pass_##leaf)(count, XYZ(n), XYZ(h), t, xx, yy);                                           \
    break;
    SHADE_MAP_ROWS(MAP_CASE, )
#undef MAP_CASE
  case SHADE_MAP_COUNT:
    break;
  }
}

/* x and y in each other's place. */
LEAF FN(lobe_ratio) FN(swapped)(FN(lobe_ratio) r) {
  return (FN(lobe_ratio)){r.yy, r.xx, r.ss, r.zz, r.above};
}

/* The same decision for one sample. */
LEAF FN(lobe_ratio) FN(detail)(shade_map map, FN(triple) n, FN(triple) h) {
  switch (map) {
#define MAP_CASE(NAME, leaf, along_y, kind, frame, with)                                           \
  case SHADE_MAP_##NAME:                                                                           \
    return along_y ? FN(swapped)(FN(detail_##leaf)(n.y, n.x, n.z, h.y, h.x, h.z))                  \
                   : FN(detail_##leaf)(n.x, n.y, n.z, h.x, h.y, h.z);
    SHADE_MAP_ROWS(MAP_CASE, )
#undef MAP_CASE
  case SHADE_MAP_COUNT:
    break;
  }
  return FN(detail_none)(n.x, n.y, n.z, h.x, h.y, h.z);
}
