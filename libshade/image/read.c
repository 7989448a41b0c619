/* SPDX-License-Identifier: Apache-2.0 */
/* Finds and loads the module that reads pictures. */
#define _POSIX_C_SOURCE 200809L
#include "image/read.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MODULE "shade_image_oiio.so"

/* The module's path beside the program or in ../libexec/shade; 0 if it is in neither. */
static int find_module(char *path, size_t size) {
  static const char *const places[] = {"/" MODULE, "/../libexec/shade/" MODULE};
  char program[4096];
  const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
  if (length <= 0)
    return 0;
  program[length] = 0;
  char *slash = strrchr(program, '/');
  if (!slash)
    return 0;
  *slash = 0;
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    const int written = snprintf(path, size, "%s%s", program, places[i]);
    if (written > 0 && (size_t)written < size && access(path, R_OK) == 0)
      return 1;
  }
  return 0;
}

int shade_image_read(const char *path, int most, shade_picture *picture, char *error,
                     size_t error_size) {
  static shade_oiio_read_function *read_picture;
  struct stat file;
  memset(picture, 0, sizeof *picture);
  /* OpenImageIO's own message for a missing file depends on the format it guesses */
  const int missing = stat(path, &file) != 0;
  if (missing || S_ISDIR(file.st_mode)) {
    snprintf(error, error_size, "%s: cannot read: %s", path,
             missing ? strerror(errno) : "is a folder");
    return -1;
  }
  if (!read_picture) {
    char module[4200];
    if (!find_module(module, sizeof module)) {
      snprintf(error, error_size,
               "%s: this `shade` was built without OpenImageIO; install Debian's packages g++ and "
               "libopenimageio-dev and run make again",
               path);
      return -1;
    }
    void *handle = dlopen(module, RTLD_NOW | RTLD_LOCAL);
    void *address = handle ? dlsym(handle, "shade_oiio_read") : NULL;
    if (!address) {
      snprintf(error, error_size, "%s: cannot load the reader of pictures: %s", path, dlerror());
      return -1;
    }
    memcpy(&read_picture, &address, sizeof address);
  }
  return read_picture(path, most, picture, error, error_size);
}
