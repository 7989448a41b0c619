/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Setting up a fabric. The far model is not told what the yarns look like: it looks at some
 * 10^5 points of the weave, spread over the repeat and over the noise, and keeps a table of what
 * is seen of either side, block by block, and the nodes that fabric_nodes.c finds.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../model/fabric.h"
#include "../batch/isa.h"
#include "../port/memory.h"
#include "params.h"

enum {
  LOOKS = 1 << 18,  /* points in all, about */
  MAX_BLOCKS = 512, /* of the table along a side: larger repeats share */
  MAX_LOOKS = 48,   /* along a side of a block */
  MIN_LOOKS = 2,
  LOOKS_BLOCK = 256
};

/* Numbers that are the same on every machine. */
static uint64_t next(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}
static double fraction(uint64_t *state) {
  return (double)(next(state) >> 11) * 0x1p-53;
}

void shade_fabric_params_init(shade_fabric_params *p) {
  memset(p, 0, sizeof *p);
  p->size = sizeof *p;
  p->defaults = SHADE_DEFAULTS;
  p->brdf = SHADE_BRDF_AUTO;
  p->detail = SHADE_DETAIL_ROTATE;
  p->warp.along = 100;
  p->warp.across = 10;
  p->warp.diffuse = SHADE_DIFFUSE_FIBRE;
  for (int c = 0; c < 3; c++) {
    p->warp.f0[c] = 0.04;
    p->warp.kd[c] = 0.5;
    p->nap_color[c] = 0.5;
  }
  p->weft = p->warp;
  p->horizon = SHADE_HORIZON_VALID_ESTEVEZ;
  p->shadows = 1;
}

shade_fabric_params shade_whole_fabric(const shade_fabric_params *given) {
  shade_fabric_params p;
  shade_fabric_params_init(&p);
  p.horizon = SHADE_HORIZON_HARD;
  p.shadows = 0;
  p.defaults = 0;
  memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  if (given->size <= offsetof(shade_fabric_params, defaults))
    p.brdf = shade_brdf_before_auto(p.brdf);
  return p;
}

static double within(double x, double low, double high, double initial, unsigned *status) {
  double y = isnan(x) ? initial : fmin(fmax(x, low), high);
  if (!(x == y))
    *status |= SHADE_CLAMPED_PARAMETER;
  return y;
}

static void color_within(double color[3], const double initial[3], unsigned *status) {
  for (int c = 0; c < 3; c++)
    color[c] = within(color[c], 0, 1, initial[c], status);
}

static void yarn_within(shade_yarn *y, const shade_yarn *initial, unsigned *status) {
  y->along = within(y->along, 0, 1e6, initial->along, status);
  y->across = within(y->across, 0, 1e6, initial->across, status);
  color_within(y->f0, initial->f0, status);
  color_within(y->kd, initial->kd, status);
  if (!shade_list_word(SHADE_LIST_DIFFUSE, (int)y->diffuse)) {
    y->diffuse = (shade_diffuse)0;
    *status |= SHADE_BAD_CHOICE;
  }
}

static shade_fabric_params within_ranges(const shade_fabric_params *given, unsigned *status) {
  shade_fabric_params p, initial;
  shade_fabric_params_init(&initial);
  p = initial;
  if (given && given->size < sizeof given->size)
    *status |= SHADE_BAD_INPUT;
  else if (given)
    p = shade_whole_fabric(given);
  yarn_within(&p.warp, &initial.warp, status);
  yarn_within(&p.weft, &initial.weft, status);
  color_within(p.backing, initial.backing, status);
  color_within(p.nap_color, initial.nap_color, status);
  color_within(p.warp_transmit, initial.warp_transmit, status);
  color_within(p.weft_transmit, initial.weft_transmit, status);
  p.nap = within(p.nap, 0, 10, 0, status);
  if (!shade_list_word(SHADE_LIST_HORIZON, (int)p.horizon)) {
    p.horizon = SHADE_HORIZON_HARD;
    *status |= SHADE_BAD_CHOICE;
  }
  return p;
}

/* What has been seen of one side. */
typedef struct cloud {
  fabric_look *looks;
  size_t count;
  double tx, ty;
} cloud;

/* Room for the looks at one block. */
typedef struct room {
  double u[LOOKS_BLOCK], v[LOOKS_BLOCK];
  int top[LOOKS_BLOCK], swap[LOOKS_BLOCK], yarn[LOOKS_BLOCK];
  double dx[LOOKS_BLOCK], dy[LOOKS_BLOCK], tx[LOOKS_BLOCK], ty[LOOKS_BLOCK];
  double occlusion[LOOKS_BLOCK], brightness[LOOKS_BLOCK], fuzz[LOOKS_BLOCK];
} room;

/* Add what look k found, as `part` of a block, to its means and the cloud. */
static void add_look(const shade_fabric *f, const room *r, int k, double part, cloud clouds[2],
                     double cell[COLUMNS]) {
  const int warp = r->swap[k], gap = r->top[k] == SHADE_TOP_GAP;
  const double light = r->occlusion[k], fuzz = r->fuzz[k], brightness = r->brightness[k];
  for (int c = 0; c < 3; c++) {
    const double own = fabric_own(f, warp, r->yarn[k], c), kd = f->side[warp].kd[c];
    /* a noisy yarn reflects no more than a white one */
    const double matt = kd * own * brightness > 1 ? 1 / kd : own * brightness;
    if (gap) {
      cell[COLUMN_FUZZ + warp + COLUMN_CHANNEL * c] += light * fuzz * part * own;
      continue;
    }
    cell[COLUMN_MATT + warp + COLUMN_CHANNEL * c] += light * matt * part;
    if (f->transmits)
      cell[COLUMN_PASS + 3 * warp + c] +=
          light * part * fmin(f->side[warp].transmit[c] * own * brightness, 1 - kd * matt);
  }
  if (gap) {
    cell[COLUMN_GAP] += light * (1 - fuzz) * part;
    cell[COLUMN_OPEN] += (1 - fuzz) * part;
    return;
  }
  cell[COLUMN_SEEN + warp] += light * part;
  cloud *seen = &clouds[warp];
  fabric_look *l = &seen->looks[seen->count++];
  l->x = (float)(r->tx[k] * r->dx[k] + r->ty[k] * r->dy[k]);
  l->y = (float)(r->tx[k] * r->dy[k] - r->ty[k] * r->dx[k]);
  l->weight = (float)light;
  seen->tx += r->tx[k] * light;
  seen->ty += r->ty[k] * light;
}

/* Look at one block of the repeat; adds its means to `cell`. */
static void look_at_block(const shade_fabric *f, int column, int row, int looks, uint64_t *state,
                          cloud clouds[2], double cell[COLUMNS]) {
  room r;
  const shade_crossings out = {.size = sizeof out,
                               .top = r.top,
                               .swap = r.swap,
                               .yarn = r.yarn,
                               .dx = r.dx,
                               .dy = r.dy,
                               .tx = r.tx,
                               .ty = r.ty,
                               .occlusion = r.occlusion,
                               .brightness = r.brightness,
                               .fuzz = r.fuzz};
  const int all = looks * looks;
  for (int start = 0; start < all; start += LOOKS_BLOCK) {
    const int count = all - start < LOOKS_BLOCK ? all - start : LOOKS_BLOCK;
    for (int i = 0; i < count; i++) {
      const int k = start + i;
      /* any repeat: the noise goes on where the draft begins again */
      const double across = (double)(next(state) & 1023) - 512,
                   up = (double)(next(state) & 1023) - 512;
      const double x = (column + (k % looks + fraction(state)) / looks) / f->columns;
      const double y = (row + (k / looks + fraction(state)) / looks) / f->rows;
      r.u[i] = f->width * (x + across);
      r.v[i] = f->height * (y + up);
    }
    shade_weave_lookup_batch(f->weave, (size_t)count, r.u, r.v, &out);
    for (int i = 0; i < count; i++)
      add_look(f, &r, i, 1.0 / all, clouds, cell);
  }
}

/* Fill the table, its means, and the clouds. */
static void look_at_repeat(shade_fabric *f, int looks, cloud clouds[2]) {
  uint64_t state = 1;
  const size_t line = (size_t)(f->columns + 1) * COLUMNS_STEP;
  memset(f->table, 0, line * (size_t)(f->rows + 1) * sizeof *f->table);
  for (int j = 0; j < f->rows; j++) {
    double row[COLUMNS] = {0}; /* of the blocks so far */
    for (int i = 0; i < f->columns; i++) {
      look_at_block(f, i, j, looks, &state, clouds, row);
      double *below = f->table + (size_t)j * line + (size_t)(i + 1) * COLUMNS_STEP;
      for (int k = 0; k < COLUMNS; k++)
        below[line + (size_t)k] = below[k] + row[k];
    }
  }
  const double *all = f->table + (size_t)f->rows * line + (size_t)f->columns * COLUMNS_STEP;
  for (int k = 0; k < COLUMNS; k++)
    f->mean[k] = all[k] / ((double)f->columns * f->rows);
  f->alike = !f->draft_colors; /* but for what is no more than white in one channel alone */
  for (int k = COLUMN_MATT; k < COLUMN_MATT + COLUMN_CHANNEL; k++)
    f->alike &=
        f->mean[k + COLUMN_CHANNEL] == f->mean[k] && f->mean[k + 2 * COLUMN_CHANNEL] == f->mean[k];
}

/* After the table. 0 when out of memory. */
static int make_strips(shade_fabric *f) {
  if (!f->uneven || f->columns != (int)f->width || f->rows != (int)f->height)
    return 1;
  const size_t line = (size_t)(f->columns + 1) * COLUMNS_STEP;
  for (int k = 0; k < 2; k++) {
    const int weft = k == SHADE_TOP_WEFT, yarns = weft ? f->rows : f->columns;
    const size_t along = weft ? COLUMNS_STEP : line, next = weft ? line : COLUMNS_STEP;
    const size_t blocks = (size_t)(weft ? f->columns : f->rows);
    double *to = f->strip[k] =
        malloc((blocks + 1) * (size_t)(yarns + FABRIC_RUN) * sizeof *f->strip[k]);
    if (!to)
      return 0;
    for (size_t i = 0; i <= blocks; i++)
      for (int j = 0; j < yarns + FABRIC_RUN; j++) {
        const double *t = f->table + i * along + (size_t)(j % yarns) * next + COLUMN_SEEN + k;
        *to++ = t[next] - t[0];
      }
  }
  return 1;
}

/*
 * The mean share of the crossings that yarns of slubs s fill: within a yarn's own limits, over even
 * values at two knots and all places between them.
 */
static double mean_fill(double share, double slub) {
  enum { STEPS = 32 };
  double sum = 0;
  for (int i = 0; i < STEPS * STEPS * STEPS; i++) {
    const double a = 2 * (i % STEPS + 0.5) / STEPS - 1;
    const double b = 2 * (i / STEPS % STEPS + 0.5) / STEPS - 1;
    const double t = (i / (STEPS * STEPS) + 0.5) / STEPS;
    const double size = share * (1 + slub * (a + (b - a) * t * t * (3 - 2 * t)));
    sum += fmin(fmax(size, 0.05 * share), 1);
  }
  return sum / (STEPS * STEPS * STEPS);
}

void shade_fabric_free(shade_fabric *f) {
  if (!f)
    return;
  shade_fabric_table_free(f->side[0].table);
  shade_fabric_table_free(f->side[1].table);
  shade_port_aligned_free(f->table);
  free(f->strip[0]);
  free(f->strip[1]);
  shade_weave_free(f->weave);
  free(f);
}

shade_fabric *shade_fabric_create(const shade_weave *weave, const shade_fabric_params *given,
                                  unsigned *status) {
  unsigned bits = SHADE_OK;
  const shade_fabric_params p = within_ranges(given, &bits);
  shade_fabric *f = weave ? calloc(1, sizeof *f) : NULL;
  if (!f)
    return NULL;
  const shade_draft *draft = shade_weave_draft(weave);
  f->isa = shade_isa_chosen();
  f->weave = shade_weave_share(weave);
  memcpy(f->backing, p.backing, sizeof f->backing);
  memcpy(f->nap_color, p.nap_color, sizeof f->nap_color);
  f->nap = p.nap;
  f->horizon = p.horizon;
  f->draft_colors = p.draft_colors;
  const shade_weave_params *shape = shade_weave_get_params(weave);
  f->uneven = shape->warp.vary_brightness + shape->warp.along_brightness +
                  shape->weft.vary_brightness + shape->weft.along_brightness + shape->warp.slub +
                  shape->weft.slub >
              0;
  for (int k = 0; k < 2; k++)
    if (weave->uniform[k])
      f->fills[k] = mean_fill(weave->thread[k]->share, weave->yarn[k].slub);
  f->width = draft->ends;
  f->height = draft->picks;
  f->columns = draft->ends < MAX_BLOCKS ? draft->ends : MAX_BLOCKS;
  f->rows = draft->picks < MAX_BLOCKS ? draft->picks : MAX_BLOCKS;
  const size_t blocks = (size_t)f->columns * (size_t)f->rows;
  int looks = (int)sqrt((double)(LOOKS / blocks));
  looks = looks < MIN_LOOKS ? MIN_LOOKS : looks > MAX_LOOKS ? MAX_LOOKS : looks;
  const size_t most = blocks * (size_t)(looks * looks);
  cloud clouds[2] = {{malloc(most * sizeof(fabric_look)), 0, 0, 0},
                     {malloc(most * sizeof(fabric_look)), 0, 0, 0}};
  f->table = shade_port_aligned_new((size_t)(f->columns + 1) * (size_t)(f->rows + 1) *
                                    COLUMNS_STEP * sizeof *f->table);
  int ok = clouds[0].looks && clouds[1].looks && f->table;
  for (int k = 0; k < 2; k++) { /* kd is read by look_at_repeat */
    memcpy(f->side[k].kd, k ? p.warp.kd : p.weft.kd, sizeof f->side[k].kd);
    memcpy(f->side[k].transmit, k ? p.warp_transmit : p.weft_transmit, sizeof p.warp_transmit);
    for (int c = 0; c < 3; c++) {
      f->transmits |= f->side[k].transmit[c] > 0;
      f->backed |= f->backing[c] > 0;
    }
  }
  if (ok) {
    look_at_repeat(f, looks, clouds);
    ok = make_strips(f);
    for (int k = 0; k < 2; k++) {
      fabric_side *side = &f->side[k];
      double length = hypot(clouds[k].tx, clouds[k].ty);
      side->tx = length > 0 ? clouds[k].tx / length : k == SHADE_TOP_WEFT;
      side->ty = length > 0 ? clouds[k].ty / length : k == SHADE_TOP_WARP;
      shade_fabric_set_side(side, &p, k ? &p.warp : &p.weft, clouds[k].looks, clouds[k].count,
                            &bits);
    }
    if (p.shadows && p.detail != SHADE_DETAIL_NONE) /* where tilts lean away, there are shadows */
      shade_fabric_set_shadows(f);
  }
  free(clouds[0].looks);
  free(clouds[1].looks);
  if (!ok) {
    shade_fabric_free(f);
    return NULL;
  }
  if (status)
    *status |= bits;
  return f;
}

void shade_fabric_get_info(const shade_fabric *f, shade_fabric_info *info) {
  const fabric_side *weft = &f->side[SHADE_TOP_WEFT], *warp = &f->side[SHADE_TOP_WARP];
  memset(info, 0, sizeof *info);
  info->weft_lobes = weft->nodes.count;
  info->warp_lobes = warp->nodes.count;
  info->weft_share = f->mean[COLUMN_SEEN + SHADE_TOP_WEFT];
  info->warp_share = f->mean[COLUMN_SEEN + SHADE_TOP_WARP];
  info->weft_single[0] = bsdf_of(&weft->lobe[FABRIC_SINGLE])->numbers.kx;
  info->weft_single[1] = bsdf_of(&weft->lobe[FABRIC_SINGLE])->numbers.ky;
  info->warp_single[0] = bsdf_of(&warp->lobe[FABRIC_SINGLE])->numbers.kx;
  info->warp_single[1] = bsdf_of(&warp->lobe[FABRIC_SINGLE])->numbers.ky;
}
