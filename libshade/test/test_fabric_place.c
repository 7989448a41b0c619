/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.3 */
/*
 * Cloth by place, on an asymmetric draft of threads of many colours, without tilt or gloss: what a
 * footprint shows is the share of each thread in it, which is plain geometry. And what the single
 * lobe makes of tilts along and across.
 */
#include <string.h>

#include "support.h"
#include "shade/fabric.h"
#include "shade/weave.h"

enum { ENDS = 5, PICKS = 3 };
/* from the first pick up; no symmetry takes it to itself */
static const unsigned char UP[PICKS][ENDS] = {{1, 0, 0, 1, 0}, {1, 1, 0, 0, 1}, {0, 1, 0, 1, 1}};

typedef struct cloth {
  shade_draft *draft;
  shade_weave *weave;
  shade_fabric *fabric;
} cloth;

static double end_color(int end) {
  return 0.1 + 0.17 * end;
}
static double pick_color(int pick) {
  return 0.95 - 0.28 * pick;
}

/* A draft's colours are sRGB. */
static double linear(double c) {
  return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/* A cloth without tilt or gloss that is uneven as `w` says, in a draft's colours or white, times
 * kd. */
static cloth uneven_cloth(shade_weave_params w, int draft_colors, const double kd[3]) {
  cloth c;
  c.draft = shade_draft_from_matrix(ENDS, PICKS, &UP[0][0]);
  for (int i = 0; i < ENDS; i++) {
    const double rgb[3] = {end_color(i), 0.5, i == 2};
    memcpy(c.draft->warp[i].color, rgb, sizeof rgb);
  }
  for (int j = 0; j < PICKS; j++) {
    const double rgb[3] = {pick_color(j), 0.5, 0};
    memcpy(c.draft->weft[j].color, rgb, sizeof rgb);
  }
  w.occlusion = SHADE_OCCLUSION_NONE;
  w.warp.curve = w.weft.curve = w.warp.ridge = w.weft.ridge = 0;
  c.weave = shade_weave_create(c.draft, &w, NULL);
  shade_fabric_params p;
  shade_fabric_params_init(&p);
  p.draft_colors = draft_colors;
  for (int k = 0; k < 3; k++) {
    p.warp.f0[k] = p.weft.f0[k] = 0;
    p.warp.kd[k] = p.weft.kd[k] = kd[k];
  }
  p.warp.diffuse = p.weft.diffuse = SHADE_DIFFUSE_LAMBERT;
  unsigned status = 0;
  c.fabric = shade_fabric_create(c.weave, &p, &status);
  assert_non_null(c.fabric);
  assert_int_equal(status, SHADE_OK);
  return c;
}

static cloth flat_cloth(void) {
  shade_weave_params w;
  shade_weave_params_init(&w);
  return uneven_cloth(w, 1, (double[3]){1, 1, 1});
}

static void close_cloth(cloth *c) {
  shade_fabric_free(c->fabric);
  shade_weave_free(c->weave);
  shade_draft_free(c->draft);
}

/* Reflectance, red and blue, of a footprint about uv, at normal incidence. */
static void shown(const cloth *c, const double uv[2], const double footprint[2],
                  shade_fabric_tier tier, double rgb[3]) {
  const double z[3] = {0, 0, 1}, wo[3] = {0.6, 0, 0.8};
  assert_int_equal(shade_fabric_eval(c->fabric, uv, footprint, NULL, z, wo, tier, rgb), SHADE_OK);
  /* Lambert with what Fresnel lets in and out, by the thread of even colour */
  for (int k = 0; k < 3; k += 2)
    rgb[k] *= linear(0.5) / rgb[1];
}

/* The same by geometry: overlaps of the rectangle with the crossings. */
static void by_hand(const double uv[2], const double footprint[2], double rgb[3]) {
  double sum = 0;
  rgb[0] = rgb[2] = 0;
  const double u0 = uv[0] - footprint[0] / 2, u1 = uv[0] + footprint[0] / 2;
  const double v0 = uv[1] - footprint[1] / 2, v1 = uv[1] + footprint[1] / 2;
  for (int j = (int)floor(v0); j <= (int)floor(v1); j++)
    for (int i = (int)floor(u0); i <= (int)floor(u1); i++) {
      const double area = (fmin(u1, i + 1) - fmax(u0, i)) * (fmin(v1, j + 1) - fmax(v0, j));
      const int end = ((i % ENDS) + ENDS) % ENDS, pick = ((j % PICKS) + PICKS) % PICKS;
      if (!(area > 0))
        continue;
      sum += area;
      rgb[0] += area * linear(UP[pick][end] ? end_color(end) : pick_color(pick));
      rgb[2] += area * (UP[pick][end] && end == 2);
    }
  rgb[0] /= sum;
  rgb[2] /= sum;
}

/* Without a footprint, each crossing shows its thread. */
static void near_shows_its_thread(void **state) {
  (void)state;
  cloth c = flat_cloth();
  for (int j = -4; j < 7; j++)
    for (int i = -6; i < 11; i++) {
      const double uv[2] = {i + 0.3, j + 0.8}, point[2] = {1e-9, 1e-9}, none[2] = {0, 0};
      double got[3], want[3];
      by_hand(uv, point, want);
      shown(&c, uv, none, SHADE_TIER_AUTO, got);
      assert_near(got[0], want[0], 1e-4);
      assert_near(got[2], want[2], 1e-4);
    }
  close_cloth(&c);
}

static const double FOOTPRINTS[][2] = {{2.5, 0.3}, {0.3, 2.5}, {7, 0.15}, {0.15, 7}, {3, 2.2},
                                       {2.2, 3.1}, {11, 1.3},  {1.3, 11}, {40, 0.4}, {0.4, 40}};

/* Far, elongated and off centre; the table's blocks are a small part of a crossing. */
static void far_shows_the_share_of_each(void **state) {
  (void)state;
  cloth c = flat_cloth();
  double worst = 0, spread = 0;
  for (size_t f = 0; f < sizeof FOOTPRINTS / sizeof FOOTPRINTS[0]; f++)
    for (int k = 0; k < 60; k++) {
      const double uv[2] = {40 * fmod(k * 0.7548776662466927, 1) - 20,
                            40 * fmod(k * 0.5698402909980532, 1) - 20};
      double got[3], want[3], all[3];
      by_hand(uv, FOOTPRINTS[f], want);
      shown(&c, uv, FOOTPRINTS[f], k % 2 ? SHADE_TIER_FAR : SHADE_TIER_AUTO, got);
      shown(&c, uv, (double[2]){1e6, 1e6}, SHADE_TIER_AUTO, all);
      for (int channel = 0; channel < 3; channel += 2) {
        worst = fmax(worst, fabs(got[channel] - want[channel]));
        spread = fmax(spread, fabs(all[channel] - want[channel]));
      }
    }
  print_message("far by place: worst %.4f, where the mean of all is off by %.3f\n", worst, spread);
  assert_true(worst < 1e-3 && spread > 0.3);
  close_cloth(&c);
}

/* Any place whose crossing's edges are `margin` away. */
static void inside_a_crossing(int k, double margin, double uv[2]) {
  const double step[2] = {0.7548776662466927, 0.5698402909980532};
  for (int axis = 0; axis < 2; axis++) {
    const double at = 40 * fmod(k * step[axis], 1);
    uv[axis] = floor(at) - 20 + margin + (1 - 2 * margin) * (at - floor(at));
  }
}

/* Near in a footprint: the mean of 16 points, all of them along a narrow one. */
static void near_spreads_its_points_along_the_footprint(void **state) {
  (void)state;
  cloth c = flat_cloth();
  static const double near[][2] = {{0.7, 0.02}, {0.02, 0.7}, {0.5, 0.5}};
  static const double bound[] = {0.03, 0.03, 0.15}; /* half a step of 16 and of 4, and the corner */
  for (size_t f = 0; f < sizeof near / sizeof near[0]; f++) {
    double worst = 0, spread = 0;
    for (int k = 0; k < 400; k++) {
      double uv[2], got[3], want[3], at[3];
      inside_a_crossing(k, 0.02, uv);
      by_hand(uv, near[f], want);
      shown(&c, uv, near[f], SHADE_TIER_AUTO, got);
      shown(&c, uv, (double[2]){0, 0}, SHADE_TIER_AUTO, at);
      worst = fmax(worst, fabs(got[0] - want[0]));
      spread = fmax(spread, fabs(at[0] - want[0]));
    }
    print_message("near in %.2f x %.2f: worst %.3f, one point %.3f\n", near[f][0], near[f][1],
                  worst, spread);
    assert_true(worst < bound[f] && spread > 0.3);
  }
  close_cloth(&c);
}

/* Between near and far both are near the truth, so the blend is too, at every share. */
static void a_blend_is_of_the_same_place(void **state) {
  (void)state;
  cloth c = flat_cloth();
  for (int turned = 0; turned < 2; turned++) {
    double worst = 0;
    for (double longer = 0.76; longer < 2; longer *= 1.1)
      for (int k = 0; k < 100; k++) {
        const double footprint[2] = {turned ? 0.02 : longer, turned ? longer : 0.02};
        double uv[2], got[3], want[3];
        inside_a_crossing(k, 0.02, uv);
        by_hand(uv, footprint, want);
        shown(&c, uv, footprint, SHADE_TIER_AUTO, got);
        worst = fmax(worst, fabs(got[0] - want[0]));
      }
    print_message("blended: worst %.3f\n", worst);
    assert_true(worst < 0.03);
  }
  close_cloth(&c);
}

/*
 * Yarns brighter than others: streaks where they are, not where they are not. One kind of
 * unevenness alone shows as well, seen along its yarns.
 */
static void streaks_lie_where_the_bright_yarns_are(void **state) {
  (void)state;
#define PART(side, part) offsetof(shade_weave_params, side.part)
  static const struct {
    size_t part[2];
    double footprint[2], bound;
  } rows[] = {
      /* each yarn is there; what hides it is known by the crossing alone */
      {{PART(warp, vary_brightness), PART(weft, vary_brightness)}, {0.3, 4}, 0.25},
      {{PART(warp, vary_brightness), PART(weft, vary_brightness)}, {4, 0.3}, 0.25},
      {{PART(warp, vary_brightness), PART(weft, vary_brightness)}, {0.3, 7.5}, 0.25},
      {{PART(warp, vary_brightness), PART(weft, vary_brightness)}, {7.5, 0.3}, 0.25},
      {{PART(warp, vary_brightness), PART(warp, vary_brightness)}, {0.3, 4}, 0.25},
      {{PART(weft, vary_brightness), PART(weft, vary_brightness)}, {4, 0.3}, 0.25},
      /* where in its footprint a yarn is bright is not known */
      {{PART(warp, along_brightness), PART(warp, along_brightness)}, {0.3, 4}, 0.5},
      {{PART(weft, along_brightness), PART(weft, along_brightness)}, {4, 0.3}, 0.5},
  };
#undef PART
  for (size_t f = 0; f < sizeof rows / sizeof rows[0]; f++) {
    const double *footprint = rows[f].footprint, bound = rows[f].bound;
    shade_weave_params w;
    shade_weave_params_init(&w);
    for (int k = 0; k < 2; k++)
      *(double *)(void *)((char *)&w + rows[f].part[k]) = 0.8;
    cloth c = uneven_cloth(w, 1, (double[3]){0.5, 0.5, 0.5});
    double with = 0, without = 0;
    for (int k = 0; k < 200; k++) {
      const double uv[2] = {500 * fmod(k * 0.7548776662466927, 1),
                            500 * fmod(k * 0.5698402909980532, 1)};
      const double z[3] = {0, 0, 1};
      double far[3], mean = 0;
      assert_int_equal(shade_fabric_eval(c.fabric, uv, footprint, NULL, z, z, SHADE_TIER_FAR, far),
                       SHADE_OK);
      enum { N = 24 };
      for (int i = 0; i < N * N; i++) { /* the near model's mean over the same place */
        const double at[2] = {uv[0] + footprint[0] * ((i % N + 0.5) / N - 0.5),
                              uv[1] + footprint[1] * ((i / N + 0.5) / N - 0.5)};
        double s[3];
        shade_fabric_eval(c.fabric, at, NULL, NULL, z, z, SHADE_TIER_NEAR, s);
        mean += s[1] / (N * N);
      }
      double even[3];
      shade_fabric_eval(c.fabric, uv, (double[2]){1e6, 1e6}, NULL, z, z, SHADE_TIER_FAR, even);
      with += (far[1] - mean) * (far[1] - mean);
      without += (even[1] - mean) * (even[1] - mean);
    }
    print_message("streaks in %.1f x %.1f: off by %.2f of what they are\n", footprint[0],
                  footprint[1], sqrt(with / without));
    assert_true(with < bound * bound * without);
    close_cloth(&c);
  }
}

/*
 * A yarn sends on kd times its brightness, which is even in 1 - v to 1 + v, of the light, but no
 * more than all of it: the mean of min(kd b, 1), near and from afar, in each channel by its own kd.
 */
static void bright_yarns_are_no_brighter_than_white(void **state) {
  (void)state;
  enum { POINTS = 20000 };
  const double v = 0.8, kd[3] = {0.4, 0.8, 1}, z[3] = {0, 0, 1}, all[2] = {1e6, 1e6};
  shade_weave_params w;
  shade_weave_params_init(&w);
  cloth even = uneven_cloth(w, 0, (double[3]){1, 1, 1});
  w.warp.vary_brightness = w.weft.vary_brightness = v;
  cloth c = uneven_cloth(w, 0, kd);
  double white[3], far[3], near[3] = {0};
  shade_fabric_eval(even.fabric, z, all, NULL, z, z, SHADE_TIER_FAR, white);
  shade_fabric_eval(c.fabric, z, all, NULL, z, z, SHADE_TIER_FAR, far);
  for (int k = 0; k < POINTS; k++) {
    const double uv[2] = {1e5 * fmod(k * 0.7548776662466927, 1),
                          1e5 * fmod(k * 0.5698402909980532, 1)};
    double s[3];
    shade_fabric_eval(c.fabric, uv, NULL, NULL, z, z, SHADE_TIER_NEAR, s);
    for (int j = 0; j < 3; j++)
      near[j] += s[j] / POINTS;
  }
  for (int j = 0; j < 3; j++) {
    const double low = kd[j] * (1 - v), high = kd[j] * (1 + v), cut = fmin(high, 1);
    const double want = ((cut * cut - low * low) / 2 + (high - cut)) / (high - low);
    print_message("kd %.1f: near %.4f, far %.4f, by hand %.4f\n", kd[j], near[j] / white[j],
                  far[j] / white[j], want);
    assert_near(near[j] / white[j], want, 0.01);
    assert_near(far[j] / white[j], want, 0.01);
  }
  close_cloth(&even);
  close_cloth(&c);
}

/* Weft only, tilted along or across it, and matt: how the single lobe darkens at low light. */
static void a_single_lobe_knows_along_from_across(void **state) {
  (void)state;
  for (int across = 0; across < 2; across++) {
    shade_draft *draft = shade_draft_from_pattern(SHADE_WEFT_ONLY, 0, 0);
    shade_weave_params w;
    shade_weave_params_init(&w);
    w.occlusion = SHADE_OCCLUSION_NONE;
    w.weft.curve = across ? 0.9 : 0;
    w.weft.ridge = across ? 0 : 0.9;
    w.weft.segments = 7;
    w.weft.slant = 0;
    shade_weave *weave = shade_weave_create(draft, &w, NULL);
    shade_fabric_params p;
    shade_fabric_params_init(&p);
    p.weft.diffuse = SHADE_DIFFUSE_LAMBERT;
    for (int k = 0; k < 3; k++)
      p.weft.f0[k] = 0;
    shade_fabric *fabric = shade_fabric_create(weave, &p, NULL);
    double single[2];
    for (int side = 0; side < 2; side++) { /* light from along u, from along v */
      double wi[3], s[3];
      const double wo[3] = {0, 0, 1}, uv[2] = {0.5, 0.5};
      spherical(80 * PI / 180, side * PI / 2, wi);
      shade_fabric_eval(fabric, uv, NULL, NULL, wi, wo, SHADE_TIER_SINGLE, s);
      single[side] = s[0];
    }
    print_message("%s: single %.4f %.4f\n", across ? "across" : "along", single[0], single[1]);
    /* half of the tilts turn away from the light that they are steep against */
    assert_true(single[across] < 0.75 * single[1 - across]);
    shade_fabric_free(fabric);
    shade_weave_free(weave);
    shade_draft_free(draft);
  }
}

/*
 * Beckmann's single lobe: alpha^2 is the yarn's own and twice the variance of the tilt, which is
 * uniform: c^2/3. Where light and eye are one, f cos is D(h) F/4, and D's logarithm says alpha.
 */
static void a_single_lobe_is_as_wide_as_tilt_and_alpha(void **state) {
  (void)state;
  shade_draft *draft = shade_draft_from_pattern(SHADE_WEFT_ONLY, 0, 0);
  shade_weave_params w;
  shade_weave_params_init(&w);
  w.occlusion = SHADE_OCCLUSION_NONE;
  w.weft.curve = 0.12;
  w.weft.ridge = 0.06;
  w.weft.segments = 7;
  shade_weave *weave = shade_weave_create(draft, &w, NULL);
  shade_fabric_params p;
  shade_fabric_params_init(&p);
  p.mdf = SHADE_MDF_BECKMANN;
  p.weft.along = 500;
  p.weft.across = 200;
  for (int k = 0; k < 3; k++)
    p.weft.kd[k] = 0;
  shade_fabric *fabric = shade_fabric_create(weave, &p, NULL);
  const double own[2] = {500, 200}, tilt[2] = {0.06, 0.12}, uv[2] = {0.5, 0.5}, z[3] = {0, 0, 1};
  double peak[3];
  shade_fabric_eval(fabric, uv, NULL, NULL, z, z, SHADE_TIER_SINGLE, peak);
  for (int k = 0; k < 2; k++) {
    double h[3], s[3];
    spherical(0.1, k * PI / 2, h);
    shade_fabric_eval(fabric, uv, NULL, NULL, h, h, SHADE_TIER_SINGLE, s);
    const double tan2 = tan(0.1) * tan(0.1);
    const double alpha2 = tan2 / log(peak[0] / (s[0] * pow(cos(0.1), 4)));
    const double want = 2 / (own[k] + 2) + 2 * tilt[k] * tilt[k] / 3;
    print_message("alpha^2 %.5f, by hand %.5f\n", alpha2, want);
    assert_near(alpha2 / want, 1, 0.03);
  }
  shade_fabric_free(fabric);
  shade_weave_free(weave);
  shade_draft_free(draft);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(near_shows_its_thread),
      cmocka_unit_test(far_shows_the_share_of_each),
      cmocka_unit_test(near_spreads_its_points_along_the_footprint),
      cmocka_unit_test(a_blend_is_of_the_same_place),
      cmocka_unit_test(streaks_lie_where_the_bright_yarns_are),
      cmocka_unit_test(bright_yarns_are_no_brighter_than_white),
      cmocka_unit_test(a_single_lobe_knows_along_from_across),
      cmocka_unit_test(a_single_lobe_is_as_wide_as_tilt_and_alpha),
  };
  return cmocka_run_group_tests_name("fabric_place", tests, NULL, NULL);
}
