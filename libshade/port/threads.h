/* SPDX-License-Identifier: Apache-2.0 */
/* POSIX threads, which Windows has by winpthreads, and what differs. */
#ifndef SHADE_PORT_THREADS_H
#define SHADE_PORT_THREADS_H

#include <pthread.h>

/* Processors that are online, at least 1. */
int shade_port_processors(void);

/* pthread_create, with a stack of more than a megabyte: macOS itself gives half of one. */
int shade_port_thread(pthread_t *thread, void *(*run)(void *), void *argument);

/* Seconds since some moment, by a clock that nobody sets. */
double shade_port_seconds(void);

/* pthread_cond_wait for at most so many seconds; it may return early, as that may. */
void shade_port_wait(pthread_cond_t *changed, pthread_mutex_t *lock, double seconds);

#endif
