/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sample positions: the first four dimensions of Sobol's sequence, shifted digitally
 * by a hash of pixel, dimension and seed; later bounces shuffle and scramble the first two
 * (stage/path.h). A pixel's samples depend on nothing
 * else: not on threads, tiles or the border. [Sobol1967] [JoeKuo2008]
 */
#ifndef LIBSHADE_SAMPLING_H
#define LIBSHADE_SAMPLING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/scene.h"

enum { SAMPLING_DIMENSIONS = 4 };

/* The samples that a pixel gets in one pass over the picture. */
typedef struct sampling {
  size_t period;                        /* how many */
  size_t whole;                         /* how many they are in the plan of all samples */
  uint32_t *point[SAMPLING_DIMENSIONS]; /* repeated, so that any run of a batch is contiguous */
  /* what the passes share */
  const uint32_t *reverse; /* by number: dimension 1, bits reversed, of mask + 1 points */
  uint32_t mask;           /* the next power of two of all samples, less 1 */
  uint32_t scramble;       /* and-ed with each hash: 0 for a dump */
  const float *warp; /* FILTER_STEPS + 1 offsets from the pixel's centre, or NULL for the box */
} sampling;

/*
 * All samples of a pixel, in passes: after 4 and 16 samples there is a picture to look at, then
 * after every 64. The passes depend on the number of samples alone, and so do the bytes of sums.
 */
typedef struct sampling_plan {
  size_t samples; /* of the picture, of which this may be a share: */
  size_t first;   /* from this one on */
  size_t passes;
  sampling *pass;
  uint32_t *reverse;
  float *warp;
} sampling_plan;

/*
 * `samples` points a pixel, of them those from share[0] to below share[1] (NULL: all), for runs of
 * at most `run` lanes. width 0: box of one pixel, else the filter's full width in pixels. False
 * when out of memory.
 */
bool sampling_init(sampling_plan *s, size_t samples, const size_t share[2], size_t run,
                   filter_type filter, float width);
/* Whether a pass begins or ends there. */
bool sampling_is_cut(size_t samples, size_t at);

/* One sample in the middle of everything, unscrambled. */
bool sampling_init_center(sampling_plan *s, size_t run);

void sampling_free(sampling_plan *s);

#endif
