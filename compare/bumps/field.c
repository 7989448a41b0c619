/* SPDX-License-Identifier: Apache-2.0 */
#include "field.h"

#include <math.h>
#include <stdlib.h>

const char *const kind_words[KINDS] = {"sine", "noise", "ridges_across", "ridges_along"};

#define CELL (PERIOD / SIDE)

double uniform(uint64_t *state) { /* splitmix64 */
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

typedef struct wave {
  double kx, ky, phase, height;
} wave;

/* Every wave of the ring has an equal part of the variance. */
static int ring(wave *waves, double slope) {
  uint64_t state = 5;
  int count = 0;
  for (int i = -7; i <= 7; i++)
    for (int j = 0; j <= 7; j++) {
      const int k2 = i * i + j * j;
      if ((j > 0 || i > 0) && k2 >= 9 && k2 <= 49)
        waves[count++] = (wave){i, j, 2 * PI * uniform(&state), sqrt(1. / k2)};
    }
  for (int k = 0; k < count; k++)
    waves[k].height *= slope / sqrt(count);
  return count;
}

static void fill(field *f, double slope) {
  wave waves[256];
  const int count = f->kind == NOISE ? ring(waves, slope) : 0;
  for (int j = 0; j < SIDE; j++)
    for (int i = 0; i < SIDE; i++) {
      const double x = i * CELL, y = j * CELL;
      double h = 0, dx = 0, dy = 0;
      for (int k = 0; k < count; k++) {
        const wave w = waves[k];
        const double at = w.kx * x + w.ky * y + w.phase, c = w.height * cos(at);
        h += w.height * sin(at);
        dx += w.kx * c;
        dy += w.ky * c;
      }
      if (f->kind == SINE) {
        h = slope * sin(x) * sin(y);
        dx = slope * cos(x) * sin(y);
        dy = slope * sin(x) * cos(y);
      } else if (f->kind != NOISE) {
        h = slope * sin(x);
        dx = slope * cos(x);
      }
      f->height[j * SIDE + i] = (float)h;
      f->slope_x[j * SIDE + i] = (float)dx;
      f->slope_y[j * SIDE + i] = (float)dy;
    }
}

int field_make(field *f, kind kind, double slope) {
  const size_t points = (size_t)SIDE * SIDE;
  float *all = malloc(3 * points * sizeof *all);
  if (!all)
    return 0;
  *f = (field){kind, all, all + points, all + 2 * points, INFINITY, -INFINITY, 0, 0, 0, 0};
  fill(f, slope);
  for (size_t i = 0; i < points; i++) {
    const double sx = f->slope_x[i], sy = f->slope_y[i];
    f->low = fmin(f->low, f->height[i]);
    f->high = fmax(f->high, f->height[i]);
    f->steepest = fmax(f->steepest, hypot(sx, sy));
    f->xx += sx * sx / (double)points;
    f->xy += sx * sy / (double)points;
    f->yy += sy * sy / (double)points;
  }
  f->steepest *= 1.02; /* between the points */
  return 1;
}

void field_free(field *f) {
  free(f->height);
  *f = (field){0};
}

static double between(const float *grid, double x, double y) {
  const double fx = x / CELL, fy = y / CELL, ix = floor(fx), iy = floor(fy), u = fx - ix,
               v = fy - iy;
  const int i = (int)ix & (SIDE - 1), j = (int)iy & (SIDE - 1), next = (i + 1) & (SIDE - 1);
  const float *a = grid + j * SIDE, *b = grid + ((j + 1) & (SIDE - 1)) * SIDE;
  return (1 - v) * (a[i] + u * (a[next] - a[i])) + v * (b[i] + u * (b[next] - b[i]));
}

vec field_normal(const field *f, double x, double y) {
  const double sx = between(f->slope_x, x, y), sy = between(f->slope_y, x, y),
               scale = 1 / sqrt(1 + sx * sx + sy * sy);
  return (vec){-sx * scale, -sy * scale, scale};
}

/* A step is what the gap allows at the steepest slope, but most of a cell at least. */
double field_cast(const field *f, vec from, vec along) {
  const double flat = sqrt(along.x * along.x + along.y * along.y),
               nearing = f->steepest * flat - along.z;
  const double least = 0.6 * CELL / fmax(flat, 0.3);
  double before = 0;
  for (double t = 0; t < 300 && nearing > 0;) {
    const vec p = plus(from, t, along);
    if (along.z > 0 && p.z > f->high)
      return -1;
    const double gap = p.z - between(f->height, p.x, p.y);
    if (gap < 0 && t > 0) {
      for (int i = 0; i < 14; i++) {
        const double middle = 0.5 * (before + t);
        const vec q = plus(from, middle, along);
        if (q.z < between(f->height, q.x, q.y))
          t = middle;
        else
          before = middle;
      }
      return before;
    }
    before = t;
    t += fmax(least, fmax(gap, 0) / nearing);
  }
  return -1;
}
