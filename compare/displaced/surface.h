/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Surfaces that are really displaced, by formulas alone: a plate, a cylinder and a sphere whose
 * points are pushed along the normal by a field of heights. No mesh and no map lies between the
 * formula and the picture, so nothing of either is in the error.
 */
#ifndef DISPLACED_SURFACE_H
#define DISPLACED_SURFACE_H

#include <math.h>

#define PI 3.14159265358979323846

typedef struct vec {
  double x, y, z;
} vec;

static inline vec add(vec a, double s, vec b) {
  return (vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline double dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline vec cross(vec a, vec b) {
  return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline vec unit(vec a) {
  return add((vec){0, 0, 0}, 1 / sqrt(dot(a, a)), a);
}

typedef enum base { PLATE, CYLINDER, SPHERE, BASES } base;
typedef enum bumps { SMOOTH, WAVES, SCRATCHES, BUMPS } bumps;

extern const char *const base_words[BASES];
extern const char *const bumps_words[BUMPS];

/* Radius of cylinder and sphere: one tile of the field is half their girth. */
#define RADIUS (1 / PI)

enum { PITS = 48 };
typedef struct pit { /* a spherical cap, stretched: design of `shade scratch`, method of its paper
                      */
  double x, y, cosine, sine, radius, stretch;
} pit;

typedef struct surface {
  base base;
  bumps bumps;
  double slope;       /* the steepest, to first order in the height */
  double wave;        /* of WAVES: 2 pi times the periods of a tile */
  double k;           /* of SCRATCHES: slope/sqrt(1 + slope^2) */
  double top, bottom; /* bounds of the height */
  double lipschitz;   /* of the height over the length along the surface */
  pit pits[PITS];
} surface;

/* A field whose steepest slope is `slope`, 0 to 2. The same seed, the same pits. */
void surface_make(surface *s, base base, bumps bumps, double slope, unsigned seed);

/* What a place of the surface is: its base's frame (x = dP/du, z out) and the displaced one. */
typedef struct place {
  double u, v;
  vec x, y, z; /* of the base: unit */
  vec p;       /* the displaced point */
  vec du, dv;  /* its derivatives by u and v, not unit */
  vec n;       /* its normal, unit, in the world */
} place;
void surface_at(const surface *s, double u, double v, place *at);

/* The place above or below a point of the world, as (u, v). */
void surface_under(const surface *s, vec p, double *u, double *v);

/* The first meeting of a ray with the displaced surface as a distance, or -1. `along` is unit. */
double surface_cast(const surface *s, vec from, vec along);

/* The same with the base, where nothing is displaced, for an eye far up z above (x, y): 0 or 1. */
int surface_base_seen(const surface *s, double x, double y, double *u, double *v);

/* Half the width of a picture that holds the whole, and its middle. */
void surface_window(const surface *s, double *half, double *x, double *y);

#endif
