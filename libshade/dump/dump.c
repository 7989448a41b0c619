/* SPDX-License-Identifier: Apache-2.0 */
/* Dumps as OpenEXR files: names of channels, writer, reader. */
#include "dump.h"
#include "dump_exr.h"
#include "whole.h"
#include "port/files.h"
#include "src/json_text.h"

#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define JSON_ATTRIBUTE "libshade"

/* ---- the dump in memory ---------------------------------------------------- */

static size_t pixel_count(const shade_dump *d) {
  return (size_t)d->width * (size_t)d->height;
}

/* Planes of the channels that every dump of so many lights has. */
static int plane_count(int lights) {
  return SHADE_DUMP_BASE + SHADE_DUMP_PER_LIGHT * lights;
}

enum { OPTIONAL_PLANES = SHADE_DUMP_OPTIONAL_END - SHADE_DUMP_OPTIONAL };

shade_dump *shade_dump_create(int width, int height, int lights) {
  if (width < 1 || width > SHADE_DUMP_MAX_SIDE || height < 1 || height > SHADE_DUMP_MAX_SIDE ||
      lights < 0 || lights > SHADE_DUMP_MAX_LIGHTS)
    return NULL;
  shade_dump *d = calloc(1, sizeof *d);
  if (!d)
    return NULL;
  d->width = width;
  d->height = height;
  d->lights = lights;
  d->has_color = 1;
  d->data =
      calloc((size_t)(plane_count(lights) + OPTIONAL_PLANES), pixel_count(d) * sizeof *d->data);
  if (!d->data || shade_dump_set_json(d, "{}") != 0) {
    shade_dump_free(d);
    return NULL;
  }
  float *material = shade_dump_plane(d, SHADE_DUMP_MATERIAL);
  for (size_t i = 0; i < pixel_count(d); ++i)
    material[i] = -1;
  return d;
}

void shade_dump_free(shade_dump *d) {
  if (!d)
    return;
  free(d->json);
  free(d->data);
  free(d);
}

float *shade_dump_plane(const shade_dump *d, int channel) {
  if (channel >= SHADE_DUMP_OPTIONAL)
    channel += plane_count(d->lights) - SHADE_DUMP_OPTIONAL;
  return d->data + (size_t)channel * pixel_count(d);
}

float *shade_dump_light_plane(const shade_dump *d, int light, int channel) {
  return shade_dump_plane(d, SHADE_DUMP_BASE + SHADE_DUMP_PER_LIGHT * light + channel);
}

/* The names of optional planes, and how many follow as one channel. */
static const struct {
  char name[16];
  int planes;
} optional_names[OPTIONAL_PLANES] = {{"alpha.X", 2},
                                     {"alpha.Y", 0},
                                     {"groove.A", 1},
                                     {"f82.R", 3},
                                     {"f82.G", 0},
                                     {"f82.B", 0},
                                     {"eta.R", 3},
                                     {"eta.G", 0},
                                     {"eta.B", 0},
                                     {"k.R", 3},
                                     {"k.G", 0},
                                     {"k.B", 0},
                                     {"kd.R", 3},
                                     {"kd.G", 0},
                                     {"kd.B", 0},
                                     {"foot.U", 2},
                                     {"foot.V", 0},
                                     {"coverage.A", 1},
                                     {"tier", 1},
                                     {"lobe2.share", 7},
                                     {"lobe2.Ns.X", 0},
                                     {"lobe2.Ns.Y", 0},
                                     {"lobe2.Ns.Z", 0},
                                     {"lobe2.alpha.X", 0},
                                     {"lobe2.alpha.Y", 0},
                                     {"lobe2.groove.A", 0},
                                     {"lobe3.share", 7},
                                     {"lobe3.Ns.X", 0},
                                     {"lobe3.Ns.Y", 0},
                                     {"lobe3.Ns.Z", 0},
                                     {"lobe3.alpha.X", 0},
                                     {"lobe3.alpha.Y", 0},
                                     {"lobe3.groove.A", 0},
                                     {"slopes.X", 5},
                                     {"slopes.Y", 0},
                                     {"slopes.XX", 0},
                                     {"slopes.XY", 0},
                                     {"slopes.YY", 0}};

static uint64_t bit_of(int plane) {
  return (uint64_t)1 << (plane - SHADE_DUMP_OPTIONAL);
}

float *shade_dump_add(shade_dump *d, enum shade_dump_optional channel) {
  const int planes = optional_names[(int)channel - SHADE_DUMP_OPTIONAL].planes;
  for (int i = 0; i < planes; ++i)
    d->optional |= bit_of((int)channel + i);
  return shade_dump_plane(d, (int)channel);
}

int shade_dump_has(const shade_dump *d, enum shade_dump_optional channel) {
  return (d->optional & bit_of((int)channel)) != 0;
}

static int set_json(shade_dump *d, const char *json, size_t length) {
  char *copy = malloc(length + 1);
  if (!copy)
    return -1;
  memcpy(copy, json, length);
  copy[length] = 0;
  free(d->json);
  d->json = copy;
  return 0;
}

/* Appends to text[at] what fits of `more`; the length that was needed. */
static size_t append(char *text, size_t size, size_t at, const char *more) {
  for (; *more; more++, at++)
    if (at + 1 < size)
      text[at] = *more;
  return at;
}

/* The header into text[size], cut where that is full; the length that is needed. */
static size_t put_header(char *text, size_t size, const char *renderer,
                         const shade_dump_material *materials, size_t count) {
  char letter[JSON_LETTER];
  size_t at = append(text, size, 0, "{\"version\": \"" SHADE_VERSION "\", \"renderer\": \"");
  for (; *renderer; renderer++) {
    json_letter(*renderer, letter);
    at = append(text, size, at, letter);
  }
  at = append(text, size, at, "\", \"materials\": [");
  for (size_t i = 0; i < count; i++) {
    at = append(text, size, at, i ? ", " : "");
    if (materials[i].json)
      at = append(text, size, at, materials[i].json);
    else
      at += (size_t)shade_params_json(materials[i].params, (int)i, materials[i].name,
                                      size ? text + at : NULL, size ? size - at : 0);
  }
  at = append(text, size, at, "]}");
  if (size)
    text[at] = 0;
  return at;
}

char *shade_dump_header(const char *renderer, const shade_dump_material *materials, size_t count) {
  const size_t size = put_header(NULL, 0, renderer, materials, count) + 1;
  char *text = malloc(size);
  if (text)
    put_header(text, size, renderer, materials, count);
  return text;
}

int shade_dump_set_json(shade_dump *d, const char *json) {
  return set_json(d, json, strlen(json));
}

/* ---- names of channels ------------------------------------------------------ */

static const char base_names[SHADE_DUMP_BASE][16] = {
    "P.X", "P.Y",  "P.Z",  "N.X",         "N.Y",     "N.Z",     "T.X",
    "T.Y", "T.Z",  "Ns.X", "Ns.Y",        "Ns.Z",    "V.X",     "V.Y",
    "V.Z", "uv.U", "uv.V", "material.ID", "Color.R", "Color.G", "Color.B"};
static const char light_names[SHADE_DUMP_PER_LIGHT][4] = {"L.X", "L.Y", "L.Z", "E.R", "E.G",
                                                          "E.B", "S.R", "S.G", "S.B"};

void shade_dump_channel_name(int plane, char name[SHADE_DUMP_NAME_SIZE]) {
  const int rest = plane - SHADE_DUMP_BASE;
  if (plane >= SHADE_DUMP_OPTIONAL)
    memcpy(name, optional_names[plane - SHADE_DUMP_OPTIONAL].name, sizeof optional_names[0].name);
  else if (rest < 0)
    memcpy(name, base_names[plane], sizeof base_names[plane]);
  else
    snprintf(name, SHADE_DUMP_NAME_SIZE, "light%d.%s", rest / SHADE_DUMP_PER_LIGHT,
             light_names[rest % SHADE_DUMP_PER_LIGHT]);
}

int shade_dump_channel_plane(const char *name) {
  for (int i = 0; i < SHADE_DUMP_BASE; ++i)
    if (strcmp(name, base_names[i]) == 0)
      return i;
  for (int i = 0; i < OPTIONAL_PLANES; ++i)
    if (strcmp(name, optional_names[i].name) == 0)
      return SHADE_DUMP_OPTIONAL + i;
  int light, end = 0;
  if (sscanf(name, "light%5d.%n", &light, &end) != 1 || end == 0 || light < 0 ||
      light >= SHADE_DUMP_MAX_LIGHTS)
    return -1;
  for (int i = 0; i < SHADE_DUMP_PER_LIGHT; ++i) {
    const int plane = plane_count(light) + i;
    char canonical[SHADE_DUMP_NAME_SIZE];
    shade_dump_channel_name(plane, canonical); /* rules out light+1, light01, light 1 */
    if (strcmp(name, canonical) == 0)
      return plane;
  }
  return -1;
}

static int is_color(int plane) {
  return plane >= SHADE_DUMP_COLOR && plane < SHADE_DUMP_BASE;
}

/* ---- errors ------------------------------------------------------------------ */

/* OpenEXRCore says what is wrong through a callback, on the thread that called it. */
static _Thread_local char library_message[256];

static void remember(exr_const_context_t context, exr_result_t code, const char *message) {
  (void)context;
  (void)code;
  snprintf(library_message, sizeof library_message, "%s", message);
}

struct report {
  const struct shade_exr_api *api;
  const char *path;
  char *error;
  size_t size;
};

/* Writes "PATH: message". Always -1. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static int
fail(const struct report *r, const char *format, ...) {
  char message[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  if (r->size)
    snprintf(r->error, r->size, "%s: %s", r->path, message);
  return -1;
}

static int fail_library(const struct report *r, exr_result_t code, const char *what) {
  return fail(r, "%s: %s", what,
              library_message[0] ? library_message : r->api->exr_get_default_error_message(code));
}

static exr_context_initializer_t context_options(void) {
  exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
  options.error_handler_fn = remember;
  options.max_image_width = SHADE_DUMP_MAX_SIDE;
  options.max_image_height = SHADE_DUMP_MAX_SIDE;
  library_message[0] = 0;
  return options;
}

/* ---- loading the library ----------------------------------------------------- */

struct shade_exr_api *shade_exr_api_load(void *(*symbol)(void *context, const char *name),
                                         void *context, char *error, size_t error_size) {
  struct shade_exr_api *api = malloc(sizeof *api);
  if (!api) {
    snprintf(error, error_size, "OpenEXRCore: out of memory");
    return NULL;
  }
#define LOAD(name)                                                                                 \
  {                                                                                                \
    void *address = symbol(context, #name);                                                        \
    if (!address) {                                                                                \
      snprintf(error, error_size, "OpenEXRCore has no function %s", #name);                        \
      free(api);                                                                                   \
      return NULL;                                                                                 \
    }                                                                                              \
    memcpy(&api->name, &address, sizeof address);                                                  \
  }
  SHADE_EXR_FUNCTIONS(LOAD)
#undef LOAD
  return api;
}

/* ---- writing ------------------------------------------------------------------ */

/*
 * The k-th plane whose channel may be in a file: those of every dump, then the optional ones. -1
 * past the last.
 */
static int plane_number(int lights, int k) {
  const int count = plane_count(lights);
  return k < count ? k : k < count + OPTIONAL_PLANES ? SHADE_DUMP_OPTIONAL + k - count : -1;
}

static int in_file(const shade_dump *d, int plane) {
  if (plane >= SHADE_DUMP_OPTIONAL)
    return (d->optional & bit_of(plane)) != 0;
  return d->has_color || !is_color(plane);
}

static int write_header(const struct report *r, exr_context_t context, const shade_dump *d) {
  const struct shade_exr_api *api = r->api;
  int part;
  exr_result_t code = api->exr_add_part(context, "dump", EXR_STORAGE_SCANLINE, &part);
  if (code == EXR_ERR_SUCCESS)
    code = api->exr_initialize_required_attr_simple(context, 0, d->width, d->height,
                                                    EXR_COMPRESSION_ZIP);
  for (int k = 0, plane; code == EXR_ERR_SUCCESS && (plane = plane_number(d->lights, k)) >= 0;
       ++k) {
    char name[SHADE_DUMP_NAME_SIZE];
    shade_dump_channel_name(plane, name);
    if (in_file(d, plane))
      code = api->exr_add_channel(context, 0, name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1);
  }
  if (code == EXR_ERR_SUCCESS)
    code = api->exr_attr_set_string(context, 0, JSON_ATTRIBUTE, d->json);
  if (code == EXR_ERR_SUCCESS)
    code = api->exr_write_header(context);
  return code == EXR_ERR_SUCCESS ? 0 : fail_library(r, code, "cannot write the header");
}

static int write_pixels(const struct report *r, exr_context_t context, const shade_dump *d) {
  const struct shade_exr_api *api = r->api;
  exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
  exr_chunk_info_t chunk;
  exr_result_t code = EXR_ERR_SUCCESS;
  for (int y = 0; code == EXR_ERR_SUCCESS && y < d->height; y += chunk.height) {
    code = api->exr_write_scanline_chunk_info(context, 0, y, &chunk);
    if (code != EXR_ERR_SUCCESS)
      break;
    code = y == 0 ? api->exr_encoding_initialize(context, 0, &chunk, &pipeline)
                  : api->exr_encoding_update(context, 0, &chunk, &pipeline);
    if (code != EXR_ERR_SUCCESS)
      break;
    for (int i = 0; i < pipeline.channel_count; ++i) {
      exr_coding_channel_info_t *channel = &pipeline.channels[i];
      const int plane = shade_dump_channel_plane(channel->channel_name);
      channel->encode_from_ptr =
          (const uint8_t *)(shade_dump_plane(d, plane) + (size_t)y * (size_t)d->width);
      channel->user_pixel_stride = (int32_t)sizeof(float);
      channel->user_line_stride = (int32_t)sizeof(float) * d->width;
    }
    if (y == 0)
      code = api->exr_encoding_choose_default_routines(context, 0, &pipeline);
    if (code == EXR_ERR_SUCCESS)
      code = api->exr_encoding_run(context, 0, &pipeline);
  }
  api->exr_encoding_destroy(context, &pipeline);
  return code == EXR_ERR_SUCCESS ? 0 : fail_library(r, code, "cannot write pixels");
}

int shade_dump_write(const struct shade_exr_api *api, const char *path, const shade_dump *d,
                     char *error, size_t error_size) {
  const struct report r = {api, path, error, error_size};
  char why[256];
  shade_whole file;
  if (shade_whole_begin(&file, path, why, sizeof why) != 0)
    return fail(&r, "%s", why);
  const exr_context_initializer_t options = context_options();
  exr_context_t context = NULL;
  exr_result_t code =
      api->exr_start_write(&context, file.temporary, EXR_WRITE_FILE_DIRECTLY, &options);
  int status = code == EXR_ERR_SUCCESS ? 0 : fail_library(&r, code, "cannot write");
  if (status == 0)
    status = write_header(&r, context, d);
  if (status == 0)
    status = write_pixels(&r, context, d);
  code = api->exr_finish(&context);
  if (status == 0 && code != EXR_ERR_SUCCESS)
    status = fail_library(&r, code, "cannot finish the file");
  if (shade_whole_end(&file, status == 0, why, sizeof why) != 0)
    status = fail(&r, "%s", why);
  return status;
}

/* ---- reading ------------------------------------------------------------------ */

static int check_layout(const struct report *r, exr_context_t context) {
  const struct shade_exr_api *api = r->api;
  int parts = 0;
  exr_storage_t storage;
  exr_compression_t compression;
  if (api->exr_get_count(context, &parts) != EXR_ERR_SUCCESS || parts != 1)
    return fail(r, "not a dump: has %d parts, expected 1", parts);
  if (api->exr_get_storage(context, 0, &storage) != EXR_ERR_SUCCESS ||
      storage != EXR_STORAGE_SCANLINE)
    return fail(r, "not a dump: tiled or deep, expected flat scanlines");
  if (api->exr_get_compression(context, 0, &compression) != EXR_ERR_SUCCESS ||
      (compression != EXR_COMPRESSION_NONE && compression != EXR_COMPRESSION_ZIPS &&
       compression != EXR_COMPRESSION_ZIP))
    return fail(r, "not a dump: compression is not none, ZIPS or ZIP");
  return 0;
}

/* What a file's list of channels says. */
struct contents {
  int lights, has_color, planes; /* planes: in the file, of those that are known */
  uint64_t optional;
};

static int optional_planes_are_whole(const struct report *r, uint64_t optional) {
  for (int first = 0; first < OPTIONAL_PLANES; first += optional_names[first].planes) {
    const uint64_t all = (((uint64_t)1 << optional_names[first].planes) - 1) << first;
    for (int i = first; (optional & all) && i < first + optional_names[first].planes; ++i)
      if (!(optional & (uint64_t)1 << i))
        return fail(r, "not a dump: channel %s is missing", optional_names[i].name);
  }
  return 0;
}

/*
 * Every plane but Color's and the optional ones must be there, once, in 32-bit float. -1 with a
 * message otherwise.
 */
static int check_channels(const struct report *r, exr_context_t context, struct contents *c) {
  const exr_attr_chlist_t *list;
  const exr_result_t code = r->api->exr_get_channels(context, 0, &list);
  if (code != EXR_ERR_SUCCESS)
    return fail_library(r, code, "no list of channels");
  memset(c, 0, sizeof *c);
  for (int i = 0; i < list->num_channels; ++i) {
    const int plane = shade_dump_channel_plane(list->entries[i].name.str);
    const int light = (plane - SHADE_DUMP_BASE) / SHADE_DUMP_PER_LIGHT;
    if (plane >= SHADE_DUMP_BASE && plane < SHADE_DUMP_OPTIONAL && light >= c->lights)
      c->lights = light + 1;
  }
  const int count = plane_count(c->lights);
  char *seen = calloc((size_t)(count + OPTIONAL_PLANES), 1);
  if (!seen)
    return fail(r, "out of memory");
  int status = 0;
  for (int i = 0; status == 0 && i < list->num_channels; ++i) {
    const exr_attr_chlist_entry_t *channel = &list->entries[i];
    const int plane = shade_dump_channel_plane(channel->name.str);
    if (plane < 0)
      continue;
    char *mark = &seen[plane < SHADE_DUMP_OPTIONAL ? plane : count + plane - SHADE_DUMP_OPTIONAL];
    if (channel->pixel_type != EXR_PIXEL_FLOAT)
      status = fail(r, "channel %s is not 32-bit float", channel->name.str);
    else if (channel->x_sampling != 1 || channel->y_sampling != 1)
      status = fail(r, "channel %s is subsampled", channel->name.str);
    else if (*mark)
      status = fail(r, "channel %s appears twice", channel->name.str);
    *mark = 1;
    c->planes++;
    if (plane >= SHADE_DUMP_OPTIONAL)
      c->optional |= bit_of(plane);
  }
  c->has_color = seen[SHADE_DUMP_COLOR] || seen[SHADE_DUMP_COLOR + 1] || seen[SHADE_DUMP_COLOR + 2];
  for (int plane = 0; status == 0 && plane < count; ++plane) {
    char name[SHADE_DUMP_NAME_SIZE];
    shade_dump_channel_name(plane, name);
    if (!seen[plane] && (c->has_color || !is_color(plane)))
      status = fail(r, "not a dump: channel %s is missing", name);
  }
  free(seen);
  return status == 0 ? optional_planes_are_whole(r, c->optional) : status;
}

/*
 * ZIP packs 1032 bytes into one at the very best (RFC 1951), so a file whose
 * header promises more is broken, and would make us allocate without end.
 */
static int check_size(const struct report *r, int64_t width, int64_t height,
                      const struct contents *c) {
  const double best_ratio = 1100;
  long long size = 0;
  if (shade_port_look(r->path, &size) == SHADE_PORT_NONE)
    return fail(r, "cannot read: %s", strerror(errno));
  const double bytes = 4.0 * (double)width * (double)height * c->planes;
  if (bytes > best_ratio * (double)size)
    return fail(r, "truncated or corrupt: %lld bytes cannot hold %d x %d pixels with %d lights",
                size, (int)width, (int)height, c->lights);
  return 0;
}

static int read_json(const struct report *r, exr_context_t context, shade_dump *d) {
  const exr_attribute_t *attribute;
  if (r->api->exr_get_attribute_by_name(context, 0, JSON_ATTRIBUTE, &attribute) !=
          EXR_ERR_SUCCESS ||
      attribute->type != EXR_ATTR_STRING)
    return fail(r, "not a dump: no string attribute \"" JSON_ATTRIBUTE "\" in the header");
  const char *text = attribute->string->str;
  const size_t length = (size_t)attribute->string->length;
  if (memchr(text, 0, length))
    return fail(r, "attribute \"" JSON_ATTRIBUTE "\" holds a zero byte");
  return set_json(d, text, length) == 0 ? 0 : fail(r, "out of memory");
}

static int read_pixels(const struct report *r, exr_context_t context, const shade_dump *d,
                       int first_row) {
  const struct shade_exr_api *api = r->api;
  exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
  exr_chunk_info_t chunk;
  exr_result_t code = EXR_ERR_SUCCESS;
  for (int y = 0; code == EXR_ERR_SUCCESS && y < d->height; y += chunk.height) {
    code = api->exr_read_scanline_chunk_info(context, 0, first_row + y, &chunk);
    if (code != EXR_ERR_SUCCESS)
      break;
    if (chunk.width != d->width || chunk.height < 1 || chunk.height > d->height - y) {
      code = EXR_ERR_CORRUPT_CHUNK;
      break;
    }
    code = y == 0 ? api->exr_decoding_initialize(context, 0, &chunk, &pipeline)
                  : api->exr_decoding_update(context, 0, &chunk, &pipeline);
    if (code != EXR_ERR_SUCCESS)
      break;
    for (int i = 0; i < pipeline.channel_count; ++i) {
      exr_coding_channel_info_t *channel = &pipeline.channels[i];
      const int plane = shade_dump_channel_plane(channel->channel_name);
      if (plane < 0)
        continue; /* left NULL: passed over */
      channel->decode_to_ptr =
          (uint8_t *)(shade_dump_plane(d, plane) + (size_t)y * (size_t)d->width);
      channel->user_pixel_stride = (int32_t)sizeof(float);
      channel->user_line_stride = (int32_t)sizeof(float) * d->width;
    }
    if (y == 0)
      code = api->exr_decoding_choose_default_routines(context, 0, &pipeline);
    if (code == EXR_ERR_SUCCESS)
      code = api->exr_decoding_run(context, 0, &pipeline);
  }
  api->exr_decoding_destroy(context, &pipeline);
  return code == EXR_ERR_SUCCESS ? 0 : fail_library(r, code, "truncated or corrupt");
}

static shade_dump *read_context(const struct report *r, exr_context_t context) {
  exr_attr_box2i_t window;
  struct contents contents;
  if (check_layout(r, context) != 0 || check_channels(r, context, &contents) != 0)
    return NULL;
  const exr_result_t code = r->api->exr_get_data_window(context, 0, &window);
  if (code != EXR_ERR_SUCCESS) {
    fail_library(r, code, "no data window");
    return NULL;
  }
  const int64_t width = (int64_t)window.max.x - window.min.x + 1;
  const int64_t height = (int64_t)window.max.y - window.min.y + 1;
  if (width < 1 || width > SHADE_DUMP_MAX_SIDE || height < 1 || height > SHADE_DUMP_MAX_SIDE) {
    fail(r, "not a dump: %lld x %lld pixels, expected 1 to %d a side", (long long)width,
         (long long)height, SHADE_DUMP_MAX_SIDE);
    return NULL;
  }
  if (check_size(r, width, height, &contents) != 0)
    return NULL;
  shade_dump *d = shade_dump_create((int)width, (int)height, contents.lights);
  if (!d) {
    fail(r, "out of memory");
    return NULL;
  }
  d->has_color = contents.has_color;
  d->optional = contents.optional;
  if (read_json(r, context, d) == 0 && read_pixels(r, context, d, window.min.y) == 0)
    return d;
  shade_dump_free(d);
  return NULL;
}

shade_dump *shade_dump_read(const struct shade_exr_api *api, const char *path, char *error,
                            size_t error_size) {
  const struct report r = {api, path, error, error_size};
  const exr_context_initializer_t options = context_options();
  exr_context_t context = NULL;
  if (shade_port_look(path, NULL) == SHADE_PORT_FOLDER) {
    fail(&r, "is a folder, not a dump");
    return NULL;
  }
  char *name = shade_port_full_name(path);
  const exr_result_t code =
      name ? api->exr_start_read(&context, name, &options) : EXR_ERR_OUT_OF_MEMORY;
  free(name);
  if (code != EXR_ERR_SUCCESS) {
    fail_library(&r, code, "cannot read");
    return NULL;
  }
  shade_dump *d = read_context(&r, context);
  api->exr_finish(&context);
  return d;
}
