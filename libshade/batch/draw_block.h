/* SPDX-License-Identifier: Apache-2.0 */
/* Uniform numbers to half vectors, and those to directions. */
#ifndef SHADE_BATCH_DRAW_BLOCK_H
#define SHADE_BATCH_DRAW_BLOCK_H

#include "../model/share.h"
#include "density_block.h"

#define DRAW_PASS(NAME, name, value, label, help)                                                  \
  static void pass_draw_##name(size_t count, const real *restrict u1, const real *restrict u2,     \
                               const real *restrict kx, const real *restrict ky,                   \
                               real *restrict hx, real *restrict hy, real *restrict hz) {          \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      triple h = draw_##name(u1[i], u2[i], kx[i], ky[i]);                                          \
      hx[i] = h.x;                                                                                 \
      hy[i] = h.y;                                                                                 \
      hz[i] = h.z;                                                                                 \
    }                                                                                              \
  }
SHADE_TABLE_MDF(DRAW_PASS)
#undef DRAW_PASS

/* Half vectors in the lobe's frame; where they are those that the eye sees, h holds it on entry. */
static void pass_draw(const bsdf *b, size_t count, const real *u1, const real *u2, const real *kx,
                      const real *ky, real *hx, real *hy, real *hz) {
  if (b->visible)
    switch (b->mdf) {
#define VISIBLE_CASE(NAME, word)                                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    pass_draw_visible_##word(count, u1, u2, kx, ky, hx, hy, hz);                                   \
    return;
      SHADE_MDF_VISIBLE(VISIBLE_CASE)
#undef VISIBLE_CASE
    default:
      break;
    }
  switch (b->mdf) {
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    pass_draw_##word(count, u1, u2, kx, ky, hx, hy, hz);                                           \
    break;
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
}

/* Uniform numbers within [0, 1); a NaN marks the lane. */
static int pass_uniform(size_t count, const real *restrict u, real *restrict out) {
  int bad = 0;
#pragma omp simd reduction(| : bad)
  for (size_t i = 0; i < count; i++) {
    bad |= u[i] != u[i];
    out[i] = minimum(maximum(u[i], 0), BELOW_ONE);
  }
  return bad;
}

/* Which of the proposal's lobes: kx and ky of the chosen one, u1 remapped. */
static void choose_part(const bsdf *b, const sample_block *s, real *u1, real *kx, real *ky) {
  const size_t size = s->count;
  ROOM px[BLOCK], py[BLOCK], weight[BLOCK], left[BLOCK];
  pass_part(b, s->shape, 0, size, s->n, kx, ky, left);
  if (b->carry.parts == 1)
    return;
  /* left: what the chosen part and those after it weigh */
  ROOM chosen[BLOCK];
  for (size_t i = 0; i < size; i++)
    chosen[i] = u1[i] < left[i];
  for (size_t i = 0; i < size; i++)
    u1[i] = remapped(u1[i], left[i], chosen[i] > 0);
  for (int part = 1; part < b->carry.parts; part++) {
    pass_part(b, s->shape, part, size, s->n, px, py, weight);
    const int last = part + 1 == b->carry.parts;
#pragma omp simd
    for (size_t i = 0; i < size; i++) {
      real rest = maximum(1 - left[i], R(1e-20));
      real share = last ? R(1.0) : weight[i] / rest;
      int open = chosen[i] == 0;
      int yes = u1[i] < share;
      real v = remapped(u1[i], share, yes);
      u1[i] = open ? v : u1[i];
      kx[i] = open ? px[i] : kx[i];
      ky[i] = open ? py[i] : ky[i];
      chosen[i] = (open & yes) ? 1 : chosen[i];
      left[i] += weight[i];
    }
  }
}

/* Which lanes draw from the diffuse part, and u1 for what follows. */
static void pass_split(size_t count, const real *restrict share, real *restrict u,
                       real *restrict matt) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    int lobe = u[i] < share[i];
    u[i] = remapped(u[i], share[i], lobe);
    matt[i] = lobe ? R(0.0) : R(1.0);
  }
}

/* A direction about the pole by the cosine, or evenly for the first `even` of u1. */
static void pass_draw_matt(size_t count, real even, const real *restrict u1,
                           const real *restrict u2, real *restrict wx, real *restrict wy,
                           real *restrict wz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    int flat = u1[i] < even;
    pair p = circle(remapped(u1[i], even, flat));
    real zz = 1 - u2[i];
    real z = flat ? zz : root(zz);
    real sine = flat ? root(u2[i] * (1 + zz)) : root(u2[i]);
    wx[i] = sine * p.x;
    wy[i] = sine * p.y;
    wz[i] = z;
  }
}

/* wo mirrored by h, any length, into h; the other part's draw where it was chosen. Unit. */
static void pass_reflect(size_t count, vec wo, real *restrict hx, real *restrict hy,
                         real *restrict hz, real *restrict lost) {
  ARRAYS(wo);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real size2 = hx[i] * hx[i] + hy[i] * hy[i] + hz[i] * hz[i];
    real along = hx[i] * wox[i] + hy[i] * woy[i] + hz[i] * woz[i];
    real twice = 2 * along / maximum(size2, TINY);
    lost[i] = along > 0 ? R(0.0) : R(1.0);
    hx[i] = twice * hx[i] - wox[i];
    hy[i] = twice * hy[i] - woy[i];
    hz[i] = twice * hz[i] - woz[i];
  }
}

/* Unit directions; those that point below are lost too, and z stands for what is lost. */
static void pass_settle(size_t count, real *restrict wx, real *restrict wy, real *restrict wz,
                        real *restrict lost) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real size2 = wx[i] * wx[i] + wy[i] * wy[i] + wz[i] * wz[i];
    int keep = (lost[i] == 0) & (wz[i] > 0) & (size2 > R(0.25));
    real scale = 1 / root(size2 + TINY);
    wx[i] = keep ? wx[i] * scale : 0;
    wy[i] = keep ? wy[i] * scale : 0;
    wz[i] = keep ? wz[i] * scale : 1;
    lost[i] = keep ? R(0.0) : R(1.0);
  }
}

/*
 * Which path each lane takes, and u for what follows: bounce where light of the bumped facet
 * goes on to the mirror; x and y of the eye, mirrored where it sees that facet in the mirror.
 */
static void pass_choose_path(size_t count, vec n, vec wo, real *restrict u, real *restrict x,
                             real *restrict y, real *restrict bounce) {
  ARRAYS(n);
  ARRAYS(wo);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real share = share_bumped(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    real left = 1 - share_bounced(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    int bumped = u[i] < share;
    real v = remapped(u[i], share, bumped);
    int plain = v < left;
    real again = remapped(v, left, plain);
    u[i] = bumped ? again : v;
    bounce[i] = (bumped & !plain) ? R(1.0) : R(0.0);
    real step = bumped ? 0 : mirror_step(nx[i], ny[i], wox[i], woy[i]);
    x[i] = wox[i] - step * nx[i];
    y[i] = woy[i] - step * ny[i];
  }
}

/* Light that left the bumped facet, on to the mirror; what never left it is lost. */
static void pass_bounce(size_t count, vec n, const real *restrict bounce, real *restrict wx,
                        real *restrict wy, const real *restrict wz, real *restrict lost) {
  ARRAYS(n);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real side = nx[i] * wx[i] + ny[i] * wy[i];
    real step = mirror_step(nx[i], ny[i], wx[i], wy[i]);
    step = ((bounce[i] > 0) & (side > 0)) ? step : 0;
    lost[i] = side + nz[i] * wz[i] > 0 ? lost[i] : 1;
    wx[i] -= step * nx[i];
    wy[i] -= step * ny[i];
  }
}

#endif
