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

LEAF ggx_sample ggx_of(ggx_slopes i, ggx_slopes o, real hh, real ll, lobe_numbers lobe,
                       real lowest) {
  ggx_sample s;
  real x = i.x + o.x, y = i.y + o.y, d = i.c + o.c, gx = lobe.gx, gy = lobe.gy;
  real top = ll * hh, bottom = ll * (d * d) + (lobe.kx * (x * x) + lobe.ky * (y * y));
  real si2 = ll * (i.c * i.c) + (gx * (i.x * i.x) + gy * (i.y * i.y));
  real so2 = ll * (o.c * o.c) + (gx * (o.x * o.x) + gy * (o.y * o.y));
  /* at most 100, alpha being at most 10, but for wi and wo that nearly cancel */
  real ratio = top / maximum(bottom, R(1e-5) * top + TINY);
  real l = root(ll), si = root(si2), so = root(so2);
  real value = lobe.peak * (ratio * ratio) * l /
               maximum(2 * (o.c * si + i.c * so), R(1e-20) * maximum(l, R(1e-12)));
  /* one comparison, as in lit_cosine; as bits, which keeps it apart from the minimum below */
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

/* By a material or sample of which is_fused holds; n, wi and wo with x and y in each other's place,
 * and so the lobe, for ROTATE_Y. */
LEAF ggx_sample ggx_fused(int flat, triple n, triple wi, triple wo, lobe_numbers lobe) {
  const real hx = wi.x + wo.x, hy = wi.y + wo.y, hz = wi.z + wo.z;
  const real hh = hx * hx + hy * hy + hz * hz;
  if (flat)
    return ggx_of((ggx_slopes){XYZ(wi)}, (ggx_slopes){XYZ(wo)}, hh, 1, lobe, 1);
  const real scale = rotate_scale(n.x, n.z), a = n.x * scale, c = n.z * scale;
  return ggx_of(ggx_carried(a, c, XYZ(n), XYZ(wi)), ggx_carried(a, c, XYZ(n), XYZ(wo)), hh,
                a * a + c * c, lobe, minimum(wi.z, wo.z));
}

static int is_fused(const bsdf *b) {
  const shade_map map = b->carry.map;
  return b->mdf == SHADE_MDF_GGX && b->brdf == SHADE_BRDF_MICROFACET &&
         (map == SHADE_MAP_NONE || map == SHADE_MAP_ROTATE_X || map == SHADE_MAP_ROTATE_Y);
}

LEAF ggx_sample fused(const bsdf *b, triple n, triple wi, triple wo) {
  const int swap = b->carry.map == SHADE_MAP_ROTATE_Y;
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  const lobe_numbers lobe = {swap ? own->ky : own->kx, swap ? own->kx : own->ky, own->peak,
                             swap ? own->gy : own->gx, swap ? own->gx : own->gy};
  return ggx_fused(b->carry.map == SHADE_MAP_NONE, exchanged(n, swap), exchanged(wi, swap),
                   exchanged(wo, swap), lobe);
}

#endif
