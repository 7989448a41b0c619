/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Weaving Information Files: from what was read to a draft.
 *
 * Some programs count from 0, all or a part of what they number. A key 0 shows it, in its own
 * section (else it would be a row of nothing); of shafts, which have no keys, that the 0 is
 * threaded and lifted like the others and that the last number is never used.
 */
#include <stdlib.h>
#include <string.h>

#include "wif.h"

enum { MAX_WORK = 1 << 30 }; /* steps from treadling to drawdown */

static const char out_of_memory[] = "out of memory";

/* --- numbering -------------------------------------------------------------------------- */

/* The first key of a section, 0 or 1, where `count` rows are announced (0: not announced). */
static int first_key(wif *w, section where, int count) {
  const rows *r = &w->rows[where];
  if (!r->zero_line)
    return 1;
  if (count && r->largest >= count) {
    shade_wif_mend(w, ROW_BEYOND, r->zero_line, "row 0 of [%s], which counts from 1: left out",
                   shade_wif_section_names[where]);
    return 1;
  }
  shade_wif_mend(w, KEYS_FROM_0, r->zero_line, "[%s] counts from 0",
                 shade_wif_section_names[where]);
  return 0;
}

/* Whether two rows say the same. */
static int same_row(const wif *w, const row *a, const row *b) {
  return a->count == b->count && a->length.value == b->length.value &&
         a->length.unit == b->length.unit &&
         (!a->count ||
          !memcmp(w->pool + a->first, w->pool + b->first, (size_t)a->count * sizeof *w->pool));
}

/* The row of each key, the last of several, from key `first` on; NULL: none, or of no memory. */
static const row **index_rows(wif *w, section where, int first, int size) {
  const row **index = calloc((size_t)size + 1, sizeof *index);
  for (size_t i = 0; index && i < w->rows[where].count; i++) {
    const row *r = &w->rows[where].data[i];
    const int k = r->key - first;
    if (k < 0)
      continue;
    if (k >= size) {
      shade_wif_mend(w, ROW_BEYOND, r->line, "row %d of [%s], where there are %d: left out", r->key,
                     shade_wif_section_names[where], size);
      continue;
    }
    if (index[k] && !same_row(w, index[k], r))
      shade_wif_mend(w, ROW_TWICE, r->line, "row %d of [%s] once more: the last holds", r->key,
                     shade_wif_section_names[where]);
    index[k] = r;
  }
  return index;
}

/* The largest number of a section's rows; whether there is a 0, and one beside other numbers. */
typedef struct uses {
  int largest, zero, zero_beside;
} uses;

static uses uses_of(const wif *w, section where) {
  uses u = {0, 0, 0};
  for (size_t i = 0; i < w->rows[where].count; i++) {
    const row *r = &w->rows[where].data[i];
    int zero = 0, other = 0;
    for (int k = 0; k < r->count; k++) {
      const int n = w->pool[r->first + k];
      zero |= !n;
      other |= n > 0;
      u.largest = n > u.largest ? n : u.largest;
    }
    u.zero |= zero;
    u.zero_beside |= zero && other;
  }
  return u;
}

/* No number beyond what a draft can hold; those beyond `announced` (0: not) are named. */
static int check_numbers(wif *w, section where, const char *name, int announced) {
  for (size_t i = 0; i < w->rows[where].count; i++) {
    const row *r = &w->rows[where].data[i];
    for (int k = 0; k < r->count; k++) {
      const int n = w->pool[r->first + k];
      if (n > SHADE_DRAFT_MAX_SIDE)
        return shade_wif_fail(w, r->line, "%s %d in [%s]: expected at most %d", name, n,
                              shade_wif_section_names[where], SHADE_DRAFT_MAX_SIDE);
      if (announced && n > announced)
        shade_wif_mend(w, SHAFT_BEYOND, r->line,
                       "%s %d in [%s], the file announces %d: read as it is", name, n,
                       shade_wif_section_names[where], announced);
    }
  }
  return 0;
}

/* --- over and under --------------------------------------------------------------------- */

/* What lifts the shafts of a pick. */
typedef enum plan { BY_TREADLES, BY_LIFTPLAN } plan;

/* The number that the first shaft has, 0 or 1. */
static int first_shaft(wif *w, plan by) {
  const section lifts = by == BY_TREADLES ? TIEUP : LIFTPLAN;
  const uses threaded = uses_of(w, THREADING), lifted = uses_of(w, lifts);
  const int largest = threaded.largest > lifted.largest ? threaded.largest : lifted.largest;
  const int straight = !w->rows[THREADING].count; /* threaded with all that is lifted */
  if (!(threaded.zero || straight) || !lifted.zero || (w->shafts && largest >= w->shafts))
    return 1;
  const int keyed = w->rows[THREADING].zero_line || w->rows[lifts].zero_line;
  if (!keyed && !(lifted.zero_beside && largest == w->shafts - 1))
    return 1;
  shade_wif_mend(w, SHAFTS_FROM_0, w->seen[THREADING], "shafts count from 0");
  return 0;
}

/* Mark the shafts that a row names with `mark`. */
static void mark_shafts(const wif *w, const row *r, int *marks, int mark) {
  for (int k = 0; r && k < r->count; k++)
    marks[w->pool[r->first + k]] = mark;
}

/* Threading x tie-up x treadling, or threading x liftplan. What went wrong, or NULL. */
static const char *draw_down(wif *w, plan by, int ends, int picks, unsigned char *warp_up) {
  const section steps = by == BY_TREADLES ? TREADLING : LIFTPLAN;
  const int lowest = first_shaft(w, by), straight = !w->rows[THREADING].count;
  /* a treadle t is row t - shift of the tie-up; without a tie-up it is its shaft */
  const int direct = by == BY_TREADLES && !w->rows[TIEUP].count;
  int first_treadle = 1, shift = 0;
  if (by == BY_TREADLES && first_key(w, TIEUP, w->treadles) == 0) {
    if (uses_of(w, TREADLING).largest > w->rows[TIEUP].largest)
      shift = 1;
    else
      first_treadle = 0;
  }
  if (!first_treadle)
    shade_wif_mend(w, TREADLES_FROM_0, w->seen[TREADLING], "treadles count from 0");
  const row **threading =
      index_rows(w, THREADING, first_key(w, THREADING, w->way[0].threads), ends);
  const row **rows = index_rows(w, steps, first_key(w, steps, w->way[1].threads), picks);
  const row **tieup = index_rows(w, TIEUP, 0, SHADE_DRAFT_MAX_SIDE + 1);
  /* marks[shaft] == pick + 1: the pick names this shaft; the same of treadles */
  int *marks = calloc(SHADE_DRAFT_MAX_SIDE + 1, sizeof *marks);
  int *pressed = calloc(SHADE_DRAFT_MAX_SIDE + 1, sizeof *pressed);
  const char *wrong = threading && rows && tieup && marks && pressed ? NULL : out_of_memory;
  long work = 0;
  for (int j = 0; !wrong && j < picks; j++) {
    const row *r = rows[j];
    if (by == BY_LIFTPLAN || direct)
      mark_shafts(w, r, marks, j + 1);
    work += r ? r->count : 0;
    for (int k = 0; by == BY_TREADLES && !direct && r && k < r->count; k++) {
      const int treadle = w->pool[r->first + k];
      if (treadle < first_treadle || pressed[treadle] == j + 1)
        continue;
      pressed[treadle] = j + 1;
      const row *tied = tieup[treadle - shift];
      if (!tied && treadle > (w->treadles ? w->treadles : w->rows[TIEUP].largest))
        shade_wif_mend(w, NOT_TIED, r->line,
                       "treadle %d in [TREADLING] is not in [TIEUP]: lifts nothing", treadle);
      mark_shafts(w, tied, marks, j + 1);
      work += tied ? tied->count : 0;
    }
    for (int i = 0; i < ends; i++) {
      const row *t = threading[i];
      int threaded = straight, named = straight && marks[i + lowest] == j + 1;
      for (int k = 0; t && k < t->count; k++) {
        const int shaft = w->pool[t->first + k];
        threaded |= shaft >= lowest;
        named |= shaft >= lowest && marks[shaft] == j + 1;
      }
      work += t ? t->count : 1;
      warp_up[(size_t)j * (size_t)ends + (size_t)i] = threaded && named != w->sinking;
    }
    if (work > MAX_WORK)
      wrong = "too large: more than 1073741824 steps from treadling to drawdown";
  }
  free(threading);
  free(rows);
  free(tieup);
  free(marks);
  free(pressed);
  return wrong;
}

/* Both plans are there: whether the one that is not taken says the same. */
static void compare_plans(wif *w, plan taken, const shade_draft *d) {
  const size_t cells = (size_t)d->ends * (size_t)d->picks;
  unsigned char *other = malloc(cells);
  const plan left = taken == BY_TREADLES ? BY_LIFTPLAN : BY_TREADLES;
  mended kept[MENDINGS]; /* what is wrong in the other does not matter */
  memcpy(kept, w->mended, sizeof kept);
  const int differ =
      other && !draw_down(w, left, d->ends, d->picks, other) && memcmp(other, d->warp_up, cells);
  memcpy(w->mended, kept, sizeof kept);
  if (differ) {
    const section where[2] = {TREADLING, LIFTPLAN};
    shade_wif_mend(w, TWO_PLANS, w->seen[where[left]], "[%s] says otherwise than [%s]: left out",
                   shade_wif_section_names[where[left]], shade_wif_section_names[where[taken]]);
  }
  free(other);
}

/* --- colours and lengths ---------------------------------------------------------------- */

/* The colour table, ready for numbers as the file uses them. */
typedef struct palette {
  double (*colors)[3]; /* by key; red < 0: no such row; NULL: no table */
  int size, shift;     /* colour n is that of key n + shift */
} palette;

static void note_color(int color, uses *u) {
  u->zero |= !color;
  u->largest = color > u->largest ? color : u->largest;
}

/* The numbers that ends and picks have for their colours. */
static uses colors_used(const wif *w) {
  uses u = {0, 0, 0};
  for (int weft = 0; weft < 2; weft++) {
    if (w->way[weft].color_line)
      note_color(w->way[weft].color, &u);
    const rows *own = &w->rows[weft ? WEFT_COLORS : WARP_COLORS];
    for (size_t i = 0; i < own->count; i++)
      if (own->data[i].count)
        note_color(w->pool[own->data[i].first], &u);
  }
  return u;
}

/* A file that gives no Range: the usual one that its numbers are in. */
static void guess_range(wif *w, int channels) {
  const rows *table = &w->rows[COLOR_TABLE];
  int largest = 0;
  for (size_t i = 0; i < table->count; i++)
    for (int k = 0; k < table->data[i].count && k < channels && !table->data[i].hex; k++) {
      const int n = w->pool[table->data[i].first + k];
      largest = n > largest ? n : largest;
    }
  const int usual = channels == 4 && largest <= 100 ? 100
                    : largest <= 255                ? 255
                    : largest <= 999                ? 999
                    : largest <= 65535              ? 65535
                                                    : largest;
  w->range[1] = usual;
  if (usual != 255)
    shade_wif_mend(w, RANGE_GUESSED, w->seen[COLOR_TABLE],
                   "[COLOR TABLE] has %d, and there is no Range: taken as Range=0,%d", largest,
                   usual);
}

/* One channel, [0, 1]. */
static double channel(wif *w, int value, int color, long line) {
  const double low = w->range[0], high = w->range[1];
  if (value < low || value > high) {
    shade_wif_mend(w, RANGE_LEFT, line, "colour %d: %d is not within Range=%g,%g: taken as %g",
                   color, value, low, high, value < low ? low : high);
    return value > high;
  }
  return (value - low) / (high - low);
}

static void read_color(wif *w, const row *r, int channels, double to[3]) {
  const int *n = w->pool + r->first;
  if (r->hex) {
    for (int c = 0; c < 3; c++)
      to[c] = n[c] / 255.;
    return;
  }
  if (r->count != channels)
    shade_wif_mend(w, CHANNELS, r->line, "colour %d has %d numbers, expected %d: %s", r->key,
                   r->count, channels, r->count < channels ? "no black" : "the others left out");
  for (int c = 0; c < 3; c++)
    to[c] = channel(w, n[c], r->key, r->line);
  if (channels == 3)
    return;
  const double black = r->count > 3 ? channel(w, n[3], r->key, r->line) : 0;
  for (int c = 0; c < 3; c++)
    to[c] = (1 - to[c]) * (1 - black);
}

static int make_palette(wif *w, palette *p) {
  const rows *table = &w->rows[COLOR_TABLE];
  const int channels = w->form == FORM_CMYK ? 4 : 3;
  *p = (palette){NULL, 0, 0};
  if (!table->count || w->form == FORM_OTHER)
    return 0;
  p->size = table->largest + 1;
  p->colors = calloc((size_t)p->size, sizeof *p->colors);
  const row **rows = index_rows(w, COLOR_TABLE, 0, p->size);
  if (!p->colors || !rows) {
    free(rows);
    return shade_wif_fail(w, 0, out_of_memory);
  }
  if (!w->has_range)
    guess_range(w, channels);
  int found = 0;
  for (int k = 0; k < p->size; k++)
    if (rows[k]) {
      read_color(w, rows[k], channels, p->colors[k]);
      found++;
    } else
      p->colors[k][0] = -1;
  if (w->entries_line && w->entries >= 0 && w->entries != found)
    shade_wif_mend(w, ENTRIES_WRONG, w->entries_line, "Entries=%d, but [COLOR TABLE] has %d",
                   w->entries, found);
  free(rows);
  const uses u = colors_used(w);
  if (table->zero_line) {
    first_key(w, COLOR_TABLE, 0);
    p->shift = u.largest == p->size ? -1 : 0;
  } else if (u.zero && u.largest == table->largest - 1) {
    shade_wif_mend(w, COLORS_FROM_0, w->seen[COLOR_TABLE], "the colours of yarns count from 0");
    p->shift = 1;
  }
  return 0;
}

/* The colour of that number, or else the one spelled out beside it (NULL: none), or no change. */
static void set_color(wif *w, const palette *p, int color, const int *rgb, long line,
                      double to[3]) {
  const int k = color + p->shift;
  if (p->colors && k >= 0 && k < p->size && p->colors[k][0] >= 0)
    memcpy(to, p->colors[k], sizeof p->colors[k]);
  else if (rgb)
    for (int c = 0; c < 3; c++)
      to[c] = channel(w, rgb[c], color, line);
  else if (p->colors && color)
    shade_wif_mend(w, COLOR_MISSING, line, "colour %d is not in [COLOR TABLE]: the default", color);
}

static double centimetres(length l, double unit) {
  return l.value * (l.unit > 0 ? l.unit : unit);
}

/* Colour, spacing and thickness of the ends (weft 0) or picks (weft 1). */
static int set_threads(wif *w, int weft, const palette *p, shade_thread *threads, int count) {
  const direction *d = &w->way[weft];
  const section colors = weft ? WEFT_COLORS : WARP_COLORS;
  const section lengths[2] = {weft ? WEFT_SPACING : WARP_SPACING,
                              weft ? WEFT_THICKNESS : WARP_THICKNESS};
  if (d->unit <= 0) {
    const int needed = d->spacing.value > 0 || d->thickness.value > 0 ||
                       w->rows[lengths[0]].count || w->rows[lengths[1]].count;
    if (needed)
      return shade_wif_fail(w, d->units_line,
                            "Units=%s: expected decipoints, inches or centimeters", d->units);
    shade_wif_mend(w, UNITS_UNKNOWN, d->units_line, "Units=%s, of no length: passed over",
                   d->units);
  }
  shade_thread usual = {
      {1, 1, 1}, centimetres(d->thickness, d->unit), centimetres(d->spacing, d->unit)};
  if (d->color_line)
    set_color(w, p, d->color, d->rgb[0] < 0 ? NULL : d->rgb, d->color_line, usual.color);
  for (int i = 0; i < count; i++)
    threads[i] = usual;
  const row **own = index_rows(w, colors, first_key(w, colors, count), count);
  const row **spacing = index_rows(w, lengths[0], first_key(w, lengths[0], count), count);
  const row **thickness = index_rows(w, lengths[1], first_key(w, lengths[1], count), count);
  const int status = own && spacing && thickness ? 0 : shade_wif_fail(w, 0, out_of_memory);
  for (int i = 0; !status && i < count; i++) {
    if (own[i] && own[i]->count) {
      const int *n = w->pool + own[i]->first;
      set_color(w, p, n[0], own[i]->count == 4 ? n + 1 : NULL, own[i]->line, threads[i].color);
    }
    if (spacing[i])
      threads[i].spacing = centimetres(spacing[i]->length, d->unit);
    if (thickness[i])
      threads[i].thickness = centimetres(thickness[i]->length, d->unit);
  }
  free(own);
  free(spacing);
  free(thickness);
  return status;
}

/* --- all of it -------------------------------------------------------------------------- */

/* How many ends or picks: as announced, else as many as have rows. */
static int count_threads(wif *w, int weft, section where, const char *what) {
  const direction *d = &w->way[weft];
  const int rows = w->rows[where].largest + (w->rows[where].zero_line > 0);
  if (!d->threads)
    return rows;
  /* a liftplan may well end with picks that lift nothing */
  if (where != LIFTPLAN && rows < d->threads)
    shade_wif_mend(w, FEWER_ROWS, d->threads_line,
                   "Threads=%d, but [%s] ends with %d: the others %s", d->threads,
                   shade_wif_section_names[where], w->rows[where].largest, what);
  return d->threads;
}

static void check_contents(wif *w) {
  for (int s = 0; s < SECTIONS; s++) {
    if (w->denied[s] && w->seen[s] && (s >= ROWS || w->rows[s].count))
      shade_wif_mend(w, CONTENTS_WRONG, w->denied[s], "[CONTENTS] denies [%s]: read all the same",
                     shade_wif_section_names[s]);
    if (w->announced[s] && !w->seen[s])
      shade_wif_mend(w, CONTENTS_WRONG, w->announced[s], "[CONTENTS] announces [%s]: not there",
                     shade_wif_section_names[s]);
  }
}

shade_draft *shade_wif_draft(wif *w) {
  const int threading = w->rows[THREADING].count > 0, tieup = w->rows[TIEUP].count > 0;
  const int treadling = w->rows[TREADLING].count > 0, liftplan = w->rows[LIFTPLAN].count > 0;
  if (!threading && !liftplan) {
    shade_wif_fail(w, 0, "no [THREADING]: expected the sections of a Weaving Information File");
    return NULL;
  }
  if (!treadling && !liftplan) {
    shade_wif_fail(w, 0, "expected [TIEUP] and [TREADLING], or [LIFTPLAN]");
    return NULL;
  }
  const int both = liftplan && treadling && tieup && threading;
  const int by_liftplan = !threading || !treadling ||
                          (liftplan && (!tieup || w->denied[TIEUP] || w->denied[TREADLING]));
  const plan by = by_liftplan && !(both && w->denied[LIFTPLAN]) ? BY_LIFTPLAN : BY_TREADLES;
  const section steps = by == BY_LIFTPLAN ? LIFTPLAN : TREADLING;
  if (check_numbers(w, THREADING, "shaft", w->shafts) != 0 ||
      check_numbers(w, TIEUP, "shaft", w->shafts) != 0 ||
      check_numbers(w, LIFTPLAN, "shaft", w->shafts) != 0 ||
      check_numbers(w, TREADLING, "treadle", 0) != 0)
    return NULL;
  int ends;
  if (threading) {
    ends = count_threads(w, 0, THREADING, "have no shaft");
  } else {
    /* as on a loom with a hook for each end */
    const int used = uses_of(w, LIFTPLAN).largest;
    ends = w->way[0].threads ? w->way[0].threads : w->shafts ? w->shafts : used ? used : 1;
    shade_wif_mend(w, THREADING_MISSING, 0, "no [THREADING]: end n is on shaft n");
  }
  const int picks = count_threads(w, 1, steps, "lift nothing");
  if (ends > SHADE_DRAFT_MAX_CELLS / picks) {
    shade_wif_fail(w, w->way[0].threads_line, "%d ends x %d picks: expected at most %d crossings",
                   ends, picks, SHADE_DRAFT_MAX_CELLS);
    return NULL;
  }
  if (by == BY_TREADLES && !tieup)
    shade_wif_mend(w, TIEUP_MISSING, 0, "no [TIEUP]: treadle n lifts shaft n");
  if (by == BY_TREADLES && w->treadles && w->rows[TIEUP].largest > w->treadles)
    shade_wif_mend(w, TIEUP_BEYOND, w->seen[TIEUP],
                   "[TIEUP] has %d treadles, the file announces %d", w->rows[TIEUP].largest,
                   w->treadles);
  check_contents(w);
  palette p;
  int status = make_palette(w, &p);
  shade_draft *d = shade_draft_create(ends, picks);
  const char *wrong = d ? draw_down(w, by, ends, picks, d->warp_up) : out_of_memory;
  if (wrong)
    status = shade_wif_fail(w, 0, "%s", wrong);
  if (!status && both)
    compare_plans(w, by, d);
  if (!status)
    status = set_threads(w, 0, &p, d->warp, ends);
  if (!status)
    status = set_threads(w, 1, &p, d->weft, picks);
  free(p.colors);
  if (status) {
    shade_draft_free(d);
    return NULL;
  }
  return d;
}
