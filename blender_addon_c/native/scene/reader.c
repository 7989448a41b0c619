/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/reader.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool reader_may_flag(reader *r, const char *key, bool *out) {
  return !reader_has(r, key) || reader_flag(r, key, out);
}

bool reader_number_within(reader *r, const char *key, double low, double high, float *out) {
  double value;
  if (!reader_number(r, key, &value))
    return false;
  if (value < low || value > high) {
    char text[80];
    snprintf(text, sizeof text, "from %g to %g", low, high);
    return reader_expected(r, key, text);
  }
  *out = (float)value;
  return true;
}

bool reader_floats(reader *r, const char *key, int count, float *out) {
  double value[16];
  if (!reader_numbers(r, key, count, value))
    return false;
  for (int i = 0; i < count; i++)
    out[i] = (float)value[i];
  return true;
}

bool reader_word(reader *r, const char *key, const char *const *words, int *out) {
  char *value, list[96] = "";
  if (!reader_text(r, key, NULL, &value))
    return false;
  for (*out = 0; words[*out] && strcmp(words[*out], value) != 0; ++*out)
    snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", *out ? ", " : "",
             words[*out]);
  free(value);
  return words[*out] || reader_fail(r, "%s must be one of %s", key, list);
}

static bool read_key(reader *r, const reader_key *k, void *out) {
  void *to = (char *)out + k->at;
  switch (k->type) {
  case KEY_FLAG:
    return reader_flag(r, k->name, to);
  case KEY_INTEGER:
    return reader_integer(r, k->name, (long)k->low, (long)k->high, to);
  case KEY_NUMBER:
    return reader_number_within(r, k->name, k->low, k->high, to);
  case KEY_FLOATS:
    return reader_floats(r, k->name, k->count, to);
  case KEY_WORD:
    return reader_word(r, k->name, k->words, to);
  }
  return false;
}

bool reader_keys(reader *r, const reader_key *keys, void *out) {
  bool good = true;
  for (; good && keys->name; keys++)
    good = read_key(r, keys, out);
  return good;
}

bool reader_options(reader *r, const reader_key *keys, void *out) {
  bool good = true;
  for (; good && keys->name; keys++)
    good = !reader_has(r, keys->name) || read_key(r, keys, out);
  return good;
}

bool reader_rgb_of_xyz(reader *r, const char *key, double out[9]) {
  static const double rec709[9] = {3.2404542, -1.5371385, -0.4985314, -0.9692660, 1.8760108,
                                   0.0415560, 0.0556434,  -0.2040259, 1.0572252};
  memcpy(out, rec709, sizeof rec709);
  return !reader_has(r, key) || reader_numbers(r, key, 9, out);
}
