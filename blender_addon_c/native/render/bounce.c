/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/bounce.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What points are taken for. */
enum { PURPOSE_DRAW, PURPOSE_LOT, PURPOSE_LENS, PURPOSE_LIGHT /* + its number */ };

bool worker_init(worker *w) {
  w->batch = aligned_alloc(64, sizeof *w->batch);
  if (!w->batch)
    return false;
  w->batch->walk = &w->batch->walks[0];
  w->batch->next = &w->batch->walks[1];
  memset(w->batch->light.ray.tnear, 0, sizeof(lane_f)); /* no stage writes it */
  return queue_init(&w->batch->queue, w->scene);
}

void worker_free(worker *w) {
  if (w->batch)
    queue_free(&w->batch->queue);
  free(w->batch);
}

/* What rays meet; the first are those of the camera. */
static void trace(worker *w, bool first, size_t count) {
  const scene *s = w->scene;
  batch *b = w->batch;
  accel_intersect(s->accel, count, first, &b->sample_ray, &b->sample_hit);
  b->queue.hits =
      s->stages->locate(count, (uint32_t)(2 * s->quad_count), s->placed, &b->sample_hit);
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
  for (size_t i = 0; w->scene->placed && i < q->hits; i++)
    to_hit->instance[i] = hit->instance[q->lane[i]];
}

static void find_surface(worker *w) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  s->corner(b->queue.hits, w->scene->triangle, b->hit, &b->corner);
  if (w->scene->placed)
    s->place(b->queue.hits, w->scene->placed, b->hit, &b->corner);
  s->surface(b->queue.hits, b->ray, b->hit, &b->corner, &b->surface);
}

/* What each material's nodes say. */
static void run_nodes(worker *w) {
  batch *b = w->batch;
  const segment *end = b->queue.segment + b->queue.segments;
  for (const segment *g = b->queue.segment; g < end; g++)
    if (g->material->closure.of.metal.normal[0] == REGISTER_NORMAL)
      w->scene->stages->flat(g, &b->input);
  clock_tick(&w->clocks, CLOCK_SURFACE);
  for (const segment *g = b->queue.segment; g < end; g++)
    for (const node *n = g->material->node; n < g->material->node + g->material->nodes; n++) {
      w->scene->stages->node[n->type](g, n, &b->corner, &b->surface, &b->input);
      clock_tick(&w->clocks, CLOCK_NODE + n->type);
    }
}

static void run_closures(worker *w, bool density) {
  batch *b = w->batch;
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++) {
    closure_type type = g->material->closure.type;
    w->status |= w->scene->stages->closure[type](g, &b->surface, &b->input, &b->light, density,
                                                 &b->reflection);
    clock_tick(&w->clocks, CLOCK_CLOSURE + type);
  }
}

/* Which points a bounce's light or draw takes; no two of one path may take the same. */
static shuffle points_of(const worker *w, size_t phase, int bounce, size_t purpose) {
  const sampling *p = w->sampling;
  uint32_t salt = (uint32_t)(bounce + 1) * 0x85ebca6bu + ((uint32_t)purpose + 1) * 0x9e3779b9u;
  return (shuffle){
      .index = p->point[0] + phase, .reverse = p->reverse, .mask = p->mask, .salt = salt};
}

/* One light on all hits: b->sum grows by what they reflect. */
static void illuminate(worker *w, size_t number, int bounce, size_t phase) {
  const light *l = &w->scene->light[number];
  const sampling *p = w->sampling;
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  size_t hits = b->queue.hits;
  bool spread = l->common.soft && p->scramble; /* a dump takes lights at their middles */
  if (spread && bounce == 0) {
    points points = {.x = p->point[2] + phase,
                     .y = p->point[3] + phase,
                     .salt = ((uint32_t)number + 1) * 0x9e3779b9u,
                     .scramble = p->scramble};
    s->pair(hits, &points, b->queue.lane, &b->path, &b->light);
  } else if (spread) {
    shuffle points = points_of(w, phase, bounce, PURPOSE_LIGHT + number);
    s->shuffled(hits, &points, b->queue.lane, b->walk, &b->path, b->light.x, b->light.y);
  }
  s->light[l->type](hits, l, spread, &b->surface, &b->light);
  s->lit(hits, &b->surface, &b->light);
  clock_tick(&w->clocks, CLOCK_LIGHT + l->type);
  if (l->common.shadow)
    accel_occluded(w->scene->accel, hits, bounce == 0, &b->light.ray);
  size_t lit = s->shadow(hits, &b->light);
  clock_tick(&w->clocks, CLOCK_SHADOW);
  if (!lit && !w->observer)
    return;
  run_closures(w, false);
  s->reflect(hits, l->common.color, &b->light, &b->reflection, &b->sum);
  clock_tick(&w->clocks, CLOCK_REFLECT);
}

static void zero(lane_c *color, size_t count) {
  memset(color->r, 0, count * sizeof(float));
  memset(color->g, 0, count * sizeof(float));
  memset(color->b, 0, count * sizeof(float));
}

/* Surfaces, nodes and lights of the hits of one bounce. */
static void shade(worker *w, const camera_view *view, int bounce, size_t phase) {
  const scene *s = w->scene;
  batch *b = w->batch;
  find_surface(w);
  run_nodes(w);
  zero(&b->sum, b->queue.hits);
  if (w->observer)
    w->observer->hits(w->observer->context, b, view);
  for (size_t k = 0; k < s->lights; k++) {
    illuminate(w, k, bounce, phase);
    if (w->observer)
      w->observer->light(w->observer->context, b, view, k, &s->light[k]);
  }
  clock_start(&w->clocks); /* an observer's time is no stage's */
}

/* Draws where the paths go on; returns how many do. */
static size_t go_on(worker *w, int bounce, size_t phase) {
  enum { FIRST_LOTTERY = 3 }; /* before, paths are too few to lose */
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  const queue *q = &b->queue;
  shuffle points = points_of(w, phase, bounce, PURPOSE_DRAW);
  s->shuffled(q->hits, &points, q->lane, b->walk, &b->path, b->draw.x, b->draw.y);
  points = points_of(w, phase, bounce, PURPOSE_LOT); /* its y is of no use: pdf is written next */
  s->shuffled(q->hits, &points, q->lane, b->walk, &b->path, b->draw.lot, b->draw.pdf);
  for (const segment *g = q->segment; g < q->segment + q->segments; g++)
    w->status |= s->draw[g->material->closure.type](g, &b->surface, &b->input, &b->draw);
  size_t rays = s->walk(q->hits, bounce >= FIRST_LOTTERY, q->lane, &b->surface, b->walk, &b->draw,
                        &b->moved_ray, b->chosen, b->next, &b->sample_ray);
  clock_tick(&w->clocks, CLOCK_DRAW);
  return rays;
}

/* The bounces after the first: sample_color grows by what they bring. */
static void follow(worker *w, const camera_view *view, size_t phase) {
  const scene *s = w->scene;
  batch *b = w->batch;
  const float most = s->clamp_indirect > 0.0f ? s->clamp_indirect : INFINITY;
  for (int bounce = 0; bounce < s->max_bounces && b->queue.hits; bounce++) {
    size_t rays = go_on(w, bounce, phase);
    if (!rays)
      return;
    walks *now = b->next;
    b->next = b->walk;
    b->walk = now;
    trace(w, false, rays);
    s->stages->escape(rays, most, b->sample_hit.record, s->background, b->walk, &b->sample_color);
    if (b->queue.hits)
      sort_hits(w, rays);
    clock_tick(&w->clocks, CLOCK_TRACE);
    if (!b->queue.hits)
      return;
    shade(w, view, bounce + 1, phase);
    s->stages->gain(b->queue.hits, most, b->queue.lane, b->walk, &b->sum, &b->sample_color);
  }
}

/* Every sample a path of weight 1. */
static void begin_walks(batch *b, size_t count) {
  memcpy(b->walk->sample, b->queue.identity, count * sizeof(uint32_t));
  for (size_t i = 0; i < count; i++)
    b->walk->weight.r[i] = b->walk->weight.g[i] = b->walk->weight.b[i] = 1.0f;
}

void bounce_batch(worker *w, camera_view *view, size_t count, float *pixels) {
  const sampling *p = w->sampling;
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  const queue *q = &b->queue;
  size_t phase = view->first % p->period;
  view->point[0] = p->point[0] + phase;
  view->point[1] = p->point[1] + phase;
  clock_start(&w->clocks);
  s->camera(count, view, &b->path, &b->sample_ray);
  if (view->camera->lens[0] + view->camera->lens[1] > 0.0f && !w->observer) {
    shuffle points = points_of(w, phase, 0, PURPOSE_LENS);
    s->lens(count, view->camera, &points, &b->path, &b->sample_ray);
  }
  clock_tick(&w->clocks, CLOCK_CAMERA);
  trace(w, true, count);
  s->cover(count, &b->sample_hit, &b->path);
  if (q->hits)
    sort_hits(w, count);
  clock_tick(&w->clocks, CLOCK_HIT);
  if (!q->hits)
    return;
  shade(w, view, 0, phase);
  const lane_c *color = &b->sum;
  bool on = w->scene->max_bounces > 0 && !w->observer;
  if (on || q->lane != q->identity) {
    color = &b->sample_color;
    zero(&b->sample_color, count);
    s->scatter(q->hits, q->lane, &b->sum, &b->sample_color);
  }
  if (on) {
    begin_walks(b, count);
    follow(w, view, phase);
  }
  s->film(count, view, color, &b->path, pixels);
  clock_tick(&w->clocks, CLOCK_FILM);
}
