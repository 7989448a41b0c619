/* SPDX-License-Identifier: Apache-2.0 */
/* Writing JSON into a buffer of the caller's. */
#ifndef SHADE_JSON_WRITER_H
#define SHADE_JSON_WRITER_H

#include <stddef.h>
#include <stdio.h>

#include "json_text.h"

/* Appends as snprintf does, counting what did not fit. */
typedef struct json_text {
  char *buffer;
  size_t capacity, length;
} json_text;

static inline void json_put(json_text *t, const char *s) {
  for (; *s; s++, t->length++)
    if (t->length + 1 < t->capacity)
      t->buffer[t->length] = *s;
}

static inline void json_put_number(json_text *t, const char *before, double value) {
  char number[64];
  snprintf(number, sizeof number, "%.17g", value);
  for (char *c = number; *c; c++) /* a comma locale must not break the JSON */
    if (*c == ',')
      *c = '.';
  json_put(t, before);
  json_put(t, number);
}

static inline void json_put_string(json_text *t, const char *s) {
  char letter[JSON_LETTER];
  json_put(t, "\"");
  for (; *s; s++) {
    json_letter(*s, letter);
    json_put(t, letter);
  }
  json_put(t, "\"");
}

/* Ends the text; the length that was needed. */
static inline int json_end(json_text *t) {
  if (t->capacity)
    t->buffer[t->length < t->capacity ? t->length : t->capacity - 1] = 0;
  return (int)t->length;
}

#endif
