/* SPDX-License-Identifier: Apache-2.0 */
/*
 * n and h to D. A distribution that reads slopes takes them from the detail pass, in a loop of
 * its own; one that reads ratios goes from n and h to D in one loop per leaf. Each loop twice:
 * with the material's own parameters, and with those of each sample.
 */
#ifndef SHADE_BATCH_LOBE_BLOCK_H
#define SHADE_BATCH_LOBE_BLOCK_H

#include "../model/lobe.h"
#include "detail_block.h"

/* The lobe's parameters: one of each, or an array of each. */
typedef struct lobe_shape {
  int varies; /* 1: arrays */
  const real *kx, *ky, *peak, *gx, *gy;
  const real *ax, *ay; /* arrays of alphas, where the distribution reads them */
  int alone;           /* 1: what stands above them was not made */
} lobe_shape;

LEAF lobe_shape own_shape(const bsdf *b) {
  return (lobe_shape){0,
                      &numbers_of(b)->kx,
                      &numbers_of(b)->ky,
                      &numbers_of(b)->peak,
                      &numbers_of(b)->gx,
                      &numbers_of(b)->gy,
                      NULL,
                      NULL,
                      0};
}

/*
 * A block of samples as passes that call passes hand it on: by its address, for a copy reads in
 * vectors what was just written one by one, and waits.
 */
typedef struct sample_block {
  size_t count;
  vec n, wi, wo;
  lobe_shape shape;
  const real *f0[3], *tint[3], *k[3], *kd[3]; /* of each sample, or NULL */
} sample_block;

/*
 * A block of the material's own parameters, whose samples are still to be set; no initialiser, for
 * clearing the whole took as long as ten samples (gcc, `rep stos`).
 */
LEAF void start_block(const bsdf *b, sample_block *s) {
  s->shape = own_shape(b);
  for (int c = 0; c < 3; c++)
    s->f0[c] = s->tint[c] = s->k[c] = s->kd[c] = NULL;
}

/* Along y what was along x. */
LEAF lobe_shape shape_swapped(lobe_shape s) {
  return (lobe_shape){s.varies, s.ky, s.kx, s.peak, s.gy, s.gx, s.ay, s.ax, s.alone};
}

#define SHAPE(s)                                                                                   \
  const real *restrict kx = (s)->kx, *restrict ky = (s)->ky, *restrict peak = (s)->peak;           \
  const real own_kx = *kx, own_ky = *ky, own_peak = *peak;                                         \
  (void)own_kx, (void)own_ky, (void)own_peak
#define OWN own_kx, own_ky, own_peak
#define EACH kx[i], ky[i], peak[i]

#define SLOPES_PASS(name, word, which)                                                             \
  static void name(size_t count, const lobe_shape *s, const real *restrict t,                      \
                   const real *restrict xx, const real *restrict yy, real *restrict d) {           \
    SHAPE(s);                                                                                      \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      lobe_point p = {t[i], xx[i], yy[i]};                                                         \
      d[i] = word(p, which);                                                                       \
    }                                                                                              \
  }
#define RATIO_PASS(name, leaf, word, which)                                                        \
  static void name(size_t count, const lobe_shape *s, VEC(n), VEC(h), real *restrict d) {          \
    SHAPE(s);                                                                                      \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) d[i] =                                  \
        word(detail_##leaf(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i]), which);                      \
  }
#define RATIO_LEAF(leaf, word)                                                                     \
  RATIO_PASS(pass_##word##_##leaf, leaf, word, OWN)                                                \
  RATIO_PASS(pass_each_##word##_##leaf, leaf, word, EACH)
#define PASSES_SLOPES(word)                                                                        \
  SLOPES_PASS(pass_##word, word, OWN)                                                              \
  SLOPES_PASS(pass_each_##word, word, EACH)
#define PASSES_RATIO(word) SHADE_MAP_LEAVES(RATIO_LEAF, word)
#define MDF_PASSES(NAME, word, value, label, help) BY_FORM(PASSES_, SHADE_MDF_##NAME##_FORM)(word)
SHADE_TABLE_MDF(MDF_PASSES)
#undef MDF_PASSES
#undef PASSES_RATIO
#undef PASSES_SLOPES
#undef RATIO_LEAF
#undef RATIO_PASS
#undef SLOPES_PASS

/* The conserving warps: d times their stretch. */
#define STRETCH_PASS(name, smooth, projected)                                                      \
  static void pass_stretch_##name(size_t count, VEC(n), VEC(h), real *restrict d) {                \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) d[i] *=                                 \
        warp_stretch(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i], smooth, projected);                 \
  }
STRETCH_PASS(linear, 0, 0)
STRETCH_PASS(linear_projected, 0, 1)
STRETCH_PASS(smooth, 1, 0)
STRETCH_PASS(smooth_projected, 1, 1)
#undef STRETCH_PASS

LEAF void pass_stretch(int smooth, int projected, size_t count, vec n, vec h, real *d) {
  if (smooth)
    (projected ? pass_stretch_smooth_projected : pass_stretch_smooth)(count, XYZ(n), XYZ(h), d);
  else
    (projected ? pass_stretch_linear_projected : pass_stretch_linear)(count, XYZ(n), XYZ(h), d);
}

/* n and h to D; h is unit for the warps. t, xx and yy are scratch. */
LEAF void pass_lobe(const bsdf *b, const lobe_shape *s, size_t count, vec n, vec h, real *t,
                    real *xx, real *yy, real *d) {
  const lobe_shape swapped = shape_swapped(*s);
  switch (b->mdf) {
#define LOBE_SLOPES(word)                                                                          \
  pass_detail(b->carry.map, count, n, h, t, xx, yy);                                               \
  (s->varies ? pass_each_##word : pass_##word)(count, s, t, xx, yy, d);
#define LOBE_RATIO_MAP(NAME, leaf, along_y, kind, frame, word)                                     \
  case SHADE_MAP_##NAME:                                                                           \
    if (along_y)                                                                                   \
      (s->varies ? pass_each_##word##_##leaf : pass_##word##_##leaf)(                              \
          count, &swapped, XYZ(vec_swapped(n)), XYZ(vec_swapped(h)), d);                           \
    else                                                                                           \
      (s->varies ? pass_each_##word##_##leaf : pass_##word##_##leaf)(count, s, XYZ(n), XYZ(h), d); \
    break;
#define LOBE_RATIO(word)                                                                           \
  switch (b->carry.map) {                                                                          \
    SHADE_MAP_ROWS(LOBE_RATIO_MAP, word)                                                           \
  case SHADE_MAP_COUNT:                                                                            \
    break;                                                                                         \
  }
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    BY_FORM(LOBE_, SHADE_MDF_##NAME##_FORM)(word) break;
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
  if (b->conserve)
    pass_stretch(b->warp == SHADE_WARP_SMOOTH, b->projected, count, n, h, d);
}
#undef LOBE_RATIO
#undef LOBE_RATIO_MAP
#undef LOBE_SLOPES

/* Slopes of a direction, carried as h is, to 1 + 2 Lambda. */
#define SMITH_PASS(NAME, word, value, label, help)                                                 \
  static void pass_smith_##word(size_t count, const lobe_shape *s, const real *restrict xx,        \
                                const real *restrict yy, real *restrict l) {                       \
    const real gx = *s->gx, gy = *s->gy;                                                           \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) l[i] =                                  \
        smith_##word(gx * xx[i] + gy * yy[i]);                                                     \
  }                                                                                                \
  static void pass_each_smith_##word(size_t count, const lobe_shape *s, const real *restrict xx,   \
                                     const real *restrict yy, real *restrict l) {                  \
    const real *restrict gx = s->gx, *restrict gy = s->gy;                                         \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) l[i] =                                  \
        smith_##word(gx[i] * xx[i] + gy[i] * yy[i]);                                               \
  }
SHADE_TABLE_MDF(SMITH_PASS)
#undef SMITH_PASS

static void pass_smith(const bsdf *b, const lobe_shape *s, size_t count, const real *xx,
                       const real *yy, real *l) {
  switch (b->mdf) {
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    (s->varies ? pass_each_smith_##word : pass_smith_##word)(count, s, xx, yy, l);                 \
    break;
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
}

#endif
