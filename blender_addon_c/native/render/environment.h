/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light from around everything: an image's, or where its nodes vary faster than an image's texels,
 * what these say of each direction. */
#ifndef LIBSHADE_ENVIRONMENT_H
#define LIBSHADE_ENVIRONMENT_H

#include "render/worker.h"

/* Room for these nodes, where the scene has any. False when out of memory. */
bool environment_init(worker *w);
void environment_free(worker *w);

/* Radiance from `count` unit directions, in the world. */
void environment_eval(worker *w, const sky *sky, size_t count, const lane_v *toward, lane_c *out);

#endif
