/* SPDX-License-Identifier: Apache-2.0 */
/* Any text as the JSON of a dump's header: a value, or a message with its line. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tool/json.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  char *text = malloc(size + 1), error[200] = "";
  if (!text)
    return 0;
  if (size)
    memcpy(text, data, size);
  text[size] = 0;
  json *value = json_read(text, error, sizeof error);
  if (!value == !*error)
    abort();
  json_member(value, "materials");
  json_free(value);
  free(text);
  return 0;
}
