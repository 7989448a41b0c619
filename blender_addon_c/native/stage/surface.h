/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hits to surface points: position, frame, direction to the eye. */
#include "batch/leaf.h"
#include "batch/valid.h"
#include "stage/common.h"
#include "stage/stage.h"

/* Cosine of eye and interpolated normal that is left as it is. */
#define GRAZING 0.002f

/* One corner of a triangle, or the interpolated one. */
typedef float row8 __attribute__((vector_size(32), aligned(4), may_alias));

/*
 * By rows, not by lanes: three loads of a row a hit, where sixteen lanes would gather 24 numbers
 * each from all over memory.
 */
static void stage_corner(size_t count, const triangle *restrict triangles, const hits *restrict hit,
                         corners *restrict corner) {
  for (size_t i = 0; i < count; i++) {
    const triangle *t = &triangles[hit->record[i]];
    const row8 *row = (const row8 *)t->corner;
    float u = hit->u[i], v = hit->v[i];
    *(row8 *)(corner->row + 8 * i) = (1.0f - u - v) * row[0] + u * row[1] + v * row[2];
    corner->handed[i] = t->handed;
    corner->reach[i] = t->reach;
    corner->outward[i] = t->mirrored ? -1.0f : 1.0f;
  }
}

/* By rows too: a hit reads one row of the table, all of it. */
static void stage_place(size_t count, const placed *restrict table, hits *restrict hit,
                        corners *restrict corner) {
  for (size_t i = 0; i < count; i++) {
    const placed *p = &table[hit->instance[i]];
    float g[3] = {hit->g.x[i], hit->g.y[i], hit->g.z[i]};
    turn_row(p->normal, corner->row + 8 * i);
    turn_row(p->linear, corner->row + 8 * i + 3);
    turn_row(p->normal, g);
    store(&hit->g, i, (vec3){g[0], g[1], g[2]});
    corner->handed[i] *= p->mirror;
    corner->reach[i] = p->reach < 0.0f ? corner->reach[i] : p->reach;
  }
}

/* The frame of normal n. */
LEAF void put_frame(const float *restrict row, vec3 n, vec3 d, size_t i, surfaces *restrict out) {
  /* tangent, orthogonal to it; where there is none, any [Duff2017] */
  vec3 t = {row[3], row[4], row[5]};
  float along = dot(t, n);
  t = (vec3){t.x - along * n.x, t.y - along * n.y, t.z - along * n.z};
  float t2 = dot(t, t);
  bool usable = t2 > 1e-12f;
  float sign = n.z < 0.0f ? -1.0f : 1.0f;
  float q = -1.0f / (sign + n.z);
  vec3 any = {1.0f + sign * n.x * n.x * q, sign * n.x * n.y * q, -sign * n.x};
  t = scaled(select3(usable, t, any), 1.0f / sqrtf(usable ? t2 : 1.0f));
  vec3 b = cross(n, t);
  store(&out->n, i, n);
  store(&out->t, i, t);
  store(&out->b, i, b);
  store(&out->wo, i, (vec3){-dot(d, t), -dot(d, b), -dot(d, n)});
}

/* Cosine of eye and normal below which the latter is bent, where `facet` is that of the facet. */
LEAF float least_seen(float facet) {
  facet = facet > 1e-6f ? facet : 1e-6f;
  return 0.5f * facet < GRAZING ? 0.5f * facet : GRAZING;
}

/* Is the eye's mirror image by n too low over the facet, or, of a dump, the eye over n? */
LEAF bool is_bent(bool valid, float seen, float facet, float along) {
  return valid ? 2.0f * seen * along - facet < least_image(facet) : seen < least_seen(facet);
}

/* Along a smooth outline, and on smooth surfaces of few facets, normals turn away from the eye:
 * they are bent back, for a dump by as much of the facet's as leaves them at a grazing angle. Few
 * are: a loop of its own costs less than all lanes' roots. */
static __attribute__((noinline)) void bend_normals(size_t count, const rays *restrict ray,
                                                   const corners *restrict corner, bool valid,
                                                   surfaces *restrict out) {
  for (size_t i = 0; i < count; i++) {
    store(&out->lean, i, (vec3){0.0f, 0.0f, 1.0f});
    vec3 own = load(&out->n, i), n = own, d = load(&ray->d, i), flat = load(&out->g, i);
    flat = scaled(flat, 1.0f / sqrtf(dot(flat, flat)));
    float facet = -dot(flat, d), along = dot(n, flat), least = least_seen(facet);
    if (!is_bent(valid, -dot(n, d), facet, along)) {
      if (!(along < 0.0f))
        continue;
      n = scaled(n, -1.0f); /* nothing is lit that shines, what is matt by the other */
    } else if (valid) {
      n = valid_normal(n, flat, d, facet, along);
    }
    float seen = -dot(n, d);
    if (seen < least) {
      float bend = (least - seen) / ((facet > 1e-6f ? facet : 1e-6f) - least);
      n = (vec3){n.x + bend * flat.x, n.y + bend * flat.y, n.z + bend * flat.z};
      n = scaled(n, 1.0f / sqrtf(dot(n, n)));
    }
    put_frame(corner->row + 8 * i, n, d, i, out);
    vec3 t = load(&out->t, i), b = load(&out->b, i);
    store(&out->lean, i, (vec3){dot(own, t), dot(own, b), dot(own, n)});
  }
}

LEAF void surfaces_of(size_t count, const rays *restrict ray, const hits *restrict hit,
                      const corners *restrict corner, bool valid, surfaces *restrict out) {
  uint32_t bent = 0;
#pragma omp simd reduction(| : bent)
  for (size_t i = 0; i < count; i++) {
    vec3 o = load(&ray->o, i), d = load(&ray->d, i);
    float far = ray->tfar[i];
    store(&out->p, i, (vec3){o.x + far * d.x, o.y + far * d.y, o.z + far * d.z});

    /* geometric normal, towards the eye, as long as the offset of shadow rays */
    vec3 g = load(&hit->g, i);
    float g2 = dot(g, g);
    float back = dot(g, d) > 0.0f ? -1.0f : 1.0f;
    vec3 flat = scaled(g, back / sqrtf(g2 > 1e-36f ? g2 : 1e-36f));
    float offset = SURFACE_OFFSET * (corner->reach[i] + fabsf(o.x) + fabsf(o.y) + fabsf(o.z) + far);
    store(&out->g, i, scaled(flat, offset));

    /* interpolated normal, turned to the eye as the facet's is, for a dump to the side of that;
     * opposite corner normals may cancel */
    const float *row = &corner->row[8 * i];
    vec3 n = {row[0], row[1], row[2]};
    float n2 = dot(n, n);
    bool good = n2 > 1e-12f;
    n = select3(good, n, flat);
    float facing = dot(n, flat) < 0.0f ? -1.0f : 1.0f;
    facing = (valid & good) ? back * corner->outward[i] : facing;
    n = scaled(n, facing / sqrtf(good ? n2 : 1.0f));
    out->side[i] = facing;
    float along = dot(n, flat);
    bent |= (is_bent(valid, -dot(n, d), -dot(flat, d), along) | (along < 0.0f)) ? 1u : 0u;
    put_frame(row, n, d, i, out);
    out->u[i] = row[6];
    out->v[i] = row[7];
  }
  out->leans = bent ? LEANS_AWAY : LEANS_NOT;
  if (bent)
    bend_normals(count, ray, corner, valid, out);
}

/* valid: normals are as closures of Cycles take them, else as a dump's. */
static void stage_surface(size_t count, const rays *restrict ray, const hits *restrict hit,
                          const corners *restrict corner, bool valid, surfaces *restrict out) {
  if (valid)
    surfaces_of(count, ray, hit, corner, true, out);
  else
    surfaces_of(count, ray, hit, corner, false, out);
}

LEAF float from_upper_half(uint16_t bits) {
  union {
    uint32_t bits;
    float number;
  } whole = {(uint32_t)bits << 16};
  return whole.number;
}

/*
 * Facets of a smooth surface that bulges lie below it: their own shadow ends in steps. Shadow rays
 * set out from where the corners' tangent planes say the surface is, by the point's weights
 * [Hanika2021].
 */
static void stage_lift(size_t count, const triangle *restrict triangles,
                       const placed *restrict table, const hits *restrict hit,
                       surfaces *restrict out) {
  static const int other[3][2] = {{1, 2}, {0, 2}, {0, 1}};
  for (size_t i = 0; i < count; i++) {
    const triangle *t = &triangles[hit->record[i]];
    store(&out->lift, i, (vec3){0, 0, 0});
    out->slack[i] = 0.0f;
    if (!t->curved)
      continue;
    float u = hit->u[i], v = hit->v[i], side = out->side[i];
    float weight[3] = {1.0f - u - v, u, v}, lift[3] = {0, 0, 0}, sum = 0;
    for (int k = 0; k < 3; k++) {
      float height = weight[other[k][0]] * from_upper_half(t->height[2 * k]) +
                     weight[other[k][1]] * from_upper_half(t->height[2 * k + 1]);
      float below = side * height < 0.0f ? weight[k] * fabsf(height) * side : 0.0f;
      sum += fabsf(below);
      for (int axis = 0; axis < 3; axis++)
        lift[axis] += below * t->corner[k][axis];
    }
    if (!(sum > 0.0f))
      continue;
    float scale = 1.0f;
    if (table && hit->instance[i]) {
      turn_row(table[hit->instance[i]].linear, lift);
      scale = table[hit->instance[i]].scale;
    }
    store(&out->lift, i, (vec3){scale * lift[0], scale * lift[1], scale * lift[2]});
    out->slack[i] = INFINITY;
  }
}

/* How much an instance shrinks at most: the determinant over the product of two singular values. */
LEAF float least_scale(const placed *p) {
  const float(*m)[3] = p->linear;
  float volume = 0.0f, squares = 0.0f;
  for (int k = 0; k < 3; k++) {
    int next = (k + 1) % 3, last = (k + 2) % 3;
    volume += m[0][k] * (m[1][next] * m[2][last] - m[1][last] * m[2][next]);
    squares += m[k][0] * m[k][0] + m[k][1] * m[k][1] + m[k][2] * m[k][2];
  }
  return 2.0f * p->scale * fabsf(volume) / squares;
}

LEAF float widest_uv(bool instances, size_t count, const stretch *restrict triangles,
                     const placed *restrict table, const hits *restrict hit,
                     const float *restrict width) {
  float most = 0.0f;
#pragma omp simd reduction(max : most)
  for (size_t i = 0; i < count; i++) {
    float own = width[i] * triangles[hit->record[i]].dense;
    if (instances)
      own = hit->instance[i] ? own / least_scale(&table[hit->instance[i]]) : own;
    most = own > most ? own : most;
  }
  return most;
}

static void stage_uv_width(size_t count, const stretch *restrict triangles,
                           const placed *restrict table, const hits *restrict hit,
                           surfaces *restrict out) {
  out->uv_width = table ? widest_uv(true, count, triangles, table, hit, out->width)
                        : widest_uv(false, count, triangles, NULL, hit, out->width);
}

/* How u and v go along the edges that stand for them. */
static __attribute__((noinline)) void along_edges(size_t count, const stretch *restrict stretches,
                                                  const triangle *restrict triangles,
                                                  const hits *restrict hit,
                                                  surfaces *restrict out) {
  for (size_t i = 0; i < count; i++) {
    const float(*corner)[8] = triangles[hit->record[i]].corner;
    vec3 u = {1.0f, 0.0f, 0.0f}, v = {0.0f, 1.0f, 0.0f};
    if (stretches[hit->record[i]].edges) {
      u = (vec3){corner[1][6] - corner[0][6], corner[1][7] - corner[0][7], 0.0f};
      v = (vec3){corner[2][6] - corner[0][6], corner[2][7] - corner[0][7], 0.0f};
    }
    store(&out->u_along, i, u);
    store(&out->v_along, i, v);
  }
}

/* Position by u and v, in the world. */
static void stage_stretch(size_t count, const stretch *restrict stretches,
                          const triangle *restrict triangles, const placed *restrict table,
                          const hits *restrict hit, surfaces *restrict out) {
  uint32_t edges = 0;
  for (size_t i = 0; i < count; i++) {
    stretch s = stretches[hit->record[i]];
    float scale = 1.0f;
    edges |= s.edges;
    if (table && hit->instance[i]) {
      const placed *p = &table[hit->instance[i]];
      scale = p->scale;
      turn_row(p->linear, s.u);
      turn_row(p->linear, s.v);
    }
    store(&out->du, i, (vec3){scale * s.u[0], scale * s.u[1], scale * s.u[2]});
    store(&out->dv, i, (vec3){scale * s.v[0], scale * s.v[1], scale * s.v[2]});
  }
  out->edges = edges != 0;
  if (edges)
    along_edges(count, stretches, triangles, hit, out);
}

static void stage_identify(size_t count, const triangle *restrict triangles,
                           const placed *restrict table, const hits *restrict hit,
                           surfaces *restrict out) {
  memcpy(out->record, hit->record, count * sizeof *out->record);
  memcpy(out->w1, hit->u, count * sizeof *out->w1);
  memcpy(out->w2, hit->v, count * sizeof *out->w2);
  for (size_t i = 0; i < count; i++) {
    uint32_t instance = table ? hit->instance[i] : 0;
    out->instance[i] = instance;
    out->object[i] = instance ? table[instance].object : triangles[hit->record[i]].object;
  }
}

/* What is not perturbed, in the shading frame. */
static void stage_flat(const segment *g, inputs *restrict out) {
  float *x = out->at[REGISTER_NORMAL], *y = out->at[REGISTER_NORMAL + 1];
  float *z = out->at[REGISTER_NORMAL + 2];
#pragma omp simd
  for (size_t i = g->run.begin; i < g->run.end; i++) {
    x[i] = 0.0f;
    y[i] = 0.0f;
    z[i] = 1.0f;
  }
}
