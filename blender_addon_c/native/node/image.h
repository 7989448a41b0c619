/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An image's colour: `image`, its index; `at`, two operands, where it is not the UV map's place.
 * Writes `out`, red, green and blue, and, where it is there, `alpha`. */
#ifndef LIBSHADE_NODE_IMAGE_H
#define LIBSHADE_NODE_IMAGE_H

#include "node/common.h"

typedef struct node_image {
  int image, out[3], alpha; /* alpha: -1 where nothing asks for it */
  bool placed;
  operand at[2];
  const texture *red_green, *blue_alpha;
} node_image;

static inline bool node_image_read(reader *r, node_image *n, graph *g) {
  n->alpha = -1;
  n->placed = reader_has(r, "at");
  return reader_integer(r, "image", 0, (long)g->images - 1, &n->image) &&
         (!n->placed || graph_operands(r, g, "at", 2, n->at)) &&
         graph_outputs(r, g, "out", 3, n->out) &&
         (!reader_has(r, "alpha") || graph_outputs(r, g, "alpha", 1, &n->alpha));
}

static inline bool node_image_build(node_image *n, const node_place *place) {
  const image *source = place->image + n->image;
  n->red_green = texture_request(place->textures, source, TEXTURE_RED_GREEN, 1.0f);
  n->blue_alpha = texture_request(place->textures, source, TEXTURE_BLUE_ALPHA, 1.0f);
  return n->red_green && n->blue_alpha;
}

/* [-1, 1] of the texture to [0, 1]; the last rounding may be beyond. */
LEAF float tint(float c) {
  return clampf(0.5f + 0.5f * c, 0.0f, 1.0f);
}

LEAF void node_image_wrapped(image_wrap wrap, const node_image *n, lane_run g, const float *u,
                             const float *v, inputs *at) {
  const texture own = *n->red_green; /* the other is as large */
  const uint32_t *red_green = own.texel, *blue_alpha = n->blue_alpha->texel;
  float *red = at->at[n->out[0]], *green = at->at[n->out[1]], *blue = at->at[n->out[2]];
  float *alpha = n->alpha < 0 ? at->constant[2] : at->at[n->alpha];
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    texel_place p = texel_find(wrap, &own, u[i], v[i]);
    float a, b, c, d;
    texel_pair(red_green, p, &a, &b);
    texel_pair(blue_alpha, p, &c, &d);
    red[i] = tint(a);
    green[i] = tint(b);
    blue[i] = tint(c);
    alpha[i] = tint(d);
  }
}

LEAF void node_image_run(const node_image *n, lane_run g, const corners *corner,
                         const surfaces *point, inputs *at) {
  const float *u = n->placed ? lane_of(at, n->at[0], 0, g) : point->u;
  const float *v = n->placed ? lane_of(at, n->at[1], 1, g) : point->v;
  (void)corner;
  switch (n->red_green->wrap) {
  case WRAP_REPEAT:
    node_image_wrapped(WRAP_REPEAT, n, g, u, v, at);
    break;
  case WRAP_MIRROR:
    node_image_wrapped(WRAP_MIRROR, n, g, u, v, at);
    break;
  case WRAP_EXTEND:
  case WRAP_CLIP:
    node_image_wrapped(WRAP_EXTEND, n, g, u, v, at);
  }
}

#endif
