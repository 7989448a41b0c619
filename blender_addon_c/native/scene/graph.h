/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A material's graph while it is read: nodes and closures read only what an earlier node wrote. */
#ifndef LIBSHADE_GRAPH_H
#define LIBSHADE_GRAPH_H

#include <stdint.h>

#include "scene/cloth.h"
#include "scene/features.h"
#include "scene/reader.h"
#include "scene/scratches.h"

typedef struct graph {
  size_t images; /* of the scene */
  const cloth *cloth;
  size_t cloths;
  const scratches *scratches;
  size_t scratch_fields;
  size_t layers, attributes;
  features *features;
  uint64_t written[REGISTERS / 64]; /* registers, a bit each */
  bool bare;                        /* something takes the unperturbed normal */
  int normal[3];                    /* the first that something takes since `named` was false */
  bool named;
  bool dump; /* one is written: it holds what the library says */
  /* of the closure at hand, whose _read says more than its kind does; */
  unsigned traits;        /* closure_trait */
  double exponent, focus; /* how sharp it is; how much light it gathers; 0 */
  unsigned status;        /* and of all: what had to be clamped, bits of libshade */
} graph;
_Static_assert(REGISTERS % 64 == 0, "graph.written has a bit for each register");

static inline bool graph_has(const graph *g, int at) {
  return g->written[at / 64] >> at % 64 & 1;
}

static inline bool graph_operands(reader *r, const graph *g, const char *key, int count,
                                  operand *out) {
  if (!reader_operands(r, key, count, out))
    return false;
  for (int k = 0; k < count; k++)
    if (out[k].at >= 0 && !graph_has(g, out[k].at))
      return reader_fail(r, "%s: no node before has written register %d", key, out[k].at);
  return true;
}

/* Registers that a node writes, up to eight. */
static inline bool graph_outputs(reader *r, graph *g, const char *key, int count, int *out) {
  operand o[8];
  if (!reader_operands(r, key, count, o))
    return false;
  for (int k = 0; k < count; k++) {
    if (o[k].at < REGISTER_FIRST)
      return reader_fail(r, "%s must be registers from %d on", key, REGISTER_FIRST);
    g->written[o[k].at / 64] |= (uint64_t)1 << o[k].at % 64;
    out[k] = o[k].at;
  }
  return true;
}

/* `normal`: registers of a normal in the shading frame; without it the unperturbed one. */
static inline bool graph_normal(reader *r, graph *g, int out[3]) {
  operand o[3] = {
      {.at = REGISTER_NORMAL}, {.at = REGISTER_NORMAL + 1}, {.at = REGISTER_NORMAL + 2}};
  if (!reader_has(r, "normal"))
    g->bare = true;
  else if (!graph_operands(r, g, "normal", 3, o))
    return false;
  for (int k = 0; k < 3; k++) {
    if ((out[k] = o[k].at) < 0)
      return reader_fail(r, "normal must be three registers");
    g->normal[k] = g->named ? g->normal[k] : out[k];
  }
  g->named = true;
  return true;
}

#endif
