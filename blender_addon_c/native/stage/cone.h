/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How wide what a ray stands for is: of the camera's a pixel, later the more the less is known of
 * where light comes from. Cloth is seen yarn by yarn or from afar by that, images as coarsely. */
#include "batch/leaf.h"
#include "stage/stage.h"

static void stage_pixel_cone(size_t count, const camera_view *view, const rays *restrict ray,
                             path_states *restrict state) {
  const camera *c = view->camera;
  const float step = sqrtf(fabsf(view->step[0] * view->step[1]));
  const float width = c->perspective ? 0.0f : step, spread = step - width;
  const float x = c->axis[2][0], y = c->axis[2][1], z = c->axis[2][2];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    vec3 d = load(&ray->d, i);
    state->width[i] = width;
    state->spread[i] = spread * fabsf(x * d.x + y * d.y + z * d.z); /* of its plane's distance */
  }
}

static void stage_width(size_t count, const uint32_t *restrict lane,
                        const path_states *restrict state, const rays *restrict ray,
                        surfaces *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out->width[i] = state->width[lane[i]] + state->spread[lane[i]] * ray->tfar[i];
}

/* A drawn ray stands for a part of all that might have been: a sixteenth of the angle that its
 * density gives to one draw. Mirrors are taken as flat. */
static void stage_spread(size_t rays, const uint32_t *restrict chosen,
                         const uint32_t *restrict lane, const surfaces *restrict at,
                         const draws *restrict draw, const path_states *restrict state,
                         path_states *restrict next) {
  const float share = 0.25f;
#pragma omp simd
  for (size_t k = 0; k < rays; k++) {
    uint32_t i = chosen[k];
    float pdf = draw->pdf[i], most = pdf > 0.1f ? pdf : 0.1f;
    next->width[k] = at->width[i];
    next->spread[k] = state->spread[lane[i]] + share / sqrtf(most);
  }
}

/* Of the plane before the camera as its rays see it; from behind a lens nearly so. */
static void stage_pixel(size_t count, const camera_view *view, const rays *restrict ray,
                        path_states *restrict state) {
  const camera *c = view->camera;
  const float wide = fabsf(view->step[0]), high = fabsf(view->step[1]);
  const float even = c->perspective ? 0.0f : 0.5f * (wide + high);
  const float seen = c->perspective ? 0.5f : 0.0f;
  const vec3 right = {c->axis[0][0], c->axis[0][1], c->axis[0][2]};
  const vec3 up = {c->axis[1][0], c->axis[1][1], c->axis[1][2]};
  const vec3 back = {c->axis[2][0], c->axis[2][1], c->axis[2][2]};
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    vec3 d = load(&ray->d, i);
    float x = dot(d, right), y = dot(d, up);
    float across = sqrtf(clampf(1.0f - x * x, 0.0f, 1.0f));
    float upright = sqrtf(clampf(1.0f - y * y, 0.0f, 1.0f));
    state->pixel[i] = even;
    state->widen[i] = seen * fabsf(dot(d, back)) * (wide * across + high * upright);
  }
}

static void stage_footprint(size_t count, const uint32_t *restrict lane,
                            const path_states *restrict state, const rays *restrict ray,
                            surfaces *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out->pixel[i] = state->pixel[lane[i]] + state->widen[lane[i]] * ray->tfar[i];
}

/* Whatever a ray was drawn from counts as a flat mirror, as in Cycles. */
static void stage_carry(size_t rays, const uint32_t *restrict chosen, const uint32_t *restrict lane,
                        const surfaces *restrict at, const path_states *restrict state,
                        path_states *restrict next) {
#pragma omp simd
  for (size_t k = 0; k < rays; k++) {
    uint32_t i = chosen[k];
    next->pixel[k] = at->pixel[i];
    next->widen[k] = state->widen[lane[i]];
  }
}
