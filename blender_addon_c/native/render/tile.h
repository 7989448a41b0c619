/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture, tile by tile, on all threads. */
#ifndef LIBSHADE_TILE_H
#define LIBSHADE_TILE_H

#include <stdatomic.h>
#include <stdbool.h>

#include "render/bounce.h"
#include "system/message.h"

typedef struct render {
  const scene *scene;
  const sampling *sampling;
  const atomic_bool *cancel;
  message_log *log;
  int region[4];
  float *image;             /* RGBA of the region, row by row from the bottom; or NULL */
  const observer *observer; /* or NULL */

  /* set by render_prepare */
  int side;      /* of a tile, in pixels */
  int origin[2]; /* of the first tile: tiles lie on the same grid whatever the region */
  size_t columns, tiles;
  atomic_bool *done;      /* per tile: its pixels are in the image */
  atomic_size_t finished; /* tiles */

  /* set by render_run */
  atomic_size_t next;
  pthread_mutex_t lock;   /* of what follows */
  unsigned status;        /* bits of libshade */
  double seconds[CLOCKS]; /* summed over threads */
} render;

/* False when out of memory. */
bool render_prepare(render *r);
/* False when cancelled or failed; the reason is in the log. */
bool render_run(render *r);
/* Copy what is finished; may run at the same time as render_run. */
void render_copy(const render *r, float *out);
void render_free(render *r);

#endif
