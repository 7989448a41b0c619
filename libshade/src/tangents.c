/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Tangents of a UV-mapped triangle mesh, by the rules of MikkTSpace.
 *
 * 0. gather: the corners at one place, in order of their numbers. All that follows
 *    stays among those of one place, so places may be worked at side by side.
 * 1. weld: corners with equal position, normal and UV become one vertex.
 * 2. link: triangles that run along the same edge in opposite directions become
 *    neighbours there, in pairs.
 * 3. fans: around a vertex, neighbours of the same handedness make one group,
 *    and the group has one tangent: the mean of dP/du over its corners, each
 *    projected on the normal's plane, weighted by the corner's angle.
 * 4. share: corners that no group took get the tangent of a group at the same
 *    vertex, else nearly that of one at the same place, else the X or Y axis.
 *
 * An edge and its first corner have the same number, 3 * triangle + 0..2. All
 * sums are in double, where no product of three floats can overflow.
 * [Mikkelsen2008, Simulation of Wrinkled Surfaces Revisited]
 */
#include "shade/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../model/coefficients.h"

#define NOTHING UINT32_MAX

/* What a triangle is, as bits. */
enum {
  FACET_NEGATIVE = 1,   /* UV area < 0 in the order of its corners: the map is mirrored */
  FACET_FLAT = 2,       /* no UV area: adds nothing, takes part in its neighbours' groups */
  FACET_UNDECIDED = 4,  /* flat, and no group has lent it a handedness yet */
  FACET_DEGENERATE = 8, /* two corners at one place: no part in any group */
};

enum { PLACES = 2048, TRIANGLES = 8192, POSITIONS = 8192 }; /* that one piece of work takes */
enum { SHARES = 16, SHARE = 1 << 15 }; /* of all hashes at most; positions that are worth another */

struct mesh {
  const float *position, *normal, *uv;
  const uint32_t *corner_position;
  uint32_t corners, positions, places;
  uint32_t *hash;     /* per position, of its values; where `vertex` will be */
  uint32_t *place;    /* per position: where it is; those with equal values are at one place */
  uint32_t *start;    /* per place: its first in `corner`; one more at the end */
  uint32_t *corner;   /* corners, those of each place one after the other */
  uint32_t *spare;    /* two per entry of `corner`: hash tables with open addressing */
  uint32_t *vertex;   /* per corner: first corner with the same values */
  uint32_t *opposite; /* per edge: the neighbour's edge, or NOTHING */
  uint32_t *group;    /* per corner: first corner of its group, or NOTHING */
  uint8_t *facet;     /* per triangle: the bits above */
  uint8_t *held;      /* per place: a triangle there has no handedness yet */
  float *tangent;
  uint32_t *without; /* per piece of work: corners without a direction */
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

/* Scale to length 1. A zero vector stays as it is. */
static void normalise(double v[3]) {
  double length = sqrt(dot(v, v));
  double scale = length > 0 ? 1 / length : 0;
  for (int i = 0; i < 3; ++i)
    v[i] *= scale;
}

/*
 * Leave of v the part that lies in the plane of unit n; 0 if there is none. Below 1e-7
 * of v it would be the rounding of the float normal.
 */
static int project(double v[3], const double n[3]) {
  double along = dot(v, n), square = dot(v, v);
  for (int i = 0; i < 3; ++i)
    v[i] -= along * n[i];
  return dot(v, v) > 1e-14 * square;
}

static void normal_of(const struct mesh *m, uint32_t c, double out[3]) {
  for (int i = 0; i < 3; ++i)
    out[i] = (double)finite_or_zero(m->normal[3 * (size_t)c + (size_t)i]);
  normalise(out);
}

/* ---- 0. gather ------------------------------------------------------------- */

/* Two rounds of multiply and shift: neighbours in space end up far apart. */
static uint64_t mix(uint64_t h) {
  h = (h ^ (h >> 32)) * UINT64_C(0x9e3779b97f4a7c15);
  h = (h ^ (h >> 29)) * UINT64_C(0xd1342543de82ef95);
  return h ^ (h >> 32);
}

/* Where to look first in a table of `length`, by the hash's upper half. */
static uint32_t first_slot(uint64_t hash, uint32_t length) {
  return (uint32_t)((hash >> 32) * length >> 32);
}
static uint32_t next_slot(uint32_t slot, uint32_t length) {
  return slot + 1 < length ? slot + 1 : 0;
}

static void place_values(const struct mesh *m, uint32_t position, float out[4]) {
  for (int i = 0; i < 3; ++i)
    out[i] = finite_or_zero(m->position[3 * (size_t)position + (size_t)i]);
  out[3] = 0;
}

static uint64_t hash_pairs(const float *values, int pairs) {
  uint64_t pair, h = 0;
  for (int i = 0; i < pairs; ++i) {
    memcpy(&pair, values + 2 * i, sizeof pair);
    h = mix(h + pair);
  }
  return h;
}

static void hash_position(const struct mesh *m, uint32_t position) {
  float values[4];
  place_values(m, position, values);
  m->hash[position] = (uint32_t)(hash_pairs(values, 2) >> 32);
}

/* ---- of positions whose hashes are in one share: whose table stays in a near cache */

static uint32_t shares_of(const struct mesh *m) {
  const uint32_t shares = m->positions / SHARE + 1;
  return shares < SHARES ? shares : SHARES;
}

/* Every position of the share takes the first with its values for a place. */
static void find_firsts(const struct mesh *m, uint32_t share) {
  const uint32_t shares = shares_of(m), *hash = m->hash;
  const uint32_t from = (uint32_t)(((uint64_t)share << 32) / shares);
  const uint32_t most = (uint32_t)(((uint64_t)(share + 1) << 32) / shares - 1) - from;
  uint32_t before = 0, own = 0; /* how many positions are in lower shares, and in this */
  for (uint32_t p = 0; p < m->positions; ++p) {
    before += hash[p] < from;
    own += hash[p] - from <= most;
  }
  const uint32_t length = own + own / 2 + 1; /* of all shares at most 1.5 a position, and 1 each */
  uint32_t *table = m->spare + before + before / 2 + share;
  memset(table, 0xff, length * sizeof *table); /* NOTHING */
  for (uint32_t p = 0; p < m->positions; ++p) {
    float mine[4], other[4];
    if (hash[p] - from > most)
      continue;
    place_values(m, p, mine);
    uint32_t slot = first_slot((uint64_t)(hash[p] - from) * shares << 32, length);
    for (; table[slot] != NOTHING; slot = next_slot(slot, length)) {
      place_values(m, table[slot], other);
      if (hash[table[slot]] == hash[p] && memcmp(mine, other, sizeof mine) == 0)
        break;
    }
    if (table[slot] == NOTHING)
      table[slot] = p;
    m->place[p] = table[slot];
  }
}

static uint32_t place_of(const struct mesh *m, uint32_t c) {
  return m->place[m->corner_position[c]];
}

/* Places in the order in which corners come to them, and the corners of each: by counting. */
static void gather(struct mesh *m) {
  const uint32_t most = m->positions < m->corners ? m->positions : m->corners;
  uint32_t *number = m->spare;                         /* of the place of a first position */
  memset(number, 0xff, m->positions * sizeof *number); /* NOTHING */
  memset(m->start, 0, ((size_t)most + 1) * sizeof *m->start);
  for (uint32_t c = 0; c < m->corners; ++c) {
    uint32_t *place = &number[place_of(m, c)];
    if (*place == NOTHING)
      *place = m->places++;
    ++m->start[*place];
  }
  for (uint32_t p = 0; p < m->positions; ++p)
    m->place[p] = number[m->place[p]];
  uint32_t end = 0;
  for (uint32_t p = 0; p <= m->places; ++p) /* ends, which counting down makes the starts */
    m->start[p] = end += p < m->places ? m->start[p] : 0;
  for (uint32_t c = m->corners; c-- > 0;)
    m->corner[--m->start[place_of(m, c)]] = c;
}

/* ---- 1. weld --------------------------------------------------------------- */

/* Normal and UV: all that tells corners at one place apart. */
static void values_of(const struct mesh *m, uint32_t c, float out[6]) {
  for (size_t i = 0; i < 3; ++i)
    out[i] = finite_or_zero(m->normal[3 * (size_t)c + i]);
  for (size_t i = 0; i < 2; ++i)
    out[3 + i] = finite_or_zero(m->uv[2 * (size_t)c + i]);
  out[5] = 0;
}

static void weld(const struct mesh *m, uint32_t place) {
  const uint32_t first = m->start[place], end = m->start[place + 1], length = 2 * (end - first);
  uint32_t *table = m->spare + 2 * (size_t)first, k = first;
  float mine[6], other[6];
  if (first == end)
    return;
  values_of(m, m->corner[first], other);
  for (; k < end; ++k) { /* most often all are alike */
    values_of(m, m->corner[k], mine);
    if (memcmp(mine, other, sizeof mine) != 0)
      break;
    m->vertex[m->corner[k]] = m->corner[first];
  }
  if (k == end)
    return;
  memset(table, 0xff, length * sizeof *table); /* NOTHING */
  for (k = first; k < end; ++k) {
    values_of(m, m->corner[k], mine);
    uint32_t slot = first_slot(hash_pairs(mine, 3), length);
    for (; table[slot] != NOTHING; slot = next_slot(slot, length)) {
      values_of(m, table[slot], other);
      if (memcmp(mine, other, sizeof mine) == 0)
        break;
    }
    if (table[slot] == NOTHING)
      table[slot] = m->corner[k];
    m->vertex[m->corner[k]] = table[slot];
  }
}

/* ---- triangles ------------------------------------------------------------- */

/* An area in UV that the rounding of the UVs alone may make, by the largest of them and the longest
 * edge: of a slanted line, say, that a map has fallen to. */
#define UV_ROUNDING 0x1p-21

/* The direction of dP/du, of any length, or zero where there is none; returns twice the UV area. */
static double triangle_dpdu(const struct mesh *m, uint32_t first, double dpdu[3]) {
  double p[3][3], uv[3][2];
  for (uint32_t i = 0; i < 3; ++i) {
    position_of(m, first + i, p[i]);
    uv_of(m, first + i, uv[i]);
  }
  double u1 = uv[1][0] - uv[0][0], v1 = uv[1][1] - uv[0][1];
  double u2 = uv[2][0] - uv[0][0], v2 = uv[2][1] - uv[0][1];
  double area = u1 * v2 - v1 * u2, largest = 0, longest = 0;
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k)
      largest = fmax(largest, fabs(uv[k][i]));
    longest = fmax(longest, fmax(fabs(uv[1][i] - uv[0][i]), fabs(uv[2][i] - uv[0][i])));
  }
  if (fabs(area) <= UV_ROUNDING * largest * longest)
    area = 0;
  for (int i = 0; i < 3; ++i)
    dpdu[i] = copysign(1.0, area) * (v2 * (p[1][i] - p[0][i]) - v1 * (p[2][i] - p[0][i]));
  return area;
}

static void classify(const struct mesh *m, uint32_t t) {
  const uint32_t c = 3 * t, p[3] = {place_of(m, c), place_of(m, c + 1), place_of(m, c + 2)};
  double dpdu[3], area = triangle_dpdu(m, c, dpdu);
  if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0])
    m->facet[t] = FACET_DEGENERATE;
  else if (area == 0)
    m->facet[t] = FACET_FLAT | FACET_UNDECIDED;
  else
    m->facet[t] = area < 0 ? FACET_NEGATIVE : 0;
}

/* ---- 2. link --------------------------------------------------------------- */

/*
 * Edges wait in line, one line per pair of vertices, until one comes that runs
 * the other way; so all that wait run the same way, and where more than two
 * triangles meet the earliest are paired first. A table slot names the last of a
 * line, whose successor is the first; m->group holds the successors, NOTHING
 * where the line has run empty (the slot still says whose line it is).
 */
static void link_edge(const struct mesh *m, uint32_t edge, uint32_t *table, uint32_t length) {
  uint32_t *successor = m->group;
  uint32_t from = m->vertex[edge], to = m->vertex[next_corner(edge)];
  uint64_t low = from < to ? from : to, high = from < to ? to : from;
  uint32_t slot = first_slot(mix(low << 32 | high), length);
  int opposite = 0;
  for (; table[slot] != NOTHING; slot = next_slot(slot, length)) {
    uint32_t a = m->vertex[table[slot]], b = m->vertex[next_corner(table[slot])];
    opposite = a == to && b == from;
    if (opposite || (a == from && b == to))
      break;
  }
  uint32_t last = table[slot];
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
    table[slot] = edge;
  }
}

/* An edge is linked at the place of its lower vertex: of a triangle at most two are. */
static void link_edges(const struct mesh *m, uint32_t place) {
  const uint32_t first = m->start[place], end = m->start[place + 1], length = 2 * (end - first);
  uint32_t *table = m->spare + 2 * (size_t)first;
  memset(table, 0xff, length * sizeof *table); /* NOTHING */
  for (uint32_t k = first; k < end; ++k) {
    const uint32_t c = m->corner[k], own = m->vertex[c];
    if (m->facet[c / 3] == FACET_DEGENERATE)
      continue;
    if (own < m->vertex[next_corner(c)])
      link_edge(m, c, table, length);
    if (own < m->vertex[previous_corner(c)])
      link_edge(m, previous_corner(c), table, length);
  }
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

/* The angle of (x, y) from the x axis, y >= 0: quicker than atan2. */
static double angle_of(double y, double x) {
  const double pi = 3.14159265358979323846, ax = fabs(x);
  const double low = y < ax ? y : ax, high = y < ax ? ax : y;
  const int steep = low > 0.41421356237309504880 * high; /* tan(pi/8) */
  const double top = steep ? low - high : low, bottom = steep ? low + high : high;
  const double s = bottom > 0 ? top / bottom : 0;
  double a = s + s * (s * s) * SHADE_ATAN_D(s * s);
  a = steep ? a + pi / 4 : a;
  a = y > ax ? pi / 2 - a : a;
  return x < 0 ? pi - a : a;
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
  if (!project(a, n) || !project(b, n))
    return 0;
  double cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                     a[0] * b[1] - a[1] * b[0]};
  return angle_of(sqrt(dot(cross, cross)), dot(a, b));
}

/*
 * Walk from corner c through its fan, away across one kind of edge, until it
 * ends or another group or the other handedness is met. Adds to sum.
 */
static void walk_fan(const struct mesh *m, uint32_t c,
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
    normalise(dpdu);
    double angle = corner_angle(m, c, n);
    for (int i = 0; i < 3; ++i)
      sum[i] += angle * dpdu[i];
  }
}

/* Puts the tangent of corner c's group, or zero, at c, if it is the group's first. */
static void make_group(const struct mesh *m, uint32_t c) {
  const uint8_t facet = m->facet[c / 3];
  if (m->group[c] != NOTHING || (facet & (FACET_FLAT | FACET_DEGENERATE)))
    return;
  double n[3], sum[3] = {0, 0, 0};
  normal_of(m, c, n);
  walk_fan(m, c, across_leaving, c, n, sum);
  walk_fan(m, across_entering(m, c), across_entering, c, n, sum);
  normalise(sum);
  float *t = m->tangent + 4 * (size_t)c;
  for (int i = 0; i < 3; ++i)
    t[i] = (float)sum[i];
  t[3] = (facet & FACET_NEGATIVE) ? -1.0f : 1.0f;
}

/* Which handedness a triangle without one takes goes by the order of all corners that it has: such
 * places wait for the end. */
static void make_groups(const struct mesh *m, uint32_t place) {
  m->held[place] = 0;
  for (uint32_t k = m->start[place]; k < m->start[place + 1]; ++k)
    m->held[place] |= m->facet[m->corner[k] / 3] & FACET_UNDECIDED;
  for (uint32_t k = m->start[place]; k < m->start[place + 1] && !m->held[place]; ++k)
    make_group(m, m->corner[k]);
}

static void make_held_groups(const struct mesh *m) {
  if (!memchr(m->facet, FACET_FLAT | FACET_UNDECIDED, m->corners / 3))
    return;
  for (uint32_t c = 0; c < m->corners; ++c)
    if (m->held[place_of(m, c)])
      make_group(m, c);
}

/* ---- 4. share -------------------------------------------------------------- */

/* The part orthogonal to n of a direction, or of the X axis, or where that is along n of the Y
 * axis: neighbours take nearly the same. */
static void nearest_tangent(const double n[3], const float *from, float t[4]) {
  double v[3] = {0, 0, 0};
  for (int i = 0; i < 3 && from; ++i)
    v[i] = (double)from[i];
  if (!from || !project(v, n)) {
    const int axis = fabs(n[0]) < 0.999 ? 0 : 1;
    v[0] = axis == 0;
    v[1] = axis == 1;
    v[2] = 0;
    project(v, n);
  }
  normalise(v);
  for (int i = 0; i < 3; ++i)
    t[i] = (float)v[i];
  t[3] = from ? from[3] : -1; /* as MikkTSpace: no area is not one that keeps its sense */
}

static int has_direction(const float t[4]) {
  return t[0] != 0 || t[1] != 0 || t[2] != 0;
}

/* Give corner c the tangent stored at corner `source`; 1 if there is none: then one near that of
 * `beside`, or NULL. */
static uint32_t settle(const struct mesh *m, uint32_t c, uint32_t source, const float *beside,
                       float *tangent) {
  const float *from = tangent + 4 * (size_t)source;
  float *to = tangent + 4 * (size_t)c;
  if (source == NOTHING || !has_direction(from)) {
    double n[3];
    normal_of(m, c, n);
    nearest_tangent(n, beside, to);
    return 1;
  }
  memmove(to, from, 4 * sizeof *to);
  return 0;
}

/* Every corner takes its tangent; returns how many found none. */
static uint32_t share(const struct mesh *m, uint32_t place) {
  const uint32_t *first = m->corner + m->start[place], *end = m->corner + m->start[place + 1];
  uint32_t *first_group = m->opposite; /* per vertex; the links have done their work */
  uint32_t without = 0;
  float beside[4] = {0, 0, 0, 1}; /* of the first corner here that has one */
  for (const uint32_t *c = first; c < end; ++c)
    first_group[*c] = NOTHING;
  for (const uint32_t *c = first; c < end && !has_direction(beside); ++c)
    if (m->group[*c] != NOTHING)
      memcpy(beside, m->tangent + 4 * (size_t)m->group[*c], sizeof beside);
  const float *near = has_direction(beside) ? beside : NULL;
  for (const uint32_t *c = first; c < end; ++c)
    if (m->group[*c] != NOTHING && first_group[m->vertex[*c]] == NOTHING)
      first_group[m->vertex[*c]] = m->group[*c];
  for (const uint32_t *c = first; c < end; ++c)
    if (m->group[*c] != *c)
      without += settle(m, *c, m->group[*c] != NOTHING ? m->group[*c] : first_group[m->vertex[*c]],
                        near, m->tangent);
  for (const uint32_t *c = first; c < end; ++c) /* last: the others read these */
    if (m->group[*c] == *c)
      without += settle(m, *c, *c, near, m->tangent);
  return without;
}

/* ---- pieces of work ---------------------------------------------------------- */

static uint32_t most(size_t begin, uint32_t step, uint32_t limit) {
  return limit - begin < step ? limit : (uint32_t)begin + step;
}

static void classify_piece(void *context, size_t piece) {
  const struct mesh *m = context;
  for (uint32_t t = (uint32_t)piece * TRIANGLES, end = most(t, TRIANGLES, m->corners / 3); t < end;
       ++t)
    classify(m, t);
}

static void hash_piece(void *context, size_t piece) {
  const struct mesh *m = context;
  for (uint32_t p = (uint32_t)piece * POSITIONS, end = most(p, POSITIONS, m->positions); p < end;
       ++p)
    hash_position(m, p);
}
static void firsts_piece(void *context, size_t piece) {
  find_firsts(context, (uint32_t)piece);
}

#define OVER_PLACES(name, what)                                                                    \
  static void name##_piece(void *context, size_t piece) {                                          \
    const struct mesh *m = context;                                                                \
    for (uint32_t p = (uint32_t)piece * PLACES, end = most(p, PLACES, m->places); p < end; ++p)    \
      what;                                                                                        \
  }
OVER_PLACES(weld, weld(m, p))
OVER_PLACES(link, link_edges(m, p))
OVER_PLACES(groups, make_groups(m, p))
OVER_PLACES(share, m->without[piece] += share(m, p))

static void one_by_one(void *pool, size_t count, void (*work)(void *context, size_t i),
                       void *context) {
  (void)pool;
  for (size_t i = 0; i < count; ++i)
    work(context, i);
}

static uint32_t pieces(uint32_t count, uint32_t step) {
  return count / step + (count % step != 0);
}

static long solve(struct mesh *m, shade_each *each, void *pool) {
  each(pool, pieces(m->positions, POSITIONS), hash_piece, m);
  each(pool, shares_of(m), firsts_piece, m);
  gather(m);
  const uint32_t parts = pieces(m->places, PLACES);
  each(pool, parts, weld_piece, m);
  each(pool, pieces(m->corners / 3, TRIANGLES), classify_piece, m);
  memset(m->opposite, 0xff, m->corners * sizeof *m->opposite); /* NOTHING */
  memset(m->group, 0xff, m->corners * sizeof *m->group);
  each(pool, parts, link_piece, m);
  memset(m->group, 0xff, m->corners * sizeof *m->group);
  each(pool, parts, groups_piece, m);
  make_held_groups(m);
  m->without = m->spare; /* done with */
  memset(m->without, 0, parts * sizeof *m->without);
  each(pool, parts, share_piece, m);
  long without = 0;
  for (uint32_t i = 0; i < parts; ++i)
    without += (long)m->without[i];
  return without;
}

long shade_mesh_tangents_by(size_t triangles, const float *position,
                            const uint32_t *corner_position, const float *corner_normal,
                            const float *corner_uv, float *corner_tangent, shade_each *each,
                            void *pool) {
  if (triangles == 0)
    return 0;
  if (triangles > INT32_MAX / 3)
    return -1;
  const size_t corners = 3 * triangles;
  size_t positions = 0;
  for (size_t c = 0; c < corners; ++c)
    positions = corner_position[c] >= positions ? (size_t)corner_position[c] + 1 : positions;
  if (positions > UINT32_MAX - 1)
    return -1;
  const size_t places = positions < corners ? positions : corners;
  /* room for hashes and their tables where many positions are at no corner */
  const size_t vertices = positions < corners ? corners : positions, spare = 2 * vertices + SHARES;
  uint32_t *memory =
      malloc((vertices + spare + 3 * corners + positions + places + 2) * sizeof *memory +
             triangles + places);
  if (!memory)
    return -1;
  struct mesh m = {
      .position = position,
      .normal = corner_normal,
      .uv = corner_uv,
      .corner_position = corner_position,
      .corners = (uint32_t)corners,
      .positions = (uint32_t)positions,
      .hash = memory,
      .vertex = memory,
      .spare = memory + vertices,
      .opposite = memory + vertices + spare,
      .group = memory + vertices + spare + corners,
      .corner = memory + vertices + spare + 2 * corners,
      .place = memory + vertices + spare + 3 * corners,
      .start = memory + vertices + spare + 3 * corners + positions,
      .facet = (uint8_t *)(memory + vertices + spare + 3 * corners + positions + places + 2),
      .tangent = corner_tangent,
  };
  m.held = m.facet + triangles;
  const long without = solve(&m, each ? each : one_by_one, pool);
  free(memory);
  return without;
}

long shade_mesh_tangents(size_t triangles, const float *position, const uint32_t *corner_position,
                         const float *corner_normal, const float *corner_uv,
                         float *corner_tangent) {
  return shade_mesh_tangents_by(triangles, position, corner_position, corner_normal, corner_uv,
                                corner_tangent, NULL, NULL);
}
