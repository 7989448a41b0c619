/* SPDX-License-Identifier: Apache-2.0 */
/* D and f over arrays of any length, a block at a time. */
#ifndef SHADE_BATCH_BSDF_BATCH_H
#define SHADE_BATCH_BSDF_BATCH_H

#include "direction_block.h"
#include "horizon_block.h"

/*
 * Samples a block. Where the arrays are beyond the caches, 4 KiB of them did best (EPYC, AVX-512,
 * float: D 1.47 ns at BLOCK, 1.31 so; GGX whole 4.3 and 2.9); in a cache BLOCK does.
 */
LEAF size_t block_of(size_t count, size_t arrays) {
  const size_t sample = arrays * sizeof(real), far = (size_t)1 << 20;
  return count > far / sample ? 4096 / sample / 16 * 16 : BLOCK;
}

static unsigned mdf_batch(const bsdf *b, size_t count, const real *nx, const real *ny,
                          const real *nz, const real *hx, const real *hy, const real *hz,
                          real *out) {
  ROOM t[BLOCK], xx[BLOCK], yy[BLOCK];
  mended_room room;
  unsigned status = SHADE_OK;
  const lobe_shape own = own_shape(b);
  const size_t step = block_of(count, 7);
  for (size_t start = 0; start < count; start += step) {
    size_t size = count - start < step ? count - start : step;
    real *d = out + start;
    vec n = vec_from(nx, ny, nz, start), h = vec_from(hx, hy, hz, start);
    vec *const v[3] = {&n, &h};
    unsigned block = mend_block(size, 2, v, &room);
    pass_lobe(b, &own, size, n, h, t, xx, yy, d);
    if (block & SHADE_BAD_INPUT)
      for (size_t i = 0; i < size; i++)
        if (room.void_lane[i])
          d[i] = 0;
    status |= block;
  }
  return status;
}

static unsigned bsdf_batch(const bsdf *given, size_t count, const bsdf_lanes *in,
                           const varied_arrays *varied, const bsdf_result *out) {
  mended_room room;
  varied_room each;
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = varied ? for_lanes(given, varied, &copy) : given;
  const size_t step = block_of(count, 13);
  sample_block s;
  start_block(b, &s);
  for (size_t start = 0; start < count; start += step) {
    s.count = count - start < step ? count - start : step;
    s.n = vec_from(in->nx, in->ny, in->nz, start);
    s.wi = vec_from(in->wix, in->wiy, in->wiz, start);
    s.wo = vec_from(in->wox, in->woy, in->woz, start);
    vec *const v[3] = {&s.n, &s.wi, &s.wo};
    const unsigned mended = mend_block(s.count, 3, v, &room);
    status |= mended;
    if (varied)
      status |= read_varied(b, varied, start, is_fused(b), &s, &each);
    const results to = {{out->r + start, out->g + start, out->b + start}, out->cosine + start};
    status |= shade_block(b, &s, &to);
    for (size_t i = 0; mended & SHADE_BAD_INPUT && i < s.count; i++)
      if (room.void_lane[i])
        to.rgb[0][i] = to.rgb[1][i] = to.rgb[2][i] = to.cosine[i] = 0;
  }
  return status;
}

#endif
