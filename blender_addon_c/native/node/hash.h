/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random numbers of places in lattices, the ones that Cycles takes: Jenkins' lookup3 of one to four
 * words, and from Blender 5.0 on a PCG of whole numbers for Voronoi cells [Jarzynski2020]. */
#ifndef LIBSHADE_NODE_HASH_H
#define LIBSHADE_NODE_HASH_H

#include "batch/leaf.h"

enum { LATTICE_DIMENSIONS = 4, LATTICE_LANES = 64 /* looked at together */ };

typedef struct words3 {
  uint32_t a, b, c;
} words3;

LEAF uint32_t rotated(uint32_t x, int by) {
  return x << by | x >> (32 - by);
}
LEAF uint32_t jenkins_end(words3 w) {
  w.c = (w.c ^ w.b) - rotated(w.b, 14);
  w.a = (w.a ^ w.c) - rotated(w.c, 11);
  w.b = (w.b ^ w.a) - rotated(w.a, 25);
  w.c = (w.c ^ w.b) - rotated(w.b, 16);
  w.a = (w.a ^ w.c) - rotated(w.c, 4);
  w.b = (w.b ^ w.a) - rotated(w.a, 14);
  return (w.c ^ w.b) - rotated(w.b, 24);
}
LEAF words3 jenkins_more(words3 w) {
  w.a = (w.a - w.c) ^ rotated(w.c, 4);
  w.c += w.b;
  w.b = (w.b - w.a) ^ rotated(w.a, 6);
  w.a += w.c;
  w.c = (w.c - w.b) ^ rotated(w.b, 8);
  w.b += w.a;
  w.a = (w.a - w.c) ^ rotated(w.c, 16);
  w.c += w.b;
  w.b = (w.b - w.a) ^ rotated(w.a, 19);
  w.a += w.c;
  w.c = (w.c - w.b) ^ rotated(w.b, 4);
  w.b += w.a;
  return w;
}
LEAF uint32_t jenkins_seed(uint32_t words) {
  return 0xdeadbeefu + (words << 2) + 13u;
}

/* Of the first `count` of four words; the others must be 0. */
LEAF uint32_t jenkins(int count, uint32_t x, uint32_t y, uint32_t z, uint32_t w) {
  uint32_t seed = jenkins_seed((uint32_t)count);
  words3 state = {seed + x, seed + y, seed + z};
  if (count > 3) {
    state = jenkins_more(state);
    state.a += w;
  }
  return jenkins_end(state);
}

/* [0, 1], both ends. A signed number converts in one instruction everywhere. */
LEAF float closed_unit(uint32_t x) {
  return ((float)(int32_t)(x >> 16) * 65536.0f + (float)(int32_t)(x & 0xffffu)) *
         (1.0f / 4294967296.0f);
}

/* Of the bits of up to four floats. */
LEAF float chance(int count, float x, float y, float z, float w) {
  return closed_unit(jenkins(
      count, (uint32_t)bits_of_float(x), count > 1 ? (uint32_t)bits_of_float(y) : 0,
      count > 2 ? (uint32_t)bits_of_float(z) : 0, count > 3 ? (uint32_t)bits_of_float(w) : 0));
}

typedef struct vec4 {
  float x, y, z, w;
} vec4;

/* Three of a place of so many dimensions. */
LEAF vec3 chances3(int count, vec4 p) {
  switch (count) {
  case 1:
    return (vec3){chance(1, p.x, 0, 0, 0), chance(2, p.x, 1, 0, 0), chance(2, p.x, 2, 0, 0)};
  case 2:
    return (vec3){chance(2, p.x, p.y, 0, 0), chance(3, p.x, p.y, 1, 0), chance(3, p.x, p.y, 2, 0)};
  case 3:
    return (vec3){chance(3, p.x, p.y, p.z, 0), chance(4, p.x, p.y, p.z, 1),
                  chance(4, p.x, p.y, p.z, 2)};
  default:
    return (vec3){chance(4, p.x, p.y, p.z, p.w), chance(4, p.z, p.x, p.w, p.y),
                  chance(4, p.w, p.z, p.y, p.x)};
  }
}

/* As many as it has dimensions; the others are 0. */
LEAF vec4 chances(int count, vec4 p) {
  if (count == 1)
    return (vec4){chance(1, p.x, 0, 0, 0), 0, 0, 0};
  if (count == 2)
    return (vec4){chance(2, p.x, p.y, 0, 0), chance(3, p.x, p.y, 1, 0), 0, 0};
  if (count == 3) {
    vec3 c = chances3(3, p);
    return (vec4){c.x, c.y, c.z, 0};
  }
  return (vec4){chance(4, p.x, p.y, p.z, p.w), chance(4, p.w, p.x, p.y, p.z),
                chance(4, p.z, p.w, p.x, p.y), chance(4, p.y, p.z, p.w, p.x)};
}

/* As an arithmetic shift would fill it. */
LEAF uint32_t folded(uint32_t x) {
  return x ^ (uint32_t)((int32_t)x >> 16);
}
LEAF float pcg_unit(uint32_t x) {
  return (float)(int32_t)(x & 0x7fffffffu) * (1.0f / 2147483647.0f);
}
LEAF uint32_t pcg_word(float x) {
  return (uint32_t)(int32_t)x * 1664525u + 1013904223u;
}

/* Of a cell of two to four dimensions, as many; of one, and beyond what is asked for, Jenkins'. */
LEAF vec4 cell_chances(int count, vec4 p) {
  uint32_t x = pcg_word(p.x), y = pcg_word(p.y), z = pcg_word(p.z), w = pcg_word(p.w);
  if (count == 1)
    return chances(1, p);
  if (count == 2) {
    x += y * 1664525u;
    y += x * 1664525u;
    x = folded(x), y = folded(y);
    x += y * 1664525u;
    y += x * 1664525u;
    return (vec4){pcg_unit(x), pcg_unit(y), 0, 0};
  }
  if (count == 3) {
    x += y * z;
    y += z * x;
    z += x * y;
    x = folded(x), y = folded(y), z = folded(z);
    x += y * z;
    y += z * x;
    z += x * y;
    return (vec4){pcg_unit(x), pcg_unit(y), pcg_unit(z), 0};
  }
  x += y * w;
  y += z * x;
  z += x * y;
  w += y * z;
  x = folded(x), y = folded(y), z = folded(z), w = folded(w);
  x += y * w;
  y += z * x;
  z += x * y;
  w += y * z;
  return (vec4){pcg_unit(x), pcg_unit(y), pcg_unit(z), pcg_unit(w)};
}
/* Its colour: a plane's cells are those of space at z = 0. */
LEAF vec3 cell_chances3(int count, vec4 p) {
  if (count == 1)
    return chances3(1, p);
  vec4 c = cell_chances(count == 4 ? 4 : 3, p);
  return (vec3){c.x, c.y, c.z};
}

#endif
