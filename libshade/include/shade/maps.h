/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Fields of slopes over a texture: scratches, made from numbers, and normal maps.
 * Looked up with a footprint they give the mean normal and what is lost in the mean,
 * the covariance of the slopes, which shade_params_widen adds to a lobe: from afar
 * scratches turn into roughness and not into noise.
 *
 * Coordinates. u runs to the right and v up, in [0, 1] over the tile or picture; row 0 of a
 * picture is its top; the centre of texel (i, j) is at u = (i + 1/2)/width,
 * v = 1 - (j + 1/2)/height. Normals are in tangent space: x along u, y along v, z out.
 * The slope of a height field is its gradient, (dH/dx, dH/dy); n is (-slope, 1) made unit.
 *
 * A footprint is the parallelogram that a pixel covers, {du1, dv1, du2, dv2}: the two whole
 * sides, as vectors in (u, v). NULL, or all 0, asks for the point itself.
 *
 * Threads. Nothing here has global state. A field or map may be shared by any number of
 * threads once it is made. Only ..._create allocates.
 */
#ifndef SHADE_MAPS_H
#define SHADE_MAPS_H

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a lookup returns. */
typedef struct shade_slopes {
  double normal[3];     /* unit: of the mean slope */
  double mean[2];       /* mean slope */
  double covariance[3]; /* of the slopes about their mean: xx, xy, yy; never indefinite */
} shade_slopes;

/* ---- scratches ------------------------------------------------------------------ */

/* A value drawn between two: radii evenly in the logarithm, others evenly. */
typedef struct shade_range {
  double low, high;
} shade_range;

enum {
  SHADE_SCRATCH_LAYERS = 8,
  SHADE_SCRATCH_MAX_PITS = 4000000 /* of all layers */
};

/*
 * Pits: spherical caps, stretched along the scratch. Lengths are in tile widths.
 */
typedef struct shade_scratch_layer {
  uint32_t pits;
  shade_range radius;  /* half width of the rim across the scratch, [1e-6, 0.5] */
  shade_range stretch; /* half length over half width, [1, 1e5]; 1 is a round pit. What would
                          reach past half a tile is cut to it, without a status */
  shade_range depth;   /* of the centre over the radius, [0, 0.99] */
  double direction;    /* of the length, from +u towards +v, radians */
  double spread;       /* up to this far to either side of the direction, [0, pi/2]: pi/2 is any */
} shade_scratch_layer;

typedef struct shade_scratch_params {
  size_t size;   /* sizeof(shade_scratch_params), set by shade_scratch_params_init */
  uint64_t seed; /* another seed, other scratches */
  double aspect; /* height of the tile over its width, [1e-3, 1e3] */
  int cells;     /* of the table that answers footprints, along the tile's longer side,
                    [0, 4096]; 0: none, every footprint is sampled, 1024 points at most */
  int layers;    /* in use, [0, SHADE_SCRATCH_LAYERS] */
  shade_scratch_layer layer[SHADE_SCRATCH_LAYERS];
} shade_scratch_params;

/* Fine scratches along u, within 10 degrees. Every layer holds these values, one is in use. */
SHADE_API void shade_scratch_params_init(shade_scratch_params *p);

typedef struct shade_scratch_field shade_scratch_field;

/*
 * Build the field: every pit, bins that find those over a point, and the table for
 * footprints. The same numbers give the same field; more pits in a layer leave the others
 * where they are. Values out of range are clamped, NaN becomes the default, the ends of a
 * range trade places where they are the wrong way round (*status, if not NULL, then has
 * SHADE_CLAMPED_PARAMETER); pits beyond SHADE_SCRATCH_MAX_PITS are left out (likewise).
 * NULL only when out of memory.
 */
SHADE_API shade_scratch_field *shade_scratch_create(const shade_scratch_params *p,
                                                    unsigned *status);
SHADE_API void shade_scratch_free(shade_scratch_field *f); /* NULL is fine */

/*
 * Height (in tile widths, 0 at the plate, negative in a pit; may be NULL) and slopes at
 * (u, v), which repeat with period 1. Where pits overlap the deepest counts; on equal
 * depth the one that comes first. Inside one, with q the place over its half axes and
 * k = 2 d/(1 + d^2), d = depth over radius r, H = -(r/k)(sqrt(1 - k^2 q^2) - sqrt(1 - k^2)).
 * A point costs time in proportion to the pits near it, not to their number.
 *
 * With a footprint: the mean height and slope over it, and the covariance. Footprints up to
 * about two cells of the table are sampled on a grid; larger ones come from the table's mip
 * levels, along the longer side up to 16 times the shorter; a blend lies between. The
 * table itself is averaged from jittered samples, 16 to 64 a cell.
 * Returns SHADE_BAD_INPUT, and the flat plate, where an argument is not finite.
 */
SHADE_API unsigned shade_scratch_eval(const shade_scratch_field *f, double u, double v,
                                      const double footprint[4], double *height,
                                      shade_slopes *slopes);

/*
 * Rows [first, first + count) from the top of a picture of the field, width x rows texels:
 * heights (one float a texel) and unit normals (three), either may be NULL. Each texel is
 * the mean over samples x samples points of it; 1 takes the centre. Any rows may be made by
 * any thread in any order: the numbers do not depend on it.
 */
SHADE_API void shade_scratch_rows(const shade_scratch_field *f, int width, int rows, int first,
                                  int count, int samples, float *height, float *normal);

#ifdef __cplusplus
}
#endif
#endif
