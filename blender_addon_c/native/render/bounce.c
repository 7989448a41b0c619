/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/bounce.h"

#include <stdlib.h>
#include <string.h>

bool worker_init(worker *w) {
  w->batch = aligned_alloc(64, sizeof *w->batch);
  if (!w->batch)
    return false;
  memset(w->batch->light.ray.tnear, 0, sizeof(lane_f)); /* no stage writes it */
  return queue_init(&w->batch->queue, w->scene);
}

void worker_free(worker *w) {
  if (w->batch)
    queue_free(&w->batch->queue);
  free(w->batch);
}

/* Camera rays and what they meet. */
static void trace(worker *w, const camera_view *view, size_t count) {
  const scene *s = w->scene;
  batch *b = w->batch;
  s->stages->camera(count, view, &b->path, &b->sample_ray);
  clock_tick(&w->clocks, CLOCK_CAMERA);
  accel_intersect(s->accel, count, &b->sample_ray, &b->sample_hit);
  b->queue.hits = s->stages->locate(count, (uint32_t)(2 * s->quad_count), &b->sample_hit, &b->path);
}

/* Samples to hits: sorted by material, unless nothing need move. */
static void sort_hits(worker *w, size_t count) {
  batch *b = w->batch;
  const queue *q = &b->queue;
  const rays *ray = b->ray = &b->sample_ray;
  const hits *hit = b->hit = &b->sample_hit;
  if (queue_sort(&b->queue, w->scene, count, hit->record))
    return;
  rays *to_ray = b->ray = &b->moved_ray;
  hits *to_hit = b->hit = &b->moved_hit;
  const float *from[] = {ray->o.x,  ray->o.y, ray->o.z, ray->d.x, ray->d.y, ray->d.z,
                         ray->tfar, hit->g.x, hit->g.y, hit->g.z, hit->u,   hit->v};
  float *to[] = {to_ray->o.x,  to_ray->o.y, to_ray->o.z, to_ray->d.x, to_ray->d.y, to_ray->d.z,
                 to_ray->tfar, to_hit->g.x, to_hit->g.y, to_hit->g.z, to_hit->u,   to_hit->v};
  for (size_t k = 0; k < sizeof from / sizeof *from; k++)
    w->scene->stages->gather(q->hits, q->lane, from[k], to[k]);
  for (size_t i = 0; i < q->hits; i++)
    to_hit->record[i] = hit->record[q->lane[i]];
}

static void find_surface(worker *w) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  s->corner(b->queue.hits, w->scene->triangle, b->hit, &b->corner);
  s->surface(b->queue.hits, b->ray, b->hit, &b->corner, &b->surface);
}

/* What each material's nodes say. */
static void run_nodes(worker *w) {
  batch *b = w->batch;
  const segment *end = b->queue.segment + b->queue.segments;
  for (const segment *g = b->queue.segment; g < end; g++)
    if (!(g->run.outputs & OUTPUT_NORMAL))
      w->scene->stages->flat(g, &b->input);
  clock_tick(&w->clocks, CLOCK_SURFACE);
  for (const segment *g = b->queue.segment; g < end; g++)
    for (const node *n = g->material->node; n < g->material->node + g->material->nodes; n++) {
      w->scene->stages->node[n->type](g, n, &b->corner, &b->surface, &b->input);
      clock_tick(&w->clocks, CLOCK_NODE + n->type);
    }
}

static void run_closures(worker *w) {
  batch *b = w->batch;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    closure_type type = g->material->closure.type;
    w->status |=
        w->scene->stages->closure[type](g, &b->surface, &b->input, &b->light, &b->reflection);
    clock_tick(&w->clocks, CLOCK_CLOSURE + type);
  }
}

/* One light on all hits: b->sum grows by what they reflect. */
static void illuminate(worker *w, size_t number, size_t phase) {
  const light *l = &w->scene->light[number];
  const sampling *p = w->sampling;
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  size_t hits = b->queue.hits;
  bool spread = l->common.soft && p->scramble; /* a dump takes lights at their middles */
  if (spread) {
    points points = {.x = p->point[2] + phase,
                     .y = p->point[3] + phase,
                     .salt = ((uint32_t)number + 1) * 0x9e3779b9u,
                     .scramble = p->scramble};
    s->pair(hits, &points, b->queue.lane, &b->path, &b->light);
  }
  s->light[l->type](hits, l, spread, &b->surface, &b->light);
  s->lit(hits, &b->surface, &b->light);
  clock_tick(&w->clocks, CLOCK_LIGHT + l->type);
  if (l->common.shadow)
    accel_occluded(w->scene->accel, hits, &b->light.ray);
  size_t lit = s->shadow(hits, &b->light);
  clock_tick(&w->clocks, CLOCK_SHADOW);
  if (!lit && !w->observer)
    return;
  run_closures(w);
  s->reflect(hits, l->common.color, &b->light, &b->reflection, &b->sum);
  clock_tick(&w->clocks, CLOCK_REFLECT);
}

static void expose(worker *w, const camera_view *view, size_t count, float *pixels) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  const queue *q = &b->queue;
  const lane_c *color = &b->sum;
  if (q->lane != q->identity) {
    memset(b->sample_color.r, 0, count * sizeof(float));
    memset(b->sample_color.g, 0, count * sizeof(float));
    memset(b->sample_color.b, 0, count * sizeof(float));
    s->scatter(q->hits, q->lane, color, &b->sample_color);
    color = &b->sample_color;
  }
  s->film(count, view, color, &b->path, pixels);
}

void bounce_batch(worker *w, camera_view *view, size_t count, float *pixels) {
  const scene *s = w->scene;
  const sampling *p = w->sampling;
  batch *b = w->batch;
  const queue *q = &b->queue;
  size_t phase = view->first % p->period;
  view->point[0] = p->point[0] + phase;
  view->point[1] = p->point[1] + phase;
  clock_start(&w->clocks);
  trace(w, view, count);
  if (q->hits)
    sort_hits(w, count);
  clock_tick(&w->clocks, CLOCK_HIT);
  if (!q->hits)
    return;
  find_surface(w);
  run_nodes(w);
  memset(b->sum.r, 0, q->hits * sizeof(float));
  memset(b->sum.g, 0, q->hits * sizeof(float));
  memset(b->sum.b, 0, q->hits * sizeof(float));
  if (w->observer)
    w->observer->hits(w->observer->context, b, view);
  for (size_t k = 0; k < s->lights; k++) {
    illuminate(w, k, phase);
    if (w->observer)
      w->observer->light(w->observer->context, b, view, k, &s->light[k]);
  }
  clock_start(&w->clocks);
  expose(w, view, count, pixels);
  clock_tick(&w->clocks, CLOCK_FILM);
}
