/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What moves while the shutter is open. Each sample has a time, which all its rays share; Embree
 * knows where things are then, and here hits learn it. Where nothing moves nothing is called.
 */
#ifndef LIBSHADE_RENDER_MOTION_H
#define LIBSHADE_RENDER_MOTION_H

#include "render/worker.h"

/* Its tables of places and objects: the scene's, or its own. False when out of memory. */
bool motion_init(batch *b, const scene *s);
void motion_end(batch *b);

/* The samples' times; points NULL: all are the middle one. */
void motion_times(worker *w, const camera_view *view, const shuffle *points, size_t count);
/* Rays of the camera from where it stands at their times; before they pass its lens, how wide it
 * sees then. */
void motion_zoom(worker *w, size_t count);
void motion_camera(worker *w, size_t count);
/* Times of rays, and of shadow rays. */
void motion_paths(worker *w, size_t rays);
void motion_shadows(worker *w);
void motion_passages(const batch *from, const passages *way, batch *to, size_t rays);
/* Hits with interpolated corners: where their meshes and instances are at their times. */
void motion_hits(worker *w);
/* The same of objects, as far as nodes ask; of meshes that change their shape nothing is lifted. */
void motion_objects(worker *w);

#endif
