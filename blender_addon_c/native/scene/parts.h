/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshes by themselves, before they are put into the world: pairs of triangles, and tangents. */
#ifndef LIBSHADE_PARTS_H
#define LIBSHADE_PARTS_H

#include "scene/scene.h"

/* Two triangles that follow each other and share an edge: one primitive for Embree. */
typedef struct pair {
  uint32_t first;  /* triangles first and first + 1 */
  uint8_t turn[2]; /* corner of each that is opposite to the shared edge */
} pair;

/* A mesh in parts as Embree and the records want it; object space. */
typedef struct parts {
  size_t pairs, singles;
  pair *pair;
  uint32_t *single;
  float *tangent; /* 4 per corner */
  float **layer;  /* the same of the scene's layers of tangents, or NULL */
} parts;

/* As many as the scene has meshes, or NULL: cancelled, or with the reason in the log. wanted: which
 * of them are made, NULL: all. */
parts *parts_make(const scene *s, const bool *wanted, const atomic_bool *cancel, message_log *log);

/* Their arrays are needed no more, their numbers are. */
void parts_used(parts *p, const scene *s);
void parts_free(parts *p, const scene *s);

/* Is a position near enough? Embree leaves primitives out that reach farther than 1.8e18. */
bool parts_usable(const float *position);

/* Memory that Embree may read, not cleared; NULL with a message where there is none. */
void *scene_array(message_log *log, size_t count, size_t size);

#endif
