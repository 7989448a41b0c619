/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sums of a part of a picture's samples, .shshare, and the whole picture from such parts. A part is
 * a rectangle of the scene's region, a range of sample numbers, or both; what is divided, sorted or
 * denoised is so once all are added up. In the machine's own byte order:
 *
 *   "shshare\n", then uint32: version, the scene's checksum, samples of a pixel, seed, the first
 *   sample and the one behind the last, region (x0 y0 x1 y1, y up), pictures, and of each picture
 *   the floats of a pixel
 *   of each picture its pixels from the lowest row: RGBA, the planes, the slots of mattes, and how
 *   many samples that pixel has (less than there are where adaptive sampling has left some out)
 *   the CRC-32 of all this
 */
#ifndef LIBSHADE_SHARE_H
#define LIBSHADE_SHARE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "dump/whole.h"
#include "render/tile.h"
#include "scene_file.h"

/* One being written. */
typedef struct share_writer {
  shade_whole whole;
  FILE *file;
  uint32_t sum;
} share_writer;

/* All return false, with what is wrong in error[size]. `region`, of the picture: x0 y0 x1 y1. */
bool share_begin(share_writer *w, const char *path, const scene_file *f, const int region[4],
                 char *error, size_t size);
/* The sums of the next picture. */
bool share_put(share_writer *w, const render *r, const int region[4], char *error, size_t size);
/* The file takes its place; or goes, where not good. */
bool share_end(share_writer *w, bool good, char *error, size_t size);

/* Those that make a picture. */
typedef struct share_set {
  const char *const *path;
  size_t count;
  struct share *share;
  size_t picture;    /* that is filled */
  uint32_t *samples; /* by pixel of the region, of what was added */
} share_set;

/* Sets the scenes' samples and seed to those of the shares. */
bool share_open(share_set *set, const char *const *path, size_t count, scene_file *f, char *error,
                size_t size);
/* A job_fill of a share_set: the sums of its picture. */
bool share_fill(void *set, render *r);
void share_close(share_set *set);

#endif
