/* SPDX-License-Identifier: Apache-2.0 */
/* Weaving Information Files: from lines to rows. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "wif.h"

static int add_row(wif *p, section where, row r) {
  rows *to = &p->rows[where];
  if (to->count == MAX_ROWS)
    return wif_fail(p, p->line, "too many lines in [%s]: expected at most %d",
                    wif_section_names[where], MAX_ROWS);
  if (to->count == to->capacity) {
    size_t capacity = to->capacity ? 2 * to->capacity : 64;
    row *data = realloc(to->data, capacity * sizeof *data);
    if (!data)
      return wif_fail(p, 0, "out of memory");
    to->data = data;
    to->capacity = capacity;
  }
  to->data[to->count++] = r;
  if (r.key > to->largest)
    to->largest = r.key;
  return 0;
}

static int add_number(wif *p, int number) {
  if (p->pool_count == p->pool_capacity) {
    size_t capacity = p->pool_capacity ? 2 * p->pool_capacity : 1024;
    int *pool = realloc(p->pool, capacity * sizeof *pool);
    if (!pool)
      return wif_fail(p, 0, "out of memory");
    p->pool = pool;
    p->pool_capacity = capacity;
  }
  p->pool[p->pool_count++] = number;
  return 0;
}

/* "1,3, 5" to the pool; nothing between commas counts as nothing. Returns how many, or -1. */
static int read_list(wif *p, section where, span s) {
  int count = 0;
  while (s.at < s.end) {
    const char *comma = memchr(s.at, ',', (size_t)(s.end - s.at));
    span item = wif_trim(s.at, comma ? comma : s.end);
    if (item.at < item.end) {
      int number = wif_whole(item);
      if (number < 0)
        return wif_fail(p, p->line,
                        "'%s' in [%s]: expected whole numbers from 0 on, comma separated",
                        wif_show(item).text, wif_section_names[where]);
      if (add_number(p, number) != 0)
        return -1;
      count++;
    }
    s.at = comma ? comma + 1 : s.end;
  }
  return count;
}

static int read_row(wif *p, section where, span key, span value) {
  row r = {.line = p->line, .first = (int)p->pool_count};
  r.key = wif_whole(key);
  const int most = where == COLOR_TABLE ? MAX_COLORS : SHADE_DRAFT_MAX_SIDE;
  if (r.key < 1 || r.key > most)
    return wif_fail(p, p->line,
                    "'%s' in [%s]: expected a number of 1 to %d before the =", wif_show(key).text,
                    wif_section_names[where], most);
  value = wif_without_comment(value);
  if (where < WHOLE_ROWS) {
    r.count = read_list(p, where, value);
    if (r.count < 0)
      return -1;
    if (where == COLOR_TABLE && r.count != 3)
      return wif_fail(p, p->line, "colour %d: expected three numbers: red, green, blue", r.key);
    return add_row(p, where, r);
  }
  if (value.at == value.end)
    return 0;
  if (wif_real(p, value, &r.length) != 0 || !(r.length >= 0 && r.length <= 1e6))
    return wif_fail(p, p->line, "'%s' in [%s]: expected a length of 0 to 1e6", wif_show(value).text,
                    wif_section_names[where]);
  return add_row(p, where, r);
}

static int read_count(const wif *p, span key, span value, int most, int *count) {
  *count = wif_whole(value);
  if (*count < 0 || *count > most)
    return wif_fail(p, p->line, "%s=%s: expected a whole number of 0 to %d", wif_show(key).text,
                    wif_show(value).text, most);
  return 0;
}

static int read_direction(wif *p, direction *s, span key, span value) {
  static const struct {
    const char *word;
    double cm;
  } units[] = {{"CENTIMETERS", 1},       {"CENTIMETRES", 1}, {"CENTIMETER", 1},
               {"CENTIMETRE", 1},        {"CM", 1},          {"INCHES", 2.54},
               {"INCH", 2.54},           {"IN", 2.54},       {"MILLIMETERS", .1},
               {"MILLIMETRES", .1},      {"MM", .1},         {"DECIPOINTS", 2.54 / 720},
               {"DECIPOINT", 2.54 / 720}};
  if (wif_is_word(key, "THREADS")) {
    s->threads_line = p->line;
    return read_count(p, key, value, SHADE_DRAFT_MAX_SIDE, &s->threads);
  }
  if (wif_is_word(key, "COLOR") || wif_is_word(key, "COLOUR")) {
    /* version 1.0 added the colour itself: number,r,g,b */
    const char *comma = memchr(value.at, ',', (size_t)(value.end - value.at));
    s->color_line = p->line;
    return read_count(p, key, comma ? wif_trim(value.at, comma) : value, MAX_NUMBER, &s->color);
  }
  if (wif_is_word(key, "UNITS")) {
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
      if (wif_is_word(value, units[i].word)) {
        s->unit = units[i].cm;
        return 0;
      }
    return wif_fail(p, p->line, "Units=%s: expected decipoints, inches or centimeters",
                    wif_show(value).text);
  }
  double *length = wif_is_word(key, "SPACING")     ? &s->spacing
                   : wif_is_word(key, "THICKNESS") ? &s->thickness
                                                   : NULL;
  if (length && (wif_real(p, value, length) != 0 || !(*length >= 0 && *length <= 1e6)))
    return wif_fail(p, p->line, "%s=%s: expected a length of 0 to 1e6", wif_show(key).text,
                    wif_show(value).text);
  return 0;
}

static int read_shed(wif *p, span value) {
  static const char *const yes[] = {"YES", "TRUE", "ON", "1", "Y", "T"};
  static const char *const no[] = {"NO", "FALSE", "OFF", "0", "N", "F"};
  for (size_t i = 0; i < sizeof yes / sizeof yes[0]; i++) {
    if (wif_is_word(value, yes[i])) {
      p->sinking = 0;
      return 0;
    }
    if (wif_is_word(value, no[i])) {
      p->sinking = 1;
      return 0;
    }
  }
  return wif_fail(p, p->line, "Rising Shed=%s: expected yes or no", wif_show(value).text);
}

static int read_range(wif *p, span value) {
  const char *comma = memchr(value.at, ',', (size_t)(value.end - value.at));
  int low = -1, high = -1;
  if (comma) {
    low = wif_whole(wif_trim(value.at, comma));
    high = wif_whole(wif_trim(comma + 1, value.end));
  }
  if (low < 0 || high <= low)
    return wif_fail(p, p->line, "Range=%s: expected two whole numbers, the lower first",
                    wif_show(value).text);
  p->range[0] = low;
  p->range[1] = high;
  return 0;
}

static int read_line(wif *p, section where, span key, span value) {
  if (where < ROWS)
    return read_row(p, where, key, value);
  value = wif_without_comment(value);
  if (value.at == value.end)
    return 0; /* left empty: the default */
  switch (where) {
  case WARP:
  case WEFT:
    return read_direction(p, &p->way[where == WEFT], key, value);
  case WEAVING:
    if (wif_is_word(key, "SHAFTS"))
      return read_count(p, key, value, SHADE_DRAFT_MAX_SIDE, &p->shafts);
    if (wif_is_word(key, "TREADLES"))
      return read_count(p, key, value, SHADE_DRAFT_MAX_SIDE, &p->treadles);
    return wif_is_word(key, "RISING SHED") ? read_shed(p, value) : 0;
  default: /* COLOR_PALETTE */
    if (wif_is_word(key, "FORM") && !wif_is_word(value, "RGB"))
      return wif_fail(p, p->line, "Form=%s: expected RGB", wif_show(value).text);
    return wif_is_word(key, "RANGE") ? read_range(p, value) : 0;
  }
}

static int read_text(wif *p, const char *text, size_t length) {
  section where = OTHER;
  const char *const end = text + length;
  while (text < end) {
    const char *stop = text;
    while (stop < end && *stop != '\n' && *stop != '\r')
      stop++;
    p->line++;
    span s = wif_trim(text, stop);
    text = stop < end && *stop == '\r' && stop + 1 < end && stop[1] == '\n' ? stop + 2 : stop + 1;
    if (s.at == s.end || *s.at == ';' || *s.at == '#')
      continue;
    if (*s.at == 0x1a) /* where DOS ends a text */
      break;
    if (*s.at == '[') {
      const char *close = memchr(s.at, ']', (size_t)(s.end - s.at));
      if (!close)
        return wif_fail(p, p->line, "'%s': expected ] after the section's name", wif_show(s).text);
      span name = wif_trim(s.at + 1, close);
      for (where = 0; where < SECTIONS && !wif_is_word(name, wif_section_names[where]);)
        where++;
      continue;
    }
    if (where == OTHER)
      continue;
    const char *equals = memchr(s.at, '=', (size_t)(s.end - s.at));
    if (!equals)
      return wif_fail(p, p->line, "'%s' in [%s]: expected key=value", wif_show(s).text,
                      wif_section_names[where]);
    if (read_line(p, where, wif_trim(s.at, equals), wif_trim(equals + 1, s.end)) != 0)
      return -1;
  }
  return 0;
}

shade_draft *shade_wif_parse(const char *text, size_t length, const char *name, char *error,
                             size_t error_size) {
  wif p = {.name = name, .error = error, .error_size = error_size, .range = {0, 255}};
  char number[8];
  p.way[0].unit = p.way[1].unit = 1;
  snprintf(number, sizeof number, "%.1f", .5);
  p.point = number[1];
  if (length > MAX_FILE) {
    wif_fail(&p, 0, "too large: expected at most %d bytes", MAX_FILE);
    return NULL;
  }
  char *made;
  if (wif_as_bytes(&text, &length, &made) != 0) {
    wif_fail(&p, 0, "out of memory");
    return NULL;
  }
  shade_draft *d = read_text(&p, text, length) == 0 ? wif_draft(&p) : NULL;
  for (int i = 0; i < ROWS; i++)
    free(p.rows[i].data);
  free(p.pool);
  free(made);
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
