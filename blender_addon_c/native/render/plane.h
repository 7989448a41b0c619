/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is rendered beside the picture, of the first surface that each sample meets. Each plane is
 * one row, ROW(TYPE, channels, filtered): TYPE is its word in a scene. A plane that is filtered is
 * the mean over a pixel's samples, 0 where they meet nothing; one that is not (distances and
 * numbers have no mean) is that of the pixel's first sample.
 */
#ifndef LIBSHADE_PLANE_H
#define LIBSHADE_PLANE_H

#include <stdbool.h>

#include "batch/state.h"
#include "stage/stage.h"

#define PLANE_TABLE(ROW)                                                                           \
  ROW(DEPTH, 1, false)                                                                             \
  ROW(POSITION, 3, false)                                                                          \
  ROW(NORMAL, 3, true)                                                                             \
  ROW(ALBEDO, 3, true)                                                                             \
  ROW(UV, 3, true)                                                                                 \
  ROW(OBJECT, 1, false)                                                                            \
  ROW(MATERIAL, 1, false)

#define PLANE_TYPE(TYPE, channels, filtered) PLANE_##TYPE,
typedef enum plane_type { PLANE_TABLE(PLANE_TYPE) PLANES } plane_type;

#define PLANE_CHANNELS(TYPE, channels, filtered) +channels
enum { PLANE_CHANNELS_MAX = PLANE_TABLE(PLANE_CHANNELS) };

/* Depth where there is nothing, as Blender has it. */
#define PLANE_FAR 1e10f

const char *plane_word(plane_type type);
int plane_channels(plane_type type);
bool plane_is_filtered(plane_type type);

/* Where each plane that is wanted begins among a pixel's numbers. */
typedef struct plane_layout {
  unsigned wanted; /* a bit each */
  int channels;    /* of all */
  int at[PLANES];
} plane_layout;

plane_layout plane_layout_of(unsigned wanted);

/* Adds the first surfaces of a batch to the tile's numbers; first: the pass is that of the pixels'
 * first samples. */
void plane_add(const plane_layout *layout, const scene *s, const batch *b, const camera_view *view,
               bool first, float *numbers);

#endif
