/* SPDX-License-Identifier: Apache-2.0 */
/* What image.c and the two formats share. Private to libshade/image. */
#ifndef SHADE_IMAGE_WRITER_H
#define SHADE_IMAGE_WRITER_H

#include "dump/whole.h"
#include "image/image.h"

struct shade_image_writer {
  char *path;
  shade_whole file;
  shade_image_spec spec; /* names: as in the file; note: only while opening */
  const char *names[SHADE_IMAGE_MAX_CHANNELS];
  int row; /* written so far */
  char *error;
  size_t error_size; /* of the call in progress */
  void *format;      /* the format's own state */
};

/* Writes "PATH: message" for the call in progress. Always -1. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int shade_image_fail(shade_image_writer *w, const char *format, ...);

/* One format. 0, or -1 after shade_image_fail. `release` frees `format` at any stage. */
typedef struct shade_image_backend {
  int (*open)(shade_image_writer *w);
  int (*rows)(shade_image_writer *w, const float *rows, int count);
  int (*finish)(shade_image_writer *w);
  void (*release)(shade_image_writer *w);
} shade_image_backend;

#ifdef HAVE_OPENEXR
extern const shade_image_backend shade_image_exr;
#endif
#ifdef HAVE_PNG
extern const shade_image_backend shade_image_png;
#endif

#endif
