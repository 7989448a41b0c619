/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kinds of closure, by number. Each group is compiled by itself, isa/closure_<group>.c. */
#ifndef LIBSHADE_CLOSURE_TABLE_H
#define LIBSHADE_CLOSURE_TABLE_H

#define CLOSURES_METAL(ROW) ROW(METAL, metal, CLOSURE_SCATTERS)
#define CLOSURES_GLASS(ROW)                                                                        \
  ROW(GLASS, glass, CLOSURE_SCATTERS | CLOSURE_CLEAR)                                              \
  ROW(COAT, coat, CLOSURE_SCATTERS)
#define CLOSURES_MATT(ROW)                                                                         \
  ROW(DIFFUSE, diffuse, CLOSURE_SCATTERS | CLOSURE_MATT)                                           \
  ROW(TRANSLUCENT, translucent, CLOSURE_SCATTERS | CLOSURE_MATT | CLOSURE_THROUGH)                 \
  ROW(SHEEN, sheen, CLOSURE_SCATTERS | CLOSURE_MATT)                                               \
  ROW(TOON, toon, CLOSURE_SCATTERS)
#define CLOSURES_PLAIN(ROW)                                                                        \
  ROW(FABRIC, fabric, CLOSURE_SCATTERS | CLOSURE_MATT | CLOSURE_GROOVED)                           \
  ROW(TRANSPARENT, transparent, CLOSURE_PASSES)                                                    \
  ROW(EMISSION, emission, 0u)
#define CLOSURE_TABLE(ROW)                                                                         \
  CLOSURES_METAL(ROW)                                                                              \
  CLOSURES_GLASS(ROW)                                                                              \
  CLOSURES_MATT(ROW)                                                                               \
  CLOSURES_PLAIN(ROW)

/* Those that are not white have closure_<name>_color: what planes of colour show of channel k. */
#define CLOSURES_COLORED(ROW)                                                                      \
  ROW(METAL, metal)                                                                                \
  ROW(DIFFUSE, diffuse)                                                                            \
  ROW(FABRIC, fabric)

#define CLOSURE_TYPE(TYPE, name, always) CLOSURE_##TYPE,
typedef enum closure_type { CLOSURE_TABLE(CLOSURE_TYPE) CLOSURE_TYPES } closure_type;

#endif
