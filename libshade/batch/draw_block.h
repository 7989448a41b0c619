/* SPDX-License-Identifier: Apache-2.0 */
/* Uniform numbers to half vectors, and those to directions: draw.h over a block. */
#ifndef SHADE_BATCH_DRAW_BLOCK_H
#define SHADE_BATCH_DRAW_BLOCK_H

#include "density_block.h"
#include "frame_block.h"

/* Uniform numbers within [0, 1); a NaN marks the lane. */
static int pass_uniform(size_t count, const real *restrict u, real *restrict out) {
  int bad = 0;
#pragma omp simd reduction(| : bad)
  for (size_t i = 0; i < count; i++) {
    bad |= u[i] != u[i];
    out[i] = uniform_of(u[i]);
  }
  return bad;
}

/* Which lanes draw from the diffuse part, a direction of it, and u1 for what follows. */
static void pass_split(size_t count, real even, const real *restrict share, real *restrict u1,
                       const real *restrict u2, real *restrict matt, real *restrict wx,
                       real *restrict wy, real *restrict wz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int is_lobe = u1[i] < share[i];
    const real u = remapped(u1[i], share[i], is_lobe);
    const triple w = draw_matt(even, u, u2[i]);
    u1[i] = u;
    matt[i] = is_lobe ? R(0.0) : R(1.0);
    wx[i] = w.x;
    wy[i] = w.y;
    wz[i] = w.z;
  }
}

/* kx and ky of the proposal's lobe that u1 falls to, and what is left of u1. */
LEAF void pass_choose(int three, const bsdf *b, const sample_block *s, real *restrict u1,
                      real *restrict kx, real *restrict ky) {
  const size_t size = s->count;
  const real *restrict own_kx = s->shape.kx, *restrict own_ky = s->shape.ky;
  const vec n = s->n;
  proposal from = proposal_of(b);
  from.three = three;
  ARRAYS(n);
#pragma omp simd
  for (size_t i = 0; i < size; i++) {
    const proposed p = choose_proposed(from, own_kx[i], own_ky[i], AT(n), u1[i]);
    kx[i] = p.kx;
    ky[i] = p.ky;
    u1[i] = p.weight;
  }
}

/* Half vectors in the lobe's frame; where they are those that the eye sees, h holds it on entry. */
LEAF void pass_draw(shade_mdf mdf, int visible, size_t count, const real *restrict u1,
                    const real *restrict u2, const real *restrict kx, const real *restrict ky,
                    real *restrict hx, real *restrict hy, real *restrict hz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    triple o = {0, 0, 1};
    if (visible)
      o = (triple){hx[i], hy[i], hz[i]};
    const triple h = draw_half(mdf, visible, u1[i], u2[i], kx[i], ky[i], o);
    hx[i] = h.x;
    hy[i] = h.y;
    hz[i] = h.z;
  }
}

/* wo mirrored by h, or the diffuse part's draw where that was chosen, into h. Unit. */
LEAF void pass_reflect(int diffuse, size_t count, vec wo, const real *restrict matt, vec even,
                       real *restrict hx, real *restrict hy, real *restrict hz,
                       real *restrict lost) {
  ARRAYS(wo);
  ARRAYS(even);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    drawn d = reflected(AT(wo), (triple){hx[i], hy[i], hz[i]});
    if (diffuse) {
      const int is = matt[i] > 0;
      d = (drawn){{is ? evenx[i] : d.w.x, is ? eveny[i] : d.w.y, is ? evenz[i] : d.w.z},
                  is ? 0 : d.lost};
    }
    d = settled(d);
    hx[i] = d.w.x;
    hy[i] = d.w.y;
    hz[i] = d.w.z;
    lost[i] = d.lost;
  }
}

static void pass_choose_path(size_t count, vec n, vec wo, real *restrict u, real *restrict x,
                             real *restrict y, real *restrict bounce) {
  ARRAYS(n);
  ARRAYS(wo);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const facet_path path = choose_path(AT(n), AT(wo), u[i]);
    x[i] = path.x;
    y[i] = path.y;
    u[i] = path.u;
    bounce[i] = path.bounce;
  }
}

static void pass_bounce(size_t count, vec n, const real *restrict bounce, real *restrict wx,
                        real *restrict wy, const real *restrict wz, real *restrict lost) {
  ARRAYS(n);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const drawn d = bounced_on(AT(n), bounce[i], (drawn){{wx[i], wy[i], wz[i]}, lost[i]});
    wx[i] = d.w.x;
    wy[i] = d.w.y;
    lost[i] = d.lost;
  }
}

/*
 * Directions wi for the eye wo about n, all in the frame of the lobe's grooves; lost[i] is 1
 * where there is none. u1 and u2 are used up.
 */
static void draw_block(const bsdf *b, const sample_block *s, draw_room *m, real *u1, real *u2,
                       real *const wi[3], real *lost) {
  ROOM share[BLOCK], matt[BLOCK];
  const size_t size = s->count;
  real *hx = wi[0], *hy = wi[1], *hz = wi[2];
  real *const even[3] = {m->oxx, m->oyy, m->xx}; /* the diffuse part's draw */
  const vec w = {even[0], even[1], even[2]};
  pass_cosines(b, size, s->n, s->wo, s->wo, m->cosi, m->coso);
  if (b->has_diffuse) {
    pass_share(b, s, m->coso, share);
    pass_split(size, even_share(b), share, u1, u2, matt, even[0], even[1], even[2]);
    pass_out_of_frame(matt_frame(b), size, s->n, even[0], even[1], even[2]);
  }
  if (b->carry.parts > 1)
    pass_choose(1, b, s, u1, m->kx, m->ky);
  else
    pass_choose(0, b, s, u1, m->kx, m->ky);
  if (b->visible) {
    pass_into_frame(b->carry.frame, size, s->n, s->wo, hx, hy);
    memcpy(hz, m->coso, size * sizeof *hz);
  }
#define LOOP(mdf)                                                                                  \
  if (b->visible && shade_mdf_is(mdf).visible)                                                     \
    pass_draw(mdf, 1, size, u1, u2, m->kx, m->ky, hx, hy, hz);                                     \
  else                                                                                             \
    pass_draw(mdf, 0, size, u1, u2, m->kx, m->ky, hx, hy, hz)
  SHADE_LOOP_OF(MDF, b->mdf)
#undef LOOP
  pass_out_of_frame(b->carry.frame, size, s->n, hx, hy, hz);
  if (b->has_diffuse)
    pass_reflect(1, size, s->wo, matt, w, hx, hy, hz, lost);
  else
    pass_reflect(0, size, s->wo, matt, w, hx, hy, hz, lost);
}

#endif
