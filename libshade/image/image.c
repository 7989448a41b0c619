/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures as files: names, checks, temporary files. The formats are in image_*.c. */
#include "image/image.h"
#include "image/writer.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int same_letters(const char *text, const char *small) {
  while (*small && tolower((unsigned char)*text) == *small) {
    text++;
    small++;
  }
  return !*text && !*small;
}

shade_image_format shade_image_format_of(const char *path) {
  const char *dot = strrchr(path, '.');
  if (dot && same_letters(dot, ".exr"))
    return SHADE_IMAGE_EXR;
  return dot && same_letters(dot, ".png") ? SHADE_IMAGE_PNG : SHADE_IMAGE_UNKNOWN;
}

static const shade_image_backend *backend(shade_image_format format) {
#ifdef HAVE_OPENEXR
  if (format == SHADE_IMAGE_EXR)
    return &shade_image_exr;
#endif
#ifdef HAVE_PNG
  if (format == SHADE_IMAGE_PNG)
    return &shade_image_png;
#endif
  (void)format;
  return NULL;
}

const char *shade_image_missing(shade_image_format format) {
  if (format == SHADE_IMAGE_UNKNOWN || backend(format))
    return NULL;
  return format == SHADE_IMAGE_EXR ? "this `shade` was built without OpenEXR; install Debian's "
                                     "package libopenexr-dev and run make again"
                                   : "this `shade` was built without libpng; install Debian's "
                                     "package libpng-dev and run make again";
}

int shade_image_fail(shade_image_writer *w, const char *format, ...) {
  char message[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  if (w->error_size)
    snprintf(w->error, w->error_size, "%s: %s", w->path, message);
  return -1;
}

static int check(shade_image_writer *w, shade_image_format format) {
  const shade_image_spec *s = &w->spec;
  const int exr = format == SHADE_IMAGE_EXR;
  if (format == SHADE_IMAGE_UNKNOWN)
    return shade_image_fail(w, "expected a name that ends in .exr or .png");
  if (!backend(format))
    return shade_image_fail(w, "%s", shade_image_missing(format));
  if (s->width < 1 || s->width > SHADE_IMAGE_MAX_SIDE || s->height < 1 ||
      s->height > SHADE_IMAGE_MAX_SIDE)
    return shade_image_fail(w, "%d x %d pixels: expected 1 to %d a side", s->width, s->height,
                            SHADE_IMAGE_MAX_SIDE);
  if (exr != (s->type == SHADE_IMAGE_HALF || s->type == SHADE_IMAGE_FLOAT))
    return shade_image_fail(w, "%s",
                            exr ? "OpenEXR holds half and float" : "PNG holds 8 or 16 bits");
  if (exr ? s->channels < 1 || s->channels > SHADE_IMAGE_MAX_CHANNELS
          : s->channels != 1 && s->channels != 3 && s->channels != 4)
    return shade_image_fail(w, "%d channels do not fit the format", s->channels);
  if (exr && !s->names && s->channels != 1 && s->channels != 3 && s->channels != 4)
    return shade_image_fail(w, "%d channels need names", s->channels);
  return 0;
}

static int create_temporary(shade_image_writer *w) {
  char why[256];
  return shade_whole_begin(&w->file, w->path, why, sizeof why) == 0
             ? 0
             : shade_image_fail(w, "%s", why);
}

static void set_names(shade_image_writer *w, const char *const *names) {
  static const char *const grey[] = {"Y"}, *const colour[] = {"R", "G", "B", "A"};
  const char *const *from = names ? names : w->spec.channels == 1 ? grey : colour;
  for (int c = 0; c < w->spec.channels; c++)
    w->names[c] = from[c];
}

shade_image_writer *shade_image_open(const char *path, const shade_image_spec *spec, char *error,
                                     size_t error_size) {
  shade_image_writer *w = calloc(1, sizeof *w);
  char *copy = malloc(strlen(path) + 1);
  if (!w || !copy) {
    snprintf(error, error_size, "%s: out of memory", path);
    free(w);
    free(copy);
    return NULL;
  }
  w->path = strcpy(copy, path);
  w->spec = *spec;
  w->error = error;
  w->error_size = error_size;
  const shade_image_format format = shade_image_format_of(path);
  if (check(w, format) != 0 || create_temporary(w) != 0) {
    shade_image_abandon(w);
    return NULL;
  }
  set_names(w, spec->names);
  if (backend(format)->open(w) != 0) {
    shade_image_abandon(w);
    return NULL;
  }
  w->spec.note = NULL;
  return w;
}

int shade_image_rows(shade_image_writer *w, const float *rows, int count, char *error,
                     size_t error_size) {
  w->error = error;
  w->error_size = error_size;
  if (count < 0 || count > w->spec.height - w->row)
    return shade_image_fail(w, "%d rows more than the picture's height", count);
  if (backend(shade_image_format_of(w->path))->rows(w, rows, count) != 0)
    return -1;
  w->row += count;
  return 0;
}

int shade_image_close(shade_image_writer *w, char *error, size_t error_size) {
  w->error = error;
  w->error_size = error_size;
  int status = 0;
  if (w->row != w->spec.height)
    status = shade_image_fail(w, "%d of %d rows were written", w->row, w->spec.height);
  if (status == 0)
    status = backend(shade_image_format_of(w->path))->finish(w);
  char why[256];
  if (status == 0 && shade_whole_end(&w->file, 1, why, sizeof why) != 0)
    status = shade_image_fail(w, "%s", why);
  shade_image_abandon(w);
  return status;
}

void shade_image_abandon(shade_image_writer *w) {
  if (!w)
    return;
  if (w->format)
    backend(shade_image_format_of(w->path))->release(w);
  shade_whole_end(&w->file, 0, NULL, 0);
  free(w->path);
  free(w);
}

int shade_image_write(const char *path, const shade_image_spec *spec, const float *pixels,
                      char *error, size_t error_size) {
  shade_image_writer *w = shade_image_open(path, spec, error, error_size);
  if (!w)
    return -1;
  if (shade_image_rows(w, pixels, spec->height, error, error_size) != 0) {
    shade_image_abandon(w);
    return -1;
  }
  return shade_image_close(w, error, error_size);
}
