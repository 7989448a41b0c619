/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By which way the point is seen: `what`, a word of the table. Writes `out`, one number. WIDTH: of
 * what the ray stands for, in the scene's unit. */
#ifndef LIBSHADE_NODE_PATH_H
#define LIBSHADE_NODE_PATH_H

#include "node/common.h"

/* Is the ray one of these, and none of those? */
LEAF float path_is(uint32_t ray, uint32_t some, uint32_t none) {
  bool is = ((ray & some) != 0) & ((ray & none) == 0);
  return is ? 1.0f : 0.0f;
}

/* As Cycles has them: what is refracted counts as glossy too, and no ray comes from a surface and
 * is a shadow's. FILM: what is a hole there is one in the picture. */
#define PATH_TABLE(ROW)                                                                            \
  ROW(CAMERA, path_is(ray, RAY_CAMERA, 0))                                                         \
  ROW(FILM, path_is(ray, RAY_CAMERA | RAY_FILM, 0))                                                \
  ROW(SHADOW, path_is(ray, RAY_SHADOW, 0))                                                         \
  ROW(DIFFUSE, path_is(ray, RAY_DIFFUSE, 0))                                                       \
  ROW(GLOSSY, path_is(ray, RAY_GLOSSY | RAY_TRANSMISSION, RAY_DIFFUSE))                            \
  ROW(SINGULAR, path_is(ray, RAY_SINGULAR, 0))                                                     \
  ROW(REFLECTION, path_is(ray, RAY_DIFFUSE | RAY_GLOSSY, RAY_TRANSMISSION))                        \
  ROW(TRANSMISSION, path_is(ray, RAY_TRANSMISSION, 0))                                             \
  ROW(LENGTH, point->length[i])                                                                    \
  ROW(WIDTH, point->width[i])                                                                      \
  ROW(DEPTH, (float)(int32_t)(point->depth[BOUNCE_DIFFUSE][i] + point->depth[BOUNCE_GLOSSY][i] +   \
                              point->depth[BOUNCE_TRANSMISSION][i]) +                              \
                 path_is(ray, RAY_SHADOW, 0))                                                      \
  ROW(DIFFUSE_DEPTH, (float)(int32_t)point->depth[BOUNCE_DIFFUSE][i])                              \
  ROW(GLOSSY_DEPTH, (float)(int32_t)point->depth[BOUNCE_GLOSSY][i])                                \
  ROW(TRANSMISSION_DEPTH, (float)(int32_t)point->depth[BOUNCE_TRANSMISSION][i])                    \
  ROW(TRANSPARENT_DEPTH, (float)(int32_t)point->depth[BOUNCE_TRANSPARENT][i])

#define PATH_NUMBER(WORD, formula) PATH_##WORD,
#define PATH_WORD(WORD, formula) #WORD,
enum { PATH_TABLE(PATH_NUMBER) };

typedef struct node_path {
  int what, out;
} node_path;

static inline bool node_path_read(reader *r, node_path *n, graph *g) {
  static const char *const words[] = {PATH_TABLE(PATH_WORD) NULL};
  g->features->light_path = true;
  return reader_word(r, "what", words, &n->what) && graph_outputs(r, g, "out", 1, &n->out);
}

#define PATH_CASE(WORD, formula)                                                                   \
  case PATH_##WORD:                                                                                \
    _Pragma("omp simd") for (size_t i = g.begin; i < g.end; i++) {                                 \
      uint32_t ray = point->ray[i];                                                                \
      (void)ray;                                                                                   \
      out[i] = formula;                                                                            \
    }                                                                                              \
    break;

LEAF void node_path_run(const node_path *n, lane_run g, const corners *corner,
                        const surfaces *restrict point, inputs *restrict at) {
  float *out = at->at[n->out];
  (void)corner;
  switch (n->what) { PATH_TABLE(PATH_CASE) }
}

#endif
