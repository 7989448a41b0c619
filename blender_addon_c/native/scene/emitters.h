/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Triangles that shine, each evenly and to both sides: one light together, of which a point is
 * drawn by area and brightness.
 */
#ifndef LIBSHADE_EMITTERS_H
#define LIBSHADE_EMITTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/geometry.h"

/* One triangle: corner, the edges from it, radiance. Nine and three numbers in rows of 16. */
enum { EMITTER_CORNER = 0, EMITTER_EDGE = 3, EMITTER_COLOR = 9, EMITTER_ROW = 16 };

typedef struct emitters {
  size_t count;
  float *row;         /* EMITTER_ROW numbers each */
  uint32_t *instance; /* by triangle: its number */
  float *sum;         /* part of the light of those before; count + 1 */
  float *material;    /* by number: radiance, density per area of its points; or 0 */
  float bright; /* brightness times area of all; a point of brightness b has b / bright as density,
                   1/m² */
  float power;  /* intensity, as of a light that is far */
  float center[3];
  float radius2; /* of what holds them, squared */
} emitters;

/* Brightness of a radiance, which may be below 0; what draws go by. */
static inline float emitter_brightness(const float radiance[3]) {
  float sum = 0.0f;
  for (int k = 0; k < 3; k++)
    sum += radiance[k] > 0.0f ? radiance[k] : -radiance[k];
  return sum * (1.0f / 3.0f);
}

/* Of all triangles whose materials say `shines`. False when out of memory. */
bool emitters_build(const geometry *s, emitters *e);
void emitters_free(emitters *e);

#endif
