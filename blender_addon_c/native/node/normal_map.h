/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An image, at the UV map's place, as a tangent-space normal map, as Cycles reads it: `image`, its
 * index, and `strength`. Writes `out`, a normal in the shading frame. */
#ifndef LIBSHADE_NODE_NORMAL_MAP_H
#define LIBSHADE_NODE_NORMAL_MAP_H

#include "node/common.h"

typedef struct node_normal_map {
  int image, out[3];
  float strength;
  const texture *normal;
} node_normal_map;

static inline bool node_normal_map_read(reader *r, node_normal_map *n, graph *g) {
  double strength;
  if (!reader_integer(r, "image", 0, (long)g->images - 1, &n->image) ||
      !reader_number(r, "strength", &strength) || !graph_outputs(r, g, "out", 3, n->out))
    return false;
  n->strength = (float)fmin(fmax(strength, 0.0), 1e6);
  return true;
}

static inline bool node_normal_map_build(node_normal_map *n, const node_place *place) {
  const image *source = place->image + n->image;
  n->normal = texture_request(place->textures, source, TEXTURE_NORMAL, n->strength, COARSE_NONE);
  if (place->exponent > 500.0 && texture_is_8bit(source))
    message_warn(place->log,
                 "material %s: an 8-bit normal map is too coarse for an exponent of %g; use "
                 "16 bits or float",
                 place->material, place->exponent);
  return n->normal != NULL;
}

/*
 * x and y of the map's normal to the shading frame, whose y axis is cross(N, T) and whose N faces
 * the eye: on the back the bumps are those of the same displaced sheet, seen from behind.
 */
LEAF void node_normal_map_wrapped(image_wrap wrap, const node_normal_map *n, lane_run g,
                                  const corners *restrict corner, const surfaces *restrict point,
                                  inputs *at) {
  const texture own = *n->normal;
  const uint32_t *texel = own.texel;
  float *nx = at->at[n->out[0]], *ny = at->at[n->out[1]], *nz = at->at[n->out[2]];
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float x, y;
    texel_pair(texel, texel_find(wrap, &own, point->u[i], point->v[i]), &x, &y);
    float z2 = 1.0f - x * x - y * y;
    z2 = z2 > 1e-8f ? z2 : 1e-8f;
    float inverse = 1.0f / sqrtf(x * x + y * y + z2);
    nx[i] = x * point->side[i] * inverse;
    ny[i] = y * corner->handed[i] * inverse;
    nz[i] = sqrtf(z2) * inverse;
  }
}

LEAF void node_normal_map_run(const node_normal_map *n, lane_run g, const corners *corner,
                              const surfaces *point, inputs *at) {
  switch (n->normal->wrap) {
  case WRAP_REPEAT:
    node_normal_map_wrapped(WRAP_REPEAT, n, g, corner, point, at);
    break;
  case WRAP_MIRROR:
    node_normal_map_wrapped(WRAP_MIRROR, n, g, corner, point, at);
    break;
  case WRAP_EXTEND:
  case WRAP_CLIP:
    node_normal_map_wrapped(WRAP_EXTEND, n, g, corner, point, at);
  }
}

#endif
