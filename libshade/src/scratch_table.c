/* SPDX-License-Identifier: Apache-2.0 */
/* The table that answers footprints of a field of scratches, from jittered samples. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "src/isa.h"
#include "src/scratch.h"
#include "src/scratch_row.h"

/* An image of a pit, by the first row of cells that it reaches. */
typedef struct image {
  uint32_t pit, shift; /* shift: 3 * that along y + that along x, each 0 to 2 for -1 to 1 */
} image;

typedef struct drawing {
  const shade_scratch_field *f;
  const shade_isa_table *isa;
  int width, height, n;
  uint32_t *start; /* rows + 1: where a row's images begin */
  image *image;
  scratch_stroke *pool;           /* those of the row, anywhere; `room` long, as the lists are */
  uint32_t *active, *next, *idle; /* places in it: of the row, of the next one, of nobody */
  size_t actives, idles, room;
  int failed; /* out of memory */
  scratch_row row;
} drawing;

/* The pit as the table's samples see it. */
static scratch_stroke stroke_of(const drawing *d, const image *m) {
  const shade_scratch_field *f = d->f;
  const pit *p = &f->pit[m->pit];
  const double across = d->n * d->width, lines = d->n * d->height;
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

/* Visit the images of a pit that meet the table. Without `image` counts them in start[row + 1]. */
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
      to[d->start[row]++] = (image){index, (uint32_t)shift};
    else
      d->start[row + 1]++;
  }
}

/* Images sorted by their first row; within it the deepest comes first, as the pits do. */
static int sort_images(drawing *d) {
  const size_t rows = (size_t)d->height;
  d->start = calloc(rows + 2, sizeof *d->start);
  if (!d->start)
    return -1;
  d->start++; /* counted one place on, so that filling moves start[row] to where row begins */
  for (size_t i = 0; i < d->f->pits; i++)
    visit(d, (uint32_t)i, NULL);
  for (size_t i = 0; i < rows; i++)
    d->start[i + 1] += d->start[i];
  const size_t total = d->start[rows];
  d->image = malloc((total + 1) * sizeof *d->image);
  if (!d->image)
    return -1;
  for (size_t i = 0; i < d->f->pits; i++)
    visit(d, (uint32_t)i, d->image);
  d->start--;
  return 0;
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
  d->row.span = malloc((size_t)d->n * room * sizeof *d->row.span);
  if (!pool || !d->active || !d->next || !d->idle || !d->row.span)
    return -1;
  for (size_t i = room; i-- > d->room;)
    d->idle[d->idles++] = (uint32_t)i;
  d->room = room;
  return 0;
}

/* The strokes of row j: of those that were there the ones that still are, and new ones, by rank. */
static int advance(drawing *d, int j) {
  const uint32_t end = d->start[j + 1];
  uint32_t k = d->start[j];
  const size_t most = d->actives + (end - k);
  if (most > d->room && make_room(d, 2 * most) != 0)
    return -1;
  const double top = (double)j * d->n - 1e-3;
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

static void table_row(const void *context, int j, float *to) {
  drawing *d = *(drawing *const *)context;
  if (d->failed || advance(d, j) != 0) {
    d->failed = 1;
    memset(to, 0, (size_t)d->width * MOMENTS * sizeof *to);
    return;
  }
  d->row.line = j * d->n;
  d->row.pool = d->pool;
  d->row.stroke = d->active;
  d->row.strokes = d->actives;
  d->row.room = d->room;
  d->row.to = to;
  d->isa->scratch_row(&d->row);
}

static int draw_table(drawing *d, moment_pyramid *table) {
  const size_t blocks = (size_t)d->row.blocks, samples = blocks * SCRATCH_BLOCK;
  uint32_t *cell64 = calloc(samples, sizeof *cell64);
  d->row.cell64 = cell64;
  d->row.sum = malloc(samples * MOMENTS * sizeof *d->row.sum);
  int status = cell64 && d->row.sum ? sort_images(d) : -1;
  for (int i = 0; status == 0 && i < d->n * d->width; i++)
    cell64[i] = (uint32_t)(i / d->n * 64 + i % d->n);
  if (status == 0)
    status = moments_create(table, d->width, d->height, 1, WRAP_REPEAT, table_row, &d);
  free(cell64);
  free(d->row.sum);
  free(d->row.span);
  free(d->start);
  free(d->image);
  free(d->pool);
  free(d->active);
  free(d->next);
  free(d->idle);
  return d->failed ? -1 : status;
}

int scratch_make_table(shade_scratch_field *f, int cells, const shade_isa_table *isa) {
  const int width = f->aspect > 1 ? (int)ceil(cells / f->aspect) : cells;
  const int height = f->aspect > 1 ? cells : (int)ceil(cells * f->aspect);
  double radius = 0;
  for (size_t i = 0; i < f->pits; i++)
    radius += f->pit[i].half_across / (double)f->pits;
  const int n = (int)fmin(fmax(ceil(2 / (fmax(radius, 1e-9) * width)), 4), 8);
  drawing d = {.f = f, .isa = isa, .width = width, .height = height, .n = n};
  d.row.n = n;
  d.row.width = width;
  d.row.blocks = (n * width + SCRATCH_BLOCK - 1) / SCRATCH_BLOCK;
  d.row.key = scratch_mix(f->seed ^ 0x7461626c65u);
  f->samples = n;
  f->has_table = 1;
  return draw_table(&d, &f->table);
}
