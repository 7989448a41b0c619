/* SPDX-License-Identifier: Apache-2.0 */
/* f and its density over a block, by whichever paths the material's horizon has. */
#ifndef SHADE_BATCH_PATHS_BLOCK_H
#define SHADE_BATCH_PATHS_BLOCK_H

#include "mutual_block.h"

/* f and the cosine by the material's horizon. Directions are mended. */
static unsigned shade_block(const bsdf *b, const sample_block *s, const results *out) {
  const shade_horizon_traits is = shade_horizon_is(b->horizon);
  const size_t size = s->count;
  if (is.mutual)
    return s->bumps ? bumps_block(b, s, out) : hard_block(b, s, out);
  if (b->horizon == SHADE_HORIZON_HARD || is_flat(b, size, s->n.x, s->n.y))
    return hard_block(b, s, out);
  if (is.facets)
    return facets_block(b, s, out);
  vec_room bent;
  sample_block about = *s;
  if (is.bends) {
    pass_bend(size, s->n, s->wo, &bent);
    about.n = vec_in(&bent);
  }
  const unsigned status = hard_block(b, &about, out);
  if (is.fade != SHADE_FADE_NOT) {
    real *factor = bent.x; /* n is shaded with */
    (is.fade == SHADE_FADE_CHIANG ? pass_shadow_chiang : pass_shadow_estevez)(size, s->n, s->wi,
                                                                              factor);
    for (int c = 0; c < 3; c++)
      pass_multiply(size, factor, out->rgb[c]);
  }
  return status;
}

/* density_block for any horizon; 0 for opposite directions, as f is. */
static unsigned density_of_paths(const bsdf *b, const sample_block *s, draw_room *m,
                                 real *restrict pdf) {
  unsigned status = s->bumps ? bumps_density_block(b, s, m, pdf) : density_block(b, s, m, pdf);
  if (shade_horizon_is(b->horizon).facets)
    add_mirrored(b, s, m, pdf);
  if (status)
    for (size_t i = 0; i < s->count; i++)
      if (opposite(s->wi.x[i], s->wi.y[i], s->wi.z[i], s->wo.x[i], s->wo.y[i], s->wo.z[i]))
        pdf[i] = 0;
  return status;
}

#endif
