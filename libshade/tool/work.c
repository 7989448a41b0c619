/* SPDX-License-Identifier: Apache-2.0 */
#include "tool/work.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>

#include "port/process.h"
#include "port/threads.h"
#include "tool/tool.h"

static volatile sig_atomic_t interrupted;

static void on_interrupt(int signal) {
  (void)signal;
  interrupted = 1;
}

void tool_catch_interrupts(void) {
  shade_port_on_stop(on_interrupt);
}

int tool_interrupted(void) {
  return interrupted;
}

int tool_threads(void) {
  const int cpus = shade_port_processors();
  return cpus > TOOL_MAX_THREADS ? TOOL_MAX_THREADS : cpus;
}

/* ---- progress ----------------------------------------------------------------- */

void tool_progress_begin(tool_progress *p, const char *title, double total) {
  p->title = title;
  p->total = total;
  p->begun = p->shown = shade_port_seconds();
  p->visible = shade_port_is_terminal(2) ? 0 : -1;
}

void tool_progress_at(tool_progress *p, double done) {
  enum { WIDTH = 32 };
  const double now = p->visible < 0 ? 0 : shade_port_seconds();
  if (p->visible < 0 || now - p->begun < 0.5 || now - p->shown < 0.1)
    return;
  const double part = p->total > 0 && done < p->total ? done / p->total : 1;
  const int filled = (int)(part * WIDTH);
  char bar[WIDTH + 1];
  for (int i = 0; i < WIDTH; i++)
    bar[i] = i < filled ? '#' : '.';
  bar[WIDTH] = 0;
  fprintf(stderr, "\rshade %s [%s] %3d %%", p->title, bar, (int)(100 * part));
  if (part > 0.02)
    fprintf(stderr, " %5.0f s left", (now - p->begun) * (1 - part) / part);
  fflush(stderr);
  p->shown = now;
  p->visible = 1;
}

void tool_progress_end(tool_progress *p) {
  if (p->visible > 0)
    fputs("\r\033[K", stderr);
}

/* ---- steps by several threads ----------------------------------------------------- */

typedef struct share {
  pthread_mutex_t lock;
  size_t next, steps;
  tool_step *step;
  void *context;
  tool_progress *bar;
  double begin, end;
} share;

typedef struct sharer {
  share *of;
  int thread;
} sharer;

static void *take(void *argument) {
  const sharer *me = argument;
  share *s = me->of;
  for (;;) {
    pthread_mutex_lock(&s->lock);
    const size_t step = s->next < s->steps ? s->next++ : s->steps;
    pthread_mutex_unlock(&s->lock);
    if (step == s->steps)
      return NULL;
    s->step(s->context, me->thread, step);
    if (me->thread == 0 && s->bar)
      tool_progress_at(s->bar, s->begin + (s->end - s->begin) * (double)step / (double)s->steps);
  }
}

void tool_share(int threads, size_t steps, tool_step *step, void *context, tool_progress *bar,
                double begin, double end) {
  share s = {.steps = steps, .step = step, .context = context, .bar = bar, .begin = begin};
  pthread_t handles[TOOL_MAX_THREADS];
  sharer sharers[TOOL_MAX_THREADS];
  s.end = end;
  pthread_mutex_init(&s.lock, NULL);
  threads = threads < 1 ? 1 : threads > TOOL_MAX_THREADS ? TOOL_MAX_THREADS : threads;
  int started = 1; /* this one; where no other starts it does all */
  for (int i = 0; i < threads; i++)
    sharers[i] = (sharer){&s, i};
  while (started < threads && shade_port_thread(&handles[started], take, &sharers[started]) == 0)
    started++;
  take(&sharers[0]);
  for (int i = 1; i < started; i++)
    pthread_join(handles[i], NULL);
  pthread_mutex_destroy(&s.lock);
}

/* ---- pictures by several threads ------------------------------------------------ */

enum { BAND = 16 }; /* rows a band: a chunk of a ZIP-packed EXR */

/* A ring of bands: filled by the workers in any order, written by the caller in order. */
typedef struct ring {
  pthread_mutex_t lock;
  pthread_cond_t moved; /* something was taken, filled or written */
  int bands, slots, next, written, stop;
  char *full;     /* per slot */
  float **pixels; /* per slot and picture */
  const tool_picture *pictures;
  int count;
  tool_fill *fill;
  void *context;
} ring;

static int band_rows(const ring *r, int band) {
  const int left = r->pictures[0].spec.height - band * BAND;
  return left < BAND ? left : BAND;
}

static void *work(void *argument) {
  ring *r = argument;
  pthread_mutex_lock(&r->lock);
  for (;;) {
    while (!r->stop && r->next < r->bands && r->next >= r->written + r->slots)
      pthread_cond_wait(&r->moved, &r->lock);
    if (r->stop || r->next >= r->bands)
      break;
    const int band = r->next++, slot = band % r->slots;
    pthread_mutex_unlock(&r->lock);
    r->fill(r->context, band * BAND, band_rows(r, band), r->pixels + slot * r->count);
    pthread_mutex_lock(&r->lock);
    r->full[slot] = 1;
    pthread_cond_broadcast(&r->moved);
  }
  pthread_mutex_unlock(&r->lock);
  return NULL;
}

/* Wait for a band; 0 when interrupted. Ctrl-C does not wake a waiting thread: look often. */
static int await(ring *r, int slot) {
  pthread_mutex_lock(&r->lock);
  while (!r->full[slot] && !interrupted)
    shade_port_wait(&r->moved, &r->lock, 0.05);
  pthread_mutex_unlock(&r->lock);
  return !interrupted;
}

static void release(ring *r, int slot) {
  pthread_mutex_lock(&r->lock);
  r->full[slot] = 0;
  r->written++;
  pthread_cond_broadcast(&r->moved);
  pthread_mutex_unlock(&r->lock);
}

/* TOOL_DONE, or TOOL_INTERRUPTED, or TOOL_BAD_INPUT with a message. */
static int write_bands(ring *r, shade_image_writer **writers, const char *title, char *error,
                       size_t size) {
  tool_progress progress;
  tool_progress_begin(&progress, title, r->bands);
  int status = TOOL_DONE;
  for (int band = 0; status == TOOL_DONE && band < r->bands; band++) {
    const int slot = band % r->slots;
    if (!await(r, slot))
      status = TOOL_INTERRUPTED;
    for (int k = 0; status == TOOL_DONE && k < r->count; k++)
      if (shade_image_rows(writers[k], r->pixels[slot * r->count + k], band_rows(r, band), error,
                           size) != 0)
        status = TOOL_BAD_INPUT;
    release(r, slot);
    tool_progress_at(&progress, band + 1);
  }
  tool_progress_end(&progress);
  return status;
}

static int run(ring *r, shade_image_writer **writers, const char *title, int threads, char *error,
               size_t size) {
  pthread_t handles[TOOL_MAX_THREADS];
  int started = 0;
  while (started < threads && shade_port_thread(&handles[started], work, r) == 0)
    started++;
  int status = TOOL_BAD_INPUT;
  if (started == 0)
    snprintf(error, size, "cannot start a thread");
  else
    status = write_bands(r, writers, title, error, size);
  pthread_mutex_lock(&r->lock);
  r->stop = 1;
  pthread_cond_broadcast(&r->moved);
  pthread_mutex_unlock(&r->lock);
  for (int i = 0; i < started; i++)
    pthread_join(handles[i], NULL);
  return status;
}

static int allocate(ring *r) {
  r->full = calloc((size_t)r->slots, 1);
  r->pixels = calloc((size_t)(r->slots * r->count), sizeof *r->pixels);
  for (int i = 0; r->full && r->pixels && i < r->slots * r->count; i++) {
    const shade_image_spec *s = &r->pictures[i % r->count].spec;
    r->pixels[i] = malloc(BAND * (size_t)s->width * (size_t)s->channels * sizeof **r->pixels);
    if (!r->pixels[i])
      return -1;
  }
  return r->full && r->pixels ? 0 : -1;
}

static void deallocate(ring *r) {
  for (int i = 0; r->pixels && i < r->slots * r->count; i++)
    free(r->pixels[i]);
  free(r->pixels);
  free(r->full);
}

int tool_write_pictures(const char *title, const tool_picture *pictures, int count, int threads,
                        tool_fill *fill, void *context) {
  char error[1024] = "";
  shade_image_writer *writers[TOOL_PICTURES] = {NULL};
  int status = TOOL_DONE;
  tool_catch_interrupts();
  for (int k = 0; status == TOOL_DONE && k < count; k++) {
    writers[k] = shade_image_open(pictures[k].path, &pictures[k].spec, error, sizeof error);
    if (!writers[k])
      status = TOOL_BAD_INPUT;
  }
  if (status == TOOL_DONE) {
    threads = threads < 1 ? 1 : threads > TOOL_MAX_THREADS ? TOOL_MAX_THREADS : threads;
    ring r = {.bands = (pictures[0].spec.height + BAND - 1) / BAND,
              .slots = 2 * threads,
              .pictures = pictures,
              .count = count,
              .fill = fill,
              .context = context};
    pthread_mutex_init(&r.lock, NULL);
    pthread_cond_init(&r.moved, NULL);
    if (allocate(&r) == 0) {
      status = run(&r, writers, title, threads, error, sizeof error);
    } else {
      snprintf(error, sizeof error, "out of memory");
      status = TOOL_BAD_INPUT;
    }
    deallocate(&r);
    pthread_cond_destroy(&r.moved);
    pthread_mutex_destroy(&r.lock);
  }
  for (int k = 0; k < count; k++) {
    if (status != TOOL_DONE)
      shade_image_abandon(writers[k]);
    else if (shade_image_close(writers[k], error, sizeof error) != 0)
      status = TOOL_BAD_INPUT;
  }
  if (status == TOOL_BAD_INPUT)
    fprintf(stderr, "shade %s: %s\n", title, error);
  if (status == TOOL_INTERRUPTED)
    fprintf(stderr, "shade %s: interrupted, nothing written\n", title);
  return status;
}
