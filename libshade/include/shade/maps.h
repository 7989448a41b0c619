/* SPDX-License-Identifier: Apache-2.0 */
/**
 * Fields of slopes over a texture: scratches, made from numbers, normal maps, and how steep they
 * are.
 *
 * Looked up with a footprint, they give the mean normal and what is lost in the mean, the
 * covariance of the slopes. shade_params_widen adds that to a lobe. So scratches turn into
 * roughness from afar, and not into noise.
 *
 * Coordinates. u runs to the right and v up, in [0, 1] over the tile or picture. Row 0 of a picture
 * is its top. The centre of texel (i, j) is at u = (i + 1/2)/width, v = 1 - (j + 1/2)/height.
 * Normals are in tangent space: x along u, y along v, z out. The slope of a height field is its
 * gradient, (dH/dx, dH/dy). n is (-slope, 1) made unit.
 *
 * A footprint is the parallelogram that a pixel covers, {du1, dv1, du2, dv2}: the two whole sides,
 * as vectors in (u, v). NULL, or all 0, asks for the point itself.
 *
 * Threads. Nothing here has global state. Any number of threads may share a field or map once it
 * is made. Only functions whose names end in _create allocate.
 */
#ifndef SHADE_MAPS_H /* read once */
#define SHADE_MAPS_H

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a look-up returns. */
typedef struct shade_slopes {
  double normal[3];     /* unit: of the mean slope */
  double mean[2];       /* mean slope */
  double covariance[3]; /* of the slopes about their mean: xx, xy, yy; never indefinite */
} shade_slopes;

/* ---- scratches ------------------------------------------------------------------ */

/** A value drawn between two: radii evenly in the logarithm, others evenly. */
typedef struct shade_range {
  double low, high;
} shade_range;

/** Limits of a field of scratches. */
enum {
  SHADE_SCRATCH_LAYERS = 8,
  SHADE_SCRATCH_MAX_PITS = 4000000 /* of all layers */
};

/** Pits: spherical caps, stretched along the scratch. Lengths are in tile widths. */
typedef struct shade_scratch_layer {
  uint32_t pits;
  shade_range radius;  /* half width of the rim across the scratch, [1e-6, 0.5] */
  shade_range stretch; /* half length over half width, [1, 1e5]; 1 is a round pit. What would
                          reach past half a tile is cut to it, without a status */
  shade_range depth;   /* of the centre over the radius, [0, 0.99] */
  double direction;    /* of the length, from +u towards +v, radians */
  double spread;       /* up to this far to either side of the direction, [0, pi/2]: pi/2 is any */
} shade_scratch_layer;

/** What a field of scratches is made of. */
typedef struct shade_scratch_params {
  size_t size;   /* sizeof(shade_scratch_params), set by shade_scratch_params_init */
  uint64_t seed; /* another seed, other scratches */
  double aspect; /* height of the tile over its width, [1e-3, 1e3] */
  int cells;     /* of the table that answers footprints, along the tile's longer side,
                    [0, 4096]; 0: none, every footprint is sampled, 1024 points at most */
  int layers;    /* in use, [0, SHADE_SCRATCH_LAYERS] */
  shade_scratch_layer layer[SHADE_SCRATCH_LAYERS];
} shade_scratch_params;

/**
 * Fine scratches along u, within 10 degrees. Every layer holds these values, and one is in use.
 *
 * @param p  the numbers to fill
 */
SHADE_API void shade_scratch_params_init(shade_scratch_params *p);

/** A field of scratches, made ready for look-ups. */
typedef struct shade_scratch_field shade_scratch_field;

/**
 * Build a field: every pit, bins that find those over a point, and the table for footprints.
 *
 * The same numbers give the same field. More pits in a layer leave the others where they are.
 * Values out of range are clamped, and NaN becomes the default. The ends of a range trade places
 * where they are the wrong way round. Pits beyond SHADE_SCRATCH_MAX_PITS are left out. Each of
 * these is SHADE_CLAMPED_PARAMETER. The table takes most of the time.
 *
 * Threads: the call allocates, and reads the environment as shade_bsdf_setup does.
 *
 * @param p       the numbers; NULL, or without its size (SHADE_BAD_INPUT): the defaults
 * @param status  NULL, or out: status bits
 * @return the field, to be freed with shade_scratch_free; NULL only when out of memory
 */
SHADE_API shade_scratch_field *shade_scratch_create(const shade_scratch_params *p,
                                                    unsigned *status);

/**
 * Free a field.
 *
 * Threads: no thread may use the field any more.
 *
 * @param f  the field, or NULL
 */
SHADE_API void shade_scratch_free(shade_scratch_field *f);

/**
 * Height and slopes at (u, v), which repeat with period 1.
 *
 * Where pits overlap the deepest counts, and on equal depth the one that comes first. Inside one,
 * q is the place over its half axes, d the depth over the radius r, and k = 2 d/(1 + d^2). Then
 * H = -(r/k)(sqrt(1 - k^2 q^2) - sqrt(1 - k^2)). A point costs time in proportion to the pits near
 * it, not to their number.
 *
 * With a footprint these are the mean height and slope over it, and the covariance. Footprints up
 * to about two cells of the table are sampled on a grid. Larger ones come from the table's mip
 * levels, along the longer side up to 16 times the shorter. A blend lies between. The table itself
 * is averaged from 12 to 64 samples a cell. They are jittered, and each has a column and a row of
 * the cell to itself. docs/results/library.md says how exact the second moments are.
 *
 * @param f          the field
 * @param u, v       where, in tiles
 * @param footprint  what the pixel covers, in tiles; NULL: the point
 * @param height     out, or NULL: in tile widths, 0 at the plate, negative in a pit
 * @param slopes     out: the slopes
 * @return status bits; SHADE_BAD_INPUT, and the flat plate, where an argument is not finite
 */
SHADE_API unsigned shade_scratch_eval(const shade_scratch_field *f, double u, double v,
                                      const double footprint[4], double *height,
                                      shade_slopes *slopes);

/**
 * Rows of a picture of the field, which is width x rows texels.
 *
 * Each texel is the mean over samples x samples points of it, where 1 takes the centre.
 *
 * Threads: any thread may make any rows, in any order. The numbers do not depend on it.
 *
 * @param f        the field
 * @param width    texels of a row
 * @param rows     rows of the whole picture
 * @param first    the first row wanted, from the top
 * @param count    how many rows are wanted
 * @param samples  points along each side of a texel
 * @param height   out, or NULL: one float a texel, in tile widths
 * @param normal   out, or NULL: three floats a texel, unit
 */
SHADE_API void shade_scratch_rows(const shade_scratch_field *f, int width, int rows, int first,
                                  int count, int samples, float *height, float *normal);

/* ---- normal maps ---------------------------------------------------------------- */

/** What a picture's first channels hold. Two channels: z is what makes the normal unit. */
typedef enum shade_normals {
  SHADE_NORMALS_COLOUR = 0, /* normals, 0 to 1 for -1 to 1 */
  SHADE_NORMALS_SIGNED = 1, /* normals, -1 to 1 */
  SHADE_NORMALS_SLOPE = 2   /* dH/dx, dH/dy, in the first two channels */
} shade_normals;

/** What lies beyond the picture's edge. */
typedef enum shade_wrap {
  SHADE_WRAP_REPEAT = 0,
  SHADE_WRAP_CLAMP = 1, /* the outermost texel */
  SHADE_WRAP_MIRROR = 2
} shade_wrap;

/** How the picture of a normal map is read. */
typedef struct shade_slope_options {
  size_t size; /* sizeof(shade_slope_options), set by shade_slope_options_init */
  shade_normals normals;
  shade_wrap wrap;
  int directx;     /* 1: green (y) points down, as in DirectX; 0: up, as in OpenGL */
  double strength; /* [0, 100] (docs/theory/conventions.md); beyond 1 only the slope grows */
} shade_slope_options;

/**
 * Colours, repeat, green up, strength 1.
 *
 * @param o  the options to fill
 */
SHADE_API void shade_slope_options_init(shade_slope_options *o);

/** The longest side of a normal map, in texels. */
enum { SHADE_SLOPE_MAX_SIDE = 65536 };

/** A normal map, made ready for look-ups. */
typedef struct shade_slope_map shade_slope_map;

/**
 * Copy a picture, and build the pyramid of its slope moments.
 *
 * It takes 8 bytes a texel, and as much again for the pyramid.
 *
 * Threads: the call allocates.
 *
 * @param pixels    `channels` floats a texel, row 0 the top
 * @param width     texels of a row, 1 to SHADE_SLOPE_MAX_SIDE
 * @param height    rows, 1 to SHADE_SLOPE_MAX_SIDE
 * @param channels  2 or more; those past the third are passed over
 * @param options   how the picture is read; NULL: the defaults
 * @param status    NULL, or out: SHADE_CLAMPED_NORMAL where a normal points inwards or lies flatter
 *                  than slope 50, which it is then given; SHADE_BAD_INPUT where a texel is not
 *                  finite or has no direction, and counts as flat; SHADE_CLAMPED_PARAMETER and
 *                  SHADE_BAD_CHOICE for the options
 * @return the map, to be freed with shade_slope_map_free; NULL when out of memory, and
 *         (SHADE_BAD_INPUT) without pixels or for a side or number of channels out of range
 */
SHADE_API shade_slope_map *shade_slope_map_create(const float *pixels, int width, int height,
                                                  int channels, const shade_slope_options *options,
                                                  unsigned *status);

/**
 * Free a map.
 *
 * Threads: no thread may use the map any more.
 *
 * @param m  the map, or NULL
 */
SHADE_API void shade_slope_map_free(shade_slope_map *m);

/**
 * Slopes over a footprint about (u, v).
 *
 * Without a footprint these are the slopes interpolated bilinearly, without a covariance. With one
 * they are the mean and covariance over it of that same interpolated field.
 *
 * A footprint of up to 1.85 texels (root of its area), or 4 along a thin one, is sampled. From 2
 * on, or 4.3, a parallelogram of texels answers whose second moments are those of the footprint, as
 * long as it is no more than 16 times longer than wide. Its patches between texels do so first, and
 * from 4 on (root of its area) the pyramid. Blends lie between. [OlanoBaker2010]
 *
 * @param m          the map
 * @param u, v       where, in pictures
 * @param footprint  what the pixel covers, in pictures; NULL: the point
 * @param slopes     out: the slopes
 * @return status bits; SHADE_BAD_INPUT, and flat, where an argument is not finite
 */
SHADE_API unsigned shade_slope_lookup(const shade_slope_map *m, double u, double v,
                                      const double footprint[4], shade_slopes *slopes);

/* ---- how steep bumps are ---------------------------------------------------------- */

/** How steep bumps are near each place of a map, for SHADE_HORIZON_MUTUAL. */
typedef struct shade_relief shade_relief;

/** What shade_relief_whole returns at most of bumps that are even. */
#define SHADE_RELIEF_EVEN 0.5

/**
 * Find how steep bumps are near each place, from points that lie as densely on all of a surface.
 *
 * Each place has the second moment of slopes in a window of 3 by 3 cells about it. 8 to 256 cells
 * lie along a side, by powers of 2: the most of which windows hold four fifths of the variance, but
 * no more than let a cell have 2 points on the mean. Where windows differ little, bumps are even,
 * and every place has the moment of all points (docs/theory/horizons.md, Which slopes count). Few
 * points tell less of that: where 4096 of them differ by more than 0.2, take more.
 *
 * With `shape` long waves are the surface's own, which nothing shades: windows eight times as wide
 * have means of their own, and moments are about these.
 *
 * Places repeat with period 1. Where all lie in a smaller square, it is that which is divided. A
 * point counts nothing where a number of it is not finite, or its weight is not above 0.
 *
 * Threads: the call allocates.
 *
 * @param count   points; from 131072 on there may be 256 cells
 * @param u, v    their places, as of a picture; finite
 * @param x, y    their slopes along T and y of the local frame: -n.x/n.z, -n.y/n.z
 * @param weight  NULL, or what each counts beside the others, above 0
 * @param shape   1: means of wide windows; 0: one mean
 * @return the relief, to be freed with shade_relief_free; NULL only when out of memory
 */
SHADE_API shade_relief *shade_relief_create(size_t count, const float *u, const float *v,
                                            const float *x, const float *y, const float *weight,
                                            int shape);

/**
 * Free a relief.
 *
 * Threads: no thread may use the relief any more.
 *
 * @param r  the relief, or NULL
 */
SHADE_API void shade_relief_free(shade_relief *r);

/**
 * The slopes of all points, and how much windows differ.
 *
 * @param r       the relief
 * @param slopes  out: x, y, xx, xy, yy, as shade_params_set_slopes takes them; 0 without points. Of
 *                a shape the moment is that about its means
 * @return the variance of the moment xx + yy in windows over the square of its mean; up to
 *         SHADE_RELIEF_EVEN, and without a shape, every place has the slopes of all
 */
SHADE_API double shade_relief_whole(const shade_relief *r, double slopes[5]);

/**
 * The slopes at places, from middle to middle of windows without a step.
 *
 * @param r       the relief
 * @param count   places; 1 for a hit
 * @param u, v    where; one that is not finite has the slopes of all
 * @param slopes  out: arrays of x, y, xx, xy, yy, each of `count` numbers, or NULL where it is not
 *                wanted
 */
SHADE_API void shade_relief_lookup_batchf(const shade_relief *r, size_t count, const float *u,
                                          const float *v, float *const slopes[5]);

/* ---- slopes into roughness ------------------------------------------------------- */

/**
 * The material whose lobe about the mean normal stands for one about all the normals of that mean.
 *
 * *out is the given material with wider exponents or alphas along axes that are turned from the
 * tangent. Shade it in the frame whose tangent is cos(angle) x + sin(angle) y, with n, wi and wo in
 * that frame. A groove that was auto stays where it was, unless the lobe was round.
 *
 * Let S be the covariance carried to n's own tangent plane. The width is 1/e + S
 * (Ashikhmin-Shirley) or alpha^2 + 2 S (Ward), as lobes add that are shifted in the plane of
 * slopes. Tilted lobes are higher in the middle and further out than that, because a density of
 * slopes is over the fourth power of the cosine from a nearer axis. So for Beckmann each slope of S
 * counts 1/(1 + alpha^2) of itself, by the alpha along its own axis, which makes the peak right
 * with microfacet. With other BRDFs it counts 1/(1 + alpha^2/2), half of that narrowing, which is
 * nearest over all lights. GGX has no variance to add to. It gets half of that narrowing, and 0.4
 * times (alpha^2 2 S)/(alpha^2 + 2 S) on top: a compromise between the peak and the whole lobe.
 *
 * docs/results/library.md says how near this comes. Slopes that are not Gaussian, such as few deep
 * scratches on a polished plate, are wider in the tail and narrower at the peak than the one lobe
 * that has their covariance. Back ends give such a plate a lobe of its own.
 *
 * @param p           the material
 * @param n           mean normal, as shade_slopes has it; NULL: z
 * @param covariance  of the slopes, xx, xy, yy; one that is indefinite or not finite counts as the
 *                    nearest that is neither (SHADE_BAD_INPUT)
 * @param out         out: the wider material; it may be p
 * @param angle       out: radians from x towards y, in [-pi/4, pi/4]
 * @return status bits; what the material has out of its range is mended as by shade_bsdf_setup, and
 *         results out of their range are clamped (SHADE_CLAMPED_PARAMETER)
 */
SHADE_API unsigned shade_params_widen(const shade_params *p, const double n[3],
                                      const double covariance[3], shade_params *out, double *angle);

/** The most lobes of shade_params_split. */
enum { SHADE_SLOPE_LOBES = 8 };

/** Lobes of one shape about several normals. */
typedef struct shade_slope_lobes {
  int count; /* in use, [1, SHADE_SLOPE_LOBES] */
  double nx[SHADE_SLOPE_LOBES], ny[SHADE_SLOPE_LOBES], nz[SHADE_SLOPE_LOBES]; /* unit, nz > 0 */
  double weight[SHADE_SLOPE_LOBES];                                           /* > 0, sum 1 */
} shade_slope_lobes;

/**
 * shade_params_widen with several lobes in place of one.
 *
 * The normals carry part of the covariance, and the lobe widens by the rest, so that the second
 * moments stay what they were. 2, 3 or 4 normals stand along the axis on which the slopes spread
 * most beside the lobe, and from 4 lobes on two across it. There are none where the spread is below
 * a tenth of the lobe's width. What GGX's one lobe has on top, several have not. Slopes beyond 50
 * are cut to it. All normals are in the frame turned by *angle, ready for a batch:
 *
 * @code
 * shade_slope_lookup(map, u, v, footprint, &s);
 * shade_params_split(&p, s.normal, s.covariance, 6, &wide, &angle, &k);
 * shade_bsdf_setup(&b, &wide);
 * for (int i = 0; i < k.count; i++) {
 *   const double n[3] = {k.nx[i], k.ny[i], k.nz[i]};
 *   shade_bsdf_eval(&b, n, wi, wo, f, &cosine); // wi, wo in the turned frame
 *   red += k.weight[i] * f[0] * cosine;
 * }
 * @endcode
 *
 * docs/results/library.md says what several lobes cost, and how much nearer they come. Two moments
 * are all that is known of the slopes. So even ripples stay further off, whose slopes are most
 * frequent at their ends, and so does GGX where the slopes spread much more than the lobe does.
 *
 * @param p           the material
 * @param n           mean normal; NULL: z
 * @param covariance  of the slopes, as for shade_params_widen
 * @param most        lobes at most, 1 to SHADE_SLOPE_LOBES, beyond it clamped
 *                    (SHADE_CLAMPED_PARAMETER); 5 and 7 are taken as 4 and 6, and 1 gives what
 *                    shade_params_widen does
 * @param out         out: the material of every lobe; it may be p
 * @param angle       out: radians from x towards y, in [-pi/4, pi/4]
 * @param lobes       out: their normals and weights
 * @return status bits, as shade_params_widen
 */
SHADE_API unsigned shade_params_split(const shade_params *p, const double n[3],
                                      const double covariance[3], int most, shade_params *out,
                                      double *angle, shade_slope_lobes *lobes);

#ifdef __cplusplus
}
#endif
#endif
