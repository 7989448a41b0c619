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
  real more; /* of xx and yy, what is there so that grooves have a width */
} relief;

/* Grooves get some width, or the other side of one that is seen along them would be anywhere. */
LEAF relief relief_of(real x, real y, real xx, real xy, real yy) {
  const real more = R(1e-4) * (xx + yy);
  return (relief){x, y, xx + more, xy, yy + more, more};
}

/* Height of a direction over the mean plane, by the shear; the variance of slopes along it. */
LEAF real height_over(relief r, triple w) {
  return multiply_add(-r.y, w.y, multiply_add(-r.x, w.x, w.z));
}
LEAF real variance_along(relief r, triple w) {
  const real x = r.xx * w.x + r.xy * w.y, y = r.xy * w.x + r.yy * w.y;
  return maximum(x * w.x + y * w.y, 0);
}

/* Smith's Lambda of Gaussian slopes, by a rational fit in height / spread, as a fraction: both
 * parts times spread^2; height > 0 and spread^2 twice the variance. [Walter2007] */
typedef struct fraction {
  real over, under;
} fraction;
LEAF fraction relief_lambda(real height, real variance) {
  const real spread2 = 2 * variance, both = root(spread2) * height, height2 = height * height;
  const real over = spread2 - R(1.259) * both + R(0.396) * height2;
  return (fraction){height2 < R(2.56) * spread2 ? maximum(over, 0) : 0,
                    R(3.535) * both + R(2.181) * height2};
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

/* What the eye sees: the other side of the bump, and the share of the facet given; 1 + Lambda(wo).
 */
typedef struct sides {
  triple other;
  real share, above;
} sides;
LEAF sides sides_of(relief r, triple n, triple wo) {
  const real per = 1 / maximum(n.z, R(1e-6)), sx = -n.x * per, sy = -n.y * per;
  const real height = height_over(r, wo), variance = variance_along(r, wo);
  const real area = area_shown(height, root(variance));
  const real shown = multiply_add(-sy, wo.y, multiply_add(-sx, wo.x, wo.z)); /* p */
  const int seen = !(variance >= R(1e-10)) | !(shown < area);
  const real share = maximum(shown / area, 0), step = 2 * (area - shown) / (variance + TINY);
  const real x = multiply_add(step, r.xx * wo.x + r.xy * wo.y, -sx);
  const real y = multiply_add(step, r.xy * wo.x + r.yy * wo.y, -sy);
  const real length = 1 / root(x * x + y * y + 1);
  const fraction masked = relief_lambda(maximum(height, R(1e-7) * root(2 * variance)), variance);
  sides s = {{seen ? n.x : x * length, seen ? n.y : y * length, seen ? n.z : length},
             seen ? 1 : share,
             1 + masked.over / maximum(masked.under, TINY)};
  return s;
}

/* Share of the light from wi that other bumps let through; above: 1 + Lambda(wo). */
LEAF real unblocked(relief r, real above, triple wi) {
  const real height = height_over(r, wi);
  const fraction masked = relief_lambda(height, variance_along(r, wi));
  const real through = above * masked.under / maximum(above * masked.under + masked.over, TINY);
  return height > 0 ? through : 0;
}

/* What is kept back of the light, all that a facet reflects, and the former's mean direction. */
typedef struct kept_back {
  real share, all, x, y, z;
} kept_back;

/* With a direction more, of which g is reflected. */
LEAF kept_back kept_more(kept_back sum, relief r, real above, triple w, real g) {
  const real back = g * (1 - unblocked(r, above, w));
  return (kept_back){sum.share + back, sum.all + g, multiply_add(back, w.x, sum.x),
                     multiply_add(back, w.y, sum.y), multiply_add(back, w.z, sum.z)};
}

/* Twice a facet's own covariance of slopes, of one axis; at most that of alpha 2. */
LEAF real facet_variance(int exponents, real k) {
  return minimum((exponents ? 2 : R(1.0)) / maximum(k, R(1e-3)), 4);
}

/* A side in its frame: the axes, whose z is its normal, and the eye in them; its roots of own; for
 * microfacet 1 + 2 Lambda of the eye, and 1 over the sum of what it sees of four facets. */
typedef struct posed {
  axes along;
  triple n, eye;
  real x, y, lo, per_seen;
} posed;

/* What direction the facet of the slopes -hx and -hy in that frame reflects, and how much of it. */
LEAF kept_back kept_by(kept_back sum, shade_mdf mdf, shade_brdf brdf, int projected, relief r,
                       real above, posed p, real share, real hx, real hy) {
  const triple o = p.eye;
  const real size = root(1 + (hx * hx + hy * hy)), per = 1 / size;
  const real up = maximum(o.z + (hx * o.x + hy * o.y), 0), twice = 2 * up * (per * per);
  const triple l = {twice * hx - o.x, twice * hy - o.y, twice - o.z};
  real g;
  if (brdf == SHADE_BRDF_MICROFACET) {
    const real tx = p.x * l.x, ty = p.y * l.y;
    const real li = smith_value(mdf, (tx * tx + ty * ty) / maximum(l.z * l.z, TINY));
    g = up * p.per_seen * (1 + p.lo) / (li + p.lo);
  } else {
    const real hwo = up * per;
    const real per_density = hwo * (projected ? size : 1);
    g = brdf_value(brdf, 1, (angles){hwo, l.z, o.z, 0, 0}) * l.z * per_density;
  }
  const int lit = (l.z > 0) & (o.z > 0) & (up > 0);
  g = lit ? share * g : 0;
  const triple w = {l.x * p.along.x.x + l.y * p.along.y.x + l.z * p.n.x,
                    l.x * p.along.x.y + l.y * p.along.y.y + l.z * p.n.y,
                    l.x * p.along.x.z + l.y * p.along.y.z + l.z * p.n.z};
  return kept_more(sum, r, above, w, g);
}

/* How far facets are off a side, in roots of `own`: two the way in which the height of what they
 * reflect changes most, and two across it. Gaussian ones give what is kept back the right mean over
 * maps of slope .3 to 1.4, at alpha .05 to .7. GGX has no variance: its are a little farther off,
 * where compare/steep_bumps.py comes out nearest. */
LEAF pair off_facets(shade_mdf mdf) {
  return mdf == SHADE_MDF_GGX ? (pair){R(1.8), R(0.9)} : (pair){R(0.97), R(0.62)};
}

/*
 * By four facets of a side. All of D is in where they lie: each counts as f cos over the density
 * of its draw, of visible normals for microfacet.
 */
LEAF kept_back kept_of(kept_back sum, shade_mdf mdf, shade_brdf brdf, int projected, relief r,
                       real above, axes along, triple n, triple wo, pair own, real share) {
  const triple o = {dot_of(along.x, wo), dot_of(along.y, wo), dot_of(n, wo)};
  const real x = root(own.x), y = root(own.y), up = height_over(r, n);
  const real gx = x * (up * o.x + o.z * height_over(r, along.x));
  const real gy = y * (up * o.y + o.z * height_over(r, along.y));
  const real g2 = gx * gx + gy * gy, per = 1 / root(g2 + TINY);
  const int even = !(g2 > R(1e-12));
  const pair way = {even ? 1 : gx * per, even ? 0 : gy * per}, off = off_facets(mdf);
  const real ax = off.x * way.x * x, ay = off.x * way.y * y;
  const real bx = -off.y * way.y * x, by = off.y * way.x * y;
  posed p = {along, n, o, x, y, 0, 0};
  if (brdf == SHADE_BRDF_MICROFACET) {
    const real tx = x * o.x, ty = y * o.y, a = ax * o.x + ay * o.y, b = bx * o.x + by * o.y;
    real seen = maximum(o.z + a, 0) + maximum(o.z - a, 0);
    seen += maximum(o.z + b, 0) + maximum(o.z - b, 0);
    p.lo = smith_value(mdf, (tx * tx + ty * ty) / maximum(o.z * o.z, TINY));
    p.per_seen = 1 / maximum(seen, TINY);
  }
  sum = kept_by(sum, mdf, brdf, projected, r, above, p, share, ax, ay);
  sum = kept_by(sum, mdf, brdf, projected, r, above, p, share, -ax, -ay);
  sum = kept_by(sum, mdf, brdf, projected, r, above, p, share, bx, by);
  return kept_by(sum, mdf, brdf, projected, r, above, p, share, -bx, -by);
}

/* The frame of those facets: as the lobe is drawn in, a rigid one. */
LEAF shade_map frame_of_sides(const bsdf *b) {
  return shade_map_is(b->carry.frame).kind == SHADE_RIGID ? b->carry.frame : SHADE_MAP_SHORTEST_ARC;
}

/* The lobe of what is met next. */
typedef struct next_lobe {
  triple from;           /* where that is seen from */
  real first, low, last; /* the lower triangle of its slopes' covariance; */
  real per_area;         /* 1 over all but the exponential of its density */
} next_lobe;

/* Where the eye of a lobe stands, in terms of its slopes: azimuth, their spread along it, and its
 * height in units of that. */
typedef struct standing {
  pair along;
  real spread, nu;
} standing;
LEAF standing standing_of(relief r, next_lobe m) {
  const real x = m.first * m.from.x + m.low * m.from.y, y = m.last * m.from.y;
  const real spread = root(x * x + y * y), per = 1 / maximum(spread, R(1e-12));
  const int flat = !(spread > R(1e-12));
  const real safe = maximum(spread, R(1e-6));
  return (standing){
      {flat ? 1 : x * per, y * per}, safe, maximum(height_over(r, m.from) / safe, R(-2.5))};
}

/* From the mean direction of what is kept back; own: of the facets' own slopes. Grooves all but
 * cancel in the determinant: they are told apart from what they got. */
LEAF next_lobe next_of(relief r, pair own, triple mean) {
  const real more = r.more;
  const real ex = more + own.x, ey = more + own.y, x0 = r.xx - more, y0 = r.yy - more;
  const real grooves = maximum(difference(x0, y0, r.xy, r.xy), 0);
  next_lobe m;
  m.first = root(x0 + ex);
  m.low = r.xy / m.first;
  m.last = root(grooves + (x0 * ey + (y0 * ex + ex * ey))) / m.first;
  const real size = 1 / root(dot_of(mean, mean) + TINY);
  triple c = {-mean.x * size, -mean.y * size, -mean.z * size};
  const int sheer = c.x * c.x + c.y * c.y < R(1e-12); /* no azimuth: that of x */
  c.x = sheer ? R(1e-6) : c.x;
  c.y = sheer ? 0 : c.y;
  const real x = m.first * c.x + m.low * c.y, y = m.last * c.y;
  const real least = r.x * c.x + r.y * c.y - R(2.5) * root(x * x + y * y);
  const int under = c.z < least; /* so far below nothing shows */
  c.z = under ? least : c.z;
  const real again = under ? 1 / root(dot_of(c, c) + TINY) : 1;
  m.from = (triple){c.x * again, c.y * again, c.z * again};
  const standing at = standing_of(r, m);
  m.per_area = R(0.039788735772973833942) /* 1/(8 pi) */ /
               (m.first * m.last * (at.spread * normal_visible(at.nu)));
  return m;
}

/* The share of the draws that go there, and its colour by F's mean: no more than facets reflect
 * again. */
LEAF real next_pick(real share) {
  return share > R(1e-9) ? minimum(share, R(0.9)) : 0;
}
LEAF real next_colour(kept_back kept, real mean) {
  return kept.share > R(1e-9) ? mean * mean * kept.share * minimum(kept.all, 1) : 0;
}

typedef struct mutual {
  relief map;
  real above;     /* 1 + Lambda(wo) */
  facet facet[2]; /* the one given, and the other side of the bump, by their shares */
  real pick;      /* share of the draws of what is met next */
  triple again;   /* its colour */
  next_lobe next;
} mutual;

LEAF facet facet_of(const bsdf *b, triple n, triple wo, real weight) {
  facet f = {n, dot_of(n, wo), 0, weight};
  f.weight = f.coso > 0 ? f.weight : 0;
  if (f.weight > 0 && b->brdf == SHADE_BRDF_MICROFACET)
    f.lo = smith(b, n, wo);
  return f;
}

/* n and wo are mended, wo.z > 0, and the map has slopes. */
static __attribute__((noinline)) void prepare_mutual(const bsdf *b, triple n, triple wo,
                                                     mutual *m) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  m->map =
      relief_of(own->slopes[0], own->slopes[1], own->slopes[2], own->slopes[3], own->slopes[4]);
  const sides s = sides_of(m->map, n, wo);
  m->above = s.above;
  m->facet[0] = facet_of(b, n, wo, s.share);
  m->facet[1] = facet_of(b, s.other, wo, 1 - s.share);
  const pair at = {facet_variance(b->exponents, own->kx), facet_variance(b->exponents, own->ky)};
  kept_back kept = {0, 0, 0, 0, 0};
  for (int k = 0; k < 2; k++)
    kept = kept_of(kept, b->mdf, b->brdf, b->projected, m->map, m->above,
                   axes_of(frame_of_sides(b), m->facet[k].n), m->facet[k].n, wo, at,
                   m->facet[k].weight);
  m->pick = next_pick(kept.share);
  m->next = next_of(m->map, at, (triple){kept.x, kept.y, kept.z});
  real colour[3];
  for (int c = 0; c < 3; c++)
    colour[c] = next_colour(kept, fresnel_mean(b->fresnel, own->f0[c], own->tint[c], own->k[c]));
  m->again = (triple){colour[0], colour[1], colour[2]};
}

/* w mirrored at the mean plane. */
LEAF triple folded(relief r, triple w) {
  const real twice = 2 * height_over(r, w) / (1 + r.x * r.x + r.y * r.y);
  return (triple){w.x + twice * r.x, w.y + twice * r.y, w.z - twice};
}

/* Density of w by what is met next, over the whole sphere. */
LEAF real next_density_of(relief r, next_lobe m, triple w) {
  const triple h = {m.from.x + w.x, m.from.y + w.y, m.from.z + w.z};
  const real hh = dot_of(h, h);
  const int shown = (h.z > 0) & (h.z * h.z > R(1e-10) * hh);
  const real per = shown ? 1 / h.z : 1, q = hh * (per * per);
  const real x = (-h.x * per - r.x) / m.first;
  const real y = (-h.y * per - r.y - m.low * x) / m.last;
  const real density = exp_negative(R(0.5) * (x * x + y * y)) * (q * q) * m.per_area;
  return shown ? density : 0;
}
LEAF real next_density(relief r, next_lobe m, triple wi) {
  return next_density_of(r, m, wi) + next_density_of(r, m, folded(r, wi));
}

/* f cos of the specular part, and its density: wi and wo above the surface, no opposites. */
static __attribute__((noinline)) triple mutual_value(const bsdf *b, const mutual *m, triple wi,
                                                     triple wo) {
  const real through = unblocked(m->map, m->above, wi);
  if (!(through > 0))
    return (triple){0, 0, 0};
  const halfway a = halfway_of(b, wi, wo);
  const real once = through * (m->facet[0].weight * facet_value(b, m->facet[0], a, wi) +
                               m->facet[1].weight * facet_value(b, m->facet[1], a, wi));
  const real twice = m->pick > 0 ? next_density(m->map, m->next, wi) : 0;
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
  return (1 - m->pick) * once + (m->pick > 0 ? m->pick * next_density(m->map, m->next, wi) : 0);
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
LEAF drawn draw_next(relief r, next_lobe m, real u1, real u2) {
  const standing at = standing_of(r, m);
  const real along = shown_slope(at.nu, u1), across = R(1.4142135623730950488) * slope_of(u2, 1, 0);
  const real x = along * at.along.x - across * at.along.y;
  const real y = along * at.along.y + across * at.along.x;
  const triple h = {-(r.x + m.first * x), -(r.y + m.low * x + m.last * y), 1};
  drawn d = reflected(m.from, h);
  if (height_over(r, d.w) < 0)
    d.w = folded(r, d.w);
  return settled(d);
}

/* One by the specular part. */
static __attribute__((noinline)) drawn mutual_draw(const bsdf *b, const mutual *m, triple wo,
                                                   real u1, real u2) {
  const int next = u1 < m->pick;
  u1 = remapped(u1, m->pick, next);
  if (next)
    return draw_next(m->map, m->next, u1, u2);
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
