/* SPDX-License-Identifier: Apache-2.0 */
/* Bumps that shade and light each other, by their slopes: the horizon `mutual`. */
#include "model.h"

#include <math.h>

/* ---- draws of a lobe, long-hand ---------------------------------------------------------------
 */

/* t with probability u above it, under the density (rise + lean t) exp(-t^2), t > -rise/lean. */
static real slope_towards(real u, real rise, real lean) {
  real low = lean > 0 && rise < 12 * lean ? -rise / lean : -12, high = 12;
  const real whole = rise * sqrtl(pi) / 2 * erfcl(low) + lean / 2 * expl(-low * low);
  for (int k = 0; k < 90; k++) {
    const real t = (low + high) / 2;
    const real above = rise * sqrtl(pi) / 2 * erfcl(t) + lean / 2 * expl(-t * t);
    *(above > u * whole ? &low : &high) = t;
  }
  return (low + high) / 2;
}

/* A half vector of one lobe of the proposal, in its frame; eye is wo in the same. */
static vec half_of(const shade_params *p, proposal q, real u1, real u2, vec eye, int visible) {
  const real c = cosl(2 * pi * u1), s = sinl(2 * pi * u1);
  switch (p->mdf) {
  case SHADE_MDF_WARD_HALF: {
    const real x = c * q.x, y = s * q.y, size = length2(x, y), k = 1 / square(size);
    const real m = -log1pl(u2 * expm1l(-2 * k)) / (2 * k), sine = sqrtl(m * (2 - m));
    return (vec){sine * x / size, sine * y / size, 1 - m};
  }
  case SHADE_MDF_BECKMANN: {
    if (!visible) {
      const real r = sqrtl(-log1pl(-u2));
      return (vec){r * c * q.x, r * s * q.y, 1};
    }
    const real x = q.x * eye.x, y = q.y * eye.y, side = length2(x, y), size = length2(side, eye.z);
    const real cx = side > 0 ? x / side : 1, cy = side > 0 ? y / side : 0;
    const real along = slope_towards(u1, eye.z / size, side / size);
    const real across = slope_towards(u2, 1, 0);
    return (vec){q.x * (along * cx - across * cy), q.y * (along * cy + across * cx), 1};
  }
  case SHADE_MDF_GGX: {
    if (!visible) {
      const real r = sqrtl(u2 / (1 - u2));
      return (vec){r * c * q.x, r * s * q.y, 1};
    }
    const vec o = unit((vec){q.x * eye.x, q.y * eye.y, eye.z});
    const real z = (1 - u2) * (1 + o.z) - o.z, sine = sqrtl(1 - z * z);
    return (vec){q.x * (sine * c + o.x), q.y * (sine * s + o.y), z + o.z};
  }
  case SHADE_MDF_ASHIKHMIN_SHIRLEY:
  case SHADE_MDF_WARD:
  case SHADE_MDF_COUNT:
    break;
  }
  const vec a = {c / sqrtl(q.x + 1), s / sqrtl(q.y + 1), 0}; /* the azimuth; |a|^2 is 1/(e + 1) */
  const real z = powl(1 - u2, dot(a, a)), sine = sqrtl(-expm1l(2 * dot(a, a) * log1pl(-u2)));
  return (vec){sine * a.x / length(a), sine * a.y / length(a), z};
}

/* Through a warp: the point p of the disc moved by the share of n that leads there. */
static vec through_warp(shade_detail detail, vec n, vec m) {
  m = unit(m);
  const vec p = {m.x, m.y, 0}, delta = {n.x, n.y, 0};
  real w = 1 - length(p);
  if (detail == SHADE_DETAIL_DEFORM_SMOOTH || detail == SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING) {
    /* the least v with v (2 - v) = |p + v (1 - v) delta| */
    real v = length(p) / (2 + length(delta));
    for (int k = 0; k < 60; k++) {
      const vec e = plus(p, scale(delta, v * (1 - v)));
      const real size = length(e), lean = size > 0 ? dot(e, delta) / size : 0;
      const real slope = 2 - 2 * v - (1 - 2 * v) * lean;
      v = within(v - (v * (2 - v) - size) / (slope > 1e-6L ? slope : 1e-6L), 0, 1);
    }
    w = 1 - v;
  }
  vec h = plus(p, scale(delta, w));
  h.z = sqrtl(within(1 - dot(h, h), 0, 1));
  return h;
}

/* A direction of the lobe about n, of any height, and the cosine of its half vector in the lobe's
 * frame. Of more than one lobe that it is drawn by, the first. Returns whether there is one. */
static int draw(const shade_params *p, vec n, vec wo, real u1, real u2, vec *wi, real *upright) {
  const shade_detail detail = ref_method_of(p), frame = ref_drawn_in(p);
  const int visible = ref_draws_visible(p);
  proposal q[3];
  ref_proposals(p, n, q);
  const vec eye = visible ? ref_carried_by(frame, p, n, wo) : wo;
  const vec m = unit(half_of(p, q[0], u1, u2, eye, visible));
  vec h;
  if (ref_is_warp(detail)) {
    h = through_warp(detail, n, m);
  } else { /* a rotation: the way back is its transpose */
    const vec x = ref_carried_by(frame, p, n, (vec){1, 0, 0});
    const vec y = ref_carried_by(frame, p, n, (vec){0, 1, 0});
    const vec z = ref_carried_by(frame, p, n, (vec){0, 0, 1});
    h = (vec){dot(x, m), dot(y, m), dot(z, m)};
  }
  *wi = mirrored(wo, unit(h));
  *upright = m.z;
  return dot(h, wo) > 0;
}

/*
 * f cos over the density of the draw, for a D of 1: visible normals by D (o.h) G1 / o.z, other ones
 * by D, or D times its cosine for those that integrate with it.
 */
static real weight_of_draw(const shade_params *p, vec n, vec wi, vec wo, real upright) {
  const real cosi = dot(n, wi), coso = dot(n, wo);
  if (cosi <= 0 || coso <= 0)
    return 0;
  const real f = ref_brdf(p, n, wi, wo, cosi, coso, 1);
  if (ref_draws_visible(p))
    return f * cosi * 4 * coso * (1 + ref_lambda(p, n, wo));
  const int projected = p->mdf == SHADE_MDF_GGX || p->mdf == SHADE_MDF_BECKMANN;
  return f * cosi * 4 * dot(unit(plus(wi, wo)), wo) / (projected ? upright : 1);
}

/* ---- a hit ------------------------------------------------------------------------------------
 */

typedef struct side {
  vec n, lobe_n;
  real share;
} side;

typedef struct bumps {
  const shade_params *p;
  real x, y, xx, xy, yy; /* mean slope, and the second moment about it */
  vec wo;
  real lambda;
  side side[2]; /* the facet, and the other side of the bump */
} bumps;

static real height(const bumps *b, vec w) {
  return w.z - b->x * w.x - b->y * w.y;
}
static real variance(const bumps *b, vec w) {
  return b->xx * w.x * w.x + 2 * b->xy * w.x * w.y + b->yy * w.y * w.y;
}
static real lambda_of(const bumps *b, vec w) {
  const real a = height(b, w) / sqrtl(2 * variance(b, w));
  if (a >= 1.6L || variance(b, w) <= 0)
    return 0;
  const real at = a > 1e-7L ? a : 1e-7L;
  const real l = (1 - 1.259L * at + 0.396L * at * at) / (3.535L * at + 2.181L * at * at);
  return l > 0 ? l : 0;
}
static real unblocked(const bumps *b, vec wi) {
  return height(b, wi) > 0 ? (1 + b->lambda) / (1 + b->lambda + lambda_of(b, wi)) : 0;
}

static real cumulative(real x) {
  return erfcl(-x / sqrtl(2)) / 2;
}
static real gaussian(real x) {
  return expl(-x * x / 2) / sqrtl(2 * pi);
}

int ref_has_bumps(const shade_params *p) {
  return p->horizon == SHADE_HORIZON_MUTUAL && p->detail != SHADE_DETAIL_NONE &&
         (p->slopes[2] > 0 || p->slopes[4] > 0);
}

static bumps bumps_at(const shade_params *p, vec n, vec lobe_n, vec wo) {
  bumps b = {.p = p, .wo = wo};
  b.x = within(p->slopes[0], -1e3L, 1e3L);
  b.y = within(p->slopes[1], -1e3L, 1e3L);
  b.xx = within(p->slopes[2], 0, 1e6L);
  b.yy = within(p->slopes[4], 0, 1e6L);
  b.xy = within(p->slopes[3], -sqrtl(b.xx * b.yy), sqrtl(b.xx * b.yy));
  const real more = 1e-4L * (b.xx + b.yy);
  b.xx += more;
  b.yy += more;
  b.lambda = lambda_of(&b, wo);
  const real up = n.z > 1e-6L ? n.z : 1e-6L;
  const vec s = {-n.x / up, -n.y / up, 0};
  const real p_n = wo.z - dot(s, wo), q = variance(&b, wo), t = sqrtl(q), mean = height(&b, wo);
  real area = mean;
  if (t > 1e-9L)
    area = mean * cumulative(mean / t) + t * gaussian(mean / t);
  area = area > 1e-12L ? area : 1e-12L;
  b.side[0] = (side){n, lobe_n, 1};
  if (q < 1e-10L || p_n >= area)
    return b;
  const real step = 2 * (area - p_n) / q;
  const vec other = unit(
      (vec){step * (b.xx * wo.x + b.xy * wo.y) - s.x, step * (b.xy * wo.x + b.yy * wo.y) - s.y, 1});
  b.side[0].share = p_n > 0 ? p_n / area : 0;
  b.side[1] = (side){other, other, 1 - b.side[0].share};
  return b;
}

/* f cos of the lobe about one side without Fresnel, and the density of its draws. */
static real side_value(const bumps *b, const side *s, vec wi) {
  const real cosi = dot(s->n, wi), coso = dot(s->n, b->wo);
  if (s->share <= 0 || cosi <= 0 || coso <= 0)
    return 0;
  const real d = ref_distribution(b->p, s->lobe_n, unit(plus(wi, b->wo)));
  return ref_brdf(b->p, s->n, wi, b->wo, cosi, coso, d) * cosi;
}
static real side_density(const bumps *b, const side *s, vec wi) {
  if (s->share <= 0 || dot(s->n, wi) <= 0 || dot(s->n, b->wo) <= 0)
    return 0;
  return ref_lobe_density(b->p, s->lobe_n, wi, b->wo);
}

/* What is kept back of the light, by that many draws; of all that is reflected; its direction. */
typedef struct kept_back {
  real share, all;
  vec mean;
} kept_back;
static kept_back kept_back_of(const bumps *b, int nodes) {
  kept_back sum = {0, 0, {0, 0, 0}};
  for (int k = 0; k < 2 * nodes; k++) {
    const side *s = &b->side[k / nodes];
    const real at = (real)(k % nodes) + 0.5L, turn = at * (sqrtl(5) - 1) / 2;
    vec wi;
    real upright;
    if (s->share <= 0 || dot(s->n, b->wo) <= 0 ||
        !draw(b->p, s->lobe_n, b->wo, at / (real)nodes, turn - floorl(turn), &wi, &upright))
      continue;
    const real g = s->share * weight_of_draw(b->p, s->n, wi, b->wo, upright) / (real)nodes;
    sum.all += g;
    sum.share += g * (1 - unblocked(b, wi));
    sum.mean = plus(sum.mean, scale(wi, g * (1 - unblocked(b, wi))));
  }
  return sum;
}

/* The lobe of what is met next: Gaussian slopes as seen from `from`. */
typedef struct next {
  vec from;
  real xx, xy, yy, area;
} next;
static next next_of(const bumps *b, kept_back kept) {
  const shade_params *p = b->p;
  next m = {unit(scale(kept.mean, -1)), b->xx, b->xy, b->yy, 0};
  if (p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    m.xx += 2 / within(p->ex, 0.02L, 1e6L);
    m.yy += 2 / within(p->ey, 0.02L, 1e6L);
  } else {
    const real most = sqrtl(50); /* of half the covariance, as above */
    m.xx += square(within(p->ax, 1e-4L, most));
    m.yy += square(within(p->ay, 1e-4L, most));
  }
  vec c = m.from;
  real t = sqrtl(m.xx * c.x * c.x + 2 * m.xy * c.x * c.y + m.yy * c.y * c.y);
  if (height(b, c) < -2.5L * t) {
    c.z = b->x * c.x + b->y * c.y - 2.5L * t;
    t /= length(c);
    c = unit(c);
    m.from = c;
  }
  t = t > 1e-6L ? t : 1e-6L;
  const real nu = height(b, c) / t;
  m.area = height(b, c) * cumulative(nu) + t * gaussian(nu);
  return m;
}
static real next_density_of(const bumps *b, const next *m, vec w) {
  const vec h = plus(m->from, w);
  if (h.z <= 0 || square(h.z) <= 1e-10L * dot(h, h))
    return 0;
  const real x = -h.x / h.z - b->x, y = -h.y / h.z - b->y, det = m->xx * m->yy - square(m->xy);
  const real e = (m->yy * x * x - 2 * m->xy * x * y + m->xx * y * y) / det;
  const real cos2 = square(h.z) / dot(h, h);
  return expl(-e / 2) / (2 * pi * sqrtl(det) * square(cos2)) / (4 * m->area);
}
static real next_density(const bumps *b, const next *m, vec wi) {
  const vec up = unit((vec){-b->x, -b->y, 1});
  return next_density_of(b, m, wi) + next_density_of(b, m, minus(wi, scale(up, 2 * dot(up, wi))));
}

void ref_mutual_f(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo, real f[3]) {
  f[0] = f[1] = f[2] = 0;
  if (wi.z <= 0 || wo.z <= 0)
    return;
  const bumps b = bumps_at(p, n, lobe_n, wo);
  const kept_back kept = kept_back_of(&b, SHADE_REF_NODES);
  real once = 0, twice = 0;
  for (int k = 0; k < 2; k++)
    once += unblocked(&b, wi) * b.side[k].share * side_value(&b, &b.side[k], wi);
  if (kept.share > 1e-9L && height(&b, wi) > 0) {
    const next m = next_of(&b, kept);
    twice = kept.share * (kept.all < 1 ? kept.all : 1) * next_density(&b, &m, wi);
  }
  const vec bent = ref_bent(n, wo);
  const real hwo = dot(unit(plus(wi, wo)), wo);
  const int lit = dot(bent, wi) > 0 && dot(bent, wo) > 0;
  for (int c = 0; c < 3; c++) {
    f[c] = ref_fresnel(p, c, hwo) * once + square(ref_mean_fresnel(p, c)) * twice;
    if (lit)
      f[c] += ref_diffuse_part(p, c, bent, wi, wo) * ref_shadow(SHADE_HORIZON_VALID_ESTEVEZ, n, wi);
    f[c] /= wi.z;
  }
}

real ref_mutual_density(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo) {
  if (wi.z <= 0 || wo.z <= 0)
    return 0;
  const bumps b = bumps_at(p, n, lobe_n, wo);
  real density = 0;
  if (height(&b, wi) > 0) {
    const kept_back kept = kept_back_of(&b, SHADE_REF_NODES);
    const real pick = kept.share > 1e-9L ? (kept.share < 0.9L ? kept.share : 0.9L) : 0;
    for (int k = 0; k < 2; k++)
      density += (1 - pick) * b.side[k].share * side_density(&b, &b.side[k], wi);
    if (pick > 0) {
      const next m = next_of(&b, kept);
      density += pick * next_density(&b, &m, wi);
    }
  }
  return ref_with_matt(p, ref_bent(n, wo), wi, wo, density);
}

double shade_ref_kept_back(const shade_params *p, const double n_in[3], const double wo_in[3],
                           int nodes) {
  const vec n = normal(n_in), wo = direction(wo_in);
  const bumps b = bumps_at(p, n, ref_as_given(p, n_in, n), wo);
  return (double)kept_back_of(&b, nodes).share;
}
