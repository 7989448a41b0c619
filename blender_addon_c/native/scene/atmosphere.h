/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the sky of an atmosphere looks like, as a table of directions: the sky's own colours without
 * the sun's disc, which is told by itself. The models are those of Blender's Sky Texture, their
 * constants and the places of their tables' texels those of its intern/sky (3.4, 5.0); without
 * units, as there.
 *
 * Columns go round the zenith by equal angles, the sun in the middle. Rows go from nadir to zenith;
 * their distance from the horizon grows by its square.
 */
#ifndef LIBSHADE_ATMOSPHERE_H
#define LIBSHADE_ATMOSPHERE_H

#include <stdbool.h>

enum { ATMOSPHERE_COLUMNS = 512, ATMOSPHERE_ROWS = 256 };
enum { ATMOSPHERE_HALF = ATMOSPHERE_COLUMNS / 2, ATMOSPHERE_HORIZON = ATMOSPHERE_ROWS / 2 };

typedef enum atmosphere_model {
  ATMOSPHERE_SINGLE,   /* light scattered once, over the spectrum [Nishita1993] */
  ATMOSPHERE_MULTIPLE, /* and an approximation of what is scattered again [GarciaLinan2024] */
  ATMOSPHERE_PREETHAM  /* [Preetham1999] */
} atmosphere_model;

typedef struct atmosphere {
  atmosphere_model model;
  float elevation;            /* of the sun, radians */
  float altitude;             /* of the eye, m */
  float air, dust, ozone;     /* times as much as usual */
  float turbidity;            /* of Preetham */
  bool later;                 /* as in Blender 5.0, else as in 3.4: rows and rims */
  float sun_size, sun_bright; /* angle across the disc, 0: none; times as bright */
  double rgb[9];              /* of X, Y and Z, by rows */

  struct multiple_table *table; /* of the multiple scattering */
} atmosphere;

/* What rows need; false when out of memory. */
bool atmosphere_prepare(atmosphere *a, int threads);
void atmosphere_free(atmosphere *a);

/* Half a row, from opposite the sun to below it: X, Y and Z by column. Of SINGLE the rows from
 * ATMOSPHERE_HORIZON on. */
typedef float atmosphere_half[3][ATMOSPHERE_HALF];
void atmosphere_row(const atmosphere *a, int row, atmosphere_half out);

/* Of the light of the lowest row above the horizon, how much the ground of SINGLE shows in this
 * row below. */
float atmosphere_ground(const atmosphere *a, int row);

/* XYZ of the sun's light, at right angles to it, at the disc's lower or upper rim. */
void atmosphere_sun(const atmosphere *a, bool upper, double xyz[3]);

/* How far below the level the ground begins, radians. */
double atmosphere_dip(const atmosphere *a);

/* Linear light of the space that the atmosphere's matrix is of. */
void atmosphere_rgb(const atmosphere *a, const double xyz[3], double rgb[3]);

/* ---- the models, for atmosphere.c */

void single_row(const atmosphere *a, int row, atmosphere_half out);
void single_sun(const atmosphere *a, double elevation, double xyz[3]);
bool multiple_prepare(atmosphere *a, int threads);
void multiple_row(const atmosphere *a, int row, atmosphere_half out);
void multiple_sun(const atmosphere *a, double elevation, double xyz[3]);
double multiple_dip(const atmosphere *a);
void preetham_row(const atmosphere *a, int row, atmosphere_half out);

#endif
