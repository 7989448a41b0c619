/* SPDX-License-Identifier: Apache-2.0 */
/* Scanline OpenEXR, ZIP, through OpenEXRCore. */
#include "image/writer.h"

#include <openexr.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* zlib's level: more costs much time and saves little on floats */
#define ZIP_LEVEL 3

typedef struct exr_state {
  exr_context_t context;
  exr_encode_pipeline_t pipeline;
  int started; /* the pipeline is initialised */
  int band, filled;
  float *rows; /* `band` rows waiting to be a whole chunk */
} exr_state;

/* OpenEXRCore says what is wrong through a callback, on the thread that called it. */
static _Thread_local char library_message[256];

static void remember(exr_const_context_t context, exr_result_t code, const char *message) {
  (void)context;
  (void)code;
  snprintf(library_message, sizeof library_message, "%s", message);
}

static int fail(shade_image_writer *w, exr_result_t code, const char *what) {
  return shade_image_fail(w, "%s: %s", what,
                          library_message[0] ? library_message
                                             : exr_get_default_error_message(code));
}

static exr_result_t write_header(shade_image_writer *w, exr_context_t context) {
  const shade_image_spec *s = &w->spec;
  const int all[] = {0, 0, s->width, s->height}, *in = s->within ? s->within : all;
  const exr_attr_box2i_t display = {.max.x = in[2] - 1, .max.y = in[3] - 1};
  const exr_attr_box2i_t data = {.min.x = in[0],
                                 .min.y = in[1],
                                 .max.x = in[0] + s->width - 1,
                                 .max.y = in[1] + s->height - 1};
  const exr_attr_v2f_t middle = {.x = 0};
  int part;
  exr_result_t code = exr_add_part(context, "picture", EXR_STORAGE_SCANLINE, &part);
  if (code == EXR_ERR_SUCCESS)
    code = exr_initialize_required_attr(context, 0, &display, &data, 1, &middle, 1,
                                        EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP);
  for (int c = 0; code == EXR_ERR_SUCCESS && c < s->channels; c++)
    code = exr_add_channel(context, 0, w->names[c],
                           s->type == SHADE_IMAGE_HALF ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                           EXR_PERCEPTUALLY_LINEAR, 1, 1);
  if (code == EXR_ERR_SUCCESS && s->note)
    code = exr_attr_set_string(context, 0, "comments", s->note);
  for (size_t i = 0; code == EXR_ERR_SUCCESS && i < s->text_count; i++)
    code = exr_attr_set_string(context, 0, s->texts[i].name, s->texts[i].text);
  return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

static int open_file(shade_image_writer *w) {
  exr_state *e = calloc(1, sizeof *e);
  if (!e)
    return shade_image_fail(w, "out of memory");
  w->format = e;
  exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
  options.error_handler_fn = remember;
  options.max_image_width = options.max_image_height = SHADE_IMAGE_MAX_SIDE;
  options.zip_level = ZIP_LEVEL;
  library_message[0] = 0;
  exr_result_t code =
      exr_start_write(&e->context, w->file.temporary, EXR_WRITE_FILE_DIRECTLY, &options);
  if (code != EXR_ERR_SUCCESS)
    return fail(w, code, "cannot write");
  code = write_header(w, e->context);
  if (code != EXR_ERR_SUCCESS)
    return fail(w, code, "cannot write the header");
  int32_t band = 0;
  code = exr_get_scanlines_per_chunk(e->context, 0, &band);
  if (code != EXR_ERR_SUCCESS || band < 1)
    return fail(w, code, "no size of chunks");
  e->band = band;
  e->rows = malloc((size_t)band * (size_t)w->spec.width * (size_t)w->spec.channels * sizeof(float));
  return e->rows ? 0 : shade_image_fail(w, "out of memory");
}

/* One chunk, whose first row is the picture's `y`. */
static int write_chunk(shade_image_writer *w, int y) {
  exr_state *e = w->format;
  const shade_image_spec *s = &w->spec;
  exr_chunk_info_t chunk;
  const int first = s->within ? s->within[1] : 0;
  exr_result_t code = exr_write_scanline_chunk_info(e->context, 0, first + y, &chunk);
  if (code == EXR_ERR_SUCCESS)
    code = e->started ? exr_encoding_update(e->context, 0, &chunk, &e->pipeline)
                      : exr_encoding_initialize(e->context, 0, &chunk, &e->pipeline);
  if (code != EXR_ERR_SUCCESS)
    return fail(w, code, "cannot write pixels");
  for (int i = 0; i < e->pipeline.channel_count; i++) {
    exr_coding_channel_info_t *channel = &e->pipeline.channels[i];
    int c = 0;
    while (c < s->channels - 1 && strcmp(w->names[c], channel->channel_name))
      c++;
    channel->encode_from_ptr = (const uint8_t *)(e->rows + c);
    channel->user_data_type = EXR_PIXEL_FLOAT;
    channel->user_bytes_per_element = (int16_t)sizeof(float);
    channel->user_pixel_stride = (int32_t)sizeof(float) * s->channels;
    channel->user_line_stride = channel->user_pixel_stride * s->width;
  }
  if (!e->started) {
    e->started = 1;
    code = exr_encoding_choose_default_routines(e->context, 0, &e->pipeline);
  }
  if (code == EXR_ERR_SUCCESS)
    code = exr_encoding_run(e->context, 0, &e->pipeline);
  return code == EXR_ERR_SUCCESS ? 0 : fail(w, code, "cannot write pixels");
}

static void take_row(shade_image_writer *w, const float *from, float *to) {
  const size_t size = (size_t)w->spec.width * (size_t)w->spec.channels;
  const float most = 65504;
  if (w->spec.type == SHADE_IMAGE_FLOAT)
    memcpy(to, from, size * sizeof *to);
  else
    for (size_t i = 0; i < size; i++)
      to[i] = from[i] > most ? most : from[i] < -most ? -most : from[i];
}

static int add_rows(shade_image_writer *w, const float *rows, int count) {
  exr_state *e = w->format;
  const size_t size = (size_t)w->spec.width * (size_t)w->spec.channels;
  library_message[0] = 0;
  for (int i = 0; i < count; i++) {
    take_row(w, rows + (size_t)i * size, e->rows + (size_t)e->filled * size);
    e->filled++;
    const int done = w->row + i + 1;
    if (e->filled < e->band && done < w->spec.height)
      continue;
    if (write_chunk(w, done - e->filled) != 0)
      return -1;
    e->filled = 0;
  }
  return 0;
}

static int finish(shade_image_writer *w) {
  exr_state *e = w->format;
  library_message[0] = 0;
  if (e->started)
    exr_encoding_destroy(e->context, &e->pipeline);
  e->started = 0;
  const exr_result_t code = exr_finish(&e->context);
  e->context = NULL;
  return code == EXR_ERR_SUCCESS ? 0 : fail(w, code, "cannot finish the file");
}

static void release(shade_image_writer *w) {
  exr_state *e = w->format;
  if (e->started)
    exr_encoding_destroy(e->context, &e->pipeline);
  if (e->context)
    exr_finish(&e->context);
  free(e->rows);
  free(e);
}

const shade_image_backend shade_image_exr = {open_file, add_rows, finish, release};
