/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of a shade_bsdf: what setup.c works out and kernel/ reads. Private to src/, kernel/,
 * test/. */
#ifndef SHADE_SRC_BSDF_H
#define SHADE_SRC_BSDF_H

#include "shade/shade.h"

/* How h is carried: the detail method and groove axis, resolved. */
typedef enum shade_map {
  SHADE_MAP_NONE,
  SHADE_MAP_PERTURB_RATIO, /* for Ashikhmin-Shirley */
  SHADE_MAP_PERTURB,
  SHADE_MAP_ROTATE_X,
  SHADE_MAP_ROTATE_Y,
  SHADE_MAP_APPROXIMATE_X,
  SHADE_MAP_APPROXIMATE_Y,
  SHADE_MAP_SHORTEST_ARC,
  SHADE_MAP_DEFORM_LINEAR,
  SHADE_MAP_DEFORM_SMOOTH
} shade_map;

/* What half vectors are drawn from. */
typedef enum shade_draw {
  SHADE_DRAW_PHONG, /* Ashikhmin-Shirley's D, Ward's too */
  SHADE_DRAW_HALF,
  SHADE_DRAW_GAUSSIAN,
  SHADE_DRAW_GGX,
  SHADE_DRAW_VISIBLE_GAUSSIAN,
  SHADE_DRAW_VISIBLE_GGX
} shade_draw;

/* The caller's room is an array of doubles: not for the compiler to tell apart from this. */
#if defined(__GNUC__)
#define MAY_ALIAS __attribute__((may_alias))
#else
#define MAY_ALIAS
#endif

typedef struct MAY_ALIAS bsdf {
  shade_mdf mdf;
  shade_brdf brdf;
  shade_detail detail;
  shade_fresnel fresnel;
  shade_map map, shadow_map; /* of h for D, of wi and wo for Smith's Lambda */
  double kx, ky, peak;       /* exponents or 1/alpha^2, and D at the pole */
  double gx, gy;             /* alpha^2 for Lambda */
  shade_diffuse diffuse;
  int has_diffuse, fibres_along_y, fast, conserve;
  double f0[3], tint[3], k[3]; /* tint: f82, or eta */
  double kd[3];
  float kxf, kyf, peakf, gxf, gyf;
  float f0f[3], tintf[3], kf[3], kdf[3];
  shade_horizon horizon; /* hard where n is ignored */
  shade_draw draw;
  shade_map draw_map;        /* the rigid frame or warp that h is drawn in */
  int draw_parts, draw_even; /* lobes of the proposal; 1: half the diffuse draws are even */
  double sx, sy;             /* exponents or 1/alpha^2 of the proposal */
  double share_lobe, share_diffuse;
  float sxf, syf, share_lobef, share_diffusef;
} bsdf;

_Static_assert(sizeof(bsdf) <= sizeof(shade_bsdf), "shade_bsdf is too small for what it holds");
_Static_assert(_Alignof(bsdf) <= _Alignof(shade_bsdf), "shade_bsdf is less aligned than that");

static inline const bsdf *bsdf_of(const shade_bsdf *b) {
  return (const bsdf *)b;
}

/* The same to write to: setup.c's, and that of tests. */
static inline bsdf *bsdf_in(shade_bsdf *b) {
  return (bsdf *)b;
}

#endif
