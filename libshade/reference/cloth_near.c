/* SPDX-License-Identifier: Apache-2.0 */
/* What one point of the cloth sends on: a yarn's lobe and fibres, or a gap, under a nap. */
#include "cloth_model.h"
#include "model.h"

static void mend_color(double color[3], double initial) {
  for (int i = 0; i < 3; i++)
    color[i] = ref_number(color[i], 0, 1, initial);
}

static void mend_material(shade_yarn *y) {
  y->along = ref_number(y->along, 0, 1e6, 100);
  y->across = ref_number(y->across, 0, 1e6, 10);
  mend_color(y->f0, 0.04);
  mend_color(y->kd, 0.5);
}

shade_ref_cloth shade_ref_cloth_of(const shade_draft *draft, const shade_weave_params *yarns,
                                   const shade_fabric_params *fabric) {
  shade_ref_cloth c = {.draft = draft, .yarns = *yarns, .fabric = *fabric};
  ref_mend_weave(&c);
  mend_material(&c.fabric.warp);
  mend_material(&c.fabric.weft);
  mend_color(c.fabric.backing, 0);
  mend_color(c.fabric.nap_color, 0.5);
  c.fabric.nap = ref_number(c.fabric.nap, 0, 10, 0);
  mend_color(c.fabric.warp_transmit, 0);
  mend_color(c.fabric.weft_transmit, 0);
  if ((unsigned)c.fabric.horizon >= SHADE_HORIZON_COUNT)
    c.fabric.horizon = SHADE_HORIZON_HARD;
  if (c.fabric.shadows)
    ref_find_leans(&c);
  return c;
}

/* ---- frames ----------------------------------------------------------------------------- */

/* v in the frame of a cloth bent to n: z is n, and the yarns' axis goes on in its own plane. */
vec ref_in_cloth(int kind, vec n, vec v) {
  if (kind == SHADE_TOP_WARP) { /* dP/dv of the height field */
    vec y = n.y * n.y + n.z * n.z > 0 ? unit((vec){0, n.z, -n.y}) : (vec){0, 1, 0};
    return in_frame(cross(y, n), y, n, v);
  }
  vec x = n.x * n.x + n.z * n.z > 0 ? unit((vec){n.z, 0, -n.x}) : (vec){1, 0, 0};
  return in_frame(x, cross(n, x), n, v);
}

vec ref_along_fibres(real tx, real ty, vec v) {
  return in_frame((vec){tx, ty, 0}, (vec){-ty, tx, 0}, (vec){0, 0, 1}, v);
}

/* ---- one yarn ----------------------------------------------------------------------------- */

shade_params ref_yarn_lobe(const shade_fabric_params *p, const shade_yarn *yarn) {
  shade_params q = {.size = sizeof q, .mdf = p->mdf, .brdf = p->brdf, .detail = p->detail};
  q.groove = SHADE_GROOVE_X;
  q.fresnel = SHADE_FRESNEL_SCHLICK;
  q.diffuse = yarn->diffuse;
  q.horizon = SHADE_HORIZON_HARD;
  q.ex = yarn->along;
  q.ey = yarn->across;
  q.ax = (double)sqrtl(2 / ((real)yarn->along + 2));
  q.ay = (double)sqrtl(2 / ((real)yarn->across + 2));
  for (int i = 0; i < 3; i++) {
    q.f0[i] = yarn->f0[i];
    q.kd[i] = 1;
  }
  return q;
}

/* Schlick's white share at a cosine. */
static real white(real cosine) {
  return fifth(1 - cosine);
}

void ref_yarn(const shade_params *lobe, vec n, vec wi, vec wo, real glossy[3], real matt[3]) {
  vec pole = lobe->detail == SHADE_DETAIL_NONE ? (vec){0, 0, 1} : n;
  real cosi = dot(pole, wi), coso = dot(pole, wo);
  for (int i = 0; i < 3; i++)
    glossy[i] = matt[i] = 0;
  if (cosi <= 0 || coso <= 0 || wi.z <= 0 || wo.z <= 0)
    return;
  vec h = unit(plus(wi, wo));
  real mirrored = ref_brdf(lobe, n, wi, wo, cosi, coso, ref_distribution(lobe, n, h)) * cosi;
  shade_params bare = *lobe; /* what f0 takes off is said below */
  bare.f0[0] = 0;
  real scattered = ref_diffuse_part(&bare, 0, n, wi, wo) * (1 - white(cosi)) * (1 - white(coso));
  for (int i = 0; i < 3; i++) {
    glossy[i] = ref_fresnel(lobe, i, dot(h, wo)) * mirrored;
    matt[i] = square(1 - (real)lobe->f0[i]) * scattered;
  }
}

/* Times the yarn's colour in the draft, and its noise if it is a yarn. */
static void dyed(const shade_ref_cloth *c, const ref_point *at, const double plain[3],
                 real color[3]) {
  real own[3] = {1, 1, 1};
  if (c->fabric.draft_colors)
    ref_draft_color(c, at->kind, at->yarn, own);
  for (int i = 0; i < 3; i++)
    color[i] = plain[i] * own[i] * (at->gap ? 1 : at->brightness);
}

void ref_point_color(const shade_ref_cloth *c, const ref_point *at, real color[3]) {
  const shade_yarn *yarn = at->kind == SHADE_TOP_WARP ? &c->fabric.warp : &c->fabric.weft;
  dyed(c, at, yarn->kd, color);
  for (int i = 0; i < 3; i++) {
    if (at->gap)
      color[i] = c->fabric.backing[i] * (1 - at->fuzz) + color[i] * at->fuzz;
    else
      color[i] = color[i] < 1 ? color[i] : 1;
  }
}

/* What a yarn lets through: no more than it does not reflect. */
static void point_transmits(const shade_ref_cloth *c, const ref_point *at, real color[3]) {
  real kd[3];
  ref_point_color(c, at, kd);
  dyed(c, at, at->kind == SHADE_TOP_WARP ? c->fabric.warp_transmit : c->fabric.weft_transmit,
       color);
  for (int i = 0; i < 3; i++)
    color[i] = color[i] < 1 - kd[i] ? color[i] : 1 - kd[i];
}

static int transmits(const shade_fabric_params *p) {
  real sum = 0;
  for (int i = 0; i < 3; i++)
    sum += p->warp_transmit[i] + (real)p->weft_transmit[i];
  return sum > 0;
}

/* ---- the point --------------------------------------------------------------------------- */

/*
 * A layer of fibres of optical depth t over what sends `s` on. Light enters and leaves along 1/ci
 * and 1/co; a fibre scatters evenly to all sides, so what it sends back is 1/(4 pi) of the light
 * that it met, and half of what it takes from a ray goes on downwards.
 */
void ref_nap(const shade_fabric_params *p, real ci, real co, real s[3]) {
  real t = p->nap, way = 1 / ci + 1 / co;
  for (int i = 0; i < 3; i++)
    s[i] = s[i] * expl(-t * way / 2) +
           p->nap_color[i] / (4 * pi) * ci / (ci + co) * (1 - expl(-t * way));
}

/* From below it is met once, on the way out. */
static void nap_from_behind(const shade_fabric_params *p, real co, real s[3]) {
  for (int i = 0; i < 3; i++)
    s[i] *= expl(-p->nap / (2 * co));
}

/* What a point sends on by the rule of `hard`. */
static void point_s(const ref_hit *hit, vec n, vec wi, vec wo, real s[3]) {
  const shade_ref_cloth *c = hit->cloth;
  const ref_point *at = hit->at;
  const real ci = dot(n, wi), co = dot(n, wo);
  s[0] = s[1] = s[2] = 0;
  const int front = ci > 0 && wi.z > 0, behind = ci < 0 && wi.z < 0 && transmits(&c->fabric);
  if (co <= 0 || wo.z <= 0 || !(front || behind) || (at->gap && behind))
    return;
  real color[3], glossy[3], matt[3];
  ref_point_color(c, at, color);
  const shade_yarn *yarn = at->kind == SHADE_TOP_WARP ? &c->fabric.warp : &c->fabric.weft;
  const shade_params lobe = ref_yarn_lobe(&c->fabric, yarn);
  const vec tilt = {at->dx, at->dy, sqrtl(1 - at->dx * at->dx - at->dy * at->dy)};
  const vec m = ref_along_fibres(at->tx, at->ty, tilt);
  const vec i = ref_along_fibres(at->tx, at->ty, ref_in_cloth(at->kind, n, wi));
  const vec o = ref_along_fibres(at->tx, at->ty, ref_in_cloth(at->kind, n, wo));
  if (behind) {
    const real in = -dot(m, i), out = dot(m, o);
    point_transmits(c, at, color);
    for (int k = 0; k < 3 && in > 0 && out > 0; k++)
      s[k] = at->occlusion * color[k] * square(1 - (real)yarn->f0[k]) * (1 - white(in)) *
             (1 - white(out)) * in / pi;
    ref_shade_by_yarns(c, n, wi, s);
    nap_from_behind(&c->fabric, co, s);
    return;
  }
  if (at->gap) {
    for (int k = 0; k < 3; k++)
      s[k] = at->occlusion * color[k] * ci / pi;
  } else {
    ref_yarn(&lobe, m, i, o, glossy, matt);
    for (int k = 0; k < 3; k++)
      s[k] = at->occlusion * (glossy[k] + color[k] * matt[k]);
  }
  ref_shade_by_yarns(c, n, wi, s);
  if (c->fabric.nap > 0)
    ref_nap(&c->fabric, ci, co, s);
}

/* ---- the horizon of the fold ---------------------------------------------------------------- */

/* Paths by way of the upright mirrors, as for any material; s of the bumped facet, f times n.wi. */
static void by_facets(const ref_hit *hit, vec n, vec wi, vec wo, real s[3]) {
  const facets f = ref_facets_of(n);
  const vec t = f.normal[UPRIGHT];
  const int front = wi.z > 0;
  real one[3];
  const real lit = front ? ref_unhidden(&f, BUMPED, wi) : 1;
  hit->by(hit, n, wi, wo, one);
  for (int i = 0; i < 3; i++)
    s[i] = ref_facet_share(&f, BUMPED, wo) * one[i] * lit;
  if (f.area[UPRIGHT] == 0)
    return;
  if (dot(t, wo) > 0) {
    hit->by(hit, n, wi, minus(wo, scale(t, 2 * dot(t, wo))), one);
    for (int i = 0; i < 3; i++)
      s[i] += ref_facet_share(&f, UPRIGHT, wo) * one[i] * lit;
  }
  if (front && dot(t, wi) > 0) {
    const vec between = minus(wi, scale(t, 2 * dot(t, wi)));
    hit->by(hit, n, between, wo, one);
    for (int i = 0; i < 3; i++)
      s[i] += ref_facet_share(&f, BUMPED, wo) * one[i] * (1 - ref_unhidden(&f, BUMPED, between)) *
              ref_unhidden(&f, UPRIGHT, wi);
  }
}

unsigned ref_cloth_s(const ref_hit *hit, const double n_in[3], const double wi_in[3],
                     const double wo_in[3], double s[3]) {
  const double up[3] = {0, 0, 1};
  const shade_fabric_params *p = &hit->cloth->fabric;
  s[0] = s[1] = s[2] = 0;
  if (!n_in)
    n_in = up;
  if (!usable(n_in) || !usable(wi_in) || !usable(wo_in))
    return SHADE_BAD_INPUT;
  const vec given = normal(n_in), wi = direction(wi_in), wo = direction(wo_in);
  const unsigned status = n_in[2] <= 0 ? SHADE_CLAMPED_NORMAL : SHADE_OK;
  if (!transmits(p) && length(plus(wi, wo)) <= 1e-15L)
    return status | SHADE_BAD_INPUT;
  const vec n = ref_bends(p->horizon) ? ref_bent(given, wo) : given;
  const real factor = wi.z > 0 ? ref_shadow(p->horizon, given, wi) : 1;
  real sum[3];
  if (p->horizon == SHADE_HORIZON_SCHUESSLER)
    by_facets(hit, n, wi, wo, sum);
  else
    hit->by(hit, n, wi, wo, sum);
  for (int i = 0; i < 3; i++)
    s[i] = (double)(sum[i] * factor);
  return status;
}

unsigned shade_ref_cloth_near(const shade_ref_cloth *c, const double uv[2], const double n[3],
                              const double wi[3], const double wo[3], double s[3]) {
  const ref_point at = ref_look(c, uv[0], uv[1]);
  const ref_hit hit = {c, &at, NULL, point_s};
  return ref_cloth_s(&hit, n, wi, wo, s);
}

double shade_ref_cloth_coverage(const shade_ref_cloth *c, const double uv[2], const double n_in[3],
                                const double wo_in[3]) {
  const double up[3] = {0, 0, 1};
  const ref_point at = ref_look(c, uv[0], uv[1]);
  const double *backing = c->fabric.backing;
  if (!at.gap || backing[0] > 0 || backing[1] > 0 || backing[2] > 0)
    return 1;
  const vec given = normal(n_in ? n_in : up), wo = direction(wo_in);
  const vec n = ref_bends(c->fabric.horizon) ? ref_bent(given, wo) : given;
  const real co = dot(n, wo);
  return (double)(1 - (co > 0 ? (1 - at.fuzz) * expl(-c->fabric.nap / (2 * co)) : 0));
}
