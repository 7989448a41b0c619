/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How steep the bumps of materials are whose horizon is `mutual`: their nodes are asked once, all
 * over their surfaces. */
#ifndef LIBSHADE_RELIEF_H
#define LIBSHADE_RELIEF_H

#include <stdatomic.h>

#include "scene/scene.h"

/*
 * Sets the mean slope and the second moment about it of every closure that wants them, of a scene
 * whose world is built. Where bumps are uneven its RELIEF node gets a map of moments in a window
 * about a point; one of a shape gets one always, with the means of wide windows, too. False when
 * out of memory.
 */
bool relief_find(scene *s, const atomic_bool *cancel);

/* Of a material's nodes. */
void relief_free(material *m);

/* What was found, or the scene told, of a material's first such closure. False if it has none. */
bool relief_told(const material *m, double slopes[5]);

#endif
