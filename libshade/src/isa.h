/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The entries of one instruction set. Each isa_*.c defines ISA, then includes
 * isa_body.h; the flags it is compiled with make the difference.
 */
#ifndef SHADE_ISA_H
#define SHADE_ISA_H

#include "shade/fabric.h"
#include "shade/shade.h"
#include "shade/weave.h"

struct fabric_table; /* of fabric_table.h */
struct scratch_row;  /* of scratch_row.h */

/* Prepared lanes of cloth: kernel/cloth.h. */
struct cloth;
struct clothf;

typedef struct shade_isa_table {
  const char *name;
  unsigned (*bsdf)(const shade_bsdf *, const double *, const double *, const double *, double *,
                   double *);
  unsigned (*bsdff)(const shade_bsdf *, const float *, const float *, const float *, float *,
                    float *);
  unsigned (*prepare)(const shade_bsdf *, const double *, const double *, shade_bsdf_hit *);
  unsigned (*preparef)(const shade_bsdf *, const float *, const float *, shade_bsdf_hitf *);
  unsigned (*hit)(const shade_bsdf *, const shade_bsdf_hit *, const double *, double *, double *);
  unsigned (*hitf)(const shade_bsdf *, const shade_bsdf_hitf *, const float *, float *, float *);
  unsigned (*bsdf_batch)(const shade_bsdf *, size_t, const shade_lanes *, const shade_result *);
  unsigned (*bsdf_batchf)(const shade_bsdf *, size_t, const shade_lanesf *, const shade_resultf *);
  unsigned (*mdf)(const shade_bsdf *, const double *, const double *, double *);
  unsigned (*mdff)(const shade_bsdf *, const float *, const float *, float *);
  unsigned (*mdf_batch)(const shade_bsdf *, size_t, const double *, const double *, const double *,
                        const double *, const double *, const double *, double *);
  unsigned (*mdf_batchf)(const shade_bsdf *, size_t, const float *, const float *, const float *,
                         const float *, const float *, const float *, float *);
  double (*diffuse)(shade_diffuse, const double *, const double *);
  float (*diffusef)(shade_diffuse, const float *, const float *);
  void (*yarn)(const shade_bsdf *, size_t, const shade_lanes *, double *, double *);
  void (*yarnf)(const shade_bsdf *, size_t, const shade_lanesf *, float *, float *);
  unsigned (*pdf)(const shade_bsdf *, const double *, const double *, const double *, double *);
  unsigned (*pdff)(const shade_bsdf *, const float *, const float *, const float *, float *);
  unsigned (*pdf_batch)(const shade_bsdf *, size_t, const shade_lanes *, double *);
  unsigned (*pdf_batchf)(const shade_bsdf *, size_t, const shade_lanesf *, float *);
  unsigned (*sample)(const shade_bsdf *, const double *, const double *, const double *, double *,
                     double *, double *, double *);
  unsigned (*samplef)(const shade_bsdf *, const float *, const float *, const float *, float *,
                      float *, float *, float *);
  unsigned (*sample_batch)(const shade_bsdf *, size_t, const shade_sample_lanes *,
                           const shade_sample_result *);
  unsigned (*sample_batchf)(const shade_bsdf *, size_t, const shade_sample_lanesf *,
                            const shade_sample_resultf *);
  void (*scratch_row)(const struct scratch_row *);
  unsigned (*weave)(const shade_weave *, double, double, shade_crossing *);
  unsigned (*weavef)(const shade_weave *, float, float, shade_crossingf *);
  unsigned (*weave_batch)(const shade_weave *, size_t, const double *, const double *,
                          const shade_crossings *);
  unsigned (*weave_batchf)(const shade_weave *, size_t, const float *, const float *,
                           const shade_crossingsf *);
  unsigned (*cloth_prepare)(const shade_fabric *, const shade_fabric_lanes *, size_t,
                            shade_fabric_tier, struct cloth *);
  unsigned (*cloth_preparef)(const shade_fabric *, const shade_fabric_lanesf *, size_t,
                             shade_fabric_tier, struct clothf *);
  unsigned (*cloth)(const shade_fabric *, const struct cloth *, const double *const[3],
                    double *const *, double *);
  unsigned (*clothf)(const shade_fabric *, const struct clothf *, const float *const[3],
                     float *const *, float *);
  unsigned (*cloth_hit)(const shade_fabric *, const struct cloth *, const double[3], double[3]);
  unsigned (*cloth_hitf)(const shade_fabric *, const struct clothf *, const float[3], float[3]);
  unsigned (*cloth_draw)(const shade_fabric *, const struct cloth *, const double *const[3],
                         double *const[3]);
  unsigned (*cloth_drawf)(const shade_fabric *, const struct clothf *, const float *const[3],
                          float *const[3]);
  void (*table)(const struct fabric_table *, size_t, const double *const[3], const double *const[3],
                double *, double *);
  void (*tablef)(const struct fabric_table *, size_t, const float *const[3], const float *const[3],
                 float *, float *);
} shade_isa_table;

extern const shade_isa_table shade_isa_scalar, shade_isa_sse2, shade_isa_avx2, shade_isa_avx512;

/*
 * By number, from the narrowest. What is made ready holds the number of the one it runs on: chosen
 * once, where a caller sets up, so that no evaluation asks the CPU or the environment.
 */
extern const shade_isa_table *const shade_isa_tables[];

/* The number of the widest that this CPU has, or of the one that the environment names. */
#define SHADE_ISA_VARIABLE "LIBSHADE_ISA"
int shade_isa_chosen(void);

/* All that this CPU has: row 0, 1, … from the widest, NULL past the end. */
const shade_isa_table *shade_isa_pick(int row);

#endif
