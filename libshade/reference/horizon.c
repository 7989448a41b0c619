/* SPDX-License-Identifier: Apache-2.0 */
/* f as a whole, and what becomes of it near the perturbed horizon. */
#include "model.h"

#include <math.h>

/*
 * f and its cosine by the rule of `hard`. `lobe_n` is n as the distribution takes it.
 * Returns status bits.
 */
static unsigned hard(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo, real f[3],
                     real *cosine) {
  vec pole = p->detail == SHADE_DETAIL_NONE ? (vec){0, 0, 1} : n;
  real cosi = dot(pole, wi), coso = dot(pole, wo);
  f[0] = f[1] = f[2] = 0;
  *cosine = cosi > 0 ? cosi : 0;
  unsigned status = length(plus(wi, wo)) <= 1e-15L ? SHADE_BAD_INPUT : SHADE_OK;
  if (cosi <= 0 || coso <= 0 || wi.z <= 0 || wo.z <= 0)
    return status;
  vec h = unit(plus(wi, wo));
  real hwo = dot(h, wo);
  real d = ref_distribution(p, lobe_n, h);
  real lobe = ref_brdf(p, n, wi, wo, cosi, coso, d);
  for (int i = 0; i < 3; i++)
    f[i] = ref_fresnel(p, i, hwo) * lobe * ref_multiscatter(p, i, n, wo) +
           ref_diffuse_part(p, i, n, wi, wo) / at_least(cosi);
  return status;
}

/* ---- near the perturbed horizon ----------------------------------------------------- */

/*
 * In the plane of z and n, the image of wo under a normal at angle theta from z has
 * z = rho cos(2 theta - phi), where (rho, phi) is wo in that plane: solved for z = t.
 */
vec ref_bent(vec n, vec wo) {
  real t = 0.9L * wo.z < 0.01L ? 0.9L * wo.z : 0.01L;
  if (wo.z <= 0 || (n.x == 0 && n.y == 0) || mirrored(wo, n).z >= t)
    return n;
  vec x = unit((vec){n.x, n.y, 0});
  real phi = atan2l(dot(x, wo), wo.z), rho = length2(dot(x, wo), wo.z);
  real theta = (phi + acosl(t / rho)) / 2;
  return plus(scale(x, sinl(theta)), (vec){0, 0, cosl(theta)});
}

int ref_bends(shade_horizon horizon) {
  return horizon == SHADE_HORIZON_VALID_REFLECTION || horizon == SHADE_HORIZON_VALID_ESTEVEZ;
}

facets ref_facets_of(vec n) {
  real side = length2(n.x, n.y);
  facets s = {{n, {0, 0, 0}}, {1 / n.z, side / n.z}};
  if (side > 0)
    s.normal[UPRIGHT] = (vec){-n.x / side, -n.y / side, 0};
  return s;
}

static real seen_area(const facets *s, int facet, vec w) {
  real cosine = dot(s->normal[facet], w);
  return cosine > 0 ? s->area[facet] * cosine : 0;
}

/* Share of the projected surface that a facet takes up, seen from w. */
real ref_facet_share(const facets *s, int facet, vec w) {
  real both = seen_area(s, BUMPED, w) + seen_area(s, UPRIGHT, w);
  return both > 0 ? seen_area(s, facet, w) / both : 0;
}

/* How much of a facet is not hidden from w: projected areas must add up to w.z. */
real ref_unhidden(const facets *s, int facet, vec w) {
  if (dot(s->normal[facet], w) <= 0 || w.z <= 0)
    return 0;
  real part = w.z / (seen_area(s, BUMPED, w) + seen_area(s, UPRIGHT, w));
  return part < 1 ? part : 1;
}

/* Path by path: the eye's ray, traced back to the light. */
static unsigned two_facets(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo, real f[3],
                           real *cosine) {
  const facets s = ref_facets_of(n);
  real one[3], cosi;
  *cosine = wi.z > 0 ? wi.z : 0;
  /* one reflection, at the bumped facet */
  unsigned status = hard(p, n, lobe_n, wi, wo, one, &cosi);
  f[0] = f[1] = f[2] = 0;
  if (wi.z <= 0 || wo.z <= 0)
    return status;
  for (int i = 0; i < 3; i++)
    f[i] = ref_facet_share(&s, BUMPED, wo) * one[i] * cosi * ref_unhidden(&s, BUMPED, wi) / wi.z;
  if (s.area[UPRIGHT] == 0)
    return status;
  const vec t = s.normal[UPRIGHT];
  if (dot(t, wi) > 0) { /* at the bumped facet, on to the mirror, out to the light */
    vec between = minus(wi, scale(t, 2 * dot(t, wi)));
    hard(p, n, lobe_n, between, wo, one, &cosi);
    real blocked = 1 - ref_unhidden(&s, BUMPED, between);
    for (int i = 0; i < 3; i++)
      f[i] += ref_facet_share(&s, BUMPED, wo) * one[i] * cosi * blocked *
              ref_unhidden(&s, UPRIGHT, wi) / wi.z;
  }
  if (dot(t, wo) > 0) { /* at the mirror, on to the bumped facet, out to the light */
    vec between = minus(wo, scale(t, 2 * dot(t, wo)));
    hard(p, n, lobe_n, wi, between, one, &cosi);
    for (int i = 0; i < 3; i++)
      f[i] +=
          ref_facet_share(&s, UPRIGHT, wo) * one[i] * cosi * ref_unhidden(&s, BUMPED, wi) / wi.z;
  }
  return status;
}

/* What is left of the light, by horizon. */
real ref_shadow(shade_horizon horizon, vec n, vec wi) {
  if (wi.z <= 0)
    return 0;
  if (horizon == SHADE_HORIZON_ESTEVEZ || horizon == SHADE_HORIZON_VALID_ESTEVEZ) {
    real bump = atan2l(length2(n.x, n.y), n.z), light = atan2l(length2(wi.x, wi.y), wi.z);
    real alpha2 = square(tanl(bump)) / 8;
    return 2 / (1 + sqrtl(1 + (alpha2 < 1 ? alpha2 : 1) * square(tanl(light))));
  }
  if (horizon == SHADE_HORIZON_CHIANG && dot(n, wi) > 0) {
    real g = wi.z / (n.z * dot(n, wi));
    return g < 1 ? g + g * g - g * g * g : 1;
  }
  return 1;
}

void shade_ref_normal(const shade_params *p, const double n_in[3], const double wo[3],
                      double out[3]) {
  vec n = normal(n_in);
  if (ref_bends(p->horizon) && p->detail != SHADE_DETAIL_NONE)
    n = ref_bent(n, direction(wo));
  out[0] = (double)n.x;
  out[1] = (double)n.y;
  out[2] = (double)n.z;
}

unsigned shade_ref_f(const shade_params *p, const double n_in[3], const double wi_in[3],
                     const double wo_in[3], double f[3], double *cosine) {
  f[0] = f[1] = f[2] = 0;
  if (cosine)
    *cosine = 0;
  if (!usable(n_in) || !usable(wi_in) || !usable(wo_in))
    return SHADE_BAD_INPUT;
  vec n = normal(n_in), wi = direction(wi_in), wo = direction(wo_in);
  vec lobe_n = ref_as_given(p, n_in, n);
  unsigned status = n_in[2] <= 0 ? SHADE_CLAMPED_NORMAL : SHADE_OK;
  shade_horizon horizon = p->detail == SHADE_DETAIL_NONE ? SHADE_HORIZON_HARD : p->horizon;
  real value[3], cosi, factor = ref_shadow(horizon, n, wi); /* 1 but for two of them */
  if (ref_has_bumps(p)) {
    status |= length(plus(wi, wo)) <= 1e-15L ? SHADE_BAD_INPUT : SHADE_OK;
    ref_mutual_f(p, n, lobe_n, wi, wo, value);
    for (int i = 0; i < 3; i++)
      f[i] = status & SHADE_BAD_INPUT ? 0 : (double)value[i];
    if (cosine)
      *cosine = wi.z > 0 ? (double)wi.z : 0;
    return status;
  }
  if (ref_bends(horizon)) {
    vec turned = ref_bent(n, wo);
    lobe_n = turned.z > n.z ? turned : lobe_n;
    n = turned;
  }
  if (horizon == SHADE_HORIZON_SCHUESSLER)
    status |= two_facets(p, n, lobe_n, wi, wo, value, &cosi);
  else
    status |= hard(p, n, lobe_n, wi, wo, value, &cosi);
  for (int i = 0; i < 3; i++)
    f[i] = (double)(horizon == SHADE_HORIZON_HARD ? value[i] : value[i] * factor);
  if (cosine)
    *cosine = (double)cosi;
  return status;
}
