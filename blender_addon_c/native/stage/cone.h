/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How wide what a ray stands for is: of the camera's a pixel, later the more the less is known of
 * where light comes from. Cloth is seen yarn by yarn or from afar by that, images as coarsely. */
#include "batch/leaf.h"
#include "stage/stage.h"

static void stage_pixel_cone(size_t count, const camera_view *view, const rays *restrict ray,
                             walks *restrict walk) {
  const camera *c = view->camera;
  const float step = sqrtf(fabsf(view->step[0] * view->step[1]));
  const float width = c->perspective ? 0.0f : step, spread = step - width;
  const float x = c->axis[2][0], y = c->axis[2][1], z = c->axis[2][2];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    vec3 d = load(&ray->d, i);
    walk->width[i] = width;
    walk->spread[i] = spread * fabsf(x * d.x + y * d.y + z * d.z); /* of its plane's distance */
  }
}

static void stage_width(size_t count, const uint32_t *restrict lane, const walks *restrict walk,
                        const rays *restrict ray, surfaces *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out->width[i] = walk->width[lane[i]] + walk->spread[lane[i]] * ray->tfar[i];
}

/* A drawn ray stands for a part of all that might have been: a sixteenth of the angle that its
 * density gives to one draw. Mirrors are taken as flat. */
static void stage_spread(size_t rays, const uint32_t *restrict chosen,
                         const uint32_t *restrict lane, const surfaces *restrict at,
                         const draws *restrict draw, const walks *restrict walk,
                         walks *restrict next) {
  const float share = 0.25f;
#pragma omp simd
  for (size_t k = 0; k < rays; k++) {
    uint32_t i = chosen[k];
    float pdf = draw->pdf[i], most = pdf > 0.1f ? pdf : 0.1f;
    next->width[k] = at->width[i];
    next->spread[k] = walk->spread[lane[i]] + share / sqrtf(most);
  }
}
