/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 2 */
/*
 * Bumps that shade and light each other (horizon mutual): the reference, draws, a white furnace,
 * the limits of no slopes, parameters of each sample, senseless input.
 */
#include <string.h>

#include "chi2.h"

static double gauss(uint64_t *seed) {
  return sqrt(-2 * log(1 - uniform(seed))) * cos(2 * PI * uniform(seed));
}

/* The normal of a slope. */
static void normal_of(double x, double y, double n[3]) {
  const double length = sqrt(1 + x * x + y * y);
  n[0] = -x / length;
  n[1] = -y / length;
  n[2] = 1 / length;
}

static shade_bsdf made(const shade_params *p) {
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, p), SHADE_OK);
  return b;
}

/* Slopes of that size, of waves along any axis, and some slope of the map as a whole. */
static void random_slopes(uint64_t *seed, double size, double slopes[5]) {
  const double along = 0.3 * size * size * uniform(seed), angle = PI * uniform(seed);
  const double c = cos(angle), s = sin(angle), across = 0.3 * size * size - along;
  slopes[0] = uniform(seed) < 0.5 ? 0 : 0.2 * gauss(seed);
  slopes[1] = uniform(seed) < 0.5 ? 0 : 0.2 * gauss(seed);
  slopes[2] = along * c * c + across * s * s;
  slopes[3] = (along - across) * c * s;
  slopes[4] = along * s * s + across * c * c;
}

static shade_params random_params(uint64_t *seed) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, pow(10, 3 * uniform(seed)), pow(10, 3 * uniform(seed)));
  if (uniform(seed) < 0.2)
    shade_params_set_exponents(&p, p.ex, p.ex);
  random_choices(seed, &p);
  p.horizon = SHADE_HORIZON_MUTUAL;
  const int matt = uniform(seed) < 0.2;
  for (int c = 0; c < 3; c++) {
    p.kd[c] = matt ? uniform(seed) : 0;
    p.f0[c] = 0.3 + 0.7 * uniform(seed);
    p.f82[c] = 0.5 + 0.5 * uniform(seed);
  }
  random_slopes(seed, 0.3 + 1.3 * uniform(seed), p.slopes);
  return p;
}

/* Nothing diffuse. */
static int kd_free(const shade_params *p) {
  return !(p->kd[0] + p->kd[1] + p->kd[2] > 0);
}

/* A normal of the map, light and eye. */
static void random_hit(uint64_t *seed, const shade_params *p, double v[9]) {
  const double xx = p->slopes[2], xy = p->slopes[3], yy = p->slopes[4], a = gauss(seed);
  const double low = xx > 0 ? xy / sqrt(xx) : 0;
  normal_of(p->slopes[0] + sqrt(xx) * a,
            p->slopes[1] + low * a + sqrt(fmax(yy - low * low, 0)) * gauss(seed), v);
  spherical(1.5 * uniform(seed), 2 * PI * uniform(seed), v + 3);
  spherical(1.4 * uniform(seed), 2 * PI * uniform(seed), v + 6);
}

/* Of the double v, and of v rounded to float, whose lengths are off: warps take them as they are.
 */
static void against_reference(void **state) {
  (void)state;
  uint64_t seed = 31;
  double worst[2][2] = {{0}}; /* [f, density][double, float] */
  int lit = 0;
  for (int k = 0; k < 700 / FEWER; k++) {
    const shade_params p = random_params(&seed);
    const shade_bsdf b = made(&p);
    double v[9], f[3], want[3], cosine, want_cosine;
    float vf[9], ff[3], cosinef;
    random_hit(&seed, &p, v);
    for (int single = 0; single < 2; single++) {
      for (int c = 0; c < 9; c++) {
        vf[c] = (float)v[c];
        v[c] = single ? (double)vf[c] : v[c];
      }
      double pdf;
      unsigned status;
      if (single) {
        status = shade_bsdf_evalf(&b, vf, vf + 3, vf + 6, ff, &cosinef);
        pdf = (double)shade_bsdf_pdff(&b, vf, vf + 3, vf + 6, NULL);
        for (int c = 0; c < 3; c++)
          f[c] = (double)ff[c];
        cosine = (double)cosinef;
      } else {
        status = shade_bsdf_eval(&b, v, v + 3, v + 6, f, &cosine);
        pdf = shade_bsdf_pdf(&b, v, v + 3, v + 6, NULL);
      }
      assert_int_equal(status, shade_ref_f(&p, v, v + 3, v + 6, want, &want_cosine));
      assert_near(cosine, want_cosine, single ? 1e-6 : 1e-15);
      for (int c = 0; c < 3; c++) {
        lit += want[c] > 0;
        worst[0][single] = fmax(worst[0][single], fabs(f[c] - want[c]) / (want[c] + 1e-3));
      }
      const double want_pdf = shade_ref_pdf(&p, v, v + 3, v + 6);
      worst[1][single] = fmax(worst[1][single], fabs(pdf - want_pdf) / (want_pdf + 1e-3));
    }
  }
  print_message("%d values: f double %.1e, float %.1e; density %.1e, %.1e\n", lit, worst[0][0],
                worst[0][1], worst[1][0], worst[1][1]);
  assert_true(lit > 1600 / FEWER);
  assert_true(worst[0][0] <= 1e-11 && worst[1][0] <= 1e-11);
  assert_true(worst[0][1] <= 1e-4 && worst[1][1] <= 1e-4);
}

/* What four facets of each side find of the light that is kept back, against an integral. */
static void nodes(void **state) {
  (void)state;
  uint64_t seed = 32;
  double mean = 0, most = 0, total = 0;
  enum { POINTS = 20 };
  for (int k = 0; k < POINTS; k++) {
    shade_params p;
    double n[3], wo[3];
    shade_params_init(&p);
    p.mdf = k & 1 ? SHADE_MDF_ASHIKHMIN_SHIRLEY : SHADE_MDF_GGX;
    p.horizon = SHADE_HORIZON_MUTUAL;
    shade_params_set_alphas(&p, 0.2, 0.2);
    p.slopes[2] = p.slopes[4] = 0.25;
    normal_of(0.5 * gauss(&seed), 0.5 * gauss(&seed), n);
    spherical((15 + 60 * uniform(&seed)) * PI / 180, 2 * PI * uniform(&seed), wo);
    const double all = shade_ref_kept_back(&p, n, wo, 100);
    const double off = fabs(shade_ref_kept_back(&p, n, wo, 0) - all);
    mean += off / POINTS;
    most = fmax(most, off);
    assert_true(all >= 0 && all < 0.9);
    total += all / POINTS;
  }
  print_message("four facets of each side: off by %.3f in the mean, %.3f at most\n", mean, most);
  assert_true(total > 0.05 && mean <= 0.035 && most <= 0.12);
}

/* Over whole maps that light has the right mean, whatever the slope and the lobe's width: what a
 * map shows is a mean, of points as large as the eye sees them. */
static void nodes_over_maps(void **state) {
  (void)state;
  static const shade_mdf kinds[] = {SHADE_MDF_ASHIKHMIN_SHIRLEY, SHADE_MDF_BECKMANN, SHADE_MDF_GGX};
  static const double alphas[] = {0.2, 0.4, 0.7}, spreads[] = {0.3, 0.7, 1.4};
  uint64_t seed = 33;
  enum { POINTS = 24 };
  for (int kind = 0; kind < 3; kind++) {
    double sum = 0, most = 0;
    for (int at = 0; at < 9; at++) {
      const double alpha = alphas[at / 3], spread = spreads[at % 3];
      double off = 0, weights = 0;
      for (int k = 0; k < POINTS; k++) {
        shade_params p;
        double n[3], wo[3];
        shade_params_init(&p);
        p.mdf = kinds[kind];
        p.horizon = SHADE_HORIZON_MUTUAL;
        shade_params_set_alphas(&p, alpha, alpha);
        p.slopes[2] = p.slopes[4] = spread * spread;
        normal_of(spread * gauss(&seed), spread * gauss(&seed), n);
        spherical((15 + 60 * uniform(&seed)) * PI / 180, 2 * PI * uniform(&seed), wo);
        const double seen = fmax(n[0] * wo[0] + n[1] * wo[1] + n[2] * wo[2], 0) / n[2];
        off += seen * (shade_ref_kept_back(&p, n, wo, 0) - shade_ref_kept_back(&p, n, wo, 40));
        weights += seen;
      }
      sum += off / weights / 9;
      most = fmax(most, fabs(off / weights));
    }
    print_message("%s: off by %+.3f in the mean of maps, %.3f at most\n",
                  shade_list_word(SHADE_LIST_MDF, (int)kinds[kind]), sum, most);
    assert_true(fabs(sum) <= 0.02 && most <= 0.06);
  }
}

/* Draws fall as their density says, and their mean f cos / pdf is finite. */
static void draws(void **state) {
  (void)state;
  enum { MATERIALS = 30, DRAWS = 20000, FINE = 10 };
  static double expected[BINS];
  static long counts[BINS];
  uint64_t seed = 34;
  double least = 1;
  for (int k = 0; k < MATERIALS / FEWER; k++) {
    shade_params p = random_params(&seed);
    p.mdf = (shade_mdf)(k % SHADE_MDF_COUNT);
    p.detail = (shade_detail)(1 + k % (SHADE_DETAIL_COUNT - 1));
    shade_params_set_exponents(&p, 3 + 15 * uniform(&seed), 3 + 15 * uniform(&seed));
    const shade_bsdf b = made(&p);
    double v[9];
    random_hit(&seed, &p, v);
    spherical(1.2 * uniform(&seed), 2 * PI * uniform(&seed), v + 6);
    shade_bsdf_hit hit;
    shade_bsdf_prepare(&b, v, v + 6, &hit);
    memset(counts, 0, sizeof counts);
    long lost = 0;
    for (int i = 0; i < DRAWS; i++) {
      const double u[2] = {uniform(&seed), uniform(&seed)};
      double wi[3], f[3], pdf, cosine, want[3];
      if (shade_bsdf_hit_sample(&b, &hit, u, wi, f, &pdf, &cosine) & SHADE_NO_SAMPLE) {
        lost++;
        continue;
      }
      counts[bin_of(wi[0], wi[1], wi[2])]++;
      if (i % 100 == 0) { /* what is told of a draw is what the others tell */
        shade_bsdf_hit_eval(&b, &hit, wi, want, NULL);
        assert_near(pdf, shade_bsdf_hit_pdf(&b, &hit, wi, NULL), 1e-9 * pdf);
        assert_near(f[0], want[0], 1e-9 * want[0]);
      }
    }
    for (int bin = 0; bin < BINS; bin++) {
      expected[bin] = 0;
      for (int point = 0; point < FINE * FINE; point++) {
        double w[3];
        bin_point(bin, point, FINE, w);
        expected[bin] += shade_bsdf_hit_pdf(&b, &hit, w, NULL) * 2 * PI / BINS / (FINE * FINE);
      }
    }
    const double chance = chi2(DRAWS, expected, counts, lost);
    if (chance < 1e-3)
      print_message("%s, %s: %.1e\n", shade_list_word(SHADE_LIST_MDF, (int)p.mdf),
                    shade_list_word(SHADE_LIST_DETAIL, (int)p.detail), chance);
    least = fmin(least, chance);
  }
  print_message("draws: least p-value %.1e\n", least);
  assert_true(least > 1e-5);
}

/* White metal under an even sky, over the points of a map with Gaussian slopes. */
static void furnace(void **state) {
  (void)state;
  uint64_t seed = 33;
  for (int size = 0; size < 4; size++) {
    const double slope = (double[]){0.3, 0.6, 1, 1.6}[size];
    shade_params p;
    shade_params_init(&p);
    p.mdf = SHADE_MDF_GGX;
    p.horizon = SHADE_HORIZON_MUTUAL;
    p.fresnel = SHADE_FRESNEL_NONE;
    shade_params_set_alphas(&p, 0.05, 0.05);
    p.slopes[2] = p.slopes[4] = slope * slope / 4;
    const shade_bsdf b = made(&p);
    double mean = 0, most = 0, least = 2;
    enum { POINTS = 60, DRAWS = 600 };
    for (int i = 0; i < POINTS / FEWER; i++) {
      double n[3], wo[3], sum = 0;
      shade_bsdf_hit hit;
      normal_of(slope / 2 * gauss(&seed), slope / 2 * gauss(&seed), n);
      spherical((15 + 60 * uniform(&seed)) * PI / 180, 2 * PI * uniform(&seed), wo);
      shade_bsdf_prepare(&b, n, wo, &hit);
      for (int k = 0; k < DRAWS; k++) {
        const double u[2] = {(k + 0.5) / DRAWS, fmod((k + 0.5) * 0.6180339887498949, 1)};
        double wi[3], f[3], pdf, cosine;
        shade_bsdf_hit_sample(&b, &hit, u, wi, f, &pdf, &cosine);
        sum += pdf > 0 ? f[0] * cosine / pdf / DRAWS : 0;
      }
      mean += sum / (POINTS / FEWER);
      most = fmax(most, sum);
      least = fmin(least, sum);
    }
    print_message("furnace, slope %g: mean %.3f, least %.3f, most %.3f\n", slope, mean, least,
                  most);
    assert_true(mean >= 0.98 && most <= 1.08);
  }
}

/* A flat facet seen from right above: what is kept back has no azimuth, and is no brighter for it.
 */
static void right_above(void **state) {
  (void)state;
  const double z[3] = {0, 0, 1};
  const float zf[3] = {0, 0, 1};
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++) {
    shade_params p;
    shade_params_init(&p);
    p.mdf = (shade_mdf)mdf;
    p.brdf = SHADE_BRDF_AUTO;
    p.horizon = SHADE_HORIZON_MUTUAL;
    p.fresnel = SHADE_FRESNEL_NONE;
    const double alpha = mdf == SHADE_MDF_GGX ? 0.3 : 0.6;
    shade_params_set_alphas(&p, alpha, alpha);
    p.slopes[2] = p.slopes[4] = 0.5;
    const shade_bsdf b = made(&p);
    enum { STEPS = 32 };
    double white = 0;
    assert_true(shade_ref_kept_back(&p, z, z, 0) > 0.01);
    for (int k = 0; k < 2 * STEPS * STEPS; k++) {
      const double height = (k / (2 * STEPS) + 0.5) / STEPS;
      double wi[3], f[3], cosine, want[3];
      float wf[3], ff[3], cosinef;
      spherical(acos(height), PI * (k % (2 * STEPS) + 0.5) / STEPS, wi);
      for (int c = 0; c < 3; c++)
        wf[c] = (float)wi[c];
      shade_bsdf_eval(&b, z, wi, z, f, &cosine);
      shade_bsdf_evalf(&b, zf, wf, zf, ff, &cosinef);
      shade_ref_f(&p, z, wi, z, want, &cosine);
      assert_near(f[0], want[0], 1e-11 * (want[0] + 1e-3));
      assert_near((double)ff[0], want[0], 1e-4 * (want[0] + 1e-3));
      white += f[0] * cosine * PI / (STEPS * STEPS);
    }
    print_message("right above, %s: %.3f\n", shade_list_word(SHADE_LIST_MDF, mdf), white);
    assert_true(white > 0 && white <= 1.08);
  }
}

/* Without slopes it is `hard`, to the last bit. Where all of a map is tilted alike, and about it is
 * little, it is nearly so: light of an even sky and of ones bright above and about. */
static void limits(void **state) {
  (void)state;
  enum { DRAWS = 1500 / FEWER, SKIES = 3 };
  uint64_t seed = 35;
  for (int k = 0; k < 200; k++) {
    shade_params p = random_params(&seed);
    double v[9], f[2][4], pdf[2];
    random_hit(&seed, &p, v);
    p.slopes[2] = p.slopes[3] = p.slopes[4] = 0;
    for (int hard = 0; hard < 2; hard++) {
      p.horizon = hard ? SHADE_HORIZON_HARD : SHADE_HORIZON_MUTUAL;
      const shade_bsdf b = made(&p);
      shade_bsdf_eval(&b, v, v + 3, v + 6, f[hard], &f[hard][3]);
      pdf[hard] = shade_bsdf_pdf(&b, v, v + 3, v + 6, NULL);
    }
    assert_memory_equal(f[0], f[1], sizeof f[0]);
    assert_true(pdf[0] == pdf[1]);
  }
  double worst[2] = {0};
  for (int tilt = 1; tilt < 4; tilt++)
    for (int eye = 0; eye < 6; eye++) {
      double light[3][SKIES] = {{0}}, n[3], wo[3];
      normal_of(0.35 * tilt, 0, n);
      spherical((15 + 30 * (eye % 3)) * PI / 180, eye / 3 * PI / 2 + 0.7, wo);
      if (wo[2] - 0.35 * tilt * wo[0] < 0.05)
        continue;                         /* behind the map */
      for (int way = 0; way < 3; way++) { /* hard, 1e-3, 1e-2 */
        shade_params p;
        shade_params_init(&p);
        p.mdf = SHADE_MDF_GGX;
        p.fresnel = SHADE_FRESNEL_NONE;
        p.horizon = way ? SHADE_HORIZON_MUTUAL : SHADE_HORIZON_HARD;
        shade_params_set_alphas(&p, 0.2, 0.2);
        p.slopes[0] = 0.35 * tilt;
        p.slopes[2] = p.slopes[4] = way == 1 ? 1e-3 : 1e-2;
        const shade_bsdf b = made(&p);
        for (int i = 0; i < DRAWS; i++) {
          const double u[2] = {(i + 0.5) / DRAWS, fmod((i + 0.5) * 0.6180339887498949, 1)};
          double wi[3], f[3], pdf, cosine;
          shade_bsdf_sample(&b, n, wo, u, wi, f, &pdf, &cosine);
          const double w = pdf > 0 ? f[0] * cosine / pdf / DRAWS : 0;
          light[way][0] += w;
          light[way][1] += w * (0.2 + 1.6 * wi[2]);
          light[way][2] += w * (1.8 - 1.6 * wi[2]);
        }
      }
      for (int way = 1; way < 3; way++)
        for (int sky = 0; sky < SKIES; sky++)
          worst[way - 1] = fmax(worst[way - 1],
                                fabs(light[way][sky] - light[0][sky]) / fmax(light[0][sky], 0.1));
    }
  print_message("tilted maps: Sigma 1e-3 off hard by %.4f, 1e-2 by %.4f\n", worst[0], worst[1]);
  assert_true(worst[0] <= 0.01 && worst[1] <= 0.04);
}

/* Slopes, lobes and grooves of each sample: batches on every instruction set give what the lane's
 * own material gives, and that the turned reference. */
static void each_sample(void **state) {
  (void)state;
  enum { COUNT = 40 };
  static double v[9][COUNT], slopes[5][COUNT], a[2][COUNT], groove[2][COUNT], u[2][COUNT];
  static double out[8][COUNT], f[4][COUNT], pdf[COUNT];
  uint64_t seed = 36;
  const shade_isa_table *isa;
  double worst = 0, worst_turned = 0;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    for (int k = 0; k < 12 / FEWER; k++) {
      shade_params p = random_params(&seed);
      const int turns = k & 1;
      for (int i = 0; i < COUNT; i++) {
        double at[9], own[5];
        random_slopes(&seed, 1, own);
        memcpy(p.slopes, own, sizeof own);
        random_hit(&seed, &p, at);
        const double angle = 2 * PI * uniform(&seed);
        for (int c = 0; c < 9; c++)
          v[c][i] = at[c];
        for (int c = 0; c < 5; c++)
          slopes[c][i] = i % 7 ? own[c] : 0;
        for (int c = 0; c < 2; c++) {
          a[c][i] = 0.05 + 0.5 * uniform(&seed);
          groove[c][i] = c ? sin(angle) : cos(angle);
          u[c][i] = uniform(&seed);
        }
      }
      const shade_bsdf b = made(&p);
      shade_lanes in = {.size = sizeof in, SHADE_DIRECTIONS(v)};
      in.slope_x = slopes[0], in.slope_y = slopes[1];
      in.slope_xx = slopes[2], in.slope_xy = slopes[3], in.slope_yy = slopes[4];
      in.ax = a[0], in.ay = a[1];
      if (turns)
        in.groove_x = groove[0], in.groove_y = groove[1];
      shade_sample_lanes from = {.size = sizeof from,
                                 .nx = v[0],
                                 .ny = v[1],
                                 .nz = v[2],
                                 .wox = v[6],
                                 .woy = v[7],
                                 .woz = v[8],
                                 .u1 = u[0],
                                 .u2 = u[1]};
      memcpy(&from.f0r, &in.f0r, sizeof from - offsetof(shade_sample_lanes, f0r));
      const shade_result result = {sizeof result, f[0], f[1], f[2], f[3]};
      const shade_sample_result drawn = {sizeof drawn, out[0], out[1], out[2], out[3],
                                         out[4],       out[5], out[6], out[7]};
      assert_int_equal(isa->entries->bsdf_batch(&b, COUNT, &in, &result), SHADE_OK);
      assert_int_equal(isa->entries->pdf_batch(&b, COUNT, &in, pdf), SHADE_OK);
      isa->entries->sample_batch(&b, COUNT, &from, &drawn);
      for (int i = 0; i < COUNT; i++) {
        double at[9], one[4], density, wi[3], g[3], q, cosine, turned[9], want[3];
        shade_bsdf own;
        for (int c = 0; c < 9; c++)
          at[c] = v[c][i];
        isa->entries->vary(&b, &in, (size_t)i, &own);
        isa->entries->bsdf(&own, at, at + 3, at + 6, one, &one[3]);
        isa->entries->pdf(&own, at, at + 3, at + 6, &density);
        isa->entries->sample(&own, at, at + 6, (double[2]){u[0][i], u[1][i]}, wi, g, &q, &cosine);
        for (int c = 0; c < 4; c++)
          worst = fmax(worst, fabs(f[c][i] - one[c]) / (one[c] + 1e-3));
        worst = fmax(worst, fabs(pdf[i] - density) / (density + 1e-3));
        if (!turns) /* else another draw of the same density */
          for (int c = 0; c < 3; c++)
            assert_near(wi[c], out[c][i], 1e-6);
        if (out[6][i] > 0) {
          isa->entries->pdf(&own, at, (double[3]){out[0][i], out[1][i], out[2][i]}, at + 6, &q);
          assert_near(q, out[6][i], 1e-6 * q);
        }
        /* the same material with its own numbers, looked at from the groove's frame */
        if (row || is_warp(p.detail))
          continue;
        shade_params same = p;
        const double angle = turns ? atan2(groove[1][i], groove[0][i]) : 0;
        const double c = cos(angle), s = sin(angle);
        shade_params_set_alphas(&same, a[0][i], a[1][i]);
        if (same.detail == SHADE_DETAIL_AUTO)
          same.detail = SHADE_DETAIL_ROTATE;
        same.slopes[0] = c * slopes[0][i] + s * slopes[1][i];
        same.slopes[1] = c * slopes[1][i] - s * slopes[0][i];
        same.slopes[2] = c * c * slopes[2][i] + 2 * c * s * slopes[3][i] + s * s * slopes[4][i];
        same.slopes[3] = c * s * (slopes[4][i] - slopes[2][i]) + (c * c - s * s) * slopes[3][i];
        same.slopes[4] = c * c * slopes[4][i] - 2 * c * s * slopes[3][i] + s * s * slopes[2][i];
        if (!(same.slopes[2] + same.slopes[4] > 1e-6))
          same.slopes[2] = same.slopes[3] = same.slopes[4] = 0;
        for (int w = 0; w < 9; w += 3)
          shade_ref_turned(angle, at + w, turned + w);
        if (same.groove == SHADE_GROOVE_AUTO && (same.ax > same.ay) != (p.ax > p.ay))
          continue; /* its nodes are those of exchanged axes */
        shade_ref_f(&same, turned, turned + 3, turned + 6, want, NULL);
        if (slopes[2][i] > 0 && kd_free(&same))
          worst_turned = fmax(worst_turned, fabs(want[0] - one[0]) / (want[0] + 1e-2));
      }
    }
  print_message("each sample: batches %.1e, against the turned reference %.1e\n", worst,
                worst_turned);
  assert_true(worst <= 1e-9 && worst_turned <= 1e-9);
}

/* Numbers that no map has: no NaN, nothing below 0. */
static void hostile(void **state) {
  (void)state;
  static const double odd[] = {0,     NAN,   INFINITY, -INFINITY, 1e6,  1e3, -1,
                               1e-12, 1e-30, 1e-300,   -0.0,      1e20, .25, .25};
  enum { ODD = sizeof odd / sizeof *odd };
  uint64_t seed = 37;
  for (int k = 0; k < 8000 / FEWER; k++) {
    shade_params p = random_params(&seed);
    shade_params_set_exponents(&p, pow(10, 6 * uniform(&seed)), pow(10, 6 * uniform(&seed)));
    double v[9], f[3], wi[3], pdf, cosine;
    float vf[9], ff[3], wif[3], pdff, cosinef;
    for (int c = 0; c < 5; c++)
      p.slopes[c] = odd[(int)(uniform(&seed) * ODD)] * (c < 2 && uniform(&seed) < 0.5 ? -1 : 1);
    if (k % 3 == 0) { /* singular: waves along one axis */
      p.slopes[2] = pow(10, 8 * uniform(&seed) - 2);
      p.slopes[4] = pow(10, 8 * uniform(&seed) - 2);
      p.slopes[3] = sqrt(p.slopes[2] * p.slopes[4]);
    }
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    spherical(1.5707963 * uniform(&seed), 2 * PI * uniform(&seed), v);
    spherical(PI * uniform(&seed), 2 * PI * uniform(&seed), v + 3);
    spherical(PI * uniform(&seed) * (k % 5 > 0), 2 * PI * uniform(&seed), v + 6);
    if (k % 11 == 0)
      memcpy(v + 6, v + 3, 3 * sizeof *v);
    for (int c = 0; c < 9; c++)
      vf[c] = (float)v[c];
    const double u[2] = {uniform(&seed), k % 2 ? uniform(&seed) : 0};
    const float uf[2] = {(float)u[0], (float)u[1]};
    shade_bsdf_eval(&b, v, v + 3, v + 6, f, &cosine);
    assert_true(f[0] >= 0 && f[1] >= 0 && isfinite(f[0] + f[1] + f[2]) && cosine >= 0);
    assert_true(isfinite(shade_bsdf_pdf(&b, v, v + 3, v + 6, NULL)));
    shade_bsdf_sample(&b, v, v + 6, u, wi, f, &pdf, &cosine);
    assert_true(pdf >= 0 && isfinite(pdf + f[0] + f[1] + f[2] + wi[0] + wi[1] + wi[2]));
    shade_bsdf_evalf(&b, vf, vf + 3, vf + 6, ff, &cosinef);
    assert_true(ff[0] >= 0 && ff[1] >= 0 && isfinite(ff[0] + ff[1] + ff[2]));
    assert_true(isfinite(shade_bsdf_pdff(&b, vf, vf + 3, vf + 6, NULL)));
    shade_bsdf_samplef(&b, vf, vf + 6, uf, wif, ff, &pdff, &cosinef);
    assert_true(pdff >= 0 && isfinite(pdff + ff[0] + ff[1] + ff[2] + wif[0] + wif[1] + wif[2]));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(against_reference), cmocka_unit_test(nodes),
      cmocka_unit_test(nodes_over_maps),   cmocka_unit_test(draws),
      cmocka_unit_test(furnace),           cmocka_unit_test(limits),
      cmocka_unit_test(each_sample),       cmocka_unit_test(hostile),
      cmocka_unit_test(right_above),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
