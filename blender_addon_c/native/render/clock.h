/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where a thread's time goes: each stage is timed from the end of the one before. */
#ifndef LIBSHADE_CLOCK_H
#define LIBSHADE_CLOCK_H

#include "system/parallel.h"

/* ROW(CLOCK, word) */
#define CLOCK_TABLE(ROW)                                                                           \
  ROW(CAMERA, camera)                                                                              \
  ROW(HIT, hit)                                                                                    \
  ROW(SURFACE, surface)                                                                            \
  ROW(BUMP, bump)                                                                                  \
  ROW(LIGHT, light)                                                                                \
  ROW(SHADOW, shadow)                                                                              \
  ROW(SHADE, shade)                                                                                \
  ROW(FILM, film)

#define CLOCK_ENUM(CLOCK, word) CLOCK_##CLOCK,
typedef enum clock_number { CLOCK_TABLE(CLOCK_ENUM) CLOCKS } clock_number;

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
