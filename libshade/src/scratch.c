/* SPDX-License-Identifier: Apache-2.0 */
/* A field of scratches: pits drawn from a seed, bins over the tile, evaluation, pictures. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "shade/maps.h"
#include "src/moments.h"

#define PI 3.14159265358979323846

/* What evaluation reads of one pit. */
typedef struct pit {
  double x, y;       /* centre, in tile widths */
  double along[2];   /* unit, along the scratch */
  double half_along; /* half axes of the rim */
  double half_across;
  double k2, rim;   /* k^2; sqrt(1 - k^2) */
  double scale;     /* r/k */
  double gradient1; /* k/s */
  double gradient2; /* k */
} pit;

struct shade_scratch_field {
  double aspect;
  size_t pits;
  pit *pit;
  int across, up;  /* bins */
  uint32_t *start; /* bins + 1: where a bin's list begins */
  uint32_t *list;  /* pits over each bin, in order */
  int has_table, samples;
  uint64_t seed;
  moment_pyramid table;
};

/* ---- drawing pits ------------------------------------------------------------------ */

static uint64_t mix(uint64_t z) { /* splitmix64's */
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* In [0, 1): a function of its arguments, so that each pit stays when others come. */
static double draw(uint64_t seed, uint64_t group, uint64_t index, uint64_t number) {
  const uint64_t z = mix(mix(mix(mix(seed) ^ group) ^ index) ^ number);
  return (double)(z >> 11) * 0x1p-53;
}

enum { DRAW_X, DRAW_Y, DRAW_RADIUS, DRAW_STRETCH, DRAW_DEPTH, DRAW_DIRECTION };

static double between(shade_range r, double t) {
  return r.low + (r.high - r.low) * t;
}

static pit make_pit(const shade_scratch_params *p, int layer, uint32_t index) {
  const shade_scratch_layer *l = &p->layer[layer];
  double random[6];
  for (int i = 0; i < 6; i++)
    random[i] = draw(p->seed, (uint64_t)layer, index, (uint64_t)i);
  const double most = 0.5 * fmin(1, p->aspect); /* a pit must not meet itself round the tile */
  const double ratio = l->radius.high / l->radius.low;
  const double r = fmin(l->radius.low * pow(ratio, random[DRAW_RADIUS]), most);
  const double s = fmin(between(l->stretch, random[DRAW_STRETCH]), most / r);
  const double d = between(l->depth, random[DRAW_DEPTH]);
  const double angle = l->direction + l->spread * (2 * random[DRAW_DIRECTION] - 1);
  const double k = 2 * d / (1 + d * d);
  pit made = {.x = random[DRAW_X],
              .y = random[DRAW_Y] * p->aspect,
              .along = {cos(angle), sin(angle)},
              .half_along = r * s,
              .half_across = r,
              .k2 = k * k,
              .rim = (1 - d * d) / (1 + d * d),
              .scale = k > 0 ? r / k : 0,
              .gradient1 = k / s,
              .gradient2 = k};
  return made;
}

/* ---- parameters --------------------------------------------------------------------- */

static const shade_scratch_layer fine_scratches = {.pits = 5000,
                                                   .radius = {0.0005, 0.002},
                                                   .stretch = {20, 60},
                                                   .depth = {0.05, 0.25},
                                                   .direction = 0,
                                                   .spread = 10 * PI / 180};

void shade_scratch_params_init(shade_scratch_params *p) {
  memset(p, 0, sizeof *p);
  p->size = sizeof *p;
  p->seed = 1;
  p->aspect = 1;
  p->cells = 512;
  p->layers = 1;
  for (int i = 0; i < SHADE_SCRATCH_LAYERS; i++)
    p->layer[i] = fine_scratches;
}

static double clamp(double x, double low, double high, double otherwise, unsigned *status) {
  const double y = isnan(x) ? otherwise : fmin(fmax(x, low), high);
  if (!(y == x))
    *status |= SHADE_CLAMPED_PARAMETER;
  return y;
}

static shade_range clamp_range(shade_range r, double low, double high, shade_range otherwise,
                               unsigned *status) {
  shade_range y = {clamp(r.low, low, high, otherwise.low, status),
                   clamp(r.high, low, high, otherwise.high, status)};
  if (y.low > y.high) {
    const double swap = y.low;
    y.low = y.high;
    y.high = swap;
    *status |= SHADE_CLAMPED_PARAMETER;
  }
  return y;
}

static shade_scratch_params within_ranges(const shade_scratch_params *given, unsigned *status) {
  shade_scratch_params p;
  shade_scratch_params_init(&p);
  memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  p.aspect = clamp(p.aspect, 1e-3, 1e3, 1, status);
  p.cells = (int)clamp(p.cells, 0, 4096, 0, status);
  p.layers = (int)clamp(p.layers, 0, SHADE_SCRATCH_LAYERS, 0, status);
  uint32_t left = SHADE_SCRATCH_MAX_PITS;
  for (int i = 0; i < p.layers; i++) {
    shade_scratch_layer *l = &p.layer[i];
    const shade_scratch_layer *f = &fine_scratches;
    if (l->pits > left) {
      l->pits = left;
      *status |= SHADE_CLAMPED_PARAMETER;
    }
    left -= l->pits;
    l->radius = clamp_range(l->radius, 1e-6, 0.5, f->radius, status);
    l->stretch = clamp_range(l->stretch, 1, 1e5, f->stretch, status);
    l->depth = clamp_range(l->depth, 0, 0.99, f->depth, status);
    l->direction = clamp(l->direction, -1e6, 1e6, f->direction, status);
    l->spread = clamp(l->spread, 0, PI / 2, f->spread, status);
  }
  return p;
}

/* ---- bins --------------------------------------------------------------------------- */

/*
 * Side of a bin. A smaller one holds fewer pits that miss the point, but long pits then
 * fill many: halve it while that still pays and the lists stay short.
 */
static double bin_side(const shade_scratch_field *f) {
  const double most_bins = 4e6, most_listed = 16e6 + 16 * (double)f->pits;
  double side = fmin(sqrt(f->aspect / fmax((double)f->pits, 1)), fmin(1, f->aspect));
  double covering = 0; /* pits over a point, on average */
  for (size_t i = 0; i < f->pits; i++)
    covering += PI * f->pit[i].half_along * f->pit[i].half_across / f->aspect;
  for (;;) {
    double listed = 0; /* pits in a bin, on average */
    for (size_t i = 0; i < f->pits; i++)
      listed += (2 * f->pit[i].half_along + side) * (2 * f->pit[i].half_across + side) / f->aspect;
    const double halved = 4 * f->aspect / (side * side); /* bins of half the side */
    if (listed <= 2 * covering + 1 || halved > most_bins || listed * halved > most_listed)
      return side;
    side /= 2;
  }
}

static int wrap(int i, int n) {
  i %= n;
  return i < 0 ? i + n : i;
}

/*
 * Visit the bins under a pit's ellipse, row by row of bins. Without a list count[bin + 1]
 * grows by one each; with a list the pit is put at list[count[bin]++].
 */
static void visit(const shade_scratch_field *f, uint32_t index, uint32_t *count, uint32_t *list) {
  const pit *p = &f->pit[index];
  const double c = p->along[0], s = p->along[1];
  const double a2 = 1 / (p->half_along * p->half_along), b2 = 1 / (p->half_across * p->half_across);
  /* A x^2 + 2 B x y + C y^2 <= 1 */
  const double A = c * c * a2 + s * s * b2, B = c * s * (a2 - b2), C = s * s * a2 + c * c * b2;
  const double det = a2 * b2, reach = sqrt(A / det), y_right = -B * sqrt(1 / (C * det));
  const double width = 1.0 / f->across, height = f->aspect / f->up;
  const double margin = 1e-9; /* of a bin, against rounding */
  const int first = (int)floor((p->y - reach) / height - margin);
  const int last = (int)floor((p->y + reach) / height + margin);
  for (int row = first; row <= last; row++) {
    const double y0 = fmin(fmax((row - margin) * height - p->y, -reach), reach);
    const double y1 = fmin(fmax((row + 1 + margin) * height - p->y, -reach), reach);
    /* the right edge bulges most at y_right, the left one at -y_right */
    const double right = fmin(fmax(y_right, y0), y1), left = fmin(fmax(-y_right, y0), y1);
    const double x1 = -B / A * right + sqrt(fmax(0, 1 / A - det * right * right / (A * A)));
    const double x0 = -B / A * left - sqrt(fmax(0, 1 / A - det * left * left / (A * A)));
    const int begin = (int)floor((p->x + x0) / width - margin);
    int end = (int)floor((p->x + x1) / width + margin);
    if (end - begin >= f->across)
      end = begin + f->across - 1;
    const size_t base = (size_t)wrap(row, f->up) * (size_t)f->across;
    for (int column = begin; column <= end; column++) {
      const size_t bin = base + (size_t)wrap(column, f->across);
      if (list)
        list[count[bin]++] = index;
      else
        count[bin + 1]++;
    }
  }
}

static int fill_bins(shade_scratch_field *f) {
  const double side = bin_side(f);
  f->across = (int)fmin(fmax(floor(1 / side), 1), 1e6);
  f->up = (int)fmin(fmax(floor(f->aspect / side), 1), 1e6);
  const size_t bins = (size_t)f->across * (size_t)f->up;
  f->start = calloc(bins + 2, sizeof *f->start);
  if (!f->start)
    return -1;
  /* counted one place on, so that filling moves start[bin + 1] to where bin + 1 begins */
  for (size_t i = 0; i < f->pits; i++)
    if (f->pit[i].k2 > 0)
      visit(f, (uint32_t)i, f->start + 1, NULL);
  for (size_t i = 0; i <= bins; i++)
    f->start[i + 1] += f->start[i];
  const size_t total = f->start[bins + 1];
  f->list = malloc((total + 1) * sizeof *f->list);
  if (!f->list)
    return -1;
  for (size_t i = 0; i < f->pits; i++)
    if (f->pit[i].k2 > 0)
      visit(f, (uint32_t)i, f->start + 1, f->list);
  return 0;
}

/* ---- evaluation ----------------------------------------------------------------------- */

static double unit(double x) { /* in [0, 1), also where rounding would give 1 */
  x -= floor(x);
  return x < 1 ? x : 0;
}

/* Shortest way round. |d| < period. */
static double round_tile(double d, double period) {
  return d > 0.5 * period ? d - period : d < -0.5 * period ? d + period : d;
}

/* Height and gradient at a point of the tile. */
static double evaluate(const shade_scratch_field *f, double u, double v, double slope[2]) {
  const double x = unit(u), y = unit(v) * f->aspect;
  int column = (int)(x * f->across), row = (int)(y / f->aspect * f->up);
  column = column < f->across ? column : f->across - 1;
  row = row < f->up ? row : f->up - 1;
  const size_t bin = (size_t)row * (size_t)f->across + (size_t)column;
  const pit *deepest = NULL;
  double lowest = 0, root = 1, q1 = 0, q2 = 0;
  for (uint32_t i = f->start[bin]; i < f->start[bin + 1]; i++) {
    const pit *p = &f->pit[f->list[i]];
    const double dx = round_tile(x - p->x, 1), dy = round_tile(y - p->y, f->aspect);
    const double a = (p->along[0] * dx + p->along[1] * dy) / p->half_along;
    const double b = (p->along[0] * dy - p->along[1] * dx) / p->half_across;
    const double rho2 = a * a + b * b;
    if (!(rho2 < 1))
      continue;
    const double w = sqrt(1 - p->k2 * rho2), h = -p->scale * (w - p->rim);
    if (h < lowest) {
      deepest = p;
      lowest = h;
      root = w;
      q1 = a;
      q2 = b;
    }
  }
  slope[0] = slope[1] = 0;
  if (!deepest)
    return 0;
  const double g1 = deepest->gradient1 * q1 / root, g2 = deepest->gradient2 * q2 / root;
  slope[0] = g1 * deepest->along[0] - g2 * deepest->along[1];
  slope[1] = g1 * deepest->along[1] + g2 * deepest->along[0];
  return lowest;
}

/* Mean moments over n1 x n2 points of a parallelogram. */
static void sample(const shade_scratch_field *f, double u, double v, const double side[4], int n1,
                   int n2, double out[MOMENTS]) {
  for (int i = 0; i < n1; i++)
    for (int j = 0; j < n2; j++) {
      const double s = (i + 0.5) / n1 - 0.5, t = (j + 0.5) / n2 - 0.5;
      double slope[2];
      const double h =
          evaluate(f, u + s * side[0] + t * side[2], v + s * side[1] + t * side[3], slope);
      moments_add(out, 1.0 / (n1 * n2), h, slope[0], slope[1]);
    }
}

/* ---- the table for footprints ---------------------------------------------------------- */

static void table_row(const void *context, int j, float *to) {
  const shade_scratch_field *f = context;
  const int width = f->table.level[0].width, height = f->table.level[0].height, n = f->samples;
  for (int i = 0; i < width; i++) {
    double sum[MOMENTS] = {0};
    for (int k = 0; k < n * n; k++) {
      const uint64_t cell = (uint64_t)j * (uint64_t)width + (uint64_t)i;
      const uint64_t jitter = mix(mix(f->seed ^ 0x7461626c65u) ^ (cell * 64 + (uint64_t)k));
      const double a = (double)(jitter >> 32) * 0x1p-32;
      const double b = (double)(jitter & 0xffffffffu) * 0x1p-32;
      double slope[2];
      const double u = (i + (k % n + a) / n) / width, v = 1 - (j + (k / n + b) / n) / height;
      const double h = evaluate(f, u, v, slope);
      moments_add(sum, 1.0 / (n * n), h, slope[0], slope[1]);
    }
    for (int c = 0; c < MOMENTS; c++)
      to[i * MOMENTS + c] = (float)sum[c];
  }
}

/* Cells of the table; samples a cell's side so that even narrow pits are met. */
static int make_table(shade_scratch_field *f, int cells) {
  const int width = f->aspect > 1 ? (int)ceil(cells / f->aspect) : cells;
  const int height = f->aspect > 1 ? cells : (int)ceil(cells * f->aspect);
  double radius = 0;
  for (size_t i = 0; i < f->pits; i++)
    radius += f->pit[i].half_across / (double)f->pits;
  f->samples = (int)fmin(fmax(ceil(2 / (fmax(radius, 1e-9) * width)), 4), 8);
  /* table_row reads the size of level 0, which is this one */
  f->table.level[0].width = width;
  f->table.level[0].height = height;
  moment_pyramid made;
  const int status = moments_create(&made, width, height, 1, WRAP_REPEAT, table_row, f);
  f->table = made;
  f->has_table = 1;
  return status;
}

/* ---- public ------------------------------------------------------------------------------ */

shade_scratch_field *shade_scratch_create(const shade_scratch_params *given, unsigned *status) {
  unsigned found = SHADE_OK;
  const shade_scratch_params p = within_ranges(given, &found);
  if (status)
    *status = found;
  shade_scratch_field *f = calloc(1, sizeof *f);
  if (!f)
    return NULL;
  f->aspect = p.aspect;
  f->seed = p.seed;
  size_t pits = 0;
  for (int i = 0; i < p.layers; i++)
    pits += p.layer[i].pits;
  f->pit = malloc((pits + 1) * sizeof *f->pit);
  if (!f->pit) {
    shade_scratch_free(f);
    return NULL;
  }
  for (int i = 0; i < p.layers; i++)
    for (uint32_t k = 0; k < p.layer[i].pits; k++)
      f->pit[f->pits++] = make_pit(&p, i, k);
  if (fill_bins(f) != 0 || (p.cells > 0 && make_table(f, p.cells) != 0)) {
    shade_scratch_free(f);
    return NULL;
  }
  return f;
}

void shade_scratch_free(shade_scratch_field *f) {
  if (!f)
    return;
  if (f->has_table)
    moments_free(&f->table);
  free(f->pit);
  free(f->start);
  free(f->list);
  free(f);
}

static int steps(double length, double spacing) {
  const double least = 4, most = 32;
  return length > 0 ? (int)fmin(fmax(ceil(length / spacing), least), most) : 1;
}

unsigned shade_scratch_eval(const shade_scratch_field *f, double u, double v,
                            const double footprint[4], double *height, shade_slopes *slopes) {
  double side[4] = {0}, moments[MOMENTS] = {0}, far[MOMENTS] = {0};
  int finite = isfinite(u) && isfinite(v);
  for (int i = 0; i < 4 && footprint; i++) {
    finite = finite && isfinite(footprint[i]);
    side[i] = fmin(fmax(footprint[i], -1e3), 1e3);
  }
  moments_flat(slopes);
  if (height)
    *height = 0;
  if (!finite)
    return SHADE_BAD_INPUT;
  u = unit(u);
  v = unit(v);
  const double extent = f->has_table ? moments_extent(&f->table, side) : 0;
  const double blend = f->has_table ? moments_blend(extent) : 0;
  if (blend < 1) {
    const double cell = f->has_table ? 1.0 / f->table.level[0].width : 0;
    const double spacing = f->has_table ? cell / f->samples : 1e-4;
    sample(f, u, v, side, steps(hypot(side[0], side[1] * f->aspect), spacing),
           steps(hypot(side[2], side[3] * f->aspect), spacing), moments);
  }
  if (blend > 0) {
    moments_lookup(&f->table, u, v, side, far);
    for (int c = 0; c < MOMENTS; c++)
      moments[c] += blend * (far[c] - moments[c]);
  }
  moments_slopes(moments, slopes);
  if (height)
    *height = moments[MOMENT_H];
  return SHADE_OK;
}

void shade_scratch_rows(const shade_scratch_field *f, int width, int rows, int first, int count,
                        int samples, float *height, float *normal) {
  const double texel[4] = {1.0 / width, 0, 0, 1.0 / rows};
  const int n = samples < 1 ? 1 : samples;
  for (int j = first; j < first + count; j++)
    for (int i = 0; i < width; i++) {
      const size_t at = (size_t)(j - first) * (size_t)width + (size_t)i;
      double moments[MOMENTS] = {0};
      sample(f, (i + 0.5) / width, 1 - (j + 0.5) / rows, texel, n, n, moments);
      if (height)
        height[at] = (float)moments[MOMENT_H];
      if (normal) {
        const double x = moments[MOMENT_X], y = moments[MOMENT_Y];
        const double inverse = 1 / sqrt(x * x + y * y + 1);
        normal[3 * at] = (float)(-x * inverse);
        normal[3 * at + 1] = (float)(-y * inverse);
        normal[3 * at + 2] = (float)inverse;
      }
    }
}
