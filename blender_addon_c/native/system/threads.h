/* SPDX-License-Identifier: GPL-3.0-or-later */
/* POSIX threads, which Windows has by winpthreads, and what differs. */
#ifndef LIBSHADE_THREADS_H
#define LIBSHADE_THREADS_H

#include <pthread.h>
#include <stdbool.h>

/* A condition for threads_wait. */
void threads_condition(pthread_cond_t *changed);

/* Wait until it changes, or for no reason, and at the longest until parallel_clock() says so; false
 * if it does. */
bool threads_wait(pthread_cond_t *changed, pthread_mutex_t *lock, double until);

/* Let others go first. */
void threads_yield(void);

#endif
