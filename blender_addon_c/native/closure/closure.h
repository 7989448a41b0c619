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
 * and one row of closure/table.h: ROW(TYPE, name, always). TYPE is the word in a scene,
 * CLOSURE_TYPE its number, stage_<name> its stage and closure_<name> its clock; `always` are the
 * traits (scene/material.h) that all of the kind have.
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
#include "closure/table.h"

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
