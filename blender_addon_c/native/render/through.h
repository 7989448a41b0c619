/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shadow rays that transparent surfaces let through, coloured: closest hits and what the materials'
 * nodes say there. Only where plain occlusion has found something in the way. */
#ifndef LIBSHADE_THROUGH_H
#define LIBSHADE_THROUGH_H

#include "render/worker.h"

typedef struct through through;

/* NULL when out of memory. */
through *through_create(const worker *w);
void through_free(through *t); /* NULL is fine */

/* In place of accel_occluded for the batch's light samples. True where some light came through
 * surfaces: it has their colours then. color: of the light, NULL: each sample has its own. */
bool through_shadows(worker *w, const float *color);

#endif
