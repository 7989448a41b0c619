/* SPDX-License-Identifier: Apache-2.0 */
/* The one table of instruction sets: what each needs, and which of them is used. */
#include "../batch/isa.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "port/processor.h"

/*
 * ROW(name, what the CPU must have), from the narrowest: a later one is preferred. avx512 is
 * x86-64-v4 but for what every CPU with AVX-512 has and clang 14 cannot ask for.
 */
#if defined(__x86_64__)
#define HAS(feature) shade_port_processor_has(feature)
#define ISA_ROWS(ROW)                                                                              \
  ROW(scalar, 1)                                                                                   \
  ROW(sse2, 1)                                                                                     \
  ROW(avx2, HAS("avx2") && HAS("fma"))                                                             \
  ROW(avx512, HAS("avx512f") && HAS("avx512bw") && HAS("avx512cd") && HAS("avx512dq") &&           \
                  HAS("avx512vl") && HAS("bmi") && HAS("bmi2") && HAS("avx2") && HAS("fma"))
#elif defined(__aarch64__) /* which has NEON, always */
#define ISA_ROWS(ROW) ROW(scalar, 1) ROW(neon, 1)
#else
#define ISA_ROWS(ROW) ROW(scalar, 1)
#endif

#define ISA_TABLE(name, needs)                                                                     \
  extern const shade_entries shade_entries_##name;                                                 \
  extern const shade_entriesf shade_entriesf_##name;                                               \
  const shade_isa_table shade_isa_##name = {#name, &shade_entries_##name, &shade_entriesf_##name};
ISA_ROWS(ISA_TABLE)
#define ISA_POINTER(name, needs) &shade_isa_##name,
#define ISA_ENTRIES(name, needs) &shade_entries_##name,
#define ISA_ENTRIESF(name, needs) &shade_entriesf_##name,
const shade_isa_table *const shade_isa_tables[] = {ISA_ROWS(ISA_POINTER)};
const shade_entries *const shade_isa_entries[] = {ISA_ROWS(ISA_ENTRIES)};
const shade_entriesf *const shade_isa_entriesf[] = {ISA_ROWS(ISA_ENTRIESF)};

enum { ISAS = sizeof shade_isa_tables / sizeof shade_isa_tables[0] };

static int runs(int isa) {
  int row = 0;
#define ISA_RUNS(name, needs)                                                                      \
  if (row++ == isa)                                                                                \
    return needs;
  ISA_ROWS(ISA_RUNS)
  return 0;
}

const shade_isa_table *shade_isa_pick(int row) {
  for (int isa = ISAS - 1; isa >= 0; isa--)
    if (runs(isa) && row-- == 0)
      return shade_isa_tables[isa];
  return NULL;
}

static int widest(void) {
  int isa = ISAS - 1;
  while (!runs(isa))
    isa--;
  return isa;
}

/* The one that the environment names, or -1. */
static int wished(const char *name) {
  for (int isa = 0; name && isa < ISAS; isa++)
    if (!strcmp(name, shade_isa_tables[isa]->name) && runs(isa))
      return isa;
  return -1;
}

int shade_isa_chosen(void) {
  const int wish = wished(getenv(SHADE_ISA_VARIABLE));
  return wish >= 0 ? wish : widest();
}

const char *shade_isa(void) {
  return shade_isa_tables[shade_isa_chosen()]->name;
}

int shade_isa_check(char *error, size_t size) {
  const char *name = getenv(SHADE_ISA_VARIABLE);
  if (!name || !name[0] || wished(name) >= 0)
    return 0;
  char there[64] = "";
  for (int isa = 0; isa < ISAS; isa++)
    if (runs(isa)) {
      strcat(there, there[0] ? ", " : "");
      strcat(there, shade_isa_tables[isa]->name);
    }
  snprintf(error, size, SHADE_ISA_VARIABLE " '%.60s': this CPU has %s; %s is used", name, there,
           shade_isa_tables[widest()]->name);
  return -1;
}
