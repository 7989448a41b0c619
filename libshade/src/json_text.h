/* SPDX-License-Identifier: Apache-2.0 */
/* How a C string becomes the inside of a JSON string (RFC 8259): the one place that knows. */
#ifndef SHADE_JSON_TEXT_H
#define SHADE_JSON_TEXT_H

#include <stdio.h>

/* The JSON of one byte of UTF-8 text with its closing 0, which is as long as the result. */
enum { JSON_LETTER = 8 };
static inline int json_letter(char c, char out[JSON_LETTER]) {
  const char *const form = (unsigned char)c < 0x20 ? "\\u%04x"
                           : c == '"' || c == '\\' ? "\\%c"
                                                   : "%c";
  return snprintf(out, JSON_LETTER, form, (unsigned char)c);
}

#endif
