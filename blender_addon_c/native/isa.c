/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <stdlib.h>
#include <string.h>

#include "batch.h"

const stage_table *stages_choose(void) {
  const char *wish = getenv("LIBSHADE_ISA");
  bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  /* the parts of x86-64-v4; clang 14 does not know that name here */
  bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                __builtin_cpu_supports("avx512vl");
  if (wish && strcmp(wish, "sse2") == 0)
    return &stages_sse2;
  if (avx512 && !(wish && strcmp(wish, "avx2") == 0))
    return &stages_avx512;
  return avx2 ? &stages_avx2 : &stages_sse2;
}
