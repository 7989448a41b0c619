/* SPDX-License-Identifier: Apache-2.0 */
/* shade bench, cloth: near, far and single, whole and after preparing, densities and draws. */

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shade/presets.h"
#include "model/fabric.h"
#include "tool/bench_parts.h"

enum { COUNT = 1024, RUNS = 40, ARRAYS = 13, OUT = 8, CHECKED = 64, POINTS = 1 << 14 };

/* What stands for a cloth: far by its tables, or by all lobes in turn; gloss: of each lane. */
typedef struct form {
  const char *word;
  shade_fabric_tier tier;
  int nodes;
  double footprint;
  int gloss;
} form;
static const form forms[] = {
    {"near", SHADE_TIER_NEAR, 0, 0, 0},          {"far", SHADE_TIER_FAR, 0, 20, 0},
    {"far_nodes", SHADE_TIER_FAR, 1, 20, 0},     {"single", SHADE_TIER_SINGLE, 0, 0, 0},
    {"near_gloss", SHADE_TIER_NEAR, 0, 0, 1},    {"far_gloss", SHADE_TIER_FAR, 0, 20, 1},
    {"single_gloss", SHADE_TIER_SINGLE, 0, 0, 1}};
enum { FORMS = sizeof forms / sizeof forms[0] };

/* What is timed of a cloth. */
typedef enum job { WHOLE, PREPARED, DENSITY, DRAW, CALL, JOBS } job;
static const char *const job_words[] = {"", "_prepared", "_pdf", "_sample", "_call"};

typedef struct arrays {
  double *in[ARRAYS], *out[OUT];
  float *inf[ARRAYS], *outf[OUT];
  void *hits, *hitsf;
} arrays;

static void release(arrays *a) {
  for (int k = 0; k < ARRAYS; k++) {
    free(a->in[k]);
    free(a->inf[k]);
  }
  for (int k = 0; k < OUT; k++) {
    free(a->out[k]);
    free(a->outf[k]);
  }
  free(a->hits);
  free(a->hitsf);
}

/* u, v over 64 crossings, footprint, wi, wo within 60 degrees of z, u1 to u3, gloss. 0: out of
 * memory. */
static int fill(arrays *a, double footprint) {
  uint64_t seed = 1;
  int ok = 1;
  memset(a, 0, sizeof *a);
  for (int k = 0; k < ARRAYS; k++) {
    ok &= (a->in[k] = malloc(COUNT * sizeof(double))) != NULL;
    ok &= (a->inf[k] = malloc(COUNT * sizeof(float))) != NULL;
  }
  for (int k = 0; k < OUT; k++) {
    ok &= (a->out[k] = calloc(COUNT, sizeof(double))) != NULL;
    ok &= (a->outf[k] = calloc(COUNT, sizeof(float))) != NULL;
  }
  ok &= (a->hits = malloc(shade_fabric_hits_size(COUNT))) != NULL;
  ok &= (a->hitsf = malloc(shade_fabric_hits_sizef(COUNT))) != NULL;
  for (int i = 0; ok && i < COUNT; i++) {
    double of[ARRAYS] = {64 * bench_uniform(&seed), 64 * bench_uniform(&seed), footprint};
    for (int v = 3; v < 9; v += 3) {
      const double theta = 1.047 * bench_uniform(&seed), phi = 6.2831853 * bench_uniform(&seed);
      of[v] = sin(theta) * cos(phi);
      of[v + 1] = sin(theta) * sin(phi);
      of[v + 2] = cos(theta);
    }
    for (int k = 9; k < ARRAYS; k++)
      of[k] = bench_uniform(&seed);
    for (int k = 0; k < ARRAYS; k++) {
      a->inf[k][i] = (float)of[k];
      a->in[k][i] = (double)a->inf[k][i];
    }
  }
  return ok;
}

#define LANES(in, gloss)                                                                           \
  {                                                                                                \
    .u = in[0], .v = in[1], .du = in[2], .dv = in[2], .wix = in[3], .wiy = in[4], .wiz = in[5],    \
    .wox = in[6], .woy = in[7], .woz = in[8], .u1 = in[9], .u2 = in[10], .u3 = in[11],             \
    .warp_gloss = gloss ? in[12] : NULL, .weft_gloss = gloss ? in[12] : NULL                       \
  }
#define RESULT(out)                                                                                \
  { .r = out[0], .g = out[1], .b = out[2], .wix = out[4], .wiy = out[5], .wiz = out[6] }

static void run(const shade_fabric *f, const arrays *a, const form *form, job what, int single) {
  const shade_fabric_tier tier = form->tier;
  shade_fabric_lanes in = LANES(a->in, form->gloss);
  shade_fabric_result out = RESULT(a->out);
  shade_fabric_lanesf inf = LANES(a->inf, form->gloss);
  shade_fabric_resultf outf = RESULT(a->outf);
  in.size = sizeof in;
  out.size = sizeof out;
  inf.size = sizeof inf;
  outf.size = sizeof outf;
  if (what == DENSITY || what == DRAW) {
    out.pdf = a->out[3];
    outf.pdf = a->outf[3];
  }
  switch (what) {
  case WHOLE:
    single ? shade_fabric_eval_batchf(f, COUNT, &inf, tier, &outf)
           : shade_fabric_eval_batch(f, COUNT, &in, tier, &out);
    break;
  case PREPARED:
    single ? shade_fabric_hits_evalf(f, COUNT, a->hitsf, &inf, &outf)
           : shade_fabric_hits_eval(f, COUNT, a->hits, &in, &out);
    break;
  case DENSITY:
    single ? shade_fabric_hits_pdff(f, COUNT, a->hitsf, &inf, &outf)
           : shade_fabric_hits_pdf(f, COUNT, a->hits, &in, &out);
    break;
  case DRAW:
    single ? shade_fabric_hits_samplef(f, COUNT, a->hitsf, &inf, &outf)
           : shade_fabric_hits_sample(f, COUNT, a->hits, &in, &out);
    break;
  default:
    break;
  }
}

/* One call a light, of one hit. */
static void call(const shade_fabric *f, const arrays *a, const form *form, int single) {
  shade_fabric_point p;
  shade_fabric_pointf pf;
  shade_fabric_hit hit;
  shade_fabric_hitf hitf;
  shade_fabric_point_init(f, &p);
  shade_fabric_point_initf(f, &pf);
  if (form->gloss) {
    p.warp_gloss = p.weft_gloss = a->in[12][0];
    pf.warp_gloss = pf.weft_gloss = a->inf[12][0];
  }
  p.uv[0] = pf.uv[0] = a->inf[0][0];
  p.uv[1] = pf.uv[1] = a->inf[1][0];
  p.footprint[0] = p.footprint[1] = pf.footprint[0] = pf.footprint[1] = a->inf[2][0];
  const double wo[3] = {a->in[6][0], a->in[7][0], a->in[8][0]};
  const float wof[3] = {a->inf[6][0], a->inf[7][0], a->inf[8][0]};
  shade_fabric_prepare(f, &p, wo, form->tier, &hit, NULL);
  shade_fabric_preparef(f, &pf, wof, form->tier, &hitf, NULL);
  for (int i = 0; i < COUNT; i++) {
    const double wi[3] = {a->in[3][i], a->in[4][i], a->in[5][i]};
    const float wif[3] = {a->inf[3][i], a->inf[4][i], a->inf[5][i]};
    double s[3];
    float sf[3];
    if (single)
      shade_fabric_hit_evalf(f, &hitf, wif, sf);
    else
      shade_fabric_hit_eval(f, &hit, wi, s);
    a->out[0][i] = single ? (double)sf[0] : s[0];
  }
}

static double best_of(const shade_fabric *f, const arrays *a, const form *form, job what,
                      int single) {
  double best = INFINITY;
  for (int k = 0; k < RUNS; k++) {
    const double begun = bench_seconds();
    if (what == CALL)
      call(f, a, form, single);
    else
      run(f, a, form, what, single);
    best = fmin(best, bench_seconds() - begun);
  }
  return best / COUNT * 1e9;
}

/*
 * Largest relative error of s: near, float against double (over s + 1e-3); far and single, of some
 * pairs against the mean of the near model over many points; with gloss none is taken.
 */
static double error_of(const shade_fabric *f, const arrays *a, const form *form, int single) {
  double worst = 0;
  run(f, a, form, WHOLE, 1);
  run(f, a, form, WHOLE, 0);
  if (form->tier == SHADE_TIER_NEAR) {
    for (int i = 0; i < COUNT; i++)
      worst = fmax(worst, fabs((double)a->outf[1][i] - a->out[1][i]) / (a->out[1][i] + 1e-3));
    return single ? worst : 0;
  }
  for (int i = 0; !form->gloss && i < COUNT; i += COUNT / CHECKED) {
    double mean = 0;
    const double wi[3] = {a->in[3][i], a->in[4][i], a->in[5][i]};
    const double wo[3] = {a->in[6][i], a->in[7][i], a->in[8][i]};
    for (int j = 0; j < POINTS; j++) {
      const double uv[2] = {4096 * fmod(0.5 + j * 0.7548776662466927, 1),
                            4096 * fmod(0.5 + j * 0.5698402909980532, 1)};
      double s[3];
      shade_fabric_eval(f, uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, s);
      mean += s[1] / POINTS;
    }
    const double got = single ? (double)a->outf[1][i] : a->out[1][i];
    worst = fmax(worst, fabs(got / mean - 1));
  }
  return worst;
}

/* All rows of a form. 0: out of memory. */
static int bench_form(const shade_fabric *f, const shade_preset *p, const form *form,
                      bench_row *print, void *context) {
  arrays a;
  const int ok = fill(&a, form->footprint);
  for (int single = 1; ok && single >= 0; single--) {
    shade_fabric_lanes in = LANES(a.in, form->gloss);
    shade_fabric_lanesf inf = LANES(a.inf, form->gloss);
    in.size = sizeof in;
    inf.size = sizeof inf;
    shade_fabric_prepare_batch(f, COUNT, &in, form->tier, a.hits, NULL);
    shade_fabric_prepare_batchf(f, COUNT, &inf, form->tier, a.hitsf, NULL);
    const double error = error_of(f, &a, form, single);
    for (int what = 0; what < JOBS; what++) {
      const int of_draws = what == DENSITY || what == DRAW;
      char word[32];
      snprintf(word, sizeof word, "cloth_%s%s", form->word, job_words[what]);
      if (!(form->nodes && of_draws)) /* those are the same */
        print(context, word, p->word, shade_list_word(SHADE_LIST_MDF, (int)p->fabric.mdf), single,
              best_of(f, &a, form, (job)what, single), of_draws ? 0 : error);
    }
  }
  release(&a);
  return ok;
}

int bench_cloth(bench_row *print, void *context) {
  shade_preset p;
  int ok = 1;
  for (int row = 0; ok && shade_preset_row(row, &p); row++) {
    shade_weave *weave = NULL;
    if (p.kind != SHADE_PRESET_FABRIC)
      continue;
    shade_fabric *f = shade_preset_fabric(&p, &weave, NULL);
    ok = f != NULL;
    for (int k = 0; ok && k < FORMS; k++) {
      fabric_table *tables[2] = {f->side[0].table, f->side[1].table};
      for (int side = 0; side < 2; side++)
        f->side[side].table = forms[k].nodes ? NULL : tables[side];
      ok = bench_form(f, &p, &forms[k], print, context);
      for (int side = 0; side < 2; side++)
        f->side[side].table = tables[side];
    }
    shade_fabric_free(f);
    shade_weave_free(weave);
  }
  return ok;
}
