/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Preparing lanes of cloth: which term of its footprint each lane stands for, then all look-ups
 * of the near ones together, and for the far ones what the footprint holds. Look-ups and
 * footprints are in double for both precisions.
 */
#ifndef SHADE_BATCH_CLOTH_PREPARE_H
#define SHADE_BATCH_CLOTH_PREPARE_H

#include "../model/footprint.h"
#include "../model/public.h"
#include "cloth_block.h"
#include "column.h"
#include "isa.h"

/* What look-ups find. */
typedef struct cloth_seen {
  int top[BLOCK], swap[BLOCK], yarn[BLOCK];
  double dx[BLOCK], dy[BLOCK], tx[BLOCK], ty[BLOCK], occlusion[BLOCK], brightness[BLOCK];
  double fuzz[BLOCK];
} cloth_seen;

/* Room of a block that is being prepared. */
typedef struct preparing {
  mended_room room;
  real n[3][BLOCK], kd[2][3][BLOCK];
  double u[BLOCK], v[BLOCK], du[BLOCK], dv[BLOCK];
  int near[BLOCK], far[BLOCK];
  size_t near_count, far_count;
  cloth_seen seen;
} preparing;

/* `from`, or the fabric's own number, within [0, most]; NaN counts as 0. */
static int cloth_number(size_t count, const real *restrict from, real own, real most,
                        real *restrict to) {
  int off = 0;
  if (!from) {
    for (size_t i = 0; i < count; i++)
      to[i] = own;
    return 0;
  }
#pragma omp simd reduction(| : off)
  for (size_t i = 0; i < count; i++) {
    const real x = minimum(maximum(from[i], 0), most);
    off |= !(x == from[i]);
    to[i] = x;
  }
  return off;
}

/* Rows of near lanes from what look-ups found; whole: lane[j] is j. */
LEAF void cloth_near_fill(const shade_fabric *f, const cloth *c, const preparing *p, int whole) {
  const cloth_seen *s = &p->seen;
  const int *lane = p->near;
  real *mx = cloth_row(c, CLOTH_TILT), *my = mx + c->stride, *mz = my + c->stride;
  real *tx = cloth_row(c, CLOTH_FIBRE), *ty = tx + c->stride;
  real *weft = cloth_row(c, CLOTH_WEIGHT), *warp = weft + c->stride;
  real *open = cloth_row(c, CLOTH_COVERAGE);
  const double bare = f->backed ? 0 : 1;
#pragma omp simd
  for (size_t j = 0; j < p->near_count; j++) {
    const size_t i = whole ? j : (size_t)lane[j];
    const double dx = s->dx[j], dy = s->dy[j], x = s->tx[j], y = s->ty[j];
    const int gap = s->top[j] == SHADE_TOP_GAP;
    const double seen = gap ? 0 : s->occlusion[j];
    mx[i] = (real)(x * dx + y * dy);
    my[i] = (real)(x * dy - y * dx);
    mz[i] = (real)sqrt(1 - dx * dx - dy * dy);
    tx[i] = (real)x;
    ty[i] = (real)y;
    weft[i] = (real)(s->swap[j] ? 0 : seen);
    warp[i] = (real)(s->swap[j] ? seen : 0);
    open[i] = (real)(gap ? bare * (1 - s->fuzz[j]) : 0);
  }
  for (size_t j = 0; j < p->near_count; j++)
    c->kind[lane[j]] = (unsigned char)(s->top[j] == SHADE_TOP_GAP ? CLOTH_GAP
                                       : s->swap[j]               ? CLOTH_WARP
                                                                  : CLOTH_WEFT);
  for (int a = 0; a < 3; a++) {
    double own[BLOCK];
    for (size_t j = 0; j < p->near_count; j++)
      own[j] = f->draft_colors ? fabric_own(f, s->swap[j], s->yarn[j], a) : 1;
    const real *kd0 = p->kd[0][a], *kd1 = p->kd[1][a];
    real *to0 = cloth_row(c, CLOTH_KD + a), *to1 = cloth_row(c, CLOTH_KD + 3 + a);
    real *flat = cloth_row(c, CLOTH_FLAT + a);
    const double leaves0 = f->side[0].leaves[a], leaves1 = f->side[1].leaves[a];
    const double backing = f->backing[a];
    SCATTERED
    for (size_t j = 0; j < p->near_count; j++) {
      const size_t i = whole ? j : (size_t)lane[j];
      const int k = s->swap[j], gap = s->top[j] == SHADE_TOP_GAP;
      const double light = s->occlusion[j], kd = (double)(k ? kd1[i] : kd0[i]) * own[j];
      const double bright = kd * s->brightness[j];
      const double matt = gap ? 0 : light * (bright < 1 ? bright : 1) * (k ? leaves1 : leaves0);
      to0[i] = (real)(k ? 0 : matt);
      to1[i] = (real)(k ? matt : 0);
      flat[i] = (real)(gap ? light * (backing + s->fuzz[j] * (kd - backing)) : 0);
    }
    if (!f->transmits)
      continue;
    to0 = cloth_row(c, CLOTH_KT + a);
    to1 = cloth_row(c, CLOTH_KT + 3 + a);
    const double kt0 = f->side[0].transmit[a], kt1 = f->side[1].transmit[a];
    SCATTERED
    for (size_t j = 0; j < p->near_count; j++) {
      const size_t i = whole ? j : (size_t)lane[j];
      const int k = s->swap[j], gap = s->top[j] == SHADE_TOP_GAP;
      const double colour = own[j] * s->brightness[j];
      const double kd = (double)(k ? kd1[i] : kd0[i]) * colour, kt = (k ? kt1 : kt0) * colour;
      const double left = kd < 1 ? 1 - kd : 0, passed = kt < left ? kt : left;
      const double all = gap ? 0 : s->occlusion[j] * passed * (k ? leaves1 : leaves0);
      to0[i] = (real)(k ? 0 : all);
      to1[i] = (real)(k ? all : 0);
    }
  }
}

/* Rows of far lanes j from columns[k * wide + j]; whole: lane[j] is j. */
LEAF void cloth_far_fill(const shade_fabric *f, const cloth *c, const preparing *p,
                         const real *columns, size_t wide, int whole) {
  const int *lane = p->far;
  for (int k = 0; k < 2; k++) {
    real *weight = cloth_row(c, CLOTH_WEIGHT + k);
    const real *seen = columns + (size_t)(COLUMN_SEEN + k) * wide;
#pragma omp simd
    for (size_t j = 0; j < p->far_count; j++)
      weight[whole ? j : (size_t)lane[j]] = seen[j];
  }
  real *open = cloth_row(c, CLOTH_COVERAGE);
  const real *bare = columns + (size_t)COLUMN_OPEN * wide, unbacked = f->backed ? 0 : 1;
#pragma omp simd
  for (size_t j = 0; j < p->far_count; j++)
    open[whole ? j : (size_t)lane[j]] = unbacked * bare[j];
  for (int a = 0; a < 3; a++) {
    const real *gap = columns + (size_t)COLUMN_GAP * wide, backing = (real)f->backing[a];
    real *flat = cloth_row(c, CLOTH_FLAT + a);
#pragma omp simd
    for (size_t j = 0; j < p->far_count; j++)
      flat[whole ? j : (size_t)lane[j]] = gap[j] * backing;
    for (int k = 0; k < 2; k++) {
      const real *kd = p->kd[k][a];
      const int channel = f->alike ? 0 : COLUMN_CHANNEL * a;
      const real *own = columns + (size_t)(COLUMN_MATT + k + channel) * wide;
      const real *fuzz = columns + (size_t)(COLUMN_FUZZ + k + channel) * wide;
      const real *seen = columns + (size_t)(COLUMN_SEEN + k) * wide;
      const real *through = columns + (size_t)(COLUMN_PASS + 3 * k + a) * wide;
      const real leaves = (real)f->side[k].leaves[a];
      real *to = cloth_row(c, CLOTH_KD + 3 * k + a);
#pragma omp simd
      for (size_t j = 0; j < p->far_count; j++) {
        const size_t i = whole ? j : (size_t)lane[j];
        to[i] = minimum(kd[i] * own[j], seen[j]) * leaves;
        flat[i] += kd[i] * fuzz[j];
      }
      if (!f->transmits)
        continue;
      real *kt = cloth_row(c, CLOTH_KT + 3 * k + a);
      for (size_t j = 0; j < p->far_count; j++) {
        const real bright = kd[lane[j]] * own[j], most = seen[j];
        kt[lane[j]] = minimum(through[j], most - minimum(bright, most)) * leaves;
      }
    }
  }
}

/*
 * What of its footprint each lane stands for: `near` and `far` list the lanes of either model.
 * Places of near lanes stand at the front, in the order of the list. Returns status bits.
 */
static unsigned cloth_split(const fabric_lanes *in, size_t start, size_t size,
                            shade_fabric_tier tier, preparing *p) {
  const int spans = in->du && in->dv, draws = in->random != NULL, both = tier == SHADE_TIER_AUTO;
  const double tier_share = tier == SHADE_TIER_NEAR ? 0 : 1;
  const real *u = in->u + start, *v = in->v + start;
  const real *du = spans ? in->du + start : u, *dv = spans ? in->dv + start : v;
  const real *random = draws ? in->random + start : u;
  double *restrict to_u = p->u, *restrict to_v = p->v;
  double *restrict to_du = p->du, *restrict to_dv = p->dv;
  double left[BLOCK], shown[BLOCK];
  int bad = 0;
#pragma omp simd reduction(| : bad)
  for (size_t i = 0; i < size; i++) {
    const double given_du = (double)du[i], given_dv = (double)dv[i];
    const double x = (double)u[i], y = (double)v[i], given_random = (double)random[i];
    const double wide = spans ? given_du : 0, high = spans ? given_dv : 0;
    const double number = draws ? given_random : 0;
    double r = number > 0 ? number : 0, w = wide > 0 ? wide : 0, h = high > 0 ? high : 0;
    r = r < CLOTH_BELOW_ONE ? r : CLOTH_BELOW_ONE;
    w = w < 1e9 ? w : 1e9;
    h = h < 1e9 ? h : 1e9;
    const double from_near = cloth_far_share(w > h ? w : h), share = both ? from_near : tier_share;
    to_u[i] = x - x == 0 ? x : 0;
    to_v[i] = y - y == 0 ? y : 0;
    to_du[i] = w;
    to_dv[i] = h;
    shown[i] = r - share;
    left[i] = (r > share ? r - share : 0) / (share < 1 ? 1 - share : 1);
    bad |= !((wide >= 0) & (high >= 0)) | !(number == number);
  }
  size_t near_count = 0, far_count = 0;
  for (size_t i = 0; i < size; i++) { /* without branches, which would be mispredicted */
    const size_t far = shown[i] < 0;
    p->far[far_count] = p->near[near_count] = (int)i;
    far_count += far;
    near_count += 1 - far;
  }
  const int *restrict near = p->near;
  double *restrict near_u = p->seen.tx, *restrict near_v = p->seen.ty;
#pragma omp simd
  for (size_t j = 0; j < near_count; j++) {
    const size_t i = (size_t)near[j];
    const cloth_place from = {to_u[i], to_v[i]};
    const cloth_place to =
        cloth_point(from, both ? to_du[i] : 0, both ? to_dv[i] : 0, cloth_which(left[i]));
    near_u[j] = to.u;
    near_v[j] = to.v;
  }
  p->far_count = far_count;
  p->near_count = near_count;
  return bad && tier != SHADE_TIER_SINGLE ? SHADE_BAD_INPUT : SHADE_OK;
}

static void cloth_look(const shade_fabric *f, const cloth *c, preparing *p) {
  cloth_seen *s = &p->seen;
  double u[BLOCK], v[BLOCK];
  memcpy(u, s->tx, p->near_count * sizeof *u);
  memcpy(v, s->ty, p->near_count * sizeof *v);
  const shade_crossings out = {.size = sizeof out,
                               .top = s->top,
                               .swap = s->swap,
                               .yarn = s->yarn,
                               .dx = s->dx,
                               .dy = s->dy,
                               .tx = s->tx,
                               .ty = s->ty,
                               .occlusion = s->occlusion,
                               .brightness = s->brightness,
                               .fuzz = s->fuzz};
  shade_isa_entries[f->isa]->weave_batch(f->weave, p->near_count, u, v, &out);
  if (p->near_count == c->count)
    cloth_near_fill(f, c, p, 1);
  else
    cloth_near_fill(f, c, p, 0);
}

/* The columns of a group, a row each, with the streaks of its yarns. */
static void cloth_streaks(const shade_fabric *f, const column_group *g,
                          const double (*seen)[STREAK_LANES], size_t row, real *restrict columns) {
  double found[3][STREAK_LANES];
  real factor[3][STREAK_LANES], bright[2][STREAK_LANES];
  column_filled(f, g, seen, found);
#pragma omp simd
  for (size_t i = 0; i < g->count; i++) {
    factor[0][i] = (real)found[0][i];
    factor[1][i] = (real)found[1][i];
    factor[2][i] = (real)found[2][i];
    bright[0][i] = (real)(found[0][i] * g->brightness[0][i]);
    bright[1][i] = (real)(found[1][i] * g->brightness[1][i]);
  }
  const real *of[COLUMNS] = {[COLUMN_GAP] = factor[2], [COLUMN_OPEN] = factor[2]};
  for (int side = 0; side < 2; side++) {
    of[COLUMN_SEEN + side] = factor[side];
    for (int a = 0; a < 3; a++) {
      of[COLUMN_MATT + COLUMN_CHANNEL * a + side] = bright[side];
      of[COLUMN_FUZZ + COLUMN_CHANNEL * a + side] = factor[2];
      of[COLUMN_PASS + 3 * side + a] = bright[side];
    }
  }
  for (int k = 0; k < column_count(f); k++) {
    real *restrict to = columns + (size_t)k * row;
    const real *restrict by = of[k], most = k == COLUMN_OPEN ? 1 : R(1e30);
#pragma omp simd
    for (size_t i = 0; i < g->count; i++)
      to[i] = minimum(to[i] * by[i], most);
  }
}

/* Rows of columns, one a lane, to a row for each column: eight at a time, which is a few vectors of
 * lanes turned about. */
static void cloth_turn_columns(const shade_fabric *f, size_t count,
                               const double (*restrict from)[COLUMNS_STEP], size_t wide,
                               real *restrict to) {
  for (int k = 0; k < column_count(f); k += 8) {
    real *restrict a = to + (size_t)k * wide;
#pragma omp simd
    for (size_t j = 0; j < count; j++) {
      const double *restrict row = from[j] + k;
      a[j] = (real)row[0];
      a[j + wide] = (real)row[1];
      a[j + 2 * wide] = (real)row[2];
      a[j + 3 * wide] = (real)row[3];
      a[j + 4 * wide] = (real)row[4];
      a[j + 5 * wide] = (real)row[5];
      a[j + 6 * wide] = (real)row[6];
      a[j + 7 * wide] = (real)row[7];
    }
  }
}
_Static_assert(COLUMNS_ALIKE == 8 && COLUMNS_OPAQUE % 8 == 0 && COLUMNS_STEP % 8 == 0, "eights");

/* neighbours: whether lanes may lie side by side. */
static void cloth_far_rows(const shade_fabric *f, const cloth *c, shade_fabric_tier tier,
                           int neighbours, const preparing *p) {
  const int kind = tier == SHADE_TIER_SINGLE ? CLOTH_SINGLE : CLOTH_FAR;
  for (size_t j = 0; j < p->far_count; j++)
    c->kind[p->far[j]] = (unsigned char)kind;
  enum { WIDE = BLOCK + 8 }; /* or all rows would fall on the same lines of the cache */
  ROOM columns[COLUMNS_STEP * WIDE];
  column_axis x, y;
  _Alignas(64) double row[STREAK_LANES][COLUMNS_STEP];
  column_along(p->far_count, p->far, p->u, p->du, f->width, f->columns, &x);
  column_along(p->far_count, p->far, p->v, p->dv, f->height, f->rows, &y);
  enum { GROUPS = BLOCK / STREAK_LANES };
  const size_t groups = (p->far_count + STREAK_LANES - 1) / STREAK_LANES;
  column_group group[GROUPS];
  double seen[GROUPS][2][STREAK_LANES];
  int any = 0;
  for (size_t k = 0; k < groups; k++) {
    const size_t begin = k * STREAK_LANES, left = p->far_count - begin;
    const size_t size = left < STREAK_LANES ? left : STREAK_LANES;
    column_group *g = &group[k];
    g->begin = begin;
    g->count = 0;
    g->any = 0;
    column_rows(f, &x, &y, begin, size, row);
    for (size_t j = 0; j < size; j++) {
      const int i = p->far[begin + j];
      const int single = kind == CLOTH_SINGLE; /* of all repeats, as where a footprint has many */
      column_group_add(f, g, p->u[i], p->v[i], single ? 0 : p->du[i], single ? 0 : p->dv[i]);
      if (single || column_is_mean(f, p->du[i], p->dv[i]))
        memcpy(row[j], f->mean, sizeof f->mean);
    }
    cloth_turn_columns(f, size, (const double(*)[COLUMNS_STEP])row, WIDE, columns + begin);
    for (size_t j = 0; j < size; j++) {
      seen[k][0][j] = row[j][COLUMN_SEEN];
      seen[k][1][j] = row[j][COLUMN_SEEN + 1];
    }
    any |= g->any;
  }
  if (any)
    shade_isa_entries[f->isa]->streaks(f, &x, &y, SHADE_FLOAT, neighbours, groups, group);
  for (size_t k = 0; k < groups; k++)
    if (group[k].any)
      cloth_streaks(f, &group[k], (const double(*)[STREAK_LANES])seen[k], WIDE,
                    columns + group[k].begin);
  if (p->far_count == c->count)
    cloth_far_fill(f, c, p, columns, WIDE, 1);
  else
    cloth_far_fill(f, c, p, columns, WIDE, 0);
}

/* Lanes from `start` of in, one term each; in is whole but for what may be NULL. */
static unsigned entry_cloth_prepare(const shade_fabric *f, const fabric_lanes *in, size_t start,
                                    shade_fabric_tier tier, cloth *c) {
  preparing p;
  const size_t size = c->count;
  unsigned status = SHADE_OK;
  const int flat = !(in->nx && in->ny && in->nz);
  if (flat)
    for (size_t i = 0; i < size; i++) {
      p.n[0][i] = p.n[1][i] = 0;
      p.n[2][i] = 1;
    }
  vec given = {p.n[0], p.n[1], p.n[2]};
  vec eye = {in->wox + start, in->woy + start, in->woz + start};
  vec *const vectors[3] = {&given, &eye, NULL}; /* the third is not read */
  if (!flat)
    given = (vec){in->nx + start, in->ny + start, in->nz + start};
  status |= mend_block(size, 2, vectors, &p.room);
  const real *const d[2][3] = {{given.x, given.y, given.z}, {eye.x, eye.y, eye.z}};
  const unsigned mended = status;
  for (int a = 0; a < 3; a++) {
    memcpy(cloth_row(c, CLOTH_GIVEN + a), d[0][a], size * sizeof(real));
    memcpy(cloth_row(c, CLOTH_WO + a), d[1][a], size * sizeof(real));
  }
  if (!flat &&
      (f->horizon == SHADE_HORIZON_VALID_REFLECTION || f->horizon == SHADE_HORIZON_VALID_ESTEVEZ)) {
    vec_room bent;
    pass_bend(size, given, eye, &bent);
    const real *const n[3] = {bent.x, bent.y, bent.z};
    for (int a = 0; a < 3; a++)
      memcpy(cloth_row(c, CLOTH_N + a), n[a], size * sizeof(real));
  } else {
    for (int a = 0; a < 3; a++)
      memcpy(cloth_row(c, CLOTH_N + a), d[0][a], size * sizeof(real));
  }

  const real *const kd[2][3] = {{in->weft_r, in->weft_g, in->weft_b},
                                {in->warp_r, in->warp_g, in->warp_b}};
  const real *const gloss[2] = {in->weft_gloss, in->warp_gloss};
  int off = 0;
  for (int k = 0; k < 2; k++) {
    const int given = kd[k][0] && kd[k][1] && kd[k][2];
    for (int a = 0; a < 3; a++)
      off |= cloth_number(size, given ? kd[k][a] + start : NULL, (real)f->side[k].kd[a], 1,
                          p.kd[k][a]);
    off |=
        cloth_number(size, gloss[k] ? gloss[k] + start : NULL, 1, 1, cloth_row(c, CLOTH_GLOSS + k));
  }
  real *nap = cloth_row(c, CLOTH_NAP);
  off |= cloth_number(size, in->nap ? in->nap + start : NULL, (real)f->nap, 10, nap);
  status |= off ? (unsigned)SHADE_CLAMPED_PARAMETER : 0u;

  status |= cloth_split(in, start, size, tier, &p);
  if (p.near_count)
    cloth_look(f, c, &p);
  if (p.far_count)
    cloth_far_rows(f, c, tier, in->neighbours != 0, &p);

  /* coverage: until here what is open */
  real *open = cloth_row(c, CLOTH_COVERAGE);
  const real *nx = cloth_row(c, CLOTH_N), *ny = nx + c->stride, *nz = ny + c->stride;
  const real *ox = d[1][0], *oy = d[1][1], *oz = d[1][2];
#pragma omp simd
  for (size_t i = 0; i < size; i++) {
    real co = maximum(nx[i] * ox[i] + ny[i] * oy[i] + nz[i] * oz[i], R(1e-6));
    open[i] = 1 - open[i] * exp_negative(minimum(R(0.5) * nap[i] / co, 80));
  }
  const real *u = in->u + start, *v = in->v + start;
  int displaced = (mended & SHADE_BAD_INPUT) != 0;
#pragma omp simd reduction(| : displaced)
  for (size_t i = 0; i < size; i++)
    displaced |= !((u[i] - u[i]) + (v[i] - v[i]) == 0);
  for (size_t i = 0; i < size && displaced; i++) {
    const int placed = (u[i] - u[i] == 0) & (v[i] - v[i] == 0);
    if ((mended & SHADE_BAD_INPUT && p.room.void_lane[i]) || !placed) {
      status |= SHADE_BAD_INPUT;
      c->kind[i] = CLOTH_VOID;
      open[i] = 0;
    }
  }
  return status;
}

#endif
