/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What gathers the light of lamps, mirrors and glass: balls about it. A matt surface finds such
 * light by rays that it draws alone; of those too few go where it is small (stage/aim.h). An image
 * around everything is spread so wide that this costs more than it brings: there are none then.
 */
#ifndef LIBSHADE_AIMS_H
#define LIBSHADE_AIMS_H

#include <stdbool.h>
#include <stddef.h>

#include "scene/geometry.h"

enum { AIMS = 4 };

typedef struct aim {
  float center[3], radius;
} aim;

/* The largest ones. */
typedef struct aims {
  size_t count;
  aim ball[AIMS];
} aims;

/* Of the triangles whose materials `focus`. False when out of memory. */
bool aims_build(const geometry *s, aims *a);

#endif
