/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lists of closures of a batch's hits: each hit draws with one of its material's, what it
 * reflects and how likely it was drawn are of all. */
#ifndef LIBSHADE_CLOSURES_H
#define LIBSHADE_CLOSURES_H

#include "render/worker.h"

/* Once the nodes have run: what shines goes to the sum, and how likely each closure is to draw.
 * Says whether anything may shine. */
bool closures_weigh(worker *w, bool first);
/* At what matt surfaces aim some of their draws, where w->aims says that they do. */
void closures_aim(worker *w);
/* f and cosine for the light's direction; with `density` how likely a draw goes there. */
void closures_eval(worker *w, bool density);
/* Light that is hidden from rays that a closure draws is so from the closure: of a run, in `out`.
 */
void closures_exclude(const worker *w, const closure *c, lane_run run, reflections *out);
/* Where the paths go on. */
void closures_draw(worker *w);

/* Which of them go through glass that is clear to the film. */
void closures_clear(worker *w);

/* What holds rays of the camera leaves a hole in the picture. */
void closures_hold(worker *w, const camera_view *view);

#endif
