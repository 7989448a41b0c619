/* SPDX-License-Identifier: Apache-2.0 */
/* What the table of an instruction set holds: the public calls, by what shade.h says of them. */

static unsigned FN(kernel_mdf)(const shade_bsdf *b, const real n[3], const real h[3], real *d) {
  return FN(mdf_one)(bsdf_of(b), n, h, d);
}

static unsigned FN(kernel_mdf_batch)(const shade_bsdf *b, size_t count, const real *nx,
                                     const real *ny, const real *nz, const real *hx, const real *hy,
                                     const real *hz, real *out) {
  return FN(mdf_batch)(bsdf_of(b), count, nx, ny, nz, hx, hy, hz, out);
}

static unsigned FN(kernel_bsdf)(const shade_bsdf *b, const real n[3], const real wi[3],
                                const real wo[3], real f[3], real *cosine) {
  return FN(bsdf_one)(bsdf_of(b), n, wi, wo, f, cosine);
}

static unsigned FN(kernel_prepare)(const shade_bsdf *b, const real n[3], const real wo[3],
                                   FN(shade_bsdf_hit) * room) {
  FN(bsdf_hit) *hit = (FN(bsdf_hit) *)room;
  FN(prepare_one)(bsdf_of(b), n, wo, hit);
  return hit->status;
}

static unsigned FN(kernel_hit)(const shade_bsdf *b, const FN(shade_bsdf_hit) * hit,
                               const real wi[3], real f[3], real *cosine) {
  return FN(hit_one)(bsdf_of(b), (const FN(bsdf_hit) *)hit, wi, f, cosine);
}

static unsigned FN(kernel_pdf)(const shade_bsdf *b, const real n[3], const real wi[3],
                               const real wo[3], real *pdf) {
  return FN(pdf_one)(bsdf_of(b), n, wi, wo, pdf);
}

static unsigned FN(kernel_sample)(const shade_bsdf *b, const real n[3], const real wo[3],
                                  const real u[2], real wi[3], real f[3], real *pdf, real *cosine) {
  return FN(sample_one)(bsdf_of(b), n, wo, u, wi, f, pdf, cosine);
}

/* Arrays that the structures of shade.h must have, from the first on. */
enum { FN(lanes_required) = 9, FN(draws_required) = 8, FN(results_required) = 4 };
_Static_assert(offsetof(FN(shade_lanes), parts) - offsetof(FN(shade_lanes), f0r) ==
                       offsetof(FN(varied), parts) &&
                   offsetof(FN(shade_sample_lanes), parts) -
                           offsetof(FN(shade_sample_lanes), f0r) ==
                       offsetof(FN(varied), parts),
               "both end in the arrays of pass_lanes.h");

/* Whether f0r, or what follows it in shade_lanes, holds anything. One by one, as in lanes.h. */
LEAF int FN(is_varied)(const void *f0r) {
#if defined(__GNUC__)
#pragma GCC unroll 32
#endif
  for (size_t i = 0; i < sizeof(FN(varied)); i += sizeof(void *)) {
    size_t word;
    memcpy(&word, (const char *)f0r + i, sizeof word);
    if (word)
      return 1;
  }
  return 0;
}

/*
 * The parameters of each sample from f0r on, in *v; NULL where there are none. Parts that do not
 * exist are all of them.
 */
static inline const FN(varied) *
    FN(varied_from)(const void *f0r, FN(varied) * v, unsigned *status) {
  const size_t all = SHADE_PART_SPECULAR | SHADE_PART_DIFFUSE;
  *status = SHADE_OK;
  if (!FN(is_varied)(f0r))
    return NULL;
  memcpy(v, f0r, sizeof *v);
  if (v->parts & ~all)
    *status = SHADE_BAD_CHOICE;
  if (v->parts & ~all || v->parts == all)
    v->parts = 0;
  return v;
}

static unsigned FN(kernel_bsdf_batch)(const shade_bsdf *b, size_t count,
                                      const FN(shade_lanes) * given,
                                      const FN(shade_result) * given_out) {
  FN(shade_lanes) room;
  FN(shade_result) room_out;
  FN(varied) held;
  unsigned status;
  if (!count)
    return SHADE_OK;
  const FN(shade_lanes) *in = shade_whole_lanes(given, FN(lanes_required), &room, sizeof room);
  const FN(shade_result) *out =
      shade_whole_lanes(given_out, FN(results_required), &room_out, sizeof room_out);
  if (!in || !out)
    return SHADE_BAD_INPUT;
  const FN(varied) *each = FN(varied_from)(&in->f0r, &held, &status);
  return status | FN(bsdf_batch)(bsdf_of(b), count, in, each, out);
}

static unsigned FN(kernel_pdf_batch)(const shade_bsdf *b, size_t count,
                                     const FN(shade_lanes) * given, real *out) {
  FN(shade_lanes) room;
  FN(varied) held;
  unsigned status;
  if (!count)
    return SHADE_OK;
  const FN(shade_lanes) *in = shade_whole_lanes(given, FN(lanes_required), &room, sizeof room);
  if (!in || !out)
    return SHADE_BAD_INPUT;
  const FN(varied) *each = FN(varied_from)(&in->f0r, &held, &status);
  return status | FN(pdf_batch)(bsdf_of(b), count, in, each, out);
}

static unsigned FN(kernel_sample_batch)(const shade_bsdf *b, size_t count,
                                        const FN(shade_sample_lanes) * given,
                                        const FN(shade_sample_result) * given_out) {
  FN(shade_sample_lanes) room;
  FN(shade_sample_result) room_out;
  FN(varied) held;
  unsigned status;
  if (!count)
    return SHADE_OK;
  const FN(shade_sample_lanes) *in =
      shade_whole_lanes(given, FN(draws_required), &room, sizeof room);
  const FN(shade_sample_result) *out =
      shade_whole_lanes(given_out, FN(draws_required), &room_out, sizeof room_out);
  if (!in || !out)
    return SHADE_BAD_INPUT;
  const FN(varied) *each = FN(varied_from)(&in->f0r, &held, &status);
  return status | FN(sample_batch)(bsdf_of(b), count, in, each, out);
}

static void FN(kernel_yarn)(const shade_bsdf *b, size_t count, const FN(shade_lanes) * in,
                            real *spec, real *matt) {
  FN(yarn_batch)(bsdf_of(b), count, in, NULL, spec, matt);
}
