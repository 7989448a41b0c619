/* SPDX-License-Identifier: Apache-2.0 */
/* Weaving Information Files: from what was read to a draft. */
#include <stdlib.h>

#include "wif.h"

enum { MAX_WORK = 1 << 30 }; /* steps from treadling to drawdown */

/* The row of each key, the last of several; index[key] is its number + 1, or 0. */
static int *index_rows(const wif *p, section where, int size) {
  int *index = calloc((size_t)size + 1, sizeof *index);
  for (size_t i = 0; index && i < p->rows[where].count; i++)
    if (p->rows[where].data[i].key <= size)
      index[p->rows[where].data[i].key] = (int)i + 1;
  return index;
}

/* No key beyond `keys`, no number beyond `numbers` (0: not announced). */
static int check_rows(const wif *p, section where, int keys, const char *key_name, int numbers,
                      const char *number_name) {
  for (size_t i = 0; i < p->rows[where].count; i++) {
    const row *r = &p->rows[where].data[i];
    if (keys && r->key > keys)
      return wif_fail(p, r->line, "%s %d in [%s]: the file announces %d", key_name, r->key,
                      wif_section_names[where], keys);
    for (int k = 0; k < r->count; k++)
      if (p->pool[r->first + k] > (numbers ? numbers : SHADE_DRAFT_MAX_SIDE))
        return wif_fail(p, r->line, "%s %d in [%s]: expected at most %d", number_name,
                        p->pool[r->first + k], wif_section_names[where],
                        numbers ? numbers : SHADE_DRAFT_MAX_SIDE);
  }
  return 0;
}

/* Mark the shafts of row `number` (from index_rows) with `mark`. */
static void mark_shafts(const wif *p, section where, int number, int *marks, int mark) {
  if (!number)
    return;
  const row *r = &p->rows[where].data[number - 1];
  for (int k = 0; k < r->count; k++)
    marks[p->pool[r->first + k]] = mark;
}

/* Over and under: threading x tie-up x treadling, or threading x liftplan. */
static int draw_down(const wif *p, shade_draft *d, int by_treadles) {
  const section by = by_treadles ? TREADLING : LIFTPLAN;
  int *threading = index_rows(p, THREADING, d->ends);
  int *picks = index_rows(p, by, d->picks);
  int *tieup = index_rows(p, TIEUP, SHADE_DRAFT_MAX_SIDE);
  /* marks[shaft] == pick + 1: the pick names this shaft; the same of treadles */
  int *marks = calloc(SHADE_DRAFT_MAX_SIDE + 1, sizeof *marks);
  int *pressed = calloc(SHADE_DRAFT_MAX_SIDE + 1, sizeof *pressed);
  long work = 0;
  int status = 0;
  if (!threading || !picks || !tieup || !marks || !pressed)
    status = wif_fail(p, 0, "out of memory");
  for (int j = 0; !status && j < d->picks; j++) {
    const int number = picks[j + 1];
    if (!by_treadles)
      mark_shafts(p, LIFTPLAN, number, marks, j + 1);
    const row *r = number ? &p->rows[by].data[number - 1] : NULL;
    work += r ? r->count : 0;
    for (int k = 0; by_treadles && r && k < r->count; k++) {
      const int treadle = p->pool[r->first + k];
      if (pressed[treadle] == j + 1)
        continue;
      pressed[treadle] = j + 1;
      mark_shafts(p, TIEUP, tieup[treadle], marks, j + 1);
      work += tieup[treadle] ? p->rows[TIEUP].data[tieup[treadle] - 1].count : 0;
    }
    for (int i = 0; i < d->ends; i++) {
      const row *t = threading[i + 1] ? &p->rows[THREADING].data[threading[i + 1] - 1] : NULL;
      int threaded = 0, named = 0;
      for (int k = 0; t && k < t->count; k++) {
        const int shaft = p->pool[t->first + k];
        threaded |= shaft > 0;
        named |= shaft > 0 && marks[shaft] == j + 1;
      }
      work += t ? t->count : 1;
      d->warp_up[(size_t)j * (size_t)d->ends + (size_t)i] = threaded && named != p->sinking;
    }
    if (work > MAX_WORK)
      status = wif_fail(p, 0, "too large: more than %d steps from treadling to drawdown", MAX_WORK);
  }
  free(threading);
  free(picks);
  free(tieup);
  free(marks);
  free(pressed);
  return status;
}

static int set_color(const wif *p, const int *table, int colors, int color, long line,
                     double to[3]) {
  if (!color || !p->rows[COLOR_TABLE].count)
    return 0;
  if (color > colors || !table[color])
    return wif_fail(p, line, "colour %d: not in [COLOR TABLE]", color);
  const row *r = &p->rows[COLOR_TABLE].data[table[color] - 1];
  for (int c = 0; c < 3; c++) {
    const double value = p->pool[r->first + c];
    if (value < p->range[0] || value > p->range[1])
      return wif_fail(p, r->line, "colour %d: %g is not within Range=%g,%g", color, value,
                      p->range[0], p->range[1]);
    to[c] = (value - p->range[0]) / (p->range[1] - p->range[0]);
  }
  return 0;
}

/* Colour, spacing and thickness of the ends (weft 0) or picks (weft 1). */
static int set_threads(const wif *p, int weft, const int *table, int colors, shade_thread *threads,
                       int count) {
  const direction *s = &p->way[weft];
  const rows *overrides = &p->rows[weft ? WEFT_COLORS : WARP_COLORS];
  shade_thread usual = {{1, 1, 1}, s->thickness * s->unit, s->spacing * s->unit};
  if (set_color(p, table, colors, s->color, s->color_line, usual.color) != 0)
    return -1;
  for (int i = 0; i < count; i++)
    threads[i] = usual;
  for (size_t i = 0; i < overrides->count; i++) {
    const row *r = &overrides->data[i];
    if (r->key <= count && r->count &&
        set_color(p, table, colors, p->pool[r->first], r->line, threads[r->key - 1].color) != 0)
      return -1;
  }
  const rows *spacing = &p->rows[weft ? WEFT_SPACING : WARP_SPACING];
  for (size_t i = 0; i < spacing->count; i++)
    if (spacing->data[i].key <= count)
      threads[spacing->data[i].key - 1].spacing = spacing->data[i].length * s->unit;
  const rows *thickness = &p->rows[weft ? WEFT_THICKNESS : WARP_THICKNESS];
  for (size_t i = 0; i < thickness->count; i++)
    if (thickness->data[i].key <= count)
      threads[thickness->data[i].key - 1].thickness = thickness->data[i].length * s->unit;
  return 0;
}

shade_draft *wif_draft(const wif *p) {
  const int by_treadles = p->rows[TIEUP].count && p->rows[TREADLING].count;
  if (!p->rows[THREADING].count) {
    wif_fail(p, 0, "no [THREADING]: expected the sections of a Weaving Information File");
    return NULL;
  }
  if (!by_treadles && !p->rows[LIFTPLAN].count) {
    wif_fail(p, 0, "expected [TIEUP] and [TREADLING], or [LIFTPLAN]");
    return NULL;
  }
  const section by = by_treadles ? TREADLING : LIFTPLAN;
  const int ends = p->way[0].threads ? p->way[0].threads : p->rows[THREADING].largest;
  const int picks = p->way[1].threads ? p->way[1].threads : p->rows[by].largest;
  if (check_rows(p, THREADING, ends, "end", p->shafts, "shaft") != 0 ||
      (by_treadles && (check_rows(p, TIEUP, p->treadles, "treadle", p->shafts, "shaft") != 0 ||
                       check_rows(p, TREADLING, picks, "pick", p->treadles, "treadle") != 0)) ||
      (!by_treadles && check_rows(p, LIFTPLAN, picks, "pick", p->shafts, "shaft") != 0))
    return NULL;
  if (ends > SHADE_DRAFT_MAX_CELLS / picks) {
    wif_fail(p, p->way[0].threads_line, "%d ends x %d picks: expected at most %d crossings", ends,
             picks, SHADE_DRAFT_MAX_CELLS);
    return NULL;
  }
  const int colors = p->rows[COLOR_TABLE].largest;
  int *table = index_rows(p, COLOR_TABLE, colors);
  shade_draft *d = shade_draft_create(ends, picks);
  int status = table && d ? 0 : wif_fail(p, 0, "out of memory");
  if (!status)
    status = draw_down(p, d, by_treadles);
  if (!status)
    status = set_threads(p, 0, table, colors, d->warp, ends);
  if (!status)
    status = set_threads(p, 1, table, colors, d->weft, picks);
  free(table);
  if (status) {
    shade_draft_free(d);
    return NULL;
  }
  return d;
}
