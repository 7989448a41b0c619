/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 13 */
/*
 * The fabric near, against the reference; far, against the mean of the near model over many
 * points; and between them, for all presets.
 */
#include "support.h"

#include <fenv.h>
#include <string.h>

#include "shade/presets.h"

typedef struct cloth {
  shade_preset preset;
  shade_weave *weave;
  shade_fabric *fabric;
} cloth;

static int open_cloth(int row, cloth *c) {
  unsigned status = SHADE_OK;
  for (int k = 0; shade_preset_row(k, &c->preset); k++)
    if (c->preset.kind == SHADE_PRESET_FABRIC && row-- == 0) {
      c->fabric = shade_preset_fabric(&c->preset, &c->weave, &status);
      assert_non_null(c->fabric);
      assert_int_equal(status, SHADE_OK); /* no preset is out of range */
      return 1;
    }
  return 0;
}

/* The same with other materials: `change` alters the parameters. */
static void alter(cloth *c, void (*change)(shade_fabric_params *)) {
  change(&c->preset.fabric);
  shade_fabric_free(c->fabric);
  c->fabric = shade_fabric_create(c->weave, &c->preset.fabric, NULL);
  assert_non_null(c->fabric);
}

static void close_cloth(cloth *c) {
  shade_fabric_free(c->fabric);
  shade_weave_free(c->weave);
}

/* 20 pairs: five lights, four eyes, none in a plane of symmetry with all others. */
enum { PAIRS = 20 };
static void pair(int k, double wi[3], double wo[3]) {
  static const double lights[5][2] = {{3, 10}, {25, 75}, {40, 200}, {55, 320}, {70, 140}};
  static const double eyes[4][2] = {{0, 0}, {30, 260}, {50, 20}, {68, 315}};
  spherical(lights[k % 5][0] * PI / 180, lights[k % 5][1] * PI / 180, wi);
  spherical(eyes[k / 5][0] * PI / 180, eyes[k / 5][1] * PI / 180, wo);
}

/* Point k of an even, random-looking sequence over `span` x `span` crossings. */
static void point(int k, double span, double uv[2]) {
  uv[0] = span * fmod(0.5 + k * 0.7548776662466927, 1);
  uv[1] = span * fmod(0.5 + k * 0.5698402909980532, 1);
}

static const double WIDE[2] = {1e6, 1e6}; /* a footprint of all repeats */

/*
 * The near model at a point, from the look-up and the reference: n, wi and wo turned so that
 * the fibres run along x.
 */
static void near_by_reference(const cloth *c, const double uv[2], const double wi[3],
                              const double wo[3], double s[3]) {
  shade_crossing at;
  shade_weave_lookup(c->weave, uv[0], uv[1], &at);
  const shade_fabric_params *p = &c->preset.fabric;
  const shade_yarn *yarn = at.swap ? &p->warp : &p->weft;
  s[0] = s[1] = s[2] = 0;
  const double way = 1 / wi[2] + 1 / wo[2];
  if (at.top == SHADE_TOP_GAP) {
    for (int k = 0; k < 3; k++)
      s[k] = at.occlusion * ((1 - at.fuzz) * p->backing[k] + at.fuzz * yarn->kd[k]) * wi[2] / PI;
  } else {
    double n[3], i[3], o[3];
    const double tilt[3] = {at.dx, at.dy, sqrt(1 - at.dx * at.dx - at.dy * at.dy)};
    const double *from[3] = {tilt, wi, wo};
    double *to[3] = {n, i, o};
    for (int k = 0; k < 3; k++) {
      to[k][0] = from[k][0] * at.tx + from[k][1] * at.ty;
      to[k][1] = from[k][1] * at.tx - from[k][0] * at.ty;
      to[k][2] = from[k][2];
    }
    shade_params lobe;
    shade_params_init(&lobe);
    shade_params_set_exponents(&lobe, yarn->along, yarn->across);
    lobe.groove = SHADE_GROOVE_X;
    lobe.horizon = SHADE_HORIZON_HARD;
    double f[3], matt[3], ci, co = 0;
    memcpy(lobe.f0, yarn->f0, sizeof lobe.f0);
    shade_ref_f(&lobe, n, i, o, f, &ci);
    for (int k = 0; k < 3; k++) {
      co += n[k] * o[k];
      lobe.f0[k] = 0;
    }
    lobe.fresnel = SHADE_FRESNEL_NONE; /* with f0 = 0: the diffuse part alone */
    lobe.diffuse = yarn->diffuse;
    lobe.kd[0] = lobe.kd[1] = lobe.kd[2] = 1;
    shade_ref_f(&lobe, n, i, o, matt, NULL);
    for (int k = 0; k < 3; k++) {
      double through = (1 - yarn->f0[k]) * (1 - yarn->f0[k]) * (1 - pow(1 - ci, 5)) *
                       (1 - pow(1 - fmax(co, 0), 5));
      s[k] = at.occlusion *
             (f[k] * ci + fmin(yarn->kd[k] * at.brightness, 1) * through * matt[k] * ci);
    }
  }
  if (p->nap > 0)
    for (int k = 0; k < 3; k++)
      s[k] = s[k] * exp(-p->nap * way / 2) +
             p->nap_color[k] / (4 * PI) * wi[2] / (wi[2] + wo[2]) * (1 - exp(-p->nap * way));
}

static void near_is_the_reference(void **state) {
  (void)state;
  cloth c;
  for (int row = 0; open_cloth(row, &c); row += FEWER) {
    double worst = 0, worstf = 0;
    for (int k = 0; k < 2000; k += FEWER) {
      double uv[2], wi[3], wo[3], s[3], want[3];
      point(k, 64, uv);
      pair(k % PAIRS, wi, wo);
      assert_int_equal(shade_fabric_eval(c.fabric, uv, NULL, NULL, wi, wo, SHADE_TIER_AUTO, s), 0);
      near_by_reference(&c, uv, wi, wo, want);
      for (int j = 0; j < 3; j++)
        worst = fmax(worst, fabs(s[j] - want[j]) / (fabs(want[j]) + 1e-3));
      const float uvf[2] = {(float)uv[0], (float)uv[1]};
      const float wif[3] = {(float)wi[0], (float)wi[1], (float)wi[2]};
      const float wof[3] = {(float)wo[0], (float)wo[1], (float)wo[2]};
      const double rounded[2] = {(double)uvf[0], (double)uvf[1]};
      for (int j = 0; j < 3; j++) {
        wi[j] = (double)wif[j];
        wo[j] = (double)wof[j];
      }
      float sf[3];
      shade_fabric_evalf(c.fabric, uvf, NULL, NULL, wif, wof, SHADE_TIER_AUTO, sf);
      shade_fabric_eval(c.fabric, rounded, NULL, NULL, wi, wo, SHADE_TIER_AUTO, s);
      for (int j = 0; j < 3; j++)
        worstf = fmax(worstf, fabs((double)sf[j] - s[j]) / (fabs(s[j]) + 1e-3));
    }
    print_message("%-18s near against the reference %.1e, float against double %.1e\n",
                  c.preset.word, worst, worstf);
    assert_true(worst <= 1e-12);
    assert_true(worstf <= 2e-4);
    close_cloth(&c);
  }
}

/* Mean of the near model over a footprint, and the standard error of its brightest channel. */
static double mean_over(const cloth *c, const double at[2], const double footprint[2], int points,
                        const double wi[3], const double wo[3], double mean[3]) {
  enum { BATCH = 4096 };
  static double in[9][BATCH], out[3][BATCH];
  const shade_fabric_lanes lanes = {.size = sizeof lanes,
                                    .u = in[0],
                                    .v = in[1],
                                    .du = in[2],
                                    .dv = in[2],
                                    .wix = in[3],
                                    .wiy = in[4],
                                    .wiz = in[5],
                                    .wox = in[6],
                                    .woy = in[7],
                                    .woz = in[8]};
  const shade_fabric_result result = {.size = sizeof result, .r = out[0], .g = out[1], .b = out[2]};
  for (int i = 0; i < BATCH; i++)
    for (int j = 0; j < 3; j++) {
      in[3 + j][i] = wi[j];
      in[6 + j][i] = wo[j];
    }
  double square = 0, sum[3] = {0, 0, 0};
  assert_int_equal(points % BATCH, 0);
  for (int start = 0; start < points; start += BATCH) {
    for (int i = 0; i < BATCH; i++) {
      double uv[2];
      point(start + i, 1, uv);
      in[0][i] = at[0] + footprint[0] * (uv[0] - 0.5);
      in[1][i] = at[1] + footprint[1] * (uv[1] - 0.5);
    }
    shade_fabric_eval_batch(c->fabric, BATCH, &lanes, SHADE_TIER_NEAR, &result);
    for (int i = 0; i < BATCH; i++) {
      for (int j = 0; j < 3; j++)
        sum[j] += out[j][i];
      square += out[1][i] * out[1][i];
    }
  }
  for (int j = 0; j < 3; j++)
    mean[j] = sum[j] / points;
  return sqrt(fmax(square / points - mean[1] * mean[1], 0) / points) / mean[1];
}

/* The same over many crossings. */
static double near_mean(const cloth *c, int points, const double wi[3], const double wo[3],
                        double mean[3]) {
  const double middle[2] = {2048, 2048}, many[2] = {4096, 4096};
  return mean_over(c, middle, many, points, wi, wo, mean);
}

static double largest_difference(const double a[3], const double b[3]) {
  double most = 0;
  for (int j = 0; j < 3; j++)
    most = fmax(most, fabs(a[j] - b[j]) / b[j]);
  return most;
}

/*
 * Mean colour. The points are evenly spread, so the error of their mean is below the standard
 * error of random ones, which is printed and at most 0.8 %.
 */
static void far_is_the_mean_of_near(void **state) {
  (void)state;
  cloth c;
  for (int row = 0; open_cloth(row, &c); row += FEWER) {
    double worst = 0, single = 0, doubt = 0;
    for (int k = 0; k < PAIRS; k += FEWER) {
      double wi[3], wo[3], truth[3], s[3];
      const double uv[2] = {0.3, 0.7};
      pair(k, wi, wo);
      double error = 1;
      for (int points = 1 << 15; error > 0.008 && points <= 1 << 18; points *= 2)
        error = near_mean(&c, points, wi, wo, truth);
      doubt = fmax(doubt, error);
      shade_fabric_eval(c.fabric, uv, WIDE, NULL, wi, wo, SHADE_TIER_AUTO, s);
      worst = fmax(worst, largest_difference(s, truth));
      shade_fabric_eval(c.fabric, uv, NULL, NULL, wi, wo, SHADE_TIER_SINGLE, s);
      single = fmax(single, largest_difference(s, truth));
    }
    shade_fabric_info info;
    shade_fabric_get_info(c.fabric, &info);
    print_message("%-18s far %.2f %% (%d + %d lobes), single %.0f %%; standard error %.2f %%\n",
                  c.preset.word, 100 * worst, info.warp_lobes, info.weft_lobes, 100 * single,
                  100 * doubt);
    assert_true(doubt <= 0.008);
    assert_true(worst <= 0.02);
    close_cloth(&c);
  }
}

/*
 * Not of the presets: every distribution, other detail methods, coloured ends of unequal
 * thickness, gaps, fibres at an angle, all kinds of occlusion.
 */
static void far_is_the_mean_of_any_cloth(void **state) {
  (void)state;
  static const shade_detail details[] = {SHADE_DETAIL_NONE,          SHADE_DETAIL_PERTURB,
                                         SHADE_DETAIL_GRAM_SCHMIDT,  SHADE_DETAIL_SHORTEST_ARC,
                                         SHADE_DETAIL_DEFORM_LINEAR, SHADE_DETAIL_AUTO};
  for (int k = 0; k < SHADE_MDF_COUNT + 6; k++) {
    shade_draft *draft = shade_draft_named(k % 2 ? "twill_2_2" : "satin_5");
    for (int i = 0; i < draft->ends; i++) {
      draft->warp[i].color[0] = i % 2;
      draft->warp[i].color[1] = 0.2;
      draft->warp[i].thickness = i % 2 ? 1 : 0.6;
    }
    shade_weave_params w;
    shade_weave_params_init(&w);
    w.occlusion = (shade_occlusion)(k % SHADE_OCCLUSION_COUNT);
    w.warp.crimp = w.weft.crimp = 0.4;
    w.warp.segments = w.weft.segments = 2;
    w.warp.gap = 0.05;
    w.weft.gap = 0.3;
    w.warp.fibre = -0.3;
    w.weft.fibre = 0.4;
    w.warp.vary_brightness = w.weft.vary_tilt = 0.1;
    cloth c;
    c.weave = shade_weave_create(draft, &w, NULL);
    shade_fabric_params *p = &c.preset.fabric;
    shade_fabric_params_init(p);
    p->draft_colors = 1;
    if (k < SHADE_MDF_COUNT) {
      p->mdf = (shade_mdf)k;
      p->brdf = k == SHADE_MDF_ASHIKHMIN_SHIRLEY ? SHADE_BRDF_ASHIKHMIN_SHIRLEY
                : k >= SHADE_MDF_BECKMANN        ? SHADE_BRDF_MICROFACET
                                                 : SHADE_BRDF_WARD_BOUNDED;
    } else {
      p->detail = details[k - SHADE_MDF_COUNT];
    }
    p->warp.along = 60;
    p->weft.along = 25;
    p->weft.kd[0] = 0.05;
    c.fabric = shade_fabric_create(c.weave, p, NULL);
    assert_non_null(c.fabric);
    double worst = 0;
    for (int j = 0; j < PAIRS; j += 2 * FEWER) {
      double wi[3], wo[3], truth[3], s[3];
      const double uv[2] = {0, 0};
      pair(j, wi, wo);
      near_mean(&c, 1 << 15, wi, wo, truth);
      shade_fabric_eval(c.fabric, uv, WIDE, NULL, wi, wo, SHADE_TIER_AUTO, s);
      worst = fmax(worst, largest_difference(s, truth));
    }
    print_message("%-18s %-18s far %.2f %%\n", shade_list_word(SHADE_LIST_MDF, (int)p->mdf),
                  shade_list_word(SHADE_LIST_DETAIL, (int)p->detail), 100 * worst);
    assert_true(worst <= 0.02);
    close_cloth(&c);
    shade_draft_free(draft);
  }
}

static void lets_light_through(shade_fabric_params *p) {
  for (int k = 0; k < 3; k++)
    p->warp_transmit[k] = p->weft_transmit[k] = 0.2;
}

/*
 * Where single yarns are told apart, of cloths whose yarns vary in brightness and width, from both
 * sides: the mean of the near model over the very footprint, not that of the cloth. Footprints are
 * whole repeats of the draft, so that all of its tilts are in them; each yarn's own tilt is not
 * known, which a few crossings show, and of 24 yarns no single ones.
 */
static void far_is_the_mean_of_its_footprint(void **state) {
  (void)state;
  static const double feet[][2] = {{2, 2}, {4, 4}, {8, 8}, {12, 12}, {12, 4}, {4, 12}, {24, 4}};
  enum { FEET = sizeof feet / sizeof feet[0], PLACES = 48 / FEWER };
  cloth c;
  for (int row = 0; open_cloth(row, &c); row++) {
    const char *word = c.preset.word;
    if (strcmp(word, "linen") == 0 || strcmp(word, "denim") == 0 ||
        strcmp(word, "silk_shantung") == 0) {
      alter(&c, lets_light_through);
      const int repeat = strcmp(c.preset.weave, "plain") == 0 ? 2 : 4;
      for (int k = 0; k < FEET; k++) {
        if (feet[k][0] < repeat || feet[k][1] < repeat)
          continue;
        double sum[2] = {0, 0}, worst = 0;
        for (int behind = 0; behind < 2; behind++) {
          double square = 0, all = 0, wi[3], wo[3];
          pair(6, wi, wo);
          wi[2] = behind ? -wi[2] : wi[2];
          for (int i = 0; i < PLACES; i++) {
            double at[2], truth[3], s[3];
            point(i + 7, 3000, at);
            mean_over(&c, at, feet[k], 4096, wi, wo, truth);
            shade_fabric_eval(c.fabric, at, feet[k], NULL, wi, wo, SHADE_TIER_FAR, s);
            square += (s[1] - truth[1]) * (s[1] - truth[1]);
            all += truth[1];
            sum[0] += s[1];
            sum[1] += truth[1];
          }
          worst = fmax(worst, sqrt(square / PLACES) / (all / PLACES));
        }
        print_message("%-18s %4.1f x %4.1f: off by %.2f %% (rms), the sum by %+.2f %%\n", word,
                      feet[k][0], feet[k][1], 100 * worst, 100 * (sum[0] / sum[1] - 1));
        assert_true(worst <= (fmin(feet[k][0], feet[k][1]) < 5 ? 0.04 : 0.02));
        assert_near(sum[0] / sum[1], 1, 0.01);
      }
    }
    close_cloth(&c);
  }
}

/* Where no number lies between the ends of a footprint, it holds no yarns: the mean of all. */
static void far_off_there_are_no_single_yarns(void **state) {
  (void)state;
  static const double places[] = {1e18, -1e18, 1e19, 1e300, -1e300};
  const double few[2] = {4, 4}, many[2] = {64, 64}; /* whole repeats */
  cloth c;
  for (int row = 0; open_cloth(row, &c); row++) {
    for (int k = 0; k < 5; k++) {
      const double at[2] = {places[k], k % 2 ? places[k] : 0.5};
      double wi[3], wo[3], s[3], all[3];
      pair(6, wi, wo);
      feclearexcept(FE_ALL_EXCEPT);
      shade_fabric_eval(c.fabric, at, few, NULL, wi, wo, SHADE_TIER_FAR, s);
      assert_false(fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW));
      shade_fabric_eval(c.fabric, at, many, NULL, wi, wo, SHADE_TIER_FAR, all);
      for (int j = 0; j < 3 && k % 2 && strcmp(c.preset.weave, "plain") == 0; j++)
        assert_near(s[j], all[j], 1e-9 * all[j]);
    }
    close_cloth(&c);
  }
}

static void no_diffuse(shade_fabric_params *p) {
  for (int k = 0; k < 3; k++)
    p->warp.kd[k] = p->weft.kd[k] = p->backing[k] = 0;
  p->nap = 0;
}

/* Second moments of hx and hy of the highlight seen from above, weighted by s. */
static void highlight(const cloth *c, int points, shade_fabric_tier tier, double moments[2]) {
  enum { N = 24 };
  const double wo[3] = {0, 0, 1};
  double sum = 0;
  moments[0] = moments[1] = 0;
  for (int i = 0; i < N * N; i++) {
    double h[3] = {((i % N + 0.5) / N - 0.5) * 1.4, ((i / N + 0.5) / N - 0.5) * 1.4, 0};
    double r2 = h[0] * h[0] + h[1] * h[1], s[3], total = 0;
    if (r2 >= 0.49) /* wi would be below the horizon */
      continue;
    h[2] = sqrt(1 - r2);
    const double wi[3] = {2 * h[2] * h[0], 2 * h[2] * h[1], 2 * h[2] * h[2] - 1};
    for (int k = 0; k < points; k++) {
      double uv[2];
      point(k * 7 + i, 4096, uv);
      shade_fabric_eval(c->fabric, uv, points > 1 ? NULL : WIDE, NULL, wi, wo, tier, s);
      total += s[1] / points;
    }
    sum += total / h[2];
    moments[0] += total / h[2] * h[0] * h[0];
    moments[1] += total / h[2] * h[1] * h[1];
  }
  moments[0] /= sum;
  moments[1] /= sum;
}

static void far_is_as_wide(void **state) {
  (void)state;
  cloth c;
  for (int row = 0; open_cloth(row, &c); row += FEWER * FEWER) {
    double truth[2], far[2], single[2];
    alter(&c, no_diffuse);
    highlight(&c, 512, SHADE_TIER_NEAR, truth);
    highlight(&c, 1, SHADE_TIER_FAR, far);
    highlight(&c, 1, SHADE_TIER_SINGLE, single);
    print_message(
        "%-18s second moments %.4f %.4f, far %+.1f %% %+.1f %%, single %+.0f %% %+.0f %%\n",
        c.preset.word, truth[0], truth[1], 100 * (far[0] / truth[0] - 1),
        100 * (far[1] / truth[1] - 1), 100 * (single[0] / truth[0] - 1),
        100 * (single[1] / truth[1] - 1));
    for (int k = 0; k < 2; k++)
      assert_near(far[k] / truth[k], 1, 0.02);
    close_cloth(&c);
  }
}

/*
 * A slow zoom: the mean of a patch may change by 1.2 % and must do so one way: `back` is how far
 * it goes against the way it takes as a whole. The patch holds the same 2^14 points at every
 * distance, which leaves a noise of half a percent.
 */
static void zoom_does_not_pop(void **state) {
  (void)state;
  cloth c;
  for (int row = 0; open_cloth(row, &c); row += FEWER * FEWER) {
    double most = 0, most_back = 0;
    for (int k = 0; k < 2; k += FEWER) {
      enum { POINTS = 1 << 14, STEPS = 14 };
      double wi[3], wo[3], mean[STEPS];
      pair(11 * k + 1, wi, wo);
      for (int step = 0; step < STEPS; step++) {
        /* fine where near gives way to far, .75 to 2 */
        static const double extents[STEPS] = {.02, .1,  .4,  .7,  .8, .95, 1.1,
                                              1.3, 1.5, 1.8, 2.2, 4,  12,  80};
        const double footprint[2] = {extents[step], extents[step]};
        mean[step] = 0;
        for (int i = 0; i < POINTS; i++) {
          double uv[2], s[3];
          point(i, 64, uv);
          shade_fabric_eval(c.fabric, uv, footprint, NULL, wi, wo, SHADE_TIER_AUTO, s);
          mean[step] += s[1] / POINTS;
        }
      }
      const double way = mean[STEPS - 1] > mean[0] ? 1 : -1;
      double furthest = way * mean[0], back = 0;
      for (int step = 1; step < STEPS; step++) {
        most = fmax(most, fabs(mean[step] / mean[0] - 1));
        back = fmax(back, (furthest - way * mean[step]) / mean[0]);
        furthest = fmax(furthest, way * mean[step]);
      }
      most_back = fmax(most_back, back);
    }
    print_message("%-18s a zoom changes the mean by %.2f %%, back by %.2f %%\n", c.preset.word,
                  100 * most, 100 * most_back);
    assert_true(most <= 0.012);
    assert_true(most_back <= 0.01);
    close_cloth(&c);
  }
}

/* A frame whose axis `a` keeps its plane: as dP/du (a = 0) or dP/dv (1) of the surface with normal
 * n. */
static void transported(const double n[3], int a, const double w[3], double out[3]) {
  double t[3] = {0, 0, 0}, b[3], length = hypot(n[a], n[2]);
  t[a] = n[2] / length;
  t[2] = -n[a] / length;
  const double *first = a ? t : n, *second = a ? n : t; /* y = z x x, x = y x z */
  for (int k = 0; k < 3; k++)
    b[k] = first[(k + 1) % 3] * second[(k + 2) % 3] - first[(k + 2) % 3] * second[(k + 1) % 3];
  out[a] = w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
  out[1 - a] = w[0] * b[0] + w[1] * b[1] + w[2] * b[2];
  out[2] = w[0] * n[0] + w[1] * n[1] + w[2] * n[2];
}

static void hard_horizon(shade_fabric_params *p) {
  p->horizon = SHADE_HORIZON_HARD;
}

static void folds_carry_the_yarns(void **state) {
  (void)state;
  cloth c;
  assert_true(open_cloth(2, &c));
  alter(&c, hard_horizon);
  const double n[3] = {-0.36, 0.48, 0.8};
  int seen[3] = {0, 0, 0};
  for (int k = 0; k < 500; k++) {
    double uv[2], wi[3], wo[3], i[3], o[3], s[3], want[3];
    point(k, 64, uv);
    spherical(0.5, k * 0.1, wi);
    spherical(0.4, k * 0.37, wo);
    shade_crossing at;
    shade_weave_lookup(c.weave, uv[0], uv[1], &at);
    seen[at.top]++;
    transported(n, at.top == SHADE_TOP_WARP, wi, i);
    transported(n, at.top == SHADE_TOP_WARP, wo, o);
    shade_fabric_eval(c.fabric, uv, NULL, n, wi, wo, SHADE_TIER_NEAR, s);
    if (i[2] > 0 && o[2] > 0)
      near_by_reference(&c, uv, i, o, want);
    else
      want[0] = want[1] = want[2] = 0;
    for (int j = 0; j < 3; j++)
      assert_near(s[j], want[j], 1e-9 * (1 + want[j]));
  }
  assert_true(seen[SHADE_TOP_WEFT] > 50 && seen[SHADE_TOP_WARP] > 50);
  close_cloth(&c);
}

/* One lobe for uniform tilts has the second moments that were derived by hand. */
static void single_has_the_moments(void **state) {
  (void)state;
  const double cf = 0.2, cy = 0.5, ex = 100, ey = 10;
  shade_draft *draft = shade_draft_from_pattern(SHADE_WEFT_ONLY, 0, 0);
  shade_weave_params w;
  shade_weave_params_init(&w);
  w.occlusion = SHADE_OCCLUSION_NONE;
  w.weft.curve = cy;
  w.weft.ridge = cf;
  w.weft.segments = 7;
  shade_weave *weave = shade_weave_create(draft, &w, NULL);
  shade_fabric_params p;
  shade_fabric_params_init(&p);
  p.weft.along = ex;
  p.weft.across = ey;
  shade_fabric *fabric = shade_fabric_create(weave, &p, NULL);
  shade_fabric_info info;
  shade_fabric_get_info(fabric, &info);
  double e[2][2] = {{ex, ey}, {info.weft_single[0], info.weft_single[1]}}, m[2][2];
  for (int k = 0; k < 2; k++)
    for (int a = 0; a < 2; a++) {
      double g[2];
      for (int j = 0; j < 2; j++)
        g[j] = 1 / (sqrt(e[k][a] + 1 + 2 * j) *
                    (sqrt(e[k][a] + 1 + 2 * j) + sqrt(e[k][1 - a] + 1 + 2 * j)));
      m[k][a] = sqrt((e[k][0] + 1) * (e[k][1] + 1)) * (g[0] - g[1]);
    }
  const double mx = m[0][0], my = m[0][1], mz = 1 - mx - my, a = atanh(cy) / cy;
  const double want_y = my + cy * cy / 3 * (mz - my);
  const double want_x = mx + cf * cf / 3 * (mz - a * mx + (a - 1) * my);
  print_message("one lobe: exponents %.2f %.2f, moments %.5f %.5f, by hand %.5f %.5f\n", e[1][0],
                e[1][1], m[1][0], m[1][1], want_x, want_y);
  assert_near(m[1][0], want_x, 0.01 * want_x);
  assert_near(m[1][1], want_y, 0.01 * want_y);
  shade_fabric_free(fabric);
  shade_weave_free(weave);
  shade_draft_free(draft);
}

static void no_input_breaks_it(void **state) {
  (void)state;
  cloth c;
  const double bad[] = {0, -0.0, 1, -1, NAN, INFINITY, -INFINITY, 1e300, 1e-300, 1e-320, -1e18};
  enum { BAD = sizeof bad / sizeof bad[0] };
  uint64_t seed = 3;
#define ANY bad[(int)(BAD * uniform(&seed))]
  for (int row = 0; row < 2; row++) { /* charmeuse; shantung, whose yarns vary */
    assert_true(open_cloth(row, &c));
    for (int k = 0; k < 40000; k++) {
      double uv[2] = {ANY, ANY}, footprint[2] = {ANY, ANY}, n[3] = {ANY, ANY, ANY};
      double wi[3] = {ANY, ANY, ANY}, wo[3] = {ANY, ANY, ANY}, s[3];
      float uvf[2], footprintf[2], nf[3], wif[3], wof[3], sf[3];
      for (int j = 0; j < 3; j++) {
        uvf[j % 2] = (float)uv[j % 2];
        footprintf[j % 2] = (float)footprint[j % 2];
        nf[j] = (float)n[j];
        wif[j] = (float)wi[j];
        wof[j] = (float)wo[j];
      }
      unsigned status = shade_fabric_eval(c.fabric, uv, k % 3 ? footprint : NULL, k % 2 ? n : NULL,
                                          wi, wo, (shade_fabric_tier)(k % 6 - 1), s);
      shade_fabric_evalf(c.fabric, uvf, k % 3 ? footprintf : NULL, k % 2 ? nf : NULL, wif, wof,
                         (shade_fabric_tier)(k % 4), sf);
      for (int j = 0; j < 3; j++) {
        assert_true(isfinite(s[j]) && s[j] >= 0 && isfinite(sf[j]) && sf[j] >= 0);
        if (!isfinite(wi[j]) || !isfinite(uv[0])) {
          assert_true(status & SHADE_BAD_INPUT);
          assert_true(s[0] == 0);
        }
      }
    }
    if (row == 0)
      close_cloth(&c);
  }
#undef ANY
  const double uv[2] = {0, 0}, up[3] = {0, 0, 1}, less[2] = {-1, 0}, down[3] = {0.6, 0, -0.8};
  double s[3];
  assert_int_equal(shade_fabric_eval(c.fabric, uv, less, NULL, up, up, SHADE_TIER_AUTO, s),
                   SHADE_BAD_INPUT);
  assert_true(s[0] > 0);
  assert_int_equal(shade_fabric_eval(c.fabric, uv, NULL, down, up, up, SHADE_TIER_AUTO, s),
                   SHADE_CLAMPED_NORMAL);
  assert_int_equal(shade_fabric_eval(c.fabric, uv, NULL, NULL, up, up, (shade_fabric_tier)9, s),
                   SHADE_BAD_CHOICE);
  assert_int_equal(shade_fabric_eval(c.fabric, uv, NULL, NULL, up, down, SHADE_TIER_AUTO, s), 0);
  assert_true(s[0] == 0 && s[1] == 0 && s[2] == 0);
  close_cloth(&c);
}

static void parameters_are_clamped(void **state) {
  (void)state;
  shade_draft *draft = shade_draft_named("plain");
  shade_weave *weave = shade_weave_create(draft, NULL, NULL);
  shade_fabric_params p;
  unsigned status = 0;
  assert_null(shade_fabric_create(NULL, NULL, &status));
  shade_fabric_free(NULL);
  shade_fabric *fabric = shade_fabric_create(weave, NULL, &status);
  assert_non_null(fabric);
  assert_int_equal(status, SHADE_OK);
  shade_fabric_free(fabric);
  const double out[] = {-1, 2e6, NAN, INFINITY};
  for (int k = 0; k < 4; k++)
    for (int field = 0; field < 6; field++) {
      shade_fabric_params_init(&p);
      double *number[] = {&p.warp.along, &p.weft.across, &p.warp.f0[1],
                          &p.weft.kd[2], &p.nap,         &p.backing[0]};
      *number[field] = out[k];
      status = 0;
      fabric = shade_fabric_create(weave, &p, &status);
      assert_non_null(fabric);
      assert_int_equal(status, SHADE_CLAMPED_PARAMETER);
      const double uv[2] = {.3, .4}, up[3] = {0, 0, 1};
      double s[3];
      for (int tier = 0; tier < 4; tier++) {
        shade_fabric_eval(fabric, uv, WIDE, NULL, up, up, (shade_fabric_tier)tier, s);
        assert_true(isfinite(s[0] + s[1] + s[2]));
      }
      shade_fabric_free(fabric);
    }
  shade_fabric_params_init(&p);
  p.mdf = (shade_mdf)99;
  p.weft.diffuse = (shade_diffuse)-1;
  status = 0;
  fabric = shade_fabric_create(weave, &p, &status);
  assert_int_equal(status, SHADE_BAD_CHOICE);
  shade_fabric_free(fabric);
  shade_weave_free(weave);
  shade_draft_free(draft);
}

/* Each number is cut where its header says, no sooner and no later: what lies beyond shades as the
 * limit does, and what lies a little within does not. */
static void parameters_are_clamped_at_their_limits(void **state) {
  (void)state;
  static const struct {
    size_t at;
    double limit, beyond, within;
  } numbers[] = {
      {offsetof(shade_fabric_params, warp.along), 1e6, 1.1e6, 0.9e6},
      {offsetof(shade_fabric_params, weft.across), 1e6, 1.1e6, 0.9e6},
      {offsetof(shade_fabric_params, warp.f0), 1, 1.1, 0.9},
      {offsetof(shade_fabric_params, weft.kd), 1, 1.1, 0.9},
      {offsetof(shade_fabric_params, nap), 10, 10.5, 9.5},
      {offsetof(shade_fabric_params, warp.across), 0, -0.1, 0.1},
      {offsetof(shade_fabric_params, nap), 0, -0.1, 0.1},
  };
  shade_draft *draft = shade_draft_named("plain");
  shade_weave *weave = shade_weave_create(draft, NULL, NULL);
  for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
    const double given[3] = {numbers[k].limit, numbers[k].beyond, numbers[k].within};
    double sum[3] = {0};
    for (int g = 0; g < 3; g++) {
      shade_fabric_params p;
      shade_fabric_params_init(&p);
      *(double *)(void *)((char *)&p + numbers[k].at) = given[g];
      unsigned status = 0;
      shade_fabric *f = shade_fabric_create(weave, &p, &status);
      assert_non_null(f);
      assert_int_equal(status, g == 1 ? SHADE_CLAMPED_PARAMETER : SHADE_OK);
      for (int j = 0; j < PAIRS; j++) {
        double uv[2], s[3], wi[3], wo[3];
        point(j, 8, uv);
        pair(j, wi, wo);
        for (int far = 0; far < 2; far++) { /* narrow lobes that no point sees, the mean does */
          shade_fabric_eval(f, uv, far ? WIDE : NULL, NULL, wi, far ? wi : wo,
                            far ? SHADE_TIER_FAR : SHADE_TIER_NEAR, s);
          sum[g] += s[0] + s[1] + s[2];
        }
      }
      shade_fabric_free(f);
    }
    assert_true(sum[0] == sum[1]);
    assert_true(sum[0] != sum[2]);
  }
  shade_weave_free(weave);
  shade_draft_free(draft);
}

static void batch_is_one_by_one(void **state) {
  (void)state;
  enum { N = 300 };
  cloth c;
  assert_true(open_cloth(3, &c));
  double v[13][N], r[N], g[N], b[N];
  for (int k = 0; k < N; k++) {
    double uv[2], wi[3], wo[3];
    point(k, 64, uv);
    pair(k % PAIRS, wi, wo);
    const double n[3] = {0, 0.6, 0.8};
    for (int j = 0; j < 3; j++) {
      v[4 + j][k] = n[j];
      v[7 + j][k] = wi[j];
      v[10 + j][k] = wo[j];
    }
    v[0][k] = uv[0];
    v[1][k] = uv[1];
    v[2][k] = v[3][k] = k * 0.02;
  }
  const shade_fabric_lanes in = {.size = sizeof in,
                                 .u = v[0],
                                 .v = v[1],
                                 .du = v[2],
                                 .dv = v[3],
                                 .nx = v[4],
                                 .ny = v[5],
                                 .nz = v[6],
                                 .wix = v[7],
                                 .wiy = v[8],
                                 .wiz = v[9],
                                 .wox = v[10],
                                 .woy = v[11],
                                 .woz = v[12]};
  const shade_fabric_result out = {.size = sizeof out, .r = r, .g = g, .b = b};
  assert_int_equal(shade_fabric_eval_batch(c.fabric, N, &in, SHADE_TIER_AUTO, &out), 0);
  for (int k = 0; k < N; k++) {
    const double uv[2] = {v[0][k], v[1][k]}, footprint[2] = {v[2][k], v[3][k]};
    const double n[3] = {v[4][k], v[5][k], v[6][k]}, wi[3] = {v[7][k], v[8][k], v[9][k]};
    const double wo[3] = {v[10][k], v[11][k], v[12][k]};
    double s[3];
    shade_fabric_eval(c.fabric, uv, footprint, n, wi, wo, SHADE_TIER_AUTO, s);
    assert_true(s[0] == r[k] && s[1] == g[k] && s[2] == b[k]);
  }
  close_cloth(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(near_is_the_reference),
      cmocka_unit_test(far_is_the_mean_of_near),
      cmocka_unit_test(far_is_the_mean_of_any_cloth),
      cmocka_unit_test(far_is_the_mean_of_its_footprint),
      cmocka_unit_test(far_off_there_are_no_single_yarns),
      cmocka_unit_test(far_is_as_wide),
      cmocka_unit_test(zoom_does_not_pop),
      cmocka_unit_test(folds_carry_the_yarns),
      cmocka_unit_test(single_has_the_moments),
      cmocka_unit_test(no_input_breaks_it),
      cmocka_unit_test(parameters_are_clamped),
      cmocka_unit_test(parameters_are_clamped_at_their_limits),
      cmocka_unit_test(batch_is_one_by_one),
  };
  return cmocka_run_group_tests_name("fabric", tests, NULL, NULL);
}
