/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "dump/whole.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Where the links of that name end, whether a file is there or not. NULL: errno says why. */
static char *end_of_links(const char *path) {
  enum { MOST = 40 }; /* as Linux */
  char *name = malloc(strlen(path) + 1);
  if (name)
    strcpy(name, path);
  for (int links = 0; name; links++) {
    char to[PATH_MAX];
    const ssize_t length = readlink(name, to, sizeof to);
    if (length < 0) /* no link */
      return name;
    if (links == MOST || length == (ssize_t)sizeof to) {
      free(name);
      errno = links == MOST ? ELOOP : ENAMETOOLONG;
      return NULL;
    }
    const char *slash = to[0] == '/' ? NULL : strrchr(name, '/');
    const size_t folder = slash ? (size_t)(slash + 1 - name) : 0;
    char *next = malloc(folder + (size_t)length + 1);
    if (next) {
      memcpy(next, name, folder);
      memcpy(next + folder, to, (size_t)length);
      next[folder + (size_t)length] = 0;
    }
    free(name);
    name = next;
  }
  return NULL;
}

int shade_whole_begin(shade_whole *w, const char *path, char *error, size_t size) {
  struct stat there;
  *w = (shade_whole){NULL, NULL};
  if (stat(path, &there) == 0 && !S_ISREG(there.st_mode)) {
    snprintf(error, size, "cannot write: is a %s",
             S_ISDIR(there.st_mode) ? "folder" : "device or pipe, not a file");
    return -1;
  }
  w->path = end_of_links(path);
  const size_t length = w->path ? strlen(w->path) + 64 : 0;
  w->temporary = w->path ? malloc(length) : NULL;
  int file = -1;
  for (int attempt = 0; w->path && w->temporary && file < 0 && attempt < 100; attempt++) {
    snprintf(w->temporary, length, "%s.%ld-%d.tmp", w->path, (long)getpid(), attempt);
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
