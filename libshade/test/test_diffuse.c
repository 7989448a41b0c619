/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.5 */
/* Diffuse models against quadrature, at the limits, and what they reflect. */
#include "support.h"

static void against_quadrature(void **state) {
  (void)state;
  uint64_t seed = 31;
  double worst = 0, worstf = 0;
  for (int k = 0; k < 6000; k++) {
    double l[3], v[3];
    float lf[3], vf[3];
    spherical(PI / 2 * uniform(&seed), 2 * PI * uniform(&seed), l);
    spherical(PI / 2 * uniform(&seed), 2 * PI * uniform(&seed), v);
    if (k % 10 == 0) /* near the fibre, where the printed form is 0/0 */
      spherical(PI / 2 - pow(10, -8 * uniform(&seed)), 0, k % 20 ? l : v);
    for (int c = 0; c < 3; c++) {
      lf[c] = (float)l[c];
      vf[c] = (float)v[c];
    }
    for (int d = 0; d < SHADE_DIFFUSE_COUNT; d++) {
      if (d == SHADE_DIFFUSE_POULIN_FOURNIER)
        continue;
      double want = shade_ref_diffuse((shade_diffuse)d, l, v);
      worst = fmax(worst, fabs(shade_diffuse_eval((shade_diffuse)d, l, v) - want));
      double exact_l[3], exact_v[3];
      for (int c = 0; c < 3; c++) {
        exact_l[c] = (double)lf[c];
        exact_v[c] = (double)vf[c];
      }
      want = shade_ref_diffuse((shade_diffuse)d, exact_l, exact_v);
      worstf = fmax(worstf, fabs((double)shade_diffuse_evalf((shade_diffuse)d, lf, vf) - want));
    }
  }
  print_message("Phi: worst error double %.1e, float %.1e\n", worst, worstf);
  assert_true(worst <= 2e-15);
  assert_true(worstf <= 5e-7);
}

static void known_values(void **state) {
  (void)state;
  const double z[3] = {0, 0, 1}, x[3] = {1, 0, 0}, below[3] = {.6, 0, -.8};
  const double side[3] = {0, .6, .8}, along[3] = {.6, 0, .8}, back[3] = {-.6, 0, .8};
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_LAMBERT, side, z), .8, 1e-15);
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_MAX_NORMAL, side, z), 1, 1e-15);
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_MAX_NORMAL, along, z), .8, 1e-15);
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_FIBRE, z, z), 2 / PI, 1e-15);
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_FIBRE, side, z), 1.8 / PI, 1e-15);
  /* the printed form is off by up to .637 on one side of the fibre */
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_FIBRE, along, z), 1.6 / PI, 1e-15);
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_FIBRE, back, z), 1.6 / PI, 1e-15);
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_FIBRE_VIEW, z, z), PI / 4, 1e-15);
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY, z, z),
              28 / 23. * (31 / 32.) * (31 / 32.), 1e-15);
  /* touching neighbours hide nothing from above and all at the horizon */
  assert_near(shade_ref_diffuse(SHADE_DIFFUSE_POULIN_FOURNIER, z, z), PI / 4, 1e-12);
  const double low[3] = {0, sqrt(1 - 1e-6), 1e-3};
  assert_true(shade_ref_diffuse(SHADE_DIFFUSE_POULIN_FOURNIER, low, z) < 1e-2);
  for (int d = 0; d < SHADE_DIFFUSE_COUNT; d++) {
    assert_true(shade_diffuse_eval((shade_diffuse)d, x, z) == 0);
    assert_true(shade_diffuse_eval((shade_diffuse)d, below, z) == 0);
    const double odd[3] = {NAN, 0, 1}, nothing[3] = {0, 0, 0};
    assert_true(shade_diffuse_eval((shade_diffuse)d, odd, z) == 0);
    assert_true(shade_diffuse_eval((shade_diffuse)d, nothing, z) == 0);
    /* v along the fibre stands for v = z */
    const double nearly[3] = {1, 0, 1e-200};
    double value = shade_diffuse_eval((shade_diffuse)d, z, nearly);
    assert_true(isfinite(value) && value >= 0);
    if (d == SHADE_DIFFUSE_FIBRE_VIEW)
      assert_near(value, PI / 4, 1e-15);
  }
}

/*
 * Light reflected for an eye at v, of all that comes evenly from above: the integral of
 * Phi/pi over l.
 */
static double albedo(shade_diffuse model, const double v[3],
                     double (*phi)(shade_diffuse, const double[3], const double[3])) {
  enum { RINGS = 120, SPOKES = 120 };
  double sum = 0;
  for (int i = 0; i < RINGS * SPOKES; i++) {
    double cosine = (i / SPOKES + .5) / RINGS, around = 2 * PI * (i % SPOKES + .5) / SPOKES, l[3];
    spherical(acos(cosine), around, l);
    sum += phi(model, l, v);
  }
  return sum * 2 / (RINGS * SPOKES);
}

static void energy(void **state) {
  (void)state;
  const double figures[] = {1, PI / 2, .5 + 1 / PI, .893, 0, .969};
  for (int d = 0; d < SHADE_DIFFUSE_COUNT; d++) {
    int quadrature = d == SHADE_DIFFUSE_POULIN_FOURNIER;
    double most = 0;
    for (int k = 0; k < 40; k += quadrature ? 5 : 1) {
      double v[3];
      spherical(PI / 2 * (k % 10 + .01) / 10, k / 10 * PI / 6, v);
      most = fmax(most,
                  albedo((shade_diffuse)d, v, quadrature ? shade_ref_diffuse : shade_diffuse_eval));
    }
    print_message("%s: albedo at most %.4f\n", shade_list_word(SHADE_LIST_DIFFUSE, d), most);
    if (quadrature)
      assert_true(most <= 1);
    else
      assert_near(most, figures[d], 2e-3);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(against_quadrature),
                                     cmocka_unit_test(known_values), cmocka_unit_test(energy)};
  return cmocka_run_group_tests_name("diffuse", tests, NULL, NULL);
}
