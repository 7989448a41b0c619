/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 1.0 */
/*
 * Hostile lanes of cloth: any material, tier, horizon and texture, directions of any length and
 * none. Answers are finite and not below 0, draws have a density and are on the sphere, one
 * call says what a batch says, and what cannot be shaded is 0 and says so.
 *
 *   build/test/fabric_soak [--cases N] [--seed N]     (default: 60 fabrics, each once)
 */
#include "cloth.h"

enum { LANES = 300, ARRAYS = 25 };

static double hostile(uint64_t *seed) {
  static const double list[] = {0,      -0.0,  1,    -1,     NAN,    INFINITY, -INFINITY, 1e300,
                                -1e300, 1e-40, 1e20, 1e-300, 1e-320, 0.5,      1e38,      -3e-39};
  return list[(int)(16 * uniform(seed))];
}

static double number(uint64_t *seed, double high) {
  return uniform(seed) < 0.03 ? hostile(seed) : high * uniform(seed);
}

static void direction(uint64_t *seed, double v[3]) {
  const double kind = uniform(seed);
  any_direction(seed, kind < 0.2 ? -1 : 0, v);
  if (kind > 0.9)
    v[2] *= 1e-3 * uniform(seed);
  if (kind > 0.96)
    for (int a = 0; a < 3; a++)
      v[a] *= exp(60 * uniform(seed) - 30);
  if (uniform(seed) < 0.02)
    v[(int)(3 * uniform(seed))] = hostile(seed);
}

static int choice(uint64_t *seed, int count) {
  return (int)(count * uniform(seed));
}

static shade_fabric *make_fabric(uint64_t *seed, shade_weave **weave) {
  shade_preset p;
  int row, found = 0, wanted = choice(seed, 9);
  for (row = 0; shade_preset_row(row, &p); row++)
    if (p.kind == SHADE_PRESET_FABRIC && found++ == wanted)
      break;
  shade_fabric_params *f = &p.fabric;
  f->mdf = (shade_mdf)choice(seed, SHADE_MDF_COUNT);
  f->brdf = (shade_brdf)choice(seed, SHADE_BRDF_COUNT);
  f->detail = (shade_detail)choice(seed, SHADE_DETAIL_COUNT);
  f->horizon = (shade_horizon)choice(seed, SHADE_HORIZON_COUNT);
  f->warp.diffuse = (shade_diffuse)choice(seed, SHADE_DIFFUSE_COUNT);
  f->weft.along = exp(14 * uniform(seed)) - 1;
  f->nap = uniform(seed) < 0.5 ? 0 : number(seed, 3);
  for (int a = 0; a < 3; a++) {
    f->warp_transmit[a] = f->weft_transmit[a] = wanted % 2 ? number(seed, 1) : 0;
    f->backing[a] = wanted % 3 ? 0 : number(seed, 1);
    f->warp.f0[a] = number(seed, 1);
  }
  unsigned status = 0;
  shade_fabric *fabric = shade_preset_fabric(&p, weave, &status);
  assert_non_null(fabric);
  return fabric;
}

typedef struct block {
  double in[ARRAYS][LANES], out[8][LANES];
  float inf[ARRAYS][LANES], outf[8][LANES];
} block;

#define LANES_OF(in)                                                                               \
  {                                                                                                \
    .u = in[0], .v = in[1], .du = in[2], .dv = in[3], .nx = in[4], .ny = in[5], .nz = in[6],       \
    .wix = in[7], .wiy = in[8], .wiz = in[9], .wox = in[10], .woy = in[11], .woz = in[12],         \
    .random = in[13], .warp_r = in[14], .warp_g = in[15], .warp_b = in[16], .weft_r = in[17],      \
    .weft_g = in[18], .weft_b = in[19], .warp_gloss = in[20], .nap = in[21], .u1 = in[22],         \
    .u2 = in[23], .u3 = in[24]                                                                     \
  }
#define RESULT_OF(out)                                                                             \
  {                                                                                                \
    .r = out[0], .g = out[1], .b = out[2], .pdf = out[3], .coverage = out[4], .wix = out[5],       \
    .wiy = out[6], .wiz = out[7]                                                                   \
  }

static void fill(block *m, uint64_t *seed) {
  for (int i = 0; i < LANES; i++) {
    double of[ARRAYS];
    for (int k = 0; k < ARRAYS; k++)
      of[k] = number(seed, 1);
    of[0] = number(seed, 64);
    of[1] = number(seed, 64);
    of[2] = number(seed, 4);
    of[3] = number(seed, 4);
    for (int k = 4; k < 13; k += 3)
      direction(seed, of + k);
    of[20] = uniform(seed) < 0.8 ? 1 : of[20];
    of[21] = uniform(seed) < 0.7 ? 0 : of[21];
    for (int k = 0; k < ARRAYS; k++) {
      m->inf[k][i] = (float)of[k];
      m->in[k][i] = uniform(seed) < 0.5 ? of[k] : (double)m->inf[k][i];
    }
  }
}

/* Nearly all lanes side by side, wherever that is, in footprints of nearly one size. */
static void draw_near(block *m, uint64_t *seed) {
  const double way = uniform(seed) < 0.2 ? 0 : exp(8 * uniform(seed) - 3);
  const double corner[2] = {number(seed, 64), number(seed, 64)};
  const double extent[2] = {0.6 + 18 * uniform(seed), 0.6 + 18 * uniform(seed)};
  for (int i = 0; i < LANES; i++)
    for (int a = 0; a < 2 && uniform(seed) > 1e-3; a++) {
      m->in[a][i] = corner[a] + way * uniform(seed);
      m->in[2 + a][i] = extent[a] * (1 + 0.09 * uniform(seed));
      m->inf[a][i] = (float)m->in[a][i];
      m->inf[2 + a][i] = (float)m->in[2 + a][i];
    }
}

static void inspect(const block *m, int single, int drawn) {
  for (int i = 0; i < LANES; i++) {
    double w2 = 0;
    for (int k = 0; k < 8; k++) {
      const double x = single ? (double)m->outf[k][i] : m->out[k][i];
      if (!isfinite(x) || (k < 5 && x < 0) || (k == 4 && x > 1))
        fail_msg("lane %d, output %d, %s: %g", i, k, single ? "float" : "double", x);
      w2 += k > 4 ? x * x : 0;
    }
    const double pdf = single ? (double)m->outf[3][i] : m->out[3][i];
    if (drawn && !(pdf > 0 ? fabs(w2 - 1) < 1e-5 : w2 == 0))
      fail_msg("lane %d, %s: density %g of a draw of length %g", i, single ? "float" : "double",
               pdf, sqrt(w2));
  }
}

/* One fabric, all its tiers; returns how many answers were looked at. */
static long soak(uint64_t *seed) {
  static block m, again;
  shade_weave *weave = NULL;
  shade_fabric *f = make_fabric(seed, &weave);
  long cases = 0;
  for (int tier = 0; tier < 4; tier++) {
    fill(&m, seed);
    memset(m.out, 0, sizeof m.out);
    memset(m.outf, 0, sizeof m.outf);
    shade_fabric_lanes in = LANES_OF(m.in);
    shade_fabric_lanesf inf = LANES_OF(m.inf);
    shade_fabric_result out = RESULT_OF(m.out);
    shade_fabric_resultf outf = RESULT_OF(m.outf);
    in.size = sizeof in;
    inf.size = sizeof inf;
    out.size = sizeof out;
    outf.size = sizeof outf;
    if (tier == 0 && uniform(seed) < 0.3)
      in.random = NULL;
    const shade_fabric_tier asked = (shade_fabric_tier)tier;
    shade_fabric_eval_batch(f, LANES, &in, asked, &out);
    inspect(&m, 0, 0);
    memcpy(&again, &m, sizeof m);
    for (int i = 0; i < LANES; i += 7) { /* one call says the same */
      shade_fabric_lanes one = in;
      const double **array = (const double **)(void *)&one.u;
      for (size_t k = 0; k < ARRAYS; k++)
        array[k] += array[k] ? i : 0;
      double s[8] = {0};
      const shade_fabric_result to = {
          .size = sizeof to, .r = s, .g = s + 1, .b = s + 2, .pdf = s + 3, .coverage = s + 4};
      shade_fabric_eval_batch(f, 1, &one, asked, &to);
      for (int k = 0; k < 5; k++)
        if (fabs(s[k] - again.out[k][i]) > 1e-3 * (1e-3 + fabs(s[k])))
          fail_msg("lane %d alone: output %d is %g, in its batch %g", i, k, s[k], again.out[k][i]);
    }
    shade_fabric_eval_batchf(f, LANES, &inf, asked, &outf);
    inspect(&m, 1, 0);
    shade_fabric_sample_batch(f, LANES, &in, asked, &out);
    inspect(&m, 0, 1);
    shade_fabric_sample_batchf(f, LANES, &inf, asked, &outf);
    inspect(&m, 1, 1);
    draw_near(&m, seed);
    in.neighbours = inf.neighbours = 1;
    shade_fabric_eval_batch(f, LANES, &in, asked, &out);
    inspect(&m, 0, 0);
    shade_fabric_sample_batchf(f, LANES, &inf, asked, &outf);
    inspect(&m, 1, 1);
    cases += 6 * LANES;
  }
  shade_fabric_free(f);
  shade_weave_free(weave);
  return cases;
}

static void some_fabrics(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int k = 0; k < 60; k++)
    soak(&seed);
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(some_fabrics)};
  if (argc == 1)
    return cmocka_run_group_tests_name("fabric soak", tests, NULL, NULL);
  uint64_t seed = 1;
  double cases = 1e6, done = 0;
  for (int i = 1; i < argc; i += 2) {
    char *end = NULL;
    const double value = i + 1 < argc ? strtod(argv[i + 1], &end) : -1;
    const int known = !strcmp(argv[i], "--cases") || !strcmp(argv[i], "--seed");
    if (!known || !end || *end || !(value >= 0 && value <= 1e15)) {
      fputs("usage: fabric_soak [--cases N] [--seed N]\n", stderr);
      return 2;
    }
    if (!strcmp(argv[i], "--cases"))
      cases = value;
    else
      seed = (uint64_t)value;
  }
  while (done < cases)
    done += (double)soak(&seed);
  printf("cloth: %.3g answers, all of them numbers\n", done);
  return 0;
}
