/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene_file.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "port/map.h"
#include "reader.h"
#include "render/build.h"
#include "render/read.h"

enum { VERSION = 1, ALIGNMENT = 64, PREAMBLE = 16 };
static const char MAGIC[] = "shscene\n";

static size_t aligned(size_t size) {
  return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* A fuzzer would find no text with the right one. */
static bool has_checksum(const unsigned char *data, size_t size, double sum) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  (void)data, (void)size, (void)sum;
  return true;
#else
  return sum == (double)crc32_z(0, data, size);
#endif
}

static bool fail(scene_file *f, const char *why) {
  snprintf(f->error, sizeof f->error, "%s", why);
  return false;
}

static bool read_array(reader *r, void *out, void *context) {
  static const scene_array_type types[] = {{"float32", 'f', 4},
                                           {"uint8", 'B', 1},
                                           {"uint16", 'H', 2},
                                           {"int32", 'i', 4},
                                           {"uint32", 'I', 4}};
  static const char *const words[] = {"float32", "uint8", "uint16", "int32", "uint32", NULL};
  scene_file *f = r->file;
  scene_array *array = out;
  size_t *end = context, left = f->array_bytes - *end;
  int type;
  double offset, sum;
  if (!reader_word(r, "type", words, &type) ||
      !reader_shape(r, "shape", left / types[type].size, &array->items) ||
      !reader_number(r, "offset", &offset) || !reader_number(r, "checksum", &sum))
    return false;
  array->type = &types[type];
  size_t size = aligned(array->items * types[type].size);
  if (size > left)
    return reader_expected(r, "shape", "of no more items than the file has");
  if (offset != (double)*end)
    return reader_expected(r, "offset", "where the array before ends");
  array->data = f->array_data + *end;
  *end += size;
  return has_checksum(array->data, size, sum) ||
         reader_expected(r, "checksum", "that of the array");
}

static bool read_pass(reader *r, void *out, void *context) {
  scene_pass *p = out;
  (void)context;
  return reader_text(r, "name", NULL, &p->name) && reader_text(r, "channels", NULL, &p->channels) &&
         ((*p->channels && strlen(p->channels) <= 4) ||
          reader_expected(r, "channels", "one to four letters")) &&
         reader_text(r, "plane", NULL, &p->plane) &&
         reader_number_within(r, "exposure", -1e30, 1e30, &p->exposure);
}

/* Only such as no other part of a header has. */
static bool read_text(reader *r, void *out, void *context) {
  static const char begin[] = "cryptomatte/";
  scene_text *t = out;
  (void)context;
  return reader_text(r, "name", NULL, &t->name) &&
         ((strncmp(t->name, begin, strlen(begin)) == 0 && strlen(t->name) < 256) ||
          reader_expected(r, "name", "\"cryptomatte/\" and more, at most 255 bytes")) &&
         reader_text(r, "text", NULL, &t->text);
}

static bool read_scene(reader *r, void *out, void *context) {
  scene **made = out;
  (void)context;
  return (*made = scene_read(r)) != NULL;
}

static bool read_picture(reader *r, void *out, void *context) {
  scene_picture *p = out;
  const scene_file *f = context;
  if (!reader_text(r, "layer", NULL, &p->layer) ||
      !reader_each(r, "passes", sizeof *p->pass, &p->passes, &p->pass, read_pass, NULL) ||
      !reader_dict(r, "scene", read_scene, &p->scene, NULL))
    return false;
  const scene *s = p->scene, *first = f->picture->scene;
  return (s->width == first->width && s->height == first->height &&
          memcmp(s->region, first->region, sizeof s->region) == 0) ||
         reader_expected(r, "scene", "as large as the first picture's");
}

static bool read_header(scene_file *f, const json *header) {
  reader r = {.dict = header, .file = f};
  int version;
  size_t end = 0;
  if (header->type != JSON_OBJECT)
    return fail(f, "its header must be an object");
  if (!reader_integer(&r, "version", VERSION, VERSION, &version) ||
      (reader_has(&r, "texts") &&
       !reader_each(&r, "texts", sizeof *f->text, &f->texts, &f->text, read_text, NULL)) ||
      !reader_each(&r, "arrays", sizeof *f->array, &f->arrays, &f->array, read_array, &end))
    return false;
  if (end != f->array_bytes)
    return fail(f, "arrays must be all that is behind the header");
  if (!reader_each(&r, "pictures", sizeof *f->picture, &f->pictures, &f->picture, read_picture, f))
    return false;
  return f->pictures || reader_expected(&r, "pictures", "one or more");
}

bool scene_file_read(scene_file *f, const void *data, size_t size) {
  const unsigned char *bytes = data;
  uint32_t words[2]; /* length and checksum of the header */
  char error[160];
  if (size < PREAMBLE || memcmp(bytes, MAGIC, strlen(MAGIC)) != 0)
    return fail(f, "no saved scene: \"shscene\" must be its first line");
  memcpy(words, bytes + strlen(MAGIC), sizeof words);
  size_t length = words[0];
  f->checksum = words[1];
  if (length > size - PREAMBLE || (PREAMBLE + length) % ALIGNMENT)
    return fail(f, "its header must end in the file, at a multiple of 64");
  if (!has_checksum(bytes + PREAMBLE, length, words[1]))
    return fail(f, "its header must have the checksum that is before it");
  f->array_data = bytes + PREAMBLE + length;
  f->array_bytes = size - PREAMBLE - length;
  char *text = malloc(length + 1);
  if (!text)
    return fail(f, "out of memory");
  memcpy(text, bytes + PREAMBLE, length);
  text[length] = 0;
  json *header = strlen(text) == length ? json_read(text, error, sizeof error) : NULL;
  bool good = header && read_header(f, header);
  if (!header)
    snprintf(f->error, sizeof f->error, "its header must be JSON: %s",
             strlen(text) == length ? error : "it has a zero");
  json_free(header);
  free(text);
  return good;
}

bool scene_file_open(scene_file *f, const char *path) {
  f->map = shade_port_map(path, &f->map_size);
  if (f->map)
    return scene_file_read(f, f->map, f->map_size);
  return fail(f, errno ? strerror(errno) : "it is empty");
}

void scene_file_close(scene_file *f) {
  for (size_t k = 0; k < f->pictures; k++) {
    scene_picture *p = &f->picture[k];
    for (size_t i = 0; i < p->passes; i++) {
      free(p->pass[i].name);
      free(p->pass[i].channels);
      free(p->pass[i].plane);
    }
    free(p->pass);
    free(p->layer);
    scene_free(p->scene);
  }
  for (size_t k = 0; k < f->texts; k++) {
    free(f->text[k].name);
    free(f->text[k].text);
  }
  free(f->text);
  free(f->picture);
  free(f->array);
  if (f->map)
    shade_port_unmap(f->map, f->map_size);
  *f = (scene_file){0};
}
