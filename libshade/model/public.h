/* SPDX-License-Identifier: Apache-2.0 */
/* The public structures of this precision. */
#ifndef SHADE_MODEL_PUBLIC_H
#define SHADE_MODEL_PUBLIC_H

#include "shade/fabric.h"
#include "shade/shade.h"
#include "shade/weave.h"
#include "suffix.h"

typedef SUFFIX(shade_lanes) bsdf_lanes;
typedef SUFFIX(shade_result) bsdf_result;
typedef SUFFIX(shade_sample_lanes) sample_lanes;
typedef SUFFIX(shade_sample_result) sample_result;
typedef SUFFIX(shade_bsdf_hit) bsdf_hit_room;
typedef SUFFIX(shade_crossing) crossing;
typedef SUFFIX(shade_crossings) crossings;
typedef SUFFIX(shade_fabric_lanes) fabric_lanes;
typedef SUFFIX(shade_fabric_result) fabric_result;
typedef SUFFIX(shade_fabric_point) fabric_point;
typedef SUFFIX(shade_fabric_hit) fabric_hit;

#endif
