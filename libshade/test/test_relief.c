/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.4 */
/* How steep bumps are near a place: points of fields whose moments are known. */
#include "test/support.h"

#include <string.h>

#include "shade/maps.h"

#define PI 3.14159265358979323846
enum { MANY = 1 << 18 };
typedef struct field {
  float u[MANY], v[MANY], x[MANY], y[MANY], weight[MANY];
} field;

typedef void slopes_at(double u, double v, uint64_t *seed, double s[2]);

/* Points that lie evenly, on [low, low + size) either way. */
static field *look(slopes_at *at, double low, double size) {
  field *f = malloc(sizeof *f);
  uint64_t seed = 7;
  assert_non_null(f);
  for (int i = 0; i < MANY; i++) {
    double s[2];
    const double u = fmod(0.5 + i * 0.7548776662466927, 1), v = fmod(0.5 + i * 0.569840290998, 1);
    at(u, v, &seed, s);
    f->u[i] = (float)(low + size * u);
    f->v[i] = (float)(low + size * v);
    f->x[i] = (float)s[0];
    f->y[i] = (float)s[1];
    f->weight[i] = 1;
  }
  return f;
}

static shade_relief *relief_of(const field *f, int shape) {
  shade_relief *r = shade_relief_create(MANY, f->u, f->v, f->x, f->y, f->weight, shape);
  assert_non_null(r);
  return r;
}

static void place(const shade_relief *r, double u, double v, float s[5]) {
  float *const to[5] = {s, s + 1, s + 2, s + 3, s + 4};
  const float at[2] = {(float)u, (float)v};
  shade_relief_lookup_batchf(r, 1, at, at + 1, to);
}

/* Within 2 % of the largest number. */
static void assert_slopes(const float *s, const double wanted[5], double within) {
  for (int k = 0; k < 5; k++)
    if (!(fabs((double)s[k] - wanted[k]) <= within))
      fail_msg("number %d: %g, expected %g", k, (double)s[k], wanted[k]);
}

static void leaning_noise(double u, double v, uint64_t *seed, double s[2]) {
  (void)u;
  (void)v;
  const double a = uniform(seed) - 0.5, b = uniform(seed) - 0.5;
  s[0] = 0.3 + a;
  s[1] = -0.2 + 0.5 * a + b;
}
static void even_bumps_have_the_moment_of_all(void **state) {
  (void)state;
  field *f = look(leaning_noise, 0, 1);
  shade_relief *r = relief_of(f, 0);
  const double wanted[5] = {0.3, -0.2, 1 / 12.0, 0.5 / 12, 1.25 / 12};
  double whole[5];
  float s[5];
  const double varies = shade_relief_whole(r, whole);
  assert_true(varies >= 0 && varies < 0.1);
  for (int k = 0; k < 5; k++)
    assert_near(whole[k], wanted[k], 2e-3);
  for (int i = 0; i < 20; i++) {
    place(r, 0.05 * i, 0.93 * i, s);
    assert_slopes(s, whole, 1e-7);
  }
  shade_relief_free(r);
  free(f);
}

/* Ripples, flat for u < 1/2, on a plane that leans. */
static const double lean[2] = {0.1, 0.2};
static void half_rippled(double u, double v, uint64_t *seed, double s[2]) {
  (void)seed;
  const double wave = u < 0.5 ? 0 : cos(2 * PI * (40 * u + 24 * v));
  s[0] = lean[0] + 0.8 * wave;
  s[1] = lean[1] + 0.4 * wave;
}
static const double flat_there[5] = {0.1, 0.2, 0, 0, 0};
static const double rippled_there[5] = {0.1, 0.2, 0.32, 0.16, 0.08};
static const double half_of_all[5] = {0.1, 0.2, 0.16, 0.08, 0.04};

static void half_flat_at(const shade_relief *r, double low, double size) {
  float s[5];
  for (double v = 0.05; v < 1; v += 0.3) {
    place(r, low + size * 0.25, low + size * v, s);
    assert_slopes(s, flat_there, 0.006);
    place(r, low + size * 0.75, low + size * v, s);
    assert_slopes(s, rippled_there, 0.02);
  }
}
static void flat_places_are_flat(void **state) {
  (void)state;
  field *f = look(half_rippled, 0, 1);
  shade_relief *r = relief_of(f, 0);
  double whole[5];
  assert_near(shade_relief_whole(r, whole), 1, 0.05); /* half 0 and half twice the mean */
  for (int k = 0; k < 5; k++)
    assert_near(whole[k], half_of_all[k], 2e-3);
  half_flat_at(r, 0, 1);
  shade_relief_free(r);

  /* between flat and rippled there is no step */
  r = relief_of(f, 0);
  float last[5], s[5];
  place(r, 0.3, 0.4, last);
  for (double u = 0.3; u < 0.7; u += 1e-4, memcpy(last, s, sizeof s)) {
    place(r, u, 0.4, s);
    assert_true(fabs((double)(s[2] - last[2])) < 0.01);
  }
  shade_relief_free(r);
  free(f);
}

/* Noise along the edges at 0, nothing elsewhere. */
static void rough_first_edges(double u, double v, uint64_t *seed, double s[2]) {
  s[0] = s[1] = 0;
  if (u < 0.04 || v < 0.04) {
    s[0] = uniform(seed) - 0.5;
    s[1] = uniform(seed) - 0.5;
  }
}

/* The square that was looked at is no tile: windows at its last edges do not reach the first. */
static void edges_are_no_neighbours(void **state) {
  (void)state;
  field *f = look(rough_first_edges, 3, 0.5);
  for (int shape = 0; shape < 2; shape++) {
    shade_relief *r = relief_of(f, shape);
    float s[5];
    for (double at = 0.2; at < 1; at += 0.1) {
      place(r, 3 + 0.5 * 0.9995, 3 + 0.5 * at, s);
      assert_slopes(s, (double[]){0, 0, 0, 0, 0}, 1e-3);
      place(r, 3 + 0.5 * at, 3 + 0.5 * 0.9995, s);
      assert_slopes(s, (double[]){0, 0, 0, 0, 0}, 1e-3);
    }
    place(r, 3 + 0.5 * 0.01, 3.25, s);
    assert_true(s[2] > 0.03F && s[4] > 0.03F); /* of 1/12 */
    shade_relief_free(r);
  }
  free(f);
}

static void a_small_square_has_windows_of_its_own(void **state) {
  (void)state;
  field *f = look(half_rippled, 0.3, 0.02);
  shade_relief *r = relief_of(f, 0);
  half_flat_at(r, 0.3, 0.02);
  shade_relief_free(r);
  free(f);
}
/* Two tiles beside each other. */
static void twice_half_rippled(double u, double v, uint64_t *seed, double s[2]) {
  half_rippled(fmod(2 * u, 1), fmod(2 * v, 1), seed, s);
}
static void more_than_a_period_lies_on_itself(void **state) {
  (void)state;
  field *f = look(twice_half_rippled, 0, 2);
  shade_relief *r = relief_of(f, 0);
  for (int i = -2; i < 3; i++)
    half_flat_at(r, i, 1);
  shade_relief_free(r);
  free(f);
}
static void few_points_say_less(void **state) {
  (void)state;
  field *f = look(half_rippled, 0, 1);
  shade_relief *r = shade_relief_create(4096, f->u, f->v, f->x, f->y, NULL, 0);
  assert_non_null(r);
  double whole[5];
  const double varies = shade_relief_whole(r, whole);
  assert_true(varies > 0.2 && varies < 1);
  shade_relief_free(r);
  free(f);
}

/* As halves of the same points, by weight; those that are no numbers count nothing either. */
static void points_count_by_their_weight(void **state) {
  (void)state;
  field *f = look(half_rippled, 0, 1);
  double whole[5];
  for (int i = 0; i < MANY; i++)
    f->weight[i] = f->u[i] < 0.5F ? 3e-6F : 1e-6F;
  shade_relief *r = relief_of(f, 0);
  shade_relief_whole(r, whole);
  assert_near(whole[2], 0.32 / 4, 2e-3);
  shade_relief_free(r);

  const float wrong[3] = {NAN, INFINITY, -INFINITY};
  float *const numbers[5] = {f->u, f->v, f->x, f->y, f->weight};
  for (int i = 0; i < MANY; i++)
    f->weight[i] = 1;
  for (int i = 0; i < MANY / 2; i++) { /* all of it at points of its own */
    numbers[i % 5][i] = wrong[i % 3];
    if (i % 7 == 0)
      f->weight[i] = -1;
    if (i % 5 < 2) /* were they counted it would show */
      f->x[i] = 30;
  }
  r = relief_of(f, 0);
  shade_relief_whole(r, whole);
  for (int k = 0; k < 5; k++)
    assert_near(whole[k], half_of_all[k], 3e-3);
  half_flat_at(r, 0, 1);
  shade_relief_free(r);
  free(f);
}

/* One long wave under noise. */
static void shape_with_noise(double u, double v, uint64_t *seed, double s[2]) {
  s[0] = 0.7 * sin(2 * PI * u) + 0.6 * (uniform(seed) - 0.5);
  s[1] = 0.2 + 0.5 * cos(2 * PI * v) + 0.3 * (uniform(seed) - 0.5);
}
static void long_waves_are_a_shape(void **state) {
  (void)state;
  field *f = look(shape_with_noise, 0, 1);
  shade_relief *r = relief_of(f, 1);
  const double wanted[5] = {0, 0.2, 0.03, 0, 0.0075};
  double whole[5];
  float s[5];
  shade_relief_whole(r, whole);
  for (int k = 0; k < 5; k++)
    assert_near(whole[k], wanted[k], 6e-3);
  for (int i = 0; i < 40; i++) {
    const double u = 0.1 + 0.8 * fmod(0.61803 * i, 1), v = 0.1 + 0.8 * fmod(0.7549 * i, 1);
    place(r, u, v, s);
    assert_near((double)s[0], 0.7 * sin(2 * PI * u), 0.05);
    assert_near((double)s[1], 0.2 + 0.5 * cos(2 * PI * v), 0.05);
    assert_near((double)s[2], 0.03, 0.012);
    assert_near((double)s[4], 0.0075, 0.006);
  }
  shade_relief_free(r);

  /* the same as a relief is even, and has all of it */
  r = relief_of(f, 0);
  shade_relief_whole(r, whole);
  assert_near(whole[2], 0.03 + 0.245, 6e-3);
  shade_relief_free(r);
  free(f);
}

static void nothing_is_flat(void **state) {
  (void)state;
  const float zero[2] = {0, 0}, wrong[2] = {NAN, NAN};
  for (int k = 0; k < 4; k++) {
    const float *const x = k == 3 ? wrong : zero;
    shade_relief *r = k == 0   ? shade_relief_create(0, zero, zero, zero, zero, NULL, 0)
                      : k == 1 ? shade_relief_create(2, zero, zero, zero, NULL, NULL, 1)
                               : shade_relief_create(2, zero, zero, x, zero, NULL, k == 2);
    assert_non_null(r);
    double whole[5] = {9, 9, 9, 9, 9};
    float s[5];
    assert_true(shade_relief_whole(r, whole) == 0);
    place(r, 0.5, 0.5, s);
    for (int i = 0; i < 5; i++)
      assert_true(whole[i] == 0 && s[i] == 0);
    shade_relief_free(r);
  }
  shade_relief_free(NULL);
}
static void a_place_may_be_anything(void **state) {
  (void)state;
  field *f = look(half_rippled, 0, 1);
  shade_relief *r = relief_of(f, 0);
  const float at[6] = {NAN, INFINITY, -INFINITY, 1e30F, -1e-20F, 16777217.0F};
  for (int i = 0; i < 36; i++) {
    float s[5];
    place(r, (double)at[i % 6], (double)at[i / 6], s);
    for (int k = 0; k < 5; k++)
      assert_true(s[k] >= 0 && s[k] < 1);
    if (i % 6 < 3 || i / 6 < 3)
      assert_slopes(s, half_of_all, 2e-3);
  }

  /* of several places, those that are wanted */
  enum { PLACES = 5 };
  const float u[PLACES] = {0.25F, 0.75F, 0.1F, 0.9F, 0.75F},
              v[PLACES] = {0.5F, 0.5F, 0.1F, 0.2F, 0};
  float x[PLACES + 1], yy[PLACES + 1], s[5];
  x[PLACES] = yy[PLACES] = -7;
  float *const to[5] = {x, NULL, NULL, NULL, yy};
  shade_relief_lookup_batchf(r, PLACES, u, v, to);
  for (int i = 0; i < PLACES; i++) {
    place(r, (double)u[i], (double)v[i], s);
    assert_true(x[i] == s[0] && yy[i] == s[4]);
  }
  assert_true(x[PLACES] == -7 && yy[PLACES] == -7);
  shade_relief_free(r);
  free(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(even_bumps_have_the_moment_of_all),
      cmocka_unit_test(flat_places_are_flat),
      cmocka_unit_test(edges_are_no_neighbours),
      cmocka_unit_test(a_small_square_has_windows_of_its_own),
      cmocka_unit_test(more_than_a_period_lies_on_itself),
      cmocka_unit_test(few_points_say_less),
      cmocka_unit_test(points_count_by_their_weight),
      cmocka_unit_test(long_waves_are_a_shape),
      cmocka_unit_test(nothing_is_flat),
      cmocka_unit_test(a_place_may_be_anything),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
