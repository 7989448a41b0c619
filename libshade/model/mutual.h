/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Bumps that shade and light each other: SHADE_HORIZON_MUTUAL, stated in shade.h. Slopes of a map
 * have the mean m and, about it, the second moment Sigma. The bump shades the map's mean plane, so
 * slopes are taken from m, and heights of directions from that plane by a shear.
 *
 * A facet shows the eye p = n.wo/n.z, bumps in the mean Ao. It is shown in its share p/Ao. The rest
 * is the other side of the bump: its slope mirrored along the eye's azimuth. Light is masked by
 * height-correlated Smith of Sigma. What that keeps back meets another bump: a Gaussian lobe, as
 * seen from the mean direction of what is kept back, and folded up about the mean plane.
 * docs/theory/horizons.md, Mutual.
 *
 * Errors against the reference: test/test_mutual.c.
 */
#ifndef SHADE_MODEL_MUTUAL_H
#define SHADE_MODEL_MUTUAL_H

#include "draw.h"
#include "fresnel.h"

LEAF real dot_of(triple n, triple w) {
  return dot(XYZ(n), XYZ(w));
}

/* Whether there are slopes to shade by; all else is `hard`. */
LEAF int has_bumps(const bsdf *b) {
  const real *slopes = numbers_of(b)->slopes;
  return shade_horizon_is(b->horizon).mutual && slopes[2] + slopes[4] > 0;
}

/* The map: its mean slope, and the second moment of slopes about it. */
typedef struct relief {
  real x, y, xx, xy, yy;
} relief;

/* Grooves get some width, or the other side of one that is seen along them would be anywhere. */
LEAF relief relief_of(const real slopes[5]) {
  relief r = {slopes[0], slopes[1], maximum(slopes[2], 0), slopes[3], maximum(slopes[4], 0)};
  const real most = root(r.xx) * root(r.yy), more = R(1e-4) * (r.xx + r.yy);
  r.xy = minimum(maximum(r.xy, -most), most);
  r.xx += more;
  r.yy += more;
  return r;
}

/* Height of a direction over the mean plane, by the shear; the variance of slopes along it. */
LEAF real height_over(relief r, triple w) {
  return multiply_add(-r.y, w.y, multiply_add(-r.x, w.x, w.z));
}
LEAF real variance_along(relief r, triple w) {
  const real x = r.xx * w.x + r.xy * w.y, y = r.xy * w.x + r.yy * w.y;
  return maximum(x * w.x + y * w.y, 0);
}

/* Smith's Lambda of Gaussian slopes, by a rational fit; height > 0. [Walter2007] */
LEAF real relief_lambda(real height, real variance) {
  const real a = maximum(height / maximum(root(2 * variance), R(1e-18)), R(1e-7));
  const real top = 1 - R(1.259) * a + R(0.396) * (a * a);
  const real lambda = top / (R(3.535) * a + R(2.181) * (a * a));
  return a < R(1.6) ? maximum(lambda, 0) : 0;
}

/* Density and distribution of the normal distribution, and x P(x) + p(x). */
LEAF real normal_density(real x) {
  return R(0.39894228040143267794) * exp_negative(R(0.5) * x * x);
}
LEAF real normal_below(real x) {
  const real t = absolute(x) * R(0.70710678118654752440);
  const real tail = R(0.5) * exp_negative(t * t) * scaled_erfc_at(1 / (1 + R(0.3) * t));
  return x < 0 ? tail : 1 - tail;
}
LEAF real normal_visible(real x) {
  return x * normal_below(x) + normal_density(x);
}

/* Mean area that slopes of that spread show a direction of that height. */
LEAF real area_shown(real height, real spread) {
  const real area = spread > R(1e-9) ? spread * normal_visible(height / spread) : height;
  return maximum(area, R(1e-12));
}

/* ---- the lobe about a facet's normal, light above it or not above the surface ------------------
 */

typedef struct facet {
  triple n;
  real coso, lo, weight; /* lo: of angles */
} facet;

LEAF facet facet_of(const bsdf *b, triple n, triple wo, real weight) {
  facet f = {n, dot_of(n, wo), 0, weight};
  f.weight = f.coso > 0 ? f.weight : 0;
  if (f.weight > 0 && b->brdf == SHADE_BRDF_MICROFACET)
    f.lo = smith(b, n, wo);
  return f;
}

/* Half of the way from wi to wo, as lobes take it, and its cosine with either. */
typedef struct halfway {
  triple h;
  real hwo;
} halfway;
LEAF halfway halfway_of(const bsdf *b, triple wi, triple wo) {
  halfway a = {{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z}, 0};
  const real scale = b->warp != SHADE_RIGID ? scale_to_unit(XYZ(a.h)) : 1;
  a.hwo = half_cosine(XYZ(a.h));
  a.h = (triple){a.h.x * scale, a.h.y * scale, a.h.z * scale};
  return a;
}

/* f cos without Fresnel. */
LEAF real facet_value(const bsdf *b, facet f, halfway a, triple wi) {
  angles to = {a.hwo, dot_of(f.n, wi), f.coso, 0, f.lo};
  if (!(to.cosi > 0 && f.weight > 0))
    return 0;
  if (b->brdf == SHADE_BRDF_MICROFACET)
    to.li = smith(b, f.n, wi);
  return brdf_value(b->brdf, lobe(b, f.n, a.h), to) * to.cosi;
}

/* The density of the lobe's own draws; what falls below the facet is lost. */
LEAF real facet_density(const bsdf *b, facet f, halfway a, triple wi, triple wo) {
  if (!(f.weight > 0 && dot_of(f.n, wi) > 0))
    return 0;
  return proposed_density(b, f.n, a.h, a.hwo, wo, f.coso);
}

/* ---- a hit -------------------------------------------------------------------------------------
 */

enum { SHADE_MUTUAL_NODES = 8 };

/* Fixed pairs of uniform numbers: even steps, and steps of the golden ratio. */
LEAF pair mutual_node(int k) {
  const real golden = R(0.61803398874989484820), at = (real)k + R(0.5), turn = at * golden;
  return (pair){at / SHADE_MUTUAL_NODES, turn - (real)(int)turn};
}

typedef struct mutual {
  relief map;
  triple up;      /* the mean plane's normal */
  real above;     /* 1 + Lambda(wo) */
  facet facet[2]; /* the one given, and the other side of the bump, by their shares */
  real pick;      /* share of the draws of what is met next */
  triple from;    /* where that is seen from */
  real low[3];    /* the lower triangle of its slopes' covariance; */
  real per_area;  /* 1 over all but the exponential of its density; */
  real nu;        /* the height of `from` in standard deviations; */
  pair along;     /* its azimuth, in terms of these */
  triple again;   /* its colour: F^2 times what is kept back */
} mutual;

/* Share of the light from wi that other bumps let through. */
LEAF real unblocked(const mutual *m, triple wi) {
  const real height = height_over(m->map, wi);
  const real li = relief_lambda(height, variance_along(m->map, wi));
  return height > 0 ? m->above / (m->above + li) : 0;
}

/* Twice the facets' own covariance of slopes. */
LEAF pair facet_variance(const bsdf *b) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  return (pair){(b->exponents ? 2 : 1) / maximum(own->kx, R(0.02)),
                (b->exponents ? 2 : 1) / maximum(own->ky, R(0.02))};
}

/* What is kept back of the light, all that a facet reflects, and the former's mean direction. */
typedef struct kept_back {
  real share, all;
  triple mean;
} kept_back;

static __attribute__((noinline)) kept_back kept_back_of(const bsdf *b, const mutual *m, triple wo) {
  kept_back sum = {0, 0, {0, 0, 0}};
  for (int k = 0; k < 2 * SHADE_MUTUAL_NODES; k++) {
    const facet f = m->facet[k / SHADE_MUTUAL_NODES];
    const pair u = mutual_node(k % SHADE_MUTUAL_NODES);
    if (!(f.weight > 0))
      continue;
    const drawn d = draw_proposed(b, f.n, wo, f.coso, u.x, u.y);
    const real scale = 1 / root(dot_of(d.w, d.w) + TINY);
    const triple w = {d.w.x * scale, d.w.y * scale, d.w.z * scale};
    const halfway a = halfway_of(b, w, wo);
    const real density = d.lost > 0 ? 0 : facet_density(b, f, a, w, wo);
    if (!(density > 0))
      continue;
    const real g = f.weight * facet_value(b, f, a, w) / density / SHADE_MUTUAL_NODES;
    const real back = g * (1 - unblocked(m, w));
    sum.share += back;
    sum.all += g;
    sum.mean = (triple){sum.mean.x + back * w.x, sum.mean.y + back * w.y, sum.mean.z + back * w.z};
  }
  return sum;
}

/* The lobe of what is met next, from the mean direction of what is kept back. */
static void meet_next(const bsdf *b, mutual *m, kept_back kept) {
  const pair own = facet_variance(b);
  const relief r = m->map;
  const double xx = (double)(r.xx + own.x), xy = (double)r.xy, yy = (double)(r.yy + own.y);
  const double first = sqrt(xx), second = xy / first; /* grooves cancel: in double */
  m->low[0] = (real)first;
  m->low[1] = (real)second;
  m->low[2] = (real)sqrt(yy - second * second);
  const real size = 1 / root(dot_of(kept.mean, kept.mean) + TINY);
  triple c = {-kept.mean.x * size, -kept.mean.y * size, -kept.mean.z * size};
  real x = m->low[0] * c.x + m->low[1] * c.y, y = m->low[2] * c.y, spread = root(x * x + y * y);
  if (height_over(r, c) < R(-2.5) * spread) { /* so far below nothing shows */
    c.z = r.x * c.x + r.y * c.y - R(2.5) * spread;
    const real again = 1 / root(dot_of(c, c) + TINY);
    c = (triple){c.x * again, c.y * again, c.z * again};
    x *= again;
    y *= again;
    spread *= again;
  }
  const real safe = maximum(spread, R(1e-6));
  m->from = c;
  m->along = spread > R(1e-12) ? (pair){x / spread, y / spread} : (pair){1, 0};
  m->nu = maximum(height_over(r, c) / safe, R(-2.5));
  const real area = safe * normal_visible(m->nu);
  m->per_area = R(0.039788735772973833942) / (m->low[0] * m->low[2] * area); /* 1/(8 pi) */
}

/* n and wo are mended, wo.z > 0, and the map has slopes. */
static __attribute__((noinline)) void prepare_mutual(const bsdf *b, triple n, triple wo,
                                                     mutual *m) {
  const relief r = relief_of(numbers_of(b)->slopes);
  const real per = 1 / maximum(n.z, R(1e-6)), size = 1 / root(1 + r.x * r.x + r.y * r.y);
  const real sx = -n.x * per, sy = -n.y * per;
  const real height = height_over(r, wo), variance = variance_along(r, wo);
  const real area = area_shown(height, root(variance));
  const real shown = multiply_add(-sy, wo.y, multiply_add(-sx, wo.x, wo.z)); /* p */
  const int seen = !(variance >= R(1e-10)) || !(shown < area);
  const real share = seen ? 1 : maximum(shown / area, 0);
  m->map = r;
  m->up = (triple){-r.x * size, -r.y * size, size};
  m->above = 1 + relief_lambda(maximum(height, 0), variance);
  m->facet[0] = facet_of(b, n, wo, share);
  m->facet[1] = (facet){n, 0, 0, 0};
  if (!seen) {
    const real step = 2 * (area - shown) / variance;
    const triple other = {multiply_add(step, r.xx * wo.x + r.xy * wo.y, -sx),
                          multiply_add(step, r.xy * wo.x + r.yy * wo.y, -sy), 1};
    const real length = 1 / root(dot_of(other, other));
    m->facet[1] = facet_of(b, (triple){other.x * length, other.y * length, length}, wo, 1 - share);
  }
  m->pick = 0;
  m->again = (triple){0, 0, 0};
  const kept_back kept = kept_back_of(b, m, wo);
  if (!(kept.share > R(1e-9)))
    return;
  meet_next(b, m, kept);
  m->pick = minimum(kept.share, R(0.9));
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  real colour[3];
  for (int c = 0; c < 3; c++) {
    const real f = fresnel_mean(b->fresnel, own->f0[c], own->tint[c], own->k[c]);
    colour[c] = f * f * kept.share * minimum(kept.all, 1); /* no more than facets reflect again */
  }
  m->again = (triple){colour[0], colour[1], colour[2]};
}

/* w mirrored at the mean plane. */
LEAF triple folded(const mutual *m, triple w) {
  const real twice = 2 * dot_of(m->up, w);
  return (triple){w.x - twice * m->up.x, w.y - twice * m->up.y, w.z - twice * m->up.z};
}

/* Density of w by what is met next, over the whole sphere. */
LEAF real next_density_of(const mutual *m, triple w) {
  const triple h = {m->from.x + w.x, m->from.y + w.y, m->from.z + w.z};
  const real hh = dot_of(h, h);
  if (!(h.z > 0 && h.z * h.z > R(1e-10) * hh))
    return 0;
  const real per = 1 / h.z, q = hh * (per * per);
  const real x = (-h.x * per - m->map.x) / m->low[0];
  const real y = (-h.y * per - m->map.y - m->low[1] * x) / m->low[2];
  return exp_negative(R(0.5) * (x * x + y * y)) * (q * q) * m->per_area;
}
LEAF real next_density(const mutual *m, triple wi) {
  return next_density_of(m, wi) + next_density_of(m, folded(m, wi));
}

/* f cos of the specular part, and its density: wi and wo above the surface, no opposites. */
static __attribute__((noinline)) triple mutual_value(const bsdf *b, const mutual *m, triple wi,
                                                     triple wo) {
  const real through = unblocked(m, wi);
  if (!(through > 0))
    return (triple){0, 0, 0};
  const halfway a = halfway_of(b, wi, wo);
  const real once = through * (m->facet[0].weight * facet_value(b, m->facet[0], a, wi) +
                               m->facet[1].weight * facet_value(b, m->facet[1], a, wi));
  const real twice = m->pick > 0 ? next_density(m, wi) : 0;
  const triple f = fresnel(b, a.hwo), g = m->again;
  return (triple){f.x * once + g.x * twice, f.y * once + g.y * twice, f.z * once + g.z * twice};
}

static __attribute__((noinline)) real mutual_density(const bsdf *b, const mutual *m, triple wi,
                                                     triple wo) {
  if (!(height_over(m->map, wi) > 0))
    return 0;
  const halfway a = halfway_of(b, wi, wo);
  const real once = m->facet[0].weight * facet_density(b, m->facet[0], a, wi, wo) +
                    m->facet[1].weight * facet_density(b, m->facet[1], a, wi, wo);
  return (1 - m->pick) * once + (m->pick > 0 ? m->pick * next_density(m, wi) : 0);
}

/* x below nu, with probability u below it under the density (nu - x) exp(-x^2/2): Newton's, kept
 * within what it has seen. */
static real shown_slope(real nu, real u) {
  const real want = u * normal_visible(nu);
  real low = SHADE_FLOAT ? -6 : -9, high = minimum(nu, -low), x = minimum(0, R(0.5) * (low + high));
  for (int step = 0; step < 60 && high - low > R(1e-14); step++) {
    const real density = normal_density(x), over = nu * normal_below(x) + density - want;
    low = over < 0 ? x : low;
    high = over < 0 ? high : x;
    const real next = x - over / maximum((nu - x) * density, R(1e-30));
    const real last = x;
    x = next > low && next < high ? next : R(0.5) * (low + high);
    if (absolute(x - last) <= (SHADE_FLOAT ? R(1e-7) : R(1e-15)))
      break;
  }
  return x;
}

/* A direction by what is met next. */
LEAF drawn draw_next(const mutual *m, real u1, real u2) {
  const real along = shown_slope(m->nu, u1), across = R(1.4142135623730950488) * slope_of(u2, 1, 0);
  const real x = along * m->along.x - across * m->along.y;
  const real y = along * m->along.y + across * m->along.x;
  const triple h = {-(m->map.x + m->low[0] * x), -(m->map.y + m->low[1] * x + m->low[2] * y), 1};
  drawn d = reflected(m->from, h);
  if (height_over(m->map, d.w) < 0)
    d.w = folded(m, d.w);
  return settled(d);
}

/* One by the specular part. */
static __attribute__((noinline)) drawn mutual_draw(const bsdf *b, const mutual *m, triple wo,
                                                   real u1, real u2) {
  const int next = u1 < m->pick;
  u1 = remapped(u1, m->pick, next);
  if (next)
    return draw_next(m, u1, u2);
  const real share = m->facet[0].weight / maximum(m->facet[0].weight + m->facet[1].weight, TINY);
  const int first = u1 < share;
  const facet f = m->facet[first ? 0 : 1];
  u1 = remapped(u1, share, first);
  if (!(f.weight > 0))
    return (drawn){{0, 0, 1}, 1};
  drawn d = settled(draw_proposed(b, f.n, wo, f.coso, u1, u2));
  /* here, for beside a diffuse part there is a density all the same */
  d.lost = dot_of(f.n, d.w) > 0 && height_over(m->map, d.w) > 0 ? d.lost : 1;
  return d;
}

#endif
