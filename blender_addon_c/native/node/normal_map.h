/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An image as a tangent-space normal map, as Cycles reads it: `image`, its index, and `strength`.
 */
#ifndef LIBSHADE_NODE_NORMAL_MAP_H
#define LIBSHADE_NODE_NORMAL_MAP_H

#include "node/common.h"

typedef struct node_normal_map {
  int image;
  float strength;
  const texture *normal;
} node_normal_map;

static inline bool node_normal_map_read(reader *r, node_normal_map *n, size_t images) {
  double strength;
  if (!reader_integer(r, "image", 0, (long)images - 1, &n->image) ||
      !reader_number(r, "strength", &strength))
    return false;
  n->strength = (float)fmin(fmax(strength, 0.0), 1e6);
  return true;
}

static inline bool node_normal_map_build(node_normal_map *n, const node_place *place) {
  const image *source = place->image + n->image;
  n->normal = texture_request(place->textures, source, TEXTURE_NORMAL, n->strength);
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
LEAF void node_normal_map_wrapped(bool repeat, const node_normal_map *n, lane_run g,
                                  const corners *restrict corner, const surfaces *restrict at,
                                  inputs *restrict out) {
  const texture own = *n->normal;
  const uint32_t *restrict texel = own.texel;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    float x, y;
    texel_pair(texel, texel_find(repeat, &own, at->u[i], at->v[i]), &x, &y);
    float z2 = 1.0f - x * x - y * y;
    z2 = z2 > 1e-8f ? z2 : 1e-8f;
    float inverse = 1.0f / sqrtf(x * x + y * y + z2);
    out->normal.x[i] = x * at->side[i] * inverse;
    out->normal.y[i] = y * corner->handed[i] * inverse;
    out->normal.z[i] = sqrtf(z2) * inverse;
  }
}

LEAF void node_normal_map_run(const node_normal_map *n, lane_run g, const corners *restrict corner,
                              const surfaces *restrict at, inputs *restrict out) {
  if (n->normal->wrap == WRAP_REPEAT)
    node_normal_map_wrapped(true, n, g, corner, at, out);
  else
    node_normal_map_wrapped(false, n, g, corner, at, out);
}

#endif
