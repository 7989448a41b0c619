/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Sampling and its density. A block of draws passes: which part (diffuse, or a lobe of the
 * proposal), the eye in the carried frame, a half vector there, the half vector in the local
 * frame, its reflection; then the density and f of the directions that came out, by the same
 * loops that answer for any other direction.
 *
 * The proposal of a material (set up in params.c): a lobe b->draw in the frame b->draw_map,
 * which is a rigid one or a warp; through a warp the density is that of the unmoved lobe
 * times the warp's Jacobian. For `perturb`, whose lobe has no closed integral, three rigid
 * lobes about n: the anisotropic one, the round one of n's own azimuth, the round widest
 * one, which bounds f cos / pdf.
 *
 * Facets with upright mirrors (SHADE_HORIZON_SCHUESSLER) draw by path: the eye sees the bumped
 * facet, or that facet in the mirror; from the bumped facet some light goes on to the mirror.
 */

/*
 * kx, ky and the weight of one of the proposal's lobes, per sample. rotate_approximate is
 * rotate with 1/alpha^2 times L^2; the floor keeps the slopes within what D is capped at.
 */
static void FN(pass_part)(const bsdf *b, int part, size_t count, const real *restrict nx,
                          const real *restrict ny, const real *restrict nz, real *restrict kx,
                          real *restrict ky, real *restrict weight) {
  const real sx = b->FN(sx), sy = b->FN(sy), least = R(1e-3);
  const real per_slope = b->draw == SHADE_DRAW_PHONG ? R(0.5) : R(1.0);
  if (b->draw_parts > 1) {
    const real widest = FN(minimum)(sx, sy);
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      real xx = nx[i] * nx[i], yy = ny[i] * ny[i], r = xx + yy;
      real here = (sx * xx + sy * yy + R(0.5) * TINY * (sx + sy)) / (r + TINY);
      real upright = R(0.5) / (1 + per_slope * (sx * xx + sy * yy));
      kx[i] = part == 0 ? sx : part == 1 ? here : widest;
      ky[i] = part == 0 ? sy : part == 1 ? here : widest;
      weight[i] = part == 0 ? upright : part == 1 ? R(0.5) - upright : R(0.5);
    }
  } else if (b->map == SHADE_MAP_APPROXIMATE_X || b->map == SHADE_MAP_APPROXIMATE_Y) {
    /* Ashikhmin and Shirley's own lobe does not see L */
    const int sees = b->mdf != SHADE_MDF_ASHIKHMIN_SHIRLEY;
    const real *other = b->map == SHADE_MAP_APPROXIMATE_X ? nx : ny;
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      real ll = sees ? other[i] * other[i] + nz[i] * nz[i] : 1;
      kx[i] = sees ? FN(maximum)(sx * ll, least) : sx;
      ky[i] = sees ? FN(maximum)(sy * ll, least) : sy;
      weight[i] = 1;
    }
  } else {
    for (size_t i = 0; i < count; i++) {
      kx[i] = sx;
      ky[i] = sy;
      weight[i] = 1;
    }
  }
}

/* ---- density ---------------------------------------------------------------- */

/* q += weight * density of wi, from half vectors drawn without regard to the eye. */
#define DENSITY_PASS(name)                                                                         \
  static void FN(pass_density_##name)(                                                             \
      size_t count, const real *restrict kx, const real *restrict ky, const real *restrict weight, \
      const real *restrict hwo, const real *restrict t, const real *restrict xx,                   \
      const real *restrict yy, real *restrict q) {                                                 \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(lobe_point) p = {t[i], xx[i], yy[i]};                                                     \
      q[i] += weight[i] * FN(density_##name)(p, kx[i], ky[i]) / FN(maximum)(4 * hwo[i], R(1e-25)); \
    }                                                                                              \
  }

DENSITY_PASS(phong)
DENSITY_PASS(half)
DENSITY_PASS(gaussian)
DENSITY_PASS(ggx)
#undef DENSITY_PASS

/* The same of visible half vectors; oxx and oyy are the eye's slopes, squared. */
#define VISIBLE_PASS(name, distribution, smith)                                                    \
  static void FN(pass_density_##name)(                                                             \
      size_t count, const real *restrict kx, const real *restrict ky, const real *restrict weight, \
      const real *restrict cosine, const real *restrict oxx, const real *restrict oyy,             \
      const real *restrict t, const real *restrict xx, const real *restrict yy,                    \
      real *restrict q) {                                                                          \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(lobe_point) p = {t[i], xx[i], yy[i]};                                                     \
      real d = FN(distribution)(p, kx[i], ky[i], FN(slope_peak)(kx[i], ky[i]));                    \
      real l = FN(smith)(oxx[i] / kx[i] + oyy[i] / ky[i]);                                         \
      q[i] += weight[i] * FN(density_visible)(d, cosine[i], l);                                    \
    }                                                                                              \
  }

VISIBLE_PASS(visible_ggx, ggx, smith_ggx)
VISIBLE_PASS(visible_gaussian, beckmann, smith_gaussian)
#undef VISIBLE_PASS

/* Half vectors' density through a warp: times J h.z / m.z, m the moved half vector. */
#define CARRY_PASS(name, smooth)                                                                   \
  static void FN(pass_carry_##name)(size_t count, const real *restrict nx,                         \
                                    const real *restrict ny, const real *restrict nz,              \
                                    const real *restrict hx, const real *restrict hy,              \
                                    const real *restrict hz, real *restrict q) {                   \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) q[i] *=                                 \
        FN(warp_stretch)(nx[i], ny[i], nz[i], hx[i], hy[i], hz[i], smooth, 0);                     \
  }

CARRY_PASS(linear, 0)
CARRY_PASS(smooth, 1)
#undef CARRY_PASS

static void FN(pass_share)(const bsdf *b, size_t count, const real *restrict cosine,
                           real *restrict share) {
  const real s = b->FN(share_lobe), d = b->FN(share_diffuse);
  const real grazing =
      b->fresnel == SHADE_FRESNEL_SCHLICK || b->fresnel == SHADE_FRESNEL_F82 ? R(1.0) : R(0.0);
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    share[i] = FN(lobe_share)(s, grazing, d, cosine[i]);
}

/* The whole density: the share of the lobe's, and the rest about the normal, where Lambert
 * is met by the cosine and the fibres by as much again that is even. */
static void FN(pass_mix)(const bsdf *b, size_t count, const real *restrict share,
                         const real *restrict cosi, real *restrict q) {
  const real even = b->draw_even ? R(0.5) : R(0.0);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real matt = (even * R(0.5) + (1 - even) * cosi[i]) * R(0.31830988618379067154);
    q[i] = share[i] * q[i] + (1 - share[i]) * matt;
  }
}

/* Arrays that the passes of a block share. */
typedef struct FN(draw_room) {
  real h[3][BLOCK], hwo[BLOCK], cosi[BLOCK], coso[BLOCK];
  real t[BLOCK], xx[BLOCK], yy[BLOCK], oxx[BLOCK], oyy[BLOCK];
  real kx[BLOCK], ky[BLOCK], weight[BLOCK];
} FN(draw_room);

/* The density of wi = v[1] under n = v[0] and wo = v[2], all mended. Returns status bits. */
static unsigned FN(density_block)(const bsdf *b, size_t size, const real *const v[3][3],
                                  FN(draw_room) * m, real *restrict pdf) {
  real *hx = m->h[0], *hy = m->h[1], *hz = m->h[2];
  const int warp = b->map >= SHADE_MAP_DEFORM_LINEAR;
  const int visible = b->draw == SHADE_DRAW_VISIBLE_GGX || b->draw == SHADE_DRAW_VISIBLE_GAUSSIAN;
  unsigned status = SHADE_OK;
  if (FN(pass_half)(size, v[1][0], v[1][1], v[1][2], v[2][0], v[2][1], v[2][2], hx, hy, hz, m->hwo))
    status = SHADE_BAD_INPUT;
  if (b->map == SHADE_MAP_NONE)
    FN(pass_cosines_none)(size, v[1][2], v[2][2], m->cosi, m->coso);
  else
    FN(pass_cosines)
  (size, v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[1][2], v[2][0], v[2][1], v[2][2], m->cosi,
   m->coso);
  if (warp)
    FN(pass_unit)(size, hx, hy, hz);
  FN(pass_detail)
  (b->draw_map, size, v[0][0], v[0][1], v[0][2], hx, hy, hz, m->t, m->xx, m->yy);
  for (size_t i = 0; i < size; i++)
    pdf[i] = 0;
  if (visible) /* weight is scratch here */
    FN(pass_detail)
  (b->draw_map, size, v[0][0], v[0][1], v[0][2], v[2][0], v[2][1], v[2][2], m->weight, m->oxx,
   m->oyy);
  for (int part = 0; part < b->draw_parts; part++) {
    FN(pass_part)(b, part, size, v[0][0], v[0][1], v[0][2], m->kx, m->ky, m->weight);
    switch (b->draw) {
    case SHADE_DRAW_HALF:
      FN(pass_density_half)(size, m->kx, m->ky, m->weight, m->hwo, m->t, m->xx, m->yy, pdf);
      break;
    case SHADE_DRAW_GAUSSIAN:
      FN(pass_density_gaussian)(size, m->kx, m->ky, m->weight, m->hwo, m->t, m->xx, m->yy, pdf);
      break;
    case SHADE_DRAW_GGX:
      FN(pass_density_ggx)(size, m->kx, m->ky, m->weight, m->hwo, m->t, m->xx, m->yy, pdf);
      break;
    case SHADE_DRAW_VISIBLE_GGX:
      FN(pass_density_visible_ggx)
      (size, m->kx, m->ky, m->weight, m->coso, m->oxx, m->oyy, m->t, m->xx, m->yy, pdf);
      break;
    case SHADE_DRAW_VISIBLE_GAUSSIAN:
      FN(pass_density_visible_gaussian)
      (size, m->kx, m->ky, m->weight, m->coso, m->oxx, m->oyy, m->t, m->xx, m->yy, pdf);
      break;
    default:
      FN(pass_density_phong)(size, m->kx, m->ky, m->weight, m->hwo, m->t, m->xx, m->yy, pdf);
    }
  }
  if (warp)
    (b->map == SHADE_MAP_DEFORM_SMOOTH ? FN(pass_carry_smooth) : FN(pass_carry_linear))(
        size, v[0][0], v[0][1], v[0][2], hx, hy, hz, pdf);
  if (b->has_diffuse) {
    FN(pass_share)(b, size, m->coso, m->weight);
    FN(pass_mix)(b, size, m->weight, m->cosi, pdf);
  }
  for (size_t i = 0; i < size; i++)
    pdf[i] = m->coso[i] > 0 ? pdf[i] : 0;
  return status;
}

/* The normal that the lobe is really about, where the horizon's choice bends it. */
static void FN(bend_block)(const bsdf *b, size_t size, const real *v[3][3], real bent[3][BLOCK]) {
  if (!FN(bends)(b))
    return;
  FN(pass_bend)
  (size, v[0][0], v[0][1], v[0][2], v[2][0], v[2][1], v[2][2], bent[0], bent[1], bent[2]);
  for (int c = 0; c < 3; c++)
    v[0][c] = bent[c];
}

/* How likely the paths of two facets are, from the one that ends in wi to those mirrored. */
static void FN(pass_paths)(size_t count, const real *restrict nx, const real *restrict ny,
                           const real *restrict nz, const real *restrict wix,
                           const real *restrict wiy, const real *restrict wox,
                           const real *restrict woy, const real *restrict woz, real *restrict plain,
                           real *restrict light, real *restrict eye) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real bounced = FN(share_bounced)(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    real bumped = FN(share_bumped)(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    real side = nx[i] * wix[i] + ny[i] * wiy[i];
    plain[i] = bumped * (side > 0 ? 1 - bounced : 1);
    light[i] = bumped * (side < 0 ? bounced : 0);
    eye[i] = FN(share_upright)(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
  }
}

/* What comes by way of the mirrors of two facets. */
static void FN(add_mirrored)(const bsdf *b, size_t size, const real *const v[3][3],
                             FN(draw_room) * m, real *restrict pdf) {
  real x[BLOCK], y[BLOCK], one[BLOCK], plain[BLOCK], mirrored[2][BLOCK];
  FN(pass_paths)
  (size, v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[2][0], v[2][1], v[2][2], plain, mirrored[0],
   mirrored[1]);
  FN(pass_multiply)(size, plain, pdf);
  for (int w = 0; w < 2; w++) {
    const real *to[3][3];
    memcpy(to, v, sizeof to);
    FN(pass_mirror)(size, v[0][0], v[0][1], v[w + 1][0], v[w + 1][1], x, y);
    to[w + 1][0] = x;
    to[w + 1][1] = y;
    FN(density_block)(b, size, to, m, one);
    FN(pass_add_product)(size, mirrored[w], one, pdf);
  }
}

/* density_block for any horizon; 0 for opposite directions, as f is. */
static unsigned FN(density_of_paths)(const bsdf *b, size_t size, const real *const v[3][3],
                                     FN(draw_room) * m, real *restrict pdf) {
  unsigned status = FN(density_block)(b, size, v, m, pdf);
  if (b->horizon == SHADE_HORIZON_SCHUESSLER)
    FN(add_mirrored)(b, size, v, m, pdf);
  if (status)
    for (size_t i = 0; i < size; i++)
      if (FN(opposite)(v[1][0][i], v[1][1][i], v[1][2][i], v[2][0][i], v[2][1][i], v[2][2][i]))
        pdf[i] = 0;
  return status;
}

static unsigned FN(pdf_batch)(const bsdf *b, size_t count, const FN(shade_lanes) * in, real *out) {
  FN(mended) room;
  FN(draw_room) draw;
  real bent[3][BLOCK];
  unsigned status = SHADE_OK;
  for (size_t start = 0; start < count; start += BLOCK) {
    size_t size = count - start < BLOCK ? count - start : BLOCK;
    const real *v[3][3] = {{in->nx + start, in->ny + start, in->nz + start},
                           {in->wix + start, in->wiy + start, in->wiz + start},
                           {in->wox + start, in->woy + start, in->woz + start}};
    unsigned block = FN(mend_block)(size, 3, v, &room);
    FN(bend_block)(b, size, v, bent);
    status |= block | FN(density_of_paths)(b, size, v, &draw, out + start);
    if (block & SHADE_BAD_INPUT)
      for (size_t i = 0; i < size; i++)
        if (room.void_lane[i])
          out[start + i] = 0;
  }
  return status;
}

/* ---- draws ------------------------------------------------------------------ */

#define FRAME_PASS(name)                                                                           \
  /* a direction in the frame */                                                                   \
  static void FN(pass_into_##name)(size_t count, const real *restrict nx, const real *restrict ny, \
                                   const real *restrict nz, const real *restrict wx,               \
                                   const real *restrict wy, const real *restrict wz,               \
                                   real *restrict ox, real *restrict oy) {                         \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(axes) f = FN(axes_##name)(nx[i], ny[i], nz[i]);                                           \
      ox[i] = f.x.x * wx[i] + f.x.y * wy[i] + f.x.z * wz[i];                                       \
      oy[i] = f.y.x * wx[i] + f.y.y * wy[i] + f.y.z * wz[i];                                       \
    }                                                                                              \
  }                                                                                                \
  /* and back, in place */                                                                         \
  static void FN(pass_out_of_##name)(size_t count, const real *restrict nx,                        \
                                     const real *restrict ny, const real *restrict nz,             \
                                     real *restrict hx, real *restrict hy, real *restrict hz) {    \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(axes) f = FN(axes_##name)(nx[i], ny[i], nz[i]);                                           \
      real x = hx[i], y = hy[i], z = hz[i];                                                        \
      hx[i] = f.x.x * x + f.y.x * y + nx[i] * z;                                                   \
      hy[i] = f.x.y * x + f.y.y * y + ny[i] * z;                                                   \
      hz[i] = f.x.z * x + f.y.z * y + nz[i] * z;                                                   \
    }                                                                                              \
  }

FRAME_PASS(rotate)
FRAME_PASS(rotate_y)
FRAME_PASS(shortest_arc)
#undef FRAME_PASS

static void FN(pass_into_frame)(shade_map map, size_t count, const real *const n[3],
                                const real *const w[3], real *ox, real *oy) {
  if (map == SHADE_MAP_ROTATE_X)
    FN(pass_into_rotate)(count, n[0], n[1], n[2], w[0], w[1], w[2], ox, oy);
  else if (map == SHADE_MAP_ROTATE_Y)
    FN(pass_into_rotate_y)(count, n[0], n[1], n[2], w[0], w[1], w[2], ox, oy);
  else if (map == SHADE_MAP_SHORTEST_ARC)
    FN(pass_into_shortest_arc)(count, n[0], n[1], n[2], w[0], w[1], w[2], ox, oy);
  else {
    memcpy(ox, w[0], count * sizeof *ox);
    memcpy(oy, w[1], count * sizeof *oy);
  }
}

static void FN(pass_forward)(size_t count, int smooth, const real *restrict nx,
                             const real *restrict ny, real *restrict hx, real *restrict hy,
                             real *restrict hz) {
  real v[BLOCK];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real scale = FN(scale_to_unit)(hx[i], hy[i], hz[i]);
    hx[i] *= scale;
    hy[i] *= scale;
    real z = hz[i] * scale;
    real linear = z * z / (1 + FN(root)(hx[i] * hx[i] + hy[i] * hy[i]));
    v[i] = smooth ? FN(warp_start)(nx[i], ny[i], hx[i], hy[i]) : 1 - linear;
    hz[i] = linear;
  }
  for (int step = 0; smooth && step < FN(warp_steps); step++)
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      v[i] = FN(warp_step)(nx[i], ny[i], hx[i], hy[i], v[i]);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real w = smooth ? 1 - v[i] : hz[i];
    FN(triple) h = FN(warp_shifted)(nx[i], ny[i], hx[i], hy[i], w);
    hx[i] = h.x;
    hy[i] = h.y;
    hz[i] = h.z;
  }
}

/* From the carried frame to the local one, in place. */
static void FN(pass_out_of_frame)(shade_map map, size_t count, const real *const n[3], real *hx,
                                  real *hy, real *hz) {
  if (map == SHADE_MAP_ROTATE_X)
    FN(pass_out_of_rotate)(count, n[0], n[1], n[2], hx, hy, hz);
  else if (map == SHADE_MAP_ROTATE_Y)
    FN(pass_out_of_rotate_y)(count, n[0], n[1], n[2], hx, hy, hz);
  else if (map == SHADE_MAP_SHORTEST_ARC)
    FN(pass_out_of_shortest_arc)(count, n[0], n[1], n[2], hx, hy, hz);
  else if (map == SHADE_MAP_DEFORM_LINEAR)
    FN(pass_forward)(count, 0, n[0], n[1], hx, hy, hz);
  else if (map == SHADE_MAP_DEFORM_SMOOTH)
    FN(pass_forward)(count, 1, n[0], n[1], hx, hy, hz);
}

#define DRAW_PASS(name)                                                                            \
  static void FN(pass_draw_##name)(size_t count, const real *restrict u1, const real *restrict u2, \
                                   const real *restrict kx, const real *restrict ky,               \
                                   real *restrict hx, real *restrict hy, real *restrict hz) {      \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      FN(triple) h = FN(draw_##name)(u1[i], u2[i], kx[i], ky[i]);                                  \
      hx[i] = h.x;                                                                                 \
      hy[i] = h.y;                                                                                 \
      hz[i] = h.z;                                                                                 \
    }                                                                                              \
  }

DRAW_PASS(phong)
DRAW_PASS(half)
DRAW_PASS(gaussian)
DRAW_PASS(ggx)
#undef DRAW_PASS

/* h holds the eye on entry, in the lobe's frame. */
static void FN(pass_draw_visible_ggx)(size_t count, const real *restrict u1,
                                      const real *restrict u2, const real *restrict kx,
                                      const real *restrict ky, real *restrict hx, real *restrict hy,
                                      real *restrict hz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    FN(triple) o = {hx[i], hy[i], hz[i]};
    FN(triple) h = FN(draw_visible_ggx)(u1[i], u2[i], kx[i], ky[i], o);
    hx[i] = h.x;
    hy[i] = h.y;
    hz[i] = h.z;
  }
}

/* t from u under (rise, lean); all searches of a block take their steps together. */
static void FN(pass_slope)(size_t count, const real *restrict u, const real *restrict rise,
                           const real *restrict lean, real *restrict t) {
  real inverse[BLOCK], low[BLOCK], high[BLOCK], v[BLOCK];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    FN(slope_search) s = FN(slope_start)(u[i], rise[i], lean[i]);
    inverse[i] = s.inverse;
    low[i] = s.low;
    high[i] = s.high;
    v[i] = s.u;
    t[i] = s.t;
  }
  for (int step = 0; step < FN(slope_steps); step++)
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      FN(slope_search) s = {v[i], rise[i], lean[i], inverse[i], low[i], high[i], t[i]};
      s = FN(slope_step)(s);
      low[i] = s.low;
      high[i] = s.high;
      t[i] = s.t;
    }
}

static void FN(pass_draw_visible_gaussian)(size_t count, const real *restrict u1,
                                           const real *restrict u2, const real *restrict kx,
                                           const real *restrict ky, real *restrict hx,
                                           real *restrict hy, real *restrict hz) {
  real rise[BLOCK], lean[BLOCK], along[BLOCK], across[BLOCK];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    FN(triple) o = {hx[i], hy[i], hz[i]};
    FN(stretched) e = FN(stretch_eye)(1 / FN(root)(kx[i]), 1 / FN(root)(ky[i]), o);
    rise[i] = e.rise;
    lean[i] = e.lean;
  }
  FN(pass_slope)(count, u1, rise, lean, along);
  for (size_t i = 0; i < count; i++) {
    rise[i] = 1;
    lean[i] = 0;
  }
  FN(pass_slope)(count, u2, rise, lean, across);
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    FN(triple) o = {hx[i], hy[i], hz[i]};
    FN(triple) h = FN(visible_gaussian)(along[i], across[i], kx[i], ky[i], o);
    hx[i] = h.x;
    hy[i] = h.y;
    hz[i] = h.z;
  }
}

/*
 * Split u where the first `share` of it means yes: both halves are uniform again. The floor
 * and the cap keep what is left in [0, 1).
 */
LEAF real FN(remapped)(real u, real share, int yes) {
  real v = yes ? u / FN(maximum)(share, R(1e-20)) : (u - share) / FN(maximum)(1 - share, R(1e-20));
  return FN(minimum)(FN(maximum)(v, 0), BELOW_ONE);
}

/* Uniform numbers within [0, 1); a NaN marks the lane. */
static int FN(pass_uniform)(size_t count, const real *restrict u, real *restrict out) {
  int bad = 0;
#pragma omp simd reduction(| : bad)
  for (size_t i = 0; i < count; i++) {
    bad |= u[i] != u[i];
    out[i] = FN(minimum)(FN(maximum)(u[i], 0), BELOW_ONE);
  }
  return bad;
}

/* Which of the proposal's lobes: kx and ky of the chosen one, u1 remapped. */
static void FN(choose_part)(const bsdf *b, size_t size, const real *const n[3], real *u1, real *kx,
                            real *ky) {
  real px[BLOCK], py[BLOCK], weight[BLOCK], left[BLOCK];
  FN(pass_part)(b, 0, size, n[0], n[1], n[2], kx, ky, left);
  if (b->draw_parts == 1)
    return;
  /* left: what the chosen part and those after it weigh */
  real chosen[BLOCK];
  for (size_t i = 0; i < size; i++)
    chosen[i] = u1[i] < left[i];
  for (size_t i = 0; i < size; i++)
    u1[i] = FN(remapped)(u1[i], left[i], chosen[i] > 0);
  for (int part = 1; part < b->draw_parts; part++) {
    FN(pass_part)(b, part, size, n[0], n[1], n[2], px, py, weight);
    const int last = part + 1 == b->draw_parts;
#pragma omp simd
    for (size_t i = 0; i < size; i++) {
      real rest = FN(maximum)(1 - left[i], R(1e-20));
      real share = last ? R(1.0) : weight[i] / rest;
      int open = chosen[i] == 0;
      int yes = u1[i] < share;
      real v = FN(remapped)(u1[i], share, yes);
      u1[i] = open ? v : u1[i];
      kx[i] = open ? px[i] : kx[i];
      ky[i] = open ? py[i] : ky[i];
      chosen[i] = (open & yes) ? 1 : chosen[i];
      left[i] += weight[i];
    }
  }
}

/* Which lanes draw from the diffuse part, and u1 for what follows. */
static void FN(pass_split)(size_t count, const real *restrict share, real *restrict u,
                           real *restrict matt) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    int lobe = u[i] < share[i];
    u[i] = FN(remapped)(u[i], share[i], lobe);
    matt[i] = lobe ? R(0.0) : R(1.0);
  }
}

/* A direction about the pole by the cosine, or evenly for the first `even` of u1. */
static void FN(pass_draw_matt)(size_t count, real even, const real *restrict u1,
                               const real *restrict u2, real *restrict wx, real *restrict wy,
                               real *restrict wz) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    int flat = u1[i] < even;
    FN(pair) p = FN(circle)(FN(remapped)(u1[i], even, flat));
    real zz = 1 - u2[i];
    real z = flat ? zz : FN(root)(zz);
    real sine = flat ? FN(root)(u2[i] * (1 + zz)) : FN(root)(u2[i]);
    wx[i] = sine * p.x;
    wy[i] = sine * p.y;
    wz[i] = z;
  }
}

/* wo mirrored by h, any length, into h; the other part's draw where it was chosen. Unit. */
static void FN(pass_reflect)(size_t count, const real *restrict wox, const real *restrict woy,
                             const real *restrict woz, real *restrict hx, real *restrict hy,
                             real *restrict hz, real *restrict lost) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real size2 = hx[i] * hx[i] + hy[i] * hy[i] + hz[i] * hz[i];
    real along = hx[i] * wox[i] + hy[i] * woy[i] + hz[i] * woz[i];
    real twice = 2 * along / FN(maximum)(size2, TINY);
    lost[i] = along > 0 ? R(0.0) : R(1.0);
    hx[i] = twice * hx[i] - wox[i];
    hy[i] = twice * hy[i] - woy[i];
    hz[i] = twice * hz[i] - woz[i];
  }
}

/* Unit directions; those that point below are lost too, and z stands for what is lost. */
static void FN(pass_settle)(size_t count, real *restrict wx, real *restrict wy, real *restrict wz,
                            real *restrict lost) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real size2 = wx[i] * wx[i] + wy[i] * wy[i] + wz[i] * wz[i];
    int keep = (lost[i] == 0) & (wz[i] > 0) & (size2 > R(0.25));
    real scale = 1 / FN(root)(size2 + TINY);
    wx[i] = keep ? wx[i] * scale : 0;
    wy[i] = keep ? wy[i] * scale : 0;
    wz[i] = keep ? wz[i] * scale : 1;
    lost[i] = keep ? R(0.0) : R(1.0);
  }
}

/*
 * Which path each lane takes, and u for what follows: bounce where light of the bumped facet
 * goes on to the mirror; x and y of the eye, mirrored where it sees that facet in the mirror.
 */
static void FN(pass_choose_path)(size_t count, const real *restrict nx, const real *restrict ny,
                                 const real *restrict nz, const real *restrict wox,
                                 const real *restrict woy, const real *restrict woz,
                                 real *restrict u, real *restrict x, real *restrict y,
                                 real *restrict bounce) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real share = FN(share_bumped)(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    real left = 1 - FN(share_bounced)(nx[i], ny[i], nz[i], wox[i], woy[i], woz[i]);
    int bumped = u[i] < share;
    real v = FN(remapped)(u[i], share, bumped);
    int plain = v < left;
    real again = FN(remapped)(v, left, plain);
    u[i] = bumped ? again : v;
    bounce[i] = (bumped & !plain) ? R(1.0) : R(0.0);
    real step = bumped ? 0 : FN(mirror_step)(nx[i], ny[i], wox[i], woy[i]);
    x[i] = wox[i] - step * nx[i];
    y[i] = woy[i] - step * ny[i];
  }
}

/* Light that left the bumped facet, on to the mirror; what never left it is lost. */
static void FN(pass_bounce)(size_t count, const real *restrict nx, const real *restrict ny,
                            const real *restrict nz, const real *restrict bounce, real *restrict wx,
                            real *restrict wy, const real *restrict wz, real *restrict lost) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    real side = nx[i] * wx[i] + ny[i] * wy[i];
    real step = FN(mirror_step)(nx[i], ny[i], wx[i], wy[i]);
    step = ((bounce[i] > 0) & (side > 0)) ? step : 0;
    lost[i] = side + nz[i] * wz[i] > 0 ? lost[i] : 1;
    wx[i] -= step * nx[i];
    wy[i] -= step * ny[i];
  }
}

static unsigned FN(sample_batch)(const bsdf *b, size_t count, const FN(shade_sample_lanes) * in,
                                 const FN(shade_sample_result) * out) {
  FN(mended) room;
  FN(draw_room) draw;
  real u1[BLOCK], u2[BLOCK], share[BLOCK], matt[BLOCK], lost[BLOCK], bent[3][BLOCK];
  real seen[2][BLOCK], bounce[BLOCK];
  const int facets = b->horizon == SHADE_HORIZON_SCHUESSLER;
  unsigned status = SHADE_OK;
  for (size_t start = 0; start < count; start += BLOCK) {
    size_t size = count - start < BLOCK ? count - start : BLOCK;
    const real *v[3][3] = {{in->nx + start, in->ny + start, in->nz + start},
                           {in->wox + start, in->woy + start, in->woz + start}};
    unsigned block = FN(mend_block)(size, 2, v, &room);
    const int odd =
        FN(pass_uniform)(size, in->u1 + start, u1) | FN(pass_uniform)(size, in->u2 + start, u2);
    v[2][0] = v[1][0], v[2][1] = v[1][1], v[2][2] = v[1][2];
    const real *const n[3] = {v[0][0], v[0][1], v[0][2]}; /* f bends it for itself */
    FN(bend_block)(b, size, v, bent);
    const real *const eye[3] = {v[2][0], v[2][1], v[2][2]};
    if (facets) {
      FN(pass_choose_path)
      (size, n[0], n[1], n[2], eye[0], eye[1], eye[2], u1, seen[0], seen[1], bounce);
      v[2][0] = v[1][0] = seen[0];
      v[2][1] = v[1][1] = seen[1];
    }
    real *hx = draw.h[0], *hy = draw.h[1], *hz = draw.h[2];

    real *coso = draw.coso;
    if (b->map == SHADE_MAP_NONE)
      FN(pass_cosines_none)(size, v[2][2], v[2][2], draw.cosi, coso);
    else
      FN(pass_cosines)
    (size, v[0][0], v[0][1], v[0][2], v[2][0], v[2][1], v[2][2], v[2][0], v[2][1], v[2][2],
     draw.cosi, coso);
    if (b->has_diffuse) {
      FN(pass_share)(b, size, coso, share);
      FN(pass_split)(size, share, u1, matt);
      FN(pass_draw_matt)(size, b->draw_even ? R(0.5) : R(0.0), u1, u2, draw.oxx, draw.oyy, draw.xx);
      FN(pass_out_of_frame)
      (b->map == SHADE_MAP_NONE ? SHADE_MAP_NONE : SHADE_MAP_SHORTEST_ARC, size, v[0], draw.oxx,
       draw.oyy, draw.xx);
    }
    FN(choose_part)(b, size, v[0], u1, draw.kx, draw.ky);
    switch (b->draw) {
    case SHADE_DRAW_HALF:
      FN(pass_draw_half)(size, u1, u2, draw.kx, draw.ky, hx, hy, hz);
      break;
    case SHADE_DRAW_GAUSSIAN:
      FN(pass_draw_gaussian)(size, u1, u2, draw.kx, draw.ky, hx, hy, hz);
      break;
    case SHADE_DRAW_GGX:
      FN(pass_draw_ggx)(size, u1, u2, draw.kx, draw.ky, hx, hy, hz);
      break;
    case SHADE_DRAW_VISIBLE_GGX:
    case SHADE_DRAW_VISIBLE_GAUSSIAN:
      FN(pass_into_frame)(b->draw_map, size, v[0], v[2], hx, hy);
      memcpy(hz, coso, size * sizeof *hz);
      if (b->draw == SHADE_DRAW_VISIBLE_GGX)
        FN(pass_draw_visible_ggx)(size, u1, u2, draw.kx, draw.ky, hx, hy, hz);
      else
        FN(pass_draw_visible_gaussian)(size, u1, u2, draw.kx, draw.ky, hx, hy, hz);
      break;
    default:
      FN(pass_draw_phong)(size, u1, u2, draw.kx, draw.ky, hx, hy, hz);
    }
    FN(pass_out_of_frame)(b->draw_map, size, v[0], hx, hy, hz);
    FN(pass_reflect)(size, v[2][0], v[2][1], v[2][2], hx, hy, hz, lost);
    if (b->has_diffuse)
      for (size_t i = 0; i < size; i++)
        if (matt[i] > 0) {
          hx[i] = draw.oxx[i];
          hy[i] = draw.oyy[i];
          hz[i] = draw.xx[i];
          lost[i] = 0;
        }
    real *wi[3] = {out->wix + start, out->wiy + start, out->wiz + start};
    memcpy(wi[0], hx, size * sizeof *hx);
    memcpy(wi[1], hy, size * sizeof *hy);
    memcpy(wi[2], hz, size * sizeof *hz);
    FN(pass_settle)(size, wi[0], wi[1], wi[2], lost);
    if (facets) {
      FN(pass_bounce)(size, n[0], n[1], n[2], bounce, wi[0], wi[1], wi[2], lost);
      v[2][0] = eye[0];
      v[2][1] = eye[1];
    }

    /* what these directions are worth, as for any others */
    v[1][0] = wi[0], v[1][1] = wi[1], v[1][2] = wi[2];
    real *pdf = out->pdf + start;
    FN(density_of_paths)(b, size, v, &draw, pdf);
    FN(shade_lanes)
    lanes = {sizeof lanes,
             n[0],
             n[1],
             n[2],
             wi[0],
             wi[1],
             wi[2],
             v[2][0],
             v[2][1],
             v[2][2],
             in->f0r ? in->f0r + start : NULL,
             in->f0g ? in->f0g + start : NULL,
             in->f0b ? in->f0b + start : NULL};
    FN(shade_result)
    result = {sizeof result, out->r + start, out->g + start, out->b + start, out->cosine + start};
    FN(bsdf_batch)(b, size, &lanes, &result);
    for (size_t i = 0; i < size; i++) {
      int empty = (block & SHADE_BAD_INPUT && room.void_lane[i]) |
                  (odd && (in->u1[start + i] != in->u1[start + i] ||
                           in->u2[start + i] != in->u2[start + i]));
      status |= empty ? (unsigned)SHADE_BAD_INPUT : 0u;
      if (empty || lost[i] > 0 || !(pdf[i] > 0)) {
        wi[0][i] = wi[1][i] = wi[2][i] = pdf[i] = result.cosine[i] = 0;
        result.r[i] = result.g[i] = result.b[i] = 0;
        status |= SHADE_NO_SAMPLE;
      }
    }
    status |= block;
  }
  return status;
}

/* One direction: a batch of one. */
static unsigned FN(pdf_one)(const bsdf *b, const real n[3], const real wi[3], const real wo[3],
                            real *pdf) {
  const FN(shade_lanes) lanes = {sizeof lanes, n,      n + 1,  n + 2, wi,   wi + 1, wi + 2,
                                 wo,           wo + 1, wo + 2, NULL,  NULL, NULL};
  return FN(pdf_batch)(b, 1, &lanes, pdf);
}

static unsigned FN(sample_one)(const bsdf *b, const real n[3], const real wo[3], const real u[2],
                               real wi[3], real f[3], real *pdf, real *cosine) {
  const FN(shade_sample_lanes)
      lanes = {sizeof lanes, n, n + 1, n + 2, wo, wo + 1, wo + 2, u, u + 1, NULL, NULL, NULL};
  const FN(shade_sample_result)
      result = {sizeof result, wi, wi + 1, wi + 2, f, f + 1, f + 2, pdf, cosine};
  return FN(sample_batch)(b, 1, &lanes, &result);
}
