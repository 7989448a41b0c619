/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/denoise.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system/library.h"
#include "system/parallel.h"

/* As in version 2 of the library's C interface. */
typedef struct OIDNDeviceImpl *OIDNDevice;
typedef struct OIDNFilterImpl *OIDNFilter;
enum { OIDN_DEVICE_CPU = 1, OIDN_FLOAT3 = 3, OIDN_CANCELLED = 6 };
typedef bool monitor(void *context, double done);

#define OIDN_FUNCTIONS(F)                                                                          \
  F(OIDNDevice, oidnNewDevice, (int type))                                                         \
  F(void, oidnSetDeviceInt, (OIDNDevice device, const char *name, int value))                      \
  F(void, oidnCommitDevice, (OIDNDevice device))                                                   \
  F(int, oidnGetDeviceError, (OIDNDevice device, const char **message))                            \
  F(void, oidnReleaseDevice, (OIDNDevice device))                                                  \
  F(OIDNFilter, oidnNewFilter, (OIDNDevice device, const char *type))                              \
  F(void, oidnSetSharedFilterImage,                                                                \
    (OIDNFilter filter, const char *name, void *data, int format, size_t width, size_t height,     \
     size_t offset, size_t pixel_stride, size_t row_stride))                                       \
  F(void, oidnSetFilterBool, (OIDNFilter filter, const char *name, bool value))                    \
  F(void, oidnSetFilterProgressMonitorFunction,                                                    \
    (OIDNFilter filter, monitor * tell, void *context))                                            \
  F(void, oidnCommitFilter, (OIDNFilter filter))                                                   \
  F(void, oidnExecuteFilter, (OIDNFilter filter))                                                  \
  F(void, oidnReleaseFilter, (OIDNFilter filter))

#define MEMBER(result, name, arguments) result(*name) arguments;
typedef struct library {
  OIDN_FUNCTIONS(MEMBER)
} library;

static bool load(library *l, const char *path, char *error, size_t error_size) {
  void *opened = path && *path ? library_open(NULL, path, error, error_size) : NULL;
  if (!opened)
    opened = library_open(NULL, library_denoiser, error, error_size);
  if (!opened) {
    snprintf(error, error_size, "Open Image Denoise was not found");
    return false;
  }
  /* POSIX gives functions as void *, C11 has no conversion: copy the bits. */
#define LOAD(result, name, arguments)                                                              \
  {                                                                                                \
    void *symbol = library_symbol(opened, #name);                                                  \
    if (!symbol) {                                                                                 \
      snprintf(error, error_size, "Open Image Denoise has no " #name ": version 2 is needed");     \
      return false;                                                                                \
    }                                                                                              \
    memcpy(&l->name, &symbol, sizeof symbol);                                                      \
  }
  OIDN_FUNCTIONS(LOAD)
  return true;
}

static bool go_on(void *cancel, double done) {
  (void)done;
  return !atomic_load_explicit((atomic_bool *)cancel, memory_order_relaxed);
}

static void filter(const library *l, OIDNDevice device, const denoise_input *in, float *out,
                   const atomic_bool *cancel) {
  const size_t width = (size_t)in->width, height = (size_t)in->height, three = 3 * sizeof *out;
  OIDNFilter f = l->oidnNewFilter(device, "RT");
  l->oidnSetSharedFilterImage(f, "color", in->color, OIDN_FLOAT3, width, height, 0, 4 * sizeof *out,
                              0);
  /* it only reads these */
  l->oidnSetSharedFilterImage(f, "albedo", (void *)(uintptr_t)in->albedo, OIDN_FLOAT3, width,
                              height, 0, three, 0);
  l->oidnSetSharedFilterImage(f, "normal", (void *)(uintptr_t)in->normal, OIDN_FLOAT3, width,
                              height, 0, three, 0);
  l->oidnSetSharedFilterImage(f, "output", out, OIDN_FLOAT3, width, height, 0, three, 0);
  l->oidnSetFilterBool(f, "hdr", true);
  l->oidnSetFilterProgressMonitorFunction(f, go_on, (void *)(uintptr_t)cancel);
  l->oidnCommitFilter(f);
  l->oidnExecuteFilter(f);
  l->oidnReleaseFilter(f);
}

bool denoise_run(const denoise_input *in, const char *path, const atomic_bool *cancel, char *error,
                 size_t error_size) {
  library l;
  const char *told = "";
  size_t pixels = (size_t)in->width * (size_t)in->height;
  error[0] = 0;
  if (!load(&l, path, error, error_size))
    return false;
  float *out = malloc(3 * pixels * sizeof *out + 1);
  OIDNDevice device = out ? l.oidnNewDevice(OIDN_DEVICE_CPU) : NULL;
  if (!device) {
    snprintf(error, error_size, "Open Image Denoise does not start on this machine");
    free(out);
    return false;
  }
  l.oidnSetDeviceInt(device, "numThreads", in->threads);
  l.oidnCommitDevice(device);
  filter(&l, device, in, out, cancel);
  int wrong = l.oidnGetDeviceError(device, &told);
  if (wrong && wrong != OIDN_CANCELLED)
    snprintf(error, error_size, "Open Image Denoise: %s", told ? told : "it failed");
  for (size_t i = 0; !wrong && i < pixels; i++)
    memcpy(in->color + 4 * i, out + 3 * i, 3 * sizeof *out);
  l.oidnReleaseDevice(device);
  free(out);
  return !wrong;
}

/* ---- without a library */

enum { LEVELS_FIRST = 5, LEVELS = 3 }; /* of one sample a pixel; of more, which need less */
/* Where colours, surfaces' colours and normals differ by so much (squared) a neighbour has half its
 * weight; of colours by their brightness, and less from level to level. */
static const float color_scale = 0.4f, calmer = 0.55f, albedo_scale = 0.02f, normal_scale = 0.05f;

typedef struct wavelet {
  const denoise_input *in;
  const float *from;
  float *to;
  int step;
  float scale; /* of colours */
} wavelet;

static float brightness(const float *c) {
  return 0.3f * c[0] + 0.6f * c[1] + 0.1f * c[2];
}

static float distance2(const float *a, const float *b) {
  float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}

/* No pixel is brighter than the second brightest of its eight neighbours: a lone one is chance. */
static void calm_row(void *context, size_t y) {
  const wavelet *w = context;
  const int width = w->in->width, height = w->in->height;
  for (int x = 0; x < width; x++) {
    const float *own = w->in->color + 4 * ((size_t)width * y + (size_t)x);
    float first = 0.0f, second = 0.0f, light = brightness(own);
    for (int k = 0; k < 9; k++) {
      const int i = x + k % 3 - 1, j = (int)y + k / 3 - 1;
      if (k == 4 || i < 0 || j < 0 || i >= width || j >= height)
        continue;
      const float other = brightness(w->in->color + 4 * ((size_t)width * (size_t)j + (size_t)i));
      second = other > first ? first : other > second ? other : second;
      first = other > first ? other : first;
    }
    const float scale = light > second && width > 2 && height > 2 ? second / light : 1.0f;
    for (int c = 0; c < 3; c++)
      w->to[3 * ((size_t)width * y + (size_t)x) + (size_t)c] = own[c] * scale;
  }
}

static void wavelet_row(void *context, size_t y) {
  static const float kernel[3] = {0.25f, 0.5f, 0.25f};
  const wavelet *w = context;
  const int width = w->in->width, height = w->in->height;
  for (int x = 0; x < width; x++) {
    const size_t at = 3 * ((size_t)width * y + (size_t)x);
    const float light = brightness(w->from + at), *normal = w->in->normal + at;
    float sum[3] = {0}, all = 0.0f;
    const bool nothing = normal[0] == 0 && normal[1] == 0 && normal[2] == 0; /* but the world */
    for (int k = 0; k < 9 && !nothing; k++) {
      const int i = x + (k % 3 - 1) * w->step, j = (int)y + (k / 3 - 1) * w->step;
      if (i < 0 || j < 0 || i >= width || j >= height)
        continue;
      const size_t there = 3 * ((size_t)width * (size_t)j + (size_t)i);
      const float other = brightness(w->from + there), mean = light + other + 1e-3f;
      const float apart = (light - other) * (light - other) / (mean * mean * w->scale) +
                          distance2(w->in->albedo + at, w->in->albedo + there) / albedo_scale +
                          distance2(w->in->normal + at, w->in->normal + there) / normal_scale;
      const float weight = kernel[k % 3] * kernel[k / 3] / (1.0f + apart * apart);
      for (int c = 0; c < 3; c++)
        sum[c] += weight * w->from[there + (size_t)c];
      all += weight;
    }
    for (int c = 0; c < 3; c++)
      w->to[at + (size_t)c] = all > 0.0f ? sum[c] / all : w->from[at + (size_t)c];
  }
}

bool denoise_simply(const denoise_input *in) {
  const size_t pixels = (size_t)in->width * (size_t)in->height, height = (size_t)in->height;
  const int threads = in->threads > 0 ? in->threads : parallel_cores();
  float *first = malloc(3 * pixels * sizeof *first + 1);
  float *second = malloc(3 * pixels * sizeof *second + 1);
  const bool good = first && second;
  const int levels = in->samples > 1 ? LEVELS : LEVELS_FIRST;
  wavelet w = {.in = in, .from = second, .to = first, .step = 1, .scale = color_scale};
  if (good) {
    parallel_for(threads, height, calm_row, &w);
    for (int level = 0; level < levels; level++, w.step *= 2, w.scale *= calmer) {
      const float *made = w.to;
      w.to = level % 2 ? first : second;
      w.from = made;
      parallel_for(threads, height, wavelet_row, &w);
    }
    for (size_t i = 0; i < pixels; i++)
      memcpy(in->color + 4 * i, w.to + 3 * i, 3 * sizeof *w.to);
  }
  free(second);
  free(first);
  return good;
}
