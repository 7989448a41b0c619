/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene from its description, whoever holds that: scene/reader.h. */
#ifndef LIBSHADE_READ_H
#define LIBSHADE_READ_H

#include "scene/reader.h"
#include "scene/scene.h"

/* A scene that scene_free frees; NULL where its description is wrong. Its buffers stay the
 * reader's. */
scene *scene_read(reader *r);

/* Another view of a scene that is built: its camera, size, region and samples. What was there stays
 * where the description is wrong. */
bool scene_look(reader *r, scene *s);

#endif
