/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Prepares hits on `cloth` for the lights and the draw of its closure, which takes the same:
 * `place`, the registers that WEAVE wrote, `normal`, and, where colours vary, `warp_from` and
 * `weft_from`, three operands each. Writes `out`, one number: the share of the eye's ray that meets
 * cloth.
 */
#ifndef LIBSHADE_NODE_CLOTH_H
#define LIBSHADE_NODE_CLOTH_H

#include "node/common.h"
#include "scene/cloth.h"

typedef struct cloth_use {
  const cloth *cloth;
  operand place[4], warp[3], weft[3];
  int normal[3];
} cloth_use;

typedef struct node_cloth {
  cloth_use use;
  int out[1];
} node_cloth;

static inline bool cloth_use_colors(reader *r, const graph *g, const char *key, operand *out) {
  for (int k = 0; k < 3; k++)
    out[k] = (operand){.at = OPERAND_NUMBER};
  return !reader_has(r, key) || graph_operands(r, g, key, 3, out);
}

static inline bool cloth_use_read(reader *r, cloth_use *c, graph *g) {
  int number;
  if (!reader_integer(r, "cloth", 0, (long)g->cloths - 1, &number) ||
      !graph_operands(r, g, "place", 4, c->place) ||
      !cloth_use_colors(r, g, "warp_from", c->warp) ||
      !cloth_use_colors(r, g, "weft_from", c->weft) || !graph_normal(r, g, c->normal))
    return false;
  for (int k = 0; k < 4; k++)
    if (c->place[k].at < 0)
      return reader_fail(r, "place must be four registers");
  c->cloth = &g->cloth[number];
  return true;
}

static inline bool node_cloth_read(reader *r, node_cloth *n, graph *g) {
  return cloth_use_read(r, &n->use, g) && graph_outputs(r, g, "out", 1, n->out);
}

static inline bool node_cloth_build(node_cloth *n, const node_place *place) {
  (void)n, (void)place;
  return true;
}

/* A colour's lanes for the library, from lane i on: all three or none. */
static inline void cloth_use_lanes(inputs *given, const operand from[3], int place, lane_run run,
                                   const float *out[3]) {
  bool varies = (from[0].at >= 0) | (from[1].at >= 0) | (from[2].at >= 0);
  for (int k = 0; k < 3; k++)
    out[k] = varies ? lane_of(given, from[k], place + k, run) + run.begin : NULL;
}

/* What the library is to know of a run's hits, but for light. */
static inline shade_fabric_lanesf cloth_lanes(const cloth_use *c, lane_run run, const surfaces *at,
                                              inputs *given) {
  const size_t i = run.begin;
  const float *warp[3], *weft[3];
  cloth_use_lanes(given, c->warp, 0, run, warp);
  cloth_use_lanes(given, c->weft, 3, run, weft);
  return (shade_fabric_lanesf){.size = sizeof(shade_fabric_lanesf),
                               .u = given->at[c->place[0].at] + i,
                               .v = given->at[c->place[1].at] + i,
                               .du = given->at[c->place[2].at] + i,
                               .dv = given->at[c->place[3].at] + i,
                               .nx = given->at[c->normal[0]] + i,
                               .ny = given->at[c->normal[1]] + i,
                               .nz = given->at[c->normal[2]] + i,
                               .wox = at->wo.x + i,
                               .woy = at->wo.y + i,
                               .woz = at->wo.z + i,
                               .random = given->single ? given->term + i : NULL,
                               .warp_r = warp[0],
                               .warp_g = warp[1],
                               .warp_b = warp[2],
                               .weft_r = weft[0],
                               .weft_g = weft[1],
                               .weft_b = weft[2]};
}

/* Room for a run's hits, or NULL: then each call prepares them anew. */
static inline void *cloth_take_room(cloth_room *room, lane_run run, int place) {
  if (!room || room->runs == CLOTH_RUNS)
    return NULL;
  size_t size = shade_fabric_hits_sizef(run.end - run.begin);
  if (size > room->size - room->used)
    return NULL;
  void *hits = room->bytes + room->used;
  room->used += size;
  room->run[room->runs].begin = run.begin;
  room->run[room->runs].end = run.end;
  room->run[room->runs].place = place;
  room->run[room->runs++].hits = hits;
  return hits;
}

/* The calls to the library are all there is to it. */
static inline void node_cloth_run(const node_cloth *n, lane_run g, const corners *corner,
                                  const surfaces *point, inputs *at) {
  const cloth_use *c = &n->use;
  const shade_fabric *fabric = c->cloth->fabric;
  size_t count = g.end - g.begin;
  shade_fabric_lanesf in = cloth_lanes(c, g, point, at);
  shade_fabric_resultf out = {.size = sizeof out, .coverage = at->at[n->out[0]] + g.begin};
  (void)corner;
  void *hits = at->single ? cloth_take_room(at->cloth, g, c->place[0].at) : NULL;
  if (hits) {
    shade_fabric_prepare_batchf(fabric, count, &in, SHADE_TIER_AUTO, hits, &out);
    return;
  }
  in.wix = in.wox; /* only the coverage is wanted, but it comes with a reflection */
  in.wiy = in.woy;
  in.wiz = in.woz;
  static _Thread_local lane_c unused;
  out.r = unused.r;
  out.g = unused.g;
  out.b = unused.b;
  shade_fabric_eval_batchf(fabric, count, &in, SHADE_TIER_AUTO, &out);
}

#endif
