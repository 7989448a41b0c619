/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/relief.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "closure/closure.h"
#include "node/hash.h"
#include "node/node.h"
#include "render/hits.h"

/* Of a material: of POINTS the root of a variance is within 2 %. Where bumps may be uneven FINE say
 * where. */
enum { POINTS = 4 * BATCH, FINE = 256 * BATCH };

static bool is_mutual(const closure *c) {
  return c->type == CLOSURE_METAL && c->of.metal.params.horizon == SHADE_HORIZON_MUTUAL;
}

static bool wants_slopes(const closure *c) {
  return is_mutual(c) && !c->of.metal.told && c->of.metal.normal[0] != REGISTER_NORMAL;
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

/* A number of a triangle's own, by its vertices: Blender 5 may give triangles in another order each
 * time, and what is found of the same mesh has to be the same. */
static uint32_t number_of(const mesh *m, size_t t, uint32_t instance) {
  uint32_t sum = 0;
  for (size_t k = 0; k < 3; k++)
    sum += jenkins(1, (uint32_t)m->corner_position[3 * t + k], 0, 0, 0);
  return jenkins(2, sum, instance, 0, 0);
}

/* Adds up the areas of a material's triangles; where there is room, puts down up to `count` points
 * that lie as densely on all of it. Returns the sum. */
static double walk(const scene *s, int32_t material, double area, size_t count, point *points) {
  const double wanted = (double)count - 4 * sqrt((double)count); /* chance adds some */
  double sum = 0;
  size_t made = 0;
  for (const instance *in = s->instance; in < s->instance + s->instances; in++) {
    const mesh *m = &s->mesh[in->mesh];
    for (size_t t = 0; t < m->triangles; t++) {
      if (m->material[t] != material)
        continue;
      const double own = length(point_of(in, m, t, 0, 0).n);
      sum += own < 1e30 ? own : 0;
      if (!points || !(own < 1e30))
        continue;
      const uint32_t number = number_of(m, t, (uint32_t)(in - s->instance));
      const double first[2] = {(double)closed_unit(jenkins(1, number, 0, 0, 0)),
                               (double)closed_unit(jenkins(2, number, 0, 0, 0))};
      const size_t end = made + (size_t)(own / area * wanted + (double)closed_unit(number));
      for (size_t k = 1; made < count && made < end; k++, made++) {
        /* multiples of the plastic number's powers lie evenly in a square, which is folded */
        double u = first[0] + (double)k * 0.7548776662466927,
               v = first[1] + (double)k * 0.5698402909980532;
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

/* What a closure's normals say at points that were looked at: places of the UV map, and slopes. */
typedef struct bumps {
  size_t count;
  float *u, *v, *x, *y; /* in one piece */
} bumps;

static bool bumps_room(bumps *b, size_t count) {
  b->u = malloc(4 * count * sizeof *b->u);
  if (b->u) {
    b->v = b->u + count;
    b->x = b->v + count;
    b->y = b->x + count;
  }
  return b->u != NULL;
}

/* Those of the normals that a closure takes, in the run of its material. */
static void add_bumps(const closure_metal *c, lane_run run, const batch *b, bumps *to) {
  const float shallowest = 0.02f;
  for (size_t i = run.begin; i < run.end; i++) {
    const vec3 n = normal_at(&b->input, c->normal, i);
    if (!(n.z > shallowest))
      continue;
    to->u[to->count] = b->surface.u[i];
    to->v[to->count] = b->surface.v[i];
    to->x[to->count] = -n.x / n.z;
    to->y[to->count++] = -n.y / n.z;
  }
}

/* Gives the node of uneven bumps, or of a shape, its relief, or says whether a first one, whose
 * windows are wide and so vary less, is worth a *finer. */
static void set_relief(node_relief *n, shade_relief *r, bool first, bool *finer) {
  const double hint = 0.2;
  const bool shape = n->outs > 3;
  double slopes[5];
  const double varies = shade_relief_whole(r, slopes);
  *finer = *finer || (first && (shape ? slopes[2] + slopes[4] > 0 : varies > hint));
  if (!first && (shape ? slopes[2] + slopes[4] > 0 : varies > SHADE_RELIEF_EVEN))
    n->relief = r;
}

static void set_slopes(closure_metal *c, const shade_relief *r) {
  double slopes[5];
  shade_relief_whole(r, slopes);
  shade_params_set_slopes(&c->params, slopes);
  shade_bsdf_setup(&c->bsdf, &c->params);
}

/* The node that a closure reads. */
static node_relief *node_of(material *m, const closure_metal *c) {
  for (size_t k = m->nodes; k-- > 0;)
    if (m->node[k].type == NODE_RELIEF && m->node[k].of.relief.out[0] == c->moment[0].at)
      return &m->node[k].of.relief;
  return NULL;
}

/* What the points say, by closure. */
static void see(worker *w, const material *m, const point *points, size_t points_count,
                bumps *found) {
  batch *b = w->batch;
  for (size_t first = 0; first < points_count; first += BATCH) {
    if (atomic_load_explicit(w->cancel, memory_order_relaxed))
      return;
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
          add_bumps(&m->closure[k].of.metal, g->run, b, &found[k]);
  }
}

/* Looks at so many points of a material; *finer: whether some of its bumps are worth FINE. */
static bool look(worker *w, material *m, double area, size_t count, bool *finer) {
  bumps found[CLOSURES_MOST] = {{0}};
  point *points = calloc(count, sizeof *points);
  bool good = points != NULL;
  for (size_t k = 0; k < m->closures; k++)
    if (wants_slopes(&m->closure[k]))
      good = bumps_room(&found[k], count) && good;
  *finer = false;
  if (good) {
    walk(w->scene, (int32_t)(m - w->scene->material), area, count, points);
    see(w, m, points, count, found);
  }
  for (size_t k = 0; good && k < m->closures; k++)
    if (found[k].count > 0) {
      closure_metal *c = &m->closure[k].of.metal;
      node_relief *n = node_of(m, c);
      const bumps *f = &found[k];
      shade_relief *r =
          shade_relief_create(f->count, f->u, f->v, f->x, f->y, NULL, n && n->outs > 3);
      good = r != NULL;
      if (good)
        set_slopes(c, r);
      /* of a node that several closures of a file read the first one's */
      if (good && n && !n->relief)
        set_relief(n, r, count < FINE, finer);
      if (!n || n->relief != r)
        shade_relief_free(r);
    }
  for (size_t k = 0; k < m->closures; k++)
    free(found[k].u);
  free(points);
  return good;
}

static bool wants(const material *m) {
  for (const closure *c = m->closure; c < m->closure + m->closures; c++)
    if (wants_slopes(c))
      return true;
  return false;
}

static bool look_at(worker *w, material *m) {
  bool finer;
  const double area = walk(w->scene, (int32_t)(m - w->scene->material), 0, 0, NULL);
  if (!(area > 0))
    return true;
  if (!w->batch && !batch_init(w))
    return false;
  memset(w->batch->path_states, 0, sizeof w->batch->path_states);
  return look(w, m, area, POINTS, &finer) && (!finer || look(w, m, area, FINE, &finer));
}

/* Of even bumps there is one moment, which the closure knows. */
static void leave_even(material *m) {
  for (closure *c = m->closure; c < m->closure + m->closures; c++) {
    const node_relief *n = c->type == CLOSURE_METAL ? node_of(m, &c->of.metal) : NULL;
    if (n && !n->relief)
      closure_metal_even(&c->of.metal);
  }
}

bool relief_find(scene *s, const atomic_bool *cancel) {
  static const sampling none;
  worker w = {.scene = s, .sampling = &none, .cancel = cancel};
  bool good = true;
  for (material *m = s->material; good && m < s->material + s->materials; m++) {
    if (wants(m) && !atomic_load_explicit(cancel, memory_order_relaxed))
      good = look_at(&w, m);
    leave_even(m);
  }
  if (w.batch)
    batch_free(&w);
  return good;
}

void relief_free(material *m) {
  for (node *n = m->node; m->node && n < m->node + m->nodes; n++)
    if (n->type == NODE_RELIEF)
      shade_relief_free(n->of.relief.relief);
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
