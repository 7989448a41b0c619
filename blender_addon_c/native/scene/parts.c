/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/parts.h"

#include <math.h>
#include <stdlib.h>

#include "shade/mesh.h"
#include "system/memory.h"
#include "system/parallel.h"

enum { LARGE = 50000 }; /* triangles of a mesh that all threads work at together */

typedef struct preparation {
  const scene *scene;
  const atomic_bool *cancel;
  message_log *log;
  parts *parts;
  const bool *wanted;
} preparation;

void *scene_array(message_log *log, size_t count, size_t size) {
  void *memory = NULL;
  if (count < SIZE_MAX / size - 1) /* 16 more: Embree reads a vertex as four floats */
    memory = memory_aligned(128, (count ? count : 1) * size + 16);
  if (!memory)
    message_error(log, "out of memory");
  return memory;
}

bool parts_usable(const float *p) {
  return fabsf(p[0]) < 1e18f && fabsf(p[1]) < 1e18f && fabsf(p[2]) < 1e18f;
}

/* Corners of p and q opposite to an edge that both share, in opposite directions. */
static bool shared_edge(const uint32_t p[3], const uint32_t q[3], uint8_t turn[2]) {
  for (unsigned i = 0; i < 3; i++)
    for (unsigned j = 0; j < 3; j++)
      if (p[i] == q[(j + 1) % 3] && p[(i + 1) % 3] == q[j]) {
        turn[0] = (uint8_t)((i + 2) % 3);
        turn[1] = (uint8_t)((j + 2) % 3);
        return true;
      }
  return false;
}

static void split(const mesh *m, parts *p) {
  for (size_t t = 0; t < m->triangles; t++) {
    const uint32_t *corner = m->corner_position + 3 * t;
    pair found = {.first = (uint32_t)t};
    bool whole = t + 1 < m->triangles && shared_edge(corner, corner + 3, found.turn);
    for (unsigned k = 0; whole && k < 6; k++) /* a bad corner must not take the good half along */
      whole = parts_usable(m->position + 3 * (size_t)corner[k]);
    if (whole) {
      p->pair[p->pairs++] = found;
      t++;
    } else {
      p->single[p->singles++] = (uint32_t)t;
    }
  }
}

/* Without UVs: the object's X axis where that is possible, else its Y axis. */
static void plain_tangents(const mesh *m, float *tangent) {
  for (size_t c = 0; c < 3 * m->triangles; c++) {
    const float *n = m->corner_normal + 3 * c;
    unsigned axis = fabsf(n[0]) < 0.999f ? 0u : 1u;
    for (unsigned k = 0; k < 3; k++)
      tangent[4 * c + k] = (k == axis ? 1.0f : 0.0f) - n[axis] * n[k];
    tangent[4 * c + 3] = 1.0f;
  }
}

static void each(void *pool, size_t count, void (*work)(void *context, size_t i), void *context) {
  parallel_for(*(const int *)pool, count, work, context);
}

static bool find_tangents(const mesh *m, const float *uv, int threads, float *tangent) {
  return shade_mesh_tangents_by(m->triangles, m->position, m->corner_position, m->corner_normal, uv,
                                tangent, each, &threads) >= 0;
}

/* Tangents of UV maps beside the mesh's own. */
static bool find_layers(const preparation *b, const mesh *m, int threads, parts *p) {
  const scene *s = b->scene;
  if (!s->layers)
    return true;
  p->layer = calloc(s->layers, sizeof *p->layer);
  for (size_t k = 0; p->layer && k < s->layers; k++) {
    int of = s->layer[k].tangents_of;
    if (of < 0 || !m->layer[of])
      continue;
    p->layer[k] = scene_array(b->log, 12 * m->triangles, sizeof **p->layer);
    if (!p->layer[k] || !find_tangents(m, m->layer[of], threads, p->layer[k]))
      return false;
  }
  return p->layer != NULL;
}

static void prepare(const preparation *b, size_t i, int threads) {
  const mesh *m = &b->scene->mesh[i];
  parts *p = &b->parts[i];
  if (atomic_load_explicit(b->cancel, memory_order_relaxed))
    return;
  p->pair = scene_array(b->log, m->triangles / 2, sizeof *p->pair);
  p->single = scene_array(b->log, m->triangles, sizeof *p->single);
  p->tangent = scene_array(b->log, 12 * m->triangles, sizeof *p->tangent);
  if (!p->pair || !p->single || !p->tangent)
    return;
  split(m, p);
  if (!m->corner_uv)
    plain_tangents(m, p->tangent);
  else if (!find_tangents(m, m->corner_uv, threads, p->tangent))
    message_error(b->log, "out of memory");
  if (!find_layers(b, m, threads, p))
    message_error(b->log, "out of memory");
}

static void prepare_small(void *context, size_t i) {
  const preparation *b = context;
  if (b->scene->mesh[i].triangles < LARGE && (!b->wanted || b->wanted[i]))
    prepare(b, i, 1);
}

parts *parts_make(const scene *s, const bool *wanted, const atomic_bool *cancel, message_log *log) {
  preparation b = {.scene = s, .cancel = cancel, .log = log, .wanted = wanted};
  b.parts = calloc(s->meshes + 1, sizeof *b.parts);
  if (!b.parts) {
    message_error(log, "out of memory");
    return NULL;
  }
  for (size_t i = 0; i < s->meshes; i++)
    if (s->mesh[i].triangles >= LARGE && (!wanted || wanted[i]))
      prepare(&b, i, s->threads);
  parallel_for(s->threads, s->meshes, prepare_small, &b);
  if (!log->error[0] && !atomic_load_explicit(cancel, memory_order_relaxed))
    return b.parts;
  parts_free(b.parts, s);
  return NULL;
}

void parts_used(parts *p, const scene *s) {
  for (size_t i = 0; p && i < s->meshes; i++) {
    free(p[i].pair);
    free(p[i].single);
    free(p[i].tangent);
    for (size_t k = 0; p[i].layer && k < s->layers; k++)
      free(p[i].layer[k]);
    free(p[i].layer);
    p[i] = (parts){.pairs = p[i].pairs, .singles = p[i].singles};
  }
}

void parts_free(parts *p, const scene *s) {
  parts_used(p, s);
  free(p);
}
