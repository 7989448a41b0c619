/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far what is seen moves over the picture: from where it was a frame before to where it is, and
 * from there to where it will be, in pixels; x y x y, as Cycles has it, with its signs. */
#ifndef LIBSHADE_VECTOR_H
#define LIBSHADE_VECTOR_H

#include "render/state.h"
#include "scene/scene.h"

/* Of a hit, where the scene has `vectors`; else 0. */
void vector_of(const scene *s, const batch *b, size_t i, float out[4]);

#endif
