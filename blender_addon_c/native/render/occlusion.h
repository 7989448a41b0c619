/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rays that nodes cast from points of surfaces: what stands about them. */
#ifndef LIBSHADE_OCCLUSION_H
#define LIBSHADE_OCCLUSION_H

#include "render/state.h"
#include "node/bevel.h"
#include "node/occlusion.h"
#include "scene/scene.h"

/* Room of a batch for them, where the scene wants any. False when out of memory. */
bool occlusion_init(batch *b, const scene *s);
void occlusion_free(batch *b);

/* Its rays, of which each starts from a lane of the batch, and what they meet: hits that `locate`
 * has found. NULL where the scene wants none. */
typedef struct occlusion {
  rays ray;
  hits hit;
  lane_u lane;
  lane_f stopped, turn, spin;
  /* of bevels: the axis, with which chances it and the two across it were drawn, and how far aside
   */
  lane_v around, axis, aside, other;
  lane_f chance[3], off;
  corners corner;
} occlusion;

/* Two numbers in [0, 1) for each point of a run, o->turn and o->spin. */
void occlusion_draw(occlusion *o, const surfaces *at, lane_run run);

/* The next surfaces on the way of rays, and whether that is the point's own object. */
void occlusion_next(const scene *s, occlusion *o, size_t count);
bool occlusion_own(const scene *s, const batch *b, const occlusion *o, size_t i);

/* Ray i goes on behind what it met, as ray `to`, as far as `far`. */
void occlusion_pass(occlusion *o, size_t i, size_t to, float far);

/* How many rays of each point of the run something stops: b->input.stopped. */
void occlusion_trace(const scene *s, batch *b, lane_run run, const node_occlusion *n);

/* Sums of the normals about each point of the run: b->input.around. */
void bevel_trace(const scene *s, batch *b, lane_run run, const node_bevel *n);

#endif
