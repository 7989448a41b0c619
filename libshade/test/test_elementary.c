/* SPDX-License-Identifier: Apache-2.0 */
/* The errors that kernel/elementary.h and the distributions state, against long double libm. */
#include <string.h>

#include "support.h"
#include "kernel/coefficients.h"

#define SHADE_FLOAT 1
#include "kernel/real.h"
#include "kernel/elementary.h"
#include "kernel/leaf_random.h"
#include "kernel/leaf_brdf.h"
#include "kernel/leaf_detail.h"
#include "kernel/mdf.h"
#undef SHADE_FLOAT
#define SHADE_FLOAT 0
#include "kernel/real.h"
#include "kernel/elementary.h"
#include "kernel/leaf_random.h"
#include "kernel/leaf_brdf.h"
#include "kernel/leaf_detail.h"
#include "kernel/mdf.h"

static double relative(long double got, long double want) {
  return (double)fabsl((got - want) / want);
}

static void log1p_float(void **state) {
  (void)state;
  double worst = 0;
  for (double exponent = -40; exponent < 124; exponent += 1e-4) {
    float t = (float)exp2(exponent);
    worst = fmax(worst, relative((long double)log1p_positivef(t), log1pl((long double)t)));
  }
  print_message("log1p float: worst relative error %.2e\n", worst);
  assert_true(worst <= 2.0e-7);
  assert_true(log1p_positivef(0) == 0);
}

static void log1p_double(void **state) {
  (void)state;
  double worst = 0;
  for (double exponent = -400; exponent < 990; exponent += 1e-3) {
    double t = exp2(exponent);
    worst = fmax(worst, relative(log1p_positive(t), log1pl(t)));
  }
  print_message("log1p double: worst relative error %.2e\n", worst);
  assert_true(worst <= 4.5e-16);
  assert_true(log1p_positive(0) == 0);
}

/* log2(1 + a/b) over all sizes that the two may have. */
static void log2_both(void **state) {
  (void)state;
  double worst = 0, worstf = 0;
  uint64_t seed = 3;
  for (double exponent = -40; exponent < 99; exponent += 1e-4) {
    float bf = (float)exp2(-96 * uniform(&seed)), af = bf * (float)exp2(exponent);
    long double want = log1pl((long double)af / (long double)bf) / logl(2.0L);
    worstf = fmax(worstf, relative(0x1p-23L * (long double)log2_1pf(af, bf), want));
  }
  for (double exponent = -400; exponent < 960; exponent += 1e-3) {
    double b = exp2(-960 * uniform(&seed)), a = b * exp2(exponent);
    worst = fmax(worst, relative(log2_1p(a, b), log1pl((long double)a / b) / logl(2.0L)));
  }
  print_message("log2: worst relative error double %.2e, float %.2e\n", worst, worstf);
  assert_true(worst <= 3.3e-16);
  assert_true(worstf <= 2.1e-7);
  assert_true(log2_1p(0, 1e-29) == 0 && log2_1pf(0, 1) == 0 && log2_1pf(0, 1e-29f) == 0);
}

static void exp2_both(void **state) {
  (void)state;
  double worst = 0, worstf = 0;
  for (float a = 0; a <= 124; a += 3e-5f)
    worstf = fmax(worstf, relative((long double)exp2_negativef(a), exp2l(-(long double)a)));
  for (double a = 0; a <= 1010; a += 3.1e-4)
    worst = fmax(worst, relative((long double)exp2_negative(a), exp2l(-(long double)a)));
  print_message("exp2: worst relative error double %.2e, float %.2e\n", worst, worstf);
  assert_true(worst <= 2e-16);
  assert_true(worstf <= 1e-7);
  assert_true(exp2_negative(0) == 1 && exp2_negativef(0) == 1);
  assert_true(exp2_negativef(124.5f) == 0 && exp2_negativef(1e38f) == 0);
  assert_true(exp2_negative(1011) == 0 && exp2_negative(1e300) == 0);
}

static void exp_float(void **state) {
  (void)state;
  double worst = 0;
  for (float a = 0; a <= 86; a += 3e-5f)
    worst = fmax(worst, relative((long double)exp_negativef(a), expl(-(long double)a)));
  print_message("exp float: worst relative error %.2e\n", worst);
  assert_true(worst <= 1.5e-7);
  assert_true(exp_negativef(0) == 1);
  assert_true(exp_negativef(86.5f) == 0 && exp_negativef(1e38f) == 0);
}

static void exp_double(void **state) {
  (void)state;
  double worst = 0;
  for (double a = 0; a <= 700; a += 3.1e-4)
    worst = fmax(worst, relative(exp_negative(a), expl(-(long double)a)));
  print_message("exp double: worst relative error %.2e\n", worst);
  assert_true(worst <= 3e-16);
  assert_true(exp_negative(0) == 1);
  assert_true(exp_negative(701) == 0 && exp_negative(1e300) == 0);
}

/* 1 + 2 Lambda for Gaussian slopes of (alpha tan)^2 = w. */
static long double gaussian(long double w) {
  long double a = 1 / sqrtl(w);
  return 1 + expl(-a * a) / (a * sqrtl(3.14159265358979323846264L)) - erfcl(a);
}

static void smith(void **state) {
  (void)state;
  double worst = 0, worstf = 0;
  for (double exponent = -40; exponent < 90; exponent += 1e-4) {
    double w = exp2(exponent);
    float wf = (float)w;
    worst = fmax(worst, relative(smith_gaussian(w), gaussian((long double)w)));
    assert_true(relative(smith_ggx(w), sqrtl(1 + (long double)w)) <= 2.3e-16);
    assert_true(relative((long double)smith_ggxf(wf), sqrtl(1 + (long double)wf)) <= 1.2e-7);
    worstf = fmax(worstf, relative((long double)smith_gaussianf(wf), gaussian((long double)wf)));
  }
  print_message("1 + 2 Lambda: worst relative error double %.2e, float %.2e\n", worst, worstf);
  assert_true(worst <= 2e-15);
  assert_true(worstf <= 4e-7);
  assert_true(smith_gaussian(0) == 1 && smith_gaussianf(0) == 1);
}

static void angle(void **state) {
  (void)state;
  double worst = 0, worstf = 0;
  for (double a = 0; a <= PI; a += 1e-6) {
    double y = fabs(sin(a)), x = cos(a);
    float yf = (float)y, xf = (float)x;
    worst = fmax(worst, fabs((double)(angle_of(y, x) - atan2l(y, x))));
    worstf =
        fmax(worstf, fabs((double)((long double)angle_off(yf, xf) - atan2l((long double)yf, xf))));
  }
  print_message("angle: worst absolute error double %.2e, float %.2e\n", worst, worstf);
  assert_true(worst <= 6e-16);
  assert_true(worstf <= 3e-7);
  assert_true(angle_of(0, 0) == 0 && angle_of(0, 1e-200) == 0 && angle_off(0, 0) == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(log2_both),   cmocka_unit_test(exp2_both),
                                     cmocka_unit_test(log1p_float), cmocka_unit_test(log1p_double),
                                     cmocka_unit_test(exp_float),   cmocka_unit_test(exp_double),
                                     cmocka_unit_test(smith),       cmocka_unit_test(angle)};
  return cmocka_run_group_tests_name("elementary", tests, NULL, NULL);
}
