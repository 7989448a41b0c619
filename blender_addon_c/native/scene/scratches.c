/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scratches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "system/parallel.h"

#define PI 3.14159265358979323846

/*
 * The table that answers for what is far has 1024 cells along the tile, 256 at least: 2 to 33 MB.
 * Making it takes time by the lines that scratches cross, eight a cell. They are no more than so
 * many.
 */
enum { CELLS = 1024, CELLS_LEAST = 256, LINES = 8 };
static const double most_crossed = 4e7;

static double within(double x, double low, double high) {
  return fmin(fmax(x, low), high);
}

/* How large the tile is, and how many scratches lie on it, of which each reaches so far up. Metres.
 */
static uint32_t plan(scratches *s, double density, double length, double width, double up,
                     double tile) {
  const double per_area = density * 1e4;
  if (!(tile > 0)) {
    tile = per_area > 0 ? sqrt(SCRATCHES_GOOD / per_area) : 1;
    tile = fmax(fmin(tile, 1e5 * width), 4 * length);
  }
  s->tile = within(tile, 1e-4, 1e3);
  const double area = s->tile * s->tile, wanted = per_area * area;
  const double deep = SCRATCHES_DEEP * area / (0.25 * PI * length * width);
  const double cells = most_crossed / LINES * s->tile / up; /* of one scratch */
  const double most = fmin(fmin(SCRATCHES_MOST, deep), cells / CELLS_LEAST);
  const double pits = floor(fmin(wanted, most) + 0.5);
  s->params.cells = (int)within(cells / fmax(pits, 1), CELLS_LEAST, CELLS);
  s->fewer = pits < 0.99 * wanted - 1;
  s->density = pits / (area * 1e4);
  /* of random ones; the mean square of a half width is more than that of its mean */
  const double covered = 0.25 * PI * length * width * (2.25 - 1 / 2.25) / (4 * log(1.5));
  s->share = (float)(1 - exp(-covered * pits / area));
  return (uint32_t)pits;
}

bool scratches_read(reader *r, void *out, void *context) {
  scratches *s = out;
  double density, length, width, depth, direction, spread, seed, tile;
  (void)context;
  if (!reader_number(r, "density", &density) || !reader_number(r, "length", &length) ||
      !reader_number(r, "width", &width) || !reader_number(r, "depth", &depth) ||
      !reader_number(r, "direction", &direction) || !reader_number(r, "spread", &spread) ||
      !reader_number(r, "seed", &seed) || !reader_number(r, "tile", &tile))
    return false;
  width = 1e-3 * within(width, 1e-4, 1e3);
  length = fmax(1e-3 * within(length, 1e-4, 1e4), width);
  depth = within(depth, 0, 0.99);
  /* all 0 but for what is set here: two that are alike can be compared as bytes */
  memset(&s->params, 0, sizeof s->params);
  shade_scratch_params_init(&s->params);
  shade_scratch_layer *l = &s->params.layer[0];
  l->direction = fmod(direction, 2 * PI);
  l->spread = within(spread, 0, PI / 2);
  const double up = fmin(fabs(sin(l->direction)) + l->spread, 1) * length + width;
  l->pits = plan(s, within(density, 0, 1e9), length, width, up, tile);
  const double half = 0.5 * width / s->tile, stretch = length / width;
  l->radius = (shade_range){fmin(half / 1.5, 0.5), fmin(half * 1.5, 0.5)};
  l->stretch = (shade_range){fmax(0.5 * stretch, 1), fmax(1.5 * stretch, 1)};
  l->depth = (shade_range){0.5 * depth, fmin(1.5 * depth, 0.99)};
  s->params.seed = (uint64_t)(int64_t)within(seed, -1e15, 1e15);
  return true;
}

/* Squares are four cells of the field's table wide, which alone answers for them then, or more. */
static int levels_for(int cells) {
  int levels = 0;
  while (levels + 1 < SCRATCHES_LEVELS && 8 << levels <= cells)
    levels++;
  return levels;
}

static void square_row(void *context, size_t row) {
  const scratches *s = context;
  const int levels = s->squares.levels, wide = 1 << levels;
  const double side = ldexp(1, -levels), footprint[4] = {side, 0, 0, side};
  for (int i = 0; i < wide; i++) {
    shade_slopes of;
    shade_scratch_eval(s->field, (i + 0.5) * side, ((double)row + 0.5) * side, footprint, NULL,
                       &of);
    const double x = of.mean[0], y = of.mean[1];
    s->squares.level[levels][row * (size_t)wide + (size_t)i] =
        (scratch_slopes){(float)x, (float)y, (float)(of.covariance[0] + x * x),
                         (float)(of.covariance[1] + x * y), (float)(of.covariance[2] + y * y)};
  }
}

static scratch_slopes mean_of(const scratch_slopes *below, const scratch_slopes *above) {
  const scratch_slopes *of[4] = {below, below + 1, above, above + 1};
  scratch_slopes mean = {0};
  for (int k = 0; k < 4; k++) {
    mean.x += 0.25f * of[k]->x;
    mean.y += 0.25f * of[k]->y;
    mean.xx += 0.25f * of[k]->xx;
    mean.xy += 0.25f * of[k]->xy;
    mean.yy += 0.25f * of[k]->yy;
  }
  return mean;
}

static bool squares_build(scratches *s) {
  scratch_squares *q = &s->squares;
  q->levels = levels_for(s->params.cells);
  for (int k = 0; k <= q->levels; k++)
    if (!(q->level[k] = malloc(sizeof(scratch_slopes) << 2 * k)))
      return false;
  parallel_for(parallel_cores(), (size_t)1 << q->levels, square_row, s);
  for (int k = q->levels - 1; k >= 0; k--) {
    const size_t wide = (size_t)1 << k;
    for (size_t j = 0; j < wide; j++)
      for (size_t i = 0; i < wide; i++) {
        const scratch_slopes *from = q->level[k + 1] + 4 * j * wide + 2 * i;
        q->level[k][j * wide + i] = mean_of(from, from + 2 * wide);
      }
  }
  return true;
}

bool scratches_build(scratches *s) {
  if (s->field)
    return true;
  s->field = shade_scratch_create(&s->params, NULL);
  if (s->field && squares_build(s))
    return true;
  scratches_free(s);
  return false;
}

void scratches_take(scratches *to, scratches *from) {
  if (to->field || to->tile != from->tile ||
      memcmp(&to->params, &from->params, sizeof to->params) != 0)
    return;
  to->field = from->field;
  to->squares = from->squares;
  from->field = NULL;
  from->squares = (scratch_squares){0};
}

void scratches_free(scratches *s) {
  shade_scratch_free(s->field);
  s->field = NULL;
  for (int k = 0; k < SCRATCHES_LEVELS; k++) {
    free(s->squares.level[k]);
    s->squares.level[k] = NULL;
  }
}

typedef struct drawing {
  const scratches *of;
  int size, samples;
  float *normal, *height, *mask;
} drawing;

static void draw_row(void *context, size_t row) {
  const drawing *d = context;
  const int n = d->samples;
  const double step = 1.0 / d->size, share = 1.0 / (n * n);
  for (int i = 0; i < d->size; i++) {
    const size_t at = row * (size_t)d->size + (size_t)i;
    double x = 0, y = 0, height = 0, mask = 0;
    for (int k = 0; k < n * n; k++) {
      shade_slopes slopes;
      double h;
      shade_scratch_eval(d->of->field, (i + (k % n + 0.5) / n) * step,
                         ((double)row + (k / n + 0.5) / n) * step, NULL, &h, &slopes);
      x += share * slopes.mean[0];
      y += share * slopes.mean[1];
      height += share * h;
      mask += h < 0 ? share : 0;
    }
    const double z = 1 / sqrt(x * x + y * y + 1);
    float *normal = d->normal + 4 * at;
    normal[0] = (float)(0.5 - 0.5 * x * z);
    normal[1] = (float)(0.5 - 0.5 * y * z);
    normal[2] = (float)(0.5 + 0.5 * z);
    normal[3] = 1.0f;
    for (int c = 0; c < 4; c++) {
      d->height[4 * at + (size_t)c] = c < 3 ? (float)(height * d->of->tile) : 1.0f;
      d->mask[4 * at + (size_t)c] = c < 3 ? (float)mask : 1.0f;
    }
  }
}

void scratches_picture(const scratches *s, int size, int samples, float *normal, float *height,
                       float *mask) {
  drawing d = {
      .of = s, .size = size, .samples = samples, .normal = normal, .height = height, .mask = mask};
  parallel_for(parallel_cores(), (size_t)size, draw_row, &d);
}
