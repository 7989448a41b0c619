/* SPDX-License-Identifier: Apache-2.0 */
#include "tool/points.h"

#include <stddef.h>

#include "tool/text.h"

int tool_read_points(const char *title, tool_point *answer, void *context) {
  tool_lines in = {.title = title, .form = "u v or u v du1 dv1 du2 dv2"};
  double x[6];
  int count;
  while ((count = tool_next_line(&in, 2, 6, x)) > 0)
    answer(context, x[0], x[1], count == 6 ? x + 2 : NULL);
  return tool_end_lines(&in);
}
