/* SPDX-License-Identifier: Apache-2.0 */
/* What one yarn of a cloth does with light. */
#ifndef SHADE_MODEL_YARN_H
#define SHADE_MODEL_YARN_H

#include "brdf.h"
#include "detail.h"
#include "diffuse.h"
#include "fabric.h"
#include "mdf.h"
#include "random.h"

#define INVERSE_PI R(0.31830988618379067154)

/* 1 where lit from in front, -1 from behind, else 0; by the cosines about n and z. */
LEAF real side_of(real ci, real co, real iz, real oz) {
  real seen = minimum(co, oz);
  real front = minimum(minimum(ci, iz), seen);
  real behind = minimum(minimum(-ci, -iz), seen);
  return front > 0 ? R(1.0) : behind > 0 ? R(-1.0) : R(0.0);
}

/*
 * w in the frame that groove transport makes of n for yarns along axis k (0: x, 1: y), turned
 * about n so that x runs along (tx, ty). That axis keeps its plane, as dP/du and dP/dv do when
 * the surface is displaced. For warp x and y are exchanged before and after.
 */
typedef struct carrier {
  real ax, az, bx, by, bz, nx, ny, nz, tx, ty; /* the axis in its plane, and n x axis */
} carrier;

LEAF carrier carrier_of(real nx, real ny, real nz, real tx, real ty) {
  real size = root(nx * nx + nz * nz);
  real inverse = 1 / maximum(size, R(1e-30));
  real x = size > 0 ? nz * inverse : 1, z = size > 0 ? -nx * inverse : 0;
  carrier f = {x, z, ny * z, nz * x - nx * z, -ny * x, nx, ny, nz, tx, ty};
  return f;
}

/* n is z. */
LEAF carrier carrier_flat(real tx, real ty) {
  return (carrier){1, 0, 0, 1, 0, 0, 0, 1, tx, ty};
}

/* (x, y, z) of the surface to the frame of the fibres, all with x along the yarns' axis. */
LEAF triple carry(carrier f, real x, real y, real z) {
  real along = f.ax * x + f.az * z;
  real across = f.bx * x + f.by * y + f.bz * z;
  triple w = {f.tx * along + f.ty * across, f.tx * across - f.ty * along,
              f.nx * x + f.ny * y + f.nz * z};
  return w;
}

LEAF triple carry_back(carrier f, real x, real y, real z) {
  real along = f.tx * x - f.ty * y, across = f.tx * y + f.ty * x;
  triple w = {f.ax * along + f.bx * across + f.nx * z, f.by * across + f.ny * z,
              f.az * along + f.bz * across + f.nz * z};
  return w;
}

/* Schlick's Fresnel by its white share. */
LEAF real whitened(real f0, real white) {
  return f0 + (1 - f0) * white;
}

/* Ashikhmin and Shirley's yarns, carried by `rotate`: those of nearly all cloths. */
static int is_usual(const bsdf *b) {
  return b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY && b->brdf == SHADE_BRDF_ASHIKHMIN_SHIRLEY &&
         b->carry.map == SHADE_MAP_ROTATE_RATIO_X && !b->fibres_along_y && !b->conserve;
}

/* f of such a lobe, without Fresnel; h: wi + wo. */
LEAF real usual_lobe(triple n, triple h, real kx, real ky, real peak, angles a) {
  const lobe_ratio at = detail_rotate_ratio(XYZ(n), XYZ(h));
  return brdf_ashikhmin_shirley(ashikhmin_shirley_ratio(at, kx, ky, peak), a);
}

/* Diffuse light from behind about the yarn's normal, by the cosines of light and eye about it. */
LEAF real let_through(real light, real co) {
  const real ci = -light;
  const real share = let_in_and_out(maximum(ci, 0), maximum(co, 0));
  return minimum(ci, co) > 0 ? ci * INVERSE_PI * share : 0;
}

/*
 * Less gloss is more variance, by what the yarn's own lobe gains: the exponent e of one becomes
 * gloss e, that of a wider lobe w follows by 1/w' = 1/w + (1/gloss - 1)/e; squares of alphas add.
 */
typedef struct dulling {
  int exponents;
  real x, y, per_x, per_y; /* w and w/e; or both alphas squared */
} dulling;

LEAF dulling dulling_of(const fabric_side *s, fabric_lobe which) {
  const shade_params *yarn = &s->made_of[FABRIC_NEAR], *lobe = &s->made_of[which];
  if (shade_mdf_reads_exponents(lobe->mdf))
    return (dulling){1, (real)lobe->ex, (real)lobe->ey,
                     (real)(yarn->ex > 0 ? lobe->ex / yarn->ex : 0),
                     (real)(yarn->ey > 0 ? lobe->ey / yarn->ey : 0)};
  return (dulling){0, (real)(lobe->ax * lobe->ax), (real)(lobe->ay * lobe->ay),
                   (real)(yarn->ax * yarn->ax), (real)(yarn->ay * yarn->ay)};
}

/* Exponents or alphas for a gloss of [0, 1], within the ranges of parameters. */
LEAF pair dulled(dulling d, real gloss) {
  const real more = 1 / maximum(gloss, R(1e-6)) - 1;
  return d.exponents ? (pair){d.x / (1 + more * d.per_x), d.y / (1 + more * d.per_y)}
                     : (pair){root(minimum(d.x + more * d.per_x, 100)),
                              root(minimum(d.y + more * d.per_y, 100))};
}

typedef struct faced {
  real nx, ny, nz, vx, vy;
} faced;

/*
 * What share of tilts, even about their mean, faces w: the single lobe's stand-in for the
 * horizons of the yarns that turn away.
 */
LEAF real facing(faced f, real x, real y, real z) {
  real reach = root(3 * (f.vx * x * x + f.vy * y * y)), c = f.nx * x + f.ny * y + f.nz * z;
  real part = R(0.5) * (1 + c / maximum(reach, R(1e-20)));
  return c >= reach ? 1 : maximum(part, 0);
}

LEAF faced faced_of(const fabric_side *s) {
  return (faced){s->one.SUFFIX(x)[0], s->one.SUFFIX(y)[0], s->one.SUFFIX(z)[0], (real)s->spread[0],
                 (real)s->spread[1]};
}

#endif
