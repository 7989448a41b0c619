/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Draws of matt surfaces that are aimed at balls. A path that comes from a matt surface to a mirror
 * that shows it a lamp brings much, and few do: these are what most noise of a closed room is made
 * of. So a part of the draws goes to the cones in which the balls are seen, more than the cosine
 * would send there, and density is that of both together: lights share theirs with it as always.
 */
#include "batch/leaf.h"
#include "scene/aims.h"
#include "stage/stage.h"

_Static_assert((int)CONES == (int)AIMS, "a cone for each ball");

#define AIM_PI 3.14159265f
#define AIM_GAIN 4.0f   /* draws that are aimed beside those that go there anyway, */
#define AIM_MOST 0.25f  /* of all draws at most */
#define AIM_LEAST 1e-4f /* sine² of a half angle: below, directions in floats are too coarse */

/* The balls as points of a run see them, and how much goes to each. */
static void stage_aim(lane_run run, const aims *aims, const surfaces *restrict at,
                      cones *restrict out) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++)
    out->rest[i] = 0.0f;
  for (size_t k = 0; k < aims->count; k++) {
    const aim ball = aims->ball[k];
    const float radius2 = ball.radius * ball.radius;
    lane_v *restrict axis = &out->axis[k];
    float *restrict density = out->density[k], *restrict narrow = out->narrow[k];
#pragma omp simd
    for (size_t i = run.begin; i < run.end; i++) {
      vec3 d = {ball.center[0] - at->p.x[i], ball.center[1] - at->p.y[i],
                ball.center[2] - at->p.z[i]};
      float d2 = dot(d, d);
      bool apart = (radius2 < 0.99f * d2) & (d2 < 1e30f);
      float inverse = 1.0f / sqrtf(apart ? d2 : 1.0f), sine2 = apart ? radius2 / d2 : 1.0f;
      float sine = sqrtf(sine2), cosine = sqrtf(1.0f - sine2);
      vec3 a = {inverse * dot(d, load(&at->t, i)), inverse * dot(d, load(&at->b, i)),
                inverse * dot(d, load(&at->n, i))};
      /* the cosine of a ball above the horizon; what is left of one that sinks below it */
      float sunk = a.z + sine > 0.0f ? (a.z + sine) * (a.z + sine) / (4.0f * sine) : 0.0f;
      float seen = a.z > sine ? a.z : sunk;
      float share = AIM_GAIN * 2.0f * sine2 / (1.0f + cosine) * seen;
      share = (apart & (sine2 > AIM_LEAST)) ? share : 0.0f;
      store(axis, i, a);
      narrow[i] = sine2 / (1.0f + cosine);
      density[i] = share;
      out->rest[i] += share;
    }
  }
  for (size_t k = 0; k < aims->count; k++) {
    float *restrict density = out->density[k], *restrict narrow = out->narrow[k];
#pragma omp simd
    for (size_t i = run.begin; i < run.end; i++) {
      float sum = out->rest[i], scale = sum > AIM_MOST ? AIM_MOST / sum : 1.0f;
      density[i] *= scale / (2.0f * AIM_PI * narrow[i]);
    }
  }
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++)
    out->rest[i] = 1.0f - (out->rest[i] < AIM_MOST ? out->rest[i] : AIM_MOST);
}

/* Which draws go where, by x; that is even again. */
static void stage_aim_pick(lane_run run, size_t count, cones *restrict cones, draws *restrict out) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++)
    cones->drawn[i] = CONE_NONE;
  for (size_t k = 0; k < count; k++) {
    const float *restrict density = cones->density[k], *restrict narrow = cones->narrow[k];
#pragma omp simd
    for (size_t i = run.begin; i < run.end; i++) {
      float share = 2.0f * AIM_PI * narrow[i] * density[i], left = out->x[i];
      bool open = cones->drawn[i] == CONE_NONE, takes = open & (left < share);
      float even = clampf(left / (share > 1e-20f ? share : 1e-20f), 0.0f, 0.99999994f);
      cones->drawn[i] = takes ? (uint32_t)k : cones->drawn[i];
      out->x[i] = takes ? even : (open ? left - share : left);
    }
  }
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    float even = clampf(out->x[i] / cones->rest[i], 0.0f, 0.99999994f);
    out->x[i] = cones->drawn[i] == CONE_NONE ? even : out->x[i];
  }
}

/* Their directions, evenly within the cone. */
static void stage_aim_turn(lane_run run, size_t count, const cones *restrict cones,
                           draws *restrict out) {
  for (size_t k = 0; k < count; k++) {
    const lane_v *restrict axis = &cones->axis[k];
    const float *restrict narrow = cones->narrow[k];
#pragma omp simd
    for (size_t i = run.begin; i < run.end; i++) {
      float low = out->x[i] * narrow[i], flat = low * (2.0f - low), s, c;
      flat = sqrtf(flat > 0.0f ? flat : 0.0f);
      turn(out->y[i], &s, &c);
      vec3 u, v, w = load(axis, i);
      across(w, &u, &v);
      float p = flat * c, q = flat * s, r = 1.0f - low;
      vec3 aimed = {p * u.x + q * v.x + r * w.x, p * u.y + q * v.y + r * w.y,
                    p * u.z + q * v.z + r * w.z};
      store(&out->wi, i, select3(cones->drawn[i] == k, aimed, load(&out->wi, i)));
    }
  }
}

/* The density of these directions, of the surface's own, becomes that of all draws. */
static void stage_aim_mix(lane_run run, size_t count, const cones *restrict cones,
                          const lane_v *restrict wi, float *restrict pdf) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++)
    pdf[i] *= cones->rest[i];
  for (size_t k = 0; k < count; k++) {
    const lane_v *restrict axis = &cones->axis[k];
    const float *restrict narrow = cones->narrow[k], *restrict density = cones->density[k];
#pragma omp simd
    for (size_t i = run.begin; i < run.end; i++) {
      vec3 a = load(axis, i), l = load(wi, i), off = {l.x - a.x, l.y - a.y, l.z - a.z};
      bool inside = dot(off, off) < 2.0f * narrow[i]; /* of unit vectors 2 (1 - cosine) */
      pdf[i] += inside ? density[i] : 0.0f;
    }
  }
}

/* Draws and what the surface says of their directions. */
static void stage_aim_take(lane_run run, const reflections *restrict part, draws *restrict out) {
#pragma omp simd
  for (size_t i = run.begin; i < run.end; i++) {
    out->f.r[i] = part->f.r[i];
    out->f.g[i] = part->f.g[i];
    out->f.b[i] = part->f.b[i];
    out->cosine[i] = part->cosine[i];
    out->pdf[i] = out->own[i] = part->pdf[i];
  }
}
