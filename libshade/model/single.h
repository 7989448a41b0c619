/* SPDX-License-Identifier: Apache-2.0 */
/*
 * f, density and draw of one sample. All return status bits. Directions are handed on by value, so
 * that they stay in registers.
 */
#ifndef SHADE_MODEL_SINGLE_H
#define SHADE_MODEL_SINGLE_H

#include "public.h"
#include "diffuse.h"
#include "direction.h"
#include "draw.h"
#include "ggx.h"
#include "multiscatter.h"
#include "mutual.h"

/* Directions of a material that shade_bsdf_vary turned, in its frame, and back. */
LEAF triple framed(const bsdf *b, triple v) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  return b->turned ? turned_into(own->c, own->s, own->side, v) : v;
}
LEAF triple unframed(const bsdf *b, triple v) {
  const SUFFIX(bsdf_numbers) *own = numbers_of(b);
  return b->turned ? turned_back(own->c, own->s, own->side, v) : v;
}

static unsigned entry_mdf(const shade_bsdf *given, const real n_in[3], const real h_in[3],
                          real *d) {
  const bsdf *b = bsdf_of(given);
  const direction n = direction_of(n_in, 1), h = direction_of(h_in, 0);
  const unsigned status = n.status | h.status;
  *d = 0;
  if (status & SHADE_BAD_INPUT)
    return status;
  *d = lobe(b, framed(b, n.v), framed(b, h.v));
  return status;
}

/*
 * A hit: the eye, the normal that the lobe stands on, and what follows from the two alone, once for
 * all lights. The normal is z where the method ignores it, and bent where the horizon bends it.
 */
typedef struct MAY_ALIAS bsdf_hit {
  triple n, wo;
  real coso;
  real lo;          /* of angles */
  triple gain;      /* of multiscatter.h */
  real fibre_l, vy; /* L and wo across the fibre, where the diffuse model has fibres */
  triple given;     /* the normal that fades light by shadow_chiang */
  estevez steep;    /* of shadow_estevez */
  unsigned status;
  int fused, swapped, fibres, paths;
  shade_fade fade;
  mutual bumps; /* of PATHS_MUTUAL; n and coso are then the diffuse part's */
} bsdf_hit;

/* How light comes to the eye: at n alone, also by a mirror, or by way of other bumps. */
enum { PATHS_ONE, PATHS_FACETS, PATHS_MUTUAL };

_Static_assert(sizeof(bsdf_hit) <= sizeof(bsdf_hit_room), "a hit is too large for its room");
_Static_assert(_Alignof(bsdf_hit) <= _Alignof(bsdf_hit_room), "a hit is less aligned than that");

/* L of the fibre, and w across it. */
LEAF real fibre_length_of(const bsdf *b, triple n) {
  return fibre_length(b->fibres_along_y ? n.y : n.x, n.z);
}
LEAF real over_fibre_of(const bsdf *b, triple n, triple w) {
  n = exchanged(n, b->fibres_along_y), w = exchanged(w, b->fibres_along_y);
  return over_fibre(XYZ(n), XYZ(w));
}

/* Without a horizon's doing. Directions are mended. */
LEAF void prepare_hard(const bsdf *b, triple n, triple wo, bsdf_hit *h) {
  if (b->carry.map == SHADE_MAP_NONE)
    n = (triple){0, 0, 1};
  const int fused = is_fused(b);
  /* as the loops take them, which go along y by exchanging x and y */
  const int swapped = fused && b->carry.map == SHADE_MAP_ROTATE_Y;
  h->n = n;
  h->wo = wo;
  h->fused = fused;
  h->swapped = swapped;
  h->coso = dot_of(exchanged(n, swapped), exchanged(wo, swapped));
  h->lo = 0;
  if (b->brdf == SHADE_BRDF_MICROFACET && !fused)
    h->lo = smith(b, n, wo);
  if (b->multiscatter)
    h->gain = multiscatter_of(b, n, wo);
  h->fibres = shade_diffuse_is(b->diffuse).fibres;
  if (h->fibres) {
    h->fibre_l = fibre_length_of(b, n);
    h->vy = over_fibre_of(b, n, wo) / h->fibre_l;
  }
}

/* f without Fresnel of a lit light, whose sum with the eye is s. */
LEAF real specular_one(const bsdf *b, const bsdf_hit *h, triple wi, triple s, real hwo, real cosi) {
  if (h->fused)
    return fused(b, h->n, wi, h->wo).f;
  real scale = b->warp != SHADE_RIGID ? scale_to_unit(XYZ(s)) : 1;
  angles a = {hwo, cosi, h->coso, 0, h->lo};
  if (b->brdf == SHADE_BRDF_MICROFACET)
    a.li = smith(b, h->n, wi);
  /* rounded, as a batch does that keeps them */
  s.x = multiply_add(s.x, scale, 0);
  s.y = multiply_add(s.y, scale, 0);
  s.z = multiply_add(s.z, scale, 0);
  return brdf_value(b->brdf, lobe(b, h->n, s), a);
}

/* Phi of a lit light. */
LEAF real phi_one(const bsdf *b, const bsdf_hit *h, triple wi, real cosi) {
  real ly = 0, vy = 0;
  if (h->fibres) {
    ly = over_fibre_of(b, h->n, wi) / h->fibre_l;
    vy = h->vy;
  }
  return diffuse_phi(b->diffuse, ly, cosi, vy, h->coso);
}

/* f and the cosine, by value as directions are. */
typedef struct shaded_sample {
  triple f;
  real cosine;
  unsigned status;
} shaded_sample;
LEAF triple scaled(triple v, real factor) {
  return (triple){v.x * factor, v.y * factor, v.z * factor};
}

/* 0 beyond the horizons of n and z; wi is mended. */
LEAF shaded_sample hard_one(const bsdf *b, const bsdf_hit *h, triple wi) {
  const triple wo = h->wo;
  const real cosi = dot_of(exchanged(h->n, h->swapped), exchanged(wi, h->swapped));
  const triple sum = {wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
  shaded_sample out = {{0, 0, 0}, cosi > 0 ? cosi : 0, SHADE_OK};
  if (no_direction(XYZ(sum)))
    out.status = SHADE_BAD_INPUT;
  if (out.status || !(cosi > 0 && h->coso > 0 && wi.z > 0 && wo.z > 0))
    return out;
  if (!b->black) {
    real hwo = half_cosine(XYZ(sum));
    out.f = scaled(fresnel(b, hwo), specular_one(b, h, wi, sum, hwo, cosi));
    if (b->multiscatter)
      out.f = (triple){out.f.x * h->gain.x, out.f.y * h->gain.y, out.f.z * h->gain.z};
  }
  if (b->has_diffuse) {
    real phi = phi_one(b, h, wi, cosi);
    real q = phi * R(0.31830988618379067154) / maximum(cosi, R(1e-20));
    out.f.x += diffuse_scale(b, 0) * q;
    out.f.y += diffuse_scale(b, 1) * q;
    out.f.z += diffuse_scale(b, 2) * q;
  }
  return out;
}

/* What yarn_batch gives, of one sample. */
static void yarn_one(const bsdf *b, triple n, triple wi, triple wo, real *spec, real *matt) {
  bsdf_hit h;
  prepare_hard(b, n, wo, &h);
  const real cosi = dot_of(h.n, wi);
  const triple sum = {wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
  *spec = *matt = 0;
  if (!(lit_cosine(cosi, h.coso, wi.z, wo.z) > 0))
    return;
  const real hwo = half_cosine(XYZ(sum));
  *spec = specular_one(b, &h, wi, sum, hwo, cosi) * cosi;
  *matt = phi_one(b, &h, wi, cosi) * R(0.31830988618379067154) * let_in_and_out(cosi, h.coso);
}

/* The light as it is, then light or eye by way of the upright facet. */
static __attribute__((noinline)) shaded_sample facets_one(const bsdf *b, const bsdf_hit *h,
                                                          const triple *wi) {
  const triple w[2] = {*wi, h->wo}, n = h->n;
  shaded_sample out = {{0, 0, 0}, maximum(wi->z, 0), SHADE_OK};
  real weight[3], see[2][2];
  for (int k = 0; k < 2; k++) {
    see[k][0] = share_bumped(XYZ(n), XYZ(w[k]));
    see[k][1] = share_upright(XYZ(n), XYZ(w[k]));
  }
  weight[0] = n.z * (see[0][0] * see[1][0]);
  weight[1] = n.z * (see[0][1] * see[1][0]);
  weight[2] = n.z * (see[0][0] * see[1][1]);
  for (int k = 0; k < 3; k++) {
    bsdf_hit other;
    const bsdf_hit *seen = h;
    triple light = *wi;
    if (k) {
      if (!(weight[k] > 0))
        continue;
      const triple m = mirrored(n, w[k - 1]);
      if (k == 1) {
        light = m;
      } else {
        prepare_hard(b, n, m, &other);
        seen = &other;
      }
    }
    const shaded_sample one = hard_one(b, seen, light);
    if (!k && one.status) {
      out.status = one.status;
      return out;
    }
    out.f.x += weight[k] * one.f.x;
    out.f.y += weight[k] * one.f.y;
    out.f.z += weight[k] * one.f.z;
  }
  return out;
}

/* The normal that the lobe is about: bent for the eye where the horizon bends it. */
LEAF triple bent(triple n, triple wo) {
  if (!needs_bend(XYZ(n), XYZ(wo))) /* seldom, and dear */
    return n;
  const normal m = bend(XYZ(n), XYZ(wo));
  return (triple){XYZ(m)};
}
LEAF triple bent_for(const bsdf *b, triple n, triple wo) {
  return shade_horizon_is(b->horizon).bends ? bent(n, wo) : n;
}

/* Bumps that shade each other; the diffuse part is that of valid_estevez. */
static __attribute__((noinline)) void prepare_bumps(const bsdf *b, const triple *n,
                                                    const triple *wo, bsdf_hit *h) {
  h->paths = PATHS_MUTUAL;
  h->fade = SHADE_FADE_ESTEVEZ;
  h->given = *n;
  h->steep = estevez_of(n->x, n->y, n->z);
  prepare_hard(b, bent(*n, *wo), *wo, h);
  if (wo->z > 0)
    prepare_mutual(b, *n, *wo, &h->bumps);
}

/* What shaded needs; n and wo are mended. */
LEAF void prepare(const bsdf *b, triple n, triple wo, bsdf_hit *h) {
  shade_horizon_traits is = shade_horizon_is(b->horizon);
  if (has_bumps(b)) {
    const triple at = n, eye = wo; /* n and wo themselves stay in registers */
    prepare_bumps(b, &at, &eye, h);
    return;
  }
  if (n.x == 0 && n.y == 0 && !is.facets)
    is = shade_horizon_is(SHADE_HORIZON_HARD);
  h->paths = is.facets ? PATHS_FACETS : PATHS_ONE;
  h->fade = is.fade;
  h->given = n;
  if (is.fade == SHADE_FADE_ESTEVEZ)
    h->steep = estevez_of(XYZ(n));
  prepare_hard(b, bent_for(b, n, wo), wo, h);
}

/*
 * With SHADE_BAD_INPUT in the status nothing else is set. This and entry_hit are one piece of code
 * for all callers, or a product of the one might be fused with a sum of the other in some.
 */
static __attribute__((noinline)) unsigned entry_prepare(const shade_bsdf *given, const real n_in[3],
                                                        const real wo_in[3], bsdf_hit_room *room) {
  const bsdf *b = bsdf_of(given);
  bsdf_hit *h = (bsdf_hit *)room;
  const direction n = direction_of(n_in, 1), wo = direction_of(wo_in, 0);
  h->status = n.status | wo.status;
  if (!(h->status & SHADE_BAD_INPUT))
    prepare(b, framed(b, n.v), framed(b, wo.v), h);
  return h->status;
}

/* The diffuse part's f cos, and the lobe's of all bumps, over wi.z. */
static __attribute__((noinline)) shaded_sample bumps_one(const bsdf *b, const bsdf_hit *h,
                                                         const triple *light) {
  const triple wi = *light, wo = h->wo;
  shaded_sample out = {{0, 0, 0}, maximum(wi.z, 0), SHADE_OK};
  if (opposite(XYZ(wi), XYZ(wo)))
    out.status = SHADE_BAD_INPUT;
  if (out.status || !(wi.z > 0 && wo.z > 0))
    return out;
  if (!b->black)
    out.f = mutual_value(b, &h->bumps, wi, wo);
  const real cosi = dot_of(h->n, wi);
  if (b->has_diffuse && cosi > 0 && h->coso > 0) {
    const real q =
        phi_one(b, h, wi, cosi) * R(0.31830988618379067154) * shadow_of(h->steep, XYZ(wi));
    out.f.x += diffuse_scale(b, 0) * q;
    out.f.y += diffuse_scale(b, 1) * q;
    out.f.z += diffuse_scale(b, 2) * q;
  }
  out.f = scaled(out.f, 1 / maximum(wi.z, R(1e-20)));
  return out;
}

LEAF shaded_sample shaded(const bsdf *b, const bsdf_hit *h, triple wi) {
  if (h->paths != PATHS_ONE) {
    const triple light = wi; /* wi itself stays in registers */
    return h->paths == PATHS_FACETS ? facets_one(b, h, &light) : bumps_one(b, h, &light);
  }
  shaded_sample out = hard_one(b, h, wi);
  if (h->fade == SHADE_FADE_ESTEVEZ)
    out.f = scaled(out.f, shadow_of(h->steep, XYZ(wi)));
  else if (h->fade == SHADE_FADE_CHIANG)
    out.f = scaled(out.f, shadow_chiang(XYZ(h->given), XYZ(wi)));
  return out;
}

LEAF void put_triple(triple v, real to[3]) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

static __attribute__((noinline)) unsigned entry_hit(const shade_bsdf *given,
                                                    const bsdf_hit_room *room, const real wi_in[3],
                                                    real f[3], real *cosine) {
  const bsdf *b = bsdf_of(given);
  const bsdf_hit *h = (const bsdf_hit *)room;
  const direction wi = direction_of(wi_in, 0);
  const unsigned status = h->status | wi.status;
  shaded_sample out = {{0, 0, 0}, 0, SHADE_OK};
  if (!(status & SHADE_BAD_INPUT))
    out = shaded(b, h, framed(b, wi.v));
  put_triple(out.f, f);
  *cosine = out.cosine;
  return status | out.status;
}

static unsigned entry_bsdf(const shade_bsdf *b, const real n[3], const real wi[3], const real wo[3],
                           real f[3], real *cosine) {
  bsdf_hit_room room;
  entry_prepare(b, n, wo, &room);
  return entry_hit(b, &room, wi, f, cosine);
}

/* The density of wi about the lobe's normal, and status bits: all are mended, in the material's
 * frame. One piece of code, as entry_hit is. */
static __attribute__((noinline)) unsigned density_of(const bsdf *b, unsigned status, triple about,
                                                     triple wi, triple wo, real *pdf) {
  *pdf = 0;
  if (status & SHADE_BAD_INPUT || opposite(XYZ(wi), XYZ(wo)))
    return status | SHADE_BAD_INPUT;
  *pdf = density_by_paths(b, about, wi, wo);
  return status;
}

static unsigned entry_hit_pdf(const shade_bsdf *given, const bsdf_hit_room *room,
                              const real wi_in[3], real *pdf);

static unsigned entry_pdf(const shade_bsdf *given, const real n_in[3], const real wi_in[3],
                          const real wo_in[3], real *pdf) {
  const bsdf *b = bsdf_of(given);
  if (has_bumps(b)) {
    bsdf_hit_room room;
    entry_prepare(given, n_in, wo_in, &room);
    return entry_hit_pdf(given, &room, wi_in, pdf);
  }
  const direction n = direction_of(n_in, 1), wi = direction_of(wi_in, 0);
  const direction wo = direction_of(wo_in, 0);
  const triple eye = framed(b, wo.v);
  return density_of(b, n.status | wi.status | wo.status, bent_for(b, framed(b, n.v), eye),
                    framed(b, wi.v), eye, pdf);
}

/* What directions are drawn about: h->n is z where the method ignores the normal. */
LEAF triple drawn_about(const bsdf *b, const bsdf_hit *h) {
  return b->carry.map == SHADE_MAP_NONE ? h->given : h->n;
}

/* Of bumps that shade each other: the lobe's, and the diffuse part's about the bent normal. */
static __attribute__((noinline)) real bumps_density(const bsdf *b, const bsdf_hit *h, triple wi) {
  if (!(wi.z > 0 && h->wo.z > 0))
    return 0;
  const real q = mutual_density(b, &h->bumps, wi, h->wo);
  if (!b->has_diffuse)
    return q;
  const cosines c = cosines_about(h->n, wi, h->wo);
  const real share = own_share(b, maximum(h->coso, 0));
  return share * q + (1 - share) * mixed_density(even_share(b), 0, 0, c.i, c.o);
}
static drawn bumps_draw(const bsdf *b, const bsdf_hit *h, real u1, real u2) {
  if (!(h->wo.z > 0))
    return (drawn){{0, 0, 1}, 1};
  if (b->has_diffuse) {
    const real share = own_share(b, maximum(h->coso, 0));
    const int is_lobe = u1 < share;
    u1 = remapped(u1, share, is_lobe);
    if (!is_lobe)
      return draw_diffuse(b, h->n, u1, u2);
  }
  return mutual_draw(b, &h->bumps, h->wo, u1, u2);
}

/* Of a hit with any horizon, mended, and no opposites. */
LEAF real hit_density(const bsdf *b, const bsdf_hit *h, triple wi) {
  return has_bumps(b) ? bumps_density(b, h, wi) : density_by_paths(b, drawn_about(b, h), wi, h->wo);
}
LEAF drawn hit_draw(const bsdf *b, const bsdf_hit *h, real u1, real u2) {
  return has_bumps(b) ? bumps_draw(b, h, u1, u2)
                      : draw_by_paths(b, drawn_about(b, h), h->wo, u1, u2);
}

static unsigned entry_hit_pdf(const shade_bsdf *given, const bsdf_hit_room *room,
                              const real wi_in[3], real *pdf) {
  const bsdf *b = bsdf_of(given);
  const bsdf_hit *h = (const bsdf_hit *)room;
  const direction wi = direction_of(wi_in, 0);
  if (has_bumps(b)) {
    const unsigned status = h->status | wi.status;
    const triple w = framed(b, wi.v);
    *pdf = 0;
    if (status & SHADE_BAD_INPUT || opposite(XYZ(w), XYZ(h->wo)))
      return status | SHADE_BAD_INPUT;
    *pdf = bumps_density(b, h, w);
    return status;
  }
  return density_of(b, h->status | wi.status, drawn_about(b, h), framed(b, wi.v), h->wo, pdf);
}

static __attribute__((noinline)) unsigned entry_hit_sample(const shade_bsdf *given,
                                                           const bsdf_hit_room *room,
                                                           const real u[2], real wi[3], real f[3],
                                                           real *pdf, real *cosine) {
  const bsdf *b = bsdf_of(given);
  const bsdf_hit *h = (const bsdf_hit *)room;
  unsigned status = h->status;
  drawn d = {{0, 0, 0}, 1};
  shaded_sample out = {{0, 0, 0}, 0, SHADE_OK};
  *pdf = 0;
  if (u[0] != u[0] || u[1] != u[1])
    status |= SHADE_BAD_INPUT;
  if (!(status & SHADE_BAD_INPUT)) {
    d = hit_draw(b, h, uniform_of(u[0]), uniform_of(u[1]));
    *pdf = d.lost > 0 ? 0 : hit_density(b, h, d.w);
  }
  if (*pdf > 0) {
    out = shaded(b, h, d.w);
    d.w = unframed(b, d.w);
  } else {
    *pdf = 0;
    d.w = (triple){0, 0, 0};
    status |= SHADE_NO_SAMPLE;
  }
  put_triple(d.w, wi);
  put_triple(out.f, f);
  *cosine = out.cosine;
  return status;
}

static unsigned entry_sample(const shade_bsdf *b, const real n[3], const real wo[3],
                             const real u[2], real wi[3], real f[3], real *pdf, real *cosine) {
  bsdf_hit_room room;
  entry_prepare(b, n, wo, &room);
  return entry_hit_sample(b, &room, u, wi, f, pdf, cosine);
}

#endif
