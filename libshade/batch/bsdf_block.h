/* SPDX-License-Identifier: Apache-2.0 */
/* The model over a block: the specular part, the diffuse one, and both by the rule of `hard`. */
#ifndef SHADE_BATCH_BSDF_BLOCK_H
#define SHADE_BATCH_BSDF_BLOCK_H

#include "../model/public.h"
#include "brdf_block.h"
#include "diffuse_block.h"
#include "ggx_block.h"
#include "multiscatter_block.h"
#include "varied_block.h"

/* Where a block's results go; by its address, as a block. */
typedef struct results {
  real *rgb[3], *cosine;
} results;

/* Scratch of the specular part. */
typedef struct specular_room {
  ROOM hx[BLOCK], hy[BLOCK], hz[BLOCK], t[BLOCK], xx[BLOCK], yy[BLOCK];
} specular_room;

/*
 * f without Fresnel in d, the cosines as pass_cosines leaves them, and hwo. Nonzero when some
 * lane has wi = -wo.
 */
LEAF int specular_block(const bsdf *b, const sample_block *s, specular_room *m, real *hwo,
                        real *cosi, real *coso, real *d) {
  const size_t size = s->count;
  const vec h = {m->hx, m->hy, m->hz};
  if (is_fused(b))
    return pass_fused(b, s, hwo, cosi, coso, d);
  const int opposite = pass_half(size, s->wi, s->wo, m->hx, m->hy, m->hz, hwo);
  if (b->warp != SHADE_RIGID)
    pass_unit(size, m->hx, m->hy, m->hz);
  pass_lobe(b, &s->shape, size, s->n, h, m->t, m->xx, m->yy, d);
  pass_cosines(b, size, s->n, s->wi, s->wo, cosi, coso);
  if (b->brdf == SHADE_BRDF_MICROFACET) { /* h is done with */
    pass_detail(b->carry.shadow, size, s->n, s->wi, m->t, m->xx, m->yy);
    pass_smith(b, &s->shape, size, m->xx, m->yy, m->hx);
    pass_detail(b->carry.shadow, size, s->n, s->wo, m->t, m->xx, m->yy);
    pass_smith(b, &s->shape, size, m->xx, m->yy, m->hy);
  }
  pass_brdf(b, size, hwo, cosi, coso, m->hx, m->hy, d);
  return opposite;
}

/* f and the cosine, 0 beyond the horizons of n and z. Directions are mended. */
static unsigned hard_block(const bsdf *b, const sample_block *s, const results *out) {
  specular_room room;
  ROOM d[BLOCK], coso[BLOCK], hwo[BLOCK], q[BLOCK];
  real *cosi = out->cosine;
  const size_t size = s->count;
  unsigned status = SHADE_OK;
  if (specular_block(b, s, &room, hwo, cosi, coso, d)) {
    status = SHADE_BAD_INPUT;
    for (size_t i = 0; i < size; i++)
      if (opposite(s->wi.x[i], s->wi.y[i], s->wi.z[i], s->wo.x[i], s->wo.y[i], s->wo.z[i]))
        d[i] = coso[i] = 0;
  }
  if (!b->has_specular)
    memset(d, 0, size * sizeof *d);
  for (int c = 0; c < 3; c++)
    pass_channel(b, size, s->f0[c], s->tint[c], s->k[c], d, hwo, out->rgb[c]);
  if (b->multiscatter && b->has_specular)
    multiscatter_block(b, s, room.t, room.xx, room.yy, room.hx, out->rgb);
  if (b->has_diffuse) {
    const real less = shade_diffuse_is(b->diffuse).less_f0 ? R(1.0) : R(0.0);
    diffuse_block(b, size, s->n, s->wi, s->wo, cosi, coso, room.xx, room.yy, q);
    for (int c = 0; c < 3; c++)
      add_diffuse(size, less, s->kd[c], s->f0[c], q, out->rgb[c]);
  }
  return status;
}

/*
 * What one yarn does with the light, for the mixtures of fabric.h, per sample: spec is the
 * BRDF without Fresnel, times the cosine; matt is Phi/pi times the light that enters and leaves by
 * Schlick's white share, (1 - w(n.wi))(1 - w(n.wo)). Both 0 beyond a horizon. No mending:
 * n, wi and wo are unit, n.z > 0. Of `varied` only the shape of the lobe is used.
 */
static void yarn_batch(const bsdf *given, size_t count, const bsdf_lanes *in,
                       const varied_arrays *varied, real *spec, real *matt) {
  specular_room room;
  ROOM hwo[BLOCK], cosi[BLOCK], coso[BLOCK];
  varied_room each;
  bsdf copy;
  const bsdf *b = for_lanes(given, varied, &copy);
  sample_block s;
  own_shape(b, count, &each, &s);
  for (size_t start = 0; start < count; start += BLOCK) {
    s.count = count - start < BLOCK ? count - start : BLOCK;
    s.n = vec_from(in->nx, in->ny, in->nz, start);
    s.wi = vec_from(in->wix, in->wiy, in->wiz, start);
    s.wo = vec_from(in->wox, in->woy, in->woz, start);
    read_varied(b, varied, start, &s, &each);
    real *d = spec + start, *q = matt + start;
    specular_block(b, &s, &room, hwo, cosi, coso, d);
    diffuse_block(b, s.count, s.n, s.wi, s.wo, cosi, coso, room.xx, room.yy, q);
    pass_yarn(s.count, cosi, coso, d, q);
  }
}

#endif
