/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The kinds of node, by number. Each group is compiled by itself, isa/node_<group>.c. */
#ifndef LIBSHADE_NODE_TABLE_H
#define LIBSHADE_NODE_TABLE_H

#define NODES_IMAGE(ROW) ROW(IMAGE, image)
#define NODES_NORMAL(ROW)                                                                          \
  ROW(NORMAL_MAP, normal_map)                                                                      \
  ROW(PERTURB, perturb)                                                                            \
  ROW(STEP, step)                                                                                  \
  ROW(BUMP, bump)                                                                                  \
  ROW(BEND, bend)                                                                                  \
  ROW(BEVEL, bevel)                                                                                \
  ROW(FRAME, frame)                                                                                \
  ROW(RELIEF, relief)
#define NODES_LAYER(ROW)                                                                           \
  ROW(ALBEDO, albedo)                                                                              \
  ROW(GLASS_ALBEDO, glass_albedo)                                                                  \
  ROW(THIN_FILM, thin_film)                                                                        \
  ROW(LAYER, layer)
#define NODES_PLACE(ROW)                                                                           \
  ROW(GEOMETRY, geometry)                                                                          \
  ROW(OBJECT, object)                                                                              \
  ROW(ATTRIBUTE, attribute)                                                                        \
  ROW(OCCLUSION, occlusion)                                                                        \
  ROW(PATH, path)                                                                                  \
  ROW(TRANSFORM, transform)
#define NODES_VALUE(ROW)                                                                           \
  ROW(MATH, math)                                                                                  \
  ROW(MIX, mix)                                                                                    \
  ROW(HUE, hue)                                                                                    \
  ROW(RAMP, ramp)                                                                                  \
  ROW(CURVE, curve)
#define NODES_NOISE(ROW)                                                                           \
  ROW(NOISE, noise)                                                                                \
  ROW(WHITE_NOISE, white_noise)                                                                    \
  ROW(BRICK, brick)                                                                                \
  ROW(BOX, box)
#define NODES_VORONOI(ROW) ROW(VORONOI, voronoi)
#define NODES_CLOTH(ROW)                                                                           \
  ROW(WEAVE, weave)                                                                                \
  ROW(CLOTH, cloth)                                                                                \
  ROW(FIBRES, fibres)                                                                              \
  ROW(SCRATCHES, scratches)
#define NODE_TABLE(ROW)                                                                            \
  NODES_IMAGE(ROW)                                                                                 \
  NODES_NORMAL(ROW)                                                                                \
  NODES_LAYER(ROW)                                                                                 \
  NODES_PLACE(ROW)                                                                                 \
  NODES_VALUE(ROW)                                                                                 \
  NODES_NOISE(ROW)                                                                                 \
  NODES_VORONOI(ROW)                                                                               \
  NODES_CLOTH(ROW)

#define NODES_BUILT(ROW)                                                                           \
  ROW(IMAGE, image)                                                                                \
  ROW(NORMAL_MAP, normal_map)                                                                      \
  ROW(ALBEDO, albedo)                                                                              \
  ROW(GLASS_ALBEDO, glass_albedo)                                                                  \
  ROW(LAYER, layer)                                                                                \
  ROW(SCRATCHES, scratches)

#define NODE_TYPE(TYPE, name) NODE_##TYPE,
typedef enum node_type { NODE_TABLE(NODE_TYPE) NODE_TYPES } node_type;

#endif
