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

/* f without Fresnel of a lit pair, whose sum is h; n is z where the method ignores it. */
LEAF real FN(specular_one)(const bsdf *b, const real n[3], const real wi[3], const real wo[3],
                           real hx, real hy, real hz, real hwo, real cosi, real coso) {
  if (FN(is_fused)(b))
    return FN(fused)(b, n, wi, wo).f;
  real scale = b->warp != SHADE_RIGID ? FN(scale_to_unit)(hx, hy, hz) : 1;
  FN(angles) a = {hwo, cosi, coso, 0, 0};
  if (b->brdf == SHADE_BRDF_MICROFACET) {
    a.li = FN(smith)(b, n, wi);
    a.lo = FN(smith)(b, n, wo);
  }
  /* rounded, as a batch does that keeps them */
  hx = FN(multiply_add)(hx, scale, 0);
  hy = FN(multiply_add)(hy, scale, 0);
  hz = FN(multiply_add)(hz, scale, 0);
  return FN(brdf)(b, FN(lobe)(b, n, hx, hy, hz), a);
}

/* Phi of a lit pair. */
LEAF real FN(phi_one)(const bsdf *b, const real n[3], const real wi[3], const real wo[3], real cosi,
                      real coso) {
  const int k = b->fibres_along_y, l = !k;
  real ly = FN(across_fibre)(n[k], n[l], n[2], wi[k], wi[l], wi[2]);
  real vy = FN(across_fibre)(n[k], n[l], n[2], wo[k], wo[l], wo[2]);
  return FN(diffuse_phi)(b->diffuse, ly, cosi, vy, coso);
}

/* f and the cosine, 0 beyond the horizons of n and z. Directions are mended. */
static unsigned FN(hard_one)(const bsdf *b, const real n_in[3], const real wi[3], const real wo[3],
                             real f[3], real *cosine) {
  const int flat = b->carry.map == SHADE_MAP_NONE;
  const real n[3] = {flat ? 0 : n_in[0], flat ? 0 : n_in[1], flat ? 1 : n_in[2]};
  /* as the loops take them, which go along y by exchanging x and y */
  const int one = FN(is_fused)(b), x = one && b->carry.map == SHADE_MAP_ROTATE_Y, y = !x;
  real cosi = FN(dot)(n[x], n[y], n[2], wi[x], wi[y], wi[2]);
  real coso = FN(dot)(n[x], n[y], n[2], wo[x], wo[y], wo[2]);
  real hx = wi[0] + wo[0], hy = wi[1] + wo[1], hz = wi[2] + wo[2];
  f[0] = f[1] = f[2] = 0;
  *cosine = cosi > 0 ? cosi : 0;
  if (FN(no_direction)(hx, hy, hz))
    return SHADE_BAD_INPUT;
  if (!(cosi > 0 && coso > 0 && wi[2] > 0 && wo[2] > 0))
    return SHADE_OK;
  real hwo = FN(half_cosine)(hx, hy, hz);
  real value = FN(specular_one)(b, n, wi, wo, hx, hy, hz, hwo, cosi, coso);
  for (int c = 0; c < 3; c++)
    f[c] = value * FN(fresnel)(b, c, hwo);
  if (b->has_diffuse) {
    real phi = FN(phi_one)(b, n, wi, wo, cosi, coso);
    real q = phi * R(0.31830988618379067154) / FN(maximum)(cosi, R(1e-20));
    for (int c = 0; c < 3; c++)
      f[c] += FN(diffuse_scale)(b, c) * q;
  }
  return SHADE_OK;
}

/* As yarn_batch. */
static void FN(yarn_one)(const bsdf *b, const real n_in[3], const real wi[3], const real wo[3],
                         real *spec, real *matt) {
  const int flat = b->carry.map == SHADE_MAP_NONE;
  const real n[3] = {flat ? 0 : n_in[0], flat ? 0 : n_in[1], flat ? 1 : n_in[2]};
  const real cosi = FN(dot)(n[0], n[1], n[2], wi[0], wi[1], wi[2]);
  const real coso = FN(dot)(n[0], n[1], n[2], wo[0], wo[1], wo[2]);
  const real hx = wi[0] + wo[0], hy = wi[1] + wo[1], hz = wi[2] + wo[2];
  *spec = *matt = 0;
  if (!(FN(lit_cosine)(cosi, coso, wi[2], wo[2]) > 0))
    return;
  const real hwo = FN(half_cosine)(hx, hy, hz);
  const real enter = 1 - FN(schlick_weight)(FN(minimum)(cosi, 1));
  const real leave = 1 - FN(schlick_weight)(FN(minimum)(coso, 1));
  *spec = FN(specular_one)(b, n, wi, wo, hx, hy, hz, hwo, cosi, coso) * cosi;
  *matt = FN(phi_one)(b, n, wi, wo, cosi, coso) * R(0.31830988618379067154) * enter * leave;
}

static unsigned FN(facets_one)(const bsdf *b, const real n[3], const real wi[3], const real wo[3],
                               real f[3], real *cosine) {
  real more[3], unused;
  real see[2][2];
  const real *w[2] = {wi, wo};
  for (int k = 0; k < 2; k++) {
    see[k][0] = FN(share_bumped)(n[0], n[1], n[2], w[k][0], w[k][1], w[k][2]);
    see[k][1] = FN(share_upright)(n[0], n[1], n[2], w[k][0], w[k][1], w[k][2]);
  }
  unsigned status = FN(hard_one)(b, n, wi, wo, f, cosine);
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
    FN(hard_one)(b, n, k == 0 ? m : wi, k == 1 ? m : wo, more, &unused);
    for (int c = 0; c < 3; c++)
      f[c] += weight * more[c];
  }
  return status;
}

static unsigned FN(bsdf_one)(const bsdf *b, const real n_in[3], const real wi_in[3],
                             const real wo_in[3], real f[3], real *cosine) {
  const shade_horizon_traits is = shade_horizon_is(b->horizon);
  real n[3] = {n_in[0], n_in[1], n_in[2]};
  real wi[3] = {wi_in[0], wi_in[1], wi_in[2]};
  real wo[3] = {wo_in[0], wo_in[1], wo_in[2]};
  unsigned status =
      FN(mend_if_needed)(n, 1) | FN(mend_if_needed)(wi, 0) | FN(mend_if_needed)(wo, 0);
  f[0] = f[1] = f[2] = 0;
  *cosine = 0;
  if (status & SHADE_BAD_INPUT)
    return status;
  if (b->horizon == SHADE_HORIZON_HARD || FN(is_flat)(b, 1, n, n + 1))
    return status | FN(hard_one)(b, n, wi, wo, f, cosine);
  if (is.facets)
    return status | FN(facets_one)(b, n, wi, wo, f, cosine);
  real factor = 1;
  if (is.fade == SHADE_FADE_CHIANG)
    factor = FN(shadow_chiang)(n[0], n[1], n[2], wi[0], wi[1], wi[2]);
  else if (is.fade == SHADE_FADE_ESTEVEZ)
    factor = FN(shadow_estevez)(n[0], n[1], n[2], wi[0], wi[1], wi[2]);
  if (is.bends) {
    FN(normal) bent = FN(bend)(n[0], n[1], n[2], wo[0], wo[1], wo[2]);
    n[0] = bent.x;
    n[1] = bent.y;
    n[2] = bent.z;
  }
  status |= FN(hard_one)(b, n, wi, wo, f, cosine);
  for (int c = 0; c < 3; c++)
    f[c] *= factor;
  return status;
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
