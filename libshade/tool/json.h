/* SPDX-License-Identifier: Apache-2.0 */
/* A strict JSON reader (RFC 8259), for the headers of dumps. */
#ifndef SHADE_TOOL_JSON_H
#define SHADE_TOOL_JSON_H

#include <stddef.h>
#include <stdio.h>

typedef enum json_type {
  JSON_NULL,
  JSON_FALSE,
  JSON_TRUE,
  JSON_NUMBER,
  JSON_STRING,
  JSON_ARRAY,
  JSON_OBJECT
} json_type;

typedef struct json {
  json_type type;
  double number;      /* JSON_NUMBER: finite */
  char *string;       /* JSON_STRING: UTF-8 without zero bytes */
  char *key;          /* name of a member of an object, else NULL */
  struct json *child; /* first element or member of an array or object */
  struct json *next;  /* next one in the same array or object */
} json;

/*
 * The value that is the whole of `text`, or NULL and a message with line and
 * column. At most 32 levels deep. Free it with json_free (NULL is fine).
 */
json *json_read(const char *text, char *error, size_t error_size);
void json_free(json *value);

/* First member called `key` of an object; NULL if there is none or it is no object. */
const json *json_member(const json *object, const char *key);

/* Print as a JSON string, with its quotes. */
void json_print_string(FILE *to, const char *text);

#endif
