/* SPDX-License-Identifier: Apache-2.0 */
/* Periodic fields of heights on a grid, z over (x, y), with their slopes between the points of it,
 * and rays that meet them. */
#ifndef BUMPS_FIELD_H
#define BUMPS_FIELD_H

#include <stdint.h>

typedef struct vec {
  double x, y, z;
} vec;

#define PI 3.14159265358979323846
#define PERIOD (2 * PI) /* along x and y */

/* z = slope sin x sin y; waves of three to seven periods of random directions; slope sin x, seen
 * across and along. Uneven ones: waves of four octaves, of equal slopes; long waves with fine ones;
 * roofs with fine waves; a ring and a bar that stand out, with bevels; pits; grooves of seven
 * directions; noise on one half. */
typedef enum kind {
  SINE,
  NOISE,
  FRACTAL,
  LONG_AND_FINE,
  ROOFS,
  LETTER,
  PITS,
  SCRATCHES,
  HALF,
  RIDGES_ACROSS,
  RIDGES_ALONG,
  KINDS
} kind;
extern const char *const kind_words[KINDS];

typedef struct field {
  kind kind;
  int side;                          /* points along a period, a power of 2 */
  float *height, *slope_x, *slope_y; /* side * side each, in one piece of memory */
  float *moment[3];                  /* likewise: see field_moment */
  double low, high, steepest;
  double xx, xy, yy; /* second moment of the slopes, whose mean is 0 */
} field;

/* `slope` is the root of twice the slopes' variance along x and y (sine, waves, roofs), or the
 * steepest.
 * 0 without memory. */
int field_make(field *f, kind kind, double slope);
void field_free(field *f);

vec field_normal(const field *f, double x, double y);

/* The second moment xx, xy, yy of slopes by which bumps shade each other: of an even map that of
 * the whole, of an uneven one that in a window about a point, of what lies between a part of both.
 * Windows are the finest of those, each twice as wide as the one before, within which four fifths
 * of the slopes' variance are. docs/theory/horizons.md, `mutual`. */
void field_moment(const field *f, double x, double y, double moment[3]);

/* The first meeting of a ray with it, as a distance, or -1. `along` is unit, `from` not below it.
 */
double field_cast(const field *f, vec from, vec along);

/* Random numbers in [0, 1). */
double uniform(uint64_t *state);

static inline vec plus(vec a, double s, vec b) {
  return (vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline double dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

#endif
