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
 * across and along */
typedef enum kind { SINE, NOISE, RIDGES_ACROSS, RIDGES_ALONG, KINDS } kind;
extern const char *const kind_words[KINDS];

enum { SIDE = 512 }; /* points along a period */

typedef struct field {
  kind kind;
  float *height, *slope_x, *slope_y; /* SIDE * SIDE each, in one piece of memory */
  double low, high, steepest;
  double xx, xy, yy; /* second moment of the slopes, whose mean is 0 */
} field;

/* `slope` is the root of twice the slopes' variance along x (sine, noise) or the steepest (ridges).
 * 0 without memory. */
int field_make(field *f, kind kind, double slope);
void field_free(field *f);

vec field_normal(const field *f, double x, double y);

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
