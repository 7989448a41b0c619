/* SPDX-License-Identifier: Apache-2.0 */
/* Memory that begins at a multiple of 64, a line of a processor's cache. */
#ifndef SHADE_PORT_MEMORY_H
#define SHADE_PORT_MEMORY_H

#include <stdlib.h>

#ifdef _WIN32
#include <malloc.h>
#endif

enum { SHADE_PORT_LINE = 64 };

/* Of a multiple of 64 bytes; NULL when out of memory. free() is not for it:
 * shade_port_aligned_free. */
static inline void *shade_port_aligned_new(size_t size) {
#ifdef _WIN32
  return _aligned_malloc(size, SHADE_PORT_LINE);
#else
  return aligned_alloc(SHADE_PORT_LINE, size);
#endif
}

static inline void shade_port_aligned_free(void *memory) {
#ifdef _WIN32
  _aligned_free(memory);
#else
  free(memory);
#endif
}

#endif
