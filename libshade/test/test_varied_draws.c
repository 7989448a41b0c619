/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 3.0 */
/*
 * Parameters of each sample, in the whole: draws against their density by chi-square, lost ones
 * included, so that the density integrates to what is drawn; the white furnace; reciprocity. The
 * lanes of a batch take turns with a few sets of parameters, each of which is judged by itself.
 */
#include <string.h>

#include "chi2.h"
#include "support.h"

#ifdef SANITIZED
enum { DRAWS = 20000, FINE = 8, EYES = 2, ROWS = 64 };
#else
enum { DRAWS = 131072, FINE = 12, EYES = 5, ROWS = 400 };
#endif
enum { SETS = 4, BATCH = 4096, EACH = BATCH / SETS };

/* What a lane may have of its own, for shade_lanes and shade_sample_lanes. */
enum { AX, AY, GX, GY, KD, F0, NUMBERS };

typedef struct lanes {
  double v[9][BATCH], u[2][BATCH], number[NUMBERS][BATCH], out[5][BATCH];
  float uf[2][BATCH], vf[9][BATCH], numberf[NUMBERS][BATCH], outf[5][BATCH];
} lanes;

/* One set: its numbers. Lane i is of set i % SETS. */
typedef double parameter_set[NUMBERS];
static const parameter_set sets[SETS] = {{0.25, 0.6, 1, 0, 0, 1},
                                         {0.6, 0.25, -3, 4, 0.5, 0.2},
                                         {0.4, 0.4, 0, -0.01, 0.1, 0.9},
                                         {0.9, 0.3, 50, 70, 0.8, 0}};

static void fill_sets(lanes *m, int matt) {
  for (int i = 0; i < BATCH; i++)
    for (int k = 0; k < NUMBERS; k++) {
      const double x = k == KD && !matt ? 0 : k == F0 && !matt ? 1 : sets[i % SETS][k];
      m->number[k][i] = x;
      m->numberf[k][i] = (float)x;
    }
}

static void fill_direction(lanes *m, int first, const double v[3]) {
  for (int c = 0; c < 3; c++)
    for (int i = 0; i < BATCH; i++)
      m->vf[first + c][i] = (float)(m->v[first + c][i] = v[c]);
}

#define OWN(numbers)                                                                               \
  .ax = numbers[AX], .ay = numbers[AY], .groove_x = numbers[GX], .groove_y = numbers[GY],          \
  .f0r = numbers[F0], .f0g = numbers[F0], .f0b = numbers[F0], .kdr = numbers[KD],                  \
  .kdg = numbers[KD], .kdb = numbers[KD]

static shade_lanes lanes_of(lanes *m) {
  return (shade_lanes){.size = sizeof(shade_lanes), SHADE_DIRECTIONS(m->v), OWN(m->number)};
}

/* Draws to v[3..5], their density to out[4]. */
static void draw(const shade_bsdf *b, lanes *m, int single) {
  if (single) {
    for (int k = 0; k < 2; k++)
      for (int i = 0; i < BATCH; i++)
        m->uf[k][i] = (float)m->u[k][i];
    const shade_sample_lanesf in = {.size = sizeof in,
                                    .nx = m->vf[0],
                                    .ny = m->vf[1],
                                    .nz = m->vf[2],
                                    .wox = m->vf[6],
                                    .woy = m->vf[7],
                                    .woz = m->vf[8],
                                    .u1 = m->uf[0],
                                    .u2 = m->uf[1],
                                    OWN(m->numberf)};
    const shade_sample_resultf to = {sizeof to,  m->vf[3],   m->vf[4],   m->vf[5],  m->outf[0],
                                     m->outf[1], m->outf[2], m->outf[4], m->outf[3]};
    shade_bsdf_sample_batchf(b, BATCH, &in, &to);
    for (int i = 0; i < BATCH; i++) {
      for (int c = 3; c < 6; c++)
        m->v[c][i] = (double)m->vf[c][i];
      m->out[4][i] = (double)m->outf[4][i];
    }
    return;
  }
  const shade_sample_lanes in = {.size = sizeof in,
                                 .nx = m->v[0],
                                 .ny = m->v[1],
                                 .nz = m->v[2],
                                 .wox = m->v[6],
                                 .woy = m->v[7],
                                 .woz = m->v[8],
                                 .u1 = m->u[0],
                                 .u2 = m->u[1],
                                 OWN(m->number)};
  const shade_sample_result to = {sizeof to, m->v[3],   m->v[4],   m->v[5],  m->out[0],
                                  m->out[1], m->out[2], m->out[4], m->out[3]};
  shade_bsdf_sample_batch(b, BATCH, &in, &to);
}

/* The density of every set over the bins. */
static void integrate(const shade_bsdf *b, lanes *m, double expected[SETS][BINS]) {
  const shade_lanes in = lanes_of(m);
  const double area = 2 * PI / ((double)BINS * FINE * FINE);
  memset(expected, 0, SETS * sizeof *expected);
  for (int bin = 0; bin < BINS; bin++) {
    for (int i = 0; i < FINE * FINE * SETS; i++) {
      double w[3];
      bin_point(bin, i / SETS, FINE, w);
      for (int c = 0; c < 3; c++)
        m->v[3 + c][i] = w[c];
    }
    shade_bsdf_pdf_batch(b, FINE * FINE * SETS, &in, m->out[4]);
    for (int i = 0; i < FINE * FINE * SETS; i++)
      expected[i % SETS][bin] += m->out[4][i] * area;
  }
}

static void histogram(const shade_bsdf *b, lanes *m, int single, uint64_t *seed,
                      long counts[SETS][BINS], long lost[SETS]) {
  memset(counts, 0, SETS * sizeof *counts);
  memset(lost, 0, SETS * sizeof *lost);
  for (long done = 0; done < DRAWS; done += EACH) {
    for (int k = 0; k < 2; k++)
      for (int i = 0; i < BATCH; i++)
        m->u[k][i] = uniform(seed);
    draw(b, m, single);
    for (int i = 0; i < BATCH && done + i / SETS < DRAWS; i++)
      if (m->out[4][i] > 0)
        counts[i % SETS][bin_of(m->v[3][i], m->v[4][i], m->v[5][i])]++;
      else
        lost[i % SETS]++;
  }
}

typedef struct example {
  shade_mdf mdf;
  shade_brdf brdf;
  shade_detail detail;
  shade_horizon horizon;
  int matt, single;
  shade_diffuse diffuse;
} example;
#define EXAMPLE(mdf, brdf, detail, horizon, matt, single, diffuse)                                 \
  {                                                                                                \
    SHADE_MDF_##mdf, SHADE_BRDF_##brdf, SHADE_DETAIL_##detail, SHADE_HORIZON_##horizon, matt,      \
        single, SHADE_DIFFUSE_##diffuse                                                            \
  }
static const example examples[] = {
    EXAMPLE(ASHIKHMIN_SHIRLEY, ASHIKHMIN_SHIRLEY, ROTATE, HARD, 0, 0, LAMBERT),
    EXAMPLE(ASHIKHMIN_SHIRLEY, ASHIKHMIN_SHIRLEY, PERTURB, VALID_ESTEVEZ, 1, 1, FIBRE_VIEW),
    EXAMPLE(WARD, WARD_BOUNDED, AUTO, HARD, 1, 0, LAMBERT),
    EXAMPLE(WARD_HALF, WARD_BOUNDED, DEFORM_SMOOTH, HARD, 0, 1, LAMBERT),
    EXAMPLE(BECKMANN, MICROFACET, ROTATE, VALID_ESTEVEZ, 0, 0, LAMBERT),
    EXAMPLE(BECKMANN, MICROFACET, GRAM_SCHMIDT, HARD, 1, 1, ASHIKHMIN_SHIRLEY),
    EXAMPLE(BECKMANN, ASHIKHMIN_SHIRLEY, PERTURB, HARD, 0, 0, LAMBERT),
    EXAMPLE(GGX, MICROFACET, AUTO, VALID_ESTEVEZ, 1, 0, FIBRE),
    EXAMPLE(GGX, MICROFACET, NONE, HARD, 0, 1, LAMBERT),
    EXAMPLE(GGX, MICROFACET, SHORTEST_ARC, SCHUESSLER, 0, 0, LAMBERT),
    EXAMPLE(GGX, MICROFACET, ROTATE_APPROXIMATE, CHIANG, 1, 1, MAX_NORMAL),
    EXAMPLE(GGX, MICROFACET, DEFORM_LINEAR_CONSERVING, HARD, 0, 0, LAMBERT)};
enum { EXAMPLES = sizeof examples / sizeof examples[0] };

static shade_params params_of(const example *e) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_alphas(&p, 0.2, 0.2); /* which no lane has */
  p.mdf = e->mdf;
  p.brdf = e->brdf;
  p.detail = e->detail;
  p.horizon = e->horizon;
  p.diffuse = e->diffuse;
  return p;
}

/* All hypotheses together at the level 1%, as test_sample.c has it. */
static void draws_have_their_density(void **state) {
  (void)state;
  static lanes m;
  static double expected[SETS][BINS];
  static long counts[SETS][BINS];
  long lost[SETS];
  double least = 1;
  int cases = 0, worst = 0;
  uint64_t seed = 21;
  for (int e = 0; e < EXAMPLES; e++) {
    const shade_params p = params_of(&examples[e]);
    shade_bsdf b;
    assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
    /* facets: the pdf steps where light begins to face the mirror, on the border of two bins */
    const double azimuth = 0.2 * PI * (e + 1), z[3] = {0, 0, 1};
    double n[3], wo[3];
    spherical(0.3 + 0.1 * (e % 3), azimuth, n);
    spherical(0.9, azimuth + 1.1, wo);
    fill_sets(&m, examples[e].matt);
    fill_direction(&m, 0, examples[e].detail == SHADE_DETAIL_NONE ? z : n);
    fill_direction(&m, 6, wo);
    integrate(&b, &m, expected);
    histogram(&b, &m, examples[e].single, &seed, counts, lost);
    for (int k = 0; k < SETS; k++, cases++) {
      const double q = chi2(DRAWS, expected[k], counts[k], lost[k]);
      if (q < least) {
        least = q;
        worst = cases;
      }
    }
  }
  const double together = 1 - pow(1 - least, cases);
  print_message("%d cases of %d draws, least p %.2g (example %d, set %d), together %.2g\n", cases,
                (int)DRAWS, least, worst / SETS, worst % SETS, together);
  assert_true(together > 0.01);
}

/* f cos of every set over the hemisphere, by midpoints. */
static void albedos(const shade_bsdf *b, lanes *m, double albedo[SETS]) {
  const shade_lanes in = lanes_of(m);
  const shade_result out = {sizeof out, m->out[0], m->out[1], m->out[2], m->out[3]};
  memset(albedo, 0, SETS * sizeof *albedo);
  for (int row = 0; row < ROWS; row++)
    for (int start = 0; start < 2 * ROWS; start += EACH) {
      const int count = 2 * ROWS - start < EACH ? 2 * ROWS - start : EACH;
      for (int i = 0; i < count * SETS; i++) {
        const double phi = PI * (start + i / SETS + 0.5) / ROWS, z = (row + 0.5) / ROWS;
        const double s = sqrt(1 - z * z);
        m->v[3][i] = s * cos(phi), m->v[4][i] = s * sin(phi), m->v[5][i] = z;
      }
      shade_bsdf_eval_batch(b, (size_t)(count * SETS), &in, &out);
      for (int i = 0; i < count * SETS; i++)
        albedo[i % SETS] += m->out[0][i] * m->out[3][i] * PI / ((double)ROWS * ROWS);
    }
}

/* White lobes that promise it reflect no more than they get, at every set of parameters. */
static void white_furnace(void **state) {
  (void)state;
  static lanes m;
  const struct {
    shade_mdf mdf;
    shade_brdf brdf;
  } models[] = {{SHADE_MDF_ASHIKHMIN_SHIRLEY, SHADE_BRDF_ASHIKHMIN_SHIRLEY},
                {SHADE_MDF_BECKMANN, SHADE_BRDF_MICROFACET},
                {SHADE_MDF_GGX, SHADE_BRDF_MICROFACET},
                {SHADE_MDF_WARD, SHADE_BRDF_WARD_BOUNDED}};
  const double eyes[] = {1.3, 0.6, 0.2, 1.0, 1.5};
  double most = 0, least = 1;
  fill_sets(&m, 0);
  for (int k = 0; k < 4; k++)
    for (int tilt = 0; tilt < 2; tilt++)
      for (int eye = 0; eye < EYES; eye++) {
        shade_params p;
        shade_bsdf b;
        double n[3], wo[3], albedo[SETS];
        shade_params_init(&p);
        p.mdf = models[k].mdf;
        p.brdf = models[k].brdf;
        p.fresnel = SHADE_FRESNEL_NONE;
        p.f0[0] = p.f0[1] = p.f0[2] = 0.1; /* the lanes' is 1 */
        shade_bsdf_setup(&b, &p);
        spherical(0.5 * tilt, 1, n);
        spherical(eyes[eye], 2.5, wo);
        fill_direction(&m, 0, n);
        fill_direction(&m, 6, wo);
        albedos(&b, &m, albedo);
        for (int s = 0; s < SETS; s++) {
          most = fmax(most, albedo[s]);
          least = fmin(least, albedo[s]);
        }
      }
  print_message("albedo of white lobes: %.3f to %.4f\n", least, most);
  assert_true(most <= 1 + 1e-3 && most > 0.9 && least > 0.1);
}

/* Light and eye in each other's place, where the model promises it. */
static void reciprocity(void **state) {
  (void)state;
  static lanes m, other;
  uint64_t seed = 3;
  double worst = 0;
  for (int k = 0; k < 200; k++) {
    shade_params p;
    shade_bsdf b;
    shade_params_init(&p);
    p.mdf = (shade_mdf)(k % SHADE_MDF_COUNT);
    p.brdf = (shade_brdf)(uniform(&seed) * SHADE_BRDF_COUNT);
    p.detail = (shade_detail)(uniform(&seed) * SHADE_DETAIL_COUNT);
    p.fresnel = (shade_fresnel)(uniform(&seed) * SHADE_FRESNEL_COUNT);
    p.horizon = uniform(&seed) < 0.5 ? SHADE_HORIZON_HARD : SHADE_HORIZON_SCHUESSLER;
    p.diffuse = SHADE_DIFFUSE_LAMBERT;
    shade_bsdf_setup(&b, &p);
    fill_sets(&m, k % 2);
    for (int i = 0; i < BATCH; i++) {
      for (int d = 0; d < 9; d += 3) {
        double v[3];
        spherical(1.4 * uniform(&seed) * (d ? 1 : 0.6), 2 * PI * uniform(&seed), v);
        for (int c = 0; c < 3; c++)
          m.v[d + c][i] = v[c];
      }
      for (int c = 0; c < 9; c++)
        other.v[c < 3 ? c : c < 6 ? c + 3 : c - 3][i] = m.v[c][i];
      for (int c = 0; c < NUMBERS; c++)
        other.number[c][i] = m.number[c][i];
    }
    const shade_lanes there = lanes_of(&m), back = lanes_of(&other);
    const shade_result to = {sizeof to, m.out[0], m.out[1], m.out[2], m.out[3]};
    const shade_result from = {sizeof from, other.out[0], other.out[1], other.out[2], other.out[3]};
    assert_int_equal(shade_bsdf_eval_batch(&b, BATCH, &there, &to), SHADE_OK);
    assert_int_equal(shade_bsdf_eval_batch(&b, BATCH, &back, &from), SHADE_OK);
    for (int i = 0; i < BATCH; i++)
      for (int c = 0; c < 3; c++)
        worst = fmax(worst, fabs(m.out[c][i] - other.out[c][i]) / (m.out[c][i] + 1));
  }
  print_message("reciprocity: %.1e\n", worst);
  assert_true(worst <= 1e-10);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(draws_have_their_density),
                                     cmocka_unit_test(white_furnace),
                                     cmocka_unit_test(reciprocity)};
  return cmocka_run_group_tests_name("varied_draws", tests, NULL, NULL);
}
