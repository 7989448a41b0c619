/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Pictures from files, of any format that OpenImageIO reads. That library is large and slow
 * to load (0.2 s), so it sits in a module of its own, shade_image_oiio.so, which the program
 * loads when a picture is first read: from the program's folder or from ../libexec/shade.
 */
#ifndef SHADE_IMAGE_READ_H
#define SHADE_IMAGE_READ_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shade_picture {
  int width, height, channels;
  int bits;      /* of a stored value: 8, 16, 32, … */
  float *pixels; /* interleaved, row 0 the top; whole numbers as 0 to 1; free() it */
} shade_picture;

/*
 * Read the first `most` channels of a file's first picture, as stored: no gamma, no alpha
 * taken apart. 0, or -1 and "PATH: what is wrong". Pictures over 65536 a side or 2^30 texels
 * are refused. The module is loaded once and stays; call it first from one thread.
 */
int shade_image_read(const char *path, int most, shade_picture *picture, char *error,
                     size_t error_size);

/* The module's only function: as shade_image_read. */
typedef int shade_oiio_read_function(const char *path, int most, shade_picture *picture,
                                     char *error, size_t error_size);
shade_oiio_read_function shade_oiio_read;

#ifdef __cplusplus
}
#endif
#endif
