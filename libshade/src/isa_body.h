/* SPDX-License-Identifier: Apache-2.0 */
/* Body of an isa_*.c: the kernel in both precisions, and the table of its entries. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "bsdf.h"
#include "fabric.h"
#include "isa.h"
#include "lanes.h"
#include "weave_private.h"
#include "../kernel/coefficients.h"

#define BLOCK 256 /* samples a pass: its scratch stays in the first-level cache */

#define SHADE_FLOAT 1
#include "../kernel/kernel.h"
#include "../kernel/pass_scratch.h"
#undef SHADE_FLOAT
#define SHADE_FLOAT 0
#include "../kernel/kernel.h"

#define ISA_TABLE_(isa) shade_isa_##isa
#define ISA_TABLE(isa) ISA_TABLE_(isa)
#define ISA_NAME_(isa) #isa
#define ISA_NAME(isa) ISA_NAME_(isa)

const shade_isa_table ISA_TABLE(ISA) = {
    ISA_NAME(ISA),
    kernel_bsdf,
    kernel_bsdff,
    kernel_prepare,
    kernel_preparef,
    kernel_hit,
    kernel_hitf,
    kernel_bsdf_batch,
    kernel_bsdf_batchf,
    kernel_mdf,
    kernel_mdff,
    kernel_mdf_batch,
    kernel_mdf_batchf,
    kernel_diffuse,
    kernel_diffusef,
    kernel_yarn,
    kernel_yarnf,
    kernel_pdf,
    kernel_pdff,
    kernel_pdf_batch,
    kernel_pdf_batchf,
    kernel_sample,
    kernel_samplef,
    kernel_sample_batch,
    kernel_sample_batchf,
    kernel_scratch_row,
    kernel_weave,
    kernel_weavef,
    kernel_weave_batch,
    kernel_weave_batchf,
    .cloth_prepare = kernel_cloth_prepare,
    .cloth_preparef = kernel_cloth_preparef,
    .cloth = kernel_cloth,
    .clothf = kernel_clothf,
    .cloth_hit = kernel_cloth_hit,
    .cloth_hitf = kernel_cloth_hitf,
    .cloth_draw = kernel_cloth_draw,
    .cloth_drawf = kernel_cloth_drawf,
    .table = kernel_table,
    .tablef = kernel_tablef,
};
