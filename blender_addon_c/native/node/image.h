/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An image as a colour: `image`, its index. */
#ifndef LIBSHADE_NODE_IMAGE_H
#define LIBSHADE_NODE_IMAGE_H

#include "node/common.h"

typedef struct node_image {
  int image;
  const texture *red_green, *blue;
} node_image;

static inline bool node_image_read(reader *r, node_image *n, size_t images) {
  return reader_integer(r, "image", 0, (long)images - 1, &n->image);
}

static inline bool node_image_build(node_image *n, const node_place *place) {
  const image *source = place->image + n->image;
  n->red_green = texture_request(place->textures, source, TEXTURE_RED_GREEN, 1.0f);
  n->blue = texture_request(place->textures, source, TEXTURE_BLUE, 1.0f);
  return n->red_green && n->blue;
}

/* [-1, 1] of the texture to [0, 1]; the last rounding may be beyond. */
LEAF float tint(float c) {
  return clampf(0.5f + 0.5f * c, 0.0f, 1.0f);
}

LEAF void node_image_wrapped(bool repeat, const node_image *n, lane_run g,
                             const surfaces *restrict at, inputs *restrict out) {
  const texture own = *n->red_green; /* blue is as large */
  const uint32_t *restrict red_green = own.texel, *restrict blue = n->blue->texel;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    texel_place p = texel_find(repeat, &own, at->u[i], at->v[i]);
    float red, green, third, nothing;
    texel_pair(red_green, p, &red, &green);
    texel_pair(blue, p, &third, &nothing);
    out->color.r[i] = tint(red);
    out->color.g[i] = tint(green);
    out->color.b[i] = tint(third);
  }
}

LEAF void node_image_run(const node_image *n, lane_run g, const corners *restrict corner,
                         const surfaces *restrict at, inputs *restrict out) {
  (void)corner;
  if (n->red_green->wrap == WRAP_REPEAT)
    node_image_wrapped(true, n, g, at, out);
  else
    node_image_wrapped(false, n, g, at, out);
}

#endif
