/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/* How many pits a field of scratches takes: of all layers together, which to make would take
 * seconds. */
#include "support.h"

#include "../src/scratch.c"

static void pits_of_all_layers(void **state) {
  (void)state;
  const struct {
    uint32_t given[3], taken[3];
    unsigned status;
  } cases[] = {
      {{1500000, 2499999, 1}, {1500000, 2499999, 1}, SHADE_OK},
      {{3000000, 2000000, 7}, {3000000, 1000000, 0}, SHADE_CLAMPED_PARAMETER},
      {{4000001, 5, 0}, {4000000, 0, 0}, SHADE_CLAMPED_PARAMETER},
      {{0, 0, UINT32_MAX}, {0, 0, 4000000}, SHADE_CLAMPED_PARAMETER},
  };
  for (int i = 0; i < 4; i++) {
    shade_scratch_params p;
    shade_scratch_params_init(&p);
    p.layers = 3;
    for (int k = 0; k < 3; k++)
      p.layer[k].pits = cases[i].given[k];
    unsigned status = SHADE_OK;
    const shade_scratch_params got = within_ranges(&p, &status);
    assert_int_equal(status, cases[i].status);
    assert_int_equal(got.layers, 3);
    for (int k = 0; k < 3; k++)
      assert_int_equal(got.layer[k].pits, cases[i].taken[k]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(pits_of_all_layers)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
