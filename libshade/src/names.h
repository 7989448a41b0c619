/* SPDX-License-Identifier: Apache-2.0 */
/* How names are compared: ASCII only, whatever the locale; '-' reads as '_', capitals as small. */
#ifndef SHADE_NAMES_H
#define SHADE_NAMES_H

#include <stddef.h>

static inline int same_letter(char a, char b) {
  if (a >= 'A' && a <= 'Z')
    a = (char)(a - 'A' + 'a');
  if (a == '-')
    a = '_';
  return a == b;
}

/* `own` is spelled as the table has it. */
static inline int same_word(const char *word, const char *own) {
  size_t k = 0;
  while (own[k] && same_letter(word[k], own[k]))
    k++;
  return !own[k] && !word[k];
}

#endif
