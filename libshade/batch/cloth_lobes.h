/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Evaluation of prepared lanes of cloth. The lanes of one kind and side are gathered, light
 * and eye are carried into the frame of their fibres, the lobes run over them as over any
 * material, and what they give is scattered back.
 */
#ifndef SHADE_BATCH_CLOTH_LOBES_H
#define SHADE_BATCH_CLOTH_LOBES_H

#include "../model/cloth_shade.h"
#include "../model/single.h"
#include "bsdf_batch.h"
#include "cloth.h"
#include "sample_batch.h"
#include "table_block.h"

/* Lanes of one kind: which, and light and eye in the frame of their fibres. */
typedef struct gathered {
  size_t count;
  int whole; /* lane[j] is j: nothing has to be gathered */
  int dull;  /* ex, ey are there: exponents or alphas, as the distribution reads them */
  int lane[BLOCK];
  real n[3][BLOCK], wi[3][BLOCK], wo[3][BLOCK], ex[BLOCK], ey[BLOCK];
} gathered;

/* Cosines about n, and which lanes are lit. */
static void cloth_sides(const cloth *c, const real *const wi[3], const real *const wo[3],
                        real *restrict ci, real *restrict co, real *restrict side) {
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  const real *ix = wi[0], *iy = wi[1], *iz = wi[2], *ox = wo[0], *oy = wo[1], *oz = wo[2];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    real a = dot(nx[i], ny[i], nz[i], ix[i], iy[i], iz[i]);
    real b = dot(nx[i], ny[i], nz[i], ox[i], oy[i], oz[i]);
    ci[i] = a;
    co[i] = b;
    side[i] = side_of(a, b, iz[i], oz[i]);
  }
  for (size_t i = 0; i < c->count; i++) /* gaps and nap are there whatever the kind */
    side[i] = c->kind[i] == CLOTH_VOID ? 0 : side[i];
}

/*
 * Warp is weft with x and y exchanged, a mirror, in which turning is the other way round: the
 * fibres' direction (tx, ty) of the cloth becomes (ty, tx), and y of the answer changes sign.
 */
typedef struct carried {
  const real *nx, *ny, *nz, *tx, *ty, *x, *y, *z;
  real mx, my, flip;
} carried;

/* Of lane i; near: along its own fibres, else along their mean. flat: n is z. */
LEAF carrier cloth_carrier(carried v, size_t i, int near, int flat) {
  const real tx = near ? v.tx[i] : v.mx, ty = near ? v.ty[i] : v.my;
  if (flat)
    return (carrier){1, 0, 0, 1, 0, 0, 0, 1, tx, ty};
  return carrier_of(v.nx[i], v.ny[i], v.nz[i], tx, ty);
}

LEAF triple cloth_carry_lane(carried v, size_t i, int near, int flat) {
  const carrier a = cloth_carrier(v, i, near, flat);
  triple w = carry(a, v.x[i], v.y[i], v.z[i]);
  w.y *= v.flip;
  return w;
}

LEAF void cloth_carry_lanes(const carried *from, size_t count, const int *lane, int whole, int near,
                            int flat, real (*to)[BLOCK]) {
  const carried v = *from;
  real *ox = to[0], *oy = to[1], *oz = to[2];
#pragma omp simd
  for (size_t j = 0; j < count; j++) {
    triple w = cloth_carry_lane(v, whole ? j : (size_t)lane[j], near, flat);
    ox[j] = w.x;
    oy[j] = w.y;
    oz[j] = w.z;
  }
}

LEAF carried cloth_carried(const shade_fabric *f, const cloth *c, int k, const real *const w[3]) {
  return (carried){.nx = cloth_row(c, CLOTH_N + k),
                   .ny = cloth_row(c, CLOTH_N + 1 - k),
                   .nz = cloth_row(c, CLOTH_N + 2),
                   .tx = cloth_row(c, CLOTH_FIBRE + k),
                   .ty = cloth_row(c, CLOTH_FIBRE + 1 - k),
                   .x = w[k],
                   .y = w[1 - k],
                   .z = w[2],
                   .mx = (real)(k ? f->side[k].ty : f->side[k].tx),
                   .my = (real)(k ? f->side[k].tx : f->side[k].ty),
                   .flip = k ? R(-1.0) : R(1.0)};
}

static void cloth_carry(const shade_fabric *f, const cloth *c, int kind, int k,
                        const real *const w[3], const gathered *g, real (*to)[BLOCK]) {
  const int near = kind == CLOTH_WEFT || kind == CLOTH_WARP;
  const carried v = cloth_carried(f, c, k, w);
  const size_t count = g->count;
  if (near)
    c->flat ? cloth_carry_lanes(&v, count, g->lane, 0, 1, 1, to)
            : cloth_carry_lanes(&v, count, g->lane, 0, 1, 0, to);
  else if (g->whole)
    c->flat ? cloth_carry_lanes(&v, count, g->lane, 1, 0, 1, to)
            : cloth_carry_lanes(&v, count, g->lane, 1, 0, 0, to);
  else
    c->flat ? cloth_carry_lanes(&v, count, g->lane, 0, 0, 1, to)
            : cloth_carry_lanes(&v, count, g->lane, 0, 0, 0, to);
}

LEAF void cloth_carry_back_lanes(const carried *from, const gathered *g, int near, int flat,
                                 real (*to)[BLOCK]) {
  const carried v = *from;
  const real *ix = g->wi[0], *iy = g->wi[1], *iz = g->wi[2];
  const int *lane = g->lane;
  real *ox = to[0], *oy = to[1], *oz = to[2];
#pragma omp simd
  for (size_t j = 0; j < g->count; j++) {
    const carrier a = cloth_carrier(v, (size_t)lane[j], near, flat);
    const triple w = carry_back(a, ix[j], v.flip * iy[j], iz[j]);
    ox[j] = w.x;
    oy[j] = w.y;
    oz[j] = w.z;
  }
}

/* From the frame of the fibres back to the surface's, scattered. */
static void cloth_carry_back(const shade_fabric *f, const cloth *c, int kind, int k,
                             const gathered *g, real *const w[3]) {
  const int near = kind == CLOTH_WEFT || kind == CLOTH_WARP;
  const real *const none[3] = {NULL, NULL, NULL};
  const carried v = cloth_carried(f, c, k, none);
  real back[3][BLOCK];
  if (near)
    c->flat ? cloth_carry_back_lanes(&v, g, 1, 1, back) : cloth_carry_back_lanes(&v, g, 1, 0, back);
  else
    c->flat ? cloth_carry_back_lanes(&v, g, 0, 1, back) : cloth_carry_back_lanes(&v, g, 0, 0, back);
  real *x = w[k], *y = w[1 - k], *z = w[2];
  for (size_t j = 0; j < g->count; j++) {
    const int i = g->lane[j];
    x[i] = back[0][j];
    y[i] = back[1][j];
    z[i] = back[2][j];
  }
}

/* The normals of near yarns, or one for all. */
static void cloth_tilts(const cloth *c, int kind, const fabric_nodes *one, gathered *g) {
  for (int a = 0; a < 3; a++) {
    const real *from = cloth_row(c, CLOTH_TILT + a);
    const real same = a == 0 ? one->SUFFIX(x)[0] : a == 1 ? one->SUFFIX(y)[0] : one->SUFFIX(z)[0];
    real *to = g->n[a];
    if (kind == CLOTH_SINGLE || kind == CLOTH_FAR)
      for (size_t j = 0; j < g->count; j++)
        to[j] = same;
    else
      for (size_t j = 0; j < g->count; j++)
        to[j] = from[g->lane[j]];
  }
}

static bsdf_lanes lanes_of(const gathered *g) {
  bsdf_lanes in = {.size = sizeof in,
                   .nx = g->n[0],
                   .ny = g->n[1],
                   .nz = g->n[2],
                   .wix = g->wi[0],
                   .wiy = g->wi[1],
                   .wiz = g->wi[2],
                   .wox = g->wo[0],
                   .woy = g->wo[1],
                   .woz = g->wo[2]};
  return in;
}

static void cloth_through(const gathered *g, real *restrict through) {
  const real *nx = g->n[0], *ny = g->n[1], *nz = g->n[2];
  const real *ix = g->wi[0], *iy = g->wi[1], *iz = g->wi[2];
  const real *ox = g->wo[0], *oy = g->wo[1], *oz = g->wo[2];
#pragma omp simd
  for (size_t j = 0; j < g->count; j++)
    through[j] = let_through(dot(nx[j], ny[j], nz[j], ix[j], iy[j], iz[j]),
                             dot(nx[j], ny[j], nz[j], ox[j], oy[j], oz[j]));
}

/* The lobes of g's lanes; empty where all have b's. */
LEAF varied_arrays cloth_varied(const bsdf *b, const gathered *g) {
  if (!g->dull)
    return (varied_arrays){.parts = 0};
  return b->exponents ? (varied_arrays){.ex = g->ex, .ey = g->ey}
                      : (varied_arrays){.ax = g->ex, .ay = g->ey};
}

/*
 * What is asked of one lobe under each pair of light and eye: two numbers (spec and matt of
 * entry_yarn), or one (the density; what comes through).
 */
typedef enum asked { ASK_YARN, ASK_DENSITY, ASK_THROUGH } asked;

static void cloth_ask(asked what, const bsdf *b, const gathered *g, real *first, real *second) {
  const bsdf_lanes in = lanes_of(g);
  const varied_arrays lobes = cloth_varied(b, g);
  if (what == ASK_YARN)
    yarn_batch(b, g->count, &in, &lobes, first, second);
  else if (what == ASK_DENSITY)
    pdf_batch(b, g->count, &in, &lobes, first);
  else
    cloth_through(g, first);
}

/* The mean over nodes, one after the other: of lanes enough to fill vectors. */
static void cloth_nodes(asked what, const bsdf *b, const fabric_nodes *nodes, gathered *g,
                        real *restrict first) {
  real one[BLOCK];
  for (size_t j = 0; j < g->count; j++)
    first[j] = 0;
  for (int node = 0; node < nodes->count; node++) {
    const real x = nodes->SUFFIX(x)[node], y = nodes->SUFFIX(y)[node], z = nodes->SUFFIX(z)[node];
    const real weight = nodes->SUFFIX(weight)[node];
    real *nx = g->n[0], *ny = g->n[1], *nz = g->n[2];
#pragma omp simd
    for (size_t j = 0; j < g->count; j++) {
      nx[j] = x;
      ny[j] = y;
      nz[j] = z;
    }
    cloth_ask(what, b, g, one, NULL);
#pragma omp simd
    for (size_t j = 0; j < g->count; j++)
      first[j] += weight * one[j];
  }
}

/* The mean over nodes: as many lanes at a time as, times the nodes, fill a block. */
static void cloth_mixture(asked what, const bsdf *b, const fabric_nodes *nodes, const gathered *g,
                          real *first, real *second) {
  gathered all;
  real one[BLOCK], two[BLOCK];
  const size_t m = (size_t)nodes->count, most = BLOCK / m;
  for (size_t start = 0; start < g->count; start += most) {
    const size_t size = g->count - start < most ? g->count - start : most;
    all.count = size * m;
    all.dull = g->dull;
    for (size_t j = 0; j < size; j++) {
      for (size_t i = j * m; all.dull && i < (j + 1) * m; i++) {
        all.ex[i] = g->ex[start + j];
        all.ey[i] = g->ey[start + j];
      }
      memcpy(all.n[0] + j * m, nodes->SUFFIX(x), m * sizeof(real));
      memcpy(all.n[1] + j * m, nodes->SUFFIX(y), m * sizeof(real));
      memcpy(all.n[2] + j * m, nodes->SUFFIX(z), m * sizeof(real));
      for (int a = 0; a < 3; a++)
        for (size_t i = j * m; i < (j + 1) * m; i++) {
          all.wi[a][i] = g->wi[a][start + j];
          all.wo[a][i] = g->wo[a][start + j];
        }
    }
    cloth_ask(what, b, &all, one, two);
    const real *weight = nodes->SUFFIX(weight);
    for (size_t j = 0; j < size; j++) {
      real sum = 0, more = 0;
#pragma omp simd reduction(+ : sum)
      for (size_t i = 0; i < m; i++)
        sum += weight[i] * one[j * m + i];
      first[start + j] = sum;
      if (what != ASK_YARN)
        continue;
#pragma omp simd reduction(+ : more)
      for (size_t i = 0; i < m; i++)
        more += weight[i] * two[j * m + i];
      second[start + j] = more;
    }
  }
}

/* Ashikhmin and Shirley's yarns, carried by `rotate`. */
static int is_usual(const bsdf *b) {
  return b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY && b->brdf == SHADE_BRDF_ASHIKHMIN_SHIRLEY &&
         b->carry.map == SHADE_MAP_ROTATE_RATIO_X && !b->fibres_along_y && !b->conserve;
}

/* spec of entry_yarn, the mean over nodes, of usual lobes under one pair of light and eye. */
static real shine_usual(const fabric_nodes *nodes, real kx, real ky, real peak, triple wi,
                        triple wo) {
  const real *restrict nx = nodes->SUFFIX(x), *restrict ny = nodes->SUFFIX(y),
                       *restrict nz = nodes->SUFFIX(z);
  const real *restrict weight = nodes->SUFFIX(weight);
  const real hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;
  const real hwo = half_cosine(hx, hy, hz);
  const size_t m = FABRIC_WHOLE((size_t)nodes->count);
  enum { PARTS = 16 }; /* sums: of a reduction gcc adds a vector's numbers one after the other */
  ROOM sum[PARTS] = {0};
  for (size_t from = 0; from < m; from += PARTS)
#pragma omp simd
    for (size_t part = 0; part < PARTS; part++) {
      const size_t i = from + part;
      const real x = nx[i], y = ny[i], z = nz[i];
      const real d =
          ashikhmin_shirley_ratio(detail_rotate_ratio(x, y, z, hx, hy, hz), kx, ky, peak);
      const real ci = dot(x, y, z, XYZ(wi));
      const real co = lit_cosine(ci, dot(x, y, z, XYZ(wo)), wi.z, wo.z);
      const angles a = {hwo, ci, co, 1, 1};
      const real one = weight[i] * (brdf_ashikhmin_shirley(d, a) * ci);
      sum[part] += co > 0 ? one : 0;
    }
  for (size_t n = PARTS / 2; n; n /= 2)
    for (size_t part = 0; part < n; part++)
      sum[part] += sum[part + n];
  return sum[0];
}

/*
 * spec of entry_yarn, the mean over nodes, of lobes of Ashikhmin and Shirley's BRDF. Lane by lane:
 * light, eye and h are the same for all nodes, and h is made once.
 */
static void cloth_shine(const bsdf *given, const fabric_nodes *nodes, const gathered *g,
                        real *spec) {
  const size_t m = FABRIC_WHOLE((size_t)nodes->count);
  ROOM hx[FABRIC_NODES], hy[FABRIC_NODES], hz[FABRIC_NODES], t[FABRIC_NODES], xx[FABRIC_NODES],
      yy[FABRIC_NODES], d[FABRIC_NODES];
  const vec n = {nodes->SUFFIX(x), nodes->SUFFIX(y), nodes->SUFFIX(z)}, h = {hx, hy, hz};
  const real *restrict nx = n.x, *restrict ny = n.y, *restrict nz = n.z;
  const real *restrict weight = nodes->SUFFIX(weight);
  varied_room each;
  bsdf copy;
  const varied_arrays lobes = cloth_varied(given, g);
  const bsdf *b = for_lanes(given, &lobes, &copy);
  ROOM kx[FABRIC_NODES], ky[FABRIC_NODES], peak[FABRIC_NODES];
  const lobe_shape shape = {.kx = kx, .ky = ky, .peak = peak};
  sample_block s = {.count = g->count};
  own_shape(b, g->count, &each, &s);
  read_varied(b, &lobes, 0, &s, &each);
  const int usual = VECTOR_BYTES > 16 && is_usual(b); /* else too few registers */
  for (size_t j = 0; j < g->count; j++) {
    if (usual) {
      const triple wi = {g->wi[0][j], g->wi[1][j], g->wi[2][j]};
      const triple wo = {g->wo[0][j], g->wo[1][j], g->wo[2][j]};
      spec[j] = shine_usual(nodes, s.shape.kx[j], s.shape.ky[j], s.shape.peak[j], wi, wo);
      continue;
    }
    const real ix = g->wi[0][j], iy = g->wi[1][j], iz = g->wi[2][j];
    const real ox = g->wo[0][j], oy = g->wo[1][j], oz = g->wo[2][j];
    const real hwo = half_cosine(ix + ox, iy + oy, iz + oz);
    const real unit = scale_to_unit(ix + ox, iy + oy, iz + oz); /* for the warps */
    real sum = 0;
    for (size_t i = 0; i < m; i++) {
      hx[i] = (ix + ox) * unit;
      hy[i] = (iy + oy) * unit;
      hz[i] = (iz + oz) * unit;
      kx[i] = s.shape.kx[j];
      ky[i] = s.shape.ky[j];
      peak[i] = s.shape.peak[j];
    }
    pass_lobe(b, &shape, m, n, h, t, xx, yy, d);
#pragma omp simd reduction(+ : sum)
    for (size_t i = 0; i < m; i++) {
      const real ci = dot(nx[i], ny[i], nz[i], ix, iy, iz);
      const real co = lit_cosine(ci, dot(nx[i], ny[i], nz[i], ox, oy, oz), iz, oz);
      const angles a = {hwo, ci, co, 1, 1};
      const real one = weight[i] * brdf_ashikhmin_shirley(d[i], a) * ci;
      sum += co > 0 ? one : 0;
    }
    spec[j] = sum;
  }
}

/* The mixture by its tables; lobe by lobe where light and eye are far apart, across a fade. */
static void cloth_far(const bsdf *b, const fabric_side *s, const gathered *g, real *spec,
                      real *matt) {
  const real *const wi[3] = {g->wi[0], g->wi[1], g->wi[2]};
  const real *const wo[3] = {g->wo[0], g->wo[1], g->wo[2]};
  const real apart = (real)FABRIC_APART, fade = 1 / ((real)FABRIC_NEARBY - (real)FABRIC_APART);
  const real *ix = wi[0], *iy = wi[1], *iz = wi[2], *ox = wo[0], *oy = wo[1], *oz = wo[2];
  gathered far;
  real share[BLOCK], one[BLOCK];
  int any = 0;
  entry_table(s->table, g->count, wi, wo, g->dull ? NULL : spec, matt);
  if (g->dull) { /* the diffuse part has no gloss */
    cloth_shine(b, &s->nodes, g, spec);
    return;
  }
#pragma omp simd reduction(| : any)
  for (size_t j = 0; j < g->count; j++) {
    share[j] = (ix[j] * ox[j] + iy[j] * oy[j] + iz[j] * oz[j] - apart) * fade;
    any |= share[j] < 1;
  }
  if (!any)
    return;
  far.count = 0;
  far.dull = 0;
  for (size_t j = 0; j < g->count; j++) {
    if (!(share[j] < 1))
      continue;
    for (int a = 0; a < 3; a++) {
      far.wi[a][far.count] = wi[a][j];
      far.wo[a][far.count] = wo[a][j];
    }
    far.lane[far.count++] = (int)j;
  }
  cloth_shine(b, &s->nodes, &far, one);
  for (size_t i = 0; i < far.count; i++) {
    const int j = far.lane[i];
    const real part = maximum(share[j], 0);
    spec[j] = one[i] + part * (spec[j] - one[i]);
  }
}

/* Lanes of a kind under one lobe of their side. */
static void cloth_run(asked what, const cloth *c, const fabric_side *s, int kind, const bsdf *b,
                      gathered *g, real *first, real *second) {
  if (kind == CLOTH_FAR && what == ASK_YARN && s->table) {
    cloth_far(b, s, g, first, second);
  } else if (kind == CLOTH_FAR && what == ASK_DENSITY && s->draws_one) {
    cloth_tilts(c, kind, &s->one, g);
    cloth_ask(what, b, g, first, second);
  } else if (kind == CLOTH_FAR && what == ASK_DENSITY && g->count >= FABRIC_FEW) {
    cloth_nodes(what, b, &s->coarse, g, first);
  } else if (kind == CLOTH_FAR) {
    cloth_mixture(what, b, what == ASK_YARN ? &s->nodes : &s->coarse, g, first, second);
  } else {
    cloth_tilts(c, kind, &s->one, g);
    cloth_ask(what, b, g, first, second);
  }
}

static fabric_lobe cloth_lobe(asked what, const fabric_side *s, int kind) {
  return kind == CLOTH_SINGLE ? FABRIC_SINGLE
         : kind != CLOTH_FAR  ? FABRIC_NEAR
         : what == ASK_YARN   ? FABRIC_FAR
         : s->draws_one       ? FABRIC_SINGLE
                              : FABRIC_DRAW;
}

/* Lanes of less gloss: which of g's, in `at`, their eyes and lobes. Returns how many. */
static size_t cloth_dull(const cloth *c, const fabric_side *s, fabric_lobe which, int k,
                         const gathered *g, gathered *to, int *at) {
  const real *gloss = cloth_row(c, CLOTH_GLOSS + k);
  int any = 0;
#pragma omp simd reduction(| : any)
  for (size_t i = 0; i < c->count; i++)
    any |= gloss[i] < 1;
  to->count = 0;
  if (!any)
    return 0;
  const dulling lobe = dulling_of(s, which);
  for (size_t j = 0; j < g->count; j++) {
    if (!(gloss[g->lane[j]] < 1))
      continue;
    const size_t i = to->count++;
    at[i] = (int)j;
    to->lane[i] = g->lane[j];
    for (int a = 0; a < 3; a++)
      to->wo[a][i] = g->wo[a][j];
    to->ex[i] = gloss[g->lane[j]];
  }
  to->whole = 0;
  to->dull = 1;
#pragma omp simd
  for (size_t i = 0; i < to->count; i++) {
    const pair e = dulled(lobe, to->ex[i]);
    to->ex[i] = e.x;
    to->ey[i] = e.y;
  }
  return to->count;
}

/* The same, where some lanes have less gloss. */
static void cloth_lobes(asked what, const cloth *c, const fabric_side *s, int k, int kind,
                        gathered *g, real *first, real *second) {
  const fabric_lobe which = cloth_lobe(what, s, kind);
  const bsdf *b = bsdf_of(&s->lobe[which]);
  gathered dull;
  real one[BLOCK], two[BLOCK];
  int at[BLOCK];
  const size_t count = cloth_dull(c, s, which, k, g, &dull, at);
  if (count < g->count)
    cloth_run(what, c, s, kind, b, g, first, second);
  if (!count)
    return;
  for (int a = 0; a < 3; a++)
    for (size_t i = 0; i < count; i++)
      dull.wi[a][i] = g->wi[a][at[i]];
  cloth_run(what, c, s, kind, b, &dull, one, two);
  for (size_t i = 0; i < count; i++) {
    first[at[i]] = one[i];
    if (second)
      second[at[i]] = two[i];
  }
}

static void cloth_facing(const fabric_side *side, const gathered *g, real *restrict spec,
                         real *restrict matt) {
  const faced f = faced_of(side);
  const real *ix = g->wi[0], *iy = g->wi[1], *iz = g->wi[2];
  const real *ox = g->wo[0], *oy = g->wo[1], *oz = g->wo[2];
#pragma omp simd
  for (size_t j = 0; j < g->count; j++) {
    real seen = facing(f, ix[j], iy[j], iz[j]) * facing(f, ox[j], oy[j], oz[j]);
    spec[j] *= seen;
    matt[j] *= seen;
  }
}

/* Gather the lanes of a list for side k; those that have nothing of it are left out. */
static size_t cloth_gather(const shade_fabric *f, const cloth *c, size_t count, const int *lane,
                           int kind, int k, const real *const wi[3], const real *const wo[3],
                           gathered *g) {
  g->count = 0;
  g->whole = g->dull = 0;
  if (!count || (kind <= CLOTH_WARP && kind != k))
    return 0;
  const real *weight = cloth_row(c, CLOTH_WEIGHT + k);
  int none = count != c->count;
#pragma omp simd reduction(| : none)
  for (size_t j = 0; j < count; j++)
    none |= weight[j] <= 0;
  g->whole = !none;
  if (g->whole) {
    g->count = count;
#pragma omp simd
    for (size_t j = 0; j < count; j++)
      g->lane[j] = lane[j];
  } else {
    for (size_t j = 0; j < count; j++) {
      g->lane[g->count] = lane[j];
      g->count += weight[lane[j]] > 0;
    }
  }
  if (wi)
    cloth_carry(f, c, kind, k, wi, g, g->wi);
  cloth_carry(f, c, kind, k, wo, g, g->wo);
  return g->count;
}

LEAF void cloth_add_lanes(size_t count, const int *lane, int whole, real f0, const real *weight,
                          const real *kd, const real *white, const real *spec, const real *matt,
                          real *to) {
#pragma omp simd
  for (size_t j = 0; j < count; j++) {
    const size_t i = whole ? j : (size_t)lane[j];
    to[i] += weight[i] * spec[j] * (f0 + (1 - f0) * white[i]) + kd[i] * matt[j];
  }
}

static void cloth_add(const shade_fabric *f, const cloth *c, int k, const gathered *g,
                      const real *spec, const real *matt, const real *white, real *const rgb[3]) {
  const real *weight = cloth_row(c, CLOTH_WEIGHT + k);
  for (int channel = 0; channel < 3; channel++) {
    const real *kd = cloth_row(c, CLOTH_KD + 3 * k + channel);
    const real f0 = (real)f->side[k].f0[channel];
    if (g->whole)
      cloth_add_lanes(g->count, g->lane, 1, f0, weight, kd, white, spec, matt, rgb[channel]);
    else
      cloth_add_lanes(g->count, g->lane, 0, f0, weight, kd, white, spec, matt, rgb[channel]);
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

static void cloth_nap(const shade_fabric *f, const cloth *c, const real *restrict ci,
                      const real *restrict co, const real *restrict side, real *const rgb[3]) {
  const real *nap = cloth_row(c, CLOTH_NAP);
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

static int any_nap(const cloth *c) {
  const real *nap = cloth_row(c, CLOTH_NAP);
  int any = 0;
  for (size_t i = 0; i < c->count; i++)
    any |= nap[i] > 0;
  return any;
}

/* The same of lane i, whose light is w: from behind, the yarns' other sides lean as much. */
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

LEAF real shadowing_lane(shadowing s, size_t i, int flat, real x, real y, real z) {
  carrier a = {1, 0, 0, 1, 0, 0, 0, 1, 1, 0};
  if (!flat)
    a = carrier_of(s.nx[i], s.ny[i], s.nz[i], 1, 0);
  triple w = carry(a, x, y, z);
  real side = w.z < 0 ? R(-1.0) : R(1.0);
  return shadowed(s.weft, s.warp, s.level, side * w.x, side * w.y, side * w.z);
}

LEAF void cloth_shadow_lanes(shadowing s, size_t count, int flat, const real *const wi[3],
                             real *restrict factor) {
  const real *ix = wi[0], *iy = wi[1], *iz = wi[2];
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    factor[i] = shadowing_lane(s, i, flat, ix[i], iy[i], iz[i]);
}

/* ci: cosines about n. */
static void cloth_shadow(const shade_fabric *f, const cloth *c, const real *restrict ci,
                         const real *const wi[3], real *const rgb[3]) {
  const shadowing s = shadowing_of(f, c);
  const real below = (real)f->shadows_below;
  real factor[BLOCK];
  int any = 0;
#pragma omp simd reduction(| : any)
  for (size_t i = 0; i < c->count; i++)
    any |= absolute(ci[i]) < below;
  if (!any)
    return;
  if (c->flat)
    cloth_shadow_lanes(s, c->count, 1, wi, factor);
  else
    cloth_shadow_lanes(s, c->count, 0, wi, factor);
  for (int channel = 0; channel < 3; channel++)
    pass_multiply(c->count, factor, rgb[channel]);
}

#endif
