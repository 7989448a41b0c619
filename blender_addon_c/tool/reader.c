/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reader.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool reader_fail(reader *r, const char *format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  snprintf(r->file->error, sizeof r->file->error, "%.150s%s%.160s", r->path, *r->path ? ": " : "",
           text);
  return false;
}

bool reader_expected(reader *r, const char *key, const char *what) {
  return reader_fail(r, "%s must be %s", key, what);
}

bool reader_out_of_memory(reader *r) {
  return reader_fail(r, "out of memory");
}

static bool require(reader *r, const char *key, const json **out) {
  *out = json_member(r->dict, key);
  return *out || reader_fail(r, "%s is missing", key);
}

bool reader_has(reader *r, const char *key) {
  const json *value = json_member(r->dict, key);
  return value && value->type != JSON_NULL;
}

static bool as_number(const json *value, double *out) {
  *out = value->type == JSON_TRUE ? 1.0 : value->type == JSON_FALSE ? 0.0 : value->number;
  return value->type == JSON_NUMBER || value->type == JSON_TRUE || value->type == JSON_FALSE;
}

bool reader_number(reader *r, const char *key, double *out) {
  const json *value;
  return require(r, key, &value) &&
         (as_number(value, out) || reader_expected(r, key, "a finite number"));
}

bool reader_integer(reader *r, const char *key, long low, long high, int *out) {
  const json *value;
  double number;
  if (!require(r, key, &value))
    return false;
  if (!as_number(value, &number) || number != floor(number) || number < (double)low ||
      number > (double)high) {
    char text[80];
    snprintf(text, sizeof text, "an integer from %ld to %ld", low, high);
    return reader_expected(r, key, text);
  }
  *out = (int)number;
  return true;
}

bool reader_flag(reader *r, const char *key, bool *out) {
  double number;
  const json *value;
  if (!require(r, key, &value))
    return false;
  if (!as_number(value, &number))
    return reader_expected(r, key, "true or false");
  *out = number != 0.0;
  return true;
}

static bool is_list(const json *value, size_t count) {
  for (const json *item = value->child; item && count <= SIZE_MAX / 2; item = item->next)
    count--; /* past 0 where there are more */
  return value->type == JSON_ARRAY && count == 0;
}

bool reader_numbers(reader *r, const char *key, int count, double *out) {
  const json *value;
  if (!require(r, key, &value))
    return false;
  bool good = is_list(value, (size_t)count);
  for (const json *item = value->child; good && item; item = item->next)
    good = as_number(item, out++);
  char text[64];
  snprintf(text, sizeof text, "a list of %d finite numbers", count);
  return good || reader_expected(r, key, text);
}

static bool as_operand(const json *value, operand *out) {
  double number;
  *out = (operand){.at = OPERAND_NUMBER};
  if (value->type != JSON_ARRAY) {
    bool good = as_number(value, &number);
    out->number = good ? (float)number : 0.0f;
    return good && isfinite(out->number);
  }
  if (!is_list(value, 1) || !as_number(value->child, &number) || number != floor(number) ||
      number < 0 || number >= REGISTERS)
    return false;
  out->at = (int)number;
  return true;
}

bool reader_operands(reader *r, const char *key, int count, operand *out) {
  const json *value;
  if (!require(r, key, &value))
    return false;
  bool good = is_list(value, (size_t)count);
  for (const json *item = value->child; good && item; item = item->next)
    good = as_operand(item, out++);
  char text[96];
  snprintf(text, sizeof text, "%d operands: finite numbers, or registers [0] to [%d]", count,
           REGISTERS - 1);
  return good || reader_expected(r, key, text);
}

bool reader_text(reader *r, const char *key, const char *missing, char **out) {
  const json *value = json_member(r->dict, key);
  if (!value && !missing)
    return reader_fail(r, "%s is missing", key);
  if (value && value->type != JSON_STRING)
    return reader_expected(r, key, "a string");
  *out = strdup(value ? value->string : missing);
  return *out || reader_out_of_memory(r);
}

/* Hands a value to `one`; `more` is its place within r's. */
static bool inside(reader *r, const json *dict, const char *more, reader_one *one, void *out,
                   void *context) {
  reader inner = {.dict = dict, .file = r->file};
  snprintf(inner.path, sizeof inner.path, "%.90s%s%.60s", r->path, *r->path ? "." : "", more);
  return dict->type == JSON_OBJECT ? one(&inner, out, context)
                                   : reader_fail(&inner, "an object is expected");
}

bool reader_dict(reader *r, const char *key, reader_one *one, void *out, void *context) {
  const json *dict;
  return require(r, key, &dict) && inside(r, dict, key, one, out, context);
}

bool reader_each(reader *r, const char *key, size_t size, size_t *count, void *array_out,
                 reader_one *one, void *context) {
  const json *list;
  size_t length = 0;
  if (!require(r, key, &list))
    return false;
  if (list->type != JSON_ARRAY)
    return reader_expected(r, key, "a list");
  for (const json *item = list->child; item; item = item->next)
    length++;
  char *array = calloc(length + 1, size), place[64];
  if (!array)
    return reader_out_of_memory(r);
  memcpy(array_out, &array, sizeof array);
  *count = 0;
  for (const json *item = list->child; item; item = item->next) {
    snprintf(place, sizeof place, "%s[%zu]", key, *count);
    /* counted first: what `one` allocates before it fails is freed with the scene */
    if (!inside(r, item, place, one, array + size * (*count)++, context))
      return false;
  }
  return true;
}

bool reader_items(reader *r, const char *key, size_t count, const char *formats, size_t item_size,
                  reader_buffer *out) {
  const json *value;
  if (!require(r, key, &value))
    return false;
  const json *index = json_member(value, "array");
  double number;
  if (!index || !as_number(index, &number) || number != floor(number) || number < 0 ||
      number >= (double)r->file->arrays)
    return reader_expected(r, key, "{\"array\": k} of an array that there is");
  const scene_array *array = &r->file->array[(size_t)number];
  size_t size = array->type->size;
  if (!strchr(formats, array->type->format) || (item_size && size != item_size))
    return reader_fail(r, "%s has items of type %s; one of '%s' is expected", key,
                       array->type->word, formats);
  *out = (reader_buffer){.data = array->data, .size = array->items * size, .item_size = size};
  if (count != SIZE_MAX && array->items != count)
    return reader_fail(r, "%s has %zu items; %zu are expected", key, array->items, count);
  return true;
}

bool reader_shape(reader *r, const char *key, size_t most, size_t *out) {
  const json *value;
  if (!require(r, key, &value))
    return false;
  bool good = value->type == JSON_ARRAY;
  *out = 1;
  for (const json *side = value->child; good && side; side = side->next) {
    double number;
    good = as_number(side, &number) && number >= 0 && number == floor(number) &&
           (double)*out * number <= (double)most;
    *out *= good ? (size_t)number : 1;
  }
  return good || reader_expected(r, key, "whole numbers, of no more items than the file has");
}
