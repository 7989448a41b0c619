/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One sample, from the same leaves. All return status bits. Directions are handed on by value: an
 * array that is indexed by a variable, or copied, lies in memory, and compilers read in one what
 * was just written in parts, which waits: a fifth of a call of GGX.
 */

static unsigned FN(mdf_one)(const bsdf *b, const real n_in[3], const real h_in[3], real *d) {
  const FN(direction) n = FN(direction_of)(n_in, 1), h = FN(direction_of)(h_in, 0);
  const unsigned status = n.status | h.status;
  *d = 0;
  if (status & SHADE_BAD_INPUT)
    return status;
  *d = FN(lobe)(b, n.v, h.v);
  return status;
}

/*
 * A hit: the eye, the normal that the lobe stands on, and what follows from the two alone, once for
 * all lights. The normal is z where the method ignores it, and bent where the horizon bends it.
 */
typedef struct MAY_ALIAS FN(bsdf_hit) {
  FN(triple) n, wo;
  real coso;
  real lo;           /* of FN(angles) */
  real fibre_l, vy;  /* L and wo across the fibre, where the diffuse model has fibres */
  FN(triple) given;  /* the normal that fades light by shadow_chiang */
  FN(estevez) steep; /* of shadow_estevez */
  unsigned status;
  int fused, swapped, fibres, facets;
  shade_fade fade;
} FN(bsdf_hit);

_Static_assert(sizeof(FN(bsdf_hit)) <= sizeof(FN(shade_bsdf_hit)),
               "a hit is too large for its room");
_Static_assert(_Alignof(FN(bsdf_hit)) <= _Alignof(FN(shade_bsdf_hit)),
               "a hit is less aligned than that");

LEAF real FN(dot_of)(FN(triple) n, FN(triple) w) {
  return FN(dot)(XYZ(n), XYZ(w));
}

/* L of the fibre, and w across it. */
LEAF real FN(fibre_length_of)(const bsdf *b, FN(triple) n) {
  return FN(fibre_length)(b->fibres_along_y ? n.y : n.x, n.z);
}
LEAF real FN(over_fibre_of)(const bsdf *b, FN(triple) n, FN(triple) w) {
  n = FN(exchanged)(n, b->fibres_along_y), w = FN(exchanged)(w, b->fibres_along_y);
  return FN(over_fibre)(XYZ(n), XYZ(w));
}

/* Without a horizon's doing. Directions are mended. */
LEAF void FN(prepare_hard)(const bsdf *b, FN(triple) n, FN(triple) wo, FN(bsdf_hit) * h) {
  if (b->carry.map == SHADE_MAP_NONE)
    n = (FN(triple)){0, 0, 1};
  const int fused = FN(is_fused)(b);
  /* as the loops take them, which go along y by exchanging x and y */
  const int swapped = fused && b->carry.map == SHADE_MAP_ROTATE_Y;
  h->n = n;
  h->wo = wo;
  h->fused = fused;
  h->swapped = swapped;
  h->coso = FN(dot_of)(FN(exchanged)(n, swapped), FN(exchanged)(wo, swapped));
  h->lo = 0;
  if (b->brdf == SHADE_BRDF_MICROFACET && !fused)
    h->lo = FN(smith)(b, n, wo);
  h->fibres = shade_diffuse_is(b->diffuse).fibres;
  if (h->fibres) {
    h->fibre_l = FN(fibre_length_of)(b, n);
    h->vy = FN(over_fibre_of)(b, n, wo) / h->fibre_l;
  }
}

/* f without Fresnel of a lit light, whose sum with the eye is s. */
LEAF real FN(specular_one)(const bsdf *b, const FN(bsdf_hit) * h, FN(triple) wi, FN(triple) s,
                           real hwo, real cosi) {
  if (h->fused)
    return FN(fused)(b, h->n, wi, h->wo).f;
  real scale = b->warp != SHADE_RIGID ? FN(scale_to_unit)(XYZ(s)) : 1;
  FN(angles) a = {hwo, cosi, h->coso, 0, h->lo};
  if (b->brdf == SHADE_BRDF_MICROFACET)
    a.li = FN(smith)(b, h->n, wi);
  /* rounded, as a batch does that keeps them */
  s.x = FN(multiply_add)(s.x, scale, 0);
  s.y = FN(multiply_add)(s.y, scale, 0);
  s.z = FN(multiply_add)(s.z, scale, 0);
  return FN(brdf)(b, FN(lobe)(b, h->n, s), a);
}

/* Phi of a lit light. */
LEAF real FN(phi_one)(const bsdf *b, const FN(bsdf_hit) * h, FN(triple) wi, real cosi) {
  real ly = 0, vy = 0;
  if (h->fibres) {
    ly = FN(over_fibre_of)(b, h->n, wi) / h->fibre_l;
    vy = h->vy;
  }
  return FN(diffuse_phi)(b->diffuse, ly, cosi, vy, h->coso);
}

/* f and the cosine, by value as directions are. */
typedef struct FN(lit) {
  FN(triple) f;
  real cosine;
  unsigned status;
} FN(lit);
LEAF FN(triple) FN(scaled)(FN(triple) v, real factor) {
  return (FN(triple)){v.x * factor, v.y * factor, v.z * factor};
}

/* 0 beyond the horizons of n and z; wi is mended. */
LEAF FN(lit) FN(hard_one)(const bsdf *b, const FN(bsdf_hit) * h, FN(triple) wi) {
  const FN(triple) wo = h->wo;
  const real cosi = FN(dot_of)(FN(exchanged)(h->n, h->swapped), FN(exchanged)(wi, h->swapped));
  const FN(triple) sum = {wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
  FN(lit) out = {{0, 0, 0}, cosi > 0 ? cosi : 0, SHADE_OK};
  if (FN(no_direction)(XYZ(sum)))
    out.status = SHADE_BAD_INPUT;
  if (out.status || !(cosi > 0 && h->coso > 0 && wi.z > 0 && wo.z > 0))
    return out;
  if (!b->black) {
    real hwo = FN(half_cosine)(XYZ(sum));
    out.f = FN(scaled)(FN(fresnel)(b, hwo), FN(specular_one)(b, h, wi, sum, hwo, cosi));
  }
  if (b->has_diffuse) {
    real phi = FN(phi_one)(b, h, wi, cosi);
    real q = phi * R(0.31830988618379067154) / FN(maximum)(cosi, R(1e-20));
    out.f.x += FN(diffuse_scale)(b, 0) * q;
    out.f.y += FN(diffuse_scale)(b, 1) * q;
    out.f.z += FN(diffuse_scale)(b, 2) * q;
  }
  return out;
}

/* As yarn_batch. */
static void FN(yarn_one)(const bsdf *b, FN(triple) n, FN(triple) wi, FN(triple) wo, real *spec,
                         real *matt) {
  FN(bsdf_hit) h;
  FN(prepare_hard)(b, n, wo, &h);
  const real cosi = FN(dot_of)(h.n, wi);
  const FN(triple) sum = {wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
  *spec = *matt = 0;
  if (!(FN(lit_cosine)(cosi, h.coso, wi.z, wo.z) > 0))
    return;
  const real hwo = FN(half_cosine)(XYZ(sum));
  const real enter = 1 - FN(schlick_weight)(FN(minimum)(cosi, 1));
  const real leave = 1 - FN(schlick_weight)(FN(minimum)(h.coso, 1));
  *spec = FN(specular_one)(b, &h, wi, sum, hwo, cosi) * cosi;
  *matt = FN(phi_one)(b, &h, wi, cosi) * R(0.31830988618379067154) * enter * leave;
}

/* The light as it is, then light or eye by way of the upright facet. */
static __attribute__((noinline)) FN(lit)
    FN(facets_one)(const bsdf *b, const FN(bsdf_hit) * h, const FN(triple) * wi) {
  const FN(triple) w[2] = {*wi, h->wo}, n = h->n;
  FN(lit) out = {{0, 0, 0}, FN(maximum)(wi->z, 0), SHADE_OK};
  real weight[3], see[2][2];
  for (int k = 0; k < 2; k++) {
    see[k][0] = FN(share_bumped)(XYZ(n), XYZ(w[k]));
    see[k][1] = FN(share_upright)(XYZ(n), XYZ(w[k]));
  }
  weight[0] = n.z * (see[0][0] * see[1][0]);
  weight[1] = n.z * (see[0][1] * see[1][0]);
  weight[2] = n.z * (see[0][0] * see[1][1]);
  for (int k = 0; k < 3; k++) {
    FN(bsdf_hit) mirrored;
    const FN(bsdf_hit) *seen = h;
    FN(triple) light = *wi;
    if (k) {
      if (!(weight[k] > 0))
        continue;
      const FN(triple) from = w[k - 1];
      real step = FN(mirror_step)(n.x, n.y, from.x, from.y);
      const FN(triple)
          m = {FN(multiply_add)(-step, n.x, from.x), FN(multiply_add)(-step, n.y, from.y), from.z};
      if (k == 1) {
        light = m;
      } else {
        FN(prepare_hard)(b, n, m, &mirrored);
        seen = &mirrored;
      }
    }
    const FN(lit) one = FN(hard_one)(b, seen, light);
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

/*
 * What hit_one needs. With SHADE_BAD_INPUT in the status nothing else is set. Both are one piece of
 * code for all callers, or a product of the one might be fused with a sum of the other in some.
 */
static __attribute__((noinline)) void FN(prepare_one)(const bsdf *b, const real n_in[3],
                                                      const real wo_in[3], FN(bsdf_hit) * h) {
  shade_horizon_traits is = shade_horizon_is(b->horizon);
  const FN(direction) given = FN(direction_of)(n_in, 1), eye = FN(direction_of)(wo_in, 0);
  FN(triple) n = given.v;
  h->status = given.status | eye.status;
  if (h->status & SHADE_BAD_INPUT)
    return;
  if (n.x == 0 && n.y == 0 && !is.facets)
    is = shade_horizon_is(SHADE_HORIZON_HARD);
  h->facets = is.facets;
  h->fade = is.fade;
  h->given = n;
  if (is.fade == SHADE_FADE_ESTEVEZ)
    h->steep = FN(estevez_of)(XYZ(n));
  if (is.bends && FN(needs_bend)(XYZ(n), XYZ(eye.v))) { /* seldom, and then dear */
    const FN(normal) bent = FN(bend)(XYZ(n), XYZ(eye.v));
    n = (FN(triple)){XYZ(bent)};
  }
  FN(prepare_hard)(b, n, eye.v, h);
}

static __attribute__((noinline)) unsigned
FN(hit_one)(const bsdf *b, const FN(bsdf_hit) * h, const real wi_in[3], real f[3], real *cosine) {
  const FN(direction) wi = FN(direction_of)(wi_in, 0);
  unsigned status = h->status | wi.status;
  FN(lit) out = {{0, 0, 0}, 0, SHADE_OK};
  if (!(status & SHADE_BAD_INPUT)) {
    if (h->facets) {
      const FN(triple) light = wi.v;
      out = FN(facets_one)(b, h, &light);
    } else {
      out = FN(hard_one)(b, h, wi.v);
      if (h->fade == SHADE_FADE_ESTEVEZ)
        out.f = FN(scaled)(out.f, FN(shadow_of)(h->steep, XYZ(wi.v)));
      else if (h->fade == SHADE_FADE_CHIANG)
        out.f = FN(scaled)(out.f, FN(shadow_chiang)(XYZ(h->given), XYZ(wi.v)));
    }
    status |= out.status;
  }
  f[0] = out.f.x;
  f[1] = out.f.y;
  f[2] = out.f.z;
  *cosine = out.cosine;
  return status;
}

static unsigned FN(bsdf_one)(const bsdf *b, const real n[3], const real wi[3], const real wo[3],
                             real f[3], real *cosine) {
  FN(bsdf_hit) h;
  FN(prepare_one)(b, n, wo, &h);
  return FN(hit_one)(b, &h, wi, f, cosine);
}

/* Phi in the fibre's own frame, by the contract of shade_diffuse_eval. */
static real FN(kernel_diffuse)(shade_diffuse model, const real l_in[3], const real v_in[3]) {
  real l[3] = {l_in[0], l_in[1], l_in[2]}, v[3] = {0, 0, 1};
  if ((unsigned)model >= SHADE_DIFFUSE_COUNT) /* an unknown model is the first */
    model = (shade_diffuse)0;
  if (shade_diffuse_is(model).sees)
    memcpy(v, v_in, sizeof v);
  if ((FN(mend_if_needed)(l, 0) | FN(mend_if_needed)(v, 0)) & SHADE_BAD_INPUT)
    return 0;
  return l[2] > 0 && v[2] > 0 ? FN(diffuse_phi)(model, l[1], l[2], v[1], v[2]) : 0;
}

/* Draws and their densities go through one loop: a batch of one. */
static unsigned FN(pdf_one)(const bsdf *b, const real n[3], const real wi[3], const real wo[3],
                            real *pdf) {
  const FN(shade_lanes) in = {.size = sizeof in,
                              .nx = n,
                              .ny = n + 1,
                              .nz = n + 2,
                              .wix = wi,
                              .wiy = wi + 1,
                              .wiz = wi + 2,
                              .wox = wo,
                              .woy = wo + 1,
                              .woz = wo + 2};
  return FN(pdf_batch)(b, 1, &in, NULL, pdf);
}

static unsigned FN(sample_one)(const bsdf *b, const real n[3], const real wo[3], const real u[2],
                               real wi[3], real f[3], real *pdf, real *cosine) {
  const FN(shade_sample_lanes) in = {.size = sizeof in,
                                     .nx = n,
                                     .ny = n + 1,
                                     .nz = n + 2,
                                     .wox = wo,
                                     .woy = wo + 1,
                                     .woz = wo + 2,
                                     .u1 = u,
                                     .u2 = u + 1};
  const FN(shade_sample_result)
      out = {sizeof out, wi, wi + 1, wi + 2, f, f + 1, f + 2, pdf, cosine};
  return FN(sample_batch)(b, 1, &in, NULL, &out);
}
