/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A block of prepared lanes of cloth under light: s, the density that the light is drawn with, or
 * both, which have most in common. Usual near lanes stay where they are, which is quickest. Others
 * are gathered, and those of rare kinds go one by one.
 */
#ifndef SHADE_BATCH_CLOTH_BLOCK_H
#define SHADE_BATCH_CLOTH_BLOCK_H

#include "cloth_lobes.h"

/* What of a block is lit. */
typedef struct lit_lanes {
  real ci[BLOCK], co[BLOCK], side[BLOCK]; /* cosines about n; side_of, 0 of lanes that are void */
  unsigned char key[BLOCK];               /* the kind of lanes lit from in front, else CLOTH_VOID */
  ROOM near[BLOCK];                       /* of those, 1 weft, -1 warp, 0 anything else */
  unsigned present;                       /* a bit for each key */
} lit_lanes;

static unsigned keys_present(size_t count, const unsigned char *key) {
  unsigned present = 0;
#pragma omp simd reduction(| : present)
  for (size_t i = 0; i < count; i++)
    present |= 1u << key[i];
  return present;
}

static void cloth_light(const cloth *c, const real *const wi[3], const real *const wo[3],
                        lit_lanes *restrict to) {
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  const real *ix = wi[0], *iy = wi[1], *iz = wi[2], *ox = wo[0], *oy = wo[1], *oz = wo[2];
  real *restrict ci = to->ci, *restrict co = to->co, *restrict side = to->side;
  real *restrict near = to->near;
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    ci[i] = dot(nx[i], ny[i], nz[i], ix[i], iy[i], iz[i]);
    co[i] = dot(nx[i], ny[i], nz[i], ox[i], oy[i], oz[i]);
    side[i] = side_of(ci[i], co[i], iz[i], oz[i]);
  }
  SCATTERED
  for (size_t i = 0; i < c->count; i++) {
    const unsigned char kind = c->kind[i];
    side[i] = kind == CLOTH_VOID ? 0 : side[i];
    to->key[i] = side[i] > 0 ? kind : (unsigned char)CLOTH_VOID;
    near[i] = to->key[i] == CLOTH_WEFT ? R(1.0) : to->key[i] == CLOTH_WARP ? R(-1.0) : R(0.0);
  }
  to->present = keys_present(c->count, to->key);
}

/* The share of each part of a block, and what it depends on: the eye's cosine about n. */
typedef struct block_shares {
  real co[BLOCK], lobe[2][BLOCK], diffuse[BLOCK], behind[BLOCK];
} block_shares;

static void cloth_shares(const shade_fabric *f, const cloth *c, const real *const wo[3],
                         block_shares *restrict to) {
  const cloth_sharing by = cloth_sharing_of(f);
  const int through = f->transmits;
  real *restrict weft = to->lobe[0], *restrict warp = to->lobe[1];
  real *restrict diffuse = to->diffuse, *restrict behind = to->behind, *restrict co = to->co;
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  const real *ox = wo[0], *oy = wo[1], *oz = wo[2];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    co[i] = dot(nx[i], ny[i], nz[i], ox[i], oy[i], oz[i]);
    const cloth_share of = cloth_share_of(by, c, i, co[i], through);
    weft[i] = of.lobe[0];
    warp[i] = of.lobe[1];
    diffuse[i] = of.diffuse;
    behind[i] = of.behind;
  }
}

/*
 * Near lanes of usual yarns, weft and warp alike: light and eye in the frame of the lane's fibres,
 * and its lobe. Lanes that are none hold z.
 */
typedef struct near_room {
  ROOM n[3][BLOCK], wi[3][BLOCK], wo[3][BLOCK], kx[BLOCK], ky[BLOCK], peak[BLOCK];
  ROOM cosi[BLOCK], coso[BLOCK], ly[BLOCK], vy[BLOCK];
} near_room;

static int near_is_usual(const shade_fabric *f) {
  const bsdf *weft = bsdf_of(&f->side[0].lobe[FABRIC_NEAR]);
  const bsdf *warp = bsdf_of(&f->side[1].lobe[FABRIC_NEAR]);
  return is_usual(weft) && is_usual(warp) && weft->diffuse == warp->diffuse;
}

LEAF void pass_near_carry(const cloth *c, int flat, const real *restrict near,
                          const real *const wi[3], const real *const wo[3], near_room *restrict m) {
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  const real *fx = cloth_row(c, CLOTH_FIBRE), *fy = fx + c->stride;
  const real *mx = cloth_row(c, CLOTH_TILT), *my = mx + c->stride, *mz = my + c->stride;
  const real *ix = wi[0], *iy = wi[1], *iz = wi[2], *ox = wo[0], *oy = wo[1], *oz = wo[2];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    const int warp = near[i] < 0;
    const real_bits some = mask_of(absolute(near[i]));
    const triple own = {nx[i], ny[i], nz[i]};
    const triple light = {ix[i], iy[i], iz[i]}, eye = {ox[i], oy[i], oz[i]};
    const real along = kept(some, fx[i], 1), across = kept(some, fy[i], 0);
    const real tx = warp ? across : along, ty = warp ? along : across;
    const carrier a = flat ? carrier_flat(tx, ty) : carrier_of(XYZ(exchanged(own, warp)), tx, ty);
    const triple l = carry(a, XYZ(exchanged(light, warp)));
    const triple e = carry(a, XYZ(exchanged(eye, warp)));
    m->n[0][i] = kept(some, mx[i], 0);
    m->n[1][i] = kept(some, my[i], 0);
    m->n[2][i] = kept(some, mz[i], 1);
    m->wi[0][i] = kept(some, l.x, 0);
    m->wi[1][i] = kept(some, warp ? -l.y : l.y, 0);
    m->wi[2][i] = kept(some, l.z, 1);
    m->wo[0][i] = kept(some, e.x, 0);
    m->wo[1][i] = kept(some, warp ? -e.y : e.y, 0);
    m->wo[2][i] = kept(some, e.z, 1);
  }
}

static void pass_near_lobes(const shade_fabric *f, const cloth *c, const real *restrict near,
                            near_room *restrict m) {
  const real *restrict gloss = cloth_row(c, CLOTH_GLOSS), *restrict other = gloss + c->stride;
  const dulling d = dulling_of(&f->side[0], FABRIC_NEAR), e = dulling_of(&f->side[1], FABRIC_NEAR);
  real *restrict kx = m->kx, *restrict ky = m->ky, *restrict peak = m->peak;
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    const int is = near[i] < 0;
    const real one = gloss[i], two = other[i];
    const dulling own = {1, is ? e.x : d.x, is ? e.y : d.y, is ? e.per_x : d.per_x,
                         is ? e.per_y : d.per_y};
    const pair k = dulled(own, is ? two : one);
    kx[i] = k.x;
    ky[i] = k.y;
    peak[i] = peak_of_exponents(k.x, k.y);
  }
}

/* The lobe and its density; cosines, 0 where nothing is seen, and what lies across the fibres. */
static void pass_near(size_t count, const real *restrict near, near_room *restrict m,
                      real *restrict spec, real *restrict density) {
  const real *nx = m->n[0], *ny = m->n[1], *nz = m->n[2];
  const real *ix = m->wi[0], *iy = m->wi[1], *iz = m->wi[2];
  const real *ox = m->wo[0], *oy = m->wo[1], *oz = m->wo[2];
  const real *kx = m->kx, *ky = m->ky, *peak = m->peak;
  real *restrict cosi = m->cosi, *restrict coso = m->coso, *restrict ly = m->ly,
                 *restrict vy = m->vy;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const triple n = {nx[i], ny[i], nz[i]};
    const triple wi = {ix[i], iy[i], iz[i]}, wo = {ox[i], oy[i], oz[i]};
    const triple h = {wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    const real ci = dot_of(n, wi), co = dot_of(n, wo), lowest = minimum(wi.z, wo.z);
    const angles a = {half_cosine(XYZ(h)), maximum(ci, 0), maximum(co, 0), 0, 0};
    const real lobe = usual_lobe(n, h, kx[i], ky[i], peak[i], a);
    const real length = fibre_length(n.x, n.z), seen = minimum(minimum(ci, co), lowest);
    const real_bits shown = mask_of(minimum(seen, absolute(near[i])));
    spec[i] = kept(shown, lobe, 0);
    density[i] = kept(shown, lobe * maximum(a.cosi, a.coso), 0);
    cosi[i] = a.cosi;
    coso[i] = kept(shown, a.coso, 0);
    ly[i] = over_fibre(XYZ(n), XYZ(wi)) / length;
    vy[i] = over_fibre(XYZ(n), XYZ(wo)) / length;
  }
}

/* Add what they are to s and to the density. */
static void cloth_near(const shade_fabric *f, const cloth *c, const real *restrict near,
                       const real *const wi[3], const real *const wo[3], const real *restrict white,
                       const block_shares *share, real *const *rgb, real *restrict pdf) {
  near_room m;
  ROOM spec[BLOCK], matt[BLOCK], density[BLOCK];
  if (lies_flat(c))
    pass_near_carry(c, 1, near, wi, wo, &m);
  else
    pass_near_carry(c, 0, near, wi, wo, &m);
  pass_near_lobes(f, c, near, &m);
  pass_near(c->count, near, &m, spec, density);
  if (rgb) {
    pass_diffuse(bsdf_of(&f->side[0].lobe[FABRIC_NEAR]), c->count, m.ly, m.cosi, m.vy, m.coso,
                 matt);
    pass_yarn(c->count, m.cosi, m.coso, spec, matt);
  }
  for (int channel = 0; rgb && channel < 3; channel++) {
    const real *restrict weft = cloth_row(c, CLOTH_WEIGHT), *restrict warp = weft + c->stride;
    const real *restrict kd0 = cloth_row(c, CLOTH_KD + channel);
    const real *restrict kd1 = cloth_row(c, CLOTH_KD + 3 + channel);
    const real f0 = (real)f->side[0].f0[channel], f1 = (real)f->side[1].f0[channel];
    real *restrict to = rgb[channel];
#pragma omp simd
    for (size_t i = 0; i < c->count; i++)
      to[i] += (weft[i] * whitened(f0, white[i]) + warp[i] * whitened(f1, white[i])) * spec[i] +
               (kd0[i] + kd1[i]) * matt[i];
  }
  if (!pdf)
    return;
  const real *restrict weft = share->lobe[0], *restrict warp = share->lobe[1];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    const real one = weft[i], other = warp[i];
    pdf[i] += (near[i] < 0 ? other : one) * density[i];
  }
}

LEAF void cloth_add_lanes(const gathered *g, int whole, real f0, const real *restrict weight,
                          const real *restrict kd, const real *restrict white,
                          const real *restrict spec, const real *restrict matt, real *restrict to) {
  const int *restrict lane = g->lane;
  SCATTERED
  for (size_t j = 0; j < g->count; j++) {
    const size_t i = whole ? j : (size_t)lane[j];
    to[i] += weight[i] * spec[j] * whitened(f0, white[i]) + kd[i] * matt[j];
  }
}

/* Add to s what lobes send of side k. */
static void cloth_add(const shade_fabric *f, const cloth *c, int k, const gathered *g,
                      const real *spec, const real *matt, const real *white, real *const rgb[3]) {
  const real *weight = cloth_row(c, CLOTH_WEIGHT + k);
  for (int channel = 0; channel < 3; channel++) {
    const real *kd = cloth_row(c, CLOTH_KD + 3 * k + channel);
    const real f0 = (real)f->side[k].f0[channel];
    if (g->whole)
      cloth_add_lanes(g, 1, f0, weight, kd, white, spec, matt, rgb[channel]);
    else
      cloth_add_lanes(g, 0, f0, weight, kd, white, spec, matt, rgb[channel]);
  }
}

/* Lanes of one kind, gathered, of side k. */
static void cloth_gathered(const shade_fabric *f, const cloth *c, int kind, int k,
                           const unsigned char *key, const real *const wi[3],
                           const real *const wo[3], const real *white, const block_shares *share,
                           real *const *rgb, real *pdf) {
  gathered g;
  real spec[BLOCK], matt[BLOCK];
  if (!cloth_gather(f, c, key, kind, kind, k, wi, wo, &g))
    return;
  if (rgb) {
    cloth_yarns(&f->side[k], kind, &g, spec, matt);
    cloth_add(f, c, k, &g, spec, matt, white, rgb);
  }
  if (pdf) {
    cloth_density(&f->side[k], kind, &g, spec);
    for (size_t j = 0; j < g.count; j++)
      pdf[g.lane[j]] += share->lobe[k][g.lane[j]] * spec[j];
  }
}

/* Light from behind, which has no loops. */
static void cloth_behind(const shade_fabric *f, const cloth *c, const lit_lanes *lit,
                         const real *const w[3], const real *const o[3], const real *white,
                         real *const rgb[3]) {
  for (size_t i = 0; i < c->count; i++) {
    if (!(lit->side[i] < 0))
      continue;
    const triple wi = {w[0][i], w[1][i], w[2][i]}, wo = {o[0][i], o[1][i], o[2][i]};
    real sum[3] = {0, 0, 0};
    cloth_add_one(f, c, i, 0, 1, white[i], wi, wo, sum);
    for (int channel = 0; channel < 3; channel++)
      rgb[channel][i] += sum[channel];
  }
}

/* Schlick's white share at the cosine between wi and h. */
static void cloth_white(size_t count, const real *const wi[3], const real *const wo[3],
                        real *restrict white) {
  const real *ix = wi[0], *iy = wi[1], *iz = wi[2], *ox = wo[0], *oy = wo[1], *oz = wo[2];
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    white[i] = schlick_weight(half_cosine(ix[i] + ox[i], iy[i] + oy[i], iz[i] + oz[i]));
}

static void cloth_nap(const shade_fabric *f, const cloth *c, const lit_lanes *lit,
                      real *const rgb[3]) {
  const real *nap = cloth_row(c, CLOTH_NAP), *ci = lit->ci, *co = lit->co, *side = lit->side;
  const real r = (real)f->nap_color[0], g = (real)f->nap_color[1], b = (real)f->nap_color[2];
  real *red = rgb[0], *green = rgb[1], *blue = rgb[2];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    const napped lane = napped_of(nap[i], ci[i], co[i], side[i]);
    red[i] = red[i] * lane.through + r * lane.back;
    green[i] = green[i] * lane.through + g * lane.back;
    blue[i] = blue[i] * lane.through + b * lane.back;
  }
}

static void cloth_shadow(const shade_fabric *f, const cloth *c, const real *const wi[3],
                         real *const rgb[3]) {
  const shadowing s = shadowing_of(f, c);
  const real *ix = wi[0], *iy = wi[1], *iz = wi[2];
  real factor[BLOCK];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++)
    factor[i] = shadowing_lane(s, i, ix[i], iy[i], iz[i]);
  for (int channel = 0; channel < 3; channel++)
    pass_multiply(c->count, factor, rgb[channel]);
}

/* s by the rule of `hard` for eyes wo, and the density of draws; NULL for what is not wanted. */
static void cloth_hard(const shade_fabric *f, const cloth *c, const real *const wi[3],
                       const real *const wo[3], real *const *rgb, real *pdf) {
  lit_lanes lit;
  block_shares share;
  real white[BLOCK];
  const real *ci = lit.ci, *side = lit.side, *nap = cloth_row(c, CLOTH_NAP);
  int any_nap = 0;
  cloth_light(c, wi, wo, &lit);
  if (rgb)
    cloth_white(c->count, wi, wo, white);
  for (int channel = 0; rgb && channel < 3; channel++) {
    const real *flat = cloth_row(c, CLOTH_FLAT + channel);
    real *to = rgb[channel];
#pragma omp simd
    for (size_t i = 0; i < c->count; i++)
      to[i] = side[i] > 0 ? flat[i] * ci[i] * INVERSE_PI : 0;
  }
  if (pdf) {
    cloth_shares(f, c, wo, &share);
    const real *diffuse = share.diffuse, *behind = share.behind;
#pragma omp simd
    for (size_t i = 0; i < c->count; i++) {
      const real part = side[i] > 0 ? diffuse[i] : side[i] < 0 ? behind[i] : 0;
      pdf[i] = matt_density(part, ci[i]);
    }
  }
  const int usual = near_is_usual(f), near = lit.present & (1u << CLOTH_WEFT | 1u << CLOTH_WARP);
  if (near && usual)
    cloth_near(f, c, lit.near, wi, wo, white, &share, rgb, pdf);
  for (int k = 0; k < 2; k++) {
    if (near && !usual)
      cloth_gathered(f, c, k ? CLOTH_WARP : CLOTH_WEFT, k, lit.key, wi, wo, white, &share, rgb,
                     pdf);
    for (int kind = CLOTH_FAR; kind <= CLOTH_SINGLE; kind++)
      if (lit.present & 1u << kind)
        cloth_gathered(f, c, kind, k, lit.key, wi, wo, white, &share, rgb, pdf);
  }
  if (rgb && f->transmits)
    cloth_behind(f, c, &lit, wi, wo, white, rgb);
  if (rgb && f->shadows)
    cloth_shadow(f, c, wi, rgb);
  for (size_t i = 0; i < c->count; i++)
    any_nap |= nap[i] > 0;
  if (rgb && any_nap)
    cloth_nap(f, c, &lit, rgb);
}

static void cloth_eye(const cloth *c, const real *wo[3]) {
  for (int a = 0; a < 3; a++)
    wo[a] = cloth_row(c, CLOTH_WO + a);
}

/* Directions to evaluate, mended where they need it. */
typedef struct mended_light {
  const real *wi[3];
  real room[3][BLOCK];
  unsigned char void_lane[BLOCK];
} mended_light;

static unsigned mend_light(size_t count, const real *const wi[3], mended_light *m) {
  unsigned status = SHADE_OK;
  for (int a = 0; a < 3; a++)
    m->wi[a] = wi[a];
  if (are_unit(count, vec_of(wi)))
    return SHADE_OK;
  for (size_t i = 0; i < count; i++) {
    real w[3] = {wi[0][i], wi[1][i], wi[2][i]};
    const unsigned lane = mend_if_needed(w, 0);
    for (int a = 0; a < 3; a++)
      m->room[a][i] = w[a];
    m->void_lane[i] = (lane & SHADE_BAD_INPUT) != 0;
    status |= lane;
  }
  for (int a = 0; a < 3; a++)
    m->wi[a] = m->room[a];
  return status;
}

static unsigned cloth_opposite(const cloth *c, const real *const wi[3]) {
  const real *ox = cloth_row(c, CLOTH_WO), *oy = ox + c->stride, *oz = oy + c->stride;
  const real *ix = wi[0], *iy = wi[1], *iz = wi[2];
  int any = 0;
#pragma omp simd reduction(| : any)
  for (size_t i = 0; i < c->count; i++)
    any |= is_opposite(ix[i], iy[i], iz[i], ox[i], oy[i], oz[i]);
  return any ? SHADE_BAD_INPUT : SHADE_OK;
}

/* Facets and upright mirrors, lane by lane: no example has them. */
static unsigned cloth_facets(const shade_fabric *f, const cloth *c, const real *const wi[3],
                             real *const *rgb, real *pdf) {
  unsigned status = SHADE_OK;
  for (size_t i = 0; i < c->count; i++) {
    const cloth one = cloth_lane(c, i);
    const real w[3] = {wi[0][i], wi[1][i], wi[2][i]};
    real s[3];
    status |= entry_cloth_hit(f, &one, w, rgb ? s : NULL, pdf ? pdf + i : NULL);
    for (int channel = 0; rgb && channel < 3; channel++)
      rgb[channel][i] = s[channel];
  }
  return status;
}

/*
 * s of every lane, which does not overlap wi, and the density; NULL for what is not wanted. Returns
 * status bits.
 */
static unsigned entry_cloth(const shade_fabric *f, const cloth *c, const real *const wi_in[3],
                            real *const *rgb, real *pdf) {
  mended_light m;
  const real *wo[3], *nx = cloth_row(c, CLOTH_GIVEN), *ny = nx + c->stride, *nz = ny + c->stride;
  real factor[BLOCK];
  const shade_horizon_traits is = shade_horizon_is(f->horizon);
  if (is.facets)
    return cloth_facets(f, c, wi_in, rgb, pdf);
  unsigned status = mend_light(c->count, wi_in, &m);
  const real *const wi[3] = {m.wi[0], m.wi[1], m.wi[2]};
  cloth_eye(c, wo);
  if (!f->transmits)
    status |= cloth_opposite(c, wi);
  cloth_hard(f, c, wi, wo, rgb, pdf);
  if (rgb && is.fade != SHADE_FADE_NOT) {
    (is.fade == SHADE_FADE_CHIANG ? pass_shadow_chiang : pass_shadow_estevez)(
        c->count, (vec){nx, ny, nz}, vec_of(wi), factor);
    for (size_t i = 0; i < c->count; i++) /* light from behind meets no bumps */
      factor[i] = wi[2][i] > 0 ? factor[i] : 1;
    for (int channel = 0; channel < 3; channel++)
      pass_multiply(c->count, factor, rgb[channel]);
  }
  for (size_t i = 0; status & SHADE_BAD_INPUT && i < c->count; i++)
    if (m.wi[0] != wi_in[0] && m.void_lane[i]) {
      for (int channel = 0; rgb && channel < 3; channel++)
        rgb[channel][i] = 0;
      if (pdf)
        pdf[i] = 0;
    }
  return status;
}

#endif
