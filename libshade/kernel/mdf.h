/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The distributions, a leaf file each, and what all of them are made of. Of a row of table.h the
 * file mdf_<word>.h holds
 *   SHADE_MDF_<NAME>_IS     its traits, errors included, which tests hold it to
 *   SHADE_MDF_<NAME>_FORM   what <word> reads: SLOPES (lobe_point) or RATIO (lobe_ratio)
 *   <word>                  points of the lobe to D
 *   smith_<word>            (alpha tan)^2 to 1 + 2 Lambda
 *   draw_<word>, density_<word>   half vectors, and their density to that of h
 *   NO_VISIBLE_NORMALS(<word>), or pass_draw_visible_<word> and VISIBLE_DENSITY(<word>)
 * and its line stands at the end of this file: what is missing does not compile. Without FN, in
 * setup.c, the traits alone.
 */
#ifndef SHADE_KERNEL_MDF_H
#define SHADE_KERNEL_MDF_H

#include "shade/shade.h"

typedef struct shade_mdf_traits {
  int ratio;                /* sees neither a common scale of the slopes along x and y, nor L */
  int projected;            /* the integral of D hz is 1, not that of D */
  int visible;              /* the normals that an eye sees can be drawn */
  int tails;                /* D falls slowly: no exponent says where it ends */
  double proposal;          /* times kx and ky: the lobe that half vectors are drawn from */
  double per_slope;         /* of a mixture for `perturb`: how narrow 1/alpha^2 or exponents are */
  double narrowed, blunted; /* of lobes that slopes widen: src/slopes.c */
  /*
   * Relative errors of D, any detail method but the warps, against the reference on the same
   * inputs: D > 1e-12 of the peak, z >= 0.05, tilts to 89.9 degrees, exponents (e = 2/alpha^2 - 2)
   * to 1e3, 1e5, 1e4. Worst where D is smallest and e largest. Through warps: methods.h. Held by
   * test_accuracy, whose worst inputs stand beside the traits.
   */
  double float_1e3, float_1e5, double_1e4;
} shade_mdf_traits;

/* Whether a distribution reads ex and ey, or ax and ay: by the rows of those. What is unknown
 * counts as the first. */
static inline int shade_mdf_reads_exponents(shade_mdf mdf) {
  return (unsigned)mdf >= SHADE_MDF_COUNT || (SHADE_EXPONENTS_ >> mdf & 1);
}

#endif

#ifdef FN
/*
 * kx and ky are the exponents for Ashikhmin-Shirley and 1/alpha^2 for the others; peak is D at
 * the pole: sqrt((ex+1)(ey+1))/(2 pi), or 1/(pi ax ay).
 *
 * Below the horizon t is -1, and its size does as well as 0: the result is 0 there. (A maximum
 * would be one more condition on t for compilers to split the computation at; see TINY.)
 */

LEAF real FN(slope_peak)(real kx, real ky) {
  return FN(root)(kx) * FN(root)(ky) * R(0.31830988618379067154);
}

/* D / (2 o.z (1 + l)): half vectors as the eye sees them, as a density of wi. */
LEAF real FN(density_visible)(real d, real cosine, real l) {
  return d / FN(maximum)(2 * cosine * (1 + l), R(1e-25));
}

/* A lobe as D and Smith's Lambda read it. */
typedef struct FN(lobe_numbers) {
  real kx, ky, peak, gx, gy;
} FN(lobe_numbers);

/* By one division. */
LEAF FN(lobe_numbers) FN(numbers_of_alphas)(real ax, real ay) {
  real inverse = 1 / (ax * ay), over_x = ay * inverse, over_y = ax * inverse;
  return (FN(lobe_numbers)){over_x * over_x, over_y * over_y, R(0.31830988618379067154) * inverse,
                            ax * ax, ay * ay};
}

#ifdef BLOCK /* tests of leaves take no passes */
/*
 * Density of wi, from half vectors as the eye sees them; oxx and oyy are the eye's slopes, squared.
 * pass_density_visible: q += weight times that of a mixture's lobe of 1/alpha^2 kx and ky.
 * pass_density_alone: q is that of the only lobe, by the material's own numbers, or by each
 * sample's alphas where these are not NULL: a division and a root less, or a root.
 */
#undef VISIBLE_DENSITY
#undef ALONE_LOOP
#define ALONE_LOOP(word, numbers)                                                                  \
  _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                         \
    const FN(lobe_point) p = {t[i], xx[i], yy[i]};                                                 \
    const FN(lobe_numbers) k = numbers;                                                            \
    real d = FN(word)(p, k.kx, k.ky, k.peak);                                                      \
    real l = FN(smith_##word)(k.gx * oxx[i] + k.gy * oyy[i]);                                      \
    q[i] = FN(density_visible)(d, cosine[i], l);                                                   \
  }
#define VISIBLE_DENSITY(word)                                                                      \
  static void FN(pass_density_visible_##word)(                                                     \
      size_t count, const real *restrict kx, const real *restrict ky, const real *restrict weight, \
      const real *restrict cosine, const real *restrict oxx, const real *restrict oyy,             \
      const real *restrict t, const real *restrict xx, const real *restrict yy,                    \
      real *restrict q) {                                                                          \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(lobe_point) p = {t[i], xx[i], yy[i]};                                                     \
      real kk = kx[i] * ky[i], peak = FN(root)(kk) * R(0.31830988618379067154);                    \
      real d = FN(word)(p, kx[i], ky[i], peak);                                                    \
      real l = FN(smith_##word)((oxx[i] * ky[i] + oyy[i] * kx[i]) / kk);                           \
      q[i] += weight[i] * FN(density_visible)(d, cosine[i], l);                                    \
    }                                                                                              \
  }                                                                                                \
  static void FN(pass_density_alone_##word)(                                                       \
      size_t count, FN(lobe_numbers) own, const real *restrict ax, const real *restrict ay,        \
      const real *restrict cosine, const real *restrict oxx, const real *restrict oyy,             \
      const real *restrict t, const real *restrict xx, const real *restrict yy,                    \
      real *restrict q) {                                                                          \
    if (ax) {                                                                                      \
      ALONE_LOOP(word, FN(numbers_of_alphas)(ax[i], ay[i]))                                        \
    } else {                                                                                       \
      ALONE_LOOP(word, own)                                                                        \
    }                                                                                              \
  }

/* setup.c never asks for them. */
#undef NO_VISIBLE_NORMALS
#define NO_VISIBLE_NORMALS(word)                                                                   \
  static void FN(pass_density_visible_##word)(                                                     \
      size_t count, const real *kx, const real *ky, const real *weight, const real *cosine,        \
      const real *oxx, const real *oyy, const real *t, const real *xx, const real *yy, real *q) {  \
    (void)count, (void)kx, (void)ky, (void)weight, (void)cosine, (void)oxx, (void)oyy, (void)t;    \
    (void)xx, (void)yy, (void)q;                                                                   \
  }                                                                                                \
  static void FN(pass_density_alone_##word)(                                                       \
      size_t count, FN(lobe_numbers) own, const real *ax, const real *ay, const real *cosine,      \
      const real *oxx, const real *oyy, const real *t, const real *xx, const real *yy, real *q) {  \
    (void)count, (void)own, (void)ax, (void)ay, (void)cosine, (void)oxx, (void)oyy, (void)t;       \
    (void)xx, (void)yy, (void)q;                                                                   \
  }                                                                                                \
  static void FN(pass_draw_visible_##word)(size_t count, const real *u1, const real *u2,           \
                                           const real *kx, const real *ky, real *hx, real *hy,     \
                                           real *hz) {                                             \
    (void)count, (void)u1, (void)u2, (void)kx, (void)ky, (void)hx, (void)hy, (void)hz;             \
  }
#endif
#endif

#include "mdf_ashikhmin_shirley.h"
#include "mdf_beckmann.h"
#include "mdf_ggx.h"
#include "mdf_ward.h"
#include "mdf_ward_half.h"

#ifndef SHADE_MDF_IS_
#define SHADE_MDF_IS_(NAME, word, value, label, help) [value] = SHADE_MDF_##NAME##_IS,
static inline shade_mdf_traits shade_mdf_is(shade_mdf mdf) {
  static const shade_mdf_traits rows[] = {SHADE_TABLE_MDF(SHADE_MDF_IS_)};
  return rows[mdf];
}
#endif
