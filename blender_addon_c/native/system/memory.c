/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _POSIX_C_SOURCE 200809L
#include "system/memory.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The linker's --wrap: the module's malloc is __wrap_malloc, the C library's __real_malloc. */
void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *old, size_t size);
void __real_free(void *old);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *old, size_t size);
char *__wrap_strdup(const char *text);
void __wrap_free(void *old);

static atomic_llong used, peak;

void memory_add(long long bytes) {
  long long now = atomic_fetch_add_explicit(&used, bytes, memory_order_relaxed) + bytes;
  long long most = atomic_load_explicit(&peak, memory_order_relaxed);
  while (now > most && !atomic_compare_exchange_weak_explicit(
                           &peak, &most, now, memory_order_relaxed, memory_order_relaxed)) {
  }
}

long long memory_used(void) {
  return atomic_load_explicit(&used, memory_order_relaxed);
}

long long memory_peak(void) {
  return atomic_load_explicit(&peak, memory_order_relaxed);
}

void memory_restart(void) {
  atomic_store_explicit(&peak, memory_used(), memory_order_relaxed);
}

#ifdef _WIN32

/* Its C library has one free() for blocks that are aligned and another for those that are not: so
 * each block of ours says before its first byte where the C library's begins. */
typedef struct head {
  void *whole;
  size_t size;
} head;
enum { LEAST = sizeof(head) }; /* what malloc itself aligns to */

static head *head_of(void *block) {
  return (head *)block - 1;
}

/* `room` of the C library, `alignment + size` bytes, as a block. */
static void *begin(void *room, size_t alignment, size_t size) {
  if (!room)
    return NULL;
  char *block = (char *)room + alignment - (uintptr_t)room % alignment;
  *head_of(block) = (head){room, size};
  memory_add((long long)size);
  return block;
}

void *memory_aligned(size_t alignment, size_t size) {
  return size > SIZE_MAX - alignment ? NULL
                                     : begin(__real_malloc(alignment + size), alignment, size);
}

void *__wrap_malloc(size_t size) {
  return memory_aligned(LEAST, size);
}

void *__wrap_calloc(size_t count, size_t size) {
  return size && count > (SIZE_MAX - LEAST) / size
             ? NULL
             : begin(__real_calloc(1, LEAST + count * size), LEAST, count * size);
}

char *__wrap_strdup(const char *text) {
  const size_t size = strlen(text) + 1;
  char *copy = __wrap_malloc(size);
  return copy ? memcpy(copy, text, size) : NULL;
}

/* Of blocks of malloc and calloc alone. */
void *__wrap_realloc(void *old, size_t size) {
  if (!old)
    return __wrap_malloc(size);
  const head before = *head_of(old);
  void *room = size > SIZE_MAX - LEAST ? NULL : __real_realloc(before.whole, LEAST + size);
  if (room)
    memory_add(-(long long)before.size);
  return begin(room, LEAST, size);
}

void __wrap_free(void *old) {
  if (!old)
    return;
  memory_add(-(long long)head_of(old)->size);
  __real_free(head_of(old)->whole);
}

#else

#ifdef __APPLE__
#include <malloc/malloc.h>
#define malloc_usable_size malloc_size
#else
#include <malloc.h>
#endif

void *__real_aligned_alloc(size_t alignment, size_t size);
int __real_posix_memalign(void **made, size_t alignment, size_t size);
char *__real_strdup(const char *text);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
int __wrap_posix_memalign(void **made, size_t alignment, size_t size);

static long long size_of(void *block) {
  return block ? (long long)malloc_usable_size(block) : 0;
}

static void *made(void *block) {
  memory_add(size_of(block));
  return block;
}

void *memory_aligned(size_t alignment, size_t size) {
  void *block = NULL;
  return posix_memalign(&block, alignment, size) == 0 ? block : NULL;
}

void *__wrap_malloc(size_t size) {
  return made(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size) {
  return made(__real_calloc(count, size));
}

void *__wrap_aligned_alloc(size_t alignment, size_t size) {
  return made(__real_aligned_alloc(alignment, size));
}

int __wrap_posix_memalign(void **block, size_t alignment, size_t size) {
  int wrong = __real_posix_memalign(block, alignment, size);
  if (!wrong)
    made(*block);
  return wrong;
}

char *__wrap_strdup(const char *text) {
  return made(__real_strdup(text));
}

void *__wrap_realloc(void *old, size_t size) {
  long long before = size_of(old);
  void *block = __real_realloc(old, size);
  if (block || !size)
    memory_add(size_of(block) - before);
  return block;
}

void __wrap_free(void *old) {
  memory_add(-size_of(old));
  __real_free(old);
}

#endif
