/* SPDX-License-Identifier: GPL-3.0-or-later */
#define Py_LIMITED_API 0x030b0000
#include "python/islands.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

const char native_roots_doc[] =
    "roots(pairs, count) -> bytearray\n\n"
    "For each of count things the one that stands for all that pairs join it with, as 32-bit\n"
    "numbers; pairs: a buffer of 32-bit numbers, two each. Sets are joined by rank, the second's\n"
    "to the first's where these are the same [Tarjan1975], which says what stands for them.";

static uint32_t root_of(uint32_t *up, uint32_t x) {
  uint32_t root = x;
  while (up[root] != root)
    root = up[root];
  while (up[x] != root) {
    uint32_t next = up[x];
    up[x] = root;
    x = next;
  }
  return root;
}

static void join(uint32_t *up, uint8_t *rank, uint32_t first, uint32_t second) {
  uint32_t to = root_of(up, first), from = root_of(up, second);
  if (to == from)
    return;
  if (rank[to] < rank[from]) {
    uint32_t other = to;
    to = from;
    from = other;
  }
  up[from] = to;
  rank[to] = (uint8_t)(rank[to] + (rank[to] == rank[from])); /* at most 32 */
}

/* False where a pair names what is not there. */
static bool join_all(const int32_t *pair, size_t pairs, uint32_t *up, uint8_t *rank, size_t count) {
  for (size_t k = 0; k < 2 * pairs; k++)
    if (pair[k] < 0 || (size_t)pair[k] >= count)
      return false;
  for (size_t k = 0; k < count; k++)
    up[k] = (uint32_t)k;
  for (size_t k = 0; k < pairs; k++)
    join(up, rank, (uint32_t)pair[2 * k], (uint32_t)pair[2 * k + 1]);
  for (size_t k = 0; k < count; k++)
    up[k] = root_of(up, (uint32_t)k);
  return true;
}

PyObject *native_roots(PyObject *self, PyObject *arguments) {
  (void)self;
  Py_buffer pairs;
  Py_ssize_t count;
  if (!PyArg_ParseTuple(arguments, "y*n", &pairs, &count))
    return NULL;
  PyObject *made = NULL;
  uint8_t *rank = NULL;
  bool fits = count >= 0 && count <= INT32_MAX && pairs.len % 8 == 0;
  if (fits) {
    made = PyByteArray_FromStringAndSize(NULL, 4 * count);
    rank = calloc((size_t)count + 1, 1);
  }
  bool room = made && rank;
  if (room) {
    uint32_t *up = (uint32_t *)(void *)PyByteArray_AsString(made);
    Py_BEGIN_ALLOW_THREADS fits =
        join_all(pairs.buf, (size_t)pairs.len / 8, up, rank, (size_t)count);
    Py_END_ALLOW_THREADS
  }
  free(rank);
  PyBuffer_Release(&pairs);
  if (room && fits)
    return made;
  Py_XDECREF(made);
  if (fits)
    return PyErr_NoMemory();
  PyErr_SetString(PyExc_ValueError,
                  "roots: pairs of 32-bit numbers, each below count, are expected");
  return NULL;
}
