/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* dladdr, RTLD_DEEPBIND */
#include "system/library.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <wchar.h>
#include <windows.h>
#else
#include <dlfcn.h>
#endif

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ADDRESS_SANITIZER 1
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define ADDRESS_SANITIZER 1
#endif

/* AddressSanitizer's allocator and a deeply bound library's would mix. */
#if defined(ADDRESS_SANITIZER)
#define SCOPE 0
#else
#define SCOPE RTLD_DEEPBIND
#endif

#ifdef _WIN32

/* A DLL's names are its own: no scope to keep apart. What it needs is looked for beside it first,
 * and by names of ours. */
static void *open_one(const wchar_t *name, const char *shown, char *error, size_t error_size) {
  void *library =
      LoadLibraryExW(name, NULL, wcschr(name, L'\\') ? LOAD_WITH_ALTERED_SEARCH_PATH : 0);
  const size_t used = strlen(error);
  if (!library)
    snprintf(error + used, error_size - used, "%s %s: error %lu of Windows",
             used ? "; nor" : "cannot load", shown, GetLastError());
  return library;
}

void *library_open(const char *own, const char *system, char *error, size_t error_size) {
  wchar_t path[32768];
  HMODULE self;
  void *library = NULL;
  static const char anchor = 0; /* its address is inside this module */
  error[0] = '\0';
  if (own && GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS |
                                    GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
                                (const wchar_t *)&anchor, &self)) {
    const DWORD most = sizeof path / sizeof *path, length = GetModuleFileNameW(self, path, most);
    wchar_t *end = length && length < most ? wcsrchr(path, L'\\') : NULL;
    if (end && swprintf(end, most - (size_t)(end - path), L"\\lib\\%hs", own) > 0)
      library = open_one(path, own, error, error_size);
  }
  wchar_t name[256];
  if (!library && swprintf(name, sizeof name / sizeof *name, L"%hs", system) > 0)
    library = open_one(name, system, error, error_size);
  if (library)
    error[0] = '\0';
  return library;
}

void *library_symbol(void *library, const char *name) {
  return (void *)(uintptr_t)GetProcAddress(library, name);
}

#else

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
    int length = snprintf(path, sizeof path, "%.*s/lib/%s", folder, self.dli_fname, own);
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
