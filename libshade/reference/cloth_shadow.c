/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Shadows of yarns on one another. Light from wi puts wi.z on each unit of the cloth. The yarns of
 * one direction, each alone, would take the mean of max(0, m.wi) over their normals m; where all
 * together would take more than there is, each gets its part of what there is.
 */
#include "cloth_model.h"

void ref_find_leans(shade_ref_cloth *c) {
  enum { POINTS = 4096 };
  int seen[2] = {0, 0};
  real first[2][3] = {{0}}, second[2][3] = {{0}};
  for (int k = 0; k < POINTS; k++) {
    const ref_point at =
        ref_look(c, 1024.0 * c->draft->ends * fmod(0.5 + k * 0.7548776662466927, 1),
                 1024.0 * c->draft->picks * fmod(0.5 + k * 0.5698402909980532, 1));
    if (at.gap)
      continue;
    const vec m = {at.dx, at.dy, sqrtl(1 - at.dx * at.dx - at.dy * at.dy)};
    real *sum = first[at.kind], *products = second[at.kind];
    seen[at.kind]++;
    sum[0] += m.x;
    sum[1] += m.y;
    sum[2] += m.z;
    products[0] += m.x * m.x;
    products[1] += m.x * m.y;
    products[2] += m.y * m.y;
  }
  for (int kind = 0; kind < 2; kind++) {
    shade_ref_lean *l = &c->lean[kind];
    l->share = (double)seen[kind] / POINTS;
    for (int i = 0; i < 3 && seen[kind]; i++)
      l->mean[i] = (double)(first[kind][i] / seen[kind]);
    for (int i = 0; i < 3 && seen[kind]; i++)
      l->covariance[i] =
          (double)(second[kind][i] / seen[kind] - (real)l->mean[i > 1] * (real)l->mean[i > 0]);
  }
  c->gaps = 1 - c->lean[0].share - c->lean[1].share;
}

/* Of numbers spread evenly over [c - reach, c + reach], the mean of those above 0, else 0. */
static real mean_above(real c, real reach) {
  const real low = c - reach > 0 ? c - reach : 0, high = c + reach;
  if (reach <= 0)
    return c > 0 ? c : 0;
  return high > low ? (high * high - low * low) / (4 * reach) : 0;
}

void ref_shade_by_yarns(const shade_ref_cloth *c, vec n, vec wi, real s[3]) {
  if (!c->fabric.shadows || c->fabric.detail == SHADE_DETAIL_NONE)
    return;
  vec w = ref_in_cloth(SHADE_TOP_WEFT, n, wi);
  if (w.z < 0)
    w = scale(w, -1);
  real taken = c->gaps * w.z;
  for (int kind = 0; kind < 2; kind++) {
    const shade_ref_lean *l = &c->lean[kind];
    const real variance = l->covariance[0] * w.x * w.x + 2 * l->covariance[1] * w.x * w.y +
                          l->covariance[2] * w.y * w.y;
    taken += l->share * mean_above(dot((vec){l->mean[0], l->mean[1], l->mean[2]}, w),
                                   sqrtl(variance > 0 ? 3 * variance : 0));
  }
  for (int i = 0; i < 3 && taken > w.z; i++)
    s[i] *= w.z / taken;
}
