/* SPDX-License-Identifier: Apache-2.0 */
/* D and f over arrays of any length, a block at a time. */

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
  ROOM t[BLOCK], xx[BLOCK], yy[BLOCK];
  FN(mended) room;
  unsigned status = SHADE_OK;
  const FN(shape) own = FN(own_shape)(b);
  const size_t step = FN(block_of)(count, 7);
  for (size_t start = 0; start < count; start += step) {
    size_t size = count - start < step ? count - start : step;
    real *d = out + start;
    FN(vec) n = FN(vec_from)(nx, ny, nz, start), h = FN(vec_from)(hx, hy, hz, start);
    FN(vec) *const v[3] = {&n, &h};
    unsigned block = FN(mend_block)(size, 2, v, &room);
    FN(pass_lobe)(b, &own, size, n, h, t, xx, yy, d);
    if (block & SHADE_BAD_INPUT)
      for (size_t i = 0; i < size; i++)
        if (room.void_lane[i])
          d[i] = 0;
    status |= block;
  }
  return status;
}

static unsigned FN(bsdf_batch)(const bsdf *given, size_t count, const FN(shade_lanes) * in,
                               const FN(varied) * varied, const FN(shade_result) * out) {
  FN(mended) room;
  FN(varied_room) each;
  bsdf copy;
  unsigned status = SHADE_OK;
  const bsdf *b = varied ? FN(for_lanes)(given, varied, &copy) : given;
  const size_t step = FN(block_of)(count, 13);
  FN(block) s;
  FN(start_block)(b, &s);
  for (size_t start = 0; start < count; start += step) {
    s.count = count - start < step ? count - start : step;
    s.n = FN(vec_from)(in->nx, in->ny, in->nz, start);
    s.wi = FN(vec_from)(in->wix, in->wiy, in->wiz, start);
    s.wo = FN(vec_from)(in->wox, in->woy, in->woz, start);
    FN(vec) *const v[3] = {&s.n, &s.wi, &s.wo};
    const unsigned mended = FN(mend_block)(s.count, 3, v, &room);
    status |= mended;
    if (varied)
      status |= FN(read_varied)(b, varied, start, FN(is_fused)(b), &s, &each);
    const FN(results) to = {{out->r + start, out->g + start, out->b + start}, out->cosine + start};
    status |= FN(shade_block)(b, &s, &to);
    for (size_t i = 0; mended & SHADE_BAD_INPUT && i < s.count; i++)
      if (room.void_lane[i])
        to.rgb[0][i] = to.rgb[1][i] = to.rgb[2][i] = to.cosine[i] = 0;
  }
  return status;
}
