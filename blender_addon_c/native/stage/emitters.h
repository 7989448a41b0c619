/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles that shine, as a light. */
#include "batch/leaf.h"
#include "scene/emitters.h"
#include "stage/common.h"
#include "stage/stage.h"

/* As if they were one bulb as large as the ball that holds them. */
static void stage_weigh_emitters(size_t count, const emitters *e, const lane_v *restrict p,
                                 float *restrict one) {
  const float x = e->center[0], y = e->center[1], z = e->center[2];
  const float power = e->power, radius2 = e->radius2 > 1e-18f ? e->radius2 : 1e-18f;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    vec3 d = {p->x[i] - x, p->y[i] - y, p->z[i] - z};
    one[i] = clampf(power / (dot(d, d) + radius2), 0.0f, 1e30f);
  }
}

/* Density per solid angle of a point that is drawn with this one per area. */
LEAF float emitter_pdf(float per_area, float d2, float cosine) {
  return per_area * d2 / (cosine > 1e-9f ? cosine : 1e-9f);
}

LEAF void lit_by_emitters(bool lifted, size_t begin, size_t end, const light_choices *choice,
                          const emitters *e, const surfaces *restrict at,
                          const light_samples *restrict from, light_draws *restrict out) {
  const uint32_t *restrict lane = choice->lane;
  const float *restrict chances = choice->chance;
  const float *restrict sum = e->sum, *restrict row = e->row;
  const int32_t count = (int32_t)e->count;
  const float bright = e->bright;
  int32_t triangle[BATCH];
  int32_t most = 1;
  while (most < count)
    most *= 2;
  for (size_t k = begin; k < end; k++)
    triangle[k] = 0;
  for (int32_t step = most / 2; step; step /= 2) /* the last whose sum is not above x */
#pragma omp simd
    for (size_t k = begin; k < end; k++) {
      int32_t next = triangle[k] + step;
      next = next < count ? next : count; /* where the sum is 1 */
      triangle[k] = sum[next] <= from->x[lane[k]] ? next : triangle[k];
    }
#pragma omp simd
  for (size_t k = begin; k < end; k++) {
    uint32_t i = lane[k];
    int32_t t = triangle[k], r = EMITTER_ROW * t;
    float below = sum[t], share = sum[t + 1] - below;
    float x = clampf((from->x[i] - below) / (share > 1e-30f ? share : 1e-30f), 0.0f, 1.0f);
    float root = sqrtf(x), a = root * (1.0f - from->y[i]), b = root * from->y[i];
    vec3 u = {row[r + 3], row[r + 4], row[r + 5]}, v = {row[r + 6], row[r + 7], row[r + 8]};
    vec3 q = {row[r] + a * u.x + b * v.x, row[r + 1] + a * u.y + b * v.y,
              row[r + 2] + a * u.z + b * v.z};
    vec3 p = {at->p.x[i], at->p.y[i], at->p.z[i]};
    vec3 d = {q.x - p.x, q.y - p.y, q.z - p.z}, n = cross(u, v);
    /* from where the shadow ray sets out, or it would meet its own triangle before its end */
    vec3 g = {at->g.x[i], at->g.y[i], at->g.z[i]};
    float off = dot(d, g) < 0.0f ? -1.0f : 1.0f;
    d = (vec3){d.x - off * g.x, d.y - off * g.y, d.z - off * g.z};
    if (lifted) {
      vec3 above = {d.x - at->lift.x[i], d.y - at->lift.y[i], d.z - at->lift.z[i]};
      d = select3(off > 0.0f, above, d);
    }
    float d2 = dot(d, d), n2 = dot(n, n);
    bool apart = (d2 > 1e-30f) & (n2 > 0.0f);
    float distance = sqrtf(apart ? d2 : 1.0f);
    d = scaled(d, 1.0f / distance);
    float cosine = fabsf(dot(d, n)) / sqrtf(apart ? n2 : 1.0f);
    vec3 color = {row[r + 9], row[r + 10], row[r + 11]};
    float per_area = (fabsf(color.x) + fabsf(color.y) + fabsf(color.z)) * (1.0f / 3.0f) / bright;
    float pdf = emitter_pdf(per_area, d2, cosine) * chances[i];
    bool shines = apart & (cosine > 1e-6f) & (pdf > 0.0f);
    /* the ray ends before the triangle, as far as rays start off their surfaces */
    float reach = fabsf(p.x) + fabsf(p.y) + fabsf(p.z) + fabsf(q.x) + fabsf(q.y) + fabsf(q.z);
    store(&out->d, k, d);
    out->tnear[k] = 0.0f;
    out->tfar[k] = distance - 2.0f * SURFACE_OFFSET * (reach + distance);
    out->e[k] = shines ? 1.0f / (shines ? pdf : 1.0f) : 0.0f;
    out->pdf[k] = shines ? pdf : 0.0f;
    out->triangle[k] = (uint32_t)t;
    out->color.r[k] = color.x;
    out->color.g[k] = color.y;
    out->color.b[k] = color.z;
  }
}

static void stage_lit_by_emitters(size_t begin, size_t end, const light_choices *choice,
                                  bool lifted, const emitters *e, const surfaces *restrict at,
                                  const light_samples *restrict from, light_draws *restrict out) {
  if (lifted)
    lit_by_emitters(true, begin, end, choice, e, at, from, out);
  else
    lit_by_emitters(false, begin, end, choice, e, at, from, out);
}

/* What rays meet of them, into met, each with the share that is left to drawn rays. One by one: few
 * rays meet any. weight: as of stage_table.meet. dark: by ray, not 0 where what it meets does not
 * shine for it; or NULL. */
static void stage_hit_emitters(size_t count, const emitters *e, const triangle *restrict triangles,
                               const placed *restrict table, const hits *restrict hit,
                               const rays *restrict ray, const path_states *restrict state,
                               const float *restrict weight, const uint32_t *restrict dark,
                               lane_c *restrict emitted) {
  for (size_t k = 0; k < count; k++) {
    if (hit->record[k] == RECORD_MISS || (dark && dark[k]))
      continue;
    const float *of = e->material + 4 * (size_t)triangles[hit->record[k]].material;
    if (!(of[3] > 0.0f))
      continue;
    float normal[3] = {hit->g.x[k], hit->g.y[k], hit->g.z[k]};
    if (table)
      turn_row(table[hit->instance[k]].normal, normal);
    vec3 o = load(&ray->o, k), d = load(&ray->d, k), from = load(&state->from, k);
    vec3 n = {normal[0], normal[1], normal[2]};
    float far = ray->tfar[k];
    vec3 to = {o.x + far * d.x - from.x, o.y + far * d.y - from.y, o.z + far * d.z - from.z};
    float n2 = dot(n, n), cosine = fabsf(dot(d, n)) / sqrtf(n2 > 1e-36f ? n2 : 1e-36f);
    float chance = weight ? weight[k] / state->lights[k] : 1.0f;
    float part = balance(state->pdf[k], emitter_pdf(of[3], dot(to, to), cosine) * chance);
    emitted->r[k] += part * of[0];
    emitted->g[k] += part * of[1];
    emitted->b[k] += part * of[2];
  }
}
