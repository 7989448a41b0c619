/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Kinds of node, of which a material's graph is a list in the order in which they run: a program
 * whose instructions read registers and numbers (operands) and write registers. Each is one file,
 * node/<name>.h, with
 *
 *   node_<name>         what it keeps
 *   node_<name>_read    reads it from a scene
 *   node_<name>_run     a loop over a run of hits that writes its registers
 *   node_<name>_build   if it is one of NODES_BUILT: before the first sample asks for textures;
 * false when out of memory
 *
 * and one row of node/table.h: ROW(TYPE, name). TYPE is the word in a scene, NODE_TYPE its number,
 * stage_<name> its stage and node_<name> its clock.
 */
#ifndef LIBSHADE_NODE_H
#define LIBSHADE_NODE_H

#include "node/albedo.h"
#include "node/attribute.h"
#include "node/bend.h"
#include "node/bevel.h"
#include "node/box.h"
#include "node/brick.h"
#include "node/bump.h"
#include "node/cloth.h"
#include "node/curve.h"
#include "node/frame.h"
#include "node/geometry.h"
#include "node/glass_albedo.h"
#include "node/hue.h"
#include "node/image.h"
#include "node/layer.h"
#include "node/math.h"
#include "node/mix.h"
#include "node/noise.h"
#include "node/normal_map.h"
#include "node/object.h"
#include "node/occlusion.h"
#include "node/path.h"
#include "node/perturb.h"
#include "node/ramp.h"
#include "node/relief.h"
#include "node/fibres.h"
#include "node/scratches.h"
#include "node/step.h"
#include "node/thin_film.h"
#include "node/transform.h"
#include "node/voronoi.h"
#include "node/weave.h"
#include "node/white_noise.h"
#include "node/table.h"

#define NODE_MEMBER(TYPE, name) node_##name name;
typedef struct node {
  node_type type;
  union {
    NODE_TABLE(NODE_MEMBER)
  } of;
} node;

#endif
