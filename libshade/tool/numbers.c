/* SPDX-License-Identifier: Apache-2.0 */
/* Which numbers state a choice of a list, by the rows of the table. */
#include "tool/numbers.h"

#include "model/bsdf.h"
#include "tool/tool.h"

unsigned tool_numbers_of(shade_list list, int value) {
  unsigned rows = 0;
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++)
    if (info.list == list && info.choices >> value & 1)
      rows |= 1u << row;
  if (list == SHADE_LIST_FRESNEL && shade_fresnel_is((shade_fresnel)value).f0)
    rows |= 1u << shade_param_find("f0"); /* read by diffuse models too */
  return rows;
}

int tool_choice_stated(shade_list list, unsigned rows) {
  shade_list_info about;
  int value, found = -1;
  shade_list_about(list, &about);
  for (int k = 0; shade_list_row(list, k, &value, NULL, NULL, NULL); k++)
    if (tool_numbers_of(list, value) == rows && (found < 0 || value == about.initial))
      found = value;
  return found;
}

unsigned tool_numbers_of_any(shade_list list) {
  unsigned rows = 0;
  int value;
  for (int k = 0; shade_list_row(list, k, &value, NULL, NULL, NULL); k++)
    rows |= tool_numbers_of(list, value);
  return rows;
}

void tool_print_numbers(FILE *to, unsigned rows) {
  shade_param_info info;
  const char *before = "";
  for (int row = 0; shade_param_row(row, &info); row++)
    if (rows >> row & 1) {
      fprintf(to, "%s--%s", before, info.word);
      before = " and ";
    }
}

void tool_print_statements(FILE *to, shade_list list) {
  const char *before = "";
  int value;
  for (int k = 0; shade_list_row(list, k, &value, NULL, NULL, NULL); k++) {
    const unsigned rows = tool_numbers_of(list, value);
    int earlier = 0, same = 0;
    for (int i = 0; i < k && shade_list_row(list, i, &earlier, NULL, NULL, NULL); i++)
      same |= tool_numbers_of(list, earlier) == rows;
    if (same)
      continue;
    fputs(before, to);
    tool_print_numbers(to, rows);
    before = ", or ";
  }
}

int tool_whole_lobe(const char *command, unsigned given) {
  const shade_list list = SHADE_LIST_MDF;
  const unsigned stated = given & tool_numbers_of_any(list);
  int value;
  if (!stated || tool_choice_stated(list, stated) >= 0)
    return TOOL_DONE;
  for (int k = 0; shade_list_row(list, k, &value, NULL, NULL, NULL); k++)
    if (!(stated & ~tool_numbers_of(list, value))) {
      fprintf(stderr, "shade %s: ", command);
      tool_print_numbers(stderr, tool_numbers_of(list, value));
      fputs(" go together\n", stderr);
      return TOOL_BAD_USAGE;
    }
  fprintf(stderr, "shade %s: give ", command);
  tool_print_statements(stderr, list);
  fputs(", not both\n", stderr);
  return TOOL_BAD_USAGE;
}
