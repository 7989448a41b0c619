/* SPDX-License-Identifier: Apache-2.0 */
/* Weaving Information Files: words, numbers, encodings. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "wif.h"

const char *const wif_section_names[SECTIONS] = {
    "THREADING",      "TIEUP",       "TREADLING",    "LIFTPLAN",     "WARP COLORS",
    "WEFT COLORS",    "COLOR TABLE", "WARP SPACING", "WEFT SPACING", "WARP THICKNESS",
    "WEFT THICKNESS", "WEAVING",     "WARP",         "WEFT",         "COLOR PALETTE"};

int wif_fail(const wif *p, long line, const char *format, ...) {
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

static int is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0';
}

span wif_trim(const char *at, const char *end) {
  while (at < end && is_blank(*at))
    at++;
  while (end > at && is_blank(end[-1]))
    end--;
  return (span){at, end};
}

static int capital(char c) {
  return c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c;
}

int wif_is_word(span s, const char *word) {
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

span wif_without_comment(span s) {
  const char *semicolon = memchr(s.at, ';', (size_t)(s.end - s.at));
  return semicolon ? wif_trim(s.at, semicolon) : s;
}

shown wif_show(span s) {
  shown t;
  size_t n = 0;
  for (; s.at < s.end && n < 40; s.at++)
    t.text[n++] = *s.at >= ' ' && *s.at <= '~' ? *s.at : '?';
  if (s.at < s.end)
    n += (size_t)snprintf(t.text + n, 4, "...");
  t.text[n] = 0;
  return t;
}

int wif_whole(span s) {
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

int wif_real(const wif *p, span s, double *value) {
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

int wif_as_bytes(const char **text, size_t *length, char **made) {
  *made = NULL;
  if (starts_with(*text, *length, "\xff\xfe", 2) || starts_with(*text, *length, "\xfe\xff", 2)) {
    *text = *made = narrow(*text, *length, length);
    return *made ? 0 : -1;
  }
  if (starts_with(*text, *length, "\xef\xbb\xbf", 3)) {
    *text += 3;
    *length -= 3;
  }
  return 0;
}
