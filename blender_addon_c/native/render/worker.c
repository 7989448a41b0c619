/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/worker.h"

#include <stdlib.h>
#include <string.h>

#include "render/motion.h"
#include "render/occlusion.h"

bool batch_init(worker *w) {
  w->batch = aligned_alloc(64, sizeof *w->batch);
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
