/* SPDX-License-Identifier: Apache-2.0 */
/* Text in and out: queries on standard input, whole files. */
#ifndef SHADE_TOOL_TEXT_H
#define SHADE_TOOL_TEXT_H

#include <stddef.h>

/* Lines of numbers on standard input. Set title and form; the rest begins as 0. */
typedef struct tool_lines {
  const char *title; /* of the subcommand, and */
  const char *form;  /* of a line, for messages */
  long number;       /* of the line that was read last, from 1 */
  char *line;
  size_t capacity;
  int status;
} tool_lines;

/*
 * The next line that is neither blank nor begins with #, as `count` finite numbers, or as
 * `other` if that is not 0. Returns how many there were; 0 at the end, and after a message for
 * any other line.
 */
int tool_next_line(tool_lines *in, int count, int other, double *numbers);

/* The line that was read last is wrong, and why: a message, and no next line. */
void tool_bad_line(tool_lines *in, const char *wrong);

/* TOOL_DONE, or TOOL_BAD_INPUT if a line was bad or standard input could not be read. */
int tool_end_lines(tool_lines *in);

/*
 * Write a text as a file: under a temporary name first, so that the whole text appears or
 * nothing. What is no plain file, such as /dev/stdout, is written to as it is. With text NULL
 * nothing is written, only whether that would work is tried. TOOL_DONE, or TOOL_BAD_INPUT and
 * a message.
 */
int tool_save_text(const char *title, const char *path, const char *text, size_t length);

#endif
