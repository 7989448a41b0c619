/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stages of several families share. */
#ifndef LIBSHADE_STAGE_COMMON_H
#define LIBSHADE_STAGE_COMMON_H

#include "batch/leaf.h"

/*
 * How far a shadow ray starts off the surface, as a part of the numbers that went
 * into the hit: some 30 roundings. Less shadows itself, more leaks.
 */
#define SURFACE_OFFSET 2e-6f

LEAF void turn_row(const float m[3][3], float *row) {
  float x = row[0], y = row[1], z = row[2];
  for (int k = 0; k < 3; k++)
    row[k] = m[k][0] * x + m[k][1] * y + m[k][2] * z;
}

/* The share of a way to find light, of two whose densities these are [VeachGuibas1995]. */
LEAF float balance(float own, float other) {
  float sum = own + other;
  return own / (sum > 1e-30f ? sum : 1e-30f);
}

#endif
