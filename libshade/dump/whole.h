/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Files that appear whole or not at all: written under a temporary name in the same folder, then
 * renamed. All that the renderers and the tool write goes through here.
 */
#ifndef SHADE_WHOLE_H
#define SHADE_WHOLE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shade_whole {
  char *path, *temporary; /* the file to be, and what to write until then */
} shade_whole;

/*
 * Create an empty file under a temporary name of its own, beside where the links of the path end:
 * a link stays one. What is there but no plain file is refused: renaming would take its place. 0,
 * or -1 and in error[size] what is wrong, without the path; then there is nothing to end.
 */
int shade_whole_begin(shade_whole *w, const char *path, char *error, size_t size);

/*
 * With `good` the file takes its place, else it is removed; also when -1 is returned, with what
 * is wrong in error[size]. A second call does nothing. `error` may be NULL if `good` is 0.
 */
int shade_whole_end(shade_whole *w, int good, char *error, size_t size);

/* All at once: `length` bytes as a file. With text NULL it is only tried whether that would work,
 * and nothing is left. 0, or -1 with what is wrong in error[size]. */
int shade_whole_write(const char *path, const char *text, size_t length, char *error, size_t size);

#ifdef __cplusplus
}
#endif
#endif
