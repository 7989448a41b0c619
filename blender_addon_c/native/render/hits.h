/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a batch's rays to the surfaces that they meet, and what the nodes there say. */
#ifndef LIBSHADE_HITS_H
#define LIBSHADE_HITS_H

#include "render/worker.h"

/* Its batch alone. False when out of memory. */
bool batch_init(worker *w);
void batch_free(worker *w);

/* What rays meet. kind: of all; 0: of each its path state's. */
void hits_trace(worker *w, ray_kind kind, size_t count);
/* Samples to hits: sorted by material, unless nothing need move, and by `key`, as queue_sort has
 * it. */
void hits_sort(worker *w, size_t count, const float *key);
/* Do shadow rays start above facets? A dump is compared with others, that do not know of it. */
bool hits_lifted(const worker *w);
void hits_surface(worker *w);
/* What each material's nodes say. */
void hits_nodes(worker *w);

#endif
