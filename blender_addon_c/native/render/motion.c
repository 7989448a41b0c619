/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "batch/leaf.h"
#include "scene/world.h"

bool motion_init(batch *b, const scene *s) {
  b->placed = s->placed;
  b->object = s->object;
  b->own_placed = NULL;
  b->own_object = NULL;
  if (!s->features.object_motion)
    return true;
  b->placed = b->own_placed = malloc((s->placed_count + BATCH) * sizeof *b->own_placed);
  if (!b->placed)
    return false;
  memcpy(b->own_placed, s->placed, s->placed_count * sizeof *b->own_placed);
  if (!s->object)
    return true;
  b->object = b->own_object = malloc((s->instances + BATCH) * sizeof *b->own_object);
  if (!b->object)
    return false;
  memcpy(b->own_object, s->object, s->instances * sizeof *b->own_object);
  return true;
}

void motion_end(batch *b) {
  free(b->own_placed);
  free(b->own_object);
}

/* ---- rays */

/* Lines from the top one after another: each may begin while those before it are still open. */
static void motion_lines(worker *w, const camera_view *view, size_t count) {
  const scene *s = w->scene;
  batch *b = w->batch;
  for (size_t i = 0; i < count; i++) {
    uint32_t j = view->first + (uint32_t)i;
    int line = view->y + (int)unzip(j / view->samples >> 1);
    float begins = 1.0f - (float)line / (float)s->height;
    float x = begins * (1.0f - s->line_time) + b->path.time[i] * s->line_time;
    b->path.time[i] = b->sample_ray.time[i] = x;
  }
}

void motion_times(worker *w, const camera_view *view, const shuffle *points, size_t count) {
  batch *b = w->batch;
  const float *shutter = w->scene->shutter;
  for (size_t i = 0; i < count; i++) {
    float x = 0.5f, unused;
    if (points)
      shuffled_point(points->index[i], points->reverse, points->mask,
                     mix(b->path.hash[i] + points->salt), &x, &unused);
    if (points && shutter) {
      float at = x * SHUTTER_STEPS;
      size_t k = (size_t)at;
      x = shutter[k] + (at - (float)k) * (shutter[k + 1] - shutter[k]);
    }
    b->path.time[i] = b->sample_ray.time[i] = x;
  }
  if (points && w->scene->features.rolling_shutter)
    motion_lines(w, view, count);
}

/* A direction by the camera's axes, and out of them. */
static vec3 into(const camera *c, vec3 d) {
  float v[3];
  for (int k = 0; k < 3; k++)
    v[k] = c->axis[k][0] * d.x + c->axis[k][1] * d.y + c->axis[k][2] * d.z;
  return (vec3){v[0], v[1], v[2]};
}

static vec3 out_of(const camera *c, vec3 d) {
  float v[3];
  for (int k = 0; k < 3; k++)
    v[k] = c->axis[0][k] * d.x + c->axis[1][k] * d.y + c->axis[2][k] * d.z;
  return (vec3){v[0], v[1], v[2]};
}

void motion_zoom(worker *w, size_t count) {
  const camera *c = &w->scene->camera;
  rays *ray = &w->batch->sample_ray;
  if (!c->frames || !c->perspective || c->panorama)
    return;
  for (size_t i = 0; i < count; i++) {
    float part, at[2], frame[4];
    int step = motion_step(c->motion.steps, ray->time[i], &part);
    for (int k = 0; k < 4; k++) {
      const float *from = c->frames + 4 * step + k;
      frame[k] = from[0] + part * (from[4] - from[0]);
    }
    vec3 d = into(c, load(&ray->d, i));
    at[0] = d.x / -d.z, at[1] = d.y / -d.z;
    for (int k = 0; k < 2; k++) {
      float share = (at[k] - c->frame[2 * k]) / (c->frame[2 * k + 1] - c->frame[2 * k]);
      at[k] = frame[2 * k] + share * (frame[2 * k + 1] - frame[2 * k]);
    }
    float length = sqrtf(at[0] * at[0] + at[1] * at[1] + 1.0f), longer = length * -d.z;
    store(&ray->d, i, out_of(c, scaled((vec3){at[0], at[1], -1.0f}, 1.0f / length)));
    ray->tnear[i] *= longer;
    ray->tfar[i] *= longer;
  }
}

void motion_camera(worker *w, size_t count) {
  const camera *c = &w->scene->camera;
  rays *ray = &w->batch->sample_ray;
  const vec3 origin = {c->origin[0], c->origin[1], c->origin[2]};
  for (size_t i = 0; c->motion.steps && i < count; i++) {
    float m[12];
    motion_at(&c->motion, ray->time[i], m);
    vec3 o = load(&ray->o, i), d = into(c, load(&ray->d, i));
    o = into(c, (vec3){o.x - origin.x, o.y - origin.y, o.z - origin.z});
    store(&ray->o, i,
          (vec3){m[0] * o.x + m[1] * o.y + m[2] * o.z + m[3],
                 m[4] * o.x + m[5] * o.y + m[6] * o.z + m[7],
                 m[8] * o.x + m[9] * o.y + m[10] * o.z + m[11]});
    store(&ray->d, i,
          (vec3){m[0] * d.x + m[1] * d.y + m[2] * d.z, m[4] * d.x + m[5] * d.y + m[6] * d.z,
                 m[8] * d.x + m[9] * d.y + m[10] * d.z});
  }
}

void motion_paths(worker *w, size_t rays) {
  batch *b = w->batch;
  for (size_t k = 0; k < rays; k++)
    b->sample_ray.time[k] = b->path.time[b->state->sample[k]];
}

void motion_shadows(worker *w) {
  batch *b = w->batch;
  memcpy(b->light.ray.time, b->ray->time, b->queue.hits * sizeof(float));
}

void motion_passages(const batch *from, const passages *way, batch *to, size_t rays) {
  for (size_t k = 0; k < rays; k++)
    to->sample_ray.time[k] = from->light.ray.time[way->hit[k]];
}

/* ---- hits */

/* Two edges of a record at a step. */
static void edges_at(const scene *s, const deform *d, const uint32_t corner[3], int step,
                     vec3 edge[2]) {
  const float *position = s->world[0];
  vec3 p[3];
  for (int k = 0; k < 3; k++) {
    const float *at = position + 3 * (corner[k] + (size_t)step * d->positions);
    p[k] = (vec3){at[0], at[1], at[2]};
  }
  for (int k = 0; k < 2; k++)
    edge[k] = (vec3){p[k + 1].x - p[0].x, p[k + 1].y - p[0].y, p[k + 1].z - p[0].z};
}

/* A vector of a triangle by its edges `from`, and then as much of `to`. */
static vec3 carried(const vec3 from[2], const vec3 to[2], vec3 v) {
  float a = dot(from[0], from[0]), b = dot(from[0], from[1]), c = dot(from[1], from[1]);
  float x = dot(from[0], v), y = dot(from[1], v), area = a * c - b * b;
  if (!(area > 1e-12f * a * c))
    return v;
  float s = (c * x - b * y) / area, t = (a * y - b * x) / area;
  return (vec3){s * to[0].x + t * to[1].x, s * to[0].y + t * to[1].y, s * to[0].z + t * to[1].z};
}

/* The row of a hit of a mesh that changes its shape: normal and tangent at its time. */
static void bend(const scene *s, const placed *p, const hits *hit, size_t i, float time,
                 float *row) {
  const deform *d = p->deform;
  float part, n[3] = {0, 0, 0};
  int step = motion_step(d->steps, time, &part);
  uint32_t record = hit->record[i], corner[3];
  uint32_t base = (uint32_t)(2 * s->quad_count);
  uint32_t quads = d->records - p->singles;
  uint32_t local = record < base ? record - p->quad : quads + record - p->single;
  float u = hit->u[i], v = hit->v[i];
  const float weight[3] = {1.0f - u - v, u, v};
  for (int end = 0; end < 2; end++) {
    const float *from =
        s->moved_normal + d->normal + 9 * ((size_t)(step + end) * d->records + local);
    float share = end ? part : 1.0f - part;
    for (int k = 0; k < 9; k++)
      n[k % 3] += share * weight[k / 3] * from[k];
  }
  memcpy(row, n, sizeof n);
  vec3 now[2], a[2], b[2], then[2];
  world_corners(s, record, corner);
  edges_at(s, d, corner, d->steps / 2, now);
  edges_at(s, d, corner, step, a);
  edges_at(s, d, corner, step + 1, b);
  for (int k = 0; k < 2; k++)
    then[k] = (vec3){a[k].x + part * (b[k].x - a[k].x), a[k].y + part * (b[k].y - a[k].y),
                     a[k].z + part * (b[k].z - a[k].z)};
  vec3 t = carried(now, then, (vec3){row[3], row[4], row[5]});
  row[3] = t.x, row[4] = t.y, row[5] = t.z;
}

void motion_hits(worker *w) {
  const scene *s = w->scene;
  batch *b = w->batch;
  for (size_t i = 0; i < b->queue.hits; i++) {
    const placed *from = &s->placed[b->hit->instance[i]];
    if (!from->motion && !from->deform)
      continue;
    float at[12], time = b->ray->time[i];
    double matrix[12];
    placed *own = &b->own_placed[s->placed_count + i];
    *own = *from;
    b->hit->instance[i] = (uint32_t)(s->placed_count + i);
    if (from->deform)
      bend(s, from, b->hit, i, time, b->corner.row + 8 * i);
    if (!from->motion)
      continue;
    motion_at(from->motion, time, at);
    for (int k = 0; k < 12; k++)
      matrix[k] = (double)at[k];
    world_place(matrix, own);
  }
}

void motion_objects(worker *w) {
  const scene *s = w->scene;
  batch *b = w->batch;
  for (size_t i = 0; i < b->queue.hits; i++) {
    uint32_t instance = b->hit->instance[i];
    if (instance < s->placed_count)
      continue;
    const placed *own = &b->own_placed[instance];
    if (s->features.curved && !w->observer && own->deform) {
      store(&b->surface.lift, i, (vec3){0, 0, 0});
      b->surface.slack[i] = 0.0f;
    }
    if (!s->features.object_info || !own->motion)
      continue;
    float at[12];
    double matrix[12];
    object *out = &b->own_object[s->instances + i];
    motion_at(own->motion, b->ray->time[i], at);
    for (int k = 0; k < 12; k++)
      matrix[k] = (double)at[k];
    *out = s->object[own->object];
    world_object(matrix, out);
    b->surface.object[i] = (uint32_t)(s->instances + i);
  }
}
