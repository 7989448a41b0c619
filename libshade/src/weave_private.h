/* SPDX-License-Identifier: Apache-2.0 */
/* What a shade_weave holds: all that look-ups would else compute again. */
#ifndef SHADE_WEAVE_PRIVATE_H
#define SHADE_WEAVE_PRIVATE_H

#include <stdint.h>

#include "shade/weave.h"

/*
 * One crossing. Cells that the yarn goes on above (or below) its partner before and after
 * this one; WEAVE_FAR: that many or more, or for ever.
 */
enum { WEAVE_FAR = 255 };
typedef struct weave_cell {
  uint8_t warp_up;
  uint8_t before[2], after[2]; /* by shade_top: of the weft, of the warp */
} weave_cell;

typedef struct weave_thread {
  double share, rgb[3];
  float sharef, rgbf[3];
} weave_thread;

/* One direction's numbers, ready for the leaves; noise amplitudes as the author gave them. */
typedef struct weave_yarn {
  double curve, ridge, slant, segments, crimp, per_crimp_length, along_frequency, slub;
  double vary_brightness, vary_tilt, along_brightness, along_tilt;
  double fibre_cos, fibre_sin;
} weave_yarn;
typedef struct weave_yarnf {
  float curve, ridge, slant, segments, crimp, per_crimp_length, along_frequency, slub;
  float vary_brightness, vary_tilt, along_brightness, along_tilt;
  float fibre_cos, fibre_sin;
} weave_yarnf;

struct shade_weave {
  shade_draft *draft;
  shade_weave_params params;
  weave_cell *cells;       /* as the draft's warp_up */
  weave_thread *thread[2]; /* by shade_top: picks, ends */
  weave_yarn yarn[2];
  weave_yarnf yarnf[2];
  double fuzz;
};

#endif
