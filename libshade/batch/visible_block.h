/* SPDX-License-Identifier: Apache-2.0 */
/* Normals that an eye sees, of the distributions that know them: drawn, and their density. */
#ifndef SHADE_BATCH_VISIBLE_BLOCK_H
#define SHADE_BATCH_VISIBLE_BLOCK_H

#include "../model/mdf.h"
#include "vec.h"

/*
 * Density of wi, from half vectors as the eye sees them; oxx and oyy are the eye's slopes, squared.
 * pass_density_visible: q += weight times that of a mixture's lobe of 1/alpha^2 kx and ky.
 * pass_density_alone: q is that of the only lobe, by the material's own numbers, or by each
 * sample's alphas where these are not NULL: a division and a root less, or a root.
 */
#define ALONE_LOOP(word, numbers)                                                                  \
  _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                         \
    const lobe_point p = {t[i], xx[i], yy[i]};                                                     \
    const lobe_numbers k = numbers;                                                                \
    real d = word(p, k.kx, k.ky, k.peak);                                                          \
    real l = smith_##word(k.gx * oxx[i] + k.gy * oyy[i]);                                          \
    q[i] = density_visible(d, cosine[i], l);                                                       \
  }
#define VISIBLE_DENSITY(NAME, word)                                                                \
  static void pass_density_visible_##word(                                                         \
      size_t count, const real *restrict kx, const real *restrict ky, const real *restrict weight, \
      const real *restrict cosine, const real *restrict oxx, const real *restrict oyy,             \
      const real *restrict t, const real *restrict xx, const real *restrict yy,                    \
      real *restrict q) {                                                                          \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      lobe_point p = {t[i], xx[i], yy[i]};                                                         \
      real kk = kx[i] * ky[i], peak = root(kk) * R(0.31830988618379067154);                        \
      real d = word(p, kx[i], ky[i], peak);                                                        \
      real l = smith_##word((oxx[i] * ky[i] + oyy[i] * kx[i]) / kk);                               \
      q[i] += weight[i] * density_visible(d, cosine[i], l);                                        \
    }                                                                                              \
  }                                                                                                \
  static void pass_density_alone_##word(size_t count, lobe_numbers own, const real *restrict ax,   \
                                        const real *restrict ay, const real *restrict cosine,      \
                                        const real *restrict oxx, const real *restrict oyy,        \
                                        const real *restrict t, const real *restrict xx,           \
                                        const real *restrict yy, real *restrict q) {               \
    if (ax) {                                                                                      \
      ALONE_LOOP(word, numbers_of_alphas(ax[i], ay[i]))                                            \
    } else {                                                                                       \
      ALONE_LOOP(word, own)                                                                        \
    }                                                                                              \
  }

SHADE_MDF_VISIBLE(VISIBLE_DENSITY)
#undef VISIBLE_DENSITY
#undef ALONE_LOOP

/*
 * t from u under (rise, lean); all searches of a block take their steps together. (Those two are
 * read only; were they const, gcc would warn that a count of 0 leaves them unset.)
 */
static void pass_slope(size_t count, const real *restrict u, real *restrict rise,
                       real *restrict lean, real *restrict t) {
  ROOM inverse[BLOCK], low[BLOCK], high[BLOCK], v[BLOCK];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    slope_search s = slope_start(u[i], rise[i], lean[i]);
    inverse[i] = s.inverse;
    low[i] = s.low;
    high[i] = s.high;
    v[i] = s.u;
    t[i] = s.t;
  }
  for (int step = 0; step < slope_steps; step++)
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      slope_search s = {v[i], rise[i], lean[i], inverse[i], low[i], high[i], t[i]};
      s = slope_step(s);
      low[i] = s.low;
      high[i] = s.high;
      t[i] = s.t;
    }
}

/* Scratch of the draws below. */
typedef struct slope_room {
  ROOM rise[BLOCK], lean[BLOCK], along[BLOCK], across[BLOCK];
} slope_room;

static void pass_draw_visible_beckmann(size_t count, const real *restrict u1,
                                       const real *restrict u2, const real *restrict kx,
                                       const real *restrict ky, real *restrict hx,
                                       real *restrict hy, real *restrict hz) {
  slope_room m;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    triple o = {hx[i], hy[i], hz[i]};
    stretched e = stretch_eye(1 / root(kx[i]), 1 / root(ky[i]), o);
    m.rise[i] = e.rise;
    m.lean[i] = e.lean;
  }
  pass_slope(count, u1, m.rise, m.lean, m.along);
  for (size_t i = 0; i < count; i++) {
    m.rise[i] = 1;
    m.lean[i] = 0;
  }
  pass_slope(count, u2, m.rise, m.lean, m.across);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    triple o = {hx[i], hy[i], hz[i]};
    triple h = visible_gaussian(m.along[i], m.across[i], kx[i], ky[i], o);
    hx[i] = h.x;
    hy[i] = h.y;
    hz[i] = h.z;
  }
}

/* h holds the eye on entry, in the lobe's frame. */
static void pass_draw_visible_ggx(size_t count, const real *restrict u1, const real *restrict u2,
                                  const real *restrict kx, const real *restrict ky,
                                  real *restrict hx, real *restrict hy, real *restrict hz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    triple o = {hx[i], hy[i], hz[i]};
    triple h = draw_visible_ggx(u1[i], u2[i], kx[i], ky[i], o);
    hx[i] = h.x;
    hy[i] = h.y;
    hz[i] = h.z;
  }
}

#endif
