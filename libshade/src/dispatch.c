/* SPDX-License-Identifier: Apache-2.0 */
/* The public entries, through the instruction set that the material was made ready for. */
#include "bsdf.h"
#include "isa.h"

static inline const shade_isa_table *isa_of(const shade_bsdf *b) {
  return shade_isa_tables[bsdf_of(b)->isa];
}

double shade_mdf_eval(const shade_bsdf *b, const double n[3], const double h[3], unsigned *status) {
  double d;
  unsigned bits = isa_of(b)->mdf(b, n, h, &d);
  if (status)
    *status |= bits;
  return d;
}

float shade_mdf_evalf(const shade_bsdf *b, const float n[3], const float h[3], unsigned *status) {
  float d;
  unsigned bits = isa_of(b)->mdff(b, n, h, &d);
  if (status)
    *status |= bits;
  return d;
}

unsigned shade_bsdf_eval(const shade_bsdf *b, const double n[3], const double wi[3],
                         const double wo[3], double f[3], double *cosine) {
  double unused;
  return isa_of(b)->bsdf(b, n, wi, wo, f, cosine ? cosine : &unused);
}

unsigned shade_bsdf_evalf(const shade_bsdf *b, const float n[3], const float wi[3],
                          const float wo[3], float f[3], float *cosine) {
  float unused;
  return isa_of(b)->bsdff(b, n, wi, wo, f, cosine ? cosine : &unused);
}

unsigned shade_bsdf_prepare(const shade_bsdf *b, const double n[3], const double wo[3],
                            shade_bsdf_hit *hit) {
  return isa_of(b)->prepare(b, n, wo, hit);
}

unsigned shade_bsdf_preparef(const shade_bsdf *b, const float n[3], const float wo[3],
                             shade_bsdf_hitf *hit) {
  return isa_of(b)->preparef(b, n, wo, hit);
}

unsigned shade_bsdf_hit_eval(const shade_bsdf *b, const shade_bsdf_hit *hit, const double wi[3],
                             double f[3], double *cosine) {
  double unused;
  return isa_of(b)->hit(b, hit, wi, f, cosine ? cosine : &unused);
}

unsigned shade_bsdf_hit_evalf(const shade_bsdf *b, const shade_bsdf_hitf *hit, const float wi[3],
                              float f[3], float *cosine) {
  float unused;
  return isa_of(b)->hitf(b, hit, wi, f, cosine ? cosine : &unused);
}

unsigned shade_bsdf_eval_batch(const shade_bsdf *b, size_t count, const shade_lanes *in,
                               const shade_result *out) {
  return isa_of(b)->bsdf_batch(b, count, in, out);
}

unsigned shade_bsdf_eval_batchf(const shade_bsdf *b, size_t count, const shade_lanesf *in,
                                const shade_resultf *out) {
  return isa_of(b)->bsdf_batchf(b, count, in, out);
}

unsigned shade_mdf_eval_batch(const shade_bsdf *b, size_t count, const double *nx, const double *ny,
                              const double *nz, const double *hx, const double *hy,
                              const double *hz, double *out) {
  return isa_of(b)->mdf_batch(b, count, nx, ny, nz, hx, hy, hz, out);
}

unsigned shade_mdf_eval_batchf(const shade_bsdf *b, size_t count, const float *nx, const float *ny,
                               const float *nz, const float *hx, const float *hy, const float *hz,
                               float *out) {
  return isa_of(b)->mdf_batchf(b, count, nx, ny, nz, hx, hy, hz, out);
}

double shade_diffuse_eval(shade_diffuse model, const double l[3], const double v[3]) {
  return shade_isa_tables[0]->diffuse(model, l, v);
}

float shade_diffuse_evalf(shade_diffuse model, const float l[3], const float v[3]) {
  return shade_isa_tables[0]->diffusef(model, l, v);
}

double shade_bsdf_pdf(const shade_bsdf *b, const double n[3], const double wi[3],
                      const double wo[3], unsigned *status) {
  double pdf;
  unsigned bits = isa_of(b)->pdf(b, n, wi, wo, &pdf);
  if (status)
    *status |= bits;
  return pdf;
}

float shade_bsdf_pdff(const shade_bsdf *b, const float n[3], const float wi[3], const float wo[3],
                      unsigned *status) {
  float pdf;
  unsigned bits = isa_of(b)->pdff(b, n, wi, wo, &pdf);
  if (status)
    *status |= bits;
  return pdf;
}

unsigned shade_bsdf_pdf_batch(const shade_bsdf *b, size_t count, const shade_lanes *in,
                              double *pdf) {
  return isa_of(b)->pdf_batch(b, count, in, pdf);
}

unsigned shade_bsdf_pdf_batchf(const shade_bsdf *b, size_t count, const shade_lanesf *in,
                               float *pdf) {
  return isa_of(b)->pdf_batchf(b, count, in, pdf);
}

unsigned shade_bsdf_sample(const shade_bsdf *b, const double n[3], const double wo[3],
                           const double u[2], double wi[3], double f[3], double *pdf,
                           double *cosine) {
  double unused;
  return isa_of(b)->sample(b, n, wo, u, wi, f, pdf, cosine ? cosine : &unused);
}

unsigned shade_bsdf_samplef(const shade_bsdf *b, const float n[3], const float wo[3],
                            const float u[2], float wi[3], float f[3], float *pdf, float *cosine) {
  float unused;
  return isa_of(b)->samplef(b, n, wo, u, wi, f, pdf, cosine ? cosine : &unused);
}

unsigned shade_bsdf_sample_batch(const shade_bsdf *b, size_t count, const shade_sample_lanes *in,
                                 const shade_sample_result *out) {
  return isa_of(b)->sample_batch(b, count, in, out);
}

unsigned shade_bsdf_sample_batchf(const shade_bsdf *b, size_t count, const shade_sample_lanesf *in,
                                  const shade_sample_resultf *out) {
  return isa_of(b)->sample_batchf(b, count, in, out);
}
