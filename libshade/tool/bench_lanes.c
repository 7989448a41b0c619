/* SPDX-License-Identifier: Apache-2.0 */
/*
 * shade bench, lanes: f, density and draws of GGX with the material's own parameters, with alphas
 * of each sample, and with every parameter that a sample may have.
 */

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "port/memory.h"
#include "reference/reference.h"
#include "shade/shade.h"
#include "batch/arrays.h"
#include "tool/bench_parts.h"

enum { COUNT = 1024, ROUNDS = 60, REPEAT = 8, CHECKED = 256 };
/* n, wi, wo; u; alphas, f0, kd, groove; then results */
enum { U = 9, ALPHA = 11, F0 = 13, KD = 16, GROOVE = 19, INPUTS = 21, OUTPUTS = 8 };

typedef enum job { EVAL, DENSITY, DRAW, JOBS } job;
typedef enum given { OWN, ALPHAS, ALL, GIVENS } given;
static const char *const words[JOBS][GIVENS] = {{"f", "f_alphas", "f_all"},
                                                {"pdf", "pdf_alphas", "pdf_all"},
                                                {"sample", "sample_alphas", "sample_all"}};

/* Each array starts a cache line, none at the same place of a page. */
typedef struct arrays {
  _Alignas(64) double in[INPUTS][COUNT + 40], out[OUTPUTS][COUNT + 40];
  _Alignas(64) float inf[INPUTS][COUNT + 80], outf[OUTPUTS][COUNT + 80];
} arrays;

/* Directions within 60 degrees of z; what a texture may hold. */
static void fill(arrays *a) {
  uint64_t seed = 1;
  memset(a, 0, sizeof *a);
  for (int i = 0; i < COUNT; i++) {
    for (int v = 0; v < U; v += 3) {
      const double theta = 1.047 * bench_uniform(&seed), phi = 6.2831853 * bench_uniform(&seed);
      a->in[v][i] = sin(theta) * cos(phi);
      a->in[v + 1][i] = sin(theta) * sin(phi);
      a->in[v + 2][i] = cos(theta);
    }
    for (int k = U; k < INPUTS; k++)
      a->in[k][i] = bench_uniform(&seed);
    a->in[ALPHA][i] = 0.05 + 0.4 * a->in[ALPHA][i];
    a->in[ALPHA + 1][i] = 0.05 + 0.4 * a->in[ALPHA + 1][i];
    for (int k = 0; k < INPUTS; k++)
      a->inf[k][i] = (float)a->in[k][i];
  }
}

#define RUN(f)                                                                                     \
  static void run##f(const shade_bsdf *b, arrays *a, job what, given which) {                      \
    shade_lanes##f in = {.size = sizeof in, SHADE_DIRECTIONS(a->in##f)};                           \
    if (which != OWN) {                                                                            \
      in.ax = a->in##f[ALPHA];                                                                     \
      in.ay = a->in##f[ALPHA + 1];                                                                 \
    }                                                                                              \
    if (which == ALL) {                                                                            \
      in.f0r = a->in##f[F0], in.f0g = a->in##f[F0 + 1], in.f0b = a->in##f[F0 + 2];                 \
      in.kdr = a->in##f[KD], in.kdg = a->in##f[KD + 1], in.kdb = a->in##f[KD + 2];                 \
      in.groove_x = a->in##f[GROOVE], in.groove_y = a->in##f[GROOVE + 1];                          \
    }                                                                                              \
    if (what == EVAL) {                                                                            \
      const shade_result##f to = {sizeof to, a->out##f[0], a->out##f[1], a->out##f[2],             \
                                  a->out##f[3]};                                                   \
      shade_bsdf_eval_batch##f(b, COUNT, &in, &to);                                                \
    } else if (what == DENSITY) {                                                                  \
      shade_bsdf_pdf_batch##f(b, COUNT, &in, a->out##f[0]);                                        \
    } else {                                                                                       \
      shade_sample_lanes##f from = {.size = sizeof from,                                           \
                                    .nx = in.nx,                                                   \
                                    .ny = in.ny,                                                   \
                                    .nz = in.nz,                                                   \
                                    .wox = in.wox,                                                 \
                                    .woy = in.woy,                                                 \
                                    .woz = in.woz,                                                 \
                                    .u1 = a->in##f[U],                                             \
                                    .u2 = a->in##f[U + 1]};                                        \
      memcpy(&from.f0r, &in.f0r, sizeof in - offsetof(shade_lanes##f, f0r));                       \
      const shade_sample_result##f to = {sizeof to,    a->out##f[4], a->out##f[5],                 \
                                         a->out##f[6], a->out##f[1], a->out##f[2],                 \
                                         a->out##f[3], a->out##f[0], a->out##f[7]};                \
      shade_bsdf_sample_batch##f(b, COUNT, &from, &to);                                            \
    }                                                                                              \
  }
RUN()
RUN(f)

static void run_either(const shade_bsdf *b, arrays *a, job what, given which, int single) {
  (single ? runf : run)(b, a, what, which);
}

/* Red of f, or the density, against the reference for the lane's own material. */
static double error_of(const shade_params *base, const shade_bsdf *b, arrays *a, job what,
                       given which, int single) {
  double worst = 0;
  run_either(b, a, what, which, single);
  for (int i = 0; i < CHECKED; i++) {
    shade_params p = *base;
    double v[U], angle = 0, want, f[3];
    if (which != OWN)
      shade_params_set_alphas(&p, a->in[ALPHA][i], a->in[ALPHA + 1][i]);
    for (int c = 0; which == ALL && c < 3; c++) {
      p.f0[c] = a->in[F0 + c][i];
      p.kd[c] = a->in[KD + c][i];
    }
    if (which == ALL)
      angle = atan2(a->in[GROOVE + 1][i], a->in[GROOVE][i]);
    for (int k = 0; k < U; k++) {
      const int wi = k >= 3 && k < 6 && what == DRAW;
      const double given = single ? (double)a->inf[k][i] : a->in[k][i];
      v[k] = !wi ? given : single ? (double)a->outf[k + 1][i] : a->out[k + 1][i];
    }
    const double got = single ? (double)a->outf[0][i] : a->out[0][i];
    if (what == DRAW && !(got > 0))
      continue;
    for (int k = 0; k < U; k += 3)
      shade_ref_turned(angle, v + k, v + k);
    const double cosi = v[0] * v[3] + v[1] * v[4] + v[2] * v[5];
    const double coso = v[0] * v[6] + v[1] * v[7] + v[2] * v[8];
    if (!(cosi > 0.05 && coso > 0.05 && v[5] > 0.05))
      continue;
    if (what == EVAL)
      shade_ref_f(&p, v, v + 3, v + 6, f, NULL);
    want = what == EVAL ? f[0] : shade_ref_pdf(&p, v, v + 3, v + 6);
    worst = fmax(worst, fabs(got / want - 1));
  }
  return worst;
}

int bench_lanes(bench_row *print, void *context) {
  static const shade_detail methods[] = {SHADE_DETAIL_NONE, SHADE_DETAIL_ROTATE};
  arrays *a = shade_port_aligned_new((sizeof *a + 63) / 64 * 64);
  if (!a)
    return 0;
  fill(a);
  for (int m = 0; m < 2; m++)
    for (int single = 1; single >= 0; single--)
      for (int what = 0; what < JOBS; what++) {
        shade_params p;
        shade_bsdf b;
        double ns[GIVENS] = {INFINITY, INFINITY, INFINITY};
        shade_params_init(&p);
        shade_params_set_alphas(&p, 0.1, 0.4);
        p.mdf = SHADE_MDF_GGX;
        p.brdf = SHADE_BRDF_MICROFACET;
        p.detail = methods[m];
        p.groove = SHADE_GROOVE_X;
        p.horizon = SHADE_HORIZON_HARD;
        shade_bsdf_setup(&b, &p);
        for (int round = 0; round < ROUNDS; round++) /* by turns, as the other rows */
          for (int which = 0; which < GIVENS; which++) {
            const double begun = bench_seconds();
            for (int k = 0; k < REPEAT; k++)
              run_either(&b, a, (job)what, (given)which, single);
            ns[which] = fmin(ns[which], (bench_seconds() - begun) * 1e9 / (REPEAT * COUNT));
          }
        for (int which = 0; which < GIVENS; which++)
          print(context, words[what][which], shade_list_word(SHADE_LIST_DETAIL, (int)p.detail),
                shade_list_word(SHADE_LIST_MDF, (int)p.mdf), single, ns[which],
                error_of(&p, &b, a, (job)what, (given)which, single));
      }
  shade_port_aligned_free(a);
  return 1;
}
