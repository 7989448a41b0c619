/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshes and instances as they are read, and the records of triangles that are made of them. */
#ifndef LIBSHADE_GEOMETRY_H
#define LIBSHADE_GEOMETRY_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/material.h"
#include "scene/motion.h"

typedef struct mesh {
  size_t positions, triangles;
  const float *position;           /* 3 per position */
  const uint32_t *corner_position; /* 3 per triangle */
  const float *corner_normal;      /* 9 per triangle */
  const float *corner_uv;          /* 6 per triangle, or NULL */
  const int32_t *material;         /* 1 per triangle */
  const float **layer;             /* by layer of the scene: per corner, or NULL */
  /* where it changes its shape: how many times, and positions and normals at each */
  int steps;
  const float *moved_position, *moved_normal;
  int shapes; /* the same where the scene has `vectors`: it stands still, but for these */
  char *name;
} mesh;

typedef struct instance {
  size_t mesh;
  double matrix[12]; /* object to world, rows of 4 */
  int pass_index;    /* of its object */
  float matte[2];    /* what stands for the object's name, and its asset's */
  int hidden;        /* ray_kinds that do not see it */
  int unlit;         /* bits of lights that do not light it, */
  int shadeless;     /* and of those that it does not shade */
  uint32_t link;     /* its own bit where what it shines lights some alone, or 0 */
  uint32_t shade;    /* and where some alone shade that */
  float color[4], random, metres[2];
  const float *told; /* four numbers for each of the scene's attributes, or NULL */
  motion motion;
  size_t base;  /* of its mesh's positions among those that Embree reads */
  bool unmoved; /* it would move, but not by places that can be inverted */
} instance;

/* A point of an object in the world. */
static inline void instance_place(const double m[12], const float *p, double out[3]) {
  for (int k = 0; k < 3; k++)
    out[k] = m[4 * k] * (double)p[0] + m[4 * k + 1] * (double)p[1] + m[4 * k + 2] * (double)p[2] +
             m[4 * k + 3];
}

/* All of it, as it is read. */
typedef struct geometry {
  size_t materials, meshes, instances;
  const material *material;
  const mesh *mesh;
  const instance *instance;
} geometry;

/*
 * All that shading needs to know of one triangle, world space, two cache lines.
 * A corner is normal, tangent, uv: one vector register of 8.
 */
typedef struct triangle {
  _Alignas(128) float corner[3][8];
  uint32_t material;
  float handed;    /* bitangent = handed * cross(normal, tangent) */
  float reach;     /* largest coordinate of a corner: scale of rounding errors */
  uint32_t object; /* number of its instance */
  /* Heights of the corners over each other's tangent planes, of a smooth triangle whose `curved` is
   * 1: of 1 and 2 over that of 0, 0 and 2 over 1, 0 and 1 over 2; upper halves of floats. */
  uint16_t height[6];
  uint16_t curved, mirrored; /* mirrored: its corners go round the other way */
} triangle;
_Static_assert(sizeof(triangle) == 128, "two cache lines");

/* Position of a triangle by u and v; where it has no area in these by two of its edges. */
typedef struct stretch {
  float u[3], v[3];
  float dense;    /* how much of u and v a step along it goes at most, by the step's length */
  uint32_t edges; /* they are edges: how u and v go along those, the triangle's corners say */
} stretch;

static inline float uv_larger(float a, float b) {
  return fabsf(a) > fabsf(b) ? fabsf(a) : fabsf(b);
}

/* Whether a triangle has an area in UV: more than the rounding of its UVs alone may make, by the
 * largest of them and the longest edge. */
static inline bool uv_spans(float u0, float v0, float u1, float v1, float u2, float v2) {
  const float a = u1 - u0, b = v1 - v0, c = u2 - u0, d = v2 - v0;
  const float largest =
      uv_larger(uv_larger(uv_larger(u0, v0), uv_larger(u1, v1)), uv_larger(u2, v2));
  const float longest = uv_larger(uv_larger(a, b), uv_larger(c, d));
  return fabsf(a * d - c * b) > 0x1p-21f * largest * longest + 1e-18f;
}

/* A mesh that changes its shape, as it is kept: at each of its steps. */
typedef struct deform {
  int steps;
  uint32_t positions, records; /* how many at each step */
  size_t position;             /* of the first step's first, in the world's; others follow */
  size_t normal;               /* the same in moved_normal: three a record, quads' halves first */
} deform;

/* Records are numbered in 32 bits; the last number is a miss. */
#define RECORD_MISS UINT32_MAX

#endif
