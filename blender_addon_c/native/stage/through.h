/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shadow rays on their way through transparent surfaces. What goes by rays is written one by one:
 * few rays are stopped. */
#include "batch/leaf.h"
#include "stage/stage.h"

/* The shadow rays that something stops, from where they set out, as long as they may go through
 * surfaces; left: how many those of a path that went through none may; all: also those that may go
 * through none. Returns their number. */
static size_t stage_stopped(size_t count, uint32_t left, bool all, const uint32_t *restrict lane,
                            const path_states *restrict state, const light_samples *restrict light,
                            passages *restrict way, rays *restrict ray) {
  size_t found = 0;
  for (size_t i = 0; i < count; i++) {
    uint32_t passed = state->bounces[BOUNCE_TRANSPARENT][lane[i]];
    way->hit[found] = (uint32_t)i;
    way->left[found] = passed < left ? left - passed : 0;
    found += (light->ray.tfar[i] < -1e30f) & (all | (passed < left));
    way->tint.r[i] = way->tint.g[i] = way->tint.b[i] = 1.0f;
  }
#pragma omp simd
  for (size_t k = 0; k < found; k++) {
    uint32_t i = way->hit[k];
    ray->o.x[k] = light->ray.o.x[i];
    ray->o.y[k] = light->ray.o.y[i];
    ray->o.z[k] = light->ray.o.z[i];
    ray->d.x[k] = light->ray.d.x[i];
    ray->d.y[k] = light->ray.d.y[i];
    ray->d.z[k] = light->ray.d.z[i];
    ray->tnear[k] = 0.0f;
    ray->tfar[k] = way->rest[k] = way->tfar[i];
    way->gone[k] = 0.0f;
  }
  return found;
}

/* Rays that meet nothing more reach their light; those at a surface that lets nothing pass, or at
 * one more than they may go through, count as misses, where these are not `free`, as some are if
 * the scene `shades`. Returns the number of the others. */
static size_t stage_sift(size_t count, const triangle *restrict triangles,
                         const material *restrict materials, bool shades,
                         const passages *restrict way, uint32_t *restrict record,
                         light_samples *restrict light) {
  size_t found = 0;
  for (size_t k = 0; k < count; k++) {
    uint32_t i = way->hit[k], r = record[k];
    if (r == RECORD_MISS)
      light->ray.tfar[i] = way->tfar[i];
    else if (!(shades && way->free[k]) &&
             (!way->left[k] || !(materials[triangles[r].material].traits & CLOSURE_PASSES)))
      record[k] = RECORD_MISS;
    found += record[k] != RECORD_MISS;
  }
  return found;
}

/* Light that surfaces let through, and the rays on from there, one surface less before them. They
 * set out as far off it as any ray, to the same end: beside that there may be a surface that
 * shines. Returns their number. */
static size_t stage_pass(size_t count, const uint32_t *restrict lane, const surfaces *restrict at,
                         const rays *restrict came, const lane_c *restrict share, bool shades,
                         passages *restrict way, rays *restrict ray,
                         light_samples *restrict light) {
  size_t goes = 0;
  for (size_t i = 0; i < count; i++) {
    uint32_t k = lane[i], hit = way->hit[k];
    bool open = shades && way->free[k];
    float r = clampf(way->tint.r[hit] * (open ? 1.0f : share->r[i]), 0.0f, 1e30f);
    float g = clampf(way->tint.g[hit] * (open ? 1.0f : share->g[i]), 0.0f, 1e30f);
    float b = clampf(way->tint.b[hit] * (open ? 1.0f : share->b[i]), 0.0f, 1e30f);
    vec3 off = load(&at->g, i), p = load(&at->p, i), d = load(&came->d, i);
    vec3 start = {p.x - off.x, p.y - off.y, p.z - off.z};
    float rest = way->rest[k] - came->tfar[i];
    if (rest < 1e18f) {
      vec3 to = {rest * d.x + off.x, rest * d.y + off.y, rest * d.z + off.z};
      float far2 = dot(to, to), far = sqrtf(far2 > 1e-36f ? far2 : 1e-36f);
      rest =
          ((rest > 0.0f) & (dot(to, off) < 0.0f)) ? far : 0.0f; /* 0: the end is on the surface */
      d = scaled(to, 1.0f / far);
    }
    way->tint.r[hit] = r;
    way->tint.g[hit] = g;
    way->tint.b[hit] = b;
    if (!(r + g + b > 0.0f))
      continue;
    if (!(rest > 0.0f)) {
      light->ray.tfar[hit] = way->tfar[hit];
      continue;
    }
    store(&ray->o, goes, start);
    store(&ray->d, goes, d);
    ray->tnear[goes] = 0.0f;
    ray->tfar[goes] = rest;
    way->next_hit[goes] = hit;
    way->next_gone[goes] = way->gone[k] + came->tfar[i];
    way->next_left[goes++] = way->left[k] - (open ? 0 : 1);
  }
  for (size_t k = 0; k < goes; k++) {
    way->hit[k] = way->next_hit[k];
    way->left[k] = way->next_left[k];
    way->gone[k] = way->next_gone[k];
    way->rest[k] = ray->tfar[k];
  }
  return goes;
}

/* The light of each sample as it arrives. color NULL: each has its own. */
static void stage_tint(size_t count, const float color[3], const passages *restrict way,
                       light_samples *restrict light) {
  const float red = color ? color[0] : 0.0f, green = color ? color[1] : 0.0f;
  const float blue = color ? color[2] : 0.0f;
  const float own = color ? 0.0f : 1.0f;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    light->color.r[i] = way->tint.r[i] * (own > 0.0f ? light->color.r[i] : red);
    light->color.g[i] = way->tint.g[i] * (own > 0.0f ? light->color.g[i] : green);
    light->color.b[i] = way->tint.b[i] * (own > 0.0f ? light->color.b[i] : blue);
  }
}
