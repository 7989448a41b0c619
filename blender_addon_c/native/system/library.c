/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* dladdr, RTLD_DEEPBIND */
#include "system/library.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

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
