/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables of stages, each of its families' parts. */
#include <string.h>

#include "stage/stage.h"

#include "system/threads.h"

/* isa/<family>.c, all that there are */
#define FAMILIES(ROW, isa)                                                                         \
  ROW(camera, isa)                                                                                 \
  ROW(surface, isa)                                                                                \
  ROW(node_image, isa)                                                                             \
  ROW(node_normal, isa)                                                                            \
  ROW(node_layer, isa)                                                                             \
  ROW(node_place, isa)                                                                             \
  ROW(node_value, isa)                                                                             \
  ROW(node_noise, isa)                                                                             \
  ROW(node_voronoi, isa)                                                                           \
  ROW(node_cloth, isa)                                                                             \
  ROW(light, isa)                                                                                  \
  ROW(closure_metal, isa)                                                                          \
  ROW(closure_glass, isa)                                                                          \
  ROW(closure_matt, isa)                                                                           \
  ROW(closure_plain, isa)                                                                          \
  ROW(paths, isa)
#define DECLARE(family, isa) extern const stage_table stages_##family##_##isa;
#define PART(family, isa) &stages_##family##_##isa,
#define TABLE(isa) {#isa, {FAMILIES(PART, isa) NULL}},

/* those that libshade's isa.c has */
#if defined(__x86_64__)
#define SETS_OF_STAGES(ROW) ROW(scalar) ROW(sse2) ROW(avx2) ROW(avx512)
#elif defined(__aarch64__)
#define SETS_OF_STAGES(ROW) ROW(scalar) ROW(neon)
#else
#define SETS_OF_STAGES(ROW) ROW(scalar)
#endif
#define DECLARED(isa) FAMILIES(DECLARE, isa)
SETS_OF_STAGES(DECLARED)

static const struct {
  const char *name;
  const stage_table *part[24];
} sets[] = {SETS_OF_STAGES(TABLE)};
enum { SETS = sizeof sets / sizeof sets[0], STAGES = sizeof(stage_table) / sizeof(void (*)(void)) };

/* A table as a row of stages; its first place is the name's. */
typedef union row {
  stage_table table;
  void (*stage[STAGES])(void);
} row;
static row tables[SETS];

static void assemble(void) {
  for (size_t k = 0; k < SETS; k++) {
    for (const stage_table *const *part = sets[k].part; *part; part++)
      for (size_t i = 0; i < STAGES; i++)
        if (((const row *)*part)->stage[i])
          tables[k].stage[i] = ((const row *)*part)->stage[i];
    tables[k].table.name = sets[k].name;
  }
}

const stage_table *stages_of(const char *isa) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, assemble);
  for (size_t k = 0; k < SETS; k++)
    if (strcmp(sets[k].name, isa) == 0)
      return &tables[k].table;
  return &tables[0].table;
}

const stage_table *stages_choose(void) {
  return stages_of(shade_isa());
}
