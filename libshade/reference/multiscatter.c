/* SPDX-License-Identifier: Apache-2.0 */
/* Light that facets reflect more than once. The fit's numbers are the library's, as data. */
#include "model.h"

#include <math.h>

#include "../data/albedo_fit.h"

/* The sum over a fit's rows, by powers. */
#define FIT_TERM(i, j, c) +c##L *power(t, i) * power(s, j)
#define FIT_GROUP(k, l, c, terms) +power(d, k) * power(q, l) * (c##L terms)

static real power(real x, int exponent) {
  return exponent ? powl(x, exponent) : 1;
}

/* (1 - E) / (1 + E) by the fit, of an eye in the carried frame. */
static real loss(const shade_params *p, vec eye) {
  const real ax = within(p->ax, 1e-4L, 1), ay = within(p->ay, 1e-4L, 1);
  vec round = unit((vec){ax * eye.x, ay * eye.y, eye.z}); /* where the lobe is */
  const real q = square(round.x) - square(round.y), u = round.z;
  real found;
  if (p->mdf == SHADE_MDF_GGX) {
    const real t = 2 * u - 1, s = ax + ay - 1, d = ax - ay;
    found = 0 SHADE_ALBEDO_GGX(FIT_GROUP, FIT_TERM);
  } else {
    /* 1 - u without its digits' loss */
    const real less = (square(round.x) + square(round.y)) / (1 + u);
    const real t = 2 * sqrtl(less) - 1, s = square(ax) + square(ay) - 1;
    const real d = square(ax) - square(ay);
    found = 0 SHADE_ALBEDO_BECKMANN(FIT_GROUP, FIT_TERM);
  }
  return found > 0 ? found : 0;
}

/*
 * 2 times the integral of F(c) c by Gauss's rule of three points for the weight c: its points are
 * the roots of 35 c^3 - 60 c^2 + 30 c - 4, and its weights make c^0, c^1 and c^2 exact.
 */
real ref_mean_fresnel(const shade_params *p, int channel) {
  const real first[3] = {0.2L, 0.6L, 0.9L}, moment[3] = {1, 2 / 3.0L, 1 / 2.0L};
  real c[3], sum = 0;
  for (int k = 0; k < 3; k++) {
    c[k] = first[k];
    for (int step = 0; step < 12; step++)
      c[k] -= (((35 * c[k] - 60) * c[k] + 30) * c[k] - 4) / ((105 * c[k] - 120) * c[k] + 30);
  }
  for (int k = 0; k < 3; k++) {
    const real a = c[(k + 1) % 3], b = c[(k + 2) % 3];
    const real weight =
        (moment[2] - (a + b) * moment[1] + a * b * moment[0]) / ((c[k] - a) * (c[k] - b));
    sum += weight * ref_fresnel(p, channel, c[k]);
  }
  return sum;
}

real ref_multiscatter(const shade_params *p, int c, vec n, vec wo) {
  if (p->multiscatter != SHADE_MULTISCATTER_ON || ref_brdf_of(p) != SHADE_BRDF_MICROFACET ||
      (p->mdf != SHADE_MDF_GGX && p->mdf != SHADE_MDF_BECKMANN))
    return 1;
  shade_detail detail = ref_method_of(p);
  vec eye = ref_carried_by(ref_is_warp(detail) ? SHADE_DETAIL_PERTURB : detail, p, n, wo);
  const real x = ref_mean_fresnel(p, c) * loss(p, eye);
  return (1 + x) / (1 - x);
}
