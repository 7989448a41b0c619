/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Textures: two numbers a look-up, then normals or colours from them. */
#include "stage_common.h"

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
 * One axis: the texel at or before the point, the next one, the part of the way, and whether the
 * point is inside the image. Coordinates beyond 2^22 have no fraction left.
 */
LEAF void axis(image_wrap wrap, float u, int size, float linear, int *restrict first,
               int *restrict second, float *restrict part, bool *restrict inside) {
  u = clampf(u, -0x1p22f, 0x1p22f);
  *inside = wrap != WRAP_CLIP || ((u >= 0.0f) & (u <= 1.0f));
  u = wrap == WRAP_REPEAT ? u - (float)floor_int(u) : clampf(u, 0.0f, 1.0f);
  float x = u * (float)size - 0.5f * linear;
  int k = floor_int(x);
  *part = (x - (float)k) * linear;
  if (wrap == WRAP_REPEAT) {
    int a = k < 0 ? k + size : k;
    a = a >= size ? a - size : a; /* u just below 1 may round up */
    *first = a;
    *second = a + 1 == size ? 0 : a + 1;
  } else {
    int a = k < 0 ? 0 : k;
    int b = k + 1;
    *first = a < size ? a : size - 1;
    *second = b < size ? b : size - 1;
  }
}

LEAF void look_up(image_wrap wrap, size_t count, const uint32_t *restrict texel, int width,
                  int height, float linear, float outside, const float *restrict u,
                  const float *restrict v, float *restrict a, float *restrict b) {
  const float scale = 1.0f / 32767.0f;
  for (size_t i = 0; i < count; i++) {
    int x0, x1, y0, y1;
    float s, t;
    bool inside_x, inside_y;
    axis(wrap, u[i], width, linear, &x0, &x1, &s, &inside_x);
    axis(wrap, v[i], height, linear, &y0, &y1, &t, &inside_y);
    uint32_t c00 = texel[y0 * width + x0], c10 = texel[y0 * width + x1];
    uint32_t c01 = texel[y1 * width + x0], c11 = texel[y1 * width + x1];
    float low =
        lerp(lerp(low_half(c00), low_half(c10), s), lerp(low_half(c01), low_half(c11), s), t);
    float high =
        lerp(lerp(high_half(c00), high_half(c10), s), lerp(high_half(c01), high_half(c11), s), t);
    bool inside = inside_x & inside_y;
    a[i] = inside ? low * scale : outside;
    b[i] = inside ? high * scale : outside;
  }
}

static void stage_bilinear(size_t count, const texture *texture, const float *restrict u,
                           const float *restrict v, float *restrict a, float *restrict b) {
#define LOOK_UP(wrap)                                                                              \
  look_up(wrap, count, texture->texel, texture->width, texture->height, texture->linear,           \
          texture->outside, u, v, a, b)
  if (texture->wrap == WRAP_REPEAT)
    LOOK_UP(WRAP_REPEAT);
  else if (texture->wrap == WRAP_EXTEND)
    LOOK_UP(WRAP_EXTEND);
  else
    LOOK_UP(WRAP_CLIP);
#undef LOOK_UP
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

/* [-1, 1] of the texture to [0, 1]. */
static void stage_tint(size_t count, float *restrict c) {
  for (size_t i = 0; i < count; i++)
    c[i] = 0.5f + 0.5f * c[i];
}
