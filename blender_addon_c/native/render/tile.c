/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/tile.h"

#include <stdlib.h>
#include <string.h>

#include "batch/batch.h"
#include "render/dump_scene.h"
#include "system/parallel.h"

const char *const stage_clock_name[CLOCK_COUNT] = {"camera", "hit",    "surface", "bump",
                                                   "light",  "shadow", "shade",   "film"};

enum { MAX_SIDE = 32 };

typedef struct worker {
  render *render;
  const stage_table *stages;
  batch *batch;
  uint32_t *tally; /* per material, for sorting */
  float pixels[4 * MAX_SIDE * MAX_SIDE];
  double clock, seconds[CLOCK_COUNT];
} worker;

static void tick(worker *w, stage_clock stage) {
  double now = parallel_clock();
  w->seconds[stage] += now - w->clock;
  w->clock = now;
}

static bool cancelled(const render *r) {
  return atomic_load_explicit(r->cancel, memory_order_relaxed);
}

static accel_rays rays_of(batch_rays *r) {
  return (accel_rays){.ox = r->ox,
                      .oy = r->oy,
                      .oz = r->oz,
                      .tnear = r->tnear,
                      .dx = r->dx,
                      .dy = r->dy,
                      .dz = r->dz,
                      .tfar = r->tfar};
}

/* Camera rays and what they meet. */
static void trace(worker *w, const camera_view *view, size_t count, size_t phase) {
  const render *r = w->render;
  const sampling *p = r->sampling;
  batch *b = w->batch;
  batch_rays *ray = &b->lane_ray;
  batch_hits *hit = &b->lane_hit;
  w->stages->camera(count, view, p->point[0] + phase, p->point[1] + phase, p->warp, b->hash,
                    ray->ox, ray->oy, ray->oz, ray->tnear, ray->dx, ray->dy, ray->dz, ray->tfar);
  tick(w, CLOCK_CAMERA);
  accel_rays rays = rays_of(ray);
  accel_hits hits = {.gx = hit->gx,
                     .gy = hit->gy,
                     .gz = hit->gz,
                     .u = hit->u,
                     .v = hit->v,
                     .primitive = b->primitive,
                     .geometry = b->geometry};
  accel_intersect(r->scene->accel, count, &rays, &hits);
  b->hits = w->stages->locate(count, (uint32_t)(2 * r->scene->quad_count), b->geometry,
                              b->primitive, hit->u, hit->v, hit->record, b->alpha);
}

/* Hits without the misses, one material after the other, in b->moved_*. */
static void move_hits(worker *w, size_t count) {
  const scene *s = w->render->scene;
  batch *b = w->batch;
  const uint32_t *record = b->lane_hit.record;
  for (size_t i = 0; i < count; i++)
    if (record[i] != RECORD_MISS) {
      uint32_t at = w->tally[s->triangle[record[i]].material]++;
      b->moved_lane[at] = (uint32_t)i;
      b->moved_hit.record[at] = record[i];
    }
  const batch_rays *ray = &b->lane_ray;
  const batch_hits *hit = &b->lane_hit;
  batch_rays *to_ray = &b->moved_ray;
  batch_hits *to_hit = &b->moved_hit;
  const float *from[] = {ray->ox,   ray->oy, ray->oz, ray->dx, ray->dy, ray->dz,
                         ray->tfar, hit->gx, hit->gy, hit->gz, hit->u,  hit->v};
  float *to[] = {to_ray->ox,   to_ray->oy, to_ray->oz, to_ray->dx, to_ray->dy, to_ray->dz,
                 to_ray->tfar, to_hit->gx, to_hit->gy, to_hit->gz, to_hit->u,  to_hit->v};
  for (size_t k = 0; k < sizeof from / sizeof *from; k++)
    w->stages->gather(b->hits, b->moved_lane, from[k], to[k]);
}

/* Lanes to hits: sorted by material, unless all lanes hit the same one and nothing need move. */
static void sort_hits(worker *w, size_t count) {
  const scene *s = w->render->scene;
  batch *b = w->batch;
  memset(w->tally, 0, s->materials * sizeof *w->tally);
  if (s->materials == 1)
    w->tally[0] = (uint32_t)b->hits;
  else
    for (size_t i = 0; i < count; i++)
      if (b->lane_hit.record[i] != RECORD_MISS)
        w->tally[s->triangle[b->lane_hit.record[i]].material]++;
  size_t begin = 0;
  b->segments = 0;
  for (size_t m = 0; begin < b->hits; m++) {
    size_t number = w->tally[m];
    w->tally[m] = (uint32_t)begin;
    if (number)
      b->segment[b->segments++] =
          (segment){.material = &s->material[m], .begin = begin, .count = number};
    begin += number;
  }
  bool in_place = b->segments == 1 && b->hits == count;
  b->ray = in_place ? &b->lane_ray : &b->moved_ray;
  b->hit = in_place ? &b->lane_hit : &b->moved_hit;
  b->lane = in_place ? b->identity : b->moved_lane;
  if (!in_place)
    move_hits(w, count);
}

static void find_surface(worker *w) {
  const stage_table *s = w->stages;
  batch *b = w->batch;
  const batch_rays *ray = b->ray;
  batch_hits *hit = b->hit;
  s->corner(b->hits, w->render->scene->triangle, hit->record, hit->u, hit->v, b->row, b->handed,
            b->reach);
  s->surface(b->hits, b->row, b->reach, ray->ox, ray->oy, ray->oz, ray->dx, ray->dy, ray->dz,
             ray->tfar, hit->gx, hit->gy, hit->gz, b->px, b->py, b->pz, b->nx, b->ny, b->nz, b->tx,
             b->ty, b->tz, b->bx, b->by, b->bz, b->wox, b->woy, b->woz, b->u, b->v, b->side);
}

static void look_up(worker *w, const segment *g) {
  batch *b = w->batch;
  const stage_table *s = w->stages;
  const material *m = g->material;
  size_t i = g->begin, n = g->count;
  if (m->normal) {
    s->bilinear(n, m->normal, b->u + i, b->v + i, b->bump_x + i, b->bump_y + i);
    s->bump(n, b->handed + i, b->side + i, b->bump_x + i, b->bump_y + i, b->bump_z + i);
  } else {
    memset(b->bump_x + i, 0, n * sizeof(float));
    memset(b->bump_y + i, 0, n * sizeof(float));
    for (size_t k = i; k < i + n; k++)
      b->bump_z[k] = 1.0f;
  }
  if (m->color[0]) {
    s->bilinear(n, m->color[0], b->u + i, b->v + i, b->f0_r + i, b->f0_g + i);
    s->bilinear(n, m->color[1], b->u + i, b->v + i, b->f0_b + i, b->spare + i);
    s->tint(n, b->f0_r + i);
    s->tint(n, b->f0_g + i);
    s->tint(n, b->f0_b + i);
  }
}

static void shade(worker *w, const segment *g) {
  batch *b = w->batch;
  size_t i = g->begin;
  bool textured = g->material->color[0] != NULL;
  shade_lanesf in = {.size = sizeof in,
                     .nx = b->bump_x + i,
                     .ny = b->bump_y + i,
                     .nz = b->bump_z + i,
                     .wix = b->wix + i,
                     .wiy = b->wiy + i,
                     .wiz = b->wiz + i,
                     .wox = b->wox + i,
                     .woy = b->woy + i,
                     .woz = b->woz + i,
                     .f0r = textured ? b->f0_r + i : NULL,
                     .f0g = textured ? b->f0_g + i : NULL,
                     .f0b = textured ? b->f0_b + i : NULL};
  shade_resultf out = {
      .size = sizeof out, .r = b->r + i, .g = b->g + i, .b = b->b + i, .cosine = b->cosine + i};
  unsigned status = shade_bsdf_eval_batchf(&g->material->bsdf, g->count, &in, &out);
  if (status)
    atomic_fetch_or_explicit(&w->render->status, status, memory_order_relaxed);
}

/* One light on all hits: b->sum_* grow by what they reflect. */
static void illuminate(worker *w, size_t number, size_t phase) {
  const render *r = w->render;
  const light *l = &r->scene->light[number];
  const sampling *p = r->sampling;
  const stage_table *s = w->stages;
  batch *b = w->batch;
  batch_rays *ray = &b->shadow_ray;
  const float *disc_a = b->zero, *disc_b = b->zero;
  if (l->radius > 0.0f && p->scramble) { /* a dump takes lights at their centres */
    s->disc(b->hits, b->lane, b->hash, p->point[2] + phase, p->point[3] + phase,
            ((uint32_t)number + 1) * 0x9e3779b9u, p->scramble, b->disc_a, b->disc_b);
    disc_a = b->disc_a;
    disc_b = b->disc_b;
  }
  s->light[l->type](b->hits, l, disc_a, disc_b, b->px, b->py, b->pz, ray->dx, ray->dy, ray->dz,
                    b->e, ray->tfar);
  s->lit(b->hits, ray->dx, ray->dy, ray->dz, b->px, b->py, b->pz, b->hit->gx, b->hit->gy,
         b->hit->gz, b->nx, b->ny, b->nz, b->tx, b->ty, b->tz, b->bx, b->by, b->bz, b->wix, b->wiy,
         b->wiz, ray->ox, ray->oy, ray->oz, ray->tfar);
  tick(w, CLOCK_LIGHT);
  if (l->shadow) {
    accel_rays rays = rays_of(ray);
    rays.tnear = b->zero;
    accel_occluded(r->scene->accel, b->hits, &rays);
  }
  size_t lit = s->shadow(b->hits, ray->tfar, b->e);
  tick(w, CLOCK_SHADOW);
  if (!lit && !r->dump)
    return;
  for (size_t k = 0; k < b->segments; k++)
    shade(w, &b->segment[k]);
  s->reflect(b->hits, l->color, b->e, b->cosine, b->r, b->g, b->b, b->sum_r, b->sum_g, b->sum_b);
  tick(w, CLOCK_SHADE);
}

static void expose(worker *w, size_t first, size_t count) {
  const stage_table *s = w->stages;
  batch *b = w->batch;
  const float *sum[] = {b->sum_r, b->sum_g, b->sum_b};
  float *lane[] = {b->red, b->green, b->blue};
  const float *out[3];
  for (int c = 0; c < 3; c++) {
    out[c] = sum[c];
    if (b->lane != b->identity) {
      memset(lane[c], 0, count * sizeof *lane[c]);
      s->scatter(b->hits, b->lane, sum[c], lane[c]);
      out[c] = lane[c];
    }
  }
  s->film(count, first, w->render->sampling->period, out[0], out[1], out[2], b->alpha, w->pixels);
}

static void render_batch(worker *w, const camera_view *view, size_t count) {
  const render *r = w->render;
  batch *b = w->batch;
  size_t phase = view->first % r->sampling->period;
  w->clock = parallel_clock();
  trace(w, view, count, phase);
  if (b->hits)
    sort_hits(w, count);
  tick(w, CLOCK_HIT);
  if (!b->hits)
    return;
  find_surface(w);
  tick(w, CLOCK_SURFACE);
  for (size_t k = 0; k < b->segments; k++)
    look_up(w, &b->segment[k]);
  tick(w, CLOCK_BUMP);
  memset(b->sum_r, 0, b->hits * sizeof(float));
  memset(b->sum_g, 0, b->hits * sizeof(float));
  memset(b->sum_b, 0, b->hits * sizeof(float));
  if (r->dump)
    dump_scene_hits(r->dump, b, view);
  for (size_t k = 0; k < r->scene->lights; k++) {
    illuminate(w, k, phase);
    if (r->dump)
      dump_scene_light(r->dump, b, view, k, r->scene->light[k].color);
  }
  w->clock = parallel_clock();
  expose(w, view->first, count);
  tick(w, CLOCK_FILM);
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
static void finish_tile(const worker *w, const camera_view *view) {
  const render *r = w->render;
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
    float alpha = w->pixels[4 * p + 3] * scale;
    for (unsigned c = 0; c < 3; c++)
      out[c] = w->pixels[4 * p + c] * scale +
               (s->transparent ? 0.0f : (1.0f - alpha) * s->background[c]);
    out[3] = s->transparent ? alpha : 1.0f;
  }
}

static void render_tile(worker *w, size_t tile) {
  render *r = w->render;
  const scene *s = r->scene;
  size_t samples = r->sampling->period, lanes = samples * (size_t)(r->side * r->side);
  camera_view view = {.camera = &s->camera,
                      .x = r->origin[0] + (int)(tile % r->columns) * r->side,
                      .y = r->origin[1] + (int)(tile / r->columns) * r->side,
                      .per_sample = 1.0f / (float)samples,
                      .step = {(s->camera.frame[1] - s->camera.frame[0]) / (float)s->width,
                               (s->camera.frame[3] - s->camera.frame[2]) / (float)s->height},
                      .seed = s->seed,
                      .scramble = r->sampling->scramble};
  memcpy(view.region, r->region, sizeof view.region);
  memset(w->pixels, 0, sizeof w->pixels);
  for (size_t first = 0; first < lanes; first += BATCH) {
    if (cancelled(r))
      return;
    view.first = (uint32_t)first;
    render_batch(w, &view, lanes - first < BATCH ? lanes - first : BATCH);
  }
  if (r->image)
    finish_tile(w, &view);
  atomic_store_explicit(&r->done[tile], true, memory_order_release);
  atomic_fetch_add_explicit(&r->finished, 1, memory_order_relaxed);
}

static void work(void *context, size_t number) {
  (void)number;
  render *r = context;
  worker w = {.render = r, .stages = r->scene->stages};
  w.batch = aligned_alloc(64, sizeof *w.batch);
  w.tally = malloc((r->scene->materials + 1) * sizeof *w.tally);
  if (w.batch && w.tally) {
    for (uint32_t i = 0; i < BATCH; i++)
      w.batch->identity[i] = i;
    memset(w.batch->zero, 0, sizeof w.batch->zero);
    for (;;) {
      size_t tile = atomic_fetch_add_explicit(&r->next, 1, memory_order_relaxed);
      if (tile >= r->tiles || cancelled(r))
        break;
      render_tile(&w, tile);
    }
  } else {
    message_error(r->log, "out of memory");
  }
  free(w.batch);
  free(w.tally);
  pthread_mutex_lock(&r->lock);
  for (int k = 0; k < CLOCK_COUNT; k++)
    r->seconds[k] += w.seconds[k];
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
