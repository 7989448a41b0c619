/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one thread works with. */
#ifndef LIBSHADE_WORKER_H
#define LIBSHADE_WORKER_H

#include <stdatomic.h>

#include "render/clock.h"
#include "render/matte.h"
#include "render/plane.h"
#include "render/sampling.h"
#include "render/state.h"
#include "stage/stage.h"

/* Who looks on and changes nothing: called with the batch as the stages left it. */
typedef struct observer {
  void *context;
  void (*hits)(void *context, const batch *b, const camera_view *view);
  void (*light)(void *context, const batch *b, const camera_view *view, size_t number,
                const light *light);
} observer;

/* One thread's state. */
typedef struct worker {
  const scene *scene;
  const sampling *sampling;
  const observer *observer;  /* or NULL */
  const atomic_bool *cancel; /* what a batch leaves undone once this is true is never shown */
  const plane_layout *planes;
  bool first_pass;
  float *half;    /* of the tile's first halves, where blocks may be done early, or NULL */
  float *numbers; /* of the tile's planes, or NULL where none is wanted */
  struct light_passes *light; /* or NULL where no plane of light and no matte is wanted */
  const matte_layout *mattes; /* or NULL where none is wanted, */
  float *matte;               /* and those of the tile */
  batch *batch;
  cloth_room cloth;
  size_t *end;     /* by light that hits choose: past the last of them in batch->lit */
  bool later;      /* the hits at hand are not those of the camera */
  bool apart;      /* what they shine with is clamped by itself, and no more in batch->sum */
  size_t aims;     /* balls that matt ones among them aim at */
  unsigned status; /* bits of libshade */
  clocks clocks;
  struct environment *environment; /* or NULL where no sky is said by nodes */
  struct through *through; /* what shadow rays need where some surface is transparent, or NULL */
} worker;

#endif
