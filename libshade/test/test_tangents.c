/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.5 */
/* shade_mesh_tangents against tangents known in closed form. */
#include "shade/mesh.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

/* A mesh without shared corners; room for `triangles`, filled by add_triangle. */
typedef struct mesh {
  size_t triangles, room;
  float *position, *normal, *uv, *tangent; /* per corner */
  uint32_t *index;
} mesh;

typedef struct point {
  float position[3], normal[3], uv[2];
} point;

static mesh new_mesh(size_t room) {
  mesh m = {0, room, NULL, NULL, NULL, NULL, NULL};
  m.position = malloc(9 * room * sizeof(float));
  m.normal = malloc(9 * room * sizeof(float));
  m.uv = malloc(6 * room * sizeof(float));
  m.tangent = malloc(12 * room * sizeof(float));
  m.index = malloc(3 * room * sizeof(uint32_t));
  return m;
}

static void free_mesh(mesh *m) {
  free(m->position);
  free(m->normal);
  free(m->uv);
  free(m->tangent);
  free(m->index);
}

static void add_triangle(mesh *m, point a, point b, point c) {
  const point corners[3] = {a, b, c};
  assert_true(m->triangles < m->room);
  for (size_t i = 0; i < 3; i++) {
    const size_t corner = 3 * m->triangles + i;
    memcpy(m->position + 3 * corner, corners[i].position, sizeof a.position);
    memcpy(m->normal + 3 * corner, corners[i].normal, sizeof a.normal);
    memcpy(m->uv + 2 * corner, corners[i].uv, sizeof a.uv);
    m->index[corner] = (uint32_t)corner;
  }
  m->triangles++;
}

static double length(const float v[3]) {
  return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

static double dot(const float a[3], const float b[3]) {
  return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

/* What holds for every corner of every mesh; returns what the function does. */
static long solve(mesh *m) {
  memset(m->tangent, 0x7f, 12 * m->room * sizeof(float));
  const long without =
      shade_mesh_tangents(m->triangles, m->position, m->index, m->normal, m->uv, m->tangent);
  for (size_t c = 0; c < 3 * m->triangles; c++) {
    const float *t = m->tangent + 4 * c, *n = m->normal + 3 * c;
    assert_true(fabs(length(t) - 1) < 1e-6);
    assert_true(t[3] == 1 || t[3] == -1);
    if (isfinite(length(n)) && length(n) > 0)
      assert_true(fabs(dot(t, n)) < 1e-6 * length(n));
  }
  return without;
}

static double angle_degrees(const float t[3], const double expected[3]) {
  double cosine = 0, norm = 0;
  for (int i = 0; i < 3; i++) {
    cosine += (double)t[i] * expected[i];
    norm += expected[i] * expected[i];
  }
  cosine /= length(t) * sqrt(norm);
  return acos(fmin(1, fmax(-1, cosine))) * 180 / PI;
}

/* ---- surfaces given by a function of (u, v) --------------------------------------- */

typedef point (*surface)(double u, double v);

/* columns x rows quads over the unit square, two triangles each, alternating diagonals. */
static mesh tessellate(surface f, int columns, int rows) {
  mesh m = new_mesh(2 * (size_t)columns * (size_t)rows);
  for (int j = 0; j < rows; j++)
    for (int i = 0; i < columns; i++) {
      const double u[2] = {(double)i / columns, (i + 1.0) / columns};
      const double v[2] = {(double)j / rows, (j + 1.0) / rows};
      const point a = f(u[0], v[0]), b = f(u[1], v[0]), c = f(u[1], v[1]), d = f(u[0], v[1]);
      if ((i + j) % 2) {
        add_triangle(&m, a, b, c);
        add_triangle(&m, a, c, d);
      } else {
        add_triangle(&m, a, b, d);
        add_triangle(&m, b, c, d);
      }
    }
  return m;
}

static point make_point(double x, double y, double z, double nx, double ny, double nz, double u,
                        double v) {
  return (point){
      {(float)x, (float)y, (float)z}, {(float)nx, (float)ny, (float)nz}, {(float)u, (float)v}};
}

/* A plane whose UV axes are turned by 30 degrees: dP/du = (cos 30, sin 30, 0). */
static point plane(double u, double v) {
  const double c = cos(PI / 6), s = sin(PI / 6);
  return make_point(u, v, 0, 0, 0, 1, c * u + s * v, -s * u + c * v);
}

static void test_plane(void **state) {
  (void)state;
  mesh m = tessellate(plane, 9, 7);
  assert_int_equal(solve(&m), 0);
  const double expected[3] = {cos(PI / 6), sin(PI / 6), 0};
  for (size_t c = 0; c < 3 * m.triangles; c++) {
    assert_true(angle_degrees(m.tangent + 4 * c, expected) < 1e-2);
    assert_true(m.tangent[4 * c + 3] == 1);
  }
  free_mesh(&m);
}

/* The right half's UVs on the left half too: a seam where u turns round. */
static point mirrored_plane(double u, double v) {
  return make_point(2 * u - 1, v, 0, 0, 0, 1, fabs(2 * u - 1), v);
}

static void test_mirrored_seam(void **state) {
  (void)state;
  mesh m = tessellate(mirrored_plane, 8, 5);
  assert_int_equal(solve(&m), 0);
  for (size_t t = 0; t < m.triangles; t++) {
    const float *p = m.position + 9 * t;
    const int side = p[0] + p[3] + p[6] > 0 ? 1 : -1;
    for (size_t c = 3 * t; c < 3 * t + 3; c++) { /* not blended even on the seam */
      assert_true(m.tangent[4 * c] == (float)side);
      assert_true(m.tangent[4 * c + 3] == (float)side);
    }
  }
  free_mesh(&m);
}

static point sphere(double u, double v) {
  const double phi = 2 * PI * u, theta = PI * v;
  const double x = sin(theta) * cos(phi), y = sin(theta) * sin(phi), z = -cos(theta);
  return make_point(x, y, z, x, y, z, u, v);
}

static point torus(double u, double v) {
  const double phi = 2 * PI * u, theta = 2 * PI * v;
  const double nx = cos(theta) * cos(phi), ny = cos(theta) * sin(phi), nz = sin(theta);
  return make_point(2 * cos(phi) + 0.5 * nx, 2 * sin(phi) + 0.5 * ny, 0.5 * nz, nx, ny, nz, u, v);
}

/* Both run along the parallels: dP/du is (-y, x, 0). The largest angle from it, the
 * rows at the sphere's poles left out, and the handedness. */
static double worst_on_parallels(surface f, int columns, int rows) {
  mesh m = tessellate(f, columns, rows);
  const long without = solve(&m);
  assert_true(without == 0 || f == sphere);
  double worst = 0;
  for (size_t c = 0; c < 3 * m.triangles; c++) {
    const float *p = m.position + 3 * c, v = m.uv[2 * c + 1];
    if (f == sphere && (v < 0.15f || v > 0.85f))
      continue;
    const double expected[3] = {-p[1], p[0], 0};
    worst = fmax(worst, angle_degrees(m.tangent + 4 * c, expected));
    assert_true(m.tangent[4 * c + 3] == 1);
  }
  free_mesh(&m);
  return worst;
}

static void test_curved(void **state) {
  (void)state;
  const surface surfaces[] = {sphere, torus};
  for (size_t i = 0; i < 2; i++) {
    /* on the u seam a corner sees half of its neighbours: the error is of first order */
    const double coarse = worst_on_parallels(surfaces[i], 48, 24);
    const double fine = worst_on_parallels(surfaces[i], 192, 96);
    assert_true(coarse < 5);
    assert_true(fine < coarse / 3.5);
  }
}

/* ---- the rules -------------------------------------------------------------------- */

static point flat_point(double x, double y, double u, double v) {
  return make_point(x, y, 0, 0, 0, 1, u, v);
}

/* Corner angles are those seen along the normal, here turned about x by `tilt`; one of them is less
 * than a right angle, or more where the last point is below. */
static void check_angle_weights(double tilt, int below) {
  mesh m = new_mesh(3);
  const double c = cos(tilt), s = sin(tilt);
  const point corner = make_point(0, 0, 0, 0, -s, c, 0, 0);
  const point up = make_point(0, 1, 0, 0, -s, c, 0, 1);
  /* collapsed, though not in UV: it must not come between the others */
  add_triangle(&m, corner, make_point(0, 0, 0, 0, -s, c, 5, 5), up);
  const double last = below ? -1 : 1;
  /* dP/du = (1, 0), a right angle at `corner`; dP/du = (1, 1), edges (0, 1) and (-1, last) */
  add_triangle(&m, corner, make_point(1, 0, 0, 0, -s, c, 1, 0), up);
  add_triangle(&m, corner, up, make_point(-1, last, 0, 0, -s, c, -1, last + 1));
  assert_int_equal(solve(&m), 1);
  const double angle = atan2(1, last * c), x = PI / 2 + angle / hypot(1, c),
               y = angle * c / hypot(1, c);
  const double expected[3] = {x, c * y, s * y};
  for (size_t k = 0; k < 9; k += 3)
    assert_true(angle_degrees(m.tangent + 4 * k, expected) < 3e-2);
  free_mesh(&m);
}

static void test_angle_weights(void **state) {
  (void)state;
  for (int below = 0; below < 2; below++) {
    check_angle_weights(0, below);
    check_angle_weights(PI / 3, below);
  }
}

/* Where u runs along the normal there is no tangent: what rounding leaves of dP/du is none. */
static void test_u_along_the_normal(void **state) {
  (void)state;
  const float along[4][3] = {{1, 2, 3}, {3, -1, 2}, {-7, 4, 1}, {2, 2, 5}};
  const float aside[4][3] = {{0, 3, -2}, {1, 3, 0}, {0, 1, -4}, {1, -1, 0}};
  for (int i = 0; i < 4; i++) {
    mesh m = new_mesh(1);
    point a = {.uv = {0, 0}}, b = {.uv = {1, 0}}, c = {.uv = {0, 1}};
    const double size = length(along[i]);
    for (int k = 0; k < 3; k++) {
      b.position[k] = along[i][k];
      c.position[k] = aside[i][k];
      a.normal[k] = b.normal[k] = c.normal[k] = (float)((double)along[i][k] / size);
    }
    add_triangle(&m, a, b, c);
    assert_int_equal(solve(&m), 3);
    for (int k = 0; k < 3; k++)
      assert_true(fabs(length(m.tangent + 4 * k) - 1) < 1e-6);
    free_mesh(&m);
  }
}

/* Two fans that only touch in a point, with the same values there, stay apart. */
static void test_fans_stay_apart(void **state) {
  (void)state;
  mesh m = new_mesh(2);
  const point corner = flat_point(0, 0, 0, 0);
  add_triangle(&m, corner, flat_point(1, 0, 1, 0), flat_point(0, 1, 0, 1));
  add_triangle(&m, corner, flat_point(-1, 0, 0, -1), flat_point(0, -1, 1, 0));
  assert_int_equal(solve(&m), 0);
  const double first[3] = {1, 0, 0}, second[3] = {0, -1, 0};
  assert_true(angle_degrees(m.tangent, first) < 1e-2);
  assert_true(angle_degrees(m.tangent + 4 * 3, second) < 1e-2);
  free_mesh(&m);
}

/* Where four triangles meet in an edge, the first ones of either direction are a pair. */
static void test_crowded_edge(void **state) {
  (void)state;
  mesh m = new_mesh(4);
  const point a = flat_point(0, 0, 0, 0), b = flat_point(0, 1, 0, 1);
  add_triangle(&m, a, b, flat_point(-1, 0, -1, 1));  /* dP/du at 45 degrees */
  add_triangle(&m, a, b, flat_point(-1, 0, -1, -1)); /* -45 */
  add_triangle(&m, b, a, flat_point(1, 0, 1, 0));    /* 0 */
  add_triangle(&m, b, a, flat_point(2, 0, 2, 0));    /* 0 */
  assert_int_equal(solve(&m), 0);
  const double rising[3] = {cos(PI / 8), sin(PI / 8), 0};
  const double falling[3] = {cos(PI / 8), -sin(PI / 8), 0};
  assert_true(angle_degrees(m.tangent, rising) < 1e-2); /* all at a: right angles */
  assert_true(angle_degrees(m.tangent + 4 * 3, falling) < 1e-2);
  assert_true(angle_degrees(m.tangent + 4 * 7, rising) < 1e-2);
  assert_true(angle_degrees(m.tangent + 4 * 10, falling) < 1e-2);
  free_mesh(&m);
}

/* A triangle without UV area joins the group across its edge, and takes its handedness. */
static void test_flat_joins(void **state) {
  (void)state;
  mesh m = new_mesh(2);
  const point a = flat_point(0, 0, 0, 0), b = flat_point(0, 1, 0, 1);
  add_triangle(&m, a, b, flat_point(-1, 0, 0, 2)); /* u = 0 all over */
  add_triangle(&m, a, flat_point(1, 0, -1, 0), b); /* mirrored */
  assert_int_equal(solve(&m), 1);
  const double expected[3] = {-1, 0, 0};
  for (size_t c = 0; c < 2; c++) { /* a and b of the flat triangle; its third has no one */
    assert_true(angle_degrees(m.tangent + 4 * c, expected) < 1e-2);
    assert_true(m.tangent[4 * c + 3] == -1);
  }
  assert_true(m.tangent[4 * 2 + 3] == -1);
  free_mesh(&m);
}

/* A collapsed triangle takes the tangents that its corners have elsewhere. */
static void test_collapsed_shares(void **state) {
  (void)state;
  mesh m = new_mesh(2);
  const point a = flat_point(0, 0, 0, 0), b = flat_point(0, 2, 0, 1);
  add_triangle(&m, a, a, b);
  add_triangle(&m, b, a, flat_point(3, 0, 1, 0));
  assert_int_equal(solve(&m), 0);
  assert_memory_equal(m.tangent, m.tangent + 4 * 4, 4 * sizeof(float));
  assert_memory_equal(m.tangent + 4, m.tangent + 4 * 4, 4 * sizeof(float));
  assert_memory_equal(m.tangent + 8, m.tangent + 4 * 3, 4 * sizeof(float));
  free_mesh(&m);
}

/* The same mesh with shared positions, in whatever order, gives the same tangents. */
static void test_indexing_does_not_matter(void **state) {
  (void)state;
  mesh m = tessellate(torus, 24, 12);
  assert_int_equal(solve(&m), 0);
  const size_t corners = 3 * m.triangles;
  float *shared = malloc(3 * corners * sizeof *shared),
        *again = malloc(4 * corners * sizeof *again);
  uint32_t *index = malloc(corners * sizeof *index);
  uint32_t count = 0;
  for (size_t c = 0; c < corners; c++) {
    uint32_t i = 0;
    while (i < count && memcmp(shared + 3 * i, m.position + 3 * c, 3 * sizeof *shared) != 0)
      i++;
    if (i == count)
      memcpy(shared + 3 * count++, m.position + 3 * c, 3 * sizeof *shared);
    index[c] = i;
  }
  assert_true(count < corners / 4);
  assert_int_equal(shade_mesh_tangents(m.triangles, shared, index, m.normal, m.uv, again), 0);
  assert_memory_equal(again, m.tangent, 4 * corners * sizeof *again);
  free(shared);
  free(again);
  free(index);
  free_mesh(&m);
}

/* Normals of any length will do. */
static void test_long_normals(void **state) {
  (void)state;
  mesh m = tessellate(torus, 24, 12), longer = tessellate(torus, 24, 12);
  for (size_t k = 0; k < 9 * m.triangles; k++)
    longer.normal[k] *= 8;
  assert_int_equal(solve(&m), 0);
  assert_int_equal(solve(&longer), 0);
  assert_memory_equal(longer.tangent, m.tangent, 12 * m.triangles * sizeof(float));
  free_mesh(&m);
  free_mesh(&longer);
}

/* 0 and -0 are one value. */
static void test_negative_zero(void **state) {
  (void)state;
  mesh m = new_mesh(2);
  const point a = flat_point(0, 0, 0, 0), b = flat_point(0, 1, 0, 1);
  add_triangle(&m, a, flat_point(1, 0, 1, 0), b);
  point minus_a = a, minus_b = b;
  minus_a.position[0] = minus_b.position[0] = minus_a.uv[0] = minus_a.normal[1] = -0.0f;
  add_triangle(&m, minus_a, minus_b, flat_point(-1, 1, -1, 2));
  assert_int_equal(solve(&m), 0);
  assert_memory_equal(m.tangent, m.tangent + 4 * 3, 3 * sizeof(float));
  free_mesh(&m);
}

/* The last piece first, the odd ones before the even: any order will do. */
static void backwards(void *pool, size_t count, void (*work)(void *context, size_t i),
                      void *context) {
  *(size_t *)pool = count > *(size_t *)pool ? count : *(size_t *)pool;
  for (size_t i = count; i-- > 0;)
    if (i % 2)
      work(context, i);
  for (size_t i = count; i-- > 0;)
    if (i % 2 == 0)
      work(context, i);
}

/* Pieces of work may go to any thread: the same bytes. Triangles without UV area take the
 * handedness of one neighbour or another, by the order of all. */
static void test_threads_do_not_matter(void **state) {
  (void)state;
  mesh m = tessellate(plane, 64, 64);
  for (size_t c = 0; c < 3 * m.triangles; c++) /* UVs by chance: a third has no area */
    for (int k = 0; k < 2; k++)
      m.uv[2 * c + (size_t)k] = (float)((int)(64 * m.position[3 * c] * (float)(5 + k) +
                                              64 * m.position[3 * c + 1] * (float)(11 - 3 * k)) %
                                        7 % 3);
  for (size_t t = 0; t < m.triangles; t++) { /* neighbours far apart in the list */
    const size_t other = (t * 7919) % m.triangles;
    float *arrays[] = {m.position, m.normal, m.uv};
    for (size_t a = 0; a < 3; a++)
      for (size_t width = a == 2 ? 6 : 9, k = 0; k < width; k++) {
        const float kept = arrays[a][width * t + k];
        arrays[a][width * t + k] = arrays[a][width * other + k];
        arrays[a][width * other + k] = kept;
      }
  }
  const long without = solve(&m);
  float *again = malloc(12 * m.triangles * sizeof *again);
  size_t pieces = 0;
  assert_int_equal(shade_mesh_tangents_by(m.triangles, m.position, m.index, m.normal, m.uv, again,
                                          backwards, &pieces),
                   without);
  assert_true(pieces > 2);
  assert_memory_equal(again, m.tangent, 12 * m.triangles * sizeof *again);
  free(again);
  free_mesh(&m);
}

/* ---- hard input --------------------------------------------------------------------- */

static void test_no_uv_at_all(void **state) {
  (void)state;
  mesh m = tessellate(sphere, 12, 8);
  memset(m.uv, 0, 6 * m.triangles * sizeof *m.uv);
  assert_int_equal(solve(&m), 3 * (long)m.triangles);
  for (size_t c = 0; c < 3 * m.triangles; c++)
    assert_true(m.tangent[4 * c + 3] == -1);
  free_mesh(&m);
}

/* By rounding alone a map that has fallen to a slanted line has area: strokes go as without one,
 * along the X axis, or where the surface faces that either way along the Y axis. */
static void check_a_line(float slope) {
  mesh m = tessellate(sphere, 12, 8);
  for (size_t c = 0; c < 3 * m.triangles; c++) { /* no two corners of a triangle alike */
    const float *p = m.position + 3 * c;
    m.uv[2 * c] = 0.7f * p[0] + 0.23f * p[1] + 0.31f * p[2];
    m.uv[2 * c + 1] = m.uv[2 * c] * slope + 0.1f;
  }
  for (int k = 0; k < 3; k++)
    m.normal[k] = k ? 0.0f : -1.0f;
  assert_int_equal(solve(&m), 3 * (long)m.triangles);
  for (size_t c = 0; c < 3 * m.triangles; c++) {
    const float *n = m.normal + 3 * c, *t = m.tangent + 4 * c;
    const int axis = fabsf(n[0]) < 0.999f ? 0 : 1;
    const float length = sqrtf(1 - n[axis] * n[axis]);
    for (int k = 0; k < 3; k++)
      assert_true(fabsf(t[k] - ((k == axis ? 1.0f : 0.0f) - n[axis] * n[k]) / length) < 1e-5f);
  }
  free_mesh(&m);
}

static void test_a_line(void **state) {
  (void)state;
  static const float slopes[] = {0.3f, 0.01f, 0.0007f, 30, -1, 4000};
  for (size_t k = 0; k < sizeof slopes / sizeof *slopes; k++)
    check_a_line(slopes[k]);
}

/* Triangles that a map leaves without area go as those at the same place. */
static void test_beside_others(void **state) {
  (void)state;
  mesh m = new_mesh(2);
  const point a = flat_point(0, 0, 0, 0), b = flat_point(0, 1, 1, 0);
  add_triangle(&m, a, flat_point(1, 0, 0, 1), b); /* u along y */
  add_triangle(&m, flat_point(0, 0, 0.5f, 0.5f), flat_point(0, 1, 0.5f, 0.5f),
               flat_point(-1, 1, 0.5f, 0.5f));
  assert_int_equal(solve(&m), 3);
  for (int c = 3; c < 5; c++)
    for (int k = 0; k < 4; k++)
      assert_true(m.tangent[4 * c + k] == m.tangent[k]);
  assert_true(m.tangent[4 * 5] == 1 && m.tangent[4 * 5 + 3] == -1);
  free_mesh(&m);
}

static void test_not_finite(void **state) {
  (void)state;
  const float bad[] = {NAN, INFINITY, -INFINITY};
  for (size_t which = 0; which < 24; which++)
    for (size_t b = 0; b < 3; b++) {
      mesh m = tessellate(torus, 6, 6);
      float *arrays[] = {m.position, m.normal, m.uv};
      for (size_t k = which; k < 6 * m.triangles; k += 24)
        arrays[which % 3][k] = bad[b];
      assert_true(solve(&m) >= 0);
      free_mesh(&m);
    }
}

static void test_extreme_sizes(void **state) {
  (void)state;
  const float scales[] = {1e38f, 1e-38f, FLT_TRUE_MIN * 16};
  for (size_t i = 0; i < 3; i++)
    for (int uv = 0; uv < 2; uv++) {
      mesh m = new_mesh(1);
      add_triangle(&m, flat_point(0, 0, 0, 0), flat_point(1, 0, 1, 0), flat_point(0, 1, 0, 1));
      for (int k = 0; k < (uv ? 6 : 9); k++)
        (uv ? m.uv : m.position)[k] *= scales[i];
      assert_int_equal(solve(&m), 0);
      assert_true(m.tangent[0] == 1);
      free_mesh(&m);
    }
}

static void test_zero_normal(void **state) {
  (void)state;
  mesh m = tessellate(plane, 2, 2);
  memset(m.normal, 0, 9 * m.triangles * sizeof *m.normal);
  assert_true(solve(&m) >= 0);
  free_mesh(&m);
}

/* One vertex with 300,000 triangles around it: no recursion to overflow, no square. */
static void test_high_valence(void **state) {
  (void)state;
  enum { COUNT = 300000 };
  mesh m = new_mesh(COUNT);
  point rim[2] = {flat_point(1, 0, 1, 0)};
  for (int i = 0; i < COUNT; i++) {
    const double angle = 2 * PI * (i + 1) / COUNT;
    rim[1] = i + 1 == COUNT ? flat_point(1, 0, 1, 0)
                            : flat_point(cos(angle), sin(angle), cos(angle), sin(angle));
    add_triangle(&m, flat_point(0, 0, 0, 0), rim[0], rim[1]);
    rim[0] = rim[1];
  }
  solve(&m);
  const double expected[3] = {1, 0, 0};
  for (size_t c = 0; c < 3 * m.triangles; c += 3)
    assert_true(angle_degrees(m.tangent + 4 * c, expected) < 0.1);
  free_mesh(&m);
}

/* The same triangle 200,000 times, both ways round: every edge is shared by all. */
static void test_one_edge_many_times(void **state) {
  (void)state;
  enum { COUNT = 200000 };
  mesh m = new_mesh(COUNT);
  const point a = flat_point(0, 0, 0, 0), b = flat_point(1, 0, 1, 0), c = flat_point(0, 1, 0, 1);
  for (int i = 0; i < COUNT; i++)
    add_triangle(&m, a, i % 3 ? b : c, i % 3 ? c : b);
  assert_int_equal(solve(&m), 0);
  for (size_t i = 0; i < 3 * m.triangles; i++)
    assert_true(m.tangent[4 * i] == 1);
  free_mesh(&m);
}

static void test_impossible_sizes(void **state) {
  (void)state;
  const float zeros[9] = {0};
  const uint32_t index[3] = {0};
  float tangent[12];
  memset(tangent, 0x7f, sizeof tangent);
  const size_t sizes[] = {SIZE_MAX,
                          SIZE_MAX / 3,
                          SIZE_MAX / 36 + 1,
                          (size_t)UINT32_MAX,
                          (size_t)UINT32_MAX / 3 + 1,
                          (size_t)INT32_MAX};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
    assert_int_equal(shade_mesh_tangents(sizes[i], zeros, index, zeros, zeros, tangent), -1);
  assert_int_equal(shade_mesh_tangents(0, zeros, index, zeros, zeros, tangent), 0);
  for (size_t i = 0; i < sizeof tangent; i++)
    assert_int_equal(((unsigned char *)tangent)[i], 0x7f);
}

/*
 * A triangle without UV area that joins a mirrored one takes its handedness and its tangent,
 * whichever comes first; one that joins a plain one does not become mirrored.
 */
static void test_flat_takes_the_handedness(void **state) {
  (void)state;
  for (int mirrored = 0; mirrored < 2; mirrored++)
    for (int order = 0; order < 2; order++) {
      const float side = mirrored ? -1 : 1;
      const point a = {{0, 0, 0}, {0, 0, 1}, {0, 0}}, b = {{1, 0, 0}, {0, 0, 1}, {side, 0}},
                  c = {{0, 1, 0}, {0, 0, 1}, {0, 1}},
                  /* between b and c on the map: the second triangle has no area there */
          d = {{1, 1, 0}, {0, 0, 1}, {0.5f * side, 0.5f}};
      mesh m = new_mesh(2);
      for (int k = 0; k < 2; k++)
        if (k == order)
          add_triangle(&m, a, b, c);
        else
          add_triangle(&m, b, d, c);
      solve(&m);
      const size_t flat = order ? 0 : 3; /* its corners: b, d, c */
      const double along[3] = {(double)side, 0, 0};
      for (size_t corner = 0; corner < 6; corner++) {
        if (corner == flat + 1)
          continue; /* d has no direction of its own */
        assert_true(angle_degrees(m.tangent + 4 * corner, along) < 1e-3);
        assert_true(m.tangent[4 * corner + 3] == side);
      }
      free_mesh(&m);
    }
}

/* A fan of mirrored triangles goes on across one without UV area: one tangent at their corner. */
static void test_a_mirrored_fan_crosses_flat(void **state) {
  (void)state;
  const double degree = PI / 180, at[4] = {0, 60, 120, 210};
  const float uv[4][2] = {{-1, 0}, {0, 1}, {0, 2}, {1, 0}};
  for (int mirrored = 0; mirrored < 2; mirrored++) {
    const float side = mirrored ? 1 : -1;
    point rim[4];
    const point o = {{0, 0, 0}, {0, 0, 1}, {0, 0}};
    for (int k = 0; k < 4; k++)
      rim[k] = (point){{(float)cos(at[k] * degree), (float)sin(at[k] * degree), 0},
                       {0, 0, 1},
                       {side * uv[k][0], uv[k][1]}};
    mesh m = new_mesh(3);
    for (int k = 0; k < 3; k++)
      add_triangle(&m, o, rim[k], rim[k + 1]);
    solve(&m);
    /* dP/du of the first is -rim[0], of the last rim[3], weighed by 60 and 90 degrees */
    const double sum[3] = {(double)side * (-60 + 90 * cos(at[3] * degree)),
                           (double)side * 90 * sin(at[3] * degree), 0};
    for (int k = 0; k < 3; k++) {
      assert_true(angle_degrees(m.tangent + 12 * k, sum) < 1e-3);
      assert_true(m.tangent[12 * k + 3] == -side);
    }
    free_mesh(&m);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_flat_takes_the_handedness),
      cmocka_unit_test(test_a_mirrored_fan_crosses_flat),
      cmocka_unit_test(test_plane),
      cmocka_unit_test(test_mirrored_seam),
      cmocka_unit_test(test_curved),
      cmocka_unit_test(test_angle_weights),
      cmocka_unit_test(test_u_along_the_normal),
      cmocka_unit_test(test_fans_stay_apart),
      cmocka_unit_test(test_crowded_edge),
      cmocka_unit_test(test_flat_joins),
      cmocka_unit_test(test_collapsed_shares),
      cmocka_unit_test(test_indexing_does_not_matter),
      cmocka_unit_test(test_threads_do_not_matter),
      cmocka_unit_test(test_long_normals),
      cmocka_unit_test(test_negative_zero),
      cmocka_unit_test(test_no_uv_at_all),
      cmocka_unit_test(test_a_line),
      cmocka_unit_test(test_beside_others),
      cmocka_unit_test(test_not_finite),
      cmocka_unit_test(test_extreme_sizes),
      cmocka_unit_test(test_zero_normal),
      cmocka_unit_test(test_high_valence),
      cmocka_unit_test(test_one_edge_many_times),
      cmocka_unit_test(test_impossible_sizes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
