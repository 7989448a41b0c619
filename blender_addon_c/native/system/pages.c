/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* madvise, fstatfs */
#include "system/pages.h"

#if defined(_WIN32) || defined(__APPLE__)

/* These give all memory a place in files of their own. */
void *pages_new(size_t bytes) {
  (void)bytes;
  return NULL;
}

void pages_leave(void *block, size_t bytes) {
  (void)block, (void)bytes;
}

size_t pages_resident(void) {
  return 0;
}

void pages_free(void *block, size_t bytes) {
  (void)block, (void)bytes;
}

#else

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

enum { LARGE = 64 << 20, MEMORY_DISK = 0x01021994 }; /* tmpfs */

static int nameless_file(void) {
  const char *folder = getenv("TMPDIR");
  char path[4096];
  int length =
      snprintf(path, sizeof path, "%s/libshade-XXXXXX", folder && *folder ? folder : "/tmp");
  if (length < 0 || (size_t)length >= sizeof path)
    return -1;
  int file = mkostemp(path, O_CLOEXEC);
  if (file >= 0)
    unlink(path);
  return file;
}

void *pages_new(size_t bytes) {
  if (bytes < LARGE)
    return NULL;
  int file = nameless_file();
  if (file < 0)
    return NULL;
  struct statfs disk;
  void *block = MAP_FAILED;
  /* room now: a disk that is full later would end the process */
  if (!fstatfs(file, &disk) && disk.f_type != MEMORY_DISK &&
      !posix_fallocate(file, 0, (off_t)bytes))
    block = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  return block == MAP_FAILED ? NULL : block;
}

void pages_leave(void *block, size_t bytes) {
  madvise(block, bytes, MADV_DONTNEED);
}

size_t pages_resident(void) {
  char text[128];
  int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  ssize_t length = file < 0 ? 0 : read(file, text, sizeof text - 1);
  unsigned long pages = 0;
  if (file >= 0)
    close(file);
  text[length > 0 ? length : 0] = '\0';
  return sscanf(text, "%*u %*u %lu", &pages) == 1 ? pages * (size_t)sysconf(_SC_PAGESIZE) : 0;
}

void pages_free(void *block, size_t bytes) {
  munmap(block, bytes);
}

#endif
