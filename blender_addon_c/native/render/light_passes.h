/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Light by the way that it took to the eye, as Cycles sorts it.
 *
 * What the camera sees shine is emission, and what it sees behind all is environment, both through
 * transparent surfaces too. All other light belongs to the first surface that is not passed. It
 * goes to the kinds matt, shining and through, by the shares that the closures of each kind have in
 * what the surface sends to the eye. It is direct where it comes from lights, whether a sample of
 * theirs or a drawn ray found them. It is indirect where there are more surfaces on its way.
 *
 * There are planes of the colours of these surfaces as well, and of the mist before all that the
 * camera sees: 1 less what it leaves. Mattes go with it.
 *
 * What is here follows a batch from outside. Where no such plane is wanted, nothing is called.
 */
#ifndef LIBSHADE_LIGHT_PASSES_H
#define LIBSHADE_LIGHT_PASSES_H

#include "render/worker.h"

/* Makes w->light where planes of light or mattes are wanted. False when out of memory. */
bool light_passes_init(worker *w);

/* In the order of a batch: the camera's rays are traced and have their path states; */
void light_passes_begin(worker *w, const camera_view *view, size_t count);
/* hits know what they shine themselves; */
void light_passes_shone(worker *w);
/* what a light makes of the closures is in batch->reflection; */
void light_passes_reflected(worker *w);
/* the light of the hits goes to their samples, no brighter than `most` as in the stage `gain`; */
void light_passes_gain(worker *w, const float most[2]);
/* new directions are drawn; */
void light_passes_drawn(worker *w);
/* rays that meet nothing, and passed through surfaces only, end at the sky behind all; */
void light_passes_environment(worker *w, const path_states *state, size_t rays);
/* rays have met lights; */
void light_passes_hit(worker *w, size_t rays, const float most[2]);
/* and all is added to the tile's numbers. */
void light_passes_film(worker *w, size_t count);

#endif
