/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/tile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "batch/leaf.h"
#include "render/bounce.h"
#include "scene/texture.h"
#include "system/parallel.h"
#include "system/threads.h"

static bool cancelled(const render *r) {
  return atomic_load_explicit(r->cancel, memory_order_relaxed);
}

static size_t region_width(const render *r) {
  return (size_t)(r->region[2] - r->region[0]);
}

/* Number of a pixel of the region. */
static size_t place_of(const render *r, int x, int y) {
  return (size_t)(y - r->region[1]) * region_width(r) + (size_t)(x - r->region[0]);
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

static bool is_inside(const render *r, int x, int y) {
  return x >= r->region[0] && y >= r->region[1] && x < r->region[2] && y < r->region[3];
}

/* The tile's numbers, `channels` a pixel, into those of the picture; `mattes` are merged. */
static void add_pixels(const render *r, const camera_view *view, size_t channels,
                       const matte_layout *mattes, const float *restrict pixels,
                       float *restrict sum) {
  const uint32_t count = (uint32_t)(r->side * r->side);
  const bool whole =
      is_inside(r, view->x, view->y) && is_inside(r, view->x + r->side - 1, view->y + r->side - 1);
  const uint32_t step = whole && !mattes ? 2 : 1; /* of two pixels the second is the next in x */
  for (uint32_t p = 0; p < count; p += step) {
    int x, y;
    pixel_place(view, p, &x, &y);
    if (!whole && !is_inside(r, x, y))
      continue;
    float *out = sum + channels * place_of(r, x, y);
    const float *in = pixels + channels * p;
    if (mattes)
      matte_merge(mattes, in, out);
    for (size_t c = 0; !mattes && c < channels * step; c++)
      out[c] += in[c];
  }
}

_Static_assert(TILE_SIDE *TILE_SIDE == ADAPTIVE_BLOCKS * ADAPTIVE_PIXELS, "blocks fill a tile");

/* Whether a block is done, by the errors of its pixels in the picture: the mean of their squares.
 */
static bool judge(const render *r, const camera_view *view, uint32_t number, size_t block) {
  const adaptive *a = &r->adaptive;
  size_t half, samples = adaptive_samples(a, r->plan, block, &half);
  double squares = 0;
  uint32_t pixels = 0;
  if (samples < a->least || !half)
    return false;
  for (uint32_t p = number * ADAPTIVE_PIXELS; p < (number + 1) * ADAPTIVE_PIXELS; p++) {
    int x, y;
    pixel_place(view, p, &x, &y);
    if (!is_inside(r, x, y))
      continue;
    size_t at = place_of(r, x, y);
    double error = (double)adaptive_error(r->sum + 4 * at, a->half + 3 * at, samples, half);
    squares += error * error;
    pixels++;
  }
  double most = (double)a->threshold;
  return squares <= most * most * pixels; /* false for NaN */
}

/* After a pass: what its blocks have now, and which of them are done. */
static void judge_all(render *r, const camera_view *view, size_t tile) {
  adaptive *a = &r->adaptive;
  for (uint32_t number = 0; number < ADAPTIVE_BLOCKS; number++) {
    size_t block = tile * ADAPTIVE_BLOCKS + number;
    if (a->done[block]) {
      atomic_fetch_add_explicit(&r->spared, (size_t)view->samples * ADAPTIVE_PIXELS,
                                memory_order_relaxed);
      continue;
    }
    a->passes[block]++;
    a->done[block] = judge(r, view, number, block);
  }
}

/* The samples of blocks begin to end; false when cancelled. */
static bool render_blocks(const render *r, worker *w, camera_view *view, size_t begin, size_t end,
                          float *pixels) {
  size_t lanes = (size_t)view->samples * ADAPTIVE_PIXELS;
  for (size_t first = begin * lanes; first < end * lanes; first += BATCH) {
    if (cancelled(r))
      return false;
    view->first = (uint32_t)first;
    bounce_batch(w, view, end * lanes - first < BATCH ? end * lanes - first : BATCH, pixels);
  }
  return true;
}

static void render_tile(render *r, worker *w, size_t tile) {
  float pixels[4 * TILE_SIDE * TILE_SIDE] = {0}, half[3 * TILE_SIDE * TILE_SIDE] = {0},
                               numbers[PLANE_CHANNELS_MAX * TILE_SIDE * TILE_SIDE];
  const scene *s = r->scene;
  size_t samples = w->sampling->period;
  const uint8_t *done = r->adaptive.done ? r->adaptive.done + tile * ADAPTIVE_BLOCKS : NULL;
  camera_view view = {.camera = &s->camera,
                      .x = r->origin[0] + (int)(tile % r->columns) * r->side,
                      .y = r->origin[1] + (int)(tile / r->columns) * r->side,
                      .samples = (uint32_t)samples,
                      .per_sample = 1.0f / (float)samples,
                      .step = {(s->camera.frame[1] - s->camera.frame[0]) / (float)s->width,
                               (s->camera.frame[3] - s->camera.frame[2]) / (float)s->height},
                      .seed = s->seed,
                      .scramble = w->sampling->scramble,
                      .warp = w->sampling->warp};
  memcpy(view.region, r->region, sizeof view.region);
  size_t channels = (size_t)r->planes.channels;
  if (r->numbers) {
    memset(numbers, 0, channels * TILE_SIDE * TILE_SIDE * sizeof *numbers);
    w->numbers = numbers;
  }
  if (w->matte)
    memset(w->matte, 0, r->mattes.all * TILE_SIDE * TILE_SIDE * sizeof *w->matte);
  w->half = done ? half : NULL;
  w->cloth.mixed = r->mixed[tile]; /* whichever worker it was: order changes bits */
  for (size_t begin = 0, end; begin < ADAPTIVE_BLOCKS; begin = end) {
    bool left_out = done && done[begin];
    for (end = begin + 1; end < ADAPTIVE_BLOCKS && (done && done[end]) == left_out;)
      end++;
    if (!left_out && !render_blocks(r, w, &view, begin, end, pixels))
      return;
  }
  if (cancelled(r))
    return;
  r->mixed[tile] = w->cloth.mixed;
  pthread_mutex_lock(&r->film);
  if (r->sum)
    add_pixels(r, &view, 4, NULL, pixels, r->sum);
  if (r->numbers)
    add_pixels(r, &view, channels, NULL, numbers, r->numbers);
  if (w->matte)
    add_pixels(r, &view, r->mattes.all, &r->mattes, w->matte, r->matte);
  if (done) {
    add_pixels(r, &view, 3, NULL, half, r->adaptive.half);
    judge_all(r, &view, tile);
  }
  atomic_fetch_add_explicit(&r->done[tile], 1, memory_order_release);
  pthread_mutex_unlock(&r->film);
  atomic_fetch_add_explicit(&r->finished, samples, memory_order_relaxed);
}

/* Whether a tile of this pass shall still be rendered. */
static bool goes_on(const render *r, size_t pass) {
  return !cancelled(r) &&
         !(pass > 0 && r->time_limit > 0.0 && parallel_clock() - r->start > r->time_limit);
}

static void work(void *context, size_t number) {
  (void)number;
  render *r = context;
  worker w = {
      .scene = r->scene, .observer = r->observer, .cancel = r->cancel, .planes = &r->planes};
  if (r->matte) {
    w.mattes = &r->mattes;
    w.matte = malloc(r->mattes.all * TILE_SIDE * TILE_SIDE * sizeof *w.matte);
  }
  if ((!r->matte || w.matte) && worker_init(&w)) {
    for (;;) {
      size_t next = atomic_fetch_add_explicit(&r->next, 1, memory_order_relaxed);
      size_t pass = next / r->tiles, tile = next % r->tiles;
      if (pass >= r->plan->passes || !goes_on(r, pass))
        break;
      /* a tile's passes are added up in their order: sums of floats depend on it */
      while (atomic_load_explicit(&r->done[tile], memory_order_acquire) < pass && goes_on(r, pass))
        threads_yield();
      if (atomic_load_explicit(&r->done[tile], memory_order_acquire) < pass)
        break;
      w.sampling = &r->plan->pass[pass];
      w.first_pass = pass == 0 && r->plan->first == 0;
      texture_relieve(&r->scene->textures, TEXTURE_RESIDENT);
      render_tile(r, &w, tile);
    }
  } else {
    message_error(r->log, "out of memory");
  }
  worker_free(&w);
  free(w.matte);
  pthread_mutex_lock(&r->lock);
  r->status |= w.status;
  for (int k = 0; k < CLOCKS; k++)
    r->seconds[k] += w.clocks.seconds[k];
  pthread_mutex_unlock(&r->lock);
}

bool render_prepare(render *r) {
  r->side = TILE_SIDE;
  size_t count[2];
  for (int k = 0; k < 2; k++) {
    r->origin[k] = r->region[k] / r->side * r->side;
    count[k] = (size_t)((r->region[k + 2] - r->origin[k] + r->side - 1) / r->side);
  }
  r->columns = count[0];
  r->tiles = count[0] * count[1];
  pthread_mutex_init(&r->lock, NULL);
  pthread_mutex_init(&r->film, NULL);
  r->done = calloc(r->tiles + 1, sizeof *r->done);
  r->mixed = calloc(r->tiles + 1, sizeof *r->mixed);
  return r->done && r->mixed;
}

bool render_run(render *r) {
  size_t threads = (size_t)r->scene->threads;
  r->start = parallel_clock();
  parallel_for((int)threads, threads < r->tiles ? threads : r->tiles, work, r);
  return !cancelled(r) && !r->log->error[0];
}

double render_progress(const render *r) {
  size_t samples = 0;
  for (size_t k = 0; k < r->plan->passes; k++)
    samples += r->plan->pass[k].period;
  size_t all = r->tiles * samples;
  return all ? (double)atomic_load(&r->finished) / (double)all : 1.0;
}

/* The background as the camera sees it, no brighter than lights may be. */
static void find_backdrop(const scene *s, float out[3]) {
  const float *even = s->backdrop, most = s->clamp_direct;
  float mean = (even[0] + even[1] + even[2]) * (1.0f / 3.0f);
  float factor = s->features.transparent_film ? 0.0f : 1.0f;
  factor *= most > 0.0f && mean > most ? most / mean : 1.0f;
  for (int k = 0; k < 3; k++)
    out[k] = factor > 0.0f ? factor * even[k] : 0.0f;
}

/* A row's means; the background behind it. */
static void copy_row(const scene *s, size_t count, float scale, const float *restrict sum,
                     float *restrict out) {
  float behind[3];
  find_backdrop(s, behind);
  for (size_t i = 0; i < count; i++, sum += 4, out += 4) {
    float alpha = sum[3] * scale;
    for (unsigned c = 0; c < 3; c++)
      out[c] = sum[c] * scale + (1.0f - alpha) * behind[c];
    out[3] = s->features.transparent_film ? clampf(alpha, 0.0f, 1.0f) : 1.0f;
  }
}

/* Where a tile lies in the picture, and how many samples its pixels have. */
typedef struct patch {
  int low[2], high[2];
  size_t samples;
} patch;

static patch patch_of(const render *r, size_t tile) {
  patch p = {.samples = 0};
  tile_bounds(r, tile, p.low, p.high);
  size_t passes = atomic_load_explicit(&r->done[tile], memory_order_acquire);
  for (size_t k = 0; k < passes; k++)
    p.samples += r->plan->pass[k].period;
  return p;
}

/* By a colour; where a channel of that is 0 the others' mean, as Cycles has it: there is no light
 * to tell of, and a grey one stays grey. */
static void divide(float *value, const float *color) {
  float sum = 0.0f, parts = 0.0f;
  for (int c = 0; c < 3; c++) {
    bool good = color[c] != 0.0f;
    value[c] = good ? value[c] / color[c] : 0.0f;
    sum += value[c];
    parts += good ? 1.0f : 0.0f;
  }
  for (int c = 0; c < 3 && parts > 0.0f; c++)
    value[c] = color[c] != 0.0f ? value[c] : sum / parts;
}

/* One over the samples of a pixel. */
static float scale_of(const render *r, const patch *p, size_t tile, int x, int y) {
  size_t half, samples = p->samples;
  if (r->adaptive.done)
    samples = adaptive_samples(&r->adaptive, r->plan,
                               adaptive_block(tile, x - r->origin[0], y - r->origin[1]), &half);
  return samples ? 1.0f / (float)samples : 0.0f;
}

/* Alpha of a row that something held out is in, before a background. */
static void leave_holes(const render *r, const patch *p, size_t tile, int y, float *out) {
  for (int x = p->low[0]; x < p->high[0]; x++) {
    size_t at = place_of(r, x, y);
    float held = r->numbers[(size_t)r->planes.channels * at + (size_t)r->planes.at[PLANE_HELD]];
    out[4 * at + 3] = fmaxf(1.0f - held * scale_of(r, p, tile, x, y), 0.0f);
  }
}

void render_copy(render *r, float *out) {
  pthread_mutex_lock(&r->film);
  const float *whole = r->whole;
  pthread_mutex_unlock(&r->film);
  if (whole) {
    size_t pixels = region_width(r) * (size_t)(r->region[3] - r->region[1]);
    memcpy(out, whole, 4 * pixels * sizeof *out);
  } else {
    render_copy_noisy(r, out);
  }
}

static void copy_tiles(render *r, bool clear, float *out) {
  for (size_t tile = 0; tile < r->tiles; tile++) {
    pthread_mutex_lock(&r->film);
    patch p = patch_of(r, tile);
    size_t count = (size_t)(p.high[0] - p.low[0]);
    for (int y = p.low[1]; y < p.high[1]; y++) {
      size_t at = 4 * place_of(r, p.low[0], y);
      if (p.samples && r->adaptive.done)
        for (size_t i = 0; i < count; i++)
          copy_row(r->scene, 1, scale_of(r, &p, tile, p.low[0] + (int)i, y), r->sum + at + 4 * i,
                   out + at + 4 * i);
      else if (p.samples)
        copy_row(r->scene, count, 1.0f / (float)p.samples, r->sum + at, out + at);
      else if (clear)
        memset(out + at, 0, 4 * count * sizeof *out);
      if (p.samples && r->planes.wanted >> PLANE_HELD & 1u)
        leave_holes(r, &p, tile, y, out);
    }
    pthread_mutex_unlock(&r->film);
  }
}

void render_copy_noisy(render *r, float *out) {
  copy_tiles(r, true, out);
}

void render_copy_over(render *r, float *out) {
  copy_tiles(r, false, out);
}

void render_copy_plane(render *r, plane_type plane, float *out) {
  size_t channels = (size_t)plane_channels(plane), stride = (size_t)r->planes.channels;
  plane_type divisor = plane_divisor(plane);
  for (size_t tile = 0; tile < r->tiles; tile++) {
    pthread_mutex_lock(&r->film);
    patch p = patch_of(r, tile);
    for (int y = p.low[1]; y < p.high[1]; y++)
      for (int x = p.low[0]; x < p.high[0]; x++) {
        size_t at = place_of(r, x, y);
        const float *from = r->numbers + stride * at + r->planes.at[plane];
        float scale = plane_is_filtered(plane) ? scale_of(r, &p, tile, x, y) : 1.0f;
        float by = divisor != PLANES ? 1.0f : scale; /* the colour is a sum as well */
        if (plane == PLANE_VECTOR) {
          float hits = r->numbers[stride * at + (size_t)r->planes.at[PLANE_VECTOR_HITS]];
          by = hits > 0.0f ? 1.0f / hits : 0.0f;
        }
        for (size_t c = 0; c < channels; c++)
          out[channels * at + c] = from[c] * by;
        if (plane == PLANE_SAMPLES) {
          float part = scale_of(r, &p, tile, x, y) * (float)r->plan->samples;
          out[at] = part > 0.0f ? 1.0f / part : 0.0f;
        }
        if (plane == PLANE_DEPTH && !(from[0] > 0.0f))
          out[at] = PLANE_FAR;
        if (plane == PLANE_MIST) {
          float left = 1.0f - out[at];
          out[at] = left > 0.0f ? left : 0.0f;
        }
        if (divisor != PLANES)
          divide(out + channels * at, r->numbers + stride * at + r->planes.at[divisor]);
      }
    pthread_mutex_unlock(&r->film);
  }
}

/* Of a layer of names, 4 floats a pixel. */
static void copy_matte(render *r, matte_kind kind, size_t layer, float *out) {
  for (size_t tile = 0; tile < r->tiles; tile++) {
    pthread_mutex_lock(&r->film);
    patch p = patch_of(r, tile);
    for (int y = p.low[1]; y < p.high[1]; y++)
      for (int x = p.low[0]; x < p.high[0]; x++) {
        size_t at = place_of(r, x, y);
        matte_layer(&r->mattes, r->matte + r->mattes.all * at, kind, layer,
                    scale_of(r, &p, tile, x, y), out + 4 * at);
      }
    pthread_mutex_unlock(&r->film);
  }
}

/* Of KIND_MATTE and a layer's two digits, as far as it is rendered. */
static bool find_matte(const render *r, const char *word, matte_kind *kind, size_t *layer) {
  for (int k = 0; k < MATTE_KINDS; k++) {
    char begin[32];
    snprintf(begin, sizeof begin, "%s_MATTE", matte_word((matte_kind)k));
    size_t length = strlen(begin);
    if (strncmp(word, begin, length) != 0 || strlen(word) != length + 2 ||
        strspn(word + length, "0123456789") != 2)
      continue;
    *kind = (matte_kind)k;
    *layer = (size_t)((word[length] - '0') * 10 + word[length + 1] - '0');
    return r->matte && r->mattes.wanted >> k & 1u && 2 * *layer < r->mattes.slots;
  }
  return false;
}

/* The plane of that word, or PLANES. */
static plane_type find_plane(const char *word) {
  int k = 0;
  while (k < PLANES && strcmp(word, plane_word((plane_type)k)) != 0)
    k++;
  return (plane_type)k;
}

static const char noisy[] = "NOISY";

int render_channels(const render *r, const char *word) {
  matte_kind kind;
  size_t layer;
  plane_type plane = find_plane(word);
  if (plane != PLANES)
    return r->planes.wanted >> plane & 1u ? plane_channels(plane) : 0;
  return !*word || strcmp(word, noisy) == 0 || find_matte(r, word, &kind, &layer) ? 4 : 0;
}

void render_copy_word(render *r, const char *word, float *out) {
  matte_kind kind;
  size_t layer;
  plane_type plane = find_plane(word);
  if (plane != PLANES)
    render_copy_plane(r, plane, out);
  else if (find_matte(r, word, &kind, &layer))
    copy_matte(r, kind, layer, out);
  else if (*word)
    render_copy_noisy(r, out);
  else
    render_copy(r, out);
}

void render_free(render *r) {
  if (r->done) {
    pthread_mutex_destroy(&r->film);
    pthread_mutex_destroy(&r->lock);
  }
  free(r->mixed);
  free(r->done);
}
