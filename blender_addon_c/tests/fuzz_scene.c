/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Any text as the header of a saved scene, and what is behind its first zero as the arrays: a
 * scene, or a message. Built without the checksums. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tool/scene_file.h"

enum { ALIGNMENT = 64, PREAMBLE = 16 };
static const char MAGIC[] = "shscene\n";

static size_t aligned(size_t size) {
  return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const uint8_t *zero = size ? memchr(data, 0, size) : NULL;
  const size_t text = zero ? (size_t)(zero - data) : size, arrays = zero ? size - text - 1 : 0;
  const size_t begin = aligned(PREAMBLE + text), whole = begin + aligned(arrays);
  const uint32_t words[2] = {(uint32_t)(begin - PREAMBLE), 0};
  char *file = aligned_alloc(ALIGNMENT, whole);
  if (!file)
    return 0;
  memset(file, ' ', begin);
  memset(file + begin, 0, whole - begin);
  memcpy(file, MAGIC, strlen(MAGIC));
  memcpy(file + strlen(MAGIC), words, sizeof words);
  if (text)
    memcpy(file + PREAMBLE, data, text);
  if (arrays)
    memcpy(file + begin, zero + 1, arrays);
  scene_file f = {0};
  if (scene_file_read(&f, file, whole) == (f.error[0] != 0))
    abort();
  scene_file_close(&f);
  free(file);
  return 0;
}
