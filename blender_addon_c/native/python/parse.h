/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Python's description of a scene to ours. All functions need the GIL. */
#ifndef LIBSHADE_PARSE_H
#define LIBSHADE_PARSE_H

#include "scene/scene.h"

/* Buffers of Python that a scene reads from. */
typedef struct parse_buffers {
  size_t count;
  void *view; /* array of Py_buffer */
} parse_buffers;

/*
 * `description` is the dict of start(). NULL with ValueError (or MemoryError) set when it is
 * malformed. The scene reads the buffers until parse_release.
 */
scene *parse_scene(void *description, parse_buffers *buffers);
void parse_release(parse_buffers *buffers);

#endif
