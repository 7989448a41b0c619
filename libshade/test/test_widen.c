/* SPDX-License-Identifier: Apache-2.0 */
/* Covariance into roughness: exact for Gaussian slopes, measured for all distributions. */
#include "test/support.h"

#include <string.h>

#include "shade/maps.h"

static shade_params material(shade_mdf mdf, double ex, double ey) {
  shade_params p;
  shade_params_init(&p);
  p.mdf = mdf;
  shade_params_set_exponents(&p, ex, ey);
  return p;
}

static double distribution(const shade_params *p, const double n[3], const double h[3]) {
  shade_bsdf b;
  shade_bsdf_setup(&b, p);
  return shade_mdf_eval(&b, n, h, NULL);
}

/* h in the frame whose tangent is turned by the angle. */
static void turned(const double h[3], double angle, double to[3]) {
  to[0] = cos(angle) * h[0] + sin(angle) * h[1];
  to[1] = cos(angle) * h[1] - sin(angle) * h[0];
  to[2] = h[2];
}

static const double up[3] = {0, 0, 1};

/*
 * Beckmann's D is a Gaussian of slopes over cos^4. Gaussians convolve to a Gaussian:
 * D = exp(-s' M^-1 s)/(pi sqrt(det M) cos^4), M = diag(ax^2, ay^2) + 2 covariance.
 */
static void gaussian_slopes_add_exactly(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int i = 0; i < 2000; i++) {
    shade_params p = material(SHADE_MDF_BECKMANN, 0, 0), wide;
    shade_params_set_alphas(&p, 0.05 + 0.5 * uniform(&seed), 0.05 + 0.5 * uniform(&seed));
    const double a = 0.1 * uniform(&seed), c = 0.1 * uniform(&seed);
    const double b = sqrt(a * c) * (2 * uniform(&seed) - 1), covariance[3] = {a, b, c};
    double angle;
    assert_int_equal(shade_params_widen(&p, up, covariance, &wide, &angle), SHADE_OK);
    assert_true(fabs(angle) <= PI / 4 + 1e-12);
    const double xx = p.ax * p.ax + 2 * a, xy = 2 * b, yy = p.ay * p.ay + 2 * c;
    const double det = xx * yy - xy * xy;
    double h[3], local[3];
    spherical(uniform(&seed), 2 * PI * uniform(&seed), h);
    const double x = h[0] / h[2], y = h[1] / h[2];
    const double want =
        exp(-(yy * x * x - 2 * xy * x * y + xx * y * y) / det) / (PI * sqrt(det) * pow(h[2], 4));
    turned(h, angle, local);
    assert_near(distribution(&wide, up, local), want, 1e-9 * want + 1e-30);
    /* the other pair and the rest go along */
    assert_near(wide.ex, fmax(0, 2 / (wide.ax * wide.ax) - 2), 1e-9 * (1 + wide.ex));
    assert_true(wide.brdf == p.brdf && wide.detail == p.detail);
  }
}

/* Exponents: 1/e' = 1/e + sigma^2 along the axes. */
static void exponents_add_their_inverses(void **state) {
  (void)state;
  const shade_params p = material(SHADE_MDF_ASHIKHMIN_SHIRLEY, 500, 20);
  shade_params wide;
  double angle;
  shade_params_widen(&p, NULL, (double[3]){0.01, 0, 0.04}, &wide, &angle);
  assert_near(angle, 0, 1e-12);
  assert_near(wide.ex, 1 / (1.0 / 500 + 0.01), 1e-9);
  assert_near(wide.ey, 1 / (1.0 / 20 + 0.04), 1e-9);
  shade_params_widen(&p, NULL, (double[3]){0, 0, 0}, &wide, &angle);
  assert_near(wide.ex, 500, 1e-9);
  assert_near(wide.ey, 20, 1e-9);
  assert_near(angle, 0, 1e-12);
  /* a lobe without an end stays without one */
  const shade_params flat = material(SHADE_MDF_ASHIKHMIN_SHIRLEY, 0, 0);
  shade_params_widen(&flat, NULL, (double[3]){0.1, 0.05, 0.2}, &wide, &angle);
  assert_true(wide.ex < 1e-9 && wide.ey < 1e-9 && isfinite(angle));
}

/* Grooves of a lobe stay where they were; those of a round one follow the scratches. */
static void grooves_stay(void **state) {
  (void)state;
  shade_params wide;
  double angle;
  shade_params p = material(SHADE_MDF_GGX, 200, 100);
  shade_params_widen(&p, NULL, (double[3]){0.5, 0, 0}, &wide, &angle);
  assert_true(wide.ax > wide.ay);
  assert_int_equal(wide.groove, SHADE_GROOVE_X);
  p = material(SHADE_MDF_GGX, 100, 200);
  shade_params_widen(&p, NULL, (double[3]){0, 0, 0.5}, &wide, &angle);
  assert_int_equal(wide.groove, SHADE_GROOVE_Y);
  p = material(SHADE_MDF_GGX, 100, 100);
  shade_params_widen(&p, NULL, (double[3]){0.5, 0, 0}, &wide, &angle);
  assert_int_equal(wide.groove, SHADE_GROOVE_AUTO);
  p.groove = SHADE_GROOVE_Y;
  shade_params_widen(&p, NULL, (double[3]){0.5, 0.1, 0}, &p, &angle); /* in place */
  assert_int_equal(p.groove, SHADE_GROOVE_Y);
  assert_true(p.ax > 0.7);
}

/*
 * On a tilted mean normal the covariance is that of slopes measured from the tilted plane:
 * by differences of normals in the frame that is really displaced.
 */
static void a_tilted_normal_narrows_the_covariance(void **state) {
  (void)state;
  uint64_t seed = 5;
  for (int i = 0; i < 500; i++) {
    const int groove_y = i % 2;
    const double sx = 2 * uniform(&seed) - 1, sy = 2 * uniform(&seed) - 1;
    const double length = sqrt(sx * sx + sy * sy + 1);
    const double n[3] = {-sx / length, -sy / length, 1 / length};
    /* the groove's direction in the surface: (1, 0, sx) or (0, 1, sy); the other by n */
    double x[3], y[3];
    if (groove_y) {
      const double l = sqrt(1 + sy * sy), d[3] = {0, 1 / l, sy / l};
      memcpy(y, d, sizeof d);
      x[0] = y[1] * n[2] - y[2] * n[1];
      x[1] = y[2] * n[0] - y[0] * n[2];
      x[2] = y[0] * n[1] - y[1] * n[0];
    } else {
      const double l = sqrt(1 + sx * sx), d[3] = {1 / l, 0, sx / l};
      memcpy(x, d, sizeof d);
      y[0] = n[1] * x[2] - n[2] * x[1];
      y[1] = n[2] * x[0] - n[0] * x[2];
      y[2] = n[0] * x[1] - n[1] * x[0];
    }
    double j[2][2];
    for (int k = 0; k < 2; k++) {
      double ends[2][2];
      for (int sign = 0; sign < 2; sign++) {
        const double e = sign ? 1e-5 : -1e-5;
        const double m[3] = {-sx - (k == 0 ? e : 0), -sy - (k == 1 ? e : 0), 1};
        const double mz = m[0] * n[0] + m[1] * n[1] + m[2] * n[2];
        ends[sign][0] = -(m[0] * x[0] + m[1] * x[1] + m[2] * x[2]) / mz;
        ends[sign][1] = -(m[0] * y[0] + m[1] * y[1] + m[2] * y[2]) / mz;
      }
      for (int r = 0; r < 2; r++)
        j[r][k] = (ends[1][r] - ends[0][r]) / 2e-5;
    }
    const double c[3] = {0.02, 0.01, 0.03};
    shade_params p = material(SHADE_MDF_WARD, 200, 200), wide;
    shade_params_set_alphas(&p, 0.1, 0.2);
    p.groove = groove_y ? SHADE_GROOVE_Y : SHADE_GROOVE_X;
    double angle;
    shade_params_widen(&p, n, c, &wide, &angle);
    const double xx = 0.01 + 2 * (j[0][0] * j[0][0] * c[0] + 2 * j[0][0] * j[0][1] * c[1] +
                                  j[0][1] * j[0][1] * c[2]);
    const double yy = 0.04 + 2 * (j[1][0] * j[1][0] * c[0] + 2 * j[1][0] * j[1][1] * c[1] +
                                  j[1][1] * j[1][1] * c[2]);
    const double xy =
        2 * (j[0][0] * j[1][0] * c[0] + (j[0][0] * j[1][1] + j[0][1] * j[1][0]) * c[1] +
             j[0][1] * j[1][1] * c[2]);
    const double cs = cos(angle), sn = sin(angle), a = wide.ax * wide.ax, b = wide.ay * wide.ay;
    assert_near(cs * cs * a + sn * sn * b, xx, 1e-8);
    assert_near(cs * sn * (a - b), xy, 1e-8);
    assert_near(sn * sn * a + cs * cs * b, yy, 1e-8);
  }
}

/*
 * Total variation between the widened lobe and the mean of the lobe over Gaussian slopes
 * about z: the figures that maps.h states.
 */
static double total_variation(shade_mdf mdf, double sigma) {
  enum { NODES = 17, THETA = 160, PHI = 45 };
  const shade_params p = material(mdf, 200, 10);
  shade_params wide;
  double angle;
  const double covariance[3] = {sigma * sigma, 0, sigma * sigma};
  assert_int_equal(shade_params_widen(&p, NULL, covariance, &wide, &angle), SHADE_OK);
  shade_bsdf narrow, broad;
  shade_bsdf_setup(&narrow, &p);
  shade_bsdf_setup(&broad, &wide);
  double weight[NODES], node[NODES], total = 0;
  for (int i = 0; i < NODES; i++) { /* trapezia: converges fast on a Gaussian */
    const double t = 9.0 * i / (NODES - 1) - 4.5;
    node[i] = sigma * t;
    weight[i] = exp(-t * t / 2);
    total += weight[i];
  }
  double difference = 0, whole = 0;
  for (int a = 0; a < THETA; a++)
    for (int b = 0; b < PHI; b++) { /* a quarter: all is symmetric */
      double h[3], truth = 0;
      const double theta = PI / 2 * (a + 0.5) / THETA;
      spherical(theta, PI / 2 * (b + 0.5) / PHI, h);
      for (int i = 0; i < NODES; i++)
        for (int k = 0; k < NODES; k++) {
          const double l = sqrt(1 + node[i] * node[i] + node[k] * node[k]);
          const double n[3] = {-node[i] / l, -node[k] / l, 1 / l};
          truth += weight[i] * weight[k] / (total * total) * shade_mdf_eval(&narrow, n, h, NULL);
        }
      difference += 0.5 * fabs(shade_mdf_eval(&broad, up, h, NULL) - truth) * sin(theta);
      whole += truth * sin(theta);
    }
  return difference / whole;
}

static void the_error_is_as_stated(void **state) {
  (void)state;
  const double sigmas[] = {0.05, 0.1, 0.2};
  static const struct {
    shade_mdf mdf;
    double stated[3];
  } table[] = {{SHADE_MDF_ASHIKHMIN_SHIRLEY, {0.0034, 0.0086, 0.0190}},
               {SHADE_MDF_WARD, {0.0042, 0.0137, 0.0443}},
               {SHADE_MDF_WARD_HALF, {0.0055, 0.0138, 0.0330}},
               {SHADE_MDF_BECKMANN, {0.0046, 0.0141, 0.0396}},
               {SHADE_MDF_GGX, {0.0444, 0.0941, 0.1515}}};
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
    for (int k = 0; k < 3; k++) {
      const double tv = total_variation(table[i].mdf, sigmas[k]);
      print_message("%-18s sigma %.2f: total variation %.4f\n",
                    shade_list_word(SHADE_LIST_MDF, (int)table[i].mdf), sigmas[k], tv);
      assert_near(tv, table[i].stated[k], 2e-4 + 0.01 * table[i].stated[k]);
    }
}

static void bad_covariances_are_mended(void **state) {
  (void)state;
  const shade_params p = material(SHADE_MDF_BECKMANN, 100, 50);
  const double bad[][3] = {{-1, 0, -1},      {0.1, 0.5, 0.1}, {NAN, 0, 0},
                           {0, INFINITY, 0}, {-0.1, 0, 0.2},  {1e300, 0, 1}};
  for (int k = 0; k < 6; k++) {
    shade_params wide;
    double angle = NAN;
    const unsigned status = shade_params_widen(&p, NULL, bad[k], &wide, &angle);
    assert_true(status & (k < 5 ? SHADE_BAD_INPUT : SHADE_CLAMPED_PARAMETER));
    assert_true(isfinite(angle) && isfinite(wide.ax) && isfinite(wide.ay));
    assert_true(wide.ax >= p.ax * (1 - 1e-12) && wide.ay >= p.ay * (1 - 1e-12));
  }
  /* {0.1, 0.5, 0.1} has 0.6 along the diagonal and -0.4 across it: 0.6 stays */
  shade_params wide;
  double angle;
  shade_params_widen(&p, NULL, bad[1], &wide, &angle);
  const double c = cos(angle), s = sin(angle), a = wide.ax * wide.ax, b = wide.ay * wide.ay;
  assert_near(c * s * (a - b), 0.6, 1e-9);
  assert_near(c * c * a + s * s * b, p.ax * p.ax + 0.6, 1e-9);
  const double upside_down[3] = {0, 0, -1};
  assert_int_equal(shade_params_widen(&p, upside_down, (double[3]){0.1, 0, 0.1}, &wide, &angle),
                   SHADE_BAD_INPUT);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(gaussian_slopes_add_exactly),
                                     cmocka_unit_test(exponents_add_their_inverses),
                                     cmocka_unit_test(grooves_stay),
                                     cmocka_unit_test(a_tilted_normal_narrows_the_covariance),
                                     cmocka_unit_test(the_error_is_as_stated),
                                     cmocka_unit_test(bad_covariances_are_mended)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
