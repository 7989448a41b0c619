/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Textures: two numbers a look-up, then normals or colours from them. */
#include "batch/leaf.h"

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

LEAF void look_up(bool repeat, size_t count, const texture *texture, const float *restrict u,
                  const float *restrict v, float *restrict a, float *restrict b) {
  const uint32_t *restrict texel = texture->texel;
  const float width = (float)texture->width, height = (float)texture->height;
  const float linear = texture->linear, scale = 1.0f / 32767.0f;
  const int stride = texture->stride;
  for (size_t i = 0; i < count; i++) {
    float x = texel_position(repeat, u[i], width, linear);
    float y = texel_position(repeat, v[i], height, linear);
    int column = (int)x, line = (int)y;
    float s = (x - (float)column) * linear, t = (y - (float)line) * linear;
    int at = line * stride + column, above = at + stride;
    uint32_t c00 = texel[at], c10 = texel[at + 1];
    uint32_t c01 = texel[above], c11 = texel[above + 1];
    a[i] = scale *
           lerp(lerp(low_half(c00), low_half(c10), s), lerp(low_half(c01), low_half(c11), s), t);
    b[i] = scale * lerp(lerp(high_half(c00), high_half(c10), s),
                        lerp(high_half(c01), high_half(c11), s), t);
  }
}

static void stage_bilinear(size_t count, const texture *texture, const float *restrict u,
                           const float *restrict v, float *restrict a, float *restrict b) {
  if (texture->wrap == WRAP_REPEAT)
    look_up(true, count, texture, u, v, a, b);
  else
    look_up(false, count, texture, u, v, a, b);
}

/*
 * x and y of the map's normal to the shading frame, whose y axis is cross(N, T) and whose N faces
 * the eye: on the back the bumps are those of the same displaced sheet, seen from behind.
 */
static void stage_bump(size_t count, const float *restrict handed, const float *restrict side,
                       float *restrict x, float *restrict y, float *restrict z) {
  for (size_t i = 0; i < count; i++) {
    float z2 = 1.0f - x[i] * x[i] - y[i] * y[i];
    z2 = z2 > 1e-8f ? z2 : 1e-8f;
    float inverse = 1.0f / sqrtf(x[i] * x[i] + y[i] * y[i] + z2);
    x[i] = x[i] * side[i] * inverse;
    y[i] = y[i] * handed[i] * inverse;
    z[i] = sqrtf(z2) * inverse;
  }
}

/* [-1, 1] of the texture to [0, 1]; the last rounding may be beyond. */
static void stage_tint(size_t count, float *restrict c) {
  for (size_t i = 0; i < count; i++)
    c[i] = clampf(0.5f + 0.5f * c[i], 0.0f, 1.0f);
}
