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
  return powl(1 - cosine, 5);
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

void ref_point_color(const shade_ref_cloth *c, const ref_point *at, real color[3]) {
  const shade_yarn *yarn = at->kind == SHADE_TOP_WARP ? &c->fabric.warp : &c->fabric.weft;
  real own[3] = {1, 1, 1};
  if (c->fabric.draft_colors)
    ref_draft_color(c, at->kind, at->yarn, own);
  for (int i = 0; i < 3; i++) {
    real kd = yarn->kd[i] * own[i], ground = c->fabric.backing[i];
    if (at->gap)
      color[i] = ground * (1 - at->fuzz) + kd * at->fuzz;
    else
      color[i] = kd * at->brightness < 1 ? kd * at->brightness : 1;
  }
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

unsigned ref_cloth_open(const double n_in[3], const double wi_in[3], const double wo_in[3], vec *n,
                        vec *wi, vec *wo) {
  const double up[3] = {0, 0, 1};
  if (!n_in)
    n_in = up;
  if (!usable(n_in) || !usable(wi_in) || !usable(wo_in))
    return SHADE_BAD_INPUT;
  *n = normal(n_in);
  *wi = direction(wi_in);
  *wo = direction(wo_in);
  unsigned status = n_in[2] <= 0 ? SHADE_CLAMPED_NORMAL : SHADE_OK;
  return length(plus(*wi, *wo)) <= 1e-15L ? status | SHADE_BAD_INPUT : status;
}

unsigned shade_ref_cloth_near(const shade_ref_cloth *c, const double uv[2], const double n_in[3],
                              const double wi_in[3], const double wo_in[3], double s[3]) {
  vec n, wi, wo;
  s[0] = s[1] = s[2] = 0;
  unsigned status = ref_cloth_open(n_in, wi_in, wo_in, &n, &wi, &wo);
  if (status & SHADE_BAD_INPUT)
    return status;
  const real ci = dot(n, wi), co = dot(n, wo);
  if (ci <= 0 || co <= 0 || wi.z <= 0 || wo.z <= 0)
    return status;
  const ref_point at = ref_look(c, uv[0], uv[1]);
  real kd[3], sum[3], glossy[3], matt[3];
  ref_point_color(c, &at, kd);
  if (at.gap) {
    for (int i = 0; i < 3; i++)
      sum[i] = at.occlusion * kd[i] * ci / pi;
  } else {
    const shade_yarn *yarn = at.kind == SHADE_TOP_WARP ? &c->fabric.warp : &c->fabric.weft;
    const shade_params lobe = ref_yarn_lobe(&c->fabric, yarn);
    const vec tilt = {at.dx, at.dy, sqrtl(1 - at.dx * at.dx - at.dy * at.dy)};
    ref_yarn(&lobe, ref_along_fibres(at.tx, at.ty, tilt),
             ref_along_fibres(at.tx, at.ty, ref_in_cloth(at.kind, n, wi)),
             ref_along_fibres(at.tx, at.ty, ref_in_cloth(at.kind, n, wo)), glossy, matt);
    for (int i = 0; i < 3; i++)
      sum[i] = at.occlusion * (glossy[i] + kd[i] * matt[i]);
  }
  if (c->fabric.nap > 0)
    ref_nap(&c->fabric, ci, co, sum);
  for (int i = 0; i < 3; i++)
    s[i] = (double)sum[i];
  return status;
}
