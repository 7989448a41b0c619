/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a thread's time goes: each stage is timed from the end of the one before. */
#ifndef LIBSHADE_CLOCK_H
#define LIBSHADE_CLOCK_H

#include "closure/table.h"
#include "light/table.h"
#include "node/table.h"
#include "system/parallel.h"

typedef enum clock_number {
  CLOCK_CAMERA,
  CLOCK_HIT,
  CLOCK_SURFACE,
  CLOCK_NODE,                            /* + node_type */
  CLOCK_LIGHT = CLOCK_NODE + NODE_TYPES, /* + light_type */
  CLOCK_SKY = CLOCK_LIGHT + LIGHT_TYPES,
  CLOCK_EMITTERS,
  CLOCK_CHOICE, /* of a light a lane */
  CLOCK_SHADOW,
  CLOCK_CLOSURE, /* + closure_type */
  CLOCK_REFLECT = CLOCK_CLOSURE + CLOSURE_TYPES,
  CLOCK_DRAW,
  CLOCK_TRACE,
  CLOCK_FILM,
  CLOCKS
} clock_number;

/* Their names, by number. */
#define CLOCK_OF_NODE(TYPE, name) "node_" #name,
#define CLOCK_OF_LIGHT(TYPE, name) "light_" #name,
#define CLOCK_OF_CLOSURE(TYPE, name, always) "closure_" #name,
#define CLOCK_WORDS                                                                                \
  "camera", "hit", "surface", NODE_TABLE(CLOCK_OF_NODE) LIGHT_TABLE(CLOCK_OF_LIGHT) "sky",         \
      "emitters", "choice", "shadow", CLOSURE_TABLE(CLOCK_OF_CLOSURE) "reflect", "draw", "trace",  \
      "film"

typedef struct clocks {
  double last, seconds[CLOCKS];
} clocks;

static inline void clock_start(clocks *c) {
  c->last = parallel_clock();
}

/* What has passed was `number`'s. */
static inline void clock_tick(clocks *c, clock_number number) {
  double now = parallel_clock();
  c->seconds[number] += now - c->last;
  c->last = now;
}

#endif
