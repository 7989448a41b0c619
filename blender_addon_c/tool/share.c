/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "share.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "port/files.h"
#include "port/map.h"

enum { VERSION = 1, NUMBERS = 11 };
static const char MAGIC[] = "shshare\n";
enum { MAGIC_SIZE = sizeof MAGIC - 1 };

/* What a file says of itself, as it lies there; behind it the channels of each picture. */
typedef struct about {
  uint32_t version, scene, samples, seed, first, end;
  int32_t region[4];
  uint32_t pictures;
} about;
_Static_assert(sizeof(about) == NUMBERS * sizeof(uint32_t), "no gaps");

typedef struct share {
  about about;
  const unsigned char *map;
  size_t size, *at; /* where each picture's pixels begin */
  uint32_t *channels;
} share;

static bool fail(char *error, size_t size, const char *path, const char *why) {
  snprintf(error, size, "%s: %s", path, why);
  return false;
}

static size_t width_of(const int32_t region[4]) {
  return (size_t)(region[2] - region[0]);
}

static size_t pixels_of(const int32_t region[4]) {
  return width_of(region) * (size_t)(region[3] - region[1]);
}

/* Floats of a pixel: what is added up, and the number of samples. */
static size_t channels_of(const plane_layout *planes, const matte_layout *mattes) {
  return 4 + (size_t)planes->channels + mattes->all + 1;
}

static size_t channels_of_scene(const scene *s) {
  plane_layout planes = plane_layout_of(s->planes);
  matte_layout mattes = matte_layout_of(s->mattes, (size_t)s->matte_slots);
  return channels_of(&planes, &mattes);
}

/* ---- writing */

static bool put(share_writer *w, const void *data, size_t bytes) {
  w->sum = (uint32_t)crc32_z(w->sum, data, bytes);
  return fwrite(data, 1, bytes, w->file) == bytes;
}

static bool cannot_write(const share_writer *w, char *error, size_t size) {
  return fail(error, size, w->whole.path, errno ? strerror(errno) : "cannot write");
}

bool share_begin(share_writer *w, const char *path, const scene_file *f, const int region[4],
                 char *error, size_t size) {
  const scene *s = f->picture->scene;
  char why[256];
  about a = {.version = VERSION,
             .scene = f->checksum,
             .samples = (uint32_t)s->samples,
             .seed = s->seed,
             .first = (uint32_t)s->share[0],
             .end = s->share[1] ? (uint32_t)s->share[1] : (uint32_t)s->samples,
             .pictures = (uint32_t)f->pictures};
  memcpy(a.region, region, sizeof a.region);
  *w = (share_writer){.file = NULL};
  if (shade_whole_begin(&w->whole, path, why, sizeof why) != 0)
    return fail(error, size, path, why);
  errno = 0;
  w->file = shade_port_open(w->whole.temporary, "wb");
  bool good = w->file && put(w, MAGIC, MAGIC_SIZE) && put(w, &a, sizeof a);
  for (size_t k = 0; good && k < f->pictures; k++) {
    uint32_t channels = (uint32_t)channels_of_scene(f->picture[k].scene);
    good = put(w, &channels, sizeof channels);
  }
  return good || cannot_write(w, error, size);
}

/* A pixel's samples. */
static float samples_of(const render *r, int x, int y) {
  size_t column = (size_t)((x - r->origin[0]) / r->side),
         row = (size_t)((y - r->origin[1]) / r->side);
  size_t tile = row * r->columns + column, samples = 0, half;
  if (r->adaptive.done)
    return (float)adaptive_samples(&r->adaptive, r->plan,
                                   adaptive_block(tile, x - r->origin[0], y - r->origin[1]), &half);
  for (size_t k = 0; k < atomic_load(&r->done[tile]); k++)
    samples += r->plan->pass[k].period;
  return (float)samples;
}

bool share_put(share_writer *w, const render *r, const int region[4], char *error, size_t size) {
  const size_t planes = (size_t)r->planes.channels, mattes = r->mattes.all;
  const size_t channels = channels_of(&r->planes, &r->mattes), width = width_of(region);
  float *row = malloc(channels * width * sizeof *row);
  bool good = row != NULL;
  errno = 0;
  for (int y = region[1]; good && y < region[3]; y++) {
    float *to = row;
    for (int x = region[0]; x < region[2]; x++) {
      size_t at = (size_t)(y - r->region[1]) * width_of(r->region) + (size_t)(x - r->region[0]);
      memcpy(to, r->sum + 4 * at, 4 * sizeof *to);
      to += 4;
      if (planes)
        memcpy(to, r->numbers + planes * at, planes * sizeof *to);
      to += planes;
      if (mattes)
        memcpy(to, r->matte + mattes * at, mattes * sizeof *to);
      to += mattes;
      *to++ = samples_of(r, x, y);
    }
    good = put(w, row, channels * width * sizeof *row);
  }
  free(row);
  return good ||
         (row ? cannot_write(w, error, size) : fail(error, size, w->whole.path, "out of memory"));
}

bool share_end(share_writer *w, bool good, char *error, size_t size) {
  const uint32_t sum = w->sum;
  char why[256];
  errno = 0;
  if (good && !put(w, &sum, sizeof sum))
    good = cannot_write(w, error, size);
  if (w->file && fclose(w->file) != 0 && good)
    good = cannot_write(w, error, size);
  char *path = w->whole.path;
  w->whole.path = path ? strdup(path) : NULL; /* which it frees */
  if (shade_whole_end(&w->whole, good, why, sizeof why) != 0)
    good = fail(error, size, path, why);
  free(path);
  return good;
}

/* ---- reading */

/* What is wrong with its beginning; NULL: nothing. */
static const char *read_about(share *s, const scene_file *f) {
  const scene *first = f->picture->scene;
  size_t end = MAGIC_SIZE + sizeof(about);
  uint32_t sum;
  if (s->size < end + sizeof sum || memcmp(s->map, MAGIC, MAGIC_SIZE) != 0)
    return "no share of a picture: \"shshare\" must be its first line";
  memcpy(&sum, s->map + s->size - sizeof sum, sizeof sum);
  if (sum != (uint32_t)crc32_z(0, s->map, s->size - sizeof sum))
    return "it must end in the checksum of all that is before";
  memcpy(&s->about, s->map + MAGIC_SIZE, sizeof(about));
  const about *a = &s->about;
  if (a->version != VERSION)
    return "its version must be 1";
  if (a->scene != f->checksum || a->pictures != f->pictures)
    return "it is of another scene";
  if (!a->samples || a->samples > 1u << 16 || a->first >= a->end || a->end > a->samples ||
      a->region[0] < first->region[0] || a->region[1] < first->region[1] ||
      a->region[2] > first->region[2] || a->region[3] > first->region[3] ||
      a->region[0] >= a->region[2] || a->region[1] >= a->region[3])
    return "it must be of a part of the picture and of its samples";
  s->at = calloc(f->pictures, sizeof *s->at);
  s->channels = calloc(f->pictures, sizeof *s->channels);
  if (!s->at || !s->channels)
    return "out of memory";
  size_t names = f->pictures * sizeof *s->channels;
  if (s->size - end < names + sizeof sum)
    return "it must have all pictures of its scene";
  memcpy(s->channels, s->map + end, names);
  end += names;
  for (size_t k = 0; k < f->pictures; k++) {
    if (s->channels[k] != channels_of_scene(f->picture[k].scene))
      return "it must have the channels of its scene";
    s->at[k] = end;
    end += pixels_of(a->region) * s->channels[k] * sizeof(float);
  }
  return end + sizeof sum == s->size ? NULL : "it must end with its last pixel";
}

static const char *open_share(share *s, const char *path, const scene_file *f) {
  void *map = shade_port_map(path, &s->size);
  if (!map)
    return errno ? strerror(errno) : "it is empty";
  s->map = map;
  return read_about(s, f);
}

static bool overlap(const about *a, const about *b) {
  return a->first < b->end && b->first < a->end && a->region[0] < b->region[2] &&
         b->region[0] < a->region[2] && a->region[1] < b->region[3] && b->region[1] < a->region[3];
}

/* Against those before it. */
static bool check(const share_set *set, size_t k, char *error, size_t size) {
  const about *first = &set->share[0].about, *a = &set->share[k].about;
  if (a->samples != first->samples || a->seed != first->seed)
    return fail(error, size, set->path[k], "its samples and seed must be those of the others");
  for (size_t i = 0; i < k; i++)
    if (overlap(a, &set->share[i].about)) {
      snprintf(error, size, "%s and %s: both have the same samples of a pixel", set->path[i],
               set->path[k]);
      return false;
    }
  return true;
}

bool share_open(share_set *set, const char *const *path, size_t count, scene_file *f, char *error,
                size_t size) {
  const int *region = f->picture->scene->region;
  double there = 0;
  *set = (share_set){.path = path, .share = calloc(count, sizeof *set->share)};
  if (!set->share)
    return fail(error, size, path[0], "out of memory");
  for (; set->count < count; set->count++) {
    share *s = &set->share[set->count];
    const char *wrong = open_share(s, path[set->count], f);
    if (wrong || !check(set, set->count, error, size)) {
      set->count++;
      return wrong ? fail(error, size, path[set->count - 1], wrong) : false;
    }
    there += (double)pixels_of(s->about.region) * (s->about.end - s->about.first);
  }
  const about *a = &set->share[0].about;
  const double all = (double)pixels_of(region) * a->samples;
  if (there < all) {
    snprintf(error, size, "shares are missing: these have %.4g %% of the picture's samples",
             100 * there / all);
    return false;
  }
  for (size_t k = 0; k < f->pictures; k++) {
    f->picture[k].scene->samples = (int)a->samples;
    f->picture[k].scene->seed = a->seed;
  }
  set->samples = malloc((pixels_of(region) + 1) * sizeof *set->samples);
  return set->samples || fail(error, size, path[0], "out of memory");
}

static void add_pixel(render *r, size_t at, const float *from) {
  const size_t planes = (size_t)r->planes.channels;
  for (size_t c = 0; c < 4; c++)
    r->sum[4 * at + c] += from[c];
  from += 4;
  for (size_t c = 0; c < planes; c++)
    r->numbers[planes * at + c] += from[c];
  if (r->mattes.all)
    matte_merge(&r->mattes, from + planes, r->matte + r->mattes.all * at);
}

static void add_share(render *r, const share *s, size_t picture, uint32_t *samples) {
  const int32_t *region = s->about.region;
  const size_t channels = s->channels[picture], bytes = channels * sizeof(float);
  float pixel[4 + PLANE_CHANNELS_MAX + 2 * MATTE_SLOTS_MOST * MATTE_KINDS + 1];
  const unsigned char *from = s->map + s->at[picture];
  for (int y = region[1]; y < region[3]; y++)
    for (int x = region[0]; x < region[2]; x++, from += bytes) {
      size_t at = (size_t)(y - r->region[1]) * width_of(r->region) + (size_t)(x - r->region[0]);
      memcpy(pixel, from, bytes);
      add_pixel(r, at, pixel);
      const float own = pixel[channels - 1];
      samples[at] += own > 0.0f && own <= (float)s->about.samples ? (uint32_t)own : 0;
    }
}

/* Passes that make so many samples. */
static size_t passes_of(const sampling_plan *plan, size_t samples) {
  size_t passes = 0, sum = 0;
  while (passes < plan->passes && sum < samples)
    sum += plan->pass[passes++].period;
  return passes;
}

bool share_fill(void *context, render *r) {
  share_set *set = context;
  memset(set->samples, 0, pixels_of(r->region) * sizeof *set->samples);
  for (size_t k = 0; k < set->count; k++)
    add_share(r, &set->share[k], set->picture, set->samples);
  for (size_t tile = 0; tile < r->tiles; tile++)
    atomic_store(&r->done[tile], r->plan->passes);
  for (int y = r->region[1]; r->adaptive.done && y < r->region[3]; y++)
    for (int x = r->region[0]; x < r->region[2]; x++) {
      size_t column = (size_t)((x - r->origin[0]) / r->side),
             row = (size_t)((y - r->origin[1]) / r->side),
             at = (size_t)(y - r->region[1]) * width_of(r->region) + (size_t)(x - r->region[0]);
      r->adaptive
          .passes[adaptive_block(row * r->columns + column, x - r->origin[0], y - r->origin[1])] =
          (uint16_t)passes_of(r->plan, set->samples[at]);
    }
  return true;
}

void share_close(share_set *set) {
  for (size_t k = 0; set->share && k < set->count; k++) {
    if (set->share[k].map)
      shade_port_unmap((void *)(uintptr_t)set->share[k].map, set->share[k].size);
    free(set->share[k].at);
    free(set->share[k].channels);
  }
  free(set->share);
  free(set->samples);
  *set = (share_set){.count = 0};
}
