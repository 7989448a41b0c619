/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Drawing light for prepared lanes of cloth. First the part: the lobe of either side, what is
 * diffuse (gaps and nap as well), what comes from behind; then a direction of that part. Diffuse
 * directions are about n, half by the cosine and half even: for fibres, however they tilt, the
 * weight stays bounded.
 */
#ifndef SHADE_BATCH_CLOTH_DRAW_H
#define SHADE_BATCH_CLOTH_DRAW_H

#include "cloth_block.h"

/* Draws of one lobe for every eye of g, into its wi; u1 and u2 are used up. */
static void cloth_sample(const bsdf *b, gathered *g, real *u1, real *u2) {
  const varied_arrays lobes = cloth_varied(b, g);
  const vec n = {g->n[0], g->n[1], g->n[2]}, wo = {g->wo[0], g->wo[1], g->wo[2]};
  real *const wi[3] = {g->wi[0], g->wi[1], g->wi[2]};
  draw_lobe(b, g->count, &n, &wo, &lobes, u1, u2, wi);
}

/* Of g's lanes a coarse node each, by u3. */
static void cloth_choose_nodes(const fabric_nodes *nodes, const real *u3, gathered *g) {
  for (size_t j = 0; j < g->count; j++) {
    int node = 0;
    real left = u3[g->lane[j]];
    while (node + 1 < nodes->count && left >= nodes->SUFFIX(weight)[node])
      left -= nodes->SUFFIX(weight)[node++];
    g->n[0][j] = nodes->SUFFIX(x)[node];
    g->n[1][j] = nodes->SUFFIX(y)[node];
    g->n[2][j] = nodes->SUFFIX(z)[node];
  }
}

/* Lobes of the lanes that are listed, into wi. u3 chooses among nodes. */
static void cloth_draw_lobes(const shade_fabric *f, const cloth *c, size_t count, const int *lane,
                             int kind, int k, const real *const wo[3], const real *u3,
                             const real *u1, const real *u2, real *const wi[3]) {
  gathered g, dull;
  real v[2][BLOCK];
  int at[BLOCK];
  const fabric_side *s = &f->side[k];
  if (!cloth_gather(f, c, count, lane, kind, k, NULL, wo, &g))
    return;
  if (kind == CLOTH_FAR && !s->draws_one)
    cloth_choose_nodes(&s->coarse, u3, &g);
  else
    cloth_tilts(c, kind, &s->one, &g);
#pragma omp simd
  for (size_t j = 0; j < g.count; j++) {
    v[0][j] = u1[g.lane[j]];
    v[1][j] = u2[g.lane[j]];
  }
  const fabric_lobe which = cloth_lobe(ASK_DENSITY, s, kind);
  const bsdf *b = bsdf_of(&s->lobe[which]);
  const size_t less = cloth_dull(c, s, which, k, &g, &dull, at);
  real w[2][BLOCK];
  for (size_t i = 0; i < less; i++) {
    const int j = at[i];
    for (int a = 0; a < 3; a++)
      dull.n[a][i] = g.n[a][j];
    w[0][i] = v[0][j];
    w[1][i] = v[1][j];
  }
  if (less < g.count)
    cloth_sample(b, &g, v[0], v[1]);
  if (less)
    cloth_sample(b, &dull, w[0], w[1]);
  for (size_t i = 0; i < less; i++)
    for (int a = 0; a < 3; a++)
      g.wi[a][at[i]] = dull.wi[a][i];
  cloth_carry_back(f, c, kind, k, &g, wi);
}

/* A diffuse direction about n: half by the cosine, half even; mirrored for light from behind. */
LEAF triple cloth_diffuse_lane(real nx, real ny, real nz, int flat, int behind, real u3, real u1,
                               real u2) {
  const pair p = circle(u1);
  const int even = u3 < R(0.5);
  const real up = even ? 1 - u2 : root(1 - u2);
  const real sine = root(even ? u2 * (2 - u2) : u2), x = sine * p.x, y = sine * p.y;
  const real z = behind ? -up : up;
  if (flat)
    return (triple){x, y, z};
  const axes a = axes_shortest_arc(nx, ny, nz);
  return (triple){a.x.x * x + a.y.x * y + nx * z, a.x.y * x + a.y.y * y + ny * z,
                  a.x.z * x + a.y.z * y + nz * z};
}

LEAF void cloth_diffuse_lanes(const cloth *c, size_t count, const int *lane, int flat,
                              const int *part, const real *u3, const real *u1, const real *u2,
                              real (*to)[BLOCK]) {
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  real *wx = to[0], *wy = to[1], *wz = to[2];
#pragma omp simd
  for (size_t j = 0; j < count; j++) {
    const int i = lane[j];
    const triple w = cloth_diffuse_lane(flat ? 0 : nx[i], flat ? 0 : ny[i], flat ? 1 : nz[i], flat,
                                        part[i] == CLOTH_BEHIND, u3[i], u1[i], u2[i]);
    wx[j] = w.x;
    wy[j] = w.y;
    wz[j] = w.z;
  }
}

/* Those of the lanes that are listed, into wi. */
static void cloth_draw_diffuse(const cloth *c, size_t count, const int *lane, const int *part,
                               const real *u3, const real *u1, const real *u2, real *const wi[3]) {
  real w[3][BLOCK];
  if (c->flat)
    cloth_diffuse_lanes(c, count, lane, 1, part, u3, u1, u2, w);
  else
    cloth_diffuse_lanes(c, count, lane, 0, part, u3, u1, u2, w);
  for (size_t j = 0; j < count; j++)
    for (int a = 0; a < 3; a++)
      wi[a][lane[j]] = w[a][j];
}

/* The part that u3 chooses, or -1 where the eye sees none; what is left of u3 is uniform again. */
static void cloth_choose(const cloth *c, const real *const wo[3], real (*share)[BLOCK],
                         real *restrict u3, int *restrict part) {
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  const real *ox = wo[0], *oy = wo[1], *oz = wo[2];
  const real *s0 = share[0], *s1 = share[1], *s2 = share[2], *s3 = share[3];
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) {
    const real a = s0[i], b = s1[i], d = s2[i], e = s3[i];
    const real co = nx[i] * ox[i] + ny[i] * oy[i] + nz[i] * oz[i];
    real u = u3[i], chosen = a;
    /* never beyond the last that is there */
    const int first = (maximum(maximum(b, d), e) > 0) & (u >= a);
    u -= first ? a : 0;
    chosen = first ? b : chosen;
    const int second = first & (maximum(d, e) > 0) & (u >= b);
    u -= second ? b : 0;
    chosen = second ? d : chosen;
    const int third = second & (e > 0) & (u >= d);
    u -= third ? d : 0;
    chosen = third ? e : chosen;
    const int seen = (minimum(co, oz[i]) > 0) & (chosen > 0);
    u3[i] = seen ? minimum(u / maximum(chosen, R(1e-20)), BELOW_ONE) : u3[i];
    part[i] = seen ? first + second + third : -1;
  }
}
_Static_assert(CLOTH_PARTS == 4, "as many as are written out above");

/* A key for cloth_pick, of lobes by kind and side. */
enum { KEY_MATT = 2 * CLOTH_KINDS };
LEAF unsigned char part_key(unsigned char kind, int part) {
  const unsigned char of = (unsigned char)part; /* none: 255 */
  const unsigned char lobe = (unsigned char)(kind + (of ? CLOTH_KINDS : 0));
  const unsigned char some = of < CLOTH_DIFFUSE ? lobe : (unsigned char)KEY_MATT;
  return kind == CLOTH_VOID || of >= CLOTH_PARTS ? (unsigned char)CLOTH_VOID : some;
}

static void cloth_part_keys(const cloth *c, const int *restrict part, unsigned char *restrict key) {
  if (c->count < CLOTH_FEW) {
    for (size_t i = 0; i < c->count; i++)
      key[i] = part_key(c->kind[i], part[i]);
    return;
  }
#pragma omp simd
  for (size_t i = 0; i < c->count; i++)
    key[i] = part_key(c->kind[i], part[i]);
}

/* Draws by the rule of `hard` for eyes wo; u3 is used up. wi is 0 where nothing was found. */
static void cloth_draw(const shade_fabric *f, const cloth *c, const real *const wo[3], real *u3,
                       const real *u1, const real *u2, real *const wi[3]) {
  static const int lobes[][2] = {{CLOTH_WEFT, 0}, {CLOTH_WARP, 1},   {CLOTH_FAR, 0},
                                 {CLOTH_FAR, 1},  {CLOTH_SINGLE, 0}, {CLOTH_SINGLE, 1}};
  real share[CLOTH_PARTS][BLOCK];
  int part[BLOCK], lane[BLOCK];
  unsigned char key[BLOCK];
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  real *wx = wi[0], *wy = wi[1], *wz = wi[2];
  cloth_shares(f, c, wo, share);
  cloth_choose(c, wo, share, u3, part);
  cloth_part_keys(c, part, key);
  for (int a = 0; a < 3; a++)
    memset(wi[a], 0, c->count * sizeof *wi[a]);
  const size_t matt = cloth_pick(c->count, key, KEY_MATT, lane);
  if (matt)
    cloth_draw_diffuse(c, matt, lane, part, u3, u1, u2, wi);
  for (size_t j = 0; j < sizeof lobes / sizeof lobes[0]; j++) {
    const int kind = lobes[j][0], k = lobes[j][1];
    const size_t count = cloth_pick(c->count, key, kind + k * CLOTH_KINDS, lane);
    if (count)
      cloth_draw_lobes(f, c, count, lane, kind, k, wo, u3, u1, u2, wi);
  }
#pragma omp simd
  for (size_t i = 0; i < c->count; i++) { /* unit, and on one side of both horizons */
    real size2 = wx[i] * wx[i] + wy[i] * wy[i] + wz[i] * wz[i];
    real ci = nx[i] * wx[i] + ny[i] * wy[i] + nz[i] * wz[i];
    int found = (size2 > R(0.25)) & (ci * wz[i] > 0);
    real scale = found ? 1 / root(maximum(size2, TINY)) : 0;
    wx[i] *= scale;
    wy[i] *= scale;
    wz[i] *= scale;
  }
}

/* Draws for facets and upright mirrors: the path first, by u3, then as for hard. */
static void cloth_facets_draw(const shade_fabric *f, const cloth *c, real *u3, const real *u1,
                              const real *u2, real *const wi[3]) {
  const real *n[3], *wo[3];
  real x[BLOCK], y[BLOCK], bounce[BLOCK];
  cloth_eye(c, wo);
  for (int a = 0; a < 3; a++)
    n[a] = cloth_row(c, CLOTH_N + a);
  pass_choose_path(c->count, vec_of(n), vec_of(wo), u3, x, y, bounce);
  const real *const eye[3] = {x, y, wo[2]};
  cloth_draw(f, c, eye, u3, u1, u2, wi);
  for (size_t i = 0; i < c->count; i++) {
    const real side = n[0][i] * wi[0][i] + n[1][i] * wi[1][i];
    if (bounce[i] > 0 && side > 0 && wi[2][i] > 0) {
      const real step = mirror_step(n[0][i], n[1][i], wi[0][i], wi[1][i]);
      wi[0][i] -= step * n[0][i];
      wi[1][i] -= step * n[1][i];
    }
  }
}

/* wi from u1, u2, u3 of every lane: 0 where no direction was found. Returns status bits. */
static unsigned entry_cloth_draw(const shade_fabric *f, const cloth *c, const real *const u_in[3],
                                 real *const wi[3]) {
  real u[3][BLOCK];
  const real *wo[3];
  int odd = 0;
  for (int a = 0; a < 3; a++)
    odd |= pass_uniform(c->count, u_in[a], u[a]);
  cloth_eye(c, wo);
  if (f->horizon == SHADE_HORIZON_SCHUESSLER)
    cloth_facets_draw(f, c, u[2], u[0], u[1], wi);
  else
    cloth_draw(f, c, wo, u[2], u[0], u[1], wi);
  for (size_t i = 0; odd && i < c->count; i++)
    for (int a = 0; a < 3; a++)
      if (u_in[a][i] != u_in[a][i])
        wi[0][i] = wi[1][i] = wi[2][i] = 0;
  return odd ? SHADE_BAD_INPUT : SHADE_OK;
}

#endif
