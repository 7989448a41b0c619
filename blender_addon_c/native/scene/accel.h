/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Ray casting. All of Embree is in scene/accel.c; nothing else knows of it.
 */
#ifndef LIBSHADE_ACCEL_H
#define LIBSHADE_ACCEL_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

typedef struct accel accel;

enum { ACCEL_QUADS = 0, ACCEL_TRIANGLES = 1 }; /* geometry numbers of a hit */
#define ACCEL_MISS UINT32_MAX                  /* geometry number of a miss */

/* Arrays stay the caller's and must outlive the accel. */
typedef struct accel_input {
  size_t positions, quads, triangles;
  const float *position;             /* 3 each, and one readable float past the end */
  const uint32_t *quad_position;     /* 4 each; halves (0, 1, 3) and (2, 3, 1) */
  const uint32_t *triangle_position; /* 3 each */
} accel_input;

/* One array per component. */
typedef struct accel_rays {
  float *ox, *oy, *oz, *tnear; /* origin; a ray with tnear > tfar is not cast */
  float *dx, *dy, *dz, *tfar;  /* direction; tfar becomes the distance of the hit */
} accel_rays;
typedef struct accel_hits {
  float *gx, *gy, *gz; /* geometric normal, any length */
  float *u, *v;
  uint32_t *primitive, *geometry;
} accel_hits;

/*
 * Build. NULL on failure with a message; NULL with an empty message when *cancel became true.
 * Primitives with a non-finite position are left out.
 */
accel *accel_create(const accel_input *input, int threads, const atomic_bool *cancel, char *error,
                    size_t error_size);
void accel_free(accel *a); /* NULL is fine */

/* The rays of one call should start or end close together: Embree's coherent mode is used. */
void accel_intersect(const accel *a, size_t count, const accel_rays *rays, const accel_hits *hits);
/* tfar of every ray that meets something becomes -infinity. */
void accel_occluded(const accel *a, size_t count, const accel_rays *rays);

#endif
