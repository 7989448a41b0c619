/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One precision of one instruction set: included twice by each src/isa_*.c, with
 * SHADE_FLOAT 1 and 0. Leaves shade one sample, passes run leaves over a block of
 * BLOCK samples in scratch on the stack, and the entries below run the passes.
 */
#include "real.h"

#include "elementary.h"
#include "leaf_detail.h"
#include "leaf_distribution.h"
#include "leaf_brdf.h"
#include "leaf_fresnel.h"
#include "leaf_diffuse.h"
#include "leaf_repair.h"
#include "leaf_horizon.h"
#include "pass_repair.h"
#include "pass_detail.h"
#include "pass_distribution.h"
#include "pass_brdf.h"
#include "pass_diffuse.h"
#include "pass_ggx.h"

#if SHADE_FLOAT
#include "leaf_fast.h"
#include "pass_fast.h"
#endif

/* n and h to D; h is unit for the warps. t, xx and yy are scratch. */
static void FN(pass_lobe)(const bsdf *b, size_t count, const real *nx, const real *ny,
                          const real *nz, const real *hx, const real *hy, const real *hz, real *t,
                          real *xx, real *yy, real *d) {
  if (b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    FN(pass_ashikhmin_shirley)(b, count, nx, ny, nz, hx, hy, hz, d);
  } else {
    FN(pass_detail)(b->map, count, nx, ny, nz, hx, hy, hz, t, xx, yy);
    FN(pass_distribution)(b, count, t, xx, yy, d);
  }
  if (b->conserve)
    FN(pass_conserve)(b, count, nx, ny, nz, hx, hy, hz, d);
}

/* The same for one sample. */
static inline real FN(lobe)(const bsdf *b, const real n[3], real hx, real hy, real hz) {
  real d = FN(distribution)(b, FN(detail)(b->map, n, hx, hy, hz));
  if (b->conserve)
    d *= FN(warp_stretch)(n[0], n[1], n[2], hx, hy, hz, b->map == SHADE_MAP_DEFORM_SMOOTH,
                          FN(projected)(b));
  return d;
}

/*
 * Samples a block. Where the arrays are beyond the caches, 4 KiB of them did best (EPYC, AVX-512,
 * float: D 1.47 ns at BLOCK, 1.31 so; GGX whole 4.3 and 2.9); in a cache BLOCK does.
 */
LEAF size_t FN(block_of)(size_t count, size_t arrays) {
  const size_t sample = arrays * sizeof(real), far = (size_t)1 << 20;
  return count > far / sample ? 4096 / sample / 16 * 16 : BLOCK;
}

static unsigned FN(mdf_batch)(const bsdf *b, size_t count, const real *nx, const real *ny,
                              const real *nz, const real *hx, const real *hy, const real *hz,
                              real *out) {
  real t[BLOCK], xx[BLOCK], yy[BLOCK];
  FN(mended) room;
  unsigned status = SHADE_OK;
  const size_t step = FN(block_of)(count, 7);
  for (size_t start = 0; start < count; start += step) {
    size_t size = count - start < step ? count - start : step;
    real *d = out + start;
    const real *v[2][3] = {{nx + start, ny + start, nz + start},
                           {hx + start, hy + start, hz + start}};
    unsigned block = FN(mend_block)(size, 2, v, &room);
#if SHADE_FLOAT
    if (b->fast)
      pass_fast(b, size, v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[1][2], d);
    else
#endif
      FN(pass_lobe)
    (b, size, v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[1][2], t, xx, yy, d);
    if (block & SHADE_BAD_INPUT)
      for (size_t i = 0; i < size; i++)
        if (room.void_lane[i])
          d[i] = 0;
    status |= block;
  }
  return status;
}

/* kd of channel c, less what Ashikhmin and Shirley give to the specular part. */
static inline real FN(diffuse_scale)(const bsdf *b, int c) {
  return b->diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY ? b->FN(kd)[c] * (1 - b->FN(f0)[c])
                                                       : b->FN(kd)[c];
}

/* q = Phi/(pi cos) of a block; v as in bsdf_hard_batch, ly and vy are scratch. */
static void FN(diffuse_block)(const bsdf *b, size_t size, const real *const v[3][3],
                              const real *cosi, const real *coso, real *ly, real *vy, real *q) {
  const int x = b->fibres_along_y, y = !x; /* the fibre's axis, and the other */
  if (b->map == SHADE_MAP_NONE) {
    memcpy(ly, v[1][y], size * sizeof *ly);
    memcpy(vy, v[2][y], size * sizeof *vy);
  } else {
    FN(pass_across)(size, v[0][x], v[0][y], v[0][2], v[1][x], v[1][y], v[1][2], ly);
    FN(pass_across)(size, v[0][x], v[0][y], v[0][2], v[2][x], v[2][y], v[2][2], vy);
  }
  FN(pass_diffuse)(b, size, ly, cosi, vy, coso, q);
}

static unsigned FN(bsdf_hard_batch)(const bsdf *b, size_t count, const FN(shade_lanes) * in,
                                    const FN(shade_result) * out) {
  real hx[BLOCK], hy[BLOCK], hz[BLOCK], t[BLOCK], xx[BLOCK], yy[BLOCK];
  real d[BLOCK], coso[BLOCK], white[BLOCK], hwo[BLOCK];
  FN(mended) room;
  const real grazing = b->fresnel == SHADE_FRESNEL_SCHLICK ? 1 : 0;
  const real *f0[3] = {in->f0r, in->f0g, in->f0b};
  real *rgb[3] = {out->r, out->g, out->b};
  const int plain = !f0[0] && !f0[1] && !f0[2] &&
                    (b->fresnel == SHADE_FRESNEL_NONE || b->fresnel == SHADE_FRESNEL_SCHLICK);
  unsigned status = SHADE_OK;
  const size_t step = FN(block_of)(count, 13);
  for (size_t start = 0; start < count; start += step) {
    size_t size = count - start < step ? count - start : step;
    const real *v[3][3] = {{in->nx + start, in->ny + start, in->nz + start},
                           {in->wix + start, in->wiy + start, in->wiz + start},
                           {in->wox + start, in->woy + start, in->woz + start}};
    real *cosi = out->cosine + start;
    unsigned block = FN(mend_block)(size, 3, v, &room);
    int none;
    if (FN(is_fused)(b)) {
      none = FN(pass_fused)(b, size, v, hwo, cosi, coso, d);
    } else {
      none = FN(pass_half)(size, v[1][0], v[1][1], v[1][2], v[2][0], v[2][1], v[2][2], hx, hy, hz,
                           hwo);
      if (b->map >= SHADE_MAP_DEFORM_LINEAR)
        FN(pass_unit)(size, hx, hy, hz);
      FN(pass_lobe)(b, size, v[0][0], v[0][1], v[0][2], hx, hy, hz, t, xx, yy, d);
      if (b->map == SHADE_MAP_NONE)
        FN(pass_cosines_none)(size, v[1][2], v[2][2], cosi, coso);
      else
        FN(pass_cosines)
      (size, v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[1][2], v[2][0], v[2][1], v[2][2], cosi,
       coso);
      if (b->brdf == SHADE_BRDF_MICROFACET)
        for (int k = 1; k <= 2; k++) {
          FN(pass_detail)
          (b->shadow_map, size, v[0][0], v[0][1], v[0][2], v[k][0], v[k][1], v[k][2], t, xx, yy);
          FN(pass_smith)(b, size, xx, yy, k == 1 ? hx : hy); /* h is done with */
        }
      FN(pass_brdf)(b, size, hwo, cosi, coso, hx, hy, d);
    }
    if (none) {
      status |= SHADE_BAD_INPUT;
      for (size_t i = 0; i < size; i++)
        if (FN(opposite)(v[1][0][i], v[1][1][i], v[1][2][i], v[2][0][i], v[2][1][i], v[2][2][i]))
          d[i] = coso[i] = 0;
    }
    if (b->has_diffuse)
      FN(diffuse_block)(b, size, v, cosi, coso, xx, yy, t);
    if (block & SHADE_BAD_INPUT)
      for (size_t i = 0; i < size; i++)
        if (room.void_lane[i])
          d[i] = cosi[i] = t[i] = 0;
    if (plain) {
      FN(pass_colour)
      (size, grazing, b->FN(f0)[0], b->FN(f0)[1], b->FN(f0)[2], d, hwo, rgb[0] + start,
       rgb[1] + start, rgb[2] + start);
    } else {
      FN(pass_schlick)(size, grazing, hwo, white);
      for (int c = 0; c < 3; c++)
        FN(pass_channel)(b, c, size, f0[c] ? f0[c] + start : NULL, d, hwo, white, rgb[c] + start);
    }
    for (int c = 0; c < 3 && b->has_diffuse; c++)
      if (f0[c] && b->diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY)
        FN(pass_add_diffuse_textured)(size, b->FN(kd)[c], f0[c] + start, t, rgb[c] + start);
      else
        FN(pass_add_diffuse)(size, FN(diffuse_scale)(b, c), t, rgb[c] + start);
    status |= block;
  }
  return status;
}

/* One sample, from the same leaves. Both return status bits. */
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

static unsigned FN(bsdf_hard)(const bsdf *b, const real n_in[3], const real wi_in[3],
                              const real wo_in[3], real f[3], real *cosine) {
  real n[3] = {n_in[0], n_in[1], n_in[2]};
  real wi[3] = {wi_in[0], wi_in[1], wi_in[2]};
  real wo[3] = {wo_in[0], wo_in[1], wo_in[2]};
  unsigned status =
      FN(mend_if_needed)(n, 1) | FN(mend_if_needed)(wi, 0) | FN(mend_if_needed)(wo, 0);
  f[0] = f[1] = f[2] = 0;
  *cosine = 0;
  if (status & SHADE_BAD_INPUT)
    return status;
  if (b->map == SHADE_MAP_NONE) {
    n[0] = n[1] = 0;
    n[2] = 1;
  }
  real cosi = n[0] * wi[0] + n[1] * wi[1] + n[2] * wi[2];
  real coso = n[0] * wo[0] + n[1] * wo[1] + n[2] * wo[2];
  *cosine = cosi > 0 ? cosi : 0;
  real hx = wi[0] + wo[0], hy = wi[1] + wo[1], hz = wi[2] + wo[2];
  if (FN(no_direction)(hx, hy, hz))
    return status | SHADE_BAD_INPUT;
  if (!(cosi > 0 && coso > 0 && wi[2] > 0 && wo[2] > 0))
    return status;
  real hwo = FN(half_cosine)(hx, hy, hz);
  real scale = b->map >= SHADE_MAP_DEFORM_LINEAR ? FN(scale_to_unit)(hx, hy, hz) : 1;
  real d = FN(lobe)(b, n, hx * scale, hy * scale, hz * scale);
  FN(angles) a = {hwo, cosi, coso, 0, 0};
  if (b->brdf == SHADE_BRDF_MICROFACET) {
    a.li = FN(smith)(b, n, wi);
    a.lo = FN(smith)(b, n, wo);
  }
  real value = FN(brdf)(b, d, a);
  for (int c = 0; c < 3; c++)
    f[c] = value * FN(fresnel)(b, c, hwo);
  if (b->has_diffuse) {
    const int x = b->fibres_along_y, y = !x;
    real ly = FN(across_fibre)(n[x], n[y], n[2], wi[x], wi[y], wi[2]);
    real vy = FN(across_fibre)(n[x], n[y], n[2], wo[x], wo[y], wo[2]);
    real phi = FN(diffuse_phi)(b->diffuse, ly, cosi, vy, coso);
    real q = phi * R(0.31830988618379067154) / FN(maximum)(cosi, R(1e-20));
    for (int c = 0; c < 3; c++)
      f[c] += FN(diffuse_scale)(b, c) * q;
  }
  return status;
}

#include "pass_horizon.h"

static unsigned FN(bsdf_batch)(const bsdf *b, size_t count, const FN(shade_lanes) * in,
                               const FN(shade_result) * out) {
  return b->horizon == SHADE_HORIZON_HARD ? FN(bsdf_hard_batch)(b, count, in, out)
                                          : FN(bsdf_horizon_batch)(b, count, in, out);
}

static unsigned FN(bsdf_one)(const bsdf *b, const real n[3], const real wi[3], const real wo[3],
                             real f[3], real *cosine) {
  return b->horizon == SHADE_HORIZON_HARD ? FN(bsdf_hard)(b, n, wi, wo, f, cosine)
                                          : FN(bsdf_horizon)(b, n, wi, wo, f, cosine);
}

/* Phi in the fibre's own frame, by the contract of shade_diffuse_eval. */
static real FN(kernel_diffuse)(shade_diffuse model, const real l_in[3], const real v_in[3]) {
  real l[3] = {l_in[0], l_in[1], l_in[2]}, v[3] = {0, 0, 1};
  int sees = model == SHADE_DIFFUSE_FIBRE_VIEW || model == SHADE_DIFFUSE_POULIN_FOURNIER ||
             model == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY;
  if (sees)
    memcpy(v, v_in, sizeof v);
  if ((FN(mend_if_needed)(l, 0) | FN(mend_if_needed)(v, 0)) & SHADE_BAD_INPUT)
    return 0;
  return l[2] > 0 && v[2] > 0 ? FN(diffuse_phi)(model, l[1], l[2], v[1], v[2]) : 0;
}

/*
 * What one yarn does with the light, for the mixtures of fabric.h, per sample: spec is the
 * BRDF without Fresnel, times the cosine; matt is Phi/pi times the light that enters and leaves by
 * Schlick's white share, (1 - w(n.wi))(1 - w(n.wo)). Both 0 beyond a horizon. No mending:
 * n, wi and wo are unit, n.z > 0.
 */
static void FN(yarn_batch)(const bsdf *b, size_t count, const FN(shade_lanes) * in, real *spec,
                           real *matt) {
  real hx[BLOCK], hy[BLOCK], hz[BLOCK], hwo[BLOCK], t[BLOCK], xx[BLOCK], yy[BLOCK];
  real cosi[BLOCK], coso[BLOCK];
  for (size_t start = 0; start < count; start += BLOCK) {
    size_t size = count - start < BLOCK ? count - start : BLOCK;
    const real *v[3][3] = {{in->nx + start, in->ny + start, in->nz + start},
                           {in->wix + start, in->wiy + start, in->wiz + start},
                           {in->wox + start, in->woy + start, in->woz + start}};
    real *d = spec + start, *q = matt + start;
    FN(pass_half)(size, v[1][0], v[1][1], v[1][2], v[2][0], v[2][1], v[2][2], hx, hy, hz, hwo);
    if (b->map >= SHADE_MAP_DEFORM_LINEAR)
      FN(pass_unit)(size, hx, hy, hz);
    FN(pass_lobe)(b, size, v[0][0], v[0][1], v[0][2], hx, hy, hz, t, xx, yy, d);
    if (b->map == SHADE_MAP_NONE)
      FN(pass_cosines_none)(size, v[1][2], v[2][2], cosi, coso);
    else
      FN(pass_cosines)
    (size, v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[1][2], v[2][0], v[2][1], v[2][2], cosi,
     coso);
    if (b->brdf == SHADE_BRDF_MICROFACET)
      for (int k = 1; k <= 2; k++) {
        FN(pass_detail)
        (b->shadow_map, size, v[0][0], v[0][1], v[0][2], v[k][0], v[k][1], v[k][2], t, xx, yy);
        FN(pass_smith)(b, size, xx, yy, k == 1 ? hx : hy);
      }
    FN(pass_brdf)(b, size, hwo, cosi, coso, hx, hy, d);
    FN(diffuse_block)(b, size, v, cosi, coso, xx, yy, q);
    FN(pass_yarn)(size, cosi, coso, d, q);
  }
}

#include "leaf_sample.h"
#include "pass_sample.h"
#include "pass_cloth.h"
#include "pass_cloth_draw.h"
#include "column.h"
#include "pass_cloth_prepare.h"
#include "entry.h"

#include "leaf_weave.h"
#include "pass_weave.h"
