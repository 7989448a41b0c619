/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All that one thread holds of the batch it works on. */
#ifndef LIBSHADE_STATE_H
#define LIBSHADE_STATE_H

#include "batch/lanes.h"
#include "scene/queue.h"
#include "scene/object.h"
#include "scene/scene.h"

typedef struct batch {
  /* by sample; rays and hits after the first bounce by ray */
  paths path;
  rays sample_ray;
  hits sample_hit;
  lane_c sample_color;
  /* by hit */
  queue queue;
  rays *ray; /* those cast last, or moved_ray */
  hits *hit;
  rays moved_ray;
  hits moved_hit;
  /* The scene's tables, or, where something moves, copies with room for one of its own a hit. */
  const placed *placed;
  const object *object;
  placed *own_placed;
  object *own_object;
  corners corner;
  surfaces surface;
  inputs input;
  light_samples light; /* of the light at hand, or of one light a lane */
  light_weights weight;
  light_choices choice;
  light_draws drawn;
  reflections reflection;
  draws draw;
  choices closures; /* among the closures of lists, */
  reflections part; /* one of them at a time */
  draws part_draw;
  cones cones;
  path_states *state, *next; /* by ray, of this bounce and of the one after */
  path_states path_states[2];
  lane_u chosen; /* by ray: the hit it starts from */
  lane_c sum;    /* reflected light of all lights */
  lane_u missed; /* by number: a ray that meets nothing; then by ray: what it meets is dark */
  lane_v toward; /* its direction, or one that a light sample of the sky goes to */
  lane_c sky;    /* what is there */
  lane_f sky_pdf;
  lane_c emitted;              /* by ray: light of lights it meets */
  struct occlusion *occlusion; /* where the scene is `occluded`, or NULL */
} batch;

/* The instance that is hit: one whose mesh is shared, or the triangle's. */
static inline const instance *hit_instance(const scene *s, const batch *b, const hits *hit,
                                           size_t i) {
  bool shared = b->placed && hit->instance[i];
  return &s->instance[shared ? b->placed[hit->instance[i]].object
                             : s->triangle[hit->record[i]].object];
}
static inline const instance *instance_at(const scene *s, const batch *b, size_t i) {
  return hit_instance(s, b, b->hit, i);
}

#endif
