/* SPDX-License-Identifier: Apache-2.0 */
/* One sample, from the same leaves. All return status bits. */

static unsigned FN(mdf_one)(const bsdf *b, const real n_in[3], const real h_in[3], real *d) {
  real n[3] = {n_in[0], n_in[1], n_in[2]};
  real h[3] = {h_in[0], h_in[1], h_in[2]};
  unsigned status = FN(mend_if_needed)(n, 1) | FN(mend_if_needed)(h, 0);
  *d = 0;
  if (status & SHADE_BAD_INPUT)
    return status;
#if SHADE_FLOAT
  if (b->fast) {
    *d = fast(b, n, h[0], h[1], h[2]);
    return status;
  }
#endif
  *d = FN(lobe)(b, n, h[0], h[1], h[2]);
  return status;
}

/*
 * A hit: the eye, the normal that the lobe stands on, and what follows from the two alone, once for
 * all lights. The normal is z where the method ignores it, and bent where the horizon bends it.
 */
typedef struct MAY_ALIAS FN(bsdf_hit) {
  real n[3], wo[3], coso;
  real lo;          /* of FN(angles) */
  real fibre_l, vy; /* L and wo across the fibre, where the diffuse model has fibres */
  real given[3];    /* the normal that fades light by shadow_chiang */
  real alpha2;      /* of shadow_estevez */
  unsigned status;
  int fused, swapped, fibres, facets;
  shade_fade fade;
} FN(bsdf_hit);

_Static_assert(sizeof(FN(bsdf_hit)) <= sizeof(FN(shade_bsdf_hit)),
               "a hit is too large for its room");
_Static_assert(_Alignof(FN(bsdf_hit)) <= _Alignof(FN(shade_bsdf_hit)),
               "a hit is less aligned than that");

/* Without a horizon's doing. Directions are mended. */
LEAF void FN(prepare_hard)(const bsdf *b, const real n_in[3], const real wo[3], FN(bsdf_hit) * h) {
  const int flat = b->carry.map == SHADE_MAP_NONE;
  for (int c = 0; c < 3; c++) {
    h->n[c] = flat ? (real)(c == 2) : n_in[c];
    h->wo[c] = wo[c];
  }
  const real *n = h->n;
  h->fused = FN(is_fused)(b);
  /* as the loops take them, which go along y by exchanging x and y */
  h->swapped = h->fused && b->carry.map == SHADE_MAP_ROTATE_Y;
  const int x = h->swapped, y = !x;
  h->coso = FN(dot)(n[x], n[y], n[2], wo[x], wo[y], wo[2]);
  h->lo = 0;
  if (b->brdf == SHADE_BRDF_MICROFACET && !h->fused)
    h->lo = FN(smith)(b, n, wo);
  h->fibres = shade_diffuse_is(b->diffuse).fibres;
  if (h->fibres) {
    const int k = b->fibres_along_y, l = !k;
    h->fibre_l = FN(fibre_length)(n[k], n[2]);
    h->vy = FN(over_fibre)(n[k], n[l], n[2], wo[k], wo[l], wo[2]) / h->fibre_l;
  }
}

/* f without Fresnel of a lit light, whose sum with the eye is x, y, z. */
LEAF real FN(specular_one)(const bsdf *b, const FN(bsdf_hit) * h, const real wi[3], real x, real y,
                           real z, real hwo, real cosi) {
  if (h->fused)
    return FN(fused)(b, h->n, wi, h->wo).f;
  real scale = b->warp != SHADE_RIGID ? FN(scale_to_unit)(x, y, z) : 1;
  FN(angles) a = {hwo, cosi, h->coso, 0, h->lo};
  if (b->brdf == SHADE_BRDF_MICROFACET)
    a.li = FN(smith)(b, h->n, wi);
  /* rounded, as a batch does that keeps them */
  x = FN(multiply_add)(x, scale, 0);
  y = FN(multiply_add)(y, scale, 0);
  z = FN(multiply_add)(z, scale, 0);
  return FN(brdf)(b, FN(lobe)(b, h->n, x, y, z), a);
}

/* Phi of a lit light. */
LEAF real FN(phi_one)(const bsdf *b, const FN(bsdf_hit) * h, const real wi[3], real cosi) {
  const int k = b->fibres_along_y, l = !k;
  real ly = 0, vy = 0;
  if (h->fibres) {
    ly = FN(over_fibre)(h->n[k], h->n[l], h->n[2], wi[k], wi[l], wi[2]) / h->fibre_l;
    vy = h->vy;
  }
  return FN(diffuse_phi)(b->diffuse, ly, cosi, vy, h->coso);
}

/* f and the cosine, 0 beyond the horizons of n and z; wi is mended. */
static unsigned FN(hard_one)(const bsdf *b, const FN(bsdf_hit) * h, const real wi[3], real f[3],
                             real *cosine) {
  const int x = h->swapped, y = !x;
  const real *n = h->n, *wo = h->wo;
  real cosi = FN(dot)(n[x], n[y], n[2], wi[x], wi[y], wi[2]);
  real hx = wi[0] + wo[0], hy = wi[1] + wo[1], hz = wi[2] + wo[2];
  f[0] = f[1] = f[2] = 0;
  *cosine = cosi > 0 ? cosi : 0;
  if (FN(no_direction)(hx, hy, hz))
    return SHADE_BAD_INPUT;
  if (!(cosi > 0 && h->coso > 0 && wi[2] > 0 && wo[2] > 0))
    return SHADE_OK;
  real hwo = FN(half_cosine)(hx, hy, hz);
  real value = FN(specular_one)(b, h, wi, hx, hy, hz, hwo, cosi);
  for (int c = 0; c < 3; c++)
    f[c] = value * FN(fresnel)(b, c, hwo);
  if (b->has_diffuse) {
    real phi = FN(phi_one)(b, h, wi, cosi);
    real q = phi * R(0.31830988618379067154) / FN(maximum)(cosi, R(1e-20));
    for (int c = 0; c < 3; c++)
      f[c] += FN(diffuse_scale)(b, c) * q;
  }
  return SHADE_OK;
}

/* As yarn_batch. */
static void FN(yarn_one)(const bsdf *b, const real n[3], const real wi[3], const real wo[3],
                         real *spec, real *matt) {
  FN(bsdf_hit) h;
  FN(prepare_hard)(b, n, wo, &h);
  const real cosi = FN(dot)(h.n[0], h.n[1], h.n[2], wi[0], wi[1], wi[2]);
  const real hx = wi[0] + wo[0], hy = wi[1] + wo[1], hz = wi[2] + wo[2];
  *spec = *matt = 0;
  if (!(FN(lit_cosine)(cosi, h.coso, wi[2], wo[2]) > 0))
    return;
  const real hwo = FN(half_cosine)(hx, hy, hz);
  const real enter = 1 - FN(schlick_weight)(FN(minimum)(cosi, 1));
  const real leave = 1 - FN(schlick_weight)(FN(minimum)(h.coso, 1));
  *spec = FN(specular_one)(b, &h, wi, hx, hy, hz, hwo, cosi) * cosi;
  *matt = FN(phi_one)(b, &h, wi, cosi) * R(0.31830988618379067154) * enter * leave;
}

static unsigned FN(facets_one)(const bsdf *b, const FN(bsdf_hit) * h, const real wi[3], real f[3],
                               real *cosine) {
  real more[3], unused;
  real see[2][2];
  const real *w[2] = {wi, h->wo}, *n = h->n;
  for (int k = 0; k < 2; k++) {
    see[k][0] = FN(share_bumped)(n[0], n[1], n[2], w[k][0], w[k][1], w[k][2]);
    see[k][1] = FN(share_upright)(n[0], n[1], n[2], w[k][0], w[k][1], w[k][2]);
  }
  unsigned status = FN(hard_one)(b, h, wi, f, cosine);
  *cosine = FN(maximum)(wi[2], 0);
  if (status & SHADE_BAD_INPUT)
    return status;
  for (int c = 0; c < 3; c++)
    f[c] *= n[2] * (see[0][0] * see[1][0]);
  for (int k = 0; k < 2; k++) {
    real weight = n[2] * (see[0][k == 0] * see[1][k == 1]);
    if (!(weight > 0))
      continue;
    real step = FN(mirror_step)(n[0], n[1], w[k][0], w[k][1]);
    const real m[3] = {FN(multiply_add)(-step, n[0], w[k][0]),
                       FN(multiply_add)(-step, n[1], w[k][1]), w[k][2]};
    FN(bsdf_hit) mirrored = *h;
    if (k == 1)
      FN(prepare_hard)(b, n, m, &mirrored);
    FN(hard_one)(b, &mirrored, k == 0 ? m : wi, more, &unused);
    for (int c = 0; c < 3; c++)
      f[c] += weight * more[c];
  }
  return status;
}

/*
 * What hit_one needs. With SHADE_BAD_INPUT in the status nothing else is set. Both are one piece of
 * code for all callers, or a product of the one might be fused with a sum of the other in some.
 */
static __attribute__((noinline)) void FN(prepare_one)(const bsdf *b, const real n_in[3],
                                                      const real wo_in[3], FN(bsdf_hit) * h) {
  shade_horizon_traits is = shade_horizon_is(b->horizon);
  real n[3] = {n_in[0], n_in[1], n_in[2]};
  real wo[3] = {wo_in[0], wo_in[1], wo_in[2]};
  h->status = FN(mend_if_needed)(n, 1) | FN(mend_if_needed)(wo, 0);
  if (h->status & SHADE_BAD_INPUT)
    return;
  if (FN(is_flat)(b, 1, n, n + 1))
    is = shade_horizon_is(SHADE_HORIZON_HARD);
  h->facets = is.facets;
  h->fade = is.fade;
  memcpy(h->given, n, sizeof n);
  if (is.fade == SHADE_FADE_ESTEVEZ)
    h->alpha2 = FN(estevez_alpha2)(n[0], n[1], n[2]);
  if (is.bends) {
    FN(normal) bent = FN(bend)(n[0], n[1], n[2], wo[0], wo[1], wo[2]);
    n[0] = bent.x;
    n[1] = bent.y;
    n[2] = bent.z;
  }
  FN(prepare_hard)(b, n, wo, h);
}

static __attribute__((noinline)) unsigned
FN(hit_one)(const bsdf *b, const FN(bsdf_hit) * h, const real wi_in[3], real f[3], real *cosine) {
  real wi[3] = {wi_in[0], wi_in[1], wi_in[2]};
  const unsigned status = h->status | FN(mend_if_needed)(wi, 0);
  f[0] = f[1] = f[2] = 0;
  *cosine = 0;
  if (status & SHADE_BAD_INPUT)
    return status;
  if (h->facets)
    return status | FN(facets_one)(b, h, wi, f, cosine);
  real factor = 1;
  if (h->fade == SHADE_FADE_ESTEVEZ)
    factor = FN(shadow_of_alpha2)(h->alpha2, wi[0], wi[1], wi[2]);
  else if (h->fade == SHADE_FADE_CHIANG)
    factor = FN(shadow_chiang)(h->given[0], h->given[1], h->given[2], wi[0], wi[1], wi[2]);
  const unsigned found = FN(hard_one)(b, h, wi, f, cosine);
  for (int c = 0; c < 3; c++)
    f[c] *= factor;
  return status | found;
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
