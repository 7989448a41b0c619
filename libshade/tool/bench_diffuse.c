/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shade bench, diffuse: the diffuse part of a material alone, each model about a bumped normal;
 * what a lookup of a filtered normal map costs that shades several lobes; and the reference.
 */

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "port/memory.h"
#include "reference/reference.h"
#include "shade/maps.h"
#include "shade/shade.h"
#include "batch/arrays.h"
#include "tool/bench_parts.h"

enum { COUNT = 1024, ROUNDS = 60, REPEAT = 8, CHECKED = 256, INPUTS = 9, OUTPUTS = 4 };

/* n, wi, wo; each array starts a cache line, none at the same place of a page. */
typedef struct arrays {
  _Alignas(64) double in[INPUTS][COUNT + 40], out[OUTPUTS][COUNT + 40];
  _Alignas(64) float inf[INPUTS][COUNT + 80], outf[OUTPUTS][COUNT + 80];
} arrays;

/* Directions within 60 degrees of z. */
static void fill(arrays *a) {
  uint64_t seed = 1;
  memset(a, 0, sizeof *a);
  for (int i = 0; i < COUNT; i++)
    for (int v = 0; v < INPUTS; v += 3) {
      const double theta = 1.047 * bench_uniform(&seed), phi = 6.2831853 * bench_uniform(&seed);
      const double of[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
      for (int c = 0; c < 3; c++) {
        a->in[v + c][i] = of[c];
        a->inf[v + c][i] = (float)of[c];
      }
    }
}

static void run(const shade_bsdf *b, arrays *a, int single) {
  const shade_lanesf inf = {
      .size = sizeof inf, SHADE_DIRECTIONS(a->inf), .parts = SHADE_PART_DIFFUSE};
  const shade_resultf outf = {sizeof outf, a->outf[0], a->outf[1], a->outf[2], a->outf[3]};
  const shade_lanes in = {.size = sizeof in, SHADE_DIRECTIONS(a->in), .parts = SHADE_PART_DIFFUSE};
  const shade_result out = {sizeof out, a->out[0], a->out[1], a->out[2], a->out[3]};
  if (single)
    shade_bsdf_eval_batchf(b, COUNT, &inf, &outf);
  else
    shade_bsdf_eval_batch(b, COUNT, &in, &out);
}

/* w along the x axis of groove transport, across it, and along n. */
static void carried(const double n[3], const double w[3], double out[3]) {
  const double length = sqrt(n[0] * n[0] + n[2] * n[2]), norm = sqrt(n[1] * n[1] + length * length);
  const double x[3] = {n[2] / length, 0, -n[0] / length};
  const double z[3] = {n[0] / norm, n[1] / norm, n[2] / norm};
  const double y[3] = {z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2],
                       z[0] * x[1] - z[1] * x[0]};
  const double *axes[3] = {x, y, z};
  for (int k = 0; k < 3; k++)
    out[k] = axes[k][0] * w[0] + axes[k][1] * w[1] + axes[k][2] * w[2];
}

/* Largest difference of f cos pi/kd from the reference's Phi, where all cosines are above .05. */
static double error_of(const shade_params *p, const shade_bsdf *b, arrays *a, int single) {
  double worst = 0;
  run(b, a, single);
  for (int i = 0; i < CHECKED; i++) {
    double v[INPUTS], l[3], e[3];
    for (int k = 0; k < INPUTS; k++)
      v[k] = single ? (double)a->inf[k][i] : a->in[k][i];
    carried(v, v + 3, l);
    carried(v, v + 6, e);
    if (!(l[2] > 0.05 && e[2] > 0.05 && v[5] > 0.05 && v[8] > 0.05))
      continue;
    const double f = single ? (double)a->outf[0][i] : a->out[0][i];
    const double got = f * l[2] * 3.14159265358979323846 / p->kd[0];
    worst = fmax(worst, fabs(got - shade_ref_diffuse(p->diffuse, l, e)));
  }
  return worst;
}

int bench_diffuse(bench_row *print, void *context) {
  arrays *a = shade_port_aligned_new((sizeof *a + 63) / 64 * 64);
  if (!a)
    return 0;
  fill(a);
  for (int single = 1; single >= 0; single--) {
    shade_params p[SHADE_DIFFUSE_COUNT];
    shade_bsdf b[SHADE_DIFFUSE_COUNT];
    double ns[SHADE_DIFFUSE_COUNT];
    for (int d = 0; d < SHADE_DIFFUSE_COUNT; d++) {
      shade_params_init(&p[d]);
      p[d].diffuse = (shade_diffuse)d;
      p[d].detail = SHADE_DETAIL_ROTATE;
      p[d].groove = SHADE_GROOVE_X;
      p[d].horizon = SHADE_HORIZON_HARD;
      for (int c = 0; c < 3; c++) {
        p[d].kd[c] = .5;
        p[d].f0[c] = 0; /* which the model of Ashikhmin and Shirley takes from it */
      }
      shade_bsdf_setup(&b[d], &p[d]);
      ns[d] = INFINITY;
    }
    for (int round = 0; round < ROUNDS; round++) /* by turns, as the other rows */
      for (int d = 0; d < SHADE_DIFFUSE_COUNT; d++) {
        const double begun = bench_seconds();
        for (int k = 0; k < REPEAT; k++)
          run(&b[d], a, single);
        ns[d] = fmin(ns[d], (bench_seconds() - begun) * 1e9 / (REPEAT * COUNT));
      }
    for (int d = 0; d < SHADE_DIFFUSE_COUNT; d++)
      if (d != SHADE_DIFFUSE_POULIN_FOURNIER) /* the reference's alone */
        print(context, "diffuse", shade_list_word(SHADE_LIST_DIFFUSE, d), "none", single, ns[d],
              error_of(&p[d], &b[d], a, single));
  }
  shade_port_aligned_free(a);
  return 1;
}

/* Red of a lookup by `most` lobes: splitting, setting up, shading for one light and eye. */
static double shaded(const shade_params *p, int most) {
  static const double n[3] = {.1, .05, .9937303457175895}, spread[3] = {.0225, .002, .0121};
  static const double wi[3] = {.3, .2, .932737905308882}, wo[3] = {-.2, .1, .9746794344808963};
  shade_params wide;
  shade_slope_lobes lobes;
  shade_bsdf b;
  double angle, red = 0;
  shade_params_split(p, n, spread, most, &wide, &angle, &lobes);
  shade_bsdf_setup(&b, &wide);
  const double c = cos(angle), s = sin(angle);
  const double ti[3] = {c * wi[0] + s * wi[1], c * wi[1] - s * wi[0], wi[2]};
  const double to[3] = {c * wo[0] + s * wo[1], c * wo[1] - s * wo[0], wo[2]};
  for (int k = 0; k < lobes.count; k++) {
    const double of[3] = {lobes.nx[k], lobes.ny[k], lobes.nz[k]};
    double f[3], cosine = 0;
    shade_bsdf_eval(&b, of, ti, to, f, &cosine);
    red += lobes.weight[k] * f[0] * cosine;
  }
  return red;
}

int bench_lobes(bench_row *print, void *context) {
  static const int counts[] = {1, 2, 3, 4, 6, 8};
  static const char *const words[] = {"lobes_1", "lobes_2", "lobes_3",
                                      "lobes_4", "lobes_6", "lobes_8"};
  enum { KINDS = sizeof counts / sizeof counts[0] };
  volatile double kept;
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++) {
    shade_params p;
    double ns[KINDS];
    shade_params_init(&p);
    shade_params_set_alphas(&p, .18, .36);
    p.mdf = (shade_mdf)mdf;
    for (int k = 0; k < KINDS; k++)
      ns[k] = INFINITY;
    for (int round = 0; round < ROUNDS; round++)
      for (int k = 0; k < KINDS; k++) {
        const double begun = bench_seconds();
        for (int i = 0; i < COUNT / 8; i++)
          kept = shaded(&p, counts[k]);
        ns[k] = fmin(ns[k], (bench_seconds() - begun) * 1e9 / (COUNT / 8));
      }
    for (int k = 0; k < KINDS; k++)
      print(context, words[k], "map", shade_list_word(SHADE_LIST_MDF, mdf), 0, ns[k], 0);
  }
  (void)kept;
  return 1;
}

int bench_reference(bench_row *print, void *context) {
  enum { SOME = COUNT / 4, TURNS = 10 };
  arrays *a = shade_port_aligned_new((sizeof *a + 63) / 64 * 64);
  volatile double kept;
  if (!a)
    return 0;
  fill(a);
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++) {
    shade_params p;
    double best = INFINITY;
    shade_params_init(&p);
    shade_params_set_exponents(&p, 200, 10);
    p.mdf = (shade_mdf)mdf;
    p.detail = SHADE_DETAIL_ROTATE;
    for (int turn = 0; turn < TURNS; turn++) {
      const double begun = bench_seconds();
      for (int i = 0; i < SOME; i++) {
        const double n[3] = {a->in[0][i], a->in[1][i], a->in[2][i]};
        const double h[3] = {a->in[3][i], a->in[4][i], a->in[5][i]};
        kept = shade_ref_mdf(&p, n, h);
      }
      best = fmin(best, (bench_seconds() - begun) * 1e9 / SOME);
    }
    print(context, "D_reference", "rotate", shade_list_word(SHADE_LIST_MDF, mdf), 0, best, 0);
  }
  (void)kept;
  shade_port_aligned_free(a);
  return 1;
}
