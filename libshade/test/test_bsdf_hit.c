/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/*
 * Prepared hits give what shade_bsdf_eval, _pdf and _sample give, to the last bit and status, for
 * every choice of the table: of many hits prepared before the first light, copies too, with lights
 * in any order, directions of any length, downward and not finite. (That those are right is for
 * test_bsdf, test_horizon, test_pdf, test_sample and test_hostile.)
 */
#include <string.h>

#include "support.h"

enum { HITS = 6, LIGHTS = 6 };

typedef struct directions {
  double n[HITS][3], wo[HITS][3], wi[LIGHTS][3], u[LIGHTS][2];
  float nf[HITS][3], wof[HITS][3], wif[LIGHTS][3], uf[LIGHTS][2];
} directions;

static void make(uint64_t *seed, directions *d) {
  for (int i = 0; i < HITS; i++) {
    spherical(1.5 * uniform(seed) * (i > 1), 6.3 * uniform(seed), d->n[i]);
    spherical(1.6 * uniform(seed), 6.3 * uniform(seed), d->wo[i]);
    spherical(1.7 * uniform(seed), 6.3 * uniform(seed), d->wi[i]);
  }
  for (int k = 0; k < 3; k++) {
    d->n[2][k] *= 3e4; /* to be made unit */
    d->wi[2][k] *= 1e-7;
    d->wi[3][k] = -d->wo[3][k];
  }
  d->n[3][2] = -d->n[3][2];
  if (uniform(seed) < 0.3)
    d->wo[4][0] = NAN;
  if (uniform(seed) < 0.3)
    d->wi[4][1] = INFINITY;
  if (uniform(seed) < 0.1)
    d->n[5][0] = d->n[5][1] = d->n[5][2] = 0;
  for (int i = 0; i < LIGHTS; i++)
    for (int k = 0; k < 2; k++)
      d->u[i][k] = i == 4 && uniform(seed) < 0.1 ? NAN : 1.1 * uniform(seed);
  for (int i = 0; i < LIGHTS; i++)
    for (int k = 0; k < 2; k++)
      d->uf[i][k] = (float)d->u[i][k];
  for (int i = 0; i < HITS; i++)
    for (int k = 0; k < 3; k++) {
      d->nf[i][k] = (float)d->n[i][k];
      d->wof[i][k] = (float)d->wo[i][k];
      d->wif[i][k] = (float)d->wi[i][k];
    }
}

/* Density and draw of one hit beside those of its n and wo. Returns whether something was drawn. */
#define DRAWS(real, f)                                                                             \
  static int compare_draws##f(const shade_bsdf *b, const shade_bsdf_hit##f *hit, const real *n,    \
                              const real *wo, const real *wi, const real *u) {                     \
    unsigned is = SHADE_CLAMPED_PARAMETER, was = SHADE_CLAMPED_PARAMETER;                          \
    const real pdf[2] = {shade_bsdf_hit_pdf##f(b, hit, wi, &is),                                   \
                         shade_bsdf_pdf##f(b, n, wi, wo, &was)};                                   \
    real got[8] = {0}, want[8] = {0};                                                              \
    assert_int_equal(is, was);                                                                     \
    assert_memory_equal(&pdf[0], &pdf[1], sizeof pdf[0]);                                          \
    assert_true(shade_bsdf_hit_pdf##f(b, hit, wi, NULL) == pdf[0]);                                \
    is = shade_bsdf_hit_sample##f(b, hit, u, got, got + 3, &got[6], &got[7]);                      \
    was = shade_bsdf_sample##f(b, n, wo, u, want, want + 3, &want[6], &want[7]);                   \
    assert_int_equal(is, was);                                                                     \
    assert_memory_equal(got, want, sizeof got);                                                    \
    return got[6] > 0;                                                                             \
  }
DRAWS(double, )
DRAWS(float, f)

static int compare(const shade_bsdf *b, const directions *d) {
  shade_bsdf_hit hit[HITS], copy;
  shade_bsdf_hitf hitf[HITS], copyf;
  memset(hit, 0xff, sizeof hit); /* NaN: what is read must have been written */
  memset(hitf, 0xff, sizeof hitf);
  unsigned mended[HITS], mendedf[HITS];
  int drawn = 0;
  for (int i = 0; i < HITS; i++) {
    mended[i] = shade_bsdf_prepare(b, d->n[i], d->wo[i], &hit[i]);
    mendedf[i] = shade_bsdf_preparef(b, d->nf[i], d->wof[i], &hitf[i]);
  }
  for (int light = LIGHTS - 1; light >= 0; light--)
    for (int i = 0; i < HITS; i++) {
      double got[4], want[4];
      float gotf[4], wantf[4];
      copy = hit[i];
      copyf = hitf[i];
      const unsigned is = shade_bsdf_hit_eval(b, &copy, d->wi[light], got, &got[3]);
      const unsigned was = shade_bsdf_eval(b, d->n[i], d->wi[light], d->wo[i], want, &want[3]);
      assert_int_equal(is, was);
      assert_int_equal(mended[i] & ~was, 0);
      assert_memory_equal(got, want, sizeof got);
      const unsigned isf = shade_bsdf_hit_evalf(b, &copyf, d->wif[light], gotf, &gotf[3]);
      const unsigned wasf =
          shade_bsdf_evalf(b, d->nf[i], d->wif[light], d->wof[i], wantf, &wantf[3]);
      assert_int_equal(isf, wasf);
      assert_int_equal(mendedf[i] & ~wasf, 0);
      assert_memory_equal(gotf, wantf, sizeof gotf);
      drawn += compare_draws(b, &copy, d->n[i], d->wo[i], d->wi[light], d->u[light]);
      drawn += compare_drawsf(b, &copyf, d->nf[i], d->wof[i], d->wif[light], d->uf[light]);
    }
  return drawn;
}

static void every_choice(void **state) {
  uint64_t seed = 11;
  directions d;
  int cases = 0, drawn = 0;
  (void)state;
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int brdf = 0; brdf < SHADE_BRDF_AUTO; brdf++)
      for (int detail = 0; detail < SHADE_DETAIL_COUNT; detail++)
        for (int horizon = 0; horizon < SHADE_HORIZON_COUNT; horizon++) {
          const int other = mdf + brdf + detail + horizon; /* the others take turns */
          shade_params p;
          shade_bsdf b;
          shade_params_init(&p);
          shade_params_set_exponents(&p, 2 + 60 * uniform(&seed), 2 + 60 * uniform(&seed));
          p.mdf = (shade_mdf)mdf;
          p.brdf = (shade_brdf)brdf;
          p.detail = (shade_detail)detail;
          p.horizon = (shade_horizon)horizon;
          p.multiscatter = (shade_multiscatter)(other & 1);
          p.groove = (shade_groove)(other % SHADE_GROOVE_COUNT);
          p.fresnel = (shade_fresnel)(other % SHADE_FRESNEL_COUNT);
          p.diffuse = (shade_diffuse)(uniform(&seed) * SHADE_DIFFUSE_COUNT);
          for (int c = 0; c < 3; c++)
            p.kd[c] = other % 3 ? uniform(&seed) : 0;
          shade_bsdf_setup(&b, &p);
          make(&seed, &d);
          drawn += compare(&b, &d);
          cases++;
        }
  assert_true(drawn > 30 * cases);
}

/* As from shade_bsdf_eval: the cosine may be left out. */
static void cosine_is_optional(void **state) {
  (void)state;
  const shade_bsdf b = make_bsdf(SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, 200, 10);
  const double n[3] = {0.1, 0.2, 0.97}, wo[3] = {0, 0, 1}, wi[3] = {0.3, 0, 0.95};
  const float nf[3] = {0.1f, 0.2f, 0.97f}, wof[3] = {0, 0, 1}, wif[3] = {0.3f, 0, 0.95f};
  shade_bsdf_hit hit;
  shade_bsdf_hitf hitf;
  double f[3];
  float ff[3];
  shade_bsdf_prepare(&b, n, wo, &hit);
  shade_bsdf_preparef(&b, nf, wof, &hitf);
  assert_int_equal(shade_bsdf_hit_eval(&b, &hit, wi, f, NULL), SHADE_OK);
  assert_int_equal(shade_bsdf_hit_evalf(&b, &hitf, wif, ff, NULL), SHADE_OK);
  assert_true(f[0] > 0 && ff[0] > 0);
  const double u[2] = {0.3, 0.6};
  const float uf[2] = {0.3f, 0.6f};
  double w[3], pdf = 0;
  float wf[3], pdff = 0;
  assert_int_equal(shade_bsdf_hit_sample(&b, &hit, u, w, f, &pdf, NULL), SHADE_OK);
  assert_int_equal(shade_bsdf_hit_samplef(&b, &hitf, uf, wf, ff, &pdff, NULL), SHADE_OK);
  assert_true(pdf > 0 && pdff > 0);
}

/* A lobe whose f0 is black in one, two or all channels, beside batches, which work it out: what is
 * black by every Fresnel term that has an f0 is so nowhere but where that term is constant. */
static void black_lobes(void **state) {
  (void)state;
  const double n[3] = {0.05, -0.1, 0.9}, wo[3] = {0.96, 0.1, 0.26};
  const double wi[2][3] = {{-0.95, -0.1, 0.3}, {0.2, -0.3, 0.93}};
  for (int fresnel = 0; fresnel < SHADE_FRESNEL_CONDUCTOR; fresnel++)
    for (int black = 1; black <= 3; black++)
      for (int light = 0; light < 2; light++) {
        shade_params p;
        shade_bsdf b;
        shade_params_init(&p);
        shade_params_set_exponents(&p, 9, 4);
        p.fresnel = (shade_fresnel)fresnel;
        p.horizon = SHADE_HORIZON_HARD;
        for (int c = 0; c < 3; c++) {
          p.f0[c] = c < black ? 0 : 0.5;
          p.kd[c] = 0.25;
        }
        shade_bsdf_setup(&b, &p);
        const double *const w = wi[light];
        const shade_lanes in = {.size = sizeof in,
                                .nx = &n[0],
                                .ny = &n[1],
                                .nz = &n[2],
                                .wix = &w[0],
                                .wiy = &w[1],
                                .wiz = &w[2],
                                .wox = &wo[0],
                                .woy = &wo[1],
                                .woz = &wo[2]};
        double one[3], many[3], cosine, cosines;
        const shade_result out = {sizeof out, &many[0], &many[1], &many[2], &cosines};
        assert_int_equal(shade_bsdf_eval(&b, n, w, wo, one, &cosine), SHADE_OK);
        assert_int_equal(shade_bsdf_eval_batch(&b, 1, &in, &out), SHADE_OK);
        const double matt = 0.25 / 3.14159265358979323846;
        for (int c = 0; c < 3; c++) {
          assert_true(fabs(one[c] - many[c]) <= 1e-13 * many[c]);
          if (c < black && fresnel == SHADE_FRESNEL_NONE)
            assert_true(fabs(one[c] - matt) <= 1e-15);
          else
            assert_true(one[c] > matt * (1 + 1e-9));
        }
      }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_choice),
                                     cmocka_unit_test(cosine_is_optional),
                                     cmocka_unit_test(black_lobes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
