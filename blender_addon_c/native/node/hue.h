/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colours to hue, saturation and value or lightness, and back: `what`, a word of the table;
 * `color`, three operands. Writes `out`, three numbers. Hues are turns. As Blender has them
 * [Smith1978]. */
#ifndef LIBSHADE_NODE_HUE_H
#define LIBSHADE_NODE_HUE_H

#include "node/common.h"

LEAF float lesser(float a, float b) {
  return a < b ? a : b;
}
LEAF float greater(float a, float b) {
  return a > b ? a : b;
}

/* The hue of a colour whose largest part is `high`, `spread` above its least; 0 for grey. */
LEAF float hue_of(vec3 c, float high, float spread) {
  float by = spread != 0.0f ? 1.0f / spread : 0.0f;
  float red = (c.y - c.z) * by, green = 2.0f + (c.z - c.x) * by, blue = 4.0f + (c.x - c.y) * by;
  float sixth = c.x == high ? red : (c.y == high ? green : blue);
  sixth = spread != 0.0f ? sixth : 0.0f;
  return (sixth < 0.0f ? sixth + 6.0f : sixth) * (1.0f / 6.0f);
}

/* Of a hue in sixths the colour whose parts reach from 0 to 1. */
LEAF vec3 pure(float h) {
  return (vec3){clampf(fabsf(h - 3.0f) - 1.0f, 0.0f, 1.0f),
                clampf(2.0f - fabsf(h - 2.0f), 0.0f, 1.0f),
                clampf(2.0f - fabsf(h - 4.0f), 0.0f, 1.0f)};
}

LEAF vec3 hue_rgb_to_hsv(vec3 c) {
  float high = greater(c.x, greater(c.y, c.z)), spread = high - lesser(c.x, lesser(c.y, c.z));
  float saturation = high != 0.0f ? spread / (high != 0.0f ? high : 1.0f) : 0.0f;
  return (vec3){saturation != 0.0f ? hue_of(c, high, spread) : 0.0f, saturation, high};
}
/* A hue that is none counts as of the last sixth. */
LEAF vec3 hue_hsv_to_rgb(vec3 c) {
  float h = 6.0f * c.x;
  h = c.x == 1.0f ? 0.0f : (((h >= 0.0f) & (h < 6.0f)) ? h : 5.0f + (h - floor_small(h)));
  vec3 of = pure(h);
  return (vec3){c.z * (1.0f + c.y * (of.x - 1.0f)), c.z * (1.0f + c.y * (of.y - 1.0f)),
                c.z * (1.0f + c.y * (of.z - 1.0f))};
}

LEAF vec3 hue_rgb_to_hsl(vec3 c) {
  float high = greater(c.x, greater(c.y, c.z)), low = lesser(c.x, lesser(c.y, c.z));
  float sum = high + low, spread = high - low, light = lesser(1.0f, 0.5f * sum);
  float whole = light > 0.5f ? 2.0f - sum : sum;
  float saturation = ((spread != 0.0f) & (whole != 0.0f)) ? spread / whole : 0.0f;
  return (vec3){hue_of(c, high, spread), saturation, light};
}
LEAF vec3 hue_hsl_to_rgb(vec3 c) {
  vec3 of = pure(6.0f * c.x);
  float chroma = (1.0f - fabsf(2.0f * c.z - 1.0f)) * c.y;
  return (vec3){(of.x - 0.5f) * chroma + c.z, (of.y - 0.5f) * chroma + c.z,
                (of.z - 0.5f) * chroma + c.z};
}

#define HUE_TABLE(ROW)                                                                             \
  ROW(RGB_TO_HSV, rgb_to_hsv)                                                                      \
  ROW(HSV_TO_RGB, hsv_to_rgb)                                                                      \
  ROW(RGB_TO_HSL, rgb_to_hsl)                                                                      \
  ROW(HSL_TO_RGB, hsl_to_rgb)

#define HUE_NUMBER(WORD, name) HUE_##WORD,
#define HUE_WORD(WORD, name) #WORD,
enum { HUE_TABLE(HUE_NUMBER) };

typedef struct node_hue {
  int what, out[3];
  operand color[3];
} node_hue;

static inline bool node_hue_read(reader *r, node_hue *n, graph *g) {
  static const char *const words[] = {HUE_TABLE(HUE_WORD) NULL};
  return reader_word(r, "what", words, &n->what) && graph_operands(r, g, "color", 3, n->color) &&
         graph_outputs(r, g, "out", 3, n->out);
}

#define HUE_CASE(WORD, name)                                                                       \
  case HUE_##WORD:                                                                                 \
    _Pragma("omp simd") for (size_t i = g.begin; i < g.end; i++) {                                 \
      vec3 c = hue_##name((vec3){red[i], green[i], blue[i]});                                      \
      x[i] = c.x;                                                                                  \
      y[i] = c.y;                                                                                  \
      z[i] = c.z;                                                                                  \
    }                                                                                              \
    break;

LEAF void node_hue_run(const node_hue *n, lane_run g, const corners *corner, const surfaces *point,
                       inputs *at) {
  const float *red = lane_of(at, n->color[0], 0, g), *green = lane_of(at, n->color[1], 1, g);
  const float *blue = lane_of(at, n->color[2], 2, g);
  float *x = at->at[n->out[0]], *y = at->at[n->out[1]], *z = at->at[n->out[2]];
  (void)corner, (void)point;
  switch (n->what) { HUE_TABLE(HUE_CASE) }
}

#endif
