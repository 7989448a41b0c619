/* SPDX-License-Identifier: Apache-2.0 */
/* Three arrays that hold a direction of each sample: what passes hand on, by value. */
#ifndef SHADE_BATCH_VEC_H
#define SHADE_BATCH_VEC_H

#include <stddef.h>

#include "../model/random.h"

/* Scratch of a block, at the start of a cache line: no vector of it straddles two. */
#define ROOM _Alignas(64) real

/* Of the widest vector that loops use. */
#if defined(__AVX512F__)
#define VECTOR_BYTES 64
#elif defined(__AVX2__)
#define VECTOR_BYTES 32
#else
#define VECTOR_BYTES 16
#endif

#define BLOCK 256 /* samples a pass: its scratch stays in the first-level cache */

typedef struct vec {
  const real *x, *y, *z;
} vec;

/* Room for one. */
typedef struct vec_room {
  ROOM x[BLOCK], y[BLOCK], z[BLOCK];
} vec_room;

LEAF vec vec_in(const vec_room *room) {
  return (vec){room->x, room->y, room->z};
}

LEAF vec vec_of(const real *const v[3]) {
  return (vec){v[0], v[1], v[2]};
}

/* From sample i on. */
LEAF vec vec_from(const real *x, const real *y, const real *z, size_t i) {
  return (vec){x + i, y + i, z + i};
}

/* x and y in each other's place: what holds along x of the result holds along y. */
LEAF vec vec_swapped(vec v) {
  return (vec){v.y, v.x, v.z};
}

/* The arrays of v as vx, vy, vz: loops over members would not vectorise. */
#define ARRAYS(v) const real *restrict v##x = v.x, *restrict v##y = v.y, *restrict v##z = v.z

/* Sample i of them, in a loop. */
#define AT(v)                                                                                      \
  (triple) {                                                                                       \
    v##x[i], v##y[i], v##z[i]                                                                      \
  }

#endif
