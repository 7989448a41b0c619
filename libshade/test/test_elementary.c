/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 1.9 */
/* The errors that model/elementary.h and the distributions state, against long double libm: in
 * double, and in float by test_elementary_float.c. */
#include <string.h>

#include "model/mdf.h"
#include "support.h"

#define LIMIT(of_float, of_double) (SHADE_FLOAT ? of_float : of_double)
static const char *const precision = LIMIT("float", "double");

static double relative(real got, long double want) {
  return (double)fabsl(((long double)got - want) / want);
}

static real power_of_2(double exponent) {
  return (real)exp2(exponent);
}

static void log1p_is_near(void **state) {
  (void)state;
  const double from = LIMIT(-40, -400), to = LIMIT(124, 990), step = LIMIT(1e-4, 1e-3);
  double worst = 0;
  for (double exponent = from; exponent < to; exponent += step) {
    const real t = power_of_2(exponent);
    worst = fmax(worst, relative(log1p_positive(t), log1pl((long double)t)));
  }
  print_message("log1p %s: worst relative error %.2e\n", precision, worst);
  assert_true(worst <= LIMIT(2.0e-7, 4.5e-16));
  assert_true(log1p_positive(0) == 0);
}

/* log2(1 + a/b) over all sizes that the two may have. */
static void log2_is_near(void **state) {
  (void)state;
  const double range = LIMIT(96, 960), from = LIMIT(-40, -400), to = LIMIT(99, 960);
  double worst = 0;
  uint64_t seed = 3;
  for (double exponent = -40; !SHADE_FLOAT && exponent < 99; exponent += 1e-4)
    uniform(&seed); /* those of float */
  for (double exponent = from; exponent < to; exponent += LIMIT(1e-4, 1e-3)) {
    const real b = power_of_2(-range * uniform(&seed)), a = b * power_of_2(exponent);
    const long double want = log1pl((long double)a / (long double)b) / logl(2.0L);
    worst = fmax(worst, relative(log2_1p(a, b), want / LOG2_UNIT));
  }
  print_message("log2 %s: worst relative error %.2e\n", precision, worst);
  assert_true(worst <= LIMIT(2.1e-7, 3.3e-16));
  assert_true(log2_1p(0, 1) == 0 && log2_1p(0, R(1e-29)) == 0);
}

static void exp2_is_near(void **state) {
  (void)state;
  const real most = LIMIT(124, 1010), step = LIMIT(3e-5f, R(3.1e-4));
  double worst = 0;
  for (real a = 0; a <= most; a += step)
    worst = fmax(worst, relative(exp2_negative(a), exp2l(-(long double)a)));
  print_message("exp2 %s: worst relative error %.2e\n", precision, worst);
  assert_true(worst <= LIMIT(1e-7, 2e-16));
  assert_true(exp2_negative(0) == 1);
  assert_true(exp2_negative(LIMIT(R(124.5), 1011)) == 0 &&
              exp2_negative((real)LIMIT(1e38, 1e300)) == 0);
}

static void exp_is_near(void **state) {
  (void)state;
  const real most = LIMIT(86, 700), step = LIMIT(3e-5f, R(3e-4));
  double worst = 0;
  for (real a = 0; a <= most; a += step)
    worst = fmax(worst, relative(exp_negative(a), expl(-(long double)a)));
  print_message("exp %s: worst relative error %.2e\n", precision, worst);
  assert_true(worst <= LIMIT(1.5e-7, 3e-16));
  assert_true(exp_negative(0) == 1);
  assert_true(exp_negative(LIMIT(R(86.5), 701)) == 0 && exp_negative(R(1e38)) == 0);
}

/* 1 + 2 Lambda for Gaussian slopes of (alpha tan)^2 = w. */
static long double gaussian(long double w) {
  long double a = 1 / sqrtl(w);
  return 1 + expl(-a * a) / (a * sqrtl(3.14159265358979323846264L)) - erfcl(a);
}

static void smith_is_near(void **state) {
  (void)state;
  double worst = 0;
  for (double exponent = -40; exponent < 90; exponent += 1e-4) {
    const double exact = exp2(exponent);
    const real w = (real)exact;
    assert_true(relative(smith_ggx(w), sqrtl(1 + (long double)w)) <= LIMIT(1.2e-7, 2.3e-16));
    worst = fmax(worst, relative(smith_gaussian(w), gaussian((long double)w)));
  }
  print_message("1 + 2 Lambda %s: worst relative error %.2e\n", precision, worst);
  assert_true(worst <= LIMIT(4e-7, 2e-15));
  assert_true(smith_gaussian(0) == 1);
}

static void angle_is_near(void **state) {
  (void)state;
  double worst = 0;
  for (double a = 0; a <= PI; a += 1e-6) {
    const real y = (real)fabs(sin(a)), x = (real)cos(a);
    const long double want = atan2l((long double)y, (long double)x);
    worst = fmax(worst, (double)fabsl((long double)angle_of(y, x) - want));
  }
  print_message("angle %s: worst absolute error %.2e\n", precision, worst);
  assert_true(worst <= LIMIT(3e-7, 6e-16));
  assert_true(angle_of(0, 0) == 0 && (SHADE_FLOAT || angle_of(0, (real)1e-200) == 0));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(log1p_is_near), cmocka_unit_test(log2_is_near),
      cmocka_unit_test(exp2_is_near),  cmocka_unit_test(exp_is_near),
      cmocka_unit_test(smith_is_near), cmocka_unit_test(angle_is_near)};
  return cmocka_run_group_tests_name("elementary", tests, NULL, NULL);
}
