/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fields of scratches of a scene: libshade's, from numbers of the surface, each made once for all
 * nodes that ask for it. */
#ifndef LIBSHADE_SCRATCHES_H
#define LIBSHADE_SCRATCHES_H

#include "scene/reader.h"
#include "shade/maps.h"

/* Slopes of a square of the tile: their means, and means of their products. */
typedef struct scratch_slopes {
  float x, y, xx, xy, yy;
} scratch_slopes;

enum { SCRATCHES_LEVELS = 9 };

/* Of all squares of 1 x 1 to 2^levels x 2^levels of the tile, rows from below; coarsest first. */
typedef struct scratch_squares {
  int levels;
  scratch_slopes *level[SCRATCHES_LEVELS];
} scratch_squares;

typedef struct scratches {
  double tile;    /* side of the square that repeats, metres */
  double density; /* 1/cm^2, of those that there are: fewer than asked for if `fewer` */
  bool fewer;
  float share; /* of the plate that is scratched */
  shade_scratch_params params;
  shade_scratch_field *field; /* made by scratches_build */
  scratch_squares squares;    /* likewise: of what rays from far away see one */
} scratches;

/*
 * `density`, 1/cm^2; `length` and `width`, mm, in the mean; `depth`, of the middle over half the
 * width; `direction`, from x towards y, and `spread` to either side of it, radians; `seed`;
 * `tile`, metres, 0: as SCRATCHES_GOOD of them fill, but four lengths at least and 1e5 widths at
 * most. Lengths and depths are from half to one and a half of the mean, widths from 2/3 to 3/2.
 * Numbers beyond what can be are brought into range; more than SCRATCHES_MOST, more than
 * SCRATCHES_DEEP over each point, or more than some two seconds make, are left out.
 */
enum { SCRATCHES_GOOD = 200000, SCRATCHES_MOST = 600000, SCRATCHES_DEEP = 16 };
bool scratches_read(reader *r, void *out, void *context);
/* False when out of memory. */
bool scratches_build(scratches *s);
/* `to`, which is read, takes the field of `from` where it is the same. */
void scratches_take(scratches *to, scratches *from);
void scratches_free(scratches *s);

/*
 * A picture of the tile: size x size texels, rows from the bottom, each the mean of samples x
 * samples points: red, green, blue and 1 of the mean slope's normal, 0 to 1 for -1 to 1; of the
 * height in metres; of the share that is scratched.
 */
void scratches_picture(const scratches *s, int size, int samples, float *normal, float *height,
                       float *mask);

#endif
