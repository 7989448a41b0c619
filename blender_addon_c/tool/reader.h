/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scene/reader.h of a header's JSON. */
#ifndef LIBSHADE_TOOL_READER_H
#define LIBSHADE_TOOL_READER_H

#include "scene/reader.h"
#include "tool/json.h"
#include "scene_file.h"

/* What a header says of one of its arrays, and of NumPy's types that they may have. */
typedef struct scene_array {
  const struct scene_array_type *type;
  size_t items;
  const void *data;
} scene_array;
typedef struct scene_array_type {
  const char *word;
  char format; /* as Python's struct module has it */
  size_t size;
} scene_array_type;

struct reader {
  const json *dict;
  scene_file *file;
  char path[160]; /* where it is, for messages: pictures[0].scene.meshes[2] */
};

/* Product of the sizes of an array; false where they are none, or more than `most`. */
bool reader_shape(reader *r, const char *key, size_t most, size_t *out);

#endif
