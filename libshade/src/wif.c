/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Weaving Information Files 1.1 [Wif1997]. The format, as far as a draft needs it:
 *
 * A text of sections, "[NAME]", each followed by lines "key=value"; a line that begins with ;
 * is a comment, and so is what follows a ; behind a number. In the sections of rows the key is
 * the number of an end, pick, treadle or colour, from 1, and rows that are left out have the
 * default.
 *   WEAVING        Shafts, Treadles, Rising Shed (yes/no): whether named shafts rise or sink
 *   WARP, WEFT     Threads (how many), Color (row of the colour table), Units (decipoints,
 *                  inches, centimeters), Spacing, Thickness
 *   COLOR PALETTE  Entries, Form (RGB), Range=lowest,highest    COLOR TABLE  colour=r,g,b
 *   THREADING      end=shaft          TIEUP     treadle=shafts, comma separated
 *   TREADLING      pick=treadles      LIFTPLAN  pick=shafts
 *   WARP COLORS, WARP SPACING, WARP THICKNESS and the same of WEFT: overrides by end and pick
 * Shaft, treadle and colour 0 mean none. The warp is over the weft where one of the end's
 * shafts is raised by one of the pick's treadles. All other sections are passed over, and so
 * is CONTENTS: the list of sections that many programs write does not always hold.
 */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shade/weave.h"

enum {
  MAX_FILE = 1 << 27,
  MAX_NUMBER = 1 << 24, /* of any whole number in a row */
  MAX_COLORS = 1 << 20,
  MAX_ROWS = 1 << 20,
  MAX_WORK = 1 << 30, /* steps from treadling to drawdown */
  MAX_TREADLES_WRITTEN = 64
};

/* Sections of rows of whole numbers, of rows of lengths, and of named values. */
typedef enum section {
  THREADING,
  TIEUP,
  TREADLING,
  LIFTPLAN,
  WARP_COLORS,
  WEFT_COLORS,
  COLOR_TABLE,
  WHOLE_ROWS,
  WARP_SPACING = WHOLE_ROWS,
  WEFT_SPACING,
  WARP_THICKNESS,
  WEFT_THICKNESS,
  ROWS,
  WEAVING = ROWS,
  WARP,
  WEFT,
  COLOR_PALETTE,
  SECTIONS,
  OTHER = SECTIONS
} section;

static const char *const section_names[SECTIONS] = {
    "THREADING",      "TIEUP",       "TREADLING",    "LIFTPLAN",     "WARP COLORS",
    "WEFT COLORS",    "COLOR TABLE", "WARP SPACING", "WEFT SPACING", "WARP THICKNESS",
    "WEFT THICKNESS", "WEAVING",     "WARP",         "WEFT",         "COLOR PALETTE"};

/* key=values on one line: `count` whole numbers from `first` on in the pool, or a length. */
typedef struct row {
  int key, first, count;
  long line;
  double length;
} row;

typedef struct rows {
  row *data;
  size_t count, capacity;
  int largest; /* key */
} rows;

/* [WARP] or [WEFT]. */
typedef struct direction {
  int threads, color;
  long threads_line, color_line;
  double unit, spacing, thickness; /* cm; the values in that unit */
} direction;

typedef struct parser {
  const char *name;
  long line;
  char *error;
  size_t error_size;
  rows rows[ROWS];
  int *pool;
  size_t pool_count, pool_capacity;
  int shafts, treadles, sinking;
  direction way[2]; /* warp, weft */
  double range[2];
  char point; /* the locale's decimal point */
} parser;

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static int
fail(const parser *p, long line, const char *format, ...) {
  char text[256];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (line > 0)
    snprintf(p->error, p->error_size, "%s, line %ld: %s", p->name, line, text);
  else
    snprintf(p->error, p->error_size, "%s: %s", p->name, text);
  return -1;
}

/* --- words and numbers ------------------------------------------------------------------ */

/* A stretch of one line, without the blanks around it. */
typedef struct span {
  const char *at, *end;
} span;

static int is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0';
}

static span trim(const char *at, const char *end) {
  while (at < end && is_blank(*at))
    at++;
  while (end > at && is_blank(end[-1]))
    end--;
  return (span){at, end};
}

static int capital(char c) {
  return c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c;
}

/* Whether the span is the word (in capitals); any blanks stand for the word's one. */
static int is_word(span s, const char *word) {
  for (; *word; word++) {
    if (s.at == s.end)
      return 0;
    if (*word == ' ') {
      if (!is_blank(*s.at))
        return 0;
      while (s.at < s.end && is_blank(*s.at))
        s.at++;
    } else if (capital(*s.at++) != *word)
      return 0;
  }
  return s.at == s.end;
}

/* What stands before a comment. */
static span without_comment(span s) {
  const char *semicolon = memchr(s.at, ';', (size_t)(s.end - s.at));
  return semicolon ? trim(s.at, semicolon) : s;
}

/* For messages: at most 40 characters, what cannot be shown as '?'. */
typedef struct shown {
  char text[44];
} shown;
static shown show(span s) {
  shown t;
  size_t n = 0;
  for (; s.at < s.end && n < 40; s.at++)
    t.text[n++] = *s.at >= ' ' && *s.at <= '~' ? *s.at : '?';
  if (s.at < s.end)
    n += (size_t)snprintf(t.text + n, 4, "...");
  t.text[n] = 0;
  return t;
}

/* A whole number of 0 to MAX_NUMBER that is the whole span; "3.0" passes as 3. -1 otherwise. */
static int read_whole(span s) {
  int value = 0;
  if (s.at < s.end && *s.at == '+')
    s.at++;
  if (s.at == s.end)
    return -1;
  for (; s.at < s.end && *s.at >= '0' && *s.at <= '9'; s.at++) {
    value = value * 10 + (*s.at - '0');
    if (value > MAX_NUMBER)
      return -1;
  }
  if (s.at < s.end && *s.at == '.')
    for (s.at++; s.at < s.end && *s.at == '0';)
      s.at++;
  return s.at == s.end ? value : -1;
}

/* A finite number that is the whole span; a lone comma passes as the decimal point. */
static int read_real(const parser *p, span s, double *value) {
  char text[64];
  const size_t length = (size_t)(s.end - s.at);
  if (!length || length >= sizeof text)
    return -1;
  for (size_t i = 0; i < length; i++) {
    char c = s.at[i];
    /* no words such as "nan", no hexadecimal */
    if (!((c >= '0' && c <= '9') || strchr("+-.,eE", c)) || !c)
      return -1;
    text[i] = c == '.' || c == ',' ? p->point : c;
  }
  text[length] = 0;
  char *end;
  *value = strtod(text, &end);
  return *end || !isfinite(*value) ? -1 : 0;
}

/* --- reading ---------------------------------------------------------------------------- */

static int add_row(parser *p, section where, row r) {
  rows *to = &p->rows[where];
  if (to->count == MAX_ROWS)
    return fail(p, p->line, "too many lines in [%s]: expected at most %d", section_names[where],
                MAX_ROWS);
  if (to->count == to->capacity) {
    size_t capacity = to->capacity ? 2 * to->capacity : 64;
    row *data = realloc(to->data, capacity * sizeof *data);
    if (!data)
      return fail(p, 0, "out of memory");
    to->data = data;
    to->capacity = capacity;
  }
  to->data[to->count++] = r;
  if (r.key > to->largest)
    to->largest = r.key;
  return 0;
}

static int add_number(parser *p, int number) {
  if (p->pool_count == p->pool_capacity) {
    size_t capacity = p->pool_capacity ? 2 * p->pool_capacity : 1024;
    int *pool = realloc(p->pool, capacity * sizeof *pool);
    if (!pool)
      return fail(p, 0, "out of memory");
    p->pool = pool;
    p->pool_capacity = capacity;
  }
  p->pool[p->pool_count++] = number;
  return 0;
}

/* "1,3, 5" to the pool; nothing between commas counts as nothing. Returns how many, or -1. */
static int read_list(parser *p, section where, span s) {
  int count = 0;
  while (s.at < s.end) {
    const char *comma = memchr(s.at, ',', (size_t)(s.end - s.at));
    span item = trim(s.at, comma ? comma : s.end);
    if (item.at < item.end) {
      int number = read_whole(item);
      if (number < 0)
        return fail(p, p->line, "'%s' in [%s]: expected whole numbers from 0 on, comma separated",
                    show(item).text, section_names[where]);
      if (add_number(p, number) != 0)
        return -1;
      count++;
    }
    s.at = comma ? comma + 1 : s.end;
  }
  return count;
}

static int read_row(parser *p, section where, span key, span value) {
  row r = {.line = p->line, .first = (int)p->pool_count};
  r.key = read_whole(key);
  const int most = where == COLOR_TABLE ? MAX_COLORS : SHADE_DRAFT_MAX_SIDE;
  if (r.key < 1 || r.key > most)
    return fail(p, p->line,
                "'%s' in [%s]: expected a number of 1 to %d before the =", show(key).text,
                section_names[where], most);
  value = without_comment(value);
  if (where < WHOLE_ROWS) {
    r.count = read_list(p, where, value);
    if (r.count < 0)
      return -1;
    if (where == COLOR_TABLE && r.count != 3)
      return fail(p, p->line, "colour %d: expected three numbers: red, green, blue", r.key);
    return add_row(p, where, r);
  }
  if (value.at == value.end)
    return 0;
  if (read_real(p, value, &r.length) != 0 || !(r.length >= 0 && r.length <= 1e6))
    return fail(p, p->line, "'%s' in [%s]: expected a length of 0 to 1e6", show(value).text,
                section_names[where]);
  return add_row(p, where, r);
}

static int read_count(const parser *p, span key, span value, int most, int *count) {
  *count = read_whole(value);
  if (*count < 0 || *count > most)
    return fail(p, p->line, "%s=%s: expected a whole number of 0 to %d", show(key).text,
                show(value).text, most);
  return 0;
}

static int read_direction(parser *p, direction *s, span key, span value) {
  static const struct {
    const char *word;
    double cm;
  } units[] = {{"CENTIMETERS", 1},       {"CENTIMETRES", 1}, {"CENTIMETER", 1},
               {"CENTIMETRE", 1},        {"CM", 1},          {"INCHES", 2.54},
               {"INCH", 2.54},           {"IN", 2.54},       {"MILLIMETERS", .1},
               {"MILLIMETRES", .1},      {"MM", .1},         {"DECIPOINTS", 2.54 / 720},
               {"DECIPOINT", 2.54 / 720}};
  if (is_word(key, "THREADS")) {
    s->threads_line = p->line;
    return read_count(p, key, value, SHADE_DRAFT_MAX_SIDE, &s->threads);
  }
  if (is_word(key, "COLOR") || is_word(key, "COLOUR")) {
    /* version 1.0 added the colour itself: number,r,g,b */
    const char *comma = memchr(value.at, ',', (size_t)(value.end - value.at));
    s->color_line = p->line;
    return read_count(p, key, comma ? trim(value.at, comma) : value, MAX_NUMBER, &s->color);
  }
  if (is_word(key, "UNITS")) {
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
      if (is_word(value, units[i].word)) {
        s->unit = units[i].cm;
        return 0;
      }
    return fail(p, p->line, "Units=%s: expected decipoints, inches or centimeters",
                show(value).text);
  }
  double *length = is_word(key, "SPACING")     ? &s->spacing
                   : is_word(key, "THICKNESS") ? &s->thickness
                                               : NULL;
  if (length && (read_real(p, value, length) != 0 || !(*length >= 0 && *length <= 1e6)))
    return fail(p, p->line, "%s=%s: expected a length of 0 to 1e6", show(key).text,
                show(value).text);
  return 0;
}

static int read_shed(parser *p, span value) {
  static const char *const yes[] = {"YES", "TRUE", "ON", "1", "Y", "T"};
  static const char *const no[] = {"NO", "FALSE", "OFF", "0", "N", "F"};
  for (size_t i = 0; i < sizeof yes / sizeof yes[0]; i++) {
    if (is_word(value, yes[i])) {
      p->sinking = 0;
      return 0;
    }
    if (is_word(value, no[i])) {
      p->sinking = 1;
      return 0;
    }
  }
  return fail(p, p->line, "Rising Shed=%s: expected yes or no", show(value).text);
}

static int read_range(parser *p, span value) {
  const char *comma = memchr(value.at, ',', (size_t)(value.end - value.at));
  int low = -1, high = -1;
  if (comma) {
    low = read_whole(trim(value.at, comma));
    high = read_whole(trim(comma + 1, value.end));
  }
  if (low < 0 || high <= low)
    return fail(p, p->line, "Range=%s: expected two whole numbers, the lower first",
                show(value).text);
  p->range[0] = low;
  p->range[1] = high;
  return 0;
}

static int read_line(parser *p, section where, span key, span value) {
  if (where < ROWS)
    return read_row(p, where, key, value);
  value = without_comment(value);
  if (value.at == value.end)
    return 0; /* left empty: the default */
  switch (where) {
  case WARP:
  case WEFT:
    return read_direction(p, &p->way[where == WEFT], key, value);
  case WEAVING:
    if (is_word(key, "SHAFTS"))
      return read_count(p, key, value, SHADE_DRAFT_MAX_SIDE, &p->shafts);
    if (is_word(key, "TREADLES"))
      return read_count(p, key, value, SHADE_DRAFT_MAX_SIDE, &p->treadles);
    return is_word(key, "RISING SHED") ? read_shed(p, value) : 0;
  default: /* COLOR_PALETTE */
    if (is_word(key, "FORM") && !is_word(value, "RGB"))
      return fail(p, p->line, "Form=%s: expected RGB", show(value).text);
    return is_word(key, "RANGE") ? read_range(p, value) : 0;
  }
}

static int read_text(parser *p, const char *text, size_t length) {
  section where = OTHER;
  const char *const end = text + length;
  while (text < end) {
    const char *stop = text;
    while (stop < end && *stop != '\n' && *stop != '\r')
      stop++;
    p->line++;
    span s = trim(text, stop);
    text = stop < end && *stop == '\r' && stop + 1 < end && stop[1] == '\n' ? stop + 2 : stop + 1;
    if (s.at == s.end || *s.at == ';' || *s.at == '#')
      continue;
    if (*s.at == 0x1a) /* where DOS ends a text */
      break;
    if (*s.at == '[') {
      const char *close = memchr(s.at, ']', (size_t)(s.end - s.at));
      if (!close)
        return fail(p, p->line, "'%s': expected ] after the section's name", show(s).text);
      span name = trim(s.at + 1, close);
      for (where = 0; where < SECTIONS && !is_word(name, section_names[where]);)
        where++;
      continue;
    }
    if (where == OTHER)
      continue;
    const char *equals = memchr(s.at, '=', (size_t)(s.end - s.at));
    if (!equals)
      return fail(p, p->line, "'%s' in [%s]: expected key=value", show(s).text,
                  section_names[where]);
    if (read_line(p, where, trim(s.at, equals), trim(equals + 1, s.end)) != 0)
      return -1;
  }
  return 0;
}

/* --- from what was read to a draft ------------------------------------------------------ */

/* The row of each key, the last of several; index[key] is its number + 1, or 0. */
static int *index_rows(const parser *p, section where, int size) {
  int *index = calloc((size_t)size + 1, sizeof *index);
  for (size_t i = 0; index && i < p->rows[where].count; i++)
    if (p->rows[where].data[i].key <= size)
      index[p->rows[where].data[i].key] = (int)i + 1;
  return index;
}

/* No key beyond `keys`, no number beyond `numbers` (0: not announced). */
static int check_rows(const parser *p, section where, int keys, const char *key_name, int numbers,
                      const char *number_name) {
  for (size_t i = 0; i < p->rows[where].count; i++) {
    const row *r = &p->rows[where].data[i];
    if (keys && r->key > keys)
      return fail(p, r->line, "%s %d in [%s]: the file announces %d", key_name, r->key,
                  section_names[where], keys);
    for (int k = 0; k < r->count; k++)
      if (p->pool[r->first + k] > (numbers ? numbers : SHADE_DRAFT_MAX_SIDE))
        return fail(p, r->line, "%s %d in [%s]: expected at most %d", number_name,
                    p->pool[r->first + k], section_names[where],
                    numbers ? numbers : SHADE_DRAFT_MAX_SIDE);
  }
  return 0;
}

/* Mark the shafts of row `number` (from index_rows) with `mark`. */
static void mark_shafts(const parser *p, section where, int number, int *marks, int mark) {
  if (!number)
    return;
  const row *r = &p->rows[where].data[number - 1];
  for (int k = 0; k < r->count; k++)
    marks[p->pool[r->first + k]] = mark;
}

/* Over and under: threading x tie-up x treadling, or threading x liftplan. */
static int draw_down(const parser *p, shade_draft *d, int by_treadles) {
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
    status = fail(p, 0, "out of memory");
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
      status = fail(p, 0, "too large: more than %d steps from treadling to drawdown", MAX_WORK);
  }
  free(threading);
  free(picks);
  free(tieup);
  free(marks);
  free(pressed);
  return status;
}

static int set_color(const parser *p, const int *table, int colors, int color, long line,
                     double to[3]) {
  if (!color || !p->rows[COLOR_TABLE].count)
    return 0;
  if (color > colors || !table[color])
    return fail(p, line, "colour %d: not in [COLOR TABLE]", color);
  const row *r = &p->rows[COLOR_TABLE].data[table[color] - 1];
  for (int c = 0; c < 3; c++) {
    const double value = p->pool[r->first + c];
    if (value < p->range[0] || value > p->range[1])
      return fail(p, r->line, "colour %d: %g is not within Range=%g,%g", color, value, p->range[0],
                  p->range[1]);
    to[c] = (value - p->range[0]) / (p->range[1] - p->range[0]);
  }
  return 0;
}

/* Colour, spacing and thickness of the ends (weft 0) or picks (weft 1). */
static int set_threads(const parser *p, int weft, const int *table, int colors,
                       shade_thread *threads, int count) {
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

static shade_draft *make_draft(const parser *p) {
  const int by_treadles = p->rows[TIEUP].count && p->rows[TREADLING].count;
  if (!p->rows[THREADING].count) {
    fail(p, 0, "no [THREADING]: expected the sections of a Weaving Information File");
    return NULL;
  }
  if (!by_treadles && !p->rows[LIFTPLAN].count) {
    fail(p, 0, "expected [TIEUP] and [TREADLING], or [LIFTPLAN]");
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
    fail(p, p->way[0].threads_line, "%d ends x %d picks: expected at most %d crossings", ends,
         picks, SHADE_DRAFT_MAX_CELLS);
    return NULL;
  }
  const int colors = p->rows[COLOR_TABLE].largest;
  int *table = index_rows(p, COLOR_TABLE, colors);
  shade_draft *d = shade_draft_create(ends, picks);
  int status = table && d ? 0 : fail(p, 0, "out of memory");
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

/* UTF-16 to bytes, what is not ASCII as '?'. The format's own words and numbers are ASCII. */
static char *narrow(const char *text, size_t length, size_t *narrowed) {
  const size_t big = (unsigned char)text[0] == 0xfe;
  char *to = malloc(length);
  *narrowed = 0;
  for (size_t i = 2; to && i + 1 < length; i += 2) {
    const unsigned char high = (unsigned char)text[i + !big], low = (unsigned char)text[i + big];
    to[(*narrowed)++] = high || low > 126 ? '?' : (char)low;
  }
  return to;
}

static int starts_with(const char *text, size_t length, const char *mark, size_t size) {
  return length >= size && !memcmp(text, mark, size);
}

shade_draft *shade_wif_parse(const char *text, size_t length, const char *name, char *error,
                             size_t error_size) {
  parser p = {.name = name, .error = error, .error_size = error_size, .range = {0, 255}};
  char number[8];
  p.way[0].unit = p.way[1].unit = 1;
  snprintf(number, sizeof number, "%.1f", .5);
  p.point = number[1];
  if (length > MAX_FILE) {
    fail(&p, 0, "too large: expected at most %d bytes", MAX_FILE);
    return NULL;
  }
  char *narrowed = NULL;
  if (starts_with(text, length, "\xff\xfe", 2) || starts_with(text, length, "\xfe\xff", 2)) {
    text = narrowed = narrow(text, length, &length);
    if (!text) {
      fail(&p, 0, "out of memory");
      return NULL;
    }
  } else if (starts_with(text, length, "\xef\xbb\xbf", 3)) {
    text += 3;
    length -= 3;
  }
  shade_draft *d = read_text(&p, text, length) == 0 ? make_draft(&p) : NULL;
  for (int i = 0; i < ROWS; i++)
    free(p.rows[i].data);
  free(p.pool);
  free(narrowed);
  return d;
}

shade_draft *shade_wif_read(const char *path, char *error, size_t error_size) {
  FILE *file = fopen(path, "rb");
  char *text = NULL;
  size_t length = 0, capacity = 0;
  int wrong = !file;
  errno = file ? 0 : errno;
  while (!wrong) {
    if (length == capacity) {
      capacity = capacity ? 2 * capacity : 1 << 16;
      char *more = capacity <= 2u * MAX_FILE ? realloc(text, capacity) : NULL;
      if (!more) {
        errno = capacity <= 2u * MAX_FILE ? ENOMEM : EFBIG;
        wrong = 1;
        break;
      }
      text = more;
    }
    size_t got = fread(text + length, 1, capacity - length, file);
    length += got;
    if (!got) {
      wrong = ferror(file);
      break;
    }
  }
  if (wrong)
    snprintf(error, error_size, "%s: %s", path, errno ? strerror(errno) : "cannot be read");
  if (file)
    fclose(file);
  shade_draft *d = wrong ? NULL : shade_wif_parse(text, length, path, error, error_size);
  free(text);
  return d;
}

/* --- writing ---------------------------------------------------------------------------- */

typedef struct writer {
  char *text;
  size_t length, capacity;
  int failed;
} writer;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
put(writer *w, const char *format, ...) {
  char piece[512];
  va_list args;
  va_start(args, format);
  const int got = vsnprintf(piece, sizeof piece, format, args);
  va_end(args);
  if (got < 0 || (size_t)got >= sizeof piece)
    w->failed = 1;
  while (!w->failed && w->capacity - w->length <= (size_t)got) {
    size_t capacity = w->capacity ? 2 * w->capacity : 4096;
    char *text = realloc(w->text, capacity);
    w->failed = !text;
    w->text = text ? text : w->text;
    w->capacity = text ? capacity : w->capacity;
  }
  if (w->failed)
    return;
  memcpy(w->text + w->length, piece, (size_t)got + 1);
  w->length += (size_t)got;
}

/* A number that reads back the same, with a point in any locale. */
static void put_length(writer *w, const char *key, double x) {
  char text[40];
  x = x > 0 ? fmin(x, 1e6) : 0;
  snprintf(text, sizeof text, "%.15g", x);
  if (strtod(text, NULL) != x)
    snprintf(text, sizeof text, "%.17g", x);
  for (char *c = text; *c; c++)
    if (*c == ',')
      *c = '.';
  put(w, "%s=%s\n", key, text);
}

/* Which of the lines of `size` bytes, `count` of them, are the same: each one's class, from
 * 0 in the order of first appearance. Returns the number of classes. */
static int classify(const unsigned char *lines, int count, size_t size, int *classes, int *first) {
  /* open addressing over twice as many places as there can be classes */
  const uint32_t places = 4 * SHADE_DRAFT_MAX_SIDE;
  int *table = calloc(places, sizeof *table), number = 0;
  if (!table)
    return -1;
  for (int i = 0; i < count; i++) {
    const unsigned char *line = lines + (size_t)i * size;
    uint32_t hash = 2166136261u;
    for (size_t k = 0; k < size; k++)
      hash = (hash ^ line[k]) * 16777619u;
    uint32_t place = (hash ^ hash >> 15) % places;
    while (table[place] && memcmp(lines + (size_t)first[table[place] - 1] * size, line, size))
      place = (place + 1) % places;
    if (!table[place]) {
      first[number++] = i;
      table[place] = number;
    }
    classes[i] = table[place] - 1;
  }
  free(table);
  return number;
}

/* The smallest N that all colours are whole numbers of 1/N of, the usual ones first. */
static int color_range(const unsigned char *colors, const int *first, int count) {
  static const int usual[] = {255, 65535, 999};
  for (int k = -3; k <= 65535; k++) {
    const int n = k < 0 ? usual[k + 3] : k;
    int exact = n > 0;
    for (int i = 0; exact && i < count; i++) {
      double c[3];
      memcpy(c, colors + (size_t)first[i] * sizeof c, sizeof c);
      for (int channel = 0; channel < 3; channel++)
        exact &= floor(c[channel] * n + .5) / n == c[channel];
    }
    if (exact)
      return n;
  }
  return 16777215;
}

static void put_threads(writer *w, const char *name, const shade_thread *threads, int count,
                        const int *colors) {
  put(w, "\n[%s]\nThreads=%d\nColor=%d\nUnits=centimeters\n", name, count, colors[0] + 1);
  if (threads[0].spacing > 0)
    put_length(w, "Spacing", threads[0].spacing);
  if (threads[0].thickness > 0)
    put_length(w, "Thickness", threads[0].thickness);
}

/* The rows that differ from the first, which is the default. */
static void put_overrides(writer *w, const char *name, const shade_thread *threads, int count,
                          const int *colors, int contents) {
  int differ[3] = {0, 0, 0};
  static const char *const what[] = {"COLORS", "SPACING", "THICKNESS"};
  for (int i = 0; i < count; i++) {
    differ[0] |= colors[i] != colors[0];
    differ[1] |= threads[i].spacing != threads[0].spacing;
    differ[2] |= threads[i].thickness != threads[0].thickness;
  }
  for (int k = 0; k < 3; k++) {
    if (!differ[k])
      continue;
    if (contents) {
      put(w, "%s %s=true\n", name, what[k]);
      continue;
    }
    put(w, "\n[%s %s]\n", name, what[k]);
    for (int i = 0; i < count; i++) {
      char key[16];
      snprintf(key, sizeof key, "%d", i + 1);
      if (k == 0 && colors[i] != colors[0])
        put(w, "%d=%d\n", i + 1, colors[i] + 1);
      if (k == 1 && threads[i].spacing != threads[0].spacing)
        put_length(w, key, threads[i].spacing);
      if (k == 2 && threads[i].thickness != threads[0].thickness)
        put_length(w, key, threads[i].thickness);
    }
  }
}

/* The shafts that pick j raises, after "key=". */
static void put_shafts(writer *w, const shade_draft *d, int key, int j, const int *first_end,
                       int shafts) {
  put(w, "%d=", key);
  const char *comma = "";
  for (int s = 0; s < shafts; s++)
    if (d->warp_up[(size_t)j * (size_t)d->ends + (size_t)first_end[s]]) {
      put(w, "%s%d", comma, s + 1);
      comma = ",";
    }
  put(w, "%s\n", *comma ? "" : "0");
}

char *shade_wif_text(const shade_draft *d) {
  const size_t ends = (size_t)d->ends, picks = (size_t)d->picks, both = ends + picks;
  unsigned char *columns = malloc(ends * picks), *rows = malloc(ends * picks);
  double(*colors)[3] = malloc(both * sizeof *colors);
  int *shaft = calloc(2 * ends, sizeof *shaft), *treadle = calloc(2 * picks, sizeof *treadle);
  int *color = calloc(2 * both, sizeof *color);
  writer w = {0};
  w.failed = !columns || !rows || !colors || !shaft || !treadle || !color;
  int shafts = -1, treadles = -1, table = -1;
  if (!w.failed) {
    for (size_t j = 0; j < picks; j++)
      for (size_t i = 0; i < ends; i++)
        columns[i * picks + j] = rows[j * ends + i] = d->warp_up[j * ends + i] != 0;
    for (size_t i = 0; i < both; i++)
      for (int c = 0; c < 3; c++) {
        const double x = i < ends ? d->warp[i].color[c] : d->weft[i - ends].color[c];
        colors[i][c] = x > 0 ? fmin(x, 1) : 0; /* a NaN too, and -0 */
      }
    shafts = classify(columns, d->ends, picks, shaft, shaft + ends);
    treadles = classify(rows, d->picks, ends, treadle, treadle + picks);
    table = classify((unsigned char *)colors, (int)both, sizeof *colors, color, color + both);
  }
  if (shafts < 0 || treadles < 0 || table < 0) {
    w.failed = 1;
  } else {
    const int lift = treadles > MAX_TREADLES_WRITTEN;
    const int range = color_range((unsigned char *)colors, color + both, table);
    put(&w,
        "[WIF]\nVersion=1.1\nDate=April 20, 1997\nDevelopers=wif@mhsoft.com\n"
        "Source Program=libshade\nSource Version=%s\n\n[CONTENTS]\nCOLOR PALETTE=true\n"
        "WEAVING=true\nWARP=true\nWEFT=true\n%sCOLOR TABLE=true\nTHREADING=true\n%s=true\n",
        SHADE_VERSION, lift ? "" : "TIEUP=true\n", lift ? "LIFTPLAN" : "TREADLING");
    put_overrides(&w, "WARP", d->warp, d->ends, color, 1);
    put_overrides(&w, "WEFT", d->weft, d->picks, color + ends, 1);
    put(&w, "\n[WEAVING]\nShafts=%d\nTreadles=%d\nRising Shed=true\n", shafts,
        lift ? shafts : treadles);
    put_threads(&w, "WARP", d->warp, d->ends, color);
    put_threads(&w, "WEFT", d->weft, d->picks, color + ends);
    put(&w, "\n[COLOR PALETTE]\nEntries=%d\nForm=RGB\nRange=0,%d\n\n[COLOR TABLE]\n", table, range);
    for (int i = 0; i < table; i++) {
      const double *c = colors[color[both + (size_t)i]];
      put(&w, "%d=%.0f,%.0f,%.0f\n", i + 1, floor(c[0] * range + .5), floor(c[1] * range + .5),
          floor(c[2] * range + .5));
    }
    put(&w, "\n[THREADING]\n");
    for (int i = 0; i < d->ends; i++)
      put(&w, "%d=%d\n", i + 1, shaft[i] + 1);
    put(&w, lift ? "\n[LIFTPLAN]\n" : "\n[TIEUP]\n");
    for (int i = 0; i < (lift ? d->picks : treadles); i++)
      put_shafts(&w, d, i + 1, lift ? i : treadle[picks + (size_t)i], shaft + ends, shafts);
    if (!lift) {
      put(&w, "\n[TREADLING]\n");
      for (int i = 0; i < d->picks; i++)
        put(&w, "%d=%d\n", i + 1, treadle[i] + 1);
    }
    put_overrides(&w, "WARP", d->warp, d->ends, color, 0);
    put_overrides(&w, "WEFT", d->weft, d->picks, color + ends, 0);
  }
  free(columns);
  free(rows);
  free(colors);
  free(shaft);
  free(treadle);
  free(color);
  if (w.failed) {
    free(w.text);
    return NULL;
  }
  return w.text;
}
