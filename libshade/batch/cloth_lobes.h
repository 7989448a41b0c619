/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Lobes of prepared lanes of cloth. The lanes of one kind and side are gathered, light and eye are
 * carried into the frame of their fibres, the lobes run over them as over any material, and what
 * they give is scattered back.
 */
#ifndef SHADE_BATCH_CLOTH_LOBES_H
#define SHADE_BATCH_CLOTH_LOBES_H

#include "bsdf_batch.h"
#include "cloth_one.h"

/* Before a loop over lanes out of order, or of many choices, which clang does not vectorise. */
#ifdef __clang__
#define SCATTERED
#else
#define SCATTERED _Pragma("omp simd")
#endif

/* Lanes of one kind: which, their normals, light and eye in the frame of their fibres, gloss. */
typedef struct gathered {
  size_t count;
  int whole; /* lane[j] is j */
  int flat;  /* that, and every n is z */
  int dull;  /* some gloss is less than 1 */
  int lane[BLOCK];
  real n[3][BLOCK], wi[3][BLOCK], wo[3][BLOCK], gloss[BLOCK];
} gathered;

LEAF void cloth_carry_lanes(carried from, const gathered *g, int near, int whole, int flat,
                            const real *x, const real *y, const real *z, real (*to)[BLOCK]) {
  real *ox = to[0], *oy = to[1], *oz = to[2];
  const int *lane = g->lane;
  SCATTERED
  for (size_t j = 0; j < g->count; j++) {
    const size_t i = whole ? j : (size_t)lane[j];
    const triple w = cloth_carry_lane(from, i, near, flat, (triple){x[i], y[i], z[i]});
    ox[j] = w.x;
    oy[j] = w.y;
    oz[j] = w.z;
  }
}

static void cloth_carry(const shade_fabric *f, const cloth *c, int kind, int k,
                        const real *const w[3], const gathered *g, real (*to)[BLOCK]) {
  const carried from = cloth_carried(f, c, k);
  if (cloth_is_near(kind))
    cloth_carry_lanes(from, g, 1, 0, 0, w[k], w[1 - k], w[2], to);
  else if (g->flat)
    cloth_carry_lanes(from, g, 0, 1, 1, w[k], w[1 - k], w[2], to);
  else if (g->whole)
    cloth_carry_lanes(from, g, 0, 1, 0, w[k], w[1 - k], w[2], to);
  else
    cloth_carry_lanes(from, g, 0, 0, 0, w[k], w[1 - k], w[2], to);
}

/* From the frame of the fibres back to the surface's, scattered. */
static void cloth_carry_back(const shade_fabric *f, const cloth *c, int kind, int k,
                             const gathered *g, real *const w[3]) {
  const carried from = cloth_carried(f, c, k);
  const int near = cloth_is_near(kind), *lane = g->lane;
  const real *ix = g->wi[0], *iy = g->wi[1], *iz = g->wi[2];
  real back[3][BLOCK], *bx = back[0], *by = back[1], *bz = back[2];
  SCATTERED
  for (size_t j = 0; j < g->count; j++) {
    const triple to =
        cloth_carry_back_lane(from, (size_t)lane[j], near, (triple){ix[j], iy[j], iz[j]});
    bx[j] = to.x;
    by[j] = to.y;
    bz[j] = to.z;
  }
  for (size_t j = 0; j < g->count; j++) {
    w[k][lane[j]] = bx[j];
    w[1 - k][lane[j]] = by[j];
    w[2][lane[j]] = bz[j];
  }
}

static void cloth_set_normal(gathered *g, triple n) {
  real *nx = g->n[0], *ny = g->n[1], *nz = g->n[2];
#pragma omp simd
  for (size_t j = 0; j < g->count; j++) {
    nx[j] = n.x;
    ny[j] = n.y;
    nz[j] = n.z;
  }
}

/* Whether every n is z: its z alone rounds to 1 before x and y are 0. */
static int lies_flat(const cloth *c) {
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride;
  int bent = 0;
#pragma omp simd reduction(| : bent)
  for (size_t i = 0; i < c->count; i++)
    bent |= (nx[i] != 0) | (ny[i] != 0);
  return !bent;
}

/*
 * Gather the lanes of a key, which are of this kind and show something of side k: normals of near
 * ones, gloss, eyes, and light if there is any. Returns how many.
 */
static size_t cloth_gather(const shade_fabric *f, const cloth *c, const unsigned char *key,
                           int wanted, int kind, int k, const real *const wi[3],
                           const real *const wo[3], gathered *g) {
  const real *weight = cloth_row(c, CLOTH_WEIGHT + k), *gloss = cloth_row(c, CLOTH_GLOSS + k);
  size_t count = 0;
  int others = 0, dull = 0;
#pragma omp simd reduction(| : others)
  for (size_t i = 0; i < c->count; i++) {
    g->lane[i] = (int)i;
    others |= (key[i] != wanted) | !(weight[i] > 0);
  }
  for (size_t i = 0; others && i < c->count; i++) {
    g->lane[count] = (int)i;
    count += (key[i] == wanted) & (weight[i] > 0);
  }
  g->whole = !others;
  g->flat = !others && lies_flat(c);
  g->count = others ? count : c->count;
  g->dull = 0;
  if (!g->count)
    return 0;
  if (cloth_is_near(kind))
    for (int a = 0; a < 3; a++)
      for (size_t j = 0; j < g->count; j++)
        g->n[a][j] = cloth_row(c, CLOTH_TILT + a)[g->lane[j]];
  for (size_t j = 0; j < g->count; j++)
    g->gloss[j] = gloss[g->lane[j]];
#pragma omp simd reduction(| : dull)
  for (size_t j = 0; j < g->count; j++)
    dull |= g->gloss[j] < 1;
  g->dull = dull;
  if (wi)
    cloth_carry(f, c, kind, k, wi, g, g->wi);
  cloth_carry(f, c, kind, k, wo, g, g->wo);
  return g->count;
}

/* Exponents or alphas of dull lanes. */
typedef struct dull_lobes {
  real x[BLOCK], y[BLOCK];
} dull_lobes;

/* The lobes of g's lanes; empty where all have that of the side. */
static varied_arrays cloth_varied(const fabric_side *s, fabric_lobe which, const gathered *g,
                                  dull_lobes *room) {
  const dulling by = dulling_of(s, which);
  real *x = room->x, *y = room->y;
  const real *gloss = g->gloss;
  if (!g->dull)
    return (varied_arrays){.parts = 0};
#pragma omp simd
  for (size_t j = 0; j < g->count; j++) {
    const pair e = dulled(by, gloss[j]);
    x[j] = e.x;
    y[j] = e.y;
  }
  return by.exponents ? (varied_arrays){.ex = x, .ey = y} : (varied_arrays){.ax = x, .ay = y};
}

/* What is asked of a lobe under each pair of light and eye: spec and matt of entry_yarn; or the
 * density alone, where matt is NULL. */
static void cloth_ask(const fabric_side *s, fabric_lobe which, const gathered *g, real *spec,
                      real *matt) {
  const bsdf *b = bsdf_of(&s->lobe[which]);
  const bsdf_lanes in = {.size = sizeof in,
                         .nx = g->n[0],
                         .ny = g->n[1],
                         .nz = g->n[2],
                         .wix = g->wi[0],
                         .wiy = g->wi[1],
                         .wiz = g->wi[2],
                         .wox = g->wo[0],
                         .woy = g->wo[1],
                         .woz = g->wo[2]};
  dull_lobes room;
  const varied_arrays lobes = cloth_varied(s, which, g, &room);
  if (matt)
    yarn_batch(b, g->count, &in, &lobes, spec, matt);
  else
    pdf_batch(b, g->count, &in, &lobes, spec);
}

/* The mean over nodes, one after the other. */
static void cloth_mixture(const fabric_side *s, fabric_lobe which, const fabric_nodes *nodes,
                          gathered *g, real *restrict spec, real *restrict matt) {
  real one[BLOCK], two[BLOCK];
  memset(spec, 0, g->count * sizeof *spec);
  if (matt)
    memset(matt, 0, g->count * sizeof *matt);
  for (int i = 0; i < nodes->count; i++) {
    const real weight = nodes->SUFFIX(weight)[i];
    cloth_set_normal(g, node_normal(nodes, i));
    cloth_ask(s, which, g, one, matt ? two : NULL);
#pragma omp simd
    for (size_t j = 0; j < g->count; j++)
      spec[j] += weight * one[j];
    for (size_t j = 0; matt && j < g->count; j++)
      matt[j] += weight * two[j];
  }
}

/* Of the single lobe, which fades where its side turns away. */
static void cloth_single(const fabric_side *s, gathered *g, real *restrict spec,
                         real *restrict matt) {
  const faced face = faced_of(s);
  const real *ix = g->wi[0], *iy = g->wi[1], *iz = g->wi[2];
  const real *ox = g->wo[0], *oy = g->wo[1], *oz = g->wo[2];
  cloth_set_normal(g, node_normal(&s->one, 0));
  cloth_ask(s, FABRIC_SINGLE, g, spec, matt);
#pragma omp simd
  for (size_t j = 0; j < g->count; j++) {
    const real seen = facing(face, ix[j], iy[j], iz[j]) * facing(face, ox[j], oy[j], oz[j]);
    spec[j] *= seen;
    matt[j] *= seen;
  }
}

/* spec and matt of entry_yarn of gathered lanes. */
static void cloth_yarns(const fabric_side *s, int kind, gathered *g, real *spec, real *matt) {
  const real *const wi[3] = {g->wi[0], g->wi[1], g->wi[2]};
  const real *const wo[3] = {g->wo[0], g->wo[1], g->wo[2]};
  if (cloth_is_near(kind)) {
    cloth_ask(s, FABRIC_NEAR, g, spec, matt);
  } else if (kind == CLOTH_SINGLE) {
    cloth_single(s, g, spec, matt);
  } else if (!s->table) {
    cloth_mixture(s, FABRIC_FAR, &s->nodes, g, spec, matt);
  } else {
    const real *ix = wi[0], *iy = wi[1], *iz = wi[2], *ox = wo[0], *oy = wo[1], *oz = wo[2];
    real share[BLOCK];
    int any = 0;
    entry_table(s->table, g->count, wi, wo, spec, matt);
#pragma omp simd reduction(| : any)
    for (size_t j = 0; j < g->count; j++) {
      share[j] =
          tabled_share(g->gloss[j], (triple){ix[j], iy[j], iz[j]}, (triple){ox[j], oy[j], oz[j]});
      any |= share[j] < 1;
    }
    for (size_t j = 0; any && j < g->count; j++)
      if (share[j] < 1)
        spec[j] = shine_mended(s, g->gloss[j], share[j], (triple){ix[j], iy[j], iz[j]},
                               (triple){ox[j], oy[j], oz[j]}, spec[j]);
  }
}

/* The density of draws of gathered lanes. */
static void cloth_density(const fabric_side *s, int kind, gathered *g, real *density) {
  const fabric_lobe which = drawn_lobe(s, kind);
  if (which == FABRIC_DRAW) {
    cloth_mixture(s, which, &s->coarse, g, density, NULL);
    return;
  }
  if (which == FABRIC_SINGLE)
    cloth_set_normal(g, node_normal(&s->one, 0));
  cloth_ask(s, which, g, density, NULL);
}

#endif
