/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The reference for woven cloth: the look-up and the shading of weave.h, fabric.h and
 * docs/theory/conventions.md, long-hand. It takes what an author states, a draft and two sets of
 * parameters, and keeps nothing that was made ready.
 */
#ifndef SHADE_REFERENCE_CLOTH_H
#define SHADE_REFERENCE_CLOTH_H

#include "shade/fabric.h"
#include "shade/weave.h"

/* The normals of the yarns of one direction, over docs/theory/conventions.md's points of the cloth.
 */
typedef struct shade_ref_lean {
  double share, mean[3], covariance[3]; /* xx, xy, yy */
} shade_ref_lean;

/* draft is not copied and must outlive the rest. */
typedef struct shade_ref_cloth {
  const shade_draft *draft;
  shade_weave_params yarns;
  shade_fabric_params fabric;
  double thickness[2], spacing[2]; /* means of what is stated, 0: nothing; weft, warp */
  shade_ref_lean lean[2];          /* for shadows; weft, warp */
  double gaps;
} shade_ref_cloth;

/* Parameters clamped to their ranges, NaN and choices out of range as the headers say. */
shade_ref_cloth shade_ref_cloth_of(const shade_draft *draft, const shade_weave_params *yarns,
                                   const shade_fabric_params *fabric);

/* What is at (u, v), by the contract of shade_weave_lookup. u and v must be finite. */
void shade_ref_crossing(const shade_ref_cloth *cloth, double u, double v, shade_crossing *out);

/* s at the one point (u, v), by the contract of shade_fabric_eval. n NULL is z. */
unsigned shade_ref_cloth_near(const shade_ref_cloth *cloth, const double uv[2], const double n[3],
                              const double wi[3], const double wo[3], double s[3]);

/* The share of the eye's ray that meets something at that point. */
double shade_ref_cloth_coverage(const shade_ref_cloth *cloth, const double uv[2], const double n[3],
                                const double wo[3]);

/*
 * Over a footprint: the far model's share of it; the mean of the near model's 16 points; its mean
 * over so many points of that footprint, which the far model is to give, and the standard error of
 * as many random ones (these lie in a cell of a grid each, and are off by no more). A pixel shows
 * what its footprint sends on, and of noise what those yarns have: that is one sum for each place,
 * not what the same part of the draft sends anywhere.
 */
double shade_ref_far_share(const double footprint[2]);
unsigned shade_ref_cloth_points(const shade_ref_cloth *cloth, const double uv[2],
                                const double footprint[2], const double n[3], const double wi[3],
                                const double wo[3], double s[3]);
unsigned shade_ref_cloth_mean(const shade_ref_cloth *cloth, const double uv[2],
                              const double footprint[2], int points, const double n[3],
                              const double wi[3], const double wo[3], double s[3], double error[3]);

/* The yarns of one direction as a whole; in the frame of their mean fibres. */
typedef struct shade_ref_side {
  double share;        /* of the cloth that shows them, times occlusion */
  double matt[3];      /* the same of their diffuse reflectance */
  double fibres[2];    /* their mean direction in the cloth, unit */
  double mean[3];      /* the mean of the tilts' normals, unit */
  double spread[2];    /* variance of the tilt as an angle, along and across */
  double exponents[2]; /* of the tier `single` */
} shade_ref_side;
typedef struct shade_ref_seen {
  shade_ref_side side[2]; /* weft, warp */
  double gap[3];          /* what the gaps reflect, times their share and occlusion */
} shade_ref_seen;

/* What is seen of the cloth, from so many points spread over 65536 x 65536 repeats. */
shade_ref_seen shade_ref_cloth_seen(const shade_ref_cloth *cloth, int looks);

/* s of the tier `single`. */
unsigned shade_ref_cloth_single(const shade_ref_cloth *cloth, const shade_ref_seen *seen,
                                const double n[3], const double wi[3], const double wo[3],
                                double s[3]);

#endif
