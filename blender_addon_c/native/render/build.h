/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene that is read made ready for rays. */
#ifndef LIBSHADE_BUILD_H
#define LIBSHADE_BUILD_H

#include <stdatomic.h>

#include "scene/scene.h"

/*
 * Make the textures, the triangles and the BVH. Returns false on failure, with
 * the reason in `log`, or when *cancel became true.
 */
bool scene_build(scene *s, const atomic_bool *cancel, message_log *log, scene_times *times);

/* What a scene that is read can use of one that is built and not needed any more, it takes over:
 * the world where the meshes are the same buffers, textures of the same images. */
void scene_take(scene *to, scene *from);

/* Free what scene_build and scene_read allocated (not the buffers of Python). NULL is fine. */
void scene_free(scene *s);

#endif
