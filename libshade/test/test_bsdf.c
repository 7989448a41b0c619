/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 2.1 */
/* The BRDF's contract: values, horizons, batches, and input that makes no sense. */
#include <fenv.h>
#include <float.h>

#include "support.h"

static void random_triple(uint64_t *seed, double n[3], double wi[3], double wo[3]) {
  spherical(1.2 * uniform(seed), 2 * PI * uniform(seed), n);
  spherical(1.6 * uniform(seed), 2 * PI * uniform(seed), wi);
  spherical(1.6 * uniform(seed), 2 * PI * uniform(seed), wo);
}

/* Turn w about n until n.w is the cosine given. */
static void lower(const double n[3], double w[3], double cosine) {
  double d = 0, level = 0, length = 0;
  for (int c = 0; c < 3; c++)
    d += n[c] * w[c];
  for (int c = 0; c < 3; c++) {
    w[c] -= d * n[c];
    level += w[c] * w[c];
  }
  for (int c = 0; c < 3; c++) {
    w[c] = w[c] * sqrt((1 - cosine * cosine) / level) + cosine * n[c];
    length += w[c] * w[c];
  }
  for (int c = 0; c < 3; c++)
    w[c] /= sqrt(length);
}

static shade_params random_params(uint64_t *seed) {
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, pow(10, 3 * uniform(seed)), pow(10, 3 * uniform(seed)));
  random_choices(seed, &p);
  p.horizon = SHADE_HORIZON_HARD; /* test_horizon.c has the others */
  p.multiscatter = (shade_multiscatter)(*seed >> 20 & 1);
  int matt = uniform(seed) < 0.2;
  for (int c = 0; c < 3; c++) {
    p.kd[c] = matt ? uniform(seed) : 0;
    p.f0[c] = 0.3 + 0.7 * uniform(seed);
    p.f82[c] = 0.7 + 0.3 * uniform(seed); /* clear of where F itself cancels */
    p.eta[c] = 0.02 + 4 * uniform(seed);
    p.k[c] = 1 + 7 * uniform(seed);
  }
  return p;
}

/* One value by hand: flat, wi = wo = n = z, exponents 3 and 15: f = D/(4) = 8/(2 pi)/4 = 1/pi. */
static void by_hand(void **state) {
  (void)state;
  shade_bsdf b = make_bsdf(SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, 3, 15);
  double z[3] = {0, 0, 1}, f[3], cosine;
  assert_int_equal(shade_bsdf_eval(&b, z, z, z, f, &cosine), SHADE_OK);
  assert_near(f[0], 1 / PI, 1e-15);
  assert_true(cosine == 1);
  /* 60 degrees apart in the plane of y: h.wo = cos 30, h = z, Schlick at f0 = 0.04 */
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, 3, 15);
  p.f0[0] = p.f0[1] = p.f0[2] = 0.04;
  shade_bsdf_setup(&b, &p);
  double wi[3] = {0, .5, sqrt(.75)}, wo[3] = {0, -.5, sqrt(.75)};
  shade_bsdf_eval(&b, z, wi, wo, f, &cosine);
  double fresnel = 0.04 + 0.96 * pow(1 - sqrt(.75), 5);
  assert_near(f[2], fresnel * 4 / PI / (4 * .75), 1e-15);
  assert_near(cosine, sqrt(.75), 1e-15);
}

/* Light's and eye's cosines with the pole that the BRDF takes them from. */
static void cosines_of(const shade_params *p, const double n[3], const double wi[3],
                       const double wo[3], double *cosi, double *coso) {
  const double z[3] = {0, 0, 1}, *pole = p->detail == SHADE_DETAIL_NONE ? z : n;
  *cosi = *coso = 0;
  for (int c = 0; c < 3; c++) {
    *cosi += pole[c] * wi[c];
    *coso += pole[c] * wo[c];
  }
}

/*
 * Where a relative error means something: light and eye are above the horizon, which cosines
 * lose their digits at, and h is within the domain of the distributions and warps.
 */
static int well_inside(const shade_params *p, const double n[3], const double wi[3],
                       const double wo[3]) {
  double cosi, coso, h[3], m[3], length = 0;
  cosines_of(p, n, wi, wo, &cosi, &coso);
  for (int c = 0; c < 3; c++) {
    h[c] = wi[c] + wo[c];
    length += h[c] * h[c];
  }
  for (int c = 0; c < 3; c++)
    h[c] /= sqrt(length);
  shade_ref_carried(p, n, h, m);
  return fmin(cosi, coso) >= 1e-3 && m[2] >= (is_warp(p->detail) ? 0.5 : 0.05);
}

static void against_reference(void **state) {
  (void)state;
  uint64_t seed = 11;
  double worst = 0, worstf = 0, worst_warp = 0;
  int lit = 0;
  for (int k = 0; k < 100000; k++) {
    shade_params p = random_params(&seed);
    /* every other case is the metal of Ashikhmin and Shirley in a frame: held to grazing */
    int metal = k & 1;
    if (metal) {
      p.mdf = SHADE_MDF_ASHIKHMIN_SHIRLEY;
      p.brdf = SHADE_BRDF_ASHIKHMIN_SHIRLEY;
      p.detail = (shade_detail)(k / 2 % (SHADE_DETAIL_ROTATE + 1));
      p.fresnel = (shade_fresnel)(k / 8 % (SHADE_FRESNEL_SCHLICK + 1));
      p.kd[0] = p.kd[1] = p.kd[2] = 0;
    }
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    double n[3], wi[3], wo[3], f[3], want[3], cosine, want_cosine;
    random_triple(&seed, n, wi, wo);
    if (k % 8 >= 6) /* to the horizon */
      lower(n, k % 8 == 6 ? wi : wo, pow(10, -3 * uniform(&seed)));
    unsigned status = shade_bsdf_eval(&b, n, wi, wo, f, &cosine);
    assert_int_equal(status, shade_ref_f(&p, n, wi, wo, want, &want_cosine));
    assert_near(cosine, want_cosine, 1e-15);
    for (int c = 0; c < 3; c++) {
      /* at a horizon one rounding decides, and exp(-a) ends at 1e-304 */
      if (fmin(fmin(want_cosine, wi[2]), wo[2]) > 1e-6)
        assert_true(want[c] > 0 ? f[c] > 0 || want[c] < 1e-290 : f[c] == 0);
      if (want[c] < 1e-12 * bsdf_of(&b)->numbers.peak || !well_inside(&p, n, wi, wo))
        continue;
      lit++;
      worst = fmax(worst, fabs(f[c] - want[c]) / (want[c] + p.kd[c]));
    }
    /* float directions, taken as they are; the reference makes them unit */
    float fv[9], ff[3], cosinef;
    for (int c = 0; c < 3; c++) {
      n[c] = (double)(fv[c] = (float)n[c]);
      wi[c] = (double)(fv[3 + c] = (float)wi[c]);
      wo[c] = (double)(fv[6 + c] = (float)wo[c]);
    }
    shade_bsdf_evalf(&b, fv, fv + 3, fv + 6, ff, &cosinef);
    shade_ref_f(&p, n, wi, wo, want, &want_cosine);
    assert_near((double)cosinef, want_cosine, 5e-7);
    /* brdf.h: what the roundings of float cosines make of those that divide by them */
    double cosi, coso, grazing = 0;
    cosines_of(&p, n, wi, wo, &cosi, &coso);
    if (!metal)
      grazing = 1e-7 / cosi + 1e-7 / coso;
    for (int c = 0; c < 3; c++)
      if (want[c] >= 1e-12 * bsdf_of(&b)->numbers.peak &&
          (metal ? want_cosine >= 1e-3 : well_inside(&p, n, wi, wo))) {
        double *tally = is_warp(p.detail) ? &worst_warp : &worstf;
        double error = fabs((double)ff[c] - want[c]) / (want[c] + p.kd[c]);
        *tally = fmax(*tally, error - grazing);
      }
  }
  print_message("f: %d values, double %.1e, float %.1e, float warps %.1e\n", lit, worst, worstf,
                worst_warp);
  assert_true(lit > 10000);
  assert_true(worst <= 1e-12);
  assert_true(worstf <= 4e-5);
  assert_true(worst_warp <= 1e-4);
}

static void horizons(void **state) {
  (void)state;
  double n[3] = {.6, 0, .8}, up[3] = {.6, 0, .8}, f[3], cosine;
  const double below[3][3] = {
      {.6, 0, -.8},                 /* under the surface */
      {-.9, 0, .43588989435406733}, /* over the surface, under the perturbed horizon */
      {0, 1, 0},                    /* on the surface's horizon */
  };
  for (int d = SHADE_DETAIL_PERTURB; d < SHADE_DETAIL_COUNT; d++) {
    shade_bsdf b = make_bsdf((shade_detail)d, SHADE_GROOVE_AUTO, 20, 5);
    bsdf_in(&b)->horizon = SHADE_HORIZON_HARD;
    shade_bsdf_eval(&b, n, up, up, f, &cosine);
    assert_true(f[0] > 0 && fabs(cosine - 1) < 1e-15);
    for (int k = 0; k < 3; k++) {
      shade_bsdf_eval(&b, n, below[k], up, f, &cosine);
      assert_true(f[0] == 0 && f[1] == 0 && f[2] == 0);
      shade_bsdf_eval(&b, n, up, below[k], f, &cosine);
      assert_true(f[0] == 0 && f[1] == 0 && f[2] == 0);
    }
  }
  /* `none` looks at z alone */
  shade_bsdf b = make_bsdf(SHADE_DETAIL_NONE, SHADE_GROOVE_AUTO, 20, 5);
  shade_bsdf_eval(&b, n, below[1], up, f, &cosine);
  assert_true(f[0] > 0 && cosine == below[1][2]);
}

/* f(wi, wo) = f(wo, wi) for every specular part. */
static void reciprocity(void **state) {
  (void)state;
  uint64_t seed = 13;
  for (int k = 0; k < 50000; k++) {
    shade_params p = random_params(&seed);
    p.kd[0] = p.kd[1] = p.kd[2] = 0;         /* fibres are not reciprocal */
    p.multiscatter = SHADE_MULTISCATTER_OFF; /* nor is that */
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    double n[3], wi[3], wo[3], f[3], back[3];
    random_triple(&seed, n, wi, wo);
    shade_bsdf_eval(&b, n, wi, wo, f, NULL);
    shade_bsdf_eval(&b, n, wo, wi, back, NULL);
    for (int c = 0; c < 3; c++)
      assert_true(fabs(f[c] - back[c]) <= 1e-12 * f[c]);
  }
}

/* Any length, any alignment, every instruction set: the batch is the single call. */
static void batch_is_single(void **state) {
  (void)state;
  enum { MOST = 1100, INPUTS = 12 };
  static float in[INPUTS][MOST + 1], out[4][MOST + 2];
  static double ind[INPUTS][MOST + 1], outd[4][MOST + 2];
  const size_t lengths[] = {0, 1, 3, 15, 16, 17, 255, 256, 257, 1000};
  uint64_t seed = 5;
  const shade_isa_table *isa;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; k++) {
      size_t count = lengths[k], shift = k & 1;
      shade_params p = random_params(&seed);
      shade_bsdf b;
      shade_bsdf_setup(&b, &p);
      for (size_t i = 0; i < MOST; i++) {
        double v[9];
        random_triple(&seed, v, v + 3, v + 6);
        for (int c = 0; c < INPUTS; c++)
          ind[c][i] = (double)(in[c][i] = (float)(c < 9 ? v[c] : uniform(&seed)));
      }
      for (int c = 0; c < 4; c++)
        for (size_t i = 0; i < MOST; i++)
          outd[c][i] = out[c][i] = -7;
      int textured = k % 3 == 0;
      shade_lanesf lanesf = {.size = sizeof lanesf,
                             .nx = in[0] + shift,
                             .ny = in[1] + shift,
                             .nz = in[2] + shift,
                             .wix = in[3] + shift,
                             .wiy = in[4] + shift,
                             .wiz = in[5] + shift,
                             .wox = in[6] + shift,
                             .woy = in[7] + shift,
                             .woz = in[8] + shift};
      shade_lanes lanes = {.size = sizeof lanes,
                           .nx = ind[0] + shift,
                           .ny = ind[1] + shift,
                           .nz = ind[2] + shift,
                           .wix = ind[3] + shift,
                           .wiy = ind[4] + shift,
                           .wiz = ind[5] + shift,
                           .wox = ind[6] + shift,
                           .woy = ind[7] + shift,
                           .woz = ind[8] + shift};
      if (textured) {
        lanesf.f0r = in[9] + shift, lanesf.f0g = in[10] + shift, lanesf.f0b = in[11] + shift;
        lanes.f0r = ind[9] + shift, lanes.f0g = ind[10] + shift, lanes.f0b = ind[11] + shift;
      }
      shade_resultf resultf = {sizeof resultf, out[0] + shift, out[1] + shift, out[2] + shift,
                               out[3] + shift};
      shade_result result = {sizeof result, outd[0] + shift, outd[1] + shift, outd[2] + shift,
                             outd[3] + shift};
      isa->entriesf->bsdf_batch(&b, count, &lanesf, &resultf);
      isa->entries->bsdf_batch(&b, count, &lanes, &result);
      for (size_t i = shift; i < count + shift; i++) {
        double v[9], f[3], cosine;
        float vf[9], ff[3], cosinef;
        for (int c = 0; c < 9; c++)
          v[c] = (double)(vf[c] = in[c][i]);
        for (int c = 0; textured && c < 3; c++)
          p.f0[c] = (double)in[9 + c][i];
        shade_bsdf_setup(&b, &p);
        shade_bsdf_evalf(&b, vf, vf + 3, vf + 6, ff, &cosinef);
        shade_bsdf_eval(&b, v, v + 3, v + 6, f, &cosine);
        /* fused multiply-adds differ between instruction sets and shift cosines by a rounding */
        assert_near(outd[3][i], cosine, 1e-15);
        assert_near(out[3][i], cosinef, 3e-7);
        for (int c = 0; c < 3 && cosine > 1e-5; c++) {
          assert_true(fabs(outd[c][i] - f[c]) <=
                      1e-11 * (f[c] + 1e-30 * bsdf_of(&b)->numbers.peak));
          if (f[c] > 1e-6 * bsdf_of(&b)->numbers.peak)
            assert_true(fabsf(out[c][i] - ff[c]) <= 1e-4f * ff[c]);
        }
      }
      for (int c = 0; c < 4; c++) {
        assert_true(out[c][count + shift] == -7 && outd[c][count + shift] == -7);
        assert_true(!shift || (out[c][0] == -7 && outd[c][0] == -7));
      }
    }
}

/* Opposite but for a few roundings, which only the reference takes out: either status is right. */
/*
 * Arrays beyond the caches go in shorter blocks: each value, one without sense far from the start,
 * and what follows the end.
 */
enum { LONG = 40037, SENSELESS = 33333 };
static double long_in[9][LONG], long_out[4][LONG + 1];
static float long_inf[9][LONG], long_outf[4][LONG + 1];

static void long_arrays(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, 40, 10);
  p.brdf = SHADE_BRDF_ASHIKHMIN_SHIRLEY;
  p.detail = SHADE_DETAIL_ROTATE;
  uint64_t seed = 5;
  for (int i = 0; i < LONG; i++) {
    double v[9];
    random_triple(&seed, v, v + 3, v + 6);
    for (int c = 0; c < 9; c++) {
      long_inf[c][i] = (float)v[c];
      long_in[c][i] = v[c];
    }
  }
  long_in[4][SENSELESS] = NAN;
  long_inf[4][SENSELESS] = (float)NAN;
  const shade_isa_table *isa;
  for (int row = 0; (isa = shade_isa_pick(row)); row++)
    for (int k = 0; k < 3; k++) {
      /* D, the whole BRDF, and under a horizon that goes through blocks of its own */
      p.horizon = k == 2 ? SHADE_HORIZON_VALID_ESTEVEZ : SHADE_HORIZON_HARD;
      shade_bsdf b;
      assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
      for (int c = 0; c < 4; c++)
        long_out[c][LONG] = long_outf[c][LONG] = 7;
      double(*d)[LONG] = long_in;
      float(*f)[LONG] = long_inf;
      unsigned status, statusf;
      if (k == 0) {
        status = isa->entries->mdf_batch(&b, LONG, d[0], d[1], d[2], d[3], d[4], d[5], long_out[0]);
        statusf =
            isa->entriesf->mdf_batch(&b, LONG, f[0], f[1], f[2], f[3], f[4], f[5], long_outf[0]);
      } else {
        shade_lanes in = {.size = sizeof in, SHADE_DIRECTIONS(d)};
        shade_lanesf inf = {.size = sizeof inf, SHADE_DIRECTIONS(f)};
        shade_result out = {sizeof out, long_out[0], long_out[1], long_out[2], long_out[3]};
        shade_resultf outf = {sizeof outf, long_outf[0], long_outf[1], long_outf[2], long_outf[3]};
        status = isa->entries->bsdf_batch(&b, LONG, &in, &out);
        statusf = isa->entriesf->bsdf_batch(&b, LONG, &inf, &outf);
      }
      assert_true((status & SHADE_BAD_INPUT) && (statusf & SHADE_BAD_INPUT));
      assert_true(long_out[0][SENSELESS] == 0 && long_outf[0][SENSELESS] == 0);
      assert_true(long_out[k ? 3 : 0][LONG] == 7 && long_outf[k ? 3 : 0][LONG] == 7);
      for (int i = 0; i < LONG; i++) {
        double v[9], want[3], cosine = 0;
        if (i == SENSELESS)
          continue;
        for (int c = 0; c < 9; c++)
          v[c] = d[c][i];
        if (k == 0)
          want[0] = shade_ref_mdf(&p, v, v + 3);
        else
          shade_ref_f(&p, v, v + 3, v + 6, want, &cosine);
        /* of float only that it is the same sample: its errors are measured elsewhere */
        assert_near(long_out[0][i], want[0], 1e-12 * (1 + want[0]));
        assert_near((double)long_outf[0][i], want[0], 2e-3 * (1 + want[0]));
        if (k)
          assert_near(long_out[3][i], cosine, 1e-14);
      }
    }
}

static int nearly_opposite(const double a[3], const double b[3]) {
  double la = hypot(hypot(a[0], a[1]), a[2]), lb = hypot(hypot(b[0], b[1]), b[2]), sum = 0;
  for (int c = 0; c < 3; c++)
    sum += fabs(a[c] / la + b[c] / lb);
  return fabs(lb - 1) < 1e-13 && sum < 1e-12;
}

/*
 * A normal a little off unit length is made unit, in single calls and in batches. (The warps'
 * reference takes vectors as they are.)
 */
static void nearly_unit(void **state) {
  (void)state;
  const double n[3] = {.259, 0, .966}, wi[3] = {.6, 0, .8}, wo[3] = {-.28, 0, .96};
  for (int k = 0; k < 2 * SHADE_DETAIL_DEFORM_LINEAR; k++)
    for (double scale = 0.9995; scale < 1.0006; scale += 1e-4) {
      shade_params p;
      shade_params_init(&p);
      shade_params_set_exponents(&p, 1000, 100);
      p.detail = (shade_detail)(k / 2);
      p.horizon = k & 1 ? SHADE_HORIZON_HARD : SHADE_HORIZON_VALID_ESTEVEZ;
      shade_bsdf b;
      shade_bsdf_setup(&b, &p);
      double m[3] = {scale * n[0], 0, scale * n[2]}, f[3], want[3];
      shade_bsdf_eval(&b, m, wi, wo, f, NULL);
      shade_ref_f(&p, m, wi, wo, want, NULL);
      assert_near(f[0], want[0], 1e-9 * want[0]);
      float v[9], r[4];
      for (int c = 0; c < 3; c++) {
        v[c] = (float)m[c];
        v[3 + c] = (float)wi[c];
        v[6 + c] = (float)wo[c];
      }
      shade_lanesf in = {.size = sizeof in,
                         .nx = v,
                         .ny = v + 1,
                         .nz = v + 2,
                         .wix = v + 3,
                         .wiy = v + 4,
                         .wiz = v + 5,
                         .wox = v + 6,
                         .woy = v + 7,
                         .woz = v + 8};
      shade_resultf out = {sizeof out, r, r + 1, r + 2, r + 3};
      shade_bsdf_eval_batchf(&b, 1, &in, &out);
      assert_near((double)r[0], want[0], 1e-4 * want[0]);
    }
}

/* NaN, infinities, zeros, tiny, huge, below the horizon: a defined value and a status. */
static void senseless_input(void **state) {
  (void)state;
  const double odd[] = {0,        -0.0,      1,   -1,    1e-300,  -1e-300, 1e300, -1e300,      NAN,
                        INFINITY, -INFINITY, 0.5, 1e-40, DBL_MAX, DBL_MIN, 0.7,   DBL_TRUE_MIN};
  enum { ODD = sizeof odd / sizeof odd[0] };
  uint64_t seed = 9;
  unsigned seen = 0;
  for (int k = 0; k < 300000; k++) {
    shade_params p = random_params(&seed);
    if (k % 5 == 0)
      shade_params_set_exponents(&p, k % 2 ? 0 : 1e6, k % 3 ? 0 : 1e6);
    if (k % 7 == 0)
      shade_params_set_alphas(&p, k % 2 ? 1e-4 : 10, k % 3 ? 1e-4 : 10);
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    double v[9], f[3], cosine;
    float vf[9], ff[3], cosinef;
    int finite = 1;
    for (int c = 0; c < 9; c++) {
      v[c] = uniform(&seed) < 0.4 ? 2 * uniform(&seed) - 1 : odd[(int)(uniform(&seed) * ODD)];
      vf[c] = (float)v[c];
      finite &= isfinite(v[c]);
    }
    unsigned status = shade_bsdf_eval(&b, v, v + 3, v + 6, f, &cosine);
    shade_bsdf_evalf(&b, vf, vf + 3, vf + 6, ff, &cosinef);
    double want[3];
    unsigned want_status = shade_ref_f(&p, v, v + 3, v + 6, want, NULL);
    if (!nearly_opposite(v + 3, v + 6) && !nearly_opposite(v + 6, v + 3))
      assert_int_equal(status & SHADE_BAD_INPUT, want_status & SHADE_BAD_INPUT);
    assert_true(finite || (status & SHADE_BAD_INPUT));
    for (int c = 0; c < 3; c++) {
      assert_true(isfinite(f[c]) && f[c] >= 0);
      assert_true(isfinite(ff[c]) && ff[c] >= 0);
    }
    assert_true(cosine >= 0 && cosine < 1.01 && cosinef >= 0 && cosinef < 1.01f);
    unsigned mdf_status = 0;
    double d = shade_mdf_eval(&b, v, v + 3, &mdf_status);
    float df = shade_mdf_evalf(&b, vf, vf + 3, NULL);
    assert_true(isfinite(d) && d >= 0 && isfinite(df) && df >= 0);
    seen |= status | mdf_status;

    /* the batch agrees on what is senseless, and its neighbours do not suffer */
    float lane[9][3], rgb[4][3], good[3], good_cosine;
    const float fine[9] = {.28f, 0, .96f, .6f, 0, .8f, 0, .6f, .8f};
    for (int c = 0; c < 9; c++) {
      lane[c][0] = lane[c][2] = fine[c];
      lane[c][1] = vf[c];
    }
    shade_lanesf in = {.size = sizeof in, SHADE_DIRECTIONS(lane)};
    shade_resultf out = {sizeof out, rgb[0], rgb[1], rgb[2], rgb[3]};
    shade_bsdf_eval_batchf(&b, 3, &in, &out);
    shade_bsdf_evalf(&b, fine, fine + 3, fine + 6, good, &good_cosine);
    for (int c = 0; c < 3; c++) {
      assert_true(fabsf(rgb[c][0] - good[c]) <= 1e-4f * good[c] + 1e-20f);
      assert_true(fabsf(rgb[c][2] - good[c]) <= 1e-4f * good[c] + 1e-20f);
      assert_true(isfinite(rgb[c][1]) && rgb[c][1] >= 0);
    }
  }
  assert_int_equal(seen, SHADE_BAD_INPUT | SHADE_CLAMPED_NORMAL);

  shade_bsdf b = make_bsdf(SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, 20, 5);
  const double z[3] = {0, 0, 1}, x[3] = {1, 0, 0}, minus_x[3] = {-1, 0, 0};
  double f[3];
  assert_int_equal(shade_bsdf_eval(&b, z, x, minus_x, f, NULL), SHADE_BAD_INPUT);
  assert_true(f[0] == 0);
  const double sunk[3] = {.6, 0, -.8};
  assert_int_equal(shade_bsdf_eval(&b, sunk, z, z, f, NULL), SHADE_CLAMPED_NORMAL);
}

/*
 * The hardware's flags for invalid operations, overflow and division by zero stay down for
 * finite input, whatever the material: single calls in both precisions. test_soak.c has the
 * batches and every instruction set.
 */
static void no_exceptions(void **state) {
  (void)state;
  const double odd[] = {0,   1,     -1,  1e-300,  1e18,  -1e18,           0.5,
                        1e9, 1e-40, 0.7, DBL_MIN, 1e-20, (double)FLT_MAX, -1e30};
  enum { ODD = sizeof odd / sizeof odd[0] };
  const int trapped = FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO;
  uint64_t seed = 17;
  for (int k = 0; k < 300000; k++) {
    shade_params p = random_params(&seed);
    if (k % 5 == 0)
      shade_params_set_alphas(&p, k % 2 ? 1e-4 : 10, k % 3 ? 1e-4 : 10);
    if (k % 7 == 0)
      shade_params_set_exponents(&p, k % 2 ? 0 : 1e6, k % 3 ? 0 : 1e6);
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    double v[9], f[3], cosine;
    float vf[9], ff[3], cosinef;
    for (int c = 0; c < 9; c++) {
      v[c] = uniform(&seed) < 0.5 ? 2 * uniform(&seed) - 1 : odd[(int)(uniform(&seed) * ODD)];
      vf[c] = (float)v[c];
    }
    feclearexcept(FE_ALL_EXCEPT);
    shade_bsdf_eval(&b, v, v + 3, v + 6, f, &cosine);
    shade_mdf_eval(&b, v, v + 3, NULL);
    shade_diffuse_eval(p.diffuse, v, v + 3);
    assert_int_equal(fetestexcept(trapped), 0);
    shade_bsdf_evalf(&b, vf, vf + 3, vf + 6, ff, &cosinef);
    shade_mdf_evalf(&b, vf, vf + 3, NULL);
    shade_diffuse_evalf(p.diffuse, vf, vf + 3);
    assert_int_equal(fetestexcept(trapped), 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(by_hand),       cmocka_unit_test(against_reference),
      cmocka_unit_test(horizons),      cmocka_unit_test(nearly_unit),
      cmocka_unit_test(reciprocity),   cmocka_unit_test(batch_is_single),
      cmocka_unit_test(long_arrays),   cmocka_unit_test(senseless_input),
      cmocka_unit_test(no_exceptions),
  };
  return cmocka_run_group_tests_name("bsdf", tests, NULL, NULL);
}
