/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Shading of woven cloth, from a macro shot to a figure across the room.
 *
 * Near, each point shows one yarn: a lobe that is narrow along the fibres (alternating
 * anisotropy: weft and warp are crossed) is carried by the tilt that shade_weave_lookup finds
 * there, with any of the detail methods, and a diffuse part is integrated over the fibre. Far
 * away, a pixel holds many yarns: the average over them is a mixture of lobes at nodes of the
 * tilt, found once from the weave itself, so that crimp, slant, occlusion, noise and
 * any draft are in it. What a pixel needs is chosen by its footprint, and one passes into
 * the other without a jump. [KangFabric, corrected]
 *
 * A shade_fabric is set up once; evaluation allocates nothing, holds no state and may be
 * called from any number of threads at once. Frame as in shade.h: x along u, y along v.
 */
#ifndef SHADE_FABRIC_H
#define SHADE_FABRIC_H

#include "shade/shade.h"
#include "shade/weave.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the yarns of one direction are made of. Exponents as for Ashikhmin-Shirley; other
 * distributions take the matching alphas, e = 2/alpha^2 - 2. */
typedef struct shade_yarn {
  double along;  /* exponent along the fibres; smooth fibres: large, [0, 1e6] */
  double across; /* exponent across them, [0, 1e6] */
  double f0[3];  /* reflectance at normal incidence (Schlick), linear RGB, [0, 1] */
  double kd[3];  /* diffuse reflectance, linear RGB, [0, 1] */
  shade_diffuse diffuse;
} shade_yarn;

typedef struct shade_fabric_params {
  size_t size; /* sizeof(shade_fabric_params), set by shade_fabric_params_init */
  shade_mdf mdf;
  shade_brdf brdf;
  shade_detail detail;
  shade_yarn warp, weft;
  int draft_colors;  /* 1: each yarn's kd is multiplied by its colour in the draft */
  double backing[3]; /* reflectance of what shows through the gaps (Lambert), [0, 1] */
  /* A nap of loose fibres over the cloth: optical depth [0, 10] and colour [0, 1]. It
   * scatters once, which brightens grazing views, and veils the yarns below. 0: none. */
  double nap, nap_color[3];
} shade_fabric_params;

/* Ashikhmin-Shirley, rotate, fibre diffuse; exponents 100 and 10, f0 .04, kd .5, no nap. */
SHADE_API void shade_fabric_params_init(shade_fabric_params *p);

typedef struct shade_fabric shade_fabric;

/*
 * A fabric ready for evaluation; it keeps a pointer to `weave`, which must outlive it. Numbers
 * out of range are clamped (SHADE_CLAMPED_PARAMETER; NaN becomes the default), unknown choices
 * become the first of their list (SHADE_BAD_CHOICE): or-ed into *status unless it is NULL. p may
 * be NULL: the defaults. Looks at some 10^5 points of the weave: milliseconds for a repeat of
 * a few yarns, up to half a second for the largest drafts. NULL if weave is NULL or memory ran
 * out.
 */
SHADE_API shade_fabric *shade_fabric_create(const shade_weave *weave, const shade_fabric_params *p,
                                            unsigned *status);
SHADE_API void shade_fabric_free(shade_fabric *fabric); /* NULL is fine */

/*
 * How to evaluate.
 *   AUTO    by the footprint: 16 points of the near model in it while it is below .75
 *           crossings, the far model above 2, both between
 *   NEAR    the one point (u, v): what AUTO does for no footprint
 *   FAR     the mixture, with what share of the footprint each yarn has by the draft
 *   SINGLE  one lobe for the warp and one for the weft, of the right second moments, the
 *           same everywhere: cheapest, for the background. Its mean colour is off by 15 to 55 %
 *           at the worst of 20 pairs of light and eye, and by 250 % where a dark cloth has a
 *           narrow highlight (FAR: by 2 %; compare/fabric.py)
 */
typedef enum shade_fabric_tier {
  SHADE_TIER_AUTO,
  SHADE_TIER_NEAR,
  SHADE_TIER_FAR,
  SHADE_TIER_SINGLE
} shade_fabric_tier;

/*
 * Radiance towards wo for unit irradiance at normal incidence from wi: f cos, RGB, in
 * 1/sr. (A picture is s times irradiance; a renderer that wants f divides by n.wi.) 0 where
 * n.wi, n.wo, wi.z or wo.z is <= 0.
 *   uv         where, in crossings (weave.h)
 *   footprint  extent of the pixel along u and v in crossings, >= 0; NULL is 0
 *   n          perturbed normal of the cloth as a whole (folds, a normal map), NULL for none.
 *              It is carried by groove transport: weft yarns follow dP/du of the surface whose
 *              normal is n, warp yarns dP/dv, and the yarn's own tilt is applied in that frame.
 * No s is larger than what arrives allows: over all wi, the integral of s dwi is at most
 * 1, near and far, for detail methods other than perturb (test_fabric).
 * Status: SHADE_CLAMPED_NORMAL; SHADE_BAD_INPUT for non-finite input or wi = -wo (0) and for a
 * footprint that is negative or NaN (taken as 0).
 */
SHADE_API unsigned shade_fabric_eval(const shade_fabric *fabric, const double uv[2],
                                     const double footprint[2], const double n[3],
                                     const double wi[3], const double wo[3], shade_fabric_tier tier,
                                     double s[3]);
SHADE_API unsigned shade_fabric_evalf(const shade_fabric *fabric, const float uv[2],
                                      const float footprint[2], const float n[3], const float wi[3],
                                      const float wo[3], shade_fabric_tier tier, float s[3]);

/*
 * The same over arrays. n and the footprint may be NULL as a whole (all three, both). Outputs
 * must not overlap inputs. Returns the or of all status bits.
 */
typedef struct shade_fabric_lanes {
  const double *u, *v, *du, *dv;
  const double *nx, *ny, *nz, *wix, *wiy, *wiz, *wox, *woy, *woz;
} shade_fabric_lanes;
typedef struct shade_fabric_lanesf {
  const float *u, *v, *du, *dv;
  const float *nx, *ny, *nz, *wix, *wiy, *wiz, *wox, *woy, *woz;
} shade_fabric_lanesf;
SHADE_API unsigned shade_fabric_eval_batch(const shade_fabric *fabric, size_t count,
                                           const shade_fabric_lanes *in, shade_fabric_tier tier,
                                           double *r, double *g, double *b);
SHADE_API unsigned shade_fabric_eval_batchf(const shade_fabric *fabric, size_t count,
                                            const shade_fabric_lanesf *in, shade_fabric_tier tier,
                                            float *r, float *g, float *b);

/* How the far model sees the fabric, for charts and tests. */
typedef struct shade_fabric_info {
  int warp_lobes, weft_lobes;            /* nodes of the mixture */
  double warp_share, weft_share;         /* what is seen of each, times its occlusion */
  double warp_single[2], weft_single[2]; /* exponents along and across, tier SINGLE */
} shade_fabric_info;
SHADE_API void shade_fabric_get_info(const shade_fabric *fabric, shade_fabric_info *info);

#ifdef __cplusplus
}
#endif
#endif
