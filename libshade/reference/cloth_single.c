/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The cloth as a whole: what is seen of it over many repeats, and the tier of one lobe for the
 * warp and one for the weft.
 */
#include "cloth_model.h"
#include "model.h"

#include <string.h>

/* ---- second moments of Ashikhmin and Shirley's distribution ------------------------------- */

enum { TURNS = 1024 };

/* cos^2 phi in the middle of each step of a quadrant; all quadrants are alike. */
static void turns_of(real cos2[TURNS]) {
  for (int i = 0; i < TURNS; i++)
    cos2[i] = square(cosl(pi / 2 * (i + 0.5L) / TURNS));
}

/* E[hx^2] and E[hy^2]: the integral over z is 1/(e + 1) - 1/(e + 3), that over phi a sum. */
static void moments_of(const real cos2[TURNS], real ex, real ey, real m[2]) {
  m[0] = m[1] = 0;
  for (int i = 0; i < TURNS; i++) {
    real c2 = cos2[i], s2 = 1 - c2;
    real e = ex * c2 + ey * s2, along_z = 1 / (e + 1) - 1 / (e + 3);
    m[0] += c2 * along_z / TURNS;
    m[1] += s2 * along_z / TURNS;
  }
  m[0] *= sqrtl((ex + 1) * (ey + 1));
  m[1] *= sqrtl((ex + 1) * (ey + 1));
}

/* The exponents that have given moments, by bisection of either in turn. */
static void exponents_of(const real cos2[TURNS], const real wanted[2], double e[2]) {
  real log_e[2] = {2, 2}, moved = 1;
  for (int turn = 0; turn < 40 && moved > 1e-9L; turn++) {
    moved = 0;
    for (int k = 0; k < 2; k++) {
      real low = -7, high = 13.8L, before = log_e[k];
      while (high - low > 1e-11L) {
        real m[2];
        log_e[k] = (low + high) / 2;
        moments_of(cos2, expl(log_e[0]), expl(log_e[1]), m);
        *(m[k] > wanted[k] ? &low : &high) = log_e[k]; /* wide lobes have small exponents */
      }
      moved += fabsl(log_e[k] - before);
    }
  }
  e[0] = (double)expl(log_e[0]);
  e[1] = (double)expl(log_e[1]);
}

/* ---- what is seen ------------------------------------------------------------------------- */

/* Point k of an even sequence over 65536 repeats a side. */
static void place_of(const shade_ref_cloth *c, int k, double uv[2]) {
  uv[0] = 65536.0 * c->draft->ends * fmod(0.5 + k * 0.7548776662466927, 1);
  uv[1] = 65536.0 * c->draft->picks * fmod(0.5 + k * 0.5698402909980532, 1);
}

/* Sums over the looks at one side, each weighted by its occlusion. */
typedef struct sums {
  real weight, tx, ty, x, y, xx, yy;
  vec normal;
} sums;

static vec own_tilt(const ref_point *at) {
  return ref_along_fibres(at->tx, at->ty,
                          (vec){at->dx, at->dy, sqrtl(1 - at->dx * at->dx - at->dy * at->dy)});
}

/* Axes of a lobe about m as rotate lays them: x in the plane of x and z. */
static void axes_of(vec m, vec axes[3]) {
  axes[0] = unit((vec){m.z, 0, -m.x});
  axes[1] = cross(m, axes[0]);
  axes[2] = m;
}

/*
 * The exponents of one lobe about `mean` that has the second moments of the yarn's lobe turned to
 * every tilt.
 */
static void widen(const shade_ref_cloth *c, int kind, int looks, shade_ref_side *side) {
  const shade_yarn *yarn = kind == SHADE_TOP_WARP ? &c->fabric.warp : &c->fabric.weft;
  real own[3], wanted[2] = {0, 0}, weight = 0, cos2[TURNS];
  vec about[3];
  turns_of(cos2);
  moments_of(cos2, yarn->along, yarn->across, own);
  own[2] = 1 - own[0] - own[1];
  axes_of((vec){side->mean[0], side->mean[1], side->mean[2]}, about);
  for (int k = 0; k < looks; k++) {
    double uv[2];
    place_of(c, k, uv);
    const ref_point at = ref_look(c, uv[0], uv[1]);
    if (at.gap || at.kind != kind)
      continue;
    vec axes[3];
    axes_of(own_tilt(&at), axes);
    for (int a = 0; a < 2; a++)
      for (int b = 0; b < 3; b++)
        wanted[a] += at.occlusion * own[b] * square(dot(about[a], axes[b]));
    weight += at.occlusion;
  }
  wanted[0] /= weight;
  wanted[1] /= weight;
  exponents_of(cos2, wanted, side->exponents);
}

shade_ref_seen shade_ref_cloth_seen(const shade_ref_cloth *c, int looks) {
  shade_ref_seen seen;
  memset(&seen, 0, sizeof seen);
  sums sum[2];
  memset(sum, 0, sizeof sum);
  for (int k = 0; k < looks; k++) {
    double uv[2];
    place_of(c, k, uv);
    const ref_point at = ref_look(c, uv[0], uv[1]);
    real kd[3];
    ref_point_color(c, &at, kd);
    for (int i = 0; i < 3; i++)
      *(at.gap ? &seen.gap[i] : &seen.side[at.kind].matt[i]) +=
          (double)(at.occlusion * kd[i] / looks);
    if (at.gap)
      continue;
    sums *s = &sum[at.kind];
    const vec m = own_tilt(&at);
    s->weight += at.occlusion;
    s->tx += at.occlusion * at.tx;
    s->ty += at.occlusion * at.ty;
    s->x += at.occlusion * m.x;
    s->y += at.occlusion * m.y;
    s->xx += at.occlusion * m.x * m.x;
    s->yy += at.occlusion * m.y * m.y;
    s->normal = plus(s->normal, scale(m, at.occlusion));
  }
  for (int kind = 0; kind < 2; kind++) {
    const sums *s = &sum[kind];
    shade_ref_side *side = &seen.side[kind];
    const shade_yarn *yarn = kind == SHADE_TOP_WARP ? &c->fabric.warp : &c->fabric.weft;
    side->share = (double)(s->weight / looks);
    if (side->share <= 0)
      continue;
    const real turn = hypotl(s->tx, s->ty), x = s->x / s->weight, y = s->y / s->weight;
    side->fibres[0] = (double)(s->tx / turn);
    side->fibres[1] = (double)(s->ty / turn);
    const vec mean = c->fabric.detail == SHADE_DETAIL_NONE ? (vec){0, 0, 1} : unit(s->normal);
    side->mean[0] = (double)mean.x;
    side->mean[1] = (double)mean.y;
    side->mean[2] = (double)mean.z;
    /* of angles: a steep tilt turns more by the same step of its sine */
    const real steep = 1 - x * x - y * y > 0.03L ? 1 - x * x - y * y : 0.03L;
    side->spread[0] = (double)((s->xx / s->weight - x * x) * (1 - y * y) / steep);
    side->spread[1] = (double)((s->yy / s->weight - y * y) * (1 - x * x) / steep);
    side->exponents[0] = yarn->along;
    side->exponents[1] = yarn->across;
    for (int k = 0; k < 2 && c->fabric.detail != SHADE_DETAIL_NONE; k++) {
      real e = k ? yarn->across : yarn->along;
      side->exponents[k] = (double)(2 / (2 / (e + 2) + 2 * (real)side->spread[k]) - 2);
    }
    if (c->fabric.mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY && c->fabric.detail != SHADE_DETAIL_NONE)
      widen(c, kind, looks, side);
  }
  return seen;
}

/* ---- the tier of one lobe each --------------------------------------------------------------- */

/* What share of tilts, even about their mean, faces w. */
static real facing(const shade_ref_side *side, vec w) {
  const vec mean = {side->mean[0], side->mean[1], side->mean[2]};
  const real reach = sqrtl(3 * (side->spread[0] * square(w.x) + side->spread[1] * square(w.y)));
  const real cosine = dot(mean, w);
  return cosine >= reach ? 1 : cosine <= -reach ? 0 : (1 + cosine / reach) / 2;
}

static void single_s(const ref_hit *hit, vec n, vec wi, vec wo, real s[3]) {
  const shade_ref_cloth *c = hit->cloth;
  const real ci = dot(n, wi), co = dot(n, wo);
  s[0] = s[1] = s[2] = 0;
  if (ci <= 0 || co <= 0 || wi.z <= 0 || wo.z <= 0)
    return;
  for (int k = 0; k < 3; k++)
    s[k] = hit->seen->gap[k] * ci / pi;
  for (int kind = 0; kind < 2; kind++) {
    const shade_ref_side *side = &hit->seen->side[kind];
    if (side->share <= 0)
      continue;
    shade_yarn yarn = kind == SHADE_TOP_WARP ? c->fabric.warp : c->fabric.weft;
    yarn.along = side->exponents[0];
    yarn.across = side->exponents[1];
    const shade_params lobe = ref_yarn_lobe(&c->fabric, &yarn);
    const vec i = ref_along_fibres(side->fibres[0], side->fibres[1], ref_in_cloth(kind, n, wi));
    const vec o = ref_along_fibres(side->fibres[0], side->fibres[1], ref_in_cloth(kind, n, wo));
    real glossy[3], matt[3], faces = facing(side, i) * facing(side, o);
    ref_yarn(&lobe, unit((vec){side->mean[0], side->mean[1], side->mean[2]}), i, o, glossy, matt);
    for (int k = 0; k < 3; k++)
      s[k] += faces * (side->share * glossy[k] + side->matt[k] * matt[k]);
  }
  ref_shade_by_yarns(c, n, wi, s);
  if (c->fabric.nap > 0)
    ref_nap(&c->fabric, ci, co, s);
}

unsigned shade_ref_cloth_single(const shade_ref_cloth *c, const shade_ref_seen *seen,
                                const double n[3], const double wi[3], const double wo[3],
                                double s[3]) {
  const ref_hit hit = {c, NULL, seen, single_s};
  return ref_cloth_s(&hit, n, wi, wo, s);
}
