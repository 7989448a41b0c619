/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene from Python's description of it. All functions need the GIL. */
#ifndef LIBSHADE_PYTHON_READER_H
#define LIBSHADE_PYTHON_READER_H

#include "scene/scene.h"

/* Buffers of Python that a scene reads from. */
typedef struct reader_buffers {
  size_t count;
  void *view; /* array of Py_buffer */
} reader_buffers;

/*
 * `description` is the dict of start(). NULL with ValueError (or MemoryError) set when it is
 * malformed. The scene reads the buffers until reader_release.
 */
scene *reader_scene(void *description, reader_buffers *buffers);
/* Another view of it: scene_look. */
bool reader_look(void *description, scene *s);
/* A field of scratches by itself. */
bool reader_scratches(void *description, scratches *out);
/* A cloth by itself, as one of a scene's; not built. Free it even after a failure. */
bool reader_cloth(void *description, cloth *out);
void reader_release(reader_buffers *buffers);

#endif
