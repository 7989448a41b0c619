/* SPDX-License-Identifier: Apache-2.0 */
/* The frames that half vectors are drawn in, and the way through a warp. */
#ifndef SHADE_MODEL_FRAME_H
#define SHADE_MODEL_FRAME_H

#include "detail.h"
#include "random.h"

/* The axes x' and y' of the carried frame; its z' is n. */
typedef struct axes {
  triple x, y;
} axes;

/* x' = (nz, 0, -nx)/L and n x x'. */
LEAF axes axes_rotate_x(real nx, real ny, real nz) {
  real scale = rotate_scale(nx, nz);
  real a = nx * scale, c = nz * scale;
  real inverse = 1 / root(maximum(a * a + c * c, TINY));
  axes f = {{c * inverse, 0, -a * inverse}, {0, 0, 0}};
  f.y.x = ny * f.x.z;
  f.y.y = nz * f.x.x - nx * f.x.z;
  f.y.z = -ny * f.x.x;
  return f;
}

LEAF axes axes_rotate_y(real nx, real ny, real nz) {
  axes f = axes_rotate_x(ny, nx, nz);
  axes g = {{f.y.y, f.y.x, f.y.z}, {f.x.y, f.x.x, f.x.z}};
  return g;
}

LEAF axes axes_shortest_arc(real nx, real ny, real nz) {
  real turn = 1 / (1 + nz), off = -nx * ny * turn;
  axes f = {{1 - nx * nx * turn, off, -nx}, {off, 1 - ny * ny * turn, -ny}};
  return f;
}

/*
 * Where a warp takes the point p of the disc, the inverse of detail_deform_*: p' = p + w delta.
 * Linear: w = 1 - |p|. Smooth: w = 1 - v with v (2 - v) = |p + v (1 - v) delta|, to whose
 * least root Newton climbs from below.
 */
enum { warp_steps = SHADE_FLOAT ? 7 : 9 };

LEAF real warp_start(real nx, real ny, real x, real y) {
  return root(x * x + y * y) / (2 + root(nx * nx + ny * ny));
}

LEAF real warp_step(real nx, real ny, real x, real y, real v) {
  real shift = v * (1 - v);
  real ex = x + shift * nx, ey = y + shift * ny;
  real size = root(ex * ex + ey * ey);
  real lean = (ex * nx + ey * ny) / maximum(size, R(1e-18));
  real slope = maximum(2 - 2 * v - (1 - 2 * v) * lean, R(1e-4));
  return maximum(minimum(v - (v * (2 - v) - size) / slope, 1), 0);
}

LEAF triple warp_shifted(real nx, real ny, real x, real y, real w) {
  x += w * nx;
  y += w * ny;
  triple h = {x, y, root(maximum(1 - x * x - y * y, 0))};
  return h;
}

#endif
