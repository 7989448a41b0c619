/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The distributions, a leaf file each, and what all of them are made of. Of a row of table.h the
 * file mdf_<word>.h holds
 *   SHADE_MDF_<NAME>_IS     its traits, errors included, which tests hold it to
 *   <word>                  points of the lobe to D
 *   smith_<word>            (alpha tan)^2 to 1 + 2 Lambda
 *   draw_<word>, density_<word>   half vectors, and their density to that of h
 *   where the normals that an eye sees can be drawn: a row below, and draw_visible_<word>
 * and its line stands in this file: what is missing does not compile.
 */
#ifndef SHADE_MODEL_MDF_H
#define SHADE_MODEL_MDF_H

#include "mdf_ashikhmin_shirley.h"
#include "mdf_beckmann.h"
#include "mdf_ggx.h"
#include "mdf_ward.h"
#include "mdf_ward_half.h"

/* Of which the normals that an eye sees can be drawn, as their traits say. */
#define SHADE_MDF_VISIBLE(ROW) ROW(BECKMANN, beckmann) ROW(GGX, ggx)

#define SHADE_MDF_IS_(NAME, word, value, label, help) [value] = SHADE_MDF_##NAME##_IS,
static inline shade_mdf_traits shade_mdf_is(shade_mdf mdf) {
  static const shade_mdf_traits rows[] = {SHADE_TABLE_MDF(SHADE_MDF_IS_)};
  return rows[mdf];
}

/* A choice of BRDF, or what `auto` stands for with that distribution. */
static inline shade_brdf shade_brdf_with(shade_mdf mdf, shade_brdf brdf) {
  return brdf == SHADE_BRDF_AUTO ? shade_mdf_is(mdf).brdf : brdf;
}

/* By name: D of a point of the lobe. */
LEAF real mdf_value(shade_mdf mdf, lobe_point p, real kx, real ky, real peak) {
  switch (mdf) {
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    return word(p, kx, ky, peak);
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
  return 0;
}

/* 1 + 2 Lambda of (alpha tan)^2. */
LEAF real smith_value(shade_mdf mdf, real w) {
  switch (mdf) {
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    return smith_##word(w);
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
  return 1;
}

/* A half vector in the lobe's frame; `visible`: one that o, in that frame, sees. */
LEAF triple draw_half(shade_mdf mdf, int visible, real u1, real u2, real kx, real ky, triple o) {
  if (visible)
    switch (mdf) {
#define VISIBLE_CASE(NAME, word)                                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    return draw_visible_##word(u1, u2, kx, ky, o);
      SHADE_MDF_VISIBLE(VISIBLE_CASE)
#undef VISIBLE_CASE
    default:
      break;
    }
  switch (mdf) {
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    return draw_##word(u1, u2, kx, ky);
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
  return (triple){0, 0, 1};
}

/*
 * How likely the direction is that the eye o sees by way of h, points of the lobe both; `visible`:
 * drawn from the normals that o sees.
 */
LEAF real half_density(shade_mdf mdf, int visible, lobe_point h, lobe_point o, real kx, real ky,
                       real hwo, real coso) {
  if (visible) {
    const real l = smith_value(mdf, (o.xx * ky + o.yy * kx) / (kx * ky));
    return density_visible(mdf_value(mdf, h, kx, ky, slope_peak(kx, ky)), coso, l);
  }
  real d = 0;
  switch (mdf) {
#define MDF_CASE(NAME, word, value, label, help)                                                   \
  case SHADE_MDF_##NAME:                                                                           \
    d = density_##word(h, kx, ky);                                                                 \
    break;
    SHADE_TABLE_MDF(MDF_CASE)
#undef MDF_CASE
  case SHADE_MDF_COUNT:
    break;
  }
  return d / maximum(4 * hwo, R(1e-25));
}

#endif
