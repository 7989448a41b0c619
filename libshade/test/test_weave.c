/* SPDX-License-Identifier: Apache-2.0 */
/* Drafts by name and pattern against matrices written by hand, and look-ups against the rules. */
#include <string.h>

#include "shade/weave.h"
#include "support.h"

/* 'X' where the warp is on top, the first line the first pick. */
static void holds(shade_draft *d, const char *matrix) {
  assert_non_null(d);
  const char *at = matrix;
  for (int j = 0; j < d->picks; j++, at++)
    for (int i = 0; i < d->ends; i++, at++)
      assert_int_equal(d->warp_up[j * d->ends + i], *at == 'X');
  assert_int_equal(at - matrix, strlen(matrix) + 1);
  shade_draft_free(d);
}

static void named(void **state) {
  (void)state;
  holds(shade_draft_named("plain"), ".X\n"
                                    "X.");
  holds(shade_draft_named("Twill-2-1"), ".XX\n"
                                        "X.X\n"
                                        "XX.");
  holds(shade_draft_named("twill_1_2"), "..X\n"
                                        "X..\n"
                                        ".X.");
  holds(shade_draft_named("twill_3_1"), ".XXX\n"
                                        "X.XX\n"
                                        "XX.X\n"
                                        "XXX.");
  holds(shade_draft_named("twill_1_3"), "...X\n"
                                        "X...\n"
                                        ".X..\n"
                                        "..X.");
  holds(shade_draft_named("twill_2_2"), "..XX\n"
                                        "X..X\n"
                                        "XX..\n"
                                        ".XX.");
  holds(shade_draft_named("satin_5"), ".XXXX\n"
                                      "XX.XX\n"
                                      "XXXX.\n"
                                      "X.XXX\n"
                                      "XXX.X");
  holds(shade_draft_named("sateen_5"), "....X\n"
                                       ".X...\n"
                                       "...X.\n"
                                       "X....\n"
                                       "..X..");
  holds(shade_draft_named("satin_8"), ".XXXXXXX\n"
                                      "XXX.XXXX\n"
                                      "XXXXXX.X\n"
                                      "X.XXXXXX\n"
                                      "XXXX.XXX\n"
                                      "XXXXXXX.\n"
                                      "XX.XXXXX\n"
                                      "XXXXX.XX");
  holds(shade_draft_named("sateen_8"), ".......X\n"
                                       "..X.....\n"
                                       ".....X..\n"
                                       "X.......\n"
                                       "...X....\n"
                                       "......X.\n"
                                       ".X......\n"
                                       "....X...");
  holds(shade_draft_named("basket"), "..XX\n"
                                     "..XX\n"
                                     "XX..\n"
                                     "XX..");
  holds(shade_draft_named("herringbone"), "X..XX..X.XX..XX.\n"
                                          "XX..XX..XX..XX..\n"
                                          ".XX..XX.X..XX..X\n"
                                          "..XX..XX..XX..XX");
  assert_null(shade_draft_named("twill"));
  assert_null(shade_draft_named(NULL));
  const char *word, *label, *help;
  int row = 0;
  for (; shade_weave_row(row, &word, &label, &help); row++) {
    shade_draft *d = shade_draft_named(word);
    assert_non_null(d);
    assert_true(*label && *help);
    shade_draft_free(d);
  }
  assert_int_equal(row, 12);
}

static void patterns(void **state) {
  (void)state;
  holds(shade_draft_from_pattern(2, 1, 1), "..X\n"
                                           ".X.\n"
                                           "X..");
  holds(shade_draft_from_pattern(2, 1, -1), "..X\n"
                                            "X..\n"
                                            ".X.");
  holds(shade_draft_from_pattern(1, 3, 2), ".XXX\n"
                                           "XX.X");
  holds(shade_draft_from_pattern(1, 1, 0), ".X");
  holds(shade_draft_from_pattern(3, 0, 5), "...\n"
                                           "...\n"
                                           "...");
  holds(shade_draft_from_pattern(SHADE_WEFT_ONLY, 3, 7), ".");
  assert_null(shade_draft_from_pattern(0, 1, 1));
  assert_null(shade_draft_from_pattern(0, 0, 1));
  assert_null(shade_draft_from_pattern(-1, 3, 1));
  assert_null(shade_draft_from_pattern(3, -1, 1));
  assert_null(shade_draft_from_pattern(SHADE_WEFT_ONLY, -1, 0));
  assert_null(shade_draft_from_pattern(4000, 97, 1));
  shade_draft_free(shade_draft_from_pattern(4000, 96, 1));
  holds(shade_draft_from_pattern(1, 2, -2147483647 - 1), ".XX\n" /* -2^31 mod 3 = 1 */
                                                         "XX.\n"
                                                         "X.X");
  assert_null(shade_draft_create(0, 1));
  assert_null(shade_draft_create(1, SHADE_DRAFT_MAX_SIDE + 1));
  assert_null(shade_draft_create(SHADE_DRAFT_MAX_SIDE, 1025));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(named),
      cmocka_unit_test(patterns),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
