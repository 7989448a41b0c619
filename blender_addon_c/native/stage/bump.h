/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Textures: two numbers a look-up, then normals or colours from them. */
#include "batch/leaf.h"
#include "stage/stage.h"

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

LEAF void look_up(bool repeat, const segment *g, const texture *texture,
                  const surfaces *restrict at, float *restrict a, float *restrict b) {
  const uint32_t *restrict texel = texture->texel;
  const float width = (float)texture->width, height = (float)texture->height;
  const float linear = texture->linear, scale = 1.0f / 32767.0f;
  const int stride = texture->stride;
#pragma omp simd
  for (size_t i = g->begin; i < g->end; i++) {
    float x = texel_position(repeat, at->u[i], width, linear);
    float y = texel_position(repeat, at->v[i], height, linear);
    int column = (int)x, line = (int)y;
    float s = (x - (float)column) * linear, t = (y - (float)line) * linear;
    int here = line * stride + column, above = here + stride;
    uint32_t c00 = texel[here], c10 = texel[here + 1];
    uint32_t c01 = texel[above], c11 = texel[above + 1];
    a[i] = scale *
           lerp(lerp(low_half(c00), low_half(c10), s), lerp(low_half(c01), low_half(c11), s), t);
    b[i] = scale * lerp(lerp(high_half(c00), high_half(c10), s),
                        lerp(high_half(c01), high_half(c11), s), t);
  }
}

static void stage_bilinear(const segment *g, const texture *texture, const surfaces *restrict at,
                           float *restrict a, float *restrict b) {
  if (texture->wrap == WRAP_REPEAT)
    look_up(true, g, texture, at, a, b);
  else
    look_up(false, g, texture, at, a, b);
}

/*
 * x and y of the map's normal to the shading frame, whose y axis is cross(N, T) and whose N faces
 * the eye: on the back the bumps are those of the same displaced sheet, seen from behind.
 */
static void stage_bump(const segment *g, const corners *restrict corner,
                       const surfaces *restrict at, inputs *restrict out) {
#pragma omp simd
  for (size_t i = g->begin; i < g->end; i++) {
    float x = out->normal.x[i], y = out->normal.y[i];
    float z2 = 1.0f - x * x - y * y;
    z2 = z2 > 1e-8f ? z2 : 1e-8f;
    float inverse = 1.0f / sqrtf(x * x + y * y + z2);
    out->normal.x[i] = x * at->side[i] * inverse;
    out->normal.y[i] = y * corner->handed[i] * inverse;
    out->normal.z[i] = sqrtf(z2) * inverse;
  }
}

/* [-1, 1] of the texture to [0, 1]; the last rounding may be beyond. */
static void stage_tint(const segment *g, inputs *restrict out) {
#pragma omp simd
  for (size_t i = g->begin; i < g->end; i++) {
    out->color.r[i] = clampf(0.5f + 0.5f * out->color.r[i], 0.0f, 1.0f);
    out->color.g[i] = clampf(0.5f + 0.5f * out->color.g[i], 0.0f, 1.0f);
    out->color.b[i] = clampf(0.5f + 0.5f * out->color.b[i], 0.0f, 1.0f);
  }
}
