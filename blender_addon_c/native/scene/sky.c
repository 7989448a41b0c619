/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/sky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stage/stage.h"
#include "system/parallel.h"

enum { ROWS_PER_TASK = 16, TASK_LANES = BATCH };

typedef struct sky_task {
  sky *sky;
  const image *image;
  const stage_table *stages;
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

/*
 * How bright the cells of one row are: means over points that lie as close as the image's texels,
 * so that none is left out.
 */
static void fill_row(void *context, size_t line) {
  sky_task *t = context;
  const sky *s = t->sky;
  lane_v *d = aligned_alloc(64, sizeof *d);
  lane_c *c = aligned_alloc(64, sizeof *c);
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
      t->stages->sky((size_t)lanes, s, d, c);
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

bool sky_build(sky *s, const image *images, int threads, const atomic_bool *cancel) {
  const image *source = &images[s->image];
  s->width = source->width;
  s->height = source->height;
  s->closest = source->closest ? UINT32_MAX : 0;
  size_t texels = ((size_t)s->width + 1) * ((size_t)s->height + 1);
  s->texel = malloc(4 * texels * sizeof *s->texel);
  s->row = malloc((SKY_ROWS + 1) * sizeof *s->row);
  s->column = malloc(SKY_ROWS * (SKY_COLUMNS + 1) * sizeof *s->column);
  s->coarse = malloc(SKY_ROWS * (SKY_COLUMNS / SKY_STRIDE) * sizeof *s->coarse);
  s->density = malloc(SKY_ROWS * SKY_COLUMNS * sizeof *s->density);
  if (!s->texel || !s->row || !s->column || !s->coarse || !s->density)
    return false;
  sky_task task = {.sky = s, .image = source, .stages = stages_choose(), .cancel = cancel};
  parallel_for(threads, ((size_t)s->height + ROWS_PER_TASK - 1) / ROWS_PER_TASK, fill_texels,
               &task);
  size_t stride = 4 * ((size_t)s->width + 1);
  memcpy(s->texel + stride * (size_t)s->height, s->texel, stride * sizeof *s->texel);
  parallel_for(threads, SKY_ROWS, fill_row, &task);
  sum_up(s);
  return !atomic_load(&task.failed);
}

void sky_free(sky *s) {
  free(s->texel);
  free(s->row);
  free(s->column);
  free(s->coarse);
  free(s->density);
}
