/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/aims.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/scene.h"

/* Below these, light that is gathered is no brighter than what is around. */
#define LEAST_EXPONENT 8.0
#define LEAST_REFLECTED 0.25

static double mean_of(const operand o[3], const double own[3]) {
  double sum = 0;
  for (int k = 0; k < 3; k++)
    sum += o[k].at >= 0 ? 1.0 : own ? own[k] : (double)o[k].number;
  return sum / 3;
}

/* What nodes say is taken for white. */
static bool gathers(const scene *s, const closure *c) {
  double weight = mean_of(c->weight, NULL);
  if (c->type == CLOSURE_METAL && !s->no_reflected) {
    const closure_metal *m = &c->of.metal;
    double share = m->params.fresnel == SHADE_FRESNEL_CONDUCTOR ? 1 : mean_of(m->f0, m->params.f0);
    return !(c->traits & CLOSURE_MATT) && closure_metal_exponent(m) >= LEAST_EXPONENT &&
           weight * share >= LEAST_REFLECTED;
  }
  return c->type == CLOSURE_GLASS && !(s->no_reflected && s->no_refracted) &&
         closure_glass_exponent(&c->of.glass) >= LEAST_EXPONENT && weight >= LEAST_REFLECTED;
}

/* About those triangles of a mesh that gather light; radius 0 where there are none. */
static aim ball_of(const mesh *m, const bool *gathering) {
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  aim ball = {.radius = 0};
  double radius2 = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t t = 0; t < m->triangles; t++) {
      if (!gathering[m->material[t]])
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

bool aims_build(scene *s) {
  bool *gathering = calloc(s->materials + 1, sizeof *gathering), any = false, matt = false;
  aim *ball = calloc(s->meshes + 1, sizeof *ball);
  s->aims.count = 0;
  for (size_t m = 0; gathering && m < s->materials; m++) {
    for (size_t k = 0; k < s->material[m].closures; k++)
      gathering[m] = gathering[m] || gathers(s, &s->material[m].closure[k]);
    any = any || gathering[m];
    matt = matt || s->material[m].traits & CLOSURE_MATT;
  }
  any = any && matt && s->lights + s->emitters.count > 0 && s->limits.kind[BOUNCE_DIFFUSE] > 0;
  for (size_t k = 0; any && ball && k < s->meshes; k++)
    ball[k] = ball_of(&s->mesh[k], gathering);
  for (const instance *in = s->instance; any && ball && in < s->instance + s->instances; in++) {
    aim here = placed_ball(&ball[in->mesh], in->matrix);
    add(&s->aims, &here);
  }
  bool good = gathering && ball;
  free(gathering);
  free(ball);
  return good;
}
