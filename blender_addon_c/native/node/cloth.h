/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Prepares hits on `cloth` for the lights and the draw of its closure, which takes the same:
 * `place` and `frame`, the registers that WEAVE wrote, `normal`, and, where they vary, `warp_from`
 * and `weft_from`, three operands each, `gloss_from` and `nap_from`, one each. Writes `out`, one
 * number: the share of the eye's ray that meets cloth.
 */
#ifndef LIBSHADE_NODE_CLOTH_H
#define LIBSHADE_NODE_CLOTH_H

#include <string.h>

#include "node/common.h"
#include "scene/cloth.h"

typedef struct cloth_use {
  const cloth *cloth;
  operand place[4], warp[3], weft[3];
  operand gloss, nap; /* if `glossed`, `napped` */
  int normal[3];
  int frame[2]; /* if `framed`: registers, where the cloth's x axis is in the shading frame */
  bool glossed, napped, framed;
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

/* A number that varies, if it is there. */
static inline bool cloth_use_number(reader *r, const graph *g, const char *key, operand *out,
                                    bool *there) {
  *there = reader_has(r, key);
  return !*there || graph_operands(r, g, key, 1, out);
}

static inline bool cloth_use_frame(reader *r, const graph *g, cloth_use *c) {
  operand o[2];
  c->framed = reader_has(r, "frame");
  if (c->framed && !graph_operands(r, g, "frame", 2, o))
    return false;
  for (int k = 0; k < 2 && c->framed; k++)
    if ((c->frame[k] = o[k].at) < 0)
      return reader_fail(r, "frame must be two registers");
  return true;
}

static inline bool cloth_use_read(reader *r, cloth_use *c, graph *g) {
  int number;
  if (!reader_integer(r, "cloth", 0, (long)g->cloths - 1, &number) ||
      !graph_operands(r, g, "place", 4, c->place) ||
      !cloth_use_colors(r, g, "warp_from", c->warp) ||
      !cloth_use_colors(r, g, "weft_from", c->weft) ||
      !cloth_use_number(r, g, "gloss_from", &c->gloss, &c->glossed) ||
      !cloth_use_number(r, g, "nap_from", &c->nap, &c->napped) || !cloth_use_frame(r, g, c) ||
      !graph_normal(r, g, c->normal))
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

/* A colour's lanes for the library, from lane i on: all three or none. */
static inline void cloth_use_lanes(inputs *given, const operand from[3], int place, lane_run run,
                                   const float *out[3]) {
  bool varies = (from[0].at >= 0) | (from[1].at >= 0) | (from[2].at >= 0);
  for (int k = 0; k < 3; k++)
    out[k] = varies ? lane_of(given, from[k], place + k, run) + run.begin : NULL;
}

/* The cloth's own frame, where that is turned: x and y of directions into it (back: out of it). */
LEAF void cloth_turn(const cloth_use *c, lane_run run, const inputs *given, bool back,
                     const float *x, const float *y, float *restrict tx, float *restrict ty) {
  const float *cosine = given->at[c->frame[0]], *sine = given->at[c->frame[1]];
  const float sign = back ? -1.0f : 1.0f;
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float a = x[i], b = y[i], s = sign * sine[i];
    tx[i] = cosine[i] * a + s * b;
    ty[i] = cosine[i] * b - s * a;
  }
}
/* Light, in that frame, and what is drawn there, back in the surface's. */
typedef struct cloth_light {
  lane_f x, y;
} cloth_light;
static inline void cloth_light_in(const cloth_use *c, lane_run run, const inputs *given,
                                  const lane_v *wi, cloth_light *own, shade_fabric_lanesf *in) {
  if (c->framed)
    cloth_turn(c, run, given, false, wi->x, wi->y, own->x, own->y);
  in->wix = (c->framed ? own->x : wi->x) + run.begin;
  in->wiy = (c->framed ? own->y : wi->y) + run.begin;
  in->wiz = wi->z + run.begin;
}
static inline void cloth_light_out(const cloth_use *c, lane_run run, const inputs *given,
                                   cloth_light *own, lane_v *wi) {
  if (!c->framed)
    return;
  memcpy(own->x + run.begin, wi->x + run.begin, (run.end - run.begin) * sizeof *own->x);
  memcpy(own->y + run.begin, wi->y + run.begin, (run.end - run.begin) * sizeof *own->y);
  cloth_turn(c, run, given, true, own->x, own->y, wi->x, wi->y);
}

/* What the library is to know of a run's hits, but for light; of hits that are `prepared` it asks
 * no more. */
static inline shade_fabric_lanesf cloth_lanes(const cloth_use *c, lane_run run, const surfaces *at,
                                              inputs *given, bool prepared) {
  static _Thread_local struct { lane_f nx, ny, wox, woy; } own;
  const size_t i = run.begin;
  const float *warp[3], *weft[3], *nx = given->at[c->normal[0]], *ny = given->at[c->normal[1]];
  const float *wox = at->wo.x, *woy = at->wo.y;
  if (prepared)
    return (shade_fabric_lanesf){.size = sizeof(shade_fabric_lanesf)};
  if (c->framed) {
    cloth_turn(c, run, given, false, nx, ny, own.nx, own.ny);
    cloth_turn(c, run, given, false, wox, woy, own.wox, own.woy);
    nx = own.nx, ny = own.ny, wox = own.wox, woy = own.woy;
  }
  cloth_use_lanes(given, c->warp, 0, run, warp);
  cloth_use_lanes(given, c->weft, 3, run, weft);
  const float *gloss = c->glossed ? lane_of(given, c->gloss, 6, run) + i : NULL;
  return (shade_fabric_lanesf){.size = sizeof(shade_fabric_lanesf),
                               .u = given->at[c->place[0].at] + i,
                               .v = given->at[c->place[1].at] + i,
                               .du = given->at[c->place[2].at] + i,
                               .dv = given->at[c->place[3].at] + i,
                               .nx = nx + i,
                               .ny = ny + i,
                               .nz = given->at[c->normal[2]] + i,
                               .wox = wox + i,
                               .woy = woy + i,
                               .woz = at->wo.z + i,
                               .random = given->single ? given->term + i : NULL,
                               .warp_r = warp[0],
                               .warp_g = warp[1],
                               .warp_b = warp[2],
                               .weft_r = weft[0],
                               .weft_g = weft[1],
                               .weft_b = weft[2],
                               .warp_gloss = gloss,
                               .weft_gloss = gloss,
                               .nap = c->napped ? lane_of(given, c->nap, 7, run) + i : NULL,
                               .neighbours = given->beside};
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

/* Whether some footprint is between the near model and the far one, as shade/fabric.h has it. */
LEAF bool cloth_between(lane_run run, const float *du, const float *dv) {
  int any = 0;
#pragma omp simd reduction(| : any)
  for (size_t i = run.begin; i < run.end; i++) {
    const float longer = du[i] > dv[i] ? du[i] : dv[i];
    any |= (longer > 0.75f) & (longer < 2.0f);
  }
  return any;
}

/* The calls to the library are all there is to it. */
static inline void node_cloth_run(const node_cloth *n, lane_run g, const corners *corner,
                                  const surfaces *point, inputs *at) {
  const cloth_use *c = &n->use;
  const shade_fabric *fabric = c->cloth->fabric;
  size_t count = g.end - g.begin;
  shade_fabric_lanesf in = cloth_lanes(c, g, point, at, false);
  shade_fabric_resultf out = {.size = sizeof out, .coverage = at->at[n->out[0]] + g.begin};
  (void)corner;
  if (at->single && at->cloth && c->cloth->tier == SHADE_TIER_AUTO)
    at->cloth->between |= cloth_between(g, at->at[c->place[2].at], at->at[c->place[3].at]);
  void *hits = at->single ? cloth_take_room(at->cloth, g, c->place[0].at) : NULL;
  if (hits) {
    shade_fabric_prepare_batchf(fabric, count, &in, c->cloth->tier, hits, &out);
    return;
  }
  in.wix = in.wox; /* only the coverage is wanted, but it comes with a reflection */
  in.wiy = in.woy;
  in.wiz = in.woz;
  static _Thread_local lane_c unused;
  out.r = unused.r;
  out.g = unused.g;
  out.b = unused.b;
  shade_fabric_eval_batchf(fabric, count, &in, c->cloth->tier, &out);
}

#endif
