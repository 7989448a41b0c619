/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 1.8 */
/* Dumps: what is written comes back, whatever the order of channels; what is not a dump does not.
 */
#define _POSIX_C_SOURCE 200809L
#include "dump/dump.h"
#include "tool/json.h"
#include "dump/dump_exr.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "test/posix.h"
#ifndef _WIN32
#include <dlfcn.h>
#include <signal.h>
#include <sys/resource.h>
#endif

enum { WIDTH = 37, HEIGHT = 53, LIGHTS = 12 }; /* light10 sorts before light2 */

static char folder[] = "/tmp/shade-test-dump-XXXXXX";
static char path[sizeof folder + 32];
static char error[512];
static int files_before;

static int planes(const shade_dump *d) {
  return SHADE_DUMP_BASE + SHADE_DUMP_PER_LIGHT * d->lights;
}

/* First planes of the optional channels, and the end. */
static const int optional[] = {
    SHADE_DUMP_ALPHA, SHADE_DUMP_GROOVE, SHADE_DUMP_F82,         SHADE_DUMP_ETA,  SHADE_DUMP_K,
    SHADE_DUMP_KD,    SHADE_DUMP_FOOT,   SHADE_DUMP_COVERAGE,    SHADE_DUMP_TIER, SHADE_DUMP_LOBE2,
    SHADE_DUMP_LOBE3, SHADE_DUMP_SLOPES, SHADE_DUMP_OPTIONAL_END};
enum { OPTIONAL = sizeof optional / sizeof *optional - 1 };

/* A value of its own for every plane and pixel, exact in float. */
static float value(int plane, int pixel) {
  return (float)plane + (float)pixel / 4096;
}

static shade_dump *sample_of(int width, int height, int lights) {
  shade_dump *d = shade_dump_create(width, height, lights);
  assert_non_null(d);
  for (int plane = 0; plane < planes(d); ++plane)
    for (int i = 0; i < width * height; ++i)
      shade_dump_plane(d, plane)[i] = value(plane, i);
  assert_int_equal(shade_dump_set_json(d, "{\"materials\": []}"), 0);
  return d;
}

static shade_dump *sample(int lights) {
  return sample_of(WIDTH, HEIGHT, lights);
}

static int files_in_folder(void) {
  DIR *directory = opendir(folder);
  int count = 0;
  for (struct dirent *entry; (entry = readdir(directory));)
    count += entry->d_name[0] != '.';
  closedir(directory);
  return count;
}

static void test_create(void **state) {
  (void)state;
  assert_null(shade_dump_create(0, 1, 1));
  assert_null(shade_dump_create(1, -1, 1));
  assert_null(shade_dump_create(1, 1, -1));
  assert_null(shade_dump_create(65537, 1, 1));
  assert_null(shade_dump_create(1, 1, 1 << 30));
  shade_dump *d = shade_dump_create(2, 3, 1);
  assert_true(d->has_color);
  for (int i = 0; i < 6; ++i) {
    assert_true(shade_dump_plane(d, SHADE_DUMP_MATERIAL)[i] == -1);
    assert_true(shade_dump_light_plane(d, 0, SHADE_DUMP_S + 2)[i] == 0);
  }
  shade_dump_free(d);
  shade_dump_free(NULL);
}

static void test_channel_names(void **state) {
  (void)state;
  char name[SHADE_DUMP_NAME_SIZE];
  for (int plane = 0; plane < SHADE_DUMP_BASE + SHADE_DUMP_PER_LIGHT * 120; ++plane) {
    shade_dump_channel_name(plane, name);
    assert_int_equal(shade_dump_channel_plane(name), plane);
  }
  for (int plane = SHADE_DUMP_OPTIONAL; plane < SHADE_DUMP_OPTIONAL_END; ++plane) {
    shade_dump_channel_name(plane, name);
    assert_int_equal(shade_dump_channel_plane(name), plane);
  }
  const struct {
    const char *name;
    int plane;
  } known[] = {{"alpha.Y", SHADE_DUMP_ALPHA + 1},
               {"groove.A", SHADE_DUMP_GROOVE},
               {"f82.G", SHADE_DUMP_F82 + 1},
               {"eta.B", SHADE_DUMP_ETA + 2},
               {"k.R", SHADE_DUMP_K},
               {"kd.B", SHADE_DUMP_KD + 2},
               {"foot.V", SHADE_DUMP_FOOT + 1},
               {"coverage.A", SHADE_DUMP_COVERAGE},
               {"tier", SHADE_DUMP_TIER},
               {"slopes.XY", SHADE_DUMP_SLOPES + 3}};
  for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
    assert_int_equal(shade_dump_channel_plane(known[i].name), known[i].plane);
  assert_int_equal(shade_dump_channel_plane("Ns.Z"), SHADE_DUMP_NS + 2);
  assert_int_equal(shade_dump_channel_plane("material.ID"), SHADE_DUMP_MATERIAL);
  assert_int_equal(shade_dump_channel_plane("light10.S.G"),
                   SHADE_DUMP_BASE + 10 * SHADE_DUMP_PER_LIGHT + SHADE_DUMP_S + 1);
  const char *unknown[] = {
      "",           "R",           "N",           "light.L.X",      "light-1.L.X",
      "light1.L.R", "light01.L.X", "light 1.L.X", "light99999.L.X", "light1.L.XX",
      "light1L.X",  "n.X"};
  for (size_t i = 0; i < sizeof unknown / sizeof *unknown; ++i)
    assert_int_equal(shade_dump_channel_plane(unknown[i]), -1);
}

static void check_round_trip(const struct shade_exr_api *api, int lights, int has_color) {
  shade_dump *d = sample(lights);
  d->has_color = has_color;
  if (shade_dump_write(api, path, d, error, sizeof error) != 0)
    fail_msg("%s", error);
  assert_int_equal(files_in_folder(), 1);
  shade_dump *back = shade_dump_read(api, path, error, sizeof error);
  if (!back)
    fail_msg("%s", error);
  assert_int_equal(back->width, WIDTH);
  assert_int_equal(back->height, HEIGHT);
  assert_int_equal(back->lights, lights);
  assert_int_equal(back->has_color, has_color);
  assert_string_equal(back->json, d->json);
  for (int plane = 0; plane < planes(d); ++plane)
    if (has_color || plane < SHADE_DUMP_COLOR || plane >= SHADE_DUMP_BASE)
      assert_memory_equal(shade_dump_plane(back, plane), shade_dump_plane(d, plane),
                          WIDTH * HEIGHT * sizeof(float));
  shade_dump_free(back);
  shade_dump_free(d);
  unlink(path);
}

static void test_round_trip(void **state) {
  (void)state;
  check_round_trip(shade_exr_api_linked(), LIGHTS, 1);
  check_round_trip(shade_exr_api_linked(), 0, 1);
}

static void test_without_color(void **state) {
  (void)state;
  check_round_trip(shade_exr_api_linked(), 1, 0);
}

/* Each channel alone, and all. */
static void test_optional(void **state) {
  (void)state;
  for (int only = 0; only <= OPTIONAL; ++only) {
    shade_dump *d = sample(2);
    for (int k = 0; k < OPTIONAL; ++k)
      if (k == only || only == OPTIONAL) {
        assert_ptr_equal(shade_dump_add(d, (enum shade_dump_optional)optional[k]),
                         shade_dump_plane(d, optional[k]));
        for (int plane = optional[k]; plane < optional[k + 1]; ++plane)
          for (int i = 0; i < WIDTH * HEIGHT; ++i)
            shade_dump_plane(d, plane)[i] = value(plane - SHADE_DUMP_OPTIONAL + 500, i);
      }
    if (shade_dump_write(shade_exr_api_linked(), path, d, error, sizeof error) != 0)
      fail_msg("%s", error);
    shade_dump *back = shade_dump_read(shade_exr_api_linked(), path, error, sizeof error);
    if (!back)
      fail_msg("%s", error);
    assert_int_equal(back->lights, 2);
    for (int k = 0; k < OPTIONAL; ++k) {
      const int there = k == only || only == OPTIONAL;
      assert_int_equal(shade_dump_has(back, (enum shade_dump_optional)optional[k]), there);
      for (int plane = optional[k]; plane < optional[k + 1]; ++plane)
        for (int i = 0; i < WIDTH * HEIGHT; ++i)
          assert_true(shade_dump_plane(back, plane)[i] ==
                      (there ? value(plane - SHADE_DUMP_OPTIONAL + 500, i) : 0));
    }
    for (int plane = 0; plane < planes(d); ++plane)
      assert_memory_equal(shade_dump_plane(back, plane), shade_dump_plane(d, plane),
                          WIDTH * HEIGHT * sizeof(float));
    shade_dump_free(back);
    shade_dump_free(d);
    unlink(path);
  }
}

/* One component of a channel without the others is no dump. */
static void test_half_a_channel(void **state) {
  (void)state;
  for (int k = 0; k < OPTIONAL; ++k)
    for (int plane = optional[k]; plane < optional[k + 1]; ++plane) {
      shade_dump *d = sample(1);
      shade_dump_add(d, (enum shade_dump_optional)optional[k]);
      d->optional &= ~((uint64_t)1 << (plane - SHADE_DUMP_OPTIONAL));
      assert_int_equal(shade_dump_write(shade_exr_api_linked(), path, d, error, sizeof error), 0);
      shade_dump_free(d);
      d = shade_dump_read(shade_exr_api_linked(), path, error, sizeof error);
      if (optional[k + 1] - optional[k] == 1) {
        assert_non_null(d);
      } else {
        char name[SHADE_DUMP_NAME_SIZE];
        shade_dump_channel_name(plane, name);
        assert_null(d);
        assert_non_null(strstr(error, name));
      }
      shade_dump_free(d);
      unlink(path);
    }
}

#ifndef _WIN32
static void *look_up(void *context, const char *name) {
  return dlsym(context, name);
}
static void *look_up_nothing(void *context, const char *name) {
  (void)name;
  return context;
}

static void test_loaded_library(void **state) {
  (void)state;
  struct shade_exr_api *api = shade_exr_api_load(look_up, RTLD_DEFAULT, error, sizeof error);
  assert_non_null(api);
  check_round_trip(api, 2, 1);
  free(api);
  assert_null(shade_exr_api_load(look_up_nothing, NULL, error, sizeof error));
  assert_non_null(strstr(error, "exr_"));
}
#endif

static void test_write_failures(void **state) {
  (void)state;
  shade_dump *d = sample(1);
  assert_int_equal(
      shade_dump_write(shade_exr_api_linked(), "/nonexistent/x.exr", d, error, sizeof error), -1);
  assert_non_null(strstr(error, "/nonexistent/x.exr"));
  /* A folder in the way: the rename fails and nothing is left behind. */
  assert_int_equal(shade_dump_write(shade_exr_api_linked(), folder, d, error, sizeof error), -1);
  assert_int_equal(files_in_folder(), 0);
  shade_dump_free(d);
}

static exr_result_t finish_badly(exr_context_t *context) {
  exr_finish(context);
  return EXR_ERR_FILE_ACCESS;
}

static exr_result_t encode_badly(exr_const_context_t context, int part, exr_encode_pipeline_t *p) {
  (void)context, (void)part, (void)p;
  return EXR_ERR_OUT_OF_MEMORY;
}

static exr_result_t head_badly(exr_context_t context) {
  (void)context;
  return EXR_ERR_MISSING_REQ_ATTR;
}

/* A file that the library could not write whole takes no other's place. */
static void test_what_the_library_cannot_write(void **state) {
  (void)state;
  struct shade_exr_api bad[3] = {*shade_exr_api_linked(), *shade_exr_api_linked(),
                                 *shade_exr_api_linked()};
  const char *const says[] = {"cannot finish the file", "cannot write pixels",
                              "cannot write the header"};
  bad[0].exr_finish = finish_badly;
  bad[1].exr_encoding_run = encode_badly;
  bad[2].exr_write_header = head_badly;
  shade_dump *d = sample(1);
  assert_int_equal(shade_dump_write(shade_exr_api_linked(), path, d, error, sizeof error), 0);
  for (int k = 0; k < 3; ++k) {
    assert_int_equal(shade_dump_write(&bad[k], path, d, error, sizeof error), -1);
    assert_non_null(strstr(error, says[k]));
    assert_int_equal(files_in_folder(), 1);
    shade_dump *old = shade_dump_read(shade_exr_api_linked(), path, error, sizeof error);
    assert_non_null(old);
    shade_dump_free(old);
  }
  shade_dump_free(d);
  unlink(path);
}

#ifndef _WIN32
/* The disk fills up: the old file survives, nothing is left behind. */
static void test_disk_full(void **state) {
  (void)state;
  FILE *old = fopen(path, "w");
  fputs("old", old);
  fclose(old);
  shade_dump *d = sample(4);
  struct rlimit before, limit;
  getrlimit(RLIMIT_FSIZE, &before);
  limit = before;
  signal(SIGXFSZ, SIG_IGN);
  const rlim_t sizes[] = {10, 1000, 5000, 20000};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
    limit.rlim_cur = sizes[i];
    setrlimit(RLIMIT_FSIZE, &limit);
    int status = shade_dump_write(shade_exr_api_linked(), path, d, error, sizeof error);
    setrlimit(RLIMIT_FSIZE, &before);
    assert_int_equal(status, -1);
    assert_non_null(strstr(error, path));
    assert_int_equal(files_in_folder(), 1);
    char text[8] = "";
    old = fopen(path, "r");
    assert_non_null(fgets(text, sizeof text, old));
    fclose(old);
    assert_string_equal(text, "old");
  }
  signal(SIGXFSZ, SIG_DFL);
  shade_dump_free(d);
  unlink(path);
}
#endif

/* ---- files that other programs might write ---------------------------------- */

struct variant {
  exr_storage_t storage;
  exr_compression_t compression;
  exr_pixel_type_t type;
  int lights, missing_plane, parts;
  const char *json;     /* NULL: no attribute */
  const char *extra[2]; /* more channels, NULL: none */
  const char *says;     /* part of the message; NULL: it can be read */
};

/* Every channel holds value(plane, pixel). Returns the number of rows written. */
static int write_chunk(exr_context_t context, exr_storage_t storage, int part, int y) {
  exr_chunk_info_t chunk;
  if (storage == EXR_STORAGE_DEEP_SCANLINE) { /* no sample in any pixel */
    const int32_t samples[WIDTH] = {0};
    assert_int_equal(
        exr_write_deep_scanline_chunk(context, part, y, samples, 0, 0, samples, sizeof samples), 0);
    return 1;
  }
  if (storage == EXR_STORAGE_TILED)
    assert_int_equal(exr_write_tile_chunk_info(context, part, 0, 0, 0, 0, &chunk), 0);
  else
    assert_int_equal(exr_write_scanline_chunk_info(context, part, y, &chunk), 0);
  exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
  assert_int_equal(exr_encoding_initialize(context, part, &chunk, &pipeline), 0);
  const size_t size = (size_t)chunk.height * WIDTH;
  float *pixels = malloc((size_t)pipeline.channel_count * size * sizeof *pixels);
  assert_non_null(pixels);
  for (int i = 0; i < pipeline.channel_count; ++i) {
    exr_coding_channel_info_t *channel = &pipeline.channels[i];
    float *mine = pixels + (size_t)i * size;
    for (size_t j = 0; j < size; ++j)
      mine[j] = value(shade_dump_channel_plane(channel->channel_name), y * WIDTH + (int)j);
    channel->encode_from_ptr = (const uint8_t *)mine;
    if (channel->data_type != EXR_PIXEL_UINT) { /* no conversion exists: the bits go as they are */
      channel->user_data_type = EXR_PIXEL_FLOAT;
      channel->user_bytes_per_element = 4;
    }
    channel->user_pixel_stride = 4;
    channel->user_line_stride = 4 * WIDTH;
  }
  assert_int_equal(exr_encoding_choose_default_routines(context, part, &pipeline), 0);
  assert_int_equal(exr_encoding_run(context, part, &pipeline), 0);
  assert_int_equal(exr_encoding_destroy(context, &pipeline), 0);
  free(pixels);
  return chunk.height;
}

static void write_variant(const struct variant *v) {
  exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
  exr_context_t context;
  const int count = SHADE_DUMP_BASE + SHADE_DUMP_PER_LIGHT * v->lights;
  assert_int_equal(exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &options), 0);
  for (int part = 0; part < v->parts; ++part) {
    int index;
    assert_int_equal(exr_add_part(context, part ? "b" : "a", v->storage, &index), 0);
    assert_int_equal(
        exr_initialize_required_attr_simple(context, part, WIDTH, HEIGHT, v->compression), 0);
    if (v->storage == EXR_STORAGE_TILED)
      assert_int_equal(
          exr_set_tile_descriptor(context, part, 64, 64, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN),
          0);
    if (v->json)
      assert_int_equal(exr_attr_set_string(context, part, "libshade", v->json), 0);
    for (int plane = count - 1; plane >= 0; --plane) {
      char name[SHADE_DUMP_NAME_SIZE];
      shade_dump_channel_name(plane, name);
      if (plane != v->missing_plane)
        assert_int_equal(
            exr_add_channel(context, part, name, v->type, EXR_PERCEPTUALLY_LINEAR, 1, 1), 0);
    }
    for (int i = 0; i < 2; ++i)
      if (v->extra[i])
        assert_int_equal(exr_add_channel(context, part, v->extra[i], EXR_PIXEL_HALF,
                                         EXR_PERCEPTUALLY_LINEAR, 1, 1),
                         0);
  }
  assert_int_equal(exr_write_header(context), 0);
  for (int part = 0; part < v->parts; ++part)
    for (int y = 0; y < HEIGHT;)
      y += write_chunk(context, v->storage, part, y);
  assert_int_equal(exr_finish(&context), 0);
}

static void check_variant(const struct variant *v) {
  write_variant(v);
  shade_dump *d = shade_dump_read(shade_exr_api_linked(), path, error, sizeof error);
  if (v->says) {
    assert_null(d);
    if (!strstr(error, v->says) || !strstr(error, path))
      fail_msg("\"%s\" does not say \"%s\"", error, v->says);
  } else {
    if (!d)
      fail_msg("%s", error);
    for (int plane = 0; plane < planes(d); ++plane)
      for (int i = 0; i < WIDTH * HEIGHT; ++i)
        assert_true(shade_dump_plane(d, plane)[i] == value(plane, i));
  }
  shade_dump_free(d);
  unlink(path);
}

#define PLAIN                                                                                      \
  .storage = EXR_STORAGE_SCANLINE, .compression = EXR_COMPRESSION_ZIP, .type = EXR_PIXEL_FLOAT,    \
  .lights = 2, .missing_plane = -1, .parts = 1, .json = "{}"

static void test_variants(void **state) {
  (void)state;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Woverride-init"
  const struct variant variants[] = {
      {PLAIN},
      {PLAIN, .compression = EXR_COMPRESSION_NONE},
      {PLAIN, .compression = EXR_COMPRESSION_ZIPS},
      {PLAIN, .extra = {"A", "zz.depth"}},
      {PLAIN, .extra = {"A", "zz.depth"}, .compression = EXR_COMPRESSION_NONE},
      {PLAIN, .compression = EXR_COMPRESSION_PIZ, .says = "compression"},
      {PLAIN, .compression = EXR_COMPRESSION_B44, .says = "compression"},
      {PLAIN, .type = EXR_PIXEL_HALF, .says = "is not 32-bit float"},
      {PLAIN, .type = EXR_PIXEL_UINT, .says = "is not 32-bit float"},
      {PLAIN, .storage = EXR_STORAGE_TILED, .says = "tiled or deep"},
      {PLAIN, .storage = EXR_STORAGE_DEEP_SCANLINE, .compression = EXR_COMPRESSION_NONE,
       .says = "tiled or deep"},
      {PLAIN, .parts = 2, .says = "2 parts"},
      {PLAIN, .json = NULL, .says = "libshade"},
      {PLAIN, .missing_plane = SHADE_DUMP_NS + 1, .says = "Ns.Y is missing"},
      {PLAIN, .missing_plane = SHADE_DUMP_COLOR + 2, .says = "Color.B is missing"},
      {PLAIN, .missing_plane = SHADE_DUMP_BASE + 4, .says = "light0.E.G is missing"},
  };
#pragma GCC diagnostic pop
  for (size_t i = 0; i < sizeof variants / sizeof *variants; ++i)
    check_variant(&variants[i]);
}

static void test_not_exr(void **state) {
  (void)state;
  assert_null(shade_dump_read(shade_exr_api_linked(), path, error, sizeof error));
  assert_non_null(strstr(error, path));
  const char *contents[] = {"", "v", "not an OpenEXR file at all", "\x76\x2f\x31\x01\x02"};
  for (size_t i = 0; i < sizeof contents / sizeof *contents; ++i) {
    FILE *file = fopen(path, "w");
    fputs(contents[i], file);
    fclose(file);
    assert_null(shade_dump_read(shade_exr_api_linked(), path, error, sizeof error));
    assert_non_null(strstr(error, path));
  }
  unlink(path);
  assert_null(shade_dump_read(shade_exr_api_linked(), folder, error, sizeof error));
}

/* However wrong the files were, this process never grew. */
static void check_memory(void) {
#ifndef _WIN32
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  assert_true(usage.ru_maxrss < 512 * 1024); /* KiB */
#endif
}

/* A header that promises a huge picture gets no memory. */
static void test_huge_promise(void **state) {
  (void)state;
  struct {
    int width, height;
  } sizes[] = {{60000, 60000}, {1 << 30, 1}, {1, 1 << 30}, {65536, 65536}};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
    shade_dump *d = sample(1);
    assert_int_equal(shade_dump_write(shade_exr_api_linked(), path, d, error, sizeof error), 0);
    shade_dump_free(d);
    char bytes[4096];
    FILE *file = fopen(path, "r+b");
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    size_t at = 0;
    while (at + 64 < size && memcmp(bytes + at, "dataWindow\0box2i", 17) != 0)
      ++at;
    assert_true(at + 64 < size);
    const int32_t window[4] = {0, 0, sizes[i].width - 1, sizes[i].height - 1};
    fseek(file, (long)at + 17 + 4, SEEK_SET);
    fwrite(window, sizeof window, 1, file);
    fclose(file);
    assert_null(shade_dump_read(shade_exr_api_linked(), path, error, sizeof error));
    assert_non_null(strstr(error, path));
    unlink(path);
  }
  check_memory();
}

static unsigned char *whole_file(size_t *size) {
  static unsigned char bytes[1 << 20];
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  *size = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  assert_true(*size > 0 && *size < sizeof bytes);
  return bytes;
}

/* 1 if it was read. Otherwise there is a message; in either case no crash. */
static int read_bytes(const unsigned char *bytes, size_t size) {
  unlink(path); /* writing over it would wait for the disk */
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  fclose(file);
  error[0] = 0;
  shade_dump *d = shade_dump_read(shade_exr_api_linked(), path, error, sizeof error);
  if (!d)
    assert_non_null(strstr(error, path));
  shade_dump_free(d);
  return d != NULL;
}

/* Cut short anywhere, it is refused; with any byte changed, nothing breaks. */
static void test_damaged(void **state) {
  (void)state;
  shade_dump *d = sample_of(7, 40, 1); /* small, but of three chunks */
  assert_int_equal(shade_dump_write(shade_exr_api_linked(), path, d, error, sizeof error), 0);
  shade_dump_free(d);
  size_t size;
  unsigned char *bytes = whole_file(&size);
  const size_t header = 2048; /* closely up to here, then now and then */
  for (size_t at = 0; at < size; at += at < header ? 1 : 101)
    if (read_bytes(bytes, at))
      fail_msg("read although cut off after %zu of %zu bytes", at, size);
  const unsigned char masks[] = {0x01, 0x80, 0xff};
  for (size_t at = 0; at < size; at += at < header ? 1 : 101)
    for (size_t i = 0; i < sizeof masks; ++i) {
      bytes[at] ^= masks[i];
      read_bytes(bytes, size);
      bytes[at] ^= masks[i];
    }
  assert_true(read_bytes(bytes, size));
  unlink(path);
  check_memory();
}

/* Even planes pack several hundred to one; a dump of them is a dump. */
static void test_even_planes(void **state) {
  (void)state;
  enum { SIDE = 800 };
  shade_dump *d = shade_dump_create(SIDE, SIDE, 1);
  assert_non_null(d);
  for (int plane = 0; plane < planes(d); ++plane)
    for (size_t i = 0; i < SIDE * SIDE; ++i)
      shade_dump_plane(d, plane)[i] = plane == SHADE_DUMP_MATERIAL ? -1 : 0;
  if (shade_dump_write(shade_exr_api_linked(), path, d, error, sizeof error) != 0)
    fail_msg("%s", error);
  struct stat file;
  assert_int_equal(stat(path, &file), 0);
  const double bytes = 4.0 * SIDE * SIDE * planes(d);
  print_message("packed %.0f to one\n", bytes / (double)file.st_size);
  assert_true(bytes / (double)file.st_size > 300);
  shade_dump *back = shade_dump_read(shade_exr_api_linked(), path, error, sizeof error);
  if (!back)
    fail_msg("%s", error);
  assert_int_equal(back->width, SIDE);
  shade_dump_free(back);
  shade_dump_free(d);
  unlink(path);
}

static int make_folder(void **state) {
  (void)state;
  files_before = next_file();
  if (!mkdtemp(folder))
    return -1;
  snprintf(path, sizeof path, "%s/dump.exr", folder);
  return 0;
}

static int remove_folder(void **state) {
  (void)state;
  return rmdir(folder);
}

/* The header as JSON readers take it apart, whatever the renderer and the materials are called. */
static void header_is_json(void **state) {
  (void)state;
  const char *const odd = "a \"b\" \\ c\n\x01 d\xc3\xa9";
  shade_params p[2];
  char error[256];
  for (int i = 0; i < 2; i++)
    shade_params_init(&p[i]);
  shade_params_set_exponents(&p[1], 5, 6);
  const shade_dump_material materials[] = {
      {odd, &p[0], NULL}, {NULL, &p[1], NULL}, {odd, NULL, "{\"id\": 2, \"fabric\": {}}"}};
  char *text = shade_dump_header(odd, materials, 3);
  assert_non_null(text);
  json *header = json_read(text, error, sizeof error);
  if (!header)
    fail_msg("%s in %s", error, text);
  assert_string_equal(json_member(header, "version")->string, SHADE_VERSION);
  assert_string_equal(json_member(header, "renderer")->string, odd);
  const json *first = json_member(header, "materials")->child, *second = first->next,
             *third = second->next;
  assert_null(third->next);
  assert_true(json_member(third, "id")->number == 2 && json_member(third, "fabric") &&
              !json_member(third, "name"));
  assert_string_equal(json_member(first, "name")->string, odd);
  assert_string_equal(json_member(second, "name")->string, "");
  assert_true(json_member(first, "id")->number == 0 && json_member(second, "id")->number == 1);
  assert_true(json_member(second, "ey")->number == 6);
  json_free(header);
  free(text);
  text = shade_dump_header("", NULL, 0);
  header = json_read(text, error, sizeof error);
  assert_non_null(header);
  assert_null(json_member(header, "materials")->child);
  json_free(header);
  free(text);
}

/* The last test: by those before it. */
static void all_files_were_closed(void **state) {
  (void)state;
  assert_int_equal(next_file(), files_before);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(header_is_json),        cmocka_unit_test(test_create),
      cmocka_unit_test(test_channel_names),    cmocka_unit_test(test_round_trip),
      cmocka_unit_test(test_without_color),    cmocka_unit_test(test_write_failures),
      cmocka_unit_test(test_variants),         cmocka_unit_test(test_not_exr),
      cmocka_unit_test(test_huge_promise),     cmocka_unit_test(test_damaged),
      cmocka_unit_test(test_optional),         cmocka_unit_test(test_half_a_channel),
      cmocka_unit_test(test_even_planes),      cmocka_unit_test(test_what_the_library_cannot_write),
#ifndef _WIN32
      cmocka_unit_test(test_loaded_library),   cmocka_unit_test(test_disk_full),
#endif
      cmocka_unit_test(all_files_were_closed),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
