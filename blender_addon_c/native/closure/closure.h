/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Kinds of closure: what a surface does with light. A material has a list of them, each with a
 * weight. Each kind is one file, closure/<name>.h, with
 *
 *   closure_<name>            what it keeps
 *   closure_<name>_read       reads it from a scene; tells the graph what is its own of its traits
 *   closure_<name>_albedo     how much light it sends on, roughly: the more, the likelier a draw
 *   closure_<name>_eval       f and cosine for a run of hits; the density of its draws if asked
 *   closure_<name>_draw       directions, with f, cosine and density
 *
 * and one row: ROW(TYPE, name, always). TYPE is the word in a scene, CLOSURE_TYPE its number,
 * stage_<name> its stage and closure_<name> its clock; `always` are the traits (scene/material.h)
 * that all of the kind have.
 */
#ifndef LIBSHADE_CLOSURE_H
#define LIBSHADE_CLOSURE_H

#include "closure/coat.h"
#include "closure/diffuse.h"
#include "closure/emission.h"
#include "closure/fabric.h"
#include "closure/glass.h"
#include "closure/metal.h"
#include "closure/sheen.h"
#include "closure/toon.h"
#include "closure/translucent.h"
#include "closure/transparent.h"

#define CLOSURE_TABLE(ROW)                                                                         \
  ROW(METAL, metal, CLOSURE_SCATTERS)                                                              \
  ROW(DIFFUSE, diffuse, CLOSURE_SCATTERS | CLOSURE_MATT)                                           \
  ROW(TRANSLUCENT, translucent, CLOSURE_SCATTERS | CLOSURE_MATT | CLOSURE_THROUGH)                 \
  ROW(FABRIC, fabric, CLOSURE_SCATTERS | CLOSURE_MATT | CLOSURE_GROOVED)                           \
  ROW(GLASS, glass, CLOSURE_SCATTERS | CLOSURE_CLEAR)                                              \
  ROW(COAT, coat, CLOSURE_SCATTERS)                                                                \
  ROW(SHEEN, sheen, CLOSURE_SCATTERS | CLOSURE_MATT)                                               \
  ROW(TOON, toon, CLOSURE_SCATTERS)                                                                \
  ROW(TRANSPARENT, transparent, CLOSURE_PASSES)                                                    \
  ROW(EMISSION, emission, 0u)

/* Those that are not white have closure_<name>_color: what planes of colour show of channel k. */
#define CLOSURES_COLORED(ROW)                                                                      \
  ROW(METAL, metal)                                                                                \
  ROW(DIFFUSE, diffuse)                                                                            \
  ROW(FABRIC, fabric)

#define CLOSURE_TYPE(TYPE, name, always) CLOSURE_##TYPE,
typedef enum closure_type { CLOSURE_TABLE(CLOSURE_TYPE) CLOSURE_TYPES } closure_type;

#define CLOSURE_MEMBER(TYPE, name, always) closure_##name name;
typedef struct closure {
  closure_type type;
  unsigned traits;        /* its kind's and its own */
  double exponent, focus; /* how sharp it is; how much light it gathers as a mirror or lens */
  operand weight[3];
  bool colored;     /* in passes of colour it is not what the closure itself says, */
  operand color[3]; /* but this, times the weight */
  union {
    CLOSURE_TABLE(CLOSURE_MEMBER)
  } of;
} closure;

#endif
