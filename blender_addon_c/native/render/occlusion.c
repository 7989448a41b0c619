/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/occlusion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "batch/leaf.h"
#include "scene/accel.h"
#include "stage/stage.h"
#include "system/memory.h"

enum { OTHERS = 64 }; /* surfaces of other objects that a local ray goes through */

bool occlusion_init(batch *b, const scene *s) {
  b->occlusion = NULL;
  b->input.stopped = NULL;
  b->input.around = NULL;
  if (!s->features.occlusion)
    return true;
  b->occlusion = memory_aligned(64, sizeof *b->occlusion);
  if (!b->occlusion)
    return false;
  memset(b->occlusion, 0, sizeof *b->occlusion);
  b->input.stopped = b->occlusion->stopped;
  b->input.around = &b->occlusion->around;
  return true;
}

void occlusion_free(batch *b) {
  free(b->occlusion);
  b->occlusion = NULL;
}

static uint32_t bits(float x) {
  uint32_t u;
  memcpy(&u, &x, sizeof u);
  return u;
}

static uint32_t mixed(uint32_t h) {
  h = (h ^ h >> 16) * 0x7feb352du;
  h = (h ^ h >> 15) * 0x846ca68bu;
  return h ^ h >> 16;
}

/* Two numbers in [0, 1) for each point: of its place and of the ray that met it, which are others
 * for each sample. */
void occlusion_draw(occlusion *o, const surfaces *at, lane_run run) {
  for (size_t i = run.begin; i < run.end; i++) {
    uint32_t h = mixed(bits(at->p.x[i]) + 0x9e3779b9u);
    h = mixed(h ^ bits(at->p.y[i]));
    h = mixed(h ^ bits(at->p.z[i]));
    h = mixed(h ^ bits(at->wo.x[i]) ^ bits(at->wo.y[i]) * 0x85ebca6bu);
    o->turn[i] = (float)(h >> 8) * 0x1p-24f;
    o->spin[i] = (float)(mixed(h + 0x68bc21ebu) >> 8) * 0x1p-24f;
  }
}

/* To the world, of a vector in the shading frame. */
static vec3 in_world(const surfaces *at, size_t i, vec3 v) {
  vec3 t = load(&at->t, i), b = load(&at->b, i), n = load(&at->n, i);
  return (vec3){v.x * t.x + v.y * b.x + v.z * n.x, v.x * t.y + v.y * b.y + v.z * n.y,
                v.x * t.z + v.y * b.z + v.z * n.z};
}

/* About a unit vector, of (x, y, z) about the z axis [Duff2017]. */
static vec3 about(vec3 n, float x, float y, float z) {
  float sign = n.z < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  vec3 s = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  vec3 t = {b, sign + n.y * n.y * a, -n.y};
  return (vec3){x * s.x + y * t.x + z * n.x, x * s.y + y * t.y + z * n.y,
                x * s.z + y * t.z + z * n.z};
}

/* The k-th ray of each point, by the cosine; of points that look as far as nowhere none. */
static size_t aim_rays(const batch *b, lane_run run, const node_occlusion *n, int k) {
  occlusion *o = b->occlusion;
  const surfaces *at = &b->surface;
  const float *far = n->distance.at < 0 ? NULL : b->input.at[n->distance.at];
  const lane_f *normal = b->input.at;
  const double first = 0.7548776662466927 * k, second = 0.5698402909980532 * k;
  size_t count = 0;
  for (size_t i = run.begin; i < run.end; i++) {
    float distance = far ? far[i] : n->distance.number;
    if (!(distance > 0.0f))
      continue;
    float u = o->turn[i] + (float)(first - floor(first)),
          v = o->spin[i] + (float)(second - floor(second));
    u -= u >= 1.0f ? 1.0f : 0.0f;
    vec3 up = {normal[n->normal[0]][i], normal[n->normal[1]][i], normal[n->normal[2]][i]};
    float length = sqrtf(up.x * up.x + up.y * up.y + up.z * up.z), turn = 6.2831853f * v;
    float by = (n->inside ? -1.0f : 1.0f) / (length > 1e-20f ? length : 1.0f), radius = sqrtf(u);
    up = in_world(at, i, (vec3){up.x * by, up.y * by, up.z * by});
    vec3 d = about(up, radius * cosf(turn), radius * sinf(turn), sqrtf(1.0f - u));
    vec3 g = load(&at->g, i), p = load(&at->p, i);
    float side = d.x * g.x + d.y * g.y + d.z * g.z < 0.0f ? -1.0f : 1.0f;
    if (!isfinite(d.x + d.y + d.z + p.x + p.y + p.z + g.x + g.y + g.z))
      continue;
    o->ray.o.x[count] = p.x + side * g.x;
    o->ray.o.y[count] = p.y + side * g.y;
    o->ray.o.z[count] = p.z + side * g.z;
    o->ray.d.x[count] = d.x;
    o->ray.d.y[count] = d.y;
    o->ray.d.z[count] = d.z;
    o->ray.tnear[count] = 0.0f;
    o->ray.tfar[count] = distance;
    o->ray.time[count] = b->ray->time[i];
    o->lane[count++] = (uint32_t)i;
  }
  return count;
}

static void count_all(const scene *s, occlusion *o, size_t count) {
  accel_occluded(s->accel, count, false, &o->ray);
  for (size_t i = 0; i < count; i++)
    o->stopped[o->lane[i]] += o->ray.tfar[i] < 0.0f ? 1.0f : 0.0f;
}

void occlusion_next(const scene *s, occlusion *o, size_t count) {
  accel_intersect(s->accel, count, RAY_SHADOW, NULL, &o->ray, &o->hit);
  s->stages->locate(count, (uint32_t)(2 * s->quad_count), s->placed, &o->hit);
}

bool occlusion_own(const scene *s, const batch *b, const occlusion *o, size_t i) {
  const surfaces *at = &b->surface;
  uint32_t lane = o->lane[i], instance = s->placed ? o->hit.instance[i] : 0;
  return instance == at->instance[lane] &&
         (instance || s->triangle[o->hit.record[i]].object == s->triangle[at->record[lane]].object);
}

void occlusion_pass(occlusion *o, size_t i, size_t to, float far) {
  o->ray.tnear[to] = o->ray.tfar[i] * 1.00001f + 1e-7f;
  o->ray.o.x[to] = o->ray.o.x[i];
  o->ray.o.y[to] = o->ray.o.y[i];
  o->ray.o.z[to] = o->ray.o.z[i];
  o->ray.d.x[to] = o->ray.d.x[i];
  o->ray.d.y[to] = o->ray.d.y[i];
  o->ray.d.z[to] = o->ray.d.z[i];
  o->ray.time[to] = o->ray.time[i];
  o->ray.tfar[to] = far;
  o->lane[to] = o->lane[i];
}

/* Rays that meet another object go on behind it. */
static void count_local(const scene *s, const batch *b, occlusion *o, size_t count) {
  lane_f far;
  for (size_t i = 0; i < count; i++)
    far[i] = o->ray.tfar[i];
  for (int step = 0; step < OTHERS && count; step++) {
    size_t left = 0;
    occlusion_next(s, o, count);
    for (size_t i = 0; i < count; i++) {
      if (o->hit.record[i] == RECORD_MISS)
        continue;
      if (occlusion_own(s, b, o, i)) {
        o->stopped[o->lane[i]] += 1.0f;
        continue;
      }
      far[left] = far[i];
      occlusion_pass(o, i, left, far[left]);
      left++;
    }
    count = left;
  }
}

void occlusion_trace(const scene *s, batch *b, lane_run run, const node_occlusion *n) {
  occlusion *o = b->occlusion;
  if (!o)
    return;
  occlusion_draw(o, &b->surface, run);
  memset(o->stopped + run.begin, 0, (run.end - run.begin) * sizeof(float));
  for (int k = 0; k < n->samples; k++) {
    size_t count = aim_rays(b, run, n, k);
    if (n->local)
      count_local(s, b, o, count);
    else
      count_all(s, o, count);
  }
}
