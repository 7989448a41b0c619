/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "dump/whole.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int shade_whole_begin(shade_whole *w, const char *path, char *error, size_t size) {
  struct stat there;
  *w = (shade_whole){NULL, NULL};
  if (stat(path, &there) == 0 && !S_ISREG(there.st_mode)) {
    snprintf(error, size, "cannot write: is a %s",
             S_ISDIR(there.st_mode) ? "folder" : "device or pipe, not a file");
    return -1;
  }
  const size_t length = strlen(path) + 64;
  w->path = malloc(length);
  w->temporary = malloc(length);
  if (!w->path || !w->temporary)
    errno = ENOMEM;
  int file = -1;
  for (int attempt = 0; w->path && w->temporary && file < 0 && attempt < 100; attempt++) {
    strcpy(w->path, path);
    snprintf(w->temporary, length, "%s.%ld-%d.tmp", path, (long)getpid(), attempt);
    file = open(w->temporary, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (file < 0 && errno != EEXIST)
      break;
  }
  if (file >= 0) {
    close(file);
    return 0;
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
  if (good && rename(w->temporary, w->path) != 0) {
    snprintf(error, size, "cannot write: %s", strerror(errno));
    status = -1;
  }
  if (!good || status != 0)
    unlink(w->temporary);
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
  FILE *file = fopen(w.temporary, "w");
  const int written = file && fwrite(text, 1, length, file) == length;
  if (!file || fclose(file) != 0 || !written) {
    snprintf(error, size, "cannot write: %s", strerror(errno));
    shade_whole_end(&w, 0, NULL, 0);
    return -1;
  }
  return shade_whole_end(&w, 1, error, size);
}
