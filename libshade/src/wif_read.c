/* SPDX-License-Identifier: Apache-2.0 */
/* Weaving Information Files: from lines to rows. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../port/files.h"
#include "wif.h"

static int add_row(wif *w, section where, row r) {
  rows *to = &w->rows[where];
  if (to->count == MAX_ROWS)
    return shade_wif_fail(w, w->line, "too many lines in [%s]: expected at most %d",
                          shade_wif_section_names[where], MAX_ROWS);
  if (to->count == to->capacity) {
    size_t capacity = to->capacity ? 2 * to->capacity : 64;
    row *data = realloc(to->data, capacity * sizeof *data);
    if (!data)
      return shade_wif_fail(w, 0, "out of memory");
    to->data = data;
    to->capacity = capacity;
  }
  to->data[to->count++] = r;
  if (r.key > to->largest)
    to->largest = r.key;
  if (!r.key && !to->zero_line)
    to->zero_line = r.line;
  return 0;
}

static int add_number(wif *w, int number) {
  if (w->pool_count == w->pool_capacity) {
    size_t capacity = w->pool_capacity ? 2 * w->pool_capacity : 1024;
    int *pool = realloc(w->pool, capacity * sizeof *pool);
    if (!pool)
      return shade_wif_fail(w, 0, "out of memory");
    w->pool = pool;
    w->pool_capacity = capacity;
  }
  w->pool[w->pool_count++] = number;
  return 0;
}

/* "1,3, 5" to the pool; nothing between commas counts as nothing. Returns how many, or -1. */
static int read_list(wif *w, section where, span s) {
  int count = 0;
  for (span item = shade_wif_item(&s); item.at < item.end; item = shade_wif_item(&s), count++) {
    const int number = shade_wif_whole(item);
    if (number < 0)
      return shade_wif_fail(w, w->line,
                            "'%s' in [%s]: expected whole numbers from 0 on, comma separated",
                            shade_wif_show(item).text, shade_wif_section_names[where]);
    if (add_number(w, number) != 0)
      return -1;
  }
  return count;
}

/* "#c83232" to the pool, or "#c33", the same in short. Returns how many numbers, or -1. */
static int read_hex(wif *w, span s) {
  static const char digits[] = "0123456789abcdefABCDEF";
  if (s.end - s.at >= 2 && *s.at == '"' && s.end[-1] == '"')
    s = (span){s.at + 1, s.end - 1};
  const ptrdiff_t each = (s.end - s.at) / 3; /* digits of a channel, after the # */
  if (s.at == s.end || *s.at != '#' || s.end - s.at != 3 * each + 1 || each < 1 || each > 2)
    return 0;
  int rgb[3] = {0, 0, 0};
  for (ptrdiff_t i = 0; i < 3 * each; i++) {
    const char *const digit = strchr(digits, s.at[1 + i]);
    if (!digit || !*digit)
      return 0;
    const int found = (int)(digit - digits), value = found < 16 ? found : found - 6;
    rgb[i / each] = 16 * rgb[i / each] + value;
  }
  for (int c = 0; c < 3; c++)
    if (add_number(w, each == 1 ? 17 * rgb[c] : rgb[c]) != 0)
      return -1;
  return 3;
}

static int leave_color(wif *w, span s) {
  shade_wif_mend(w, COLOR_NONE, w->line, "'%s' in [COLOR TABLE], no number of a colour: left out",
                 shade_wif_show(s).text);
  return 0;
}

/* A row of the colour table; `value` has what looks like a comment. One that is none is left out.
 */
static int read_color_row(wif *w, row r, span value) {
  span rest = value, item = shade_wif_item(&rest);
  r.count = read_hex(w, item);
  r.hex = r.count > 0;
  if (r.hex) {
    const int *n = w->pool + r.first;
    shade_wif_mend(w, COLOR_HEX, w->line, "colour %d is %s: taken as %d,%d,%d of 255", r.key,
                   shade_wif_show(item).text, n[0], n[1], n[2]);
  }
  rest = shade_wif_value(value);
  for (item = shade_wif_item(&rest); !r.hex && r.count >= 0 && item.at < item.end;
       item = shade_wif_item(&rest)) {
    const int number = shade_wif_whole(item);
    if (number < 0) /* from the fourth on the colour's name */
      break;
    r.count = add_number(w, number) == 0 ? r.count + 1 : -1;
  }
  if (r.count < 0)
    return -1;
  if (r.count >= 3)
    return add_row(w, COLOR_TABLE, r);
  shade_wif_mend(w, COLOR_NONE, w->line,
                 "colour %d is '%s', not three numbers, red, green and blue: left out", r.key,
                 shade_wif_show(value).text);
  return 0;
}

static int read_row(wif *w, section where, span key, span value) {
  row r = {.line = w->line, .first = (int)w->pool_count};
  r.key = shade_wif_whole(key);
  const int most = where == COLOR_TABLE ? MAX_COLORS : SHADE_DRAFT_MAX_SIDE;
  if ((r.key < 0 || r.key > most) && where == COLOR_TABLE)
    return leave_color(w, key);
  if (r.key < 0 || r.key > most)
    return shade_wif_fail(w, w->line, "'%s' in [%s]: expected a number of 1 to %d before the =",
                          shade_wif_show(key).text, shade_wif_section_names[where], most);
  if (where == COLOR_TABLE)
    return read_color_row(w, r, value);
  value = shade_wif_value(value);
  if (where < WHOLE_ROWS) {
    r.count = read_list(w, where, value);
    return r.count < 0 ? -1 : add_row(w, where, r);
  }
  if (value.at == value.end)
    return 0;
  if (shade_wif_length(w, value, &r.length) != 0)
    return shade_wif_fail(w, w->line, "'%s' in [%s]: expected a length of 0 to 1e6",
                          shade_wif_show(value).text, shade_wif_section_names[where]);
  return add_row(w, where, r);
}

static int read_count(const wif *w, span key, span value, int most, int *count) {
  *count = shade_wif_whole(value);
  if (*count < 0 || *count > most)
    return shade_wif_fail(w, w->line, "%s=%s: expected a whole number of 0 to %d",
                          shade_wif_show(key).text, shade_wif_show(value).text, most);
  return 0;
}

static int read_direction(wif *w, direction *d, span key, span value) {
  if (shade_wif_is_word(key, "THREADS")) {
    d->threads_line = w->line;
    return read_count(w, key, value, SHADE_DRAFT_MAX_SIDE, &d->threads);
  }
  if (shade_wif_is_word(key, "COLOR")) {
    d->color_line = w->line;
    if (read_count(w, key, shade_wif_item(&value), MAX_NUMBER, &d->color) != 0)
      return -1;
    /* version 1.0 added the colour itself: number,r,g,b */
    for (int c = 0; c < 3; c++)
      d->rgb[c] = shade_wif_whole(shade_wif_item(&value));
    if (d->rgb[1] < 0 || d->rgb[2] < 0)
      d->rgb[0] = -1;
    return 0;
  }
  if (shade_wif_is_word(key, "UNITS")) {
    /* what cannot be understood may not be needed: that shows when all is read */
    d->units_line = w->line;
    d->unit = shade_wif_unit(value);
    memcpy(d->units, shade_wif_show(value).text, sizeof d->units);
    return 0;
  }
  length *to = shade_wif_is_word(key, "SPACING")     ? &d->spacing
               : shade_wif_is_word(key, "THICKNESS") ? &d->thickness
                                                     : NULL;
  if (to && shade_wif_length(w, value, to) != 0)
    return shade_wif_fail(w, w->line, "%s=%s: expected a length of 0 to 1e6",
                          shade_wif_show(key).text, shade_wif_show(value).text);
  return 0;
}

/* "0,255"; a number alone is the highest. */
static int read_range(wif *w, span value) {
  span rest = value;
  const span first = shade_wif_item(&rest), second = shade_wif_item(&rest),
             third = shade_wif_item(&rest);
  const int alone = second.at == second.end;
  const int low = alone ? 0 : shade_wif_whole(first),
            high = shade_wif_whole(alone ? first : second);
  if (low < 0 || high <= low || third.at < third.end)
    return shade_wif_fail(w, w->line, "Range=%s: expected two whole numbers, the lower first",
                          shade_wif_show(value).text);
  w->range[0] = low;
  w->range[1] = high;
  w->has_range = 1;
  return 0;
}

static int read_weaving(wif *w, span key, span value) {
  if (shade_wif_is_word(key, "SHAFTS"))
    return read_count(w, key, value, SHADE_DRAFT_MAX_SIDE, &w->shafts);
  if (shade_wif_is_word(key, "TREADLES"))
    return read_count(w, key, value, SHADE_DRAFT_MAX_SIDE, &w->treadles);
  if (!shade_wif_is_word(key, "RISING SHED"))
    return 0;
  const int rising = shade_wif_is_yes(value);
  if (rising < 0)
    return shade_wif_fail(w, w->line, "Rising Shed=%s: expected yes or no",
                          shade_wif_show(value).text);
  w->sinking = !rising;
  return 0;
}

static int read_palette(wif *w, span key, span value) {
  if (shade_wif_is_word(key, "FORM")) {
    w->form = shade_wif_is_word(value, "RGB")    ? FORM_RGB
              : shade_wif_is_word(value, "CMYK") ? FORM_CMYK
                                                 : FORM_OTHER;
    if (w->form == FORM_OTHER)
      shade_wif_mend(w, FORM_UNKNOWN, w->line, "Form=%s, neither RGB nor CMYK: colours left out",
                     shade_wif_show(value).text);
  }
  if (shade_wif_is_word(key, "ENTRIES")) {
    w->entries = shade_wif_whole(value);
    w->entries_line = w->line;
  }
  return shade_wif_is_word(key, "RANGE") ? read_range(w, value) : 0;
}

static section find_section(span name) {
  int s = 0;
  while (s < SECTIONS && !shade_wif_is_word(name, shade_wif_section_names[s]))
    s++;
  return (section)s;
}

static void read_contents(wif *w, span key, span value) {
  const section s = find_section(key);
  const int yes = shade_wif_is_yes(value);
  if (s == SECTIONS || yes < 0)
    return;
  w->announced[s] = yes ? w->line : 0;
  w->denied[s] = yes ? 0 : w->line;
}

static int read_line(wif *w, section where, span s) {
  const char *equals = memchr(s.at, '=', (size_t)(s.end - s.at));
  if (where == CONTENTS) {
    if (equals)
      read_contents(w, shade_wif_trim(s.at, equals),
                    shade_wif_value(shade_wif_trim(equals + 1, s.end)));
    return 0;
  }
  if (!equals) {
    /* a row's number alone */
    const span alone = shade_wif_value(s);
    if (where == COLOR_TABLE && shade_wif_whole(alone) < 0)
      return leave_color(w, s);
    if (where >= ROWS || shade_wif_whole(alone) < 0)
      return shade_wif_fail(w, w->line, "'%s' in [%s]: expected key=value", shade_wif_show(s).text,
                            shade_wif_section_names[where]);
    shade_wif_mend(w, NO_EQUALS, w->line, "'%s' in [%s] without =: an empty row",
                   shade_wif_show(alone).text, shade_wif_section_names[where]);
    if (where == COLOR_TABLE)
      return 0;
    return read_row(w, where, alone, (span){alone.end, alone.end});
  }
  const span key = shade_wif_trim(s.at, equals), whole = shade_wif_trim(equals + 1, s.end);
  if (where < ROWS)
    return read_row(w, where, key, whole);
  const span value = shade_wif_value(whole);
  if (value.at == value.end)
    return 0; /* left empty: the default */
  switch (where) {
  case WARP:
  case WEFT:
    return read_direction(w, &w->way[where == WEFT], key, value);
  case WEAVING:
    return read_weaving(w, key, value);
  default:
    return read_palette(w, key, value);
  }
}

/* The section that begins here; in *where, which stays as it is in free text. */
static int read_name(wif *w, span s, section *where) {
  const char *close = memchr(s.at, ']', (size_t)(s.end - s.at));
  const section found = find_section(shade_wif_trim(s.at + 1, close ? close : s.end));
  if (!close) {
    if (*where == OTHER && found == OTHER)
      return 0;
    return shade_wif_fail(w, w->line, "'%s': expected ] after the section's name",
                          shade_wif_show(s).text);
  }
  *where = found;
  if (found == OTHER)
    return 0;
  if (w->seen[found])
    shade_wif_mend(w, SECTION_TWICE, w->line, "[%s] once more: read as one",
                   shade_wif_section_names[found]);
  else
    w->seen[found] = w->line;
  return 0;
}

static int read_text(wif *w, const char *text, size_t length) {
  section where = OTHER;
  const char *const end = text + length;
  while (text < end) {
    const char *stop = text;
    while (stop < end && *stop != '\n' && *stop != '\r')
      stop++;
    w->line++;
    span s = shade_wif_trim(text, stop);
    text = stop < end && *stop == '\r' && stop + 1 < end && stop[1] == '\n' ? stop + 2 : stop + 1;
    if (s.at == s.end || *s.at == ';' || *s.at == '#')
      continue;
    if (*s.at == 0x1a) /* where DOS ends a text */
      break;
    if (*s.at == '[') {
      if (read_name(w, s, &where) != 0)
        return -1;
    } else if (where != OTHER && read_line(w, where, s) != 0)
      return -1;
  }
  return 0;
}

shade_draft *shade_wif_parse(const char *text, size_t length, const char *name, char *message,
                             size_t message_size) {
  wif w = {.name = name, .message = message, .message_size = message_size, .range = {0, 255}};
  for (int weft = 0; weft < 2; weft++)
    w.way[weft] = (direction){.rgb = {-1, -1, -1}, .unit = 1};
  char number[8];
  snprintf(number, sizeof number, "%.1f", .5);
  w.point = number[1];
  if (length > MAX_FILE) {
    shade_wif_fail(&w, 0, "too large: expected at most %d bytes", MAX_FILE);
    return NULL;
  }
  char *made;
  if (shade_wif_as_bytes(&text, &length, &made) != 0) {
    shade_wif_fail(&w, 0, "out of memory");
    return NULL;
  }
  shade_draft *d = read_text(&w, text, length) == 0 ? shade_wif_draft(&w) : NULL;
  if (d)
    shade_wif_say_mended(&w);
  for (int i = 0; i < ROWS; i++)
    free(w.rows[i].data);
  free(w.pool);
  free(made);
  return d;
}

shade_draft *shade_wif_read(const char *path, char *message, size_t message_size) {
  FILE *file = shade_port_open(path, "rb");
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
    snprintf(message, message_size, "%s: %s", path, errno ? strerror(errno) : "cannot be read");
  if (file)
    fclose(file);
  shade_draft *d = wrong ? NULL : shade_wif_parse(text, length, path, message, message_size);
  free(text);
  return d;
}
