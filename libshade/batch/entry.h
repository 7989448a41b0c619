/* SPDX-License-Identifier: Apache-2.0 */
/* What the table of an instruction set holds: the public calls, by what shade.h says of them. */
#ifndef SHADE_BATCH_ENTRY_H
#define SHADE_BATCH_ENTRY_H

#include "../model/single.h"
#include "bsdf_batch.h"
#include "arrays.h"
#include "sample_batch.h"

/* Arrays that the structures of shade.h must have, from the first on. */
enum { lanes_required = 9, draws_required = 8, results_required = 4 };
_Static_assert(sizeof(bsdf_lanes) - offsetof(bsdf_lanes, f0r) == sizeof(varied_arrays) &&
                   sizeof(sample_lanes) - offsetof(sample_lanes, f0r) == sizeof(varied_arrays),
               "both end in the arrays of varied_block.h");

/* The parameters of each sample, from f0r on. Parts that do not exist are all of them, and half a
 * groove is none. */
LEAF varied_arrays varied_from(const void *f0r, unsigned *status) {
  const size_t all = SHADE_PART_SPECULAR | SHADE_PART_DIFFUSE;
  varied_arrays v;
  memcpy(&v, f0r, sizeof v);
  *status = v.parts & ~all ? SHADE_BAD_CHOICE : SHADE_OK;
  if (v.parts & ~all || v.parts == all)
    v.parts = 0;
  if (!v.groove_x != !v.groove_y) {
    *status |= SHADE_BAD_INPUT;
    v.groove_x = v.groove_y = NULL;
  }
  return v;
}

static unsigned entry_bsdf_batch(const shade_bsdf *b, size_t count, const bsdf_lanes *given,
                                 const bsdf_result *given_out) {
  bsdf_lanes in;
  bsdf_result out;
  unsigned status;
  if (!count)
    return SHADE_OK;
  if (bsdf_of(b)->varied || !shade_whole_lanes(given, lanes_required, &in, sizeof in) ||
      !shade_whole_lanes(given_out, results_required, &out, sizeof out))
    return SHADE_BAD_INPUT;
  const varied_arrays each = varied_from(&in.f0r, &status);
  return status | bsdf_batch(bsdf_of(b), count, &in, &each, &out);
}

static unsigned entry_pdf_batch(const shade_bsdf *b, size_t count, const bsdf_lanes *given,
                                real *out) {
  bsdf_lanes in;
  unsigned status;
  if (!count)
    return SHADE_OK;
  if (bsdf_of(b)->varied || !shade_whole_lanes(given, lanes_required, &in, sizeof in) || !out)
    return SHADE_BAD_INPUT;
  const varied_arrays each = varied_from(&in.f0r, &status);
  return status | pdf_batch(bsdf_of(b), count, &in, &each, out);
}

static unsigned entry_sample_batch(const shade_bsdf *b, size_t count, const sample_lanes *given,
                                   const sample_result *given_out) {
  sample_lanes in;
  sample_result out;
  unsigned status;
  if (!count)
    return SHADE_OK;
  if (bsdf_of(b)->varied || !shade_whole_lanes(given, draws_required, &in, sizeof in) ||
      !shade_whole_lanes(given_out, draws_required, &out, sizeof out))
    return SHADE_BAD_INPUT;
  const varied_arrays each = varied_from(&in.f0r, &status);
  return status | sample_batch(bsdf_of(b), count, &in, &each, &out);
}

static void entry_yarn(const shade_bsdf *b, size_t count, const bsdf_lanes *in, real *spec,
                       real *matt) {
  yarn_batch(bsdf_of(b), count, in, &(varied_arrays){.parts = 0}, spec, matt);
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
