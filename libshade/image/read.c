/* SPDX-License-Identifier: Apache-2.0 */
/* Finds and loads the module that reads pictures. */
#include "image/read.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "port/files.h"
#include "port/process.h"

/* The module's path beside the program or in ../libexec/shade; 0 if it is in neither. */
static int find_module(char *path, size_t size) {
  static const char *const places[] = {"", "/../libexec/shade"};
  char folder[4096];
  if (shade_port_program_folder(folder, sizeof folder) != 0)
    return 0;
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    const int written = snprintf(path, size, "%s%s/shade_image_oiio%s", folder, places[i],
                                 shade_port_module_ending);
    if (written > 0 && (size_t)written < size && shade_port_look(path, NULL) == SHADE_PORT_FILE)
      return 1;
  }
  return 0;
}

int shade_image_read(const char *path, int most, shade_picture *picture, char *error,
                     size_t error_size) {
  static shade_oiio_read_function *read_picture;
  memset(picture, 0, sizeof *picture);
  /* OpenImageIO's own message for a missing file depends on the format it guesses */
  const shade_port_kind there = shade_port_look(path, NULL);
  if (there == SHADE_PORT_NONE || there == SHADE_PORT_FOLDER) {
    snprintf(error, error_size, "%s: cannot read: %s", path,
             there == SHADE_PORT_NONE ? strerror(errno) : "is a folder");
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
    char why[512];
    void *address = shade_port_module_symbol(module, "shade_oiio_read", why, sizeof why);
    if (!address) {
      snprintf(error, error_size, "%s: cannot load the reader of pictures: %s", path, why);
      return -1;
    }
    memcpy(&read_picture, &address, sizeof address);
  }
  return read_picture(path, most, picture, error, error_size);
}
