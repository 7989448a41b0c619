/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/* What the fuzzers found worth keeping (libshade/fuzz), once more: their targets abort when wrong.
 */
#include <dirent.h>
#include <string.h>

#include "support.h"

#define LLVMFuzzerTestOneInput fuzz_wif
#include "../fuzz/fuzz_wif.c"
#undef LLVMFuzzerTestOneInput
#define LLVMFuzzerTestOneInput fuzz_parse
#include "../fuzz/fuzz_parse.c"
#undef LLVMFuzzerTestOneInput
#define LLVMFuzzerTestOneInput fuzz_json
#include "../fuzz/fuzz_json.c"
#undef LLVMFuzzerTestOneInput

static void replay(const char *name, int (*target)(const uint8_t *, size_t)) {
  char path[600];
  snprintf(path, sizeof path, "libshade/fuzz/corpus/%s", name);
  DIR *folder = opendir(path);
  if (!folder)
    fail_msg("%s: not found; tests run in the repository's root", path);
  int count = 0;
  for (struct dirent *entry; (entry = readdir(folder));) {
    if (entry->d_name[0] == '.')
      continue;
    snprintf(path, sizeof path, "libshade/fuzz/corpus/%s/%s", name, entry->d_name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char *data = malloc(1 << 16);
    assert_non_null(data);
    size_t size = fread(data, 1, 1 << 16, file);
    fclose(file);
    uint8_t *exact = malloc(size ? size : 1); /* no byte more: reading beyond shows */
    assert_non_null(exact);
    memcpy(exact, data, size);
    free(data);
    assert_int_equal(target(exact, size), 0);
    free(exact);
    count++;
  }
  closedir(folder);
  assert_true(count > 0);
}

static void wif(void **state) {
  (void)state;
  replay("wif", fuzz_wif);
}
static void parse(void **state) {
  (void)state;
  replay("parse", fuzz_parse);
}
static void headers(void **state) {
  (void)state;
  replay("json", fuzz_json);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wif),
      cmocka_unit_test(parse),
      cmocka_unit_test(headers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
