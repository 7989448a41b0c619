/* SPDX-License-Identifier: Apache-2.0 */
#include "dump/whole.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "port/files.h"

int shade_whole_begin(shade_whole *w, const char *path, char *error, size_t size) {
  const shade_port_kind there = shade_port_look(path, NULL);
  *w = (shade_whole){NULL, NULL};
  if (there == SHADE_PORT_FOLDER || there == SHADE_PORT_DEVICE) {
    snprintf(error, size, "cannot write: is a %s",
             there == SHADE_PORT_FOLDER ? "folder" : "device or pipe, not a file");
    return -1;
  }
  w->path = shade_port_end_of_links(path);
  const size_t length = w->path ? strlen(w->path) + 64 : 0;
  w->temporary = w->path ? malloc(length) : NULL;
  for (int attempt = 0; w->path && w->temporary && attempt < 100; attempt++) {
    snprintf(w->temporary, length, "%s.%ld-%d.tmp", w->path, shade_port_process(), attempt);
    if (shade_port_create(w->temporary) == 0)
      return 0;
    if (errno != EEXIST)
      break;
  }
  snprintf(error, size, "cannot write: %s", strerror(errno));
  free(w->path);
  free(w->temporary);
  *w = (shade_whole){NULL, NULL};
  return -1;
}

int shade_whole_end(shade_whole *w, int good, char *error, size_t size) {
  if (!w->temporary)
    return 0;
  int status = 0;
  if (good && shade_port_rename(w->temporary, w->path) != 0) {
    snprintf(error, size, "cannot write: %s", strerror(errno));
    status = -1;
  }
  if (!good || status != 0)
    shade_port_remove(w->temporary);
  free(w->path);
  free(w->temporary);
  *w = (shade_whole){NULL, NULL};
  return status;
}

int shade_whole_write(const char *path, const char *text, size_t length, char *error, size_t size) {
  shade_whole w;
  if (shade_whole_begin(&w, path, error, size) != 0)
    return -1;
  if (!text)
    return shade_whole_end(&w, 0, NULL, 0);
  FILE *file = shade_port_open(w.temporary, "wb");
  const int written = file && fwrite(text, 1, length, file) == length;
  if (!file || fclose(file) != 0 || !written) {
    snprintf(error, size, "cannot write: %s", strerror(errno));
    shade_whole_end(&w, 0, NULL, 0);
    return -1;
  }
  return shade_whole_end(&w, 1, error, size);
}
