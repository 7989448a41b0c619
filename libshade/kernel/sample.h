/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Draws and their density over arrays. A block of draws passes: which part (diffuse, or a lobe of
 * the proposal), the eye in the carried frame, a half vector there, the half vector in the local
 * frame, its reflection; then the density and f of the directions that came out, by the same
 * loops that answer for any other direction.
 */

static unsigned FN(pdf_batch)(const bsdf *given, size_t count, const FN(shade_lanes) * in,
                              const FN(varied) * varied, real *out) {
  FN(mended) room;
  FN(varied_room) each;
  FN(draw_room) draw;
  FN(vec_room) bent;
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = varied ? FN(for_lanes)(given, varied, &copy) : given;
  FN(block) s = {.shape = FN(own_shape)(b)};
  for (size_t start = 0; start < count; start += BLOCK) {
    s.count = count - start < BLOCK ? count - start : BLOCK;
    s.n = FN(vec_from)(in->nx, in->ny, in->nz, start);
    s.wi = FN(vec_from)(in->wix, in->wiy, in->wiz, start);
    s.wo = FN(vec_from)(in->wox, in->woy, in->woz, start);
    FN(vec) *const v[3] = {&s.n, &s.wi, &s.wo};
    const unsigned mended = FN(mend_block)(s.count, 3, v, &room);
    status |= mended;
    if (varied)
      status |= FN(read_varied)(b, varied, start, 1, &s, &each);
    FN(prepare_shares)(b, &s, &draw);
    if (shade_horizon_is(b->horizon).bends) {
      FN(pass_bend)(s.count, s.n, s.wo, &bent);
      s.n = FN(vec_in)(&bent);
    }
    status |= FN(density_of_paths)(b, &s, &draw, out + start);
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
static void FN(draw_block)(const bsdf *b, const FN(block) * s, FN(draw_room) * m, real *u1,
                           real *u2, real *const wi[3], real *lost) {
  ROOM share[BLOCK], matt[BLOCK];
  const size_t size = s->count;
  real *hx = m->h[0], *hy = m->h[1], *hz = m->h[2];
  real *const even[3] = {m->oxx, m->oyy, m->xx}; /* the diffuse part's draw */
  FN(pass_cosines)(b, size, s->n, s->wo, s->wo, m->cosi, m->coso);
  if (b->has_diffuse) {
    FN(block_share)(b, size, m, share);
    FN(pass_split)(size, share, u1, matt);
    FN(pass_draw_matt)(size, b->draw_even ? R(0.5) : R(0.0), u1, u2, even[0], even[1], even[2]);
    FN(pass_out_of_frame)
    (b->carry.map == SHADE_MAP_NONE ? SHADE_MAP_NONE : SHADE_MAP_SHORTEST_ARC, size, s->n, even[0],
     even[1], even[2]);
  }
  FN(choose_part)(b, s, u1, m->kx, m->ky);
  if (b->visible) {
    FN(pass_into_frame)(b->carry.frame, size, s->n, s->wo, hx, hy);
    memcpy(hz, m->coso, size * sizeof *hz);
  }
  FN(pass_draw)(b, size, u1, u2, m->kx, m->ky, hx, hy, hz);
  FN(pass_out_of_frame)(b->carry.frame, size, s->n, hx, hy, hz);
  FN(pass_reflect)(size, s->wo, hx, hy, hz, lost);
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
  FN(pass_settle)(size, wi[0], wi[1], wi[2], lost);
}

/*
 * Directions alone, of a lobe as cloth has them: rigid or warped, horizon `hard`, nothing diffuse.
 * A block at most; 0 where there is none.
 */
static void FN(draw_lobe)(const bsdf *given, size_t count, const FN(vec) * n, const FN(vec) * wo,
                          const FN(varied) * varied, real *u1, real *u2, real *const wi[3]) {
  FN(mended) room;
  FN(varied_room) each;
  FN(draw_room) draw;
  ROOM lost[BLOCK], pdf[BLOCK];
  bsdf copy;
  const bsdf *b = varied ? FN(for_lanes)(given, varied, &copy) : given;
  FN(block) s;
  FN(start_block)(b, &s);
  s.count = count;
  s.n = *n;
  s.wo = *wo;
  s.wi = (FN(vec)){NULL, NULL, NULL};
  FN(vec) *const v[3] = {&s.n, &s.wo, NULL};
  FN(mend_block)(count, 2, v, &room);
  if (varied)
    FN(read_varied)(b, varied, 0, 1, &s, &each);
  FN(prepare_shares)(b, &s, &draw);
  FN(draw_block)(b, &s, &draw, u1, u2, wi, lost);
  s.wi = (FN(vec)){wi[0], wi[1], wi[2]};
  /* what the density is 0 for: a rigid lobe's beyond the horizons only */
  if (b->warp == SHADE_RIGID)
    FN(pass_cosines)(b, count, s.n, s.wi, s.wo, draw.cosi, pdf);
  else
    FN(density_block)(b, &s, &draw, pdf);
  if (varied && each.turned)
    FN(pass_turn_back)(count, each.c, each.s, each.mirror, wi[0], wi[1]);
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

static unsigned FN(sample_batch)(const bsdf *given, size_t count, const FN(shade_sample_lanes) * in,
                                 const FN(varied) * varied, const FN(shade_sample_result) * out) {
  FN(mended) room;
  FN(varied_room) each;
  FN(draw_room) draw;
  FN(vec_room) bent;
  ROOM u1[BLOCK], u2[BLOCK], lost[BLOCK], seen[2][BLOCK], bounce[BLOCK];
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = varied ? FN(for_lanes)(given, varied, &copy) : given;
  const FN(shape) own = FN(own_shape)(b);
  const shade_horizon_traits horizon = shade_horizon_is(b->horizon);
  for (size_t start = 0; start < count; start += BLOCK) {
    const size_t size = count - start < BLOCK ? count - start : BLOCK;
    real *const wi[3] = {out->wix + start, out->wiy + start, out->wiz + start};
    FN(block) s = {.count = size, .shape = own}; /* n as given: f bends it for itself */
    s.n = FN(vec_from)(in->nx, in->ny, in->nz, start);
    s.wo = FN(vec_from)(in->wox, in->woy, in->woz, start);
    FN(vec) *const v[3] = {&s.n, &s.wo};
    const unsigned mended = FN(mend_block)(size, 2, v, &room);
    const int odd =
        FN(pass_uniform)(size, in->u1 + start, u1) | FN(pass_uniform)(size, in->u2 + start, u2);
    status |= mended;
    if (varied)
      status |= FN(read_varied)(b, varied, start, FN(is_fused)(b), &s, &each);
    FN(prepare_shares)(b, &s, &draw);
    FN(block) about = s;
    if (horizon.bends) {
      FN(pass_bend)(size, s.n, s.wo, &bent);
      about.n = FN(vec_in)(&bent);
    }
    FN(block) from = about;
    if (horizon.facets) {
      FN(pass_choose_path)(size, s.n, s.wo, u1, seen[0], seen[1], bounce);
      from.wo.x = seen[0];
      from.wo.y = seen[1];
    }
    FN(draw_block)(b, &from, &draw, u1, u2, wi, lost);
    if (horizon.facets)
      FN(pass_bounce)(size, s.n, bounce, wi[0], wi[1], wi[2], lost);

    /* what these directions are worth, as for any others */
    s.wi = about.wi = (FN(vec)){wi[0], wi[1], wi[2]};
    real *pdf = out->pdf + start;
    FN(density_of_paths)(b, &about, &draw, pdf);
    const FN(results) to = {{out->r + start, out->g + start, out->b + start}, out->cosine + start};
    FN(shade_block)(b, &s, &to);
    if (varied && each.turned)
      FN(pass_turn_back)(size, each.c, each.s, each.mirror, wi[0], wi[1]);
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
