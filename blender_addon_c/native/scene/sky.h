/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * An image around everything, or the sky of an atmosphere and its sun, and a map of the sphere by
 * which directions are drawn to where it is bright: cells of one solid angle, even in z and in the
 * angle about it.
 */
#ifndef LIBSHADE_SKY_H
#define LIBSHADE_SKY_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "scene/atmosphere.h"
#include "scene/reader.h"
#include "scene/texture.h"

/* Powers of two: stage/sky.h halves them. 1024 columns are worth 1.23 times 256 in a studio. */
enum { SKY_ROWS = 512, SKY_COLUMNS = 1024, SKY_STRIDE = 32 };

/* The disc of a sun, dimmer towards its rim. */
typedef struct sky_sun {
  float share;                      /* of draws that go there; 0: there is none */
  float to[3], across[3], along[3]; /* directions in the world */
  float chord2, half2; /* squared: from the middle to the rim, the angle between them */
  float density;       /* of draws by their share, 1/sr */
  float low_z;         /* z in the image, below which the ground hides it */
  float low, per_rise; /* elevation where it is as at its lower rim; 1 / from there to its upper */
  float lower[3], more[3];
  uint32_t covers; /* the sky behind it is not added; for either() */
} sky_sun;

typedef struct sky {
  bool there; /* else all below is 0 */
  int image;
  int shader; /* 1 + the material whose nodes say what comes from each direction, of which the image
                 is one sample a texel; 0: the image says it */
  float strength[3];
  float matrix[12]; /* of a direction to that in the image, rows of 4 */
  uint32_t ball; /* the image is that of a mirror ball, else latitude by longitude; for either() */
  uint32_t dome; /* rows lie closer to the horizon, as atmosphere.h says; for either() */
  uint32_t closest; /* texel, instead of bilinear; for either() */
  bool modelled;    /* by the atmosphere, instead of the image */
  atmosphere air;

  /* made by sky_build */
  int width, height;
  uint32_t ends;  /* the lowest and the highest row end at the poles, else each goes on as the
                     other, as Cycles' images do; for either() */
  float *texel;   /* r g b 0, times strength; one column more repeats the first, and one row more
                     the first, or the last where it ends at a pole */
  float *row;     /* part of the light below row i; SKY_ROWS + 1 */
  float *column;  /* the same within each row; SKY_ROWS times SKY_COLUMNS + 1 */
  float *coarse;  /* every SKY_STRIDE-th of these sums: 64 KB, where the search begins */
  float *density; /* of the cells, 1/sr */
  float power;    /* irradiance if it came from all of the half sphere; 0: it is black */
  sky_sun sun;
} sky;

/* `sky` of a scene, or another of that kind, which has so many images. */
bool sky_read(reader *r, const char *key, sky *s, int images);

/* What some directions see of it: the stage `sky`. */
typedef void sky_look(size_t count, const sky *sky, const lane_v *d, lane_c *out);

/* False when out of memory; stops early when *cancel is true. */
bool sky_build(sky *s, const image *images, sky_look *look, int threads, const atomic_bool *cancel);

void sky_free(sky *s);

#endif
