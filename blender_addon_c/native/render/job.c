/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/job.h"

#include <stdlib.h>
#include <string.h>

#include "render/build.h"
#include "render/denoise.h"
#include "render/dump_scene.h"
#include "port/threads.h"
#include "system/memory.h"
#include "system/parallel.h"

static bool out_of_memory(job *j) {
  return message_error(&j->log, "out of memory");
}

static bool render_picture(job *j) {
  atomic_store(&j->stage, JOB_RENDER);
  return render_run(&j->render);
}

/* A denoiser that is missing or fails is no reason to lose the picture. A path after '?' is of one
 * that need not be there: else it is done without, as it is of one sample, which shall be there at
 * once. */
static bool denoise(job *j) {
  render *r = &j->render;
  int width = r->region[2] - r->region[0], height = r->region[3] - r->region[1];
  size_t pixels = (size_t)width * (size_t)height;
  char wrong[MESSAGE_SIZE] = "out of memory";
  float *color = malloc(4 * pixels * sizeof *color);
  float *albedo = malloc(3 * pixels * sizeof *albedo),
        *normal = malloc(3 * pixels * sizeof *normal);
  bool good = color && albedo && normal;
  atomic_store(&j->stage, JOB_DENOISE);
  if (good) {
    render_copy(r, color);
    render_copy_plane(r, PLANE_ALBEDO, albedo);
    render_copy_plane(r, PLANE_NORMAL, normal);
    denoise_input input = {.width = width,
                           .height = height,
                           .color = color,
                           .albedo = albedo,
                           .normal = normal,
                           .threads = j->scene->threads,
                           .samples = j->scene->samples};
    const char *path = j->scene->denoiser;
    const bool optional = path && path[0] == '?';
    const bool quick = optional && input.samples == 1;
    good = !quick && denoise_run(&input, path + optional, &j->cancel, wrong, sizeof wrong);
    good = good || (optional && wrong[0] && denoise_simply(&input));
  }
  free(albedo);
  free(normal);
  if (good) {
    pthread_mutex_lock(&r->film);
    r->whole = color;
    pthread_mutex_unlock(&r->film);
    return true;
  }
  free(color);
  if (wrong[0])
    message_warn(&j->log, "%s; the picture is as noisy as it was", wrong);
  return !atomic_load(&j->cancel);
}

/* One more pass of the same stages, over the whole picture, a sample in each pixel's middle. */
static bool render_dump(job *j) {
  const scene *s = j->scene;
  sampling_plan middle = {0};
  shade_dump *dump = dump_scene_create(s, &j->log);
  observer observer = dump_scene_observer(dump);
  render r = {.scene = s,
              .plan = &middle,
              .cancel = &j->cancel,
              .log = &j->log,
              .region = {0, 0, s->width, s->height},
              .observer = &observer};
  atomic_store(&j->stage, JOB_DUMP);
  bool good = dump && sampling_init_center(&middle, BATCH) && render_prepare(&r);
  if (!good)
    out_of_memory(j);
  good = good && render_run(&r) && dump_scene_write(dump, s->dump, &j->log);
  render_free(&r);
  sampling_free(&middle);
  shade_dump_free(dump);
  return good;
}

static bool run(job *j) {
  scene *s = j->scene;
  if (j->fill ? !j->fill(j->context, &j->render)
              : !scene_build(s, &j->cancel, &j->log, &j->times) || !render_picture(j))
    return false;
  if (j->render.status & SHADE_BAD_INPUT)
    message_warn(&j->log, "some samples had no valid direction or normal and are black");
  return (!s->features.denoise || denoise(j)) && (!s->dump || render_dump(j));
}

static void *controller(void *argument) {
  job *j = argument;
  double start = parallel_clock();
  bool good = run(j);
  pthread_mutex_lock(&j->lock);
  j->wall = parallel_clock() - start;
  j->state = good ? JOB_DONE : j->log.error[0] ? JOB_FAILED : JOB_CANCELLED;
  pthread_cond_broadcast(&j->changed);
  pthread_mutex_unlock(&j->lock);
  return NULL;
}

static void release(job *j) {
  render_free(&j->render);
  free(j->render.sum);
  free(j->render.numbers);
  adaptive_free(&j->render.adaptive);
  free(j->render.whole);
  free(j->render.matte);
  sampling_free(&j->samples);
  scene_free(j->scene);
  message_free(&j->log);
  pthread_cond_destroy(&j->changed);
  pthread_mutex_destroy(&j->lock);
  free(j);
}

job *job_start(scene *s) {
  return job_start_filled(s, NULL, NULL);
}

job *job_start_filled(scene *s, job_fill *fill, void *context) {
  memory_restart();
  job *j = calloc(1, sizeof *j);
  if (!j) {
    scene_free(s);
    return NULL;
  }
  j->scene = s;
  j->fill = fill;
  j->context = context;
  message_init(&j->log);
  char wrong[160];
  s->stages = stages_choose();
  if (shade_isa_check(wrong, sizeof wrong) != 0)
    message_warn(&j->log, "%s", wrong);
  pthread_mutex_init(&j->lock, NULL);
  threads_condition(&j->changed);
  j->render = (render){
      .scene = s,
      .plan = &j->samples,
      .cancel = &j->cancel,
      .log = &j->log,
      .time_limit = (double)s->time_limit,
      .adaptive = {.threshold = s->adaptive_threshold, .least = (size_t)s->adaptive_least}};
  memcpy(j->render.region, s->region, sizeof s->region);
  size_t pixels = (size_t)(s->region[2] - s->region[0]) * (size_t)(s->region[3] - s->region[1]);
  j->render.sum = calloc(pixels + 1, 4 * sizeof(float));
  j->render.planes = plane_layout_of(s->planes);
  if (s->planes)
    j->render.numbers = calloc(pixels + 1, (size_t)j->render.planes.channels * sizeof(float));
  j->render.mattes = matte_layout_of(s->mattes, (size_t)s->matte_slots);
  if (s->mattes)
    j->render.matte = calloc(pixels + 1, j->render.mattes.all * sizeof(float));
  if (!j->render.sum || (s->planes && !j->render.numbers) || (s->mattes && !j->render.matte) ||
      !sampling_init(&j->samples, (size_t)s->samples, s->share[1] ? s->share : NULL, BATCH,
                     s->filter, s->filter_width) ||
      !render_prepare(&j->render) ||
      (s->adaptive_threshold > 0.0f &&
       !adaptive_init(&j->render.adaptive, j->render.tiles, pixels)) ||
      shade_port_thread(&j->thread, controller, j) != 0) {
    release(j);
    return NULL;
  }
  return j;
}

bool job_wait(job *j, double seconds) {
  const double until = parallel_clock() + (seconds < 0 || seconds > 1e8 ? 1e8 : seconds);
  pthread_mutex_lock(&j->lock);
  while (j->state == JOB_RUNNING && threads_wait(&j->changed, &j->lock, until)) {
  }
  bool finished = j->state != JOB_RUNNING;
  pthread_mutex_unlock(&j->lock);
  return finished;
}

job_state job_get_state(job *j) {
  pthread_mutex_lock(&j->lock);
  job_state state = j->state;
  pthread_mutex_unlock(&j->lock);
  return state;
}

double job_progress(const job *j) {
  return render_progress(&j->render);
}

void job_cancel(job *j) {
  atomic_store(&j->cancel, true);
}

scene *job_leave(job *j) {
  scene *s = j->scene;
  job_cancel(j);
  pthread_join(j->thread, NULL);
  j->scene = NULL;
  release(j);
  return s;
}

void job_free(job *j) {
  scene_free(job_leave(j));
}
