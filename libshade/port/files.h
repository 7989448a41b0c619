/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Files, as each system has them. Names are UTF-8 everywhere, and of any length: on Windows too,
 * where the C library's own functions take neither. What fails says why in errno.
 */
#ifndef SHADE_PORT_FILES_H
#define SHADE_PORT_FILES_H

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* fopen. */
FILE *shade_port_open(const char *path, const char *mode);

/* What is there, or would be reached by a link that is there. NONE: nothing that this process may
 * see. */
typedef enum shade_port_kind {
  SHADE_PORT_NONE,
  SHADE_PORT_FILE,
  SHADE_PORT_FOLDER,
  SHADE_PORT_DEVICE
} shade_port_kind;

/* `size`, in bytes, is that of a file; it may be NULL. */
shade_port_kind shade_port_look(const char *path, long long *size);

/* Create an empty file, of which no child inherits a handle. 0, or -1: also where something is
 * there, with EEXIST. */
int shade_port_create(const char *path);

/* Give a file another name, in the place of what has that name. 0 or -1. */
int shade_port_rename(const char *from, const char *to);

/* Remove a file. 0 or -1. */
int shade_port_remove(const char *path);

/*
 * Where the links of that name end, whether a file is there or not, as other libraries that take
 * UTF-8 can open it. To be freed; NULL when it cannot be told.
 */
char *shade_port_end_of_links(const char *path);

/* That name as other libraries that take UTF-8 can open it. To be freed; NULL when out of memory.
 */
char *shade_port_full_name(const char *path);

/* A number that no other running process has. */
long shade_port_process(void);

#ifdef __cplusplus
}
#endif
#endif
