/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The entries of one instruction set: entries.c, compiled once for each precision. The flags it is
 * compiled with make the difference.
 */
#ifndef SHADE_BATCH_ISA_H
#define SHADE_BATCH_ISA_H

#include "shade/fabric.h"
#include "shade/shade.h"
#include "shade/weave.h"

struct fabric_table; /* of fabric_table.h */
struct scratch_row;  /* of scratch_row.h */
struct column_axis;  /* of batch/column.h */
struct column_group;

/* Prepared lanes of cloth: batch/cloth.h. */
struct cloth;
struct clothf;

/* What a precision has: numbers of a type, structures whose names end in f or nothing, members that
 * the other has not. */
#define SHADE_ENTRIES(type, f, more)                                                               \
  typedef struct shade_entries##f {                                                                \
    unsigned (*mdf)(const shade_bsdf *, const type *, const type *, type *);                       \
    unsigned (*mdf_batch)(const shade_bsdf *, size_t, const type *, const type *, const type *,    \
                          const type *, const type *, const type *, type *);                       \
    unsigned (*bsdf)(const shade_bsdf *, const type *, const type *, const type *, type *,         \
                     type *);                                                                      \
    unsigned (*prepare)(const shade_bsdf *, const type *, const type *, shade_bsdf_hit##f *);      \
    unsigned (*hit)(const shade_bsdf *, const shade_bsdf_hit##f *, const type *, type *, type *);  \
    unsigned (*hit_pdf)(const shade_bsdf *, const shade_bsdf_hit##f *, const type *, type *);      \
    unsigned (*hit_sample)(const shade_bsdf *, const shade_bsdf_hit##f *, const type *, type *,    \
                           type *, type *, type *);                                                \
    unsigned (*vary)(const shade_bsdf *, const shade_lanes##f *, size_t, shade_bsdf *);            \
    unsigned (*bsdf_batch)(const shade_bsdf *, size_t, const shade_lanes##f *,                     \
                           const shade_result##f *);                                               \
    type (*diffuse)(shade_diffuse, const type *, const type *);                                    \
    void (*yarn)(const shade_bsdf *, size_t, const shade_lanes##f *, type *, type *);              \
    unsigned (*pdf)(const shade_bsdf *, const type *, const type *, const type *, type *);         \
    unsigned (*pdf_batch)(const shade_bsdf *, size_t, const shade_lanes##f *, type *);             \
    unsigned (*sample)(const shade_bsdf *, const type *, const type *, const type *, type *,       \
                       type *, type *, type *);                                                    \
    unsigned (*sample_batch)(const shade_bsdf *, size_t, const shade_sample_lanes##f *,            \
                             const shade_sample_result##f *);                                      \
    unsigned (*weave)(const shade_weave *, type, type, shade_crossing##f *);                       \
    unsigned (*weave_batch)(const shade_weave *, size_t, const type *, const type *,               \
                            const shade_crossings##f *);                                           \
    unsigned (*cloth_prepare)(const shade_fabric *, const shade_fabric_lanes##f *, size_t,         \
                              shade_fabric_tier, struct cloth##f *);                               \
    unsigned (*cloth)(const shade_fabric *, const struct cloth##f *, const type *const[3],         \
                      type *const *, type *);                                                      \
    unsigned (*cloth_hit)(const shade_fabric *, const struct cloth##f *, const type[3], type *,    \
                          type *);                                                                 \
    unsigned (*cloth_draw_one)(const shade_fabric *, const struct cloth##f *, const type[3],       \
                               type[3]);                                                           \
    unsigned (*cloth_draw)(const shade_fabric *, const struct cloth##f *, const type *const[3],    \
                           type *const[3]);                                                        \
    void (*table)(const struct fabric_table *, size_t, const type *const[3], const type *const[3], \
                  type *, type *);                                                                 \
    more                                                                                           \
  } shade_entries##f;
SHADE_ENTRIES(float, f, )
SHADE_ENTRIES(double, ,
              void (*streaks)(const shade_fabric *, const struct column_axis *,
                              const struct column_axis *, int, int, size_t, struct column_group *);
              void (*scratch_row)(const struct scratch_row *);)

typedef struct shade_isa_table {
  const char *name;
  const shade_entries *entries;
  const shade_entriesf *entriesf;
} shade_isa_table;

extern const shade_isa_table shade_isa_scalar, shade_isa_sse2, shade_isa_avx2, shade_isa_avx512;

/*
 * By number, from the narrowest. What is made ready holds the number of the one it runs on: chosen
 * once, where a caller sets up, so that no evaluation asks the CPU or the environment.
 */
extern const shade_isa_table *const shade_isa_tables[];
extern const shade_entries *const shade_isa_entries[];
extern const shade_entriesf *const shade_isa_entriesf[];

/* The number of the widest that this CPU has, or of the one that the environment names. */
#define SHADE_ISA_VARIABLE "LIBSHADE_ISA"
int shade_isa_chosen(void);

/* All that this CPU has: row 0, 1, … from the widest, NULL past the end. */
const shade_isa_table *shade_isa_pick(int row);

#endif
