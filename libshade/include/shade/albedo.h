/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The directional albedo of a material: the integral of f cos over all wi, the share of even
 * white light that leaves towards wo. For ambient terms, and to know what energy is left for what
 * lies below or between.
 *
 * Threads. A table may be shared by any number of threads once it is made. Only _create allocates.
 */
#ifndef SHADE_ALBEDO_H
#define SHADE_ALBEDO_H

#include "shade/shade.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shade_bsdf_albedo shade_bsdf_albedo;

/*
 * Work out a table over the elevation and azimuth of wo for n = z, where all detail methods and
 * horizons are one, by quadrature over half vectors and, for the diffuse part, over wi. It takes
 * 7 KiB, and 0.7 ms for a round lobe, 6 ms for another and 3 more with a diffuse part that depends
 * on wo (one core at 2.6 GHz, AVX-512); a look-up 60 ns. Parameters as for shade_bsdf_setup, whose
 * status *status gets (NULL is fine). NULL when out of memory.
 */
SHADE_API shade_bsdf_albedo *shade_bsdf_albedo_create(const shade_params *p, unsigned *status);
SHADE_API void shade_bsdf_albedo_free(shade_bsdf_albedo *a); /* NULL is fine */

/*
 * RGB of the specular and the diffuse part for wo, the eye's direction in the local frame, of
 * any length; their sum is the albedo. Either may be NULL. With n (or NULL: z), a perturbed normal,
 * wo is carried to the frame that `rotate` makes of it: the albedo of a bump that stands alone,
 * which the surface's own horizon lowers. 0 where wo is below n's or the surface's horizon; below
 * 0.0004 of n.wo it is what is there.
 *
 * Against the integral by the reference, as a test measures it for alphas from 0.05 and n.wo from
 * 0.05, every distribution, BRDF and Fresnel, reflectances up to 1: specular within 0.02, where the
 * albedo is below 1.2; within 15 % where it is above, as it is for BRDFs with a distribution that
 * is not theirs (GGX with ward_bounded reaches 36). Diffuse within 0.005, every model.
 *
 * Returns SHADE_BAD_INPUT, and 0, where an argument is not finite or has no direction;
 * SHADE_CLAMPED_NORMAL where n points down, and is lifted as shade_bsdf_eval does it.
 */
SHADE_API unsigned shade_bsdf_albedo_eval(const shade_bsdf_albedo *a, const double n[3],
                                          const double wo[3], double specular[3],
                                          double diffuse[3]);

/* Lanes of the same, `count` floats each. */
typedef struct shade_albedo_lanesf {
  size_t size; /* sizeof(shade_albedo_lanesf) */
  const float *wox, *woy, *woz;
  const float *nx, *ny, *nz; /* all three, or NULL for z */
} shade_albedo_lanesf;
typedef struct shade_albedo_resultf {
  size_t size;                                 /* sizeof(shade_albedo_resultf) */
  float *specular_r, *specular_g, *specular_b; /* all three, or NULL */
  float *diffuse_r, *diffuse_g, *diffuse_b;    /* likewise */
} shade_albedo_resultf;

/* shade_bsdf_albedo_eval over arrays. Returns the or of all status bits; SHADE_BAD_INPUT, and
 * writes nothing, where a required array is missing, or a structure's size. */
SHADE_API unsigned shade_bsdf_albedo_batchf(const shade_bsdf_albedo *a, size_t count,
                                            const shade_albedo_lanesf *in,
                                            const shade_albedo_resultf *out);

#ifdef __cplusplus
}
#endif
#endif
