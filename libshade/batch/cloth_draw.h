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

/* The part that u chooses, or CLOTH_NOTHING where the eye sees none; what is left of u is uniform
 * again. */
typedef struct chosen_part {
  int part;
  real left;
} chosen_part;

/* lowest: of the eye's cosines about n and z. */
LEAF chosen_part cloth_choose_one(real a, real b, real d, real e, real lowest, real u3) {
  real u = u3, chosen = a;
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
  const int seen = (lowest > 0) & (chosen > 0);
  return (chosen_part){seen ? first + second + third : CLOTH_NOTHING,
                       seen ? minimum(u / maximum(chosen, R(1e-20)), BELOW_ONE) : u3};
}
_Static_assert(CLOTH_PARTS == 4, "as many as are written out above");

/* The node that u chooses. */
static int cloth_choose_node(const fabric_nodes *nodes, real u) {
  int node = 0;
  while (node + 1 < nodes->count && u >= nodes->SUFFIX(weight)[node])
    u -= nodes->SUFFIX(weight)[node++];
  return node;
}

/* A diffuse direction about n: half by the cosine, half even; mirrored for light from behind. */
LEAF triple cloth_diffuse_one(triple n, int behind, real u3, real u1, real u2) {
  const pair p = circle(u1);
  const int even = u3 < R(0.5);
  const real up = even ? 1 - u2 : root(1 - u2);
  const real sine = root(even ? u2 * (2 - u2) : u2), x = sine * p.x, y = sine * p.y;
  const real z = behind ? -up : up;
  const axes a = axes_shortest_arc(XYZ(n));
  return (triple){a.x.x * x + a.y.x * y + n.x * z, a.x.y * x + a.y.y * y + n.y * z,
                  a.x.z * x + a.y.z * y + n.z * z};
}

/* Unit, and on one side of both horizons; or 0. */
LEAF triple cloth_settled(triple n, triple w) {
  const real size2 = w.x * w.x + w.y * w.y + w.z * w.z;
  const real ci = n.x * w.x + n.y * w.y + n.z * w.z;
  const int found = (size2 > R(0.25)) & (ci * w.z > 0);
  return scaled(w, found ? 1 / root(maximum(size2, TINY)) : 0);
}

/* ---- one lane ----------------------------------------------------------------------- */

/* From the lobe that lane 0 has of side k. */
static triple cloth_lobe_draw_one(const shade_fabric *f, const cloth *c, int k, triple wo,
                                  const real u[3]) {
  const fabric_side *s = &f->side[k];
  const fabric_lobe which = drawn_lobe(s, c->kind[0]);
  yarn_view v = yarn_view_of(f, c, 0, k, wo, wo);
  bsdf room;
  const bsdf *b = lobe_one(s, which, cloth_row(c, CLOTH_GLOSS + k)[0], &room);
  if (which == FABRIC_DRAW)
    v.n = node_normal(&s->coarse, cloth_choose_node(&s->coarse, u[2]));
  const drawn d = draw_about(b, v.n, v.wo, u[0], u[1]);
  if (d.lost > 0 || !(density_about(b, v.n, d.w, v.wo) > 0))
    return (triple){0, 0, 0};
  const triple w = cloth_carry_back_lane(cloth_carried(f, c, k), 0, cloth_is_near(c->kind[0]), d.w);
  return exchanged(w, k);
}

/* By the rule of `hard`. */
static triple cloth_hard_draw_one(const shade_fabric *f, const cloth *c, triple wo, real u[3]) {
  const triple n = cloth_triple(c, CLOTH_N, 0), none = {0, 0, 0};
  const real co = dot_of(n, wo);
  const cloth_share s = cloth_share_of(cloth_sharing_of(f), c, 0, co, f->transmits);
  const chosen_part of =
      cloth_choose_one(s.lobe[0], s.lobe[1], s.diffuse, s.behind, minimum(co, wo.z), u[2]);
  u[2] = of.left;
  if (c->kind[0] == CLOTH_VOID || of.part == CLOTH_NOTHING)
    return none;
  if (of.part >= CLOTH_DIFFUSE)
    return cloth_settled(n, cloth_diffuse_one(n, of.part == CLOTH_BEHIND, u[2], u[0], u[1]));
  return cloth_shows(c, 0, of.part) ? cloth_settled(n, cloth_lobe_draw_one(f, c, of.part, wo, u))
                                    : none;
}

/* wi from numbers u; 0 where no direction was found. Returns status bits. */
static unsigned entry_cloth_draw_one(const shade_fabric *f, const cloth *c, const real given[3],
                                     real wi[3]) {
  const triple n = cloth_triple(c, CLOTH_N, 0);
  triple wo = cloth_triple(c, CLOTH_WO, 0);
  facet_path path = {.bounce = 0};
  real u[3];
  wi[0] = wi[1] = wi[2] = 0;
  for (int a = 0; a < 3; a++)
    if (pass_uniform(1, given + a, u + a))
      return SHADE_BAD_INPUT;
  if (shade_horizon_is(f->horizon).facets) { /* the path first */
    path = choose_path(n, wo, u[2]);
    u[2] = path.u;
    wo.x = path.x;
    wo.y = path.y;
  }
  const triple w = cloth_hard_draw_one(f, c, wo, u);
  const int on = path.bounce > 0 && n.x * w.x + n.y * w.y > 0 && w.z > 0;
  const triple to = on ? mirrored(n, w) : w;
  wi[0] = to.x;
  wi[1] = to.y;
  wi[2] = to.z;
  return SHADE_OK;
}

/* ---- a block ------------------------------------------------------------------------ */

/* Draws of one lobe for every eye of g, into its wi; u1 and u2 are used up. */
static void cloth_sample(const fabric_side *s, fabric_lobe which, gathered *g, real *u1, real *u2) {
  dull_lobes room;
  const vec n = {g->n[0], g->n[1], g->n[2]}, wo = {g->wo[0], g->wo[1], g->wo[2]};
  real *const wi[3] = {g->wi[0], g->wi[1], g->wi[2]};
  const varied_arrays lobes = cloth_varied(s, which, g, &room);
  draw_lobe(bsdf_of(&s->lobe[which]), g->count, &n, &wo, &lobes, u1, u2, wi);
}

/* Lobes of the lanes of a key, into wi. u3 chooses among nodes. */
static void cloth_draw_lobes(const shade_fabric *f, const cloth *c, const unsigned char *key,
                             int wanted, int kind, int k, const real *const wo[3], const real *u3,
                             const real *u1, const real *u2, real *const wi[3]) {
  gathered g;
  real v[2][BLOCK];
  const fabric_side *s = &f->side[k];
  const fabric_lobe which = drawn_lobe(s, kind);
  if (!cloth_gather(f, c, key, wanted, kind, k, NULL, wo, &g))
    return;
  if (which == FABRIC_SINGLE)
    cloth_set_normal(&g, node_normal(&s->one, 0));
  for (size_t j = 0; j < g.count && which == FABRIC_DRAW; j++) {
    const triple n = node_normal(&s->coarse, cloth_choose_node(&s->coarse, u3[g.lane[j]]));
    g.n[0][j] = n.x;
    g.n[1][j] = n.y;
    g.n[2][j] = n.z;
  }
#pragma omp simd
  for (size_t j = 0; j < g.count; j++) {
    v[0][j] = u1[g.lane[j]];
    v[1][j] = u2[g.lane[j]];
  }
  cloth_sample(s, which, &g, v[0], v[1]);
  cloth_carry_back(f, c, kind, k, &g, wi);
}

/* Of every lane, whatever its part. */
static void cloth_draw_diffuse(const cloth *c, const int *restrict part, const real *restrict u3,
                               const real *restrict u1, const real *restrict u2,
                               real *const wi[3]) {
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  real *restrict wx = wi[0], *restrict wy = wi[1], *restrict wz = wi[2];
  SCATTERED
  for (size_t i = 0; i < c->count; i++) {
    const triple w = cloth_diffuse_one((triple){nx[i], ny[i], nz[i]}, part[i] == CLOTH_BEHIND,
                                       u3[i], u1[i], u2[i]);
    const int some = (part[i] == CLOTH_DIFFUSE) | (part[i] == CLOTH_BEHIND);
    wx[i] = some ? w.x : 0;
    wy[i] = some ? w.y : 0;
    wz[i] = some ? w.z : 0;
  }
}

static void cloth_choose(const cloth *c, const real *restrict oz, const block_shares *s,
                         real *restrict u3, int *restrict part) {
  const real *a = s->lobe[0], *b = s->lobe[1], *d = s->diffuse, *e = s->behind, *co = s->co;
  SCATTERED
  for (size_t i = 0; i < c->count; i++) {
    const chosen_part to = cloth_choose_one(a[i], b[i], d[i], e[i], minimum(co[i], oz[i]), u3[i]);
    part[i] = to.part;
    u3[i] = to.left;
  }
  for (size_t i = 0; i < c->count; i++)
    part[i] = c->kind[i] == CLOTH_VOID ? CLOTH_NOTHING : part[i];
}

/* wi from u1, u2, u3 of every lane: 0 where no direction was found. Returns status bits. */
static unsigned entry_cloth_draw(const shade_fabric *f, const cloth *c, const real *const u_in[3],
                                 real *const wi[3]) {
  static const int lobes[][2] = {{CLOTH_WEFT, 0}, {CLOTH_WARP, 1},   {CLOTH_FAR, 0},
                                 {CLOTH_FAR, 1},  {CLOTH_SINGLE, 0}, {CLOTH_SINGLE, 1}};
  block_shares share;
  real u[3][BLOCK];
  int part[BLOCK], odd = 0;
  unsigned char key[BLOCK];
  unsigned status = SHADE_OK;
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  const real *wo[3];
  real *wx = wi[0], *wy = wi[1], *wz = wi[2];
  if (shade_horizon_is(f->horizon).facets) {
    for (size_t i = 0; i < c->count; i++) {
      const cloth one = cloth_lane(c, i);
      const real numbers[3] = {u_in[0][i], u_in[1][i], u_in[2][i]};
      real w[3];
      status |= entry_cloth_draw_one(f, &one, numbers, w);
      for (int a = 0; a < 3; a++)
        wi[a][i] = w[a];
    }
    return status;
  }
  for (int a = 0; a < 3; a++)
    odd |= pass_uniform(c->count, u_in[a], u[a]);
  cloth_eye(c, wo);
  cloth_shares(f, c, wo, &share);
  cloth_choose(c, wo[2], &share, u[2], part);
  cloth_draw_diffuse(c, part, u[2], u[0], u[1], wi);
  for (size_t i = 0; i < c->count; i++)
    key[i] =
        (unsigned char)(part[i] < CLOTH_DIFFUSE ? c->kind[i] + part[i] * CLOTH_KINDS : CLOTH_VOID);
  const unsigned present = keys_present(c->count, key);
  for (size_t j = 0; j < sizeof lobes / sizeof lobes[0]; j++) {
    const int kind = lobes[j][0], k = lobes[j][1], wanted = kind + k * CLOTH_KINDS;
    if (present & 1u << wanted)
      cloth_draw_lobes(f, c, key, wanted, kind, k, wo, u[2], u[0], u[1], wi);
  }
  SCATTERED
  for (size_t i = 0; i < c->count; i++) {
    const triple w = cloth_settled((triple){nx[i], ny[i], nz[i]}, (triple){wx[i], wy[i], wz[i]});
    wx[i] = w.x;
    wy[i] = w.y;
    wz[i] = w.z;
  }
  for (size_t i = 0; odd && i < c->count; i++)
    for (int a = 0; a < 3; a++)
      if (u_in[a][i] != u_in[a][i])
        wi[0][i] = wi[1][i] = wi[2][i] = 0;
  return odd ? SHADE_BAD_INPUT : SHADE_OK;
}

#endif
