/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/hits.h"

#include <stdlib.h>
#include <string.h>

#include "node/node.h"
#include "render/motion.h"
#include "render/occlusion.h"
#include "system/memory.h"

bool batch_init(worker *w) {
  w->batch = memory_aligned(64, sizeof *w->batch);
  if (!w->batch)
    return false;
  w->batch->queue.tally = NULL;
  w->batch->state = &w->batch->path_states[0];
  w->batch->next = &w->batch->path_states[1];
  w->batch->input.blurs = false;
  memset(w->batch->light.ray.tnear, 0, sizeof(lane_f)); /* lights that are alone write none */
  memset(w->batch->weight.total, 0, sizeof(lane_f));
  memset(&w->batch->drawn, 0, sizeof w->batch->drawn);
  w->batch->drawn.tfar[BATCH] = -1.0f; /* of those that no light reaches */
  w->batch->input.cloth = NULL;
  w->batch->input.texture_blur = w->observer ? 0.0f : w->scene->texture_blur; /* dumps say points */
  w->batch->input.normal_blur = w->observer ? 0.0f : w->scene->normal_blur;
  w->batch->input.single = !w->observer;           /* a dump takes all terms of cloth; */
  memset(w->batch->input.term, 0, sizeof(lane_f)); /* shadow rays the point that they meet */
  w->batch->input.beside = false;
  memset(w->batch->surface.width, 0, sizeof(lane_f));
  memset(w->batch->surface.pixel, 0, sizeof(lane_f));
  if (!occlusion_init(w->batch, w->scene))
    return false;
  return motion_init(w->batch, w->scene) && queue_init(&w->batch->queue, w->scene);
}

void batch_free(worker *w) {
  if (w->batch) {
    queue_free(&w->batch->queue);
    motion_end(w->batch);
    occlusion_free(w->batch);
  }
  free(w->batch);
}

void hits_trace(worker *w, ray_kind kind, size_t count) {
  const scene *s = w->scene;
  batch *b = w->batch;
  accel_intersect(s->accel, count, kind, b->state->ray, &b->sample_ray, &b->sample_hit);
  b->queue.hits =
      s->stages->locate(count, (uint32_t)(2 * s->quad_count), s->placed, &b->sample_hit);
}

void hits_sort(worker *w, size_t count, const float *key) {
  batch *b = w->batch;
  const queue *q = &b->queue;
  const rays *ray = b->ray = &b->sample_ray;
  const hits *hit = b->hit = &b->sample_hit;
  if (queue_sort(&b->queue, w->scene, count, hit->record, key))
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
  if (w->scene->features.object_motion)
    w->scene->stages->gather(q->hits, q->lane, ray->time, to_ray->time);
  for (size_t i = 0; w->scene->placed && i < q->hits; i++)
    to_hit->instance[i] = hit->instance[q->lane[i]];
}

bool hits_lifted(const worker *w) {
  return w->scene->features.curved && !w->observer;
}

/* Position by u and v; not where footprints are finer than all that asks for it. */
static void find_derivatives(worker *w) {
  const scene *s = w->scene;
  batch *b = w->batch;
  b->surface.edges = false;
  s->stages->uv_width(b->queue.hits, s->stretch, b->placed, b->hit, &b->surface);
  if (s->features.fine_derivatives || texture_is_coarse(b->surface.uv_width, s->finest))
    s->stages->stretch(b->queue.hits, s->stretch, s->triangle, b->placed, b->hit, &b->surface);
}

void hits_surface(worker *w) {
  const stage_table *s = w->scene->stages;
  batch *b = w->batch;
  s->corner(b->queue.hits, w->scene->triangle, b->hit, &b->corner);
  if (w->scene->features.object_motion)
    motion_hits(w);
  if (w->scene->placed)
    s->place(b->queue.hits, b->placed, b->hit, &b->corner);
  s->surface(b->queue.hits, b->ray, b->hit, &b->corner, !w->observer, &b->surface);
  if (b->surface.leans)
    b->surface.leans = w->observer                               ? LEANS_NOT
                       : w->scene->features.interpolated_diffuse ? LEANS_AWAY
                                                                 : LEANS_FADING;
  if (hits_lifted(w))
    s->lift(b->queue.hits, w->scene->triangle, b->placed, b->hit, &b->surface);
  if (w->scene->features.object_info) {
    b->surface.placed = b->placed;
    b->surface.objects = b->object;
    s->identify(b->queue.hits, w->scene->triangle, b->placed, b->hit, &b->surface);
  }
  if (w->scene->stretch)
    find_derivatives(w);
  if (w->scene->features.object_motion)
    motion_objects(w);
}

void hits_nodes(worker *w) {
  batch *b = w->batch;
  const segment *end = b->queue.segment + b->queue.segments;
  for (const segment *g = b->queue.segment; g < end; g++)
    if (g->material->bare)
      w->scene->stages->flat(g, &b->input);
  clock_tick(&w->clocks, CLOCK_SURFACE);
  for (const segment *g = b->queue.segment; g < end; g++) {
    const node *past = g->material->node + g->material->nodes;
    for (const node *n = g->material->node; n < past; n++) {
      if (n->type == NODE_OCCLUSION)
        occlusion_trace(w->scene, b, g->run, &n->of.occlusion);
      if (n->type == NODE_BEVEL)
        bevel_trace(w->scene, b, g->run, &n->of.bevel);
      w->scene->stages->node[n->type](g, n, &b->corner, &b->surface, &b->input);
      if (n + 1 == past ||
          n[1].type != n->type) /* of those alike in a row once: it takes a while */
        clock_tick(&w->clocks, CLOCK_NODE + n->type);
    }
  }
}
