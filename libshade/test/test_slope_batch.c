/* SPDX-License-Identifier: Apache-2.0 */
/* Batches of look-ups and of widening, on every instruction set, against the single calls. */
#include "test/support.h"

#include <string.h>

#include "shade/maps.h"
#include "src/slope_map.h"

enum { LANES = 1003, ARRAYS = 6 };

static shade_slope_map *random_map(int width, int height, shade_wrap wrap, uint64_t seed) {
  float *p = malloc((size_t)(width * height) * 2 * sizeof *p);
  for (int j = 0; j < height; j++)
    for (int i = 0; i < width; i++) {
      float *s = p + 2 * (j * width + i);
      s[0] = (float)(0.4 * sin(0.4 * i + 0.9 * j) + 0.3 * (uniform(&seed) - 0.5));
      s[1] = (float)(0.1 + 0.5 * (double)s[0] + 0.3 * (uniform(&seed) - 0.5));
    }
  shade_slope_options o;
  shade_slope_options_init(&o);
  o.normals = SHADE_NORMALS_SLOPE;
  o.wrap = wrap;
  shade_slope_map *m = shade_slope_map_create(p, width, height, 2, &o, NULL);
  assert_non_null(m);
  free(p);
  return m;
}

typedef struct lanes {
  float in[ARRAYS][LANES], out[ARRAYS][LANES];
} lanes;

static shade_slope_lanesf lanes_of(const lanes *l, int sides) {
  return (shade_slope_lanesf){sizeof(shade_slope_lanesf),
                              l->in[0],
                              l->in[1],
                              sides ? l->in[2] : NULL,
                              sides ? l->in[3] : NULL,
                              sides ? l->in[4] : NULL,
                              sides ? l->in[5] : NULL};
}

static shade_slope_resultf result_of(lanes *l) {
  return (shade_slope_resultf){sizeof(shade_slope_resultf),
                               l->out[0],
                               l->out[1],
                               l->out[2],
                               l->out[3],
                               l->out[4],
                               l->out[5]};
}

/* Largest difference of lane i from the single call, as the header bounds it: 1 is the bound. */
static double off_by(const shade_slope_map *m, const lanes *l, int i, int sides, double stretch) {
  double side[4], off = 0;
  shade_slopes s;
  for (int k = 0; k < 4; k++)
    side[k] = stretch * (double)l->in[2 + k][i];
  shade_slope_lookup(m, (double)l->in[0][i], (double)l->in[1][i], sides ? side : NULL, &s);
  const double size = 1 + s.mean[0] * s.mean[0] + s.mean[1] * s.mean[1];
  for (int k = 0; k < 3; k++) {
    off = fmax(off, fabs((double)l->out[k][i] - s.normal[k]) / 2e-6);
    off = fmax(off, fabs((double)l->out[3 + k][i] - s.covariance[k]) / (2e-6 * size));
  }
  return off;
}

/* Footprints of every size, shape and place: next to one another, and lane by lane unlike. */
static void footprint(lanes *l, int i, int kind, double texels, int width, int height,
                      uint64_t *seed) {
  const double turn = kind % 2 ? 6.3 * uniform(seed) : 0, c = cos(turn), s = sin(turn);
  double a = texels, b = texels;
  if (kind >= 2) { /* each lane its own */
    a = pow(10, 4 * uniform(seed) - 2);
    b = a * pow(10, -2 * uniform(seed));
  } else if (kind == 1) {
    b /= 7;
  }
  l->in[0][i] = (float)(kind >= 2 ? 6 * uniform(seed) - 3 : 0.1 + i * texels / width);
  l->in[1][i] = (float)(kind >= 2 ? 6 * uniform(seed) - 3 : 0.37);
  l->in[2][i] = (float)(a * c / width);
  l->in[3][i] = (float)(a * s / height);
  l->in[4][i] = (float)(-b * s / width);
  l->in[5][i] = (float)(b * c / height);
  for (int k = 2; k < ARRAYS && kind == 4; k++) /* shares of the picture, whatever its shape */
    l->in[k][i] = (float)(0.999 * (uniform(seed) - 0.5) * pow(10, -4 * uniform(seed)));
}

static void look_ups_agree(void **state) {
  (void)state;
  static lanes l;
  const int sizes[][2] = {{256, 256}, {53, 37}, {1, 1},    {2, 9},
                          {16, 1},    {300, 7}, {1, 8192}, {8192, 3}};
  const double texels[] = {0.01, 1, 2, 3, 5.5, 8, 17, 60};
  const shade_isa_table *isa;
  uint64_t seed = 5;
  double worst = 0;
  int lanes_seen = 0, others = 0;
  for (int z = 0; z < 8; z++)
    for (int wrap = SHADE_WRAP_REPEAT; wrap <= SHADE_WRAP_MIRROR; wrap++) {
      shade_slope_map *m = random_map(sizes[z][0], sizes[z][1], (shade_wrap)wrap, 7);
      for (int kind = 0; kind < 11; kind++) {
        for (int i = 0; i < LANES; i++)
          footprint(&l, i, kind < 8 ? kind % 2 : kind - 6, texels[kind % 8], sizes[z][0],
                    sizes[z][1], &seed);
        for (int row = 0; (isa = shade_isa_pick(row)); row++)
          for (int sides = 0; sides < 2; sides++) {
            const shade_slope_lanesf in = lanes_of(&l, sides);
            const shade_slope_resultf out = result_of(&l);
            memset(l.out, 0xff, sizeof l.out);
            assert_int_equal(slope_lookup_on(isa, m, LANES, &in, &out), SHADE_OK);
            for (int i = 0; i < LANES; i++) {
              double off = off_by(m, &l, i, sides, 1);
              lanes_seen++;
              if (off > 1) { /* a count was rounded the other way */
                others++;
                off = fmin(off_by(m, &l, i, sides, 1 - 2e-4), off_by(m, &l, i, sides, 1 + 2e-4));
                assert_true(off <= 400);
              } else {
                worst = fmax(worst, off);
              }
            }
          }
      }
      shade_slope_map_free(m);
    }
  print_message("%d lanes: worst %.2f of the bound, %d by another count\n", lanes_seen, worst,
                others);
  assert_true(others <= lanes_seen / 1000);
}

/* Pixels side by side: footprints alike, along the axes and turned, here and there over an edge. */
static void rows_of_pixels_agree(void **state) {
  (void)state;
  static lanes l;
  const double sides[][2] = {{2, 2},   {3, 3},  {3, 2.5}, {2.8, 1.8}, {3.2, 3.2}, {6, 1},
                             {10, 1},  {4, 4},  {16, 16}, {16, 4},    {5, 16},    {64, 64},
                             {60, 30}, {64, 8}, {9, 12},  {10, 4},    {14, 4}};
  const double turns[] = {0, 1e-7, 1e-4, 0.02, 0.5, 1.2};
  const shade_isa_table *isa;
  double worst = 0;
  for (int wrap = SHADE_WRAP_REPEAT; wrap <= SHADE_WRAP_MIRROR; wrap++)
    for (int odd = 0; odd < 2; odd++) {
      const int width = 256 - 3 * odd, height = 240 + odd;
      shade_slope_map *m = random_map(width, height, (shade_wrap)wrap, 7);
      for (size_t shape = 0; shape < sizeof sides / sizeof sides[0]; shape++)
        for (size_t turn = 0; turn < sizeof turns / sizeof turns[0]; turn++) {
          const double c = cos(turns[turn]), s = sin(turns[turn]);
          const double a = sides[shape][0], b = sides[shape][1];
          for (int i = 0; i < LANES; i++) {
            l.in[0][i] = (float)fmod(0.1 + i * a * c / width, 1);
            l.in[1][i] = (float)fmod(0.2 + i * a * s / height, 1);
            l.in[2][i] = (float)(a * c / width);
            l.in[3][i] = (float)(a * s / height);
            l.in[4][i] = (float)(-b * s / width);
            l.in[5][i] = (float)(b * c / height);
          }
          const shade_slope_lanesf in = lanes_of(&l, 1);
          const shade_slope_resultf out = result_of(&l);
          for (int row = 0; (isa = shade_isa_pick(row)); row++) {
            memset(l.out, 0xff, sizeof l.out);
            assert_int_equal(slope_lookup_on(isa, m, LANES, &in, &out), SHADE_OK);
            for (int i = 0; i < LANES; i++)
              worst = fmax(worst, fmin(off_by(m, &l, i, 1, 1), off_by(m, &l, i, 1, 1 + 2e-4)));
          }
        }
      shade_slope_map_free(m);
    }
  print_message("pixels side by side: worst %.2f of the bound\n", worst);
  assert_true(worst <= 1);
}

/* Any length, any alignment: a lane's numbers do not depend on its neighbours. */
static void any_count_and_alignment(void **state) {
  (void)state;
  static lanes l, part;
  uint64_t seed = 11;
  shade_slope_map *m = random_map(64, 64, SHADE_WRAP_REPEAT, 3);
  for (int i = 0; i < LANES; i++)
    footprint(&l, i, 3, 1, 64, 64, &seed);
  shade_slope_lanesf in = lanes_of(&l, 1);
  shade_slope_resultf out = result_of(&l);
  assert_int_equal(shade_slope_lookup_batchf(m, LANES, &in, &out), SHADE_OK);
  for (int first = 0; first < 20; first += 3)
    for (int count = 0; count < 40; count += 7) {
      const float *const from[ARRAYS] = {l.in[0] + first, l.in[1] + first, l.in[2] + first,
                                         l.in[3] + first, l.in[4] + first, l.in[5] + first};
      in = (shade_slope_lanesf){sizeof in, from[0], from[1], from[2], from[3], from[4], from[5]};
      memset(part.out, 0, sizeof part.out);
      out = result_of(&part);
      assert_int_equal(shade_slope_lookup_batchf(m, (size_t)count, &in, &out), SHADE_OK);
      for (int k = 0; k < ARRAYS; k++) {
        for (int i = 0; i < count; i++)
          assert_near((double)part.out[k][i], (double)l.out[k][first + i], 1e-6);
        assert_true(part.out[k][count] == 0);
      }
    }
  shade_slope_map_free(m);
}

static void bad_look_ups(void **state) {
  (void)state;
  static lanes l;
  const float bad[] = {NAN, INFINITY, -INFINITY, 1e30F, -3e38F, 1e9F, -0.0F, 1e-40F};
  shade_slope_map *m = random_map(31, 17, SHADE_WRAP_MIRROR, 3);
  uint64_t seed = 13;
  for (int k = 0; k < ARRAYS; k++)
    for (int b = 0; b < 8; b++) {
      for (int i = 0; i < LANES; i++)
        footprint(&l, i, 3, 1, 31, 17, &seed);
      l.in[k][777] = bad[b];
      const shade_slope_lanesf in = lanes_of(&l, 1);
      const shade_slope_resultf out = result_of(&l);
      const unsigned status = shade_slope_lookup_batchf(m, LANES, &in, &out);
      assert_int_equal(status, isfinite(bad[b]) ? SHADE_OK : SHADE_BAD_INPUT);
      for (int c = 0; c < ARRAYS; c++)
        assert_true(isfinite(l.out[c][777]));
      if (status)
        assert_true(l.out[2][777] == 1 && l.out[3][777] == 0);
      else
        assert_true(off_by(m, &l, 777, 1, 1) <= 1);
      assert_true(off_by(m, &l, 776, 1, 1) <= 1 || off_by(m, &l, 776, 1, 1 + 2e-4) <= 40);
    }
  /* what is missing, or beyond `size` */
  shade_slope_lanesf in = lanes_of(&l, 1);
  shade_slope_resultf out = result_of(&l);
  memset(l.out, 0, sizeof l.out);
  in.dv2 = NULL;
  assert_int_equal(shade_slope_lookup_batchf(m, LANES, &in, &out), SHADE_BAD_INPUT);
  in = lanes_of(&l, 1);
  in.v = NULL;
  assert_int_equal(shade_slope_lookup_batchf(m, LANES, &in, &out), SHADE_BAD_INPUT);
  in = lanes_of(&l, 1);
  out.nz = NULL;
  assert_int_equal(shade_slope_lookup_batchf(m, LANES, &in, &out), SHADE_BAD_INPUT);
  out = result_of(&l);
  out.cxy = NULL;
  assert_int_equal(shade_slope_lookup_batchf(m, LANES, &in, &out), SHADE_BAD_INPUT);
  out = result_of(&l);
  in.size = offsetof(shade_slope_lanesf, v);
  assert_int_equal(shade_slope_lookup_batchf(m, LANES, &in, &out), SHADE_BAD_INPUT);
  assert_true(l.out[2][0] == 0 && l.out[2][LANES - 1] == 0);
  in.size = offsetof(shade_slope_lanesf, du1); /* points */
  out.size = offsetof(shade_slope_resultf, cxx);
  assert_int_equal(shade_slope_lookup_batchf(m, LANES, &in, &out), SHADE_OK);
  assert_true(l.out[2][0] > 0 && l.out[3][0] == 0);
  shade_slope_map_free(m);
}

/* ---- widening ------------------------------------------------------------------------------ */

typedef struct lobes {
  float n[3][LANES], c[3][LANES], base[2][LANES], width[4][LANES], groove[2][LANES];
} lobes;

static void random_lobes(lobes *l, int kind, uint64_t *seed) {
  for (int i = 0; i < LANES; i++) {
    const double tilt = kind == 1 ? 1.5 * uniform(seed) : 0.7 * uniform(seed);
    const double phi = 6.3 * uniform(seed), turn = 6.3 * uniform(seed);
    const double a = pow(10, 5 * uniform(seed) - 5), b = a * pow(10, -3 * uniform(seed));
    const double cs = cos(turn), sn = sin(turn), length = kind == 1 ? 0.2 + 3 * uniform(seed) : 1;
    l->n[0][i] = (float)(length * sin(tilt) * cos(phi));
    l->n[1][i] = (float)(length * sin(tilt) * sin(phi));
    l->n[2][i] = (float)(length * cos(tilt));
    l->c[0][i] = (float)(a * cs * cs + b * sn * sn);
    l->c[1][i] = (float)((a - b) * cs * sn);
    l->c[2][i] = (float)(a * sn * sn + b * cs * cs);
    for (int k = 0; k < 3 && i % 50 == 7; k++)
      l->c[k][i] = 0;
  }
}

static void widening_agrees(void **state) {
  (void)state;
  static lobes l;
  uint64_t seed = 17;
  double worst = 0, turned = 0;
  const shade_isa_table *isa;
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int groove = SHADE_GROOVE_AUTO; groove < SHADE_GROOVE_COUNT; groove++)
      for (int kind = 0; kind < 4; kind++) {
        shade_params p;
        shade_params_init(&p);
        p.mdf = (shade_mdf)mdf;
        p.groove = (shade_groove)groove;
        shade_params_set_alphas(&p, 0.3, kind == 2 ? 0.3 : 0.06);
        const int exponents = mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY;
        random_lobes(&l, kind, &seed);
        for (int i = 0; i < LANES; i++)
          for (int k = 0; k < 2; k++)
            l.base[k][i] =
                (float)(exponents ? pow(10, 5 * uniform(&seed)) : pow(10, 2 * uniform(&seed) - 2));
        shade_widen_lanesf in = {sizeof in, l.n[0], l.n[1], l.n[2], l.c[0], l.c[1],
                                 l.c[2],    NULL,   NULL,   NULL,   NULL};
        const shade_widen_resultf out = {sizeof out, l.width[0],  l.width[1], l.width[2],
                                         l.width[3], l.groove[0], l.groove[1]};
        if (kind == 3) {
          in.ax = in.ex = l.base[0];
          in.ay = in.ey = l.base[1];
        }
        for (int row = 0; (isa = shade_isa_pick(row)); row++) {
          assert_int_equal(slope_widen_on(isa, &p, LANES, &in, &out), SHADE_OK);
          for (int i = 0; i < LANES; i++) {
            shade_params q = p, wide;
            const double n[3] = {(double)l.n[0][i], (double)l.n[1][i], (double)l.n[2][i]};
            const double c[3] = {(double)l.c[0][i], (double)l.c[1][i], (double)l.c[2][i]};
            double angle;
            if (kind == 3 && exponents)
              shade_params_set_exponents(&q, (double)l.base[0][i], (double)l.base[1][i]);
            else if (kind == 3)
              shade_params_set_alphas(&q, (double)l.base[0][i], (double)l.base[1][i]);
            shade_params_widen(&q, n, c, &wide, &angle);
            const double want[4] = {wide.ax, wide.ay, wide.ex, wide.ey};
            const double apart = fabs(log(wide.ax / wide.ay));
            const double cs = (double)l.groove[0][i], sn = (double)l.groove[1][i];
            assert_near(cs * cs + sn * sn, 1, 1e-6);
            if (apart > 0.01) {
              turned = fmax(turned, fabs(sn * cos(angle) - cs * sin(angle)));
              for (int k = 0; k < 4; k++)
                if (k < 2 || exponents || want[k] > 1)
                  worst = fmax(worst, fabs((double)l.width[k][i] / want[k] - 1));
            } else { /* all but round: the axes may lie elsewhere, or trade places */
              const double sum = (double)l.width[0][i] + (double)l.width[1][i];
              worst = fmax(worst, fabs(sum / (wide.ax + wide.ay) - 1));
            }
          }
        }
      }
  print_message("widths %.1e off, directions %.1e\n", worst, turned);
  assert_true(worst <= 1e-5);
  assert_true(turned <= 1e-4);
}

static void bad_lobes(void **state) {
  (void)state;
  static lobes l;
  uint64_t seed = 19;
  shade_params p;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_GGX;
  const struct {
    int array;
    float value;
    unsigned status;
  } cases[] = {{0, NAN, SHADE_BAD_INPUT},
               {2, -1, SHADE_BAD_INPUT},
               {2, INFINITY, SHADE_BAD_INPUT},
               {3, NAN, SHADE_BAD_INPUT},
               {4, INFINITY, SHADE_BAD_INPUT},
               {5, -1, SHADE_BAD_INPUT},
               {4, 5, SHADE_BAD_INPUT},
               {3, 1e30F, SHADE_CLAMPED_PARAMETER},
               {6, NAN, 0},
               {6, -2, 0},
               {7, 1e9F, 0}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    random_lobes(&l, 0, &seed);
    for (int i = 0; i < LANES; i++)
      l.base[0][i] = l.base[1][i] = 0.2F;
    float *const arrays[8] = {l.n[0], l.n[1], l.n[2], l.c[0], l.c[1], l.c[2], l.base[0], l.base[1]};
    arrays[cases[k].array][500] = cases[k].value;
    const shade_widen_lanesf in = {sizeof in, l.n[0],    l.n[1],    l.n[2], l.c[0], l.c[1],
                                   l.c[2],    l.base[0], l.base[1], NULL,   NULL};
    const shade_widen_resultf out = {sizeof out, l.width[0],  l.width[1], l.width[2],
                                     l.width[3], l.groove[0], l.groove[1]};
    const unsigned status = shade_params_widen_batchf(&p, LANES, &in, &out);
    for (int c = 0; c < 2; c++) {
      assert_true(l.width[c][500] >= 1e-4F && l.width[c][500] <= 10);
      assert_true(l.width[2 + c][500] >= 0 && l.width[2 + c][500] <= 1e6F);
      assert_true(fabsf(l.groove[c][500]) <= 1);
    }
    if (cases[k].array >= 6) {
      assert_int_equal(status, SHADE_CLAMPED_PARAMETER);
      continue;
    }
    assert_int_equal(status & cases[k].status, cases[k].status);
    shade_params wide;
    double angle;
    const double n[3] = {(double)l.n[0][500], (double)l.n[1][500], (double)l.n[2][500]};
    const double c[3] = {(double)l.c[0][500], (double)l.c[1][500], (double)l.c[2][500]};
    shade_params q = p;
    shade_params_set_alphas(&q, 0.2F, 0.2F);
    assert_int_equal(shade_params_widen(&q, n, c, &wide, &angle), status);
    assert_near((double)l.width[0][500] + (double)l.width[1][500], wide.ax + wide.ay,
                2e-5 * (wide.ax + wide.ay));
  }
  shade_widen_lanesf in = {.size = sizeof in, .cxx = l.c[0], .cxy = l.c[1], .cyy = l.c[2]};
  shade_widen_resultf out = {.size = sizeof out, .ax = l.width[0], .ay = l.width[1]};
  assert_int_equal(shade_params_widen_batchf(&p, LANES, &in, &out), SHADE_OK);
  in.nx = l.n[0];
  assert_int_equal(shade_params_widen_batchf(&p, LANES, &in, &out), SHADE_BAD_INPUT);
  in.nx = NULL;
  in.cxy = NULL;
  assert_int_equal(shade_params_widen_batchf(&p, LANES, &in, &out), SHADE_BAD_INPUT);
  in.cxy = l.c[1];
  out.ay = NULL;
  assert_int_equal(shade_params_widen_batchf(&p, LANES, &in, &out), SHADE_BAD_INPUT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(look_ups_agree),          cmocka_unit_test(rows_of_pixels_agree),
      cmocka_unit_test(any_count_and_alignment), cmocka_unit_test(bad_look_ups),
      cmocka_unit_test(widening_agrees),         cmocka_unit_test(bad_lobes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
