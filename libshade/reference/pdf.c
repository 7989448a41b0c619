/* SPDX-License-Identifier: Apache-2.0 */
/* The density that shade_bsdf_sample draws with, by the contract of its header. */
#include "model.h"

#include <math.h>

static int by_exponents(const shade_params *p) {
  return p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY || p->mdf == SHADE_MDF_WARD;
}

/* Density of m, per sr about it, from its angles; eye is wo in the same frame. */
static real half_density(const shade_params *p, proposal q, vec m, vec eye, int visible) {
  real theta = atan2l(length2(m.x, m.y), m.z), phi = atan2l(m.y, m.x);
  real c = cosl(theta), tan2 = square(tanl(theta));
  if (m.x == 0 && m.y == 0)
    phi = pi / 4; /* the mean of both axes */
  if (by_exponents(p)) {
    real e = q.x * square(cosl(phi)) + q.y * square(sinl(phi));
    return sqrtl((q.x + 1) * (q.y + 1)) / (2 * pi) * powl(c, e);
  }
  real k = square(cosl(phi) / q.x) + square(sinl(phi) / q.y), peak = 1 / (pi * q.x * q.y);
  real slope = visible ? length2(q.x * eye.x, q.y * eye.y) / eye.z : 0, d = 0, lambda_o = 0;
  switch (p->mdf) {
  case SHADE_MDF_WARD_HALF:
    return peak * expl(-4 * k * square(sinl(theta / 2))) / -expm1l(-2 * k);
  case SHADE_MDF_BECKMANN:
    d = peak / powl(c, 4) * expl(-k * tan2);
    if (slope > 0)
      lambda_o = slope * expl(-1 / square(slope)) / (2 * sqrtl(pi)) - erfcl(1 / slope) / 2;
    break;
  case SHADE_MDF_GGX:
    d = peak / powl(c, 4) / square(1 + k * tan2);
    if (slope > 0)
      lambda_o = (sqrtl(1 + slope * slope) - 1) / 2;
    break;
  case SHADE_MDF_ASHIKHMIN_SHIRLEY: /* by exponents, above */
  case SHADE_MDF_WARD:
  case SHADE_MDF_COUNT:
    break;
  }
  /* the share of m's area that the eye sees, of all that it sees */
  return visible ? d * dot(m, eye) / (eye.z * (1 + lambda_o)) : d * c;
}

int ref_proposals(const shade_params *p, vec n, proposal q[3]) {
  real ax = within(p->ax, 1e-4L, 10), ay = within(p->ay, 1e-4L, 10);
  real ex = within(p->ex, 0, 1e6L), ey = within(p->ey, 0, 1e6L);
  shade_detail detail = ref_method_of(p);
  if (p->mdf == SHADE_MDF_WARD) {
    ex = 2 / square(ax);
    ey = 2 / square(ay);
  }
  if (detail == SHADE_DETAIL_ROTATE_APPROXIMATE && p->mdf != SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    /* alpha/L, at most sqrt(1000) */
    real l = ref_grooves_along_y(p) ? length2(n.y, n.z) : length2(n.x, n.z);
    real most = sqrtl(1000);
    ex = p->mdf == SHADE_MDF_WARD && ex * l * l < 1e-3L ? 1e-3L : ex * l * l;
    ey = p->mdf == SHADE_MDF_WARD && ey * l * l < 1e-3L ? 1e-3L : ey * l * l;
    ax = ax / l > most ? most : ax / l;
    ay = ay / l > most ? most : ay / l;
  }
  int e = by_exponents(p);
  real x = e ? ex : ax, y = e ? ey : ay;
  q[0] = (proposal){x, y, 1};
  if (detail != SHADE_DETAIL_PERTURB || x == y)
    return 1;
  real phi = n.x == 0 && n.y == 0 ? pi / 4 : atan2l(n.y, n.x), side2 = square(n.x) + square(n.y);
  real kx = e ? ex : 1 / square(ax), ky = e ? ey : 1 / square(ay);
  real here = kx * square(cosl(phi)) + ky * square(sinl(phi)), least = kx < ky ? kx : ky;
  q[0].weight = 0.5L / (1 + (e ? 0.5L : 1) * side2 * here);
  q[1] = e ? (proposal){here, here, 0} : (proposal){1 / sqrtl(here), 1 / sqrtl(here), 0};
  q[1].weight = 0.5L - q[0].weight;
  q[2] = e ? (proposal){least, least, 0.5L} : (proposal){1 / sqrtl(least), 1 / sqrtl(least), 0.5L};
  return 3;
}

shade_detail ref_drawn_in(const shade_params *p) {
  const shade_detail detail = ref_method_of(p);
  if (detail == SHADE_DETAIL_PERTURB) /* its lobes are carried by the smallest rotation */
    return SHADE_DETAIL_SHORTEST_ARC;
  return detail == SHADE_DETAIL_ROTATE_APPROXIMATE ? SHADE_DETAIL_ROTATE : detail;
}

int ref_draws_visible(const shade_params *p) {
  return ref_brdf_of(p) == SHADE_BRDF_MICROFACET && !ref_is_warp(ref_method_of(p)) &&
         (p->mdf == SHADE_MDF_BECKMANN || p->mdf == SHADE_MDF_GGX);
}

real ref_lobe_density(const shade_params *p, vec n, vec wi, vec wo) {
  const shade_detail detail = ref_method_of(p), frame = ref_drawn_in(p);
  const int visible = ref_draws_visible(p);
  vec h = unit(plus(wi, wo));
  vec m = ref_carried_by(frame, p, n, h);
  if (m.z <= 0)
    return 0;
  vec eye = visible ? ref_carried_by(frame, p, n, wo) : wo;
  proposal q[3];
  int count = ref_proposals(p, n, q);
  real density = 0;
  for (int i = 0; i < count; i++)
    density += q[i].weight * half_density(p, q[i], m, eye, visible);
  if (ref_is_warp(detail)) /* areas of the disc: d omega = dA / z, on either side */
    density *= (h.x == n.x && h.y == n.y ? 1 : ref_stretch(detail, n, h)) * h.z / m.z;
  return density / (4 * dot(h, wo));
}

/* The lobe's share of the draws beside a diffuse part. */
static real lobe_share(const shade_params *p, real coso) {
  real specular = 0, matt = 0;
  for (int c = 0; c < 3; c++) {
    real f0 = within(p->f0[c], 0, 1), kd = within(p->kd[c], 0, 1);
    matt += kd * (p->diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY ? 1 - f0 : 1) / 3;
    specular += (p->fresnel == SHADE_FRESNEL_CONDUCTOR ? ref_fresnel(p, c, 1) : f0) / 3;
  }
  const int grazing = p->fresnel == SHADE_FRESNEL_SCHLICK || p->fresnel == SHADE_FRESNEL_F82;
  if (matt == 0)
    return 1; /* a white f0 leaves nothing to ashikhmin_shirley's diffuse part */
  if (specular == 0 && !grazing)
    return 0;
  if (grazing)
    specular += (1 - specular) * powl(1 - coso, 5);
  return within(specular / (specular + matt), 0.1L, 0.9L);
}

real ref_with_matt(const shade_params *p, vec n, vec wi, vec wo, real density) {
  if (!(p->kd[0] > 0 || p->kd[1] > 0 || p->kd[2] > 0))
    return density;
  const real cosi = dot(n, wi), coso = dot(n, wo);
  int fibres = p->diffuse != SHADE_DIFFUSE_LAMBERT && p->diffuse != SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY;
  real matt = fibres ? 0.5L * cosi / pi + 0.25L / pi : cosi / pi;
  if (cosi <= 0 || coso <= 0)
    matt = 0;
  const real share = lobe_share(p, coso > 0 ? coso : 0);
  return share * density + (1 - share) * matt;
}

/* Density by the rule of `hard`. `lobe_n` is n as the distribution takes it. */
static real hard_density(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo) {
  vec pole = p->detail == SHADE_DETAIL_NONE ? (vec){0, 0, 1} : n;
  if (dot(pole, wi) <= 0 || dot(pole, wo) <= 0 || wi.z <= 0 || wo.z <= 0)
    return 0;
  return ref_with_matt(p, pole, wi, wo, ref_lobe_density(p, lobe_n, wi, wo));
}

/* The three ways that draws of two facets come to wi, each with its probability. */
static real two_facet_density(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo) {
  const facets s = ref_facets_of(n);
  if (s.area[UPRIGHT] == 0)
    return hard_density(p, n, lobe_n, wi, wo);
  const vec t = s.normal[UPRIGHT];
  /* of the light w that leaves the bumped facet towards the mirror (t.w < 0), what is sent on */
  real tilt = atan2l(length2(n.x, n.y), n.z);
  real bounced = 0.5L * sinl(tilt) / (sinl(tilt) + cosl(tilt));
  vec image = mirrored(wo, n);
  if (dot(t, image) < 0 && image.z > 0) {
    real past = s.area[UPRIGHT] * fabsl(dot(t, image)) / image.z; /* tan tilt and the slope */
    real here = past < 1 ? past / (1 + past) : 0.5L;
    bounced = here > bounced ? here : bounced;
  }
  real density = hard_density(p, n, lobe_n, wi, wo) * (dot(t, wi) < 0 ? 1 - bounced : 1);
  if (dot(t, wi) > 0)
    density += hard_density(p, n, lobe_n, minus(wi, scale(t, 2 * dot(t, wi))), wo) * bounced;
  density *= ref_facet_share(&s, BUMPED, wo);
  if (dot(t, wo) > 0)
    density += hard_density(p, n, lobe_n, wi, minus(wo, scale(t, 2 * dot(t, wo)))) *
               ref_facet_share(&s, UPRIGHT, wo);
  return density;
}

double shade_ref_pdf(const shade_params *p, const double n_in[3], const double wi_in[3],
                     const double wo_in[3]) {
  if (!usable(n_in) || !usable(wi_in) || !usable(wo_in))
    return 0;
  vec n = normal(n_in), wi = direction(wi_in), wo = direction(wo_in);
  vec lobe_n = ref_as_given(p, n_in, n);
  if (p->detail == SHADE_DETAIL_NONE)
    return (double)hard_density(p, n, lobe_n, wi, wo);
  if (ref_has_bumps(p))
    return (double)ref_mutual_density(p, n, lobe_n, wi, wo);
  if (ref_bends(p->horizon)) {
    vec turned = ref_bent(n, wo);
    lobe_n = turned.z > n.z ? turned : lobe_n;
    n = turned;
  }
  return (double)(p->horizon == SHADE_HORIZON_SCHUESSLER ? two_facet_density(p, n, lobe_n, wi, wo)
                                                         : hard_density(p, n, lobe_n, wi, wo));
}
