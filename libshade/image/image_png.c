/* SPDX-License-Identifier: Apache-2.0 */
/* PNG of 8 or 16 bits, through libpng. */
#include "image/writer.h"
#include "port/files.h"

#include <errno.h>
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* zlib's level: more costs much time and saves little on normal maps */
#define ZIP_LEVEL 3

typedef struct png_state {
  FILE *file;
  png_structp png;
  png_infop info;
  uint8_t *row;
} png_state;

/*
 * libpng does not return from an error: to the setjmp of the call in progress. Where a write of the
 * stream failed it says no more than that: errno says why.
 */
static void on_error(png_structp png, png_const_charp message) {
  const int why = errno;
  shade_image_writer *w = png_get_error_ptr(png);
  const png_state *p = w->format;
  shade_image_fail(w, "cannot write: %s",
                   p->file && ferror(p->file) && why ? strerror(why) : message);
  longjmp(png_jmpbuf(png), 1);
}
static void on_warning(png_structp png, png_const_charp message) {
  (void)png;
  (void)message;
}

static int start(shade_image_writer *w, png_state *p) {
  const shade_image_spec *s = &w->spec;
  const int colour = s->channels == 1   ? PNG_COLOR_TYPE_GRAY
                     : s->channels == 3 ? PNG_COLOR_TYPE_RGB
                                        : PNG_COLOR_TYPE_RGB_ALPHA;
  if (setjmp(png_jmpbuf(p->png)))
    return -1;
  png_init_io(p->png, p->file);
  png_set_user_limits(p->png, SHADE_IMAGE_MAX_SIDE, SHADE_IMAGE_MAX_SIDE);
  png_set_compression_level(p->png, ZIP_LEVEL);
  png_set_filter(p->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP | PNG_FILTER_SUB);
  png_set_IHDR(p->png, p->info, (png_uint_32)s->width, (png_uint_32)s->height,
               s->type == SHADE_IMAGE_U8 ? 8 : 16, colour, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (s->srgb)
    png_set_sRGB_gAMA_and_cHRM(p->png, p->info, PNG_sRGB_INTENT_PERCEPTUAL);
  if (s->note) {
    png_text text;
    memset(&text, 0, sizeof text);
    text.compression = PNG_TEXT_COMPRESSION_NONE;
    text.key = (png_charp) "Comment";
    text.text = (png_charp)s->note; /* read only */
    png_set_text(p->png, p->info, &text, 1);
  }
  png_write_info(p->png, p->info);
  return 0;
}

static int open_file(shade_image_writer *w) {
  png_state *p = calloc(1, sizeof *p);
  if (!p)
    return shade_image_fail(w, "out of memory");
  w->format = p;
  p->row = malloc((size_t)w->spec.width * (size_t)w->spec.channels * 2);
  p->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, w, on_error, on_warning);
  p->info = p->png ? png_create_info_struct(p->png) : NULL;
  if (!p->row || !p->info)
    return shade_image_fail(w, "out of memory");
  p->file = shade_port_open(w->file.temporary, "wb");
  if (!p->file)
    return shade_image_fail(w, "cannot write: %s", strerror(errno));
  return start(w, p);
}

static float to_srgb(float x) {
  return x <= 0.0031308F ? 12.92F * x : 1.055F * powf(x, 1 / 2.4F) - 0.055F;
}

/* [0, 1] to whole numbers; what is not above 0, NaN too, is 0 */
static unsigned quantise(float x, float most, int srgb) {
  x = x > 0 ? fminf(x, 1) : 0;
  if (srgb)
    x = fminf(to_srgb(x), 1);
  return (unsigned)(x * most + 0.5F);
}

static void pack_row(const shade_image_spec *s, const float *from, uint8_t *to) {
  const size_t size = (size_t)s->width * (size_t)s->channels;
  const float most = s->type == SHADE_IMAGE_U8 ? 255.0F : 65535.0F;
  for (size_t i = 0; i < size; i++) {
    const int alpha = s->channels == 4 && i % 4 == 3;
    const unsigned v = quantise(from[i], most, s->srgb && !alpha);
    if (s->type == SHADE_IMAGE_U8) {
      to[i] = (uint8_t)v;
    } else {
      to[2 * i] = (uint8_t)(v >> 8);
      to[2 * i + 1] = (uint8_t)(v & 255);
    }
  }
}

static int add_rows(shade_image_writer *w, const float *rows, int count) {
  png_state *p = w->format;
  const size_t size = (size_t)w->spec.width * (size_t)w->spec.channels;
  if (setjmp(png_jmpbuf(p->png)))
    return -1;
  for (int i = 0; i < count; i++) {
    pack_row(&w->spec, rows + (size_t)i * size, p->row);
    png_write_row(p->png, p->row);
  }
  return 0;
}

static int finish(shade_image_writer *w) {
  png_state *p = w->format;
  if (setjmp(png_jmpbuf(p->png)))
    return -1;
  png_write_end(p->png, p->info);
  FILE *file = p->file;
  p->file = NULL;
  return fclose(file) == 0 ? 0 : shade_image_fail(w, "cannot write: %s", strerror(errno));
}

static void release(shade_image_writer *w) {
  png_state *p = w->format;
  if (p->png)
    png_destroy_write_struct(&p->png, &p->info);
  if (p->file)
    fclose(p->file);
  free(p->row);
  free(p);
}

const shade_image_backend shade_image_png = {open_file, add_rows, finish, release};
