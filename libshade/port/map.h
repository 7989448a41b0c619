/* SPDX-License-Identifier: Apache-2.0 */
/* A file as memory that is read only. */
#ifndef SHADE_PORT_MAP_H
#define SHADE_PORT_MAP_H

#include <stddef.h>

/* All of a file. NULL with errno where it cannot be read or is no plain file, and with errno 0
 * where it is empty. */
void *shade_port_map(const char *path, size_t *size);
void shade_port_unmap(void *map, size_t size);

#endif
