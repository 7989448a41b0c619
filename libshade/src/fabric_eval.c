/* SPDX-License-Identifier: Apache-2.0 */
/* Evaluation of a fabric: near, far and between; the entries of fabric.h. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "fabric.h"
#include "isa.h"
#include "lanes.h"
#include "../kernel/coefficients.h"

enum { LANES = 256, TERMS = FABRIC_POINTS + 1 };

/* The far model's share: none below .75 crossings, all from 2. */
static double far_share(double extent) {
  if (!(extent > 0.75))
    return 0;
  double x = log2(extent / 0.75) / log2(2 / 0.75);
  return x < 1 ? x * x * (3 - 2 * x) : 1;
}

/* How many of the 16 points lie along u: more along the longer side of the footprint. */
static int point_columns(const double extent[2]) {
  int columns = 4;
  for (; columns < FABRIC_POINTS && extent[0] * 4 > extent[1] * columns * 2; columns *= 2)
    ;
  for (; columns > 1 && extent[1] * columns > extent[0] * 4 * 2; columns /= 2)
    ;
  return columns;
}

/* Point k of them. */
static void point_of(const double uv[2], const double extent[2], int k, double at[2]) {
  const int columns = point_columns(extent), rows = FABRIC_POINTS / columns;
  at[0] = uv[0] + extent[0] * ((k % columns + 0.5) / columns - 0.5);
  at[1] = uv[1] + extent[1] * ((k / columns + 0.5) / rows - 0.5);
}

#define SHADE_FLOAT 1
#include "fabric_eval.h"
#include "fabric_batch.h"
#undef SHADE_FLOAT
#define SHADE_FLOAT 0
#include "fabric_eval.h"
#include "fabric_batch.h"
