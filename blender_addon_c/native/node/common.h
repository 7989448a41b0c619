/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all kinds of node have in common: operands, and images, looked up. */
#ifndef LIBSHADE_NODE_COMMON_H
#define LIBSHADE_NODE_COMMON_H

#include "batch/leaf.h"
#include "scene/graph.h"
#include "scene/object.h"
#include "scene/texture.h"
#include "system/message.h"

/* What a node looks at while the scene is built. */
typedef struct node_place {
  const image *image; /* the scene's */
  texture_set *textures;
  const layer *layer;
  float texture_blur, normal_blur; /* as of the scene */
  const char *material;            /* its name, */
  double exponent;                 /* and how sharp it reflects */
  message_log *log;
} node_place;

/*
 * An operand's lanes: a register's, or a number's, repeated in one of the places that are kept for
 * it. Filling that costs .03 ns a lane, and the loops need no case distinction.
 */
static inline const float *lane_of(inputs *at, operand o, int place, lane_run g) {
  if (o.at >= 0)
    return at->at[o.at];
  float *lane = at->constant[place];
  for (size_t i = g.begin; i < g.end; i++)
    lane[i] = o.number;
  return lane;
}

LEAF float low_half(uint32_t pair) {
  return (float)((int32_t)(pair << 16) >> 16);
}
LEAF float high_half(uint32_t pair) {
  return (float)((int32_t)pair >> 16);
}
LEAF float lerp(float a, float b, float t) {
  return a + t * (b - a);
}

/*
 * The rim of a texture makes the wrapping: a coordinate only has to be brought within the rim. A
 * mirrored image's rim is an extended one's. Truncation is floor here, for x >= 0. NaN, infinity
 * and numbers beyond 2^22, which have no fraction left, end up somewhere within the rim too.
 */
LEAF float texel_position(image_wrap wrap, float u, float size, float linear) {
  if (wrap == WRAP_REPEAT)
    u = u - floor_small(u);
  if (wrap == WRAP_MIRROR) {
    u = u - 2.0f * floor_small(0.5f * u);
    u = u > 1.0f ? 2.0f - u : u;
  }
  return clampf(u * size + (1.0f - 0.5f * linear), 0.0f, size + 1.0f);
}

/* Where a texture is looked up: the lower left of four texels, and how far beyond it. */
typedef struct texel_place {
  int at, stride;
  float s, t;
} texel_place;

LEAF texel_place texel_find(image_wrap wrap, const texture *t, float u, float v) {
  float x = texel_position(wrap, u, (float)t->width, t->linear);
  float y = texel_position(wrap, v, (float)t->height, t->linear);
  int column = (int)x, line = (int)y;
  return (texel_place){.at = line * t->stride + column,
                       .stride = t->stride,
                       .s = (x - (float)column) * t->linear,
                       .t = (y - (float)line) * t->linear};
}

/* The two numbers of a texel, in [-1, 1]. */
LEAF void texel_pair(const uint32_t *texel, texel_place p, float *a, float *b) {
  const float scale = 1.0f / 32767.0f;
  uint32_t c00 = texel[p.at], c10 = texel[p.at + 1];
  uint32_t c01 = texel[p.at + p.stride], c11 = texel[p.at + p.stride + 1];
  *a = scale *
       lerp(lerp(low_half(c00), low_half(c10), p.s), lerp(low_half(c01), low_half(c11), p.s), p.t);
  *b = scale * lerp(lerp(high_half(c00), high_half(c10), p.s),
                    lerp(high_half(c01), high_half(c11), p.s), p.t);
}

#endif
