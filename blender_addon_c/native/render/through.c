/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/through.h"

#include <stdlib.h>
#include <string.h>

#include "closure/closure.h"
#include "render/hits.h"
#include "render/motion.h"
#include "render/plane.h"
#include "system/memory.h"

struct through {
  worker inner; /* at surfaces on the way, whose rays are the shadow rays that are stopped */
  passages way;
};

through *through_create(const worker *w) {
  through *t = memory_aligned(64, sizeof *t);
  if (!t)
    return NULL;
  t->inner = (worker){.scene = w->scene, .sampling = w->sampling, .cancel = w->cancel};
  if (batch_init(&t->inner))
    return t;
  through_free(t);
  return NULL;
}

void through_free(through *t) {
  if (t)
    batch_free(&t->inner);
  free(t);
}

/* How much light goes straight on at the hits: their transparent closures' weights. */
static void add_shares(worker *w) {
  batch *b = w->batch;
  size_t bytes = b->queue.hits * sizeof(float);
  memset(b->sum.r, 0, bytes);
  memset(b->sum.g, 0, bytes);
  memset(b->sum.b, 0, bytes);
  for (const segment *g = b->queue.segment; g < b->queue.segment + b->queue.segments; g++)
    for (size_t k = 0; k < g->material->closures; k++)
      if (g->material->closure[k].traits & CLOSURE_PASSES)
        w->scene->stages->emit(&g->material->closure[k], g->run, &b->input, &b->sum);
}

/* Which of the rays met instances that do not shade their light: as if they were not there. */
static void find_free(const worker *w, const light_samples *light, passages *way, size_t rays) {
  const scene *s = w->scene;
  const batch *b = w->batch;
  const hits *hit = &b->sample_hit;
  for (size_t k = 0; k < rays; k++) {
    uint32_t bit = hit->record[k] == RECORD_MISS ? 0 : light->shade[way->hit[k]];
    way->free[k] = bit && (uint32_t)hit_instance(s, b, hit, k)->shadeless & bit;
  }
}

/* Of surfaces that do not shade a light, which nobody counts, no scene has so many in a row; beside
 * numbers without end a ray may never get off one. */
enum { UNCOUNTED_MOST = 1024 };

bool through_shadows(worker *w, const float *color) {
  const scene *s = w->scene;
  const stage_table *stage = s->stages;
  batch *b = w->batch;
  worker *inner = &w->through->inner;
  batch *at = inner->batch;
  passages *way = &w->through->way;
  size_t hits = b->queue.hits;
  memcpy(way->tfar, b->light.ray.tfar, hits * sizeof(float));
  accel_occluded(s->accel, hits, false, &b->light.ray);
  size_t rays = stage->stopped(hits, s->limits.shadows, s->features.shadow_linking, b->queue.lane,
                               b->state, &b->light, way, &at->sample_ray);
  bool any = false;
  for (int round = 0; rays && round < (int)s->limits.shadows + UNCOUNTED_MOST; round++) {
    if (s->features.object_motion)
      motion_passages(b, way, at, rays);
    hits_trace(inner, RAY_SHADOW, rays);
    if (s->features.shadow_linking)
      find_free(inner, &b->light, way, rays);
    at->queue.hits = stage->sift(rays, s->triangle, s->material, s->features.shadow_linking, way,
                                 at->sample_hit.record, &b->light);
    if (!at->queue.hits)
      break;
    any = true;
    hits_sort(inner, rays, NULL);
    hits_surface(inner);
    if (s->features.light_path)
      stage->route_shadow(at->queue.hits, s->limits.shadows, at->queue.lane, way, b->queue.lane,
                          b->state, at->ray, &at->surface);
    hits_nodes(inner);
    add_shares(inner);
    rays = stage->pass(at->queue.hits, at->queue.lane, &at->surface, at->ray, &at->sum,
                       s->features.shadow_linking, way, &at->light.ray, &b->light);
    memcpy(&at->sample_ray, &at->light.ray, sizeof at->sample_ray);
  }
  if (any)
    stage->tint(hits, color, way, &b->light);
  return any;
}
