/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What all kinds of node have in common: operands, and images, looked up. */
#ifndef LIBSHADE_NODE_COMMON_H
#define LIBSHADE_NODE_COMMON_H

#include "batch/leaf.h"
#include "scene/graph.h"
#include "scene/object.h"
#include "scene/texture.h"
#include "system/message.h"

#include <string.h>

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
 * it. Filling that costs little, and the loops need no case distinction.
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

/* The lower left, lower right, upper left and upper right of four texels. */
typedef struct texel_cell {
  uint32_t c00, c10, c01, c11;
} texel_cell;

LEAF texel_cell texel_cell_at(const uint32_t *texel, texel_place p) {
  return (texel_cell){texel[p.at], texel[p.at + 1], texel[p.at + p.stride],
                      texel[p.at + p.stride + 1]};
}

/* The two numbers of a texel, in [-1, 1]. */
LEAF void cell_pair(texel_cell c, float s, float t, float *a, float *b) {
  const float scale = 1.0f / 32767.0f;
  *a = scale * lerp(lerp(low_half(c.c00), low_half(c.c10), s),
                    lerp(low_half(c.c01), low_half(c.c11), s), t);
  *b = scale * lerp(lerp(high_half(c.c00), high_half(c.c10), s),
                    lerp(high_half(c.c01), high_half(c.c11), s), t);
}

LEAF void texel_pair(const uint32_t *texel, texel_place p, float *a, float *b) {
  cell_pair(texel_cell_at(texel, p), p.s, p.t, a, b);
}

/*
 * Places of some lanes, and what is there. A gather of four texels takes as long as everything
 * else that is done with them; lane by lane the two that lie side by side are one load.
 */
enum { PLACE_LANES = 128 };
typedef struct texel_places {
  int at[PLACE_LANES], stride[PLACE_LANES], level[PLACE_LANES];
  float s[PLACE_LANES], t[PLACE_LANES];
} texel_places;
typedef struct texel_cells {
  uint32_t lower[2 * PLACE_LANES], upper[2 * PLACE_LANES];
} texel_cells;

LEAF void places_put(texel_places *to, size_t k, texel_place p) {
  to->at[k] = p.at;
  to->stride[k] = p.stride;
  to->s[k] = p.s;
  to->t[k] = p.t;
}

/* begins: where each level's texels begin, or NULL for places in the first. */
LEAF void cells_fetch(const uint32_t *texel, const int *begins, const texel_places *p, size_t count,
                      texel_cells *to) {
  for (size_t k = 0; k < count; k++) {
    const uint32_t *from = texel + p->at[k] + (begins ? begins[p->level[k]] : 0);
#if defined(__GNUC__)
    __asm__("" : "+r"(from)); /* or compilers make gathers of it */
#endif
    memcpy(to->lower + 2 * k, from, 2 * sizeof *from);
    memcpy(to->upper + 2 * k, from + p->stride[k], 2 * sizeof *from);
  }
}

LEAF texel_cell fetched(const texel_cells *c, size_t k) {
  return (texel_cell){c->lower[2 * k], c->lower[2 * k + 1], c->upper[2 * k], c->upper[2 * k + 1]};
}

LEAF size_t place_count(size_t begin, size_t end) {
  return end - begin < PLACE_LANES ? end - begin : PLACE_LANES;
}

#endif
