/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 4.2 */
/*
 * docs/theory/papers.md: each formula as its paper prints it, beside the true one and the
 * library's. The printed formulas live here and nowhere else.
 */
#include <complex.h>

#include "support.h"

static const double ex = 200, ey = 10;

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalise(double v[3]) {
  double length = sqrt(dot(v, v));
  for (int c = 0; c < 3; c++)
    v[c] /= length;
}

/* h in the frame of the displaced surface: x' = dP/du, y' = n x x' ([KangCho Eq. 4]). */
static void displaced(const double n[3], const double h[3], double m[3]) {
  double x[3] = {n[2], 0, -n[0]}, y[3];
  normalise(x);
  cross(n, x, y);
  m[0] = dot(x, h);
  m[1] = dot(y, h);
  m[2] = dot(n, h);
}

/* Ashikhmin and Shirley's D of a cosine z and an azimuth (x, y) of any length. */
static double lobe(double x, double y, double z) {
  double r = x * x + y * y;
  double e = r > 0 ? (ex * x * x + ey * y * y) / r : (ex + ey) / 2;
  return z > 0 ? sqrt((ex + 1) * (ey + 1)) / (2 * PI) * pow(z, e) : 0;
}

/* The hemisphere by the midpoint rule. */
enum { THETAS = 240 / FEWER, PHIS = 240 / FEWER, POINTS = THETAS * PHIS };

static double direction(int i, double h[3]) {
  double theta = (i / PHIS + 0.5) * (PI / 2) / THETAS;
  spherical(theta, (i % PHIS + 0.5) * 2 * PI / PHIS, h);
  return sin(theta) * (PI / 2 / THETAS) * (2 * PI / PHIS);
}

typedef double (*model)(const double n[3], const double h[3]);

static double truth(const double n[3], const double h[3]) {
  double m[3];
  displaced(n, h, m);
  return lobe(m[0], m[1], m[2]);
}

/* Half the integral of |a - b|, mean over 24 azimuths of a normal with this tilt in degrees. */
static double total_variation(model a, model b, double tilt) {
  double sum = 0;
  for (int k = 0; k < 24; k++) {
    double n[3], h[3];
    spherical(tilt * PI / 180, 2 * PI * (k + 0.5) / 24, n);
    for (int i = 0; i < POINTS; i++) {
      double weight = direction(i, h);
      sum += 0.5 / 24 * weight * fabs(a(n, h) - b(n, h));
    }
  }
  return sum;
}

static double library(shade_detail detail, shade_groove groove, const double n[3],
                      const double h[3]) {
  shade_bsdf b = make_bsdf(detail, groove, ex, ey);
  return shade_mdf_eval(&b, n, h, NULL);
}

static double rotate(const double n[3], const double h[3]) {
  return library(SHADE_DETAIL_ROTATE, SHADE_GROOVE_X, n, h);
}

/* ---- Kang and Cho: rotation ------------------------------------------------------ */

/* Rows 1 and 2 of the matrix times h, sign +1 as printed in Eq. 9 and 11, -1 corrected. */
static void matrix(double sign, const double n[3], const double h[3], double m[3]) {
  m[0] = n[2] * h[0] - n[0] * h[2];
  m[1] = -n[0] * n[1] * h[0] + (1 - n[1] * n[1]) * h[1] + sign * n[1] * n[2] * h[2];
  m[2] = dot(n, h);
}

static double printed_row_two(const double n[3], const double h[3]) {
  double m[3];
  matrix(1, n, h, m);
  return lobe(m[0], m[1], m[2]);
}

static double corrected_row_two(const double n[3], const double h[3]) {
  double m[3];
  matrix(-1, n, h, m);
  return lobe(m[0], m[1], m[2]);
}

static void row_two(void **state) {
  (void)state;
  double printed = 0, corrected = 0;
  for (int i = 0; i < POINTS; i++) {
    double n[3], m[3];
    direction(i, n);
    matrix(1, n, n, m);
    printed = fmax(printed, fabs(m[1]));
    matrix(-1, n, n, m);
    corrected = fmax(corrected, fmax(fabs(m[0]), fabs(m[1])));
  }
  double off = total_variation(printed_row_two, truth, 30);
  print_message("row 2: h = n lies %.4f from the pole, corrected %.1e; TV at 30 degrees %.3f\n",
                printed, corrected, off);
  assert_near(printed, 4 / sqrt(27), 1e-3); /* 2 y (1 - y^2) at its largest: 0.770 */
  assert_true(corrected <= 1e-15);
  assert_near(off, .420, 1e-3);
  assert_true(total_variation(corrected_row_two, truth, 30) <= 1e-12);
  assert_true(total_variation(rotate, truth, 30) <= 1e-12);
}

/* Eq. 11's third row is n.n: D is the peak everywhere. */
static double printed_row_three(const double n[3], const double h[3]) {
  double m[3];
  matrix(-1, n, h, m);
  return lobe(m[0], m[1], dot(n, n));
}

static void row_three(void **state) {
  (void)state;
  double n[3], h[3], printed = 0, corrected = 0;
  spherical(30 * PI / 180, 1, n);
  for (int i = 0; i < POINTS; i++) {
    double weight = direction(i, h);
    printed += weight * printed_row_three(n, h);
    corrected += weight * rotate(n, h);
  }
  print_message("row 3: the integral of D is %.3f, corrected %.4f\n", printed, corrected);
  assert_near(printed, sqrt(201. * 11), 1e-2); /* 2 pi times the peak: 47.02 */
  assert_near(corrected, 1, 1e-3);
}

/* v' of Eq. 9 is (0, -nz, ny), said to be w' x u'. */
static void axis_v(void **state) {
  (void)state;
  double worst = 1;
  for (int i = 0; i < POINTS; i++) {
    double n[3], true_v[3];
    direction(i, n);
    double u[3] = {n[2], 0, -n[0]}, printed[3] = {0, -n[2], n[1]};
    cross(n, u, true_v);
    const double row[3] = {-n[0] * n[1], 1 - n[1] * n[1], -n[1] * n[2]};
    for (int c = 0; c < 3; c++)
      assert_near(true_v[c], row[c], 1e-15);
    worst = fmin(worst, dot(printed, true_v) / sqrt(dot(printed, printed) * dot(true_v, true_v)));
    assert_true(dot(printed, true_v) <= 0);
  }
  print_message("v': cosine of the angle to w' x u' down to %.6f\n", worst);
  assert_near(worst, -1, 1e-4);
}

/* Eq. 7 and KangChoKim Eq. 6 do not say of which vector phi is: of h it changes nothing. */
static double azimuth_of_h(const double n[3], const double h[3]) {
  return lobe(h[0], h[1], dot(n, h));
}

static void azimuth(void **state) {
  (void)state;
  for (int i = 0; i < POINTS; i += 7) {
    double n[3], h[3];
    spherical(.7, i, n);
    direction(i, h);
    double perturb = library(SHADE_DETAIL_PERTURB, SHADE_GROOVE_X, n, h);
    assert_near(azimuth_of_h(n, h), perturb, 1e-10 * perturb + 1e-250);
  }
  double off = total_variation(azimuth_of_h, truth, 30);
  print_message("azimuth of h: TV at 30 degrees %.3f\n", off);
  assert_near(off, .513, 1e-3);
}

/* The exponent's fraction over the common 1 - (n.h)^2 instead of x^2 + y^2. */
static double common_denominator(const double n[3], const double h[3]) {
  double m[3];
  matrix(-1, n, h, m);
  double sin2 = 1 - m[2] * m[2];
  double e = sin2 > 0 ? (ex * m[0] * m[0] + ey * m[1] * m[1]) / sin2 : (ex + ey) / 2;
  return m[2] > 0 ? sqrt((ex + 1) * (ey + 1)) / (2 * PI) * pow(m[2], e) : 0;
}

static void denominator(void **state) {
  (void)state;
  const struct { double tilt, want; } rows[] = {{30, .11}, {45, .25}, {60, .47}};
  const double peak = sqrt(201. * 11) / (2 * PI);
  for (int r = 0; r < 3; r++) {
    double worst = 0, ratio = 1;
    for (int k = 0; k < 48; k++)
      for (int i = 0; i < POINTS; i++) {
        double n[3], h[3];
        spherical(rows[r].tilt * PI / 180, 2 * PI * k / 48, n);
        direction(i, h);
        double want = truth(n, h), got = common_denominator(n, h);
        worst = fmax(worst, fabs(got - want) / peak);
        if (want > 1e-12 * peak)
          ratio = fmax(ratio, got / want);
      }
    print_message("common denominator, tilt %g: off by %.3f of the peak, by %.1e times\n",
                  rows[r].tilt, worst, ratio);
    assert_near(worst, rows[r].want, 6e-3);
    assert_true(ratio > 10);
  }
}

/* With grooves along y, which the paper draws (ex = 1, ey = 40), x' = dP/du is the wrong axis. */
static void groove(void **state) {
  (void)state;
  double sum = 0, right = 0;
  for (int k = 0; k < 48; k++) {
    double n[3], h[3];
    spherical(PI / 6, 2 * PI * (k + 0.5) / 48, n);
    shade_bsdf along_u = make_bsdf(SHADE_DETAIL_ROTATE, SHADE_GROOVE_X, ey, ex);
    shade_bsdf along_v = make_bsdf(SHADE_DETAIL_ROTATE, SHADE_GROOVE_Y, ey, ex);
    for (int i = 0; i < POINTS; i++) {
      double weight = direction(i, h) * 0.5 / 48;
      /* turned by 90 degrees the truth is that of grooves along x */
      double turned_n[3] = {n[1], -n[0], n[2]}, turned_h[3] = {h[1], -h[0], h[2]};
      double want = truth(turned_n, turned_h);
      sum += weight * fabs(shade_mdf_eval(&along_u, n, h, NULL) - want);
      right += weight * fabs(shade_mdf_eval(&along_v, n, h, NULL) - want);
    }
  }
  print_message("groove along y by x' = dP/du: TV at 30 degrees %.3f, by dP/dv %.1e\n", sum, right);
  assert_near(sum, .116, 1e-3);
  assert_true(right <= 1e-12);
}

/* "Almost the same" (Fig. 8): equal for Ashikhmin-Shirley, not for the slope distributions. */
static void approximate_rotation(void **state) {
  (void)state;
  const double want[] = {0, .159, .200, .228, .243};
  for (size_t d = 0; d < sizeof want / sizeof want[0]; d++) {
    shade_bsdf exact = make_lobe((shade_mdf)d, SHADE_DETAIL_ROTATE, SHADE_GROOVE_X, ex, ey);
    shade_bsdf fast =
        make_lobe((shade_mdf)d, SHADE_DETAIL_ROTATE_APPROXIMATE, SHADE_GROOVE_X, ex, ey);
    double off = 0;
    for (int k = 0; k < 24; k++) {
      double n[3], h[3];
      spherical(PI / 4, 2 * PI * (k + 0.5) / 24, n);
      for (int i = 0; i < POINTS; i++) {
        double weight = direction(i, h);
        off += 0.5 / 24 * weight *
               fabs(shade_mdf_eval(&exact, n, h, NULL) - shade_mdf_eval(&fast, n, h, NULL));
      }
    }
    print_message("approximate rotation, %s: TV at 45 degrees %.4f\n",
                  shade_list_word(SHADE_LIST_MDF, (int)d), off);
    assert_near(off, want[d], d ? 1e-3 : 1e-12);
  }
}

/* ---- Ward ------------------------------------------------------------------------ */

static const double ax = .1, ay = .5;

static void ward_squares(void **state) {
  (void)state;
  double h[3] = {-.5, 0, sqrt(.75)};
  double printed = exp(-2 * (h[0] / ax + h[1] / ay) / (1 + h[2]));
  double squared = exp(-2 * (pow(h[0] / ax, 2) + pow(h[1] / ay, 2)) / (1 + h[2]));
  shade_params p;
  shade_params_init(&p);
  shade_params_set_alphas(&p, ax, ay);
  p.mdf = SHADE_MDF_WARD_HALF;
  p.detail = SHADE_DETAIL_NONE;
  shade_bsdf b;
  shade_bsdf_setup(&b, &p);
  const double z[3] = {0, 0, 1};
  double got = shade_mdf_eval(&b, z, h, NULL) / bsdf_of(&b)->numbers.peak;
  print_message("Ward at 30 degrees: printed %.1f of the peak, squared %.2e, library %.2e\n",
                printed, squared, got);
  assert_near(printed, 212.5, .1);
  assert_near(got, squared, 1e-12 * squared);
  assert_true(squared < 1e-11);
  assert_near(bsdf_of(&b)->numbers.peak, 1 / (PI * ax * ay),
              1e-12); /* the factor that Eq. 3 leaves out */
}

static double ward_half(double x, double y, double z) {
  return z > 0 ? exp(-2 * (x * x / (ax * ax) + y * y / (ay * ay)) / (1 + z)) / (PI * ax * ay) : 0;
}

/* Eq. 8, squares mended: z of the rotated h, x and y of h itself. */
static double ward_of_h(const double n[3], const double h[3]) {
  return ward_half(h[0], h[1], dot(n, h));
}

static double ward_truth(const double n[3], const double h[3]) {
  double m[3];
  displaced(n, h, m);
  return ward_half(m[0], m[1], m[2]);
}

static double ward_library(const double n[3], const double h[3]) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_alphas(&p, ax, ay);
  p.mdf = SHADE_MDF_WARD_HALF;
  p.groove = SHADE_GROOVE_X;
  shade_bsdf b;
  shade_bsdf_setup(&b, &p);
  return shade_mdf_eval(&b, n, h, NULL);
}

static void ward_rotated(void **state) {
  (void)state;
  double off = total_variation(ward_of_h, ward_truth, 30);
  double right = total_variation(ward_library, ward_truth, 30);
  print_message("Ward with x and y of h itself: TV at 30 degrees %.3f, of the rotated h %.1e\n",
                off, right);
  assert_near(off, .875, 1e-3);
  assert_true(right <= 1e-11);
}

/* (hx, hy, n.h) is no unit vector; slope distributions take it badly even when round. */
static double slopes(shade_mdf mdf, double alpha, double x, double y, double z) {
  double slope2 = (x * x + y * y) / (z * z), a2 = alpha * alpha;
  if (z <= 0)
    return 0;
  if (mdf == SHADE_MDF_WARD)
    return exp(-slope2 / a2) / (PI * a2);
  if (mdf == SHADE_MDF_BECKMANN)
    return exp(-slope2 / a2) / (PI * a2 * pow(z, 4));
  return 1 / (PI * a2 * pow(z, 4) * pow(1 + slope2 / a2, 2));
}

static void unnormalised(void **state) {
  (void)state;
  const double alpha = .2;
  const struct {
    shade_mdf mdf;
    double want;
  } cases[] = {{SHADE_MDF_WARD, .786}, {SHADE_MDF_BECKMANN, 1.121}, {SHADE_MDF_GGX, .987}};
  for (int k = 0; k < 3; k++) {
    shade_params p;
    shade_params_init(&p);
    shade_params_set_alphas(&p, alpha, alpha);
    p.mdf = cases[k].mdf;
    p.detail = SHADE_DETAIL_PERTURB;
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    double n[3], h[3], off = 0, right = 0;
    spherical(PI / 6, 1, n);
    for (int i = 0; i < POINTS; i++) {
      double weight = direction(i, h), z = dot(n, h), sine[3];
      cross(n, h, sine);
      double want = slopes(p.mdf, alpha, sqrt(dot(sine, sine)), 0, z);
      off += 0.5 * weight * fabs(slopes(p.mdf, alpha, h[0], h[1], z) - want);
      right += 0.5 * weight * fabs(shade_mdf_eval(&b, n, h, NULL) - want);
    }
    print_message("%s of (hx, hy, n.h): TV at 30 degrees %.3f, of the angle to n %.1e\n",
                  shade_list_word(SHADE_LIST_MDF, (int)p.mdf), off, right);
    assert_near(off, cases[k].want, 1e-3);
    assert_true(right <= 1e-11);
  }
}

/* ---- Kang, Cho and Kim: warps of the disc ---------------------------------------- */

/* |R - p|/|R - c|, R where the ray from c through p leaves the unit disc. */
static double fade(double complex c, double complex p) {
  double complex along = (p - c) / cabs(p - c);
  double b = creal(along * conj(c));
  double reach = -b + sqrt(b * b + 1 - creal(c * conj(c)));
  return 1 - cabs(p - c) / reach;
}

/* Eq. 3 and 4, and their printed inverses, Eq. 5 with and without the root. */
static double complex forward(double complex delta, double complex p, int smooth) {
  double w = fade(0, p);
  return p + (smooth ? sqrt(w) : w) * delta;
}
static double complex inverse(double complex delta, double complex p, int smooth) {
  double w = fade(delta, p);
  return p - (smooth ? sqrt(w) : w) * delta;
}

static void smooth_warp(void **state) {
  (void)state;
  const struct {
    double delta, outside, error;
  } rows[] = {{.3, .036, .089}, {.5, .087, .248}, {.7, .151, .488}, {.98, .255, .954}};
  enum { RADII = 1000, TURNS = 180 };
  shade_bsdf b = make_bsdf(SHADE_DETAIL_DEFORM_SMOOTH, SHADE_GROOVE_X, 3, 3);
  for (int r = 0; r < 4; r++) {
    double delta = rows[r].delta, outside = 0, smooth = 0, linear = 0;
    double n[3] = {delta, 0, sqrt(1 - delta * delta)};
    for (int i = 0; i < RADII * TURNS; i++) {
      double radius = (i / TURNS + 0.5) / RADII;
      double x = (i % TURNS + 0.5) / TURNS; /* half the disc, finest along delta */
      double complex p = radius * cexp(PI * I * x * x);
      double complex back = inverse(delta, p, 1);
      outside += cabs(back) > 1 ? 2 * radius * 2 * x / (RADII * TURNS) : 0;
      linear = fmax(linear, cabs(inverse(delta, forward(delta, p, 0), 0) - p));
      double complex there = forward(delta, p, 1);
      if (cabs(there) < 1)
        smooth = fmax(smooth, cabs(inverse(delta, there, 1) - p));
      /* the library's D is 0 where z, as printed, is the root of a negative number */
      double h[3] = {creal(p), cimag(p), sqrt(1 - radius * radius)};
      double zz = 1 - cabs(back) * cabs(back);
      double want = zz > 0 ? 2 / PI * pow(zz, 1.5) : 0; /* exponents 3, 3 */
      assert_near(shade_mdf_eval(&b, n, h, NULL), want, 1e-9);
    }
    print_message("warp by %.2f: %.1f %% leave the disc; round trip off by %.3f, linear %.0e\n",
                  delta, 100 * outside, smooth, linear);
    assert_true(smooth < rows[r].error + 1e-3 && smooth > rows[r].error - 8e-3);
    assert_near(outside, rows[r].outside, 2e-3);
    assert_true(linear <= 1e-12);
  }
}

/* ---- Hast, Wesslen and Seipel: fibres -------------------------------------------- */

/* Eq. 10 with t = x, b = y, n = z. */
static double printed_fibre(const double l[3]) {
  double most[3] = {0, l[1], l[2]}, least[3];
  normalise(most);
  cross(l, most, least);
  normalise(least);
  return dot(l, most) * (1 - least[1]) / PI;
}

/* The mean over the upper half: the normals n' from -pi/2 to pi/2 that face l, by midpoints. */
static double fibre_integral(const double l[3]) {
  enum { STEPS = 4000 };
  double sum = 0;
  for (int i = 0; i < STEPS; i++) {
    double theta = PI * ((i + 0.5) / STEPS - 0.5);
    sum += fmax(0, l[1] * sin(theta) + l[2] * cos(theta)) / STEPS;
  }
  return sum;
}

static void fibre(void **state) {
  (void)state;
  const double z[3] = {0, 0, 1};
  double ahead = 0, behind = 0, exact = 0;
  for (int i = 0; i < POINTS; i += 3) {
    double l[3];
    direction(i, l);
    double want = fibre_integral(l), off = fabs(printed_fibre(l) - want);
    if (l[0] > 0)
      ahead = fmax(ahead, off);
    else
      behind = fmax(behind, off);
    exact = fmax(exact, fabs(shade_diffuse_eval(SHADE_DIFFUSE_FIBRE, l, z) - want));
  }
  double across[3] = {0, .6, .8}, along[3] = {1, 0, 0};
  print_message("fibre: off by %.1e for l.t > 0, %.4f for l.t < 0; corrected %.1e\n", ahead, behind,
                exact);
  assert_true(fmin(ahead, behind) <= 1e-6);
  assert_near(fmax(ahead, behind), 2 / PI, 1e-3); /* .637 */
  assert_true(exact <= 1e-6);
  assert_true(isnan(printed_fibre(across)) && isnan(printed_fibre(along)));
  assert_near(shade_diffuse_eval(SHADE_DIFFUSE_FIBRE, across, z), 1.8 / PI, 1e-15);
}

/* ---- Kang: woven fabric ---------------------------------------------------------- */

static int modulo(int a, int b) {
  return (a % b + b) % b;
}

/* Eq. 3 in cells: 1 where weft is on top. */
static int printed_weave(int column, int row, int weft, int warp, int shift) {
  return modulo(modulo(column, weft) + shift * modulo(row, warp), weft + warp) < weft;
}
static int true_weave(int column, int row, int weft, int warp, int shift) {
  return modulo(column + shift * row, weft + warp) < weft;
}

static void weave(void **state) {
  (void)state;
  int printed = 0, corrected = 0;
  for (int row = -30; row < 30; row++)
    for (int column = -30; column < 30; column++) {
      printed += printed_weave(column, row, 2, 1, 1);
      corrected += true_weave(column, row, 2, 1, 1);
      assert_int_equal(true_weave(column, row, 2, 1, 1),
                       true_weave(column - 1, row + 1, 2, 1, 1)); /* the twill's diagonal */
    }
  print_message("2/1 twill: weft on top in %d of 3600 cells as printed, %d corrected\n", printed,
                corrected);
  assert_int_equal(printed, 3600);
  assert_int_equal(corrected, 2400);
}

/* Phase of the twist on a weft yarn: u along it from 0 to 1, sigma across it from -1 to 1. */
static double printed_phase(double u, double sigma, double slant) {
  (void)sigma;
  return u - slant * (2 * u - 1); /* Eq. 4: with sigma^u, which runs along the yarn */
}
static double true_phase(double u, double sigma, double slant) {
  return u - slant * sigma;
}

/* Degrees between the ridges, lines of equal phase, and the yarn's cross-section (l_w = l_y). */
static double ridge_angle(double (*phase)(double, double, double), double slant) {
  const double step = 1e-3;
  double along = (phase(.5 + step, 0, slant) - phase(.5 - step, 0, slant)) / (2 * step);
  /* sigma goes from -1 to 1 over the yarn's width */
  double across = (phase(.5, 2 * step, slant) - phase(.5, -2 * step, slant)) / (2 * step);
  return atan2(fabs(across), fabs(along)) * 180 / PI;
}

static void twist(void **state) {
  (void)state;
  for (double angle = 30; angle <= 60; angle += 30) {
    double printed_slant = 2 * (angle * PI / 180) / PI; /* s_f = 2 theta/pi */
    double slant = tan(angle * PI / 180) / 2;           /* tan theta = 2 s_f l_w/l_y */
    double flat = ridge_angle(printed_phase, slant);
    double printed = ridge_angle(true_phase, printed_slant), got = ridge_angle(true_phase, slant);
    print_message("twist of %g degrees: %.1f by Eq. 4, %.1f by s_f, %.1f corrected\n", angle, flat,
                  printed, got);
    assert_near(flat, 0, 1e-9);
    assert_near(printed, angle == 30 ? 33.7 : 53.1, .05);
    assert_near(got, angle, 1e-9);
  }
}

/* Eq. 4's tilts with c_f = c_y = 1, which the text allows: |tilt| > 1 has no normal. */
static void tilt(void **state) {
  (void)state;
  enum { STEPS = 1000 };
  int without = 0;
  for (int i = 0; i < STEPS; i++)
    for (int j = 0; j < STEPS; j++) {
      double u = (i + 0.5) / STEPS, sigma = 2 * (j + 0.5) / STEPS - 1;
      double phase = 2 * true_phase(u, sigma, .25);
      without += hypot(2 * (phase - floor(phase)) - 1, sigma) > 1;
    }
  print_message("tilt: no normal on %.2f %% of the yarn\n", 100. * without / (STEPS * STEPS));
  assert_near(1. * without / (STEPS * STEPS), 1 - PI / 4, 2e-3);
}

/* ---- Kang, Cho and Kim: pits ----------------------------------------------------- */

/* Mean squared slope across a pit, rim radius 1, sphere radius 1/k, over a share of its disc. */
static double pit_slope2(double k, double share) {
  enum { STEPS = 20000 };
  double sum = 0;
  for (int i = 0; i < STEPS; i++) {
    /* rho^2 = share (1 - q^8): steps as fine at the rim as the slope is steep */
    double q = (i + 0.5) / STEPS, weight = 8 * pow(q, 7) / STEPS;
    double rho2 = share * (1 - pow(q, 8));
    sum += weight * k * k * rho2 / (1 - k * k * rho2) / 2;
  }
  return sum;
}

static void pits(void **state) {
  (void)state;
  double before = 0;
  for (int i = 1; i <= 3; i++) {
    double left = pow(10, -2 * i), hemisphere = pit_slope2(1, 1 - left);
    print_message("hemisphere: mean squared slope %.3f over all but %.0e of the disc\n", hemisphere,
                  left);
    assert_near(hemisphere, (-log(left) / (1 - left) - 1) / 2, 1e-3);
    /* log 10 more for each hundredth: no limit */
    assert_true(i == 1 || fabs(hemisphere - before - log(10)) < .05);
    before = hemisphere;
  }
  /* a cap of depth D, rim r: k = 2 (D/r)/(1 + (D/r)^2) */
  for (double depth = .1; depth < .95; depth += .2) {
    double k = 2 * depth / (1 + depth * depth);
    assert_near(pit_slope2(k, 1), (-log(1 - k * k) / (k * k) - 1) / 2, 1e-4);
    /* centre depth from the cap's own height */
    assert_near((1 - sqrt(1 - k * k)) / k, depth, 1e-12);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(row_two),      cmocka_unit_test(row_three),
      cmocka_unit_test(axis_v),       cmocka_unit_test(azimuth),
      cmocka_unit_test(denominator),  cmocka_unit_test(groove),
      cmocka_unit_test(ward_squares), cmocka_unit_test(ward_rotated),
      cmocka_unit_test(unnormalised), cmocka_unit_test(approximate_rotation),
      cmocka_unit_test(smooth_warp),  cmocka_unit_test(fibre),
      cmocka_unit_test(weave),        cmocka_unit_test(twist),
      cmocka_unit_test(pits),         cmocka_unit_test(tilt),
  };
  return cmocka_run_group_tests_name("papers", tests, NULL, NULL);
}
