/* SPDX-License-Identifier: GPL-3.0-or-later */
/* COST = 0.1 */
/* The renderer's door to the system, on each that it is made for: memory, threads, clocks,
 * libraries. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "system/library.h"
#include "system/memory.h"
#include "system/parallel.h"
#include "system/threads.h"

/* Blocks of any size and alignment begin where they should, keep what is in them, and are counted
 * until they are freed. */
static void memory_is_aligned_and_counted(void **state) {
  (void)state;
  const long long before = memory_used();
  enum { BLOCKS = 64 };
  unsigned char *block[BLOCKS];
  long long asked = 0;
  for (size_t i = 0; i < BLOCKS; i++) {
    const size_t alignment = (size_t)16 << i % 4, size = 1 + 37 * i;
    block[i] = memory_aligned(alignment, size);
    assert_non_null(block[i]);
    assert_int_equal((uintptr_t)block[i] % alignment, 0);
    memset(block[i], (int)i, size);
    asked += (long long)size;
  }
  assert_true(memory_used() - before >= asked && memory_peak() >= memory_used());
  for (size_t i = 0; i < BLOCKS; i++) {
    for (size_t k = 0; k < 1 + 37 * i; k++)
      assert_int_equal(block[i][k], i);
    free(block[i]);
  }
  assert_true(memory_used() == before);
  free(NULL);
#ifndef __SANITIZE_ADDRESS__ /* which ends a program that asks for so much */
  assert_null(memory_aligned(64, SIZE_MAX - 8));
#endif
}

static void memory_grows_and_is_zero(void **state) {
  (void)state;
  const long long before = memory_used();
  char *text = realloc(NULL, 4);
  assert_non_null(text);
  memcpy(text, "abc", 4);
  for (size_t size = 8; size < 1 << 20; size *= 4) {
    char *more = realloc(text, size);
    assert_non_null(more);
    text = more;
    assert_string_equal(text, "abc");
    assert_true(memory_used() - before >= (long long)size);
  }
  char *copy = strdup(text);
  assert_string_equal(copy, "abc");
  int *zeros = calloc(1000, sizeof *zeros);
  for (size_t i = 0; i < 1000; i++)
    assert_int_equal(zeros[i], 0);
#ifndef __SANITIZE_ADDRESS__
  volatile size_t many = SIZE_MAX / 2;
  void *volatile none = calloc(many, 3); /* clang leaves out a block that nobody looks at */
  assert_null(none);
#endif
  free(text);
  free(copy);
  free(zeros);
  assert_true(memory_used() == before);
}

static void count(void *context, size_t i) {
  atomic_fetch_add((atomic_int *)context + i, 1);
}

static void each_is_done_once(void **state) {
  (void)state;
  enum { MANY = 1000 };
  static atomic_int done[MANY];
  assert_true(parallel_cores() >= 1 && parallel_cores() <= 4096);
  parallel_for(7, MANY, count, done);
  for (size_t i = 0; i < MANY; i++)
    assert_int_equal(atomic_load(&done[i]), 1);
}

typedef struct waiting {
  pthread_mutex_t lock;
  pthread_cond_t changed;
  bool told;
} waiting;

static void *tell(void *context) {
  waiting *w = context;
  threads_yield();
  pthread_mutex_lock(&w->lock);
  w->told = true;
  pthread_cond_broadcast(&w->changed);
  pthread_mutex_unlock(&w->lock);
  return NULL;
}

/* As long as was said, and no longer than until the other thread tells. */
static void waits_end(void **state) {
  (void)state;
  waiting w = {.told = false};
  pthread_mutex_init(&w.lock, NULL);
  threads_condition(&w.changed);
  pthread_mutex_lock(&w.lock);
  const double begin = parallel_clock();
  while (threads_wait(&w.changed, &w.lock, begin + 0.05)) {
  }
  assert_true(parallel_clock() >= begin + 0.05 && parallel_clock() < begin + 30);
  pthread_t other;
  assert_int_equal(pthread_create(&other, NULL, tell, &w), 0);
  while (!w.told)
    assert_true(threads_wait(&w.changed, &w.lock, begin + 60));
  pthread_mutex_unlock(&w.lock);
  pthread_join(other, NULL);
  pthread_cond_destroy(&w.changed);
  pthread_mutex_destroy(&w.lock);
}

static void a_library_that_is_not_there_is_named(void **state) {
  (void)state;
  char error[512] = "";
  assert_null(library_open("none", "none-of-the-system", error, sizeof error));
  assert_non_null(strstr(error, "libshade_none."));
  assert_null(library_open(NULL, "/no/such/\xd0\xbf\xd0\xb0\xd0\xbf\xd0\xba\xd0\xb0/x", error,
                           sizeof error));
  assert_non_null(strstr(error, "\xd0\xbf\xd0\xb0\xd0\xbf\xd0\xba\xd0\xb0"));
  char tiny[8];
  assert_null(library_open("none", "none", tiny, sizeof tiny));
  assert_int_equal(strlen(tiny), sizeof tiny - 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(memory_is_aligned_and_counted), cmocka_unit_test(memory_grows_and_is_zero),
      cmocka_unit_test(each_is_done_once), cmocka_unit_test(waits_end),
      cmocka_unit_test(a_library_that_is_not_there_is_named)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
