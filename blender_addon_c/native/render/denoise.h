/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Intel's Open Image Denoise, where it is found; all of it is in render/denoise.c. Nothing is
 * linked: the library of the Blender that runs is taken, the system's, or one at a given path.
 */
#ifndef LIBSHADE_DENOISE_H
#define LIBSHADE_DENOISE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct denoise_input {
  int width, height;
  float *color;        /* 4 floats a pixel: the first three are filtered where they are */
  const float *albedo; /* 3 floats a pixel each */
  const float *normal;
  int threads, samples;
} denoise_input;

/* False with a message where the library is missing or fails, with an empty one where *cancel
 * became true; the picture then is as it was. path: where to look first, or NULL. */
bool denoise_run(const denoise_input *input, const char *path, const atomic_bool *cancel,
                 char *error, size_t error_size);

/* The same without a library, by edge-avoiding wavelets [Dammertz2010]: for pictures that shall be
 * there at once. False when out of memory; the picture then is as it was. */
bool denoise_simply(const denoise_input *input);

#endif
