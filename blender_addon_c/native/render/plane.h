/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is rendered beside the picture, of the first surface that each sample meets. Each plane is
 * one row, ROW(TYPE, channels, filtered): TYPE is its word in a scene. A plane that is filtered is
 * the mean over a pixel's samples, 0 where they meet nothing; one that is not (distances and
 * numbers have no mean) is that of the pixel's first sample. DISTANCE is along the ray, from where
 * the camera clips; SEEN_NORMAL in the camera's frame, z away from it; VECTOR the mean over
 * VECTOR_HITS (render/vector.h); SAMPLES the part of all samples that the pixel has; HELD, how
 * much of it is a hole before a background. Planes of
 * light are of all surfaces (render/light_passes.h).
 */
#ifndef LIBSHADE_PLANE_H
#define LIBSHADE_PLANE_H

#include <stdbool.h>

#include "render/state.h"
#include "stage/stage.h"

#define PLANES_OF_SURFACES(ROW)                                                                    \
  ROW(DEPTH, 1, false)                                                                             \
  ROW(POSITION, 3, false)                                                                          \
  ROW(NORMAL, 3, true)                                                                             \
  ROW(ALBEDO, 3, true)                                                                             \
  ROW(UV, 3, true)                                                                                 \
  ROW(OBJECT, 1, false)                                                                            \
  ROW(MATERIAL, 1, false)                                                                          \
  ROW(DISTANCE, 1, true)                                                                           \
  ROW(SEEN_NORMAL, 3, true)                                                                        \
  ROW(VECTOR, 4, true)                                                                             \
  ROW(VECTOR_HITS, 1, true)                                                                        \
  ROW(SAMPLES, 1, false)                                                                           \
  ROW(HELD, 1, true)

/* Of each kind (bounce_kind) its parts in this order; those of light are divided by the colour once
 * they are looked at. */
#define PLANES_OF_LIGHT(ROW)                                                                       \
  ROW(DIFFUSE_DIRECT, 3, true)                                                                     \
  ROW(DIFFUSE_INDIRECT, 3, true)                                                                   \
  ROW(DIFFUSE_COLOR, 3, true)                                                                      \
  ROW(GLOSSY_DIRECT, 3, true)                                                                      \
  ROW(GLOSSY_INDIRECT, 3, true)                                                                    \
  ROW(GLOSSY_COLOR, 3, true)                                                                       \
  ROW(TRANSMISSION_DIRECT, 3, true)                                                                \
  ROW(TRANSMISSION_INDIRECT, 3, true)                                                              \
  ROW(TRANSMISSION_COLOR, 3, true)                                                                 \
  ROW(EMISSION, 3, true)                                                                           \
  ROW(ENVIRONMENT, 3, true)                                                                        \
  ROW(MIST, 1, true)

#define PLANE_TABLE(ROW) PLANES_OF_SURFACES(ROW) PLANES_OF_LIGHT(ROW)

#define PLANE_TYPE(TYPE, channels, filtered) PLANE_##TYPE,
typedef enum plane_type { PLANE_TABLE(PLANE_TYPE) PLANES } plane_type;

#define PLANE_CHANNELS(TYPE, channels, filtered) +channels
enum { PLANE_CHANNELS_MAX = PLANE_TABLE(PLANE_CHANNELS) };

/* Those of light come last. */
enum { PLANE_LIGHT = PLANE_DIFFUSE_DIRECT, LIGHT_PLANES = PLANES - PLANE_LIGHT };
#define PLANES_LIGHT_MASK (((1u << LIGHT_PLANES) - 1u) << PLANE_LIGHT)

/* Parts of the planes of a kind of light. */
typedef enum light_part { LIGHT_DIRECT, LIGHT_INDIRECT, LIGHT_COLOR, LIGHT_PARTS } light_part;

/* Depth where there is nothing, as Blender has it. */
#define PLANE_FAR 1e10f

const char *plane_word(plane_type type);
int plane_channels(plane_type type);
bool plane_is_filtered(plane_type type);
/* The plane that it is divided by, or PLANES. */
plane_type plane_divisor(plane_type type);
/* These planes and all that they take. */
unsigned plane_needs(unsigned wanted);

/* Where each plane that is wanted begins among a pixel's numbers. */
typedef struct plane_layout {
  unsigned wanted; /* a bit each */
  int channels;    /* of all */
  int at[PLANES];
} plane_layout;

plane_layout plane_layout_of(unsigned wanted);

/* One closure's colour in channel k, 0 to 1. */
float plane_closure_color(const inputs *in, const closure *c, int k, size_t i);

/* Adds the first surfaces of a batch to the tile's numbers; first: the pass is that of the pixels'
 * first samples. */
void plane_add(const plane_layout *layout, const scene *s, const batch *b, const camera_view *view,
               bool first, float *numbers);

#endif
