/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By which way points are seen, where nodes ask. Rays that go straight on count as one with the ray
 * before. */
#include "batch/leaf.h"
#include "stage/stage.h"

/* The camera's rays count from the near clipping plane on. */
static void stage_route_begin(size_t count, const rays *restrict ray, path_states *restrict state) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    state->length[i] = -ray->tnear[i];
}

static void stage_route_hit(size_t count, const uint32_t *restrict lane,
                            const path_states *restrict state, const rays *restrict ray,
                            surfaces *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    uint32_t from = lane[i];
    out->ray[i] = state->ray[from];
    out->length[i] = state->length[from] + ray->tfar[i];
  }
  for (uint32_t kind = 0; kind < BOUNCE_KINDS; kind++) {
    const uint32_t *restrict bounces = state->bounces[kind];
    uint32_t *restrict depth = out->depth[kind];
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      depth[i] = bounces[lane[i]];
  }
}

static void stage_route_next(size_t rays, const uint32_t *restrict chosen,
                             const surfaces *restrict at, const draws *restrict draw,
                             path_states *restrict next) {
#pragma omp simd
  for (size_t k = 0; k < rays; k++) {
    uint32_t i = chosen[k];
    bool straight = (draw->kind[i] & BOUNCE_MASK) == BOUNCE_TRANSPARENT;
    next->length[k] = straight ? at->length[i] : 0.0f;
  }
}

/* Of shadow rays on their way, by hit; sender: the paths' own hits. */
static void stage_route_shadow(size_t count, uint32_t left, const uint32_t *restrict lane,
                               const passages *restrict way, const uint32_t *restrict sender,
                               const path_states *restrict state, const rays *restrict ray,
                               surfaces *restrict out) {
  for (size_t i = 0; i < count; i++) {
    uint32_t k = lane[i], from = sender[way->hit[k]];
    out->ray[i] = RAY_SHADOW;
    out->length[i] = way->gone[k] + ray->tfar[i];
    for (uint32_t kind = 0; kind < BOUNCE_KINDS; kind++)
      out->depth[kind][i] = state->bounces[kind][from];
    out->depth[BOUNCE_TRANSPARENT][i] = left - way->left[k];
  }
}
