/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An image, at the UV map's place, as a tangent-space normal map, as Cycles reads it: `image`, its
 * index, and `strength`. Writes `out`, a normal in the shading frame; `filtered`: of the normals
 * that the ray stands for the mean, and two numbers more, twice the variance of their slopes along
 * the frame's x and y, which is what they add to the squares of a lobe's alphas [OlanoBaker2010].
 */
#ifndef LIBSHADE_NODE_NORMAL_MAP_H
#define LIBSHADE_NODE_NORMAL_MAP_H

#include "node/image.h"

typedef struct node_normal_map {
  int image, out[5];
  bool filtered;
  float strength, texels; /* texels: across the UV map, by the part of a ray that is filtered */
  const texture *normal, *squares; /* squares: NULL where points are looked at */
} node_normal_map;

static inline bool node_normal_map_read(reader *r, node_normal_map *n, graph *g) {
  double strength;
  n->filtered = false;
  if (!reader_may_flag(r, "filtered", &n->filtered) ||
      !reader_integer(r, "image", 0, (long)g->images - 1, &n->image) ||
      !reader_number(r, "strength", &strength) ||
      !graph_outputs(r, g, "out", n->filtered ? 5 : 3, n->out))
    return false;
  n->strength = (float)fmin(fmax(strength, 0.0), 1e6);
  return true;
}

static inline bool node_normal_map_build(node_normal_map *n, const node_place *place) {
  const image *source = place->image + n->image;
  bool coarse = n->filtered && place->normal_blur > 0.0f && !source->closest;
  n->normal = texture_request(place->textures, source, TEXTURE_NORMAL, n->strength,
                              coarse ? COARSE_EVEN : COARSE_NONE);
  n->texels =
      place->normal_blur * (float)(source->width > source->height ? source->width : source->height);
  n->squares = coarse && n->normal ? texture_squares(place->textures, n->normal) : NULL;
  const double narrow = 0.02 * (double)n->strength; /* alpha: 2.5 steps of 8 bits */
  if (place->exponent * narrow * narrow > 2.0 && texture_is_8bit(source))
    message_warn(place->log,
                 "material %s: an 8-bit normal map is too coarse for an exponent of %g; use "
                 "16 bits or float",
                 place->material, place->exponent);
  return n->normal && (n->squares || !coarse);
}

/*
 * x and y of the map's normal to the shading frame, whose y axis is cross(N, T) and whose N faces
 * the eye: on the back the bumps are those of the same displaced sheet, seen from behind.
 */
LEAF vec3 node_normal_map_unit(float x, float y, float side, float handed) {
  float z2 = 1.0f - x * x - y * y;
  z2 = z2 > 1e-8f ? z2 : 1e-8f;
  float inverse = 1.0f / sqrtf(x * x + y * y + z2);
  return (vec3){x * side * inverse, y * handed * inverse, sqrtf(z2) * inverse};
}

/* A block of points by themselves. */
LEAF void node_normal_map_points(image_wrap wrap, const node_normal_map *n, size_t first,
                                 size_t count, const corners *restrict corner,
                                 const surfaces *restrict point, inputs *at) {
  const texture own = *n->normal;
  float *nx = at->at[n->out[0]], *ny = at->at[n->out[1]], *nz = at->at[n->out[2]];
  texel_places p;
  texel_cells cells;
#pragma omp simd
  for (size_t k = 0; k < count; k++)
    places_put(&p, k, texel_find(wrap, &own, point->u[first + k], point->v[first + k]));
  cells_fetch(own.texel, NULL, &p, count, &cells);
#pragma omp simd
  for (size_t k = 0; k < count; k++) {
    const size_t i = first + k;
    float x, y;
    cell_pair(fetched(&cells, k), p.s[k], p.t[k], &x, &y);
    vec3 normal = node_normal_map_unit(x, y, point->side[i], corner->handed[i]);
    nx[i] = normal.x;
    ny[i] = normal.y;
    nz[i] = normal.z;
  }
}

/*
 * A block of footprints, some of them wider than a texel. Between two levels a point takes either,
 * as images do. The spread about the mean is a part of that about the mean of a wider level
 * (texture.h says why), and points by themselves have none.
 */
LEAF void node_normal_map_filtered(image_wrap wrap, const node_normal_map *n, size_t first,
                                   size_t count, const float *restrict covered,
                                   const corners *restrict corner, const surfaces *restrict point,
                                   inputs *at) {
  const texture_levels of = n->normal->level, squares_of = n->squares->level;
  const uint32_t *texel = n->normal->texel, *square = n->squares->texel;
  const float *part_x = n->normal->part[0], *part_y = n->normal->part[1];
  const float *u = point->u, *v = point->v;
  float *nx = at->at[n->out[0]], *ny = at->at[n->out[1]], *nz = at->at[n->out[2]];
  float *sx = at->at[n->out[3]], *sy = at->at[n->out[4]];
  const int last = of.count - 1;
  texel_places own, wide, spread;
  texel_cells own_cells, wide_cells, spread_cells;
#pragma omp simd
  for (size_t k = 0; k < count; k++) {
    const size_t i = first + k;
    int level = image_level(covered[k], of.count, u[i], v[i]);
    int wider = level + TEXTURE_WIDER < last ? level + TEXTURE_WIDER : last;
    int squared = wider > 0 ? wider - 1 : 0;
    own.level[k] = level;
    wide.level[k] = wider;
    spread.level[k] = squared;
    places_put(&own, k, image_find_in(wrap, &of, level, u[i], v[i]));
    places_put(&wide, k, image_find_in(wrap, &of, wider, u[i], v[i]));
    places_put(&spread, k, image_find_in(wrap, &squares_of, squared, u[i], v[i]));
  }
  cells_fetch(texel, of.at, &own, count, &own_cells);
  cells_fetch(texel, of.at, &wide, count, &wide_cells);
  cells_fetch(square, squares_of.at, &spread, count, &spread_cells);
#pragma omp simd
  for (size_t k = 0; k < count; k++) {
    const size_t i = first + k;
    const int level = own.level[k];
    float x, y, wide_x, wide_y, xx, yy;
    cell_pair(fetched(&own_cells, k), own.s[k], own.t[k], &x, &y);
    cell_pair(fetched(&wide_cells, k), wide.s[k], wide.t[k], &wide_x, &wide_y);
    cell_pair(fetched(&spread_cells, k), spread.s[k], spread.t[k], &xx, &yy);
    /* from the spread of a unit normal's x and y to that of x/z and y/z: squares of their slopes */
    float zz = clampf(1.0f - xx - yy, 0.3f, 1.0f), by = level > 0 ? 2.0f / (zz * zz * zz) : 0.0f;
    float left_x = xx - wide_x * wide_x, left_y = yy - wide_y * wide_y;
    sx[i] = left_x > 0.0f ? by * (1.0f - yy) * (1.0f - yy) * left_x * part_x[level] : 0.0f;
    sy[i] = left_y > 0.0f ? by * (1.0f - xx) * (1.0f - xx) * left_y * part_y[level] : 0.0f;
    vec3 normal = node_normal_map_unit(x, y, point->side[i], corner->handed[i]);
    nx[i] = normal.x;
    ny[i] = normal.y;
    nz[i] = normal.z;
  }
}

LEAF void node_normal_map_any(image_wrap wrap, const node_normal_map *n, lane_run g,
                              const corners *corner, const surfaces *point, inputs *at) {
  const bool coarse =
      n->squares && at->normal_blur > 0.0f && texture_is_coarse(point->uv_width, n->texels);
  const image_slope by_uv = {.s_u = (float)n->normal->width, .t_v = (float)n->normal->height};
  float covered[PLACE_LANES];
  for (int k = 3; n->filtered && k < 5; k++)
    memset(at->at[n->out[k]] + g.begin, 0, (g.end - g.begin) * sizeof(float));
  for (size_t first = g.begin; first < g.end; first += PLACE_LANES) {
    const size_t count = place_count(first, g.end);
    if (coarse && image_footprints(point, first, count, by_uv, at->normal_blur, covered))
      node_normal_map_filtered(wrap, n, first, count, covered, corner, point, at);
    else
      node_normal_map_points(wrap, n, first, count, corner, point, at);
  }
}

LEAF void node_normal_map_run(const node_normal_map *n, lane_run g, const corners *corner,
                              const surfaces *point, inputs *at) {
  switch (n->normal->wrap) {
  case WRAP_REPEAT:
    node_normal_map_any(WRAP_REPEAT, n, g, corner, point, at);
    break;
  case WRAP_MIRROR:
    node_normal_map_any(WRAP_MIRROR, n, g, corner, point, at);
    break;
  case WRAP_EXTEND:
  case WRAP_CLIP:
    node_normal_map_any(WRAP_EXTEND, n, g, corner, point, at);
  }
}

#endif
