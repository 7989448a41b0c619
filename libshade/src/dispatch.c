/* SPDX-License-Identifier: Apache-2.0 */
/* The public entries, through the instruction set that the material was made ready for: compiled
 * once for each precision. Those of float end in f: shade_bsdf_eval_batchf. */
#include "../batch/isa.h"

#include "../model/real.h"
#include "../model/bsdf.h"

#define shade_mdf_eval SUFFIX(shade_mdf_eval)
#define shade_mdf_eval_batch SUFFIX(shade_mdf_eval_batch)
#define shade_bsdf_eval SUFFIX(shade_bsdf_eval)
#define shade_bsdf_eval_batch SUFFIX(shade_bsdf_eval_batch)
#define shade_bsdf_prepare SUFFIX(shade_bsdf_prepare)
#define shade_bsdf_hit_eval SUFFIX(shade_bsdf_hit_eval)
#define shade_bsdf_hit_pdf SUFFIX(shade_bsdf_hit_pdf)
#define shade_bsdf_hit_sample SUFFIX(shade_bsdf_hit_sample)
#define shade_bsdf_vary SUFFIX(shade_bsdf_vary)
#define shade_bsdf_pdf SUFFIX(shade_bsdf_pdf)
#define shade_bsdf_pdf_batch SUFFIX(shade_bsdf_pdf_batch)
#define shade_bsdf_sample SUFFIX(shade_bsdf_sample)
#define shade_bsdf_sample_batch SUFFIX(shade_bsdf_sample_batch)
#define shade_diffuse_eval SUFFIX(shade_diffuse_eval)

static inline const SUFFIX(shade_entries) * entries_of(const shade_bsdf *b) {
  return SUFFIX(shade_isa_entries)[bsdf_of(b)->isa];
}

real shade_mdf_eval(const shade_bsdf *b, const real n[3], const real h[3], unsigned *status) {
  real d;
  unsigned bits = entries_of(b)->mdf(b, n, h, &d);
  if (status)
    *status |= bits;
  return d;
}

unsigned shade_mdf_eval_batch(const shade_bsdf *b, size_t count, const real *nx, const real *ny,
                              const real *nz, const real *hx, const real *hy, const real *hz,
                              real *out) {
  return entries_of(b)->mdf_batch(b, count, nx, ny, nz, hx, hy, hz, out);
}

unsigned shade_bsdf_eval(const shade_bsdf *b, const real n[3], const real wi[3], const real wo[3],
                         real f[3], real *cosine) {
  real unused;
  return entries_of(b)->bsdf(b, n, wi, wo, f, cosine ? cosine : &unused);
}

unsigned shade_bsdf_prepare(const shade_bsdf *b, const real n[3], const real wo[3],
                            SUFFIX(shade_bsdf_hit) * hit) {
  return entries_of(b)->prepare(b, n, wo, hit);
}

unsigned shade_bsdf_hit_eval(const shade_bsdf *b, const SUFFIX(shade_bsdf_hit) * hit,
                             const real wi[3], real f[3], real *cosine) {
  real unused;
  return entries_of(b)->hit(b, hit, wi, f, cosine ? cosine : &unused);
}

real shade_bsdf_hit_pdf(const shade_bsdf *b, const SUFFIX(shade_bsdf_hit) * hit, const real wi[3],
                        unsigned *status) {
  real pdf;
  unsigned bits = entries_of(b)->hit_pdf(b, hit, wi, &pdf);
  if (status)
    *status |= bits;
  return pdf;
}

unsigned shade_bsdf_hit_sample(const shade_bsdf *b, const SUFFIX(shade_bsdf_hit) * hit,
                               const real u[2], real wi[3], real f[3], real *pdf, real *cosine) {
  real unused;
  return entries_of(b)->hit_sample(b, hit, u, wi, f, pdf, cosine ? cosine : &unused);
}

unsigned shade_bsdf_vary(const shade_bsdf *b, const SUFFIX(shade_lanes) * in, size_t lane,
                         shade_bsdf *out) {
  return entries_of(b)->vary(b, in, lane, out);
}

unsigned shade_bsdf_eval_batch(const shade_bsdf *b, size_t count, const SUFFIX(shade_lanes) * in,
                               const SUFFIX(shade_result) * out) {
  return entries_of(b)->bsdf_batch(b, count, in, out);
}

real shade_diffuse_eval(shade_diffuse model, const real l[3], const real v[3]) {
  return SUFFIX(shade_isa_entries)[0]->diffuse(model, l, v);
}

real shade_bsdf_pdf(const shade_bsdf *b, const real n[3], const real wi[3], const real wo[3],
                    unsigned *status) {
  real pdf;
  unsigned bits = entries_of(b)->pdf(b, n, wi, wo, &pdf);
  if (status)
    *status |= bits;
  return pdf;
}

unsigned shade_bsdf_pdf_batch(const shade_bsdf *b, size_t count, const SUFFIX(shade_lanes) * in,
                              real *pdf) {
  return entries_of(b)->pdf_batch(b, count, in, pdf);
}

unsigned shade_bsdf_sample(const shade_bsdf *b, const real n[3], const real wo[3], const real u[2],
                           real wi[3], real f[3], real *pdf, real *cosine) {
  real unused;
  return entries_of(b)->sample(b, n, wo, u, wi, f, pdf, cosine ? cosine : &unused);
}

unsigned shade_bsdf_sample_batch(const shade_bsdf *b, size_t count,
                                 const SUFFIX(shade_sample_lanes) * in,
                                 const SUFFIX(shade_sample_result) * out) {
  return entries_of(b)->sample_batch(b, count, in, out);
}
