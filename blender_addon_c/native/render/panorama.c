/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/panorama.h"

#include <math.h>

#include "batch/leaf.h"
#include "stage/aperture.h"

/* Where a round picture shows the direction at an angle from its middle. */
static bool around(float x, float y, float angle, float most, vec3 *out) {
  float r = sqrtf(x * x + y * y);
  if (!(angle <= most))
    return false;
  float s = sinf(angle) / (r > 0.0f ? r : 1.0f);
  *out = (vec3){s * x, s * y, -cosf(angle)};
  return true;
}

/* The direction that a point of the picture shows, u and v from 0 to 1: to the right, up and back.
 * False where there is none. */
static bool direction(const camera *c, float u, float v, vec3 *out) {
  const float *range = c->range, *k = c->polynomial;
  float half = 0.5f * c->fov;
  float right = range[0] + u * (range[1] - range[0]), up = range[2] + v * (range[3] - range[2]);
  float x = u - 0.5f, y = v - 0.5f, quarter = 1.57079633f;
  float across = x * c->sensor[0], upright = y * c->sensor[1];
  float r = sqrtf(across * across + upright * upright);
  switch (c->panorama) {
  case PANORAMA_EQUIRECTANGULAR:
    *out = (vec3){cosf(up) * sinf(right), sinf(up), -cosf(up) * cosf(right)};
    return true;
  case PANORAMA_CENTRAL_CYLINDRICAL:
    *out = scaled((vec3){sinf(right), up, -cosf(right)}, 1.0f / sqrtf(1.0f + up * up));
    return true;
  case PANORAMA_EQUIANGULAR_CUBEMAP_FACE:
    *out = (vec3){tanf(x * quarter), tanf(y * quarter), -1.0f};
    *out = scaled(*out, 1.0f / sqrtf(dot(*out, *out)));
    return true;
  case PANORAMA_FISHEYE_EQUIDISTANT:
    return around(x, y, 2.0f * sqrtf(x * x + y * y) * half, half, out);
  case PANORAMA_FISHEYE_EQUISOLID:
    if (r > 2.0f * c->focal * sinf(0.5f * half) || r > 2.0f * c->focal)
      return false;
    return around(across, upright, 2.0f * asinf(r / (2.0f * c->focal)), INFINITY, out);
  case PANORAMA_FISHEYE_LENS_POLYNOMIAL: {
    float angle = -(k[0] + r * (k[1] + r * (k[2] + r * (k[3] + r * k[4]))));
    return fabsf(angle) <= half && around(across, upright, angle, INFINITY, out);
  }
  case PANORAMA_MIRRORBALL: {
    float a = 2.0f * x, b = 2.0f * y, z2 = 1.0f - a * a - b * b, z = sqrtf(z2 > 0.0f ? z2 : 0.0f);
    *out = (vec3){2.0f * z * a, 2.0f * z * b, 1.0f - 2.0f * z * z};
    return z2 >= 0.0f;
  }
  case PANORAMA_NONE:
    break;
  }
  return false;
}

/* From a point of the aperture, across the ray's own direction. */
static void through_lens(const camera *c, const shuffle *points, uint32_t hash, size_t i, vec3 *o,
                         vec3 *d) {
  const bool disc = c->blades < 3;
  const float blades = disc ? 1.0f : (float)c->blades, half = 3.14159265f / blades;
  float x, y, a, b;
  shuffled_point(points->index[i], points->reverse, points->mask, mix(hash + points->salt), &x, &y);
  lens_point(disc, blades, cosf(half), sinf(half), c->turn / 6.28318531f, x, y, &a, &b);
  a *= c->lens[0];
  b *= c->lens[1];
  /* u: what is left of straight ahead, as in Cycles */
  vec3 u = {d->z * d->x, d->z * d->y, d->z * d->z - 1.0f};
  float length2 = dot(u, u);
  u = length2 > 1e-12f ? scaled(u, 1.0f / sqrtf(length2)) : (vec3){1, 0, 0};
  vec3 v = cross(*d, u);
  *o = (vec3){a * u.x + b * v.x, a * u.y + b * v.y, a * u.z + b * v.z};
  vec3 to = {d->x * c->focus - o->x, d->y * c->focus - o->y, d->z * c->focus - o->z};
  *d = scaled(to, 1.0f / sqrtf(dot(to, to)));
}

static vec3 by_axes(const camera *c, vec3 v) {
  float out[3];
  for (int k = 0; k < 3; k++)
    out[k] = v.x * c->axis[0][k] + v.y * c->axis[1][k] + v.z * c->axis[2][k];
  return (vec3){out[0], out[1], out[2]};
}

void panorama_rays(worker *w, const camera_view *view, const shuffle *points, size_t count) {
  batch *b = w->batch;
  const camera *c = view->camera;
  rays *ray = &b->sample_ray;
  /* points of the picture are those that rays of such a camera start from */
  camera flat = {.axis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .clip = {c->clip[0], c->clip[1]}};
  for (int k = 0; k < 4; k++)
    flat.frame[k] = c->frame[k];
  camera_view plain = *view;
  plain.camera = &flat;
  w->scene->stages->camera(count, &plain, &b->path, ray);
  for (size_t i = 0; i < count; i++) {
    vec3 d, o = {0, 0, 0};
    bool sees = direction(c, ray->o.x[i], ray->o.y[i], &d);
    d = sees ? d : (vec3){0, 0, -1};
    if (points)
      through_lens(c, points, b->path.hash[i], i, &o, &d);
    o = by_axes(c, o);
    store(&ray->o, i, (vec3){o.x + c->origin[0], o.y + c->origin[1], o.z + c->origin[2]});
    store(&ray->d, i, by_axes(c, d));
    ray->tfar[i] = sees ? ray->tfar[i] : -1.0f;
  }
}

void panorama_cover(worker *w, size_t count) {
  batch *b = w->batch;
  for (size_t i = 0; i < count; i++)
    b->path.alpha[i] = b->sample_ray.tfar[i] < 0.0f ? 1.0f : b->path.alpha[i];
}

void panorama_cones(worker *w, const camera_view *view, size_t count) {
  const scene *s = w->scene;
  const camera *c = &s->camera;
  path_states *state = w->batch->state;
  bool by_range = c->panorama == PANORAMA_EQUIRECTANGULAR;
  float across = by_range ? c->range[1] - c->range[0] : c->fov;
  float upright = by_range ? c->range[3] - c->range[2] : c->fov;
  across = fabsf(across * view->step[0]), upright = fabsf(upright * view->step[1]);
  for (size_t i = 0; i < count; i++) {
    vec3 d = load(&w->batch->sample_ray.d, i);
    float high = d.x * c->axis[1][0] + d.y * c->axis[1][1] + d.z * c->axis[1][2];
    float wide = by_range ? across * sqrtf(clampf(1.0f - high * high, 0.0f, 1.0f)) : across;
    state->width[i] = state->pixel[i] = 0.0f;
    state->spread[i] = sqrtf(wide * upright);
    state->widen[i] = 0.5f * (wide + upright);
  }
}
