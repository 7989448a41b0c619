/* SPDX-License-Identifier: Apache-2.0 */
/*
 * One precision of one instruction set: included twice by each src/isa_*.c, with SHADE_FLOAT 1
 * and 0. Leaves shade one sample, passes run leaves over a block of BLOCK samples in scratch on
 * the stack, batches run passes over arrays. entry.h is what the library calls.
 *
 *   f    entry.h, batch.h: blocks; pass_repair.h: directions mended; pass_lanes.h: parameters of
 *        each sample; pass_horizon.h: the choice of horizon, around pass_model.h: `hard`
 *   draw entry.h, sample.h, sample_draw.h, sample_frame.h, sample_density.h
 *   one sample: single.h; of cloth: single_cloth.h
 */
#include "real.h"

#include "elementary.h"
#include "leaf_random.h"
#include "vec.h"

#include "leaf_brdf.h"
#include "leaf_detail.h"
#include "mdf.h"
#include "leaf_fresnel.h"
#include "leaf_diffuse.h"
#include "leaf_repair.h"
#include "leaf_horizon.h"
#include "leaf_frame.h"
#include "leaf_share.h"

#include "pass_repair.h"
#include "pass_detail.h"
#include "pass_distribution.h"
#include "pass_brdf.h"
#include "pass_ggx.h"
#include "pass_colour.h"
#include "pass_diffuse.h"
#include "pass_lanes.h"
#include "pass_model.h"
#include "pass_horizon.h"

#include "batch.h"
#include "sample_density.h"
#include "sample_frame.h"
#include "sample_draw.h"
#include "sample.h"
#include "single.h"
#include "pass_table.h"
#include "pass_cloth.h"
#include "pass_cloth_block.h"
#include "single_cloth.h"
#include "pass_cloth_draw.h"
#include "column.h"
#include "pass_cloth_prepare.h"
#include "entry.h"

#include "leaf_weave.h"
#include "pass_weave.h"

#if !SHADE_FLOAT
#include "column_yarns.h"
#include "column_near.h"
#endif
