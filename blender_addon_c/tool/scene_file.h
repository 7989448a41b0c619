/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A saved scene, .shscene, as saved.py of the add-on writes it. Little-endian:
 *
 *   "shscene\n", a uint32: how long the header is, a uint32: the CRC-32 of the header
 *   the header: JSON in UTF-8, spaces behind it until its end is a multiple of 64
 *   arrays: each begins at a multiple of 64, zeros behind it; the file ends with the last
 *
 * The header is {"version", "texts", "pictures", "arrays"}. `texts`, which may be missing, are what
 * the rendered file's header is to say: each a `name`, "cryptomatte/…", and a `text`. A picture has
 * a `scene`, which is what the native module's start() takes, where {"array": k} stands for what is
 * a buffer there; a `layer`; and `passes`, each with a `name`, `channels`, a letter each, the
 * `plane` that it shows (a word of the module's image()) and the `exposure` that its first three
 * are multiplied by. An array has a `type` (NumPy's word), a `shape`, an `offset` in the file
 * behind the header, and a `checksum`: the CRC-32 of its bytes and of the zeros behind them.
 */
#ifndef LIBSHADE_SCENE_FILE_H
#define LIBSHADE_SCENE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"

typedef struct scene_pass {
  char *name, *channels, *plane;
  float exposure;
} scene_pass;

/* One that is rendered by itself. */
typedef struct scene_picture {
  scene *scene; /* whoever takes it leaves NULL */
  char *layer;
  size_t passes;
  scene_pass *pass;
} scene_picture;

typedef struct scene_text {
  char *name, *text;
} scene_text;

typedef struct scene_file {
  uint32_t checksum; /* of the header, which has those of all arrays */
  size_t texts;
  scene_text *text;
  size_t pictures; /* all as large, of the same region; at least one */
  scene_picture *picture;
  struct scene_array *array; /* what the rest is for the reader alone */
  size_t arrays, array_bytes;
  const unsigned char *array_data;
  void *map;
  size_t map_size;
  char error[320];
} scene_file;

/* False where it is no such file, and why, with the key's name and what was expected, in `error`.
 * Scenes read its arrays until it is closed; close it after a failure, too. */
bool scene_file_open(scene_file *f, const char *path);
/* The same of bytes that stay where they are, at a multiple of 64. */
bool scene_file_read(scene_file *f, const void *data, size_t size);
void scene_file_close(scene_file *f);

#endif
