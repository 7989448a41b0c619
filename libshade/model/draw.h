/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Draws of one sample and the density they are drawn with: that of every lobe of the proposal, of
 * the diffuse part, and of what comes by the mirrors of two facets.
 *
 * setup.c sets up the proposal of a material. It is the distribution's own lobe, or the part of it
 * that the eye sees, in the frame of carry.frame, which is a rigid one or a warp. Through a warp
 * the density is that of the unmoved lobe times the warp's Jacobian. The lobe of `perturb` has no
 * closed integral. Its proposal is three rigid lobes about n: the anisotropic one, the round one of
 * n's own azimuth, and the round widest one, which bounds f cos / pdf.
 *
 * Facets with upright mirrors (SHADE_HORIZON_SCHUESSLER) draw by path. The eye sees the bumped
 * facet, or that facet in the mirror. From the bumped facet some light goes on to the mirror.
 */
#ifndef SHADE_MODEL_DRAW_H
#define SHADE_MODEL_DRAW_H

#include "frame.h"
#include "horizon.h"
#include "lobe.h"
#include "share.h"

/* One of the proposal's lobes, and its share of the draws. */
typedef struct proposed {
  real kx, ky, weight;
} proposed;

/* How a proposal stands to the lobe; rotate_approximate is rotate with 1/alpha^2 times L^2, whose
 * floor keeps the slopes within what D is capped at. */
typedef struct proposal {
  int three, short_by_l, along_x;
  real scale, per_slope, least;
} proposal;
LEAF proposal proposal_of(const bsdf *b) {
  return (proposal){
      b->carry.parts > 1,      b->carry.short_by_l,      b->carry.map == SHADE_MAP_ROTATE_RATIO_X,
      numbers_of(b)->proposal, numbers_of(b)->per_slope, b->carry.short_by_l ? R(1e-3) : 0};
}

/* Number `part` of the lobes. */
LEAF proposed propose(proposal from, int part, real kx, real ky, triple n) {
  const real xx = n.x * n.x, yy = n.y * n.y;
  kx *= from.scale;
  ky *= from.scale;
  if (!from.three) {
    const real ll = from.short_by_l ? (from.along_x ? xx : yy) + n.z * n.z : 1;
    return (proposed){maximum(kx * ll, from.least), maximum(ky * ll, from.least), 1};
  }
  const real widest = minimum(kx, ky);
  const real here = (kx * xx + ky * yy + R(0.5) * TINY * (kx + ky)) / (xx + yy + TINY);
  const real upright = R(0.5) / (1 + from.per_slope * (kx * xx + ky * yy));
  return (proposed){part == 0   ? kx
                    : part == 1 ? here
                                : widest,
                    part == 0   ? ky
                    : part == 1 ? here
                                : widest,
                    part == 0   ? upright
                    : part == 1 ? R(0.5) - upright
                                : R(0.5)};
}

/* The one that u falls to; its weight is what is left of u. */
LEAF proposed choose_proposed(proposal from, real kx, real ky, triple n, real u) {
  const proposed p = propose(from, 0, kx, ky, n);
  if (!from.three)
    return (proposed){p.kx, p.ky, u};
  const proposed second = propose(from, 1, kx, ky, n), third = propose(from, 2, kx, ky, n);
  const int is_first = u < p.weight;
  u = remapped(u, p.weight, is_first);
  const real share = second.weight / maximum(1 - p.weight, R(1e-20));
  const int is_second = u < share;
  const real v = remapped(u, share, is_second);
  return (proposed){is_first    ? p.kx
                    : is_second ? second.kx
                                : third.kx,
                    is_first    ? p.ky
                    : is_second ? second.ky
                                : third.ky,
                    is_first ? u : v};
}

/* A direction; `lost` is 1 where there is none. */
typedef struct drawn {
  triple w;
  real lost;
} drawn;

/* A direction of the diffuse part, about the pole by the cosine, or evenly for the first `even`. */
LEAF triple draw_matt(real even, real u1, real u2) {
  const int flat = u1 < even;
  const pair p = circle(remapped(u1, even, flat));
  const real zz = 1 - u2, z = flat ? zz : root(zz);
  const real sine = flat ? root(u2 * (1 + zz)) : root(u2);
  return (triple){sine * p.x, sine * p.y, z};
}

/* wo mirrored by h, of any length. */
LEAF drawn reflected(triple wo, triple h) {
  const real size2 = h.x * h.x + h.y * h.y + h.z * h.z;
  const real along = h.x * wo.x + h.y * wo.y + h.z * wo.z;
  const real twice = 2 * along / maximum(size2, TINY);
  return (drawn){{twice * h.x - wo.x, twice * h.y - wo.y, twice * h.z - wo.z},
                 along > 0 ? R(0.0) : R(1.0)};
}

/* Unit; what points below is lost too, and z stands for what is lost. */
LEAF drawn settled(drawn d) {
  const triple w = d.w;
  const real size2 = w.x * w.x + w.y * w.y + w.z * w.z, scale = 1 / root(size2 + TINY);
  const int keep = (d.lost == 0) & (w.z > 0) & (size2 > R(0.25));
  return (drawn){{keep ? w.x * scale : 0, keep ? w.y * scale : 0, keep ? w.z * scale : 1},
                 keep ? R(0.0) : R(1.0)};
}

/* Which path a draw takes: the eye, mirrored where it sees the bumped facet in the mirror, what is
 * left of u, and whether (1, 0) light goes on to the mirror from the bumped facet. */
typedef struct facet_path {
  real x, y, u, bounce;
} facet_path;
LEAF facet_path choose_path(triple n, triple wo, real u) {
  const real share = share_bumped(XYZ(n), XYZ(wo)), left = 1 - share_bounced(XYZ(n), XYZ(wo));
  const int bumped = u < share;
  const real v = remapped(u, share, bumped);
  const int plain = v < left;
  const real again = remapped(v, left, plain);
  const real step = bumped ? 0 : mirror_step(n.x, n.y, wo.x, wo.y);
  return (facet_path){wo.x - step * n.x, wo.y - step * n.y, bumped ? again : v,
                      (bumped & !plain) ? R(1.0) : R(0.0)};
}

/* Light that left the bumped facet, on to the mirror; what never left it is lost. */
LEAF drawn bounced_on(triple n, real bounce, drawn d) {
  const real side = n.x * d.w.x + n.y * d.w.y;
  real step = mirror_step(n.x, n.y, d.w.x, d.w.y);
  step = ((bounce > 0) & (side > 0)) ? step : 0;
  d.lost = side + n.z * d.w.z > 0 ? d.lost : 1;
  d.w.x -= step * n.x;
  d.w.y -= step * n.y;
  return d;
}

/* Whether the lobe is white at grazing angles, for lobe_share. */
LEAF real grazing_of(const bsdf *b) {
  return b->has_specular && shade_fresnel_is(b->fresnel).grazing ? R(1.0) : R(0.0);
}

/*
 * The whole density: the share of the lobe's, q, and the rest about the normal, where Lambert is
 * met by the cosine and the fibres by as much again that is even.
 */
LEAF real mixed_density(real even, real share, real q, real cosi, real coso) {
  const real matt = (even * R(0.5) + (1 - even) * cosi) * R(0.31830988618379067154);
  return coso > 0 ? share * q + (1 - share) * matt : 0;
}

/* Of the diffuse part's draws: how many are even, and the frame of all. */
LEAF real even_share(const bsdf *b) {
  return b->draw_even ? R(0.5) : R(0.0);
}
LEAF shade_map matt_frame(const bsdf *b) {
  return b->carry.map == SHADE_MAP_NONE ? SHADE_MAP_NONE : SHADE_MAP_SHORTEST_ARC;
}

/* How likely the paths of two facets are that end in wi: plain, by light mirrored, by the eye. */
typedef struct path_shares {
  real plain, light, eye;
} path_shares;
LEAF path_shares paths(triple n, triple wi, triple wo) {
  const real bounced = share_bounced(XYZ(n), XYZ(wo)), bumped = share_bumped(XYZ(n), XYZ(wo));
  const real side = n.x * wi.x + n.y * wi.y;
  return (path_shares){bumped * (side > 0 ? 1 - bounced : 1), bumped * (side < 0 ? bounced : 0),
                       share_upright(XYZ(n), XYZ(wo))};
}

/* ---- whole, by a material's own parameters ----------------------------------------------------
 */

LEAF real own_share(const bsdf *b, real coso) {
  return lobe_share(numbers_of(b)->share_lobe, grazing_of(b), numbers_of(b)->share_diffuse, coso);
}

LEAF cosines cosines_of(const bsdf *b, triple n, triple wi, triple wo) {
  return cosines_about(b->carry.map == SHADE_MAP_NONE ? (triple){0, 0, 1} : n, wi, wo);
}

/* The density, by the lobe alone, of the direction whose half vector with wo is h: unit for warps;
 * coso > 0. */
LEAF real proposed_density(const bsdf *b, triple n, triple h, real hwo, triple wo, real coso) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  const lobe_point at = lobe_at(detail(b->carry.frame, n, h));
  lobe_point eye = {0, 0, 0};
  if (b->visible)
    eye = lobe_at(detail(b->carry.frame, n, wo));
  real q = 0;
  for (int part = 0; part < b->carry.parts; part++) {
    const proposed p = propose(proposal_of(b), part, own->kx, own->ky, n);
    q += p.weight * half_density(b->mdf, b->visible, at, eye, p.kx, p.ky, hwo, coso);
  }
  if (b->warp != SHADE_RIGID)
    q *= warp_stretch(XYZ(n), XYZ(h), b->warp == SHADE_WARP_SMOOTH, 0);
  return q;
}

/* The density of wi for the n that the lobe is about. */
static __attribute__((noinline)) real density_about(const bsdf *b, triple n, triple wi, triple wo) {
  const cosines c = cosines_of(b, n, wi, wo);
  triple h = {wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
  const real hwo = half_cosine(XYZ(h)), unit = b->warp != SHADE_RIGID ? scale_to_unit(XYZ(h)) : 1;
  h = (triple){h.x * unit, h.y * unit, h.z * unit};
  const real q = proposed_density(b, n, h, hwo, wo, c.o);
  const real share = b->has_diffuse ? own_share(b, c.o) : R(1.0);
  return mixed_density(even_share(b), share, q, c.i, c.o);
}

LEAF triple mirrored(triple n, triple w) {
  const real step = mirror_step(n.x, n.y, w.x, w.y);
  return (triple){multiply_add(-step, n.x, w.x), multiply_add(-step, n.y, w.y), w.z};
}

/* The same for any horizon. */
static real density_by_paths(const bsdf *b, triple n, triple wi, triple wo) {
  const real q = density_about(b, n, wi, wo);
  if (!shade_horizon_is(b->horizon).facets)
    return q;
  const path_shares by = paths(n, wi, wo);
  return by.plain * q + by.light * density_about(b, n, mirrored(n, wi), wo) +
         by.eye * density_about(b, n, wi, mirrored(n, wo));
}

/* A direction of the diffuse part about n. */
LEAF drawn draw_diffuse(const bsdf *b, triple n, real u1, real u2) {
  return settled((drawn){out_of_frame(matt_frame(b), n, draw_matt(even_share(b), u1, u2)), 0});
}

/* One of the lobe about n, of any length and height; coso >= 0. */
LEAF drawn draw_proposed(const bsdf *b, triple n, triple wo, real coso, real u1, real u2) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  const proposed p = choose_proposed(proposal_of(b), own->kx, own->ky, n, u1);
  triple eye = {0, 0, 1};
  if (b->visible) {
    const pair o = into_frame(b->carry.frame, n, wo);
    eye = (triple){o.x, o.y, coso};
  }
  const triple h = draw_half(b->mdf, b->visible, p.weight, u2, p.kx, p.ky, eye);
  return reflected(wo, out_of_frame(b->carry.frame, n, h));
}

/* A direction for the eye wo about n. */
static __attribute__((noinline)) drawn draw_about(const bsdf *b, triple n, triple wo, real u1,
                                                  real u2) {
  if (b->has_diffuse) {
    const real share = own_share(b, cosines_of(b, n, wo, wo).o);
    const int is_lobe = u1 < share;
    u1 = remapped(u1, share, is_lobe);
    if (!is_lobe)
      return draw_diffuse(b, n, u1, u2);
  }
  return settled(draw_proposed(b, n, wo, cosines_of(b, n, wo, wo).o, u1, u2));
}

/* The same for any horizon. */
static drawn draw_by_paths(const bsdf *b, triple n, triple wo, real u1, real u2) {
  if (!shade_horizon_is(b->horizon).facets)
    return draw_about(b, n, wo, u1, u2);
  const facet_path path = choose_path(n, wo, u1);
  const triple eye = {path.x, path.y, wo.z};
  return bounced_on(n, path.bounce, draw_about(b, n, eye, path.u, u2));
}

#endif
