/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The hits of a batch, one material after the other: lanes to shade, without the misses. */
#ifndef LIBSHADE_QUEUE_H
#define LIBSHADE_QUEUE_H

#include <stdbool.h>
#include <stddef.h>

#include "batch/lanes.h"
#include "scene/scene.h"

typedef struct segment {
  const material *material;
  lane_run run;
} segment;

typedef struct queue {
  size_t hits, segments;
  const uint32_t *lane; /* by hit: its sample */
  lane_u identity, moved;
  segment segment[BATCH];
  uint32_t *tally; /* per material */
} queue;

/* False when out of memory. */
bool queue_init(queue *q, const scene *s);
void queue_free(queue *q);

/*
 * The q->hits hits among `count` records. True where all samples hit one material and so can stay
 * where they are; else hit i is that of sample q->lane[i]. `key`: NULL, or a number in [0, 1) for
 * each sample, by which those of a material are put in order, in QUEUE_STEPS steps.
 */
enum { QUEUE_STEPS = 64 };
bool queue_sort(queue *q, const scene *s, size_t count, const uint32_t *record, const float *key);

#endif
