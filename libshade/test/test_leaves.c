/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.9 */
/*
 * The errors that model/detail.h, direction.h, diffuse.h and brdf.h state of
 * single leaves, against the reference or long double: in double, and in float by
 * test_leaves_float.c.
 */
#include <string.h>

#include "model/diffuse.h"
#include "model/direction.h"
#include "model/mdf.h"
#include "support.h"

#define LIMIT(of_float, of_double) (SHADE_FLOAT ? of_float : of_double)
static const char *const precision = LIMIT("float", "double");

/* What a leaf is given, without what its type cannot hold. */
static void round_to(const real from[3], double v[3]) {
  for (int c = 0; c < 3; c++)
    v[c] = (double)from[c];
}

/* n tilted to 89.9 degrees (warps 75), h anywhere above its carried horizon. */
static void draw(uint64_t *seed, double tilt, double n[3], double h[3], real to_n[3],
                 real to_h[3]) {
  spherical(tilt * PI / 180 * uniform(seed), 2 * PI * uniform(seed), n);
  spherical(PI / 2 * uniform(seed), 2 * PI * uniform(seed), h);
  double near = uniform(seed), length = 0; /* as often close to n as far from it */
  near *= near;
  for (int c = 0; c < 3; c++) {
    h[c] = n[c] + near * (h[c] - n[c]);
    length += h[c] * h[c];
  }
  for (int c = 0; c < 3; c++) {
    h[c] /= sqrt(length);
    to_n[c] = (real)n[c];
    to_h[c] = (real)h[c];
  }
}

/* The leaf of a method's map, for grooves along x, as slopes. */
static lobe_point leaf(shade_map map, const real n[3], const real h[3]) {
  return lobe_at(detail(map, (triple){n[0], n[1], n[2]}, (triple){h[0], h[1], h[2]}));
}

/* Errors of the slopes along x and y, over 1 + tan^2; -1 where the horizon was missed. */
static double slope_error(shade_detail d, const double n[3], const double h[3], double t, double xx,
                          double yy) {
  shade_params p;
  shade_params_init(&p);
  p.detail = d;
  p.groove = SHADE_GROOVE_X;
  double m[3];
  shade_ref_carried(&p, n, h, m);
  if (m[2] < (is_warp(d) ? .5 : .05))
    return m[2] < -1e-6 && t >= 0 ? 1e30 : 0;
  double x = fabs(sqrt(xx) - fabs(m[0] / m[2])), y = fabs(sqrt(yy) - fabs(m[1] / m[2]));
  return t < 0 ? 1e30 : fmax(x, y) / (1 + (m[0] * m[0] + m[1] * m[1]) / (m[2] * m[2]));
}

static void slopes(void **state) {
  (void)state;
  for (int method = 0; method < SHADE_DETAIL_COUNT; method++) {
    const shade_detail d = (shade_detail)method;
    const shade_map map = shade_detail_is(d).slopes[0];
    double worst = 0;
    uint64_t seed = 3;
    for (int i = 0; i < 200000; i++) {
      double n[3], h[3];
      real to_n[3], to_h[3];
      draw(&seed, is_warp(d) ? 75 : 89.9, n, h, to_n, to_h);
      const lobe_point p = leaf(map, to_n, to_h);
      round_to(to_n, n);
      round_to(to_h, h);
      worst = fmax(worst, slope_error(d, n, h, (double)p.t, (double)p.xx, (double)p.yy));
    }
    print_message("%s: slopes, %s %.1e\n", shade_list_word(SHADE_LIST_DETAIL, (int)d), precision,
                  worst);
    assert_true(worst <= (is_warp(d) ? LIMIT(5e-7, 1.5e-15) : LIMIT(2e-7, 4e-16)));
  }
}

static void units(void **state) {
  (void)state;
  uint64_t seed = 5;
  double length = 0, way = 0, across = 0, half = 0;
  for (int i = 0; i < 300000; i++) {
    const real size = (real)pow(10, LIMIT(60, 600) * uniform(&seed) - LIMIT(30, 300));
    double n[3], w[3];
    real v[3], m[3], l[3];
    spherical(PI * uniform(&seed), 2 * PI * uniform(&seed), n);
    long double exact[3], sum = 0, got = 0;
    for (int c = 0; c < 3; c++) {
      exact[c] = (long double)(v[c] = (real)n[c] * size) / (long double)size;
      sum += exact[c] * exact[c];
    }
    assert_true(make_unit(v));
    for (int c = 0; c < 3; c++) {
      got += (long double)v[c] * (long double)v[c];
      way = fmax(way, (double)fabsl((long double)v[c] - exact[c] / sqrtl(sum)));
    }
    length = fmax(length, (double)fabsl(sqrtl(got) - 1));

    spherical(89.9 * PI / 180 * uniform(&seed), 2 * PI * uniform(&seed), n);
    spherical(PI / 2 * uniform(&seed), 2 * PI * uniform(&seed), w);
    for (int c = 0; c < 3; c++) {
      m[c] = (real)n[c];
      l[c] = (real)w[c];
    }
    round_to(m, n);
    round_to(l, w);
    const long double a[3] = {n[0], n[1], n[2]}, b[3] = {w[0], w[1], w[2]};
    long double y = a[0] * (a[0] * b[1] - a[1] * b[0]) + a[2] * (a[2] * b[1] - a[1] * b[2]);
    y /= sqrtl(a[0] * a[0] + a[2] * a[2]);
    long double h = sqrtl((a[0] + b[0]) * (a[0] + b[0]) + (a[1] + b[1]) * (a[1] + b[1]) +
                          (a[2] + b[2]) * (a[2] + b[2])) /
                    2;
    if (h > 1)
      h = 1;
    const real over = across_fibre(m[0], m[1], m[2], l[0], l[1], l[2]);
    const real cosine = half_cosine(m[0] + l[0], m[1] + l[1], m[2] + l[2]);
    across = fmax(across, (double)fabsl((long double)over - y));
    half = fmax(half, (double)fabsl((long double)cosine - h));
  }
  print_message("%s: make_unit: length off by %.1e, components %.1e\n", precision, length, way);
  print_message("%s: across_fibre: %.1e, half_cosine: %.1e\n", precision, across, half);
  assert_true(length <= LIMIT(2e-7, 3e-16));
  assert_true(way <= LIMIT(2e-7, 3e-16));
  assert_true(across <= LIMIT(3e-7, 6e-16));
  assert_true(half <= LIMIT(2e-7, 3e-16));
}

/* Normals that all but lie in the surface, to either side of it: what one has at h the other has at
 * h mirrored, down to the smallest n.z. */
static void steepest(void **state) {
  (void)state;
  uint64_t seed = 31;
  for (int i = 0; i < 400; i++) {
    const double nz = pow(10, -LIMIT(35, 300) * uniform(&seed)), nx = sqrt(1 - fmin(nz * nz, 1));
    double h[3];
    spherical(1.5 * uniform(&seed), 3 * uniform(&seed) - 1.5, h);
    const real x = (real)nx, z = (real)nz, hx = (real)h[0], hy = (real)h[1], hz = (real)h[2];
    const lobe_point p = lobe_at(detail_rotate(x, 0, z, hx, hy, hz));
    const lobe_point q = lobe_at(detail_rotate(-x, 0, z, -hx, hy, hz));
    assert_true(isfinite(p.t) && isfinite(p.xx) && isfinite(p.yy));
    assert_true(p.t == q.t && p.xx == q.xx && p.yy == q.yy);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(slopes), cmocka_unit_test(units),
                                     cmocka_unit_test(steepest)};
  return cmocka_run_group_tests_name("leaves", tests, NULL, NULL);
}
