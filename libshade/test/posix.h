/* SPDX-License-Identifier: Apache-2.0 */
/* What tests ask of a system beside C, for their own folders and files; where Windows lacks it,
 * what comes near. */
#ifndef SHADE_TEST_POSIX_H
#define SHADE_TEST_POSIX_H

#include <dirent.h>
#include <sys/stat.h>

#ifdef _WIN32
#include <direct.h>
#include <io.h>
#include <process.h>
#include <stddef.h>

/* The folder of its name, which ends in XXXXXX, is on the drive of the current folder. */
static inline char *mkdtemp(char *name) {
  return _mktemp(name) && _mkdir(name) == 0 ? name : NULL;
}
#else
#include <unistd.h>
#endif

/* The number that the next file to be opened gets: the same again where all were closed. */
static inline int next_file(void) {
  const int file = dup(0);
  close(file);
  return file;
}

#endif
