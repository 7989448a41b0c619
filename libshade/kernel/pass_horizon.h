/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The choices of SHADE_TABLE_HORIZON, around the evaluation of `hard`: n bent before it,
 * a factor after it, or three of it.
 */
static int FN(bends)(const bsdf *b) {
  return b->horizon == SHADE_HORIZON_VALID_REFLECTION || b->horizon == SHADE_HORIZON_VALID_ESTEVEZ;
}

static void FN(pass_bend)(size_t count, const real *restrict nx, const real *restrict ny,
                          const real *restrict nz, const real *restrict wox,
                          const real *restrict woy, const real *restrict woz, real *restrict bx,
                          real *restrict by, real *restrict bz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    FN(normal) n = FN(bend)(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    bx[i] = n.x;
    by[i] = n.y;
    bz[i] = n.z;
  }
}

/* factor[i] of a direction w[i] under n[i]. */
#define HORIZON_PASS(name)                                                                         \
  static void FN(pass_##name)(size_t count, const real *restrict nx, const real *restrict ny,      \
                              const real *restrict nz, const real *restrict wx,                    \
                              const real *restrict wy, const real *restrict wz,                    \
                              real *restrict factor) {                                             \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) factor[i] =                             \
        FN(name)(nx[i], ny[i], nz[i], wx[i], wy[i], wz[i]);                                        \
  }

HORIZON_PASS(shadow_estevez)
HORIZON_PASS(shadow_chiang)
HORIZON_PASS(share_bumped)
HORIZON_PASS(share_upright)
#undef HORIZON_PASS

static void FN(pass_mirror)(size_t count, const real *restrict nx, const real *restrict ny,
                            const real *restrict wx, const real *restrict wy, real *restrict mx,
                            real *restrict my) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real step = FN(mirror_step)(nx[i], ny[i], wx[i], wy[i]);
    mx[i] = wx[i] - step * nx[i];
    my[i] = wy[i] - step * ny[i];
  }
}

static void FN(pass_multiply)(size_t count, const real *restrict factor, real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] *= factor[i];
}

/*
 * nz a b, once for all colours. (Within the loop over them gcc moves the product in front, over
 * whole scratch arrays: it then meets what no lane wrote.)
 */
static void FN(pass_weight)(size_t count, const real *restrict nz, const real *restrict a,
                            const real *restrict b, real *restrict weight) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    weight[i] = nz[i] * (a[i] * b[i]);
}

static void FN(pass_add_product)(size_t count, const real *restrict weight, const real *restrict f,
                                 real *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] += weight[i] * f[i];
}

/* One block of facets with normal n and of upright mirrors; v as in bsdf_hard_batch. */
static unsigned FN(two_facets)(const bsdf *b, size_t size, const real *const v[3][3],
                               const FN(shade_lanes) * in, const FN(shade_result) * out) {
  real x[BLOCK], y[BLOCK], rgb[3][BLOCK], unused[BLOCK], weight[BLOCK];
  real see[2][2][BLOCK]; /* [light, eye][bumped, upright] */
  real *to[3] = {out->r, out->g, out->b};
  const FN(shade_result) extra = {sizeof extra, rgb[0], rgb[1], rgb[2], unused};
  for (int w = 0; w < 2; w++) {
    const real *const *d = v[w + 1];
    FN(pass_share_bumped)(size, v[0][0], v[0][1], v[0][2], d[0], d[1], d[2], see[w][0]);
    FN(pass_share_upright)(size, v[0][0], v[0][1], v[0][2], d[0], d[1], d[2], see[w][1]);
  }
  unsigned status = FN(bsdf_hard_batch)(b, size, in, out);
  FN(pass_weight)(size, v[0][2], see[0][0], see[1][0], weight);
  for (int c = 0; c < 3; c++)
    FN(pass_multiply)(size, weight, to[c]);
  for (int w = 0; w < 2; w++) {
    FN(shade_lanes) mirrored = *in;
    const real *const *d = v[w + 1];
    FN(pass_mirror)(size, v[0][0], v[0][1], d[0], d[1], x, y);
    if (w == 0) {
      mirrored.wix = x;
      mirrored.wiy = y;
    } else {
      mirrored.wox = x;
      mirrored.woy = y;
    }
    FN(bsdf_hard_batch)(b, size, &mirrored, &extra);
    FN(pass_weight)(size, v[0][2], see[0][w == 0], see[1][w == 1], weight);
    for (int c = 0; c < 3; c++)
      FN(pass_add_product)(size, weight, rgb[c], to[c]);
  }
  for (size_t i = 0; status & SHADE_BAD_INPUT && i < size; i++)
    if (FN(no_direction)(v[1][0][i] + v[2][0][i], v[1][1][i] + v[2][1][i], v[1][2][i] + v[2][2][i]))
      to[0][i] = to[1][i] = to[2][i] = 0;
  for (size_t i = 0; i < size; i++)
    out->cosine[i] = v[1][2][i] > 0 ? v[1][2][i] : 0;
  return status;
}

/*
 * No bumps here, so that all choices are `hard` (to a rounding for two facets, which are left
 * alone): flat surfaces are not to pay for the others. Needs no mended n.
 */
static int FN(is_flat)(const bsdf *b, size_t count, const real *nx, const real *ny) {
  int bumps = nx[0] != 0 || ny[0] != 0 || b->horizon == SHADE_HORIZON_SCHUESSLER;
  if (bumps)
    return 0;
#pragma omp simd reduction(| : bumps)
  for (size_t i = 0; i < count; i++)
    bumps |= (nx[i] != 0) | (ny[i] != 0);
  return !bumps;
}

static unsigned FN(bsdf_horizon_batch)(const bsdf *b, size_t count, const FN(shade_lanes) * in,
                                       const FN(shade_result) * out) {
  real bent[3][BLOCK];
  FN(mended) room;
  unsigned status = SHADE_OK;
  const size_t step = FN(block_of)(count, 13);
  for (size_t start = 0; start < count; start += step) {
    size_t size = count - start < step ? count - start : step;
    const real *v[3][3] = {{in->nx + start, in->ny + start, in->nz + start},
                           {in->wix + start, in->wiy + start, in->wiz + start},
                           {in->wox + start, in->woy + start, in->woz + start}};
    const int flat = FN(is_flat)(b, size, v[0][0], v[0][1]);
    const unsigned mended = flat ? SHADE_OK : FN(mend_block)(size, 3, v, &room);
    unsigned block = mended;
    FN(shade_lanes)
    lanes = {sizeof lanes,
             v[0][0],
             v[0][1],
             v[0][2],
             v[1][0],
             v[1][1],
             v[1][2],
             v[2][0],
             v[2][1],
             v[2][2],
             in->f0r ? in->f0r + start : NULL,
             in->f0g ? in->f0g + start : NULL,
             in->f0b ? in->f0b + start : NULL};
    const FN(shade_result) result = {sizeof result, out->r + start, out->g + start, out->b + start,
                                     out->cosine + start};
    real *to[4] = {result.r, result.g, result.b, result.cosine},
         *factor = bent[0]; /* once n is shaded with */
    if (flat) {
      block |= FN(bsdf_hard_batch)(b, size, &lanes, &result);
    } else if (b->horizon == SHADE_HORIZON_SCHUESSLER) {
      block |= FN(two_facets)(b, size, v, &lanes, &result);
    } else {
      if (FN(bends)(b)) {
        FN(pass_bend)
        (size, v[0][0], v[0][1], v[0][2], v[2][0], v[2][1], v[2][2], bent[0], bent[1], bent[2]);
        lanes.nx = bent[0];
        lanes.ny = bent[1];
        lanes.nz = bent[2];
      }
      block |= FN(bsdf_hard_batch)(b, size, &lanes, &result);
      if (b->horizon != SHADE_HORIZON_VALID_REFLECTION) {
        (b->horizon == SHADE_HORIZON_CHIANG ? FN(pass_shadow_chiang) : FN(pass_shadow_estevez))(
            size, v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[1][2], factor);
        for (int c = 0; c < 3; c++)
          FN(pass_multiply)(size, factor, to[c]);
      }
    }
    for (size_t i = 0; mended & SHADE_BAD_INPUT && i < size; i++)
      for (int c = 0; c < 4 && room.void_lane[i]; c++)
        to[c][i] = 0;
    status |= block;
  }
  return status;
}

/* The same for one sample. */
static unsigned FN(two_facets_one)(const bsdf *b, const real n[3], const real wi[3],
                                   const real wo[3], real f[3], real *cosine) {
  real more[3], unused;
  real see[2][2];
  const real *w[2] = {wi, wo};
  for (int k = 0; k < 2; k++) {
    see[k][0] = FN(share_bumped)(n[0], n[1], n[2], w[k][0], w[k][1], w[k][2]);
    see[k][1] = FN(share_upright)(n[0], n[1], n[2], w[k][0], w[k][1], w[k][2]);
  }
  unsigned status = FN(bsdf_hard)(b, n, wi, wo, f, cosine);
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
    const real m[3] = {w[k][0] - step * n[0], w[k][1] - step * n[1], w[k][2]};
    FN(bsdf_hard)(b, n, k == 0 ? m : wi, k == 1 ? m : wo, more, &unused);
    for (int c = 0; c < 3; c++)
      f[c] += weight * more[c];
  }
  return status;
}

static unsigned FN(bsdf_horizon)(const bsdf *b, const real n_in[3], const real wi_in[3],
                                 const real wo_in[3], real f[3], real *cosine) {
  if (FN(is_flat)(b, 1, n_in, n_in + 1))
    return FN(bsdf_hard)(b, n_in, wi_in, wo_in, f, cosine);
  real n[3] = {n_in[0], n_in[1], n_in[2]};
  real wi[3] = {wi_in[0], wi_in[1], wi_in[2]};
  real wo[3] = {wo_in[0], wo_in[1], wo_in[2]};
  unsigned status =
      FN(mend_if_needed)(n, 1) | FN(mend_if_needed)(wi, 0) | FN(mend_if_needed)(wo, 0);
  real factor = 1;
  f[0] = f[1] = f[2] = 0;
  *cosine = 0;
  if (status & SHADE_BAD_INPUT)
    return status;
  if (b->horizon == SHADE_HORIZON_SCHUESSLER)
    return status | FN(two_facets_one)(b, n, wi, wo, f, cosine);
  if (b->horizon == SHADE_HORIZON_CHIANG)
    factor = FN(shadow_chiang)(n[0], n[1], n[2], wi[0], wi[1], wi[2]);
  else if (b->horizon != SHADE_HORIZON_VALID_REFLECTION)
    factor = FN(shadow_estevez)(n[0], n[1], n[2], wi[0], wi[1], wi[2]);
  if (FN(bends)(b)) {
    FN(normal) bent = FN(bend)(n[0], n[1], n[2], wo[0], wo[1], wo[2]);
    n[0] = bent.x;
    n[1] = bent.y;
    n[2] = bent.z;
  }
  status |= FN(bsdf_hard)(b, n, wi, wo, f, cosine);
  for (int c = 0; c < 3; c++)
    f[c] *= factor;
  return status;
}
