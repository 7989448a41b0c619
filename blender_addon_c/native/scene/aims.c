/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/aims.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* About those triangles of a mesh that focus light; radius 0 where there are none. */
static aim ball_of(const mesh *m, const material *material) {
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  aim ball = {.radius = 0};
  double radius2 = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t t = 0; t < m->triangles; t++) {
      if (!material[m->material[t]].focuses)
        continue;
      for (size_t k = 0; k < 3; k++) {
        const float *p = m->position + 3 * (size_t)m->corner_position[3 * t + k];
        double d2 = 0;
        for (int axis = 0; axis < 3; axis++) {
          double off = (double)p[axis] - (double)ball.center[axis];
          low[axis] = p[axis] < low[axis] ? p[axis] : low[axis];
          high[axis] = p[axis] > high[axis] ? p[axis] : high[axis];
          d2 += off * off;
        }
        radius2 = pass && d2 > radius2 ? d2 : radius2;
      }
    }
    for (int axis = 0; axis < 3; axis++)
      ball.center[axis] = 0.5f * low[axis] + 0.5f * high[axis];
  }
  ball.radius = low[0] <= high[0] ? (float)sqrt(radius2) : 0.0f;
  return ball;
}

/* Into the world, where it is as large as the longest axis; an oblique matrix may leave some of
 * the mesh outside, which is then drawn as all else is. */
static aim placed_ball(const aim *ball, const double m[12]) {
  aim out;
  double most = 0;
  for (int k = 0; k < 3; k++) {
    out.center[k] =
        (float)(m[4 * k] * (double)ball->center[0] + m[4 * k + 1] * (double)ball->center[1] +
                m[4 * k + 2] * (double)ball->center[2] + m[4 * k + 3]);
    most = fmax(most, m[k] * m[k] + m[4 + k] * m[4 + k] + m[8 + k] * m[8 + k]);
  }
  out.radius = (float)((double)ball->radius * sqrt(most));
  return out;
}

/* Where it is one of the largest. */
static void add(aims *a, const aim *ball) {
  float far = fabsf(ball->center[0]) + fabsf(ball->center[1]) + fabsf(ball->center[2]);
  if (!(ball->radius > 1e-9f && ball->radius < 1e9f && far < 1e9f))
    return;
  size_t at = a->count < AIMS ? a->count : AIMS;
  a->count = a->count < AIMS ? a->count + 1 : AIMS;
  for (; at > 0 && a->ball[at - 1].radius < ball->radius; at--)
    if (at < AIMS)
      a->ball[at] = a->ball[at - 1];
  if (at < AIMS)
    a->ball[at] = *ball;
}

bool aims_build(const geometry *s, aims *a) {
  aim *ball = calloc(s->meshes + 1, sizeof *ball);
  for (size_t k = 0; ball && k < s->meshes; k++)
    ball[k] = ball_of(&s->mesh[k], s->material);
  for (const instance *in = s->instance; ball && in < s->instance + s->instances; in++) {
    aim here = placed_ball(&ball[in->mesh], in->matrix);
    add(a, &here);
  }
  bool good = ball != NULL;
  free(ball);
  return good;
}
