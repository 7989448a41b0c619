/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The microfacet BRDF of GGX in one loop, for the methods whose frame is a rotation: with
 * X, Y = L x, L y the unnormalised slopes of `rotate`'s leaf and c = n.w,
 *   D = peak ((L^2 |h|^2)/(L^2 (n.h)^2 + kx X^2 + ky Y^2))^2,
 *   1 + 2 Lambda(w) = S(w)/(L c), S(w)^2 = L^2 c^2 + ax^2 X^2 + ay^2 Y^2,
 *   f = D L/(2 (co S(wi) + ci S(wo))):
 * two divisions where leaf by leaf has six. X and Y of h = wi + wo are the sums of those of
 * wi and wo. Errors as brdf.h states them. [Heitz2014 Eq. 72, 85, 99]
 */
#ifndef SHADE_MODEL_GGX_H
#define SHADE_MODEL_GGX_H

#include "brdf.h"
#include "lobe.h"

/* What a loop computes of one sample; lowest: z of the lower one of wi and wo. */
typedef struct ggx_sample {
  real cosi, coso, hwo, f;
  int opposite;
} ggx_sample;

/* Slopes of a direction, times L, and its cosine with n. */
typedef struct ggx_slopes {
  real x, y, c;
} ggx_slopes;

/* The lobe: of a material by its own numbers, or of a sample by its alphas. */
typedef struct ggx_lobe {
  int varies;
  real kx, ky, peak, gx, gy, ax, ay;
} ggx_lobe;

LEAF ggx_lobe ggx_own(lobe_numbers n, int swap) {
  return (ggx_lobe){.kx = swap ? n.ky : n.kx,
                    .ky = swap ? n.kx : n.ky,
                    .peak = n.peak,
                    .gx = swap ? n.gy : n.gx,
                    .gy = swap ? n.gx : n.gy};
}

LEAF ggx_lobe ggx_of_alphas(real ax, real ay) {
  return (ggx_lobe){.varies = 1, .ax = ax, .ay = ay};
}

/* D without its peak is (top/bottom)^2, over which the rest is divided by under; S^2 of i and o. */
typedef struct ggx_terms {
  real top, bottom, least, peak, under, si2, so2;
} ggx_terms;

LEAF ggx_terms ggx_own_terms(ggx_slopes i, ggx_slopes o, real hh, real ll, ggx_lobe lobe) {
  real x = i.x + o.x, y = i.y + o.y, d = i.c + o.c, gx = lobe.gx, gy = lobe.gy;
  return (ggx_terms){ll * hh,
                     ll * (d * d) + (lobe.kx * (x * x) + lobe.ky * (y * y)),
                     TINY,
                     lobe.peak,
                     1,
                     ll * (i.c * i.c) + (gx * (i.x * i.x) + gy * (i.y * i.y)),
                     ll * (o.c * o.c) + (gx * (o.x * o.x) + gy * (o.y * o.y))};
}

/*
 * No division: top and bottom are those above times (ax ay)^2. With the slopes times the alphas
 * that is four operations more than above; with alpha^2 it was seven.
 */
LEAF ggx_terms ggx_terms_of_alphas(ggx_slopes i, ggx_slopes o, real hh, real ll, ggx_lobe lobe) {
  real ax = lobe.ax, ay = lobe.ay, area = ax * ay, scale = area * area * ll;
  real x = ay * (i.x + o.x), y = ax * (i.y + o.y), d = i.c + o.c;
  real ix = ax * i.x, iy = ay * i.y, ox = ax * o.x, oy = ay * o.y;
  return (ggx_terms){scale * hh,
                     scale * (d * d) + (x * x + y * y),
                     LEAST_NORMAL,
                     R(0.31830988618379067154),
                     area,
                     ll * (i.c * i.c) + (ix * ix + iy * iy),
                     ll * (o.c * o.c) + (ox * ox + oy * oy)};
}

LEAF ggx_sample ggx_of(ggx_slopes i, ggx_slopes o, real hh, real ll, ggx_lobe lobe, real lowest) {
  ggx_sample s;
  ggx_terms t =
      lobe.varies ? ggx_terms_of_alphas(i, o, hh, ll, lobe) : ggx_own_terms(i, o, hh, ll, lobe);
  /* at most 100, alpha being at most 10, but for wi and wo that nearly cancel */
  real ratio = t.top / maximum(t.bottom, R(1e-5) * t.top + t.least);
  real l = root(ll), si = root(t.si2), so = root(t.so2);
  real value = t.peak * (ratio * ratio) * l /
               (t.under * maximum(2 * (o.c * si + i.c * so), R(1e-20) * maximum(l, R(1e-12))));
  /* one comparison, as in lit_cosine; as bits, or gcc weaves it into that of the minimum below */
  real_bits lit = -(real_bits)(minimum(minimum(i.c, o.c), lowest) > 0);
  s.cosi = maximum(i.c, 0);
  s.coso = from_bits(to_bits(o.c) & lit);
  s.hwo = minimum(R(0.5) * root(hh), 1);
  s.f = from_bits(to_bits(value) & lit);
  s.opposite = !(hh > R(1e-30));
  return s;
}

LEAF ggx_slopes ggx_carried(real a, real c, real nx, real ny, real nz, real wx, real wy, real wz) {
  ggx_slopes s;
  s.x = difference(c, wx, a, wz);
  s.y = dot2(a, c, difference(nx, wy, ny, wx), difference(nz, wy, ny, wz));
  s.c = dot(nx, ny, nz, wx, wy, wz);
  return s;
}

LEAF ggx_sample ggx_rotated(real nx, real ny, real nz, real wix, real wiy, real wiz, real wox,
                            real woy, real woz, real hh, ggx_lobe lobe) {
  real scale = rotate_scale(nx, nz), a = nx * scale, c = nz * scale;
  return ggx_of(ggx_carried(a, c, nx, ny, nz, wix, wiy, wiz),
                ggx_carried(a, c, nx, ny, nz, wox, woy, woz), hh, a * a + c * c, lobe,
                minimum(wiz, woz));
}

LEAF ggx_sample ggx_flat(real nx, real ny, real nz, real wix, real wiy, real wiz, real wox,
                         real woy, real woz, real hh, ggx_lobe lobe) {
  (void)nx, (void)ny, (void)nz;
  return ggx_of((ggx_slopes){wix, wiy, wiz}, (ggx_slopes){wox, woy, woz}, hh, 1, lobe, 1);
}

static int is_fused(const bsdf *b) {
  const shade_map map = b->carry.map;
  return b->mdf == SHADE_MDF_GGX && b->brdf == SHADE_BRDF_MICROFACET &&
         (map == SHADE_MAP_NONE || map == SHADE_MAP_ROTATE_X || map == SHADE_MAP_ROTATE_Y);
}

/* By a material of which is_fused holds. */
LEAF ggx_sample fused(const bsdf *b, triple n, triple wi, triple wo) {
  const int swap = b->carry.map == SHADE_MAP_ROTATE_Y;
  const real hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;
  const real hh = hx * hx + hy * hy + hz * hz;
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  const ggx_lobe lobe =
      ggx_own((lobe_numbers){own->kx, own->ky, own->peak, own->gx, own->gy}, swap);
  if (b->carry.map == SHADE_MAP_NONE)
    return ggx_flat(XYZ(n), XYZ(wi), XYZ(wo), hh, lobe);
  n = exchanged(n, swap), wi = exchanged(wi, swap), wo = exchanged(wo, swap);
  return ggx_rotated(XYZ(n), XYZ(wi), XYZ(wo), hh, lobe);
}

#endif
