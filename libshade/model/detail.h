/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Where the half vector lies in the carried distribution, for a perturbed normal n.
 *
 * h need not be unit, except for the warps: only its direction counts. The tangents come from cross
 * products, because 1 - (n.h)^2 and h_y - n_y (n.h) cancel (docs/theory/conventions.md, Detail).
 *
 * test/test_leaves.c holds the errors of the slopes sqrt(xx) and sqrt(yy) of lobe_at over 1 + t,
 * against the reference on the same inputs. With a cosine to the carried pole >= 0.05 and tilts to
 * 89.9 degrees they are 2e-7 in float and 4e-16 in double, worst at the largest tilts. For the
 * warps (cosine >= 0.5, tilts to 75 degrees) they are 5e-7 and 1.5e-15, worst near their rim. mdf.h
 * states what becomes of them in D.
 */
#ifndef SHADE_MODEL_DETAIL_H
#define SHADE_MODEL_DETAIL_H

#include "elementary.h"
#include "methods.h"
#include "random.h"

/*
 * h in the carried frame before any division, to a scale of its own: squared components along x
 * and y, squared sine and cosine of the angle to the pole. ss is xx + yy but for perturb and
 * rotate_ratio. D' = 0 where h is not above the carried horizon.
 */
typedef struct lobe_ratio {
  real xx, yy, ss, zz;
  int above;
} lobe_ratio;

/*
 * The same as slopes, which is what the distributions of slopes need:
 *   t       tan^2 of the angle between h and the pole; -1 where h is not above the horizon
 *   xx, yy  squares of the slope along x and y
 */
typedef struct lobe_point {
  real t, xx, yy;
} lobe_point;

LEAF lobe_point lobe_at(lobe_ratio r) {
  real inverse = 1 / (r.zz + TINY);
  lobe_point p = {-1, r.xx * inverse, r.yy * inverse};
  p.t = r.above ? r.ss * inverse : -1;
  return p;
}

/* With the sine that x and y make up. */
LEAF lobe_ratio lobe_of(real x, real y, real zz, int above) {
  lobe_ratio r = {x * x, y * y, x * x + y * y, zz, above};
  return r;
}

/* n x h, whose length is the sine, and n . h. */
typedef struct cross_and_dot {
  real x, y, z, d;
} cross_and_dot;

LEAF cross_and_dot cross_and_dot_of(real nx, real ny, real nz, real hx, real hy, real hz) {
  cross_and_dot c;
  c.x = difference(ny, hz, nz, hy);
  c.y = difference(nz, hx, nx, hz);
  c.z = difference(nx, hy, ny, hx);
  c.d = dot(nx, ny, nz, hx, hy, hz);
  return c;
}

/* With the sine of the angle to n itself, on which xx and yy have no say. */
LEAF lobe_ratio lobe_around(cross_and_dot c, real xx, real yy) {
  lobe_ratio r = {xx, yy, c.x * c.x + c.y * c.y + c.z * c.z, c.d * c.d, c.d > 0};
  return r;
}

/* The perturbed normal is ignored. */
LEAF lobe_ratio detail_none(real nx, real ny, real nz, real hx, real hy, real hz) {
  (void)nx, (void)ny, (void)nz;
  return lobe_of(hx, hy, hz * hz, hz > 0);
}

/*
 * Plain normal mapping: the polar angle from n, the azimuth from the unperturbed
 * frame. This form is for Ashikhmin-Shirley, which reads only the ratio of xx and yy
 * and takes cos^2 = 1/2 where both are 0: they have a scale of their own here.
 */
LEAF lobe_ratio detail_perturb_ratio(real nx, real ny, real nz, real hx, real hy, real hz) {
  return lobe_around(cross_and_dot_of(nx, ny, nz, hx, hy, hz), hx * hx, hy * hy);
}

/*
 * The same as slopes, for lobe_at. Over the unperturbed pole the azimuth is undefined and
 * cos^2 = 1/2 stands for it.
 */
LEAF lobe_ratio detail_perturb(real nx, real ny, real nz, real hx, real hy, real hz) {
  lobe_ratio r = detail_perturb_ratio(nx, ny, nz, hx, hy, hz);
  real share = r.ss / (r.xx + r.yy + TINY);
  r.xx = (r.xx + R(0.5) * TINY) * share;
  r.yy = (r.yy + R(0.5) * TINY) * share;
  return r;
}

/*
 * What to multiply nx and nz by so that near L = 0 their squares do not underflow: only the
 * ratio nx : nz matters to the axes.
 */
LEAF real rotate_scale(real nx, real nz) {
#if SHADE_FLOAT
  const real small = 0x1p-40f, step = 0x1p40f;
#else
  const real small = 0x1p-300, step = 0x1p300;
#endif
  real size = maximum(absolute(nx), nz);
  real scale = size < small ? step : 1;
  return size * scale < small ? scale * step : scale;
}

/*
 * Groove transport: the frame whose x' = (nz, 0, -nx)/L is dP/du of the height
 * field with normal n, L^2 = nx^2 + nz^2. [KangCho Eq. 9, sign corrected:
 * docs/theory/conventions.md, Detail] Grooves along y, and Gram-Schmidt, are this with x and y
 * exchanged.
 */
LEAF lobe_ratio detail_rotate(real nx, real ny, real nz, real hx, real hy, real hz) {
  real scale = rotate_scale(nx, nz);
  real a = nx * scale, c = nz * scale;
  real x = difference(c, hx, a, hz);
  real y = dot2(a, c, difference(nx, hy, ny, hx), difference(nz, hy, ny, hz));
  real d = dot(nx, ny, nz, hx, hy, hz);
  return lobe_of(x, y, (a * a + c * c) * (d * d), d > 0);
}

/* The smallest rotation that brings z to n, applied to n x h: its sine is kept, not lost. */
LEAF lobe_ratio detail_shortest_arc(real nx, real ny, real nz, real hx, real hy, real hz) {
  cross_and_dot c = cross_and_dot_of(nx, ny, nz, hx, hy, hz);
  real turn = c.z / (1 + nz);
  real x = multiply_add(-ny, turn, c.y), y = multiply_add(-nx, turn, c.x);
  return lobe_of(x, y, c.d * c.d, c.d > 0);
}

/*
 * `rotate` without the division of x and y by L, so that xx + yy = L^2 t: all that
 * Ashikhmin-Shirley, which sees their ratio only, needs of it. Read as slopes it is the paper's
 * fast form, sign corrected: rotate_approximate.
 */
LEAF lobe_ratio detail_rotate_ratio(real nx, real ny, real nz, real hx, real hy, real hz) {
  cross_and_dot c = cross_and_dot_of(nx, ny, nz, hx, hy, hz);
  real y = difference(nx, c.z, nz, c.x);
  return lobe_around(c, c.y * c.y, y * y);
}

/*
 * Both warps move the point p' = (hx, hy) of the unit disc by delta = (nx, ny) at the lobe's
 * centre and not at all at the rim; h is unit here. u is 1 less the paper's weight w,
 * taken from whichever root does not cancel. Errors of D: methods.h. [KangChoKim2011 Eq. 3-5]
 */
LEAF real warp_fraction(real nx, real ny, real nz, real x, real y) {
  real a = dot2(x, y, x, y);
  real b = dot2(nx, ny, x, y);
  real c = nz * nz;
  real s = root(dot2(b, a, b, c));
  real sum = absolute(b) + s;
  real top = b >= 0 ? sum : a;
  real bottom = b >= 0 ? c : sum;
  /* u > 1 is outside anyway; this floor keeps it from overflowing as nz -> 0 */
  return top / maximum(bottom, R(0.5) * top + TINY);
}

/* Weight w: |p| is u itself. */
LEAF lobe_ratio detail_deform_linear(real nx, real ny, real nz, real hx, real hy, real hz) {
  real x = hx - nx, y = hy - ny;
  real u = warp_fraction(nx, ny, nz, x, y);
  x = multiply_add(u, nx, x);
  y = multiply_add(u, ny, y);
  return lobe_of(x, y, absolute((1 - u) * (1 + u)), (u < 1) & (hz > 0));
}

/* Weight sqrt(w); p may leave the disc, where D' = 0. */
LEAF lobe_ratio detail_deform_smooth(real nx, real ny, real nz, real hx, real hy, real hz) {
  real x = hx - nx, y = hy - ny;
  real u = minimum(warp_fraction(nx, ny, nz, x, y), 1);
  real shift = u / (1 + root(1 - u));
  x = multiply_add(shift, nx, x);
  y = multiply_add(shift, ny, y);
  real zz = 1 - dot2(x, y, x, y);
  return lobe_of(x, y, absolute(zz), (zz > 0) & (hz > 0));
}

/*
 * What makes a warped distribution conserve energy: the Jacobian of the warp, J = 1 +
 * delta.p/s for the linear one (p the linear p) and 1 + delta.p/(2 s sqrt(1 - u)) for the
 * smooth one, times hz over the cosine in which D is normalised: z of the moved h, or n.h
 * where D is a projected one (Beckmann, GGX). At h = n, where J depends on the way there,
 * it is taken as 1. Relative error as the warps'.
 */
LEAF real warp_stretch(real nx, real ny, real nz, real hx, real hy, real hz, int smooth,
                       int projected) {
  const real rim = R(1e-9); /* the least cosine: keeps the result finite */
  real x = hx - nx, y = hy - ny;
  real u = warp_fraction(nx, ny, nz, x, y);
  real b = dot2(nx, ny, x, y);
  real s = root(dot2(b, dot2(x, y, x, y), b, nz * nz));
  real fade = root(absolute(1 - u)); /* u > 1 is outside, as zz < 0: D' is 0 there */
  real along = multiply_add(u, dot2(nx, ny, nx, ny), b); /* delta . p_linear */
  /* 1 where s, and with it `along`, is 0; twice TINY, for rim times it is divided by */
  real under = (smooth ? 2 * s * fade : s) + 2 * TINY;
  real grown = maximum(minimum(under + along, R(1e9) * under), 0); /* J under */
  real shift = smooth ? u / (1 + fade) : u;
  x = multiply_add(shift, nx, x);
  y = multiply_add(shift, ny, y);
  real zz = smooth ? 1 - dot2(x, y, x, y) : (1 - u) * (1 + u);
  real z = projected ? dot(nx, ny, nz, hx, hy, hz) : root(absolute(zz));
  real lit = (smooth || projected) && !(z > 0) ? 0 : maximum(hz, 0);
  return grown * lit / (under * maximum(z, rim));
}

/* x and y in each other's place. */
LEAF lobe_ratio swapped(lobe_ratio r) {
  return (lobe_ratio){r.yy, r.xx, r.ss, r.zz, r.above};
}

/* h by a map, for grooves along x or y. */
LEAF lobe_ratio detail(shade_map map, triple n, triple h) {
  switch (map) {
#define MAP_CASE(NAME, leaf, along_y, kind, frame)                                                 \
  case SHADE_MAP_##NAME:                                                                           \
    return along_y ? swapped(detail_##leaf(n.y, n.x, n.z, h.y, h.x, h.z))                          \
                   : detail_##leaf(n.x, n.y, n.z, h.x, h.y, h.z);
    SHADE_MAP_ROWS(MAP_CASE)
#undef MAP_CASE
  case SHADE_MAP_COUNT:
    break;
  }
  return detail_none(n.x, n.y, n.z, h.x, h.y, h.z);
}

#endif
