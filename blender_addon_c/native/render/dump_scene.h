/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The dump of what the stages computed (docs/theory/conventions.md), through libshade's writer. */
#ifndef LIBSHADE_DUMP_SCENE_H
#define LIBSHADE_DUMP_SCENE_H

#include "render/worker.h"
#include "system/message.h"

#include "dump/dump.h"

/* Empty planes and the header of a scene. NULL when out of memory. */
shade_dump *dump_scene_create(const scene *s, message_log *log);

/*
 * Who writes the hits of a batch, one sample a pixel, and what each light gave them, into the
 * planes: from its arrays as they are. Any number of threads, each with its own pixels.
 */
observer dump_scene_observer(shade_dump *d);

/* Write it whole or not at all. False, with the reason in the log, on failure. */
bool dump_scene_write(const shade_dump *d, const char *path, message_log *log);

#endif
