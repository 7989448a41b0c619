/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A mip pyramid of slope moments. Private to src/.
 *
 * A texel holds MOMENTS floats: the means of (height, sx, sy, sx^2, sx sy, sy^2) over its
 * part of the texture. Means of means are means: every level keeps them exactly, since
 * reductions weight each texel by what the larger one covers of it, at odd sizes too. What a
 * lookup interpolates is moments; the covariance is taken last. [OlanoBaker2010]
 * The finest level may be one that is not stored: a lookup makes its moments as it reads them.
 */
#ifndef SHADE_SRC_MOMENTS_H
#define SHADE_SRC_MOMENTS_H

#include <stddef.h>

#include "shade/maps.h"

enum { MOMENTS = 6, MOMENT_LEVELS = 17 };
/*
 * How large the texels are that a lookup reads. Squares of their side: over that of the footprint's
 * shorter axis (1.85 texels across it at least), over the product of both axes (2.5 texels along
 * either of a round one); over that of the longer axis, the least that counts as the shorter one.
 * From MOMENT_NEXT of what the next level would be read with to all of it, that level is mixed in.
 */
#define MOMENT_ACROSS (1 / (1.85 * 1.85))
#define MOMENT_SQUARE (1 / (2.5 * 2.5))
#define MOMENT_LONGEST (1 / (16.0 * 16.0))
#define MOMENT_NEXT 1.875
#define MOMENT_LEAST 3.1 /* square of the narrowest filter, in texels of a level */
/* Root of a footprint's area in texels: from the one on cells leave to level 1, to the other. */
#define MOMENT_CELLS_NEAR 3.02
#define MOMENT_CELLS_FAR 3.98
enum { MOMENT_H, MOMENT_X, MOMENT_Y, MOMENT_XX, MOMENT_XY, MOMENT_YY };

/* Index of texel i of n where i may lie outside. */
typedef enum moment_wrap { WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR } moment_wrap;

static inline int wrap_index(int i, int n, moment_wrap wrap) {
  if (i >= 0 && i < n)
    return i;
  if (wrap == WRAP_CLAMP)
    return i < 0 ? 0 : n - 1;
  const int period = wrap == WRAP_MIRROR ? 2 * n : n;
  i %= period;
  i += i < 0 ? period : 0;
  return i < n ? i : period - 1 - i;
}

typedef struct moment_level {
  int width, height;
  float *texels; /* rows from the top; NULL for cells */
} moment_level;

static inline float *moment_texel(const moment_level *l, int i, int j) {
  return l->texels + ((size_t)j * (size_t)l->width + (size_t)i) * MOMENTS;
}

/* Moments of row j of a picture of width x height texels, into `to`. */
typedef void moment_row(const void *context, int j, float *to);
/* Moments between the middles of texels (i, j) and (i + 1, j + 1), wherever these lie. */
typedef void moment_cell(const void *context, int i, int j, double to[MOMENTS]);

typedef struct moment_pyramid {
  int levels;
  moment_wrap wrap;
  moment_level level[MOMENT_LEVELS];
  moment_cell *cell; /* of level 0, or NULL where that is stored */
  const void *context;
} moment_pyramid;

/*
 * Build all levels down to 1 x 1, reduced from the rows that `row` makes. With `cell`, level 0 is
 * left to that, level 1 is the first that is stored, and `context` has to last as long as `p`. 0,
 * or -1 when out of memory.
 */
int shade_moments_create(moment_pyramid *p, int width, int height, moment_wrap wrap,
                         moment_row *row, moment_cell *cell, const void *context);
void shade_moments_free(moment_pyramid *p);

/* Longer side of the footprint's ellipse, in texels of level 0. */
double shade_moments_extent(const moment_pyramid *p, const double footprint[4]);

/*
 * Mean moments over a footprint about (u, v). The filter is smooth; its second moment is
 * that of the parallelogram, unless that is below one texel's or more than 16 times longer
 * than wide.
 */
void shade_moments_lookup(const moment_pyramid *p, double u, double v, const double footprint[4],
                          double out[MOMENTS]);

/* How far (0…1) a lookup leaves sampling for the pyramid, for a footprint of this extent. */
double shade_moments_blend(double extent);

/* The moments of one slope added, `weight` times. */
void shade_moments_add(double sum[MOMENTS], double weight, double height, double x, double y);
void shade_moments_slopes(const double moments[MOMENTS], shade_slopes *s);
void shade_moments_flat(shade_slopes *s);

#endif
