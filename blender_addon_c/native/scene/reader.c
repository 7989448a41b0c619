/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/reader.h"

bool reader_may_flag(reader *r, const char *key, bool *out) {
  return !reader_has(r, key) || reader_flag(r, key, out);
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
