/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "port/files.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32

#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>

#include "port/wide.h"

/* What Windows says, in C's numbers. */
static void set_errno(void) {
  switch (GetLastError()) {
  case ERROR_FILE_NOT_FOUND:
  case ERROR_PATH_NOT_FOUND:
  case ERROR_INVALID_NAME:
  case ERROR_BAD_PATHNAME:
  case ERROR_INVALID_DRIVE:
    errno = ENOENT;
    break;
  case ERROR_ACCESS_DENIED:
  case ERROR_SHARING_VIOLATION:
  case ERROR_LOCK_VIOLATION:
  case ERROR_WRITE_PROTECT:
    errno = EACCES;
    break;
  case ERROR_FILE_EXISTS:
  case ERROR_ALREADY_EXISTS:
    errno = EEXIST;
    break;
  case ERROR_DISK_FULL:
  case ERROR_HANDLE_DISK_FULL:
    errno = ENOSPC;
    break;
  case ERROR_NOT_ENOUGH_MEMORY:
  case ERROR_OUTOFMEMORY:
    errno = ENOMEM;
    break;
  default:
    errno = EIO;
  }
}

wchar_t *shade_port_wide_name(const char *path) {
  enum { MUCH = 200 };
  wchar_t *given = shade_port_wide(path);
  if (!given)
    return NULL;
  const DWORD room = GetFullPathNameW(given, 0, NULL, NULL);
  if (room < MUCH || !wcsncmp(given, L"\\\\?\\", 4) || !wcsncmp(given, L"\\\\.\\", 4))
    return given;
  wchar_t *name = malloc((room + 8) * sizeof *name);
  if (name) {
    wchar_t *full = name + 8; /* what is put before it is shorter */
    GetFullPathNameW(given, room, full, NULL);
    const int share = full[0] == L'\\' && full[1] == L'\\';
    const wchar_t *before = share ? L"\\\\?\\UNC" : L"\\\\?\\";
    wcscpy(name, before);
    full += share; /* \\server becomes \\?\UNC\server */
    memmove(name + wcslen(before), full, (wcslen(full) + 1) * sizeof *full);
  } else
    errno = ENOMEM;
  free(given);
  return name;
}

FILE *shade_port_open(const char *path, const char *mode) {
  wchar_t *name = shade_port_wide_name(path), *how = shade_port_wide(mode);
  FILE *file = name && how ? _wfopen(name, how) : NULL;
  if (!file && errno == EACCES && shade_port_look(path, NULL) == SHADE_PORT_FOLDER)
    errno = EISDIR;
  free(name);
  free(how);
  return file;
}

shade_port_kind shade_port_look(const char *path, long long *size) {
  shade_port_kind kind = SHADE_PORT_NONE;
  wchar_t *name = shade_port_wide_name(path);
  if (!name)
    return kind;
  wchar_t full[8] = L"";
  WIN32_FILE_ATTRIBUTE_DATA found;
  if (GetFullPathNameW(name, 8, full, NULL) && !wcsncmp(full, L"\\\\.\\", 4)) /* NUL, CON */
    kind = SHADE_PORT_DEVICE;
  else if (!GetFileAttributesExW(name, GetFileExInfoStandard, &found))
    set_errno();
  else {
    kind = found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY ? SHADE_PORT_FOLDER : SHADE_PORT_FILE;
    if (size)
      *size = (long long)found.nFileSizeHigh << 32 | found.nFileSizeLow;
  }
  free(name);
  return kind;
}

int shade_port_create(const char *path) {
  wchar_t *name = shade_port_wide_name(path);
  const int file =
      name ? _wopen(name, _O_CREAT | _O_EXCL | _O_WRONLY | _O_NOINHERIT, _S_IREAD | _S_IWRITE) : -1;
  free(name);
  return file < 0 ? -1 : _close(file);
}

int shade_port_rename(const char *from, const char *to) {
  enum { TRIES = 20, PAUSE = 10 }; /* ms: what looks for viruses has a new file open for a while */
  wchar_t *old = shade_port_wide_name(from), *wanted = shade_port_wide_name(to);
  int moved = 0;
  for (int i = 0; old && wanted && !moved && i < TRIES; i++) {
    moved = MoveFileExW(old, wanted, MOVEFILE_REPLACE_EXISTING) != 0;
    if (!moved) {
      set_errno();
      if (errno != EACCES)
        break;
      Sleep(PAUSE);
    }
  }
  free(old);
  free(wanted);
  return moved ? 0 : -1;
}

int shade_port_remove(const char *path) {
  wchar_t *name = shade_port_wide_name(path);
  const int gone = name && DeleteFileW(name);
  if (name && !gone)
    set_errno();
  free(name);
  return gone ? 0 : -1;
}

char *shade_port_full_name(const char *path) {
  wchar_t *name = shade_port_wide_name(path);
  char *full = name ? shade_port_narrow(name) : NULL;
  free(name);
  return full;
}

char *shade_port_end_of_links(const char *path) {
  wchar_t *name = shade_port_wide_name(path);
  char *end = NULL;
  const DWORD is = name ? GetFileAttributesW(name) : INVALID_FILE_ATTRIBUTES;
  if (is != INVALID_FILE_ATTRIBUTES && is & FILE_ATTRIBUTE_REPARSE_POINT) {
    const HANDLE there =
        CreateFileW(name, 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, NULL,
                    OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL);
    const DWORD room =
        there == INVALID_HANDLE_VALUE ? 0 : GetFinalPathNameByHandleW(there, NULL, 0, 0);
    wchar_t *to = room ? malloc(room * sizeof *to) : NULL;
    if (to && GetFinalPathNameByHandleW(there, to, room, 0) < room)
      end = shade_port_narrow(to);
    free(to);
    if (there != INVALID_HANDLE_VALUE)
      CloseHandle(there);
  }
  if (name && !end) /* no link, or one that leads nowhere */
    end = shade_port_narrow(name);
  free(name);
  return end;
}

long shade_port_process(void) {
  return (long)GetCurrentProcessId();
}

#else

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

FILE *shade_port_open(const char *path, const char *mode) {
  return fopen(path, mode);
}

shade_port_kind shade_port_look(const char *path, long long *size) {
  struct stat found;
  if (stat(path, &found) != 0)
    return SHADE_PORT_NONE;
  if (size)
    *size = (long long)found.st_size;
  return S_ISDIR(found.st_mode)   ? SHADE_PORT_FOLDER
         : S_ISREG(found.st_mode) ? SHADE_PORT_FILE
                                  : SHADE_PORT_DEVICE;
}

int shade_port_create(const char *path) {
  const int file = open(path, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  return file < 0 ? -1 : close(file);
}

int shade_port_rename(const char *from, const char *to) {
  return rename(from, to);
}

int shade_port_remove(const char *path) {
  return unlink(path);
}

char *shade_port_full_name(const char *path) {
  char *name = malloc(strlen(path) + 1);
  return name ? strcpy(name, path) : NULL;
}

char *shade_port_end_of_links(const char *path) {
  enum { MOST = 40 }; /* as Linux */
  char *name = shade_port_full_name(path);
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

long shade_port_process(void) {
  return (long)getpid();
}

#endif
