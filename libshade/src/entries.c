/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One precision of one instruction set: compiled for each ISA with SHADE_FLOAT 0 and 1. model/ is
 * functions on one sample: each formula stands there once. batch/ is loops over them: *_block.h
 * run over a block of BLOCK samples in scratch on the stack, *_batch.h run blocks over arrays, and
 * entry.h is what the library calls.
 *
 *   f    bsdf_batch.h: blocks; direction_block.h: directions mended; varied_block.h: parameters
 *        of each sample; paths_block.h: the choice of horizon, by horizon_block.h and
 *        mutual_block.h around bsdf_block.h: `hard`
 *   draw sample_batch.h, draw_block.h, frame_block.h, density_block.h, over model/draw.h
 *   one sample: model/single.h, f and draws; of cloth: batch/cloth_one.h
 *
 * A loop over a choice of table.h is written once, with the choice as a parameter, and made once
 * for each by SHADE_LOOP_OF (model/methods.h).
 */
#include "../batch/isa.h"

#include "../batch/cloth_draw.h"
#include "../batch/cloth_prepare.h"
#include "../batch/varied_one.h"
#include "../batch/weave_batch.h"
#if !SHADE_FLOAT /* what has no precision to choose */
#include "../batch/column_near.h"
#include "../batch/scratch_batch.h"
#endif

#define UNIT_(table, isa) table##_##isa
#define UNIT(table, isa) UNIT_(table, isa)

const SUFFIX(shade_entries) UNIT(SUFFIX(shade_entries), ISA) = {
    .mdf = entry_mdf,
    .mdf_batch = entry_mdf_batch,
    .bsdf = entry_bsdf,
    .prepare = entry_prepare,
    .hit = entry_hit,
    .hit_pdf = entry_hit_pdf,
    .hit_sample = entry_hit_sample,
    .vary = entry_vary,
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
    .cloth_draw_one = entry_cloth_draw_one,
    .table = entry_table,
#if !SHADE_FLOAT
    .streaks = entry_streaks,
    .scratch_row = entry_scratch_row,
#endif
};
