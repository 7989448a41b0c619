/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/relief.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "closure/closure.h"
#include "render/hits.h"

enum { POINTS = 4 * BATCH }; /* a material: the root of a variance is then within 2 % */

static bool is_mutual(const closure *c) {
  return c->type == CLOSURE_METAL && c->of.metal.params.horizon == SHADE_HORIZON_MUTUAL;
}

static bool wants_slopes(const closure *c) {
  return is_mutual(c) && !c->of.metal.told;
}

typedef struct point {
  double at[3], n[3]; /* of a triangle in the world; its normal is as long as twice its area */
} point;

/* The point (u, v) of a triangle. */
static point point_of(const instance *in, const mesh *m, size_t t, double u, double v) {
  double corner[3][3], a[3], b[3];
  point p;
  for (size_t k = 0; k < 3; k++)
    instance_place(in->matrix, m->position + 3 * (size_t)m->corner_position[3 * t + k], corner[k]);
  for (int i = 0; i < 3; i++) {
    a[i] = corner[1][i] - corner[0][i];
    b[i] = corner[2][i] - corner[0][i];
    p.at[i] = corner[0][i] + u * a[i] + v * b[i];
  }
  for (int i = 0; i < 3; i++)
    p.n[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
  return p;
}

static double length(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Adds up the areas of a material's triangles; where there is room, puts down POINTS points that
 * lie as densely on all of it. Returns the sum. */
static double walk(const scene *s, int32_t material, double area, point *points) {
  double sum = 0;
  size_t made = 0;
  for (const instance *in = s->instance; in < s->instance + s->instances; in++) {
    const mesh *m = &s->mesh[in->mesh];
    for (size_t t = 0; t < m->triangles; t++) {
      if (m->material[t] != material)
        continue;
      const double own = length(point_of(in, m, t, 0, 0).n);
      sum += own < 1e30 ? own : 0;
      for (; points && made < POINTS && ((double)made + 0.5) * area < sum * POINTS; made++) {
        /* multiples of the plastic number's powers lie evenly in a square, which is folded */
        double u = (double)(made + 1) * 0.7548776662466927,
               v = (double)(made + 1) * 0.5698402909980532;
        u -= floor(u);
        v -= floor(v);
        points[made] = u + v > 1 ? point_of(in, m, t, 1 - u, 1 - v) : point_of(in, m, t, u, v);
      }
    }
  }
  return sum;
}

/* A short ray to each point, straight down on it: what it meets is that point, and all that is
 * known of it. */
static size_t aim_down(const point *points, size_t count, rays *ray) {
  size_t made = 0;
  for (size_t k = 0; k < count; k++) {
    const point *p = &points[k];
    const double size = length(p->n), reach = fmax(sqrt(size), 1e-4 * length(p->at)) * 1e-2;
    if (!(size > 1e-30))
      continue;
    float *o[3] = {ray->o.x, ray->o.y, ray->o.z}, *d[3] = {ray->d.x, ray->d.y, ray->d.z};
    for (int i = 0; i < 3; i++) {
      o[i][made] = (float)(p->at[i] + reach * p->n[i] / size);
      d[i][made] = (float)(-p->n[i] / size);
    }
    ray->tnear[made] = 0.0f;
    ray->tfar[made] = (float)(2 * reach);
    ray->time[made++] = 0.5f;
  }
  return made;
}

typedef struct moments {
  double count, x, y, xx, xy, yy;
} moments;

/* The slopes of the normals that a closure takes, in the run of its material. */
static void add_slopes(const closure_metal *c, lane_run run, const inputs *in, moments *m) {
  enum { STEEPEST = 50 };
  for (size_t i = run.begin; i < run.end; i++) {
    const vec3 n = normal_at(in, c->normal, i);
    if (!(n.z > 1.0f / STEEPEST))
      continue;
    const double x = -(double)(n.x / n.z), y = -(double)(n.y / n.z);
    m->count++;
    m->x += x;
    m->y += y;
    m->xx += x * x;
    m->xy += x * y;
    m->yy += y * y;
  }
}

static void set_slopes(closure_metal *c, const moments *m) {
  if (!(m->count > 0))
    return;
  const double x = m->x / m->count, y = m->y / m->count;
  shade_params_set_slopes(&c->params, (const double[5]){x, y, fmax(m->xx / m->count - x * x, 0),
                                                        m->xy / m->count - x * y,
                                                        fmax(m->yy / m->count - y * y, 0)});
  shade_bsdf_setup(&c->bsdf, &c->params);
}

static bool look(worker *w, material *m, const point *points) {
  batch *b = w->batch;
  moments *found = calloc(m->closures, sizeof *found);
  if (!found)
    return false;
  for (size_t first = 0; first < POINTS; first += BATCH) {
    const size_t count = aim_down(points + first, BATCH, &b->sample_ray);
    hits_trace(w, RAY_CAMERA, count);
    if (!b->queue.hits)
      continue;
    hits_sort(w, count, NULL);
    hits_surface(w);
    hits_nodes(w);
    for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++)
      for (size_t k = 0; g->material == m && k < m->closures; k++)
        if (wants_slopes(&m->closure[k]))
          add_slopes(&m->closure[k].of.metal, g->run, &b->input, &found[k]);
  }
  for (size_t k = 0; k < m->closures; k++)
    if (wants_slopes(&m->closure[k]))
      set_slopes(&m->closure[k].of.metal, &found[k]);
  free(found);
  return true;
}

static bool wants(const material *m) {
  for (const closure *c = m->closure; c < m->closure + m->closures; c++)
    if (wants_slopes(c))
      return true;
  return false;
}

bool relief_find(scene *s, const atomic_bool *cancel) {
  static const sampling none;
  worker w = {.scene = s, .sampling = &none, .cancel = cancel};
  point *points = NULL;
  bool good = true;
  for (material *m = s->material; good && m < s->material + s->materials; m++) {
    if (!wants(m) || atomic_load_explicit(cancel, memory_order_relaxed))
      continue;
    const int32_t number = (int32_t)(m - s->material);
    const double area = walk(s, number, 0, NULL);
    if (!(area > 0))
      continue;
    points = points ? points : calloc(POINTS, sizeof *points);
    good = points && (w.batch || batch_init(&w));
    if (!good)
      break;
    memset(w.batch->path_states, 0, sizeof w.batch->path_states);
    walk(s, number, area, points);
    good = look(&w, m, points);
  }
  if (w.batch)
    batch_free(&w);
  free(points);
  return good;
}

bool relief_told(const material *m, double slopes[5]) {
  const closure *c = m->closure, *const end = m->closure + m->closures;
  while (c < end && !is_mutual(c))
    c++;
  if (c == end)
    return false;
  shade_params_get_slopes(&c->of.metal.params, slopes);
  return true;
}
