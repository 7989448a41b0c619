/* SPDX-License-Identifier: Apache-2.0 */
/* Structures of arrays as callers hand them over, whichever header they were built against. */
#ifndef SHADE_SRC_LANES_H
#define SHADE_SRC_LANES_H

#include <stddef.h>
#include <string.h>

/*
 * *given, a structure that begins with its size and goes on in pointers, to *whole, which is
 * `room` bytes long: members beyond given's size become NULL, those that are not known yet are
 * left out. 0 when one of the first `required` pointers is not there.
 */
static inline int shade_whole_lanes(const void *given, size_t required, void *whole, size_t room) {
  size_t size;
  memcpy(&size, given, sizeof size);
  if (size >= room) {
    memcpy(whole, given, room);
  } else {
    memset(whole, 0, room);
    memcpy(whole, given, size - size % sizeof(void *));
  }
  const char *at = (const char *)whole + sizeof size;
  for (size_t i = 0; i < required; i++, at += sizeof(void *)) {
    const void *array;
    memcpy(&array, at, sizeof array);
    if (!array)
      return 0;
  }
  return 1;
}

#endif
