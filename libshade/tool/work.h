/* SPDX-License-Identifier: Apache-2.0 */
/* Long work in the tool: threads, progress on a terminal, Ctrl-C. */
#ifndef SHADE_TOOL_WORK_H
#define SHADE_TOOL_WORK_H

#include <stddef.h>

#include "image/image.h"

/* Exit status after Ctrl-C, as shells have it. */
enum { TOOL_INTERRUPTED = 130 };

/* From now on SIGINT and SIGTERM only set a flag; work stops at its next step. */
void tool_catch_interrupts(void);
int tool_interrupted(void);

/* CPUs that are online; what --threads defaults to. */
int tool_threads(void);

/* A bar on standard error, only where that is a terminal and after half a second. */
typedef struct tool_progress {
  const char *title;
  double total, begun, shown;
  int visible;
} tool_progress;
void tool_progress_begin(tool_progress *p, const char *title, double total);
void tool_progress_at(tool_progress *p, double done);
void tool_progress_end(tool_progress *p); /* wipes the bar */

/*
 * Do steps [0, steps) by up to `threads` threads, this one among them, in any order; returns when
 * all are done. `thread` counts from 0 and is below `threads` and TOOL_MAX_THREADS: what a thread
 * adds up may stand in a place of its own. The bar moves from `begin` to `end`; NULL: none.
 */
enum { TOOL_MAX_THREADS = 256 };
typedef void tool_step(void *context, int thread, size_t step);
void tool_share(int threads, size_t steps, tool_step *step, void *context, tool_progress *bar,
                double begin, double end);

/* Up to this many pictures are made by one pass. */
enum { TOOL_PICTURES = 4 };

/*
 * Fill pictures of the same size by `threads` threads and write them in order. `fill` makes
 * rows [first, first + count) of all pictures, in out[0], out[1], …, from any thread; what it
 * makes must depend on the rows alone, so that files do not depend on the threads. Takes over
 * the writers: closes them all, or abandons them all. Returns TOOL_DONE, TOOL_BAD_INPUT
 * (message printed, beginning with "shade `title`: ") or TOOL_INTERRUPTED.
 */
typedef void tool_fill(void *context, int first, int count, float *const *out);
typedef struct tool_picture {
  const char *path;
  shade_image_spec spec;
} tool_picture;
int tool_write_pictures(const char *title, const tool_picture *pictures, int count, int threads,
                        tool_fill *fill, void *context);

#endif
