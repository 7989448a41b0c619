/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What nodes may ask of the object that is hit, and of its mesh beside the UV map: layers, numbers
 * at the corners of its triangles. Both are there where a material asks for them. */
#ifndef LIBSHADE_OBJECT_H
#define LIBSHADE_OBJECT_H

#include <stdint.h>

typedef struct object {
  float matrix[12];  /* to the world, rows of 4 */
  float inverse[12]; /* from there; 0 where there is none */
  float color[4];
  float pass_index, random;
  float metres[2];   /* in one unit of its UV map, and of its own space */
  const float *told; /* four numbers for each of the scene's attributes, or NULL */
} object;
enum { OBJECT_FLOATS = sizeof(object) / sizeof(float) }; /* nodes count in floats */
_Static_assert(sizeof(object) % sizeof(float) == 0, "an object is a row of them");

/*
 * An instance of a mesh that is kept once, as it is: hits of it are turned into the world.
 * Directions alone: the largest number of each matrix is 1.
 */
typedef struct placed {
  uint32_t quad, single; /* number of the mesh's first record of each kind */
  uint32_t singles;      /* how many of the latter */
  float normal[3][3];    /* of normals */
  float linear[3][3];    /* of tangents */
  float scale;           /* of linear, to be the matrix */
  float mirror;          /* -1 where the matrix mirrors */
  float reach;           /* as of a triangle; below 0: the triangle's */
  uint32_t object;       /* number of its instance */
  uint32_t hidden;
  const struct motion *motion; /* NULL: it stays where it is */
  const struct deform *deform; /* NULL: and as it is */
} placed;

typedef struct layer {
  int width;       /* numbers a corner: 2 or 4 */
  int tangents_of; /* UVs are the layer of that number; else -1 */
  /* of the world */
  float *corner;       /* 3 corners of each record; 0 where a mesh has no such layer */
  const float *record; /* struct triangle, 32 floats each */
} layer;

#endif
