/* SPDX-License-Identifier: Apache-2.0 */
/* Names, ranges, conversions and the JSON of a material. */
#include <string.h>

#include "support.h"

static void names(void **state) {
  (void)state;
  assert_int_equal(shade_list_find(SHADE_LIST_MDF, "ashikhmin-shirley"),
                   SHADE_MDF_ASHIKHMIN_SHIRLEY);
  assert_int_equal(shade_list_find(SHADE_LIST_MDF, "Ashikhmin_Shirley"),
                   SHADE_MDF_ASHIKHMIN_SHIRLEY);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, "GRAM_SCHMIDT"), SHADE_DETAIL_GRAM_SCHMIDT);
  assert_int_equal(shade_list_find(SHADE_LIST_GROOVE, "x"), SHADE_GROOVE_X);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, "rotat"), -1);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, "rotates"), -1);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, ""), -1);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, NULL), -1);
  assert_int_equal(shade_list_find(SHADE_LIST_COUNT, "x"), -1);
  for (int list = 0; list < SHADE_LIST_COUNT; list++) {
    const char *word, *label, *help;
    int value, row = 0;
    for (; shade_list_row((shade_list)list, row, &value, &word, &label, &help); row++) {
      assert_int_equal(shade_list_find((shade_list)list, word), value);
      assert_string_equal(shade_list_word((shade_list)list, value), word);
      assert_true(*label && *help);
    }
    assert_true(row > 0);
  }
  assert_null(shade_list_word(SHADE_LIST_DETAIL, 99));
  assert_null(shade_list_name(SHADE_LIST_COUNT));
}

static void exponents_and_alphas(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++) {
    const double *member = NULL;
    if (!strcmp(info.word, "ax"))
      member = &p.ax;
    if (!strcmp(info.word, "ay"))
      member = &p.ay;
    if (member) /* the table's alphas are those of its exponents */
      assert_near(*member, info.initial, 1e-8);
  }
  assert_int_equal(shade_params_set_alphas(&p, .1, 1.5), SHADE_OK);
  assert_near(p.ex, 198, 1e-10);
  assert_true(p.ey == 0);
  assert_int_equal(shade_params_set_exponents(&p, 6170.84, 7.876543), SHADE_OK);
  assert_near(p.ax, sqrt(2 / 6172.84), 1e-15);
  assert_int_equal(shade_params_set_exponents(&p, -1, NAN), SHADE_CLAMPED_PARAMETER);
  assert_true(p.ex == 0 && p.ey == 10);
  assert_int_equal(shade_params_set_alphas(&p, INFINITY, 0), SHADE_CLAMPED_PARAMETER);
  assert_true(p.ax == 10 && p.ay == 1e-4 && p.ey == 1e6);
}

static void setup_clamps(void **state) {
  (void)state;
  shade_params p;
  shade_bsdf b;
  shade_params_init(&p);
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  p.ex = 2e6;
  p.f0[1] = -.5;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_CLAMPED_PARAMETER);
  assert_true(b.kx == 1e6 && b.f0[1] == 0);
  shade_params_init(&p);
  p.detail = (shade_detail)77;
  p.mdf = (shade_mdf)-3;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_BAD_CHOICE);
  assert_true(b.mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY && b.detail == SHADE_DETAIL_NONE);
}

static void json(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, 198, 6);
  char text[512], cut[20];
  int length = shade_params_json(&p, 3, "a \"b\"\\\n", text, sizeof text);
  assert_int_equal(length, (int)strlen(text));
  assert_string_equal(
      text, "{\"id\": 3, \"name\": \"a \\\"b\\\"\\\\\\u000a\", \"mdf\": \"ashikhmin_shirley\", "
            "\"brdf\": \"ashikhmin_shirley\", \"detail\": \"rotate\", \"groove\": \"auto\", "
            "\"fresnel\": \"schlick\", \"ex\": 198, \"ey\": 6, \"ax\": 0.10000000000000001, "
            "\"ay\": 0.5, \"f0\": [1, 1, 1]}");
  assert_int_equal(shade_params_json(&p, 3, "a \"b\"\\\n", cut, sizeof cut), length);
  assert_memory_equal(cut, text, sizeof cut - 1);
  assert_true(cut[sizeof cut - 1] == 0);
  assert_int_equal(shade_params_json(&p, 3, "a \"b\"\\\n", NULL, 0), length);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(names),
      cmocka_unit_test(exponents_and_alphas),
      cmocka_unit_test(setup_clamps),
      cmocka_unit_test(json),
  };
  return cmocka_run_group_tests_name("params", tests, NULL, NULL);
}
