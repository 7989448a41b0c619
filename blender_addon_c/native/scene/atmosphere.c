/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/atmosphere.h"

#include <math.h>
#include <stdlib.h>

bool atmosphere_prepare(atmosphere *a, int threads) {
  return a->model != ATMOSPHERE_MULTIPLE || multiple_prepare(a, threads);
}

void atmosphere_free(atmosphere *a) {
  free(a->table);
  a->table = NULL;
}

void atmosphere_row(const atmosphere *a, int row, atmosphere_half out) {
  switch (a->model) {
  case ATMOSPHERE_SINGLE:
    single_row(a, row, out);
    break;
  case ATMOSPHERE_MULTIPLE:
    multiple_row(a, row, out);
    break;
  case ATMOSPHERE_PREETHAM:
    preetham_row(a, row, out);
  }
}

static double ground_left(double far) {
  double left = 1 - 2.5 * sin(1.5707963267948966 * far * far);
  return left > 0 ? left * left * left : 0;
}

/* Blender 5.0 has the rows in its table; before, each direction is worked out, from which what lies
 * between two rows here errs as far as their ends. */
float atmosphere_ground(const atmosphere *a, int row) {
  const double step = 1.0 / ATMOSPHERE_HORIZON;
  double far = 1 - (row + (a->later ? 0 : 0.5)) * step, left = ground_left(far);
  double bent = ground_left(far + step) - 2 * left + ground_left(far - step);
  return (float)fmax(a->later ? left : left - bent / 16, 0);
}

void atmosphere_sun(const atmosphere *a, bool upper, double xyz[3]) {
  double half = 0.5 * (double)a->sun_size, top = (double)a->elevation + half;
  double elevation = upper ? top : (double)a->elevation - half;
  if (a->model == ATMOSPHERE_MULTIPLE) {
    multiple_sun(a, elevation, xyz);
    return;
  }
  single_sun(a, elevation > 0 ? elevation : 0, xyz);
  for (int k = 0; k < 3; k++)
    xyz[k] = top > 0 ? xyz[k] : 0;
}

double atmosphere_dip(const atmosphere *a) {
  return a->later ? multiple_dip(a) : 0;
}

void atmosphere_rgb(const atmosphere *a, const double xyz[3], double rgb[3]) {
  for (int k = 0; k < 3; k++) {
    const double *row = a->rgb + 3 * k;
    rgb[k] = row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
  }
}
