/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An image's colour: `image`, its index; `at`, two operands, where it is not the UV map's place.
 * `cubic`, whether texels are mixed by cubic splines. Writes `out`, red, green and blue, and, where
 * it is there, `alpha`. */
#ifndef LIBSHADE_NODE_IMAGE_H
#define LIBSHADE_NODE_IMAGE_H

#include "node/common.h"

typedef struct node_image {
  int image, out[3], alpha; /* alpha: -1 where nothing asks for it */
  bool placed, cubic;
  operand at[2];
  const texture *red_green, *blue_alpha;
} node_image;

static inline bool node_image_read(reader *r, node_image *n, graph *g) {
  n->alpha = -1;
  n->placed = reader_has(r, "at");
  n->cubic = false;
  return (!reader_has(r, "cubic") || reader_flag(r, "cubic", &n->cubic)) &&
         reader_integer(r, "image", 0, (long)g->images - 1, &n->image) &&
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
      one[i] = tint(four_mixed(a[0], a[1], a[2], a[3], x.share, y.share));
      two[i] = tint(four_mixed(b[0], b[1], b[2], b[3], x.share, y.share));
    }
  }
}

LEAF void node_image_any(image_wrap wrap, const node_image *n, lane_run g, const float *u,
                         const float *v, inputs *at) {
  if (n->cubic)
    node_image_cubic(wrap, n, g, u, v, at);
  else
    node_image_wrapped(wrap, n, g, u, v, at);
}

LEAF void node_image_run(const node_image *n, lane_run g, const corners *corner,
                         const surfaces *point, inputs *at) {
  const float *u = n->placed ? lane_of(at, n->at[0], 0, g) : point->u;
  const float *v = n->placed ? lane_of(at, n->at[1], 1, g) : point->v;
  (void)corner;
  switch (n->red_green->wrap) {
  case WRAP_REPEAT:
    node_image_any(WRAP_REPEAT, n, g, u, v, at);
    break;
  case WRAP_MIRROR:
    node_image_any(WRAP_MIRROR, n, g, u, v, at);
    break;
  case WRAP_EXTEND:
  case WRAP_CLIP:
    node_image_any(WRAP_EXTEND, n, g, u, v, at);
  }
}

#endif
