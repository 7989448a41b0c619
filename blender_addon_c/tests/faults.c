/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For LD_PRELOAD: of the calls for memory by one library, which lies from `low` to `high`, one
 * fails, or that and all after it. */
#include <errno.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static uintptr_t low, high;
static atomic_long count, first;
static atomic_int others;

void faults_of(uintptr_t begin, uintptr_t end) {
  low = begin;
  high = end;
}

/* number: from 1 on, 0: none fails. Counts from 0 again. */
void faults_set(long number, int others_too) {
  atomic_store(&count, 0);
  atomic_store(&others, others_too);
  atomic_store(&first, number);
}

long faults_count(void) {
  return atomic_load(&count);
}

static int fails(void *caller) {
  const uintptr_t place = (uintptr_t)caller;
  if (place < low || place >= high)
    return 0;
  const long number = atomic_fetch_add(&count, 1) + 1, from = atomic_load(&first);
  const int now = from && (number == from || (atomic_load(&others) && number > from));
  if (now)
    errno = ENOMEM;
  return now;
}

#define FAILS fails(__builtin_return_address(0))

void *malloc(size_t size) {
  return FAILS ? NULL : __libc_malloc(size);
}

void *calloc(size_t number, size_t size) {
  return FAILS ? NULL : __libc_calloc(number, size);
}

void *realloc(void *old, size_t size) {
  return FAILS ? NULL : __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
  return FAILS ? NULL : __libc_memalign(alignment, size);
}

int posix_memalign(void **made, size_t alignment, size_t size) {
  void *block = FAILS ? NULL : __libc_memalign(alignment, size);
  if (block)
    *made = block;
  return block ? 0 : ENOMEM;
}

char *strdup(const char *text) {
  const size_t size = strlen(text) + 1;
  char *copy = FAILS ? NULL : __libc_malloc(size);
  return copy ? memcpy(copy, text, size) : NULL;
}
