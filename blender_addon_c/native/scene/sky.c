/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "batch/leaf.h"
#include "system/memory.h"
#include "system/parallel.h"

enum { ROWS_PER_TASK = 16, TASK_LANES = BATCH };

/* of the draws go to a sun, however bright it is: it may be hidden */
static const double SUN_MOST = 0.8;

typedef struct sky_task {
  sky *sky;
  const image *image; /* NULL: of the atmosphere */
  sky_look *look;
  const atomic_bool *cancel;
  atomic_bool failed;
} sky_task;

static bool stopped(const sky_task *t) {
  return atomic_load_explicit(t->cancel, memory_order_relaxed);
}

/* NaN and light below 0 are none; infinite light would leave none for the rest. */
static float usable(float x) {
  return x > 0.0f ? (x < 1e10f ? x : 1e10f) : 0.0f;
}

/* Rows of texels, each with the first once more at its end. */
static void fill_texels(void *context, size_t task) {
  sky_task *t = context;
  const sky *s = t->sky;
  size_t width = (size_t)s->width;
  float *channel = malloc(width * sizeof *channel);
  if (!channel)
    atomic_store(&t->failed, true);
  for (int y = (int)task * ROWS_PER_TASK;
       channel && y < s->height && y < ((int)task + 1) * ROWS_PER_TASK && !stopped(t); y++) {
    float *row = s->texel + 4 * (size_t)y * (width + 1);
    for (int c = 0; c < 3; c++) {
      image_row(t->image, y, c, channel);
      for (size_t x = 0; x < width; x++)
        row[4 * x + (size_t)c] = usable(channel[x] * s->strength[c]);
    }
    for (size_t x = 0; x < width; x++)
      row[4 * x + 3] = 0.0f;
    memcpy(row + 4 * width, row, 4 * sizeof *row);
  }
  free(channel);
}

/* A row of an atmosphere's sky; the half beyond the sun mirrors the other. */
static void fill_modelled(void *context, size_t line) {
  sky_task *t = context;
  const sky *s = t->sky;
  atmosphere_half half;
  float *row = s->texel + 4 * line * (size_t)(s->width + 1);
  bool ground = s->air.model == ATMOSPHERE_SINGLE && line < ATMOSPHERE_HORIZON;
  float shown = ground ? atmosphere_ground(&s->air, (int)line) : 1.0f;
  if (stopped(t) || !(shown > 0.0f)) {
    memset(row, 0, 4 * (size_t)(s->width + 1) * sizeof *row);
    return;
  }
  atmosphere_row(&s->air, ground ? ATMOSPHERE_HORIZON : (int)line, half);
  for (int x = 0; x < ATMOSPHERE_HALF; x++) {
    double rgb[3];
    const double xyz[3] = {(double)half[0][x], (double)half[1][x], (double)half[2][x]};
    atmosphere_rgb(&s->air, xyz, rgb);
    float *one = row + 4 * x, *other = row + 4 * (ATMOSPHERE_COLUMNS - 1 - x);
    for (int c = 0; c < 3; c++)
      one[c] = other[c] = usable((float)rgb[c] * shown * s->strength[c]);
    one[3] = other[3] = 0.0f;
  }
  memcpy(row + 4 * s->width, row, 4 * sizeof *row);
}

/* The sun of an atmosphere stands in the middle of its image, whose x axis is below it. */
static void place_sun(sky *s) {
  const atmosphere *a = &s->air;
  const float *m = s->matrix;
  sky_sun *sun = &s->sun;
  float x = cosf(a->elevation), z = sinf(a->elevation);
  vec3 to = {m[0] * x + m[8] * z, m[1] * x + m[9] * z, m[2] * x + m[10] * z}, across_, along;
  if (!make_unit(&to))
    return;
  across(to, &across_, &along);
  memcpy(sun->to, (float[3]){to.x, to.y, to.z}, sizeof sun->to);
  memcpy(sun->across, (float[3]){across_.x, across_.y, across_.z}, sizeof sun->across);
  memcpy(sun->along, (float[3]){along.x, along.y, along.z}, sizeof sun->along);
  double half = 0.5 * (double)a->sun_size, chord = 2 * sin(0.5 * half);
  double angle = 3.141592653589793 * chord * chord, lower[3], upper[3], bright = 0;
  for (int k = 0; k < 2; k++) {
    double xyz[3], *rgb = k ? upper : lower;
    atmosphere_sun(a, k == 1, xyz);
    atmosphere_rgb(a, xyz, rgb);
    for (int c = 0; c < 3; c++)
      rgb[c] = (double)usable((float)(rgb[c] / angle * (double)(a->sun_bright * s->strength[c])));
    bright += 0.5 * (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]);
  }
  for (int c = 0; c < 3; c++) {
    sun->lower[c] = (float)lower[c];
    sun->more[c] = (float)(upper[c] - lower[c]);
  }
  sun->chord2 = (float)(chord * chord);
  sun->half2 = (float)(half * half);
  double low = (double)a->elevation - half, high = (double)a->elevation + half;
  sun->low = (float)(a->later ? low : fmax(low, 0));
  sun->per_rise = (float)(1 / fmax(high - (double)sun->low, 1e-6));
  sun->covers = a->later ? 0 : UINT32_MAX;
  sun->low_z = (float)-sin(atmosphere_dip(a));
  double power = 0.8 * 0.25 * angle * bright; /* of the disc the rim takes a fifth */
  if (power > 0) {
    sun->share = (float)fmin(power / (power + (double)s->power), SUN_MOST);
    s->power += (float)power;
    sun->density = sun->share / (float)angle;
  }
}

/*
 * How bright the cells of one row are: means over points that lie as close as the image's texels,
 * so that none is left out.
 */
static void fill_row(void *context, size_t line) {
  sky_task *t = context;
  const sky *s = t->sky;
  lane_v *d = memory_aligned(64, sizeof *d);
  lane_c *c = memory_aligned(64, sizeof *c);
  float *out = s->density + line * SKY_COLUMNS;
  if (!d || !c)
    atomic_store(&t->failed, true);
  int fine_x = s->width / SKY_COLUMNS + 1, fine_y = s->height / SKY_ROWS + 1;
  fine_x = fine_x < 2 ? 2 : fine_x;
  fine_y = fine_y < 2 ? 2 : fine_y;
  int columns = SKY_COLUMNS * fine_x;
  memset(out, 0, SKY_COLUMNS * sizeof *out);
  for (int k = 0; k < fine_y && d && c && !stopped(t); k++) {
    double z = 1 - ((double)line + (k + 0.5) / fine_y) * 2 / SKY_ROWS, flat = sqrt(1 - z * z);
    for (int first = 0; first < columns; first += TASK_LANES) {
      int lanes = columns - first < TASK_LANES ? columns - first : TASK_LANES;
      for (int i = 0; i < lanes; i++) {
        double turns = 6.283185307179586 * (first + i + 0.5) / columns;
        store(d, (size_t)i,
              (vec3){(float)(flat * cos(turns)), (float)(flat * sin(turns)), (float)z});
      }
      t->look((size_t)lanes, s, d, c);
      for (int i = 0; i < lanes; i++)
        out[(first + i) / fine_x] +=
            (0.2126f * c->r[i] + 0.7152f * c->g[i] + 0.0722f * c->b[i]) / (float)(fine_x * fine_y);
    }
  }
  free(d);
  free(c);
}

/* Sums along the rows and over them; the cells' brightness becomes the density of draws. */
static void sum_up(sky *s) {
  const double cell = 4 * 3.141592653589793 / ((double)SKY_ROWS * SKY_COLUMNS);
  double row_sum[SKY_ROWS], total = 0;
  for (size_t j = 0; j < SKY_ROWS; j++) {
    row_sum[j] = 0;
    for (size_t i = 0; i < SKY_COLUMNS; i++)
      row_sum[j] += (double)s->density[j * SKY_COLUMNS + i];
    total += row_sum[j];
  }
  s->power = (float)(total * cell * 0.25); /* pi times the mean */
  double below = 0;
  for (size_t j = 0; j < SKY_ROWS; j++) {
    float *column = s->column + j * (SKY_COLUMNS + 1);
    double left = 0;
    s->row[j] = total > 0 ? (float)(below / total) : 0.0f;
    below += row_sum[j];
    for (size_t i = 0; i < SKY_COLUMNS; i++) {
      float *density = &s->density[j * SKY_COLUMNS + i];
      column[i] = row_sum[j] > 0 ? (float)(left / row_sum[j]) : 0.0f;
      left += (double)*density;
      *density = total > 0 ? (float)((double)*density / (total * cell)) : 0.0f;
    }
    column[SKY_COLUMNS] = 1.0f;
    for (size_t i = 0; i < SKY_COLUMNS / SKY_STRIDE; i++)
      s->coarse[j * (SKY_COLUMNS / SKY_STRIDE) + i] = column[i * SKY_STRIDE];
  }
  s->row[SKY_ROWS] = 1.0f;
}

bool sky_build(sky *s, const image *images, sky_look *look, int threads,
               const atomic_bool *cancel) {
  const image *source = s->modelled ? NULL : &images[s->image];
  s->width = source ? source->width : ATMOSPHERE_COLUMNS;
  s->height = source ? source->height : ATMOSPHERE_ROWS;
  s->closest = source && source->closest ? UINT32_MAX : 0;
  s->ends = source && source->wrap == WRAP_REPEAT ? 0 : UINT32_MAX;
  size_t texels = ((size_t)s->width + 1) * ((size_t)s->height + 1);
  s->texel = malloc(4 * texels * sizeof *s->texel);
  s->row = malloc((SKY_ROWS + 1) * sizeof *s->row);
  s->column = malloc(SKY_ROWS * (SKY_COLUMNS + 1) * sizeof *s->column);
  s->coarse = malloc(SKY_ROWS * (SKY_COLUMNS / SKY_STRIDE) * sizeof *s->coarse);
  s->density = malloc(SKY_ROWS * SKY_COLUMNS * sizeof *s->density);
  if (!s->texel || !s->row || !s->column || !s->coarse || !s->density)
    return false;
  sky_task task = {.sky = s, .image = source, .look = look, .cancel = cancel};
  size_t stride = 4 * ((size_t)s->width + 1), last = (size_t)s->height - 1;
  if (source)
    parallel_for(threads, ((size_t)s->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK, fill_texels,
                 &task);
  else if (atmosphere_prepare(&s->air, threads))
    parallel_for(threads, (size_t)s->height, fill_modelled, &task);
  else
    return false;
  atmosphere_free(&s->air);
  memcpy(s->texel + stride * (last + 1), s->texel + (s->ends ? stride * last : 0),
         stride * sizeof *s->texel);
  parallel_for(threads, SKY_ROWS, fill_row, &task);
  sum_up(s);
  if (s->modelled && s->air.sun_size > 0.0f)
    place_sun(s);
  return !atomic_load(&task.failed);
}

void sky_free(sky *s) {
  free(s->texel);
  free(s->row);
  free(s->column);
  free(s->coarse);
  free(s->density);
}
