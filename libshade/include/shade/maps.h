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
 * SHADE_CLAMPED_PARAMETER); pits beyond SHADE_SCRATCH_MAX_PITS are left out (likewise). p may be
 * NULL: the defaults, which a p without its size counts as, too (SHADE_BAD_INPUT).
 * NULL only when out of memory. A metal's preset takes 22 to 36 ms of one core (gcc 12, AMD EPYC,
 * AVX-512), most of it for the table.
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
 * table itself is averaged from 12 to 64 samples a cell, jittered, of which each has a column
 * and a row of the cell to itself: second moments of the metals' presets are 10 to 21 % off in a
 * cell, 5 to 10 in 2 x 2 of them, 2 to 3 in 8 x 8 (root mean square, of the mean square slope).
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

/* ---- normal maps ---------------------------------------------------------------- */

/* What a picture's first channels hold. Two channels: z is what makes the normal unit. */
typedef enum shade_normals {
  SHADE_NORMALS_COLOUR = 0, /* normals, 0 to 1 for -1 to 1 */
  SHADE_NORMALS_SIGNED = 1, /* normals, -1 to 1 */
  SHADE_NORMALS_SLOPE = 2   /* dH/dx, dH/dy, in the first two channels */
} shade_normals;

/* What lies beyond the picture's edge. */
typedef enum shade_wrap {
  SHADE_WRAP_REPEAT = 0,
  SHADE_WRAP_CLAMP = 1, /* the outermost texel */
  SHADE_WRAP_MIRROR = 2
} shade_wrap;

typedef struct shade_slope_options {
  size_t size; /* sizeof(shade_slope_options), set by shade_slope_options_init */
  shade_normals normals;
  shade_wrap wrap;
  int directx;     /* 1: green (y) points down, as in DirectX; 0: up, as in OpenGL */
  double strength; /* [0, 100] (docs/theory/conventions.md); beyond 1 only the slope grows */
} shade_slope_options;

/* Colours, repeat, green up, strength 1. */
SHADE_API void shade_slope_options_init(shade_slope_options *o);

enum { SHADE_SLOPE_MAX_SIDE = 65536 };

typedef struct shade_slope_map shade_slope_map;

/*
 * Copy a picture, `channels` floats a texel (2 or more; those past the third are passed
 * over), row 0 the top, any size, and build its pyramid of slope moments. Takes 8 bytes a
 * texel and as much again for the pyramid. *status (if not NULL) gathers:
 * SHADE_CLAMPED_NORMAL where a normal points inwards or lies flatter than slope 50, which it
 * is then given; SHADE_BAD_INPUT where a texel is not finite or has no direction: it counts as
 * flat; SHADE_CLAMPED_PARAMETER and SHADE_BAD_CHOICE for the options (NULL: the defaults). NULL
 * when out of memory, or without pixels or for a side or number of channels out of range (then
 * *status is SHADE_BAD_INPUT).
 */
SHADE_API shade_slope_map *shade_slope_map_create(const float *pixels, int width, int height,
                                                  int channels, const shade_slope_options *options,
                                                  unsigned *status);
SHADE_API void shade_slope_map_free(shade_slope_map *m); /* NULL is fine */

/*
 * Slopes over a footprint about (u, v). Without one: the slopes interpolated bilinearly, no
 * covariance. With one: the mean and covariance over it of that same interpolated field.
 * Up to 1.85 texels (root of its area), or 4 along a thin one, it is sampled. From 2 on, or 4.3, a
 * parallelogram of texels answers whose second moments are the footprint's, as long as it is no
 * more than 16 times longer than wide: of the patches between texels first, from 4 on (root of its
 * area) of the pyramid. Blends lie between. Returns SHADE_BAD_INPUT, and flat, where an argument is
 * not finite. [OlanoBaker2010]
 */
SHADE_API unsigned shade_slope_lookup(const shade_slope_map *m, double u, double v,
                                      const double footprint[4], shade_slopes *slopes);

/* ---- slopes into roughness ------------------------------------------------------- */

/*
 * The material whose lobe about the mean normal n stands for the given one about all the
 * normals that n is the mean of. n and covariance are shade_slopes's (n NULL: z).
 *
 * *out is the given material with wider exponents or alphas along axes that are turned from
 * the tangent by *angle (radians from x towards y, in [-pi/4, pi/4]): shade it in the frame
 * whose tangent is cos(angle) x + sin(angle) y, with n, wi and wo in that frame. A groove
 * that was auto stays where it was, unless the lobe was round. *out may be *p.
 *
 * With the covariance S carried to n's own tangent plane: 1/e + S (Ashikhmin-Shirley),
 * alpha^2 + 2 S (Ward), as lobes add that are shifted in the plane of slopes. Tilted lobes are
 * higher in the middle and further out than that (a density of slopes over the fourth power of the
 * cosine from a nearer axis); for Beckmann each slope of S counts 1/(1 + alpha^2) of itself, by the
 * alpha along its own axis, which makes the peak right with microfacet (others: 1/(1 + alpha^2/2),
 * half of it, nearest over all lights). GGX has no variance to add to: half of that narrowing, and
 * 0.4 times (alpha^2 2 S)/(alpha^2 + 2 S) on top, a compromise between the peak (too high by 24 %
 * at most without it, by 14 % with it) and the whole lobe.
 *
 * Half the integral of |difference| of the distributions over that of the true one, for Gaussian
 * slopes of deviation s each way, exponents 200 and 10 or the matching alphas, detail rotate, as a
 * test measures it:
 *
 *   s                  0.05   0.1    0.2
 *   ashikhmin_shirley  0.003  0.009  0.019
 *   ward               0.004  0.014  0.044
 *   ward_half          0.006  0.014  0.033
 *   beckmann           0.005  0.014  0.039  (0.042 with microfacet)
 *   ggx                0.050  0.099  0.154
 *
 * The mean colour of a map of smooth random slopes, of lobes of alpha 0.18 and 0.36 or
 * exponents 60 and 12, over 20 pairs of light and view (compare/slopes.py): 1.3 to 3.0 % off
 * for deviations of 0.05 and 0.1, 4.3 (Ashikhmin-Shirley), 4.4 (Beckmann), 6.1 (Ward) and
 * 8.3 % (GGX) for 0.15 and 0.1.
 *
 * At its peak D is within 1 % (Beckmann with microfacet; 7 with others), 2 (Ward) and 7 % (its
 * cheap form) of the mean of the lobes for alphas to 0.36 and deviations to 0.35, of GGX and
 * Ashikhmin-Shirley 14 and 12 % too high; with alphas of 0.5 within 5 (13), 0, 8, 4 and 5 %. Slopes
 * that are not Gaussian (few deep scratches on a polished plate) are wider in the tail and narrower
 * at the peak than the one lobe that has their covariance: back ends give the plate a lobe of its
 * own. A covariance that is indefinite, or not finite, counts as the nearest that is not
 * (SHADE_BAD_INPUT). What the material has out of its range is mended as by shade_bsdf_setup,
 * results out of the parameters' ranges are clamped (SHADE_CLAMPED_PARAMETER).
 */
SHADE_API unsigned shade_params_widen(const shade_params *p, const double n[3],
                                      const double covariance[3], shade_params *out, double *angle);

enum { SHADE_SLOPE_LOBES = 8 };

/* Lobes of one shape about several normals. */
typedef struct shade_slope_lobes {
  int count; /* in use, [1, SHADE_SLOPE_LOBES] */
  double nx[SHADE_SLOPE_LOBES], ny[SHADE_SLOPE_LOBES], nz[SHADE_SLOPE_LOBES]; /* unit, nz > 0 */
  double weight[SHADE_SLOPE_LOBES];                                           /* > 0, sum 1 */
} shade_slope_lobes;

/*
 * shade_params_widen with `most` lobes at most, 1 to SHADE_SLOPE_LOBES, instead of one; beyond
 * it is clamped (SHADE_CLAMPED_PARAMETER), 5 and 7 are taken as 4 and 6. The normals carry part of
 * the covariance, the lobe widens by the rest, so that the second moments stay what they were: 2, 3
 * or 4 normals along the axis on which the slopes spread most beside the lobe, two across it from 4
 * lobes on; none where the spread is below a tenth of the lobe's width. (What GGX's one lobe has on
 * top, several have not.) All normals are in the
 * frame turned by *angle, ready for a batch:
 *
 *   shade_slope_lookup(map, u, v, footprint, &s);
 *   shade_params_split(&p, s.normal, s.covariance, 6, &wide, &angle, &k);
 *   shade_bsdf_setup(&b, &wide);
 *   for (int i = 0; i < k.count; i++) {
 *     const double n[3] = {k.nx[i], k.ny[i], k.nz[i]};
 *     shade_bsdf_eval(&b, n, wi, wo, f, &cosine); // wi, wo in the turned frame
 *     red += k.weight[i] * f[0] * cosine;
 *   }
 *
 * Mean colour over 20 pairs of light and view, % off, for Gaussian slopes of deviation 0.15 and
 * 0.11, alphas 0.18 and 0.36, detail rotate, as a test measures it; and what a lookup costs
 * with GGX, in ns of one core (gcc 12, AMD EPYC, AVX-512, doubles), shade_bsdf_setup's 150 apart:
 *
 *   lobes              1     4    6    8
 *   ashikhmin_shirley  3.0   2.0  1.5  1.0
 *   ward               2.9   2.6  1.9  1.3
 *   ward_half          2.7   2.9  2.0  1.4
 *   beckmann           2.4   1.7  1.2  0.7
 *   ggx                8.6   1.9  1.2  1.4
 *   this call          228   379  459  527
 *   batch of its lobes 123   198  264  301
 *
 * On the maps of compare/slopes.py six lobes are within 0.4 % (deviations 0.05 and 0.1), 2.3 %
 * (0.15 and 0.1, where one is 8.3 % off with GGX) and 0.2 % (scratches), at every footprint.
 *
 * Two moments are all that is known of the slopes. Even ripples, whose slopes are most frequent
 * at their ends, stay 10 to 12 % off (one lobe: 12 to 19), and so does GGX where the slopes spread
 * much more than the lobe does: with alphas of 0.07 and 0.14 about 11 % instead of 20.
 *
 * With most = 1 *out and *angle are those of shade_params_widen, as are the status bits and what
 * bad input becomes. Slopes beyond 50 are cut to it. *out may be *p. Reentrant.
 */
SHADE_API unsigned shade_params_split(const shade_params *p, const double n[3],
                                      const double covariance[3], int most, shade_params *out,
                                      double *angle, shade_slope_lobes *lobes);

#ifdef __cplusplus
}
#endif
#endif
