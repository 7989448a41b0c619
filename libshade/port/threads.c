/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#include "port/threads.h"

#include <time.h>

#ifdef _WIN32

#include "port/wide.h"

int shade_port_processors(void) {
  const DWORD count = GetActiveProcessorCount(ALL_PROCESSOR_GROUPS);
  return count < 1 ? 1 : (int)count;
}

double shade_port_seconds(void) {
  LARGE_INTEGER now, second;
  QueryPerformanceCounter(&now);
  QueryPerformanceFrequency(&second);
  return (double)now.QuadPart / (double)second.QuadPart;
}

#else

#include <unistd.h>

int shade_port_processors(void) {
  const long count = sysconf(_SC_NPROCESSORS_ONLN);
  return count < 1 ? 1 : (int)count;
}

double shade_port_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif

int shade_port_thread(pthread_t *thread, void *(*run)(void *), void *argument) {
#ifdef __APPLE__
  enum { STACK = 8 << 20 };
  pthread_attr_t large;
  pthread_attr_init(&large);
  pthread_attr_setstacksize(&large, STACK);
  const int wrong = pthread_create(thread, &large, run, argument);
  pthread_attr_destroy(&large);
  return wrong;
#else
  return pthread_create(thread, NULL, run, argument);
#endif
}

/* winpthreads has this clock, too */
void shade_port_wait(pthread_cond_t *changed, pthread_mutex_t *lock, double seconds) {
  enum { SECOND = 1000000000 };
  struct timespec until;
  clock_gettime(CLOCK_REALTIME, &until);
  const long long ns = until.tv_nsec + (long long)(seconds * SECOND);
  until.tv_sec += (time_t)(ns / SECOND);
  until.tv_nsec = (long)(ns % SECOND);
  pthread_cond_timedwait(changed, lock, &until);
}
