/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Tangents of a UV-mapped triangle mesh, by the rules of MikkTSpace.
 *
 * 1. weld: corners with equal position, normal and UV become one vertex.
 * 2. link: triangles that run along the same edge in opposite directions become
 *    neighbours there, in pairs.
 * 3. fans: around a vertex, neighbours of the same handedness make one group,
 *    and the group has one tangent: the mean of dP/du over its corners, each
 *    projected on the normal's plane, weighted by the corner's angle.
 * 4. share: corners that no group took get the tangent of a group at the same
 *    vertex, or any direction where there is none.
 *
 * An edge and its first corner have the same number, 3 * triangle + 0..2. All
 * sums are in double, where no product of three floats can overflow.
 * [Mikkelsen2008, Simulation of Wrinkled Surfaces Revisited]
 */
#include "shade/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NOTHING UINT32_MAX

/* What a triangle is, as bits. */
enum {
  FACET_NEGATIVE = 1,   /* UV area < 0 in the order of its corners: the map is mirrored */
  FACET_FLAT = 2,       /* no UV area: adds nothing, takes part in its neighbours' groups */
  FACET_UNDECIDED = 4,  /* flat, and no group has lent it a handedness yet */
  FACET_DEGENERATE = 8, /* two corners at one place: no part in any group */
};

struct mesh {
  const float *position, *normal, *uv;
  const uint32_t *corner_position;
  uint32_t corners;
  uint32_t *vertex;   /* per corner: first corner with the same values */
  uint32_t *opposite; /* per edge: the neighbour's edge, or NOTHING */
  uint32_t *group;    /* per corner: first corner of its group, or NOTHING */
  uint32_t *table;    /* hash table with open addressing */
  size_t mask;        /* its length - 1, length a power of two */
  uint8_t *facet;     /* per triangle: the bits above */
};

/* ---- values of a corner -------------------------------------------------- */

static float finite_or_zero(float x) {
  return isfinite(x) ? x + 0.0f : 0.0f; /* + 0 makes -0 equal to 0 bit by bit */
}

static void position_of(const struct mesh *m, uint32_t c, double out[3]) {
  const float *p = m->position + 3 * (size_t)m->corner_position[c];
  for (int i = 0; i < 3; ++i)
    out[i] = (double)finite_or_zero(p[i]);
}

static void uv_of(const struct mesh *m, uint32_t c, double out[2]) {
  for (int i = 0; i < 2; ++i)
    out[i] = (double)finite_or_zero(m->uv[2 * (size_t)c + (size_t)i]);
}

static uint32_t next_corner(uint32_t c) {
  return c % 3 == 2 ? c - 2 : c + 1;
}
static uint32_t previous_corner(uint32_t c) {
  return c % 3 == 0 ? c + 2 : c - 1;
}

/* ---- vectors ------------------------------------------------------------- */

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Scale to length 1. A zero vector stays as it is and gives 0. */
static int normalise(double v[3]) {
  double length = sqrt(dot(v, v));
  if (!(length > 0))
    return 0;
  for (int i = 0; i < 3; ++i)
    v[i] /= length;
  return 1;
}

/*
 * Make the part of unit v that lies in the plane of unit n, of length 1; 0 if
 * there is none. Below 1e-7 it would be the rounding of the float normal.
 */
static int project(double v[3], const double n[3]) {
  double along = dot(v, n);
  for (int i = 0; i < 3; ++i)
    v[i] -= along * n[i];
  return dot(v, v) > 1e-14 && normalise(v);
}

static void normal_of(const struct mesh *m, uint32_t c, double out[3]) {
  for (int i = 0; i < 3; ++i)
    out[i] = (double)finite_or_zero(m->normal[3 * (size_t)c + (size_t)i]);
  normalise(out);
}

/* ---- 1. weld --------------------------------------------------------------- */

static void values_of(const struct mesh *m, uint32_t c, float out[8]) {
  const float *p = m->position + 3 * (size_t)m->corner_position[c];
  memcpy(out, p, 3 * sizeof *out);
  memcpy(out + 3, m->normal + 3 * (size_t)c, 3 * sizeof *out);
  memcpy(out + 6, m->uv + 2 * (size_t)c, 2 * sizeof *out);
  for (int i = 0; i < 8; ++i)
    out[i] = finite_or_zero(out[i]);
}

/* Two rounds of multiply and shift: neighbours in space end up far apart. */
static uint64_t mix(uint64_t h) {
  h = (h ^ (h >> 32)) * UINT64_C(0x9e3779b97f4a7c15);
  h = (h ^ (h >> 29)) * UINT64_C(0xd1342543de82ef95);
  return h ^ (h >> 32);
}

static uint64_t hash_values(const float values[8]) {
  uint64_t pairs[4], h = 0;
  memcpy(pairs, values, sizeof pairs);
  for (int i = 0; i < 4; ++i)
    h = mix(h + pairs[i]);
  return h;
}

static void clear_table(struct mesh *m) {
  memset(m->table, 0xff, (m->mask + 1) * sizeof *m->table); /* NOTHING */
}

static void weld(struct mesh *m) {
  clear_table(m);
  for (uint32_t c = 0; c < m->corners; ++c) {
    float mine[8], other[8];
    values_of(m, c, mine);
    size_t slot = (size_t)hash_values(mine) & m->mask;
    for (; m->table[slot] != NOTHING; slot = (slot + 1) & m->mask) {
      values_of(m, m->table[slot], other);
      if (memcmp(mine, other, sizeof mine) == 0)
        break;
    }
    if (m->table[slot] == NOTHING)
      m->table[slot] = c;
    m->vertex[c] = m->table[slot];
  }
}

/* ---- triangles ------------------------------------------------------------- */

/* The direction of dP/du, unit, or zero where there is none; returns twice the UV area. */
static double triangle_dpdu(const struct mesh *m, uint32_t first, double dpdu[3]) {
  double p[3][3], uv[3][2];
  for (uint32_t i = 0; i < 3; ++i) {
    position_of(m, first + i, p[i]);
    uv_of(m, first + i, uv[i]);
  }
  double u1 = uv[1][0] - uv[0][0], v1 = uv[1][1] - uv[0][1];
  double u2 = uv[2][0] - uv[0][0], v2 = uv[2][1] - uv[0][1];
  double area = u1 * v2 - v1 * u2;
  for (int i = 0; i < 3; ++i)
    dpdu[i] = copysign(1.0, area) * (v2 * (p[1][i] - p[0][i]) - v1 * (p[2][i] - p[0][i]));
  normalise(dpdu);
  return area;
}

static int same_place(const struct mesh *m, uint32_t a, uint32_t b) {
  double p[3], q[3];
  position_of(m, a, p);
  position_of(m, b, q);
  return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

static void classify(struct mesh *m) {
  for (uint32_t t = 0; t < m->corners / 3; ++t) {
    uint32_t c = 3 * t;
    double dpdu[3], area = triangle_dpdu(m, c, dpdu);
    if (same_place(m, c, c + 1) || same_place(m, c + 1, c + 2) || same_place(m, c + 2, c))
      m->facet[t] = FACET_DEGENERATE;
    else if (area == 0)
      m->facet[t] = FACET_FLAT | FACET_UNDECIDED;
    else
      m->facet[t] = area < 0 ? FACET_NEGATIVE : 0;
  }
}

/* ---- 2. link --------------------------------------------------------------- */

/*
 * Edges wait in line, one line per pair of vertices, until one comes that runs
 * the other way; so all that wait run the same way, and where more than two
 * triangles meet the earliest are paired first. A table slot names the last of a
 * line, whose successor is the first; m->group holds the successors, NOTHING
 * where the line has run empty (the slot still says whose line it is).
 */
static void link_edge(struct mesh *m, uint32_t edge) {
  uint32_t *successor = m->group;
  uint32_t from = m->vertex[edge], to = m->vertex[next_corner(edge)];
  uint64_t low = from < to ? from : to, high = from < to ? to : from;
  size_t slot = (size_t)mix(low << 32 | high) & m->mask;
  int opposite = 0;
  for (; m->table[slot] != NOTHING; slot = (slot + 1) & m->mask) {
    uint32_t a = m->vertex[m->table[slot]], b = m->vertex[next_corner(m->table[slot])];
    opposite = a == to && b == from;
    if (opposite || (a == from && b == to))
      break;
  }
  uint32_t last = m->table[slot];
  int waiting = last != NOTHING && successor[last] != NOTHING;
  if (waiting && opposite) {
    uint32_t first = successor[last];
    successor[last] = first == last ? NOTHING : successor[first];
    m->opposite[edge] = first;
    m->opposite[first] = edge;
  } else {
    successor[edge] = waiting ? successor[last] : edge;
    if (waiting)
      successor[last] = edge;
    m->table[slot] = edge;
  }
}

static void link_edges(struct mesh *m) {
  clear_table(m);
  memset(m->opposite, 0xff, m->corners * sizeof *m->opposite); /* NOTHING */
  memset(m->group, 0xff, m->corners * sizeof *m->group);
  for (uint32_t c = 0; c < m->corners; ++c)
    if (m->facet[c / 3] != FACET_DEGENERATE)
      link_edge(m, c);
}

/* ---- 3. fans --------------------------------------------------------------- */

/* The corner at the same vertex across the edge that leaves (or enters) it. */
static uint32_t across_leaving(const struct mesh *m, uint32_t c) {
  uint32_t edge = m->opposite[c];
  return edge == NOTHING ? NOTHING : next_corner(edge);
}
static uint32_t across_entering(const struct mesh *m, uint32_t c) {
  return m->opposite[previous_corner(c)];
}

/* Angle of the triangle at corner c, seen along the normal, in radians. */
static double corner_angle(const struct mesh *m, uint32_t c, const double n[3]) {
  double p[3], a[3], b[3];
  position_of(m, c, p);
  position_of(m, next_corner(c), a);
  position_of(m, previous_corner(c), b);
  for (int i = 0; i < 3; ++i) {
    a[i] -= p[i];
    b[i] -= p[i];
  }
  normalise(a);
  normalise(b);
  if (!project(a, n) || !project(b, n))
    return 0;
  double cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                     a[0] * b[1] - a[1] * b[0]};
  return atan2(sqrt(dot(cross, cross)), dot(a, b));
}

/*
 * Walk from corner c through its fan, away across one kind of edge, until it
 * ends or another group or the other handedness is met. Adds to sum.
 */
static void walk_fan(struct mesh *m, uint32_t c,
                     uint32_t (*across)(const struct mesh *m, uint32_t c), uint32_t group,
                     const double n[3], double sum[3]) {
  const uint8_t handedness = m->facet[group / 3] & FACET_NEGATIVE;
  for (; c != NOTHING && m->group[c] == NOTHING; c = across(m, c)) {
    uint8_t *facet = &m->facet[c / 3];
    if (*facet & FACET_UNDECIDED)
      *facet = FACET_FLAT | handedness;
    if ((*facet & FACET_NEGATIVE) != handedness)
      return;
    m->group[c] = group;
    double dpdu[3];
    triangle_dpdu(m, c - c % 3, dpdu);
    if ((*facet & FACET_FLAT) || !project(dpdu, n))
      continue;
    double angle = corner_angle(m, c, n);
    for (int i = 0; i < 3; ++i)
      sum[i] += angle * dpdu[i];
  }
}

/* Puts the tangent of each group, or zero, at the group's first corner. */
static void make_groups(struct mesh *m, float *tangent) {
  memset(m->group, 0xff, m->corners * sizeof *m->group); /* NOTHING */
  for (uint32_t c = 0; c < m->corners; ++c) {
    const uint8_t facet = m->facet[c / 3];
    if (m->group[c] != NOTHING || (facet & (FACET_FLAT | FACET_DEGENERATE)))
      continue;
    double n[3], sum[3] = {0, 0, 0};
    normal_of(m, c, n);
    walk_fan(m, c, across_leaving, c, n, sum);
    walk_fan(m, across_entering(m, c), across_entering, c, n, sum);
    normalise(sum);
    float *t = tangent + 4 * (size_t)c;
    for (int i = 0; i < 3; ++i)
      t[i] = (float)sum[i];
    t[3] = (facet & FACET_NEGATIVE) ? -1.0f : 1.0f;
  }
}

/* ---- 4. share -------------------------------------------------------------- */

/* Any unit vector orthogonal to n, from the axis that is least along it. */
static void any_tangent(const double n[3], float t[4]) {
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (fabs(n[i]) < fabs(n[axis]))
      axis = i;
  double v[3] = {axis == 0, axis == 1, axis == 2};
  project(v, n);
  for (int i = 0; i < 3; ++i)
    t[i] = (float)v[i];
  t[3] = 1;
}

/* Give corner c the tangent stored at corner `source`; 1 if there is none. */
static uint32_t settle(const struct mesh *m, uint32_t c, uint32_t source, float *tangent) {
  const float *from = tangent + 4 * (size_t)source;
  float *to = tangent + 4 * (size_t)c;
  if (source == NOTHING || (from[0] == 0 && from[1] == 0 && from[2] == 0)) {
    double n[3];
    normal_of(m, c, n);
    any_tangent(n, to);
    return 1;
  }
  memmove(to, from, 4 * sizeof *to);
  return 0;
}

/* Every corner takes its tangent; returns how many found none. */
static uint32_t share(struct mesh *m, float *tangent) {
  uint32_t *first_group = m->opposite; /* per vertex; the links have done their work */
  memset(first_group, 0xff, m->corners * sizeof *first_group); /* NOTHING */
  for (uint32_t c = 0; c < m->corners; ++c)
    if (m->group[c] != NOTHING && first_group[m->vertex[c]] == NOTHING)
      first_group[m->vertex[c]] = m->group[c];
  uint32_t without = 0;
  for (uint32_t c = 0; c < m->corners; ++c)
    if (m->group[c] != c)
      without +=
          settle(m, c, m->group[c] != NOTHING ? m->group[c] : first_group[m->vertex[c]], tangent);
  for (uint32_t c = 0; c < m->corners; ++c) /* last: the others read these */
    if (m->group[c] == c)
      without += settle(m, c, c, tangent);
  return without;
}

long shade_mesh_tangents(size_t triangles, const float *position, const uint32_t *corner_position,
                         const float *corner_normal, const float *corner_uv,
                         float *corner_tangent) {
  if (triangles == 0)
    return 0;
  if (triangles > INT32_MAX / 3)
    return -1;
  const size_t corners = 3 * triangles;
  size_t length = 4;
  while (length < corners + corners / 2)
    length *= 2;
  uint32_t *memory = malloc((3 * corners + length) * sizeof *memory + triangles);
  if (!memory)
    return -1;
  struct mesh m = {
      .position = position,
      .normal = corner_normal,
      .uv = corner_uv,
      .corner_position = corner_position,
      .corners = (uint32_t)corners,
      .vertex = memory,
      .opposite = memory + corners,
      .group = memory + 2 * corners,
      .table = memory + 3 * corners,
      .mask = length - 1,
      .facet = (uint8_t *)(memory + 3 * corners + length),
  };
  weld(&m);
  classify(&m);
  link_edges(&m);
  make_groups(&m, corner_tangent);
  const uint32_t without = share(&m, corner_tangent);
  free(memory);
  return (long)without;
}
