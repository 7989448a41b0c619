/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Pictures as files, for the tool: OpenEXR and PNG, written row by row from float.
 * A file appears whole or not at all: it grows under a temporary name in the same
 * folder and is renamed when it is closed. Each format is compiled in where its
 * library was found (HAVE_OPENEXR, HAVE_PNG); without it a clear message names
 * Debian's package. Functions that fail write "PATH: what is wrong" to `error`.
 * Different writers may be used by different threads at once.
 */
#ifndef SHADE_IMAGE_H
#define SHADE_IMAGE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum shade_image_format {
  SHADE_IMAGE_UNKNOWN, /* neither of the two */
  SHADE_IMAGE_EXR,
  SHADE_IMAGE_PNG
} shade_image_format;

/* By the ending of the name, capitals or not. */
shade_image_format shade_image_format_of(const char *path);
/* The message "…built without …; install Debian's package …", or NULL when compiled in. */
const char *shade_image_missing(shade_image_format format);

typedef enum shade_image_type {
  SHADE_IMAGE_U8,   /* PNG: [0, 1] to 0…255, rounded to nearest; NaN is 0 */
  SHADE_IMAGE_U16,  /* PNG: [0, 1] to 0…65535 */
  SHADE_IMAGE_HALF, /* EXR: rounded to nearest even, finite values beyond 65504 clamped */
  SHADE_IMAGE_FLOAT /* EXR */
} shade_image_type;

enum { SHADE_IMAGE_MAX_SIDE = 65536, SHADE_IMAGE_MAX_CHANNELS = 256 };

typedef struct shade_image_text {
  const char *name, *text;
} shade_image_text;

typedef struct shade_image_spec {
  int width, height;        /* 1 to SHADE_IMAGE_MAX_SIDE */
  int channels;             /* EXR: 1 to SHADE_IMAGE_MAX_CHANNELS; PNG: 1 grey, 3 RGB, 4 RGBA */
  const char *const *names; /* EXR: one a channel; NULL: Y; R G B; R G B A */
  shade_image_type type;
  int srgb;         /* PNG: 1 encodes the first three channels from linear to sRGB and says so */
  const char *note; /* what the picture is (EXR `comments`, PNG `Comment`), or NULL */
  const int
      *within; /* EXR: of what it is a part: x, y, and the width and height of that; NULL: all */
  const shade_image_text *texts; /* EXR: more of its header, until opened */
  size_t text_count;
} shade_image_spec;

typedef struct shade_image_writer shade_image_writer;

/* NULL and a message: unknown format, unfit type or size, no such folder, out of memory, … */
shade_image_writer *shade_image_open(const char *path, const shade_image_spec *spec, char *error,
                                     size_t error_size);
/*
 * The next `count` rows from the top: `channels` floats a pixel, interleaved, width a row.
 * Returns 0, or -1 and a message; rows beyond the height are an error.
 */
int shade_image_rows(shade_image_writer *w, const float *rows, int count, char *error,
                     size_t error_size);
/* Finish, rename and free. All rows must have been written. 0, or -1 and a message: no file. */
int shade_image_close(shade_image_writer *w, char *error, size_t error_size);
/* Remove the temporary file and free; NULL is fine. A file of that name from before stays. */
void shade_image_abandon(shade_image_writer *w);

/* Open, all rows, close. */
int shade_image_write(const char *path, const shade_image_spec *spec, const float *pixels,
                      char *error, size_t error_size);

#ifdef __cplusplus
}
#endif
#endif
