/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/environment.h"

#include <stdlib.h>
#include <string.h>

#include "closure/closure.h"
#include "node/node.h"
#include "system/memory.h"

/* What nodes read and write for directions instead of hits, whose own are still in use. */
struct environment {
  surfaces surface;
  inputs input;
  corners corner;
};

static bool has_shader(const scene *s) {
  bool any = s->sky.shader || s->behind.shader;
  for (size_t i = 0; i < s->looks; i++)
    any = any || s->look[i].sky.shader;
  return any;
}

bool environment_init(worker *w) {
  if (!has_shader(w->scene))
    return true;
  w->environment = memory_aligned(64, sizeof *w->environment);
  if (!w->environment)
    return false;
  memset(w->environment, 0, sizeof *w->environment);
  return true;
}

void environment_free(worker *w) {
  free(w->environment);
  w->environment = NULL;
}

/* NaN and light below 0 are none, as in the image. */
static void scale(float strength, float *restrict lane, size_t count) {
  for (size_t i = 0; i < count; i++) {
    float x = strength * lane[i];
    lane[i] = x > 0.0f ? (x < 1e10f ? x : 1e10f) : 0.0f;
  }
}

/* As of a wall about the eye that faces it. */
static void shade(struct environment *e, const scene *s, const sky *sky, size_t count,
                  const lane_v *toward, lane_c *out) {
  const material *m = &s->material[sky->shader - 1];
  const segment g = {.material = m, .run = {0, count}};
  for (size_t i = 0; i < count; i++) {
    vec3 d = load(toward, i);
    store(&e->surface.p, i, d);
    store(&e->surface.n, i, (vec3){-d.x, -d.y, -d.z});
    store(&e->surface.wo, i, (vec3){0.0f, 0.0f, 1.0f});
  }
  if (m->bare)
    s->stages->flat(&g, &e->input);
  for (const node *n = m->node; n < m->node + m->nodes; n++)
    s->stages->node[n->type](&g, n, &e->corner, &e->surface, &e->input);
  float *lane[] = {out->r, out->g, out->b};
  for (int k = 0; k < 3; k++)
    memset(lane[k], 0, count * sizeof(float));
  for (const closure *c = m->closure; c < m->closure + m->closures; c++)
    if (c->traits & CLOSURE_EMITS)
      s->stages->emit(c, g.run, &e->input, out);
  for (int k = 0; k < 3; k++)
    scale(sky->strength[k], lane[k], count);
}

void environment_eval(worker *w, const sky *sky, size_t count, const lane_v *toward, lane_c *out) {
  if (sky->shader && count)
    shade(w->environment, w->scene, sky, count, toward, out);
  else
    w->scene->stages->sky(count, sky, toward, out);
}
