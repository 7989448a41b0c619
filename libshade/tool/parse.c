/* SPDX-License-Identifier: Apache-2.0 */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shade/weave.h"
#include "tool/parse.h"

int tool_parse_number(const char *text, double *value) {
  char *end;
  *value = strtod(text, &end);
  return end != text && !*end && isfinite(*value);
}

/* A whole number at the start of the text, without blanks before it; *end is what follows. */
static int whole(const char *text, int64_t low, int64_t high, int64_t *value, const char **end) {
  char *rest;
  if (isspace((unsigned char)*text))
    return 0;
  errno = 0;
  *value = strtoll(text, &rest, 10);
  *end = rest;
  return rest != text && !errno && *value >= low && *value <= high;
}

int tool_parse_whole(const char *text, int64_t low, int64_t high, int64_t *value) {
  const char *end;
  return whole(text, low, high, value, &end) && !*end;
}

int tool_parse_size(const char *text, int most, int *width, int *height) {
  int64_t w, h;
  const char *end;
  if (!whole(text, 1, most, &w, &end))
    return 0;
  h = w;
  if (*end && !(*end == 'x' && tool_parse_whole(end + 1, 1, most, &h)))
    return 0;
  *width = (int)w;
  *height = (int)h;
  return 1;
}

int tool_parse_pattern(const char *text, int numbers[3]) {
  for (int i = 0; i < 3; i++) {
    const char last = i < 2 ? ',' : '\0';
    int64_t value;
    if (i == 0 && !strncmp(text, "inf,", 4)) {
      value = SHADE_WEFT_ONLY;
      text += 3;
    } else if (!whole(text, INT_MIN, INT_MAX - 1, &value, &text))
      return 0;
    numbers[i] = (int)value;
    if (*text != last)
      return 0;
    text++;
  }
  return 1;
}

const char *tool_parse_line(const char *line, size_t length, int count, double *numbers) {
  if (strlen(line) != length)
    return "it holds a zero byte";
  for (int i = 0; i < count; i++) {
    char *end;
    numbers[i] = strtod(line, &end);
    if (end == line) {
      while (isspace((unsigned char)*line))
        line++;
      return *line ? "not a number" : "too few numbers";
    }
    if (*end && !isspace((unsigned char)*end))
      return "not a number";
    if (!isfinite(numbers[i]))
      return "a number is not finite";
    line = end;
  }
  while (isspace((unsigned char)*line))
    line++;
  return *line ? "too many numbers" : NULL;
}
