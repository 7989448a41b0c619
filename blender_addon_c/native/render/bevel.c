/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/occlusion.h"

#include "batch/leaf.h"
#include "stage/stage.h"

#include <math.h>

enum { SURFACES = 64 }; /* that a ray goes through */

/* What a point at a distance weighs, as a part of the radius, up to a factor. */
static float falloff(float x) {
  return x < 1.0f ? (1.0f - x) * (1.0f - x) * (1.0f - x) : 0.0f;
}

/* A distance, as a part of the radius, of a point of the disc by this falloff: the share of it
 * within x is 10 x^2 - 20 x^3 + 15 x^4 - 4 x^5. Newton's steps, kept within what is known. */
static float draw_distance(float u) {
  float low = 0.0f, high = 1.0f, x = 0.5f;
  for (int k = 0; k < 16; k++) {
    float share = x * x * (10.0f + x * (-20.0f + x * (15.0f - 4.0f * x))) - u;
    float slope = 20.0f * x * falloff(x);
    if (share < 0.0f)
      low = x;
    else
      high = x;
    float next = x - share / (slope > 1e-6f ? slope : 1e-6f);
    x = next > low && next < high ? next : 0.5f * (low + high);
  }
  return x;
}

/* Two vectors across a unit vector [Duff2017]. */
static void two_across(vec3 n, vec3 *s, vec3 *t) {
  float sign = n.z < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  *s = (vec3){1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  *t = (vec3){b, sign + n.y * n.y * a, -n.y};
}

/* The k-th ray of each point, through the ball of the radius along one of three axes: the surface's
 * normal or, half as often each, across it. */
static size_t aim_rays(const batch *b, lane_run run, const node_bevel *n, int k, lane_f radius) {
  occlusion *o = b->occlusion;
  const surfaces *at = &b->surface;
  const float *wide = n->radius.at < 0 ? NULL : b->input.at[n->radius.at];
  const double first = 0.7548776662466927 * k, second = 0.5698402909980532 * k;
  size_t count = 0;
  for (size_t i = run.begin; i < run.end; i++) {
    float reach = wide ? wide[i] : n->radius.number;
    vec3 p = load(&at->p, i), g = load(&at->g, i), s, t;
    float length = sqrtf(dot(g, g));
    if (!(reach > 0.0f && reach < 1e18f) || !(length > 0.0f) || !isfinite(p.x + p.y + p.z + length))
      continue;
    float u = o->turn[i] + (float)(first - floor(first)),
          v = o->spin[i] + (float)(second - floor(second));
    u -= u >= 1.0f ? 1.0f : 0.0f;
    v -= v >= 1.0f ? 1.0f : 0.0f;
    vec3 axis = {g.x / length, g.y / length, g.z / length}, drawn = axis;
    two_across(axis, &s, &t);
    float own = 0.5f, beside = 0.25f, last = 0.25f;
    if (u < 0.5f) {
      u *= 2.0f;
    } else if (u < 0.75f) {
      u = 4.0f * (u - 0.5f);
      drawn = s;
      s = axis;
      own = 0.25f;
      beside = 0.5f;
    } else {
      u = 4.0f * (u - 0.75f);
      drawn = t;
      t = axis;
      own = 0.25f;
      last = 0.5f;
    }
    float off = draw_distance(v), turn = 6.2831853f * u, c = reach * off * cosf(turn);
    float d = reach * off * sinf(turn), up = reach * sqrtf(1.0f - off * off);
    vec3 from = {p.x + c * s.x + d * t.x + up * drawn.x, p.y + c * s.y + d * t.y + up * drawn.y,
                 p.z + c * s.z + d * t.z + up * drawn.z};
    store(&o->ray.o, count, from);
    store(&o->ray.d, count, (vec3){-drawn.x, -drawn.y, -drawn.z});
    store(&o->axis, count, drawn);
    store(&o->aside, count, s);
    store(&o->other, count, t);
    o->chance[0][count] = own;
    o->chance[1][count] = beside;
    o->chance[2][count] = last;
    o->off[count] = falloff(off);
    o->ray.tnear[count] = 0.0f;
    o->ray.tfar[count] = 2.0f * up;
    o->ray.time[count] = b->ray->time[i];
    radius[count] = reach;
    o->lane[count++] = (uint32_t)i;
  }
  return count;
}

/* What ray i met adds its normal, by the falloff of its distance, over the density of all three
 * axes' rays there, by the power heuristic [VeachGuibas1995]. */
static void add_normal(const batch *b, occlusion *o, size_t i, float radius) {
  uint32_t lane = o->lane[i];
  const float *row = o->corner.row + 8 * i;
  vec3 g = load(&o->hit.g, i), n = {row[0], row[1], row[2]}, p = load(&b->surface.p, lane);
  float long_ = sqrtf(dot(g, g)), length = sqrtf(dot(n, n)), t = o->ray.tfar[i];
  if (!(long_ > 0.0f) || !(length > 0.0f) || !(o->off[i] > 0.0f))
    return;
  vec3 at = {o->ray.o.x[i] + t * o->ray.d.x[i] - p.x, o->ray.o.y[i] + t * o->ray.d.y[i] - p.y,
             o->ray.o.z[i] + t * o->ray.d.z[i] - p.z};
  const lane_v *axis[3] = {&o->axis, &o->aside, &o->other};
  float density[3], sum = 0.0f;
  for (int k = 0; k < 3; k++) {
    density[k] = o->chance[k][i] * fabsf(dot(load(axis[k], i), g)) / long_;
    sum += density[k] * density[k];
  }
  float far = sqrtf(dot(at, at)) / radius;
  float by = sum > 0.0f ? density[0] / sum * falloff(far) / (o->off[i] * length) : 0.0f;
  by *= b->surface.side[lane];
  o->around.x[lane] += by * n.x;
  o->around.y[lane] += by * n.y;
  o->around.z[lane] += by * n.z;
}

static void add_all(const scene *s, const batch *b, occlusion *o, size_t count, lane_f radius) {
  lane_f far;
  for (size_t i = 0; i < count; i++)
    far[i] = o->ray.tfar[i];
  for (int step = 0; step < SURFACES && count; step++) {
    size_t left = 0, met = 0;
    occlusion_next(s, o, count);
    for (size_t i = 0; i < count; i++) { /* rays that met something, first */
      if (o->hit.record[i] == RECORD_MISS)
        continue;
      far[met] = far[i];
      radius[met] = radius[i];
      o->off[met] = o->off[i];
      o->hit.record[met] = o->hit.record[i];
      o->hit.instance[met] = s->placed ? o->hit.instance[i] : 0;
      o->hit.u[met] = o->hit.u[i];
      o->hit.v[met] = o->hit.v[i];
      store(&o->hit.g, met, load(&o->hit.g, i));
      store(&o->axis, met, load(&o->axis, i));
      store(&o->aside, met, load(&o->aside, i));
      store(&o->other, met, load(&o->other, i));
      for (int k = 0; k < 3; k++)
        o->chance[k][met] = o->chance[k][i];
      float near = o->ray.tnear[i], at = o->ray.tfar[i];
      occlusion_pass(o, i, met, at);
      o->ray.tnear[met++] = near;
    }
    s->stages->corner(met, s->triangle, &o->hit, &o->corner);
    if (s->placed)
      s->stages->place(met, b->placed, &o->hit, &o->corner);
    for (; left < met; left++) {
      if (occlusion_own(s, b, o, left))
        add_normal(b, o, left, radius[left]);
      occlusion_pass(o, left, left, far[left]);
    }
    count = left;
  }
}

void bevel_trace(const scene *s, batch *b, lane_run run, const node_bevel *n) {
  occlusion *o = b->occlusion;
  lane_f radius;
  if (!o)
    return;
  occlusion_draw(o, &b->surface, run);
  for (size_t i = run.begin; i < run.end; i++)
    store(&o->around, i, (vec3){0.0f, 0.0f, 0.0f});
  for (int k = 0; k < n->samples; k++)
    add_all(s, b, o, aim_rays(b, run, n, k, radius), radius);
}
