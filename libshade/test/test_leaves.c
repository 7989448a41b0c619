/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The errors that kernel/leaf_detail.h, leaf_repair.h, leaf_diffuse.h and leaf_brdf.h state of
 * single leaves, against the reference or long double.
 */
#include <string.h>

#include "support.h"
#include "kernel/coefficients.h"

#define SHADE_FLOAT 1
#include "kernel/real.h"
#include "kernel/elementary.h"
#include "kernel/leaf_random.h"
#include "kernel/leaf_brdf.h"
#include "kernel/leaf_detail.h"
#include "kernel/mdf.h"
#include "kernel/leaf_fresnel.h"
#include "kernel/leaf_diffuse.h"
#include "kernel/leaf_repair.h"
#undef SHADE_FLOAT
#define SHADE_FLOAT 0
#include "kernel/real.h"
#include "kernel/elementary.h"
#include "kernel/leaf_random.h"
#include "kernel/leaf_brdf.h"
#include "kernel/leaf_detail.h"
#include "kernel/mdf.h"
#include "kernel/leaf_fresnel.h"
#include "kernel/leaf_diffuse.h"
#include "kernel/leaf_repair.h"

/* n tilted to 89.9 degrees (warps 75), h anywhere above its carried horizon. */
static void draw(uint64_t *seed, double tilt, double n[3], double h[3], float nf[3], float hf[3]) {
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
    nf[c] = (float)n[c];
    hf[c] = (float)h[c];
  }
}

/* The leaf of a method's map, for grooves along x, as slopes. */
#define LEAF_CASE(NAME, leaf, along_y, kind, frame, f)                                             \
  case SHADE_MAP_##NAME:                                                                           \
    p = along_y ? lobe_at##f(detail_##leaf##f(n[1], n[0], n[2], h[1], h[0], h[2]))                 \
                : lobe_at##f(detail_##leaf##f(n[0], n[1], n[2], h[0], h[1], h[2]));                \
    return along_y ? (lobe_point##f){p.t, p.yy, p.xx} : p;
static lobe_point leaf(shade_map map, const double n[3], const double h[3]) {
  lobe_point p = {0, 0, 0};
  switch (map) {
    SHADE_MAP_ROWS(LEAF_CASE, )
  case SHADE_MAP_COUNT:
    break;
  }
  return p;
}
static lobe_pointf leaff(shade_map map, const float n[3], const float h[3]) {
  lobe_pointf p = {0, 0, 0};
  switch (map) {
    SHADE_MAP_ROWS(LEAF_CASE, f)
  case SHADE_MAP_COUNT:
    break;
  }
  return p;
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
    double worst = 0, worstf = 0;
    uint64_t seed = 3;
    for (int i = 0; i < 200000; i++) {
      double n[3], h[3];
      float nf[3], hf[3];
      draw(&seed, is_warp(d) ? 75 : 89.9, n, h, nf, hf);
      lobe_point p = leaf(map, n, h);
      worst = fmax(worst, slope_error(d, n, h, p.t, p.xx, p.yy));
      for (int c = 0; c < 3; c++) {
        n[c] = (double)nf[c];
        h[c] = (double)hf[c];
      }
      lobe_pointf q = leaff(map, nf, hf);
      worstf = fmax(worstf, slope_error(d, n, h, (double)q.t, (double)q.xx, (double)q.yy));
    }
    print_message("%s: slopes, double %.1e, float %.1e\n",
                  shade_list_word(SHADE_LIST_DETAIL, (int)d), worst, worstf);
    assert_true(worst <= (is_warp(d) ? 1.5e-15 : 4e-16));
    assert_true(worstf <= (is_warp(d) ? 5e-7 : 2e-7));
  }
}

static void units(void **state) {
  (void)state;
  uint64_t seed = 5;
  double length = 0, lengthf = 0, way = 0, wayf = 0, across = 0, acrossf = 0, half = 0, halff = 0;
  for (int i = 0; i < 300000; i++) {
    double v[3], n[3], size = pow(10, 600 * uniform(&seed) - 300);
    float vf[3], sizef = (float)pow(10, 60 * uniform(&seed) - 30);
    spherical(PI * uniform(&seed), 2 * PI * uniform(&seed), n);
    long double exact[3], exactf[3], sum = 0, sumf = 0, got = 0, gotf = 0;
    for (int c = 0; c < 3; c++) {
      exact[c] = (long double)(v[c] = n[c] * size);
      exactf[c] = (long double)(vf[c] = (float)n[c] * sizef);
    }
    for (int c = 0; c < 3; c++) {
      sum += (exact[c] / size) * (exact[c] / size);
      sumf += (exactf[c] / sizef) * (exactf[c] / sizef);
    }
    assert_true(make_unit(v) && make_unitf(vf));
    for (int c = 0; c < 3; c++) {
      got += (long double)v[c] * v[c];
      gotf += (long double)vf[c] * (long double)vf[c];
      way = fmax(way, (double)fabsl(v[c] - exact[c] / size / sqrtl(sum)));
      wayf = fmax(wayf, (double)fabsl((long double)vf[c] - exactf[c] / sizef / sqrtl(sumf)));
    }
    length = fmax(length, (double)fabsl(sqrtl(got) - 1));
    lengthf = fmax(lengthf, (double)fabsl(sqrtl(gotf) - 1));

    double w[3];
    float nf[3], wf[3];
    spherical(89.9 * PI / 180 * uniform(&seed), 2 * PI * uniform(&seed), n);
    spherical(PI / 2 * uniform(&seed), 2 * PI * uniform(&seed), w);
    for (int c = 0; c < 3; c++) {
      nf[c] = (float)n[c];
      wf[c] = (float)w[c];
    }
    for (int single = 0; single < 2; single++) {
      long double a[3], b[3];
      for (int c = 0; c < 3; c++) {
        a[c] = single ? (long double)nf[c] : n[c];
        b[c] = single ? (long double)wf[c] : w[c];
      }
      long double y = a[0] * (a[0] * b[1] - a[1] * b[0]) + a[2] * (a[2] * b[1] - a[1] * b[2]);
      y /= sqrtl(a[0] * a[0] + a[2] * a[2]);
      long double h = sqrtl((a[0] + b[0]) * (a[0] + b[0]) + (a[1] + b[1]) * (a[1] + b[1]) +
                            (a[2] + b[2]) * (a[2] + b[2])) /
                      2;
      if (h > 1)
        h = 1;
      if (single) {
        acrossf = fmax(
            acrossf, (double)fabsl(
                         (long double)across_fibref(nf[0], nf[1], nf[2], wf[0], wf[1], wf[2]) - y));
        halff = fmax(
            halff, (double)fabsl(
                       (long double)half_cosinef(nf[0] + wf[0], nf[1] + wf[1], nf[2] + wf[2]) - h));
      } else {
        across = fmax(across, (double)fabsl(across_fibre(n[0], n[1], n[2], w[0], w[1], w[2]) - y));
        half = fmax(half, (double)fabsl(half_cosine(n[0] + w[0], n[1] + w[1], n[2] + w[2]) - h));
      }
    }
  }
  print_message("make_unit: length off by %.1e, float %.1e; components %.1e, %.1e\n", length,
                lengthf, way, wayf);
  print_message("across_fibre: %.1e, float %.1e; half_cosine: %.1e, %.1e\n", across, acrossf, half,
                halff);
  assert_true(length <= 3e-16 && lengthf <= 2e-7);
  assert_true(way <= 3e-16 && wayf <= 2e-7);
  assert_true(across <= 6e-16 && acrossf <= 3e-7);
  assert_true(half <= 3e-16 && halff <= 2e-7);
}

/* Normals that all but lie in the surface, to either side of it: what one has at h the other has at
 * h mirrored, down to the smallest n.z. */
static void steepest(void **state) {
  (void)state;
  uint64_t seed = 31;
  for (int i = 0; i < 400; i++) {
    const double nz = pow(10, -(i % 2 ? 300 : 35) * uniform(&seed)),
                 nx = sqrt(1 - fmin(nz * nz, 1));
    double h[3];
    spherical(1.5 * uniform(&seed), 3 * uniform(&seed) - 1.5, h);
    const lobe_point p = lobe_at(detail_rotate(nx, 0, nz, h[0], h[1], h[2]));
    const lobe_point q = lobe_at(detail_rotate(-nx, 0, nz, -h[0], h[1], h[2]));
    assert_true(isfinite(p.t) && isfinite(p.xx) && isfinite(p.yy));
    assert_true(p.t == q.t && p.xx == q.xx && p.yy == q.yy);
    if (i % 2)
      continue;
    const float x = (float)nx, z = (float)nz, hx = (float)h[0], hy = (float)h[1], hz = (float)h[2];
    const lobe_pointf pf = lobe_atf(detail_rotatef(x, 0, z, hx, hy, hz));
    const lobe_pointf qf = lobe_atf(detail_rotatef(-x, 0, z, -hx, hy, hz));
    assert_true(isfinite(pf.t) && isfinite(pf.xx) && isfinite(pf.yy));
    assert_true(pf.t == qf.t && pf.xx == qf.xx && pf.yy == qf.yy);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(slopes), cmocka_unit_test(units),
                                     cmocka_unit_test(steepest)};
  return cmocka_run_group_tests_name("leaves", tests, NULL, NULL);
}
