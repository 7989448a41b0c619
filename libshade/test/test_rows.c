/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.4 */
/*
 * Every row of table.h has a say: two choices of a list, or two values of a number, shade a
 * material that reads them differently, and the reference sees each as the kernels do. By the table
 * alone: a row that is appended is tested without a word here.
 */
#include <string.h>

#include "support.h"

enum { MATERIALS = 300, LOOKS = 40 };

/* Light and eye well above the horizon of z and of n, h well within what the method covers. */
static int look(uint64_t *seed, const shade_params *p, double n[3], double wi[3], double wo[3]) {
  double h[3], m[3], cosh = 0, cosi = 0, coso = 0, length = 0;
  spherical(0.6 * uniform(seed), 2 * PI * uniform(seed), n);
  spherical(1.3 * uniform(seed), 2 * PI * uniform(seed), wo);
  for (int c = 0; c < 3; c++) {
    h[c] = n[c] + 0.4 * (uniform(seed) - 0.5);
    length += h[c] * h[c];
  }
  for (int c = 0; c < 3; c++) {
    h[c] /= sqrt(length);
    cosh += h[c] * wo[c];
  }
  for (int c = 0; c < 3; c++) {
    wi[c] = 2 * cosh * h[c] - wo[c];
    cosi += n[c] * wi[c];
    coso += n[c] * wo[c];
  }
  shade_ref_carried(p, n, h, m);
  return cosh > 0.05 && fmin(cosi, coso) > 0.05 && fmin(wi[2], wo[2]) > 0.05 &&
         m[2] > (is_warp(p->detail) ? 0.5 : 0.05);
}

static int rows_of(shade_list list) {
  int rows = 0;
  while (shade_list_row(list, rows, NULL, NULL, NULL, NULL))
    rows++;
  return rows;
}

static int random_choice(uint64_t *seed, shade_list list) {
  int value = 0;
  shade_list_row(list, (int)(uniform(seed) * rows_of(list)), &value, NULL, NULL, NULL);
  return value;
}

/* Within a factor of two of the default, or below a half where that is 0. */
static double random_number(uint64_t *seed, const shade_param_info *row) {
  const double x = row->initial > 0 ? row->initial * (0.5 + uniform(seed)) : 0.5 * uniform(seed);
  return fmin(fmax(x, row->minimum), row->maximum);
}

static void random_row(uint64_t *seed, shade_params *p, int row) {
  shade_param_info info;
  double v[3];
  shade_param_row(row, &info);
  for (int c = 0; c < info.components; c++)
    v[c] = random_number(seed, &info);
  assert_int_equal(shade_params_set(p, row, v), SHADE_OK);
}

static shade_params random_material(uint64_t *seed) {
  shade_params p;
  shade_param_info info;
  shade_params_init(&p);
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    shade_params_set_choice(&p, (shade_list)list, random_choice(seed, (shade_list)list));
  for (int row = 0; shade_param_row(row, &info); row++)
    random_row(seed, &p, row);
  /* what `auto` stands for depends on which axis is narrow, and whether one is */
  const double kind = uniform(seed);
  if (kind < 0.6)
    shade_params_set_exponents(&p, kind < 0.3 ? p.ex : p.ey, p.ex);
  return p;
}

/* Whether two materials differ in f anywhere; f and pdf of each are held to the reference. */
static int differ(uint64_t *seed, const shade_params *a, const shade_params *b, const char *what) {
  const shade_params *const p[2] = {a, b};
  shade_bsdf made[2];
  int different = 0;
  for (int k = 0; k < 2; k++)
    assert_int_equal(shade_bsdf_setup(&made[k], p[k]), SHADE_OK);
  for (int i = 0; i < LOOKS; i++) {
    double n[3], wi[3], wo[3], f[2][3], want[3];
    if (!look(seed, a, n, wi, wo) || !look(seed, b, n, wi, wo))
      continue;
    for (int k = 0; k < 2; k++) {
      shade_bsdf_eval(&made[k], n, wi, wo, f[k], NULL);
      shade_ref_f(p[k], n, wi, wo, want, NULL);
      for (int c = 0; c < 3; c++)
        if (!(fabs(f[k][c] - want[c]) <= 1e-8 * want[c] + 1e-12 * bsdf_of(&made[k])->numbers.peak))
          fail_msg("%s: f is %.9g, the reference says %.9g", what, f[k][c], want[c]);
      const double pdf = shade_bsdf_pdf(&made[k], n, wi, wo, NULL);
      want[0] = shade_ref_pdf(p[k], n, wi, wo);
      /* light by the mirrors of two facets is nowhere near as well inside: test_pdf.c */
      if (!shade_horizon_is(p[k]->horizon).facets &&
          !(fabs(pdf - want[0]) <= 1e-8 * want[0] + 1e-12 * bsdf_of(&made[k])->numbers.peak))
        fail_msg("%s: the density is %.9g, the reference says %.9g", what, pdf, want[0]);
    }
    for (int c = 0; c < 3; c++)
      different |= fabs(f[0][c] - f[1][c]) > 1e-4 * (f[0][c] + f[1][c]);
  }
  return different;
}

/* Shaded as one, as table.h says: `auto` is the quickest that is `rotate`. */
static int alike(shade_list list, int a, int b) {
  const int low = a < b ? a : b, high = a < b ? b : a;
  return (list == SHADE_LIST_DIFFUSE && low == SHADE_DIFFUSE_FIBRE_VIEW &&
          high == SHADE_DIFFUSE_POULIN_FOURNIER) ||
         (list == SHADE_LIST_DETAIL && low == SHADE_DETAIL_ROTATE && high == SHADE_DETAIL_AUTO);
}

static void choices(void **state) {
  (void)state;
  uint64_t seed = 23;
  for (int k = 0; k < SHADE_LIST_COUNT; k++) {
    const shade_list list = (shade_list)k;
    for (int x = 1; x < rows_of(list); x++)
      for (int y = 0; y < x; y++) {
        int a, b, different = 0;
        char what[200];
        shade_list_row(list, x, &a, NULL, NULL, NULL);
        shade_list_row(list, y, &b, NULL, NULL, NULL);
        snprintf(what, sizeof what, "%s %s or %s", shade_list_name(list), shade_list_word(list, a),
                 shade_list_word(list, b));
        for (int i = 0; i < MATERIALS && !different; i++) {
          shade_params p = random_material(&seed), q;
          if (list == SHADE_LIST_HORIZON) /* no row of the table, and `mutual` reads them */
            shade_params_set_slopes(&p, (const double[5]){0, 0, 0.3, 0.1, 0.2});
          shade_params_set_choice(&p, list, a);
          q = p;
          shade_params_set_choice(&q, list, b);
          different = differ(&seed, &p, &q, what);
        }
        if (different == alike(list, a, b))
          fail_msg("%s: the same for all of %d materials?", what, MATERIALS);
      }
  }
}

static void numbers(void **state) {
  (void)state;
  uint64_t seed = 29;
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++)
    for (int c = 0; c < info.components; c++) {
      int different = 0;
      for (int i = 0; i < MATERIALS && !different; i++) {
        shade_params p = random_material(&seed), q;
        double v[3];
        while (info.list != SHADE_LIST_COUNT &&
               !(info.choices >> shade_params_get_choice(&p, info.list) & 1))
          shade_params_set_choice(&p, info.list, random_choice(&seed, info.list));
        q = p;
        shade_params_get(&q, row, v);
        v[c] = random_number(&seed, &info);
        shade_params_set(&q, row, v);
        different = differ(&seed, &p, &q, info.word);
      }
      if (!different)
        fail_msg("%s: nothing reads it", info.word);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(choices), cmocka_unit_test(numbers)};
  return cmocka_run_group_tests_name("rows", tests, NULL, NULL);
}
