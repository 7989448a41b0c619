/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "port/process.h"

#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32

#include <fcntl.h>
#include <io.h>

#include "port/wide.h"
#include <shellapi.h>

const char shade_port_module_ending[] = ".dll";

static UINT codes_before; /* of the terminal, which outlives this process */

static void restore_codes(void) {
  SetConsoleOutputCP(codes_before);
}

static int is_console(DWORD which) {
  DWORD mode;
  return GetConsoleMode(GetStdHandle(which), &mode) != 0;
}

void shade_port_begin(int *count, char ***arguments) {
  int wide_count = 0;
  wchar_t **wide = CommandLineToArgvW(GetCommandLineW(), &wide_count);
  char **made = wide ? calloc((size_t)wide_count + 1, sizeof *made) : NULL;
  int i = 0;
  while (made && i < wide_count && (made[i] = shade_port_narrow(wide[i])))
    i++;
  if (made && i == wide_count) { /* for as long as the process lives */
    *count = wide_count;
    *arguments = made;
  }
  LocalFree(wide);
  _setmode(0, _O_BINARY);
  _setmode(1, _O_BINARY);
  _setmode(2, _O_BINARY);
  if (is_console(STD_OUTPUT_HANDLE) || is_console(STD_ERROR_HANDLE)) {
    codes_before = GetConsoleOutputCP();
    if (codes_before && SetConsoleOutputCP(CP_UTF8))
      atexit(restore_codes);
    DWORD mode; /* \033[K of progress */
    if (GetConsoleMode(GetStdHandle(STD_ERROR_HANDLE), &mode))
      SetConsoleMode(GetStdHandle(STD_ERROR_HANDLE), mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
  }
}

int shade_port_is_terminal(int stream) { /* _isatty says so of NUL, too */
  return is_console(stream == 1 ? STD_OUTPUT_HANDLE : STD_ERROR_HANDLE);
}

void shade_port_on_stop(void (*handler)(int)) {
  signal(SIGINT, handler);
  signal(SIGTERM, handler);
  signal(SIGBREAK, handler);
}

int shade_port_set_variable(const char *name, const char *value) {
  return _putenv_s(name, value ? value : "") ? -1 : 0;
}

int shade_port_program_folder(char *path, size_t size) {
  enum { MOST = 32768 };
  wchar_t *wide = malloc(MOST * sizeof *wide);
  const DWORD length = wide ? GetModuleFileNameW(NULL, wide, MOST) : 0;
  char *name = length && length < MOST ? shade_port_narrow(wide) : NULL;
  free(wide);
  char *slash = name ? strrchr(name, '\\') : NULL;
  int status = -1;
  if (slash) {
    *slash = 0;
    for (char *c = name; *c; c++)
      if (*c == '\\')
        *c = '/';
    if (strlen(name) < size) {
      strcpy(path, name);
      status = 0;
    }
  }
  free(name);
  return status;
}

void *shade_port_module_symbol(const char *path, const char *name, char *error, size_t size) {
  wchar_t *wide = shade_port_wide(path);
  for (wchar_t *c = wide; c && *c; c++)
    if (*c == L'/') /* LoadLibrary takes no other */
      *c = L'\\';
  HMODULE module = wide ? LoadLibraryExW(wide, NULL, LOAD_WITH_ALTERED_SEARCH_PATH) : NULL;
  void *address = module ? (void *)(uintptr_t)GetProcAddress(module, name) : NULL;
  if (!address)
    snprintf(error, size, "error %lu of Windows", GetLastError());
  free(wide);
  return address;
}

long long shade_port_line(char **line, size_t *capacity, FILE *file) {
  size_t length = 0;
  for (int c = 0; c != '\n' && (c = getc(file)) != EOF;) {
    if (length + 2 > *capacity) {
      const size_t more = *capacity ? 2 * *capacity : 128;
      char *grown = realloc(*line, more);
      if (!grown)
        return -1;
      *line = grown;
      *capacity = more;
    }
    (*line)[length++] = (char)c;
  }
  if (!length)
    return -1;
  (*line)[length] = 0;
  return (long long)length;
}

#else

#include <dlfcn.h>
#include <unistd.h>
#ifdef __APPLE__
#include <mach-o/dyld.h>
#endif

const char shade_port_module_ending[] = ".so";

void shade_port_begin(int *count, char ***arguments) {
  (void)count;
  (void)arguments;
}

int shade_port_is_terminal(int stream) {
  return isatty(stream);
}

void shade_port_on_stop(void (*handler)(int)) {
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

int shade_port_set_variable(const char *name, const char *value) {
  return value ? setenv(name, value, 1) : unsetenv(name);
}

/* 0, or -1 if it does not fit. */
static int program_name(char *path, size_t size) {
#ifdef __APPLE__
  uint32_t room = (uint32_t)size;
  return _NSGetExecutablePath(path, &room);
#else
  const ssize_t length = readlink("/proc/self/exe", path, size);
  if (length <= 0 || (size_t)length == size)
    return -1;
  path[length] = 0;
  return 0;
#endif
}

int shade_port_program_folder(char *path, size_t size) {
  if (program_name(path, size))
    return -1;
  char *slash = strrchr(path, '/');
  if (!slash)
    return -1;
  *slash = 0;
  return 0;
}

void *shade_port_module_symbol(const char *path, const char *name, char *error, size_t size) {
  void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  void *address = module ? dlsym(module, name) : NULL;
  if (!address)
    snprintf(error, size, "%s", dlerror());
  return address;
}

long long shade_port_line(char **line, size_t *capacity, FILE *file) {
  return getline(line, capacity, file);
}

#endif
