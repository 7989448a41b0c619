/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "texture.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

#include "parallel.h"

enum { BLOCK = 512, ROWS_PER_TASK = 32, SRGB_STEPS = 4096 };

const texture *texture_request(texture_set *set, const image *source, texture_kind kind,
                               float strength) {
  for (size_t i = 0; i < set->count; i++)
    if (set->item[i]->source == source && set->item[i]->kind == kind &&
        set->item[i]->strength == strength)
      return set->item[i];
  texture **item = realloc(set->item, (set->count + 1) * sizeof *item);
  if (!item)
    return NULL;
  set->item = item;
  texture *t = calloc(1, sizeof *t);
  if (!t)
    return NULL;
  *t = (texture){.width = source->width,
                 .height = source->height,
                 .wrap = source->wrap,
                 .linear = source->closest ? 0.0f : 1.0f,
                 .outside = kind == TEXTURE_NORMAL ? 0.0f : -1.0f,
                 .source = source,
                 .kind = kind,
                 .strength = strength};
  item[set->count++] = t;
  return t;
}

void texture_free(texture_set *set) {
  for (size_t i = 0; i < set->count; i++) {
    free(set->item[i]->texel);
    free(set->item[i]);
  }
  free(set->item);
}

/* One channel of a run of texels as float; channels that are missing repeat the first one. */
static void load(const image *m, size_t first, size_t count, int channel, float *restrict out) {
  size_t stride = (size_t)m->channels;
  size_t at = first * stride + (size_t)(m->channels >= 3 ? channel : 0);
  if (m->type == IMAGE_FLOAT32) {
    const float *in = (const float *)m->data + at;
    for (size_t i = 0; i < count; i++)
      out[i] = in[i * stride];
  } else if (m->type == IMAGE_UINT16) {
    const uint16_t *in = (const uint16_t *)m->data + at;
    for (size_t i = 0; i < count; i++)
      out[i] = (float)in[i * stride] * (1.0f / 65535.0f);
  } else {
    const uint8_t *in = (const uint8_t *)m->data + at;
    for (size_t i = 0; i < count; i++)
      out[i] = (float)in[i * stride] * (1.0f / 255.0f);
  }
}

/* Clamp to [low, high]; NaN becomes low. */
static inline float clamp(float x, float low, float high) {
  x = x > low ? x : low;
  return x < high ? x : high;
}

static float srgb_table[SRGB_STEPS + 2];
static pthread_once_t srgb_once = PTHREAD_ONCE_INIT;

static void srgb_table_fill(void) {
  for (int i = 0; i < SRGB_STEPS + 2; i++) {
    double c = (double)i / SRGB_STEPS;
    srgb_table[i] = (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
  }
}

static void srgb_decode(size_t count, float *restrict c) {
  for (size_t i = 0; i < count; i++) {
    float x = clamp(c[i], 0.0f, 1.0f) * SRGB_STEPS;
    int k = (int)x;
    c[i] = srgb_table[k] + (x - (float)k) * (srgb_table[k + 1] - srgb_table[k]);
  }
}

static inline uint32_t pack_pair(float a, float b) {
  int low = (int)(a * 32767.0f + (a < 0.0f ? -0.5f : 0.5f));
  int high = (int)(b * 32767.0f + (b < 0.0f ? -0.5f : 0.5f));
  return ((uint32_t)low & 0xffffu) | (uint32_t)high << 16;
}

/*
 * Tangent-space normal as Cycles' Normal Map node has it: colour to [-1, 1], x and y
 * times the strength, z mixed towards 1 by a strength below 1; then unit length,
 * and z kept positive, since the plane stores x and y only.
 */
static void pack_normal(size_t count, const float *restrict r, const float *restrict g,
                        const float *restrict b, float strength, uint32_t *restrict out) {
  float keep = clamp(strength, 0.0f, 1.0f);
  for (size_t i = 0; i < count; i++) {
    float x = (2.0f * r[i] - 1.0f) * strength;
    float y = (2.0f * g[i] - 1.0f) * strength;
    float z = 1.0f + keep * (2.0f * b[i] - 2.0f);
    z = z > 1e-4f ? z : 1e-4f;
    float length = sqrtf(x * x + y * y + z * z);
    float scale = length < 1e18f ? 1.0f / length : 0.0f; /* NaN and overflow: flat */
    out[i] = length < 1e18f ? pack_pair(x * scale, y * scale) : 0u;
  }
}

static void pack_color(size_t count, const float *restrict a, const float *restrict b,
                       uint32_t *restrict out) {
  for (size_t i = 0; i < count; i++)
    out[i] =
        pack_pair(2.0f * clamp(a[i], 0.0f, 1.0f) - 1.0f, 2.0f * clamp(b[i], 0.0f, 1.0f) - 1.0f);
}

typedef struct pack_task {
  const texture *texture;
  const atomic_bool *cancel;
} pack_task;

static void pack_rows(void *context, size_t task) {
  const pack_task *p = context;
  const texture *t = p->texture;
  const image *m = t->source;
  float channel[3][BLOCK];
  size_t begin = task * ROWS_PER_TASK * (size_t)t->width;
  size_t end = begin + ROWS_PER_TASK * (size_t)t->width;
  size_t all = (size_t)t->width * (size_t)t->height;
  if (end > all)
    end = all;
  if (atomic_load_explicit(p->cancel, memory_order_relaxed))
    return;
  for (size_t at = begin; at < end; at += BLOCK) {
    size_t count = end - at < BLOCK ? end - at : BLOCK;
    int first = t->kind == TEXTURE_BLUE ? 2 : 0;
    int last = t->kind == TEXTURE_RED_GREEN ? 1 : 2;
    for (int c = first; c <= last; c++) {
      load(m, at, count, c, channel[c]);
      if (m->srgb)
        srgb_decode(count, channel[c]);
    }
    if (t->kind == TEXTURE_NORMAL)
      pack_normal(count, channel[0], channel[1], channel[2], t->strength, t->texel + at);
    else if (t->kind == TEXTURE_RED_GREEN)
      pack_color(count, channel[0], channel[1], t->texel + at);
    else
      pack_color(count, channel[2], channel[2], t->texel + at);
  }
}

bool texture_pack(texture_set *set, int threads, const atomic_bool *cancel) {
  pthread_once(&srgb_once, srgb_table_fill);
  for (size_t i = 0; i < set->count; i++) {
    texture *t = set->item[i];
    t->texel = malloc((size_t)t->width * (size_t)t->height * sizeof *t->texel);
    if (!t->texel)
      return false;
    pack_task task = {.texture = t, .cancel = cancel};
    parallel_for(threads, ((size_t)t->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK, pack_rows,
                 &task);
  }
  return true;
}

bool texture_is_8bit(const image *m) {
  if (m->type != IMAGE_FLOAT32)
    return m->type == IMAGE_UINT8;
  const float *data = m->data;
  size_t count = (size_t)m->width * (size_t)m->height * (size_t)m->channels;
  size_t step = count / 4096 + 1;
  for (size_t i = 0; i < count; i += step) {
    float level = data[i] * 255.0f;
    if (!(fabsf(level - rintf(level)) < 1e-3f))
      return false;
  }
  return true;
}
