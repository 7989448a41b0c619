/* SPDX-License-Identifier: Apache-2.0 */
/* A field of scratches: pits drawn from a seed, evaluation, pictures. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "src/scratch.h"

#define PI 3.14159265358979323846

/* ---- drawing pits ------------------------------------------------------------------ */

/* In [0, 1): a function of its arguments, so that each pit stays when others come. */
static double draw(uint64_t seed, uint64_t group, uint64_t index, uint64_t number) {
  const uint64_t pit_seed = scratch_mix(scratch_mix(scratch_mix(seed) ^ group) ^ index);
  const uint64_t z = scratch_mix(pit_seed ^ number);
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
  const double along_x = r * s * made.along[0], along_y = r * s * made.along[1];
  const double across_x = r * made.along[1], across_y = r * made.along[0];
  made.reach[0] = sqrt(along_x * along_x + across_x * across_x);
  made.reach[1] = sqrt(along_y * along_y + across_y * across_y);
  /* rounding must not leave a place that is deeper */
  made.depth = made.scale * (1 - made.rim) * (1 + 1e-9);
  return made;
}

/* Where a pit stands in the order: moving these takes less than moving pits. */
typedef struct pit_place {
  double depth;
  uint32_t number;
} pit_place;

/* Greater for smaller ones. */
static unsigned byte_of(double x, int shift) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return ~(unsigned)(bits >> shift) & 0xff;
}

/*
 * The deepest first; on equal depth the one that was drawn first, as they come: byte by byte of the
 * depths, which are not negative. `room` is as long.
 */
static void sort_places(pit_place *place, pit_place *room, size_t count) {
  for (int shift = 0; shift < 64; shift += 8) {
    size_t begin[257] = {0};
    for (size_t i = 0; i < count; i++)
      begin[byte_of(place[i].depth, shift) + 1]++;
    for (int k = 0; k < 256; k++)
      begin[k + 1] += begin[k];
    for (size_t i = 0; i < count; i++)
      room[begin[byte_of(place[i].depth, shift)]++] = place[i];
    memcpy(place, room, count * sizeof *place);
  }
}

/* Bring them to their places, those of place[i] to i, with room for one. */
static void move_pits(pit *pits, pit_place *place, size_t count) {
  const uint32_t moved = UINT32_MAX;
  for (size_t begin = 0; begin < count; begin++) {
    if (place[begin].number == moved)
      continue;
    const pit first = pits[begin];
    size_t to = begin;
    for (uint32_t from; (from = place[to].number) != begin; to = from) {
      pits[to] = pits[from];
      place[to].number = moved;
    }
    pits[to] = first;
    place[to].number = moved;
  }
}

/* All pits of the layers, sorted. 0, or -1 when out of memory. */
static int make_pits(shade_scratch_field *f, const shade_scratch_params *p) {
  size_t pits = 0;
  for (int i = 0; i < p->layers; i++)
    pits += p->layer[i].pits;
  f->pit = malloc((pits + 1) * sizeof *f->pit);
  pit_place *place = malloc(2 * (pits + 1) * sizeof *place);
  const int status = f->pit && place ? 0 : -1;
  for (int i = 0; status == 0 && i < p->layers; i++)
    for (uint32_t k = 0; k < p->layer[i].pits; k++, f->pits++) {
      pit *made = &f->pit[f->pits];
      *made = make_pit(p, i, k);
      made->number = (uint32_t)f->pits;
      place[f->pits] = (pit_place){made->depth, made->number};
    }
  if (status == 0) {
    sort_places(place, place + pits, f->pits);
    move_pits(f->pit, place, f->pits);
  }
  free(place);
  return status;
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
  if (given && given->size >= sizeof given->size)
    memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  else if (given)
    *status |= SHADE_BAD_INPUT;
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
    if (p->depth < -lowest)
      break; /* and so are all that follow */
    const double dx = round_tile(x - p->x, 1), dy = round_tile(y - p->y, f->aspect);
    const double a = (p->along[0] * dx + p->along[1] * dy) / p->half_along;
    const double b = (p->along[0] * dy - p->along[1] * dx) / p->half_across;
    const double rho2 = a * a + b * b;
    if (!(rho2 < 1))
      continue;
    const double w = sqrt(1 - p->k2 * rho2), h = -p->scale * (w - p->rim);
    if (h < lowest || (deepest && h == lowest && p->number < deepest->number)) {
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
      shade_moments_add(out, 1.0 / (n1 * n2), h, slope[0], slope[1]);
    }
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
  if (make_pits(f, &p) != 0 || shade_scratch_fill_bins(f) != 0 ||
      (p.cells > 0 &&
       shade_scratch_make_table(f, p.cells, shade_isa_tables[shade_isa_chosen()]) != 0)) {
    shade_scratch_free(f);
    return NULL;
  }
  return f;
}

void shade_scratch_free(shade_scratch_field *f) {
  if (!f)
    return;
  if (f->has_table)
    shade_moments_free(&f->table);
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
  shade_moments_flat(slopes);
  if (height)
    *height = 0;
  if (!finite)
    return SHADE_BAD_INPUT;
  u = unit(u);
  v = unit(v);
  const double extent = f->has_table ? shade_moments_extent(&f->table, side) : 0;
  const double blend = f->has_table ? shade_moments_blend(extent) : 0;
  if (blend < 1) {
    const double cell = f->has_table ? 1.0 / f->table.level[0].width : 0;
    const double spacing = f->has_table ? cell / f->steps : 1e-4;
    sample(f, u, v, side, steps(hypot(side[0], side[1] * f->aspect), spacing),
           steps(hypot(side[2], side[3] * f->aspect), spacing), moments);
  }
  if (blend > 0) {
    shade_moments_lookup(&f->table, u, v, side, far);
    for (int c = 0; c < MOMENTS; c++)
      moments[c] += blend * (far[c] - moments[c]);
  }
  shade_moments_slopes(moments, slopes);
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
