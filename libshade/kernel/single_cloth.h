/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One prepared lane of cloth, from the leaves of pass_cloth.h: a light in one call. There every
 * loop over a block is begun for a single lane and ended again, which takes twice the time.
 */

/* What is asked of the lobes of side k, in the frame of its fibres: spec and matt of the yarns, or
 * in spec what comes through. */
static void FN(cloth_lobe_one)(FN(asked) what, const FN(cloth) * c, const fabric_side *s, int k,
                               FN(gathered) * g, real *spec, real *matt) {
  const int kind = c->kind[0];
  const real gloss = FN(cloth_row)(c, CLOTH_GLOSS + k)[0];
  const fabric_lobe which = FN(cloth_lobe)(FN(ASK_YARN), kind);
  shade_bsdf room;
  if (what == FN(ASK_THROUGH) && kind > CLOTH_WARP) {
    FN(cloth_mixture)(what, NULL, &s->nodes, g, spec, matt);
    return;
  }
  const bsdf *b = bsdf_of(what == FN(ASK_YARN) && gloss < 1
                              ? shade_fabric_dull_lobe(s, which, (double)gloss, &room)
                              : &s->lobe[which]);
  if (kind == CLOTH_FAR) {
    FN(cloth_run)(what, c, s, kind, b, g, spec, matt);
    return;
  }
  FN(cloth_tilts)(c, kind, &s->one, g);
  if (what == FN(ASK_THROUGH)) {
    FN(cloth_through)(g, spec);
    return;
  }
  const real n[3] = {g->n[0][0], g->n[1][0], g->n[2][0]};
  const real wi[3] = {g->wi[0][0], g->wi[1][0], g->wi[2][0]};
  const real wo[3] = {g->wo[0][0], g->wo[1][0], g->wo[2][0]};
  FN(yarn_one)(b, n, wi, wo, spec, matt);
  if (kind == CLOTH_SINGLE) {
    const FN(faced) f = FN(faced_of)(s);
    const real seen = FN(facing)(f, wi[0], wi[1], wi[2]) * FN(facing)(f, wo[0], wo[1], wo[2]);
    *spec *= seen;
    *matt *= seen;
  }
}

/* w of the cloth in the frame of the fibres of side k, as lane 0. */
LEAF void FN(cloth_carry_one)(const shade_fabric *f, const FN(cloth) * c, int k,
                              const real *const w[3], real (*to)[BLOCK]) {
  const int near = c->kind[0] <= CLOTH_WARP;
  const FN(carried) from = FN(cloth_carried)(f, c, k, w);
  const FN(triple) v = FN(cloth_carry_lane)(from, 0, near, c->flat);
  to[0][0] = v.x;
  to[1][0] = v.y;
  to[2][0] = v.z;
}

/* As cloth_block of one lane; any horizon but schuessler. */
static unsigned FN(cloth_one)(const shade_fabric *f, const FN(cloth) * c,
                              const real *const given[3], real *const rgb[3]) {
  const real *row = c->rows;
  const size_t step = c->stride;
  const int kind = c->kind[0];
  real w[3] = {given[0][0], given[1][0], given[2][0]}, sum[3];
  const real *const wi[3] = {w, w + 1, w + 2};
  const real *const wo[3] = {row + CLOTH_WO * step, row + (CLOTH_WO + 1) * step,
                             row + (CLOTH_WO + 2) * step};
  const unsigned mended = FN(mend_if_needed)(w, 0);
  const int opposite = !f->transmits && FN(is_opposite)(w[0], w[1], w[2], *wo[0], *wo[1], *wo[2]);
  const unsigned status = opposite ? mended | SHADE_BAD_INPUT : mended;
  const real nx = row[CLOTH_N * step], ny = row[(CLOTH_N + 1) * step],
             nz = row[(CLOTH_N + 2) * step];
  const real ci = FN(dot)(nx, ny, nz, w[0], w[1], w[2]);
  const real co = FN(dot)(nx, ny, nz, *wo[0], *wo[1], *wo[2]);
  const real side = FN(side_of)(ci, co, w[2], *wo[2]);
  rgb[0][0] = rgb[1][0] = rgb[2][0] = 0;
  if (mended & SHADE_BAD_INPUT || kind == CLOTH_VOID || side == 0)
    return status;
  for (int a = 0; a < 3; a++)
    sum[a] = side > 0 ? row[(size_t)(CLOTH_FLAT + a) * step] * ci * INVERSE_PI : 0;

  const int ask = side > 0 || f->transmits;
  const real white =
      FN(schlick_weight)(FN(half_cosine)(w[0] + *wo[0], w[1] + *wo[1], w[2] + *wo[2]));
  for (int k = 0; ask && k < 2; k++) {
    const fabric_side *s = &f->side[k];
    const real weight = row[(size_t)(CLOTH_WEIGHT + k) * step];
    FN(gathered) g;
    real spec = 0, matt = 0;
    if (kind == CLOTH_GAP || (kind <= CLOTH_WARP && kind != k) || !(weight > 0))
      continue;
    g.count = 1;
    g.whole = 1;
    g.lane[0] = 0;
    FN(cloth_carry_one)(f, c, k, wi, g.wi);
    FN(cloth_carry_one)(f, c, k, wo, g.wo);
    FN(cloth_lobe_one)(side > 0 ? FN(ASK_YARN) : FN(ASK_THROUGH), c, s, k, &g, &spec, &matt);
    for (int a = 0; a < 3; a++) {
      const real kd = row[(size_t)(CLOTH_KD + 3 * k + a) * step], f0 = (real)s->f0[a];
      if (side > 0)
        sum[a] += weight * spec * (f0 + (1 - f0) * white) + kd * matt;
      else
        sum[a] += row[(size_t)(CLOTH_KT + 3 * k + a) * step] * spec;
    }
  }

  if (f->shadows && FN(absolute)(ci) < (real)f->shadows_below) {
    const real lit = FN(shadowing_lane)(FN(shadowing_of)(f, c), 0, c->flat, w[0], w[1], w[2]);
    for (int a = 0; a < 3; a++)
      sum[a] *= lit;
  }
  const real nap = row[CLOTH_NAP * step];
  if (nap > 0) {
    const FN(napped) fibres = FN(napped_of)(nap, ci, co, side);
    for (int a = 0; a < 3; a++)
      sum[a] = sum[a] * fibres.through + (real)f->nap_color[a] * fibres.back;
  }
  real factor = 1;
  if (!c->flat && w[2] > 0) { /* light from behind meets no bumps */
    const real *n = row + CLOTH_GIVEN * step;
    const shade_horizon_traits is = shade_horizon_is(f->horizon);
    if (is.fade == SHADE_FADE_CHIANG)
      factor = FN(shadow_chiang)(n[0], n[step], n[2 * step], w[0], w[1], w[2]);
    else if (is.fade == SHADE_FADE_ESTEVEZ)
      factor = FN(shadow_estevez)(n[0], n[step], n[2 * step], w[0], w[1], w[2]);
  }
  for (int a = 0; a < 3; a++)
    rgb[a][0] = factor * sum[a];
  return status;
}

/* s of every lane; rgb does not overlap wi. Returns status bits. */
static unsigned FN(kernel_cloth)(const shade_fabric *f, const FN(cloth) * c,
                                 const real *const wi[3], real *const rgb[3]) {
  const int one = c->count == 1 && f->horizon != SHADE_HORIZON_SCHUESSLER;
  return one ? FN(cloth_one)(f, c, wi, rgb) : FN(cloth_block)(f, c, wi, rgb);
}
