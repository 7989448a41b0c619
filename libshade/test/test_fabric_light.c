/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 4.2 */
/*
 * What becomes of light at a cloth: horizons over folds, what is let through, what passes the
 * gaps, a furnace around both sides, and the weights of draws.
 */
#include "cloth.h"

/* ---- horizons ------------------------------------------------------------------- */

static void mirrored(const double n[3], const double w[3], double out[3]) {
  const double step = 2 * (n[0] * w[0] + n[1] * w[1]) / (n[0] * n[0] + n[1] * n[1]);
  out[0] = w[0] - step * n[0];
  out[1] = w[1] - step * n[1];
  out[2] = w[2];
}

static shade_horizon the_horizon;
static void set_horizon(shade_fabric_params *p) {
  p->horizon = the_horizon;
}

/* Every horizon from `hard` by what shade.h says of it, the bent n from the reference. */
static void horizons_are_those_of_shade_h(void **state) {
  (void)state;
  uint64_t seed = 8;
  the_horizon = SHADE_HORIZON_HARD;
  cloth hard = open_cloth("gabardine", set_horizon);
  for (int h = 1; h < SHADE_HORIZON_COUNT; h++) {
    the_horizon = (shade_horizon)h;
    cloth c = open_cloth("gabardine", set_horizon);
    int lit = 0, differ = 0;
    for (int k = 0; k < 3000; k++) {
      double wi[3], wo[3], n[3], got[3], want[3] = {0, 0, 0}, s[3];
      any_direction(&seed, 0.02, wi);
      any_direction(&seed, 0.02, wo);
      any_direction(&seed, 0.3, n);
      const double uv[2] = {9 * uniform(&seed), 9 * uniform(&seed)};
      const double none[2] = {0, 0}, all[2] = {50, 50}, *footprint = k % 5 ? none : all;
      shade_fabric_eval(c.fabric, uv, footprint, n, wi, wo, SHADE_TIER_AUTO, got);
      if (h == SHADE_HORIZON_SCHUESSLER) {
        const double *w[2] = {wi, wo};
        double p[2], q[2], wim[3], wom[3], f[3][3], pm;
        for (int j = 0; j < 2; j++) {
          p[j] = fmax(n_dot(n, w[j]), 0);
          q[j] = fmax(-(n[0] * w[j][0] + n[1] * w[j][1]), 0);
        }
        mirrored(n, wi, wim);
        mirrored(n, wo, wom);
        pm = n_dot(n, wim);
        shade_fabric_eval(hard.fabric, uv, footprint, n, wi, wo, SHADE_TIER_AUTO, f[0]);
        shade_fabric_eval(hard.fabric, uv, footprint, n, wim, wo, SHADE_TIER_AUTO, f[1]);
        shade_fabric_eval(hard.fabric, uv, footprint, n, wi, wom, SHADE_TIER_AUTO, f[2]);
        for (int a = 0; a < 3; a++) /* f is s over n.wi */
          want[a] = wi[2] * n[2] *
                    ((p[0] > 0 ? p[1] * f[0][a] + q[1] * f[2][a] : 0) +
                     (pm > 0 ? q[0] * p[1] * f[1][a] / pm : 0)) /
                    ((p[0] + q[0]) * (p[1] + q[1]));
      } else {
        shade_params q;
        double bent[3], factor = 1;
        shade_params_init(&q);
        q.horizon = the_horizon;
        shade_ref_normal(&q, n, wo, bent);
        shade_fabric_eval(hard.fabric, uv, footprint, bent, wi, wo, SHADE_TIER_AUTO, s);
        const double side2 = n[0] * n[0] + n[1] * n[1], z2 = wi[2] * wi[2];
        if (h == SHADE_HORIZON_ESTEVEZ || h == SHADE_HORIZON_VALID_ESTEVEZ)
          factor = 2 / (1 + sqrt(1 + fmin(1, side2 / (n[2] * n[2]) / 8) * (1 - z2) / z2));
        if (h == SHADE_HORIZON_CHIANG) {
          const double g = fmin(1, wi[2] / (n[2] * n_dot(n, wi)));
          factor = n_dot(n, wi) > 0 ? g + g * g - g * g * g : 0;
        }
        for (int a = 0; a < 3; a++)
          want[a] = factor * s[a];
      }
      double plain[3];
      shade_fabric_eval(hard.fabric, uv, footprint, n, wi, wo, SHADE_TIER_AUTO, plain);
      lit += want[1] > 0;
      differ += fabs(plain[1] - want[1]) > 1e-3 * plain[1];
      for (int a = 0; a < 3; a++)
        assert_near(got[a], want[a], 1e-9 * (1 + want[a]));
      const double up[3] = {0, 0, 1};
      shade_fabric_eval(c.fabric, uv, footprint, up, wi, wo, SHADE_TIER_AUTO, got);
      shade_fabric_eval(hard.fabric, uv, footprint, NULL, wi, wo, SHADE_TIER_AUTO, want);
      for (int a = 0; a < 3; a++)
        assert_near(got[a], want[a], 1e-12 * (1 + want[a]));
    }
    print_message("%s: lit %d of 3000, other than hard %d\n",
                  shade_list_word(SHADE_LIST_HORIZON, h), lit, differ);
    assert_true(lit > 1000);
    if (the_horizon == SHADE_HORIZON_MUTUAL) /* folds have no slopes: it is `hard` */
      assert_int_equal(differ, 0);
    else
      assert_true(differ > 100);
    close_cloth(&c);
  }
  /* the default, and what callers get who do not know of it */
  shade_fabric_params p;
  shade_fabric_params_init(&p);
  assert_int_equal(p.horizon, SHADE_HORIZON_VALID_ESTEVEZ);
  const double uv[2] = {0.3, 0.7}, n[3] = {0.6, 0, 0.8}, wi[3] = {-0.6, 0, 0.8};
  double wo[3], old[3], want[3];
  spherical(0.2, 1, wo);
  for (int k = 0; k < 2; k++) {
    p.size = k ? offsetof(shade_fabric_params, warp_transmit) : sizeof p;
    p.horizon = k ? SHADE_HORIZON_VALID_ESTEVEZ : SHADE_HORIZON_HARD;
    p.shadows = k;
    shade_fabric *f = shade_fabric_create(hard.weave, &p, NULL);
    shade_fabric_eval(f, uv, NULL, n, wi, wo, SHADE_TIER_NEAR, k ? old : want);
    shade_fabric_free(f);
  }
  assert_true(want[1] > 0 && old[1] == want[1]);
  close_cloth(&hard);
}

/* ---- through the cloth ------------------------------------------------------------ */

static void bare(shade_fabric_params *p) {
  for (int a = 0; a < 3; a++) {
    p->backing[a] = 0;
    p->warp_transmit[a] = p->weft_transmit[a] = 0.3;
  }
  p->nap = 0;
}

static void each_alone(shade_fabric_params *p) {
  bare(p);
  p->shadows = 0;
}

static void from_behind(void **state) {
  (void)state;
  cloth c = open_cloth("linen", each_alone);
  uint64_t seed = 12;
  int gaps = 0, yarns = 0;
  for (int k = 0; k < 4000; k++) {
    const double uv[2] = {30 * uniform(&seed), 30 * uniform(&seed)};
    double wi[3], wo[3], s[3];
    any_direction(&seed, 0, wi);
    any_direction(&seed, 0, wo);
    wi[2] = -wi[2];
    shade_fabric_eval(c.fabric, uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, s);
    shade_crossing at;
    shade_weave_lookup(c.weave, uv[0], uv[1], &at);
    if (at.top == SHADE_TOP_GAP) {
      assert_true(s[0] == 0 && s[1] == 0 && s[2] == 0);
      gaps++;
      continue;
    }
    const shade_yarn *y = at.swap ? &c.preset.fabric.warp : &c.preset.fabric.weft;
    const double n[3] = {at.dx, at.dy, sqrt(1 - at.dx * at.dx - at.dy * at.dy)};
    const double ci = -n_dot(n, wi), co = n_dot(n, wo);
    for (int a = 0; a < 3; a++) {
      const double kd = fmin(y->kd[a] * at.brightness, 1);
      const double kt = fmin(0.3 * at.brightness, 1 - kd);
      const double want = ci > 0 && co > 0
                              ? at.occlusion * kt * (1 - y->f0[a]) * (1 - y->f0[a]) * ci / PI *
                                    (1 - pow(1 - ci, 5)) * (1 - pow(1 - co, 5))
                              : 0;
      assert_near(s[a], want, 1e-12);
    }
    yarns += s[1] > 0;
  }
  assert_true(gaps > 20 && yarns > 1000);
  close_cloth(&c);
  c = open_cloth("linen", bare);
  /* far is the mean of near, from behind too */
  double worst = 0;
  for (int k = 0; k < 12 / FEWER; k++) {
    double wi[3], wo[3], far[3], single[3], mean[3] = {0, 0, 0};
    const double all[2] = {1e6, 1e6};
    any_direction(&seed, 0.15, wi);
    any_direction(&seed, 0.15, wo);
    wi[2] = -wi[2];
    for (int j = 0; j < 1 << 16; j++) {
      const double uv[2] = {4096 * fmod(0.5 + j * 0.7548776662466927, 1),
                            4096 * fmod(0.5 + j * 0.5698402909980532, 1)};
      double s[3];
      shade_fabric_eval(c.fabric, uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, s);
      for (int a = 0; a < 3; a++)
        mean[a] += s[a] / (1 << 16);
    }
    shade_fabric_eval(c.fabric, all, all, NULL, wi, wo, SHADE_TIER_FAR, far);
    shade_fabric_eval(c.fabric, all, all, NULL, wi, wo, SHADE_TIER_SINGLE, single);
    for (int a = 0; a < 3; a++) {
      worst = fmax(worst, fabs(far[a] / mean[a] - 1));
      assert_near(single[a], far[a], 0.02 * far[a]);
    }
  }
  print_message("far from behind against the mean of near: %.2f %%\n", 100 * worst);
  assert_true(worst <= 0.02);
  close_cloth(&c);
}

static void as_white_as_can_be(shade_fabric_params *p) {
  for (int a = 0; a < 3; a++) {
    p->warp.kd[a] = p->weft.kd[a] = 0.4;
    p->warp_transmit[a] = p->weft_transmit[a] = 1;
    p->warp.f0[a] = p->weft.f0[a] = 0.04;
    p->backing[a] = 1;
  }
  p->nap = 0.2;
}

/* Light from all sides of the whole sphere: no more leaves than arrives; horizons included. */
static void furnace(void **state) {
  (void)state;
  uint64_t seed = 13;
  double most = 0, least = 1;
  for (int h = 0; h < SHADE_HORIZON_COUNT; h += FEWER) {
    cloth c;
    assert_true(shade_preset_find("silk_charmeuse", &c.preset));
    as_white_as_can_be(&c.preset.fabric);
    c.preset.fabric.horizon = (shade_horizon)h;
    c.preset.yarns.occlusion = SHADE_OCCLUSION_NONE;
    c.fabric = shade_preset_fabric(&c.preset, &c.weave, NULL);
    for (int k = 0; k < 36 / FEWER; k++) {
      double wo[3], sum = 0;
      shade_fabric_point p;
      shade_fabric_point_init(c.fabric, &p);
      any_direction(&seed, 0.02, wo);
      if (k % 3)
        any_direction(&seed, 0.5, p.n);
      p.uv[0] = 9 * uniform(&seed);
      p.uv[1] = 9 * uniform(&seed);
      p.footprint[0] = p.footprint[1] = 30;
      shade_fabric_hit hit;
      shade_fabric_prepare(c.fabric, &p, wo, (shade_fabric_tier)(1 + k % 3), &hit, NULL);
      enum { GRID = 64 };
      for (int j = 0; j < GRID * GRID; j++) {
        double wi[3], s[3];
        spherical(acos(2 * (j / GRID + 0.5) / GRID - 1), 2 * PI * (j % GRID + 0.5) / GRID, wi);
        shade_fabric_hit_eval(c.fabric, &hit, wi, s);
        sum += s[1] * 4 * PI / (GRID * GRID);
      }
      most = fmax(most, sum);
      least = fmin(least, sum);
    }
    close_cloth(&c);
  }
  print_message("white furnace, both sides: %.3f to %.3f\n", least, most);
  assert_true(most <= 1 + 1e-3);
  assert_true(most > 0.6);
}

/* ---- coverage ----------------------------------------------------------------------- */

static void backed(shade_fabric_params *p) {
  p->backing[1] = 0.1;
}

static void coverage_is_of_yarns(void **state) {
  (void)state;
  cloth c = open_cloth("linen", bare);
  const double up[3] = {0, 0, 1};
  shade_fabric_hit hit;
  shade_fabric_point p;
  shade_fabric_point_init(c.fabric, &p);
  double sum = 0, far, one;
  enum { POINTS = 1 << 15 };
  int open = 0;
  for (int j = 0; j < POINTS; j++) {
    double coverage;
    p.uv[0] = 4096 * fmod(0.5 + j * 0.7548776662466927, 1);
    p.uv[1] = 4096 * fmod(0.5 + j * 0.5698402909980532, 1);
    shade_fabric_prepare(c.fabric, &p, up, SHADE_TIER_NEAR, &hit, &coverage);
    shade_crossing at;
    shade_weave_lookup(c.weave, p.uv[0], p.uv[1], &at);
    assert_near(coverage, at.top == SHADE_TOP_GAP ? at.fuzz : 1, 1e-12);
    open += at.top == SHADE_TOP_GAP;
    sum += coverage / POINTS;
  }
  assert_true(open > 100);
  p.footprint[0] = p.footprint[1] = 1e6;
  shade_fabric_prepare(c.fabric, &p, up, SHADE_TIER_FAR, &hit, &far);
  shade_fabric_prepare(c.fabric, &p, up, SHADE_TIER_SINGLE, &hit, &one);
  print_message("coverage of linen: %.4f, mean of near %.4f\n", far, sum);
  assert_near(far, sum, 0.004);
  assert_near(one, far, 1e-12);
  /* a nap takes its part of what the gaps leave, by Beer's law for half its depth */
  p.nap = 0.8;
  double veiled, wo[3];
  spherical(1, 0.3, wo);
  shade_fabric_prepare(c.fabric, &p, wo, SHADE_TIER_FAR, &hit, &veiled);
  assert_near(1 - veiled, (1 - far) * exp(-0.4 / cos(1)), 1e-12);
  close_cloth(&c);
  c = open_cloth("linen", backed);
  shade_fabric_prepare(c.fabric, &p, up, SHADE_TIER_FAR, &hit, &far);
  assert_near(far, 1, 0);
  close_cloth(&c);
}

/* ---- weights ----------------------------------------------------- */

static void weights_are_bounded(void **state) {
  (void)state;
  uint64_t seed = 21;
  shade_preset preset;
  double most = 0;
  for (int row = 0, cloths = 0; shade_preset_row(row, &preset); row++) {
    if (preset.kind != SHADE_PRESET_FABRIC || cloths++ % FEWER)
      continue;
    cloth c = open_cloth(preset.word, transmits);
    double here = 0;
    for (int k = 0; k < 6000 / FEWER; k++) {
      shade_fabric_point p;
      shade_fabric_hit hit;
      double wo[3], wi[3], s[3], pdf, u[3] = {uniform(&seed), uniform(&seed), uniform(&seed)};
      shade_fabric_point_init(c.fabric, &p);
      any_direction(&seed, 0, wo);
      any_direction(&seed, k % 2 ? 0.2 : 0.999999, p.n);
      p.uv[0] = 9 * uniform(&seed);
      p.uv[1] = 9 * uniform(&seed);
      p.footprint[0] = p.footprint[1] = 3;
      p.nap = k % 7 ? 0 : 0.3;
      shade_fabric_prepare(c.fabric, &p, wo, (shade_fabric_tier)(1 + k % 3), &hit, NULL);
      if (k % 4) { /* any direction, and what is drawn */
        any_direction(&seed, -1, wi);
        shade_fabric_hit_eval(c.fabric, &hit, wi, s);
        pdf = shade_fabric_hit_pdf(c.fabric, &hit, wi, NULL);
      } else {
        shade_fabric_hit_sample(c.fabric, &hit, u, wi, s, &pdf);
      }
      assert_true(isfinite(pdf) && pdf >= 0);
      for (int a = 0; a < 3; a++) {
        assert_true(s[a] == 0 || pdf > 0); /* nothing is missed */
        if (s[a] > 1e-12)
          here = fmax(here, s[a] / pdf);
      }
    }
    print_message("%-18s largest s / pdf %.2f\n", preset.word, here);
    most = fmax(most, here);
    close_cloth(&c);
  }
  assert_true(most <= 2);
}

/* ---- albedo ----------------------------------------------------------------------------- */

/* The table, and one direction's own quadrature, against the integral of s over both sides, far,
 * and with a nap, by the midpoint rule. */
static void albedo_is_the_integral(void **state) {
  (void)state;
  const char *names[] = {"denim", "silk_charmeuse", "wool_flannel"};
  const double all[2] = {1e6, 1e6}, none[2] = {0, 0};
  uint64_t seed = 31;
  double worst = 0, apart = 0;
  /* sanitizers see the one of fewest lobes, from one side */
  for (int name = FEWER > 1 ? 2 : 0; name < 3; name += FEWER) {
    cloth c = open_cloth(names[name], FEWER > 1 ? NULL : transmits);
    shade_fabric_albedo *table = shade_fabric_albedo_create(c.fabric);
    assert_non_null(table);
    for (int k = 0; k < 8; k += FEWER) {
      double wo[3], got[3], want[3] = {0, 0, 0};
      any_direction(&seed, 0.1, wo);
      enum { GRID = 96 };
      for (int j = 0; j < GRID * GRID; j++) {
        double wi[3], s[3];
        spherical(acos(2 * (j / GRID + 0.5) / GRID - 1), 2 * PI * (j % GRID + 0.5) / GRID, wi);
        shade_fabric_eval(c.fabric, none, all, NULL, wi, wo, SHADE_TIER_FAR, s);
        for (int a = 0; a < 3; a++)
          want[a] += s[a] * 4 * PI / (GRID * GRID);
      }
      assert_int_equal(shade_fabric_albedo_eval(table, wo, got), SHADE_OK);
      for (int a = 0; a < 3; a++)
        worst = fmax(worst, fabs(got[a] / want[a] - 1));
      const double longer[3] = {1e3 * wo[0], 1e3 * wo[1], 1e3 * wo[2]};
      assert_int_equal(shade_fabric_albedo_towards(c.fabric, longer, got), SHADE_OK);
      for (int a = 0; a < 3; a++)
        apart = fmax(apart, fabs(got[a] / want[a] - 1));
    }
    /* round the pole it ends where it begins, and turns between its last node and its first as
     * between all others */
    double turned[3][3], step[2] = {0, 0};
    for (int k = -1; k < 2; k++) {
      const double low[3] = {cos(k * PI / 16), sin(k * PI / 16), 0.1};
      shade_fabric_albedo_eval(table, low, turned[k + 1]);
    }
    for (int a = 0; a < 3; a++) {
      const double half[3] = {cos(PI / 32), -sin(PI / 32), 0.1};
      double between[3];
      shade_fabric_albedo_eval(table, half, between);
      step[0] = fmax(step[0], fabs(turned[1][a] - turned[0][a]));
      step[1] = fmax(step[1], fabs(between[a] - (turned[0][a] + turned[1][a]) / 2));
    }
    print_message("%s: %.1e from the last node to the first, %.1e off between\n", names[name],
                  step[0], step[1]);
    assert_true(step[1] <= 1e-6 + 0.02 * step[0]);
    double rgb[3];
    const double down[3] = {0.6, 0, -0.8}, bad[3] = {NAN, 0, 1};
    assert_int_equal(shade_fabric_albedo_eval(table, down, rgb), SHADE_OK);
    assert_true(rgb[0] == 0 && rgb[2] == 0);
    assert_int_equal(shade_fabric_albedo_eval(table, bad, rgb), SHADE_BAD_INPUT);
    assert_true(rgb[1] == 0);
    rgb[0] = rgb[1] = 1;
    assert_int_equal(shade_fabric_albedo_towards(c.fabric, down, rgb), SHADE_OK);
    assert_true(rgb[0] == 0 && rgb[2] == 0);
    rgb[1] = 1;
    assert_int_equal(shade_fabric_albedo_towards(c.fabric, bad, rgb), SHADE_BAD_INPUT);
    assert_true(rgb[1] == 0);
    shade_fabric_albedo_free(table);
    close_cloth(&c);
  }
  shade_fabric_albedo_free(NULL);
  print_message("albedo's table against the integral: %.2f %%\n", 100 * worst);
  print_message("one direction's quadrature: %.2f %%\n", 100 * apart);
  assert_true(worst <= 0.05);
  assert_true(apart <= 0.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(horizons_are_those_of_shade_h),
      cmocka_unit_test(from_behind),
      cmocka_unit_test(furnace),
      cmocka_unit_test(coverage_is_of_yarns),
      cmocka_unit_test(weights_are_bounded),
      cmocka_unit_test(albedo_is_the_integral),
  };
  return cmocka_run_group_tests_name("fabric light", tests, NULL, NULL);
}
