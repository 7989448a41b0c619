/* SPDX-License-Identifier: Apache-2.0 */
/* The density that directions are drawn with: draw.h over a block. */
#ifndef SHADE_BATCH_DENSITY_BLOCK_H
#define SHADE_BATCH_DENSITY_BLOCK_H

#include "../model/draw.h"
#include "horizon_block.h"

/* Arrays that the passes of a block share. */
typedef struct draw_room {
  ROOM h[3][BLOCK], hwo[BLOCK], cosi[BLOCK], coso[BLOCK];
  ROOM t[BLOCK], xx[BLOCK], yy[BLOCK], ot[BLOCK], oxx[BLOCK], oyy[BLOCK];
  ROOM kx[BLOCK], ky[BLOCK], weight[BLOCK];
} draw_room;

/* One of the proposal's lobes. */
LEAF void pass_propose(int three, int part, const bsdf *b, const sample_block *s, draw_room *m) {
  const size_t size = s->count;
  const real *restrict own_kx = s->shape.kx, *restrict own_ky = s->shape.ky;
  real *restrict kx = m->kx, *restrict ky = m->ky, *restrict weight = m->weight;
  const vec n = s->n;
  proposal from = proposal_of(b);
  from.three = three;
  ARRAYS(n);
#pragma omp simd
  for (size_t i = 0; i < size; i++) {
    const proposed p = propose(from, part, own_kx[i], own_ky[i], AT(n));
    kx[i] = p.kx;
    ky[i] = p.ky;
    weight[i] = p.weight;
  }
}

/* Adds the density of wi by it. */
LEAF void pass_half_density(shade_mdf mdf, int visible, size_t count, const draw_room *m,
                            real *restrict q) {
  const real *restrict t = m->t, *restrict xx = m->xx, *restrict yy = m->yy;
  const real *restrict ot = m->ot, *restrict oxx = m->oxx, *restrict oyy = m->oyy;
  const real *restrict kx = m->kx, *restrict ky = m->ky, *restrict weight = m->weight;
  const real *restrict hwo = m->hwo, *restrict coso = m->coso;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    lobe_point eye = {0, 0, 0};
    if (visible)
      eye = (lobe_point){ot[i], oxx[i], oyy[i]};
    q[i] += weight[i] * half_density(mdf, visible, (lobe_point){t[i], xx[i], yy[i]}, eye, kx[i],
                                     ky[i], hwo[i], coso[i]);
  }
}

/* A channel's part of the mean reflectances, added. */
LEAF void pass_means(int conductor, int less_f0, size_t count, const real *restrict f0,
                     const real *restrict eta, const real *restrict k, const real *restrict kd,
                     real *restrict lobe, real *restrict diffuse) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    lobe[i] += conductor ? lobe_mean(1, 0, eta[i], k[i]) : lobe_mean(0, f0[i], 0, 0);
    diffuse[i] += diffuse_mean(less_f0, f0[i], kd[i]);
  }
}

/* The lobe's share of the draws. */
static void pass_share(const bsdf *b, const sample_block *s, const real *restrict coso,
                       real *restrict share) {
  ROOM lobe[BLOCK], diffuse[BLOCK];
  const size_t size = s->count;
  const real grazing = grazing_of(b), lit = b->has_specular ? R(1.0) : R(0.0);
  const int conductor = !shade_fresnel_is(b->fresnel).f0,
            less = shade_diffuse_is(b->diffuse).less_f0;
  for (size_t i = 0; i < size; i++)
    lobe[i] = diffuse[i] = 0;
  for (int c = 0; c < 3; c++)
    if (conductor)
      pass_means(1, less, size, s->f0[c], s->tint[c], s->k[c], s->kd[c], lobe, diffuse);
    else
      pass_means(0, less, size, s->f0[c], s->tint[c], s->k[c], s->kd[c], lobe, diffuse);
#pragma omp simd
  for (size_t i = 0; i < size; i++)
    share[i] = lobe_share(lit * lobe[i], grazing, diffuse[i], coso[i]);
}

static void pass_mix(size_t count, real even, const real *restrict share, const real *restrict cosi,
                     const real *restrict coso, real *restrict q) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    q[i] = mixed_density(even, share[i], q[i], cosi[i], coso[i]);
}

/* The density of wi for the n that the lobe is about. Returns status bits. */
static unsigned density_block(const bsdf *b, const sample_block *s, draw_room *m,
                              real *restrict pdf) {
  const size_t size = s->count;
  const vec h = {m->h[0], m->h[1], m->h[2]};
  const int opposite = pass_half(size, s->wi, s->wo, m->h[0], m->h[1], m->h[2], m->hwo);
  pass_cosines(b, size, s->n, s->wi, s->wo, m->cosi, m->coso);
  if (b->warp != SHADE_RIGID)
    pass_unit(size, m->h[0], m->h[1], m->h[2]);
  pass_detail(b->carry.frame, size, s->n, h, m->t, m->xx, m->yy);
  if (b->visible)
    pass_detail(b->carry.frame, size, s->n, s->wo, m->ot, m->oxx, m->oyy);
  for (size_t i = 0; i < size; i++)
    pdf[i] = 0;
  for (int part = 0; part < b->carry.parts; part++) {
    if (b->carry.parts > 1)
      pass_propose(1, part, b, s, m);
    else
      pass_propose(0, part, b, s, m);
#define LOOP(mdf)                                                                                  \
  if (b->visible && shade_mdf_is(mdf).visible)                                                     \
    pass_half_density(mdf, 1, size, m, pdf);                                                       \
  else                                                                                             \
    pass_half_density(mdf, 0, size, m, pdf)
    SHADE_LOOP_OF(MDF, b->mdf)
#undef LOOP
  }
  if (b->warp != SHADE_RIGID)
    pass_stretch(b->warp == SHADE_WARP_SMOOTH, 0, size, s->n, h, pdf);
  if (b->has_diffuse)
    pass_share(b, s, m->coso, m->weight);
  else
    for (size_t i = 0; i < size; i++)
      m->weight[i] = 1;
  pass_mix(size, even_share(b), m->weight, m->cosi, m->coso, pdf);
  return opposite ? SHADE_BAD_INPUT : SHADE_OK;
}

/* How likely the paths of two facets are, from the one that ends in wi to those mirrored. */
static void pass_paths(size_t count, vec n, vec wi, vec wo, real *restrict plain,
                       real *restrict light, real *restrict eye) {
  ARRAYS(n);
  ARRAYS(wi);
  ARRAYS(wo);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const path_shares by = paths(AT(n), AT(wi), AT(wo));
    plain[i] = by.plain;
    light[i] = by.light;
    eye[i] = by.eye;
  }
}

/* What comes by way of the mirrors of two facets. */
static void add_mirrored(const bsdf *b, const sample_block *s, draw_room *m, real *restrict pdf) {
  const size_t size = s->count;
  ROOM x[BLOCK], y[BLOCK], one[BLOCK], plain[BLOCK], mirrored[2][BLOCK];
  pass_paths(size, s->n, s->wi, s->wo, plain, mirrored[0], mirrored[1]);
  pass_multiply(size, plain, pdf);
  for (int k = 0; k < 2; k++) {
    sample_block to = *s;
    vec *const w = k ? &to.wo : &to.wi;
    pass_mirror(size, s->n, *w, x, y);
    w->x = x;
    w->y = y;
    density_block(b, &to, m, one);
    pass_add_product(size, mirrored[k], one, pdf);
  }
}

#endif
