/* SPDX-License-Identifier: Apache-2.0 */
/* Diffuse passes: components across the fibre, then Phi/(pi cos), then each colour. */
#ifndef SHADE_BATCH_DIFFUSE_BLOCK_H
#define SHADE_BATCH_DIFFUSE_BLOCK_H

#include "../model/diffuse.h"
#include "fresnel_block.h"

static void pass_across(size_t count, vec n, vec w, real *restrict across) {
  ARRAYS(n);
  ARRAYS(w);
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    across[i] = across_fibre(nx[i], ny[i], nz[i], wx[i], wy[i], wz[i]);
}

/* The floor keeps f finite where the cosine vanishes and Phi does not. */
LEAF void pass_diffuse_of(shade_diffuse diffuse, size_t count, const real *restrict ly,
                          const real *restrict cosi, const real *restrict vy,
                          const real *restrict coso, real *restrict q) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const real phi = diffuse_phi(diffuse, ly[i], cosi[i], vy[i], coso[i]);
    const real one = phi * R(0.31830988618379067154) / maximum(cosi[i], R(1e-20));
    q[i] = coso[i] > 0 ? one : 0;
  }
}
static void pass_diffuse(const bsdf *b, size_t count, const real *ly, const real *cosi,
                         const real *vy, const real *coso, real *q) {
#define LOOP(diffuse) pass_diffuse_of(diffuse, count, ly, cosi, vy, coso, q)
  SHADE_LOOP_OF(DIFFUSE, b->diffuse)
#undef LOOP
}

/* q = Phi/(pi cos) of a block; ly and vy are scratch. */
static void diffuse_block(const bsdf *b, size_t size, vec n, vec wi, vec wo, const real *cosi,
                          const real *coso, real *ly, real *vy, real *q) {
  if (b->fibres_along_y)
    n = vec_swapped(n), wi = vec_swapped(wi), wo = vec_swapped(wo);
  if (b->carry.map == SHADE_MAP_NONE) {
    memcpy(ly, wi.y, size * sizeof *ly);
    memcpy(vy, wo.y, size * sizeof *vy);
  } else {
    pass_across(size, n, wi, ly);
    pass_across(size, n, wo, vy);
  }
  pass_diffuse(b, size, ly, cosi, vy, coso, q);
}

/* Adds a colour channel's diffuse part; less: 1 where f0 takes its share of it first, else 0. */
static void add_diffuse(size_t count, real less, const real *restrict kd, const real *restrict f0,
                        const real *restrict q, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] += kd[i] * (1 - less * f0[i]) * q[i];
}

/* d: f to f cos. q: Phi/(pi cos) to what yarn_batch promises. */
static void pass_yarn(size_t count, const real *restrict cosi, const real *restrict coso,
                      real *restrict d, real *restrict q) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real matt = q[i] * cosi[i] * let_in_and_out(cosi[i], coso[i]);
    d[i] *= cosi[i];
    q[i] = coso[i] > 0 ? matt : 0;
  }
}

#endif
