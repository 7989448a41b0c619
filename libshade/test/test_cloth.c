/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 6.4 */
/*
 * Cloth against the reference, which writes the look-up and the shading again from the documents:
 * random drafts, yarns, materials, places and folds, and every preset.
 */
#include "support.h"

#include <string.h>

#include "reference/cloth.h"
#include "shade/presets.h"

static uint64_t seed = 1;

static double random_number(void) {
  return uniform(&seed);
}
static double between(double low, double high) {
  return low + (high - low) * random_number();
}
static int below(int count) {
  return (int)(random_number() * count);
}
/* Often off, else within a range. */
static double maybe(double low, double high) {
  return below(2) ? between(low, high) : 0;
}

/* ---- random cloths ----------------------------------------------------------------------- */

static shade_draft *random_draft(void) {
  static const char *const names[] = {"plain", "twill_3_1", "herringbone", "satin_8", "basket"};
  shade_draft *d = below(2)   ? shade_draft_named(names[below(5)])
                   : below(2) ? shade_draft_from_pattern(1 + below(6), below(6), below(9) - 4)
                              : shade_draft_create(1 + below(9), 1 + below(9));
  assert_non_null(d);
  if (below(3) == 0)
    for (int i = 0; i < d->ends * d->picks; i++)
      d->warp_up[i] = (unsigned char)below(2);
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < (k ? d->ends : d->picks); i++) {
      shade_thread *t = k ? &d->warp[i] : &d->weft[i];
      for (int c = 0; c < 3; c++)
        t->color[c] = random_number();
      t->thickness = below(3) ? between(0.02, 0.06) : 0;
      t->spacing = below(3) ? between(0.05, 0.09) : 0;
    }
  return d;
}

static void random_yarn(shade_yarn_params *y) {
  y->width = between(0.3, 1);
  y->gap = maybe(0, 0.6);
  y->curve = maybe(0, 0.98);
  y->ridge = maybe(0, 0.5);
  y->slant = between(-2, 2);
  y->segments = maybe(0.2, 6);
  y->fibre = maybe(-1.5, 1.5);
  y->crimp = maybe(0, 0.7);
  y->crimp_length = between(0.05, 3);
  y->vary_brightness = maybe(0, 1);
  y->vary_tilt = maybe(0, 0.3);
  y->along_brightness = maybe(0, 1);
  y->along_tilt = maybe(0, 0.3);
  y->slub = maybe(0, 1);
  y->along_length = between(0.3, 8);
  y->fuzz = maybe(0, 1);
}

static void random_yarn_material(shade_yarn *y) {
  y->along = pow(10, between(0, 3));
  y->across = pow(10, between(0, 2));
  y->diffuse = (shade_diffuse)below(SHADE_DIFFUSE_POULIN_FOURNIER);
  for (int c = 0; c < 3; c++) {
    y->f0[c] = random_number();
    y->kd[c] = random_number();
  }
}

typedef struct cloth {
  shade_draft *draft;
  shade_weave *weave;
  shade_fabric *fabric;
  shade_ref_cloth reference;
} cloth;

static void close_cloth(cloth *c) {
  shade_fabric_free(c->fabric);
  shade_weave_free(c->weave);
  shade_draft_free(c->draft);
}

static cloth make_cloth(shade_draft *draft, const shade_weave_params *w,
                        const shade_fabric_params *f) {
  unsigned status = SHADE_OK;
  cloth c = {.draft = draft, .weave = shade_weave_create(draft, w, &status)};
  assert_non_null(c.weave);
  c.fabric = shade_fabric_create(c.weave, f, &status);
  assert_non_null(c.fabric);
  assert_int_equal(status, SHADE_OK);
  c.reference = shade_ref_cloth_of(draft, w, f);
  return c;
}

static cloth random_cloth(void) {
  shade_weave_params w;
  shade_fabric_params f;
  shade_weave_params_init(&w);
  shade_fabric_params_init(&f);
  random_yarn(&w.warp);
  random_yarn(&w.weft);
  w.occlusion = (shade_occlusion)below(SHADE_OCCLUSION_COUNT);
  w.seed = (uint32_t)below(1 << 30);
  f.mdf = (shade_mdf)below(SHADE_MDF_COUNT);
  f.brdf = (shade_brdf)below(SHADE_BRDF_COUNT);
  f.detail = (shade_detail)below(SHADE_DETAIL_COUNT);
  random_yarn_material(&f.warp);
  random_yarn_material(&f.weft);
  f.draft_colors = below(2);
  f.shadows = below(2);
  for (int k = 0; k < 3; k++) {
    f.backing[k] = random_number();
    f.nap_color[k] = random_number();
  }
  f.nap = maybe(0, 1);
  f.horizon = (shade_horizon)below(SHADE_HORIZON_COUNT);
  const int transmits = below(4); /* one bit a yarn */
  for (int k = 0; k < 3; k++) {
    f.warp_transmit[k] = transmits & 1 ? random_number() : 0;
    f.weft_transmit[k] = transmits & 2 ? random_number() : 0;
  }
  return make_cloth(random_draft(), &w, &f);
}

static int preset_cloth(int row, cloth *c) {
  shade_preset p;
  for (int k = 0; shade_preset_row(k, &p); k++)
    if (p.kind == SHADE_PRESET_FABRIC && row-- == 0) {
      *c = make_cloth(shade_draft_named(p.weave), &p.yarns, &p.fabric);
      return 1;
    }
  return 0;
}

/* ---- places -------------------------------------------------------------------------------- */

static void random_direction(double most, double v[3]) {
  spherical(acos(1 - (1 - cos(most)) * random_number()), 2 * PI * random_number(), v);
}

static void random_place(double uv[2], double n[3], double wi[3], double wo[3]) {
  uv[0] = between(-40, 40);
  uv[1] = between(-40, 40);
  random_direction(1.1, n);
  random_direction(1.45, wi);
  random_direction(1.45, wo);
}

static double largest(double a, double b) {
  return a > b ? a : b;
}

/* What the look-ups find, in one row of numbers; whole ones apart. */
enum { NUMBERS = 12 };
static void list_numbers(const shade_crossing *c, double x[NUMBERS]) {
  const double row[NUMBERS] = {c->sigma, c->along,    c->dx,        c->dy,
                               c->tx,    c->ty,       c->occlusion, c->brightness,
                               c->fuzz,  c->color[0], c->color[1],  c->color[2]};
  memcpy(x, row, sizeof row);
}
static int same_kind(const shade_crossing *a, const shade_crossing *b) {
  return a->top == b->top && a->swap == b->swap && a->below == b->below && a->yarn == b->yarn;
}

/*
 * An edge of a yarn or a ridge's, where rounding decides: the reference itself differs a little
 * beside the point.
 */
static int on_an_edge(const shade_ref_cloth *c, const double uv[2]) {
  shade_crossing at, beside;
  double x[NUMBERS], y[NUMBERS];
  shade_ref_crossing(c, uv[0], uv[1], &at);
  list_numbers(&at, x);
  for (int k = 0; k < 4; k++) {
    const double step = k % 2 ? 1e-8 : -1e-8;
    shade_ref_crossing(c, uv[0] + (k < 2 ? step : 0), uv[1] + (k < 2 ? 0 : step), &beside);
    list_numbers(&beside, y);
    if (!same_kind(&at, &beside))
      return 1;
    for (int i = 0; i < NUMBERS; i++)
      if (fabs(x[i] - y[i]) > 1e-4)
        return 1;
  }
  return 0;
}

static void look_up(void **state) {
  (void)state;
  int edges = 0, looks = 0, seen[3] = {0, 0, 0}, below_others = 0;
  double worst = 0;
  for (int row = 0; row < 120; row += FEWER) {
    cloth c = {0};
    if (!preset_cloth(row, &c))
      c = random_cloth();
    for (int k = 0; k < 300; k++) {
      double uv[2], n[3], wi[3], wo[3], x[NUMBERS], y[NUMBERS];
      shade_crossing at, want;
      random_place(uv, n, wi, wo);
      looks++;
      if (on_an_edge(&c.reference, uv)) {
        edges++;
        continue;
      }
      shade_weave_lookup(c.weave, uv[0], uv[1], &at);
      shade_ref_crossing(&c.reference, uv[0], uv[1], &want);
      assert_true(same_kind(&at, &want));
      list_numbers(&at, x);
      list_numbers(&want, y);
      for (int i = 0; i < NUMBERS; i++)
        worst = largest(worst, fabs(x[i] - y[i]));
      seen[want.top]++;
      below_others += want.below && want.top != SHADE_TOP_GAP;
    }
    close_cloth(&c);
  }
  print_message(
      "look-ups against the reference: %.1e over %d, %d of gaps, %d beside the upper yarn; "
      "%d on edges left out\n",
      worst, looks - edges, seen[SHADE_TOP_GAP], below_others, edges);
  assert_true(worst <= 1e-12);
  assert_true(edges < looks / 1000);
  for (int k = 0; k < 3; k++)
    assert_true(seen[k] > looks / 50);
  assert_true(below_others > looks / 50);
}

/* ---- near ------------------------------------------------------------------------------------ */

static void near_is_the_reference(void **state) {
  (void)state;
  double worst = 0;
  int lit = 0, points = 0;
  for (int row = 0; row < 120; row += FEWER) {
    cloth c = {0};
    if (!preset_cloth(row, &c))
      c = random_cloth();
    for (int k = 0; k < 200; k++) {
      double uv[2], n[3], wi[3], wo[3], s[3], want[3];
      random_place(uv, n, wi, wo);
      if (on_an_edge(&c.reference, uv))
        continue;
      const double *fold = k % 3 ? n : NULL;
      if (k % 4 == 0)
        wi[2] = -wi[2];
      const unsigned got = shade_fabric_eval(c.fabric, uv, NULL, fold, wi, wo, SHADE_TIER_NEAR, s);
      assert_int_equal(got, shade_ref_cloth_near(&c.reference, uv, fold, wi, wo, want));
      points++;
      lit += want[0] > 0;
      for (int i = 0; i < 3; i++) {
        double error = fabs(s[i] - want[i]) / fmax(fabs(want[i]), 1e-3);
        worst = largest(worst, error);
      }
    }
    close_cloth(&c);
  }
  print_message("near against the reference: %.1e over %d points, %d lit\n", worst, points, lit);
  assert_true(worst <= 1e-12);
  assert_true(lit > points / 3);
}

/* A footprint below a crossing is sixteen points, more of them along its longer side: of the same
 * places but for one in some hundred, which an edge goes through. */
static void footprints_are_points_of_near(void **state) {
  (void)state;
  int same = 0, footprints = 0;
  for (int row = 0; row < 60; row += FEWER) {
    cloth c = {0};
    if (!preset_cloth(row, &c))
      c = random_cloth();
    for (int k = 0; k < 60; k++) {
      double uv[2], n[3], wi[3], wo[3], s[3], want[3], off = 0;
      const double long_side = between(0.1, 0.75), short_side = long_side * between(0.02, 1);
      const double foot[2] = {k % 2 ? long_side : short_side, k % 2 ? short_side : long_side};
      random_place(uv, n, wi, wo);
      shade_fabric_eval(c.fabric, uv, foot, n, wi, wo, SHADE_TIER_AUTO, s);
      shade_ref_cloth_points(&c.reference, uv, foot, n, wi, wo, want);
      for (int i = 0; i < 3; i++)
        off = largest(off, fabs(s[i] - want[i]) / fmax(fabs(want[i]), 1e-3));
      footprints++;
      same += off <= 1e-9;
    }
    close_cloth(&c);
  }
  print_message("footprints against the reference: %d of %d\n", same, footprints);
  assert_true(same >= 0.99 * footprints);
}

/* From 3/4 of a crossing on the far model takes over, smoothly in the logarithm of the longer side:
 * half of it at sqrt 1.5, all of it at 2. */
static void near_passes_into_far(void **state) {
  (void)state;
  const double sides[] = {0.75, 0.9, 1.2247448713915890, 1.6, 2, 3}, half = sides[2];
  const double x = log(0.9 / 0.75) / log(2 / 0.75);
  assert_true(shade_ref_far_share((double[]){0.75, 0.1}) == 0);
  assert_true(fabs(shade_ref_far_share((double[]){half, half}) - 0.5) <= 1e-12);
  assert_true(fabs(shade_ref_far_share((double[]){0.9, 0.2}) - x * x * (3 - 2 * x)) <= 1e-12);
  assert_true(shade_ref_far_share((double[]){0.2, 2}) == 1);
  cloth c = {0};
  assert_true(preset_cloth(0, &c));
  int same = 0, footprints = 0;
  for (size_t k = 0; k < 6 * 20; k++) {
    double uv[2], n[3], wi[3], wo[3], s[3], points[3], far[3], off = 0;
    const double foot[2] = {sides[k % 6], sides[k % 6]};
    const double share = shade_ref_far_share(foot);
    random_place(uv, n, wi, wo);
    shade_fabric_eval(c.fabric, uv, foot, n, wi, wo, SHADE_TIER_AUTO, s);
    shade_fabric_eval(c.fabric, uv, foot, n, wi, wo, SHADE_TIER_FAR, far);
    shade_ref_cloth_points(&c.reference, uv, foot, n, wi, wo, points);
    for (int i = 0; i < 3; i++) {
      const double want = (1 - share) * points[i] + share * far[i];
      off = largest(off, fabs(s[i] - want) / fmax(fabs(want), 1e-3));
    }
    footprints++;
    same += off <= 1e-9;
  }
  close_cloth(&c);
  print_message("between near and far: %d of %d\n", same, footprints);
  assert_true(same >= 0.99 * footprints);
}

/*
 * The tier of one lobe each. What both measure of the weave, they measure by points of their own,
 * and noise per yarn differs from sample to sample: linen's shares by 1.3 %.
 */
static void single_is_the_reference(void **state) {
  (void)state;
  cloth c;
  for (int row = 0; preset_cloth(row, &c); row += FEWER) {
    const shade_ref_seen seen = shade_ref_cloth_seen(&c.reference, 1 << 16);
    shade_fabric_info info;
    shade_fabric_get_info(c.fabric, &info);
    const double share[2] = {info.weft_share, info.warp_share};
    const double *exponents[2] = {info.weft_single, info.warp_single};
    double worst = 0, worst_share = 0, worst_exponent = 0;
    for (int k = 0; k < 2; k++) {
      worst_share = largest(worst_share, fabs(seen.side[k].share / share[k] - 1));
      for (int i = 0; i < 2 && c.reference.fabric.mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY; i++)
        worst_exponent =
            largest(worst_exponent, fabs(seen.side[k].exponents[i] / exponents[k][i] - 1));
    }
    for (int k = 0; k < 400; k++) {
      double uv[2], n[3], wi[3], wo[3], s[3], want[3];
      random_place(uv, n, wi, wo);
      shade_fabric_eval(c.fabric, uv, NULL, n, wi, wo, SHADE_TIER_SINGLE, s);
      shade_ref_cloth_single(&c.reference, &seen, n, wi, wo, want);
      for (int i = 0; i < 3; i++)
        worst = largest(worst, fabs(s[i] - want[i]) / fmax(want[i], 0.02));
    }
    print_message("cloth %d: single %.1f %%, shares %.1f %%, exponents %.1f %%\n", row, 100 * worst,
                  100 * worst_share, 100 * worst_exponent);
    assert_true(worst <= 0.04);
    assert_true(worst_share <= 0.02);
    assert_true(worst_exponent <= 0.02);
    close_cloth(&c);
  }
}

/*
 * What the reference takes for far cloth: the mean of its near points over the footprint itself,
 * not over what the same part of the draft shows anywhere. Where yarns differ in brightness alone,
 * and none is hidden, that is the sum over the yarns, each by the part of the footprint that it
 * fills.
 */
static void mean_is_the_sum_over_yarns(void **state) {
  (void)state;
  enum { POINTS = 4096 / FEWER, PLACES = 16 };
  const double foot[2] = {3, 2.5}, wi[3] = {0.36, 0.48, 0.8}, wo[3] = {-0.48, 0, 0.877268};
  for (int warp = 0; warp < 2; warp++) {
    const unsigned char warp_up = (unsigned char)warp;
    shade_weave_params w;
    shade_fabric_params f;
    shade_weave_params_init(&w);
    shade_fabric_params_init(&f);
    shade_yarn_params *y = warp ? &w.warp : &w.weft;
    *y = (shade_yarn_params){
        .width = 1, .crimp_length = 1, .vary_brightness = 0.8, .along_length = 1};
    cloth c = make_cloth(shade_draft_from_matrix(1, 1, &warp_up), &w, &f);
    for (int k = 0; k < PLACES; k++) {
      const double uv[2] = {between(-500, 500), between(-500, 500)};
      const double across = uv[!warp] - foot[!warp] / 2, end = across + foot[!warp];
      double s[3], error[3], sum[3] = {0, 0, 0};
      for (double yarn = floor(across); yarn < end; yarn++) {
        const double part = (fmin(yarn + 1, end) - fmax(yarn, across)) / foot[!warp];
        const double at[2] = {warp ? yarn + 0.5 : uv[0], warp ? uv[1] : yarn + 0.5};
        double one[3];
        shade_ref_cloth_near(&c.reference, at, NULL, wi, wo, one);
        for (int i = 0; i < 3; i++)
          sum[i] += part * one[i];
      }
      shade_ref_cloth_mean(&c.reference, uv, foot, POINTS, NULL, wi, wo, s, error);
      for (int i = 0; i < 3; i++)
        assert_near(s[i], sum[i], error[i]); /* as the header has it */
    }
    close_cloth(&c);
  }
}

/*
 * The same of cloths with gaps, slubs and narrow highlights, by points drawn at random: of few
 * crossings, and of so many that evenly spread points fell on the same places of the weave.
 */
static void mean_is_of_the_footprint(void **state) {
  (void)state;
  enum { POINTS = 1024, DRAWN = 16384 / FEWER, PLACES = 8 };
  static const double feet[2][2] = {{3, 2}, {78.9266, 66.2834}};
  static const double wi[3] = {0.46146, 0.35178, 0.81441}, wo[3] = {-0.72752, -0.01368, 0.68595};
  for (int wide = 0; wide < 2; wide++) {
    cloth c;
    assert_true(preset_cloth(wide ? 7 : 4, &c)); /* shot taffeta; linen */
    double worst = 0;
    for (int k = 0; k < PLACES; k++) {
      const double uv[2] = {between(-500, 500), between(-500, 500)};
      double s[3], error[3], sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
      for (int i = 0; i < DRAWN; i++) {
        const double at[2] = {uv[0] + feet[wide][0] * between(-0.5, 0.5),
                              uv[1] + feet[wide][1] * between(-0.5, 0.5)};
        double one[3];
        shade_ref_cloth_near(&c.reference, at, NULL, wi, wo, one);
        for (int j = 0; j < 3; j++) {
          sum[j] += one[j] / DRAWN;
          squares[j] += one[j] * one[j] / DRAWN;
        }
      }
      shade_ref_cloth_mean(&c.reference, uv, feet[wide], POINTS, NULL, wi, wo, s, error);
      for (int j = 0; j < 3; j++) {
        const double doubt = hypot(error[j], sqrt((squares[j] - sum[j] * sum[j]) / DRAWN));
        worst = largest(worst, fabs(s[j] - sum[j]) / doubt);
      }
    }
    print_message("mean over %.0f x %.0f: at most %.1f standard errors off\n", feet[wide][0],
                  feet[wide][1], worst);
    assert_true(worst <= 4);
    close_cloth(&c);
  }
}

/* Without tilts it is as narrow as its yarns say, along and across. */
static void single_of_no_detail_is_the_yarn_s(void **state) {
  (void)state;
  shade_weave_params w;
  shade_fabric_params f;
  shade_weave_params_init(&w);
  shade_fabric_params_init(&f);
  f.detail = SHADE_DETAIL_NONE;
  const double yarns[2][2] = {{20, 70}, {50, 9}};
  f.weft.along = yarns[0][0];
  f.weft.across = yarns[0][1];
  f.warp.along = yarns[1][0];
  f.warp.across = yarns[1][1];
  cloth c = make_cloth(shade_draft_named("plain"), &w, &f);
  const shade_ref_seen seen = shade_ref_cloth_seen(&c.reference, 1 << 10);
  shade_fabric_info info;
  shade_fabric_get_info(c.fabric, &info);
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 2; i++) {
      assert_true(fabs(seen.side[k].exponents[i] / yarns[k][i] - 1) <= 1e-12);
      assert_true(fabs((k ? info.warp_single : info.weft_single)[i] / yarns[k][i] - 1) <= 1e-9);
    }
  close_cloth(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(look_up),
      cmocka_unit_test(near_is_the_reference),
      cmocka_unit_test(footprints_are_points_of_near),
      cmocka_unit_test(near_passes_into_far),
      cmocka_unit_test(mean_is_the_sum_over_yarns),
      cmocka_unit_test(mean_is_of_the_footprint),
      cmocka_unit_test(single_is_the_reference),
      cmocka_unit_test(single_of_no_detail_is_the_yarn_s),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
