/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture in passes, each tile by tile, on all threads. */
#ifndef LIBSHADE_TILE_H
#define LIBSHADE_TILE_H

#include <stdatomic.h>
#include <stdbool.h>

#include "render/adaptive.h"
#include "render/bounce.h"
#include "system/message.h"

/* Pixels: with 4 samples each a tile is one batch. What is rendered of a tile changes what its
 * pixels round to. */
enum { TILE_SIDE = 16 };

typedef struct render {
  const scene *scene;
  const sampling_plan *plan;
  const atomic_bool *cancel;
  message_log *log;
  int region[4];
  float *sum;   /* of the samples: RGBA of the region, from its lowest row; or NULL */
  float *whole; /* the picture that takes the place of the means, once it is made */
  plane_layout planes;
  float *numbers; /* of the planes that are wanted: all of a pixel, as sum; or NULL */
  matte_layout mattes;
  float *matte;             /* the same of names' slots; or NULL */
  const observer *observer; /* or NULL */
  adaptive adaptive;
  double time_limit; /* seconds after which no tile is begun once all have a pass; 0: none */

  /* set by render_prepare */
  int side;      /* of a tile, in pixels */
  int origin[2]; /* of the first tile: tiles lie on the same grid whatever the region */
  size_t columns, tiles;
  atomic_size_t *done;    /* per tile: passes in the sums */
  bool *mixed;            /* per tile: cloth_room's, after its last batch */
  atomic_size_t finished; /* samples a pixel, over all tiles, with those that are not needed */
  atomic_size_t spared;   /* these, of all pixels */
  pthread_mutex_t film;   /* of the sums, and of done where these are read */

  /* set by render_run */
  double start;
  atomic_size_t next;
  pthread_mutex_t lock;   /* of what follows */
  unsigned status;        /* bits of libshade */
  double seconds[CLOCKS]; /* summed over threads */
} render;

/* False when out of memory. */
bool render_prepare(render *r);
/* False when cancelled or failed; the reason is in the log. */
bool render_run(render *r);
/* What is finished of all samples, 0 to 1. */
double render_progress(const render *r);
/* The picture so far: each pixel's mean over the samples that it has. May run at the same time as
 * render_run. */
void render_copy(render *r, float *out);
/* The same where there are samples; elsewhere `out` stays as it is. */
void render_copy_over(render *r, float *out);
/* The same without what was made of it. */
void render_copy_noisy(render *r, float *out);
/* The same of a plane that is wanted. */
void render_copy_plane(render *r, plane_type plane, float *out);
/* What word it is called by: "" the picture, NOISY it as it was before it was denoised, planes that
 * are wanted, OBJECT_MATTE00, ... layers of names. Its floats a pixel; 0: there is none. */
int render_channels(const render *r, const char *word);
/* The same of one that there is. */
void render_copy_word(render *r, const char *word, float *out);
void render_free(render *r);

#endif
