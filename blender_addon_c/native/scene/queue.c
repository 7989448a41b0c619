/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/queue.h"

#include <stdlib.h>
#include <string.h>

bool queue_init(queue *q, const scene *s) {
  for (uint32_t i = 0; i < BATCH; i++)
    q->identity[i] = i;
  q->tally = malloc((s->materials + 1) * sizeof *q->tally);
  return q->tally != NULL;
}

void queue_free(queue *q) {
  free(q->tally);
}

/* Samples that hit something, by their keys. */
static void order_hits(size_t count, const uint32_t *record, const float *key, uint32_t *order) {
  uint32_t begin[QUEUE_STEPS] = {0}, step[BATCH], before = 0;
  for (size_t i = 0; i < count; i++) {
    step[i] = (uint32_t)(key[i] * QUEUE_STEPS);
    begin[step[i]] += record[i] != RECORD_MISS;
  }
  for (size_t k = 0; k < QUEUE_STEPS; k++) {
    const uint32_t number = begin[k];
    begin[k] = before;
    before += number;
  }
  for (size_t i = 0; i < count; i++)
    if (record[i] != RECORD_MISS)
      order[begin[step[i]]++] = (uint32_t)i;
}

bool queue_sort(queue *q, const scene *s, size_t count, const uint32_t *record, const float *key) {
  uint32_t material[BATCH]; /* a triangle is far away: once */
  memset(q->tally, 0, s->materials * sizeof *q->tally);
  if (s->materials == 1)
    q->tally[0] = (uint32_t)q->hits;
  else
    for (size_t i = 0; i < count; i++)
      if (record[i] != RECORD_MISS)
        q->tally[material[i] = s->triangle[record[i]].material]++;
  size_t begin = 0;
  q->segments = 0;
  for (size_t m = 0; begin < q->hits; m++) {
    size_t number = q->tally[m];
    q->tally[m] = (uint32_t)begin;
    if (number)
      q->segment[q->segments++] =
          (segment){.material = &s->material[m], .run = {.begin = begin, .end = begin + number}};
    begin += number;
  }
  bool in_place = q->segments == 1 && q->hits == count && !key;
  q->lane = in_place ? q->identity : q->moved;
  if (key) {
    uint32_t order[BATCH];
    order_hits(count, record, key, order);
    for (size_t k = 0; k < q->hits; k++)
      q->moved[q->tally[s->materials == 1 ? 0 : material[order[k]]]++] = order[k];
    return false;
  }
  for (size_t i = 0; !in_place && i < count; i++)
    if (record[i] != RECORD_MISS)
      q->moved[q->tally[s->materials == 1 ? 0 : material[i]]++] = (uint32_t)i;
  return in_place;
}
