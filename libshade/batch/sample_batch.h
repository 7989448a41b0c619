/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Draws and their density over arrays. A block of draws passes: which part (diffuse, or a lobe of
 * the proposal), the eye in the carried frame, a half vector there, the half vector in the local
 * frame, its reflection; then the density and f of the directions that came out, by the same
 * loops that answer for any other direction.
 */
#ifndef SHADE_BATCH_SAMPLE_BATCH_H
#define SHADE_BATCH_SAMPLE_BATCH_H

#include "direction_block.h"
#include "draw_block.h"
#include "frame_block.h"

static unsigned pdf_batch(const bsdf *given, size_t count, const bsdf_lanes *in,
                          const varied_arrays *varied, real *out) {
  mended_room room;
  varied_room each;
  draw_room draw;
  vec_room bent;
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = varied ? for_lanes(given, varied, &copy) : given;
  sample_block s = {.shape = own_shape(b)};
  for (size_t start = 0; start < count; start += BLOCK) {
    s.count = count - start < BLOCK ? count - start : BLOCK;
    s.n = vec_from(in->nx, in->ny, in->nz, start);
    s.wi = vec_from(in->wix, in->wiy, in->wiz, start);
    s.wo = vec_from(in->wox, in->woy, in->woz, start);
    vec *const v[3] = {&s.n, &s.wi, &s.wo};
    const unsigned mended = mend_block(s.count, 3, v, &room);
    status |= mended;
    if (varied)
      status |= read_varied(b, varied, start, 1, &s, &each);
    prepare_shares(b, &s, &draw);
    if (shade_horizon_is(b->horizon).bends) {
      pass_bend(s.count, s.n, s.wo, &bent);
      s.n = vec_in(&bent);
    }
    status |= density_of_paths(b, &s, &draw, out + start);
    for (size_t i = 0; mended & SHADE_BAD_INPUT && i < s.count; i++)
      if (room.void_lane[i])
        out[start + i] = 0;
  }
  return status;
}

/*
 * Directions wi for the eye wo about n, all in the frame of the lobe's grooves; lost[i] is 1
 * where there is none. u1 and u2 are used up.
 */
static void draw_block(const bsdf *b, const sample_block *s, draw_room *m, real *u1, real *u2,
                       real *const wi[3], real *lost) {
  ROOM share[BLOCK], matt[BLOCK];
  const size_t size = s->count;
  real *hx = m->h[0], *hy = m->h[1], *hz = m->h[2];
  real *const even[3] = {m->oxx, m->oyy, m->xx}; /* the diffuse part's draw */
  pass_cosines(b, size, s->n, s->wo, s->wo, m->cosi, m->coso);
  if (b->has_diffuse) {
    block_share(b, size, m, share);
    pass_split(size, share, u1, matt);
    pass_draw_matt(size, b->draw_even ? R(0.5) : R(0.0), u1, u2, even[0], even[1], even[2]);
    pass_out_of_frame(b->carry.map == SHADE_MAP_NONE ? SHADE_MAP_NONE : SHADE_MAP_SHORTEST_ARC,
                      size, s->n, even[0], even[1], even[2]);
  }
  choose_part(b, s, u1, m->kx, m->ky);
  if (b->visible) {
    pass_into_frame(b->carry.frame, size, s->n, s->wo, hx, hy);
    memcpy(hz, m->coso, size * sizeof *hz);
  }
  pass_draw(b, size, u1, u2, m->kx, m->ky, hx, hy, hz);
  pass_out_of_frame(b->carry.frame, size, s->n, hx, hy, hz);
  pass_reflect(size, s->wo, hx, hy, hz, lost);
  if (b->has_diffuse)
    for (size_t i = 0; i < size; i++)
      if (matt[i] > 0) {
        hx[i] = even[0][i];
        hy[i] = even[1][i];
        hz[i] = even[2][i];
        lost[i] = 0;
      }
  for (int c = 0; c < 3; c++)
    memcpy(wi[c], m->h[c], size * sizeof *hx);
  pass_settle(size, wi[0], wi[1], wi[2], lost);
}

/*
 * Directions alone, of a lobe as cloth has them: rigid or warped, horizon `hard`, nothing diffuse.
 * A block at most; 0 where there is none.
 */
static void draw_lobe(const bsdf *given, size_t count, const vec *n, const vec *wo,
                      const varied_arrays *varied, real *u1, real *u2, real *const wi[3]) {
  mended_room room;
  varied_room each;
  draw_room draw;
  ROOM lost[BLOCK], pdf[BLOCK];
  bsdf copy;
  const bsdf *b = varied ? for_lanes(given, varied, &copy) : given;
  sample_block s;
  start_block(b, &s);
  s.count = count;
  s.n = *n;
  s.wo = *wo;
  s.wi = (vec){NULL, NULL, NULL};
  vec *const v[3] = {&s.n, &s.wo, NULL};
  mend_block(count, 2, v, &room);
  if (varied)
    read_varied(b, varied, 0, 1, &s, &each);
  prepare_shares(b, &s, &draw);
  draw_block(b, &s, &draw, u1, u2, wi, lost);
  s.wi = (vec){wi[0], wi[1], wi[2]};
  /* what the density is 0 for: a rigid lobe's beyond the horizons only */
  if (b->warp == SHADE_RIGID)
    pass_cosines(b, count, s.n, s.wi, s.wo, draw.cosi, pdf);
  else
    density_block(b, &s, &draw, pdf);
  if (varied && each.turned)
    pass_turn_back(count, each.c, each.s, each.mirror, wi[0], wi[1]);
  real *restrict wx = wi[0], *restrict wy = wi[1], *restrict wz = wi[2];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int found = (lost[i] == 0) & (pdf[i] > 0);
    const real keep = found ? R(1.0) : R(0.0);
    wx[i] *= keep;
    wy[i] *= keep;
    wz[i] *= keep;
  }
}

static unsigned sample_batch(const bsdf *given, size_t count, const sample_lanes *in,
                             const varied_arrays *varied, const sample_result *out) {
  mended_room room;
  varied_room each;
  draw_room draw;
  vec_room bent;
  ROOM u1[BLOCK], u2[BLOCK], lost[BLOCK], seen[2][BLOCK], bounce[BLOCK];
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = varied ? for_lanes(given, varied, &copy) : given;
  const lobe_shape own = own_shape(b);
  const shade_horizon_traits horizon = shade_horizon_is(b->horizon);
  for (size_t start = 0; start < count; start += BLOCK) {
    const size_t size = count - start < BLOCK ? count - start : BLOCK;
    real *const wi[3] = {out->wix + start, out->wiy + start, out->wiz + start};
    sample_block s = {.count = size, .shape = own}; /* n as given: f bends it for itself */
    s.n = vec_from(in->nx, in->ny, in->nz, start);
    s.wo = vec_from(in->wox, in->woy, in->woz, start);
    vec *const v[3] = {&s.n, &s.wo};
    const unsigned mended = mend_block(size, 2, v, &room);
    const int odd = pass_uniform(size, in->u1 + start, u1) | pass_uniform(size, in->u2 + start, u2);
    status |= mended;
    if (varied)
      status |= read_varied(b, varied, start, is_fused(b), &s, &each);
    prepare_shares(b, &s, &draw);
    sample_block about = s;
    if (horizon.bends) {
      pass_bend(size, s.n, s.wo, &bent);
      about.n = vec_in(&bent);
    }
    sample_block from = about;
    if (horizon.facets) {
      pass_choose_path(size, s.n, s.wo, u1, seen[0], seen[1], bounce);
      from.wo.x = seen[0];
      from.wo.y = seen[1];
    }
    draw_block(b, &from, &draw, u1, u2, wi, lost);
    if (horizon.facets)
      pass_bounce(size, s.n, bounce, wi[0], wi[1], wi[2], lost);

    /* what these directions are worth, as for any others */
    s.wi = about.wi = (vec){wi[0], wi[1], wi[2]};
    real *pdf = out->pdf + start;
    density_of_paths(b, &about, &draw, pdf);
    const results to = {{out->r + start, out->g + start, out->b + start}, out->cosine + start};
    shade_block(b, &s, &to);
    if (varied && each.turned)
      pass_turn_back(size, each.c, each.s, each.mirror, wi[0], wi[1]);
    for (size_t i = 0; i < size; i++) {
      int empty = (mended & SHADE_BAD_INPUT && room.void_lane[i]) |
                  (odd && (in->u1[start + i] != in->u1[start + i] ||
                           in->u2[start + i] != in->u2[start + i]));
      status |= empty ? (unsigned)SHADE_BAD_INPUT : 0u;
      if (empty || lost[i] > 0 || !(pdf[i] > 0)) {
        wi[0][i] = wi[1][i] = wi[2][i] = pdf[i] = to.cosine[i] = 0;
        to.rgb[0][i] = to.rgb[1][i] = to.rgb[2][i] = 0;
        status |= SHADE_NO_SAMPLE;
      }
    }
  }
  return status;
}

/* Draws and their densities go through one loop: a batch of one. */
static unsigned pdf_one(const bsdf *b, const real n[3], const real wi[3], const real wo[3],
                        real *pdf) {
  const bsdf_lanes in = {.size = sizeof in,
                         .nx = n,
                         .ny = n + 1,
                         .nz = n + 2,
                         .wix = wi,
                         .wiy = wi + 1,
                         .wiz = wi + 2,
                         .wox = wo,
                         .woy = wo + 1,
                         .woz = wo + 2};
  return pdf_batch(b, 1, &in, NULL, pdf);
}

static unsigned sample_one(const bsdf *b, const real n[3], const real wo[3], const real u[2],
                           real wi[3], real f[3], real *pdf, real *cosine) {
  const sample_lanes in = {.size = sizeof in,
                           .nx = n,
                           .ny = n + 1,
                           .nz = n + 2,
                           .wox = wo,
                           .woy = wo + 1,
                           .woz = wo + 2,
                           .u1 = u,
                           .u2 = u + 1};
  const sample_result out = {sizeof out, wi, wi + 1, wi + 2, f, f + 1, f + 2, pdf, cosine};
  return sample_batch(b, 1, &in, NULL, &out);
}

#endif
