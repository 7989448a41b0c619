/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sample positions to camera rays. */
#include "batch/leaf.h"
#include "stage/aperture.h"
#include "stage/stage.h"

/* Position in a pixel: uniform over it, or spread by the filter's inverse integral. */
LEAF float place(uint32_t point, const float *restrict warp) {
  float x = unit_float(point);
  if (!warp)
    return x;
  float at = x * FILTER_STEPS;
  int k = (int)at;
  return 0.5f + warp[k] + (at - (float)k) * (warp[k + 1] - warp[k]);
}

LEAF void camera_rays(bool perspective, bool filtered, size_t count, const camera_view *view,
                      paths *restrict path, rays *restrict ray) {
  const camera c = *view->camera;
  const uint32_t *restrict point_x = view->point[0], *restrict point_y = view->point[1];
  const float *restrict warp = filtered ? view->warp : NULL;
  const int x = view->x, y = view->y;
  const int x0 = view->region[0], y0 = view->region[1];
  const int x1 = view->region[2], y1 = view->region[3];
  const uint32_t first = view->first, scramble = view->scramble, seed = mix(view->seed);
  const float per_sample = view->per_sample;
  const float step_x = view->step[0], step_y = view->step[1];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    /* j / samples by a product: half a sample's margin is more than its rounding error */
    uint32_t j = first + (uint32_t)i;
    uint32_t pixel = (uint32_t)(int32_t)(((float)(int32_t)j + 0.5f) * per_sample);
    int px = x + (int)unzip(pixel);
    int py = y + (int)unzip(pixel >> 1);
    uint32_t h = mix((uint32_t)px * 0x8da6b343u ^ (uint32_t)py * 0xd8163841u ^ seed);
    path->hash[i] = h;
    float sx = (float)px + place(point_x[i] ^ (h & scramble), warp);
    float sy = (float)py + place(point_y[i] ^ (mix(h) & scramble), warp);
    float fx = c.frame[0] + sx * step_x;
    float fy = c.frame[2] + sy * step_y;
    float length = perspective ? sqrtf(fx * fx + fy * fy + 1.0f) : 1.0f;
    if (perspective) {
      float inverse = 1.0f / length;
      ray->o.x[i] = c.origin[0];
      ray->o.y[i] = c.origin[1];
      ray->o.z[i] = c.origin[2];
      ray->d.x[i] = (fx * c.axis[0][0] + fy * c.axis[1][0] - c.axis[2][0]) * inverse;
      ray->d.y[i] = (fx * c.axis[0][1] + fy * c.axis[1][1] - c.axis[2][1]) * inverse;
      ray->d.z[i] = (fx * c.axis[0][2] + fy * c.axis[1][2] - c.axis[2][2]) * inverse;
    } else {
      ray->o.x[i] = c.origin[0] + fx * c.axis[0][0] + fy * c.axis[1][0];
      ray->o.y[i] = c.origin[1] + fx * c.axis[0][1] + fy * c.axis[1][1];
      ray->o.z[i] = c.origin[2] + fx * c.axis[0][2] + fy * c.axis[1][2];
      ray->d.x[i] = -c.axis[2][0];
      ray->d.y[i] = -c.axis[2][1];
      ray->d.z[i] = -c.axis[2][2];
    }
    ray->tnear[i] = c.clip[0] * length;
    bool wanted = (px >= x0) & (py >= y0) & (px < x1) & (py < y1);
    ray->tfar[i] = wanted ? c.clip[1] * length : -1.0f;
  }
}

static void stage_camera(size_t count, const camera_view *view, paths *restrict path,
                         rays *restrict ray) {
  if (view->camera->perspective && view->warp)
    camera_rays(true, true, count, view, path, ray);
  else if (view->camera->perspective)
    camera_rays(true, false, count, view, path, ray);
  else if (view->warp)
    camera_rays(false, true, count, view, path, ray);
  else
    camera_rays(false, false, count, view, path, ray);
}

static void stage_lens(size_t count, const camera *camera, const shuffle *points,
                       const paths *restrict path, rays *restrict ray) {
  const uint32_t *restrict index = points->index, *restrict reverse = points->reverse;
  const uint32_t mask = points->mask, salt = points->salt;
  const vec3 right = {camera->axis[0][0], camera->axis[0][1], camera->axis[0][2]};
  const vec3 up = {camera->axis[1][0], camera->axis[1][1], camera->axis[1][2]};
  const vec3 back = {camera->axis[2][0], camera->axis[2][1], camera->axis[2][2]};
  const bool disc = camera->blades < 3;
  const float blades = disc ? 1.0f : (float)camera->blades, half = 3.14159265f / blades;
  const float side = cosf(half), across = sinf(half), turned = camera->turn / 6.28318531f;
  const float width = camera->lens[0], height = camera->lens[1], focus = camera->focus;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    float x, y, a, b;
    shuffled_point(index[i], reverse, mask, mix(path->hash[i] + salt), &x, &y);
    lens_point(disc, blades, side, across, turned, x, y, &a, &b);
    a *= width;
    b *= height;
    vec3 d = load(&ray->d, i), o = load(&ray->o, i);
    vec3 step = {a * right.x + b * up.x, a * right.y + b * up.y, a * right.z + b * up.z};
    float depth = -dot(d, back); /* of a step of 1 along the ray; the clipping planes lie in it */
    float sharp = focus / depth;
    vec3 to = {d.x * sharp - step.x, d.y * sharp - step.y, d.z * sharp - step.z};
    to = scaled(to, 1.0f / sqrtf(dot(to, to)));
    float seen = -dot(to, back);
    float stretch = depth / (seen > 1e-9f ? seen : 1e-9f);
    store(&ray->o, i, (vec3){o.x + step.x, o.y + step.y, o.z + step.z});
    store(&ray->d, i, to);
    ray->tnear[i] *= stretch;
    ray->tfar[i] *= stretch;
  }
}
