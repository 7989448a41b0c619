/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/tile.h"

#include <stdlib.h>
#include <string.h>

#include "render/bounce.h"
#include "system/parallel.h"

enum { MAX_SIDE = 32 };

static bool cancelled(const render *r) {
  return atomic_load_explicit(r->cancel, memory_order_relaxed);
}

static size_t region_width(const render *r) {
  return (size_t)(r->region[2] - r->region[0]);
}

/* Where the tile's part of the region begins and ends. */
static void tile_bounds(const render *r, size_t tile, int low[2], int high[2]) {
  size_t place[2] = {tile % r->columns, tile / r->columns};
  for (int k = 0; k < 2; k++) {
    int begin = r->origin[k] + (int)place[k] * r->side, end = begin + r->side;
    low[k] = begin > r->region[k] ? begin : r->region[k];
    high[k] = end < r->region[k + 2] ? end : r->region[k + 2];
  }
}

/* The tile's average into the picture; the background behind it. */
static void finish_tile(const render *r, const camera_view *view, const float *pixels) {
  const scene *s = r->scene;
  float scale = 1.0f / (float)r->sampling->period;
  for (uint32_t p = 0; p < (uint32_t)(r->side * r->side); p++) {
    int x, y;
    pixel_place(view, p, &x, &y);
    x -= r->region[0];
    y -= r->region[1];
    if (x < 0 || y < 0 || x >= r->region[2] - r->region[0] || y >= r->region[3] - r->region[1])
      continue;
    float *out = r->image + 4 * ((size_t)y * region_width(r) + (size_t)x);
    float alpha = pixels[4 * p + 3] * scale;
    for (unsigned c = 0; c < 3; c++)
      out[c] =
          pixels[4 * p + c] * scale + (s->transparent ? 0.0f : (1.0f - alpha) * s->background[c]);
    out[3] = s->transparent ? alpha : 1.0f;
  }
}

static void render_tile(render *r, worker *w, size_t tile) {
  float pixels[4 * MAX_SIDE * MAX_SIDE] = {0};
  const scene *s = r->scene;
  size_t samples = r->sampling->period, lanes = samples * (size_t)(r->side * r->side);
  camera_view view = {.camera = &s->camera,
                      .x = r->origin[0] + (int)(tile % r->columns) * r->side,
                      .y = r->origin[1] + (int)(tile / r->columns) * r->side,
                      .samples = (uint32_t)samples,
                      .per_sample = 1.0f / (float)samples,
                      .step = {(s->camera.frame[1] - s->camera.frame[0]) / (float)s->width,
                               (s->camera.frame[3] - s->camera.frame[2]) / (float)s->height},
                      .seed = s->seed,
                      .scramble = r->sampling->scramble,
                      .warp = r->sampling->warp};
  memcpy(view.region, r->region, sizeof view.region);
  for (size_t first = 0; first < lanes; first += BATCH) {
    if (cancelled(r))
      return;
    view.first = (uint32_t)first;
    bounce_batch(w, &view, lanes - first < BATCH ? lanes - first : BATCH, pixels);
  }
  if (r->image)
    finish_tile(r, &view, pixels);
  atomic_store_explicit(&r->done[tile], true, memory_order_release);
  atomic_fetch_add_explicit(&r->finished, 1, memory_order_relaxed);
}

static void work(void *context, size_t number) {
  (void)number;
  render *r = context;
  worker w = {.scene = r->scene, .sampling = r->sampling, .observer = r->observer};
  if (worker_init(&w)) {
    for (;;) {
      size_t tile = atomic_fetch_add_explicit(&r->next, 1, memory_order_relaxed);
      if (tile >= r->tiles || cancelled(r))
        break;
      render_tile(r, &w, tile);
    }
  } else {
    message_error(r->log, "out of memory");
  }
  worker_free(&w);
  pthread_mutex_lock(&r->lock);
  r->status |= w.status;
  for (int k = 0; k < CLOCKS; k++)
    r->seconds[k] += w.clocks.seconds[k];
  pthread_mutex_unlock(&r->lock);
}

bool render_prepare(render *r) {
  size_t samples = r->sampling->period;
  r->side = samples < 16 ? MAX_SIDE : samples <= 1024 ? 16 : 4;
  size_t count[2];
  for (int k = 0; k < 2; k++) {
    r->origin[k] = r->region[k] / r->side * r->side;
    count[k] = (size_t)((r->region[k + 2] - r->origin[k] + r->side - 1) / r->side);
  }
  r->columns = count[0];
  r->tiles = count[0] * count[1];
  pthread_mutex_init(&r->lock, NULL);
  r->done = calloc(r->tiles + 1, sizeof *r->done);
  return r->done != NULL;
}

bool render_run(render *r) {
  size_t threads = (size_t)r->scene->threads;
  parallel_for((int)threads, threads < r->tiles ? threads : r->tiles, work, r);
  return !cancelled(r) && !r->log->error[0];
}

void render_copy(const render *r, float *out) {
  size_t stride = 4 * region_width(r);
  for (size_t tile = 0; tile < r->tiles; tile++) {
    bool done = atomic_load_explicit(&r->done[tile], memory_order_acquire);
    int low[2], high[2];
    tile_bounds(r, tile, low, high);
    size_t size = 4 * (size_t)(high[0] - low[0]) * sizeof *out;
    for (int y = low[1]; y < high[1]; y++) {
      size_t at = (size_t)(y - r->region[1]) * stride + 4 * (size_t)(low[0] - r->region[0]);
      if (done)
        memcpy(out + at, r->image + at, size);
      else
        memset(out + at, 0, size);
    }
  }
}

void render_free(render *r) {
  if (r->done)
    pthread_mutex_destroy(&r->lock);
  free(r->done);
}
