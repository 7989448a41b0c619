/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* sched_getaffinity */
#include "system/parallel.h"

#include <stdatomic.h>
#include <stdint.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "port/threads.h"

enum { MAX_THREADS = 256 };

typedef struct task {
  void (*work)(void *context, size_t i);
  void *context;
  size_t count;
  atomic_size_t next;
} task;

/* Embree asks for flushed denormals, and nothing here needs them. */
static void flush_denormals(void) {
#if defined(__SSE2__)
  _mm_setcsr(_mm_getcsr() | 0x8040u);
#elif defined(__aarch64__)
  uint64_t control;
  __asm__ volatile("mrs %0, fpcr" : "=r"(control));
  __asm__ volatile("msr fpcr, %0" : : "r"(control | 1u << 24));
#endif
}

static void *run(void *argument) {
  task *t = argument;
  flush_denormals();
  for (;;) {
    size_t i = atomic_fetch_add_explicit(&t->next, 1, memory_order_relaxed);
    if (i >= t->count)
      return NULL;
    t->work(t->context, i);
  }
}

void parallel_for(int threads, size_t count, void (*work)(void *context, size_t i), void *context) {
  pthread_t helper[MAX_THREADS];
  size_t helpers = 0;
  task t = {.work = work, .context = context, .count = count};
  atomic_init(&t.next, 0);
  while (helpers + 1 < (size_t)threads && helpers + 1 < count && helpers < MAX_THREADS &&
         shade_port_thread(&helper[helpers], run, &t) == 0)
    helpers++;
  run(&t);
  while (helpers)
    pthread_join(helper[--helpers], NULL);
}

#ifdef _WIN32

#include "port/wide.h"

int parallel_cores(void) {
  DWORD_PTR own, all;
  if (GetProcessAffinityMask(GetCurrentProcess(), &own, &all) && own)
    return __builtin_popcountll(own);
  return (int)GetActiveProcessorCount(ALL_PROCESSOR_GROUPS); /* in several groups it has no mask */
}

#elif defined(__APPLE__) /* which keeps no thread on a processor */

int parallel_cores(void) {
  return shade_port_processors();
}

#else

#include <sched.h>

int parallel_cores(void) {
  cpu_set_t set;
  if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0)
    return CPU_COUNT(&set);
  return 1;
}

#endif

double parallel_clock(void) {
  return shade_port_seconds();
}
