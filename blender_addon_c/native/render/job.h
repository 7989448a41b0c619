/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A picture in the making: a thread that builds, renders and dumps. Python's
 * side is in python/; nothing here knows of Python.
 */
#ifndef LIBSHADE_JOB_H
#define LIBSHADE_JOB_H

#include "render/tile.h"

typedef enum job_state { JOB_RUNNING, JOB_DONE, JOB_CANCELLED, JOB_FAILED } job_state;
typedef enum job_stage { JOB_BUILD, JOB_RENDER, JOB_DENOISE, JOB_DUMP } job_stage;

/* Fills a render that is prepared, instead of its being rendered; false after an error in its log.
 */
typedef bool job_fill(void *context, render *r);

typedef struct job {
  scene *scene;
  job_fill *fill; /* or NULL */
  void *context;
  message_log log;
  atomic_bool cancel;
  atomic_int stage;
  pthread_t thread;
  pthread_mutex_t lock; /* of state */
  pthread_cond_t changed;
  job_state state;
  sampling_plan samples;
  render render;
  scene_times times;
  double wall;
} job;

/* Ends a job and gives its scene back, which is the caller's from then on. */
scene *job_leave(job *j);
/* Takes the scene over, also when it fails. NULL when out of memory or threads. */
job *job_start(scene *s);
/* The same of sums that are there already, to which `fill` sets those of the render. */
job *job_start_filled(scene *s, job_fill *fill, void *context);
/* True when finished within this time; negative waits for ever. */
bool job_wait(job *j, double seconds);
job_state job_get_state(job *j);
double job_progress(const job *j); /* of its stage, 0 to 1 */
void job_cancel(job *j);
/* Cancel, wait, free. */
void job_free(job *j);

#endif
