/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Draws and their density over arrays. A block of draws passes: which part (diffuse, or a lobe of
 * the proposal), the eye in the carried frame, a half vector there, the half vector in the local
 * frame, its reflection; then the density and f of the directions that came out, by the same
 * loops that answer for any other direction.
 */
#ifndef SHADE_BATCH_SAMPLE_BATCH_H
#define SHADE_BATCH_SAMPLE_BATCH_H

#include "paths_block.h"

/* The normal that a block's lobe is about: bent for the eye. */
LEAF void bend_block(const bsdf *b, sample_block *s, vec_room *bent) {
  if (!shade_horizon_is(b->horizon).bends)
    return;
  pass_bend(s->count, s->n, s->wo, bent);
  s->n = vec_in(bent);
}

static unsigned pdf_batch(const bsdf *given, size_t count, const bsdf_lanes *in,
                          const varied_arrays *varied, real *out) {
  mended_room room;
  varied_room each;
  draw_room draw;
  vec_room bent;
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = for_lanes(given, varied, &copy);
  sample_block s;
  own_proposal(b, count, &each, &s);
  for (size_t start = 0; start < count; start += BLOCK) {
    s.count = count - start < BLOCK ? count - start : BLOCK;
    const unsigned read = read_lanes(b, in, varied, start, &s, &each, &room);
    bend_block(b, &s, &bent);
    status |= read | density_of_paths(b, &s, &draw, out + start);
    for (size_t i = 0; read & SHADE_BAD_INPUT && i < s.count; i++)
      if (room.void_lane[i])
        out[start + i] = 0;
  }
  return status;
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
  const bsdf *b = for_lanes(given, varied, &copy);
  sample_block s = {.count = count, .n = *n, .wo = *wo};
  vec *const v[3] = {&s.n, &s.wo};
  mend_block(count, 2, v, &room);
  own_proposal(b, count, &each, &s);
  read_varied(b, varied, 0, &s, &each);
  draw_block(b, &s, &draw, u1, u2, wi, lost);
  s.wi = (vec){wi[0], wi[1], wi[2]};
  /* what the density is 0 for: a rigid lobe's beyond the horizons only */
  if (b->warp == SHADE_RIGID)
    pass_cosines(b, count, s.n, s.wi, s.wo, draw.cosi, pdf);
  else
    density_block(b, &s, &draw, pdf);
  if (each.turned)
    pass_turn_back(count, &each, wi[0], wi[1]);
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
  mutual_room met;
  ROOM u1[BLOCK], u2[BLOCK], lost[BLOCK], seen[2][BLOCK], bounce[BLOCK];
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = for_lanes(given, varied, &copy);
  const int facets = shade_horizon_is(b->horizon).facets;
  sample_block s; /* n as given: f bends it for itself */
  own_block(b, count, &each, &s);
  for (size_t start = 0; start < count; start += BLOCK) {
    const size_t size = s.count = count - start < BLOCK ? count - start : BLOCK;
    real *const wi[3] = {out->wix + start, out->wiy + start, out->wiz + start};
    real *pdf = out->pdf + start;
    const bsdf_lanes at = {
        .nx = in->nx, .ny = in->ny, .nz = in->nz, .wox = in->wox, .woy = in->woy, .woz = in->woz};
    const unsigned read = read_lanes(b, &at, varied, start, &s, &each, &room);
    const int odd = pass_uniform(size, in->u1 + start, u1) | pass_uniform(size, in->u2 + start, u2);
    status |= read;
    sample_block about = s;
    bend_block(b, &about, &bent);
    sample_block from = about;
    if (facets) {
      pass_choose_path(size, s.n, s.wo, u1, seen[0], seen[1], bounce);
      from.wo.x = seen[0];
      from.wo.y = seen[1];
    }
    if (s.bumps) {
      mutual_block(b, &s, &met);
      s.met = about.met = &met;
      bumps_draw_block(b, &s, &draw, u1, u2, wi, lost);
    } else {
      draw_block(b, &from, &draw, u1, u2, wi, lost);
    }
    if (facets)
      pass_bounce(size, s.n, bounce, wi[0], wi[1], wi[2], lost);

    /* what these directions are worth, as for any others */
    s.wi = about.wi = (vec){wi[0], wi[1], wi[2]};
    density_of_paths(b, &about, &draw, pdf);
    const results to = {{out->r + start, out->g + start, out->b + start}, out->cosine + start};
    shade_block(b, &s, &to);
    if (each.turned)
      pass_turn_back(size, &each, wi[0], wi[1]);
    for (size_t i = 0; i < size; i++) {
      const int empty = (read & SHADE_BAD_INPUT && room.void_lane[i]) |
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

#endif
