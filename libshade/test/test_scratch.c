/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 2.1 */
/* Scratches: against the cap's closed forms, the height's own gradient and brute force. */
#include "test/support.h"

#include <string.h>

#include "shade/maps.h"
#include "src/scratch.h"
#include "batch/scratch_row.h"

static shade_scratch_params one_layer(uint32_t pits, double radius, double stretch, double depth) {
  shade_scratch_params p;
  shade_scratch_params_init(&p);
  p.cells = 0;
  p.layer[0] =
      (shade_scratch_layer){pits, {radius, radius}, {stretch, stretch}, {depth, depth}, 0.5, 0};
  return p;
}

static shade_scratch_field *create(const shade_scratch_params *p) {
  unsigned status = 99;
  shade_scratch_field *f = shade_scratch_create(p, &status);
  assert_non_null(f);
  assert_int_equal(status, SHADE_OK);
  return f;
}

static double height_at(const shade_scratch_field *f, double u, double v) {
  double height;
  shade_slopes s;
  assert_int_equal(shade_scratch_eval(f, u, v, NULL, &height, &s), SHADE_OK);
  return height;
}

/* Depth, rim, volume and mean square slopes of one pit. */
static void one_pit_is_a_spherical_cap(void **state) {
  (void)state;
  enum { N = 1200 };
  const double depths[] = {0.02, 0.3, 0.7}, stretches[] = {1, 5};
  for (int a = 0; a < 6; a++) {
    const double d = depths[a % 3], s = stretches[a / 3], r = 0.08, k = 2 * d / (1 + d * d);
    const double c = cos(0.5), sn = sin(0.5);
    shade_scratch_params p = one_layer(1, r, s, d);
    shade_scratch_field *f = create(&p);
    double lowest = 0, area = 0, volume = 0, along = 0, across = 0;
    for (int i = 0; i < N; i++)
      for (int j = 0; j < N; j++) {
        double h;
        shade_slopes at;
        shade_scratch_eval(f, (i + 0.5) / N, (j + 0.5) / N, NULL, &h, &at);
        if (h == 0)
          continue;
        const double g1 = c * at.mean[0] + sn * at.mean[1], g2 = c * at.mean[1] - sn * at.mean[0];
        lowest = fmin(lowest, h);
        area += 1;
        volume -= h;
        along += g1 * g1;
        across += g2 * g2;
      }
    shade_scratch_free(f);
    along /= area;
    across /= area;
    area /= (double)N * N;
    volume /= (double)N * N;
    const double slope2 = 0.5 * (-log(1 - k * k) / (k * k) - 1);
    /* the cap of a sphere is V = pi D (3 r^2 + D^2)/6; stretched s times */
    const double D = d * r, cap = s * PI * D * (3 * r * r + D * D) / 6;
    assert_near(lowest, -D, 1e-3 * D);
    assert_near(area, PI * r * r * s, 1e-3 * area);
    assert_near(volume, cap, 1e-3 * cap);
    assert_near(across, slope2, 3e-3 * slope2);
    assert_near(along, slope2 / (s * s), 3e-3 * slope2 / (s * s));
  }
}

/* Central differences, but for the creases, where the sides disagree. */
static void slopes_are_the_gradient_of_the_height(void **state) {
  (void)state;
  enum { POINTS = 40000 };
  const double step = 1e-7, aspects[] = {1, 0.4, 2.5};
  for (int a = 0; a < 3; a++) {
    shade_scratch_params p;
    shade_scratch_params_init(&p);
    p.cells = 0;
    p.aspect = aspects[a];
    p.layers = 2;
    p.layer[0].spread = PI / 2;
    p.layer[0].radius = (shade_range){0.002, 0.01};
    p.layer[1].stretch = (shade_range){1, 2};
    p.layer[1].depth = (shade_range){0.3, 0.6};
    shade_scratch_field *f = create(&p);
    uint64_t seed = 3;
    int creases = 0, inside = 0;
    double worst = 0;
    for (int i = 0; i < POINTS; i++) {
      const double u = uniform(&seed), v = uniform(&seed), du = step, dv = step / p.aspect;
      double h;
      shade_slopes s;
      shade_scratch_eval(f, u, v, NULL, &h, &s);
      const double right = height_at(f, u + du, v), left = height_at(f, u - du, v);
      const double up = height_at(f, u, v + dv), down = height_at(f, u, v - dv);
      if (fabs(right + left - 2 * h) > 1e-3 * step || fabs(up + down - 2 * h) > 1e-3 * step) {
        creases++;
        continue;
      }
      inside += h < 0;
      const double x = (right - left) / (2 * step), y = (up - down) / (2 * step);
      worst = fmax(worst, fmax(fabs(x - s.mean[0]), fabs(y - s.mean[1])));
      const double length = sqrt(x * x + y * y + 1);
      assert_near(s.normal[0], -x / length, 1e-4);
      assert_near(s.normal[1], -y / length, 1e-4);
      assert_near(s.normal[2], 1 / length, 1e-4);
    }
    shade_scratch_free(f);
    print_message("aspect %g: worst difference of slopes %.1e, %d points in pits\n", aspects[a],
                  worst, inside);
    assert_true(worst <= 1e-4);
    assert_true(inside > POINTS / 4);
    assert_true(creases < POINTS / 1000);
  }
}

/* Each layer alone has other bins than all together: what one of them misses shows. */
static void the_deepest_pit_counts(void **state) {
  (void)state;
  enum { LAYERS = 5, POINTS = 50000 };
  shade_scratch_params p;
  shade_scratch_params_init(&p);
  p.cells = 0;
  p.layers = LAYERS;
  p.aspect = 0.7;
  for (int i = 0; i < LAYERS; i++) {
    shade_scratch_layer *l = &p.layer[i];
    l->pits = (uint32_t)(1 << (3 * i));
    l->radius.low = l->radius.high = i == 0 ? 0.3 : 0.1 / (1 << i);
    l->stretch = (shade_range){1, 3 + 60.0 * i};
    l->spread = PI / 2;
  }
  shade_scratch_field *all = create(&p), *alone[LAYERS];
  for (int i = 0; i < LAYERS; i++) {
    shade_scratch_params q = p;
    for (int k = 0; k < LAYERS; k++)
      q.layer[k].pits = k == i ? p.layer[k].pits : 0;
    alone[i] = create(&q);
  }
  uint64_t seed = 5;
  int used[LAYERS] = {0};
  for (int i = 0; i < POINTS; i++) {
    const double u = uniform(&seed), v = uniform(&seed);
    double lowest = 0;
    int which = 0;
    for (int k = 0; k < LAYERS; k++) {
      const double h = height_at(alone[k], u, v);
      which = h < lowest ? k : which;
      lowest = fmin(lowest, h);
    }
    used[which]++;
    assert_true(height_at(all, u, v) == lowest);
  }
  for (int k = 0; k < LAYERS; k++) {
    assert_true(used[k] > 50);
    shade_scratch_free(alone[k]);
  }
  shade_scratch_free(all);
}

static void the_tile_has_no_seam(void **state) {
  (void)state;
  shade_scratch_params p;
  shade_scratch_params_init(&p);
  p.cells = 0;
  p.aspect = 1.5;
  p.layer[0].radius = (shade_range){0.002, 0.02};
  p.layer[0].spread = PI / 2;
  shade_scratch_field *f = create(&p);
  uint64_t seed = 7;
  int deep = 0;
  for (int i = 0; i < 20000; i++) {
    const double t = uniform(&seed), e = 1e-9;
    /* across each edge the height is continuous: slopes are below 1 here */
    assert_near(height_at(f, 1 - e, t), height_at(f, e, t), 4e-9);
    assert_near(height_at(f, t, 1 - e), height_at(f, t, e), 4e-9);
    deep += height_at(f, e, t) < 0;
    /* dyadic places survive the addition unchanged */
    const double u = floor(t * 1024) / 1024, v = floor(uniform(&seed) * 1024) / 1024;
    assert_true(height_at(f, u, v) == height_at(f, u + 1, v - 3));
  }
  assert_true(deep > 5000);
  shade_scratch_free(f);
}

static void scratches_follow_the_direction(void **state) {
  (void)state;
  const double whole[4] = {1, 0, 0, 1};
  for (int a = -3; a <= 3; a++) {
    shade_scratch_params p;
    shade_scratch_params_init(&p);
    p.layer[0].direction = 0.4 * a;
    p.layer[0].spread = 0;
    p.cells = 256;
    shade_scratch_field *f = create(&p);
    shade_slopes s;
    shade_scratch_eval(f, 0.5, 0.5, whole, NULL, &s);
    shade_scratch_free(f);
    /* slopes are large across the scratch */
    const double angle = 0.5 * atan2(2 * s.covariance[1], s.covariance[0] - s.covariance[2]);
    const double off = sin(angle - p.layer[0].direction - PI / 2);
    assert_near(off, 0, 0.02);
    const double trace = s.covariance[0] + s.covariance[2];
    const double gap = hypot(s.covariance[0] - s.covariance[2], 2 * s.covariance[1]);
    assert_true(gap > 0.98 * trace);
  }
}

/* Texels are points of the field, whatever rows are asked for together; v runs up. */
static void rows_are_points_of_the_field(void **state) {
  (void)state;
  enum { W = 96, H = 60 };
  shade_scratch_params p;
  shade_scratch_params_init(&p);
  p.aspect = (double)H / W;
  p.cells = 0;
  shade_scratch_field *f = create(&p);
  float *height = malloc(W * H * sizeof(float)), *normal = malloc(W * H * 3 * sizeof(float));
  float one_height[W], one_normal[3 * W];
  shade_scratch_rows(f, W, H, 0, H, 1, height, normal);
  for (int j = 0; j < H; j++) {
    shade_scratch_rows(f, W, H, j, 1, 1, one_height, one_normal);
    assert_memory_equal(one_height, height + j * W, sizeof one_height);
    assert_memory_equal(one_normal, normal + 3 * j * W, sizeof one_normal);
    for (int i = 0; i < W; i++) {
      double h;
      shade_slopes s;
      shade_scratch_eval(f, (i + 0.5) / W, 1 - (j + 0.5) / H, NULL, &h, &s);
      assert_near(h, (double)one_height[i], 1e-9);
      for (int c = 0; c < 3; c++)
        assert_near(s.normal[c], (double)one_normal[3 * i + c], 1e-6);
    }
  }
  /* a small picture of many samples is the box mean of a large one */
  enum { N = 5 };
  float *small = malloc(W * H / N / N * sizeof(float));
  shade_scratch_rows(f, W / N, H / N, 0, H / N, N, small, NULL);
  shade_scratch_rows(f, W / N * N, H / N * N, 0, H / N * N, 1, height, NULL);
  for (int j = 0; j < H / N; j++)
    for (int i = 0; i < W / N; i++) {
      double sum = 0;
      for (int k = 0; k < N * N; k++)
        sum += (double)height[(j * N + k / N) * (W / N * N) + i * N + k % N] / (N * N);
      assert_near((double)small[j * (W / N) + i], sum, 1e-9);
    }
  free(small);
  free(height);
  free(normal);
  shade_scratch_free(f);
}

/* Mean and covariance by 150 x 150 points, jittered. */
static void brute_force(const shade_scratch_field *f, double u, double v, const double side[4],
                        double mean[2], double second[3]) {
  enum { N = 150 };
  uint64_t seed = 11;
  memset(mean, 0, 2 * sizeof *mean);
  memset(second, 0, 3 * sizeof *second);
  for (int k = 0; k < N * N; k++) {
    const double s = (k % N + uniform(&seed)) / N - 0.5, t = (k / N + uniform(&seed)) / N - 0.5;
    shade_slopes at;
    shade_scratch_eval(f, u + s * side[0] + t * side[2], v + s * side[1] + t * side[3], NULL, NULL,
                       &at);
    const double x = at.mean[0], y = at.mean[1];
    mean[0] += x / (N * N);
    mean[1] += y / (N * N);
    second[0] += x * x / (N * N);
    second[1] += x * y / (N * N);
    second[2] += y * y / (N * N);
  }
}

/*
 * Footprints of every size against brute force. Sums of covariance and mean square are
 * compared over many places: the filter's shape is not a box, its mean over the tile is. The
 * mean slopes are compared at each place.
 */
static void footprints_are_averages(void **state) {
  (void)state;
  enum { PLACES = 16 };
  shade_scratch_params p;
  shade_scratch_params_init(&p);
  p.layers = 2;
  p.layer[0].direction = 0.3;
  p.layer[1].stretch = (shade_range){1, 4};
  p.layer[1].radius = (shade_range){0.001, 0.01};
  p.cells = 256;
  shade_scratch_field *f = create(&p);
  const double sizes[] = {0.0005, 0.006, 0.012, 0.03, 0.1, 1};
  for (size_t z = 0; z < sizeof sizes / sizeof sizes[0]; z++)
    for (int slant = 0; slant < 3; slant++) {
      const double a = sizes[z], b = slant == 2 ? a / 6 : a;
      const double turn = slant == 0 ? 0 : 0.7, c = cos(turn), sn = sin(turn);
      const double side[4] = {a * c, a * sn, -b * sn, b * c};
      double got[3] = {0}, want[3] = {0}, off = 0, norm = 0;
      uint64_t seed = 13 + z;
      for (int i = 0; i < PLACES; i++) {
        const double u = uniform(&seed), v = uniform(&seed);
        double mean[2], second[3];
        shade_slopes s;
        brute_force(f, u, v, side, mean, second);
        assert_int_equal(shade_scratch_eval(f, u, v, side, NULL, &s), SHADE_OK);
        const double gained[3] = {s.covariance[0] + s.mean[0] * s.mean[0],
                                  s.covariance[1] + s.mean[0] * s.mean[1],
                                  s.covariance[2] + s.mean[1] * s.mean[1]};
        for (int k = 0; k < 3; k++) {
          got[k] += gained[k] / PLACES;
          want[k] += second[k] / PLACES;
        }
        off += pow(s.mean[0] - mean[0], 2) + pow(s.mean[1] - mean[1], 2);
        norm += second[0] + second[2];
      }
      const double trace = want[0] + want[2];
      const double error =
          fmax(fmax(fabs(got[0] - want[0]), fabs(got[2] - want[2])), fabs(got[1] - want[1])) /
          trace;
      print_message("footprint %6.4f x %6.4f turned %.1f: second moments %.3f off, means %.3f\n", a,
                    b, turn, error, sqrt(off / norm));
      assert_true(error <= 0.1);
      /* place by place it is: worst (.122) where the narrow side is half a cell of the table */
      assert_true(sqrt(off / norm) <= 0.15);
    }
  /* over the whole tile nothing is left of the filter's shape */
  const double whole[4] = {1, 0, 0, 1};
  double mean[2], second[3];
  shade_slopes s;
  brute_force(f, 0.5, 0.5, whole, mean, second);
  shade_scratch_eval(f, 0.2, 0.9, whole, NULL, &s);
  assert_near(s.covariance[0], second[0] - mean[0] * mean[0], 0.02 * second[0]);
  assert_near(s.covariance[2], second[2] - mean[1] * mean[1], 0.02 * second[2]);
  shade_scratch_free(f);
}

/* Every cell of the table, on every instruction set, is the mean of the field at its samples. */
static void the_table_is_made_of_points(void **state) {
  (void)state;
  enum { SHAPES = 4 };
  const double aspects[SHAPES] = {1, 0.37, 2.2, 0.02};
  const int cells[SHAPES] = {48, 48, 48, 400}; /* the last: lines of more samples than a tile's */
  for (int a = 0; a < 2 * SHAPES; a++) {
    const int few = a < SHAPES; /* and the plate shows; of many most are hidden */
    shade_scratch_params p;
    shade_scratch_params_init(&p);
    p.aspect = aspects[a % SHAPES];
    p.cells = 0;
    p.seed = 5;
    p.layers = few ? 3 : 1;
    p.layer[0].pits = few ? 60 : 4000;
    p.layer[0].radius = (shade_range){0.0004, few ? 0.002 : 0.01};
    p.layer[0].stretch = (shade_range){20, 400};
    p.layer[0].direction = few ? 1.1 : 0.03;
    p.layer[1].pits = 20;
    p.layer[1].radius = (shade_range){0.01, 0.2};
    p.layer[1].stretch = (shade_range){1, 5};
    p.layer[1].spread = PI / 2;
    p.layer[2].pits = 200;
    p.layer[2].depth = (shade_range){0, 1e-5};
    shade_scratch_field *f = create(&p);
    const shade_isa_table *isa;
    for (int row = 0; (isa = shade_isa_pick(row)); row++) {
      assert_int_equal(shade_scratch_make_table(f, cells[a % SHAPES], isa), 0);
      const moment_level *l = &f->table.level[0];
      const int n = f->columns, rows = f->rows, count = n * rows;
      assert_int_equal(l->width > l->height ? l->width : l->height, cells[a % SHAPES]);
      assert_true(a % SHAPES != 3 || l->width * n > SCRATCH_TILE * SCRATCH_BLOCK);
      const uint64_t key = scratch_mix(f->seed ^ 0x7461626c65u);
      int off = 0, covered = 0;
      for (int cell = 0; cell < l->width * l->height; cell++) {
        double want[MOMENTS] = {0}, size[MOMENTS] = {1e-4, 1e-2, 1e-2, 1e-2, 1e-2, 1e-2};
        for (int k = 0; k < count; k++) {
          const int ki = k % n, kj = k / n;
          const uint64_t z = scratch_mix(key ^ ((uint64_t)cell * 64 + (uint64_t)k));
          const double a = scratch_shuffled(kj, rows) + 0.25 + (double)(z >> 32) * 0x1p-33;
          const double b = scratch_shuffled(ki, n) + 0.25 + (double)(z & 0xffffffffu) * 0x1p-33;
          const double u = (cell % l->width + (ki + a / rows) / n) / l->width;
          const double v = 1 - (cell / l->width + (kj + b / n) / rows) / l->height;
          double h;
          shade_slopes s;
          shade_scratch_eval(f, u, v, NULL, &h, &s);
          const double x = s.mean[0], y = s.mean[1];
          const double got[MOMENTS] = {h, x, y, x * x, x * y, y * y};
          covered += h < 0;
          for (int c = 0; c < MOMENTS; c++) {
            want[c] += got[c] / count;
            size[c] += fabs(got[c]) / count;
          }
        }
        const float *texel = moment_texel(l, cell % l->width, cell / l->width);
        int bad = 0;
        for (int c = 0; c < MOMENTS; c++)
          bad |= !(fabs((double)texel[c] - want[c]) <= 2e-4 * size[c]);
        off += bad;
      }
      shade_moments_free(&f->table);
      /* single precision sees a sample at a pit's very rim on its other side */
      print_message("aspect %g, %s: %d of %d cells differ, %d samples in pits\n", p.aspect,
                    isa->name, off, l->width * l->height, covered);
      assert_true(off <= l->width * l->height / 500);
      assert_true(covered > count * l->width * l->height / 16);
    }
    f->has_table = 0;
    shade_scratch_free(f);
  }
}

static void seeds_and_more_pits(void **state) {
  (void)state;
  shade_scratch_params p = one_layer(500, 0.004, 4, 0.3);
  shade_scratch_field *first = create(&p), *again = create(&p);
  p.layer[0].pits = 600;
  shade_scratch_field *more = create(&p);
  p.seed++;
  shade_scratch_field *other = create(&p);
  uint64_t seed = 17;
  int differ = 0, deeper = 0;
  for (int i = 0; i < 20000; i++) {
    const double u = uniform(&seed), v = uniform(&seed), h = height_at(first, u, v);
    assert_true(h == height_at(again, u, v));
    assert_true(height_at(more, u, v) <= h); /* those that were there stay */
    deeper += height_at(more, u, v) < h;
    differ += height_at(other, u, v) != h;
  }
  assert_true(deeper > 100);
  assert_true(differ > 1000);
  shade_scratch_free(first);
  shade_scratch_free(again);
  shade_scratch_free(more);
  shade_scratch_free(other);
}

static void bad_numbers_are_mended(void **state) {
  (void)state;
  const double bad[] = {NAN, INFINITY, -INFINITY, -1, 1e300};
  for (int i = 0; i < 5; i++) {
    shade_scratch_params p;
    shade_scratch_params_init(&p);
    const double x = bad[i];
    p.aspect = x;
    p.cells = i % 2 ? -7 : 16;
    p.layer[0] = (shade_scratch_layer){50, {x, 0.01}, {3, x}, {x, x}, x, x};
    unsigned status = 0;
    shade_scratch_field *f = shade_scratch_create(&p, &status);
    assert_non_null(f);
    assert_true(status & SHADE_CLAMPED_PARAMETER);
    for (int k = 0; k < 5; k++) {
      const double side[4] = {bad[k], 0, 0, 0.1};
      double h = NAN;
      shade_slopes s;
      shade_scratch_eval(f, 0.3, 0.4, side, &h, &s);
      assert_true(isfinite(h) && isfinite(s.covariance[0]) && isfinite(s.normal[2]));
      assert_int_equal(shade_scratch_eval(f, bad[k], 0.4, NULL, &h, &s),
                       isfinite(bad[k]) ? SHADE_OK : SHADE_BAD_INPUT);
      assert_true(isfinite(h) && isfinite(s.normal[2]));
    }
    shade_scratch_free(f);
  }
  shade_scratch_params p = one_layer(0, 0.01, 1, 0.1);
  p.cells = 8;
  shade_scratch_field *none = create(&p);
  assert_true(height_at(none, 0.2, 0.3) == 0);
  shade_scratch_free(none);
  p.layers = 0;
  none = create(&p);
  assert_true(height_at(none, 0.2, 0.3) == 0);
  shade_scratch_free(none);
  shade_scratch_free(NULL);
  p = one_layer(40, 0.01, 1, 0); /* depth 0: no pit, no division by it */
  none = create(&p);
  assert_true(height_at(none, 0.2, 0.3) == 0);
  shade_scratch_free(none);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(one_pit_is_a_spherical_cap),
                                     cmocka_unit_test(slopes_are_the_gradient_of_the_height),
                                     cmocka_unit_test(the_deepest_pit_counts),
                                     cmocka_unit_test(the_tile_has_no_seam),
                                     cmocka_unit_test(scratches_follow_the_direction),
                                     cmocka_unit_test(rows_are_points_of_the_field),
                                     cmocka_unit_test(footprints_are_averages),
                                     cmocka_unit_test(the_table_is_made_of_points),
                                     cmocka_unit_test(seeds_and_more_pits),
                                     cmocka_unit_test(bad_numbers_are_mended)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
