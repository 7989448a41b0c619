/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the C tests: cmocka, a seeded generator, directions. */
#ifndef SHADE_TEST_SUPPORT_H
#define SHADE_TEST_SUPPORT_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "reference/reference.h"
#include "shade/shade.h"
#include "src/bsdf.h"
#include "src/isa.h"

/* cmocka's assert_float_equal works in float */
#define assert_near(got, want, tolerance) assert_true(fabs((got) - (want)) <= (tolerance))

#define PI 3.14159265358979323846

/* splitmix64: the same numbers on every machine */
static inline double uniform(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static inline void spherical(double theta, double phi, double v[3]) {
  v[0] = sin(theta) * cos(phi);
  v[1] = sin(theta) * sin(phi);
  v[2] = cos(theta);
}

static inline int is_warp(shade_detail d) {
  return shade_map_kind_of(shade_detail_is(d).slopes[0]) != SHADE_RIGID;
}

/* Any distribution from exponents; the alphas are the matching ones. */
static inline shade_bsdf make_lobe(shade_mdf mdf, shade_detail detail, shade_groove groove,
                                   double ex, double ey) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, ex, ey);
  p.mdf = mdf;
  p.detail = detail;
  p.groove = groove;
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  return b;
}

static inline shade_bsdf make_bsdf(shade_detail detail, shade_groove groove, double ex, double ey) {
  return make_lobe(SHADE_MDF_ASHIKHMIN_SHIRLEY, detail, groove, ex, ey);
}

#endif
