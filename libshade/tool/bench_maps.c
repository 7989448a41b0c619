/* SPDX-License-Identifier: Apache-2.0 */
/* shade bench, maps: slopes of a normal map over footprints, and what they do to a lobe's width. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shade/maps.h"
#include "tool/bench_parts.h"

enum { SIDE = 1024, COUNT = 1024, ROUNDS = 60 };

typedef struct arrays {
  double u[COUNT], v[COUNT], sides[4];
  shade_slopes seen[COUNT];
} arrays;

/* Waves of every length down to four texels, as slopes. */
static shade_slope_map *make_map(void) {
  shade_slope_options o;
  shade_slope_map *m = NULL;
  float *slopes = malloc(sizeof(float) * 2 * SIDE * SIDE);
  shade_slope_options_init(&o);
  o.normals = SHADE_NORMALS_SLOPE;
  for (int k = 0; slopes && k < SIDE * SIDE; k++) {
    const double x = 6.283185307179586 * (k % SIDE) / SIDE,
                 y = 6.283185307179586 * (k / SIDE) / SIDE;
    double sx = 0, sy = 0;
    for (int wave = 1; wave <= SIDE / 4; wave *= 4) {
      sx += 0.1 * cos(wave * x + 3 * wave);
      sy += 0.1 * sin(wave * y + 0.5 * wave * x);
    }
    slopes[2 * k] = (float)sx;
    slopes[2 * k + 1] = (float)sy;
  }
  if (slopes)
    m = shade_slope_map_create(slopes, SIDE, SIDE, 2, &o, NULL);
  free(slopes);
  return m;
}

/* A row of pixels that are a footprint apart, turned by half a radian; sides in texels. */
static void fill(arrays *a, double longer, double shorter) {
  const double c = cos(0.5) / SIDE, s = sin(0.5) / SIDE;
  for (int i = 0; i < COUNT; i++) {
    const double at = i * fmax(longer, 1);
    a->u[i] = 0.1 + at * c - floor(at * c);
    a->v[i] = 0.2 + at * s - floor(at * s);
  }
  const double sides[4] = {longer * c, longer * s, -shorter * s, shorter * c};
  memcpy(a->sides, sides, sizeof sides);
}

int bench_maps(bench_row *print, void *context) {
  static const struct {
    const char *what;
    double longer, shorter; /* in texels */
  } rows[] = {{"slopes_point", 0, 0}, {"slopes_1", 1, 1},        {"slopes_2", 2, 2},
              {"slopes_3", 3, 3},     {"slopes_4", 4, 4},        {"slopes_16", 16, 16},
              {"slopes_64", 64, 64},  {"slopes_16_by_4", 16, 4}, {"slopes_64_by_8", 64, 8}};
  shade_slope_map *m = make_map();
  arrays *a = calloc(1, sizeof *a);
  shade_params p, wide;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_GGX;
  for (size_t row = 0; m && a && row < sizeof rows / sizeof rows[0]; row++) {
    double best = INFINITY;
    fill(a, rows[row].longer, rows[row].shorter);
    for (int round = 0; round < ROUNDS; round++) {
      const double begun = bench_seconds();
      for (int i = 0; i < COUNT; i++)
        shade_slope_lookup(m, a->u[i], a->v[i], row ? a->sides : NULL, &a->seen[i]);
      best = fmin(best, bench_seconds() - begun);
    }
    print(context, rows[row].what, "map", "none", 0, best * 1e9 / COUNT, 0);
  }
  double best = INFINITY, angle;
  for (int round = 0; m && a && round < ROUNDS; round++) {
    const double begun = bench_seconds();
    for (int i = 0; i < COUNT; i++)
      shade_params_widen(&p, a->seen[i].normal, a->seen[i].covariance, &wide, &angle);
    best = fmin(best, bench_seconds() - begun);
  }
  const int done = m && a;
  if (done)
    print(context, "widen", "map", "ggx", 0, best * 1e9 / COUNT, 0);
  shade_slope_map_free(m);
  free(a);
  return done;
}
