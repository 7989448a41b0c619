/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/* LIBSHADE_ISA: what is made ready runs on the instruction set that it names, to the last bit. */
#include <string.h>

#include "shade/fabric.h"
#include "model/fabric.h"
#include "model/weave_private.h"
#include "port/process.h"
#include "support.h"

enum { COUNT = 512 };

static float in[6][COUNT], own[4][COUNT], want[4][COUNT];

static void fill(void) {
  uint64_t seed = 4;
  for (int i = 0; i < COUNT; i++) {
    double n[3], h[3];
    spherical(0.5 * uniform(&seed), 2 * PI * uniform(&seed), n);
    spherical(1.2 * uniform(&seed), 2 * PI * uniform(&seed), h);
    for (int c = 0; c < 3; c++) {
      in[c][i] = (float)n[c];
      in[3 + c][i] = (float)h[c];
    }
  }
}

/* Public calls give what the table of that name gives; returns a hash of their bits. */
static uint64_t runs_on(const shade_isa_table *isa) {
  assert_string_equal(shade_isa(), isa->name);
  shade_params p;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_GGX;
  p.brdf = SHADE_BRDF_MICROFACET;
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  const shade_lanesf lanes = {.size = sizeof lanes,
                              .nx = in[0],
                              .ny = in[1],
                              .nz = in[2],
                              .wix = in[3],
                              .wiy = in[4],
                              .wiz = in[5],
                              .wox = in[0],
                              .woy = in[1],
                              .woz = in[2]};
  const shade_resultf here = {
      .size = sizeof here, .r = own[0], .g = own[1], .b = own[2], .cosine = own[3]};
  const shade_resultf there = {
      .size = sizeof there, .r = want[0], .g = want[1], .b = want[2], .cosine = want[3]};
  assert_int_equal(shade_bsdf_eval_batchf(&b, COUNT, &lanes, &here), SHADE_OK);
  assert_int_equal(isa->entriesf->bsdf_batch(&b, COUNT, &lanes, &there), SHADE_OK);
  assert_memory_equal(own, want, sizeof own);
  uint64_t hash = 14695981039346656037u;
  for (size_t i = 0; i < sizeof own; i++)
    hash = (hash ^ ((const unsigned char *)own)[i]) * 1099511628211u;

  /* what keeps its choice otherwise */
  shade_draft *draft = shade_draft_create(1, 1);
  shade_weave *weave = shade_weave_create(draft, NULL, NULL);
  shade_fabric *fabric = shade_fabric_create(weave, NULL, NULL);
  assert_true(draft && weave && fabric);
  assert_ptr_equal(shade_isa_tables[weave->isa], isa);
  assert_ptr_equal(shade_isa_tables[fabric->isa], isa);
  assert_ptr_equal(shade_isa_tables[bsdf_of(&fabric->side[0].lobe[FABRIC_NEAR])->isa], isa);
  shade_fabric_free(fabric);
  shade_weave_free(weave);
  shade_draft_free(draft);
  return hash;
}

static void each(void **state) {
  (void)state;
  uint64_t first = 0;
  int rows = 0, others = 0;
  fill();
  for (const shade_isa_table *isa; (isa = shade_isa_pick(rows)); rows++) {
    char wrong[160] = "nothing";
    shade_port_set_variable(SHADE_ISA_VARIABLE, isa->name);
    assert_int_equal(shade_isa_check(wrong, sizeof wrong), 0);
    assert_string_equal(wrong, "nothing");
    const uint64_t hash = runs_on(isa);
    first = rows ? first : hash;
    others += hash != first;
  }
  assert_true(rows >= 1);
  if (rows > 2) /* fused or not, bits differ: else the comparison above would see nothing */
    assert_true(others > 0);
}

static void unset_or_unknown(void **state) {
  (void)state;
  const char *const widest = shade_isa_pick(0)->name;
  static const char *const unknown[] = {"AVX2", "avx", "vax", "avx512 ", "0"};
  char wrong[160];
  shade_port_set_variable(SHADE_ISA_VARIABLE, NULL);
  assert_string_equal(shade_isa(), widest);
  assert_int_equal(shade_isa_check(wrong, sizeof wrong), 0);
  shade_port_set_variable(SHADE_ISA_VARIABLE, "");
  assert_string_equal(shade_isa(), widest);
  assert_int_equal(shade_isa_check(wrong, sizeof wrong), 0);
  for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
    shade_port_set_variable(SHADE_ISA_VARIABLE, unknown[i]);
    assert_string_equal(shade_isa(), widest);
    assert_int_equal(shade_isa_check(wrong, sizeof wrong), -1);
    assert_non_null(strstr(wrong, unknown[i]));
    assert_non_null(strstr(wrong, "scalar"));
    assert_non_null(strstr(wrong, widest));
  }
  char small[8];
  assert_int_equal(shade_isa_check(small, sizeof small), -1);
  assert_int_equal(strlen(small), sizeof small - 1);
  shade_port_set_variable(SHADE_ISA_VARIABLE, NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(each), cmocka_unit_test(unset_or_unknown)};
  return cmocka_run_group_tests_name("isa", tests, NULL, NULL);
}
