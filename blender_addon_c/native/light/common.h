/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all kinds of light have in common. */
#ifndef LIBSHADE_LIGHT_COMMON_H
#define LIBSHADE_LIGHT_COMMON_H

#include "batch/leaf.h"
#include "scene/reader.h"

typedef struct light_common {
  float color[3]; /* of a sample's e: sun: irradiance; point: intensity */
  bool soft;      /* it has an extent, over which samples are spread */
  bool shadow;
} light_common;

/* What one point of a light gives to one point of a surface. */
typedef struct light_sample {
  vec3 direction; /* to the light, unit */
  float distance;
  float e; /* irradiance as a part of the light's colour */
} light_sample;

/* A point of the unit disc from one of the unit square. */
LEAF void disc_point(float x, float y, float *a, float *b) {
  float radius = sqrtf(x), s, c;
  turn(y, &s, &c);
  *a = radius * c;
  *b = radius * s;
}

#endif
