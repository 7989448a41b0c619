/* SPDX-License-Identifier: Apache-2.0 */
/*
 * mutual.h over a block: what follows from the map, the normal and the eye once, then f, density
 * and draws of that.
 */
#ifndef SHADE_BATCH_MUTUAL_BLOCK_H
#define SHADE_BATCH_MUTUAL_BLOCK_H

#include "../model/mutual.h"
#include "draw_block.h"

/* A side that the eye sees: its normal and its share; lit: whether any lane has one. */
typedef struct side_room {
  vec_room n;
  ROOM weight[BLOCK];
  int lit;
} side_room;

/* mutual and kept_back, an array of each number; slopes are the block's. */
typedef struct mutual_room {
  const real *slopes[5];
  ROOM above[BLOCK];
  side_room side[2];
  ROOM share[BLOCK], all[BLOCK], pick[BLOCK], again[3][BLOCK];
  vec_room mean, from;
  ROOM first[BLOCK], low[BLOCK], last[BLOCK], per_area[BLOCK];
} mutual_room;

/* Slopes, an array of each number, and relief i of them, in a loop. */
#define SLOPES(m)                                                                                  \
  const real *restrict mx = (m)->slopes[0], *restrict my = (m)->slopes[1];                         \
  const real *restrict mxx = (m)->slopes[2], *restrict mxy = (m)->slopes[3];                       \
  const real *restrict myy = (m)->slopes[4]
#define RELIEF relief_of(mx[i], my[i], mxx[i], mxy[i], myy[i])

LEAF next_lobe next_at(const mutual_room *m, size_t i) {
  return (next_lobe){{m->from.x[i], m->from.y[i], m->from.z[i]},
                     m->first[i],
                     m->low[i],
                     m->last[i],
                     m->per_area[i]};
}

static void pass_sides(const sample_block *s, mutual_room *restrict m) {
  const size_t size = s->count;
  const vec n = s->n, wo = s->wo;
  side_room *restrict own = &m->side[0], *restrict other = &m->side[1];
  int lit = 0, both = 0;
  ARRAYS(n);
  ARRAYS(wo);
  SLOPES(m);
#pragma omp simd reduction(| : lit, both)
  for (size_t i = 0; i < size; i++) {
    const sides seen = sides_of(RELIEF, AT(n), AT(wo));
    const real coso = dot_of(AT(n), AT(wo)), beyond = dot_of(seen.other, AT(wo));
    const real weight = coso > 0 ? seen.share : 0, rest = beyond > 0 ? 1 - seen.share : 0;
    own->n.x[i] = nx[i];
    own->n.y[i] = ny[i];
    own->n.z[i] = nz[i];
    own->weight[i] = weight;
    other->n.x[i] = seen.other.x;
    other->n.y[i] = seen.other.y;
    other->n.z[i] = seen.other.z;
    other->weight[i] = rest;
    m->above[i] = seen.above;
    lit |= weight > 0;
    both |= rest > 0;
  }
  own->lit = lit;
  other->lit = both;
}

/* ---- what is kept back ------------------------------------------------------------------------
 */

/* The axes of a side. */
LEAF void pass_axes_of(shade_map frame, size_t count, vec n, vec_room *restrict x,
                       vec_room *restrict y) {
  ARRAYS(n);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const axes f = axes_of(frame, AT(n));
    x->x[i] = f.x.x;
    x->y[i] = f.x.y;
    x->z[i] = f.x.z;
    y->x[i] = f.y.x;
    y->y[i] = f.y.y;
    y->z[i] = f.y.z;
  }
}

/* Adds what a side keeps back. */
LEAF void pass_kept(shade_mdf mdf, shade_brdf brdf, const bsdf *b, const sample_block *s,
                    const real *restrict weight, vec n, vec x, vec y, mutual_room *restrict m) {
  const size_t size = s->count;
  const int exponents = b->exponents, projected = b->projected;
  const real *restrict kx = s->shape.kx, *restrict ky = s->shape.ky;
  const vec wo = s->wo;
  ARRAYS(n);
  ARRAYS(x);
  ARRAYS(y);
  ARRAYS(wo);
  SLOPES(m);
#pragma omp simd
  for (size_t i = 0; i < size; i++) {
    const pair own = {facet_variance(exponents, kx[i]), facet_variance(exponents, ky[i])};
    const kept_back sum = {m->share[i], m->all[i], m->mean.x[i], m->mean.y[i], m->mean.z[i]};
    const kept_back kept = kept_of(sum, mdf, brdf, projected, RELIEF, m->above[i],
                                   (axes){AT(x), AT(y)}, AT(n), AT(wo), own, weight[i]);
    m->share[i] = kept.share;
    m->all[i] = kept.all;
    m->mean.x[i] = kept.x;
    m->mean.y[i] = kept.y;
    m->mean.z[i] = kept.z;
  }
}

static void pass_kept_back(const bsdf *b, const sample_block *s, const side_room *side,
                           mutual_room *m) {
  vec_room along_x, along_y;
  const vec n = vec_in(&side->n), x = vec_in(&along_x), y = vec_in(&along_y);
#define LOOP(frame) pass_axes_of(frame, s->count, n, &along_x, &along_y)
  SHADE_LOOP_OF_FRAME(frame_of_sides(b))
#undef LOOP
  if (b->brdf == SHADE_BRDF_MICROFACET) {
#define LOOP(mdf) pass_kept(mdf, SHADE_BRDF_MICROFACET, b, s, side->weight, n, x, y, m)
    SHADE_LOOP_OF(MDF, b->mdf)
#undef LOOP
    return;
  }
  /* of distributions the others ask for the tails only */
#define LOOP(brdf)                                                                                 \
  if (shade_mdf_is(b->mdf).tails)                                                                  \
    pass_kept(SHADE_MDF_GGX, brdf, b, s, side->weight, n, x, y, m);                                \
  else                                                                                             \
    pass_kept(SHADE_MDF_BECKMANN, brdf, b, s, side->weight, n, x, y, m)
  SHADE_LOOP_OF_BRDF(b->brdf)
#undef LOOP
}

/* ---- what is met next -------------------------------------------------------------------------
 */

static void pass_next(const bsdf *b, const sample_block *s, mutual_room *restrict m) {
  const size_t size = s->count;
  const int exponents = b->exponents;
  const real *restrict kx = s->shape.kx, *restrict ky = s->shape.ky;
  SLOPES(m);
#pragma omp simd
  for (size_t i = 0; i < size; i++) {
    const pair own = {facet_variance(exponents, kx[i]), facet_variance(exponents, ky[i])};
    const triple mean = {m->mean.x[i], m->mean.y[i], m->mean.z[i]};
    const next_lobe next = next_of(RELIEF, own, mean);
    m->pick[i] = next_pick(m->share[i]);
    m->from.x[i] = next.from.x;
    m->from.y[i] = next.from.y;
    m->from.z[i] = next.from.z;
    m->first[i] = next.first;
    m->low[i] = next.low;
    m->last[i] = next.last;
    m->per_area[i] = next.per_area;
  }
}

LEAF void pass_again(shade_fresnel fresnel, size_t count, const real *restrict f0,
                     const real *restrict tint, const real *restrict k, const mutual_room *m,
                     real *restrict again) {
  const shade_fresnel_traits reads = shade_fresnel_is(fresnel);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const kept_back kept = {m->share[i], m->all[i], 0, 0, 0};
    again[i] = next_colour(kept, fresnel_mean(fresnel, reads.f0 ? f0[i] : 0,
                                              reads.tint ? tint[i] : 0, reads.k ? k[i] : 0));
  }
}

/* All that follows without the light. */
static __attribute__((noinline)) void mutual_block(const bsdf *b, const sample_block *s,
                                                   mutual_room *m) {
  const size_t size = s->count;
  memcpy(m->slopes, s->slopes, sizeof m->slopes);
  pass_sides(s, m);
  for (size_t i = 0; i < size; i++)
    m->share[i] = m->all[i] = m->mean.x[i] = m->mean.y[i] = m->mean.z[i] = 0;
  for (int k = 0; k < 2; k++)
    if (m->side[k].lit)
      pass_kept_back(b, s, &m->side[k], m);
  pass_next(b, s, m);
  for (int c = 0; c < 3; c++) {
#define LOOP(fresnel) pass_again(fresnel, size, s->f0[c], s->tint[c], s->k[c], m, m->again[c])
    SHADE_LOOP_OF(FRESNEL, b->fresnel)
#undef LOOP
  }
}

/* That of the block, or made in `room`. */
static const mutual_room *mutual_of(const bsdf *b, const sample_block *s, mutual_room *room) {
  if (s->met)
    return s->met;
  mutual_block(b, s, room);
  return room;
}

/* ---- lanes without slopes, which are `hard` ---------------------------------------------------
 */

/* Copies `count` arrays there. */
static void copy_flat(const sample_block *s, int count, const real *const from[],
                      real *const to[]) {
  for (size_t i = 0; i < s->count; i++)
    for (int k = 0; k < count && !(s->slopes[2][i] + s->slopes[4][i] > 0); k++)
      to[k][i] = from[k][i];
}

/* ---- f ----------------------------------------------------------------------------------------
 */

/* Adds `add`, of one side, by its share. */
static void pass_add_side(size_t count, const real *restrict weight, const real *restrict add,
                          real *restrict sum) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    sum[i] += weight[i] > 0 ? weight[i] * add[i] : 0;
}

/* What is let through of f cos of both sides, and what is met next; over wi.z. */
static void pass_meet(size_t count, vec wi, vec wo, const mutual_room *m, real *restrict once,
                      real *restrict twice) {
  ARRAYS(wi);
  ARRAYS(wo);
  (void)wox, (void)woy;
  SLOPES(m);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const relief r = RELIEF;
    const real through = unblocked(r, m->above[i], AT(wi)),
               next = next_density(r, next_at(m, i), AT(wi));
    const int lit = (through > 0) & (wiz[i] > 0) & (woz[i] > 0);
    const real per = 1 / maximum(wiz[i], R(1e-20));
    once[i] = lit ? through * once[i] * per : 0;
    twice[i] = (lit & (m->pick[i] > 0)) ? next * per : 0;
  }
}

/* q = Phi/(pi cos) about the bent normal to what it gives over wi.z. */
static void pass_fade(size_t count, const real *restrict cosi, const real *restrict shadow,
                      const real *restrict wiz, real *restrict q) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    q[i] *= cosi[i] * shadow[i] / maximum(wiz[i], R(1e-20));
}

static __attribute__((noinline)) unsigned bumps_block(const bsdf *b, const sample_block *s,
                                                      const results *out) {
  specular_room room;
  mutual_room own;
  ROOM once[BLOCK], twice[BLOCK], d[BLOCK], cosi[BLOCK], coso[BLOCK], hwo[BLOCK];
  const size_t size = s->count;
  const mutual_room *m = mutual_of(b, s, &own);
  sample_block at = *s;
  int opposites = 0;
  for (size_t i = 0; i < size; i++)
    once[i] = 0;
  for (int k = 0; k < 2; k++) {
    if (k && !m->side[k].lit)
      continue;
    at.n = vec_in(&m->side[k].n);
    opposites |= specular_block(b, &at, &room, hwo, cosi, coso, d);
    pass_multiply(size, cosi, d);
    pass_add_side(size, m->side[k].weight, d, once);
  }
  pass_meet(size, s->wi, s->wo, m, once, twice);
  for (size_t i = 0; !b->has_specular && i < size; i++)
    once[i] = twice[i] = 0;
  for (int c = 0; c < 3; c++) {
    pass_channel(b, size, s->f0[c], s->tint[c], s->k[c], once, hwo, out->rgb[c]);
    pass_add_product(size, m->again[c], twice, out->rgb[c]);
  }
  if (b->has_diffuse) {
    const real less = shade_diffuse_is(b->diffuse).less_f0 ? R(1.0) : R(0.0);
    vec_room bent;
    pass_bend(size, s->n, s->wo, &bent);
    pass_cosines(b, size, vec_in(&bent), s->wi, s->wo, cosi, coso);
    diffuse_block(b, size, vec_in(&bent), s->wi, s->wo, cosi, coso, room.xx, room.yy, d);
    pass_shadow_estevez(size, s->n, s->wi, hwo);
    pass_fade(size, cosi, hwo, s->wi.z, d);
    for (int c = 0; c < 3; c++)
      add_diffuse(size, less, s->kd[c], s->f0[c], d, out->rgb[c]);
  }
  const real *wiz = s->wi.z;
  for (size_t i = 0; i < size; i++)
    out->cosine[i] = maximum(wiz[i], 0);
  for (size_t i = 0; opposites && i < size; i++)
    if (opposite(s->wi.x[i], s->wi.y[i], s->wi.z[i], s->wo.x[i], s->wo.y[i], s->wo.z[i]))
      out->rgb[0][i] = out->rgb[1][i] = out->rgb[2][i] = 0;
  if (s->bumps == BUMPS_OF_SOME) {
    const results flat = {{once, twice, d}, cosi};
    hard_block(b, s, &flat);
    copy_flat(s, 4, (const real *[]){once, twice, d, cosi},
              (real *[]){out->rgb[0], out->rgb[1], out->rgb[2], out->cosine});
  }
  return opposites ? SHADE_BAD_INPUT : SHADE_OK;
}

/* ---- density ----------------------------------------------------------------------------------
 */

/* q, of both sides, and what is met next. */
static void pass_mix_next(size_t count, vec wi, vec wo, const mutual_room *m, real *restrict q) {
  ARRAYS(wi);
  ARRAYS(wo);
  (void)wox, (void)woy;
  SLOPES(m);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const relief r = RELIEF;
    const real pick = m->pick[i],
               next = pick > 0 ? pick * next_density(r, next_at(m, i), AT(wi)) : 0;
    const int lit = (height_over(r, AT(wi)) > 0) & (wiz[i] > 0) & (woz[i] > 0);
    q[i] = lit ? (1 - pick) * q[i] + next : 0;
  }
}

/* q by its share, and the diffuse part's density. */
static void pass_add_matt(size_t count, const real *restrict share, const real *restrict matt,
                          real *restrict q) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    q[i] = share[i] * q[i] + (1 - share[i]) * matt[i];
}

/* *b's lobe alone. */
static bsdf lobe_of_bumps(const bsdf *b) {
  bsdf alone = *b;
  alone.has_diffuse = 0;
  return alone;
}

static __attribute__((noinline)) unsigned bumps_density_block(const bsdf *b, const sample_block *s,
                                                              draw_room *room, real *restrict pdf) {
  mutual_room own;
  ROOM one[BLOCK];
  const size_t size = s->count;
  const mutual_room *m = mutual_of(b, s, &own);
  const bsdf alone = lobe_of_bumps(b);
  sample_block at = *s;
  unsigned status = SHADE_OK;
  for (size_t i = 0; i < size; i++)
    pdf[i] = 0;
  for (int k = 0; k < 2; k++) {
    if (k && !m->side[k].lit)
      continue;
    at.n = vec_in(&m->side[k].n);
    status |= density_block(&alone, &at, room, one);
    pass_add_side(size, m->side[k].weight, one, pdf);
  }
  pass_mix_next(size, s->wi, s->wo, m, pdf);
  if (b->has_diffuse) {
    vec_room bent;
    pass_bend(size, s->n, s->wo, &bent);
    pass_cosines(b, size, vec_in(&bent), s->wo, s->wo, room->cosi, room->coso);
    pass_share(b, s, room->coso, room->weight);
    pass_cosines(b, size, vec_in(&bent), s->wi, s->wo, room->cosi, room->coso);
    for (size_t i = 0; i < size; i++)
      one[i] = room->t[i] = 0;
    pass_mix(size, even_share(b), room->t, room->cosi, room->coso, one);
    pass_add_matt(size, room->weight, one, pdf);
  }
  if (s->bumps == BUMPS_OF_SOME) {
    density_block(b, s, room, one);
    copy_flat(s, 1, (const real *[]){one}, (real *[]){pdf});
  }
  return status;
}

/* ---- draws ------------------------------------------------------------------------------------
 */

/* The side that a lane draws about, and what is left of u1; `next` where it is neither. */
static void pass_choose_side(size_t count, const mutual_room *m, real *restrict u1,
                             real *restrict next, vec_room *restrict n) {
  const real *restrict own = m->side[0].weight, *restrict other = m->side[1].weight;
  const vec_room *restrict a = &m->side[0].n, *restrict o = &m->side[1].n;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int is_next = u1[i] < m->pick[i];
    const real u = remapped(u1[i], m->pick[i], is_next);
    const real share = own[i] / maximum(own[i] + other[i], TINY);
    const int first = u < share;
    const real left = remapped(u, share, first);
    n->x[i] = first ? a->x[i] : o->x[i];
    n->y[i] = first ? a->y[i] : o->y[i];
    n->z[i] = first ? a->z[i] : o->z[i];
    next[i] = is_next ? R(1.0) : R(0.0);
    u1[i] = is_next ? u : left;
  }
}

/* What falls below the side or the map is lost, and what no side is seen for. */
static void pass_lose(size_t count, const mutual_room *m, vec n, const real *restrict wx,
                      const real *restrict wy, const real *restrict wz, real *restrict lost) {
  ARRAYS(n);
  const real *restrict own = m->side[0].weight, *restrict other = m->side[1].weight;
  SLOPES(m);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const triple w = {wx[i], wy[i], wz[i]};
    const real cosine = dot_of(AT(n), w), height = height_over(RELIEF, w);
    lost[i] = minimum(minimum(cosine, height), own[i] + other[i]) > 0 ? lost[i] : 1;
  }
}

static __attribute__((noinline)) void bumps_draw_block(const bsdf *b, const sample_block *s,
                                                       draw_room *room, real *u1, real *u2,
                                                       real *const wi[3], real *lost) {
  const size_t size = s->count;
  const mutual_room *m = s->met;
  SLOPES(m);
  const bsdf alone = lobe_of_bumps(b);
  ROOM matt[BLOCK], share[BLOCK], next[BLOCK], left[2][BLOCK];
  ROOM flat_lost[BLOCK];
  vec_room n, even, flat;
  sample_block about = *s;
  real *const flat_to[4] = {flat.x, flat.y, flat.z, flat_lost};
  if (s->bumps == BUMPS_OF_SOME) {
    memcpy(left[0], u1, size * sizeof *u1);
    memcpy(left[1], u2, size * sizeof *u2);
    draw_block(b, s, room, left[0], left[1], flat_to, flat_lost);
  }
  about.n = vec_in(&n);
  if (b->has_diffuse) {
    pass_bend(size, s->n, s->wo, &n);
    pass_cosines(b, size, about.n, s->wo, s->wo, room->cosi, room->coso);
    pass_share(b, s, room->coso, share);
    pass_split(size, even_share(b), share, u1, u2, matt, even.x, even.y, even.z);
    pass_out_of_frame(matt_frame(b), size, about.n, even.x, even.y, even.z);
  }
  pass_choose_side(size, m, u1, next, &n);
  memcpy(left[0], u1, size * sizeof *u1);
  memcpy(left[1], u2, size * sizeof *u2);
  draw_block(&alone, &about, room, u1, u2, wi, lost);
  pass_lose(size, m, about.n, wi[0], wi[1], wi[2], lost);
  for (size_t i = 0; i < size; i++) {
    drawn d = {{wi[0][i], wi[1][i], wi[2][i]}, lost[i]};
    if (b->has_diffuse && matt[i] > 0)
      d = settled((drawn){{even.x[i], even.y[i], even.z[i]}, 0});
    else if (next[i] > 0)
      d = draw_next(RELIEF, next_at(m, i), left[0][i], left[1][i]);
    else
      continue;
    wi[0][i] = d.w.x;
    wi[1][i] = d.w.y;
    wi[2][i] = d.w.z;
    lost[i] = d.lost;
  }
  for (size_t i = 0; i < size; i++)
    lost[i] = s->wo.z[i] > 0 ? lost[i] : 1;
  if (s->bumps == BUMPS_OF_SOME)
    copy_flat(s, 4, (const real *[]){flat.x, flat.y, flat.z, flat_lost},
              (real *[]){wi[0], wi[1], wi[2], lost});
}

#endif
