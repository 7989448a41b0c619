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
#include "model/bsdf.h"
#include "batch/isa.h"
#include "batch/arrays.h"

/* cmocka's assert_float_equal works in float */
#define assert_near(got, want, tolerance) assert_true(fabs((got) - (want)) <= (tolerance))

#define PI 3.14159265358979323846

/* Sanitizers look at memory and are slow: there one case in FEWER is enough. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) && !defined(SANITIZED)
#define SANITIZED 1
#endif
#ifdef SANITIZED
enum { FEWER = 3 };
#else
enum { FEWER = 1 };
#endif

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

/* Which of `sectors` (up to 40) of a turn from x on (x, y) lies in; atan2 takes five times as long.
 */
static inline int sector_of(double x, double y, int sectors) {
  static double edge[41][2];
  static int made; /* for so many */
  for (int k = 0; made != sectors && k <= sectors; k++) {
    edge[k][0] = cos(2 * PI * (k % sectors) / sectors);
    edge[k][1] = sin(2 * PI * (k % sectors) / sectors);
  }
  made = sectors;
  const double size = fabs(x) + fabs(y);
  if (!(size > 0))
    return 0;
  /* round a square: a hundredth of a turn off at most, so the sector or one beside it */
  const double part = 0.25 * y / size, turn = x < 0 ? 0.5 - part : y < 0 ? 1 + part : part;
  int k = (int)(turn * sectors);
  k = k < sectors ? k : sectors - 1;
  const int before = edge[k][0] * y < edge[k][1] * x;
  const int after = edge[k + 1][0] * y >= edge[k + 1][1] * x;
  return (k + after - before + sectors) % sectors;
}

static inline int is_warp(shade_detail d) {
  return shade_map_is(shade_detail_is(d).slopes[0]).kind != SHADE_RIGID;
}

/* Any choice of each list but the horizon's. */
static inline void random_choices(uint64_t *seed, shade_params *p) {
  p->mdf = (shade_mdf)(uniform(seed) * SHADE_MDF_COUNT);
  p->brdf = (shade_brdf)(uniform(seed) * SHADE_BRDF_COUNT);
  p->detail = (shade_detail)(uniform(seed) * SHADE_DETAIL_COUNT);
  p->groove = (shade_groove)(uniform(seed) * SHADE_GROOVE_COUNT);
  p->fresnel = (shade_fresnel)(uniform(seed) * SHADE_FRESNEL_COUNT);
  p->diffuse = (shade_diffuse)(uniform(seed) * SHADE_DIFFUSE_COUNT);
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

/* (wi + wo).n over its length, w (one of them) mirrored at the upright facet of n. */
static inline double by_mirror(const double n[3], const double w[3], const double other[3]) {
  const double side2 = n[0] * n[0] + n[1] * n[1];
  const double step = side2 > 0 ? 2 * (n[0] * w[0] + n[1] * w[1]) / side2 : 0;
  const double h[3] = {w[0] - step * n[0] + other[0], w[1] - step * n[1] + other[1],
                       w[2] + other[2]};
  return (n[0] * h[0] + n[1] * h[1] + n[2] * h[2]) / sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
}

/*
 * The least of the cosines that f divides by, about the normal that it is shaded with: v is n, wi
 * and wo, unit. As it goes to 0, roundings grow in inverse proportion.
 */
static inline double least_cosine(const shade_params *p, const double v[9]) {
  const double *wi = v + 3, *wo = v + 6;
  double n[3] = {0, 0, 1};
  if (p->detail != SHADE_DETAIL_NONE)
    shade_ref_normal(p, v, wo, n);
  const double cosi = n[0] * wi[0] + n[1] * wi[1] + n[2] * wi[2];
  const double coso = n[0] * wo[0] + n[1] * wo[1] + n[2] * wo[2];
  const double least = fmin(fmin(fabs(cosi), fabs(coso)), fmin(fabs(wi[2]), fabs(wo[2])));
  if (p->horizon != SHADE_HORIZON_SCHUESSLER)
    return least;
  return fmin(least, fmin(by_mirror(n, wi, wo), by_mirror(n, wo, wi)));
}

static inline shade_bsdf make_bsdf(shade_detail detail, shade_groove groove, double ex, double ey) {
  return make_lobe(SHADE_MDF_ASHIKHMIN_SHIRLEY, detail, groove, ex, ey);
}

#endif
