/* SPDX-License-Identifier: Apache-2.0 */
/* Structures of arrays as callers hand them over, whichever header they were built against. */
#ifndef SHADE_BATCH_ARRAYS_H
#define SHADE_BATCH_ARRAYS_H

#include <stddef.h>
#include <string.h>

/* Nine arrays as n, wi and wo of shade_lanes, among the initializers of one. */
#define SHADE_DIRECTIONS(v)                                                                        \
  .nx = (v)[0], .ny = (v)[1], .nz = (v)[2], .wix = (v)[3], .wiy = (v)[4], .wiz = (v)[5],           \
  .wox = (v)[6], .woy = (v)[7], .woz = (v)[8]

/*
 * *given, a structure that begins with its size and goes on in pointers, to *whole, which is
 * `room` bytes long: members beyond given's size become NULL, those that are not known yet are
 * left out. Nothing, and 0, where there is no structure or nobody set its size.
 */
static inline int shade_copy_lanes(const void *given, void *whole, size_t room) {
  size_t size = 0;
  if (given)
    memcpy(&size, given, sizeof size);
  if (size >= room) {
    memcpy(whole, given, room);
  } else {
    memset(whole, 0, room);
    if (size >= sizeof size)
      memcpy(whole, given, size - size % sizeof(void *));
  }
  return size >= sizeof size;
}

/* The same; 0 when one of the first `required` pointers is not there. */
static inline int shade_whole_lanes(const void *given, size_t required, void *whole, size_t room) {
  if (!shade_copy_lanes(given, whole, room))
    return 0;
  for (size_t i = 0; i < required; i++) {
    const void *array;
    memcpy(&array, (const char *)whole + sizeof room + i * sizeof array, sizeof array);
    if (!array)
      return 0;
  }
  return 1;
}

#endif
