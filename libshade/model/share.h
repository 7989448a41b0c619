/* SPDX-License-Identifier: Apache-2.0 */
/* What share of draws goes where. */
#ifndef SHADE_MODEL_SHARE_H
#define SHADE_MODEL_SHARE_H

#include "bsdf.h"
#include "fresnel.h"

/* A channel's part of the mean reflectances that draws are shared out by: of the lobe at normal
 * incidence, and of the diffuse part. */
LEAF real lobe_mean(int conductor, real f0, real eta, real k) {
  const real k2 = k * k, metal = ((eta - 1) * (eta - 1) + k2) / ((eta + 1) * (eta + 1) + k2);
  return (conductor ? metal : f0) / 3;
}
LEAF real diffuse_mean(int less_f0, real f0, real kd) {
  return kd * (1 - (less_f0 ? f0 : 0)) / 3;
}

/* Those means of a material's numbers. */
LEAF void set_shares(const bsdf *b, SUFFIX(bsdf_numbers) * own) {
  const int conductor = !shade_fresnel_is(b->fresnel).f0;
  const int less_f0 = shade_diffuse_is(b->diffuse).less_f0;
  own->share_lobe = own->share_diffuse = 0;
  for (int c = 0; c < 3; c++) {
    own->share_lobe += lobe_mean(conductor, own->f0[c], own->tint[c], own->k[c]);
    own->share_diffuse += diffuse_mean(less_f0, own->f0[c], own->kd[c]);
  }
  if (!b->has_specular)
    own->share_lobe = 0;
}

/*
 * Share of the draws that go to the specular lobe beside a diffuse part: its reflectance at
 * the eye's angle against the diffuse one, and at least a tenth for either that there is.
 */
LEAF real lobe_share(real s, real grazing, real d, real cosine) {
  real specular = s + grazing * (1 - s) * schlick_weight(minimum(cosine, 1));
  real share = specular / maximum(specular + d, R(1e-20));
  share = minimum(maximum(share, R(0.1)), R(0.9));
  share = d > 0 ? share : 1;
  return s + grazing > 0 ? share : 0;
}

/*
 * For facets and upright mirrors: share of the bumped facet's draws that go on to the mirror
 * before they leave. That facet's light w goes past the mirror by nz w.z : side, and the mirror
 * lets out no more than nz w.z of its own: so the split is that of the mirror image of wo,
 * which a narrow lobe surrounds, but not below the one that bounds f cos / pdf by 1 + cot(tilt)
 * times the lobe's own. A share that followed w would need a third uniform number.
 */
LEAF real share_bounced(real nx, real ny, real nz, real wox, real woy, real woz) {
  real side2 = nx * nx + ny * ny, along = nx * wox + ny * woy;
  real twice = 2 * (along + nz * woz);
  real side = maximum(twice * side2 - along, 0);
  real past = nz * maximum(twice * nz - woz, 0);
  real least = minimum(side, past);
  real here = least / (past + least + TINY);
  real slope = root(side2);
  return maximum(here, R(0.5) * slope / (slope + nz));
}

#endif
