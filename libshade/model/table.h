/* SPDX-License-Identifier: Apache-2.0 */
/* What tables of a mixture of lobes (fabric_table.h) say for one pair of light and eye. */
#ifndef SHADE_MODEL_TABLE_H
#define SHADE_MODEL_TABLE_H

#include "fabric_table.h"
#include "random.h"

/* Where a direction lies between vertices: the lower left one, and the rest of the way. */
typedef struct table_spot {
  int32_t at;
  real x, y;
} table_spot;

/*
 * size: the length of (x, y, z); right, top: the last column and row. Of a direction with z <= 0
 * or NaN, some place.
 */
LEAF table_spot table_find(real x, real y, real z, real size, real right, real top, int columns) {
  const real length = root(y * y + z * z), over_x = size + length, over_y = length + z;
  const real inverse = 1 / maximum(over_x * over_y, LEAST_NORMAL); /* of both at once */
  const real px = (1 + x * (over_y * inverse)) * (R(0.5) * right);
  const real py = (1 + y * (over_x * inverse)) * (R(0.5) * top);
  const real i = minimum(maximum(px, 0), right), j = minimum(maximum(py, 0), top);
  const int32_t a = (int32_t)minimum(i, right - 1), b = (int32_t)minimum(j, top - 1);
  const table_spot spot = {a + b * columns, i - (real)a, j - (real)b};
  return spot;
}

/* The integral from 0 to t of min(1, (1 + t) / (1 - t)) within -1 to 1. */
LEAF real table_integral(real t, real one) {
  const real u = minimum(maximum(t, -one), one), down = maximum(-u, 0);
  return u + down * down * SHADE_SEEN(down);
}

/*
 * What a lane has for all strips: h' and d, turned along the fibres as its lobes are; the cosine
 * of h with wo, not quite 0, and its inverse.
 */
typedef struct table_turned {
  real h, hx, hy, d, dx, dy, variance, cosine, per_cosine;
} table_turned;

LEAF table_turned table_turn(real ix, real iy, real iz, real ox, real oy, real oz, real s,
                             real variance) {
  const real hx = R(0.5) * (ix + ox), hy = R(0.5) * (iy + oy), hz = R(0.5) * (iz + oz);
  const real dx = R(0.5) * (ix - ox), dy = R(0.5) * (iy - oy), dz = R(0.5) * (iz - oz);
  const real c = root(maximum(1 - s * s, R(1e-4)));
  const real cosine = maximum(root(hx * hx + hy * hy + hz * hz), R(1e-6));
  const real inverse = 1 / (c * cosine), slope = s * cosine * inverse;
  const table_turned v = {
      s * hx + c * hz, hx - slope * hz, hy,          s * dx + c * dz, dx - slope * dz, dy,
      variance,        cosine,          c * inverse,
  };
  return v;
}

/* Of a strip n.h', then by its inverse t over the strip: the mean, and half an even spread's width,
 * never so narrow that the difference below loses its digits. */
LEAF real table_over(table_turned v, real tilt) {
  return maximum(v.h + tilt * v.hy, R(1e-3) * v.cosine);
}

typedef struct table_strip {
  real t, half;
} table_strip;

LEAF table_strip table_strip_of(table_turned v, real tilt, real spread, real per) {
  const real t = (v.d + tilt * v.dy) * per;
  const real along = (v.dx - t * v.hx) * per, across = (v.dy - t * v.hy) * per;
  const real variance = along * along * v.variance + across * across * spread;
  return (table_strip){t, root(maximum(3 * variance, R(1e-6)))};
}

/* The mean of min(1, n.wi / n.wo) within both horizons over a strip, times twice that half. */
LEAF real table_width(table_strip s, real one) {
  return table_integral(s.t + s.half, one) - table_integral(s.t - s.half, one);
}

/* 1/a, 1/b and 1/c: a division takes as long as ten products. */
LEAF triple inverses(real a, real b, real c) {
  const real ab = a * b, all = 1 / (ab * c);
  return (triple){b * c * all, a * c * all, ab * all};
}

/* What lanes have in common: of three strips, and of all. */
typedef struct table_strips {
  real d[3], tilt[3], spread[3];
} table_strips;

typedef struct table_lobes {
  table_strips low, high;
  real along, variance, one; /* one: 1, as compilers do not know it */
} table_lobes;

/* Of three strips, times their D. */
LEAF real table_three(table_turned v, table_strips s, real d0, real d1, real d2, real bound) {
  const triple per =
      inverses(table_over(v, s.tilt[0]), table_over(v, s.tilt[1]), table_over(v, s.tilt[2]));
  const table_strip a = table_strip_of(v, s.tilt[0], s.spread[0], per.x);
  const table_strip b = table_strip_of(v, s.tilt[1], s.spread[1], per.y);
  const table_strip c = table_strip_of(v, s.tilt[2], s.spread[2], per.z);
  const triple one = inverses(a.half, b.half, c.half);
  return s.d[0] * d0 * (table_width(a, bound) * one.x) +
         s.d[1] * d1 * (table_width(b, bound) * one.y) +
         s.d[2] * d2 * (table_width(c, bound) * one.z);
}

/* spec from the fields at h; 0 beyond a horizon. */
LEAF real table_spec(table_lobes t, const real *restrict f, triple wi, triple wo) {
  const table_turned v =
      table_turn(XYZ(wi), XYZ(wo), t.along * f[FABRIC_ALONG] - 1, t.variance * f[FABRIC_VARIANCE]);
  const real sum = table_three(v, t.low, f[0], f[1], f[2], t.one) +
                   table_three(v, t.high, f[3], f[4], f[5], t.one);
  return minimum(wi.z, wo.z) > 0 ? sum * v.per_cosine : 0;
}
_Static_assert(FABRIC_STRIPS == 6, "as many as are written out above");

/* matt from the factors of light and eye; lowest: the lower of their cosines. */
LEAF real table_matt(const real unit[FABRIC_RANK], const real *restrict a, const real *restrict b,
                     real lowest) {
  const real sum = unit[0] * a[0] * b[0] + unit[1] * a[1] * b[1] +
                   (unit[2] * a[2] * b[2] + unit[3] * a[3] * b[3]);
  return lowest > 0 ? maximum(sum, 0) : 0;
}
_Static_assert(FABRIC_RANK == 4, "as many as are written out above");

#endif
