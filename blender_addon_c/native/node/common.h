/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all kinds of node have in common: images, looked up. */
#ifndef LIBSHADE_NODE_COMMON_H
#define LIBSHADE_NODE_COMMON_H

#include "batch/leaf.h"
#include "scene/reader.h"
#include "scene/texture.h"
#include "system/message.h"

/* What a node looks at while the scene is built. */
typedef struct node_place {
  const image *image; /* the scene's */
  texture_set *textures;
  const char *material; /* its name, */
  double exponent;      /* and how sharp it reflects */
  message_log *log;
} node_place;

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
 * The rim of a texture makes the wrapping: a coordinate only has to be brought within the rim.
 * Truncation is floor here, for x >= 0. NaN, infinity and numbers beyond 2^22, which have no
 * fraction left, end up somewhere within the rim too.
 */
LEAF float texel_position(bool repeat, float u, float size, float linear) {
  u = repeat ? u - floor_small(u) : u;
  return clampf(u * size + (1.0f - 0.5f * linear), 0.0f, size + 1.0f);
}

/* Where a texture is looked up: the lower left of four texels, and how far beyond it. */
typedef struct texel_place {
  int at, stride;
  float s, t;
} texel_place;

LEAF texel_place texel_find(bool repeat, const texture *t, float u, float v) {
  float x = texel_position(repeat, u, (float)t->width, t->linear);
  float y = texel_position(repeat, v, (float)t->height, t->linear);
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
