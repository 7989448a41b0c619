/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/dump_scene.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system/library.h"

#define OPENEXR_LIBRARY "libOpenEXRCore-3_1.so.30"

static pthread_once_t exr_once = PTHREAD_ONCE_INIT;
static const struct shade_exr_api *exr;
static char exr_error[MESSAGE_SIZE];

static void exr_load(void) {
  void *library = library_open(OPENEXR_LIBRARY, exr_error, sizeof exr_error);
  if (library)
    exr = shade_exr_api_load(library_symbol, library, exr_error, sizeof exr_error);
}

bool dump_scene_write(const shade_dump *d, const char *path, message_log *log) {
  char error[MESSAGE_SIZE];
  pthread_once(&exr_once, exr_load);
  if (!exr)
    return message_error(log, "the dump cannot be written: %s", exr_error);
  if (shade_dump_write(exr, path, d, error, sizeof error) < 0)
    return message_error(log, "the dump cannot be written: %s", error);
  return true;
}

/* What the dump's header says of the scene; the caller frees. */
static char *header(const scene *s) {
  shade_dump_material *materials = malloc((s->materials + 1) * sizeof *materials);
  if (!materials)
    return NULL;
  for (size_t m = 0; m < s->materials; m++)
    materials[m] = (shade_dump_material){s->material[m].name, &s->material[m].params};
  char *text = shade_dump_header(s->renderer, materials, s->materials);
  free(materials);
  return text;
}

shade_dump *dump_scene_create(const scene *s) {
  char *json = header(s);
  shade_dump *d = json ? shade_dump_create(s->width, s->height, (int)s->lights) : NULL;
  if (d && shade_dump_set_json(d, json) < 0) {
    shade_dump_free(d);
    d = NULL;
  }
  free(json);
  return d;
}

/* Where hit i belongs: with one sample a pixel its lane is its pixel. Rows from the top. */
static size_t place(const shade_dump *d, const batch *b, const camera_view *view, size_t i) {
  int x, y;
  pixel_place(view, view->first + b->lane[i], &x, &y);
  return (size_t)(d->height - 1 - y) * (size_t)d->width + (size_t)x;
}

static void put(float *const plane[3], size_t at, float x, float y, float z) {
  plane[0][at] = x;
  plane[1][at] = y;
  plane[2][at] = z;
}

void dump_scene_hits(shade_dump *d, const batch *b, const camera_view *view) {
  float *plane[SHADE_DUMP_BASE];
  for (int k = 0; k < SHADE_DUMP_BASE; k++)
    plane[k] = shade_dump_plane(d, k);
  for (const segment *g = b->segment; g < b->segment + b->segments; g++)
    for (size_t i = g->begin; i < g->begin + g->count; i++) {
      size_t at = place(d, b, view, i);
      float x = b->bump_x[i], y = b->bump_y[i], z = b->bump_z[i];
      put(plane + SHADE_DUMP_P, at, b->px[i], b->py[i], b->pz[i]);
      put(plane + SHADE_DUMP_N, at, b->nx[i], b->ny[i], b->nz[i]);
      put(plane + SHADE_DUMP_T, at, b->tx[i], b->ty[i], b->tz[i]);
      put(plane + SHADE_DUMP_NS, at, x * b->tx[i] + y * b->bx[i] + z * b->nx[i],
          x * b->ty[i] + y * b->by[i] + z * b->ny[i], x * b->tz[i] + y * b->bz[i] + z * b->nz[i]);
      put(plane + SHADE_DUMP_V, at, -b->ray->dx[i], -b->ray->dy[i], -b->ray->dz[i]);
      plane[SHADE_DUMP_UV][at] = b->u[i];
      plane[SHADE_DUMP_UV + 1][at] = b->v[i];
      plane[SHADE_DUMP_MATERIAL][at] = (float)g->material->number;
      if (g->material->color[0])
        put(plane + SHADE_DUMP_COLOR, at, b->f0_r[i], b->f0_g[i], b->f0_b[i]);
      else
        put(plane + SHADE_DUMP_COLOR, at, (float)g->material->params.f0[0],
            (float)g->material->params.f0[1], (float)g->material->params.f0[2]);
    }
}

void dump_scene_light(shade_dump *d, const batch *b, const camera_view *view, size_t number,
                      const float color[3]) {
  float *plane[SHADE_DUMP_PER_LIGHT];
  for (int k = 0; k < SHADE_DUMP_PER_LIGHT; k++)
    plane[k] = shade_dump_light_plane(d, (int)number, k);
  for (size_t i = 0; i < b->hits; i++) {
    size_t at = place(d, b, view, i);
    put(plane + SHADE_DUMP_L, at, b->shadow_ray.dx[i], b->shadow_ray.dy[i], b->shadow_ray.dz[i]);
    put(plane + SHADE_DUMP_E, at, b->e[i] * color[0], b->e[i] * color[1], b->e[i] * color[2]);
    put(plane + SHADE_DUMP_S, at, b->r[i], b->g[i], b->b[i]);
  }
}
