/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hits to triangle records, and samples to hits and back. */
#include "batch/leaf.h"
#include "stage/stage.h"

LEAF size_t locate(bool instances, size_t count, uint32_t triangle_base,
                   const placed *restrict table, hits *restrict hit) {
  uint32_t found = 0;
#pragma omp simd reduction(+ : found)
  for (size_t i = 0; i < count; i++) {
    bool hits = hit->geometry[i] != ACCEL_MISS;
    bool quad = hit->geometry[i] == ACCEL_QUADS;
    bool second = quad & (hit->u[i] + hit->v[i] > 1.0f);
    uint32_t quads = instances ? table[hit->instance[i]].quad : 0;
    uint32_t singles = instances ? table[hit->instance[i]].single : triangle_base;
    uint32_t of_quad = quads + 2 * hit->primitive[i] + (second ? 1u : 0u);
    uint32_t index = quad ? of_quad : singles + hit->primitive[i];
    hit->u[i] = second ? 1.0f - hit->u[i] : hit->u[i];
    hit->v[i] = second ? 1.0f - hit->v[i] : hit->v[i];
    hit->record[i] = hits ? index : RECORD_MISS;
    found += hits ? 1u : 0u;
  }
  return found;
}

static size_t stage_locate(size_t count, uint32_t triangle_base, const placed *table, hits *hit) {
  return table ? locate(true, count, triangle_base, table, hit)
               : locate(false, count, triangle_base, NULL, hit);
}

static void stage_cover(size_t count, const hits *restrict hit, paths *restrict path) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    path->alpha[i] = hit->record[i] != RECORD_MISS ? 1.0f : 0.0f;
}

static void stage_gather(size_t count, const uint32_t *restrict lane, const float *restrict in,
                         float *restrict out) {
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    out[i] = in[lane[i]];
}

static void stage_scatter(size_t count, const uint32_t *restrict lane, const lane_c *restrict in,
                          lane_c *restrict out) {
  for (size_t i = 0; i < count; i++) {
    out->r[lane[i]] = in->r[i];
    out->g[lane[i]] = in->g[i];
    out->b[lane[i]] = in->b[i];
  }
}
