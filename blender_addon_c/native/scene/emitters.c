/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/emitters.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Brightness times area of a triangle in the world; what is not finite or has no area is 0. */
static double fill(const mesh *m, size_t t, const double matrix[12], const float radiance[3],
                   float *row) {
  double corner[3][3], edge[2][3];
  for (size_t k = 0; k < 3; k++)
    instance_place(matrix, m->position + 3 * (size_t)m->corner_position[3 * t + k], corner[k]);
  for (int k = 0; k < 3; k++) {
    edge[0][k] = corner[1][k] - corner[0][k];
    edge[1][k] = corner[2][k] - corner[0][k];
    row[EMITTER_CORNER + k] = (float)corner[0][k];
    row[EMITTER_EDGE + k] = (float)edge[0][k];
    row[EMITTER_EDGE + 3 + k] = (float)edge[1][k];
    row[EMITTER_COLOR + k] = radiance[k];
  }
  double x = edge[0][1] * edge[1][2] - edge[0][2] * edge[1][1];
  double y = edge[0][2] * edge[1][0] - edge[0][0] * edge[1][2];
  double z = edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
  double bright = 0.5 * sqrt(x * x + y * y + z * z) * (double)emitter_brightness(radiance);
  return bright > 1e-30 && bright < 1e30 ? bright : 0;
}

/* The triangles, one after the other: counted, or filled in where there is room. */
static size_t gather(const geometry *s, float *row, double *bright, uint32_t *instance_of) {
  size_t count = 0;
  for (const instance *in = s->instance; in < s->instance + s->instances; in++) {
    const mesh *m = &s->mesh[in->mesh];
    for (size_t t = 0; t < m->triangles; t++) {
      const material *of = &s->material[m->material[t]];
      if (!of->shines)
        continue;
      if (row) {
        bright[count] = fill(m, t, in->matrix, of->radiance, row + EMITTER_ROW * count);
        instance_of[count] = (uint32_t)(in - s->instance);
      }
      count++;
    }
  }
  return count;
}

/* A ball about them, by their light's middle. */
static void find_ball(emitters *e, const double *bright, double all) {
  double center[3] = {0, 0, 0};
  for (size_t i = 0; i < e->count; i++)
    for (int k = 0; k < 3; k++) {
      const float *row = e->row + EMITTER_ROW * i;
      double middle = (double)row[k] + ((double)row[3 + k] + (double)row[6 + k]) / 3;
      center[k] += bright[i] > 0 ? bright[i] / all * middle : 0;
    }
  double radius2 = 0;
  for (size_t i = 0; i < e->count; i++)
    for (int corner = 0; corner < 3; corner++) {
      const float *row = e->row + EMITTER_ROW * i;
      double d2 = 0;
      for (int k = 0; k < 3; k++) {
        double at = (double)row[k] + (corner ? (double)row[3 * corner + k] : 0);
        d2 += (at - center[k]) * (at - center[k]);
      }
      radius2 = bright[i] > 0 && d2 > radius2 ? d2 : radius2;
    }
  for (int k = 0; k < 3; k++)
    e->center[k] = (float)center[k];
  e->radius2 = (float)fmin(radius2, 1e36);
}

bool emitters_build(const geometry *s, emitters *e) {
  size_t count = gather(s, NULL, NULL, NULL);
  if (!count || count > INT32_MAX / EMITTER_ROW)
    return true; /* so many are met by drawn rays alone */
  double *bright = malloc(count * sizeof *bright), all = 0, below = 0;
  e->row = calloc(count, EMITTER_ROW * sizeof *e->row);
  e->instance = malloc(count * sizeof *e->instance);
  e->sum = malloc((count + 1) * sizeof *e->sum);
  e->material = calloc(s->materials, 4 * sizeof *e->material);
  bool good = bright && e->row && e->instance && e->sum && e->material;
  if (good) {
    gather(s, e->row, bright, e->instance);
    for (size_t i = 0; i < count; i++)
      all += bright[i];
    for (size_t i = 0; i <= count; i++) {
      e->sum[i] = all > 0 ? (float)fmin(below / all, 1) : 0.0f;
      below += i < count ? bright[i] : 0;
    }
    e->sum[count] = 1.0f;
    e->count = all > 0 ? count : 0;
    e->bright = (float)all;
    e->power = (float)all; /* as if all faced the point */
    find_ball(e, bright, all);
    for (size_t m = 0; all > 0 && m < s->materials; m++)
      if (s->material[m].shines) {
        memcpy(e->material + 4 * m, s->material[m].radiance, 3 * sizeof *e->material);
        e->material[4 * m + 3] = emitter_brightness(s->material[m].radiance) / e->bright;
      }
  }
  free(bright);
  return good;
}

void emitters_free(emitters *e) {
  free(e->row);
  free(e->instance);
  free(e->sum);
  free(e->material);
}
