/* SPDX-License-Identifier: Apache-2.0 */
/* The specular lobe: distribution, shadowing, BRDF, Fresnel. */
#include "model.h"

#include <complex.h>
#include <math.h>

/*
 * Switches here have no `default`: a row of table.h without its formula does not compile. A value
 * outside the enum counts as the first, after the switch.
 */

/* D' as far as the warps that conserve are those that do not. */
static real unconserved(const shade_params *p, vec n, vec h) {
  real ex = within(p->ex, 0, 1e6L), ey = within(p->ey, 0, 1e6L);
  real ax = within(p->ax, 1e-4L, 10), ay = within(p->ay, 1e-4L, 10);
  vec m = ref_carried(p, n, h);
  if (m.z <= 0)
    return 0;
  real ward_peak = 1 / (pi * ax * ay);
  switch (p->mdf) {
  case SHADE_MDF_WARD:
    return ward_peak * expl(-(square(m.x / ax) + square(m.y / ay)) / square(m.z));
  case SHADE_MDF_WARD_HALF:
    return ward_peak * expl(-2 * (square(m.x / ax) + square(m.y / ay)) / (1 + m.z));
  case SHADE_MDF_BECKMANN:
    return ward_peak * expl(-(square(m.x / ax) + square(m.y / ay)) / square(m.z)) /
           square(square(m.z));
  case SHADE_MDF_GGX:
    return ward_peak / square(square(m.x / ax) + square(m.y / ay) + square(m.z));
  case SHADE_MDF_ASHIKHMIN_SHIRLEY:
  case SHADE_MDF_COUNT:
    break;
  }
  real sin2 = square(m.x) + square(m.y);
  real exponent = sin2 > 0 ? (ex * square(m.x) + ey * square(m.y)) / sin2 : 0;
  return sqrtl((ex + 1) * (ey + 1)) / (2 * pi) * powl(m.z, exponent);
}

real ref_distribution(const shade_params *p, vec n, vec h) {
  real d = unconserved(p, n, h);
  if (!ref_conserves(p->detail) || d == 0)
    return d;
  int projected = p->mdf == SHADE_MDF_BECKMANN || p->mdf == SHADE_MDF_GGX;
  real cosine = projected ? dot(n, h) : ref_warped(p->detail, n, h).z;
  if (h.x == n.x && h.y == n.y)
    return d * h.z / cosine;
  return cosine > 0 ? d * ref_stretch(p->detail, n, h) * h.z / cosine : 0;
}

/* Of w, whose theta and phi are those of the carried frame. */
real ref_lambda(const shade_params *p, vec n, vec w) {
  shade_detail detail = ref_method_of(p);
  vec m = ref_carried_by(ref_is_warp(detail) ? SHADE_DETAIL_PERTURB : detail, p, n, w);
  real ax = within(p->ax, 1e-4L, 10), ay = within(p->ay, 1e-4L, 10);
  if (p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    ax = sqrtl(2 / (within(p->ex, 0, 1e6L) + 2));
    ay = sqrtl(2 / (within(p->ey, 0, 1e6L) + 2));
  }
  real slope = length2(ax * m.x, ay * m.y); /* alpha(phi) sin theta */
  if (slope == 0)
    return 0;
  real a = m.z / slope;
  switch (p->mdf) {
  case SHADE_MDF_GGX:
    return (sqrtl(1 + 1 / (a * a)) - 1) / 2;
  case SHADE_MDF_ASHIKHMIN_SHIRLEY:
  case SHADE_MDF_WARD:
  case SHADE_MDF_WARD_HALF:
  case SHADE_MDF_BECKMANN:
  case SHADE_MDF_COUNT:
    break;
  }
  return expl(-a * a) / (2 * a * sqrtl(pi)) - erfcl(a) / 2;
}

shade_brdf ref_brdf_of(const shade_params *p) {
  if (p->brdf != SHADE_BRDF_AUTO)
    return p->brdf;
  switch (p->mdf) {
  case SHADE_MDF_GGX:
  case SHADE_MDF_BECKMANN:
    return SHADE_BRDF_MICROFACET;
  case SHADE_MDF_WARD:
  case SHADE_MDF_WARD_HALF:
    return SHADE_BRDF_WARD_BOUNDED;
  case SHADE_MDF_ASHIKHMIN_SHIRLEY:
  case SHADE_MDF_COUNT:
    break;
  }
  return SHADE_BRDF_ASHIKHMIN_SHIRLEY;
}

real ref_brdf(const shade_params *p, vec n, vec wi, vec wo, real cosi, real coso, real d) {
  vec sum = plus(wi, wo);
  real hwo = dot(unit(sum), wo);
  switch (ref_brdf_of(p)) {
  case SHADE_BRDF_WARD_1992:
    return d / at_least(4 * sqrtl(cosi * coso));
  case SHADE_BRDF_WARD_DUR:
    return d / at_least(4 * cosi * coso);
  case SHADE_BRDF_WARD_BOUNDED:
    return d * dot(sum, sum) / at_least(square(square(cosi + coso)));
  case SHADE_BRDF_MICROFACET: {
    real shadowing = 1 / (1 + ref_lambda(p, n, wi) + ref_lambda(p, n, wo));
    return d * shadowing / at_least(4 * cosi * coso);
  }
  case SHADE_BRDF_ASHIKHMIN_SHIRLEY:
  case SHADE_BRDF_AUTO:
  case SHADE_BRDF_COUNT:
    break;
  }
  return d / at_least(4 * hwo * (cosi > coso ? cosi : coso));
}

double shade_ref_mdf(const shade_params *p, const double n[3], const double h[3]) {
  if (!usable(n) || !usable(h))
    return 0;
  return (double)ref_distribution(p, ref_as_given(p, n, normal(n)),
                                  ref_as_given(p, h, direction(h)));
}

/* Channel c of Fresnel's reflectance; the conductor's from its complex amplitudes. */
real ref_fresnel(const shade_params *p, int c, real cosine) {
  real f0 = within(p->f0[c], 0, 1), f = f0 + (1 - f0) * fifth(1 - cosine);
  switch (p->fresnel) {
  case SHADE_FRESNEL_SCHLICK:
    return f;
  case SHADE_FRESNEL_F82: {
    real at = 1 / 7.0L, here = f0 + (1 - f0) * fifth(1 - at);
    real b = here * (1 - within(p->f82[c], 0, 1)) / (at * (fifth(1 - at) * (1 - at)));
    f -= b * cosine * fifth(1 - cosine) * (1 - cosine);
    return f > 0 ? f : 0;
  }
  case SHADE_FRESNEL_CONDUCTOR: {
    long double complex m = within(p->eta[c], 1e-3L, 100) + I * within(p->k[c], 0, 100);
    long double complex inside = csqrtl(1 - (1 - cosine * cosine) / (m * m)); /* cos within */
    real s = cabsl((cosine - m * inside) / (cosine + m * inside));
    real q = cabsl((m * cosine - inside) / (m * cosine + inside));
    return (s * s + q * q) / 2;
  }
  case SHADE_FRESNEL_NONE:
  case SHADE_FRESNEL_COUNT:
    break;
  }
  return f0;
}
