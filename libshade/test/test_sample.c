/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 19 */
/*
 * Sampling against its own density by chi-square, for every distribution through every detail
 * method and tilted normals. 10^6 draws a case; fewer under a sanitizer, which is slow.
 */
#include <string.h>

#include "chi2.h"
#include "support.h"

#ifdef SANITIZED
enum { DRAWS = 20000, FINE = 8, FINER = 8 };
#else
enum { DRAWS = 500000, FINE = 16, FINER = 40 };
#endif

enum { BATCH = 4096 };

/* Room for a batch; the results of either precision are read as double. */
typedef struct lanes {
  double in[8][BATCH], out[8][BATCH], pdf[BATCH];
} lanes;

static unsigned draw(const shade_bsdf *b, lanes *m, size_t count) {
  const shade_sample_lanes in = {.size = sizeof in,
                                 .nx = m->in[0],
                                 .ny = m->in[1],
                                 .nz = m->in[2],
                                 .wox = m->in[3],
                                 .woy = m->in[4],
                                 .woz = m->in[5],
                                 .u1 = m->in[6],
                                 .u2 = m->in[7]};
  const shade_sample_result out = {sizeof out, m->out[0], m->out[1], m->out[2], m->out[3],
                                   m->out[4],  m->out[5], m->out[6], m->out[7]};
  return shade_bsdf_sample_batch(b, count, &in, &out);
}

static unsigned drawf(const shade_bsdf *b, lanes *m, size_t count) {
  static float in[8][BATCH], out[8][BATCH];
  for (int k = 0; k < 8; k++)
    for (size_t i = 0; i < count; i++)
      in[k][i] = (float)m->in[k][i];
  const shade_sample_lanesf lanes = {.size = sizeof lanes,
                                     .nx = in[0],
                                     .ny = in[1],
                                     .nz = in[2],
                                     .wox = in[3],
                                     .woy = in[4],
                                     .woz = in[5],
                                     .u1 = in[6],
                                     .u2 = in[7]};
  const shade_sample_resultf result = {sizeof result, out[0], out[1], out[2], out[3],
                                       out[4],        out[5], out[6], out[7]};
  unsigned status = shade_bsdf_sample_batchf(b, count, &lanes, &result);
  for (int k = 0; k < 8; k++)
    for (size_t i = 0; i < count; i++)
      m->out[k][i] = (double)out[k][i];
  return status;
}

static void fill(lanes *m, int first, const double v[3]) {
  for (int c = 0; c < 3; c++)
    for (size_t i = 0; i < BATCH; i++)
      m->in[first + c][i] = v[c];
}

/* The integral of the pdf over each bin (cos theta, phi) of the upper hemisphere, by midpoints. */
static void integrate(const shade_bsdf *b, const double n[3], const double wo[3], lanes *m,
                      int fine, double expected[BINS]) {
  fill(m, 0, n);
  fill(m, 3, wo);
  const shade_lanes in = {.size = sizeof in,
                          .nx = m->in[0],
                          .ny = m->in[1],
                          .nz = m->in[2],
                          .wix = m->out[0],
                          .wiy = m->out[1],
                          .wiz = m->out[2],
                          .wox = m->in[3],
                          .woy = m->in[4],
                          .woz = m->in[5]};
  const double area = 2 * PI / ((double)BINS * fine * fine);
  for (int bin = 0; bin < BINS; bin++) {
    for (int k = 0; k < fine * fine; k++) {
      double w[3];
      bin_point(bin, k, fine, w);
      for (int c = 0; c < 3; c++)
        m->out[c][k] = w[c];
    }
    shade_bsdf_pdf_batch(b, (size_t)(fine * fine), &in, m->pdf);
    double sum = 0;
    for (int k = 0; k < fine * fine; k++)
      sum += m->pdf[k];
    expected[bin] = sum * area;
  }
}

/* Draws counted in the same bins; returns how many found no direction. */
static long histogram(const shade_bsdf *b, const double n[3], const double wo[3], lanes *m,
                      int single, uint64_t *seed, long counts[BINS]) {
  long lost = 0;
  memset(counts, 0, BINS * sizeof *counts);
  fill(m, 0, n);
  fill(m, 3, wo);
  for (long done = 0; done < DRAWS; done += BATCH) {
    size_t count = (size_t)(DRAWS - done < BATCH ? DRAWS - done : BATCH);
    for (size_t i = 0; i < count; i++) {
      m->in[6][i] = uniform(seed);
      m->in[7][i] = uniform(seed);
    }
    (single ? drawf : draw)(b, m, count);
    for (size_t i = 0; i < count; i++) {
      double x = m->out[0][i], y = m->out[1][i], z = m->out[2][i];
      if (m->out[6][i] == 0) {
        assert_true(x == 0 && y == 0 && z == 0 && m->out[3][i] == 0);
        lost++;
        continue;
      }
      assert_true(m->out[6][i] > 0 && isfinite(m->out[6][i]) && z > 0);
      counts[bin_of(x, y, z)]++;
    }
  }
  return lost;
}

/* ---- the cases -------------------------------------------------------------- */

enum { NORMALS = 5 };

/* Tilts of 0, 20, 45 and 70 degrees, and n -> y (or x), where the frame of rotate gives out. */
static void normal_of(int k, int sign, double n[3]) {
  const double tilt[] = {0, 20, 45, 70}, azimuth[] = {0, 0.7, 2.5, 4.1};
  if (k < 4)
    spherical(tilt[k] * PI / 180, azimuth[k], n);
  else {
    n[0] = 1e-10;
    n[1] = sign;
    n[2] = 2e-10;
  }
}

/* An eye that sees n from the side and is above both horizons. */
static void eye_of(const double n[3], double wo[3]) {
  const double by[] = {-0.3, 0.1, 0.5};
  double length = 0;
  for (int c = 0; c < 3; c++) {
    wo[c] = n[c] + by[c];
    length += wo[c] * wo[c];
  }
  for (int c = 0; c < 3; c++)
    wo[c] /= sqrt(length);
}

static shade_bsdf material(int mdf, int brdf, int detail, double ex, double ey, double kd,
                           int diffuse) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, ex, ey);
  p.mdf = (shade_mdf)mdf;
  p.brdf = (shade_brdf)brdf;
  p.detail = (shade_detail)detail;
  p.diffuse = (shade_diffuse)diffuse;
  p.horizon = SHADE_HORIZON_HARD;
  for (int c = 0; c < 3; c++) {
    p.f0[c] = kd > 0 ? 0.3 : 1;
    p.kd[c] = kd;
  }
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  return b;
}

typedef struct verdict {
  int cases;
  double least;
  char worst[128];
} verdict;

static void judge_at(const shade_bsdf *b, const double n[3], const double wo[3], int fine,
                     int single, uint64_t *seed, const char *where, verdict *v) {
  static lanes m;
  static double expected[BINS];
  static long counts[BINS];
  integrate(b, n, wo, &m, fine, expected);
  long lost = histogram(b, n, wo, &m, single, seed, counts);
  double p = chi2(DRAWS, expected, counts, lost);
  v->cases++;
  if (p < v->least) {
    v->least = p;
    snprintf(v->worst, sizeof v->worst, "%s %s %s, %s",
             shade_list_word(SHADE_LIST_MDF, (int)bsdf_of(b)->mdf),
             shade_list_word(SHADE_LIST_BRDF, (int)bsdf_of(b)->brdf),
             shade_list_word(SHADE_LIST_DETAIL, (int)bsdf_of(b)->detail), where);
  }
}

static void judge(const shade_bsdf *b, int k, int sign, int single, uint64_t *seed, verdict *v) {
  const char *const where[NORMALS] = {"normal 0", "normal 1", "normal 2", "normal 3", "normal 4"};
  double n[3], wo[3];
  normal_of(k, sign, n);
  eye_of(n, wo);
  judge_at(b, n, wo, FINE, single, seed, where[k], v);
}

/* All null hypotheses together at the level 1%: 1 - (1 - least)^cases (Sidak). */
static void conclude(const char *what, const verdict *v) {
  double together = 1 - pow(1 - v->least, v->cases);
  print_message("%s: %d cases of %d draws, least p %.2g (%s), together %.2g\n", what, v->cases,
                (int)DRAWS, v->least, v->worst, together);
  assert_true(together > 0.01);
}

/* Every distribution x method x normal; microfacet too, where visible normals are drawn. */
static void chi2_lobes(void **state) {
  (void)state;
  uint64_t seed = 2;
  verdict v = {0, 1, ""};
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int detail = 0; detail < SHADE_DETAIL_COUNT; detail++)
      for (int k = 0; k < NORMALS; k++) {
        if (detail == SHADE_DETAIL_AUTO)
          continue;
        shade_bsdf b = material(mdf, SHADE_BRDF_ASHIKHMIN_SHIRLEY, detail, 40, 6, 0, 0);
        judge(&b, k, detail & 1 ? 1 : -1, 0, &seed, &v);
        b = material(mdf, SHADE_BRDF_MICROFACET, detail, 6, 40, 0, 0); /* grooves along y */
        if (bsdf_of(&b)->visible)
          judge(&b, k, 1, 0, &seed, &v);
      }
  conclude("lobes", &v);
}

/* Grooves along y, round lobes, a diffuse part of each kind, bent normals, and float. */
static void chi2_mixtures(void **state) {
  (void)state;
  uint64_t seed = 3;
  verdict v = {0, 1, ""};
  for (int k = 0; k < NORMALS; k++) {
    for (int diffuse = 0; diffuse < SHADE_DIFFUSE_COUNT; diffuse += 2) {
      shade_bsdf b =
          material(SHADE_MDF_GGX, SHADE_BRDF_MICROFACET, SHADE_DETAIL_PERTURB, 6, 60, 0.5, diffuse);
      judge(&b, k, 1, 1, &seed, &v);
      b = material(SHADE_MDF_ASHIKHMIN_SHIRLEY, 0, SHADE_DETAIL_ROTATE, 6, 60, 0.5, diffuse + 1);
      bsdf_in(&b)->horizon = SHADE_HORIZON_VALID_REFLECTION;
      judge(&b, k, 1, 0, &seed, &v);
      b = material(SHADE_MDF_BECKMANN, SHADE_BRDF_MICROFACET, SHADE_DETAIL_NONE, 20, 20, 0.2,
                   diffuse);
      judge(&b, k, 1, 1, &seed, &v);
    }
    for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++) {
      shade_bsdf b = material(mdf, SHADE_BRDF_MICROFACET, SHADE_DETAIL_AUTO, 0, 0, 0, 0);
      judge(&b, k, 1, 1, &seed, &v);
      b = material(mdf, SHADE_BRDF_MICROFACET, SHADE_DETAIL_DEFORM_SMOOTH, 9, 30, 0, 0);
      judge(&b, k, 1, 1, &seed, &v);
    }
  }
  conclude("mixtures", &v);
}

/*
 * The library's default horizon, before an eye whose mirror image lies below the surface: draws
 * about the bent normal, of n that the eye sees from the side and from behind.
 */
static void chi2_bent(void **state) {
  (void)state;
  uint64_t seed = 5;
  verdict v = {0, 1, ""};
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int k = 1; k < 4; k++) {
      const int detail = (mdf + k) & 1 ? SHADE_DETAIL_GRAM_SCHMIDT : SHADE_DETAIL_ROTATE;
      shade_bsdf b = material(mdf, k & 1 ? SHADE_BRDF_MICROFACET : SHADE_BRDF_ASHIKHMIN_SHIRLEY,
                              detail, 40, 6, k == 2 ? 0.5 : 0, SHADE_DIFFUSE_FIBRE);
      shade_params initial;
      shade_params_init(&initial);
      bsdf_in(&b)->horizon = initial.horizon;
      double n[3], wo[3];
      normal_of(k, 1, n);
      const double azimuth = atan2(n[1], n[0]);
      spherical(1.35, azimuth + (k & 1 ? 2.7 : 3.4), wo);
      judge_at(&b, n, wo, FINER, k & 1, &seed, k == 1 ? "tilt 20" : "tilt 45 or 70", &v);
    }
  conclude("bent", &v);
}

/*
 * Facets and upright mirrors, the eye above n's horizon and below it. The azimuths of n put the
 * step of the pdf, where light begins to face the mirror, on the border of two bins.
 */
static void chi2_facets(void **state) {
  (void)state;
  const struct {
    int mdf, brdf, detail, single;
    double ex, ey, kd;
  } cases[] = {
      {SHADE_MDF_ASHIKHMIN_SHIRLEY, SHADE_BRDF_ASHIKHMIN_SHIRLEY, SHADE_DETAIL_ROTATE, 0, 40, 6, 0},
      {SHADE_MDF_GGX, SHADE_BRDF_MICROFACET, SHADE_DETAIL_GRAM_SCHMIDT, 1, 30, 8, 0},
      {SHADE_MDF_BECKMANN, SHADE_BRDF_MICROFACET, SHADE_DETAIL_SHORTEST_ARC, 0, 6, 60, 0.3},
      {SHADE_MDF_WARD_HALF, SHADE_BRDF_WARD_BOUNDED, SHADE_DETAIL_PERTURB, 1, 20, 6, 0},
  };
  const double tilt[] = {0, 20, 45, 70}, azimuth[] = {0, 36, 144, 234};
  uint64_t seed = 4;
  verdict v = {0, 1, ""};
  for (int c = 0; c < 4; c++)
    for (int k = 0; k < 4; k++)
      for (int below = 0; below < 2; below++) {
        double n[3], wo[3];
        spherical(tilt[k] * PI / 180, azimuth[k] * PI / 180, n);
        eye_of(n, wo);
        if (below)
          spherical(1.4, azimuth[k] * PI / 180 + 2.8, wo);
        shade_bsdf b = material(cases[c].mdf, cases[c].brdf, cases[c].detail, cases[c].ex,
                                cases[c].ey, cases[c].kd, 0);
        bsdf_in(&b)->horizon = SHADE_HORIZON_SCHUESSLER;
        char where[40];
        snprintf(where, sizeof where, "tilt %g, eye %s", tilt[k], below ? "behind" : "in front");
        judge_at(&b, n, wo, FINER, cases[c].single, &seed, where, &v);
      }
  conclude("facets", &v);
}

/*
 * Facets and upright mirrors under the slightest tilts: what the mirror reflects stays unit.
 * The eye grazes, level with the bumped facet, where either facet's share is large.
 */
static void facets_of_tiny_tilt(void **state) {
  (void)state;
  static lanes m;
  uint64_t seed = 11;
  shade_bsdf b = material(SHADE_MDF_GGX, SHADE_BRDF_MICROFACET, SHADE_DETAIL_ROTATE, 4, 4, 0.5, 0);
  bsdf_in(&b)->horizon = SHADE_HORIZON_SCHUESSLER;
  for (int k = 0; k <= 68; k++) {
    const double tilt = pow(10, -20 + k * 0.25);
    for (int single = 0; single < 2; single++) {
      for (size_t i = 0; i < BATCH; i++) {
        const double a = 2 * PI * uniform(&seed), c = 2 * PI * uniform(&seed);
        const double z = 3 * tilt * uniform(&seed), s = sqrt(1 - z * z);
        const double v[8] = {tilt * cos(a),  tilt * sin(a), sqrt(1 - tilt * tilt),
                             s * cos(c),     s * sin(c),    z,
                             uniform(&seed), uniform(&seed)};
        for (int q = 0; q < 8; q++)
          m.in[q][i] = v[q];
      }
      (single ? drawf : draw)(&b, &m, BATCH);
      size_t drawn = 0, mirrored = 0;
      for (size_t i = 0; i < BATCH; i++) {
        const double *x = &m.out[0][i], *y = &m.out[1][i], *z = &m.out[2][i];
        if (!(m.out[6][i] > 0))
          continue;
        drawn++;
        /* light within reach of n's azimuth, on the mirror's side of it */
        mirrored += m.in[0][i] * *x + m.in[1][i] * *y < 0;
        const double error = fabs(sqrt(*x * *x + *y * *y + *z * *z) - 1);
        if (!(error < (single ? 1e-6 : 1e-14)))
          fail_msg("tilt %g, %s: wi is not unit by %g", tilt, single ? "float" : "double", error);
      }
      if (drawn < BATCH / 4 || mirrored < BATCH / 16)
        fail_msg("tilt %g: %zu drawn, %zu mirrored", tilt, drawn, mirrored);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(chi2_lobes),          cmocka_unit_test(chi2_mixtures),
      cmocka_unit_test(chi2_bent),           cmocka_unit_test(chi2_facets),
      cmocka_unit_test(facets_of_tiny_tilt),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
