/* SPDX-License-Identifier: Apache-2.0 */
/* Parameters of one sample: varied_block.h, made a material of. */
#ifndef SHADE_BATCH_VARIED_ONE_H
#define SHADE_BATCH_VARIED_ONE_H

#include "../model/share.h"
#include "entry.h"

static unsigned vary_colour(const real *const given[3], size_t lane, real own[3], real low,
                            real high) {
  int changed = 0;
  for (int c = 0; c < 3; c++)
    if (given[c])
      changed |= pass_within(1, low, high, own[c], given[c] + lane, &own[c]);
  return changed ? SHADE_CLAMPED_PARAMETER : SHADE_OK;
}

static unsigned vary_colours(bsdf *b, const varied_arrays *in, size_t lane) {
  SUFFIX(bsdf_numbers) *own = &b->SUFFIX(numbers);
  unsigned status = vary_colour(in->f0, lane, own->f0, 0, 1);
  status |= vary_colour(in->kd, lane, own->kd, 0, 1);
  if (b->fresnel == SHADE_FRESNEL_F82)
    status |= vary_colour(in->f82, lane, own->tint, 0, 1);
  if (b->fresnel == SHADE_FRESNEL_CONDUCTOR) {
    status |= vary_colour(in->eta, lane, own->tint, R(1e-3), 100);
    status |= vary_colour(in->k, lane, own->k, 0, 100);
  }
  return status;
}

/* The lobe; its numbers change places where its narrow axis is not the material's. */
static unsigned vary_shape(bsdf *b, const varied_arrays *in, size_t lane, real *mirror,
                           int *mirrored) {
  SUFFIX(bsdf_numbers) *own = &b->SUFFIX(numbers);
  const real *at[4] = {in->ax, in->ay, in->ex, in->ey};
  if (!at[0] && !at[1] && !at[2] && !at[3])
    return SHADE_OK;
  for (int k = 0; k < 4; k++)
    at[k] = at[k] ? at[k] + lane : NULL;
  real x, y;
  unsigned status = read_axis(b->exponents, 1, own->kx, at[0], at[2], &x);
  status |= read_axis(b->exponents, 1, own->ky, at[1], at[3], &y);
  const lobe_numbers lobe = b->exponents ? numbers_of_exponents(x, y) : numbers_of_alphas(x, y);
  own->kx = lobe.kx;
  own->ky = lobe.ky;
  own->peak = lobe.peak;
  own->gx = lobe.gx;
  own->gy = lobe.gy;
  if (b->groove_auto && pass_mirrored(1, b->fibres_along_y, &own->kx, &own->ky, mirror)) {
    *mirrored = 1;
    pass_exchange(1, mirror, &own->kx, &own->ky);
    pass_exchange(1, mirror, &own->gx, &own->gy);
  }
  return status;
}

/* The map's slopes. */
static unsigned vary_slopes(const varied_arrays *in, size_t lane, real own[5]) {
  static const real least[5] = {-1000, -1000, 0, -1000000, 0};
  int changed = 0;
  for (int c = 0; c < 5; c++)
    if (in->slopes[c])
      changed |=
          pass_within(1, least[c], c < 2 ? 1000 : 1000000, own[c], in->slopes[c] + lane, &own[c]);
  changed |= bound_slopes(own);
  return changed ? SHADE_CLAMPED_PARAMETER : SHADE_OK;
}

static unsigned entry_vary(const shade_bsdf *given, const bsdf_lanes *lanes, size_t lane,
                           shade_bsdf *out) {
  bsdf_lanes in;
  bsdf copy, *b = bsdf_in(out);
  unsigned status;
  if (bsdf_of(given)->varied || !shade_whole_lanes(lanes, 0, &in, sizeof in)) {
    memmove(out, given, sizeof *out);
    return SHADE_BAD_INPUT;
  }
  const varied_arrays each = varied_from(&in.f0r, &status);
  *b = *for_lanes(bsdf_of(given), &each, &copy);
  SUFFIX(bsdf_numbers) *own = &b->SUFFIX(numbers);
  ROOM mirror[1];
  int mirrored = 0;
  status |= vary_colours(b, &each, lane);
  status |= vary_shape(b, &each, lane, mirror, &mirrored);
  set_shares(b, own);
  b->black = !b->has_specular || (b->black && !each.f0[0] && !each.f0[1] && !each.f0[2]);
  own->c = own->side = 1;
  own->s = 0;
  if (each.groove_x && pass_groove(1, each.groove_x + lane, each.groove_y + lane, &own->c, &own->s))
    status |= SHADE_CLAMPED_PARAMETER;
  if (mirrored)
    pass_axes(1, mirror, &own->c, &own->s, &own->side);
  if (any_slopes(&each))
    status |= vary_slopes(&each, lane, own->slopes);
  if (mirrored || each.groove_x)
    turn_slopes(own->c, own->s, own->side, own->slopes);
  b->varied = 1;
  b->turned = mirrored || each.groove_x;
  if (SHADE_FLOAT)
    widen_numbers(b);
  else
    narrow_numbers(b);
  return status;
}

#endif
