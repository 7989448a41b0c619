/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One precision of one instruction set: compiled for each ISA with SHADE_FLOAT 0 and 1. Leaves
 * shade one sample, passes run leaves over a block of BLOCK samples in scratch on the stack,
 * batches run passes over arrays. entry.h is what the library calls.
 *
 *   f    entry.h, batch.h: blocks; pass_repair.h: directions mended; pass_lanes.h: parameters of
 *        each sample; pass_horizon.h: the choice of horizon, around pass_model.h: `hard`
 *   draw entry.h, sample.h, sample_draw.h, sample_frame.h, sample_density.h
 *   one sample: single.h; of cloth: single_cloth.h
 */
#include "isa.h"

#include "../kernel/entry.h"
#include "../kernel/pass_cloth_draw.h"
#include "../kernel/pass_cloth_prepare.h"
#include "../kernel/pass_weave.h"
#include "../kernel/single_cloth.h"
#if !SHADE_FLOAT /* what has no precision to choose */
#include "../kernel/column_near.h"
#include "../kernel/pass_scratch.h"
#endif

#define UNIT_(table, isa) table##_##isa
#define UNIT(table, isa) UNIT_(table, isa)

const SUFFIX(shade_entries) UNIT(SUFFIX(shade_entries), ISA) = {
    .mdf = entry_mdf,
    .mdf_batch = entry_mdf_batch,
    .bsdf = entry_bsdf,
    .prepare = entry_prepare,
    .hit = entry_hit,
    .bsdf_batch = entry_bsdf_batch,
    .diffuse = entry_diffuse,
    .yarn = entry_yarn,
    .pdf = entry_pdf,
    .pdf_batch = entry_pdf_batch,
    .sample = entry_sample,
    .sample_batch = entry_sample_batch,
    .weave = entry_weave,
    .weave_batch = entry_weave_batch,
    .cloth_prepare = entry_cloth_prepare,
    .cloth = entry_cloth,
    .cloth_hit = entry_cloth_hit,
    .cloth_draw = entry_cloth_draw,
    .table = entry_table,
#if !SHADE_FLOAT
    .streaks = entry_streaks,
    .scratch_row = entry_scratch_row,
#endif
};
