/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The geometry of the world: meshes and instances to records of triangles, and the BVH. */
#ifndef LIBSHADE_WORLD_H
#define LIBSHADE_WORLD_H

#include <stdatomic.h>

#include "scene/scene.h"

/* False on failure, with the reason in `log`, or when *cancel became true. Times: mesh and bvh. */
bool world_build(scene *s, const atomic_bool *cancel, message_log *log, scene_times *times);

/* The world of a scene that is built goes over to one that is read, where its meshes are the same;
 * world_build then moves what has moved. Else that makes haste. */
void world_take(scene *to, scene *from);
void world_plan_free(struct world_plan *plan);

/* Corners of a record among the positions that Embree reads; of a mesh that changes its shape those
 * of its first step. */
void world_corners(const scene *s, uint32_t record, uint32_t out[3]);

/* How directions come from a space into the world, and what nodes may ask of an object there. */
void world_place(const double matrix[12], placed *out);
void world_object(const double matrix[12], object *out);

#endif
