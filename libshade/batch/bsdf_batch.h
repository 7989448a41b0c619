/* SPDX-License-Identifier: Apache-2.0 */
/* D and f over arrays of any length, a block at a time. */
#ifndef SHADE_BATCH_BSDF_BATCH_H
#define SHADE_BATCH_BSDF_BATCH_H

#include "paths_block.h"

static unsigned entry_mdf_batch(const shade_bsdf *given, size_t count, const real *nx,
                                const real *ny, const real *nz, const real *hx, const real *hy,
                                const real *hz, real *out) {
  const bsdf *b = bsdf_of(given);
  if (count && b->varied)
    return SHADE_BAD_INPUT;
  ROOM t[BLOCK], xx[BLOCK], yy[BLOCK];
  mended_room room;
  varied_room each;
  unsigned status = SHADE_OK;
  sample_block s;
  own_shape(b, count, &each, &s);
  for (size_t start = 0; start < count; start += BLOCK) {
    const size_t size = count - start < BLOCK ? count - start : BLOCK;
    real *d = out + start;
    vec n = vec_from(nx, ny, nz, start), h = vec_from(hx, hy, hz, start);
    vec *const v[3] = {&n, &h};
    const unsigned mended = mend_block(size, 2, v, &room);
    pass_lobe(b, &s.shape, size, n, h, t, xx, yy, d);
    for (size_t i = 0; mended & SHADE_BAD_INPUT && i < size; i++)
      d[i] = room.void_lane[i] ? 0 : d[i];
    status |= mended;
  }
  return status;
}

static unsigned bsdf_batch(const bsdf *given, size_t count, const bsdf_lanes *in,
                           const varied_arrays *varied, const bsdf_result *out) {
  mended_room room;
  varied_room each;
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = for_lanes(given, varied, &copy);
  sample_block s;
  own_block(b, count, &each, &s);
  for (size_t start = 0; start < count; start += BLOCK) {
    s.count = count - start < BLOCK ? count - start : BLOCK;
    const unsigned read = read_lanes(b, in, varied, start, &s, &each, &room);
    const results to = {{out->r + start, out->g + start, out->b + start}, out->cosine + start};
    status |= read | shade_block(b, &s, &to);
    for (size_t i = 0; read & SHADE_BAD_INPUT && i < s.count; i++)
      if (room.void_lane[i])
        to.rgb[0][i] = to.rgb[1][i] = to.rgb[2][i] = to.cosine[i] = 0;
  }
  return status;
}

#endif
