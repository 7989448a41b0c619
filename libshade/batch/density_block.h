/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The density that directions are drawn with: that of every lobe of the proposal, of the diffuse
 * part, and of what comes by the mirrors of two facets.
 *
 * The proposal of a material (set up in setup.c): the distribution's own lobe, or the part of it
 * that the eye sees, in the frame of carry.frame, which is a rigid one or a warp; through a warp
 * the density is that of the unmoved lobe times the warp's Jacobian. For `perturb`, whose lobe has
 * no closed integral, three rigid lobes about n: the anisotropic one, the round one of n's own
 * azimuth, the round widest one, which bounds f cos / pdf.
 *
 * Facets with upright mirrors (SHADE_HORIZON_SCHUESSLER) draw by path: the eye sees the bumped
 * facet, or that facet in the mirror; from the bumped facet some light goes on to the mirror.
 */
#ifndef SHADE_BATCH_DENSITY_BLOCK_H
#define SHADE_BATCH_DENSITY_BLOCK_H

#include "../model/share.h"
#include "horizon_block.h"
#include "visible_block.h"

/* kx and ky of the proposal: of the material, or of each sample. */
static void pass_proposal(const bsdf *b, lobe_shape s, size_t count, real *restrict kx,
                          real *restrict ky) {
  const real scale = numbers_of(b)->proposal;
  if (!s.varies) {
    const real own_kx = *s.kx * scale, own_ky = *s.ky * scale; /* here: arrays may hold nothing */
    for (size_t i = 0; i < count; i++) {
      kx[i] = own_kx;
      ky[i] = own_ky;
    }
    return;
  }
  if (s.alone) {
    const real *restrict ax = s.ax, *restrict ay = s.ay;
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      const lobe_numbers lobe = numbers_of_alphas(ax[i], ay[i]);
      kx[i] = lobe.kx * scale;
      ky[i] = lobe.ky * scale;
    }
    return;
  }
  const real *restrict x = s.kx, *restrict y = s.ky;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    kx[i] = x[i] * scale;
    ky[i] = y[i] * scale;
  }
}

/*
 * kx, ky and the weight of one of the proposal's lobes, per sample. rotate_approximate is
 * rotate with 1/alpha^2 times L^2; the floor keeps the slopes within what D is capped at.
 */
static void pass_part(const bsdf *b, lobe_shape s, int part, size_t count, vec n, real *restrict kx,
                      real *restrict ky, real *restrict weight) {
  const real least = R(1e-3), per_slope = numbers_of(b)->per_slope;
  ARRAYS(n);
  pass_proposal(b, s, count, kx, ky);
  if (b->carry.parts > 1) {
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      real sx = kx[i], sy = ky[i], widest = minimum(sx, sy);
      real xx = nx[i] * nx[i], yy = ny[i] * ny[i], r = xx + yy;
      real here = (sx * xx + sy * yy + R(0.5) * TINY * (sx + sy)) / (r + TINY);
      real upright = R(0.5) / (1 + per_slope * (sx * xx + sy * yy));
      kx[i] = part == 0 ? sx : part == 1 ? here : widest;
      ky[i] = part == 0 ? sy : part == 1 ? here : widest;
      weight[i] = part == 0 ? upright : part == 1 ? R(0.5) - upright : R(0.5);
    }
  } else if (b->carry.short_by_l) {
    const real *restrict other = b->carry.map == SHADE_MAP_ROTATE_RATIO_X ? nx : ny;
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      real ll = other[i] * other[i] + nz[i] * nz[i];
      kx[i] = maximum(kx[i] * ll, least);
      ky[i] = maximum(ky[i] * ll, least);
      weight[i] = 1;
    }
  } else {
    for (size_t i = 0; i < count; i++)
      weight[i] = 1;
  }
}

/* q += weight * density of wi, from half vectors drawn without regard to the eye. */
#define DENSITY_PASS(NAME, name, value, label, help)                                               \
  static void pass_density_##name(size_t count, const real *restrict kx, const real *restrict ky,  \
                                  const real *restrict weight, const real *restrict hwo,           \
                                  const real *restrict t, const real *restrict xx,                 \
                                  const real *restrict yy, real *restrict q) {                     \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      lobe_point p = {t[i], xx[i], yy[i]};                                                         \
      q[i] += weight[i] * density_##name(p, kx[i], ky[i]) / maximum(4 * hwo[i], R(1e-25));         \
    }                                                                                              \
  }

SHADE_TABLE_MDF(DENSITY_PASS)
#undef DENSITY_PASS

/* The lobe's share of the draws; s and d: reflectances of each sample, or NULL. */
static void pass_share(const bsdf *b, size_t count, const real *restrict s, const real *restrict d,
                       const real *restrict cosine, real *restrict share) {
  const real own_s = numbers_of(b)->share_lobe, own_d = numbers_of(b)->share_diffuse;
  const real grazing = shade_fresnel_is(b->fresnel).grazing ? R(1.0) : R(0.0);
  if (!b->has_specular) {
    memset(share, 0, count * sizeof *share);
  } else if (s) {
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      share[i] = lobe_share(s[i], grazing, d[i], cosine[i]);
  } else {
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      share[i] = lobe_share(own_s, grazing, own_d, cosine[i]);
  }
}

/* The whole density: the share of the lobe's, and the rest about the normal, where Lambert
 * is met by the cosine and the fibres by as much again that is even. */
static void pass_mix(const bsdf *b, size_t count, const real *restrict share,
                     const real *restrict cosi, real *restrict q) {
  const real even = b->draw_even ? R(0.5) : R(0.0);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real matt = (even * R(0.5) + (1 - even) * cosi[i]) * R(0.31830988618379067154);
    q[i] = share[i] * q[i] + (1 - share[i]) * matt;
  }
}

/* Arrays that the passes of a block share. */
typedef struct draw_room {
  ROOM h[3][BLOCK], hwo[BLOCK], cosi[BLOCK], coso[BLOCK];
  ROOM t[BLOCK], xx[BLOCK], yy[BLOCK], oxx[BLOCK], oyy[BLOCK];
  ROOM kx[BLOCK], ky[BLOCK], weight[BLOCK];
  int shares_vary; /* the two below are filled */
  ROOM lobe[BLOCK], diffuse[BLOCK];
} draw_room;

/* What the shares of draws go by, once for a block. */
static void prepare_shares(const bsdf *b, const sample_block *s, draw_room *m) {
  m->shares_vary = 0;
  for (int c = 0; c < 3 && b->has_diffuse; c++)
    m->shares_vary |= s->f0[c] || s->tint[c] || s->k[c] || s->kd[c];
  if (m->shares_vary)
    read_shares(b, s, m->lobe, m->diffuse);
}

static void block_share(const bsdf *b, size_t size, const draw_room *m, real *share) {
  pass_share(b, size, m->shares_vary ? m->lobe : NULL, m->shares_vary ? m->diffuse : NULL, m->coso,
             share);
}

/* Whether the proposal is the lobe that an eye sees, as it stands. */
static int is_alone(const bsdf *b, const lobe_shape *s) {
  return b->visible && b->carry.parts == 1 && !b->carry.short_by_l && (!s->varies || s->alone);
}

static void density_alone(const bsdf *b, const lobe_shape *s, size_t size, draw_room *m,
                          real *restrict pdf) {
  lobe_numbers own = {0, 0, 0, 0, 0};
  if (!s->varies)
    own = (lobe_numbers){*s->kx, *s->ky, *s->peak, *s->gx, *s->gy};
  switch (b->mdf) {
#define VISIBLE_CASE(NAME, word)                                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    pass_density_alone_##word(size, own, s->ax, s->ay, m->coso, m->oxx, m->oyy, m->t, m->xx,       \
                              m->yy, pdf);                                                         \
    break;
    SHADE_MDF_VISIBLE(VISIBLE_CASE)
#undef VISIBLE_CASE
  default: /* setup.c asks for no other */
    break;
  }
}

/* Adds that of one of the proposal's lobes. */
static void part_density(const bsdf *b, size_t size, draw_room *m, real *restrict pdf) {
  if (b->visible)
    switch (b->mdf) {
#define VISIBLE_CASE(NAME, word)                                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    pass_density_visible_##word(size, m->kx, m->ky, m->weight, m->coso, m->oxx, m->oyy, m->t,      \
                                m->xx, m->yy, pdf);                                                \
    return;
      SHADE_MDF_VISIBLE(VISIBLE_CASE)
#undef VISIBLE_CASE
    default:
      break;
    }
  switch (b->mdf) {
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    pass_density_##word(size, m->kx, m->ky, m->weight, m->hwo, m->t, m->xx, m->yy, pdf);           \
    break;
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
}

/* The density of wi for the n that the lobe is about. Returns status bits. */
static unsigned density_block(const bsdf *b, const sample_block *s, draw_room *m,
                              real *restrict pdf) {
  const size_t size = s->count;
  const vec h = {m->h[0], m->h[1], m->h[2]};
  unsigned status = SHADE_OK;
  if (pass_half(size, XYZ(s->wi), XYZ(s->wo), m->h[0], m->h[1], m->h[2], m->hwo))
    status = SHADE_BAD_INPUT;
  pass_cosines(b, size, s->n, s->wi, s->wo, m->cosi, m->coso);
  if (b->warp != SHADE_RIGID)
    pass_unit(size, m->h[0], m->h[1], m->h[2]);
  pass_detail(b->carry.frame, size, s->n, h, m->t, m->xx, m->yy);
  if (b->visible) /* weight is scratch here */
    pass_detail(b->carry.frame, size, s->n, s->wo, m->weight, m->oxx, m->oyy);
  const int alone = is_alone(b, &s->shape);
  if (alone)
    density_alone(b, &s->shape, size, m, pdf);
  else
    for (size_t i = 0; i < size; i++)
      pdf[i] = 0;
  for (int part = 0; part < b->carry.parts && !alone; part++) {
    pass_part(b, s->shape, part, size, s->n, m->kx, m->ky, m->weight);
    part_density(b, size, m, pdf);
  }
  if (b->warp != SHADE_RIGID)
    pass_stretch(b->warp == SHADE_WARP_SMOOTH, 0, size, s->n, h, pdf);
  if (b->has_diffuse) {
    block_share(b, size, m, m->weight);
    pass_mix(b, size, m->weight, m->cosi, pdf);
  }
  for (size_t i = 0; i < size; i++)
    pdf[i] = m->coso[i] > 0 ? pdf[i] : 0;
  return status;
}

/* How likely the paths of two facets are, from the one that ends in wi to those mirrored. */
static void pass_paths(size_t count, vec n, vec wi, vec wo, real *restrict plain,
                       real *restrict light, real *restrict eye) {
  ARRAYS(n);
  ARRAYS(wi);
  ARRAYS(wo);
  (void)wiz;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real bounced = share_bounced(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    real bumped = share_bumped(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    real side = nx[i] * wix[i] + ny[i] * wiy[i];
    plain[i] = bumped * (side > 0 ? 1 - bounced : 1);
    light[i] = bumped * (side < 0 ? bounced : 0);
    eye[i] = share_upright(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
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

/* density_block for any horizon; 0 for opposite directions, as f is. */
static unsigned density_of_paths(const bsdf *b, const sample_block *s, draw_room *m,
                                 real *restrict pdf) {
  unsigned status = density_block(b, s, m, pdf);
  if (shade_horizon_is(b->horizon).facets)
    add_mirrored(b, s, m, pdf);
  if (status)
    for (size_t i = 0; i < s->count; i++)
      if (opposite(s->wi.x[i], s->wi.y[i], s->wi.z[i], s->wo.x[i], s->wo.y[i], s->wo.z[i]))
        pdf[i] = 0;
  return status;
}

#endif
