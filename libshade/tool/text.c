/* SPDX-License-Identifier: Apache-2.0 */
#include "tool/text.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dump/whole.h"
#include "port/files.h"
#include "port/process.h"
#include "tool/parse.h"
#include "tool/tool.h"

void tool_bad_line(tool_lines *in, const char *wrong) {
  fflush(stdout);
  fprintf(stderr, "shade %s: standard input, line %ld: %s; expected %s\n", in->title, in->number,
          wrong, in->form);
  in->status = TOOL_BAD_INPUT;
}

int tool_next_line(tool_lines *in, int count, int other, double *numbers) {
  long long length;
  while (!in->status && (length = shade_port_line(&in->line, &in->capacity, stdin)) >= 0) {
    in->number++;
    const char *text = in->line;
    if (in->number == 1 &&
        !strncmp(text, "\xef\xbb\xbf", 3)) { /* some editors begin files with it */
      length -= 3;
      memmove(in->line, in->line + 3, (size_t)length + 1);
    }
    while (isspace((unsigned char)*text))
      text++;
    if ((!*text && strlen(in->line) == (size_t)length) || *text == '#')
      continue;
    const char *wrong = tool_parse_line(in->line, (size_t)length, count, numbers);
    if (!wrong)
      return count;
    if (other) {
      wrong = tool_parse_line(in->line, (size_t)length, other, numbers);
      if (!wrong)
        return other;
    }
    tool_bad_line(in, wrong);
  }
  return 0;
}

int tool_end_lines(tool_lines *in) {
  if (ferror(stdin)) {
    fprintf(stderr, "shade %s: standard input: %s\n", in->title, strerror(errno));
    in->status = TOOL_BAD_INPUT;
  }
  free(in->line);
  in->line = NULL;
  return in->status;
}

/* To be written to as it is: to rename over a device would put a file in its place. */
static int is_device(const char *path) {
  const shade_port_kind there = shade_port_look(path, NULL);
  return there == SHADE_PORT_FOLDER || there == SHADE_PORT_DEVICE;
}

int tool_save_text(const char *title, const char *path, const char *text, size_t length) {
  char why[256] = "";
  int good;
  if (is_device(path)) {
    FILE *stream = shade_port_open(path, "wb");
    good = stream && (!text || fwrite(text, 1, length, stream) == length);
    good = stream && !fclose(stream) && good;
    snprintf(why, sizeof why, "cannot write: %s", strerror(errno));
  } else
    good = shade_whole_write(path, text, length, why, sizeof why) == 0;
  if (!good)
    fprintf(stderr, "shade %s: %s: %s\n", title, path, why);
  return good ? TOOL_DONE : TOOL_BAD_INPUT;
}
