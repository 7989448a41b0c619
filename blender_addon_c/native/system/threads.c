/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "system/threads.h"

#include <errno.h>
#include <sched.h>
#include <time.h>

#include "port/threads.h"
#include "system/parallel.h"

void threads_yield(void) {
  sched_yield();
}

#if defined(_WIN32) || defined(__APPLE__)

/* These wait by the clock that tells the time of day: for what is left of the other. */
void threads_condition(pthread_cond_t *changed) {
  pthread_cond_init(changed, NULL);
}

bool threads_wait(pthread_cond_t *changed, pthread_mutex_t *lock, double until) {
  const double left = until - parallel_clock();
  shade_port_wait(changed, lock, left > 0 ? left : 0);
  return parallel_clock() < until;
}

#else

void threads_condition(pthread_cond_t *changed) {
  pthread_condattr_t steady;
  pthread_condattr_init(&steady);
  pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
  pthread_cond_init(changed, &steady);
  pthread_condattr_destroy(&steady);
}

bool threads_wait(pthread_cond_t *changed, pthread_mutex_t *lock, double until) {
  const time_t whole = (time_t)until;
  const struct timespec end = {.tv_sec = whole, .tv_nsec = (long)((until - (double)whole) * 1e9)};
  return pthread_cond_timedwait(changed, lock, &end) != ETIMEDOUT;
}

#endif
