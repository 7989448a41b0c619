/* SPDX-License-Identifier: Apache-2.0 */
/* How steep bumps are near a place, from points that were looked at: docs/theory/horizons.md, Which
 * slopes count. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shade/maps.h"

/* Cells along a side, a power of 2, which hold so many points on the mean. WIDER: windows of a
 * shape over those of moments. */
enum { COARSEST = 8, FINEST = 256, IN_A_CELL = 4, WIDER = 8 };
_Static_assert((int)COARSEST >= (int)WIDER, "a shape has a cell");

static const double least = 1e-10; /* of moments: less is rounding */
static const float none = 1e-3F;   /* of points in a window: fewer say little */

struct shade_relief {
  double whole[5], varies;
  int side, wide; /* cells of moments, of means; 0: there are none */
  float first[2], scale;
  float (*mean)[2]; /* behind the moments */
  float moment[][3];
};

/* Points whose numbers are finite, and what each counts; 1 on the mean. */
typedef struct points {
  size_t count;
  const float *u, *v, *x, *y, *weight;
  double counts, scale;
} points;

static float weight_of(const points *p, size_t i) {
  const float w = p->weight ? p->weight[i] : 1.0F;
  const int finite = isfinite(p->u[i] + p->v[i]) && isfinite(p->x[i] * p->x[i] + p->y[i] * p->y[i]);
  return finite && w > 0 && isfinite(w) ? w * (float)p->scale : 0.0F;
}

/* Sums of slopes in a cell, taken from the mean. */
typedef struct cell {
  float count, x, y, xx, xy, yy;
} cell;

static cell plus(cell a, cell b) {
  return (cell){a.count + b.count, a.x + b.x, a.y + b.y, a.xx + b.xx, a.xy + b.xy, a.yy + b.yy};
}

static const cell *cell_at(const cell *cells, int side, int x, int y) {
  return &cells[(y & (side - 1)) * side + (x & (side - 1))];
}

/* Windows of 3 by 3 cells, by 1, 2 and 1 along either axis: those of 2 come twice. */
static void blur(const cell *cells, int side, cell *to) {
  for (int k = 0; k < side * side; k++) {
    const int x = k % side, y = k / side;
    cell sum = {0};
    for (int j = 0; j < 16; j++)
      sum = plus(sum, *cell_at(cells, side, x + j % 4 / 2 + j % 2 - 1, y + j / 8 + j / 4 % 2 - 1));
    to[k] = sum;
  }
}

static void halve(cell *cells, int side) {
  for (int k = 0; k < side * side / 4; k++) {
    const cell *low = cells + 4 * (k / (side / 2)) * (side / 2) + 2 * (k % (side / 2));
    cells[k] = plus(plus(low[0], low[1]), plus(low[side], low[side + 1]));
  }
}

/* The squares of the means in windows, which is what windows do not hold. */
static double left_out(const cell *cells, const cell *windows, int side) {
  double sum = 0;
  for (int k = 0; k < side * side; k++) {
    const cell w = windows[k];
    if (cells[k].count > 0)
      sum += (double)(cells[k].count * (w.x * w.x + w.y * w.y) / (w.count * w.count));
  }
  return sum;
}

/* The cell that a coordinate lies in, those between whose middles it lies, and how far it is beyond
 * the first. */
typedef struct place {
  int nearest, low, high;
  float past;
} place;

static place place_of(float at, float first, float scale, int side) {
  const float x = (at - first) * scale;
  const float cells = fminf(fmaxf(x - floorf(x), 0.0F), 1.0F) * (float)side;
  const float beyond = cells + ((float)side - 0.5F); /* the middle of a cell, a side farther */
  const int low = (int)beyond, last = side - 1;
  return (place){(int)cells & last, low & last, (low + 1) & last, beyond - (float)low};
}

static float mix(float a, float b, float share) {
  return a + share * (b - a);
}

/* Of a number in each cell, of which there are `per`. */
static float between(const float *number, int per, int side, place x, place y) {
  const float *low = number + y.low * side * per, *high = number + y.high * side * per;
  return mix(mix(low[x.low * per], low[x.high * per], x.past),
             mix(high[x.low * per], high[x.high * per], x.past), y.past);
}

/* The square that the points lie in; all of the period, again and again, where that is larger.
 * About a shape there is a rim as wide as the finest map's cells of means, so that none of its
 * windows reaches the other side; those of a coarser one at the edge do. */
static void frame(const points *p, int shape, shade_relief *r) {
  float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (size_t i = 0; i < p->count; i++) {
    const float at[2] = {p->u[i], p->v[i]};
    for (int k = 0; k < 2 && weight_of(p, i) > 0; k++) {
      low[k] = fminf(low[k], at[k]);
      high[k] = fmaxf(high[k], at[k]);
    }
  }
  const float size = fmaxf(high[0] - low[0], high[1] - low[1]);
  const float rim = shape ? size / (FINEST / WIDER - 2) : 0.01F * size;
  const int repeats = !(size < 1);
  for (int k = 0; k < 2; k++)
    r->first[k] = repeats ? 0 : low[k] - rim;
  r->scale = repeats ? 1 : 1 / fmaxf(size + 2 * rim, 1e-6F);
}

/* Mean slope, and second moment about it. False without points. */
static int moments_of(points *p, double m[5]) {
  double sum[5] = {0};
  p->counts = 0;
  p->scale = 1;
  for (int second = 0; second < 2; second++) {
    for (size_t i = 0; i < p->count; i++) {
      const double w = (double)weight_of(p, i);
      if (!(w > 0))
        continue;
      const double x = (double)p->x[i] - m[0], y = (double)p->y[i] - m[1];
      if (!second) {
        p->counts += w;
        sum[0] += w * (double)p->x[i];
        sum[1] += w * (double)p->y[i];
      } else {
        sum[2] += w * x * x;
        sum[3] += w * x * y;
        sum[4] += w * y * y;
      }
    }
    for (int k = 0; k < 5 && p->counts > 0; k++)
      m[k] = sum[k] / p->counts;
  }
  return p->counts > 0;
}

static void fill(const points *p, const shade_relief *r, cell *cells) {
  for (size_t i = 0; i < p->count; i++) {
    const float w = weight_of(p, i);
    if (!(w > 0))
      continue;
    const float x = p->x[i] - (float)r->whole[0], y = p->y[i] - (float)r->whole[1];
    const int column = place_of(p->u[i], r->first[0], r->scale, r->side).nearest;
    const int row = place_of(p->v[i], r->first[1], r->scale, r->side).nearest;
    cell *to = &cells[row * r->side + column];
    *to = plus(*to, (cell){w, w * x, w * y, w * x * x, w * x * y, w * y * y});
  }
}

/* The variance of moments in windows, over the square of their mean. */
static double varied(const cell *cells, const cell *windows, int side, double sum, double count) {
  double squares = 0;
  for (int k = 0; k < side * side; k++) {
    const cell w = windows[k];
    const double here = cells[k].count > 0 ? (double)((w.xx + w.yy) / w.count) / sum : 0;
    squares += (double)cells[k].count * here * here / count;
  }
  return squares - 1;
}

/* Moments in windows count the more, not that of all, the more they vary: waves' are even enough,
 * and where half of a map is flat they count wholly. */
static float nearness(double varies) {
  const double even = SHADE_RELIEF_EVEN, uneven = 0.8;
  return (float)fmin(fmax((varies - even) / (uneven - even), 0), 1);
}

/* What lies on a mean. */
static cell about(cell c, float x, float y) {
  return (cell){c.count,
                c.x - c.count * x,
                c.y - c.count * y,
                c.xx + x * (c.count * x - 2 * c.x),
                c.xy + c.count * x * y - x * c.y - y * c.x,
                c.yy + y * (c.count * y - 2 * c.y)};
}

/* The mean in wide windows, and what is left of cells about it; `spare` has room for them. */
static void detrend(const cell *cells, int side, float (*mean)[2], cell *left, cell *spare) {
  const int wide = side / WIDER;
  const float cell_size = 1 / (float)side;
  memcpy(left, cells, (size_t)side * (size_t)side * sizeof *cells);
  for (int k = side; k > wide; k /= 2)
    halve(left, k);
  blur(left, wide, spare);
  for (int k = 0; k < wide * wide; k++) {
    mean[k][0] = spare[k].x / (spare[k].count + none);
    mean[k][1] = spare[k].y / (spare[k].count + none);
  }
  for (int k = 0; k < side * side; k++) {
    const float u = ((float)(k % side) + 0.5F) * cell_size;
    const float v = ((float)(k / side) + 0.5F) * cell_size;
    const place x = place_of(u, 0, 1, wide), y = place_of(v, 0, 1, wide);
    left[k] = about(cells[k], between(mean[0], 2, wide, x, y), between(mean[0] + 1, 2, wide, x, y));
  }
}

/* The moments about a shape; its mean becomes that of all slopes, not what it adds to theirs. */
static void set_rest(const cell *left, shade_relief *r, double counts) {
  double sum[3] = {0};
  for (int k = 0; k < r->side * r->side; k++) {
    const float of[3] = {left[k].xx, left[k].xy, left[k].yy};
    for (int i = 0; i < 3; i++)
      sum[i] += (double)of[i] / counts;
  }
  for (int i = 0; i < 3; i++)
    r->whole[2 + i] = i == 1 ? sum[i] : fmax(sum[i], least);
  for (int k = 0; k < r->wide * r->wide; k++)
    for (int i = 0; i < 2; i++)
      r->mean[k][i] += (float)r->whole[i];
}

static void set_moments(const cell *windows, shade_relief *r) {
  const float near = nearness(r->varies);
  for (int k = 0; k < r->side * r->side; k++) {
    const cell w = windows[k];
    const float here[3] = {w.xx, w.xy, w.yy}, part = near / (w.count + none);
    for (int i = 0; i < 3; i++) { /* where nothing was seen that of all */
      const float whole = (float)r->whole[2 + i];
      r->moment[k][i] = whole + part * (here[i] - w.count * whole);
    }
    for (int i = 0; i < 3; i += 2) /* about a shape they are differences, which round */
      r->moment[k][i] = fmaxf(r->moment[k][i], 0);
  }
}

/* The finest windows, of so many cells along a side or fewer, that hold four fifths of the
 * variance, and how much they vary; of a shape, what they do not hold has to be in its own windows.
 */
static int find_windows(const points *p, int shape, shade_relief *r) {
  const double most = 0.2 * (r->whole[2] + r->whole[4]) * p->counts;
  const size_t room = (size_t)r->side * (size_t)r->side;
  cell *cells = calloc((shape ? 3 : 2) * room, sizeof *cells), *left = cells;
  if (!cells)
    return 0;
  cell *windows = cells + room;
  fill(p, r, cells);
  for (;; r->side /= 2) {
    if (shape)
      detrend(cells, r->side, r->mean, left = windows + room, windows);
    blur(left, r->side, windows);
    if (r->side == COARSEST || left_out(left, windows, r->side) <= most)
      break;
    halve(cells, r->side);
  }
  r->wide = shape ? r->side / WIDER : 0;
  if (shape)
    set_rest(left, r, p->counts);
  r->varies = varied(left, windows, r->side, r->whole[2] + r->whole[4], p->counts);
  set_moments(windows, r);
  if (!shape && !(nearness(r->varies) > 0))
    r->side = 0;
  free(cells);
  return 1;
}

static int side_for(size_t count) {
  int side = COARSEST;
  while (side < FINEST && (size_t)side * (size_t)side * (2 * IN_A_CELL) <= count)
    side *= 2;
  return side;
}

shade_relief *shade_relief_create(size_t count, const float *u, const float *v, const float *x,
                                  const float *y, const float *weight, int shape) {
  points p = {u && v && x && y ? count : 0, u, v, x, y, weight, 0, 1};
  const int side = side_for(p.count);
  const size_t room = (size_t)side * (size_t)side, wide = room / (WIDER * WIDER);
  shade_relief *r = calloc(1, sizeof *r + room * sizeof *r->moment + wide * sizeof *r->mean);
  if (!r)
    return NULL;
  r->mean = (float(*)[2])(r->moment + room);
  if (!moments_of(&p, r->whole) || !(r->whole[2] + r->whole[4] > least))
    return r;
  p.scale = (double)p.count / p.counts;
  p.counts = (double)p.count;
  r->side = side;
  frame(&p, shape, r);
  if (!find_windows(&p, shape, r)) {
    free(r);
    return NULL;
  }
  return r;
}

void shade_relief_free(shade_relief *r) {
  free(r);
}

double shade_relief_whole(const shade_relief *r, double slopes[5]) {
  memcpy(slopes, r->whole, sizeof r->whole);
  return r->varies;
}

void shade_relief_lookup_batchf(const shade_relief *r, size_t count, const float *u, const float *v,
                                float *const slopes[5]) {
  for (size_t i = 0; i < count; i++) {
    const int there = isfinite(u[i]) && isfinite(v[i]);
    for (int part = 0; part < 2; part++) { /* means, moments */
      const int first = part ? 2 : 0, number = part ? 3 : 2;
      const int side = there ? (part ? r->side : r->wide) : 0;
      place x = {0}, y = {0};
      if (side > 0) {
        x = place_of(u[i], r->first[0], r->scale, side);
        y = place_of(v[i], r->first[1], r->scale, side);
      }
      const float *const of = part ? r->moment[0] : r->mean[0];
      for (int k = 0; k < number; k++)
        if (slopes[first + k])
          slopes[first + k][i] =
              side > 0 ? between(of + k, number, side, x, y) : (float)r->whole[first + k];
    }
  }
}
