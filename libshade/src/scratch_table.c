/* SPDX-License-Identifier: Apache-2.0 */
/* The table that answers footprints of a field of scratches, from jittered samples. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "batch/isa.h"
#include "src/scratch.h"
#include "batch/scratch_row.h"

_Static_assert((int)SCRATCH_MOMENTS == (int)MOMENTS, "a texel of moments.h");

/* An image of a pit, by the first band that it reaches. */
typedef struct image {
  uint32_t pit, shift; /* shift: 3 * that along y + that along x, each 0 to 2 for -1 to 1 */
} image;

typedef struct drawing {
  const shade_scratch_field *f;
  const shade_isa_table *isa;
  int width, height;
  int band, bands; /* rows of cells that are made together; how often */
  uint32_t *start; /* bands + 1: where a band's images begin */
  image *image;
  scratch_stroke *pool;           /* those of the band, anywhere; `room` long, as the lists are */
  uint32_t *active, *next, *idle; /* places in it: of the band, of the next one, of nobody */
  size_t actives, idles, room;
  int failed; /* out of memory */
  scratch_row row;
} drawing;

/* The pit as the table's samples see it. */
static scratch_stroke stroke_of(const drawing *d, const image *m) {
  const shade_scratch_field *f = d->f;
  const pit *p = &f->pit[m->pit];
  const double across = d->row.across * d->width, lines = d->row.down * d->height;
  const double px = 1 / across, py = -f->aspect / lines, k = sqrt(p->k2), r = p->half_across;
  const double c = p->along[0], s = p->along[1];
  const double ax = c * px / p->half_along, ay = s * py / p->half_along;
  const double bx = -s * px / r, by = c * py / r;
  /* A u^2 + 2 B u v + C v^2 <= 1 */
  const double A = ax * ax + bx * bx, B = ax * ay + bx * by, C = ay * ay + by * by;
  const double root = fabs(ax * by - ay * bx), det = root * root;
  scratch_stroke o = {.x = (p->x + (int)(m->shift % 3) - 1) * across,
                      .y = (1 - p->y / f->aspect + (int)(m->shift / 3) - 1) * lines,
                      .reach = sqrt(A) / root,
                      .lean = -B / A,
                      .half = 1 / A,
                      .bend = det / (A * A),
                      .bulge = -B / (root * sqrt(C)),
                      .ax = (float)ax,
                      .ay = (float)ay,
                      .bx = (float)bx,
                      .by = (float)by,
                      .depth = (float)p->depth,
                      .linear = (float)(2 * p->rim / (k * r)),
                      .square = (float)(1 / (r * r)),
                      .rk = (float)(r * k),
                      .k2 = (float)p->k2,
                      .rim = (float)p->rim,
                      .xa = (float)(p->gradient1 * c),
                      .xb = (float)(-p->gradient2 * s),
                      .ya = (float)(p->gradient1 * s),
                      .yb = (float)(p->gradient2 * c),
                      .rank = m->pit};
  return o;
}

/* Visit the images of a pit that meet the table. Without `image` counts them in
 * start[band + 1]. */
static void visit(drawing *d, uint32_t index, image *to) {
  const shade_scratch_field *f = d->f;
  const pit *p = &f->pit[index];
  const double least =
      1e-12; /* k^2 below which single precision knows no pit, nor does a picture */
  if (!(p->k2 > least * least))
    return;
  const double x_reach = p->reach[0], y_reach = p->reach[1];
  for (int shift = 0; shift < 9; shift++) {
    const double x = p->x + (shift % 3 - 1), y = 1 - p->y / f->aspect + (shift / 3 - 1);
    const double top = (y - y_reach / f->aspect) * d->height;
    const double bottom = (y + y_reach / f->aspect) * d->height;
    if (x + x_reach < 0 || x - x_reach > 1 || bottom < 0 || top > d->height)
      continue;
    int row = (int)floor(fmax(top - 1e-3, 0));
    row = row < d->height ? row : d->height - 1;
    if (to)
      to[d->start[row / d->band]++] = (image){index, (uint32_t)shift};
    else
      d->start[row / d->band + 1]++;
  }
}

/* Images sorted by their first band; within it the deepest comes first, as the pits do. */
static int sort_images(drawing *d) {
  const size_t bands = (size_t)d->bands;
  d->start = calloc(bands + 2, sizeof *d->start);
  if (!d->start)
    return -1;
  d->start++; /* counted one place on, so that filling moves start[band] to where it begins */
  for (size_t i = 0; i < d->f->pits; i++)
    visit(d, (uint32_t)i, NULL);
  for (size_t i = 0; i < bands; i++)
    d->start[i + 1] += d->start[i];
  const size_t total = d->start[bands];
  d->image = malloc((total + 1) * sizeof *d->image);
  for (size_t i = 0; d->image && i < d->f->pits; i++)
    visit(d, (uint32_t)i, d->image);
  d->start--;
  return d->image ? 0 : -1;
}

/* `list` grown to `room`, or NULL and what was there freed. */
static uint32_t *grown(uint32_t *list, size_t room) {
  uint32_t *more = realloc(list, room * sizeof *more);
  if (!more)
    free(list);
  return more;
}

static int make_room(drawing *d, size_t room) {
  scratch_stroke *pool = realloc(d->pool, room * sizeof *pool);
  d->pool = pool ? pool : d->pool;
  d->active = grown(d->active, room);
  d->next = grown(d->next, room);
  d->idle = grown(d->idle, room);
  free(d->row.span);
  d->row.span = malloc(SCRATCH_LINES * room * sizeof *d->row.span);
  if (!pool || !d->active || !d->next || !d->idle || !d->row.span)
    return -1;
  for (size_t i = room; i-- > d->room;)
    d->idle[d->idles++] = (uint32_t)i;
  d->room = room;
  return 0;
}

/* The strokes of band j: of those that were there the ones that still are, and new ones, by rank.
 */
static int advance(drawing *d, int j) {
  const uint32_t end = d->start[j + 1];
  uint32_t k = d->start[j];
  const size_t most = d->actives + (end - k);
  if (most > d->room && make_room(d, 2 * most) != 0)
    return -1;
  const double top = (double)(j * d->band) * d->row.down - 1e-3;
  uint32_t *to = d->next;
  for (size_t old = 0; old < d->actives || k < end;) {
    const uint32_t place = old < d->actives ? d->active[old] : 0;
    const scratch_stroke *s = &d->pool[place];
    if (k == end || (old < d->actives && s->rank <= d->image[k].pit)) {
      if (s->y + s->reach >= top)
        *to++ = place;
      else
        d->idle[d->idles++] = place;
      old++;
    } else {
      const uint32_t free_place = d->idle[--d->idles];
      if (k + 4 < end) /* pits lie anywhere in memory */
        __builtin_prefetch(&d->f->pit[d->image[k + 4].pit]);
      d->pool[free_place] = stroke_of(d, &d->image[k++]);
      *to++ = free_place;
    }
  }
  d->actives = (size_t)(to - d->next);
  to = d->next;
  d->next = d->active;
  d->active = to;
  return 0;
}

/* Row j of the table, of which a band is made together. */
static void table_row(const void *context, int j, float *to) {
  drawing *d = *(drawing *const *)context;
  const size_t size = (size_t)d->width * MOMENTS;
  const int rest = d->height - j, of_band = j % d->band;
  if (of_band == 0 && !d->failed) {
    d->failed = advance(d, j / d->band) != 0;
    d->row.row = j;
    d->row.rows = rest < d->band ? rest : d->band;
    d->row.pool = d->pool;
    d->row.stroke = d->active;
    d->row.strokes = d->actives;
    d->row.room = d->room;
    if (!d->failed)
      d->isa->entries->scratch_row(&d->row);
  }
  if (d->failed)
    memset(to, 0, size * sizeof *to);
  else
    memcpy(to, d->row.to + (size_t)of_band * size, size * sizeof *to);
}

static int draw_table(drawing *d, moment_pyramid *table) {
  const size_t samples = (size_t)d->row.blocks * SCRATCH_BLOCK;
  uint32_t *cell64 = calloc(samples, sizeof *cell64);
  float *shift = calloc(samples, sizeof *shift);
  d->row.cell64 = cell64;
  d->row.shift = shift;
  d->row.sum = malloc(samples * MOMENTS * sizeof *d->row.sum);
  d->row.to = malloc((size_t)d->band * (size_t)d->width * MOMENTS * sizeof *d->row.to);
  int status = cell64 && shift && d->row.sum && d->row.to ? sort_images(d) : -1;
  for (size_t i = 0; status == 0 && i < samples; i++) {
    const int across = d->row.across, wide = d->row.wide;
    const int column = (int)(i / SCRATCH_BLOCK) * wide + (int)(i % SCRATCH_BLOCK) % wide;
    const int k = column % across;
    cell64[i] = (uint32_t)(column / across * 64 + k + (int)(i % SCRATCH_BLOCK) / wide * across);
    shift[i] = ((float)scratch_shuffled(k, across) + 0.25F) / (float)across;
  }
  if (status == 0)
    status = shade_moments_create(table, d->width, d->height, WRAP_REPEAT, table_row, NULL, &d);
  free(cell64);
  free(shift);
  free(d->row.sum);
  free(d->row.to);
  free(d->row.span);
  free(d->start);
  free(d->image);
  free(d->pool);
  free(d->active);
  free(d->next);
  free(d->idle);
  return d->failed ? -1 : status;
}

/*
 * Samples of a cell, and how they are tested. Two points lie across a pit's mean radius, n^2 of
 * them: each anywhere in its part of the cell they were as far from the cell's mean as these, which
 * share out its columns and its rows too. Where scratches run along an axis that counts for most.
 */
static void choose_samples(shade_scratch_field *f, drawing *d) {
  static const struct {
    unsigned char across, down;
  } any[] = {{4, 4}, {6, 4}, {8, 4}, {6, 8}, {8, 8}},
    aligned[] = {{3, 4}, {3, 4}, {4, 4}, {8, 4}, {8, 4}};
  double radius = 0, x = 0, y = 0;
  for (size_t i = 0; i < f->pits; i++) {
    radius += f->pit[i].half_across / (double)f->pits;
    x += f->pit[i].reach[0];
    y += f->pit[i].reach[1];
  }
  const int n = (int)fmin(fmax(ceil(2 / (fmax(radius, 1e-9) * d->width)), 4), 8);
  const int along = x > 16 * y || y > 16 * x;
  scratch_row *r = &d->row;
  r->across = along ? aligned[n - 4].across : any[n - 4].across;
  r->down = along ? aligned[n - 4].down : any[n - 4].down;
  r->tall = x > 4 * y ? 1 : SCRATCH_SQUARE;
  r->wide = SCRATCH_BLOCK / r->tall;
  r->blocks = (r->across * d->width + r->wide - 1) / r->wide;
  d->band = SCRATCH_LINES * r->tall / r->down;
  d->bands = (d->height + d->band - 1) / d->band;
  f->steps = n;
  f->columns = r->across;
  f->rows = r->down;
}

int shade_scratch_make_table(shade_scratch_field *f, int cells, const shade_isa_table *isa) {
  const int width = f->aspect > 1 ? (int)ceil(cells / f->aspect) : cells;
  const int height = f->aspect > 1 ? cells : (int)ceil(cells * f->aspect);
  drawing d = {.f = f, .isa = isa, .width = width, .height = height};
  choose_samples(f, &d);
  d.row.width = width;
  d.row.key = scratch_mix(f->seed ^ 0x7461626c65u);
  f->has_table = 1;
  return draw_table(&d, &f->table);
}
