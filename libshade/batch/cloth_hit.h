/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One light of one prepared hit, from the leaves of cloth_lobes.h. There every loop over a block is
 * begun for a single lane and ended again, which takes twice the time. The terms of a hit have all
 * but the yarns in common: what depends on light and eye alone is computed once for all of them.
 */
#ifndef SHADE_BATCH_CLOTH_HIT_H
#define SHADE_BATCH_CLOTH_HIT_H

#include "cloth_block.h"

/* The lobe of all g's lanes where the hit has less gloss. */
static void cloth_dull_one(const cloth *c, const fabric_side *s, fabric_lobe which, int k,
                           gathered *g) {
  const real gloss = cloth_row(c, CLOTH_GLOSS + k)[0];
  g->dull = gloss < 1;
  if (!g->dull)
    return;
  const pair e = dulled(dulling_of(s, which), gloss);
  for (size_t j = 0; j < g->count; j++) {
    g->ex[j] = e.x;
    g->ey[j] = e.y;
  }
}

/* What is asked of the lobes of side k, in the frame of its fibres: spec and matt of the yarns, or
 * in spec what comes through. */
static void cloth_lobe_one(asked what, const cloth *c, const fabric_side *s, int k, gathered *g,
                           real *spec, real *matt) {
  const int kind = c->kind[0];
  const fabric_lobe which = cloth_lobe(ASK_YARN, s, kind);
  const bsdf *b = bsdf_of(&s->lobe[which]);
  g->dull = 0;
  if (what == ASK_THROUGH && kind > CLOTH_WARP) {
    cloth_mixture(what, b, &s->nodes, g, spec, matt);
    return;
  }
  if (what == ASK_YARN)
    cloth_dull_one(c, s, which, k, g);
  if (kind == CLOTH_FAR) {
    cloth_run(what, c, s, kind, b, g, spec, matt);
    return;
  }
  cloth_tilts(c, kind, &s->one, g);
  if (what == ASK_THROUGH) {
    cloth_through(g, spec);
    return;
  }
  const triple n = {g->n[0][0], g->n[1][0], g->n[2][0]};
  const triple wi = {g->wi[0][0], g->wi[1][0], g->wi[2][0]};
  const triple wo = {g->wo[0][0], g->wo[1][0], g->wo[2][0]};
  if (g->dull)
    cloth_ask(what, b, g, spec, matt);
  else
    yarn_one(b, n, wi, wo, spec, matt);
  if (kind == CLOTH_SINGLE) {
    const faced f = faced_of(s);
    const real seen = facing(f, XYZ(wi)) * facing(f, XYZ(wo));
    *spec *= seen;
    *matt *= seen;
  }
}

/* w of the cloth in the frame of the fibres of side k that term `lane` shows. */
LEAF void cloth_carry_one(const shade_fabric *f, const cloth *c, int k, size_t lane,
                          const real *const w[3], real to[3]) {
  const int near = c->kind[lane] <= CLOTH_WARP;
  carried from = cloth_carried(f, c, k, w);
  from.tx += lane;
  from.ty += lane;
  const triple v = cloth_carry_lane(from, 0, near, c->flat);
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

/*
 * What the near terms send, in the usual lobe of yarns: Ashikhmin and Shirley's, carried by
 * `rotate`. Light and eye, in the frame of the fibres, are the same for all terms of a side, so
 * that one loop does, in which nothing is gathered: a term takes those of the side whose weight it
 * has, and what it does not have of the other is 0.
 */
typedef struct near_side {
  real wi[3], wo[3], kx, ky, peak;
} near_side;
typedef struct near_sent {
  real shine[2], matt[3];
} near_sent;

#define NEAR_SUM(NAME, word, value, label, help)                                                   \
  static void near_sum_##word(const cloth *c, size_t count, const near_side given[2],              \
                              near_sent *sent) {                                                   \
    const real *restrict nx = cloth_row(c, CLOTH_TILT), *restrict ny = nx + c->stride;             \
    const real *restrict nz = ny + c->stride, *restrict part = cloth_row(c, CLOTH_PART);           \
    const real *restrict weft = cloth_row(c, CLOTH_WEIGHT), *restrict warp = weft + c->stride;     \
    const real *restrict kd = cloth_row(c, CLOTH_KD);                                              \
    const size_t step = c->stride;                                                                 \
    const near_side f = given[0], p = given[1];                                                    \
    real sf = 0, sp = 0, r = 0, g = 0, bl = 0;                                                     \
    _Pragma("omp simd reduction(+ : sf, sp, r, g, bl)") for (size_t j = 0; j < count; j++) {       \
      const real x = nx[j], y = ny[j], z = nz[j], w = weft[j] + warp[j];                           \
      const int is = warp[j] > 0;                                                                  \
      const triple wi = {is ? p.wi[0] : f.wi[0], is ? p.wi[1] : f.wi[1], is ? p.wi[2] : f.wi[2]};  \
      const triple wo = {is ? p.wo[0] : f.wo[0], is ? p.wo[1] : f.wo[1], is ? p.wo[2] : f.wo[2]};  \
      const real kx = is ? p.kx : f.kx, ky = is ? p.ky : f.ky, peak = is ? p.peak : f.peak;        \
      const real hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;                             \
      const real hwo = half_cosine(hx, hy, hz), lowest = minimum(wi.z, wo.z);                      \
      const real ci = dot(x, y, z, XYZ(wi)), co = dot(x, y, z, XYZ(wo));                           \
      const real cosi = maximum(ci, 0), coso = maximum(co, 0);                                     \
      const real d =                                                                               \
          ashikhmin_shirley_ratio(detail_rotate_ratio(x, y, z, hx, hy, hz), kx, ky, peak);         \
      const angles a = {hwo, cosi, coso, 0, 0};                                                    \
      const real length = fibre_length(x, z);                                                      \
      const real ly = over_fibre(x, y, z, XYZ(wi)) / length;                                       \
      const real vy = over_fibre(x, y, z, XYZ(wo)) / length;                                       \
      const real phi = diffuse_##word(ly, cosi, vy, coso) * INVERSE_PI;                            \
      const real enter = 1 - schlick_weight(minimum(cosi, 1));                                     \
      const real leave = 1 - schlick_weight(minimum(coso, 1));                                     \
      const real spec = w * (brdf_ashikhmin_shirley(d, a) * cosi), matt = phi * enter * leave;     \
      const int shown = minimum(minimum(ci, co), minimum(lowest, w)) > 0;                          \
      const real shine = shown ? part[j] * spec : 0, diffuse = shown ? part[j] * matt : 0;         \
      sf += is ? 0 : shine;                                                                        \
      sp += is ? shine : 0;                                                                        \
      r += (kd[j] + kd[j + 3 * step]) * diffuse;                                                   \
      g += (kd[j + step] + kd[j + 4 * step]) * diffuse;                                            \
      bl += (kd[j + 2 * step] + kd[j + 5 * step]) * diffuse;                                       \
    }                                                                                              \
    *sent = (near_sent){{sf, sp}, {r, g, bl}};                                                     \
  }
SHADE_TABLE_DIFFUSE(NEAR_SUM)
#undef NEAR_SUM

static void near_sum(shade_diffuse model, const cloth *c, size_t count, const near_side given[2],
                     near_sent *sent) {
  switch (model) {
#define NEAR_CASE(NAME, word, value, label, help)                                                  \
  case SHADE_DIFFUSE_##NAME:                                                                       \
    near_sum_##word(c, count, given, sent);                                                        \
    return;
    SHADE_TABLE_DIFFUSE(NEAR_CASE)
#undef NEAR_CASE
  case SHADE_DIFFUSE_COUNT:
    break;
  }
  near_sum_lambert(c, count, given, sent);
}

/* The first near term of side k, or count. */
static size_t near_first(const cloth *c, int k) {
  const real *weight = cloth_row(c, CLOTH_WEIGHT + k);
  size_t first = 0;
  while (first < c->count && !(c->kind[first] == k && weight[first] > 0))
    first++;
  return first;
}

/*
 * Add what the near terms send of both sides, lit from in front. Returns 0, and adds nothing,
 * where one's lobe is another than usual.
 */
static int cloth_near_sides(const shade_fabric *f, const cloth *c, real white,
                            const real *const wi[3], const real *const wo[3], real sum[3]) {
  near_side given[2];
  near_sent all;
  const bsdf *any = NULL;
  size_t near = c->count;
  for (int k = 0; k < 2; k++) {
    const fabric_side *s = &f->side[k];
    const real gloss = cloth_row(c, CLOTH_GLOSS + k)[0];
    const size_t first = near_first(c, k);
    if (first == c->count) {
      given[k] = (near_side){.wi = {0}};
      continue;
    }
    const bsdf *b = bsdf_of(&s->lobe[FABRIC_NEAR]);
    if (!is_usual(b) || (any && any->diffuse != b->diffuse))
      return 0;
    cloth_carry_one(f, c, k, first, wi, given[k].wi);
    cloth_carry_one(f, c, k, first, wo, given[k].wo);
    given[k].kx = numbers_of(b)->kx;
    given[k].ky = numbers_of(b)->ky;
    given[k].peak = numbers_of(b)->peak;
    if (gloss < 1) {
      const pair e = dulled(dulling_of(s, FABRIC_NEAR), gloss);
      given[k].kx = e.x;
      given[k].ky = e.y;
      given[k].peak = peak_of_exponents(e.x, e.y);
    }
    any = b;
  }
  if (!any)
    return 1;
  if (c->kind[near - 1] == CLOTH_FAR)
    near--; /* it has no tilt, and is the last */
  near_sum(any->diffuse, c, near, given, &all);
  for (int a = 0; a < 3; a++) {
    const real f0 = (real)f->side[0].f0[a], f1 = (real)f->side[1].f0[a];
    sum[a] += all.shine[0] * (f0 + (1 - f0) * white) + all.shine[1] * (f1 + (1 - f1) * white) +
              all.matt[a];
  }
  return 1;
}

/*
 * Add what the yarns of side k send that near terms show: of all of them the fibres run one way.
 * white: Schlick's, if they are lit from in front.
 */
static void cloth_near_terms(const shade_fabric *f, const cloth *c, int k, int lit, real white,
                             const real *const wi[3], const real *const wo[3], real sum[3]) {
  enum { VECTOR = VECTOR_BYTES / sizeof(real) };
  const fabric_side *s = &f->side[k];
  const real *weight = cloth_row(c, CLOTH_WEIGHT + k), *part = cloth_row(c, CLOTH_PART);
  const real *tilt[3] = {cloth_row(c, CLOTH_TILT), cloth_row(c, CLOTH_TILT + 1),
                         cloth_row(c, CLOTH_TILT + 2)};
  gathered g;
  real spec[BLOCK], matt[BLOCK], i[3], o[3], shine = 0;
  const size_t first = near_first(c, k);
  size_t used = 0;
  if (first == c->count)
    return;
  cloth_carry_one(f, c, k, first, wi, i);
  cloth_carry_one(f, c, k, first, wo, o);
  for (size_t j = first; j < c->count; j++)
    if (c->kind[j] == k && weight[j] > 0) {
      for (int a = 0; a < 3; a++)
        g.n[a][used] = tilt[a][j];
      g.lane[used++] = (int)j;
    }
  g.whole = 0;
  g.count = (used + VECTOR - 1) / VECTOR * VECTOR; /* no lane of its own after the last vector */
  for (size_t j = 0; j < g.count; j++) {
    for (int a = 0; a < 3 && j >= used; a++)
      g.n[a][j] = g.n[a][0];
    g.wi[0][j] = i[0];
    g.wi[1][j] = i[1];
    g.wi[2][j] = i[2];
    g.wo[0][j] = o[0];
    g.wo[1][j] = o[1];
    g.wo[2][j] = o[2];
  }
  if (!lit) {
    cloth_through(&g, spec);
    for (int a = 0; a < 3; a++) {
      const real *kt = cloth_row(c, CLOTH_KT + 3 * k + a);
      for (size_t j = 0; j < used; j++)
        sum[a] += part[g.lane[j]] * kt[g.lane[j]] * spec[j];
    }
    return;
  }
  cloth_dull_one(c, s, FABRIC_NEAR, k, &g);
  cloth_ask(ASK_YARN, bsdf_of(&s->lobe[FABRIC_NEAR]), &g, spec, matt);
  for (size_t j = 0; j < used; j++) {
    const size_t lane = (size_t)g.lane[j];
    shine += part[lane] * weight[lane] * spec[j];
    matt[j] *= part[lane];
  }
  for (int a = 0; a < 3; a++) {
    const real *kd = cloth_row(c, CLOTH_KD + 3 * k + a), f0 = (real)s->f0[a];
    sum[a] += shine * (f0 + (1 - f0) * white);
    for (size_t j = 0; j < used; j++)
      sum[a] += kd[g.lane[j]] * matt[j];
  }
}

/* Add `part` of what one term sends of side k. */
static void cloth_add_one(const shade_fabric *f, const cloth *c, int k, real part, int lit,
                          real white, const real *const wi[3], const real *const wo[3],
                          real sum[3]) {
  const fabric_side *s = &f->side[k];
  const real *row = c->rows, weight = row[(size_t)(CLOTH_WEIGHT + k) * c->stride];
  const int kind = c->kind[0];
  gathered g;
  real i[3], o[3], spec = 0, matt = 0;
  if (kind == CLOTH_GAP || (kind <= CLOTH_WARP && kind != k) || !(weight > 0))
    return;
  cloth_carry_one(f, c, k, 0, wi, i);
  cloth_carry_one(f, c, k, 0, wo, o);
  g.count = 1;
  g.whole = 1;
  g.lane[0] = 0;
  for (int a = 0; a < 3; a++) {
    g.wi[a][0] = i[a];
    g.wo[a][0] = o[a];
  }
  cloth_lobe_one(lit ? ASK_YARN : ASK_THROUGH, c, s, k, &g, &spec, &matt);
  for (int a = 0; a < 3; a++) {
    const real kd = row[(size_t)(CLOTH_KD + 3 * k + a) * c->stride], f0 = (real)s->f0[a];
    if (lit)
      sum[a] += part * (weight * spec * (f0 + (1 - f0) * white) + kd * matt);
    else
      sum[a] += part * (row[(size_t)(CLOTH_KT + 3 * k + a) * c->stride] * spec);
  }
}

/*
 * Add `part` of what a far term sends: both sides at once, as is usual. Returns 0, and adds
 * nothing, where a side is not there or not looked up in its table alone.
 */
static int cloth_far_sides(const shade_fabric *f, const cloth *c, real part, real white,
                           const real *const wi[3], const real *const wo[3], real sum[3]) {
  const real near = (real)FABRIC_NEARBY;
  table_query q[2];
  real spec[2], matt[2];
  for (int k = 0; k < 2; k++) {
    if (!(f->side[k].table && cloth_row(c, CLOTH_WEIGHT + k)[0] > 0 &&
          cloth_row(c, CLOTH_GLOSS + k)[0] >= 1))
      return 0;
    q[k].table = f->side[k].table;
    cloth_carry_one(f, c, k, 0, wi, q[k].wi);
    cloth_carry_one(f, c, k, 0, wo, q[k].wo);
    const real *i = q[k].wi, *o = q[k].wo;
    if (!(dot(i[0], i[1], i[2], o[0], o[1], o[2]) >= near))
      return 0;
  }
  table_sides(q, spec, matt);
  for (int k = 0; k < 2; k++)
    for (int a = 0; a < 3; a++) {
      const real kd = cloth_row(c, CLOTH_KD + 3 * k + a)[0], f0 = (real)f->side[k].f0[a];
      const real weight = cloth_row(c, CLOTH_WEIGHT + k)[0];
      sum[a] += part * (weight * spec[k] * (f0 + (1 - f0) * white) + kd * matt[k]);
    }
  return 1;
}

/* The mean over the terms of one hit, as cloth_block has it; any horizon but schuessler. */
static unsigned cloth_mean(const shade_fabric *f, const cloth *c, const real given[3],
                           real sum[3]) {
  const real *row = c->rows, whole = 1;
  const real *part = c->count == 1 ? &whole : cloth_row(c, CLOTH_PART);
  const size_t step = c->stride;
  real w[3] = {given[0], given[1], given[2]};
  const real *const wi[3] = {w, w + 1, w + 2};
  const real *const wo[3] = {row + CLOTH_WO * step, row + (CLOTH_WO + 1) * step,
                             row + (CLOTH_WO + 2) * step};
  const unsigned mended = mend_if_needed(w, 0);
  const int opposite = !f->transmits && is_opposite(w[0], w[1], w[2], *wo[0], *wo[1], *wo[2]);
  const unsigned status = opposite ? mended | SHADE_BAD_INPUT : mended;
  const real nx = row[CLOTH_N * step], ny = row[(CLOTH_N + 1) * step],
             nz = row[(CLOTH_N + 2) * step];
  const real ci = dot(nx, ny, nz, w[0], w[1], w[2]);
  const real co = dot(nx, ny, nz, *wo[0], *wo[1], *wo[2]);
  const real side = side_of(ci, co, w[2], *wo[2]);
  const int lit = side > 0;
  sum[0] = sum[1] = sum[2] = 0;
  if (mended & SHADE_BAD_INPUT || c->kind[0] == CLOTH_VOID || side == 0)
    return status;
  for (int a = 0; lit && a < 3; a++) {
    const real *flat = cloth_row(c, CLOTH_FLAT + a);
    real shown = 0;
#pragma omp simd reduction(+ : shown)
    for (size_t i = 0; i < c->count; i++)
      shown += part[i] * flat[i];
    sum[a] = shown * ci * INVERSE_PI;
  }

  const real white = schlick_weight(half_cosine(w[0] + *wo[0], w[1] + *wo[1], w[2] + *wo[2]));
  /* the far term, if there is one, is the last: it has no tilt */
  const size_t last = c->count - 1;
  const cloth one = {1, step, c->flat, c->kind + last, c->rows + last};
  const int alone = c->count == 1 || one.kind[0] == CLOTH_FAR;
  const int far =
      lit && one.kind[0] == CLOTH_FAR && cloth_far_sides(f, &one, part[last], white, wi, wo, sum);
  const int near = c->count == 1 || (lit && cloth_near_sides(f, c, white, wi, wo, sum));
  for (int k = 0; (lit || f->transmits) && k < 2; k++) {
    if (!near)
      cloth_near_terms(f, c, k, lit, white, wi, wo, sum);
    if (alone && !far)
      cloth_add_one(f, &one, k, part[last], lit, white, wi, wo, sum);
  }

  if (f->shadows && absolute(ci) < (real)f->shadows_below) {
    const real shadow = shadowing_lane(shadowing_of(f, c), 0, c->flat, w[0], w[1], w[2]);
    for (int a = 0; a < 3; a++)
      sum[a] *= shadow;
  }
  const real nap = row[CLOTH_NAP * step];
  if (nap > 0) {
    const napped fibres = napped_of(nap, ci, co, side);
    for (int a = 0; a < 3; a++)
      sum[a] = sum[a] * fibres.through + (real)f->nap_color[a] * fibres.back;
  }
  real factor = 1;
  if (!c->flat && w[2] > 0) { /* light from behind meets no bumps */
    const real *n = row + CLOTH_GIVEN * step;
    const shade_horizon_traits is = shade_horizon_is(f->horizon);
    if (is.fade == SHADE_FADE_CHIANG)
      factor = shadow_chiang(n[0], n[step], n[2 * step], w[0], w[1], w[2]);
    else if (is.fade == SHADE_FADE_ESTEVEZ)
      factor = shadow_estevez(n[0], n[step], n[2 * step], w[0], w[1], w[2]);
  }
  for (int a = 0; a < 3; a++)
    sum[a] *= factor;
  return status;
}

/* As cloth_block. */
static unsigned entry_cloth(const shade_fabric *f, const cloth *c, const real *const wi[3],
                            real *const *rgb, real *pdf) {
  if (!rgb || c->count != 1 || f->horizon == SHADE_HORIZON_SCHUESSLER)
    return cloth_block(f, c, wi, rgb, pdf);
  const real w[3] = {wi[0][0], wi[1][0], wi[2][0]};
  real s[3];
  const unsigned more = pdf ? cloth_block(f, c, wi, NULL, pdf) : SHADE_OK;
  const unsigned status = cloth_mean(f, c, w, s);
  for (int a = 0; a < 3; a++)
    rgb[a][0] = s[a];
  return status | more;
}

/* The mean of s over the terms of one hit, for one light. Returns status bits. */
static unsigned entry_cloth_hit(const shade_fabric *f, const cloth *c, const real wi[3],
                                real s[3]) {
  if (f->horizon != SHADE_HORIZON_SCHUESSLER)
    return cloth_mean(f, c, wi, s);
  const real *part = cloth_row(c, CLOTH_PART);
  real w[3][BLOCK], rgb[3][BLOCK];
  for (int a = 0; a < 3; a++)
    for (size_t i = 0; i < c->count; i++)
      w[a][i] = wi[a];
  const real *const from[3] = {w[0], w[1], w[2]};
  real *const to[3] = {rgb[0], rgb[1], rgb[2]};
  const unsigned status = cloth_block(f, c, from, to, NULL);
  for (int a = 0; a < 3; a++) {
    s[a] = 0;
    for (size_t i = 0; i < c->count; i++)
      s[a] += part[i] * rgb[a][i];
  }
  return status;
}

#endif
