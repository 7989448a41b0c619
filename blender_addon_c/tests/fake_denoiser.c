/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What stands in for Open Image Denoise in tests: it turns a picture upside down, adds a quarter of
 * the albedo and of the normal, and asks whether to go on until it is told no, where FAKE_WAITS is
 * set; with FAKE_ERROR it fails by those words.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { COLOR, ALBEDO, NORMAL, OUTPUT, IMAGES };
static const char *const names[IMAGES] = {"color", "albedo", "normal", "output"};
static struct {
  char *data[IMAGES];
  size_t pixel[IMAGES], width, height;
  bool bright, is_cancelled;
  bool (*go_on)(void *, double);
  void *context;
} filter;
int fake_open, fake_threads; /* devices and filters that nobody has released; of the last device */

void *oidnNewDevice(int type) {
  memset(&filter, 0, sizeof filter);
  fake_open++;
  return type == 1 ? &filter : NULL;
}
void oidnSetDeviceInt(void *device, const char *name, int value) {
  (void)device;
  fake_threads = strcmp(name, "numThreads") == 0 ? value : -1;
}
void oidnCommitDevice(void *device) {
  (void)device;
}
int oidnGetDeviceError(void *device, const char **message) {
  (void)device;
  *message = filter.is_cancelled ? "cancelled by the caller" : getenv("FAKE_ERROR");
  return filter.is_cancelled ? 6 : *message ? 4 : 0;
}
void oidnReleaseDevice(void *device) {
  (void)device;
  fake_open--;
}
void *oidnNewFilter(void *device, const char *type) {
  fake_open++;
  return strcmp(type, "RT") == 0 ? device : NULL;
}
void oidnSetSharedFilterImage(void *f, const char *name, void *data, int format, size_t width,
                              size_t height, size_t offset, size_t pixel, size_t row) {
  (void)f, (void)format, (void)row;
  for (int k = 0; k < IMAGES; k++)
    if (strcmp(name, names[k]) == 0) {
      filter.data[k] = (char *)data + offset;
      filter.pixel[k] = pixel ? pixel : 3 * sizeof(float);
    }
  filter.width = width;
  filter.height = height;
}
void oidnSetFilterBool(void *f, const char *name, bool value) {
  (void)f;
  filter.bright = strcmp(name, "hdr") == 0 && value;
}
void oidnSetFilterProgressMonitorFunction(void *f, bool (*go_on)(void *, double), void *context) {
  (void)f;
  filter.go_on = go_on;
  filter.context = context;
}
void oidnCommitFilter(void *f) {
  (void)f;
}
void oidnExecuteFilter(void *f) {
  (void)f;
  while (getenv("FAKE_WAITS") && !filter.is_cancelled) {
    nanosleep(&(struct timespec){0, 1000000}, NULL);
    filter.is_cancelled = !filter.go_on(filter.context, 0.5);
  }
  for (size_t i = 0; !filter.is_cancelled && i < filter.width * filter.height; i++) {
    const size_t row = i / filter.width,
                 from = (filter.height - 1 - row) * filter.width + i % filter.width;
    const float *color = (const float *)(filter.data[COLOR] + from * filter.pixel[COLOR]);
    const float *albedo = (const float *)(filter.data[ALBEDO] + i * filter.pixel[ALBEDO]);
    const float *normal = (const float *)(filter.data[NORMAL] + i * filter.pixel[NORMAL]);
    float *to = (float *)(filter.data[OUTPUT] + i * filter.pixel[OUTPUT]);
    for (int c = 0; c < 3; c++) /* what is not said to be brighter than 1 is cut there */
      to[c] = (filter.bright     ? color[c]
               : color[c] < 1.0f ? color[c]
                                 : 1.0f) +
              0.25f * (albedo[c] + normal[c]);
  }
}
void oidnReleaseFilter(void *f) {
  (void)f;
  fake_open--;
}
