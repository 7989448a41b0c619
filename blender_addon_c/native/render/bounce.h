/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One batch of samples from the camera to the film: the order of the stages. */
#ifndef LIBSHADE_BOUNCE_H
#define LIBSHADE_BOUNCE_H

#include "render/worker.h"

/* False when out of memory. */
bool worker_init(worker *w);
void worker_free(worker *w);

/* Adds the samples view->first … + count of a tile to its pixels, 4 floats each. */
void bounce_batch(worker *w, camera_view *view, size_t count, float *pixels);

#endif
