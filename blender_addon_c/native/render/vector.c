/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/vector.h"

#include "batch/leaf.h"
#include "scene/world.h"

enum { BEFORE, NOW, AFTER };

/* Where a point of an object is then: of a mesh that changes its shape by its corners. */
static vec3 place_then(const scene *s, const instance *in, const uint32_t corner[3],
                       const float weight[3], int when) {
  const mesh *m = &s->mesh[in->mesh];
  const float *position = m->position;
  if (m->shapes && when != NOW)
    position = m->moved_position + (when == AFTER ? 3 * (size_t)(m->shapes - 1) * m->positions : 0);
  vec3 p = {0, 0, 0};
  for (int k = 0; k < 3; k++) {
    const float *at = position + 3 * (size_t)(corner[k] - in->base);
    p = (vec3){p.x + weight[k] * at[0], p.y + weight[k] * at[1], p.z + weight[k] * at[2]};
  }
  float a[12];
  for (int k = 0; k < 12; k++)
    a[k] = (float)in->matrix[k];
  if (in->motion.steps && when != NOW)
    motion_at(&in->motion, when == AFTER ? 1.0f : 0.0f, a);
  return (vec3){a[0] * p.x + a[1] * p.y + a[2] * p.z + a[3],
                a[4] * p.x + a[5] * p.y + a[6] * p.z + a[7],
                a[8] * p.x + a[9] * p.y + a[10] * p.z + a[11]};
}

/* And in the picture, in pixels. */
static void pixel_then(const scene *s, vec3 p, int when, float out[2]) {
  const camera *c = &s->camera;
  const float *frame = c->frame;
  float m[12];
  for (int k = 0; k < 3; k++) {
    for (int axis = 0; axis < 3; axis++)
      m[4 * k + axis] = c->axis[axis][k];
    m[4 * k + 3] = c->origin[k];
  }
  if (c->motion.steps && when != NOW) {
    motion_at(&c->motion, when == AFTER ? 1.0f : 0.0f, m);
    if (c->frames)
      frame = c->frames + (when == AFTER ? 4 * (c->motion.steps - 1) : 0);
  }
  vec3 d = {p.x - m[3], p.y - m[7], p.z - m[11]};
  float at[3];
  for (int axis = 0; axis < 3; axis++)
    at[axis] = m[axis] * d.x + m[4 + axis] * d.y + m[8 + axis] * d.z;
  const int size[2] = {s->width, s->height};
  for (int k = 0; k < 2; k++) {
    float x = c->perspective ? at[k] / -at[2] : at[k];
    out[k] = (x - frame[2 * k]) / (frame[2 * k + 1] - frame[2 * k]) * (float)size[k];
  }
}

void vector_of(const scene *s, const batch *b, size_t i, float out[4]) {
  memset(out, 0, 4 * sizeof *out);
  if (!s->features.motion_vectors || s->camera.panorama)
    return;
  const instance *in = instance_at(s, b, i);
  uint32_t corner[3];
  float u = b->hit->u[i], v = b->hit->v[i], place[3][2];
  const float weight[3] = {1.0f - u - v, u, v};
  world_corners(s, b->hit->record[i], corner);
  for (int when = BEFORE; when <= AFTER; when++)
    pixel_then(s, place_then(s, in, corner, weight, when), when, place[when]);
  for (int k = 0; k < 2; k++) {
    float before = place[BEFORE][k] - place[NOW][k], after = place[NOW][k] - place[AFTER][k];
    out[k] = fabsf(before) < 1e18f ? before : 0.0f; /* false for NaN */
    out[2 + k] = fabsf(after) < 1e18f ? after : 0.0f;
  }
}
