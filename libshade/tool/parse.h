/* SPDX-License-Identifier: Apache-2.0 */
/* Words and numbers of command lines and of lines of input. All return 1, or 0 if it is not one. */
#ifndef SHADE_TOOL_PARSE_H
#define SHADE_TOOL_PARSE_H

#include <stddef.h>
#include <stdint.h>

/* A finite number, or a whole number of low to high, that is the whole text. */
int tool_parse_number(const char *text, double *value);
int tool_parse_whole(const char *text, int64_t low, int64_t high, int64_t *value);

/* "W" or "WxH", each 1 to most; W alone is a square. */
int tool_parse_size(const char *text, int most, int *width, int *height);

/* "n_w,n_p,n_s" of shade_draft_from_pattern; n_w may be `inf`. Not whether they are in range. */
int tool_parse_pattern(const char *text, int numbers[3]);

/*
 * Exactly `count` finite numbers with blanks between them on a line of `length` bytes with a 0
 * behind them. Returns NULL, or what is wrong.
 */
const char *tool_parse_line(const char *line, size_t length, int count, double *numbers);

#endif
