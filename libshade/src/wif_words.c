/* SPDX-License-Identifier: Apache-2.0 */
/* Weaving Information Files: messages, words, numbers, encodings. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "wif.h"

const char *const shade_wif_section_names[SECTIONS] = {
    "THREADING",    "TIEUP",          "TREADLING",      "LIFTPLAN",
    "WARP COLORS",  "WEFT COLORS",    "COLOR TABLE",    "WARP SPACING",
    "WEFT SPACING", "WARP THICKNESS", "WEFT THICKNESS", "WEAVING",
    "WARP",         "WEFT",           "COLOR PALETTE",  "CONTENTS"};

/* --- messages --------------------------------------------------------------------------- */

int shade_wif_fail(const wif *w, long line, const char *format, ...) {
  char text[256];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (line > 0)
    snprintf(w->message, w->message_size, "%s, line %ld: %s", w->name, line, text);
  else
    snprintf(w->message, w->message_size, "%s: %s", w->name, text);
  return -1;
}

void shade_wif_mend(wif *w, mending kind, long line, const char *format, ...) {
  mended *m = &w->mended[kind];
  /* rows are looked through section by section, not line by line */
  if (m->count++ && line >= m->line)
    return;
  m->line = line;
  va_list args;
  va_start(args, format);
  vsnprintf(m->text, sizeof m->text, format, args);
  va_end(args);
}

void shade_wif_say_mended(const wif *w) {
  size_t used = 0;
  if (w->message_size)
    *w->message = 0;
  for (long last = -1;;) {
    /* the kinds in the order of their lines */
    long line = 0;
    int any = 0;
    for (int k = 0; k < MENDINGS; k++)
      if (w->mended[k].count && w->mended[k].line > last && (!any || w->mended[k].line < line)) {
        line = w->mended[k].line;
        any = 1;
      }
    if (!any)
      return;
    for (int k = 0; k < MENDINGS; k++) {
      const mended *m = &w->mended[k];
      if (!m->count || m->line != line || used >= w->message_size)
        continue;
      char where[32] = "", more[32] = "";
      if (line)
        snprintf(where, sizeof where, "line %ld: ", line);
      if (m->count > 1)
        snprintf(more, sizeof more, " (and %d more)", m->count - 1);
      const int got = used ? snprintf(w->message + used, w->message_size - used, "; %s%s%s", where,
                                      m->text, more)
                           : snprintf(w->message, w->message_size, "%s: mended: %s%s%s", w->name,
                                      where, m->text, more);
      used += got > 0 ? (size_t)got : 0;
    }
    last = line;
  }
}

/* --- words ------------------------------------------------------------------------------ */

/* The non-breaking blanks of Latin-1 and, of two bytes, of UTF-8 are blanks too. */
static int is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0' || c == '\xa0' || c == '\xc2';
}

span shade_wif_trim(const char *at, const char *end) {
  while (at < end && is_blank(*at))
    at++;
  while (end > at && is_blank(end[-1]))
    end--;
  return (span){at, end};
}

static int capital(char c) {
  return c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c;
}

int shade_wif_is_word(span s, const char *word) {
  const char *at = word;
  for (; s.at < s.end; s.at++) {
    if (is_blank(*s.at) || *s.at == '-' || *s.at == '_')
      continue;
    while (*at == ' ')
      at++;
    const int c = capital(*s.at);
    if (c == 'U' && *at == 'R' && at - word >= 4 && !memcmp(at - 4, "COLO", 4))
      continue;
    if (c != *at || !*at)
      return 0;
    at++;
  }
  return !*at && at > word;
}

int shade_wif_is_yes(span s) {
  static const char *const words[2][6] = {{"NO", "FALSE", "OFF", "0", "N", "F"},
                                          {"YES", "TRUE", "ON", "1", "Y", "T"}};
  for (int yes = 0; yes < 2; yes++)
    for (int i = 0; i < 6; i++)
      if (shade_wif_is_word(s, words[yes][i]))
        return yes;
  return -1;
}

span shade_wif_value(span s) {
  for (const char *c = s.at; c < s.end; c++)
    if (*c == ';' || *c == '#') {
      s = shade_wif_trim(s.at, c);
      break;
    }
  if (s.end - s.at >= 2 && *s.at == '"' && s.end[-1] == '"')
    s = shade_wif_trim(s.at + 1, s.end - 1);
  return s;
}

shown shade_wif_show(span s) {
  shown t;
  size_t n = 0;
  for (; s.at < s.end && n < 40; s.at++)
    t.text[n++] = *s.at >= ' ' && *s.at <= '~' ? *s.at : '?';
  if (s.at < s.end)
    n += (size_t)snprintf(t.text + n, 4, "...");
  t.text[n] = 0;
  return t;
}

/* --- numbers ---------------------------------------------------------------------------- */

span shade_wif_item(span *s) {
  while (s->at < s->end && (*s->at == ',' || is_blank(*s->at)))
    s->at++;
  span item = {s->at, s->at};
  while (item.end < s->end && *item.end != ',' && !is_blank(*item.end))
    item.end++;
  s->at = item.end;
  return item;
}

int shade_wif_whole(span s) {
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

double shade_wif_unit(span s) {
  static const struct {
    const char *word;
    double cm;
  } units[] = {{"CENTIMETERS", 1},
               {"CENTIMETRES", 1},
               {"CENTIMETER", 1},
               {"CENTIMETRE", 1},
               {"CM", 1},
               {"INCHES", 2.54},
               {"INCH", 2.54},
               {"IN", 2.54},
               {"\"", 2.54},
               {"MILLIMETERS", .1},
               {"MILLIMETRES", .1},
               {"MM", .1},
               {"DECIPOINTS", 2.54 / 720},
               {"DECIPOINT", 2.54 / 720}};
  for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
    if (shade_wif_is_word(s, units[i].word))
      return units[i].cm;
  return 0;
}

int shade_wif_length(const wif *w, span s, length *to) {
  char text[64];
  size_t n = 0;
  /* no words such as "nan", no hexadecimal */
  for (; s.at < s.end && *s.at && strchr("0123456789+-.,eE", *s.at); s.at++) {
    if (n == sizeof text - 1)
      return -1;
    text[n++] = *s.at == '.' || *s.at == ',' ? w->point : *s.at;
  }
  text[n] = 0;
  char *end;
  to->value = strtod(text, &end);
  if (!n || *end || !(to->value >= 0 && to->value <= 1e6))
    return -1;
  s = shade_wif_trim(s.at, s.end);
  to->unit = shade_wif_unit(s);
  return s.at < s.end && to->unit <= 0 ? -1 : 0;
}

/* --- encodings -------------------------------------------------------------------------- */

/* UTF-16 to bytes, what is not ASCII as '?'. The format's own words and numbers are ASCII. */
static char *narrow(const char *text, size_t length, size_t big, size_t *narrowed) {
  char *to = malloc(length);
  *narrowed = 0;
  for (size_t i = 0; to && i + 1 < length; i += 2) {
    const unsigned char high = (unsigned char)text[i + !big], low = (unsigned char)text[i + big];
    to[(*narrowed)++] = high || low > 126 ? (low == 0xa0 && !high ? ' ' : '?') : (char)low;
  }
  return to;
}

int shade_wif_as_bytes(const char **text, size_t *length, char **made) {
  const char *at = *text;
  const size_t n = *length;
  *made = NULL;
  if (n >= 3 && !memcmp(at, "\xef\xbb\xbf", 3)) {
    *text += 3;
    *length -= 3;
  }
  if (n < 2)
    return 0;
  const int mark = !memcmp(at, "\xff\xfe", 2) || !memcmp(at, "\xfe\xff", 2);
  /* without a mark: the first two characters are ASCII, and so every other byte is 0 */
  const int big = mark ? at[1] == '\xff' : n >= 4 && !at[0] && at[1] && !at[2] && at[3];
  const int little = mark ? !big : n >= 4 && at[0] && !at[1] && at[2] && !at[3];
  if (!big && !little)
    return 0;
  *text = *made = narrow(at + 2 * mark, n - 2 * (size_t)mark, (size_t)big, length);
  return *made ? 0 : -1;
}
