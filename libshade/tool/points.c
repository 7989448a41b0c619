/* SPDX-License-Identifier: Apache-2.0 */
#include "tool/points.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tool/tool.h"

int tool_read_points(const char *title, tool_point *answer, void *context) {
  char line[1024];
  for (long number = 1; fgets(line, sizeof line, stdin); number++) {
    double x[6];
    int count = 0, cut = !strchr(line, '\n') && !feof(stdin);
    char *at = line, *end;
    for (; count < 6; count++, at = end) {
      x[count] = strtod(at, &end);
      if (end == at || !isfinite(x[count]))
        break;
    }
    at += strspn(at, " \t\r\n");
    if (!*at && !count && !cut)
      continue;
    if (cut || *at || (count != 2 && count != 6)) {
      fprintf(stderr,
              "shade %s: standard input, line %ld: expected 'u v' or 'u v du1 dv1 du2 dv2'\n",
              title, number);
      return TOOL_BAD_INPUT;
    }
    answer(context, x[0], x[1], count == 6 ? x + 2 : NULL);
  }
  return TOOL_DONE;
}
