/* SPDX-License-Identifier: Apache-2.0 */
/* A material made ready for evaluation: how n moves h, what directions are drawn from. */
#include <math.h>
#include <string.h>

#include "shade/shade.h"
#include "bsdf.h"
#include "params.h"

#define PI 3.14159265358979323846

/* ratio_only: Ashikhmin-Shirley sees neither a common scale of x and y, nor L. */
static shade_map resolve(const bsdf *b, int ratio_only, int groove_y) {
  shade_map short_by_l = groove_y ? SHADE_MAP_APPROXIMATE_Y : SHADE_MAP_APPROXIMATE_X;
  switch (b->detail) {
  case SHADE_DETAIL_PERTURB:
    return ratio_only ? SHADE_MAP_PERTURB_RATIO : SHADE_MAP_PERTURB;
  case SHADE_DETAIL_GRAM_SCHMIDT:
    /* its x' is x without its part along n: the x' of groove transport along y */
    return ratio_only ? SHADE_MAP_APPROXIMATE_Y : SHADE_MAP_ROTATE_Y;
  case SHADE_DETAIL_ROTATE:
    return ratio_only ? short_by_l : groove_y ? SHADE_MAP_ROTATE_Y : SHADE_MAP_ROTATE_X;
  case SHADE_DETAIL_ROTATE_APPROXIMATE:
    return short_by_l;
  case SHADE_DETAIL_SHORTEST_ARC:
    return SHADE_MAP_SHORTEST_ARC;
  case SHADE_DETAIL_DEFORM_LINEAR:
  case SHADE_DETAIL_DEFORM_LINEAR_CONSERVING:
    return SHADE_MAP_DEFORM_LINEAR;
  case SHADE_DETAIL_DEFORM_SMOOTH:
  case SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING:
    return SHADE_MAP_DEFORM_SMOOTH;
  default:
    return SHADE_MAP_NONE;
  }
}

/* No more than the lobe needs: a round one is carried exactly by perturb. */
static shade_detail choose_detail(const bsdf *b) {
  return b->kx == b->ky ? SHADE_DETAIL_PERTURB : SHADE_DETAIL_ROTATE;
}

/* What directions are drawn from; see kernel/pass_sample.h. */
static void setup_draws(bsdf *b, const shade_params *p, int groove_y) {
  const int warp = b->map >= SHADE_MAP_DEFORM_LINEAR;
  const int visible = b->brdf == SHADE_BRDF_MICROFACET && !warp;
  const double per_alpha = b->mdf == SHADE_MDF_WARD ? 2 : 1;
  b->sx = b->kx * per_alpha;
  b->sy = b->ky * per_alpha;
  switch (b->mdf) {
  case SHADE_MDF_WARD_HALF:
    b->draw = SHADE_DRAW_HALF;
    break;
  case SHADE_MDF_BECKMANN:
    b->draw = visible ? SHADE_DRAW_VISIBLE_GAUSSIAN : SHADE_DRAW_GAUSSIAN;
    break;
  case SHADE_MDF_GGX:
    b->draw = visible ? SHADE_DRAW_VISIBLE_GGX : SHADE_DRAW_GGX;
    break;
  default: /* Ward too: with exponents 2/alpha^2 its lobe is within this one */
    b->draw = SHADE_DRAW_PHONG;
  }
  b->draw_parts = 1;
  b->draw_map = resolve(b, 0, groove_y);
  if (b->detail == SHADE_DETAIL_PERTURB) { /* a round lobe is carried by any rigid frame */
    b->draw_map = SHADE_MAP_SHORTEST_ARC;
    b->draw_parts = b->kx == b->ky ? 1 : 3;
  }
  if (b->detail == SHADE_DETAIL_ROTATE_APPROXIMATE)
    b->draw_map = groove_y ? SHADE_MAP_ROTATE_Y : SHADE_MAP_ROTATE_X;
  b->draw_even =
      b->diffuse != SHADE_DIFFUSE_LAMBERT && b->diffuse != SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY;
  for (int c = 0; c < 3; c++) {
    double f0 = b->f0[c], k2 = b->k[c] * b->k[c];
    double left = b->diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY ? 1 - f0 : 1;
    if (b->fresnel == SHADE_FRESNEL_CONDUCTOR)
      f0 = ((p->eta[c] - 1) * (p->eta[c] - 1) + k2) / ((p->eta[c] + 1) * (p->eta[c] + 1) + k2);
    b->share_lobe += f0 / 3;
    b->share_diffuse += b->kd[c] * left / 3;
  }
  b->sxf = (float)b->sx;
  b->syf = (float)b->sy;
  b->share_lobef = (float)b->share_lobe;
  b->share_diffusef = (float)b->share_diffuse;
}

unsigned shade_bsdf_setup(shade_bsdf *out, const shade_params *given) {
  unsigned status = SHADE_OK;
  const shade_params p = shade_params_within_ranges(given, &status);
  bsdf *b = bsdf_in(out);
  memset(out, 0, sizeof *out);
  b->mdf = p.mdf;
  b->brdf = p.brdf;
  b->detail = p.detail;
  b->fresnel = p.fresnel;
  b->diffuse = p.diffuse;

  if (b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY) {
    b->kx = p.ex;
    b->ky = p.ey;
    b->gx = 2 / (b->kx + 2);
    b->gy = 2 / (b->ky + 2);
    b->peak = sqrt((b->kx + 1) * (b->ky + 1)) / (2 * PI);
  } else {
    b->gx = p.ax * p.ax;
    b->gy = p.ay * p.ay;
    b->kx = 1 / b->gx;
    b->ky = 1 / b->gy;
    b->peak = 1 / (PI * p.ax * p.ay);
  }

  int groove_y = p.groove == SHADE_GROOVE_Y || (p.groove == SHADE_GROOVE_AUTO && b->ky > b->kx);
  if (b->detail == SHADE_DETAIL_AUTO)
    b->detail = choose_detail(b);
  b->fibres_along_y = groove_y;
  b->horizon = b->detail == SHADE_DETAIL_NONE ? SHADE_HORIZON_HARD : p.horizon;
  b->map = resolve(b, b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY, groove_y);
  b->shadow_map = b->map >= SHADE_MAP_DEFORM_LINEAR ? SHADE_MAP_PERTURB : resolve(b, 0, groove_y);

  b->conserve = b->detail == SHADE_DETAIL_DEFORM_LINEAR_CONSERVING ||
                b->detail == SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING;
  b->fast = p.fast && b->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY &&
            (b->map == SHADE_MAP_NONE || b->map == SHADE_MAP_PERTURB_RATIO ||
             b->map == SHADE_MAP_APPROXIMATE_X || b->map == SHADE_MAP_APPROXIMATE_Y);
  b->kxf = (float)b->kx;
  b->kyf = (float)b->ky;
  b->gxf = (float)b->gx;
  b->gyf = (float)b->gy;
  b->peakf = (float)b->peak;
  for (int c = 0; c < 3; c++) {
    b->f0[c] = p.f0[c];
    b->f0f[c] = (float)b->f0[c];
    if (b->fresnel == SHADE_FRESNEL_F82)
      b->tint[c] = p.f82[c];
    if (b->fresnel == SHADE_FRESNEL_CONDUCTOR) {
      b->tint[c] = p.eta[c];
      b->k[c] = p.k[c];
    }
    b->kd[c] = p.kd[c];
    b->has_diffuse |= b->kd[c] > 0;
    b->kdf[c] = (float)b->kd[c];
    b->tintf[c] = (float)b->tint[c];
    b->kf[c] = (float)b->k[c];
  }
  setup_draws(b, &p, groove_y);
  return status;
}
