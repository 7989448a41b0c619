/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.6 */
/*
 * Shadows of yarns on one another: a cloth takes what falls on it and no more, and ends in no line
 * where light grazes.
 */
#include "cloth.h"

#include "reference/cloth.h"

static const double ABOVE[3] = {0, 0, 1}, WIDE[2] = {1e6, 1e6};

/* White, matt, without occlusion: pi s towards an eye above is what the yarns take. */
static void white(shade_preset *p) {
  p->yarns.occlusion = SHADE_OCCLUSION_NONE;
  p->fabric.nap = 0;
  for (int c = 0; c < 3; c++) {
    p->fabric.warp.f0[c] = p->fabric.weft.f0[c] = 0;
    p->fabric.warp.kd[c] = p->fabric.weft.kd[c] = p->fabric.backing[c] = 1;
  }
  p->fabric.warp.diffuse = p->fabric.weft.diffuse = SHADE_DIFFUSE_LAMBERT;
  p->fabric.draft_colors = 0;
}

/* The mean over points of what is sent up, times pi: no more than what is taken. */
static double sent(const shade_fabric *f, const double wi[3]) {
  enum { POINTS = 1000 };
  double sum = 0;
  for (int k = 0; k < POINTS; k++) {
    const double uv[2] = {640 * fmod(0.5 + k * 0.7548776662466927, 1),
                          640 * fmod(0.5 + k * 0.5698402909980532, 1)};
    double s[3];
    shade_fabric_eval(f, uv, NULL, NULL, wi, ABOVE, SHADE_TIER_NEAR, s);
    sum += PI * s[1] / POINTS;
  }
  return sum;
}

static void no_more_than_falls(void **state) {
  (void)state;
  shade_preset p;
  for (int row = 0, cloths = 0; shade_preset_row(row, &p); row++) {
    if (p.kind != SHADE_PRESET_FABRIC || cloths++ % FEWER != 0)
      continue;
    shade_weave *weave;
    white(&p);
    shade_fabric *f = shade_preset_fabric(&p, &weave, NULL);
    p.fabric.shadows = 0;
    shade_fabric *alone = shade_fabric_create(weave, &p.fabric, NULL);
    double most = 0, least = 1, before = 0;
    for (int k = 0; k < 16; k++) {
      double wi[3];
      spherical((60 + 7.4 * (k / 4)) * PI / 180, (k % 4 + 0.2) * PI / 2, wi); /* to 82 degrees */
      const double share = sent(f, wi) / wi[2];
      most = fmax(most, share);
      least = fmin(least, share);
      before = fmax(before, sent(alone, wi) / wi[2]);
    }
    print_message("%-18s sends %.3f to %.3f of what falls on it, without shadows to %.3f\n", p.word,
                  least, most, before);
    assert_true(most < 1.03); /* tilts are not spread quite evenly */
    assert_true(
        least >
        0.65); /* the yarns' surfaces mirror the rest: charmeuse, the flattest, .687 without */
    shade_fabric_free(alone);
    shade_fabric_free(f);
    shade_weave_free(weave);
  }
}

/* Towards the terminator s goes to 0 with the light, near, far and single. */
static void no_line(void **state) {
  (void)state;
  cloth c = open_cloth("linen", NULL);
  for (int tier = SHADE_TIER_NEAR; tier <= SHADE_TIER_SINGLE; tier++)
    for (int k = 0; k < 60; k++) {
      double wi[3], s[3], uv[2] = {0.37 * k, 0.59 * k};
      spherical((90 - 0.1) * PI / 180, 0.7 * k, wi);
      const double *wide = tier == SHADE_TIER_NEAR ? NULL : WIDE, wo[3] = {0.3, 0.1, sqrt(0.9)};
      shade_fabric_eval(c.fabric, uv, wide, NULL, wi, wo, (shade_fabric_tier)tier, s);
      assert_true(s[0] >= 0 && s[0] < 10 * wi[2]);
      /* also on a fold, all round it, just over its own horizon */
      const double side = hypot(FOLD[0], FOLD[1]), x[3] = {FOLD[1] / side, -FOLD[0] / side, 0};
      const double y[3] = {FOLD[1] * x[2] - FOLD[2] * x[1], FOLD[2] * x[0] - FOLD[0] * x[2],
                           FOLD[0] * x[1] - FOLD[1] * x[0]};
      double size = 0;
      for (int a = 0; a < 3; a++) {
        wi[a] = cos(0.7 * k) * x[a] + sin(0.7 * k) * y[a] + 0.002 * FOLD[a];
        size += wi[a] * wi[a];
      }
      for (int a = 0; a < 3; a++)
        wi[a] /= sqrt(size);
      shade_fabric_eval(c.fabric, uv, wide, FOLD, wi, wo, (shade_fabric_tier)tier, s);
      assert_true(s[0] >= 0 && s[0] < 10 * n_dot(FOLD, wi));
    }
  close_cloth(&c);
}

/* Light from high up meets no shadows where yarns lean to no side. */
static void high_light_is_as_before(void **state) {
  (void)state;
  shade_preset p;
  assert_true(shade_preset_find("linen", &p));
  shade_weave *weave;
  shade_fabric *f = shade_preset_fabric(&p, &weave, NULL);
  p.fabric.shadows = 0;
  shade_fabric *alone = shade_fabric_create(weave, &p.fabric, NULL);
  for (int k = 0; k < 100; k++) {
    const double uv[2] = {0.37 * k, 0.59 * k}, wo[3] = {0.3, 0.1, sqrt(0.9)};
    double wi[3], s[3], want[3];
    spherical(35 * PI / 180, k, wi);
    shade_fabric_eval(f, uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, s);
    shade_fabric_eval(alone, uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, want);
    for (int a = 0; a < 3; a++)
      assert_near(s[a], want[a], 0.01 * want[a]);
  }
  shade_fabric_free(alone);
  shade_fabric_free(f);
  shade_weave_free(weave);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(no_more_than_falls),
                                     cmocka_unit_test(no_line),
                                     cmocka_unit_test(high_light_is_as_before)};
  return cmocka_run_group_tests_name("fabric shadow", tests, NULL, NULL);
}
