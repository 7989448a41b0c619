/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 3.6 */
/* The choices of horizon: values, continuity, reciprocity, energy, batches, senseless input. */
#include <fenv.h>
#include <float.h>
#include <string.h>

#include "support.h"

/* Those that need no slopes. Without them `mutual` is `hard`; with them: test_mutual.c. */
enum { CHOICES = SHADE_HORIZON_MUTUAL };

static double dot3(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static shade_params random_params(uint64_t *seed, shade_horizon horizon) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, pow(10, 3 * uniform(seed)), pow(10, 3 * uniform(seed)));
  p.mdf = (shade_mdf)(uniform(seed) * SHADE_MDF_COUNT);
  p.brdf = (shade_brdf)(uniform(seed) * SHADE_BRDF_COUNT);
  p.detail = (shade_detail)(uniform(seed) * SHADE_DETAIL_COUNT);
  p.groove = (shade_groove)(uniform(seed) * SHADE_GROOVE_COUNT);
  p.fresnel = (shade_fresnel)(uniform(seed) * SHADE_FRESNEL_F82);
  p.diffuse = (shade_diffuse)(uniform(seed) * SHADE_DIFFUSE_COUNT);
  p.horizon = horizon;
  int matt = uniform(seed) < 0.2;
  for (int c = 0; c < 3; c++) {
    p.kd[c] = matt ? uniform(seed) : 0;
    p.f0[c] = 0.3 + 0.7 * uniform(seed);
  }
  return p;
}

static void random_triple(uint64_t *seed, double tilt, double n[3], double wi[3], double wo[3]) {
  spherical(tilt * uniform(seed), 2 * PI * uniform(seed), n);
  spherical(1.6 * uniform(seed), 2 * PI * uniform(seed), wi);
  spherical(1.6 * uniform(seed), 2 * PI * uniform(seed), wo);
}

static shade_bsdf made(const shade_params *p) {
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, p), SHADE_OK);
  return b;
}

/* w mirrored at the upright facet of n. */
static void mirror(const double n[3], const double w[3], double out[3]) {
  double phi = atan2(n[1], n[0]), along = w[0] * cos(phi) + w[1] * sin(phi);
  out[0] = w[0] - 2 * along * cos(phi);
  out[1] = w[1] - 2 * along * sin(phi);
  out[2] = w[2];
}

/* The lobe sees h of wi and wo well above its own horizon: there its relative error is small. */
static int lobe_inside(const shade_params *p, const double n[3], const double wi[3],
                       const double wo[3]) {
  double h[3], m[3];
  for (int c = 0; c < 3; c++)
    h[c] = wi[c] + wo[c];
  double length = sqrt(dot3(h, h));
  for (int c = 0; c < 3; c++)
    h[c] /= length;
  shade_ref_carried(p, n, h, m);
  return m[2] >= (is_warp(p->detail) ? 0.5 : 0.05);
}

static int well_inside(const shade_params *p, const double n[3], const double wi[3],
                       const double wo[3]) {
  const double least = 0.05;
  double lobe_n[3], ti[3], to[3];
  shade_ref_normal(p, n, wo, lobe_n);
  if (fabs(dot3(lobe_n, wi)) < least || fabs(dot3(lobe_n, wo)) < least || wi[2] < least ||
      wo[2] < least)
    return 0;
  mirror(n, wi, ti);
  mirror(n, wo, to);
  return lobe_inside(p, lobe_n, wi, wo) &&
         (p->horizon != SHADE_HORIZON_SCHUESSLER ||
          (lobe_inside(p, n, ti, wo) && lobe_inside(p, n, wi, to)));
}

static void against_reference(void **state) {
  (void)state;
  for (int horizon = 0; horizon < CHOICES; horizon++) {
    uint64_t seed = 21;
    double worst = 0, worstf = 0, worst_warp = 0;
    int lit = 0, changed = 0;
    for (int k = 0; k < 40000; k++) {
      shade_params p = random_params(&seed, (shade_horizon)horizon);
      double n[3], wi[3], wo[3], f[3], want[3], plain[3], cosine, want_cosine;
      random_triple(&seed, 1.2, n, wi, wo);
      if (shade_detail_is(p.detail).conserve)
        continue; /* their reference differentiates: test_bsdf.c */
      shade_bsdf b = made(&p);
      unsigned status = shade_bsdf_eval(&b, n, wi, wo, f, &cosine);
      assert_int_equal(status, shade_ref_f(&p, n, wi, wo, want, &want_cosine));
      assert_near(cosine, want_cosine, wo[2] > 0.05 ? 1e-14 : 1e-8);
      p.horizon = SHADE_HORIZON_HARD;
      shade_ref_f(&p, n, wi, wo, plain, NULL);
      p.horizon = (shade_horizon)horizon;
      int inside = well_inside(&p, n, wi, wo);
      for (int c = 0; c < 3 && inside; c++) {
        assert_true(want[c] > 0 ? f[c] > 0 || want[c] < 1e-290 : f[c] == 0);
        if (want[c] < 1e-12 * bsdf_of(&b)->numbers.peak)
          continue;
        lit++;
        changed += fabs(want[c] - plain[c]) > 1e-3 * want[c];
        worst = fmax(worst, fabs(f[c] - want[c]) / (want[c] + p.kd[c]));
      }
      float v[9], ff[3], cosinef;
      for (int c = 0; c < 3; c++) {
        n[c] = (double)(v[c] = (float)n[c]);
        wi[c] = (double)(v[3 + c] = (float)wi[c]);
        wo[c] = (double)(v[6 + c] = (float)wo[c]);
      }
      shade_bsdf_evalf(&b, v, v + 3, v + 6, ff, &cosinef);
      shade_ref_f(&p, n, wi, wo, want, &want_cosine);
      inside = well_inside(&p, n, wi, wo);
      for (int c = 0; c < 3 && inside; c++)
        if (want[c] >= 1e-12 * bsdf_of(&b)->numbers.peak) {
          double *tally = is_warp(p.detail) ? &worst_warp : &worstf;
          *tally = fmax(*tally, fabs((double)ff[c] - want[c]) / (want[c] + p.kd[c]));
        }
    }
    print_message("%s: %d values, %d not as hard; double %.1e, float %.1e, float warps %.1e\n",
                  shade_list_word(SHADE_LIST_HORIZON, horizon), lit, changed, worst, worstf,
                  worst_warp);
    assert_true(lit > 5000 && (horizon == 0 ? changed == 0 : changed > 200));
    assert_true(worst <= 1e-12);
    assert_true(worstf <= 5e-5);
    assert_true(worst_warp <= 1e-4);
  }
}

/* Where nothing is bumped nothing differs, to the last bit; nor where the method ignores n. */
static void flat_is_hard(void **state) {
  (void)state;
  uint64_t seed = 22;
  for (int k = 0; k < 20000; k++) {
    shade_params p = random_params(&seed, SHADE_HORIZON_HARD);
    double n[3], wi[3], wo[3], f[3], want[3], cosine, want_cosine;
    random_triple(&seed, 1.2, n, wi, wo);
    if (k & 1)
      p.detail = SHADE_DETAIL_NONE;
    else
      n[0] = n[1] = 0, n[2] = 1;
    shade_bsdf b = made(&p);
    shade_bsdf_eval(&b, n, wi, wo, want, &want_cosine);
    for (int horizon = 1; horizon < SHADE_HORIZON_COUNT; horizon++) {
      p.horizon = (shade_horizon)horizon;
      b = made(&p);
      shade_bsdf_eval(&b, n, wi, wo, f, &cosine);
      assert_memory_equal(f, want, sizeof f);
      assert_true(cosine == want_cosine);
      double ref[3], ref_hard[3];
      shade_ref_f(&p, n, wi, wo, ref, NULL);
      p.horizon = SHADE_HORIZON_HARD;
      shade_ref_f(&p, n, wi, wo, ref_hard, NULL);
      assert_near(ref[0], ref_hard[0], 1e-15 * ref_hard[0]);
    }
  }
}

/* The same of batches, on every instruction set: all lanes flat, or every third one. */
static void flat_lanes_are_hard(void **state) {
  (void)state;
  enum { COUNT = 300 };
  static float in[9][COUNT], out[2][4][COUNT];
  static double ind[9][COUNT], outd[2][4][COUNT];
  const shade_lanesf lanesf = {.size = sizeof lanesf, SHADE_DIRECTIONS(in)};
  const shade_lanes lanes = {.size = sizeof lanes, SHADE_DIRECTIONS(ind)};
  uint64_t seed = 27;
  const shade_isa_table *isa;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    for (int k = 0; k < 40 * (SHADE_HORIZON_COUNT - 1); k++) {
      shade_params p = random_params(&seed, (shade_horizon)(1 + k / 40));
      const int every = k & 1 ? 1 : 3;
      for (int i = 0; i < COUNT; i++) {
        double v[9];
        random_triple(&seed, 1.2, v, v + 3, v + 6);
        if (i % every == 0)
          v[0] = v[1] = 0, v[2] = 1;
        for (int c = 0; c < 9; c++)
          ind[c][i] = (double)(in[c][i] = (float)v[c]);
      }
      for (int hard = 0; hard < 2; hard++) {
        if (hard)
          p.horizon = SHADE_HORIZON_HARD;
        const shade_bsdf b = made(&p);
        const shade_resultf resultf = {sizeof resultf, out[hard][0], out[hard][1], out[hard][2],
                                       out[hard][3]};
        const shade_result result = {sizeof result, outd[hard][0], outd[hard][1], outd[hard][2],
                                     outd[hard][3]};
        assert_int_equal(isa->entriesf->bsdf_batch(&b, COUNT, &lanesf, &resultf), SHADE_OK);
        assert_int_equal(isa->entries->bsdf_batch(&b, COUNT, &lanes, &result), SHADE_OK);
      }
      for (int c = 0; c < 4; c++)
        for (int i = 0; i < COUNT; i += every)
          assert_true(out[0][c][i] == out[1][c][i] && outd[0][c][i] == outd[1][c][i]);
    }
}

/*
 * valid_reflection: n as it is while the mirror image of wo is high enough; else the lobe of a
 * normal between z and n whose image has exactly the height that is stated.
 */
static void bent_normal(void **state) {
  (void)state;
  uint64_t seed = 23;
  int bent = 0;
  for (int k = 0; k < 50000; k++) {
    shade_params p = random_params(&seed, SHADE_HORIZON_VALID_REFLECTION);
    double n[3], m[3], wi[3], wo[3], f[3], want[3];
    random_triple(&seed, 1.5, n, wi, wo);
    if (p.detail == SHADE_DETAIL_NONE || wo[2] <= 0.01)
      continue;
    shade_bsdf b = made(&p);
    shade_bsdf_eval(&b, n, wi, wo, f, NULL);
    p.horizon = SHADE_HORIZON_HARD;
    shade_bsdf hard = made(&p);
    double t = fmin(0.9 * wo[2], 0.01);
    if (2 * dot3(n, wo) * n[2] - wo[2] >= t + 1e-12) {
      shade_bsdf_eval(&hard, n, wi, wo, want, NULL);
      assert_memory_equal(f, want, sizeof f);
      continue;
    }
    bent++;
    p.horizon = SHADE_HORIZON_VALID_REFLECTION;
    shade_ref_normal(&p, n, wo, m);
    assert_near(dot3(m, m), 1, 1e-15);
    assert_near(2 * dot3(m, wo) * m[2] - wo[2], t, 1e-14);
    assert_true(m[2] >= n[2]);
    assert_near(m[0] * n[1], m[1] * n[0], 1e-15); /* in the plane of z and n, */
    assert_true(m[0] * n[0] + m[1] * n[1] >= 0);  /* on the side of n */
    shade_bsdf_eval(&hard, m, wi, wo, want, NULL);
    if (fabs(dot3(m, wi)) > 0.01 && fabs(dot3(m, wo)) > 1e-3 &&
        want[0] > 1e-12 * bsdf_of(&b)->numbers.peak && !is_warp(p.detail))
      assert_near(f[0], want[0], 1e-9 * want[0]);
  }
  assert_true(bent > 5000);
}

/* Values worked out by hand: n at atan 1/2, light over y at 45 degrees or lower. */
static void by_hand(void **state) {
  (void)state;
  const double n[3] = {0, 1 / sqrt(5), 2 / sqrt(5)}, wo[3] = {0, 0, 1};
  const double wi[3] = {0, .8, .6}; /* n.wi = 2/sqrt 5; tan = 4/3 */
  shade_params p;
  shade_params_init(&p);
  p.fresnel = SHADE_FRESNEL_NONE;
  p.horizon = SHADE_HORIZON_HARD;
  shade_bsdf b = made(&p);
  double hard[3], f[3], cosine;
  shade_bsdf_eval(&b, n, wi, wo, hard, NULL);
  p.horizon = SHADE_HORIZON_ESTEVEZ; /* alpha^2 = 1/32: 1 + sqrt(1 + 16/288) */
  b = made(&p);
  shade_bsdf_eval(&b, n, wi, wo, f, &cosine);
  assert_near(f[0] / hard[0], 2 / (1 + sqrt(1 + 1. / 18)), 1e-14);
  assert_near(cosine, 2 / sqrt(5), 1e-15);
  p.horizon = SHADE_HORIZON_VALID_ESTEVEZ; /* the eye's image is high: n stays */
  b = made(&p);
  double both[3];
  shade_bsdf_eval(&b, n, wi, wo, both, NULL);
  assert_true(both[0] == f[0]);
  p.horizon = SHADE_HORIZON_CHIANG; /* g = .6/(.8) */
  b = made(&p);
  shade_bsdf_eval(&b, n, wi, wo, f, &cosine);
  assert_near(f[0] / hard[0], .75 + .5625 - .421875, 1e-14);
  assert_near(cosine, 2 / sqrt(5), 1e-15);
  /* both facets: eye and light see the bumped one only, whose share is 1 */
  p.horizon = SHADE_HORIZON_SCHUESSLER;
  b = made(&p);
  shade_bsdf_eval(&b, n, wi, wo, f, &cosine);
  assert_near(f[0] / hard[0], 2 / sqrt(5), 1e-14);
  assert_true(cosine == .6);
  /* light behind the bump: p = 0, all of it comes by way of the mirror, from (0, .8, .6) */
  const double behind[3] = {0, -.96, .28};
  const double image[3] = {0, .96, .28};
  p.horizon = SHADE_HORIZON_HARD;
  b = made(&p);
  shade_bsdf_eval(&b, n, image, wo, hard, NULL);
  p.horizon = SHADE_HORIZON_SCHUESSLER;
  b = made(&p);
  shade_bsdf_eval(&b, n, behind, wo, f, &cosine);
  assert_true(dot3(n, behind) < 0 && hard[0] > 0);
  assert_near(f[0] / hard[0], 2 / sqrt(5), 1e-14);
}

/* f cos just inside and just outside of a horizon: which of the three, and on which side. */
typedef enum edge { LIGHT_UNDER_N, EYE_UNDER_N, LIGHT_UNDER_Z, EDGES } edge;

/* The largest step of f cos over 2e-7 radians across the edge, over f cos nearby. */
static double jump(shade_horizon horizon, shade_mdf mdf, shade_brdf brdf, edge e) {
  const double step = 1e-7;
  uint64_t seed = 24;
  double most = 0;
  for (int k = 0; k < 3000; k++) {
    shade_params p;
    shade_params_init(&p);
    shade_params_set_exponents(&p, 4 + 20 * uniform(&seed), 4 + 20 * uniform(&seed));
    p.mdf = mdf;
    p.brdf = brdf;
    p.detail = SHADE_DETAIL_ROTATE;
    p.fresnel = SHADE_FRESNEL_NONE;
    p.horizon = horizon;
    shade_bsdf b = made(&p);
    double v[3][3], side[2][3], f[2][3], cosine[2]; /* v: n, wi, wo */
    spherical(0.2 + 0.6 * uniform(&seed), 2 * PI * uniform(&seed), v[0]);
    spherical(1.3 * uniform(&seed), 2 * PI * uniform(&seed), v[1]);
    spherical(1.3 * uniform(&seed), 2 * PI * uniform(&seed), v[2]);
    const double z[3] = {0, 0, 1}, *pole = e == LIGHT_UNDER_Z ? z : v[0];
    double *moved = v[e == EYE_UNDER_N ? 2 : 1];
    /* onto the great circle of the edge, then a step to either side */
    double off = dot3(pole, moved);
    for (int c = 0; c < 3; c++)
      moved[c] -= off * pole[c];
    double length = sqrt(dot3(moved, moved));
    for (int s = 0; s < 2; s++)
      for (int c = 0; c < 3; c++)
        side[s][c] = moved[c] / length + (s ? step : -step) * pole[c];
    const double *other = e == EYE_UNDER_N ? v[1] : v[2];
    if (dot3(v[0], other) < 0.1 || other[2] < 0.1 ||
        (e == LIGHT_UNDER_Z ? dot3(v[0], side[1]) < 0.1 : side[1][2] < 0.1))
      continue; /* one edge at a time */
    for (int s = 0; s < 2; s++)
      shade_bsdf_eval(&b, v[0], e == EYE_UNDER_N ? v[1] : side[s],
                      e == EYE_UNDER_N ? side[s] : v[2], f[s], &cosine[s]);
    most = fmax(most, fabs(f[1][0] * cosine[1] - f[0][0] * cosine[0]));
  }
  return most;
}

static void continuity(void **state) {
  (void)state;
  const struct {
    shade_mdf mdf;
    shade_brdf brdf;
  } models[] = {{SHADE_MDF_ASHIKHMIN_SHIRLEY, SHADE_BRDF_ASHIKHMIN_SHIRLEY},
                {SHADE_MDF_GGX, SHADE_BRDF_MICROFACET}};
  /* 1: f cos must not jump there. The others do, or there would be nothing to mend */
  const int smooth[CHOICES][EDGES] = {
      [SHADE_HORIZON_HARD] = {1, 0, 0},       [SHADE_HORIZON_VALID_REFLECTION] = {1, 1, 0},
      [SHADE_HORIZON_ESTEVEZ] = {1, 0, 1},    [SHADE_HORIZON_CHIANG] = {1, 0, 1},
      [SHADE_HORIZON_SCHUESSLER] = {1, 1, 1}, [SHADE_HORIZON_VALID_ESTEVEZ] = {1, 1, 1},
  };
  for (int m = 0; m < 2; m++)
    for (int horizon = 0; horizon < CHOICES; horizon++) {
      double found[EDGES];
      for (int e = 0; e < EDGES; e++)
        found[e] = jump((shade_horizon)horizon, models[m].mdf, models[m].brdf, (edge)e);
      print_message("%s, %s: jump of f cos at n.wi = 0: %.1e, n.wo = 0: %.1e, wi.z = 0: %.1e\n",
                    shade_list_word(SHADE_LIST_HORIZON, horizon),
                    shade_list_word(SHADE_LIST_BRDF, (int)models[m].brdf), found[0], found[1],
                    found[2]);
      for (int e = 0; e < EDGES; e++)
        assert_true(smooth[horizon][e] ? found[e] < 1e-4 : found[e] > 0.05);
    }
}

static void reciprocity(void **state) {
  (void)state;
  double apart[CHOICES] = {0};
  for (int horizon = 0; horizon < CHOICES; horizon++) {
    uint64_t seed = 25;
    for (int k = 0; k < 20000; k++) {
      shade_params p = random_params(&seed, (shade_horizon)horizon);
      p.kd[0] = p.kd[1] = p.kd[2] = 0;
      shade_bsdf b = made(&p);
      double n[3], wi[3], wo[3], f[3], back[3];
      random_triple(&seed, 1.2, n, wi, wo);
      shade_bsdf_eval(&b, n, wi, wo, f, NULL);
      shade_bsdf_eval(&b, n, wo, wi, back, NULL);
      if (f[0] > 1e-12 * bsdf_of(&b)->numbers.peak)
        apart[horizon] = fmax(apart[horizon], fabs(back[0] / f[0] - 1));
    }
    print_message("%s: reciprocal to %.1e\n", shade_list_word(SHADE_LIST_HORIZON, horizon),
                  apart[horizon]);
  }
  assert_true(apart[SHADE_HORIZON_HARD] < 1e-12 && apart[SHADE_HORIZON_SCHUESSLER] < 1e-11);
  for (int horizon = SHADE_HORIZON_VALID_REFLECTION; horizon < CHOICES; horizon++)
    assert_true(horizon == SHADE_HORIZON_SCHUESSLER || apart[horizon] > 0.1);
}

/* Albedo about z: the integral of f cos over all wi above the surface, midpoints of a grid. */
static double albedo(const shade_bsdf *b, const double n[3], const double wo[3]) {
  enum { RINGS = 160, SPOKES = 320 / FEWER, POINTS = RINGS * SPOKES };
  static double v[9][POINTS], out[4][POINTS];
  for (int i = 0; i < POINTS; i++) {
    double wi[3];
    spherical(acos((i / SPOKES + 0.5) / RINGS), 2 * PI * (i % SPOKES + 0.5) / SPOKES, wi);
    for (int c = 0; c < 3; c++) {
      v[c][i] = n[c];
      v[3 + c][i] = wi[c];
      v[6 + c][i] = wo[c];
    }
  }
  shade_lanes in = {.size = sizeof in, SHADE_DIRECTIONS(v)};
  shade_result result = {sizeof result, out[0], out[1], out[2], out[3]};
  shade_bsdf_eval_batch(b, POINTS, &in, &result);
  double sum = 0;
  for (int i = 0; i < POINTS; i++)
    sum += out[0][i] * out[3][i];
  return sum * 2 * PI / POINTS;
}

/*
 * White furnace through tilted normals, eye anywhere above the surface. (Steeper facets send
 * most of what they reflect down, where single reflection loses it under every choice.)
 */
static void furnace(void **state) {
  (void)state;
  const struct {
    shade_mdf mdf;
    shade_brdf brdf;
  } models[] = {{SHADE_MDF_ASHIKHMIN_SHIRLEY, SHADE_BRDF_ASHIKHMIN_SHIRLEY},
                {SHADE_MDF_GGX, SHADE_BRDF_MICROFACET}};
  for (int horizon = 0; horizon < SHADE_HORIZON_COUNT; horizon++) {
    double most = 0, least = 9;
    for (int m = 0; m < 2; m++)
      for (int k = 0; k < 3 * 4 * 4; k++) {
        const double tilts[] = {5, 20, 35}, thetas[] = {5, 45, 70, 88};
        shade_params p;
        shade_params_init(&p);
        shade_params_set_exponents(&p, 60, 8);
        p.mdf = models[m].mdf;
        p.brdf = models[m].brdf;
        p.fresnel = SHADE_FRESNEL_NONE;
        p.horizon = (shade_horizon)horizon;
        shade_bsdf b = made(&p);
        double n[3], wo[3];
        spherical(tilts[k % 3] * PI / 180, 0.4, n);
        spherical(thetas[k / 3 % 4] * PI / 180, 0.4 + k / 12 * PI / 3, wo);
        double a = albedo(&b, n, wo);
        most = fmax(most, a);
        least = fmin(least, a);
      }
    print_message("%s: albedo %.4f to %.4f\n", shade_list_word(SHADE_LIST_HORIZON, horizon), least,
                  most);
    assert_true(most <= 1 + 1e-3);
    /* black where the eye is below the perturbed horizon, or not */
    if (horizon == SHADE_HORIZON_VALID_REFLECTION || horizon == SHADE_HORIZON_SCHUESSLER ||
        horizon == SHADE_HORIZON_VALID_ESTEVEZ)
      assert_true(least > 0.1);
    else
      assert_true(least == 0);
  }
}

/* Every instruction set and length, f0 by the sample, and a lane without direction. */
static void batch_is_single(void **state) {
  (void)state;
  enum { MOST = 600, INPUTS = 12 };
  static float in[INPUTS][MOST], out[4][MOST];
  static double ind[INPUTS][MOST], outd[4][MOST];
  const size_t lengths[] = {1, 17, 256, 257, 600};
  uint64_t seed = 26;
  const shade_isa_table *isa;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    for (int k = 0; k < 5 * (SHADE_HORIZON_COUNT - 1); k++) {
      size_t count = lengths[k % 5];
      shade_params p = random_params(&seed, (shade_horizon)(1 + k / 5));
      for (size_t i = 0; i < count; i++) {
        double v[9];
        random_triple(&seed, 1.2, v, v + 3, v + 6);
        for (int c = 0; c < INPUTS; c++)
          ind[c][i] = (double)(in[c][i] = (float)(c < 9 ? v[c] : uniform(&seed)));
      }
      ind[k % 9][count / 2] = in[k % 9][count / 2] = NAN;
      int textured = k % 2;
      shade_lanesf lanesf = {.size = sizeof lanesf, SHADE_DIRECTIONS(in)};
      shade_lanes lanes = {.size = sizeof lanes, SHADE_DIRECTIONS(ind)};
      if (textured) {
        lanesf.f0r = in[9], lanesf.f0g = in[10], lanesf.f0b = in[11];
        lanes.f0r = ind[9], lanes.f0g = ind[10], lanes.f0b = ind[11];
      }
      shade_resultf resultf = {sizeof resultf, out[0], out[1], out[2], out[3]};
      shade_result result = {sizeof result, outd[0], outd[1], outd[2], outd[3]};
      shade_bsdf b = made(&p);
      assert_true(isa->entriesf->bsdf_batch(&b, count, &lanesf, &resultf) & SHADE_BAD_INPUT);
      assert_true(isa->entries->bsdf_batch(&b, count, &lanes, &result) & SHADE_BAD_INPUT);
      for (size_t i = 0; i < count; i++) {
        double v[9], f[3], cosine, bent[3];
        float vf[9], ff[3], cosinef;
        for (int c = 0; c < 9; c++)
          v[c] = (double)(vf[c] = in[c][i]);
        for (int c = 0; textured && c < 3; c++)
          p.f0[c] = (double)in[9 + c][i];
        b = made(&p);
        shade_bsdf_evalf(&b, vf, vf + 3, vf + 6, ff, &cosinef);
        shade_bsdf_eval(&b, v, v + 3, v + 6, f, &cosine);
        if (i == count / 2) {
          for (int c = 0; c < 4; c++)
            assert_true(out[c][i] == 0 && outd[c][i] == 0);
          assert_true(cosine == 0 && f[0] == 0);
          continue;
        }
        shade_ref_normal(&p, v, v + 6, bent);
        if (v[8] < 0.02 || fabs(dot3(bent, v + 3)) < 1e-3 || fabs(dot3(bent, v + 6)) < 1e-3)
          continue; /* one rounding decides, or counts for much */
        assert_near(outd[3][i], cosine, 1e-13);
        assert_near(out[3][i], cosinef, 1e-5);
        for (int c = 0; c < 3; c++) {
          assert_true(fabs(outd[c][i] - f[c]) <=
                      1e-10 * (f[c] + 1e-30 * bsdf_of(&b)->numbers.peak));
          if (f[c] > 1e-6 * bsdf_of(&b)->numbers.peak)
            assert_true(fabsf(out[c][i] - ff[c]) <= 1e-3f * ff[c]);
        }
      }
    }
}

/* Nothing but numbers comes out; single calls raise none of the flags that can be trapped. */
static void senseless_input(void **state) {
  (void)state;
  const double odd[] = {0,     -0.0,  1,   -1,      1e-300,       -1e-300,
                        1e18,  -1e18, NAN, 1e-20,   -1e-20,       0.5,
                        1e-40, 1e9,   0.7, DBL_MIN, DBL_TRUE_MIN, INFINITY};
  enum { ODD = sizeof odd / sizeof odd[0] };
  const int trapped = FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO;
  uint64_t seed = 27;
  for (int k = 0; k < 200000; k++) {
    shade_params p = random_params(&seed, (shade_horizon)(1 + k % (SHADE_HORIZON_COUNT - 1)));
    if (k % 5 == 0)
      shade_params_set_exponents(&p, k % 2 ? 0 : 1e6, k % 3 ? 0 : 1e6);
    if (k % 7 == 0)
      shade_params_set_alphas(&p, k % 2 ? 1e-4 : 10, k % 3 ? 1e-4 : 10);
    shade_bsdf b = made(&p);
    double v[9], f[3], cosine;
    float vf[9], ff[3], cosinef, lane[9][2], rgb[4][2];
    int finite = 1;
    for (int c = 0; c < 9; c++) {
      v[c] = uniform(&seed) < 0.5 ? 2 * uniform(&seed) - 1 : odd[(int)(uniform(&seed) * ODD)];
      vf[c] = (float)v[c];
      lane[c][0] = lane[c][1] = vf[c];
      finite &= isfinite(v[c]);
    }
    feclearexcept(FE_ALL_EXCEPT);
    unsigned status = shade_bsdf_eval(&b, v, v + 3, v + 6, f, &cosine);
    shade_bsdf_evalf(&b, vf, vf + 3, vf + 6, ff, &cosinef);
    assert_true(!finite || fetestexcept(trapped) == 0);
    assert_true(finite || (status & SHADE_BAD_INPUT));
    shade_lanesf in = {.size = sizeof in, SHADE_DIRECTIONS(lane)};
    shade_resultf out = {sizeof out, rgb[0], rgb[1], rgb[2], rgb[3]};
    shade_bsdf_eval_batchf(&b, 2, &in, &out);
    for (int c = 0; c < 3; c++) {
      assert_true(isfinite(f[c]) && f[c] >= 0);
      assert_true(isfinite(ff[c]) && ff[c] >= 0);
      assert_true(isfinite(rgb[c][1]) && rgb[c][1] >= 0);
    }
    assert_true(cosine >= 0 && cosine < 1.01 && cosinef >= 0 && cosinef < 1.01f);
    assert_true(rgb[3][1] >= 0 && rgb[3][1] < 1.01f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(by_hand),         cmocka_unit_test(against_reference),
      cmocka_unit_test(flat_is_hard),    cmocka_unit_test(flat_lanes_are_hard),
      cmocka_unit_test(bent_normal),     cmocka_unit_test(continuity),
      cmocka_unit_test(reciprocity),     cmocka_unit_test(furnace),
      cmocka_unit_test(batch_is_single), cmocka_unit_test(senseless_input),
  };
  return cmocka_run_group_tests_name("horizon", tests, NULL, NULL);
}
