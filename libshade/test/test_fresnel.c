/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.3 */
/* Fresnel leaves against the reference, alone: a lobe so flat that f is known but for F. */
#include "support.h"

/* F of red at half the angle between wi and wo, by the reference and both precisions. */
static void values(const shade_params *p, double theta, double got[3]) {
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, p), SHADE_OK);
  double z[3] = {0, 0, 1}, wi[3], wo[3], f[3];
  float zf[3] = {0, 0, 1}, wif[3], wof[3], ff[3];
  spherical(theta, 0, wi);
  spherical(theta, PI, wo);
  for (int c = 0; c < 3; c++) {
    wif[c] = (float)wi[c];
    wof[c] = (float)wo[c];
  }
  /* exponents 0: D = 1/(2 pi), f = F D/(4 cos^2) */
  double rest = 1 / (2 * PI) / (4 * wi[2] * wi[2]);
  shade_ref_f(p, z, wi, wo, f, NULL);
  got[0] = f[0] / rest;
  shade_bsdf_eval(&b, z, wi, wo, f, NULL);
  got[1] = f[0] / rest;
  shade_bsdf_evalf(&b, zf, wif, wof, ff, NULL);
  got[2] = (double)ff[0] / rest;
}

static shade_params flat(shade_fresnel fresnel) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, 0, 0);
  p.fresnel = fresnel;
  return p;
}

static void known_values(void **state) {
  (void)state;
  double got[3];
  shade_params p = flat(SHADE_FRESNEL_CONDUCTOR);
  /* glass without absorption: 4 % at normal incidence, Rp = 0 at Brewster's angle, where
     Rs = ((eta^2 - 1)/(eta^2 + 1))^2 */
  p.eta[0] = 1.5;
  p.k[0] = 0;
  values(&p, 0, got);
  assert_near(got[1], 0.04, 1e-15);
  values(&p, atan(1.5), got);
  assert_near(got[1], 0.5 * pow(1.25 / 3.25, 2), 1e-14);
  /* a metal at normal incidence: ((eta - 1)^2 + k^2)/((eta + 1)^2 + k^2) */
  p.eta[0] = 0.2;
  p.k[0] = 3;
  values(&p, 0, got);
  assert_near(got[1], (0.64 + 9) / (1.44 + 9), 1e-15);
  /* F82: the ends are Schlick's, 1/7 is tint times Schlick's */
  p = flat(SHADE_FRESNEL_F82);
  p.f0[0] = 0.6;
  p.f82[0] = 0.7;
  values(&p, 0, got);
  assert_near(got[1], 0.6, 1e-15);
  values(&p, acos(1 / 7.), got);
  assert_near(got[1], 0.7 * (0.6 + 0.4 * pow(6 / 7., 5)), 1e-14);
  p.f82[0] = 1;
  values(&p, 1.2, got);
  assert_near(got[1], 0.6 + 0.4 * pow(1 - cos(1.2), 5), 1e-14);
}

static void bounds(void **state) {
  (void)state;
  uint64_t seed = 21;
  double worst = 0, worstf = 0;
  for (int k = 0; k < 200000; k++) {
    shade_params p = flat(k & 1 ? SHADE_FRESNEL_CONDUCTOR : SHADE_FRESNEL_F82);
    p.f0[0] = uniform(&seed);
    p.f82[0] = uniform(&seed);
    p.eta[0] = pow(10, 3 * uniform(&seed) - 2);
    p.k[0] = pow(10, 3 * uniform(&seed) - 2);
    double got[3];
    values(&p, 1.55 * uniform(&seed), got);
    assert_true(got[1] >= 0 && got[1] <= 1 + 1e-14 && got[2] >= 0 && got[2] <= 1 + 3e-6);
    worst = fmax(worst, fabs(got[1] - got[0]));
    worstf = fmax(worstf, fabs(got[2] - got[0]));
  }
  print_message("Fresnel: double %.1e, float %.1e\n", worst, worstf);
  assert_true(worst <= 1e-14);
  assert_true(worstf <= 5e-6);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(known_values), cmocka_unit_test(bounds)};
  return cmocka_run_group_tests_name("fresnel", tests, NULL, NULL);
}
