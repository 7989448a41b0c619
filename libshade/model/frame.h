/* SPDX-License-Identifier: Apache-2.0 */
/* The frames that half vectors are drawn in, and the way through a warp. */
#ifndef SHADE_MODEL_FRAME_H
#define SHADE_MODEL_FRAME_H

#include "brdf.h"
#include "detail.h"

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

/* The same by name; those of z for any other. */
LEAF axes axes_of(shade_map frame, triple n) {
  switch (frame) {
#define AXES_CASE(NAME, name)                                                                      \
  case SHADE_MAP_##NAME:                                                                           \
    return axes_##name(XYZ(n));
    SHADE_FRAME_ROWS(AXES_CASE)
#undef AXES_CASE
  default:
    return (axes){{1, 0, 0}, {0, 1, 0}};
  }
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

/* The half vector h of any length, through a warp. */
LEAF triple warped(int smooth, triple n, triple h) {
  const real scale = scale_to_unit(XYZ(h)), x = h.x * scale, y = h.y * scale, z = h.z * scale;
  real w = z * z / (1 + root(x * x + y * y));
  if (smooth) {
    real v = warp_start(n.x, n.y, x, y);
#if defined(__GNUC__) /* or the loop around it stays scalar */
#pragma GCC unroll 16
#endif
    for (int step = 0; step < warp_steps; step++)
      v = warp_step(n.x, n.y, x, y, v);
    w = 1 - v;
  }
  return warp_shifted(n.x, n.y, x, y, w);
}

/* x and y of a direction in a rigid frame. */
LEAF pair into_frame(shade_map frame, triple n, triple w) {
  const axes f = axes_of(frame, n);
  return (pair){f.x.x * w.x + f.x.y * w.y + f.x.z * w.z, f.y.x * w.x + f.y.y * w.y + f.y.z * w.z};
}

/* From the frame that half vectors are drawn in to the local one. */
LEAF triple out_of_frame(shade_map frame, triple n, triple h) {
  if (frame == SHADE_MAP_NONE)
    return h;
  if (shade_map_is(frame).kind != SHADE_RIGID)
    return warped(frame == SHADE_MAP_DEFORM_SMOOTH, n, h);
  const axes f = axes_of(frame, n);
  return (triple){f.x.x * h.x + f.y.x * h.y + n.x * h.z, f.x.y * h.x + f.y.y * h.y + n.y * h.z,
                  f.x.z * h.x + f.y.z * h.y + n.z * h.z};
}

#endif
