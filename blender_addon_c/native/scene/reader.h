/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A scene's description, dictionary by dictionary. Where it is from, a dict of Python's
 * (python/reader.c) or a file (tool/reader.c), is not known here. Every function returns false
 * after a failure; the message says where.
 */
#ifndef LIBSHADE_READER_H
#define LIBSHADE_READER_H

#include <stdbool.h>
#include <stddef.h>

#include "batch/lanes.h"

typedef struct reader reader;

/* Why what is read cannot be right: always false, so that a caller can return it. */
__attribute__((format(printf, 2, 3))) bool reader_fail(reader *r, const char *format, ...);
bool reader_expected(reader *r, const char *key, const char *what);
bool reader_out_of_memory(reader *r);

bool reader_has(reader *r, const char *key);
bool reader_number(reader *r, const char *key, double *out);
bool reader_number_within(reader *r, const char *key, double low, double high, float *out);
bool reader_integer(reader *r, const char *key, long low, long high, int *out);
bool reader_flag(reader *r, const char *key, bool *out);
/* One that is missing leaves what is there. */
bool reader_may_flag(reader *r, const char *key, bool *out);
bool reader_numbers(reader *r, const char *key, int count, double *out); /* count <= 16 */
bool reader_floats(reader *r, const char *key, int count, float *out);
/* A copy that the caller frees; `missing` stands for a missing key, NULL: it is required. */
bool reader_text(reader *r, const char *key, const char *missing, char **out);
/* One of several words, NULL at their end, as its index. */
bool reader_word(reader *r, const char *key, const char *const *words, int *out);

/* Keys of a dictionary, and where in a struct their values go. */
typedef enum key_type { KEY_FLAG, KEY_INTEGER, KEY_NUMBER, KEY_FLOATS, KEY_WORD } key_type;
typedef struct reader_key {
  const char *name;
  key_type type;
  size_t at;        /* of a bool, an int, a float, some floats, or the int of a word */
  double low, high; /* of integers and numbers */
  int count;        /* of floats */
  const char *const *words;
} reader_key;
#define FLAG_KEY(word, of, member)                                                                 \
  { .name = word, .type = KEY_FLAG, .at = offsetof(of, member) }
#define INTEGER_KEY(word, of, member, from, to)                                                    \
  { .name = word, .type = KEY_INTEGER, .at = offsetof(of, member), .low = from, .high = to }
#define NUMBER_KEY(word, of, member, from, to)                                                     \
  { .name = word, .type = KEY_NUMBER, .at = offsetof(of, member), .low = from, .high = to }
#define FLOATS_KEY(word, of, member, number)                                                       \
  { .name = word, .type = KEY_FLOATS, .at = offsetof(of, member), .count = number }
#define WORD_KEY(word, of, member, list)                                                           \
  { .name = word, .type = KEY_WORD, .at = offsetof(of, member), .words = list }
/* All of a table that a key without a name ends; of `options` those that are there. */
bool reader_keys(reader *r, const reader_key *keys, void *out);
bool reader_options(reader *r, const reader_key *keys, void *out);

/* The matrix of X, Y and Z, by rows, to the red, green and blue of the scene's working space; of
 * linear Rec. 709 and D65 where it is missing. */
bool reader_rgb_of_xyz(reader *r, const char *key, double out[9]);

/* Operands of a graph: each a number, or a register as a sequence of its one index. */
bool reader_operands(reader *r, const char *key, int count, operand *out);

/* What `one` makes of a dictionary, or of each in a list: an array of items of this size, which
 * the caller frees and whose `count` also covers the item that failed. */
typedef bool reader_one(reader *r, void *out, void *context);
bool reader_dict(reader *r, const char *key, reader_one *one, void *out, void *context);
bool reader_each(reader *r, const char *key, size_t size, size_t *count, void *array_out,
                 reader_one *one, void *context);

/* A buffer of items in one of these formats of Python's struct module; read until the job ends. */
typedef struct reader_buffer {
  const void *data;
  size_t size, item_size; /* in bytes */
} reader_buffer;
enum { READER_ANY = 0 }; /* number of items, size of an item */
bool reader_items(reader *r, const char *key, size_t count, const char *formats, size_t item_size,
                  reader_buffer *out);

#endif
