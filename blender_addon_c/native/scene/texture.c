/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/texture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "system/pages.h"
#include "system/parallel.h"
#include "system/threads.h"

enum { BLOCK = 512, ROWS_PER_TASK = 32, SRGB_STEPS = 4096 };

static bool has_alpha(const image *m) {
  return m->channels % 2 == 0;
}

static texture *add_texture(texture_set *set) {
  texture **item = realloc(set->item, (set->count + 1) * sizeof *item);
  if (!item)
    return NULL;
  set->item = item;
  texture *t = calloc(1, sizeof *t);
  if (t)
    item[set->count++] = t;
  return t;
}

const texture *texture_request(texture_set *set, const image *source, texture_kind kind,
                               float strength, texture_coarse coarse) {
  if (coarse == COARSE_WEIGHTED && !has_alpha(source))
    coarse = COARSE_EVEN;
  for (size_t i = 0; i < set->count; i++) {
    texture *t = set->item[i];
    if (t->source != source || t->kind != kind || t->strength != strength)
      continue;
    if (t->coarse == COARSE_NONE)
      t->coarse = coarse; /* the image itself is the same */
    if (t->coarse == coarse || coarse == COARSE_NONE)
      return t;
  }
  texture *t = add_texture(set);
  if (!t)
    return NULL;
  *t = (texture){.width = source->width,
                 .height = source->height,
                 .stride = source->width + TEXTURE_RIM,
                 .wrap = source->wrap,
                 .linear = source->closest ? 0.0f : 1.0f,
                 .source = source,
                 .kind = kind,
                 .strength = strength,
                 .coarse = coarse};
  return t;
}

static int halved(int size) {
  return size > 1 ? size / 2 : 1;
}

const texture *texture_squares(texture_set *set, const texture *normal) {
  for (size_t i = 0; i < set->count; i++)
    if (set->item[i]->normal == normal)
      return set->item[i];
  texture *t = add_texture(set);
  if (!t)
    return NULL;
  *t = (texture){.width = halved(normal->width),
                 .height = halved(normal->height),
                 .stride = halved(normal->width) + TEXTURE_RIM,
                 .wrap = normal->wrap,
                 .linear = normal->linear,
                 .kind = TEXTURE_SQUARES,
                 .coarse = COARSE_EVEN,
                 .normal = normal};
  return t;
}

static bool same_image(const image *a, const image *b) {
  return a->data == b->data && a->width == b->width && a->height == b->height &&
         a->channels == b->channels && a->type == b->type && a->srgb == b->srgb &&
         a->wrap == b->wrap && a->closest == b->closest;
}

static bool same_request(const texture *a, const texture *b) {
  if (a->kind == TEXTURE_SQUARES || b->kind == TEXTURE_SQUARES)
    return a->kind == b->kind && same_request(a->normal, b->normal);
  return a->kind == b->kind && a->strength == b->strength && a->coarse == b->coarse &&
         same_image(a->source, b->source);
}

void texture_take(texture_set *set, texture_set *before) {
  for (size_t i = 0; i < set->count; i++)
    for (size_t k = 0; k < before->count && !set->item[i]->texel; k++) {
      texture *to = set->item[i], *from = before->item[k];
      if (!from->texel || !same_request(to, from))
        continue;
      to->texel = from->texel;
      to->paged = from->paged;
      to->level = from->level;
      memcpy(to->part, from->part, sizeof to->part);
      to->filled = true;
      from->texel = NULL;
      from->paged = 0;
    }
  texture_free(before);
  *before = (texture_set){0};
}

void texture_free(texture_set *set) {
  for (size_t i = 0; i < set->count; i++) {
    if (set->item[i]->paged)
      pages_free(set->item[i]->texel, set->item[i]->paged);
    else
      free(set->item[i]->texel);
    free(set->item[i]);
  }
  free(set->item);
}

/* One channel of a run of texels as float. Colours that are missing repeat the first one, alpha is
 * the last of two or four channels and 1 else. */
static void load(const image *m, size_t first, size_t count, int channel, float *restrict out) {
  size_t stride = (size_t)m->channels;
  bool alpha = channel == 3;
  if (alpha && !has_alpha(m)) {
    for (size_t i = 0; i < count; i++)
      out[i] = 1.0f;
    return;
  }
  size_t at = first * stride + (alpha ? stride - 1 : m->channels >= 3 ? (size_t)channel : 0);
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

/* What lies beyond the edge of WRAP_CLIP: a flat normal, black without alpha. */
static uint32_t outside(const texture *t) {
  return t->kind == TEXTURE_RED_GREEN || t->kind == TEXTURE_BLUE_ALPHA ? pack_pair(-1.0f, -1.0f)
                                                                       : 0u;
}

/* Where the rim's texel k of an axis comes from; -1: from nowhere. */
static int rim_source(const texture *t, int k, int size) {
  if (t->wrap == WRAP_REPEAT)
    return k < 0 ? size - 1 : k % size;
  if (t->wrap == WRAP_EXTEND || t->wrap == WRAP_MIRROR)
    return k < 0 ? 0 : size - 1;
  return -1;
}

static int level_size(int size, int level) {
  size >>= level;
  return size > 1 ? size : 1;
}
static int level_stride(const texture *t, int level) {
  return level_size(t->width, level) + TEXTURE_RIM;
}

/* Texel (0, y) of a level. */
static uint32_t *level_row(const texture *t, int level, int y) {
  return t->texel + t->level.at[level] + (ptrdiff_t)(y + 1) * level_stride(t, level) + 1;
}

static void pack_rim(const texture *t, int level, int y) {
  uint32_t *row = level_row(t, level, y);
  int width = level_size(t->width, level);
  for (int k = -1; k < width + 2; k = k < 0 ? width : k + 1) {
    int from = rim_source(t, k, width);
    row[k] = from < 0 ? outside(t) : row[from];
  }
}

static void pack_bytes_row(const texture *t, int y) {
  const image *m = t->source;
  uint32_t *row = level_row(t, 0, y);
  size_t step = (size_t)m->channels, green = step >= 3 ? 1 : 0, blue = 2 * green;
  const uint8_t *in = (const uint8_t *)m->data + (size_t)y * (size_t)t->width * step;
  for (int x = 0; x < t->width; x++, in += step) {
    uint32_t alpha = has_alpha(m) ? in[step - 1] : 255u;
    row[x] = in[0] | (uint32_t)in[green] << 8 | (uint32_t)in[blue] << 16 | alpha << 24;
  }
  pack_rim(t, 0, y);
}

/* NaN is 0. */
static void pack_floats_row(const texture *t, int y) {
  uint32_t *row = level_row(t, 0, y);
  size_t width = (size_t)t->width;
  for (size_t x = 0; x < width; x += BLOCK) {
    size_t count = width - x < BLOCK ? width - x : BLOCK;
    float channel[BLOCK];
    load(t->source, (size_t)y * width + x, count, (int)t->kind - TEXTURE_RED, channel);
    for (size_t i = 0; i < count; i++)
      channel[i] = channel[i] == channel[i] ? clamp(channel[i], -1e30f, 1e30f) : 0.0f;
    memcpy(row + x, channel, count * sizeof *row);
  }
  pack_rim(t, 0, y);
}

static bool has_floats(const texture *t) {
  return t->kind >= TEXTURE_RED && t->kind <= TEXTURE_ALPHA;
}

static void pack_row(const texture *t, int y) {
  if (t->kind == TEXTURE_BYTES || has_floats(t)) {
    (has_floats(t) ? pack_floats_row : pack_bytes_row)(t, y);
    return;
  }
  const image *m = t->source;
  uint32_t *row = level_row(t, 0, y);
  float channel[4][BLOCK];
  size_t width = (size_t)t->width;
  int first = t->kind == TEXTURE_BLUE_ALPHA ? 2 : 0;
  int last = t->kind == TEXTURE_BLUE_ALPHA ? 3 : t->kind == TEXTURE_RED_GREEN ? 1 : 2;
  for (size_t x = 0; x < width; x += BLOCK) {
    size_t count = width - x < BLOCK ? width - x : BLOCK;
    for (int c = first; c <= last; c++) {
      load(m, (size_t)y * width + x, count, c, channel[c]);
      if (m->srgb && t->kind == TEXTURE_NORMAL)
        srgb_decode(count, channel[c]);
    }
    if (t->kind == TEXTURE_NORMAL)
      pack_normal(count, channel[0], channel[1], channel[2], t->strength, row + x);
    else if (t->kind == TEXTURE_RED_GREEN)
      pack_color(count, channel[0], channel[1], row + x);
    else
      pack_color(count, channel[2], channel[3], row + x);
  }
  pack_rim(t, 0, y);
}

static void pack_rim_rows(const texture *t, int level) {
  size_t stride = (size_t)level_stride(t, level);
  int height = level_size(t->height, level);
  for (int k = -1; k < height + 2; k = k < 0 ? height : k + 1) {
    int from = rim_source(t, k, height);
    uint32_t *row = level_row(t, level, k) - 1;
    if (from >= 0)
      memcpy(row, level_row(t, level, from) - 1, stride * sizeof *row);
    else
      for (size_t x = 0; x < stride; x++)
        row[x] = outside(t);
  }
}

/* Of an axis's texel k, which finer ones it covers, and how much of the first and of the last. */
typedef struct cover {
  int first, last;
  float begin, end;
} cover;

static cover cover_of(int k, int size, int finer) {
  double begin = (double)k * finer / size, end = (double)(k + 1) * finer / size;
  int first = (int)begin, last = (int)ceil(end) - 1;
  last = last < finer ? last : finer - 1;
  return (cover){first, last, (float)(fmin(first + 1, end) - begin),
                 last > first ? (float)(end - last) : 0.0f};
}

static float cover_weight(const cover *c, int k) {
  return k == c->first ? c->begin : k == c->last ? c->end : 1.0f;
}

static float first_of(uint32_t pair) {
  return (float)(int16_t)(pair & 0xffffu) * (1.0f / 32767.0f);
}
static float second_of(uint32_t pair) {
  return (float)(int16_t)(pair >> 16) * (1.0f / 32767.0f);
}

/* Sizes that halve, of texels that count alike. */
static void pack_halved_row(const texture *t, int level, int y) {
  const uint32_t *low = level_row(t, level - 1, 2 * y), *high = level_row(t, level - 1, 2 * y + 1);
  uint32_t *row = level_row(t, level, y);
  int width = level_size(t->width, level);
  for (int x = 0; x < width; x++) {
    uint32_t p = low[2 * x], q = low[2 * x + 1], r = high[2 * x], s = high[2 * x + 1];
    int a = (int16_t)p + (int16_t)q + (int16_t)r + (int16_t)s;
    int b = ((int32_t)p >> 16) + ((int32_t)q >> 16) + ((int32_t)r >> 16) + ((int32_t)s >> 16);
    row[x] = ((uint32_t)((a + 2) >> 2) & 0xffffu) | (uint32_t)((b + 2) >> 2) << 16;
  }
  pack_rim(t, level, y);
}

/* Light of bytes, and the last of them of which the light is no more than this (of 4095 steps to
 * begin at). */
static float byte_light[2][257];
static uint8_t byte_below[2][4097];

static void byte_tables_fill(void) {
  srgb_table_fill();
  for (int srgb = 0; srgb < 2; srgb++) {
    for (int k = 0; k < 256; k++)
      byte_light[srgb][k] = (float)k * (1.0f / 255.0f);
    if (srgb)
      for (int k = 0; k < 256; k++) {
        double c = k / 255.0;
        byte_light[srgb][k] = (float)(c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4));
      }
    byte_light[srgb][256] = 2.0f;
    for (int i = 0, k = 0; i < 4097; i++) {
      while (k < 255 && byte_light[srgb][k + 1] <= (float)i * (1.0f / 4096.0f))
        k++;
      byte_below[srgb][i] = (uint8_t)k;
    }
  }
}

/* One of the two bytes about a light, by `random number`, so that the mean of many is this light.
 */
static uint32_t byte_of(bool srgb, float light, float random) {
  const float *table = byte_light[srgb];
  light = clamp(light, 0.0f, 1.0f);
  int k = byte_below[srgb][(int)(light * 4096.0f)];
  while (table[k + 1] <= light)
    k++;
  return (uint32_t)k + (k < 255 && light - table[k] > random * (table[k + 1] - table[k]) ? 1u : 0u);
}

static uint32_t mixed(uint32_t h) {
  h = (h ^ h >> 16) * 0x7feb352du;
  h = (h ^ h >> 15) * 0x846ca68bu;
  return h ^ h >> 16;
}

/* Means of light, of alpha, and by alpha of light where t is weighted. */
static void pack_coarse_bytes_row(const texture *t, int level, int y) {
  int finer_width = level_size(t->width, level - 1),
      finer_height = level_size(t->height, level - 1);
  int width = level_size(t->width, level), height = level_size(t->height, level);
  uint32_t *row = level_row(t, level, y);
  const float *light = byte_light[t->source->srgb];
  const bool weighted = t->coarse == COARSE_WEIGHTED;
  cover down = cover_of(y, height, finer_height);
  for (int x = 0; x < width; x++) {
    cover along = cover_of(x, width, finer_width);
    float even[4] = {0, 0, 0, 0}, by_alpha[3] = {0, 0, 0}, sum = 0;
    for (int j = down.first; j <= down.last; j++) {
      const uint32_t *from = level_row(t, level - 1, j);
      for (int i = along.first; i <= along.last; i++) {
        float share = cover_weight(&down, j) * cover_weight(&along, i);
        float alpha = share * (float)(from[i] >> 24);
        for (int c = 0; c < 3; c++) {
          float part = light[from[i] >> 8 * c & 255u];
          even[c] += share * part;
          by_alpha[c] += alpha * part;
        }
        even[3] += alpha;
        sum += share;
      }
    }
    bool counts = weighted && even[3] > 1e-4f;
    uint32_t texel = 0, seed = mixed((uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^
                                     (uint32_t)level * 83492791u);
    for (int c = 0; c < 4; c++) {
      float random = ((float)(seed >> 8 * c & 255u) + 0.5f) * (1.0f / 256.0f);
      float part = c == 3   ? even[3] / (255.0f * sum)
                   : counts ? by_alpha[c] / even[3]
                            : even[c] / sum;
      texel |= byte_of(c < 3 && t->source->srgb, part, random) << 8 * c;
    }
    row[x] = texel;
  }
  pack_rim(t, level, y);
}

/* sRGB of a light, to the last of 16 bits. */
static float srgb_of(float light) {
  return light <= 0.0031308f ? 12.92f * light : 1.055f * powf(light, 1.0f / 2.4f) - 0.055f;
}

/* Which of a pair's two numbers are sRGB. */
static void encoded_of(const texture *t, bool out[2]) {
  out[0] = (t->kind == TEXTURE_RED_GREEN || t->kind == TEXTURE_BLUE_ALPHA) && t->source->srgb;
  out[1] = out[0] && t->kind == TEXTURE_RED_GREEN;
}

/* What is averaged of a number of a pair: light. */
static float light_in(bool encoded, float x) {
  if (!encoded)
    return x;
  float c = 0.5f + 0.5f * x;
  srgb_decode(1, &c);
  return 2.0f * c - 1.0f;
}

static float light_out(bool encoded, float x) {
  x = clamp(x, -1.0f, 1.0f);
  return encoded ? 2.0f * srgb_of(0.5f + 0.5f * x) - 1.0f : x;
}

/* A row of a coarser level; alpha: the texture whose second number says how much each texel counts,
 * or NULL. Where nothing counts they count alike. */
static void pack_coarse_row(const texture *t, const texture *alpha, int level, int y) {
  if (t->kind == TEXTURE_BYTES) {
    pack_coarse_bytes_row(t, level, y);
    return;
  }
  int finer_width = level_size(t->width, level - 1),
      finer_height = level_size(t->height, level - 1);
  int width = level_size(t->width, level), height = level_size(t->height, level);
  bool encoded[2];
  encoded_of(t, encoded);
  if (!alpha && !encoded[0] && finer_width == 2 * width && finer_height == 2 * height) {
    pack_halved_row(t, level, y);
    return;
  }
  uint32_t *row = level_row(t, level, y);
  cover down = cover_of(y, height, finer_height);
  for (int x = 0; x < width; x++) {
    cover along = cover_of(x, width, finer_width);
    float a = 0, b = 0, sum = 0, wa = 0, wb = 0, weights = 0;
    for (int j = down.first; j <= down.last; j++) {
      const uint32_t *from = level_row(t, level - 1, j);
      const uint32_t *by = alpha ? level_row(alpha, level - 1, j) : NULL;
      for (int i = along.first; i <= along.last; i++) {
        float share = cover_weight(&down, j) * cover_weight(&along, i);
        float weight = by ? share * (0.5f + 0.5f * second_of(by[i])) : share;
        float one = light_in(encoded[0], first_of(from[i]));
        float two = light_in(encoded[1], second_of(from[i]));
        a += share * one;
        b += share * two;
        wa += weight * one;
        wb += weight * two;
        sum += share;
        weights += weight;
      }
    }
    bool counts = weights > 1e-6f, own = alpha == t; /* alpha itself is a plain mean */
    float scale = 1.0f / (counts ? weights : sum);
    row[x] = pack_pair(light_out(encoded[0], (counts ? wa : a) * scale),
                       light_out(encoded[1], own ? b / sum : (counts ? wb : b) * scale));
  }
  pack_rim(t, level, y);
}

/* Of squares those of the normals that a texel covers. */
static void pack_squares_row(const texture *t, int y) {
  const texture *from = t->normal;
  cover down = cover_of(y, t->height, from->height);
  uint32_t *row = level_row(t, 0, y);
  for (int x = 0; x < t->width; x++) {
    cover along = cover_of(x, t->width, from->width);
    float a = 0, b = 0, sum = 0;
    for (int j = down.first; j <= down.last; j++) {
      const uint32_t *normal = level_row(from, 0, j);
      for (int i = along.first; i <= along.last; i++) {
        float share = cover_weight(&down, j) * cover_weight(&along, i);
        a += share * first_of(normal[i]) * first_of(normal[i]);
        b += share * second_of(normal[i]) * second_of(normal[i]);
        sum += share;
      }
    }
    row[x] = pack_pair(clamp(a / sum, 0.0f, 1.0f), clamp(b / sum, 0.0f, 1.0f));
  }
  pack_rim(t, 0, y);
}

/* Where each level begins; no more than fit into an int. Returns the texels of all. */
static size_t find_levels(texture *t) {
  texture_levels *l = &t->level;
  size_t texels = 0;
  *l = (texture_levels){.width = (float)t->width, .height = (float)t->height};
  do {
    size_t width = (size_t)level_size(t->width, l->count);
    size_t height = (size_t)level_size(t->height, l->count);
    size_t more = (width + TEXTURE_RIM) * (height + TEXTURE_RIM);
    if (l->count && texels + more > INT32_MAX)
      break;
    l->at[l->count++] = (int)texels;
    texels += more;
    if (width == 1 && height == 1)
      break;
  } while (t->coarse != COARSE_NONE && l->count < TEXTURE_LEVELS);
  return texels;
}

typedef struct pack_task {
  const texture *texture, *alpha;
  int level, height;
  const atomic_bool *cancel;
} pack_task;

static void pack_rows(void *context, size_t task) {
  const pack_task *p = context;
  int y = (int)task * ROWS_PER_TASK, end = y + ROWS_PER_TASK;
  for (; y < end && y < p->height; y++)
    if (atomic_load_explicit(p->cancel, memory_order_relaxed))
      return;
    else if (!p->level && p->texture->kind == TEXTURE_SQUARES)
      pack_squares_row(p->texture, y);
    else if (p->level)
      pack_coarse_row(p->texture, p->alpha, p->level, y);
    else
      pack_row(p->texture, y);
}

static void pack_level(const texture *t, const texture *alpha, int level, int threads,
                       const atomic_bool *cancel) {
  pack_task task = {.texture = t,
                    .alpha = alpha,
                    .level = level,
                    .height = level_size(t->height, level),
                    .cancel = cancel};
  parallel_for(threads, ((size_t)task.height + ROWS_PER_TASK - 1) / ROWS_PER_TASK, pack_rows,
               &task);
  pack_rim_rows(t, level);
  if (t->paged)
    pages_leave(t->texel, t->paged);
}

/* Sums of products of a level's texels: with themselves, and with those beside, above and across,
 * as a mean over all places between texels needs them. Integers: the same by any threads. */
typedef struct square_task {
  const texture *texture;
  int level, height, step;
  atomic_llong sum[2][3];
} square_task;

static void sum_squares(void *context, size_t task) {
  square_task *p = context;
  const texture *t = p->texture;
  int y = (int)task * ROWS_PER_TASK, end = y + ROWS_PER_TASK,
      width = level_size(t->width, p->level);
  long long sum[2][3] = {{0}};
  for (; y < end && y < p->height; y++) {
    if (y % p->step)
      continue;
    const uint32_t *low = level_row(t, p->level, y), *high = level_row(t, p->level, y + 1);
    for (int shift = 0; shift < 32; shift += 16)
      for (int x = 0; x < width; x++) {
        int a = (int16_t)(low[x] >> shift), b = (int16_t)(low[x + 1] >> shift);
        int c = (int16_t)(high[x] >> shift), d = (int16_t)(high[x + 1] >> shift);
        sum[shift / 16][0] += a * a;
        sum[shift / 16][1] += (long long)a * b + (long long)a * c;
        sum[shift / 16][2] += (long long)a * d + (long long)b * c;
      }
  }
  for (int k = 0; k < 6; k++)
    atomic_fetch_add_explicit(&p->sum[k / 3][k % 3], sum[k / 3][k % 3], memory_order_relaxed);
}

/* Means of the squares of a level: of its texels, and of what look-ups between them give. */
static void mean_squares(const texture *t, int level, int threads, double texels[2],
                         double between[2]) {
  int height = level_size(t->height, level), step = height / 1024 > 1 ? height / 1024 : 1;
  square_task task = {.texture = t, .level = level, .height = height, .step = step};
  parallel_for(threads, ((size_t)height + ROWS_PER_TASK - 1) / ROWS_PER_TASK, sum_squares, &task);
  double count =
      (double)level_size(t->width, level) * ((height + step - 1) / step) * 32767.0 * 32767.0;
  for (int k = 0; k < 2; k++) {
    double own = (double)task.sum[k][0], beside = (double)task.sum[k][1];
    texels[k] = own / count;
    between[k] = (own * 4 / 9 + beside * 2 / 9 + (double)task.sum[k][2] / 18) / count;
  }
}

static void find_parts(texture *t, int threads) {
  double own[2], between[TEXTURE_LEVELS][2], texels[2];
  int last = t->level.count - 1;
  for (int level = 0; level <= last; level++)
    mean_squares(t, level, threads, level ? texels : own, between[level]);
  for (int level = 0; level <= last; level++)
    for (int k = 0; k < 2; k++) {
      int wider = level + TEXTURE_WIDER < last ? level + TEXTURE_WIDER : last;
      double left = between[0][k] - between[level][k], all = own[k] - between[wider][k];
      t->part[k][level] = all > 1e-9 && left > 0 ? (float)fmin(left / all, 1.0) : 0.0f;
    }
}

/* The texture that has the alpha of a weighted one. */
static const texture *alpha_of(const texture_set *set, const texture *t) {
  for (size_t i = 0; t->coarse == COARSE_WEIGHTED && i < set->count; i++)
    if (set->item[i]->source == t->source && set->item[i]->kind == TEXTURE_BLUE_ALPHA &&
        set->item[i]->coarse == COARSE_WEIGHTED)
      return set->item[i];
  return NULL;
}

/* What was read for the texture may go. */
static void leave_source(const image *m) {
  size_t size = m->type == IMAGE_FLOAT32 ? 4 : m->type == IMAGE_UINT16 ? 2 : 1;
  void *data;
  memcpy(&data, &m->data, sizeof data);
  pages_leave(data, (size_t)m->width * (size_t)m->height * (size_t)m->channels * size);
}

static void leave_all(const texture_set *set) {
  for (size_t i = 0; i < set->count; i++)
    if (set->item[i]->paged)
      pages_leave(set->item[i]->texel, set->item[i]->paged);
}

void texture_relieve(const texture_set *set, size_t most) {
  if (set->paged <= most)
    return;
  size_t now = pages_resident();
  if (now > set->other && now - set->other > most)
    leave_all(set);
}

bool texture_pack(texture_set *set, int threads, const atomic_bool *cancel) {
  pthread_once(&srgb_once, byte_tables_fill);
  for (size_t i = 0; i < set->count; i++) {
    texture *t = set->item[i];
    if (t->filled)
      continue;
    size_t bytes = find_levels(t) * sizeof *t->texel;
    t->texel = pages_new(bytes);
    t->paged = t->texel ? bytes : 0;
    if (!t->texel)
      t->texel = malloc(bytes);
    if (!t->texel)
      return false;
    pack_level(t, NULL, 0, threads, cancel);
    if (t->source && t->source->paged)
      leave_source(t->source);
  }
  for (int level = 1; level < TEXTURE_LEVELS; level++)
    for (size_t i = 0; i < set->count; i++) {
      const texture *t = set->item[i];
      if (!t->filled && level < t->level.count)
        pack_level(t, alpha_of(set, t), level, threads, cancel);
    }
  for (size_t i = 0; i < set->count && !atomic_load_explicit(cancel, memory_order_relaxed); i++)
    if (!set->item[i]->filled && set->item[i]->kind == TEXTURE_NORMAL &&
        set->item[i]->level.count > 1)
      find_parts(set->item[i], threads);
  set->paged = 0;
  for (size_t i = 0; i < set->count; i++)
    set->paged += set->item[i]->paged;
  leave_all(set);
  set->other = pages_resident();
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

void image_row(const image *source, int y, int channel, float *out) {
  size_t width = (size_t)source->width;
  load(source, (size_t)y * width, width, channel, out);
  if (source->srgb) {
    pthread_once(&srgb_once, byte_tables_fill);
    srgb_decode(width, out);
  }
}
