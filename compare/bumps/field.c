/* SPDX-License-Identifier: Apache-2.0 */
#include "field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const kind_words[KINDS] = {
    "sine", "noise",     "fractal", "long_and_fine", "roofs",        "letter",
    "pits", "scratches", "half",    "ridges_across", "ridges_along",
};

enum { COARSE = 512, FINE = 1024 };

double uniform(uint64_t *state) { /* splitmix64 */
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

typedef struct wave {
  double kx, ky, phase, height;
} wave;

/* Waves of `low` to `high` periods, of every direction, or `few` of them; each has an equal part of
 * the variance. */
typedef struct waves {
  int count;
  wave wave[256];
} waves;

static void ring(waves *to, int low, int high, int few, double slope) {
  uint64_t state = 5;
  const int first = to->count;
  for (int i = -high; i <= high; i++)
    for (int j = 0; j <= high; j++) {
      const int k2 = i * i + j * j;
      if ((j > 0 || i > 0) && k2 >= low * low && k2 <= high * high && to->count < 256 &&
          (!few || uniform(&state) < few / (1.6 * (high * high - low * low))))
        to->wave[to->count++] = (wave){i, j, 2 * PI * uniform(&state), sqrt(1. / k2)};
    }
  for (int k = first; k < to->count; k++)
    to->wave[k].height *= slope / sqrt(to->count - first);
}

/* What a field is made of, told once. */
typedef struct recipe {
  kind kind;
  double slope;
  waves of;
  double pit[40][2];
} recipe;

static void prepare(recipe *r) {
  const double s = r->slope;
  uint64_t state = 7;
  if (r->kind == NOISE || r->kind == HALF)
    ring(&r->of, 3, 7, 0, s);
  for (int octave = 2; r->kind == FRACTAL && octave < 32; octave *= 2)
    ring(&r->of, octave, 2 * octave - 1, octave > 2 ? 40 : 0, s / 2);
  if (r->kind == LONG_AND_FINE)
    ring(&r->of, 6, 10, 40, 0.64 * s);
  if (r->kind == LONG_AND_FINE || r->kind == ROOFS)
    ring(&r->of, 50, 70, 40, (r->kind == ROOFS ? 0.51 : 0.77) * s);
  for (int k = 0; k < 40; k++)
    for (int axis = 0; axis < 2; axis++)
      r->pit[k][axis] = PERIOD * uniform(&state);
}

static double waved(const waves *all, double x, double y) {
  double h = 0;
  for (int k = 0; k < all->count; k++) {
    const wave w = all->wave[k];
    h += w.height * sin(w.kx * x + w.ky * y + w.phase);
  }
  return h;
}

static double clamped(double x, double low, double high) {
  return fmin(fmax(x, low), high);
}

/* How far into a ring with a bar, by the distance from their outlines. */
static double letter_depth(double x, double y) {
  const double ring = 0.3 - fabs(hypot(x - PI, y - PI) - 1.7);
  const double bar = fmin(0.3 - fabs(y - PI), 2.6 - fabs(x - PI));
  return fmax(ring, bar);
}

static double groove_depth(double x, double y, double wide) {
  static const int way[7][3] = {{1, 0, 2}, {0, 1, 2},  {1, 1, 2}, {1, -1, 1},
                                {2, 1, 1}, {1, -2, 1}, {3, 1, 1}};
  double deepest = 0;
  for (int k = 0; k < 7; k++)
    for (int copy = 0; copy < way[k][2]; copy++) {
      const double size = hypot(way[k][0], way[k][1]);
      const double at = way[k][0] * x + way[k][1] * y + 1.3 * k + 2.1 * copy;
      const double off = fabs(remainder(at, PERIOD)) / size;
      if (off < 0.5 * wide)
        deepest = fmax(deepest, 0.5 * (1 + cos(2 * PI * off / wide)));
    }
  return deepest;
}

static double height_of(const recipe *r, double x, double y) {
  const double s = r->slope;
  switch (r->kind) {
  case SINE:
    return s * sin(x) * sin(y);
  case RIDGES_ACROSS:
  case RIDGES_ALONG:
    return s * sin(x);
  case ROOFS: /* two of them */
    return 0.86 / sqrt(2) * s * fabs(remainder(x, PI)) + waved(&r->of, x, y);
  case LETTER:
    return s * clamped(letter_depth(x, y) + 0.1, 0, 0.25);
  case PITS: {
    const double wide = 0.2;
    double h = 0;
    for (int k = 0; k < 40; k++) {
      const double off =
          hypot(remainder(x - r->pit[k][0], PERIOD), remainder(y - r->pit[k][1], PERIOD)) / wide;
      h = fmin(h, off < 1 ? 0.5 * s * wide * (off * off - 1) : 0);
    }
    return h;
  }
  case SCRATCHES: {
    const double wide = 11 * PERIOD / FINE;
    return -s * wide / PI * groove_depth(x, y, wide);
  }
  case HALF: {
    const double in = clamped((PI / 2 - fabs(x - PI)) / 0.3 + 0.5, 0, 1);
    return in > 0 ? in * in * (3 - 2 * in) * waved(&r->of, x, y) : 0;
  }
  default:
    return waved(&r->of, x, y);
  }
}

static float *row_of(float *grid, int side, int j) {
  return grid + (size_t)(j & (side - 1)) * (size_t)side;
}

static void fill(field *f, double slope) {
  static recipe r;
  r = (recipe){.kind = f->kind, .slope = slope};
  prepare(&r);
  const int side = f->side;
  const double cell = PERIOD / side;
  for (int j = 0; j < side; j++)
    for (int i = 0; i < side; i++)
      row_of(f->height, side, j)[i] = (float)height_of(&r, i * cell, j * cell);
  for (int j = 0; j < side; j++)
    for (int i = 0; i < side; i++) {
      const float *here = row_of(f->height, side, j);
      const double dx = here[(i + 1) & (side - 1)] - here[(i - 1) & (side - 1)];
      const double dy = row_of(f->height, side, j + 1)[i] - row_of(f->height, side, j - 1)[i];
      row_of(f->slope_x, side, j)[i] = (float)(dx / (2 * cell));
      row_of(f->slope_y, side, j)[i] = (float)(dy / (2 * cell));
    }
}

/* The means of 2 * half + 1 neighbours along one axis, by a running sum; `line` has room for them.
 */
static void blur_line(float *first, size_t step, int side, int half, double *line) {
  for (int i = 0; i < side; i++)
    line[i] = first[(size_t)i * step];
  double sum = 0;
  for (int k = -half; k <= half; k++)
    sum += line[k & (side - 1)];
  for (int i = 0; i < side; i++) {
    first[(size_t)i * step] = (float)(sum / (2 * half + 1));
    sum += line[(i + half + 1) & (side - 1)] - line[(i - half) & (side - 1)];
  }
}

/* Three boxes along both axes, which is all but a Gaussian. */
static void blur(float *grid, int side, int half, double *line) {
  for (int time = 0; time < 3; time++) {
    for (int k = 0; k < side; k++)
      blur_line(grid + (size_t)k * (size_t)side, 1, side, half, line);
    for (int k = 0; k < side; k++)
      blur_line(grid + k, (size_t)side, side, half, line);
  }
}

/* How much moments in windows count, not that of all: the more, the more they vary. */
static double nearness(const field *f) {
  const size_t points = (size_t)f->side * (size_t)f->side;
  double squares = 0;
  for (size_t i = 0; i < points; i++) {
    const double here = (f->moment[0][i] + f->moment[2][i]) / (f->xx + f->yy);
    squares += here * here / (double)points;
  }
  return clamped((squares - 1 - 0.5) / 0.3, 0, 1);
}

/* For field_moment. `room` is two grids. */
static void find_moments(field *f, float *room, double *line) {
  const size_t points = (size_t)f->side * (size_t)f->side;
  const double whole[3] = {f->xx, f->xy, f->yy};
  int half = 3;
  for (; half < f->side / 8; half *= 2) {
    double left = 0;
    memcpy(room, f->slope_x, points * sizeof *room);
    memcpy(room + points, f->slope_y, points * sizeof *room);
    blur(room, f->side, half, line);
    blur(room + points, f->side, half, line);
    for (size_t i = 0; i < 2 * points; i++)
      left += room[i] * room[i] / (double)points;
    if (left <= 0.2 * (f->xx + f->yy))
      break;
  }
  for (size_t i = 0; i < points; i++) {
    f->moment[0][i] = f->slope_x[i] * f->slope_x[i];
    f->moment[1][i] = f->slope_x[i] * f->slope_y[i];
    f->moment[2][i] = f->slope_y[i] * f->slope_y[i];
  }
  for (int k = 0; k < 3; k++)
    blur(f->moment[k], f->side, half, line);
  const double near = nearness(f);
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < points; i++)
      f->moment[k][i] = (float)(whole[k] + near * (f->moment[k][i] - whole[k]));
}

int field_make(field *f, kind kind, double slope) {
  const int side = kind >= FRACTAL && kind <= HALF ? FINE : COARSE;
  const size_t points = (size_t)side * (size_t)side;
  float *all = malloc(8 * points * sizeof *all);
  double *line = malloc((size_t)side * sizeof *line);
  if (!all || !line) {
    free(all);
    free(line);
    return 0;
  }
  *f = (field){.kind = kind,
               .side = side,
               .height = all,
               .slope_x = all + points,
               .slope_y = all + 2 * points,
               .moment = {all + 3 * points, all + 4 * points, all + 5 * points},
               .low = INFINITY,
               .high = -INFINITY};
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
  find_moments(f, all + 6 * points, line);
  free(line);
  return 1;
}

void field_free(field *f) {
  free(f->height);
  *f = (field){0};
}

static double between(const field *f, const float *grid, double x, double y) {
  const int side = f->side;
  const double cell = PERIOD / side, fx = x / cell, fy = y / cell, ix = floor(fx), iy = floor(fy),
               u = fx - ix, v = fy - iy;
  const int i = (int)ix & (side - 1), j = (int)iy & (side - 1), next = (i + 1) & (side - 1);
  const float *a = grid + j * side, *b = grid + ((j + 1) & (side - 1)) * side;
  return (1 - v) * (a[i] + u * (a[next] - a[i])) + v * (b[i] + u * (b[next] - b[i]));
}

void field_moment(const field *f, double x, double y, double moment[3]) {
  for (int k = 0; k < 3; k++)
    moment[k] = between(f, f->moment[k], x, y);
}

vec field_normal(const field *f, double x, double y) {
  const double sx = between(f, f->slope_x, x, y), sy = between(f, f->slope_y, x, y),
               scale = 1 / sqrt(1 + sx * sx + sy * sy);
  return (vec){-sx * scale, -sy * scale, scale};
}

/* A step is what the gap allows at the steepest slope, but most of a cell at least. */
double field_cast(const field *f, vec from, vec along) {
  const double flat = sqrt(along.x * along.x + along.y * along.y),
               nearing = f->steepest * flat - along.z;
  const double least = 0.6 * PERIOD / f->side / fmax(flat, 0.3);
  double before = 0;
  for (double t = 0; t < 300 && nearing > 0;) {
    const vec p = plus(from, t, along);
    if (along.z > 0 && p.z > f->high)
      return -1;
    const double gap = p.z - between(f, f->height, p.x, p.y);
    if (gap < 0 && t > 0) {
      for (int i = 0; i < 14; i++) {
        const double middle = 0.5 * (before + t);
        const vec q = plus(from, middle, along);
        if (q.z < between(f, f->height, q.x, q.y))
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
