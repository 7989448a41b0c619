/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "stage/stage.h"

const stage_table *stages_choose(void) {
  static const stage_table *const tables[] = {&stages_scalar, &stages_sse2, &stages_avx2,
                                              &stages_avx512};
  const char *name = shade_isa();
  for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
    if (strcmp(tables[i]->name, name) == 0)
      return tables[i];
  return tables[0];
}
