/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All that one thread holds of the batch it works on. */
#ifndef LIBSHADE_STATE_H
#define LIBSHADE_STATE_H

#include "batch/lanes.h"
#include "batch/queue.h"

typedef struct batch {
  /* by sample; rays and hits after the first bounce by ray */
  paths path;
  rays sample_ray;
  hits sample_hit;
  lane_c sample_color;
  /* by hit */
  queue queue;
  rays *ray; /* those cast last, or moved_ray */
  hits *hit;
  rays moved_ray;
  hits moved_hit;
  corners corner;
  surfaces surface;
  inputs input;
  light_samples light; /* of the light at hand */
  reflections reflection;
  draws draw;
  walks *walk, *next; /* by ray, of this bounce and of the one after */
  walks walks[2];
  lane_u chosen; /* by ray: the hit it starts from */
  lane_c sum;    /* reflected light of all lights */
} batch;

#endif
