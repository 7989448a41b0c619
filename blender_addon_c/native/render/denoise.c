/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/denoise.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system/library.h"

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
    opened = library_open(NULL, "libOpenImageDenoise.so.2", error, error_size);
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
