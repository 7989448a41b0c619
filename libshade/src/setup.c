/* SPDX-License-Identifier: Apache-2.0 */
/* A material made ready for evaluation: how n moves h, what directions are drawn from. */
#include <math.h>
#include <string.h>

#include "shade/shade.h"
#include "../model/bsdf.h"
#include "../batch/isa.h"
#include "../model/mdf.h"
#include "../model/share.h"
#include "params.h"

#define PI 3.14159265358979323846

/* No more than the lobe needs: a round one is carried exactly by perturb. */
static shade_detail choose_detail(const bsdf *b) {
  return b->numbers.kx == b->numbers.ky ? SHADE_DETAIL_PERTURB : SHADE_DETAIL_ROTATE;
}

/* ratio: the distribution sees neither a common scale of x and y, nor L. */
static shade_carry carry(shade_detail detail, int ratio, int groove_y, int round) {
  const shade_detail_traits is = shade_detail_is(detail);
  shade_carry c;
  c.map = (ratio ? is.ratio : is.slopes)[groove_y];
  c.shadow = is.shadow[groove_y];
  c.frame = shade_map_is(is.slopes[groove_y]).frame;
  c.parts = is.no_lobe && !round ? 3 : 1;
  c.short_by_l = !ratio && detail == SHADE_DETAIL_ROTATE_APPROXIMATE;
  return c;
}

/* What directions are drawn from; see model/draw.h. */
static void setup_draws(bsdf *b) {
  const shade_mdf_traits mdf = shade_mdf_is(b->mdf);
  const shade_diffuse_traits diffuse = shade_diffuse_is(b->diffuse);
  b->visible = mdf.visible && b->brdf == SHADE_BRDF_MICROFACET && b->warp == SHADE_RIGID;
  b->numbers.proposal = mdf.proposal;
  b->numbers.per_slope = mdf.per_slope;
  b->draw_even = diffuse.fibres;
  set_shares(b, &b->numbers);
}

shade_brdf shade_params_brdf(const shade_params *given) {
  unsigned unused = SHADE_OK;
  const shade_params p = shade_params_within_ranges(given, &unused);
  return shade_brdf_with(p.mdf, p.brdf);
}

unsigned shade_bsdf_setup(shade_bsdf *out, const shade_params *given) {
  unsigned status = SHADE_OK;
  const shade_params p = shade_params_within_ranges(given, &status);
  bsdf *b = bsdf_in(out);
  memset(out, 0, sizeof *out);
  b->isa = shade_isa_chosen();
  b->mdf = p.mdf;
  b->brdf = shade_brdf_with(p.mdf, p.brdf);
  b->detail = p.detail;
  b->fresnel = p.fresnel;
  b->diffuse = p.diffuse;

  const shade_mdf_traits mdf = shade_mdf_is(b->mdf);
  b->exponents = shade_mdf_reads_exponents(b->mdf);
  b->projected = mdf.projected;
  if (b->exponents) {
    b->numbers.kx = p.ex;
    b->numbers.ky = p.ey;
    b->numbers.gx = 2 / (b->numbers.kx + 2);
    b->numbers.gy = 2 / (b->numbers.ky + 2);
    b->numbers.peak = sqrt((b->numbers.kx + 1) * (b->numbers.ky + 1)) / (2 * PI);
  } else {
    b->numbers.gx = p.ax * p.ax;
    b->numbers.gy = p.ay * p.ay;
    b->numbers.kx = 1 / b->numbers.gx;
    b->numbers.ky = 1 / b->numbers.gy;
    b->numbers.peak = 1 / (PI * p.ax * p.ay);
  }

  b->groove_auto = p.groove == SHADE_GROOVE_AUTO;
  b->fibres_along_y = b->groove_auto ? b->numbers.ky > b->numbers.kx : p.groove == SHADE_GROOVE_Y;
  b->detail_auto = b->detail == SHADE_DETAIL_AUTO;
  if (b->detail_auto)
    b->detail = choose_detail(b);
  const shade_detail_traits detail = shade_detail_is(b->detail);
  b->horizon = detail.ignores_n ? SHADE_HORIZON_HARD : p.horizon;
  b->carry = carry(b->detail, mdf.ratio, b->fibres_along_y, b->numbers.kx == b->numbers.ky);
  b->uneven =
      carry(b->detail_auto ? SHADE_DETAIL_ROTATE : b->detail, mdf.ratio, b->fibres_along_y, 0);
  b->warp = shade_map_is(b->carry.map).kind;
  b->conserve = detail.conserve;
  b->has_specular = 1;
  for (int c = 0; c < 5; c++)
    b->numbers.slopes[c] = p.slopes[c];
  for (int c = 0; c < 3; c++) {
    b->numbers.f0[c] = p.f0[c];
    if (b->fresnel == SHADE_FRESNEL_F82)
      b->numbers.tint[c] = p.f82[c];
    if (b->fresnel == SHADE_FRESNEL_CONDUCTOR) {
      b->numbers.tint[c] = p.eta[c];
      b->numbers.k[c] = p.k[c];
    }
    b->numbers.kd[c] = p.kd[c];
    b->has_diffuse |= b->numbers.kd[c] > 0;
  }
  const shade_fresnel_traits fresnel = shade_fresnel_is(b->fresnel);
  b->black = fresnel.f0 && !fresnel.tint && !fresnel.grazing &&
             !(b->numbers.f0[0] + b->numbers.f0[1] + b->numbers.f0[2] > 0);
  b->multiscatter =
      p.multiscatter == SHADE_MULTISCATTER_ON && mdf.visible && b->brdf == SHADE_BRDF_MICROFACET;
  setup_draws(b);
  narrow_numbers(b);
  return status;
}
