/* SPDX-License-Identifier: Apache-2.0 */
/*
 * How the yarns of a cloth lean, for the shadows that they cast on one another. The points are
 * part of the model (docs/theory/conventions.md, "Shadows of yarns"): whoever computes it finds the
 * same.
 */
#include "../model/fabric.h"

enum { LEANS = 4096, LEANS_BLOCK = 256, REPEATS = 1024 };

/* Points of a sequence that fills the square evenly, each in a repeat of its own noise. */
static void set_places(const shade_fabric *f, int start, double *u, double *v) {
  for (int k = 0; k < LEANS_BLOCK; k++) {
    u[k] = REPEATS * f->width * fmod(0.5 + (start + k) * 0.7548776662466927, 1);
    v[k] = REPEATS * f->height * fmod(0.5 + (start + k) * 0.5698402909980532, 1);
  }
}

/* The normal that leans by x and y, as number `count`: sums of products about the mean so far,
 * since differences of large sums would leave nothing of a small spread. [Welford1962] */
static void add(fabric_lean *l, int count, double x, double y) {
  const double dx = x - l->mean[0], dy = y - l->mean[1], z = sqrt(1 - x * x - y * y);
  l->mean[0] += dx / count;
  l->mean[1] += dy / count;
  l->mean[2] += (z - l->mean[2]) / count;
  l->xx += dx * (x - l->mean[0]);
  l->xy += dx * (y - l->mean[1]);
  l->yy += dy * (y - l->mean[1]);
}

/*
 * Light so high that no yarn turns away, and that all together, whose normals' mean is shorter than
 * 1, take less than falls even if that mean leans towards it.
 */
static double no_shadows_from(const shade_fabric *f) {
  double x = 0, y = 0, z = f->level, least = INFINITY; /* tangent of the light's angle from n */
  for (int side = 0; side < 2; side++) {
    const fabric_lean *l = &f->lean[side];
    const double gap = l->xx - l->yy, widest = (l->xx + l->yy + hypot(gap, 2 * l->xy)) / 2;
    const double away = hypot(l->mean[0], l->mean[1]) + sqrt(3 * fmax(widest, 1e-12));
    x += l->share * l->mean[0];
    y += l->share * l->mean[1];
    z += l->share * l->mean[2];
    if (l->share > 0)
      least = fmin(least, l->mean[2] / away);
  }
  least = fmin(least, (1 - z) / fmax(hypot(x, y), 1e-12));
  return 1 / sqrt(1 + least * least) * (1 + 1e-6);
}

void shade_fabric_set_shadows(shade_fabric *f) {
  double u[LEANS_BLOCK], v[LEANS_BLOCK], dx[LEANS_BLOCK], dy[LEANS_BLOCK];
  int top[LEANS_BLOCK], count[2] = {0, 0};
  const shade_crossings out = {.size = sizeof out, .top = top, .dx = dx, .dy = dy};
  for (int start = 0; start < LEANS; start += LEANS_BLOCK) {
    set_places(f, start, u, v);
    shade_weave_lookup_batch(f->weave, LEANS_BLOCK, u, v, &out);
    for (int k = 0; k < LEANS_BLOCK; k++)
      if (top[k] != SHADE_TOP_GAP)
        add(&f->lean[top[k]], ++count[top[k]], dx[k], dy[k]);
  }
  for (int side = 0; side < 2; side++) {
    fabric_lean *l = &f->lean[side];
    const double n = count[side] > 0 ? count[side] : 1;
    l->xx /= n;
    l->xy /= n;
    l->yy /= n;
    l->share = (double)count[side] / LEANS;
  }
  f->level = (double)(LEANS - count[0] - count[1]) / LEANS;
  f->shadows_below = no_shadows_from(f);
  f->shadows = 1;
}
