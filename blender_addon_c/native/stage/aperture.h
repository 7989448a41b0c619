/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LIBSHADE_APERTURE_H
#define LIBSHADE_APERTURE_H

#include "batch/leaf.h"

/* A point of the aperture, of a width and height of 2: of the disc, or of a polygon whose corners
 * lie on its rim. Each side of that makes a triangle with the middle. */
LEAF void lens_point(bool disc, float blades, float side, float across, float turned, float x,
                     float y, float *a, float *b) {
  float number = floor_small(x * blades);
  float out = sqrtf(disc ? x : x * blades - number); /* evenly over the area */
  float along = disc ? 0.0f : (2.0f * y - 1.0f) * across * out;
  float away = disc ? out : side * out;
  float angle = disc ? y : number / blades + turned, s, c;
  turn(angle - floor_small(angle), &s, &c);
  *a = away * c - along * s;
  *b = away * s + along * c;
}

#endif
