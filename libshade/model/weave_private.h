/* SPDX-License-Identifier: Apache-2.0 */
/* What a shade_weave holds: all that look-ups would else compute again. */
#ifndef SHADE_MODEL_WEAVE_PRIVATE_H
#define SHADE_MODEL_WEAVE_PRIVATE_H

#include <stdatomic.h>
#include <stdint.h>

#include "shade/weave.h"

/*
 * One crossing in 32 bits: 1 if the warp is up; then, 7 bits each, how many cells the weft goes on
 * above (or below) its partner before this one and after it, and the same of the warp. WEAVE_FAR:
 * that many or more, or for ever; a crimp reaches 16.
 */
enum { WEAVE_FAR = 127 };

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
  atomic_int holders; /* who made it until they free it, and each fabric of it */
  int isa;            /* of shade_isa_tables: what it runs on */
  shade_draft *draft;
  shade_weave_params params;
  uint32_t *cells;         /* as the draft's warp_up */
  weave_thread *thread[2]; /* by shade_top: picks, then ends, side by side */
  weave_yarn yarn[2];
  weave_yarnf yarnf[2];
  double fuzz;
  int uniform[2]; /* by shade_top: all yarns fill the same share */
  int noisy;      /* any noise at all */
};

/* The same weave, for one more holder, who frees it with shade_weave_free. */
shade_weave *shade_weave_share(const shade_weave *weave);

#endif
