/* SPDX-License-Identifier: Apache-2.0 */
/* The model over a block: the specular part, the diffuse one, and both by the rule of `hard`. */

/* Where a block's results go; by its address, as a block. */
typedef struct FN(results) {
  real *rgb[3], *cosine;
} FN(results);

/* Scratch of the specular part. */
typedef struct FN(specular_room) {
  ROOM hx[BLOCK], hy[BLOCK], hz[BLOCK], t[BLOCK], xx[BLOCK], yy[BLOCK];
} FN(specular_room);

/*
 * f without Fresnel in d, the cosines as pass_cosines leaves them, and hwo. Nonzero when some
 * lane has wi = -wo.
 */
LEAF int FN(specular_block)(const bsdf *b, const FN(block) * s, FN(specular_room) * m, real *hwo,
                            real *cosi, real *coso, real *d) {
  const size_t size = s->count;
  const FN(vec) h = {m->hx, m->hy, m->hz};
  if (FN(is_fused)(b))
    return FN(pass_fused)(b, s, hwo, cosi, coso, d);
  const int opposite = FN(pass_half)(size, XYZ(s->wi), XYZ(s->wo), m->hx, m->hy, m->hz, hwo);
  if (b->warp != SHADE_RIGID)
    FN(pass_unit)(size, m->hx, m->hy, m->hz);
  FN(pass_lobe)(b, &s->shape, size, s->n, h, m->t, m->xx, m->yy, d);
  FN(pass_cosines)(b, size, s->n, s->wi, s->wo, cosi, coso);
  if (b->brdf == SHADE_BRDF_MICROFACET) { /* h is done with */
    FN(pass_detail)(b->carry.shadow, size, s->n, s->wi, m->t, m->xx, m->yy);
    FN(pass_smith)(b, &s->shape, size, m->xx, m->yy, m->hx);
    FN(pass_detail)(b->carry.shadow, size, s->n, s->wo, m->t, m->xx, m->yy);
    FN(pass_smith)(b, &s->shape, size, m->xx, m->yy, m->hy);
  }
  FN(pass_brdf)(b, size, hwo, cosi, coso, m->hx, m->hy, d);
  return opposite;
}

/* f and the cosine, 0 beyond the horizons of n and z. Directions are mended. */
static unsigned FN(hard_block)(const bsdf *b, const FN(block) * s, const FN(results) * out) {
  FN(specular_room) room;
  ROOM d[BLOCK], coso[BLOCK], hwo[BLOCK], q[BLOCK];
  real *cosi = out->cosine;
  const size_t size = s->count;
  const shade_fresnel_traits fresnel = shade_fresnel_is(b->fresnel);
  const int plain = !s->f0[0] && !s->f0[1] && !s->f0[2] && fresnel.f0 && !fresnel.tint;
  unsigned status = SHADE_OK;
  if (FN(specular_block)(b, s, &room, hwo, cosi, coso, d)) {
    status = SHADE_BAD_INPUT;
    for (size_t i = 0; i < size; i++)
      if (FN(opposite)(s->wi.x[i], s->wi.y[i], s->wi.z[i], s->wo.x[i], s->wo.y[i], s->wo.z[i]))
        d[i] = coso[i] = 0;
  }
  if (!b->has_specular)
    memset(d, 0, size * sizeof *d);
  if (plain)
    FN(pass_colour)
  (size, fresnel.grazing ? R(1.0) : R(0.0), b->FN(f0)[0], b->FN(f0)[1], b->FN(f0)[2], d, hwo,
   out->rgb[0], out->rgb[1], out->rgb[2]);
  else for (int c = 0; c < 3; c++)
      FN(pass_channel)(b, c, size, s->f0[c], s->tint[c], s->k[c], d, hwo, out->rgb[c]);
  if (b->has_diffuse) {
    FN(diffuse_block)(b, size, s->n, s->wi, s->wo, cosi, coso, room.xx, room.yy, q);
    for (int c = 0; c < 3; c++)
      FN(add_diffuse)(b, c, size, s->kd[c], s->f0[c], q, out->rgb[c]);
  }
  return status;
}

/*
 * What one yarn does with the light, for the mixtures of fabric.h, per sample: spec is the
 * BRDF without Fresnel, times the cosine; matt is Phi/pi times the light that enters and leaves by
 * Schlick's white share, (1 - w(n.wi))(1 - w(n.wo)). Both 0 beyond a horizon. No mending:
 * n, wi and wo are unit, n.z > 0. Of `varied`, NULL for none, only the shape of the lobe is used.
 */
static void FN(yarn_batch)(const bsdf *given, size_t count, const FN(shade_lanes) * in,
                           const FN(varied) * varied, real *spec, real *matt) {
  FN(specular_room) room;
  ROOM hwo[BLOCK], cosi[BLOCK], coso[BLOCK];
  FN(varied_room) each;
  bsdf copy;
  const bsdf *b = varied ? FN(for_lanes)(given, varied, &copy) : given;
  FN(block) s = {.shape = FN(own_shape)(b)};
  for (size_t start = 0; start < count; start += BLOCK) {
    s.count = count - start < BLOCK ? count - start : BLOCK;
    s.n = FN(vec_from)(in->nx, in->ny, in->nz, start);
    s.wi = FN(vec_from)(in->wix, in->wiy, in->wiz, start);
    s.wo = FN(vec_from)(in->wox, in->woy, in->woz, start);
    if (varied)
      FN(read_varied)(b, varied, start, FN(is_fused)(b), &s, &each);
    real *d = spec + start, *q = matt + start;
    FN(specular_block)(b, &s, &room, hwo, cosi, coso, d);
    FN(diffuse_block)(b, s.count, s.n, s.wi, s.wo, cosi, coso, room.xx, room.yy, q);
    FN(pass_yarn)(s.count, cosi, coso, d, q);
  }
}
