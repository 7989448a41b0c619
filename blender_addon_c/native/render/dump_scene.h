/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The dump of what the stages computed (CONVENTIONS.md), through libshade's writer. */
#ifndef LIBSHADE_DUMP_SCENE_H
#define LIBSHADE_DUMP_SCENE_H

#include "batch/batch.h"
#include "system/message.h"

#include "dump/dump.h"

/* Empty planes and the header of a scene. NULL when out of memory. */
shade_dump *dump_scene_create(const scene *s);

/*
 * One sample a pixel: the hits of a batch, from its arrays as they are, and what
 * one light gave them. Any number of threads, each with its own pixels.
 */
void dump_scene_hits(shade_dump *d, const batch *b, const camera_view *view);
void dump_scene_light(shade_dump *d, const batch *b, const camera_view *view, size_t number,
                      const float color[3]);

/* Write it whole or not at all. False, with the reason in the log, on failure. */
bool dump_scene_write(const shade_dump *d, const char *path, message_log *log);

#endif
