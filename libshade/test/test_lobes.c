/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 3.6 */
/*
 * What the carried distributions are, against integrals and a displaced surface
 * built long-hand here: the figures of the method (sections 1 and 2).
 */
#include "support.h"

static const double ex = 200, ey = 10;

/* A grid over the hemisphere; midpoints, so that no point lies on the pole. */
enum { THETAS = 300, PHIS = 300, POINTS = THETAS * PHIS };
static double grid_x[POINTS], grid_y[POINTS], grid_z[POINTS], grid_weight[POINTS];
static double lane_nx[POINTS], lane_ny[POINTS], lane_nz[POINTS], value[POINTS];

static int make_grid(void **state) {
  (void)state;
  for (int i = 0; i < POINTS; i++) {
    double theta = (i / PHIS + 0.5) * (PI / 2) / THETAS;
    double phi = (i % PHIS + 0.5) * 2 * PI / PHIS;
    double v[3];
    spherical(theta, phi, v);
    grid_x[i] = v[0];
    grid_y[i] = v[1];
    grid_z[i] = v[2];
    grid_weight[i] = sin(theta) * (PI / 2 / THETAS) * (2 * PI / PHIS);
  }
  return 0;
}

static void evaluate(const shade_bsdf *b, const double n[3]) {
  for (int i = 0; i < POINTS; i++) {
    lane_nx[i] = n[0];
    lane_ny[i] = n[1];
    lane_nz[i] = n[2];
  }
  shade_mdf_eval_batch(b, POINTS, lane_nx, lane_ny, lane_nz, grid_x, grid_y, grid_z, value);
}

static double integral(shade_detail detail, double nx, double ny) {
  shade_bsdf b = make_bsdf(detail, SHADE_GROOVE_AUTO, ex, ey);
  double n[3] = {nx, ny, sqrt(1 - nx * nx - ny * ny)}, sum = 0;
  evaluate(&b, n);
  for (int i = 0; i < POINTS; i++)
    sum += value[i] * grid_weight[i];
  return sum;
}

static void energy(void **state) {
  (void)state;
  const struct {
    shade_detail detail;
    double nx, ny, want;
  } cases[] = {
      {SHADE_DETAIL_NONE, 0, 0, 1},
      {SHADE_DETAIL_NONE, .3, .2, 1},
      {SHADE_DETAIL_PERTURB, .3, 0, .652},
      {SHADE_DETAIL_PERTURB, 0, .3, 1.263},
      {SHADE_DETAIL_PERTURB, .5, .5, .850},
      {SHADE_DETAIL_ROTATE, .3, 0, 1},
      {SHADE_DETAIL_ROTATE, 0, .3, 1},
      {SHADE_DETAIL_ROTATE, .5, .5, .9999},
      {SHADE_DETAIL_DEFORM_LINEAR, .3, 0, 1.028},
      {SHADE_DETAIL_DEFORM_LINEAR, 0, .3, 1.020},
      {SHADE_DETAIL_DEFORM_LINEAR, .5, .5, 1.172},
      {SHADE_DETAIL_DEFORM_SMOOTH, .3, 0, 1.012},
      {SHADE_DETAIL_DEFORM_SMOOTH, 0, .3, 1.005},
      {SHADE_DETAIL_DEFORM_SMOOTH, .5, .5, 1.065},
      {SHADE_DETAIL_DEFORM_LINEAR_CONSERVING, .3, 0, 1},
      {SHADE_DETAIL_DEFORM_LINEAR_CONSERVING, 0, .3, 1},
      {SHADE_DETAIL_DEFORM_LINEAR_CONSERVING, .5, .5, 1},
      {SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING, .3, 0, 1},
      {SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING, 0, .3, 1},
      {SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING, .5, .5, 1},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    double got = integral(cases[i].detail, cases[i].nx, cases[i].ny);
    print_message("integral %s n=(%g, %g): %.4f\n",
                  shade_list_word(SHADE_LIST_DETAIL, (int)cases[i].detail), cases[i].nx,
                  cases[i].ny, got);
    assert_near(got, cases[i].want, 6e-4);
  }
}

/* With a projected distribution it is the integral of D' n.h that the warps conserve. */
static void conserving_projected(void **state) {
  (void)state;
  const double normals[][2] = {{.3, 0}, {0, .3}, {.5, .5}};
  for (int k = 0; k < 12; k++) {
    shade_bsdf b = make_lobe(k & 1 ? SHADE_MDF_BECKMANN : SHADE_MDF_GGX,
                             k & 2 ? SHADE_DETAIL_DEFORM_LINEAR_CONSERVING
                                   : SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING,
                             SHADE_GROOVE_AUTO, ex, ey);
    double n[3] = {normals[k / 4][0], normals[k / 4][1], 0}, sum = 0;
    n[2] = sqrt(1 - n[0] * n[0] - n[1] * n[1]);
    evaluate(&b, n);
    for (int i = 0; i < POINTS; i++)
      sum += value[i] * (n[0] * grid_x[i] + n[1] * grid_y[i] + n[2] * grid_z[i]) * grid_weight[i];
    print_message("%s %s n=(%g, %g): %.4f\n",
                  shade_list_word(SHADE_LIST_MDF, (int)bsdf_of(&b)->mdf),
                  shade_list_word(SHADE_LIST_DETAIL, (int)bsdf_of(&b)->detail), n[0], n[1], sum);
    assert_near(sum, 1,
                bsdf_of(&b)->mdf == SHADE_MDF_GGX ? 1.5e-2
                                                  : 1e-3); /* GGX reaches past n's horizon */
  }
}

/* What each distribution integrates to, without and with the cosine. */
static void normalisation(void **state) {
  (void)state;
  const struct {
    shade_mdf mdf;
    double ax, ay, plain, cosine; /* 0: not stated */
  } cases[] = {
      {SHADE_MDF_WARD, .3, .3, .888, .856},
      {SHADE_MDF_WARD_HALF, .3, .3, 1 - exp(-2 / .09), 0},
      {SHADE_MDF_WARD_HALF, .9, .9, 1 - exp(-2 / .81), 0},
      {SHADE_MDF_BECKMANN, .3, .3, 0, 1},
      {SHADE_MDF_BECKMANN, .15, .6, 0, 1},
      {SHADE_MDF_GGX, .3, .3, 0, 1},
      {SHADE_MDF_GGX, .15, .6, 0, 1},
      {SHADE_MDF_ASHIKHMIN_SHIRLEY, .15, .6, 1, 0},
  };
  const double normals[][2] = {{0, 0}, {.3, 0}, {0, .3}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
    for (int m = 0; m < 3; m++) {
      shade_params p;
      shade_params_init(&p);
      shade_params_set_alphas(&p, cases[k].ax, cases[k].ay);
      p.mdf = cases[k].mdf;
      shade_bsdf b;
      assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
      double n[3] = {normals[m][0], normals[m][1], 0};
      n[2] = sqrt(1 - n[0] * n[0] - n[1] * n[1]);
      evaluate(&b, n);
      double plain = 0, cosine = 0;
      for (int i = 0; i < POINTS; i++) {
        double d = n[0] * grid_x[i] + n[1] * grid_y[i] + n[2] * grid_z[i];
        plain += value[i] * grid_weight[i];
        cosine += value[i] * fmax(d, 0) * grid_weight[i];
      }
      print_message("%s alpha (%g, %g) n=(%g, %g): %.4f, with the cosine %.4f\n",
                    shade_list_word(SHADE_LIST_MDF, (int)p.mdf), p.ax, p.ay, n[0], n[1], plain,
                    cosine);
      /* tilted, broad lobes and long tails lose what turns below the horizon */
      double lost = m && (p.mdf == SHADE_MDF_GGX || p.ay > .3) ? .05 : 6e-4;
      if (cases[k].plain > 0)
        assert_true(plain < cases[k].plain + 6e-4 && plain > cases[k].plain - lost);
      if (cases[k].cosine > 0)
        assert_true(cosine < cases[k].cosine + 6e-4 && cosine > cases[k].cosine - lost);
    }
}

/*
 * The displaced truth: the plane through the origin with normal n is the height field
 * z = u p + v q; its microfacets are the flat surface's, seen in the frame of dP/du.
 */
static double displaced(const double n[3], double hx, double hy, double hz) {
  double p = -n[0] / n[2], length = sqrt(1 + p * p);
  double x[3] = {1 / length, 0, p / length};
  double y[3] = {n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]};
  double lx = x[0] * hx + x[1] * hy + x[2] * hz;
  double ly = y[0] * hx + y[1] * hy + y[2] * hz;
  double lz = n[0] * hx + n[1] * hy + n[2] * hz;
  if (lz <= 0)
    return 0;
  double phi = atan2(ly, lx);
  double e = ex * cos(phi) * cos(phi) + ey * sin(phi) * sin(phi);
  return sqrt((ex + 1) * (ey + 1)) / (2 * PI) * pow(lz, e);
}

enum { METHODS = 7 };
static const shade_detail methods[METHODS] = {
    SHADE_DETAIL_NONE,          SHADE_DETAIL_PERTURB,      SHADE_DETAIL_DEFORM_LINEAR,
    SHADE_DETAIL_DEFORM_SMOOTH, SHADE_DETAIL_SHORTEST_ARC, SHADE_DETAIL_GRAM_SCHMIDT,
    SHADE_DETAIL_ROTATE};

static void total_variation(void **state) {
  (void)state;
  static const struct {
    double tilt, want[METHODS];
  } rows[] = {{10, {.568, .390, .153, .071, .006, .013, 0}},
              {20, {.835, .501, .303, .149, .025, .051, 0}},
              {30, {.929, .513, .448, .240, .059, .115, 0}},
              {45, {.978, .509, .657, .409, .137, .254, 0}}};
  enum { AZIMUTHS = FEWER > 1 ? 64 : 96 };
  for (size_t r = 0; r < sizeof rows / sizeof rows[0]; r += FEWER) {
    double mean[METHODS] = {0};
    for (int a = 0; a < AZIMUTHS; a++) {
      double n[3];
      spherical(rows[r].tilt * PI / 180, 2 * PI * (a + 0.5) / AZIMUTHS, n);
      static double truth[POINTS];
      for (int i = 0; i < POINTS; i++)
        truth[i] = displaced(n, grid_x[i], grid_y[i], grid_z[i]);
      for (int d = 0; d < METHODS; d++) {
        shade_bsdf b = make_bsdf(methods[d], SHADE_GROOVE_AUTO, ex, ey);
        evaluate(&b, n);
        for (int i = 0; i < POINTS; i++)
          mean[d] += 0.5 / AZIMUTHS * grid_weight[i] * fabs(value[i] - truth[i]);
      }
    }
    print_message("tilt %2g:", rows[r].tilt);
    for (int d = 0; d < METHODS; d++)
      print_message(" %s %.3g", shade_list_word(SHADE_LIST_DETAIL, (int)methods[d]), mean[d]);
    print_message("\n");
    for (int d = 0; d < METHODS; d++)
      assert_near(mean[d], rows[r].want[d], methods[d] == SHADE_DETAIL_ROTATE ? 1e-12 : 7e-4);
  }
}

/* The fast form's two faces: no change for Ashikhmin-Shirley, slopes short by L for the rest. */
static void rotate_approximate(void **state) {
  (void)state;
  uint64_t seed = 4;
  for (int k = 0; k < 20000; k++) {
    double n[3], h[3];
    spherical(1.4 * uniform(&seed), 2 * PI * uniform(&seed), n);
    spherical(1.4 * uniform(&seed), 2 * PI * uniform(&seed), h);
    shade_mdf mdf = (shade_mdf)(k % SHADE_MDF_COUNT);
    shade_bsdf exact = make_lobe(mdf, SHADE_DETAIL_ROTATE, SHADE_GROOVE_X, 20, 3);
    double l = mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY ? 1 : hypot(n[0], n[2]);
    bsdf_in(&exact)->numbers.kx *= l * l;
    bsdf_in(&exact)->numbers.ky *= l * l;
    shade_bsdf fast = make_lobe(mdf, SHADE_DETAIL_ROTATE_APPROXIMATE, SHADE_GROOVE_X, 20, 3);
    double want = shade_mdf_eval(&exact, n, h, NULL);
    assert_true(fabs(shade_mdf_eval(&fast, n, h, NULL) - want) <= 1e-11 * want);
  }
}

/* h = n is the carried pole, whatever n, groove and exponents. */
static void peak_at_normal(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int k = 0; k < 20000; k++) {
    double n[3], nh[3];
    double theta = k % 10 ? PI / 2 * uniform(&seed) : PI / 2 - pow(10, -12 * uniform(&seed));
    spherical(theta, 2 * PI * uniform(&seed), n);
    if (k % 7 == 0)
      n[0] = 0;
    double e1 = pow(10, 5 * uniform(&seed)), e2 = pow(10, 5 * uniform(&seed));
    shade_bsdf b = make_lobe((shade_mdf)(k % SHADE_MDF_COUNT), SHADE_DETAIL_ROTATE,
                             (shade_groove)(k % 3), e1, e2);
    double peak = bsdf_of(&b)->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY
                      ? sqrt((e1 + 1) * (e2 + 1)) / (2 * PI)
                      : sqrt((e1 + 2) * (e2 + 2)) / (2 * PI);
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3; c++)
      nh[c] = n[c] /= length;
    assert_true(fabs(shade_mdf_eval(&b, n, nh, NULL) / peak - 1) <= 1e-12);
    float nf[3] = {(float)n[0], (float)n[1], (float)n[2]};
    assert_true(nf[2] <= 0 || fabsf(shade_mdf_evalf(&b, nf, nf, NULL) / (float)peak - 1) <= 1e-6f);
  }
  /* the direction where the tangent has no limit */
  shade_bsdf b = make_bsdf(SHADE_DETAIL_ROTATE, SHADE_GROOVE_X, 200, 10);
  for (double nz = 1e-3; nz > 1e-307; nz /= 10) {
    double n[3] = {0, 1, nz};
    assert_true(fabs(shade_mdf_eval(&b, n, n, NULL) / bsdf_of(&b)->numbers.peak - 1) <= 1e-12);
    float nf[3] = {0, 1, (float)nz};
    assert_true(nf[2] <= 0 ||
                fabsf(shade_mdf_evalf(&b, nf, nf, NULL) / bsdf_of(&b)->numbersf.peak - 1) <= 1e-6f);
  }
}

/* Round lobes: perturb, gram-schmidt, rotate and the shortest arc are the same thing. */
static void isotropic(void **state) {
  (void)state;
  uint64_t seed = 2;
  for (int k = 0; k < 20000; k++) {
    double n[3], h[3], e = pow(10, 4 * uniform(&seed));
    shade_mdf mdf = (shade_mdf)(k % SHADE_MDF_COUNT);
    spherical(1.5 * uniform(&seed), 2 * PI * uniform(&seed), n);
    spherical(1.5 * uniform(&seed), 2 * PI * uniform(&seed), h);
    double want = 0;
    for (int d = SHADE_DETAIL_PERTURB; d <= SHADE_DETAIL_SHORTEST_ARC; d++) {
      shade_bsdf b = make_lobe(mdf, (shade_detail)d, SHADE_GROOVE_AUTO, e, e);
      double got = shade_mdf_eval(&b, n, h, NULL);
      if (d == SHADE_DETAIL_PERTURB)
        want = got;
      else if (want > 1e-12 * bsdf_of(&b)->numbers.peak)
        assert_true(fabs(got / want - 1) <= 1e-11);
    }
  }
}

/* The groove's axis: turning everything by 90 degrees trades x for y. */
static void groove_axis(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int k = 0; k < 5000; k++) {
    double n[3], h[3];
    spherical(1.4 * uniform(&seed), 2 * PI * uniform(&seed), n);
    spherical(1.4 * uniform(&seed), 2 * PI * uniform(&seed), h);
    double turned_n[3] = {-n[1], n[0], n[2]}, turned_h[3] = {-h[1], h[0], h[2]};
    shade_mdf mdf = (shade_mdf)(k % SHADE_MDF_COUNT);
    shade_bsdf along_x = make_lobe(mdf, SHADE_DETAIL_ROTATE, SHADE_GROOVE_X, 300, 5);
    shade_bsdf along_y = make_lobe(mdf, SHADE_DETAIL_ROTATE, SHADE_GROOVE_Y, 5, 300);
    shade_bsdf automatic = make_lobe(mdf, SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, 5, 300);
    double a = shade_mdf_eval(&along_x, n, h, NULL);
    double b = shade_mdf_eval(&along_y, turned_n, turned_h, NULL);
    assert_true(fabs(a - b) <= 1e-12 * bsdf_of(&along_x)->numbers.peak);
    assert_true(b == shade_mdf_eval(&automatic, turned_n, turned_h, NULL));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energy),
      cmocka_unit_test(normalisation),
      cmocka_unit_test(total_variation),
      cmocka_unit_test(isotropic),
      cmocka_unit_test(peak_at_normal),
      cmocka_unit_test(groove_axis),
      cmocka_unit_test(rotate_approximate),
      cmocka_unit_test(conserving_projected),
  };
  return cmocka_run_group_tests_name("lobes", tests, make_grid, NULL);
}
