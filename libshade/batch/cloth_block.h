/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A block of prepared lanes of cloth under light: s, the density that the light is drawn with, or
 * both, which have most in common. Usual near lanes stay where they are; lanes of other kinds are
 * gathered.
 */
#ifndef SHADE_BATCH_CLOTH_BLOCK_H
#define SHADE_BATCH_CLOTH_BLOCK_H

#include "cloth_lobes.h"

/* What of a block is lit. */
typedef struct sorted_lanes {
  unsigned char key[BLOCK]; /* the kind of a lane, CLOTH_KINDS more if lit from behind, or VOID */
  ROOM near[BLOCK];         /* lit from in front: 1 weft, -1 warp, 0 anything else */
  int any_near;
} sorted_lanes;

LEAF unsigned char key_of(unsigned char kind, real side) {
  const unsigned char behind = (unsigned char)(kind + CLOTH_KINDS);
  return side > 0 ? kind : side < 0 ? behind : (unsigned char)CLOTH_VOID;
}
LEAF real near_of(unsigned char key) {
  return key == CLOTH_WEFT ? R(1.0) : key == CLOTH_WARP ? R(-1.0) : R(0.0);
}

static void cloth_sort(const cloth *c, const real *restrict side, sorted_lanes *s) {
  const unsigned char *restrict kinds = c->kind;
  unsigned char *restrict key = s->key;
  real *restrict near = s->near;
  int any = 0;
  if (c->count < CLOTH_FEW) {
    for (size_t i = 0; i < c->count; i++) {
      key[i] = key_of(kinds[i], side[i]);
      near[i] = near_of(key[i]);
      any |= key[i] <= CLOTH_WARP;
    }
    s->any_near = any;
    return;
  }
#pragma omp simd
  for (size_t i = 0; i < c->count; i++)
    key[i] = key_of(kinds[i], side[i]);
#pragma omp simd reduction(| : any)
  for (size_t i = 0; i < c->count; i++) {
    near[i] = near_of(key[i]);
    any |= key[i] <= CLOTH_WARP;
  }
  s->any_near = any;
}

/* The lanes of one key. Returns how many. */
static size_t cloth_pick(size_t count, const unsigned char *restrict key, int want,
                         int *restrict lane) {
  const unsigned char wanted = (unsigned char)want;
  unsigned char any = 0, others = 0;
  size_t found = 0;
  if (count < CLOTH_FEW) {
    for (size_t i = 0; i < count; i++)
      if (key[i] == wanted)
        lane[found++] = (int)i;
    return found;
  }
#pragma omp simd reduction(| : any, others)
  for (size_t i = 0; i < count; i++) {
    any |= key[i] == wanted;
    others |= key[i] != wanted;
  }
  if (!any)
    return 0;
  if (!others) { /* as where a block is far away */
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      lane[i] = (int)i;
    return count;
  }
  for (size_t i = 0; i < count; i++) {
    lane[found] = (int)i;
    found += key[i] == wanted;
  }
  return found;
}

LEAF real mean3(real r, real g, real b) {
  return (r + g + b) * R(0.33333333333333333333);
}

/* Probability of each part: by what it reflects, a twentieth at least of each that is there. */
static void cloth_shares(const shade_fabric *f, const cloth *c, const real *const wo[3],
                         real share[CLOTH_PARTS][BLOCK]) {
  const real *row = c->rows;
  const size_t s = c->stride;
  const real *nx = row + CLOTH_N * s, *ny = nx + s, *nz = ny + s;
  const real *ox = wo[0], *oy = wo[1], *oz = wo[2];
  const real *weight = row + CLOTH_WEIGHT * s, *kd = row + CLOTH_KD * s, *kt = row + CLOTH_KT * s;
  const real *flat = row + CLOTH_FLAT * s, *nap = row + CLOTH_NAP * s;
  real f0[2];
  for (int k = 0; k < 2; k++)
    f0[k] = (real)((f->side[k].f0[0] + f->side[k].f0[1] + f->side[k].f0[2]) / 3);
  const real haze = (real)(0.25 / 3 * (f->nap_color[0] + f->nap_color[1] + f->nap_color[2]));
  real *lobe0 = share[0], *lobe1 = share[1], *diffuse = share[2], *behind = share[3];
  for (size_t i = 0; i < c->count; i++) /* else those rows are not filled */
    behind[i] = f->transmits ? mean3(kt[i], kt[i + s], kt[i + 2 * s]) +
                                   mean3(kt[i + 3 * s], kt[i + 4 * s], kt[i + 5 * s])
                             : 0;
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    real co = maximum(nx[i] * ox[i] + ny[i] * oy[i] + nz[i] * oz[i], R(1e-4));
    real white = schlick_weight(minimum(co, 1));
    real gone = minimum(nap[i] / co, 60);
    real through = exp_negative(R(0.5) * gone);
    real a = through * weight[i] * (f0[0] + (1 - f0[0]) * white);
    real b = through * weight[i + s] * (f0[1] + (1 - f0[1]) * white);
    real d = mean3(kd[i], kd[i + s], kd[i + 2 * s]) +
             mean3(kd[i + 3 * s], kd[i + 4 * s], kd[i + 5 * s]) +
             mean3(flat[i], flat[i + s], flat[i + 2 * s]);
    d = through * d + haze * (1 - through * through);
    real e = through * behind[i];
    real least = (a + b + d + e) * R(0.0625);
    a += a > 0 ? least : 0;
    b += b > 0 ? least : 0;
    d += d > 0 ? least : 0;
    e += e > 0 ? least : 0;
    real scale = 1 / (a + b + d + e + TINY);
    lobe0[i] = a * scale;
    lobe1[i] = b * scale;
    diffuse[i] = d * scale;
    behind[i] = e * scale;
  }
}

/*
 * Near lanes of usual yarns, weft and warp alike: light and eye in the frame of the lane's fibres,
 * and its lobe. Lanes that are none hold z.
 */
typedef struct near_room {
  ROOM n[3][BLOCK], wi[3][BLOCK], wo[3][BLOCK], kx[BLOCK], ky[BLOCK], peak[BLOCK];
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
    carrier a = {1, 0, 0, 1, 0, 0, 0, 1, tx, ty};
    if (!flat)
      a = carrier_of(XYZ(exchanged(own, warp)), tx, ty);
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
  const bsdf *weft = bsdf_of(&f->side[0].lobe[FABRIC_NEAR]);
  const bsdf *warp = bsdf_of(&f->side[1].lobe[FABRIC_NEAR]);
  int dull = 0;
#pragma omp simd reduction(| : dull)
  for (size_t i = 0; i < c->count; i++)
    dull |= minimum(gloss[i], other[i]) < 1;
  if (dull) {
    const dulling d = dulling_of(&f->side[0], FABRIC_NEAR);
    const dulling e = dulling_of(&f->side[1], FABRIC_NEAR);
#pragma omp simd
    for (size_t i = 0; i < c->count; i++) {
      const int is = near[i] < 0;
      const real one = gloss[i], two = other[i];
      const dulling own = {1, is ? e.x : d.x, is ? e.y : d.y, is ? e.per_x : d.per_x,
                           is ? e.per_y : d.per_y};
      const pair k = dulled(own, is ? two : one);
      m->kx[i] = k.x;
      m->ky[i] = k.y;
      m->peak[i] = peak_of_exponents(k.x, k.y);
    }
    return;
  }
  const real x0 = numbers_of(weft)->kx, y0 = numbers_of(weft)->ky, peak0 = numbers_of(weft)->peak;
  const real x1 = numbers_of(warp)->kx, y1 = numbers_of(warp)->ky, peak1 = numbers_of(warp)->peak;
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    m->kx[i] = near[i] < 0 ? x1 : x0;
    m->ky[i] = near[i] < 0 ? y1 : y0;
    m->peak[i] = near[i] < 0 ? peak1 : peak0;
  }
}

/* spec and matt of entry_yarn, and the density of the lobe: what of them is not 0. */
#define NEAR_PASS(NAME, word, value, label, help)                                                  \
  static void pass_near_##word(size_t count, const real *restrict near,                            \
                               const near_room *restrict m, real *restrict spec,                   \
                               real *restrict matt, real *restrict density) {                      \
    const real *nx = m->n[0], *ny = m->n[1], *nz = m->n[2];                                        \
    const real *ix = m->wi[0], *iy = m->wi[1], *iz = m->wi[2];                                     \
    const real *ox = m->wo[0], *oy = m->wo[1], *oz = m->wo[2];                                     \
    const real *kx = m->kx, *ky = m->ky, *peak = m->peak;                                          \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      const real x = nx[i], y = ny[i], z = nz[i];                                                  \
      const triple wi = {ix[i], iy[i], iz[i]}, wo = {ox[i], oy[i], oz[i]};                         \
      const real hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;                             \
      const real hwo = half_cosine(hx, hy, hz), lowest = minimum(wi.z, wo.z);                      \
      const real ci = dot(x, y, z, XYZ(wi)), co = dot(x, y, z, XYZ(wo));                           \
      const real cosi = maximum(ci, 0), coso = maximum(co, 0);                                     \
      const real d = ashikhmin_shirley_ratio(detail_rotate_ratio(x, y, z, hx, hy, hz), kx[i],      \
                                             ky[i], peak[i]);                                      \
      const angles a = {hwo, cosi, coso, 0, 0};                                                    \
      const real lobe = brdf_ashikhmin_shirley(d, a);                                              \
      const real length = fibre_length(x, z);                                                      \
      const real ly = over_fibre(x, y, z, XYZ(wi)) / length;                                       \
      const real vy = over_fibre(x, y, z, XYZ(wo)) / length;                                       \
      const real phi = diffuse_##word(ly, cosi, vy, coso) * INVERSE_PI;                            \
      const real enter = 1 - schlick_weight(minimum(cosi, 1));                                     \
      const real leave = 1 - schlick_weight(minimum(coso, 1));                                     \
      const real seen = minimum(minimum(ci, co), lowest);                                          \
      const real_bits shown = mask_of(minimum(seen, absolute(near[i])));                           \
      spec[i] = kept(shown, lobe * cosi, 0);                                                       \
      matt[i] = kept(shown, phi * enter * leave, 0);                                               \
      density[i] = kept(shown, lobe * maximum(cosi, coso), 0);                                     \
    }                                                                                              \
  }
SHADE_TABLE_DIFFUSE(NEAR_PASS)
#undef NEAR_PASS

static void pass_near(shade_diffuse model, size_t count, const real *near, const near_room *m,
                      real *spec, real *matt, real *density) {
  switch (model) {
#define NEAR_CASE(NAME, word, value, label, help)                                                  \
  case SHADE_DIFFUSE_##NAME:                                                                       \
    pass_near_##word(count, near, m, spec, matt, density);                                         \
    return;
    SHADE_TABLE_DIFFUSE(NEAR_CASE)
#undef NEAR_CASE
  case SHADE_DIFFUSE_COUNT:
    break;
  }
  pass_near_lambert(count, near, m, spec, matt, density);
}

/* Add what they are to s and to the density. */
static void cloth_near(const shade_fabric *f, const cloth *c, const real *restrict near,
                       const real *const wi[3], const real *const wo[3], const real *restrict white,
                       real (*share)[BLOCK], real *const *rgb, real *restrict pdf) {
  near_room m;
  ROOM spec[BLOCK], matt[BLOCK], density[BLOCK];
  if (c->flat)
    pass_near_carry(c, 1, near, wi, wo, &m);
  else
    pass_near_carry(c, 0, near, wi, wo, &m);
  pass_near_lobes(f, c, near, &m);
  pass_near(bsdf_of(&f->side[0].lobe[FABRIC_NEAR])->diffuse, c->count, near, &m, spec, matt,
            density);
  for (int channel = 0; rgb && channel < 3; channel++) {
    const real *restrict weft = cloth_row(c, CLOTH_WEIGHT), *restrict warp = weft + c->stride;
    const real *restrict kd0 = cloth_row(c, CLOTH_KD + channel);
    const real *restrict kd1 = cloth_row(c, CLOTH_KD + 3 + channel);
    const real f0 = (real)f->side[0].f0[channel], f1 = (real)f->side[1].f0[channel];
    real *restrict to = rgb[channel];
#pragma omp simd
    for (size_t i = 0; i < c->count; i++)
      to[i] +=
          (weft[i] * (f0 + (1 - f0) * white[i]) + warp[i] * (f1 + (1 - f1) * white[i])) * spec[i] +
          (kd0[i] + kd1[i]) * matt[i];
  }
  if (!pdf)
    return;
  const real *restrict weft = share[0], *restrict warp = share[1];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    const real one = weft[i], other = warp[i];
    pdf[i] += (near[i] < 0 ? other : one) * density[i];
  }
}

/* s by the rule of `hard` for eyes wo, and the density of draws; NULL for what is not wanted. */
static void cloth_hard(const shade_fabric *f, const cloth *c, const real *const wi[3],
                       const real *const wo[3], real *const *rgb, real *pdf) {
  static const int front[] = {CLOTH_WEFT, CLOTH_WARP, CLOTH_FAR, CLOTH_SINGLE};
  gathered g;
  sorted_lanes sorted;
  real ci[BLOCK], co[BLOCK], side[BLOCK], white[BLOCK], spec[BLOCK], matt[BLOCK];
  real share[CLOTH_PARTS][BLOCK];
  int lane[BLOCK];
  cloth_sides(c, wi, wo, ci, co, side);
  cloth_sort(c, side, &sorted);
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
    cloth_shares(f, c, wo, share);
    const real *diffuse = share[CLOTH_DIFFUSE], *behind = share[CLOTH_BEHIND];
#pragma omp simd
    for (size_t i = 0; i < c->count; i++) {
      real part = side[i] > 0 ? diffuse[i] : side[i] < 0 ? behind[i] : 0;
      pdf[i] = part * INVERSE_PI * (R(0.25) + R(0.5) * absolute(ci[i]));
    }
  }
  const int usual = sorted.any_near && near_is_usual(f);
  if (usual)
    cloth_near(f, c, sorted.near, wi, wo, white, share, rgb, pdf);
  for (size_t j = sorted.any_near && !usual ? 0 : 2; j < sizeof front / sizeof front[0]; j++) {
    const int kind = front[j];
    const size_t count = cloth_pick(c->count, sorted.key, kind, lane);
    for (int k = 0; count && k < 2; k++) {
      const fabric_side *s = &f->side[k];
      if (!cloth_gather(f, c, count, lane, kind, k, wi, wo, &g))
        continue;
      if (rgb) {
        cloth_lobes(ASK_YARN, c, s, k, kind, &g, spec, matt);
        if (kind == CLOTH_SINGLE)
          cloth_facing(s, &g, spec, matt);
        cloth_add(f, c, k, &g, spec, matt, white, rgb);
      }
      if (pdf) {
        cloth_lobes(ASK_DENSITY, c, s, k, kind, &g, spec, NULL);
        for (size_t i = 0; i < g.count; i++)
          pdf[g.lane[i]] += share[k][g.lane[i]] * spec[i];
      }
    }
  }
  for (size_t j = 0; f->transmits && rgb && j < sizeof front / sizeof front[0]; j++) {
    const int kind = front[j];
    const size_t count = cloth_pick(c->count, sorted.key, kind + CLOTH_KINDS, lane);
    for (int k = 0; count && k < 2; k++) {
      const fabric_side *s = &f->side[k];
      if (!cloth_gather(f, c, count, lane, kind, k, wi, wo, &g))
        continue;
      if (kind > CLOTH_WARP) {
        cloth_mixture(ASK_THROUGH, NULL, &s->nodes, &g, spec, NULL);
      } else {
        cloth_tilts(c, kind, &s->one, &g);
        cloth_through(&g, spec);
      }
      for (int channel = 0; channel < 3; channel++) {
        const real *kt = cloth_row(c, CLOTH_KT + 3 * k + channel);
        for (size_t i = 0; i < g.count; i++)
          rgb[channel][g.lane[i]] += kt[g.lane[i]] * spec[i];
      }
    }
  }
  if (rgb && f->shadows)
    cloth_shadow(f, c, ci, wi, rgb);
  if (rgb && any_nap(c))
    cloth_nap(f, c, ci, co, side, rgb);
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

/* Whether wi is opposite to wo, where there is no half vector; only light from behind is. */
LEAF int is_opposite(real ix, real iy, real iz, real ox, real oy, real oz) {
  return !(2 + 2 * (ix * ox + iy * oy + iz * oz) > R(1e-30));
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

/* Facets with normal n and upright mirrors: the paths of light and eye, as horizon_block.h. */
static void cloth_facets(const shade_fabric *f, const cloth *c, const real *const wi[3],
                         real *const rgb[3]) {
  const real *n[3], *wo[3];
  real x[BLOCK], y[BLOCK], more[3][BLOCK], see[2][2][BLOCK], weight[BLOCK], scale[BLOCK];
  real *const to[3] = {more[0], more[1], more[2]};
  const size_t size = c->count;
  for (int a = 0; a < 3; a++) {
    n[a] = cloth_row(c, CLOTH_N + a);
    wo[a] = cloth_row(c, CLOTH_WO + a);
  }
  const real *const *w[2] = {wi, wo};
  for (int k = 0; k < 2; k++) {
    pass_share_bumped(size, vec_of(n), vec_of(w[k]), see[k][0]);
    pass_share_upright(size, vec_of(n), vec_of(w[k]), see[k][1]);
  }
  /* s has n.wi in it, where the facets have wi.z n.z / (p + q): their quotient */
  for (size_t i = 0; i < size; i++) {
    real side = n[0][i] * wi[0][i] + n[1][i] * wi[1][i];
    real p = maximum(side + n[2][i] * wi[2][i], 0), q = maximum(-side, 0);
    scale[i] = wi[2][i] > 0 ? n[2][i] * wi[2][i] / maximum(p + q, TINY) : 1;
  }
  cloth_hard(f, c, wi, wo, rgb, NULL);
  pass_mirror(size, vec_of(n), vec_of(wo), x, y);
  const real *const eye[3] = {x, y, wo[2]};
  cloth_hard(f, c, wi, eye, to, NULL);
  for (int channel = 0; channel < 3; channel++)
    for (size_t i = 0; i < size; i++)
      rgb[channel][i] =
          scale[i] * (see[1][0][i] * rgb[channel][i] + see[1][1][i] * more[channel][i]);
  pass_mirror(size, vec_of(n), vec_of(wi), x, y);
  const real *const light[3] = {x, y, wi[2]};
  cloth_hard(f, c, light, wo, to, NULL);
  for (size_t i = 0; i < size; i++) {
    real side = n[0][i] * wi[0][i] + n[1][i] * wi[1][i];
    real q = maximum(-side, 0), p = q + n[2][i] * wi[2][i]; /* p of the mirrored light */
    weight[i] = wi[2][i] > 0 ? scale[i] * see[1][0][i] * q / maximum(p, TINY) : 0;
  }
  for (int channel = 0; channel < 3; channel++)
    for (size_t i = 0; i < size; i++)
      rgb[channel][i] += weight[i] * more[channel][i];
}

/* Their density; draws go the paths of sample_batch.h. */
static void cloth_facets_density(const shade_fabric *f, const cloth *c, const real *const wi[3],
                                 real *pdf) {
  const real *n[3], *wo[3];
  real x[BLOCK], y[BLOCK], one[BLOCK], plain[BLOCK], light[BLOCK], eye[BLOCK];
  const size_t size = c->count;
  cloth_eye(c, wo);
  for (int a = 0; a < 3; a++)
    n[a] = cloth_row(c, CLOTH_N + a);
  pass_paths(size, vec_of(n), vec_of(wi), vec_of(wo), plain, light, eye);
  for (size_t i = 0; i < size; i++)
    if (!(wi[2][i] > 0)) { /* what comes from behind meets no mirror */
      plain[i] = 1 - eye[i];
      light[i] = 0;
    }
  cloth_hard(f, c, wi, wo, NULL, pdf);
  pass_multiply(size, plain, pdf);
  pass_mirror(size, vec_of(n), vec_of(wi), x, y);
  const real *const from[3] = {x, y, wi[2]};
  cloth_hard(f, c, from, wo, NULL, one);
  pass_add_product(size, light, one, pdf);
  pass_mirror(size, vec_of(n), vec_of(wo), x, y);
  const real *const seen[3] = {x, y, wo[2]};
  cloth_hard(f, c, wi, seen, NULL, one);
  pass_add_product(size, eye, one, pdf);
}

/*
 * s of every lane, which does not overlap wi, and the density; NULL for what is not wanted. Returns
 * status bits.
 */
static unsigned cloth_block(const shade_fabric *f, const cloth *c, const real *const wi_in[3],
                            real *const *rgb, real *pdf) {
  mended_light m;
  const real *wo[3];
  real factor[BLOCK];
  unsigned status = mend_light(c->count, wi_in, &m);
  const real *const wi[3] = {m.wi[0], m.wi[1], m.wi[2]};
  cloth_eye(c, wo);
  if (!f->transmits)
    status |= cloth_opposite(c, wi);
  if (f->horizon == SHADE_HORIZON_SCHUESSLER) {
    if (rgb)
      cloth_facets(f, c, wi, rgb);
    if (pdf)
      cloth_facets_density(f, c, wi, pdf);
  } else {
    cloth_hard(f, c, wi, wo, rgb, pdf);
    if (rgb && !c->flat && f->horizon != SHADE_HORIZON_HARD &&
        f->horizon != SHADE_HORIZON_VALID_REFLECTION) {
      const real *nx = cloth_row(c, CLOTH_GIVEN), *ny = nx + c->stride, *nz = ny + c->stride;
      (f->horizon == SHADE_HORIZON_CHIANG ? pass_shadow_chiang : pass_shadow_estevez)(
          c->count, (vec){nx, ny, nz}, vec_of(wi), factor);
      for (size_t i = 0; i < c->count; i++) /* light from behind meets no bumps */
        factor[i] = wi[2][i] > 0 ? factor[i] : 1;
      for (int channel = 0; channel < 3; channel++)
        pass_multiply(c->count, factor, rgb[channel]);
    }
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
