/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hits to triangle records, and lanes to hits and back. */
#include "batch/leaf.h"

static size_t stage_locate(size_t count, uint32_t triangle_base, const uint32_t *restrict geometry,
                           const uint32_t *restrict primitive, float *restrict u, float *restrict v,
                           uint32_t *restrict record, float *restrict alpha) {
  uint32_t hits = 0;
  for (size_t i = 0; i < count; i++) {
    bool hit = geometry[i] != ACCEL_MISS;
    bool quad = geometry[i] == ACCEL_QUADS;
    bool second = quad & (u[i] + v[i] > 1.0f);
    uint32_t of_quad = 2 * primitive[i] + (second ? 1u : 0u);
    uint32_t index = quad ? of_quad : triangle_base + primitive[i];
    u[i] = second ? 1.0f - u[i] : u[i];
    v[i] = second ? 1.0f - v[i] : v[i];
    record[i] = hit ? index : RECORD_MISS;
    alpha[i] = hit ? 1.0f : 0.0f;
    hits += hit ? 1u : 0u;
  }
  return hits;
}

static void stage_gather(size_t count, const uint32_t *restrict lane, const float *restrict in,
                         float *restrict out) {
  for (size_t i = 0; i < count; i++)
    out[i] = in[lane[i]];
}

static void stage_scatter(size_t count, const uint32_t *restrict lane, const float *restrict in,
                          float *restrict out) {
  for (size_t i = 0; i < count; i++)
    out[lane[i]] = in[i];
}
