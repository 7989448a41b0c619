/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Calls functions without arguments of a module for Windows, where there is no Python:
 * test_windows_render.py makes a python3.dll that hands texts through. module_host.exe MODULE
 * NAME... */
#include <stdio.h>
#include <string.h>
#include <windows.h>

/* As CPython has them since 3.0. */
typedef struct method {
  const char *name;
  char *(*call)(void *self, void *unused);
  int flags;
  const char *doc;
} method;
typedef struct definition {
  void *base[5];
  const char *name, *doc;
  long long size;
  method *methods;
} definition;

int main(int argc, char **argv) {
  const HMODULE module = argc > 1 ? LoadLibraryA(argv[1]) : NULL;
  const FARPROC init = module ? GetProcAddress(module, "PyInit__native") : NULL;
  if (!init) {
    printf("error %lu of Windows\n", GetLastError());
    return 1;
  }
  const definition *d = ((definition * (*)(void))(void (*)(void))init)();
  for (int i = 2; i < argc; i++)
    for (const method *m = d->methods; m->name; m++)
      if (strcmp(m->name, argv[i]) == 0)
        puts(m->call(NULL, NULL));
  return 0;
}
