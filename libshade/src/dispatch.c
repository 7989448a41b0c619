/* SPDX-License-Identifier: Apache-2.0 */
/* The public entries, through the table of the widest instruction set. */
#include "isa.h"

const shade_isa_table *shade_isa_pick(int row) {
  const shade_isa_table *tables[4];
  int count = 0;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("bmi2"))
    tables[count++] = &shade_isa_avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    tables[count++] = &shade_isa_avx2;
  tables[count++] = &shade_isa_sse2;
#endif
  tables[count++] = &shade_isa_scalar;
  return row < count ? tables[row] : NULL;
}

const char *shade_isa(void) {
  return shade_isa_pick(0)->name;
}

double shade_mdf_eval(const shade_bsdf *b, const double n[3], const double h[3], unsigned *status) {
  double d;
  unsigned bits = shade_isa_pick(0)->mdf(b, n, h, &d);
  if (status)
    *status |= bits;
  return d;
}

float shade_mdf_evalf(const shade_bsdf *b, const float n[3], const float h[3], unsigned *status) {
  float d;
  unsigned bits = shade_isa_pick(0)->mdff(b, n, h, &d);
  if (status)
    *status |= bits;
  return d;
}

unsigned shade_bsdf_eval(const shade_bsdf *b, const double n[3], const double wi[3],
                         const double wo[3], double f[3], double *cosine) {
  double unused;
  return shade_isa_pick(0)->bsdf(b, n, wi, wo, f, cosine ? cosine : &unused);
}

unsigned shade_bsdf_evalf(const shade_bsdf *b, const float n[3], const float wi[3],
                          const float wo[3], float f[3], float *cosine) {
  float unused;
  return shade_isa_pick(0)->bsdff(b, n, wi, wo, f, cosine ? cosine : &unused);
}

unsigned shade_bsdf_eval_batch(const shade_bsdf *b, size_t count, const shade_lanes *in,
                               const shade_result *out) {
  return shade_isa_pick(0)->bsdf_batch(b, count, in, out);
}

unsigned shade_bsdf_eval_batchf(const shade_bsdf *b, size_t count, const shade_lanesf *in,
                                const shade_resultf *out) {
  return shade_isa_pick(0)->bsdf_batchf(b, count, in, out);
}

unsigned shade_mdf_eval_batch(const shade_bsdf *b, size_t count, const double *nx, const double *ny,
                              const double *nz, const double *hx, const double *hy,
                              const double *hz, double *out) {
  return shade_isa_pick(0)->mdf_batch(b, count, nx, ny, nz, hx, hy, hz, out);
}

unsigned shade_mdf_eval_batchf(const shade_bsdf *b, size_t count, const float *nx, const float *ny,
                               const float *nz, const float *hx, const float *hy, const float *hz,
                               float *out) {
  return shade_isa_pick(0)->mdf_batchf(b, count, nx, ny, nz, hx, hy, hz, out);
}

double shade_diffuse_eval(shade_diffuse model, const double l[3], const double v[3]) {
  return shade_isa_pick(0)->diffuse(model, l, v);
}

float shade_diffuse_evalf(shade_diffuse model, const float l[3], const float v[3]) {
  return shade_isa_pick(0)->diffusef(model, l, v);
}

double shade_bsdf_pdf(const shade_bsdf *b, const double n[3], const double wi[3],
                      const double wo[3], unsigned *status) {
  double pdf;
  unsigned bits = shade_isa_pick(0)->pdf(b, n, wi, wo, &pdf);
  if (status)
    *status |= bits;
  return pdf;
}

float shade_bsdf_pdff(const shade_bsdf *b, const float n[3], const float wi[3], const float wo[3],
                      unsigned *status) {
  float pdf;
  unsigned bits = shade_isa_pick(0)->pdff(b, n, wi, wo, &pdf);
  if (status)
    *status |= bits;
  return pdf;
}

unsigned shade_bsdf_pdf_batch(const shade_bsdf *b, size_t count, const shade_lanes *in,
                              double *pdf) {
  return shade_isa_pick(0)->pdf_batch(b, count, in, pdf);
}

unsigned shade_bsdf_pdf_batchf(const shade_bsdf *b, size_t count, const shade_lanesf *in,
                               float *pdf) {
  return shade_isa_pick(0)->pdf_batchf(b, count, in, pdf);
}

unsigned shade_bsdf_sample(const shade_bsdf *b, const double n[3], const double wo[3],
                           const double u[2], double wi[3], double f[3], double *pdf,
                           double *cosine) {
  double unused;
  return shade_isa_pick(0)->sample(b, n, wo, u, wi, f, pdf, cosine ? cosine : &unused);
}

unsigned shade_bsdf_samplef(const shade_bsdf *b, const float n[3], const float wo[3],
                            const float u[2], float wi[3], float f[3], float *pdf, float *cosine) {
  float unused;
  return shade_isa_pick(0)->samplef(b, n, wo, u, wi, f, pdf, cosine ? cosine : &unused);
}

unsigned shade_bsdf_sample_batch(const shade_bsdf *b, size_t count, const shade_sample_lanes *in,
                                 const shade_sample_result *out) {
  return shade_isa_pick(0)->sample_batch(b, count, in, out);
}

unsigned shade_bsdf_sample_batchf(const shade_bsdf *b, size_t count, const shade_sample_lanesf *in,
                                  const shade_sample_resultf *out) {
  return shade_isa_pick(0)->sample_batchf(b, count, in, out);
}
