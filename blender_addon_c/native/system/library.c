/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* dladdr, RTLD_DEEPBIND */
#include "system/library.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32

#include "port/wide.h"

const char library_denoiser[] = "OpenImageDenoise.dll";

/* Of this module's folder, with \\ at its end. To be freed; NULL where it cannot be told. */
static wchar_t *own_folder(void) {
  enum { MOST = 32768 };
  static const char anchor = 0; /* its address is inside this module */
  HMODULE self;
  wchar_t *path = malloc(MOST * sizeof *path);
  const DWORD length = path && GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS |
                                                      GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
                                                  (const wchar_t *)&anchor, &self)
                           ? GetModuleFileNameW(self, path, MOST)
                           : 0;
  wchar_t *slash = length && length < MOST ? wcsrchr(path, L'\\') : NULL;
  if (slash) {
    slash[1] = 0;
    return path;
  }
  free(path);
  return NULL;
}

/* What it needs is looked for beside it first. */
void *library_open(const char *own, const char *system, char *error, size_t error_size) {
  char name[64] = "";
  if (own)
    snprintf(name, sizeof name, "lib\\libshade_%s.dll", own);
  wchar_t *folder = own ? own_folder() : NULL, *wide = shade_port_wide(own ? name : system);
  const size_t before = folder ? wcslen(folder) : 0;
  wchar_t *path = wide ? malloc((before + wcslen(wide) + 1) * sizeof *path) : NULL;
  HMODULE library = NULL;
  error[0] = 0;
  if (path) {
    wcscpy(path, folder ? folder : L"");
    wcscpy(path + before, wide);
    for (wchar_t *c = path; *c; c++)
      if (*c == L'/') /* LoadLibrary takes no other */
        *c = L'\\';
    library = LoadLibraryExW(path, NULL, wcschr(path, L'\\') ? LOAD_WITH_ALTERED_SEARCH_PATH : 0);
  }
  if (!library) {
    const unsigned long code = GetLastError();
    char *shown = path ? shade_port_narrow(path) : NULL;
    snprintf(error, error_size, "cannot load %s: error %lu of Windows", shown ? shown : name, code);
    free(shown);
  }
  free(path);
  free(wide);
  free(folder);
  return library;
}

void *library_symbol(void *library, const char *name) {
  return (void *)(uintptr_t)GetProcAddress(library, name);
}

#else

#include <dlfcn.h>

#ifdef __APPLE__
#define ENDING ".dylib"
const char library_denoiser[] = "libOpenImageDenoise.2.dylib";
#else
#define ENDING ".so"
const char library_denoiser[] = "libOpenImageDenoise.so.2";
#endif

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ADDRESS_SANITIZER 1
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define ADDRESS_SANITIZER 1
#endif

/* AddressSanitizer's allocator and a deeply bound library's would mix. On macOS each library names
 * the one that it has a symbol from. */
#if defined(ADDRESS_SANITIZER) || defined(__APPLE__)
#define SCOPE 0
#else
#define SCOPE RTLD_DEEPBIND
#endif

/* NULL, and why at the end of the message so far. */
static void *open_one(const char *name, char *error, size_t error_size) {
  void *library = dlopen(name, RTLD_NOW | RTLD_LOCAL | SCOPE);
  const char *reason = library ? NULL : dlerror();
  const size_t used = strlen(error);
  if (!library)
    snprintf(error + used, error_size - used, "%s %s", used ? "; nor" : "cannot load",
             reason ? reason : name);
  return library;
}

void *library_open(const char *own, const char *system, char *error, size_t error_size) {
  char path[4096];
  Dl_info self;
  void *library = NULL;
  static const char anchor = 0; /* its address is inside this module */
  error[0] = '\0';
  if (own && dladdr(&anchor, &self) && self.dli_fname && strrchr(self.dli_fname, '/')) {
    int folder = (int)(strrchr(self.dli_fname, '/') - self.dli_fname);
    int length =
        snprintf(path, sizeof path, "%.*s/lib/libshade_%s" ENDING, folder, self.dli_fname, own);
    if (length > 0 && (size_t)length < sizeof path)
      library = open_one(path, error, error_size);
  }
  if (!library)
    library = open_one(system, error, error_size);
  if (library)
    error[0] = '\0';
  return library;
}

void *library_symbol(void *library, const char *name) {
  return dlsym(library, name);
}

#endif
