/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "port/map.h"

#include <errno.h>

#include "port/files.h"

#ifdef _WIN32

#include "port/wide.h"

void *shade_port_map(const char *path, size_t *size) {
  long long length = 0;
  void *map = NULL;
  const shade_port_kind kind = shade_port_look(path, &length);
  if (kind == SHADE_PORT_NONE)
    return NULL;
  errno = kind != SHADE_PORT_FILE ? EINVAL : 0;
  if (kind != SHADE_PORT_FILE || !length)
    return NULL;
  wchar_t *name = shade_port_wide_name(path);
  const HANDLE file = name ? CreateFileW(name, GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_DELETE,
                                         NULL, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, NULL)
                           : INVALID_HANDLE_VALUE;
  const HANDLE mapping = file == INVALID_HANDLE_VALUE
                             ? NULL
                             : CreateFileMappingW(file, NULL, PAGE_READONLY, 0, 0, NULL);
  if (mapping)
    map = MapViewOfFile(mapping, FILE_MAP_READ, 0, 0, 0);
  if (!map)
    errno = file == INVALID_HANDLE_VALUE ? EACCES : ENOMEM;
  *size = (size_t)length;
  if (mapping)
    CloseHandle(mapping);
  if (file != INVALID_HANDLE_VALUE)
    CloseHandle(file);
  free(name);
  return map;
}

void shade_port_unmap(void *map, size_t size) {
  (void)size;
  UnmapViewOfFile(map);
}

#else

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

void *shade_port_map(const char *path, size_t *size) {
  struct stat about;
  void *map = MAP_FAILED;
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0)
    return NULL;
  if (fstat(file, &about) == 0) {
    *size = (size_t)about.st_size;
    errno = S_ISREG(about.st_mode) ? 0 : EINVAL;
    if (!errno && *size)
      map = mmap(NULL, *size, PROT_READ, MAP_PRIVATE, file, 0);
  }
  const int why = errno;
  close(file);
  errno = why;
  return map == MAP_FAILED ? NULL : map;
}

void shade_port_unmap(void *map, size_t size) {
  munmap(map, size);
}

#endif
