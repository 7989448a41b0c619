/* SPDX-License-Identifier: Apache-2.0 */
/**
 * The directional albedo of a material: the integral of f cos over all wi.
 *
 * It is the share of even white light that leaves towards wo. It serves for ambient terms, and to
 * know what energy is left for what lies below or between.
 *
 * Threads. Any number of threads may share a table once it is made. Only shade_bsdf_albedo_create
 * allocates.
 */
#ifndef SHADE_ALBEDO_H /* read once */
#define SHADE_ALBEDO_H

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A table of the albedo of one material. */
typedef struct shade_bsdf_albedo shade_bsdf_albedo;

/**
 * Make a table over the elevation and azimuth of wo, for n = z.
 *
 * There all detail methods and horizons are one. It comes from quadrature over half vectors and,
 * for the diffuse part, over wi. It takes 7 KiB, and some milliseconds to make.
 *
 * Threads: the call allocates, and reads the environment as shade_bsdf_setup does.
 *
 * @param p       parameters, as for shade_bsdf_setup
 * @param status  NULL, or out: the status that shade_bsdf_setup has for them
 * @return the table, to be freed with shade_bsdf_albedo_free; NULL when out of memory
 */
SHADE_API shade_bsdf_albedo *shade_bsdf_albedo_create(const shade_params *p, unsigned *status);

/**
 * Free a table.
 *
 * Threads: no thread may use the table any more.
 *
 * @param a  the table, or NULL
 */
SHADE_API void shade_bsdf_albedo_free(shade_bsdf_albedo *a);

/**
 * The albedo of the specular and of the diffuse part towards the eye. Their sum is that of all.
 *
 * A perturbed normal n carries wo to the frame that `rotate` makes of n. This is the albedo of a
 * bump that stands alone, which the surface's own horizon lowers. It is 0 where wo is below the
 * horizon of n or of the surface. Below 0.0004 of n.wo it is what is there.
 *
 * docs/results/library.md says how far it is from the integral. It is least exact for BRDFs with a
 * distribution that is not theirs, whose albedo exceeds 1.
 *
 * @param a         the table
 * @param n         perturbed normal, unit, local frame; NULL: z
 * @param wo        to the eye, local frame, of any length
 * @param specular  out, or NULL: RGB
 * @param diffuse   out, or NULL: RGB
 * @return status bits; SHADE_BAD_INPUT, and 0, where an argument is not finite or has no direction;
 *         SHADE_CLAMPED_NORMAL where n points down, and is lifted as shade_bsdf_eval does it
 */
SHADE_API unsigned shade_bsdf_albedo_eval(const shade_bsdf_albedo *a, const double n[3],
                                          const double wo[3], double specular[3],
                                          double diffuse[3]);

/** Inputs of shade_bsdf_albedo_batchf, one array per component. */
typedef struct shade_albedo_lanesf {
  size_t size; /* sizeof(shade_albedo_lanesf) */
  const float *wox, *woy, *woz;
  const float *nx, *ny, *nz; /* all three, or NULL for z */
} shade_albedo_lanesf;

/** Outputs of shade_bsdf_albedo_batchf, one array per component. */
typedef struct shade_albedo_resultf {
  size_t size;                                 /* sizeof(shade_albedo_resultf) */
  float *specular_r, *specular_g, *specular_b; /* all three, or NULL */
  float *diffuse_r, *diffuse_g, *diffuse_b;    /* likewise */
} shade_albedo_resultf;

/**
 * shade_bsdf_albedo_eval over arrays of float.
 *
 * @param a      the table
 * @param count  number of lanes
 * @param in     directions
 * @param out    albedos
 * @return the or of all status bits; SHADE_BAD_INPUT, and nothing written, where a required array
 *         or the size of a structure is missing
 */
SHADE_API unsigned shade_bsdf_albedo_batchf(const shade_bsdf_albedo *a, size_t count,
                                            const shade_albedo_lanesf *in,
                                            const shade_albedo_resultf *out);

#ifdef __cplusplus
}
#endif
#endif
