/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Light that leaves a microfacet surface after more than one reflection, as a factor on f that
 * depends on the eye alone, so that draws stay as they are. [Turquin2019]
 *
 * E is what f reflects of even light towards the eye where Fresnel is 1, and F the mean of Fresnel.
 * 1 - E of the light meets a facet again, and of that 2 E / (1 + E) leaves each time. A random walk
 * on the facets [Heitz2016] leaves so often to .02. The geometric series of that is
 *   f (1 + x) / (1 - x), x = F (1 - E) / (1 + E),
 * which is f / E where F is 1. The chance E, or the mean of E, would be too low: of a lobe of alpha
 * 1 and F .7 they keep .42 and .46 where the walk keeps .48 and this .475.
 */
#ifndef SHADE_MODEL_MULTISCATTER_H
#define SHADE_MODEL_MULTISCATTER_H

#include "../data/albedo_fit.h"
#include "fresnel.h"
#include "lobe.h"
#include "mdf.h"

/* What albedo_fit.h fits: t, and of the alphas as it takes them the sum, less 1, and the
 * difference; q. */
typedef struct loss_point {
  real t, s, d, q;
} loss_point;

/* The sum of a fit's rows. */
#define LOSS_TERM(i, j, c) +R(c) * (t##i * s##j)
#define LOSS_GROUP(k, l, c, terms) +(d##k * q##l) * (R(c) terms)
#define LOSS_FIT(name, FIT)                                                                        \
  LEAF real name(loss_point p) {                                                                   \
    const real t0 = 1, t1 = p.t, t2 = t1 * t1, t3 = t2 * t1, t4 = t2 * t2, t5 = t4 * t1;           \
    const real t6 = t3 * t3, t7 = t4 * t3, t8 = t4 * t4;                                           \
    const real s0 = 1, s1 = p.s, s2 = s1 * s1, s3 = s2 * s1, s4 = s2 * s2, s5 = s4 * s1;           \
    const real s6 = s3 * s3;                                                                       \
    const real d0 = 1, d1 = p.d, d2 = d1 * d1, d3 = d2 * d1, d4 = d2 * d2, d5 = d4 * d1;           \
    const real d6 = d3 * d3;                                                                       \
    const real q0 = 1, q1 = p.q, q2 = q1 * q1, q3 = q2 * q1, q4 = q2 * q2;                         \
    return FIT(LOSS_GROUP, LOSS_TERM);                                                             \
  }
LOSS_FIT(fit_ggx, SHADE_ALBEDO_GGX)
LOSS_FIT(fit_beckmann, SHADE_ALBEDO_BECKMANN)

/* From the eye's cosine u in the space where the lobe is round, 1 - u, and the squares of both
 * alphas, at most 1. */
LEAF real loss_ggx(real u, real less, real gx, real gy, real q) {
  (void)less;
  const real x = root(gx), y = root(gy);
  return fit_ggx((loss_point){2 * u - 1, x + y - 1, x - y, q});
}
LEAF real loss_beckmann(real u, real less, real gx, real gy, real q) {
  (void)u;
  return fit_beckmann((loss_point){2 * root(less) - 1, gx + gy - 1, gx - gy, q});
}

/*
 * (1 - E) / (1 + E) of an eye, carried as Smith's Lambda sees it. Relative errors of E, of alphas
 * from 1e-3 to 1, stand in albedo_fit.h. Beyond 1 an alpha counts as 1, and less than all is kept.
 */
LEAF real albedo_loss(shade_mdf mdf, lobe_point eye, real gx, real gy) {
  const real x = minimum(gx, 1), y = minimum(gy, 1);
  const real along = x * eye.xx, across = y * eye.yy, square = 1 / (1 + along + across);
  const real u = root(square), q = (along - across) * square;
  const real less = (along + across) * square / (1 + u);
  real loss = 0;
  switch (mdf) {
#define LOSS_CASE(NAME, word)                                                                      \
  case SHADE_MDF_##NAME:                                                                           \
    loss = loss_##word(u, less, x, y, q);                                                          \
    break;
    SHADE_MDF_VISIBLE(LOSS_CASE)
#undef LOSS_CASE
  default:
    break;
  }
  return maximum(loss, 0);
}

/* What to multiply one channel of f by. */
LEAF real multiscatter(real mean, real loss) {
  const real x = mean * loss;
  return (1 + x) / (1 - x);
}

/* All three, of a material and an eye. */
LEAF triple multiscatter_of(const bsdf *b, triple n, triple wo) {
  const SUFFIX(bsdf_numbers) *m = numbers_of(b);
  const real loss = albedo_loss(b->mdf, lobe_at(detail(b->carry.shadow, n, wo)), m->gx, m->gy);
  real to[3];
  for (int c = 0; c < 3; c++)
    to[c] = multiscatter(fresnel_mean(b->fresnel, m->f0[c], m->tint[c], m->k[c]), loss);
  return (triple){to[0], to[1], to[2]};
}

#endif
