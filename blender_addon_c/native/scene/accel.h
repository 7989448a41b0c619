/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Ray casting. All of Embree is in scene/accel.c; nothing else knows of it.
 */
#ifndef LIBSHADE_ACCEL_H
#define LIBSHADE_ACCEL_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "batch/lanes.h"
#include "scene/motion.h"

typedef struct accel accel;

/* geometry numbers of a hit; those of instances in the world begin with the last */
enum { ACCEL_QUADS = 0, ACCEL_TRIANGLES = 1, ACCEL_INSTANCES = 2 };
#define ACCEL_MISS UINT32_MAX /* geometry number of a miss */

typedef struct accel_part {
  size_t quads, triangles;
  const uint32_t *quad_position;     /* 4 each; halves (0, 1, 3) and (2, 3, 1) */
  const uint32_t *triangle_position; /* 3 each */
  /* of one that changes its shape: how many times, and from one's positions to the next one's */
  int steps;
  size_t stride;
} accel_part;

typedef struct accel_instance {
  size_t part;
  float matrix[12];     /* to the world, rows of 4 */
  uint32_t hidden;      /* ray_kinds that do not see it */
  const motion *motion; /* or NULL */
} accel_instance;

/* Arrays of positions and indices stay the caller's and must outlive the accel. */
typedef struct accel_input {
  size_t positions;
  const float *position; /* 3 each, and one readable float past the end */
  accel_part world;
  size_t parts, instances;
  const accel_part *part;
  const accel_instance *instance;
  /* NULL, or of the world's quads (every other number) and triangles: ray_kinds that do not see
     them. These too must outlive the accel. */
  const uint8_t *quad_hidden, *triangle_hidden;
  bool timed; /* something moves: rays have times */
  bool hasty; /* parts' trees are soon made, and rays are a little slower; they find the same */
} accel_input;

/*
 * Build. NULL on failure with a message; NULL with an empty message when *cancel became true.
 * Primitives with a non-finite position are left out.
 */
accel *accel_create(const accel_input *input, int threads, const atomic_bool *cancel, char *error,
                    size_t error_size);
/* The world again, of parts that are as they were: its own positions and instances may have moved.
 * False with a message; then it can only be freed. */
bool accel_place(accel *a, const accel_input *input, char *error, size_t error_size);
void accel_free(accel *a); /* NULL is fine */

/* Misses have the geometry ACCEL_MISS. Where there are instances, hit->instance becomes 1 + the
 * number of that which is hit, 0 for the world, and hit->g is in its space. kind: of all these
 * rays; 0: of each ray in kinds. Those of the camera start or end close together. */
void accel_intersect(const accel *a, size_t count, ray_kind kind, const uint32_t *kinds, rays *ray,
                     hits *hit);
/* Shadow rays. tfar of every ray that meets something becomes -infinity. coherent: from points that
 * lie close together, to a lamp without a size. */
void accel_occluded(const accel *a, size_t count, bool coherent, rays *ray);

#endif
