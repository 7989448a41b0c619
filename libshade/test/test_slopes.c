/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 1.1 */
/* Normal maps: decoding, interpolation, pyramid, each against a plain form of its own. */
#include "test/support.h"

#include <string.h>

#include "shade/maps.h"

static shade_slope_options options_of(shade_normals normals, shade_wrap wrap) {
  shade_slope_options o;
  shade_slope_options_init(&o);
  o.normals = normals;
  o.wrap = wrap;
  return o;
}

static shade_slope_map *create(const float *pixels, int width, int height, int channels,
                               shade_slope_options o) {
  unsigned status = 99;
  shade_slope_map *m = shade_slope_map_create(pixels, width, height, channels, &o, &status);
  assert_non_null(m);
  assert_int_equal(status, SHADE_OK);
  return m;
}

/* A picture of slopes, any size: waves and noise, anisotropic. */
static float *random_slopes(int width, int height, uint64_t seed) {
  float *p = malloc((size_t)(width * height) * 2 * sizeof *p);
  for (int j = 0; j < height; j++)
    for (int i = 0; i < width; i++) {
      float *s = p + 2 * (j * width + i);
      s[0] = (float)(0.2 * sin(0.4 * i + 0.9 * j) + 0.3 * (uniform(&seed) - 0.5));
      s[1] = (float)(0.1 + 0.5 * (double)s[0] + 0.1 * (uniform(&seed) - 0.5));
    }
  return p;
}

static void normals_become_slopes(void **state) {
  (void)state;
  const double x = 0.3, y = -0.2, z = sqrt(1 - x * x - y * y);
  const float coloured[4] = {(float)(0.5 + 0.5 * x), (float)(0.5 + 0.5 * y), (float)(0.5 + 0.5 * z),
                             0.123F};
  const float plain[3] = {(float)(2 * x), (float)(2 * y), (float)(2 * z)}; /* any length */
  const float tiny[3] = {(float)(1e-5 * x), (float)(1e-5 * y), (float)(1e-5 * z)};
  const float slope[2] = {(float)(-x / z), (float)(-y / z)};
  for (int directx = 0; directx < 2; directx++)
    for (int k = 0; k < 6; k++) {
      const float *pixels[] = {coloured, coloured, coloured, plain, tiny, slope};
      const int channels[] = {4, 3, 2, 3, 3, 2};
      shade_slope_options o = options_of(k < 3   ? SHADE_NORMALS_COLOUR
                                         : k < 5 ? SHADE_NORMALS_SIGNED
                                                 : SHADE_NORMALS_SLOPE,
                                         SHADE_WRAP_REPEAT);
      o.directx = directx;
      shade_slope_map *m = create(pixels[k], 1, 1, channels[k], o);
      shade_slopes s;
      assert_int_equal(shade_slope_lookup(m, 0.7, 0.2, NULL, &s), SHADE_OK);
      assert_near(s.normal[0], x, 1e-6);
      assert_near(s.normal[1], directx ? -y : y, 1e-6);
      assert_near(s.normal[2], z, 1e-6);
      assert_near(s.covariance[0] + s.covariance[2], 0, 1e-12);
      shade_slope_map_free(m);
    }
  /* strength: normalize(s nx, s ny, 1 + min(s, 1)(nz - 1)) */
  for (int k = 0; k < 4; k++) {
    shade_slope_options o = options_of(SHADE_NORMALS_SIGNED, SHADE_WRAP_REPEAT);
    o.strength = (double[]){0, 0.4, 1, 3}[k];
    shade_slope_map *m = create(plain, 1, 1, 3, o);
    shade_slopes s;
    shade_slope_lookup(m, 0.5, 0.5, NULL, &s);
    const double a = o.strength * x, b = o.strength * y, c = 1 + fmin(o.strength, 1) * (z - 1);
    const double length = sqrt(a * a + b * b + c * c);
    assert_near(s.normal[0], a / length, 1e-6);
    assert_near(s.normal[1], b / length, 1e-6);
    assert_near(s.normal[2], c / length, 1e-6);
    shade_slope_map_free(m);
  }
}

static int beyond(int i, int n, shade_wrap wrap) {
  if (wrap == SHADE_WRAP_CLAMP)
    return i < 0 ? 0 : i >= n ? n - 1 : i;
  while (i < 0 || i >= n) {
    if (wrap == SHADE_WRAP_REPEAT)
      i += i < 0 ? n : -n;
    else
      i = i < 0 ? -1 - i : 2 * n - 1 - i;
  }
  return i;
}

/* The interpolated slope, long-hand. */
static void interpolated(const float *p, int w, int h, shade_wrap wrap, double u, double v,
                         double s[2]) {
  const double x = u * w - 0.5, y = (1 - v) * h - 0.5;
  s[0] = s[1] = 0;
  for (int j = (int)floor(y); j <= (int)floor(y) + 1; j++)
    for (int i = (int)floor(x); i <= (int)floor(x) + 1; i++)
      for (int c = 0; c < 2; c++)
        s[c] += (1 - fabs(x - i)) * (1 - fabs(y - j)) *
                (double)p[2 * (beyond(j, h, wrap) * w + beyond(i, w, wrap)) + c];
}

static const int sizes[][2] = {{1, 1},   {1, 9},   {16, 1},   {7, 5},
                               {64, 64}, {53, 37}, {128, 33}, {2, 300}};
enum { SIZES = sizeof sizes / sizeof sizes[0] };

static void points_are_interpolated(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int k = 0; k < SIZES; k++)
    for (int wrap = SHADE_WRAP_REPEAT; wrap <= SHADE_WRAP_MIRROR; wrap++) {
      const int w = sizes[k][0], h = sizes[k][1];
      float *p = random_slopes(w, h, 5);
      shade_slope_map *m = create(p, w, h, 2, options_of(SHADE_NORMALS_SLOPE, (shade_wrap)wrap));
      for (int i = 0; i < 2000; i++) {
        const double u = 5 * uniform(&seed) - 2, v = 5 * uniform(&seed) - 2;
        double want[2];
        interpolated(p, w, h, (shade_wrap)wrap, u, v, want);
        shade_slopes s;
        shade_slope_lookup(m, u, v, NULL, &s);
        assert_near(s.mean[0], want[0], 1e-6);
        assert_near(s.mean[1], want[1], 1e-6);
        assert_true(s.covariance[0] < 1e-12 && s.covariance[2] < 1e-12);
      }
      shade_slope_map_free(m);
      free(p);
    }
}

/* Mean and second moments over a footprint of the interpolated field, by many points. */
static void brute_force(const float *p, int w, int h, shade_wrap wrap, double u, double v,
                        const double side[4], int n, double mean[2], double second[3]) {
  memset(mean, 0, 2 * sizeof *mean);
  memset(second, 0, 3 * sizeof *second);
  for (int k = 0; k < n * n; k++) {
    const double a = (k % n + 0.5) / n - 0.5, b = (k / n + 0.5) / n - 0.5;
    double s[2];
    interpolated(p, w, h, wrap, u + a * side[0] + b * side[2], v + a * side[1] + b * side[3], s);
    for (int c = 0; c < 2; c++)
      mean[c] += s[c] / (n * n);
    second[0] += s[0] * s[0] / (n * n);
    second[1] += s[0] * s[1] / (n * n);
    second[2] += s[1] * s[1] / (n * n);
  }
}

/*
 * The mean of look-ups all over the picture is the picture's, whatever the filter: no texel
 * is lost or counted twice at any level, at odd sizes either. Look-ups lie on a lattice of
 * 1/4 texel, where sums of bilinear weights are even at every level of even sizes; at odd
 * ones the lattice misses by its own step.
 */
static void every_level_keeps_the_moments(void **state) {
  (void)state;
  for (int k = 0; k < SIZES; k++) {
    const int w = sizes[k][0], h = sizes[k][1];
    float *p = random_slopes(w, h, 7);
    shade_slope_map *m = create(p, w, h, 2, options_of(SHADE_NORMALS_SLOPE, SHADE_WRAP_REPEAT));
    /* exact: between texel centres the square is of degree two, and Simpson's rule holds */
    double want[5] = {0};
    for (int j = 0; j < 2 * h; j++)
      for (int i = 0; i < 2 * w; i++) {
        double s[2];
        interpolated(p, w, h, SHADE_WRAP_REPEAT, (i + 1) / (2.0 * w), (j + 1) / (2.0 * h), s);
        const double weight = (i % 2 ? 2 : 1) * (j % 2 ? 2 : 1) / (9.0 * w * h);
        const double found[5] = {s[0], s[1], s[0] * s[0], s[0] * s[1], s[1] * s[1]};
        for (int c = 0; c < 5; c++)
          want[c] += weight * found[c];
      }
    const int even = !(w & (w - 1)) && !(h & (h - 1));
    for (double texels = 8; texels < 400; texels *= 2.7) {
      const double side[4] = {texels / w, 0, 0, texels / h};
      double got[5] = {0};
      const int nu = 4 * w, nv = 4 * h;
      for (int i = 0; i < nu * nv; i++) {
        shade_slopes s;
        shade_slope_lookup(m, (i % nu + 0.5) / nu, (i / nu + 0.5) / nv, side, &s);
        const double x = s.mean[0], y = s.mean[1];
        const double found[5] = {x, y, s.covariance[0] + x * x, s.covariance[1] + x * y,
                                 s.covariance[2] + y * y};
        for (int c = 0; c < 5; c++)
          got[c] += found[c] / (nu * nv);
      }
      const double tolerance = even ? 1e-6 : 2e-3;
      for (int c = 0; c < 5; c++)
        if (fabs(got[c] - want[c]) >
            tolerance * (c < 2 ? sqrt(want[2] + want[4]) : want[2] + want[4]))
          fail_msg("%d x %d, %.1f texels: %g for %g", w, h, texels, got[c], want[c]);
    }
    shade_slope_map_free(m);
    free(p);
  }
}

/* Many places: second moments to 10 %, means close beside the size of the slopes. */
static void footprints_are_averages(void **state) {
  (void)state;
  enum { PLACES = 40, POINTS = 60 };
  const double texels[] = {0.3, 1, 3, 5, 8, 16, 31};
  for (int k = 4; k < SIZES; k++)
    for (int wrap = SHADE_WRAP_REPEAT; wrap <= SHADE_WRAP_MIRROR; wrap++) {
      const int w = sizes[k][0], h = sizes[k][1];
      float *p = random_slopes(w, h, 9);
      shade_slope_map *m = create(p, w, h, 2, options_of(SHADE_NORMALS_SLOPE, (shade_wrap)wrap));
      for (int z = 0; z < 7; z++) {
        double error = 0, size = 0, got[3] = {0}, want[3] = {0};
        uint64_t seed = 11;
        for (int i = 0; i < PLACES; i++) {
          const double u = uniform(&seed), v = uniform(&seed), turn = 3 * uniform(&seed);
          const double a = texels[z], b = i % 2 ? a : a / 4;
          const double side[4] = {a * cos(turn) / w, a * sin(turn) / h, -b * sin(turn) / w,
                                  b * cos(turn) / h};
          double mean[2], second[3];
          brute_force(p, w, h, (shade_wrap)wrap, u, v, side, POINTS, mean, second);
          shade_slopes s;
          shade_slope_lookup(m, u, v, side, &s);
          const double x = s.mean[0], y = s.mean[1];
          const double found[3] = {s.covariance[0] + x * x, s.covariance[1] + x * y,
                                   s.covariance[2] + y * y};
          for (int c = 0; c < 3; c++) {
            got[c] += found[c] / PLACES;
            want[c] += second[c] / PLACES;
          }
          error += pow(x - mean[0], 2) + pow(y - mean[1], 2);
          size += second[0] + second[2];
          assert_true(s.covariance[0] * s.covariance[2] >=
                      s.covariance[1] * s.covariance[1] * (1 - 1e-12));
        }
        const double off =
            fmax(fmax(fabs(got[0] - want[0]), fabs(got[1] - want[1])), fabs(got[2] - want[2]));
        if (wrap == SHADE_WRAP_REPEAT)
          print_message("%3d x %3d, %4.1f texels: second moments %.4f off, means %.3f\n", w, h,
                        texels[z], off / (want[0] + want[2]), sqrt(error / size));
        assert_true(off <= 0.1 * (want[0] + want[2]));
        /* white noise, where the filters' shapes differ most from a box: 0.133 seen */
        assert_true(sqrt(error / size) <= 0.15);
      }
      shade_slope_map_free(m);
      free(p);
    }
}

/*
 * Slopes that grow evenly over the picture are, in the mean over any footprint, those at its
 * middle: a filter's texels may not pull it aside, wherever they lie. And their covariance is the
 * footprint's, times the square of what they grow by a texel: at every place, within what the
 * filter's spread depends on it.
 */
static void even_growth_is_met_in_the_middle(void **state) {
  (void)state;
  enum { SIZE = 256 };
  const double grow[2] = {0.004, -0.002}, middle = SIZE / 2;
  float *p = malloc((size_t)SIZE * SIZE * 2 * sizeof *p);
  assert_non_null(p);
  for (int j = 0; j < SIZE; j++)
    for (int i = 0; i < SIZE; i++) {
      const double x = i + .5 - middle, y = middle - (j + .5);
      p[2 * (j * SIZE + i)] = (float)(grow[0] * x);
      p[2 * (j * SIZE + i) + 1] = (float)(grow[1] * (x + 2 * y));
    }
  shade_slope_map *m = create(p, SIZE, SIZE, 2, options_of(SHADE_NORMALS_SLOPE, SHADE_WRAP_CLAMP));
  uint64_t seed = 17;
  double off = 0, bias[3] = {0, 0, 0};
  int seen = 0;
  for (int k = 0; k < 6000; k++) {
    const double x = 60 * (uniform(&seed) - .5), y = 60 * (uniform(&seed) - .5);
    const double a = pow(40, uniform(&seed)), b = a / pow(k % 2 ? 1 : 8, uniform(&seed));
    const double turn = 6.3 * uniform(&seed), c = cos(turn), s = sin(turn);
    const double side[4] = {a * c / SIZE, a * s / SIZE, -b * s / SIZE, b * c / SIZE};
    shade_slopes got;
    shade_slope_lookup(m, (middle + x) / SIZE, (middle + y) / SIZE, side, &got);
    off = fmax(off, fabs(got.mean[0] - grow[0] * x) / grow[0]);
    off = fmax(off, fabs(got.mean[1] - grow[1] * (x + 2 * y)) / -grow[1]);
    if (b < 3 || (b < 4 && a < 7)) /* thinner than the finest texels tell, or between */
      continue;
    const double xx = a * a * c * c + b * b * s * s, yy = a * a * s * s + b * b * c * c;
    const double xy = (a * a - b * b) * c * s, size = 12 / (a * a + b * b);
    const double wrong[3] = {
        size * got.covariance[0] / pow(grow[0], 2) - size * xx / 12,
        size * got.covariance[1] / (grow[0] * grow[1]) - size * (xx + 2 * xy) / 12,
        size * got.covariance[2] / pow(grow[1], 2) - size * (xx + 4 * xy + 4 * yy) / 12};
    for (int d = 0; d < 3; d++)
      bias[d] += wrong[d];
    seen++;
  }
  print_message("even growth: %.1e texels from the middle, spread %.4f %.4f %.4f off\n", off,
                bias[0] / seen, bias[1] / seen, bias[2] / seen);
  assert_true(off <= 1e-4);
  for (int d = 0; d < 3; d++)
    assert_true(fabs(bias[d]) <= 0.002 * seen);
  shade_slope_map_free(m);
  free(p);
}

/*
 * Whatever its shape, a filter that spreads as the footprint does answers the square of a
 * coordinate with what the footprint would: of a box of side a, a^2/12 more than at its middle,
 * and 1/6 for the straight lines between the texels of the picture. So it is for every side
 * of 6 texels and more, however it falls between the levels; in the mean over places, since the
 * filter's spread depends a little on where the texels lie.
 */
static void filters_spread_as_footprints(void **state) {
  (void)state;
  enum { SIZE = 512, PLACES = 60 };
  const double scale = 4.0 / ((double)SIZE * SIZE), middle = SIZE / 2;
  float *p = malloc((size_t)SIZE * SIZE * 2 * sizeof *p);
  assert_non_null(p);
  for (int j = 0; j < SIZE; j++)
    for (int i = 0; i < SIZE; i++) {
      p[2 * (j * SIZE + i)] = (float)(scale * pow(i + .5 - middle, 2));
      p[2 * (j * SIZE + i) + 1] = (float)(scale * pow(j + .5 - middle, 2));
    }
  shade_slope_map *m = create(p, SIZE, SIZE, 2, options_of(SHADE_NORMALS_SLOPE, SHADE_WRAP_CLAMP));
  double worst = 0;
  const double turns[] = {0, .3, PI / 4};
  for (int thin = 1; thin <= 4; thin++)
    for (int t = 0; t < 3; t++)
      for (double a = 6 * thin; a <= 60; a *= 1.13) {
        const double b = a / thin, c = cos(turns[t]), s = sin(turns[t]);
        const double side[4] = {a * c / SIZE, a * s / SIZE, -b * s / SIZE, b * c / SIZE};
        const double want[2] = {(a * a * c * c + b * b * s * s + 2) / 12,
                                (a * a * s * s + b * b * c * c + 2) / 12};
        double got[2] = {0, 0};
        /* over 64 texels, a multiple of every level's, in steps that are none of one */
        for (int k = 0; k < PLACES * PLACES; k++) {
          const double x = 64 * ((k % PLACES + .25) / PLACES - .5);
          const double y = 64 * ((k / PLACES + .25) / PLACES - .5);
          shade_slopes found;
          shade_slope_lookup(m, (middle + x) / SIZE, 1 - (middle + y) / SIZE, side, &found);
          got[0] += (found.mean[0] / scale - x * x) / (PLACES * PLACES);
          got[1] += (found.mean[1] / scale - y * y) / (PLACES * PLACES);
        }
        for (int d = 0; d < 2; d++)
          worst = fmax(worst, fabs(got[d] - want[d]) / (a * a + b * b) * 12);
      }
  print_message("spread of the filter against the footprint's: %.4f\n", worst);
  assert_true(worst <= 0.005);
  shade_slope_map_free(m);
  free(p);
}

/*
 * A map seen over footprints of every size, here and there over its edges, is the middle of one
 * three times as large that holds what lies beyond them.
 */
static void edges_are_those_of_a_larger_picture(void **state) {
  (void)state;
  enum { WIDTH = 128, HEIGHT = 64, TIMES = 3, RIM = 16 };
  float *p = random_slopes(WIDTH, HEIGHT, 21);
  float *even = malloc(sizeof(float) * 2 * WIDTH * HEIGHT);
  float *around = malloc(sizeof(float) * 2 * TIMES * WIDTH * TIMES * HEIGHT);
  assert_true(even && around);
  for (int wrap = SHADE_WRAP_REPEAT; wrap <= SHADE_WRAP_MIRROR; wrap++) {
    /* beyond an edge that is clamped lie coarse texels, too: of these the outermost shall be even
     */
    for (int k = 0; k < WIDTH * HEIGHT && wrap == SHADE_WRAP_CLAMP; k++) {
      const int x = RIM + beyond(k % WIDTH - RIM, WIDTH - 2 * RIM, SHADE_WRAP_CLAMP);
      const int y = RIM + beyond(k / WIDTH - RIM, HEIGHT - 2 * RIM, SHADE_WRAP_CLAMP);
      memcpy(even + 2 * k, p + 2 * (y * WIDTH + x), 2 * sizeof *p);
    }
    const float *picture = wrap == SHADE_WRAP_CLAMP ? even : p;
    for (int j = 0; j < TIMES * HEIGHT; j++)
      for (int i = 0; i < TIMES * WIDTH; i++) {
        const int x = beyond(i - WIDTH, WIDTH, (shade_wrap)wrap);
        const int y = beyond(j - HEIGHT, HEIGHT, (shade_wrap)wrap);
        memcpy(around + 2 * (j * TIMES * WIDTH + i), picture + 2 * (y * WIDTH + x), 2 * sizeof *p);
      }
    const shade_slope_options o = options_of(SHADE_NORMALS_SLOPE, (shade_wrap)wrap);
    shade_slope_map *m = create(picture, WIDTH, HEIGHT, 2, o);
    shade_slope_map *larger = create(around, TIMES * WIDTH, TIMES * HEIGHT, 2, o);
    uint64_t seed = 23;
    for (int k = 0; k < 20000; k++) {
      const double u = uniform(&seed), v = uniform(&seed), turn = 6.3 * uniform(&seed);
      const double a = pow(16, uniform(&seed)), b = a / pow(8, uniform(&seed));
      const double side[4] = {a * cos(turn) / WIDTH, a * sin(turn) / HEIGHT, -b * sin(turn) / WIDTH,
                              b * cos(turn) / HEIGHT};
      double third[4];
      for (int c = 0; c < 4; c++)
        third[c] = side[c] / TIMES;
      shade_slopes got, want;
      shade_slope_lookup(m, u, v, side, &got);
      shade_slope_lookup(larger, (1 + u) / TIMES, (1 + v) / TIMES, third, &want);
      for (int c = 0; c < 2; c++)
        assert_near(got.mean[c], want.mean[c], 1e-6);
      for (int c = 0; c < 3; c++)
        assert_near(got.covariance[c], want.covariance[c], 1e-6);
    }
    shade_slope_map_free(m);
    shade_slope_map_free(larger);
  }
  free(around);
  free(even);
  free(p);
}

/* A plane stays a plane, at every footprint, and has no covariance. */
static void a_tilted_plane_stays(void **state) {
  (void)state;
  float p[2 * 12 * 10];
  for (int i = 0; i < 120; i++) {
    p[2 * i] = 0.7F;
    p[2 * i + 1] = -0.4F;
  }
  shade_slope_map *m = create(p, 12, 10, 2, options_of(SHADE_NORMALS_SLOPE, SHADE_WRAP_CLAMP));
  uint64_t seed = 13;
  for (int i = 0; i < 500; i++) {
    double side[4];
    for (int k = 0; k < 4; k++)
      side[k] = pow(10, 5 * uniform(&seed) - 3) * (uniform(&seed) - 0.5);
    shade_slopes s;
    shade_slope_lookup(m, 3 * uniform(&seed) - 1, 3 * uniform(&seed) - 1, side, &s);
    assert_near(s.mean[0], 0.7, 1e-6);
    assert_near(s.mean[1], -0.4, 1e-6);
    assert_true(s.covariance[0] < 1e-6 && s.covariance[2] < 1e-6);
  }
  shade_slope_map_free(m);
}

static void bad_pictures_are_mended(void **state) {
  (void)state;
  const float good[6] = {0.5F, 0.5F, 1, 0.6F, 0.5F, 0.9F};
  unsigned status;
  shade_slope_options o = options_of(SHADE_NORMALS_COLOUR, SHADE_WRAP_REPEAT);
  assert_null(shade_slope_map_create(good, 0, 1, 3, &o, &status));
  assert_int_equal(status, SHADE_BAD_INPUT);
  assert_null(shade_slope_map_create(good, 1, -1, 3, &o, NULL));
  assert_null(shade_slope_map_create(good, 1 << 20, 1, 3, &o, NULL));
  assert_null(shade_slope_map_create(good, 1, 1, 1, &o, NULL));
  const float cases[][3] = {{NAN, 0.5F, 1},     {0.5F, INFINITY, 1}, {0.5F, 0.5F, 0.5F},
                            {0.5F, 0.9F, 0.2F}, {1, 0.5F, 0.5F},     {1e30F, -1e30F, 1e30F},
                            {1e30F, 1, 0.6F}};
  const unsigned expected[] = {SHADE_BAD_INPUT,      SHADE_BAD_INPUT,      SHADE_BAD_INPUT,
                               SHADE_CLAMPED_NORMAL, SHADE_CLAMPED_NORMAL, SHADE_OK,
                               SHADE_CLAMPED_NORMAL};
  for (int k = 0; k < 7; k++) {
    shade_slope_map *m = shade_slope_map_create(cases[k], 1, 1, 3, &o, &status);
    assert_non_null(m);
    assert_int_equal(status, expected[k]);
    shade_slopes s;
    shade_slope_lookup(m, 0.5, 0.5, (double[4]){1, 0, 0, 1}, &s);
    assert_true(s.normal[2] > 0.019 && isfinite(s.covariance[0]));
    if (expected[k] == SHADE_BAD_INPUT)
      assert_true(s.normal[2] == 1);
    assert_int_equal(shade_slope_lookup(m, NAN, 0, NULL, &s), SHADE_BAD_INPUT);
    assert_int_equal(shade_slope_lookup(m, 1e300, -1e300, (double[4]){1e300, 1, 1, 1e300}, &s),
                     SHADE_OK);
    assert_true(isfinite(s.mean[0]) && isfinite(s.covariance[2]));
    shade_slope_map_free(m);
  }
  /* an argument that is not finite, each in turn; huge ones */
  const double odd[] = {NAN, INFINITY, -INFINITY, 1e300, -3e38, 1e9, 1e-310};
  shade_slope_map *two = create(good, 2, 1, 3, o);
  for (int k = 0; k < 6; k++)
    for (int b = 0; b < 7; b++) {
      double in[6] = {0.3, 0.4, 0.5, 0.1, -0.1, 0.5};
      in[k] = odd[b];
      shade_slopes s;
      assert_int_equal(shade_slope_lookup(two, in[0], in[1], in + 2, &s),
                       b < 3 ? SHADE_BAD_INPUT : SHADE_OK);
      assert_true(isfinite(s.mean[0] + s.mean[1]) && isfinite(s.covariance[0] + s.covariance[2]));
      if (b < 3)
        assert_true(s.normal[2] == 1 && s.covariance[0] == 0 && s.covariance[2] == 0);
    }
  shade_slope_map_free(two);
  o.normals = (shade_normals)7;
  o.strength = NAN;
  shade_slope_map *m = shade_slope_map_create(good, 2, 1, 3, &o, &status);
  assert_int_equal(status, SHADE_BAD_CHOICE | SHADE_CLAMPED_PARAMETER);
  shade_slope_map_free(m);
  m = shade_slope_map_create(good, 2, 1, 3, &(shade_slope_options){sizeof o, .wrap = (shade_wrap)3},
                             &status);
  assert_int_equal(status, SHADE_BAD_CHOICE);
  shade_slope_map_free(m);
  shade_slope_map_free(NULL);
}

/* A row of texels along u, or a column along v, and a footprint of so many of them along it by its
 * first side or its second: what holds of one holds of all four. */
enum { WAYS = 4 };
static shade_slope_map *row_of(const float *pixels, int count, int way) {
  return create(pixels, way & 1 ? 1 : count, way & 1 ? count : 1, 2,
                options_of(SHADE_NORMALS_SLOPE, SHADE_WRAP_REPEAT));
}
static void look_along(const shade_slope_map *m, int way, double at, double length,
                       shade_slopes *got) {
  double footprint[4] = {0};
  footprint[2 * (way >> 1) + (way & 1)] = length;
  /* v counts upwards, rows downwards */
  shade_slope_lookup(m, way & 1 ? 0.5 : at, way & 1 ? 1 - at : 0.5, footprint, got);
}

/* A footprint of one texel about its centre: the interpolated slope is two straight pieces, whose
 * mean and mean square are known. */
static void one_texel_is_exact(void **state) {
  (void)state;
  enum { WIDTH = 9 };
  float *pixels = random_slopes(WIDTH, 1, 8);
  for (int way = 0; way < WAYS; way++) {
    shade_slope_map *m = row_of(pixels, WIDTH, way);
    for (int i = 0; i < WIDTH; i++) {
      double s[3], mean = 0, square = 0;
      for (int k = -1; k < 2; k++)
        s[k + 1] = (double)pixels[2 * ((i + k + WIDTH) % WIDTH)];
      for (int side = 0; side < 3; side += 2) { /* s1 + t (s - s1), t from 0 to 1/2 */
        const double rise = s[side] - s[1];
        mean += s[1] / 2 + rise / 8;
        square += s[1] * s[1] / 2 + s[1] * rise / 4 + rise * rise / 24;
      }
      shade_slopes got;
      look_along(m, way, (i + 0.5) / WIDTH, 1.0 / WIDTH, &got);
      assert_near(got.mean[0], mean, 1e-6);
      assert_near(got.covariance[0], square - mean * mean, 1e-7);
    }
    shade_slope_map_free(m);
  }
  free(pixels);
}

/* Footprints of two and more texels side by side, over the whole of a row: together their means and
 * mean squares are those of the straight pieces between the texels' middles, (a^2 + ab + b^2)/3. */
static void texels_side_by_side_are_exact(void **state) {
  (void)state;
  enum { WIDTH = 60 };
  float *pixels = random_slopes(WIDTH, 1, 9);
  double mean = 0, square = 0;
  for (int i = 0; i < WIDTH; i++) {
    const double a = (double)pixels[2 * i], b = (double)pixels[2 * ((i + 1) % WIDTH)];
    mean += a / WIDTH;
    square += (a * a + a * b + b * b) / 3 / WIDTH;
  }
  for (int way = 0; way < WAYS; way++) {
    shade_slope_map *m = row_of(pixels, WIDTH, way);
    for (int texels = 1; texels <= 3; texels++) {
      double means = 0, squares = 0;
      for (int i = 0; i < WIDTH; i += texels) {
        shade_slopes got;
        look_along(m, way, (i + texels / 2.0) / WIDTH, (double)texels / WIDTH, &got);
        means += got.mean[0] * texels / WIDTH;
        squares += (got.covariance[0] + got.mean[0] * got.mean[0]) * texels / WIDTH;
      }
      assert_near(means, mean, 1e-6);
      assert_near(squares, square, 1e-6 * square);
    }
    shade_slope_map_free(m);
  }
  free(pixels);
}

/* Footprints of any shape, one about each texel: together they have the mean, and the mean square,
 * of the bilinear field itself, sums of products of corners: those of a side 4, 2 and 1 ninths. */
static void all_places_together_are_exact(void **state) {
  (void)state;
  enum { WIDTH = 14, HEIGHT = 10 };
  static const double sides[][3] = {{2.1, 2.2, 0.4}, {3, 2.4, 1.1}, {1.95, 1.9, 2},
                                    {3.5, 3.4, 0.3}, {6, 0.7, 2.5}, {7, 5, 0.8}};
  float *pixels = random_slopes(WIDTH, HEIGHT, 10);
  double mean[2] = {0}, square[3] = {0};
  for (int j = 0; j < HEIGHT; j++)
    for (int i = 0; i < WIDTH; i++) {
      const float *corner[2][2];
      for (int k = 0; k < 4; k++)
        corner[k / 2][k % 2] = pixels + 2 * ((j + k / 2) % HEIGHT * WIDTH + (i + k % 2) % WIDTH);
      for (int k = 0; k < 16; k++) {
        const float *a = corner[k / 8][k / 4 % 2], *b = corner[k / 2 % 2][k % 2];
        const double part = (k / 8 == k / 2 % 2 ? 2 : 1) * (k / 4 % 2 == k % 2 ? 2 : 1) / 36.0;
        square[0] += part * (double)a[0] * (double)b[0] / (WIDTH * HEIGHT);
        square[1] += part * (double)a[0] * (double)b[1] / (WIDTH * HEIGHT);
        square[2] += part * (double)a[1] * (double)b[1] / (WIDTH * HEIGHT);
      }
      mean[0] += (double)corner[0][0][0] / (WIDTH * HEIGHT);
      mean[1] += (double)corner[0][0][1] / (WIDTH * HEIGHT);
    }
  shade_slope_map *m =
      create(pixels, WIDTH, HEIGHT, 2, options_of(SHADE_NORMALS_SLOPE, SHADE_WRAP_REPEAT));
  for (size_t n = 0; n < sizeof sides / sizeof sides[0]; n++) {
    const double c = cos(sides[n][2]), s = sin(sides[n][2]);
    const double footprint[4] = {sides[n][0] * c / WIDTH, sides[n][0] * s / HEIGHT,
                                 -sides[n][1] * s / WIDTH, sides[n][1] * c / HEIGHT};
    double means[2] = {0}, squares[3] = {0};
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
      shade_slopes got;
      const double u = (k % WIDTH + 0.3) / WIDTH, v = (k / WIDTH + 0.8) / HEIGHT;
      assert_int_equal(shade_slope_lookup(m, u, v, footprint, &got), SHADE_OK);
      for (int a = 0; a < 3; a++) {
        const double product = got.mean[a == 2] * got.mean[a != 0];
        squares[a] += (got.covariance[a] + product) / (WIDTH * HEIGHT);
      }
      means[0] += got.mean[0] / (WIDTH * HEIGHT);
      means[1] += got.mean[1] / (WIDTH * HEIGHT);
    }
    for (int a = 0; a < 2; a++)
      assert_near(means[a], mean[a], 1e-7);
    /* points beside cells are not exact: up to FEW texels three a side */
    for (int a = 0; a < 3; a++)
      assert_near(squares[a], square[a], (n == 2 ? 2e-3 : 1e-7) * (square[0] + square[2]));
  }
  shade_slope_map_free(m);
  free(pixels);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(one_texel_is_exact),
                                     cmocka_unit_test(texels_side_by_side_are_exact),
                                     cmocka_unit_test(all_places_together_are_exact),
                                     cmocka_unit_test(normals_become_slopes),
                                     cmocka_unit_test(points_are_interpolated),
                                     cmocka_unit_test(every_level_keeps_the_moments),
                                     cmocka_unit_test(footprints_are_averages),
                                     cmocka_unit_test(filters_spread_as_footprints),
                                     cmocka_unit_test(even_growth_is_met_in_the_middle),
                                     cmocka_unit_test(edges_are_those_of_a_larger_picture),
                                     cmocka_unit_test(a_tilted_plane_stays),
                                     cmocka_unit_test(bad_pictures_are_mended)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
