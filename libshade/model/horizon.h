/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Light and eye near the perturbed horizon: the factors of the choices of
 * SHADE_TABLE_HORIZON, stated in shade.h. Directions are unit, n.z > 0.
 * Errors of f against the reference on the same inputs, where the cosines of wi and wo about
 * the lobe's normal and about z are 0.05 at least, exponents to 1e3: double 1e-12, float 5e-5
 * (seen 2e-5, and 3.4e-5 for two facets compiled without optimisation), float warps 1e-4. The
 * worst input is a bent normal, or a mirrored direction, whose half vector lies far out in a
 * narrow lobe. As wi.z or the cosines go to 0 relative errors grow in inverse proportion.
 */
#ifndef SHADE_MODEL_HORIZON_H
#define SHADE_MODEL_HORIZON_H

#include "elementary.h"

/*
 * n bent towards z, in the plane of both, until the mirror image of wo has z = t,
 * t = min(0.9 wo.z, 0.01): in that plane the bent normal halves the angle between the
 * projections of wo, (a, c), and of the image, (s, t), which are equally long. Only then is n
 * changed. [the aim, and t, are those of Cycles' ensure_valid_specular_reflection]
 */
typedef struct normal {
  real x, y, z;
} normal;

LEAF int needs_bend(real nx, real ny, real nz, real wox, real woy, real woz) {
  real along = dot2(nx, ny, wox, woy);
  real t = minimum(R(0.9) * woz, R(0.01));
  real image = multiply_add(2 * multiply_add(nz, woz, along), nz, -woz);
  return (image < t) & (woz > 0) & (dot2(nx, ny, nx, ny) > TINY);
}
LEAF normal bend(real nx, real ny, real nz, real wox, real woy, real woz) {
  real side2 = dot2(nx, ny, nx, ny);
  real along = dot2(nx, ny, wox, woy);
  real t = minimum(R(0.9) * woz, R(0.01));
  int low = needs_bend(nx, ny, nz, wox, woy, woz);
  real inverse = 1 / root(low ? side2 : 1); /* once: divisions are most of the time */
  real a = along * inverse;
  real over = maximum((woz - t) * (woz + t), 0); /* s^2 - a^2 */
  real s = root(multiply_add(a, a, over));
  /* s + a without cancellation; both are 0 only where wo is normal to that plane */
  real apart = over / maximum(s - a, TINY);
  real x = a < 0 ? apart : s + a;
  real z = woz + t;
  /* by the larger first: z may be so small that it has no square. No choice by `low`: both cases
     would be divided, 0/0 too */
  real larger = 1 / (maximum(x, absolute(z)) + LEAST_NORMAL);
  x *= larger;
  z *= larger;
  real scale = 1 / root(maximum(dot2(x, z, x, z), TINY));
  x *= scale * inverse;
  normal n = {nx, ny, nz};
  n.x = low ? nx * x : n.x;
  n.y = low ? ny * x : n.y;
  n.z = low ? z * scale : n.z;
  return n;
}

/*
 * Smith's shadow of wi from z, for GGX of alpha^2 = tan^2/8 (1 at most), tan that of n from z. Both
 * of its fractions times n.z, for one division in place of two. Where n.z is below .001, alpha^2 is
 * 1 whatever it is. [Estevez2019]
 */
typedef struct estevez {
  real up, alpha2; /* n.z; times its square */
} estevez;
LEAF estevez estevez_of(real nx, real ny, real nz) {
  real up = maximum(nz, R(1e-3));
  return (estevez){up, minimum(R(0.125) * (nx * nx + ny * ny), up * up)};
}
LEAF real shadow_of(estevez e, real wix, real wiy, real wiz) {
  real z = maximum(wiz, 0), own = z * e.up;
  /* own again, where it has no square */
  real sum = own + maximum(root(own * own + e.alpha2 * (wix * wix + wiy * wiy)), own);
  return 2 * own / maximum(sum, LEAST_NORMAL);
}
LEAF real shadow_estevez(real nx, real ny, real nz, real wix, real wiy, real wiz) {
  return shadow_of(estevez_of(nx, ny, nz), wix, wiy, wiz);
}

/* The cubic in g = wi.z/(n.z n.wi) that meets 1 without a kink at g = 1. [Chiang2019] */
LEAF real shadow_chiang(real nx, real ny, real nz, real wix, real wiy, real wiz) {
  real z = maximum(wiz, 0);
  real cosine = nz * dot(nx, ny, nz, wix, wiy, wiz);
  real g = z < cosine ? z / maximum(cosine, TINY) : 1;
  return g + g * g * (1 - g);
}

/*
 * Shares of the two facets that w, above z, sees: that of the bumped one, p/(p + q), and that
 * of the upright one, q/(p + q). [Schuessler2017]
 */
LEAF real share_upright(real nx, real ny, real nz, real wx, real wy, real wz) {
  real side = dot2(nx, ny, wx, wy);
  real p = maximum(multiply_add(nz, wz, side), 0), q = maximum(-side, 0);
  return q / maximum(p + q, TINY);
}
LEAF real share_bumped(real nx, real ny, real nz, real wx, real wy, real wz) {
  real side = dot2(nx, ny, wx, wy);
  real p = maximum(multiply_add(nz, wz, side), 0), q = maximum(-side, 0);
  return p / maximum(p + q, TINY);
}

/*
 * How much of (nx, ny) to take from w to mirror it at the upright facet: 2 (w.m)/(m.m).
 * Scaled, or TINY would count beside the squares of small tilts, and the image not be unit.
 * Tilts below 1e-29 (float) or 1e-287 (double) have no mirror.
 */
LEAF real mirror_step(real nx, real ny, real wx, real wy) {
#if SHADE_FLOAT
  const real scale = 0x1p60f, least = 1e-21f;
#else
  const real scale = 0x1p500, least = 1e-273;
#endif
  real mx = nx * scale, my = ny * scale;
  real side2 = dot2(mx, my, mx, my);
  real step = 2 * scale * dot2(mx, my, wx, wy) / (side2 + TINY);
  return side2 > least ? step : 0;
}

#endif
