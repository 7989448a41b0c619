/* SPDX-License-Identifier: Apache-2.0 */
/* A normal map as its look-ups read it. Private to src/ and kernel/. */
#ifndef SHADE_SRC_SLOPE_MAP_H
#define SHADE_SRC_SLOPE_MAP_H

#include "isa.h"
#include "moments.h"

struct shade_slope_map {
  int isa; /* of shade_isa_tables: what it runs on */
  int width, height;
  moment_wrap wrap;
  float *slopes; /* two a texel, row 0 the top */
  moment_pyramid pyramid;
};

/* Lanes of a block of look-ups. */
typedef struct slope_block {
  const float *u, *v, *side[4]; /* side: NULL for points */
  float *nx, *ny, *nz;
  float *covariance[3];  /* or NULL */
  unsigned char *single; /* set where a lane is left to shade_slope_lookup */
} slope_block;

enum { SLOPE_BLOCK = 256 };

/* Lanes of a block of lobes to widen. */
typedef struct widen_block {
  const float *n[3], *covariance[3], *base[2]; /* base: exponents or alphas */
  float *width[2], *groove[2];                 /* those of the wider lobe; its x axis */
  int exponents;
  float narrowed, blunted;     /* of the distribution's traits */
  float groove_y, groove_auto; /* 1 where grooves run along y; where y is the narrow axis */
} widen_block;

/*
 * Counts of points are rounded up, and where a footprint is a whole number of them
 * single and double precision must come to the same one.
 */
#define SLOPE_COUNT_SLACK 1e-4
/* Sides in texels up to which three points are enough; with two a texel, two are exact again. */
#define SLOPE_FEW 1.9
/* Root of a footprint's area, or its longer side, in texels: up to the one it is sampled, from the
 * other on the pyramid answers. */
#define SLOPE_NEAR 1.85
#define SLOPE_FAR 1.99
#define SLOPE_LONG_NEAR 4.0
#define SLOPE_LONG_FAR 4.3
/* How far Gauss's two points are from the middles of an interval's halves, in halves: 1/sqrt 3 -
 * 1/2. */
#define SLOPE_GAUSS_SHIFT 0.07735026918962576

/* shade_slope_lookup_batchf and shade_params_widen_batchf on an instruction set. */
unsigned slope_lookup_on(const shade_isa_table *isa, const shade_slope_map *m, size_t count,
                         const shade_slope_lanesf *in, const shade_slope_resultf *out);
unsigned slope_widen_on(const shade_isa_table *isa, const shade_params *p, size_t count,
                        const shade_widen_lanesf *in, const shade_widen_resultf *out);

#endif
