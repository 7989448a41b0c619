/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cameras that see around them, as Cycles has them. Where there is none nothing is called. */
#ifndef LIBSHADE_PANORAMA_H
#define LIBSHADE_PANORAMA_H

#include "render/worker.h"

/* Rays of the samples, through the lens; points NULL: its middle. What is outside of a round
 * picture gets no ray. */
void panorama_rays(worker *w, const camera_view *view, const shuffle *points, size_t count);
/* After `cover`: the picture is black there. */
void panorama_cover(worker *w, size_t count);
/* What the rays stand for: parts of the ball. */
void panorama_cones(worker *w, const camera_view *view, size_t count);

#endif
