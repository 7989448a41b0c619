/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Fresnel of one colour channel at c = h.wo: fresnel_<word of table.h>, of which each reads what
 * SHADE_FRESNEL_<NAME>_IS in methods.h says; tint is f82 or eta. Absolute errors against the
 * reference, for directions to 89 degrees: float 5e-6 (of which the directions make most), double
 * 1e-14.
 */
#ifndef SHADE_MODEL_FRESNEL_H
#define SHADE_MODEL_FRESNEL_H

#include "bsdf.h"
#include "random.h"

/* (1 - c)^5, the share of white in Schlick's Fresnel. [Schlick1994 Eq. 15] */
LEAF real schlick_weight(real c) {
  real m = 1 - c;
  real m2 = m * m;
  return m2 * m2 * m;
}

LEAF real fresnel_none(real f0, real tint, real k, real c) {
  (void)tint, (void)k, (void)c;
  return f0;
}

LEAF real fresnel_schlick(real f0, real tint, real k, real c) {
  (void)tint, (void)k;
  return f0 + (1 - f0) * schlick_weight(c);
}

/*
 * Schlick's value less b c (1 - c)^6, b such that c = 1/7 keeps `tint` of it. The
 * difference may fall below 0 for dark f0 and small tint: 0 there. [Kutz2021]
 */
LEAF real fresnel_f82(real f0, real tint, real k, real c) {
  (void)k;
  const real at_7th = R(7776.0) / R(16807.0);  /* (6/7)^5 */
  const real scale = R(823543.0) / R(46656.0); /* 7 (7/6)^6 */
  real white = schlick_weight(c);
  real b = (f0 + (1 - f0) * at_7th) * (1 - tint) * scale;
  return maximum(f0 + (1 - f0) * white - b * c * white * (1 - c), 0);
}

/*
 * Conductor eta + i k against air, unpolarised. a^2 comes from whichever of its forms does
 * not cancel. [BornWolf1999 section 14.2]
 */
LEAF real fresnel_conductor(real f0, real eta, real k, real c) {
  (void)f0;
  real cos2 = c * c, sin2 = 1 - cos2;
  real eta2 = eta * eta, k2 = k * k;
  real t0 = eta2 - k2 - sin2;
  real both = root(t0 * t0 + 4 * eta2 * k2); /* a^2 + b^2 */
  real larger = R(0.5) * (both + (t0 < 0 ? -t0 : t0));
  real smaller = eta2 * k2 / (larger + TINY);
  real a = root(t0 < 0 ? smaller : larger);
  real t1 = both + cos2, t2 = 2 * a * c;
  real rs = (t1 - t2) / (t1 + t2 + TINY);
  real t3 = cos2 * both + sin2 * sin2, t4 = t2 * sin2;
  real rp = rs * (t3 - t4) / (t3 + t4 + TINY);
  return maximum(R(0.5) * (rs + rp), 0); /* eta near 1 cancels */
}

/* By name, of one channel. */
LEAF real fresnel_value(shade_fresnel fresnel, real f0, real tint, real k, real c) {
  switch (fresnel) {
#define FRESNEL_CASE(NAME, word, value, label, help)                                               \
  case SHADE_FRESNEL_##NAME:                                                                       \
    return fresnel_##word(f0, tint, k, c);
    SHADE_TABLE_FRESNEL(FRESNEL_CASE)
#undef FRESNEL_CASE
  case SHADE_FRESNEL_COUNT:
    break;
  }
  return 0;
}

/*
 * The mean of Fresnel over even light, 2 integral of F(c) c dc, by Gauss's three points: exact for
 * none and Schlick's. Measured metals are within .0015, F82 within .008; of bodies that reflect
 * all beyond some angle, eta below 1 and k near 0, it may be .14 off.
 */
LEAF real fresnel_mean(shade_fresnel fresnel, real f0, real tint, real k) {
  return R(0.13965395980290832) * fresnel_value(fresnel, f0, tint, k, R(0.212340538239153)) +
         R(0.4584822127191726) * fresnel_value(fresnel, f0, tint, k, R(0.5905331355592653)) +
         R(0.4018638274779191) * fresnel_value(fresnel, f0, tint, k, R(0.9114120404872961));
}

/* All three, of a material. */
LEAF triple fresnel(const bsdf *b, real hwo) {
  const SUFFIX(bsdf_numbers) *m = numbers_of(b);
  return (triple){fresnel_value(b->fresnel, m->f0[0], m->tint[0], m->k[0], hwo),
                  fresnel_value(b->fresnel, m->f0[1], m->tint[1], m->k[1], hwo),
                  fresnel_value(b->fresnel, m->f0[2], m->tint[2], m->k[2], hwo)};
}

#endif
