/* SPDX-License-Identifier: Apache-2.0 */
/* Any text as what command lines and lines of input hold. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "shade/weave.h"
#include "tool/parse.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char *text = malloc(size + 1); /* exactly as long: reading beyond it shows */
  if (!text)
    return 0;
  if (size)
    memcpy(text, data, size);
  text[size] = 0;
  double numbers[9];
  int64_t whole;
  int n[3], width, height;
  if (tool_parse_number(text, numbers) && !isfinite(numbers[0]))
    abort();
  if (tool_parse_whole(text, -7, 256, &whole) && (whole < -7 || whole > 256))
    abort();
  if (tool_parse_size(text, 65536, &width, &height) &&
      (width < 1 || width > 65536 || height < 1 || height > 65536))
    abort();
  if (tool_parse_pattern(text, n)) {
    shade_draft *d = shade_draft_from_pattern(n[0], n[1], n[2]);
    const int fits = n[0] == SHADE_WEFT_ONLY
                         ? n[1] >= 0
                         : n[0] >= 1 && n[1] >= 0 && n[0] <= SHADE_PATTERN_MAX &&
                               n[1] <= SHADE_PATTERN_MAX - n[0];
    if (!d != !fits)
      abort();
    shade_draft_free(d);
  }
  for (int count = 1; count <= 9; count++)
    if (!tool_parse_line(text, size, count, numbers))
      for (int i = 0; i < count; i++)
        if (!isfinite(numbers[i]))
          abort();
  shade_draft_free(shade_draft_named(text));
  shade_yarn_params yarn;
  double *number = shade_yarn_param(&yarn, text);
  if (number && ((char *)number < (char *)&yarn || (char *)number >= (char *)(&yarn + 1)))
    abort();
  free(text);
  return 0;
}
