/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One prepared lane of cloth: what single calls are made of. Loops over lanes come here with what
 * no rendered frame has much of: light from behind, mirrors of facets.
 */
#ifndef SHADE_BATCH_CLOTH_ONE_H
#define SHADE_BATCH_CLOTH_ONE_H

#include "../model/cloth_shade.h"
#include "../model/draw.h"
#include "../model/single.h"
#include "cloth.h"
#include "sample_batch.h"
#include "table_block.h"

LEAF triple cloth_triple(const cloth *c, int row, size_t i) {
  return (triple){cloth_row(c, row)[i], cloth_row(c, row + 1)[i], cloth_row(c, row + 2)[i]};
}

LEAF int cloth_is_near(int kind) {
  return kind <= CLOTH_WARP;
}

/* Whether lane i shows anything of side k. */
LEAF int cloth_shows(const cloth *c, size_t i, int k) {
  const int kind = c->kind[i];
  return (cloth_is_near(kind) ? kind == k : kind == CLOTH_FAR || kind == CLOTH_SINGLE) &&
         cloth_row(c, CLOTH_WEIGHT + k)[i] > 0;
}

/*
 * Warp is weft with x and y exchanged, a mirror, in which turning is the other way round: the
 * fibres' direction (tx, ty) of the cloth becomes (ty, tx), and y of the answer changes sign.
 */
typedef struct carried {
  const real *nx, *ny, *nz, *tx, *ty;
  real mx, my, flip;
} carried;

LEAF carried cloth_carried(const shade_fabric *f, const cloth *c, int k) {
  return (carried){.nx = cloth_row(c, CLOTH_N + k),
                   .ny = cloth_row(c, CLOTH_N + 1 - k),
                   .nz = cloth_row(c, CLOTH_N + 2),
                   .tx = cloth_row(c, CLOTH_FIBRE + k),
                   .ty = cloth_row(c, CLOTH_FIBRE + 1 - k),
                   .mx = (real)(k ? f->side[k].ty : f->side[k].tx),
                   .my = (real)(k ? f->side[k].tx : f->side[k].ty),
                   .flip = k ? R(-1.0) : R(1.0)};
}

/* Of lane i; near: along its own fibres, else along their mean; flat: n is z. */
LEAF carrier cloth_carrier(carried v, size_t i, int near, int flat) {
  const real tx = near ? v.tx[i] : v.mx, ty = near ? v.ty[i] : v.my;
  return flat ? carrier_flat(tx, ty) : carrier_of(v.nx[i], v.ny[i], v.nz[i], tx, ty);
}

/* w, exchanged for warp, to the frame of the fibres, and back from there. */
LEAF triple cloth_carry_lane(carried v, size_t i, int near, int flat, triple w) {
  const triple to = carry(cloth_carrier(v, i, near, flat), XYZ(w));
  return (triple){to.x, v.flip * to.y, to.z};
}
LEAF triple cloth_carry_back_lane(carried v, size_t i, int near, triple w) {
  return carry_back(cloth_carrier(v, i, near, 0), w.x, v.flip * w.y, w.z);
}

/* Light and eye in the frame of the fibres of side k, and there the normal of the lane's lobe. */
typedef struct yarn_view {
  triple n, wi, wo;
} yarn_view;

static yarn_view yarn_view_of(const shade_fabric *f, const cloth *c, size_t i, int k, triple wi,
                              triple wo) {
  const carried from = cloth_carried(f, c, k);
  const fabric_nodes *one = &f->side[k].one;
  const int near = cloth_is_near(c->kind[i]);
  return (yarn_view){near ? cloth_triple(c, CLOTH_TILT, i)
                          : (triple){one->SUFFIX(x)[0], one->SUFFIX(y)[0], one->SUFFIX(z)[0]},
                     cloth_carry_lane(from, i, near, 0, exchanged(wi, k)),
                     cloth_carry_lane(from, i, near, 0, exchanged(wo, k))};
}

LEAF triple node_normal(const fabric_nodes *nodes, int i) {
  return (triple){nodes->SUFFIX(x)[i], nodes->SUFFIX(y)[i], nodes->SUFFIX(z)[i]};
}

/* A lobe of a side, as dull as the gloss. */
static lobe_numbers numbers_one(const fabric_side *s, fabric_lobe which, real gloss) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(bsdf_of(&s->lobe[which]));
  if (!(gloss < 1))
    return (lobe_numbers){own->kx, own->ky, own->peak, own->gx, own->gy};
  const dulling by = dulling_of(s, which);
  const pair e = dulled(by, gloss);
  return by.exponents ? numbers_of_exponents(e.x, e.y) : numbers_of_alphas(e.x, e.y);
}

/* The same as a material, in *room if the gloss is less. */
static const bsdf *lobe_one(const fabric_side *s, fabric_lobe which, real gloss, bsdf *room) {
  const bsdf *b = bsdf_of(&s->lobe[which]);
  if (!(gloss < 1))
    return b;
  const lobe_numbers own = numbers_one(s, which, gloss);
  SUFFIX(bsdf_numbers) *to = &room->SUFFIX(numbers);
  *room = *b;
  room->carry = b->uneven;
  to->kx = own.kx;
  to->ky = own.ky;
  to->peak = own.peak;
  to->gx = own.gx;
  to->gy = own.gy;
  return room;
}

/* spec and matt of entry_yarn, the mean over the nodes of a side. */
static __attribute__((noinline)) void mixture_one(const fabric_side *s, real gloss,
                                                  const yarn_view *v, real *spec, real *matt) {
  const fabric_nodes *nodes = &s->nodes;
  bsdf room;
  const bsdf *b = lobe_one(s, FABRIC_FAR, gloss, &room);
  *spec = *matt = 0;
  for (int i = 0; i < nodes->count; i++) {
    real one, two;
    yarn_one(b, node_normal(nodes, i), v->wi, v->wo, &one, &two);
    *spec += nodes->SUFFIX(weight)[i] * one;
    *matt += nodes->SUFFIX(weight)[i] * two;
  }
}

/* spec of that, of Ashikhmin and Shirley's yarns carried by `rotate`. */
LEAF real shine_usual(const fabric_nodes *nodes, lobe_numbers by, triple wi, triple wo) {
  const real *restrict nx = nodes->SUFFIX(x), *restrict ny = nodes->SUFFIX(y),
                       *restrict nz = nodes->SUFFIX(z);
  const real *restrict weight = nodes->SUFFIX(weight);
  const triple h = {wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
  const real hwo = half_cosine(XYZ(h));
  const size_t m = FABRIC_WHOLE((size_t)nodes->count);
  enum { PARTS = 16 }; /* sums side by side, which vectors hold */
  ROOM sum[PARTS] = {0};
  for (size_t from = 0; from < m; from += PARTS)
#pragma omp simd
    for (size_t part = 0; part < PARTS; part++) {
      const size_t i = from + part;
      const triple n = {nx[i], ny[i], nz[i]};
      const real ci = dot_of(n, wi), co = lit_cosine(ci, dot_of(n, wo), wi.z, wo.z);
      const angles a = {hwo, ci, co, 1, 1};
      const real one = weight[i] * (usual_lobe(n, h, by.kx, by.ky, by.peak, a) * ci);
      sum[part] += co > 0 ? one : 0;
    }
  for (size_t n = PARTS / 2; n; n /= 2)
    for (size_t part = 0; part < n; part++)
      sum[part] += sum[part + n];
  return sum[0];
}

/*
 * The share of a side's tables in spec: the rest is of the mixture itself, lobe by lobe. Where
 * light and eye are far apart, across a fade, and of less gloss, which no table is made for.
 */
LEAF real tabled_share(real gloss, triple wi, triple wo) {
  const real apart = (real)FABRIC_APART, fade = 1 / ((real)FABRIC_NEARBY - (real)FABRIC_APART);
  const real share = (wi.x * wo.x + wi.y * wo.y + wi.z * wo.z - apart) * fade;
  return gloss < 1 ? 0 : minimum(maximum(share, 0), 1);
}

/* spec of the mixture of a side with tables, from that of the tables and their share. */
LEAF real shine_mended(const fabric_side *s, real gloss, real share, triple wi, triple wo,
                       real spec) {
  real one, unused;
  if (is_usual(bsdf_of(&s->lobe[FABRIC_FAR]))) {
    one = shine_usual(&s->nodes, numbers_one(s, FABRIC_FAR, gloss), wi, wo);
  } else {
    const yarn_view v = {{0, 0, 1}, wi, wo};
    mixture_one(s, gloss, &v, &one, &unused);
  }
  return one + share * (share > 0 ? spec - one : 0);
}

/* spec and matt of entry_yarn that lane i has of side k. */
static void yarns_one(const cloth *c, const fabric_side *s, size_t i, int k, const yarn_view *v,
                      real *spec, real *matt) {
  const int kind = c->kind[i];
  const real gloss = cloth_row(c, CLOTH_GLOSS + k)[i];
  bsdf room;
  if (kind == CLOTH_FAR && s->table) {
    table_one(s->table, v->wi, v->wo, spec, matt);
    const real share = tabled_share(gloss, v->wi, v->wo);
    if (share < 1)
      *spec = shine_mended(s, gloss, share, v->wi, v->wo, *spec);
  } else if (kind == CLOTH_FAR) {
    mixture_one(s, gloss, v, spec, matt);
  } else {
    yarn_one(lobe_one(s, kind == CLOTH_SINGLE ? FABRIC_SINGLE : FABRIC_NEAR, gloss, &room), v->n,
             v->wi, v->wo, spec, matt);
    if (kind == CLOTH_SINGLE) {
      const faced face = faced_of(s);
      const real seen = facing(face, XYZ(v->wi)) * facing(face, XYZ(v->wo));
      *spec *= seen;
      *matt *= seen;
    }
  }
}

/* What a lane lets through of side k: the mean over its tilts. */
static real through_one(const cloth *c, const fabric_nodes *nodes, size_t i, const yarn_view *v) {
  const real *x = nodes->SUFFIX(x), *y = nodes->SUFFIX(y), *z = nodes->SUFFIX(z);
  const real *weight = nodes->SUFFIX(weight);
  real sum = 0;
  if (cloth_is_near(c->kind[i]))
    return let_through(dot(XYZ(v->n), XYZ(v->wi)), dot(XYZ(v->n), XYZ(v->wo)));
#pragma omp simd reduction(+ : sum)
  for (int j = 0; j < nodes->count; j++)
    sum += weight[j] *
           let_through(dot(x[j], y[j], z[j], XYZ(v->wi)), dot(x[j], y[j], z[j], XYZ(v->wo)));
  return sum;
}

/* Add `part` of what the yarns of lane i send: lit from in front, or else from behind. */
static void cloth_add_one(const shade_fabric *f, const cloth *c, size_t i, int lit, real part,
                          real white, triple wi, triple wo, real sum[3]) {
  for (int k = 0; k < 2; k++) {
    if (!cloth_shows(c, i, k))
      continue;
    const fabric_side *s = &f->side[k];
    const yarn_view v = yarn_view_of(f, c, i, k, wi, wo);
    const real weight = cloth_row(c, CLOTH_WEIGHT + k)[i];
    real spec, matt;
    if (lit)
      yarns_one(c, s, i, k, &v, &spec, &matt);
    else
      spec = through_one(c, &s->nodes, i, &v);
    for (int a = 0; a < 3; a++)
      sum[a] += part * (lit ? weight * spec * whitened((real)s->f0[a], white) +
                                  cloth_row(c, CLOTH_KD + 3 * k + a)[i] * matt
                            : cloth_row(c, CLOTH_KT + 3 * k + a)[i] * spec);
  }
}

/* The lobe that directions are drawn from. */
static fabric_lobe drawn_lobe(const fabric_side *s, int kind) {
  return cloth_is_near(kind)                    ? FABRIC_NEAR
         : kind == CLOTH_SINGLE || s->draws_one ? FABRIC_SINGLE
                                                : FABRIC_DRAW;
}

/* Of draws of the lobe that lane i has of side k. */
static real yarns_density(const cloth *c, const fabric_side *s, size_t i, int k,
                          const yarn_view *v) {
  bsdf room;
  const fabric_lobe which = drawn_lobe(s, c->kind[i]);
  const bsdf *b = lobe_one(s, which, cloth_row(c, CLOTH_GLOSS + k)[i], &room);
  const fabric_nodes *nodes = &s->coarse;
  real sum = 0;
  if (which != FABRIC_DRAW)
    return density_about(b, v->n, v->wi, v->wo);
  for (int j = 0; j < nodes->count; j++)
    sum += nodes->SUFFIX(weight)[j] * density_about(b, node_normal(nodes, j), v->wi, v->wo);
  return sum;
}

/* Probability of each part: by what it reflects, a sixteenth more at least of each that is there.
 */
typedef struct cloth_share {
  real lobe[2], diffuse, behind;
} cloth_share;

/* What they depend on beside the lane. */
typedef struct cloth_sharing {
  real f0[2], haze;
} cloth_sharing;

LEAF cloth_sharing cloth_sharing_of(const shade_fabric *f) {
  cloth_sharing to;
  for (int k = 0; k < 2; k++)
    to.f0[k] = (real)((f->side[k].f0[0] + f->side[k].f0[1] + f->side[k].f0[2]) / 3);
  to.haze = (real)(0.25 / 3 * (f->nap_color[0] + f->nap_color[1] + f->nap_color[2]));
  return to;
}

LEAF real mean3(const real *restrict row, size_t step) {
  return (row[0] + row[step] + row[2 * step]) * R(0.33333333333333333333);
}

/* co: cosine of the eye about n. through: whether the cloth lets light through; else those rows are
 * not filled. */
LEAF cloth_share cloth_share_of(cloth_sharing by, const cloth *c, size_t i, real co, int through) {
  const real *row = c->rows + i;
  const size_t s = c->stride;
  const real cosine = maximum(co, R(1e-4)), white = schlick_weight(minimum(cosine, 1));
  const real gets = exp_negative(R(0.5) * minimum(row[CLOTH_NAP * s] / cosine, 60));
  const real *kt = row + CLOTH_KT * s, *kd = row + CLOTH_KD * s;
  real a = gets * row[CLOTH_WEIGHT * s] * whitened(by.f0[0], white);
  real b = gets * row[(CLOTH_WEIGHT + 1) * s] * whitened(by.f0[1], white);
  real d = mean3(kd, s) + mean3(kd + 3 * s, s) + mean3(row + CLOTH_FLAT * s, s);
  d = gets * d + by.haze * (1 - gets * gets);
  real e = through ? gets * (mean3(kt, s) + mean3(kt + 3 * s, s)) : 0;
  const real least = (a + b + d + e) * R(0.0625);
  a += a > 0 ? least : 0;
  b += b > 0 ? least : 0;
  d += d > 0 ? least : 0;
  e += e > 0 ? least : 0;
  const real scale = 1 / (a + b + d + e + TINY);
  return (cloth_share){{a * scale, b * scale}, d * scale, e * scale};
}

/* Density of what is drawn about n; ci: cosine of the light about n. */
LEAF real matt_density(real share, real ci) {
  return share * INVERSE_PI * (R(0.25) + R(0.5) * absolute(ci));
}

/* Of draws of both sides' lobes, by their shares. */
static real lobes_density(const shade_fabric *f, const cloth *c, size_t i, const real share[2],
                          triple wi, triple wo) {
  real pdf = 0;
  for (int k = 0; k < 2; k++)
    if (cloth_shows(c, i, k)) {
      const yarn_view v = yarn_view_of(f, c, i, k, wi, wo);
      pdf += share[k] * yarns_density(c, &f->side[k], i, k, &v);
    }
  return pdf;
}

/* The density that light from wi is drawn with for lane i, by the rule of `hard`. */
static real cloth_density_one(const shade_fabric *f, const cloth *c, size_t i, real side, real ci,
                              real co, triple wi, triple wo) {
  const cloth_share share = cloth_share_of(cloth_sharing_of(f), c, i, co, f->transmits);
  const real matt = matt_density(side > 0 ? share.diffuse : share.behind, ci);
  return side > 0 ? matt + lobes_density(f, c, i, share.lobe, wi, wo) : matt;
}

/* What shadows depend on, and the factor of lane i for light from w: from behind, the yarns' other
 * sides lean as much. */
typedef struct shadowing {
  leaning weft, warp;
  real level;
  const real *nx, *ny, *nz;
} shadowing;

LEAF shadowing shadowing_of(const shade_fabric *f, const cloth *c) {
  return (shadowing){.weft = leaning_of(&f->lean[0]),
                     .warp = leaning_of(&f->lean[1]),
                     .level = (real)f->level,
                     .nx = cloth_row(c, CLOTH_N),
                     .ny = cloth_row(c, CLOTH_N + 1),
                     .nz = cloth_row(c, CLOTH_N + 2)};
}

LEAF real shadowing_lane(shadowing s, size_t i, real x, real y, real z) {
  const triple w = carry(carrier_of(s.nx[i], s.ny[i], s.nz[i], 1, 0), x, y, z);
  const real side = w.z < 0 ? R(-1.0) : R(1.0);
  return shadowed(s.weft, s.warp, s.level, side * w.x, side * w.y, side * w.z);
}

/* The mean over the terms of a hit by the rule of `hard`: s, or its density; NULL for what is not
 * wanted. All terms have n and nap in common. */
static void cloth_hard_one(const shade_fabric *f, const cloth *c, triple wi, triple wo, real *sum,
                           real *pdf) {
  const triple n = cloth_triple(c, CLOTH_N, 0);
  const real whole = 1, *part = c->count == 1 ? &whole : cloth_row(c, CLOTH_PART);
  const real ci = dot_of(n, wi), co = dot_of(n, wo), nap = cloth_row(c, CLOTH_NAP)[0];
  const real side = c->kind[0] == CLOTH_VOID ? 0 : side_of(ci, co, wi.z, wo.z);
  const int lit = side > 0;
  for (int a = 0; sum && a < 3; a++)
    sum[a] = 0;
  if (pdf)
    *pdf = 0;
  if (side == 0)
    return;
  for (size_t i = 0; pdf && i < c->count; i++)
    *pdf += part[i] * cloth_density_one(f, c, i, side, ci, co, wi, wo);
  if (!sum)
    return;
  const real white = schlick_weight(half_cosine(wi.x + wo.x, wi.y + wo.y, wi.z + wo.z));
  for (size_t i = 0; i < c->count; i++) {
    for (int a = 0; lit && a < 3; a++)
      sum[a] += part[i] * (cloth_row(c, CLOTH_FLAT + a)[i] * ci * INVERSE_PI);
    if (lit || f->transmits)
      cloth_add_one(f, c, i, lit, part[i], white, wi, wo, sum);
  }
  const int shadows = f->shadows && absolute(ci) < (real)f->shadows_below;
  const real shadow = shadows ? shadowing_lane(shadowing_of(f, c), 0, XYZ(wi)) : 1;
  const napped fibres = nap > 0 ? napped_of(nap, ci, co, side) : (napped){1, 0};
  for (int a = 0; a < 3; a++)
    sum[a] = sum[a] * shadow * fibres.through + (real)f->nap_color[a] * fibres.back;
}

/* Facets with normal n and upright mirrors: the paths of light and eye, as horizon_block.h. */
static void cloth_facets_one(const shade_fabric *f, const cloth *c, triple wi, triple wo, real *sum,
                             real *pdf) {
  const triple n = cloth_triple(c, CLOTH_N, 0);
  const triple light = mirrored(n, wi), eye = mirrored(n, wo);
  const real seen = share_bumped(XYZ(n), XYZ(wo)), upright = share_upright(XYZ(n), XYZ(wo));
  const real along = n.x * wi.x + n.y * wi.y;
  real more[3], other[3], density[3];
  cloth_hard_one(f, c, wi, wo, sum, pdf ? density : NULL);
  cloth_hard_one(f, c, wi, eye, sum ? more : NULL, pdf ? density + 1 : NULL);
  cloth_hard_one(f, c, light, wo, sum ? other : NULL, pdf ? density + 2 : NULL);
  if (sum) {
    /* s has n.wi in it, where the facets have wi.z n.z / (p + q): their quotient */
    const int above = wi.z > 0;
    const real p = maximum(along + n.z * wi.z, 0), q = maximum(-along, 0);
    const real scale = above ? n.z * wi.z / maximum(p + q, TINY) : 1;
    const real behind = above ? scale * seen * q / maximum(q + n.z * wi.z, TINY) : 0;
    for (int a = 0; a < 3; a++)
      sum[a] = scale * (seen * sum[a] + upright * more[a]) + behind * other[a];
  }
  if (pdf) { /* what comes from behind meets no mirror */
    const path_shares by = paths(n, wi, wo);
    const int above = wi.z > 0;
    *pdf = (above ? by.plain : 1 - by.eye) * density[0] + by.eye * density[1] +
           (above ? by.light : 0) * density[2];
  }
}

/* Whether wi is opposite to wo, where there is no half vector; only light from behind is. */
LEAF int is_opposite(real ix, real iy, real iz, real ox, real oy, real oz) {
  return !(2 + 2 * (ix * ox + iy * oy + iz * oz) > R(1e-30));
}

/*
 * The mean over the terms of one hit of s and of the density; NULL for what is not wanted. Returns
 * status bits.
 */
static unsigned entry_cloth_hit(const shade_fabric *f, const cloth *c, const real given[3], real *s,
                                real *pdf) {
  const direction light = direction_of(given, 0);
  const triple wi = light.v, wo = cloth_triple(c, CLOTH_WO, 0), n = cloth_triple(c, CLOTH_GIVEN, 0);
  unsigned status = light.status;
  if (status & SHADE_BAD_INPUT) {
    for (int a = 0; s && a < 3; a++)
      s[a] = 0;
    if (pdf)
      *pdf = 0;
    return status;
  }
  if (!f->transmits && is_opposite(XYZ(wi), XYZ(wo)))
    status |= SHADE_BAD_INPUT;
  if (shade_horizon_is(f->horizon).facets) {
    cloth_facets_one(f, c, wi, wo, s, pdf);
    return status;
  }
  cloth_hard_one(f, c, wi, wo, s, pdf);
  if (s && wi.z > 0) { /* light from behind meets no bumps */
    const shade_fade fade = shade_horizon_is(f->horizon).fade;
    const real factor = fade == SHADE_FADE_CHIANG    ? shadow_chiang(XYZ(n), XYZ(wi))
                        : fade == SHADE_FADE_ESTEVEZ ? shadow_estevez(XYZ(n), XYZ(wi))
                                                     : 1;
    for (int a = 0; a < 3; a++)
      s[a] *= factor;
  }
  return status;
}

#endif
