/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scratches.h"

#include <math.h>
#include <string.h>

#include "system/parallel.h"

#define PI 3.14159265358979323846

/*
 * The table that answers for what is far has 1024 cells along the tile, 256 at least: 2 to 33 MB.
 * To make it takes some 40 ns for each of a cell's eight lines that a scratch crosses, which are no
 * more than so many.
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

bool scratches_build(scratches *s) {
  if (!s->field)
    s->field = shade_scratch_create(&s->params, NULL);
  return s->field != NULL;
}

void scratches_take(scratches *to, scratches *from) {
  if (to->field || to->tile != from->tile ||
      memcmp(&to->params, &from->params, sizeof to->params) != 0)
    return;
  to->field = from->field;
  from->field = NULL;
}

void scratches_free(scratches *s) {
  shade_scratch_free(s->field);
  s->field = NULL;
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
