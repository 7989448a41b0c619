/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The distributions, a leaf file each, and what all of them are made of. Of a row of table.h the
 * file mdf_<word>.h holds
 *   SHADE_MDF_<NAME>_IS     its traits, errors included, which tests hold it to
 *   SHADE_MDF_<NAME>_FORM   what <word> reads: SLOPES (lobe_point) or RATIO (lobe_ratio)
 *   <word>                  points of the lobe to D
 *   smith_<word>            (alpha tan)^2 to 1 + 2 Lambda
 *   draw_<word>, density_<word>   half vectors, and their density to that of h
 *   where the normals that an eye sees can be drawn: a row below, and in visible_block.h
 *   pass_draw_visible_<word>
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

#endif
