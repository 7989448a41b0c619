/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 5.6 */
/*
 * Single calls and batches of each instruction set agree on every finite input: f cos, the density
 * and D to 1e-3 of themselves or of 1, whichever is more, and what had to be mended to the bit.
 * Directions have any length that their type can hold, lie along axes, graze the surface by less
 * than any cosine has digits, are opposite to one another or nearly so, point down. Where
 * roundings cannot be all of the answer, the reference says which one is right.
 *
 * Without arguments a million samples, every combination of distribution, BRDF, method, horizon and
 * Fresnel; `make soak` takes more. See --help.
 */
#include <float.h>
#include <string.h>

#include "support.h"

#ifdef SANITIZED
enum { LANES = 20 };
#else
enum { LANES = 80 };
#endif
enum { DIRECTIONS = 9, ANSWERS = 6 };
enum { FCOS, COSINE = 3, PDF, D };
enum {
  COMBINATIONS = SHADE_MDF_COUNT * SHADE_BRDF_COUNT * SHADE_DETAIL_COUNT * SHADE_HORIZON_COUNT *
                 SHADE_FRESNEL_COUNT
};
static const char *const answer_names[ANSWERS] = {"f cos, red", "f cos, green", "f cos, blue",
                                                  "cosine",     "pdf",          "D"};

/* A block of samples of one material; those of floats are exact in double too. */
typedef struct block {
  shade_params params;
  shade_bsdf bsdf;
  int single; /* in floats */
  double v[LANES][DIRECTIONS];
  double one[ANSWERS][LANES], all[ANSWERS][LANES];
  unsigned one_status[3], all_status[3]; /* f, pdf, D: the or of all lanes */
} block;

static struct {
  uint64_t seed, compared, referred, told, failed;
  double worst[ANSWERS], worst_reference[2][2]; /* of f cos and pdf, in double and float */
} run;

/* ---- input ---- */

static int chance(double p) {
  return uniform(&run.seed) < p;
}

static double between(double low, double high) {
  return low + (high - low) * uniform(&run.seed);
}

static double either(double x) {
  return chance(0.5) ? x : -x;
}

/* A size that the type holds: as large as 1e38 or 1e300, down to the subnormals. */
static double length(int single) {
  if (chance(0.1))
    return single ? pow(10, between(-45, -37)) : pow(10, between(-323, -307));
  return single ? pow(10, between(-38, 38)) : pow(10, between(-300, 300));
}

static double small(int single) {
  return pow(10, between(chance(0.5) ? -4 : single ? -45 : -320, 0));
}

static void set(double v[3], double x, double y, double z) {
  v[0] = x, v[1] = y, v[2] = z;
}

static void on_sphere(double v[3]) {
  spherical(acos(between(-1, 1)), between(0, 2 * PI), v);
}

static void direction(int single, double v[3]) {
  on_sphere(v);
  switch ((int)between(0, 12)) {
  default:
    v[2] = fabs(v[2]);
    break;
  case 0:
    break;
  case 1: /* along an axis */
    set(v, 0, 0, 0);
    v[(int)between(0, 3)] = either(1);
    break;
  case 2: /* grazing */
    v[2] = chance(0.8) ? small(single) : -small(single);
    break;
  case 3:
    v[2] = chance(0.5) ? 0.0 : -0.0;
    break;
  case 4: /* of components that have nothing to do with one another */
    for (int c = 0; c < 3; c++)
      v[c] = either(small(single));
    v[2] = fabs(v[2]);
    break;
  case 5: /* along y, where groove transport ends, or x */
    set(v, either(small(single)), either(1), small(single));
    if (chance(0.3))
      set(v, v[1], v[0], v[2]);
    break;
  case 6: /* along z */
    set(v, either(small(single)), either(small(single)), 1);
    break;
  case 7: /* in the plane of a tangent */
    v[chance(0.5)] = 0;
    v[2] = fabs(v[2]);
    break;
  }
}

/* v scaled, in the numbers of the type. */
static void settle(int single, double v[3]) {
  const double most = single ? (double)FLT_MAX : DBL_MAX, by = chance(0.7) ? 1 : length(single);
  for (int c = 0; c < 3; c++) {
    v[c] = fmin(fmax(v[c] * by, -most), most);
    v[c] = single ? (double)(float)v[c] : v[c];
  }
}

static void mirrored(const double n[3], const double from[3], double to[3]) {
  const double d = n[0] * from[0] + n[1] * from[1] + n[2] * from[2];
  for (int c = 0; c < 3; c++)
    to[c] = 2 * d * n[c] - from[c];
}

/* n, wi and wo; D takes wi for h. */
static void directions(int single, double v[DIRECTIONS]) {
  double *n = v, *wi = v + 3, *wo = v + 6;
  const double z[3] = {0, 0, 1};
  for (int k = 0; k < DIRECTIONS; k += 3)
    direction(single, v + k);
  switch (chance(0.5) ? (int)between(0, 9) : 9) {
  case 0:
    memcpy(wo, wi, 3 * sizeof *wo);
    break;
  case 1: /* opposite, or nearly so */
    for (int c = 0; c < 3; c++)
      wo[c] = -wi[c] + (chance(0.7) ? either(small(single)) : 0);
    break;
  case 2: /* the half vector along n, and along z */
    mirrored(n, wi, wo);
    break;
  case 3:
    mirrored(z, wi, wo);
    break;
  case 4: /* close to n, or opposite to it */
    for (int c = 0; c < 3; c++)
      wi[c] = n[c] + either(small(single));
    break;
  case 5:
    set(wi, -n[0], -n[1], -n[2]);
    break;
  case 6:
    memcpy(n, z, sizeof z);
    break;
  case 7: /* along the horizon of n */
    for (int c = 0; c < 3; c++)
      wo[c] -= n[c] * (n[0] * wo[0] + n[1] * wo[1] + n[2] * wo[2]);
    break;
  case 8:
    set(n, either(small(single)), either(small(single)), -1);
    break;
  default:
    break;
  }
  for (int k = 0; k < DIRECTIONS; k += 3)
    settle(single, v + k);
}

/* Choice `k` of `count`, and what remains of a number that counts through all combinations. */
static int digit(uint64_t *rest, int count) {
  const int k = (int)(*rest % (uint64_t)count);
  *rest /= (uint64_t)count;
  return k;
}

static void fill(block *b, uint64_t number, int single) {
  shade_params *p = &b->params;
  shade_params_init(p);
  p->mdf = (shade_mdf)digit(&number, SHADE_MDF_COUNT);
  p->brdf = (shade_brdf)digit(&number, SHADE_BRDF_COUNT);
  p->detail = (shade_detail)digit(&number, SHADE_DETAIL_COUNT);
  p->horizon = (shade_horizon)digit(&number, SHADE_HORIZON_COUNT);
  p->fresnel = (shade_fresnel)digit(&number, SHADE_FRESNEL_COUNT);
  p->diffuse = (shade_diffuse)between(0, SHADE_DIFFUSE_COUNT);
  p->groove = (shade_groove)between(0, SHADE_GROOVE_COUNT);
  if (chance(0.5))
    shade_params_set_alphas(p, pow(10, between(-4, 1)), pow(10, between(-4, 1)));
  else
    shade_params_set_exponents(p, pow(10, between(-1, 6)), pow(10, between(-1, 3)));
  if (chance(0.2))
    shade_params_set_alphas(p, p->ax, p->ax);
  const int matt = chance(0.5);
  for (int c = 0; c < 3; c++) {
    p->f0[c] = uniform(&run.seed);
    p->f82[c] = uniform(&run.seed);
    p->eta[c] = between(0.1, 4);
    p->k[c] = between(0, 4);
    p->kd[c] = matt ? uniform(&run.seed) : 0;
  }
  assert_int_equal(shade_bsdf_setup(&b->bsdf, p), SHADE_OK);
  b->single = single;
  for (int i = 0; i < LANES; i++)
    directions(single, b->v[i]);
}

/* ---- calls ---- */

#define CALLS(real, f)                                                                             \
  static void call_##real(block *b, const shade_isa_table *isa) {                                  \
    real v[DIRECTIONS][LANES], out[4][LANES], pdf[LANES], d[LANES];                                \
    memset(b->one_status, 0, sizeof b->one_status);                                                \
    for (int i = 0; i < LANES; i++) {                                                              \
      real w[DIRECTIONS], one[3], cosine, q, lobe;                                                 \
      for (int c = 0; c < DIRECTIONS; c++)                                                         \
        v[c][i] = w[c] = (real)b->v[i][c];                                                         \
      b->one_status[0] |= isa->entries##f->bsdf(&b->bsdf, w, w + 3, w + 6, one, &cosine);          \
      b->one_status[1] |= isa->entries##f->pdf(&b->bsdf, w, w + 3, w + 6, &q);                     \
      b->one_status[2] |= isa->entries##f->mdf(&b->bsdf, w, w + 3, &lobe);                         \
      for (int c = 0; c < 3; c++)                                                                  \
        b->one[FCOS + c][i] = (double)one[c] * (double)cosine;                                     \
      b->one[COSINE][i] = (double)cosine;                                                          \
      b->one[PDF][i] = (double)q;                                                                  \
      b->one[D][i] = (double)lobe;                                                                 \
    }                                                                                              \
    const shade_lanes##f in = {.size = sizeof in, SHADE_DIRECTIONS(v)};                            \
    const shade_result##f to = {sizeof to, out[0], out[1], out[2], out[3]};                        \
    b->all_status[0] = isa->entries##f->bsdf_batch(&b->bsdf, LANES, &in, &to);                     \
    b->all_status[1] = isa->entries##f->pdf_batch(&b->bsdf, LANES, &in, pdf);                      \
    b->all_status[2] =                                                                             \
        isa->entries##f->mdf_batch(&b->bsdf, LANES, v[0], v[1], v[2], v[3], v[4], v[5], d);        \
    for (int i = 0; i < LANES; i++) {                                                              \
      for (int c = 0; c < 3; c++)                                                                  \
        b->all[FCOS + c][i] = (double)out[c][i] * (double)out[3][i];                               \
      b->all[COSINE][i] = (double)out[3][i];                                                       \
      b->all[PDF][i] = (double)pdf[i];                                                             \
      b->all[D][i] = (double)d[i];                                                                 \
    }                                                                                              \
  }
CALLS(double, )
CALLS(float, f)

/* ---- what comes out ---- */

static void tell(const block *b, const char *isa, const char *what, int i, double got,
                 double want) {
  run.failed++;
  if (run.told++ >= 12)
    return;
  char json[2048];
  shade_params_json(&b->params, 0, NULL, json, sizeof json);
  print_message("%s, %s, %s: %.9g for %.9g\n  %s\n ", what, b->single ? "float" : "double", isa,
                got, want, json);
  for (int c = 0; c < DIRECTIONS; c++)
    print_message(" %.17g", b->v[i][c]);
  print_message("\n");
}

/* 0 where both are the same, 1e-3 at the bound; what is not finite is as far off as can be. */
static double apart(double got, double want) {
  return isfinite(got) && isfinite(want) ? fabs(got - want) / fmax(1, fabs(want)) : INFINITY;
}

static void compare(const block *b, const char *isa) {
  for (int i = 0; i < LANES; i++)
    for (int a = 0; a < ANSWERS; a++) {
      const double off = apart(b->one[a][i], b->all[a][i]);
      run.worst[a] = fmax(run.worst[a], off);
      if (!(off <= 1e-3))
        tell(b, isa, answer_names[a], i, b->one[a][i], b->all[a][i]);
    }
  for (int q = 0; q < 3; q++)
    if (b->one_status[q] != b->all_status[q])
      tell(b, isa, "status", 0, b->one_status[q], b->all_status[q]);
  run.compared += LANES;
}

static void unit(const double from[3], double to[3]) {
  const long double x = from[0], y = from[1], z = from[2], size = hypotl(hypotl(x, y), z);
  to[0] = size > 0 ? (double)(x / size) : 0;
  to[1] = size > 0 ? (double)(y / size) : 0;
  to[2] = size > 0 ? (double)(z / size) : 0;
}

/*
 * Light and eye well above both horizons, h above the carried one, nothing at a pole where its
 * azimuth jumps, nor where light begins to face the mirror of two facets, which draws know:
 * roundings are small there.
 */
static int well_posed(const shade_params *p, const double v[DIRECTIONS]) {
  double n[3], h[3], m[3];
  if (!(v[2] > 0.1 && v[5] > 0.05 && v[8] > 0.05 && least_cosine(p, v) > 0.05))
    return 0;
  shade_ref_normal(p, v, v + 6, n);
  for (int c = 0; c < 3; c++)
    h[c] = v[3 + c] + v[6 + c];
  const double length = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
  if (!(length > 0.1))
    return 0;
  for (int c = 0; c < 3; c++)
    h[c] /= length;
  shade_ref_carried(p, n, h, m);
  const double aside =
      fmin(fmin(hypot(v[3], v[4]), hypot(v[6], v[7])), fmin(hypot(h[0], h[1]), hypot(m[0], m[1])));
  if (p->horizon == SHADE_HORIZON_SCHUESSLER &&
      !(fabs(n[0] * v[3] + n[1] * v[4]) > 1e-3 * hypot(n[0], n[1])))
    return 0;
  return m[2] > 0.5 && aside > 0.05;
}

static void refer_to(const block *b, const char *isa, int q, int i, const char *what, double want) {
  double *worst = &run.worst_reference[b->single][q == PDF];
  const double off = apart(b->one[q][i], want);
  *worst = fmax(*worst, off);
  if (!(off <= (b->single ? 1e-3 : 1e-9)))
    tell(b, isa, what, i, b->one[q][i], want);
}

/*
 * Whether the answers are those of the reference: of some lanes, of lobes that are not too narrow.
 * Made unit first, for the reference takes warps' directions as they are where they are nearly so.
 */
static void refer(const block *b, const char *isa) {
  const shade_params *p = &b->params;
  if (fmin(p->ax, p->ay) < 0.05)
    return;
  for (int i = 0; i < LANES; i += 4) {
    double v[DIRECTIONS], f[3], cosine;
    for (int k = 0; k < DIRECTIONS; k += 3)
      unit(b->v[i] + k, v + k);
    if (!well_posed(p, v))
      continue;
    shade_ref_f(p, v, v + 3, v + 6, f, &cosine);
    for (int c = 0; c < 3; c++)
      refer_to(b, isa, FCOS + c, i, "f cos beside the reference", f[c] * cosine);
    refer_to(b, isa, PDF, i, "pdf beside the reference", shade_ref_pdf(p, v, v + 3, v + 6));
    run.referred++;
  }
}

static void hostile(uint64_t samples) {
  static block b;
  const shade_isa_table *isa;
  for (uint64_t k = 0; k < samples / LANES; k++) {
    fill(&b, k % COMBINATIONS, (int)((k + k / COMBINATIONS) & 1));
    for (int row = 0; (isa = shade_isa_pick(row)); row++) {
      (b.single ? call_float : call_double)(&b, isa);
      compare(&b, isa->name);
      if (row == (int)(k / 2 % 4))
        refer(&b, isa->name);
    }
  }
  print_message("%llu samples; single and batch apart at most:", (unsigned long long)run.compared);
  for (int a = 0; a < ANSWERS; a++)
    print_message(" %s %.1e", answer_names[a], run.worst[a]);
  print_message("\n%llu beside the reference: f cos %.1e, pdf %.1e; in float %.1e, %.1e\n",
                (unsigned long long)run.referred, run.worst_reference[0][0],
                run.worst_reference[0][1], run.worst_reference[1][0], run.worst_reference[1][1]);
}

static void single_and_batch_agree(void **state) {
  (void)state;
  hostile(2 * COMBINATIONS * LANES);
  assert_true(run.compared >= 13200 * LANES && run.referred >= 25 * LANES);
  assert_int_equal(run.failed, 0);
}

static int usage(FILE *to, int status) {
  fputs("usage: hostile [--samples N] [--seed N]\n\n"
        "Compares single calls with batches of hostile finite input, every instruction set.\n"
        "Without options: the test of make check, a million samples.\n",
        to);
  return status;
}

int main(int argc, char **argv) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(single_and_batch_agree)};
  unsigned long long samples = 10000000;
  if (argc == 1)
    return cmocka_run_group_tests_name("hostile", tests, NULL, NULL);
  for (int i = 1; i < argc; i += 2) {
    char *end = NULL;
    const unsigned long long value = i + 1 < argc ? strtoull(argv[i + 1], &end, 10) : 0;
    if (!strcmp(argv[i], "--help"))
      return usage(stdout, 0);
    if (!end || end == argv[i + 1] || *end || argv[i + 1][0] == '-')
      return usage(stderr, 2);
    if (!strcmp(argv[i], "--samples"))
      samples = value;
    else if (!strcmp(argv[i], "--seed"))
      run.seed = value;
    else
      return usage(stderr, 2);
  }
  hostile(samples);
  print_message("%llu failures\n", (unsigned long long)run.failed);
  return run.failed > 0;
}
