/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of build/displaced share: the order, and how they write. */
#ifndef DISPLACED_PROGRAM_H
#define DISPLACED_PROGRAM_H

#include <stdio.h>

#include "shade/shade.h"
#include "surface.h"

typedef struct scene {
  surface surface;
  shade_params params;
  double first, second; /* exponents of Ashikhmin-Shirley, alphas of the others */
  int along_y;          /* grooves run along y: the narrow axis */
  int size, over;       /* pixels along a side; samples along a side of a pixel */
  int lights;           /* how many of SUNS in pictures.c */
  int methods, method[SHADE_DETAIL_COUNT];
  shade_bsdf bsdf[SHADE_DETAIL_COUNT], plain; /* by each method; with none, for facets */
} scene;

enum { MOST_LIGHTS = 4 };

/* Each returns an exit status. `pfm` may be NULL. */
int displaced_pictures(const scene *sc, const char *csv, const char *pfm);
int displaced_lobes(const scene *sc, double tilt, int azimuths, const char *csv);

/* Text that grows in memory and is written whole: what is stopped half way leaves nothing. */
typedef struct text {
  char *bytes;
  size_t length, room;
  int failed;
} text;
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void text_line(text *t, const char *format, ...);
int text_write(text *t, const char *path); /* frees it */

/* One channel of floats, rows from the bottom. */
int pfm_write(const char *path, const float *pixels, int width, int height);

#endif
