/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An image's colour: `image`, its index; `at`, two operands, where it is not the UV map's place.
 * `cubic`, whether texels are mixed by cubic splines. Writes `out`, red, green and blue, and, where
 * it is there, `alpha`. `averaged`: over what the ray stands for; `near`, where `at` is, two
 * operands a step of `step` further along u and two as far along v. */
#ifndef LIBSHADE_NODE_IMAGE_H
#define LIBSHADE_NODE_IMAGE_H

#include "node/geometry.h"

typedef struct node_image {
  int image, out[3], alpha; /* alpha: -1 where nothing asks for it */
  bool placed, cubic, averaged;
  operand at[2], near[4];
  float per_step, texels; /* across the UV map, where these are averaged, by their part of a ray */
  const texture *red_green, *blue_alpha; /* of bytes the first is all */
  const texture *one[4];                 /* of a wide image, by channel, else NULL */
  uint32_t srgb;                         /* what is mixed is to be decoded, for either() */
} node_image;

static inline bool node_image_read(reader *r, node_image *n, graph *g) {
  n->alpha = -1;
  n->placed = reader_has(r, "at");
  n->cubic = n->averaged = false;
  n->per_step = 0.0f;
  double step = 1.0;
  if (!reader_may_flag(r, "averaged", &n->averaged))
    return false;
  if (n->averaged && n->placed) {
    if (!graph_operands(r, g, "near", 4, n->near) || !reader_number(r, "step", &step))
      return false;
    n->per_step = (float)(1.0 / fmin(fmax(step, 1e-6), 1.0));
  }
  return reader_may_flag(r, "cubic", &n->cubic) &&
         reader_integer(r, "image", 0, (long)g->images - 1, &n->image) &&
         (!n->placed || graph_operands(r, g, "at", 2, n->at)) &&
         graph_outputs(r, g, "out", 3, n->out) &&
         (!reader_has(r, "alpha") || graph_outputs(r, g, "alpha", 1, &n->alpha));
}

/* Light of many sizes is not averaged: one bright texel would be seen from afar as a block. */
static inline bool node_image_widely(node_image *n, const image *source, const node_place *place) {
  n->averaged = false;
  for (int k = 0; k < 4; k++) {
    n->one[k] =
        texture_request(place->textures, source, TEXTURE_RED + (unsigned)k, 1.0f, COARSE_NONE);
    if (!n->one[k])
      return false;
  }
  n->red_green = n->blue_alpha = n->one[0];
  return true;
}

static inline bool node_image_build(node_image *n, const node_place *place) {
  const image *source = place->image + n->image;
  n->averaged = n->averaged && !n->cubic && !source->closest && place->texture_blur > 0.0f;
  n->texels = place->texture_blur *
              (float)(source->width > source->height ? source->width : source->height);
  for (int k = 0; k < 4; k++)
    n->one[k] = NULL;
  if (source->wide)
    return node_image_widely(n, source, place);
  texture_coarse coarse = !n->averaged    ? COARSE_NONE
                          : n->alpha >= 0 ? COARSE_WEIGHTED
                                          : COARSE_EVEN;
  n->srgb = source->srgb ? UINT32_MAX : 0;
  n->blue_alpha = NULL;
  if (source->type == IMAGE_UINT8) {
    n->red_green = texture_request(place->textures, source, TEXTURE_BYTES, 1.0f, coarse);
    return n->red_green;
  }
  n->red_green = texture_request(place->textures, source, TEXTURE_RED_GREEN, 1.0f, coarse);
  n->blue_alpha = texture_request(place->textures, source, TEXTURE_BLUE_ALPHA, 1.0f, coarse);
  return n->red_green && n->blue_alpha;
}

/* [-1, 1] of the texture to [0, 1]; the last rounding may be beyond. */
LEAF float tint(float c) {
  return clampf(0.5f + 0.5f * c, 0.0f, 1.0f);
}

/* sRGB to light: 1.1e-5 of it. The power of .4 is that of the root, by a polynomial. */
LEAF float light_of(float c) {
  float u = (c + 0.055f) * (1.0f / 1.055f), s = sqrtf(u);
  float p = 0.751994425f + s * (-0.431574699f + s * 0.106261945f);
  p = 0.0359017390f + s * (1.33498098f + s * (-0.797553513f + s * p));
  return c <= 0.04045f ? c * (1.0f / 12.92f) : u * u * p;
}

typedef struct image_color {
  float r, g, b, a;
} image_color;

/* One of the bytes of four texels, mixed. */
LEAF float byte_mixed(texel_cell of, int by, float x, float y) {
  float a = (float)(int32_t)(of.c00 >> by & 255u), b = (float)(int32_t)(of.c10 >> by & 255u);
  float c = (float)(int32_t)(of.c01 >> by & 255u), d = (float)(int32_t)(of.c11 >> by & 255u);
  return (1.0f / 255.0f) * lerp(lerp(a, b, x), lerp(c, d, x), y);
}

LEAF image_color cell_color(texel_cell c, float s, float t) {
  return (image_color){byte_mixed(c, 0, s, t), byte_mixed(c, 8, s, t), byte_mixed(c, 16, s, t),
                       byte_mixed(c, 24, s, t)};
}

LEAF image_color texel_color(const uint32_t *texel, texel_place p) {
  return cell_color(texel_cell_at(texel, p), p.s, p.t);
}

LEAF image_color decoded(uint32_t srgb, image_color c) {
  return (image_color){either(srgb, light_of(c.r), c.r), either(srgb, light_of(c.g), c.g),
                       either(srgb, light_of(c.b), c.b), c.a};
}

LEAF image_color pair_color(texel_cell red_green, texel_cell blue_alpha, float s, float t) {
  float r, g, b, a;
  cell_pair(red_green, s, t, &r, &g);
  cell_pair(blue_alpha, s, t, &b, &a);
  return (image_color){tint(r), tint(g), tint(b), tint(a)};
}

LEAF void node_image_bytes(image_wrap wrap, const node_image *n, lane_run g, const float *u,
                           const float *v, inputs *at) {
  const texture own = *n->red_green;
  const uint32_t *texel = own.texel, srgb = n->srgb;
  float *red = at->at[n->out[0]], *green = at->at[n->out[1]], *blue = at->at[n->out[2]];
  float *alpha = n->alpha < 0 ? at->constant[2] : at->at[n->alpha];
  texel_places p;
  texel_cells cells;
  for (size_t first = g.begin; first < g.end; first += PLACE_LANES) {
    const size_t count = place_count(first, g.end);
#pragma omp simd
    for (size_t k = 0; k < count; k++)
      places_put(&p, k, texel_find(wrap, &own, u[first + k], v[first + k]));
    cells_fetch(texel, NULL, &p, count, &cells);
#pragma omp simd
    for (size_t k = 0; k < count; k++) {
      image_color c = decoded(srgb, cell_color(fetched(&cells, k), p.s[k], p.t[k]));
      red[first + k] = c.r;
      green[first + k] = c.g;
      blue[first + k] = c.b;
      alpha[first + k] = c.a;
    }
  }
}

LEAF void node_image_wrapped(image_wrap wrap, bool srgb, const node_image *n, lane_run g,
                             const float *u, const float *v, inputs *at) {
  const texture own = *n->red_green; /* the other is as large */
  const uint32_t *red_green = own.texel, *blue_alpha = n->blue_alpha->texel;
  float *red = at->at[n->out[0]], *green = at->at[n->out[1]], *blue = at->at[n->out[2]];
  float *alpha = n->alpha < 0 ? at->constant[2] : at->at[n->alpha];
  texel_places p;
  texel_cells one, other;
  for (size_t first = g.begin; first < g.end; first += PLACE_LANES) {
    const size_t count = place_count(first, g.end);
#pragma omp simd
    for (size_t k = 0; k < count; k++)
      places_put(&p, k, texel_find(wrap, &own, u[first + k], v[first + k]));
    cells_fetch(red_green, NULL, &p, count, &one);
    cells_fetch(blue_alpha, NULL, &p, count, &other);
#pragma omp simd
    for (size_t k = 0; k < count; k++) {
      image_color c = pair_color(fetched(&one, k), fetched(&other, k), p.s[k], p.t[k]);
      c = srgb ? decoded(UINT32_MAX, c) : c;
      red[first + k] = c.r;
      green[first + k] = c.g;
      blue[first + k] = c.b;
      alpha[first + k] = c.a;
    }
  }
}

/* Where to look twice for four texels' mean by a cubic B-spline: between the first two and the last
 * two of them, and how much of the latter [SiggHadwiger2005]. */
typedef struct spline {
  float first, last, share;
} spline;

LEAF spline spline_find(float u, float size) {
  float x = u * size - 0.5f, whole = floor_small(x), f = x - whole, e = 1.0f - f;
  float w1 = (4.0f + f * f * (3.0f * f - 6.0f)) * (1.0f / 6.0f);
  float w3 = f * f * f * (1.0f / 6.0f),
        share = (1.0f + f * (3.0f + f * (3.0f - 3.0f * f))) / 6 + w3;
  float w0 = e * e * e * (1.0f / 6.0f);
  return (spline){.first = (whole - 0.5f + w1 / (w0 + w1)) / size,
                  .last = (whole + 1.5f + w3 / share) / size,
                  .share = share};
}

LEAF float four_mixed(float f00, float f10, float f01, float f11, float s, float t) {
  return lerp(lerp(f00, f10, s), lerp(f01, f11, s), t);
}

LEAF void node_image_cubic_bytes(image_wrap wrap, const node_image *n, lane_run g, const float *u,
                                 const float *v, inputs *at) {
  const texture own = *n->red_green;
  const uint32_t *texel = own.texel, srgb = n->srgb;
  float *red = at->at[n->out[0]], *green = at->at[n->out[1]], *blue = at->at[n->out[2]];
  float *alpha = n->alpha < 0 ? at->constant[2] : at->at[n->alpha];
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    spline x = spline_find(u[i], (float)own.width), y = spline_find(v[i], (float)own.height);
    image_color a = texel_color(texel, texel_find(wrap, &own, x.first, y.first));
    image_color b = texel_color(texel, texel_find(wrap, &own, x.last, y.first));
    image_color c = texel_color(texel, texel_find(wrap, &own, x.first, y.last));
    image_color d = texel_color(texel, texel_find(wrap, &own, x.last, y.last));
    image_color all = {four_mixed(a.r, b.r, c.r, d.r, x.share, y.share),
                       four_mixed(a.g, b.g, c.g, d.g, x.share, y.share),
                       four_mixed(a.b, b.b, c.b, d.b, x.share, y.share),
                       four_mixed(a.a, b.a, c.a, d.a, x.share, y.share)};
    all = decoded(srgb, all);
    red[i] = all.r;
    green[i] = all.g;
    blue[i] = all.b;
    alpha[i] = all.a;
  }
}

LEAF void node_image_cubic(image_wrap wrap, const node_image *n, lane_run g, const float *u,
                           const float *v, inputs *at) {
  const texture own = *n->red_green; /* the other is as large */
  const uint32_t *texel[2] = {own.texel, n->blue_alpha->texel};
  float *out[4] = {at->at[n->out[0]], at->at[n->out[1]], at->at[n->out[2]],
                   n->alpha < 0 ? at->constant[2] : at->at[n->alpha]};
  for (int k = 0; k < 2; k++) {
    const uint32_t *from = texel[k];
    float *one = out[2 * k], *two = out[2 * k + 1];
#pragma omp simd
    for (size_t i = g.begin; i < g.end; i++) {
      spline x = spline_find(u[i], (float)own.width), y = spline_find(v[i], (float)own.height);
      float a[4], b[4];
      texel_pair(from, texel_find(wrap, &own, x.first, y.first), &a[0], &b[0]);
      texel_pair(from, texel_find(wrap, &own, x.last, y.first), &a[1], &b[1]);
      texel_pair(from, texel_find(wrap, &own, x.first, y.last), &a[2], &b[2]);
      texel_pair(from, texel_find(wrap, &own, x.last, y.last), &a[3], &b[3]);
      float c = tint(four_mixed(a[0], a[1], a[2], a[3], x.share, y.share));
      float d = tint(four_mixed(b[0], b[1], b[2], b[3], x.share, y.share));
      one[i] = either(n->srgb, light_of(c), c);
      two[i] = either(k ? 0u : n->srgb, light_of(d), d);
    }
  }
}

LEAF float texel_float(const uint32_t *texel, texel_place p) {
  return four_mixed(float_of_bits((int32_t)texel[p.at]), float_of_bits((int32_t)texel[p.at + 1]),
                    float_of_bits((int32_t)texel[p.at + p.stride]),
                    float_of_bits((int32_t)texel[p.at + p.stride + 1]), p.s, p.t);
}

LEAF void node_image_wide(image_wrap wrap, bool cubic, const node_image *n, lane_run g,
                          const float *u, const float *v, inputs *at) {
  const texture own = *n->one[0]; /* the others are as large */
  for (int k = 0; k < (n->alpha < 0 ? 3 : 4); k++) {
    const uint32_t *texel = n->one[k]->texel;
    float *out = at->at[k < 3 ? n->out[k] : n->alpha];
#pragma omp simd
    for (size_t i = g.begin; i < g.end; i++) {
      spline x = cubic ? spline_find(u[i], (float)own.width) : (spline){u[i], u[i], 0.0f};
      spline y = cubic ? spline_find(v[i], (float)own.height) : (spline){v[i], v[i], 0.0f};
      float a = texel_float(texel, texel_find(wrap, &own, x.first, y.first));
      if (cubic)
        a = four_mixed(a, texel_float(texel, texel_find(wrap, &own, x.last, y.first)),
                       texel_float(texel, texel_find(wrap, &own, x.first, y.last)),
                       texel_float(texel, texel_find(wrap, &own, x.last, y.last)), x.share,
                       y.share);
      out[i] = a;
    }
  }
}

/* How much the place in the image, in texels, changes along u and v. */
typedef struct image_slope {
  float s_u, s_v, t_u, t_v;
} image_slope;

/*
 * How many texels a ray of this width stands for, squared, where they are fewest: of the ellipse
 * that its round section covers in the image the short axis. With q across the ray and across_u,
 * across_v as in node/weave.h it is the smaller singular value of q to texels.
 */
LEAF float image_footprint(const surfaces *restrict point, size_t i, image_slope by, float width) {
  vec3 eye = world_of(point, i, load(&point->wo, i));
  vec3 du = load(&point->du, i), dv = load(&point->dv, i);
  vec3 v = cross(dv, eye), u = cross(eye, du);
  vec3 s = {by.s_u * v.x + by.s_v * u.x, by.s_u * v.y + by.s_v * u.y, by.s_u * v.z + by.s_v * u.z};
  vec3 t = {by.t_u * v.x + by.t_v * u.x, by.t_u * v.y + by.t_v * u.y, by.t_u * v.z + by.t_v * u.z};
  float ss = dot(s, s), tt = dot(t, t), st = dot(s, t), half = 0.5f * (ss - tt);
  float larger = 0.5f * (ss + tt) + sqrtf(half * half + st * st);
  float area = (by.s_u * by.t_v - by.s_v * by.t_u) * width;
  return area * area / (larger > 1e-30f ? larger : 1e-30f);
}

/* Of a block. False where all are so fine that the image is seen as it is. */
LEAF bool image_footprints(const surfaces *restrict point, size_t first, size_t count,
                           image_slope by, float blur, float *restrict texels2) {
  float most = 0.0f;
#pragma omp simd reduction(max : most)
  for (size_t k = 0; k < count; k++) {
    float own = image_footprint(point, first + k, by, blur * point->width[first + k]);
    texels2[k] = own;
    most = own > most ? own : most;
  }
  return most > TEXTURE_FINE;
}

/*
 * A texel's mean, weighted by how near it is looked up, spreads as far as that over a square of the
 * square root of three times its width: from that width on the image is seen coarser. Between two
 * levels a point takes either, by the last bits of its place, so that in the mean it is as far.
 */
LEAF int image_level(float texels2, int count, float u, float v) {
  float square = clampf(texels2 * (1.0f / TEXTURE_FINE), 1.0f, 1e12f);
  int level = ((bits_of_float(square) >> 23) - 127) >> 1; /* 4^level <= square < 4^(level + 1) */
  float more = square * float_of_bits((127 - 2 * level) << 23) - 1.0f;
  uint32_t h = mix((uint32_t)bits_of_float(u) * 0x9e3779b1u ^ (uint32_t)bits_of_float(v));
  level += 3.0f * unit_float(h) < more ? 1 : 0;
  return level < count - 1 ? level : count - 1;
}

/* In the level itself: from where its texels begin. */
LEAF texel_place image_find_in(image_wrap wrap, const texture_levels *restrict of, int level,
                               float u, float v) {
  float half = float_of_bits((127 - level) << 23); /* halved so often */
  float width = floor_small(of->width * half), height = floor_small(of->height * half);
  width = width > 1.0f ? width : 1.0f;
  height = height > 1.0f ? height : 1.0f;
  float x = texel_position(wrap, u, width, 1.0f), y = texel_position(wrap, v, height, 1.0f);
  int column = (int)x, line = (int)y, stride = (int)width + TEXTURE_RIM;
  return (texel_place){
      .at = line * stride + column, .stride = stride, .s = x - (float)column, .t = y - (float)line};
}

LEAF void node_image_averaged(bool bytes, bool placed, image_wrap wrap, const node_image *n,
                              lane_run g, const float *u, const float *v,
                              const surfaces *restrict point, inputs *at) {
  const texture_levels of = n->red_green->level; /* the other's are alike */
  const uint32_t *red_green = n->red_green->texel;
  const uint32_t *blue_alpha = bytes ? red_green : n->blue_alpha->texel, srgb = n->srgb;
  float *red = at->at[n->out[0]], *green = at->at[n->out[1]], *blue = at->at[n->out[2]];
  float *alpha = n->alpha < 0 ? at->constant[2] : at->at[n->alpha];
  const float *near[4];
  for (int k = 0; k < 4; k++)
    near[k] = placed ? lane_of(at, n->near[k], 3 + k, g) : u;
  const float *su = near[0], *tu = near[1], *sv = near[2], *tv = near[3];
  const float width = of.width, height = of.height, blur = at->texture_blur;
  const float by_s = width * n->per_step, by_t = height * n->per_step;
  texel_places p;
  texel_cells one, other;
  for (size_t first = g.begin; first < g.end; first += PLACE_LANES) {
    const size_t count = place_count(first, g.end);
#pragma omp simd
    for (size_t k = 0; k < count; k++) {
      const size_t i = first + k;
      image_slope by = {.s_u = placed ? (su[i] - u[i]) * by_s : width,
                        .s_v = placed ? (sv[i] - u[i]) * by_s : 0.0f,
                        .t_u = placed ? (tu[i] - v[i]) * by_t : 0.0f,
                        .t_v = placed ? (tv[i] - v[i]) * by_t : height};
      float texels2 = image_footprint(point, i, by, blur * point->width[i]);
      int level = image_level(texels2, of.count, u[i], v[i]);
      p.level[k] = level;
      places_put(&p, k, image_find_in(wrap, &of, level, u[i], v[i]));
    }
    cells_fetch(red_green, of.at, &p, count, &one);
    if (!bytes)
      cells_fetch(blue_alpha, of.at, &p, count, &other);
#pragma omp simd
    for (size_t k = 0; k < count; k++) {
      image_color c = bytes ? cell_color(fetched(&one, k), p.s[k], p.t[k])
                            : pair_color(fetched(&one, k), fetched(&other, k), p.s[k], p.t[k]);
      c = decoded(srgb, c);
      red[first + k] = c.r;
      green[first + k] = c.g;
      blue[first + k] = c.b;
      alpha[first + k] = c.a;
    }
  }
}

LEAF void node_image_any(image_wrap wrap, const node_image *n, lane_run g, const float *u,
                         const float *v, const surfaces *point, inputs *at) {
  const bool bytes = !n->blue_alpha;
  const bool averaged = n->averaged && at->texture_blur > 0.0f &&
                        (n->placed || texture_is_coarse(point->uv_width, n->texels));
  if (n->one[0] && n->cubic)
    node_image_wide(wrap, true, n, g, u, v, at);
  else if (n->one[0])
    node_image_wide(wrap, false, n, g, u, v, at);
  else if (averaged && bytes && n->placed)
    node_image_averaged(true, true, wrap, n, g, u, v, point, at);
  else if (averaged && bytes)
    node_image_averaged(true, false, wrap, n, g, u, v, point, at);
  else if (averaged && n->placed)
    node_image_averaged(false, true, wrap, n, g, u, v, point, at);
  else if (averaged)
    node_image_averaged(false, false, wrap, n, g, u, v, point, at);
  else if (n->cubic && bytes)
    node_image_cubic_bytes(wrap, n, g, u, v, at);
  else if (n->cubic)
    node_image_cubic(wrap, n, g, u, v, at);
  else if (bytes)
    node_image_bytes(wrap, n, g, u, v, at);
  else if (n->srgb)
    node_image_wrapped(wrap, true, n, g, u, v, at);
  else
    node_image_wrapped(wrap, false, n, g, u, v, at);
}

LEAF void node_image_run(const node_image *n, lane_run g, const corners *corner,
                         const surfaces *point, inputs *at) {
  const float *u = n->placed ? lane_of(at, n->at[0], 0, g) : point->u;
  const float *v = n->placed ? lane_of(at, n->at[1], 1, g) : point->v;
  (void)corner;
  switch (n->red_green->wrap) {
  case WRAP_REPEAT:
    node_image_any(WRAP_REPEAT, n, g, u, v, point, at);
    break;
  case WRAP_MIRROR:
    node_image_any(WRAP_MIRROR, n, g, u, v, point, at);
    break;
  case WRAP_EXTEND:
  case WRAP_CLIP:
    node_image_any(WRAP_EXTEND, n, g, u, v, point, at);
  }
}

#endif
