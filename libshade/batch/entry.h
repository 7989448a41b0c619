/* SPDX-License-Identifier: Apache-2.0 */
/* What the table of an instruction set holds: the public calls, by what shade.h says of them. */
#ifndef SHADE_BATCH_ENTRY_H
#define SHADE_BATCH_ENTRY_H

#include "../model/single.h"
#include "bsdf_batch.h"
#include "arrays.h"
#include "sample_batch.h"

static unsigned entry_mdf(const shade_bsdf *b, const real n[3], const real h[3], real *d) {
  return mdf_one(bsdf_of(b), n, h, d);
}

static unsigned entry_mdf_batch(const shade_bsdf *b, size_t count, const real *nx, const real *ny,
                                const real *nz, const real *hx, const real *hy, const real *hz,
                                real *out) {
  return mdf_batch(bsdf_of(b), count, nx, ny, nz, hx, hy, hz, out);
}

static unsigned entry_bsdf(const shade_bsdf *b, const real n[3], const real wi[3], const real wo[3],
                           real f[3], real *cosine) {
  return bsdf_one(bsdf_of(b), n, wi, wo, f, cosine);
}

static unsigned entry_prepare(const shade_bsdf *b, const real n[3], const real wo[3],
                              bsdf_hit_room *room) {
  bsdf_hit *hit = (bsdf_hit *)room;
  prepare_one(bsdf_of(b), n, wo, hit);
  return hit->status;
}

static unsigned entry_hit(const shade_bsdf *b, const bsdf_hit_room *hit, const real wi[3],
                          real f[3], real *cosine) {
  return hit_one(bsdf_of(b), (const bsdf_hit *)hit, wi, f, cosine);
}

static unsigned entry_pdf(const shade_bsdf *b, const real n[3], const real wi[3], const real wo[3],
                          real *pdf) {
  return pdf_one(bsdf_of(b), n, wi, wo, pdf);
}

static unsigned entry_sample(const shade_bsdf *b, const real n[3], const real wo[3],
                             const real u[2], real wi[3], real f[3], real *pdf, real *cosine) {
  return sample_one(bsdf_of(b), n, wo, u, wi, f, pdf, cosine);
}

/* Arrays that the structures of shade.h must have, from the first on. */
enum { lanes_required = 9, draws_required = 8, results_required = 4 };
_Static_assert(offsetof(bsdf_lanes, parts) - offsetof(bsdf_lanes, f0r) ==
                       offsetof(varied_arrays, parts) &&
                   offsetof(sample_lanes, parts) - offsetof(sample_lanes, f0r) ==
                       offsetof(varied_arrays, parts),
               "both end in the arrays of varied_block.h");

/* Whether f0r, or what follows it in shade_lanes, holds anything. One by one, as in arrays.h. */
LEAF int is_varied(const void *f0r) {
#if defined(__GNUC__)
#pragma GCC unroll 32
#endif
  for (size_t i = 0; i < sizeof(varied_arrays); i += sizeof(void *)) {
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
static inline const varied_arrays *varied_from(const void *f0r, varied_arrays *v,
                                               unsigned *status) {
  const size_t all = SHADE_PART_SPECULAR | SHADE_PART_DIFFUSE;
  *status = SHADE_OK;
  if (!is_varied(f0r))
    return NULL;
  memcpy(v, f0r, sizeof *v);
  if (v->parts & ~all)
    *status = SHADE_BAD_CHOICE;
  if (v->parts & ~all || v->parts == all)
    v->parts = 0;
  return v;
}

static unsigned entry_bsdf_batch(const shade_bsdf *b, size_t count, const bsdf_lanes *given,
                                 const bsdf_result *given_out) {
  bsdf_lanes room;
  bsdf_result room_out;
  varied_arrays held;
  unsigned status;
  if (!count)
    return SHADE_OK;
  const bsdf_lanes *in = shade_whole_lanes(given, lanes_required, &room, sizeof room);
  const bsdf_result *out =
      shade_whole_lanes(given_out, results_required, &room_out, sizeof room_out);
  if (!in || !out)
    return SHADE_BAD_INPUT;
  const varied_arrays *each = varied_from(&in->f0r, &held, &status);
  return status | bsdf_batch(bsdf_of(b), count, in, each, out);
}

static unsigned entry_pdf_batch(const shade_bsdf *b, size_t count, const bsdf_lanes *given,
                                real *out) {
  bsdf_lanes room;
  varied_arrays held;
  unsigned status;
  if (!count)
    return SHADE_OK;
  const bsdf_lanes *in = shade_whole_lanes(given, lanes_required, &room, sizeof room);
  if (!in || !out)
    return SHADE_BAD_INPUT;
  const varied_arrays *each = varied_from(&in->f0r, &held, &status);
  return status | pdf_batch(bsdf_of(b), count, in, each, out);
}

static unsigned entry_sample_batch(const shade_bsdf *b, size_t count, const sample_lanes *given,
                                   const sample_result *given_out) {
  sample_lanes room;
  sample_result room_out;
  varied_arrays held;
  unsigned status;
  if (!count)
    return SHADE_OK;
  const sample_lanes *in = shade_whole_lanes(given, draws_required, &room, sizeof room);
  const sample_result *out =
      shade_whole_lanes(given_out, draws_required, &room_out, sizeof room_out);
  if (!in || !out)
    return SHADE_BAD_INPUT;
  const varied_arrays *each = varied_from(&in->f0r, &held, &status);
  return status | sample_batch(bsdf_of(b), count, in, each, out);
}

static void entry_yarn(const shade_bsdf *b, size_t count, const bsdf_lanes *in, real *spec,
                       real *matt) {
  yarn_batch(bsdf_of(b), count, in, NULL, spec, matt);
}

/* Phi in the fibre's own frame, by the contract of shade_diffuse_eval. */
static real entry_diffuse(shade_diffuse model, const real l_in[3], const real v_in[3]) {
  real l[3] = {l_in[0], l_in[1], l_in[2]}, v[3] = {0, 0, 1};
  if ((unsigned)model >= SHADE_DIFFUSE_COUNT) /* an unknown model is the first */
    model = (shade_diffuse)0;
  if (shade_diffuse_is(model).sees)
    memcpy(v, v_in, sizeof v);
  if ((mend_if_needed(l, 0) | mend_if_needed(v, 0)) & SHADE_BAD_INPUT)
    return 0;
  return l[2] > 0 && v[2] > 0 ? diffuse_phi(model, l[1], l[2], v[1], v[2]) : 0;
}

#endif
