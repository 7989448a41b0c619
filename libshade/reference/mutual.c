/* SPDX-License-Identifier: Apache-2.0 */
/* Bumps that shade and light each other, by their slopes: the horizon `mutual`. */
#include "model.h"

#include <math.h>

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

/* Twice the covariance of a facet's own slopes, along x and y; at most that of alpha 2. */
static void own_variance(const shade_params *p, real v[2]) {
  const int exponents = p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY;
  v[0] = exponents ? 2 / within(p->ex, 0.5L, 1e6L) : square(within(p->ax, 1e-4L, 2));
  v[1] = exponents ? 2 / within(p->ey, 0.5L, 1e6L) : square(within(p->ay, 1e-4L, 2));
}

/* What is kept back of the light, of all that is reflected; its direction. */
typedef struct kept_back {
  real share, all;
  vec mean;
} kept_back;

/* 1 + 2 Lambda of a lobe whose slopes' covariance is v / 2, of w in its frame. */
static real smith(const shade_params *p, const real v[2], vec w) {
  const real slope2 = (v[0] * w.x * w.x + v[1] * w.y * w.y) / square(w.z), a = 1 / sqrtl(slope2);
  if (p->mdf == SHADE_MDF_GGX)
    return sqrtl(1 + slope2);
  return slope2 > 0 ? erfl(a) + expl(-a * a) / (a * sqrtl(pi)) : 1;
}

/* By four facets of each side, whose slopes are off its own: two the way in which the height of
 * what they reflect changes most, and two across it. */
static kept_back kept_back_of(const bumps *b) {
  const shade_params *p = b->p;
  const int microfacet = ref_brdf_of(p) == SHADE_BRDF_MICROFACET;
  const int projected = p->mdf == SHADE_MDF_GGX || p->mdf == SHADE_MDF_BECKMANN;
  const shade_detail detail =
      ref_is_warp(ref_method_of(p)) ? SHADE_DETAIL_SHORTEST_ARC : ref_drawn_in(p);
  kept_back sum = {0, 0, {0, 0, 0}};
  real v[2];
  own_variance(p, v);
  for (int k = 0; k < 2; k++) {
    const side *s = &b->side[k];
    if (s->share <= 0 || dot(s->n, b->wo) <= 0)
      continue;
    const vec o = ref_carried_by(detail, p, s->lobe_n, b->wo);
    const vec x = ref_carried_by(detail, p, s->lobe_n, (vec){1, 0, 0});
    const vec y = ref_carried_by(detail, p, s->lobe_n, (vec){0, 1, 0});
    const vec z = ref_carried_by(detail, p, s->lobe_n, (vec){0, 0, 1});
    const vec axis[3] = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}};
    const real up = height(b, axis[2]);
    real gx = sqrtl(v[0]) * (up * o.x + o.z * height(b, axis[0]));
    real gy = sqrtl(v[1]) * (up * o.y + o.z * height(b, axis[1]));
    const real g = sqrtl(gx * gx + gy * gy);
    gx = g > 1e-6L ? gx / g : 1;
    gy = g > 1e-6L ? gy / g : 0;
    const int tails = p->mdf == SHADE_MDF_GGX;
    vec to[4];
    real seen = 0;
    for (int i = 0; i < 4; i++) {
      const real sign = i & 1 ? -1 : 1;
      const real off = sign * (i < 2 ? (tails ? 1.8L : 0.97L) : (tails ? 0.9L : 0.62L));
      to[i] =
          (vec){off * sqrtl(v[0]) * (i < 2 ? gx : -gy), off * sqrtl(v[1]) * (i < 2 ? gy : gx), 1};
      seen += fmaxl(dot(to[i], o), 0);
    }
    for (int i = 0; i < 4; i++) {
      const vec h = unit(to[i]), l = mirrored(o, h);
      const vec wi = {dot(x, l), dot(y, l), dot(z, l)};
      if (dot(h, o) <= 0 || l.z <= 0)
        continue;
      real g = ref_brdf(p, s->n, wi, b->wo, l.z, o.z, 1) * l.z * dot(h, o) / (projected ? h.z : 1);
      if (microfacet) {
        const real lo = smith(p, v, o);
        g = dot(to[i], o) / seen * (1 + lo) / (smith(p, v, l) + lo);
      }
      sum.all += s->share * g;
      sum.share += s->share * g * (1 - unblocked(b, wi));
      sum.mean = plus(sum.mean, scale(wi, s->share * g * (1 - unblocked(b, wi))));
    }
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
  if (square(m.from.x) + square(m.from.y) < 1e-12L) { /* no azimuth: that of x */
    m.from.x = 1e-6L;
    m.from.y = 0;
  }
  real v[2];
  own_variance(p, v);
  m.xx += v[0];
  m.yy += v[1];
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
  const kept_back kept = kept_back_of(&b);
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
    const kept_back kept = kept_back_of(&b);
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
                           int steps) {
  const vec n = normal(n_in), wo = direction(wo_in);
  const bumps b = bumps_at(p, n, ref_as_given(p, n_in, n), wo);
  if (!steps)
    return (double)kept_back_of(&b).share;
  real sum = 0;
  for (int j = 0; j < steps; j++)
    for (int i = 0; i < 2 * steps; i++) {
      const real z = -1 + 2 * ((real)j + 0.5L) / steps, turn = pi * ((real)i + 0.5L) / steps;
      const real sine = sqrtl(1 - z * z);
      const vec wi = {sine * cosl(turn), sine * sinl(turn), z};
      for (int k = 0; k < 2; k++)
        sum += b.side[k].share * side_value(&b, &b.side[k], wi) * (1 - unblocked(&b, wi));
    }
  return (double)(sum * 2 * pi / square(steps));
}
