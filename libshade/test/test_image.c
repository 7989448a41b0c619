/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/* Pictures as files: values come back, bad requests are refused, nothing is left half. */
#define _POSIX_C_SOURCE 200809L
#include "test/support.h"

#include <openexr.h>
#include <png.h>
#include <string.h>

#include "image/image.h"
#include "test/posix.h"

static char folder[] = "/tmp/shade-image-XXXXXX";

static const char *in_folder(const char *name) {
  static char path[256];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  return path;
}

static int files_in_folder(void) {
  DIR *d = opendir(folder);
  int count = 0;
  for (struct dirent *e = readdir(d); e; e = readdir(d))
    count += e->d_name[0] != '.';
  closedir(d);
  return count;
}

static int files_before;

static int set_up(void **state) {
  (void)state;
  files_before = next_file();
  return mkdtemp(folder) ? 0 : -1;
}

static int tear_down(void **state) {
  (void)state;
  return rmdir(folder);
}

enum { W = 37, H = 41 };

/* distinct in every sample, with what does not fit at the ends */
static float sample(int i, int count) {
  return -0.25F + 1.5F * (float)i / (float)(count - 1);
}

static void png_holds_what_was_written(void **state) {
  (void)state;
  enum { CHANNELS = 3, COUNT = W * H * CHANNELS };
  float *pixels = malloc(COUNT * sizeof *pixels);
  for (int i = 0; i < COUNT; i++)
    pixels[i] = sample(i, COUNT);
  pixels[COUNT / 2] = NAN;
  char error[256];
  const shade_image_spec spec = {
      .width = W, .height = H, .channels = CHANNELS, .type = SHADE_IMAGE_U8, .note = "a note"};
  const char *path = in_folder("a.PNG");
  assert_int_equal(shade_image_write(path, &spec, pixels, error, sizeof error), 0);
  assert_int_equal(files_in_folder(), 1);
  png_image image = {.version = PNG_IMAGE_VERSION};
  assert_true(png_image_begin_read_from_file(&image, path));
  assert_int_equal(image.width, W);
  assert_int_equal(image.height, H);
  assert_int_equal(PNG_IMAGE_SAMPLE_CHANNELS(image.format), CHANNELS);
  unsigned char *got = malloc(COUNT);
  image.format = PNG_FORMAT_RGB;
  assert_true(png_image_finish_read(&image, NULL, got, 0, NULL));
  for (int i = 0; i < COUNT; i++) {
    const double want = isnan(pixels[i]) ? 0 : fmin(fmax((double)pixels[i], 0), 1) * 255;
    assert_true(fabs(got[i] - want) <= 0.5 + 1e-4);
  }
  free(got);
  free(pixels);
  char bytes[512];
  FILE *file = fopen(path, "rb");
  const size_t length = fread(bytes, 1, sizeof bytes, file);
  fclose(file);
  int notes = 0;
  for (size_t i = 0; i + 6 <= length; i++)
    notes += !memcmp(bytes + i, "a note", 6);
  assert_int_equal(notes, 1);
  unlink(path);
}

/* Planes of an EXR's only part, in the order of the file's channels, through OpenEXRCore. */
static float *read_exr(const char *path, int channels, exr_pixel_type_t type) {
  exr_context_t context;
  exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
  assert_int_equal(exr_start_read(&context, path, &options), EXR_ERR_SUCCESS);
  float *pixels = malloc((size_t)(W * H * channels) * sizeof *pixels);
  exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
  exr_chunk_info_t chunk;
  for (int y = 0; y < H; y += chunk.height) {
    assert_int_equal(exr_read_scanline_chunk_info(context, 0, y, &chunk), EXR_ERR_SUCCESS);
    if (y == 0)
      assert_int_equal(exr_decoding_initialize(context, 0, &chunk, &pipeline), EXR_ERR_SUCCESS);
    else
      assert_int_equal(exr_decoding_update(context, 0, &chunk, &pipeline), EXR_ERR_SUCCESS);
    assert_int_equal(pipeline.channel_count, channels);
    for (int c = 0; c < channels; c++) {
      assert_int_equal(pipeline.channels[c].data_type, type);
      pipeline.channels[c].decode_to_ptr = (uint8_t *)(pixels + (c * H + y) * W);
      pipeline.channels[c].user_data_type = EXR_PIXEL_FLOAT;
      pipeline.channels[c].user_bytes_per_element = 4;
      pipeline.channels[c].user_pixel_stride = 4;
      pipeline.channels[c].user_line_stride = 4 * W;
    }
    if (y == 0)
      assert_int_equal(exr_decoding_choose_default_routines(context, 0, &pipeline),
                       EXR_ERR_SUCCESS);
    assert_int_equal(exr_decoding_run(context, 0, &pipeline), EXR_ERR_SUCCESS);
  }
  exr_decoding_destroy(context, &pipeline);
  exr_finish(&context);
  return pixels;
}

/* Names out of alphabetical order, rows in pieces that do not match the file's chunks. */
static void check_exr(shade_image_type type, double tolerance) {
  enum { CHANNELS = 3, COUNT = W * H * CHANNELS };
  static const char *const names[CHANNELS] = {"u", "height", "mean.v"};
  static const int place[CHANNELS] = {2, 0, 1}; /* in the file: height, mean.v, u */
  float *pixels = malloc(COUNT * sizeof *pixels);
  for (int i = 0; i < COUNT; i++)
    pixels[i] = 100 * sample(i, COUNT);
  pixels[4] = 1e6f; /* what half cannot hold becomes the largest that it can */
  pixels[8] = -1e6f;
  char error[256];
  const shade_image_spec spec = {
      .width = W, .height = H, .channels = CHANNELS, .names = names, .type = type};
  const char *path = in_folder("a.exr");
  shade_image_writer *w = shade_image_open(path, &spec, error, sizeof error);
  assert_non_null(w);
  for (int y = 0; y < H;) {
    const int count = y % 5 + 1 < H - y ? y % 5 + 1 : H - y;
    assert_int_equal(shade_image_rows(w, pixels + y * W * CHANNELS, count, error, sizeof error), 0);
    y += count;
  }
  assert_int_equal(shade_image_rows(w, pixels, 1, error, sizeof error), -1); /* one too many */
  assert_int_equal(shade_image_close(w, error, sizeof error), 0);
  float *got =
      read_exr(path, CHANNELS, type == SHADE_IMAGE_HALF ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT);
  for (int i = 0; i < W * H; i++)
    for (int c = 0; c < CHANNELS; c++) {
      const double most = type == SHADE_IMAGE_HALF ? 65504 : 1e30;
      const double want = fmin(fmax((double)pixels[i * CHANNELS + c], -most), most);
      assert_near((double)got[place[c] * W * H + i], want, tolerance * fabs(want));
    }
  free(got);
  free(pixels);
  unlink(path);
}

static void exr_holds_what_was_written(void **state) {
  (void)state;
  check_exr(SHADE_IMAGE_FLOAT, 0);
  check_exr(SHADE_IMAGE_HALF, 0x1p-11);
}

static void refused(const char *path, shade_image_spec spec, const char *why) {
  char error[512] = "";
  assert_null(shade_image_open(path, &spec, error, sizeof error));
  if (!strstr(error, why) || !strstr(error, path))
    fail_msg("'%s' does not name '%s' and '%s'", error, path, why);
  assert_int_equal(files_in_folder(), 0);
}

static void bad_requests_are_refused(void **state) {
  (void)state;
  const shade_image_spec good = {.width = W, .height = H, .channels = 3, .type = SHADE_IMAGE_FLOAT};
  shade_image_spec s = good;
  refused(in_folder("a.jpg"), s, ".exr or .png");
  refused(in_folder("exr"), s, ".exr or .png");
  refused(in_folder("no/a.exr"), s, "No such file or directory");
  refused(in_folder("a.png"), s, "8 or 16 bits");
  s.width = 0;
  refused(in_folder("a.exr"), s, "1 to");
  s = good;
  s.height = -3;
  refused(in_folder("a.exr"), s, "1 to");
  s = good;
  s.height = 1 << 20;
  refused(in_folder("a.exr"), s, "1 to");
  s = good;
  s.channels = 0;
  refused(in_folder("a.exr"), s, "channels");
  s.channels = 7;
  refused(in_folder("a.exr"), s, "need names");
  s = good;
  s.type = SHADE_IMAGE_U8;
  refused(in_folder("a.exr"), s, "half and float");
  s.channels = 2;
  refused(in_folder("a.png"), s, "channels");
}

static void a_picture_given_up_leaves_the_old_file(void **state) {
  (void)state;
  const float pixels[4] = {0, 0.25F, 0.5F, 1};
  const shade_image_spec spec = {.width = 2, .height = 2, .channels = 1, .type = SHADE_IMAGE_U16};
  char error[256];
  const char *path = in_folder("old.png");
  assert_int_equal(shade_image_write(path, &spec, pixels, error, sizeof error), 0);
  struct stat before, after;
  stat(path, &before);
  shade_image_writer *w = shade_image_open(path, &spec, error, sizeof error);
  assert_int_equal(shade_image_rows(w, pixels, 1, error, sizeof error), 0);
  assert_int_equal(files_in_folder(), 2);
  shade_image_abandon(w);
  assert_int_equal(files_in_folder(), 1);
  w = shade_image_open(path, &spec, error, sizeof error);
  assert_int_equal(shade_image_rows(w, pixels, 1, error, sizeof error), 0);
  assert_int_equal(shade_image_close(w, error, sizeof error), -1);
  assert_non_null(strstr(error, "1 of 2 rows"));
  assert_int_equal(files_in_folder(), 1);
  stat(path, &after);
  assert_int_equal(before.st_ino, after.st_ino);
  unlink(path);
}

/* Colours are stored as sRGB has them, how much is covered as it is. */
static void png_of_light_has_codes_and_alpha(void **state) {
  (void)state;
  const float pixels[8] = {0.5F, 0.002F, 1, 0.5F, 0, 0.215F, 0.0331F, 0.2F};
  const unsigned char want[8] = {188, 7, 255, 128, 0, 128, 51, 51};
  const shade_image_spec spec = {
      .width = 2, .height = 1, .channels = 4, .type = SHADE_IMAGE_U8, .srgb = 1};
  char error[256];
  const char *path = in_folder("light.png");
  assert_int_equal(shade_image_write(path, &spec, pixels, error, sizeof error), 0);
  png_image image = {.version = PNG_IMAGE_VERSION};
  unsigned char got[8];
  assert_true(png_image_begin_read_from_file(&image, path));
  image.format = PNG_FORMAT_RGBA;
  assert_true(png_image_finish_read(&image, NULL, got, 0, NULL));
  for (int i = 0; i < 8; i++)
    assert_int_equal(got[i], want[i]);
  unlink(path);
}

/* What stands where it would put its unfinished file is someone else's. */
static void a_picture_takes_a_free_name_meanwhile(void **state) {
  (void)state;
  const float pixels[4] = {0, 0.25F, 0.5F, 1};
  const shade_image_spec spec = {.width = 2, .height = 2, .channels = 1, .type = SHADE_IMAGE_U16};
  char error[256], taken[2][320];
  const char *path = in_folder("a.png");
  for (int k = 0; k < 2; k++) {
    snprintf(taken[k], sizeof taken[k], "%s.%ld-%d.tmp", path, (long)getpid(), k);
    fclose(fopen(taken[k], "w"));
  }
  assert_int_equal(shade_image_write(path, &spec, pixels, error, sizeof error), 0);
  assert_int_equal(files_in_folder(), 3);
  for (int k = 0; k < 2; k++) {
    struct stat there;
    assert_int_equal(stat(taken[k], &there), 0);
    assert_int_equal(there.st_size, 0);
    unlink(taken[k]);
  }
  unlink(path);
}

/* The last test: by those before it. */
static void all_files_were_closed(void **state) {
  (void)state;
  assert_int_equal(next_file(), files_before);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(png_holds_what_was_written),
                                     cmocka_unit_test(exr_holds_what_was_written),
                                     cmocka_unit_test(bad_requests_are_refused),
                                     cmocka_unit_test(a_picture_given_up_leaves_the_old_file),
                                     cmocka_unit_test(a_picture_takes_a_free_name_meanwhile),
                                     cmocka_unit_test(png_of_light_has_codes_and_alpha),
                                     cmocka_unit_test(all_files_were_closed)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
