/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Large blocks that lie in a file without a name: what of them is not in use need not stay in
 * memory. They are no part of what memory.h counts. */
#ifndef LIBSHADE_PAGES_H
#define LIBSHADE_PAGES_H

#include <stddef.h>

/* NULL where a block is too small for that, or there is no file for it: TMPDIR's (/tmp's) disk is
 * full, or is memory itself. On Windows and macOS always. */
void *pages_new(size_t bytes);

/* What is in it goes to the file, and comes back where it is asked for. */
void pages_leave(void *block, size_t bytes);

/* Bytes of this process's memory that are pages of files; 0 where nothing tells. Any thread. */
size_t pages_resident(void);

void pages_free(void *block, size_t bytes);

#endif
