/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.2 */
/*
 * One bad lane among many: the batch says so wherever it lies, whatever comes after it, and all
 * other lanes are as they are without it. Normals that point inwards are mended to z = 1e-4, no
 * more and no less; random numbers beyond [0, 1) count as its ends.
 */
#include <string.h>

#include "support.h"
#include "shade/albedo.h"
#include "shade/fabric.h"
#include "shade/maps.h"
#include "shade/presets.h"
#include "shade/weave.h"

enum { COUNT = 1200, ARRAYS = 20 };
/* of a vector, of a block, of the arrays */
static const int places[] = {0,   1,   15,   16,   17,        255,      256,
                             511, 640, 1023, 1024, COUNT - 2, COUNT - 1};
enum { PLACES = sizeof places / sizeof places[0] };

enum { NX, NY, NZ, IX, IY, IZ, OX, OY, OZ, U1, U2, INPUTS };

static void fill(double in[INPUTS][COUNT]) {
  uint64_t random = 5;
  for (int i = 0; i < COUNT; i++) {
    double n[3], wi[3], wo[3];
    spherical(0.3 * uniform(&random), 6 * uniform(&random), n);
    spherical(0.6 * uniform(&random), 6 * uniform(&random), wi);
    spherical(0.6 * uniform(&random), 6 * uniform(&random), wo);
    for (int k = 0; k < 3; k++) {
      in[NX + k][i] = n[k];
      in[IX + k][i] = wi[k];
      in[OX + k][i] = wo[k];
    }
    in[U1][i] = 0.1 + 0.3 * uniform(&random);
    in[U2][i] = uniform(&random);
  }
}

static double in[INPUTS][COUNT], out[ARRAYS][COUNT];
static float inf[INPUTS][COUNT], outf[ARRAYS][COUNT];

/* Status bits of one kind of call over the first `count` lanes of in and inf. */
typedef unsigned call(const shade_bsdf *b, size_t count);

static unsigned call_eval(const shade_bsdf *b, size_t count) {
  const shade_lanes lanes = {.size = sizeof lanes, SHADE_DIRECTIONS(in)};
  const shade_result result = {sizeof result, out[0], out[1], out[2], out[3]};
  return shade_bsdf_eval_batch(b, count, &lanes, &result);
}
static unsigned call_evalf(const shade_bsdf *b, size_t count) {
  const shade_lanesf lanes = {.size = sizeof lanes, SHADE_DIRECTIONS(inf)};
  const shade_resultf result = {sizeof result, outf[0], outf[1], outf[2], outf[3]};
  return shade_bsdf_eval_batchf(b, count, &lanes, &result);
}
static unsigned call_pdf(const shade_bsdf *b, size_t count) {
  const shade_lanes lanes = {.size = sizeof lanes, SHADE_DIRECTIONS(in)};
  return shade_bsdf_pdf_batch(b, count, &lanes, out[0]);
}
static unsigned call_pdff(const shade_bsdf *b, size_t count) {
  const shade_lanesf lanes = {.size = sizeof lanes, SHADE_DIRECTIONS(inf)};
  return shade_bsdf_pdf_batchf(b, count, &lanes, outf[0]);
}
static unsigned call_mdf(const shade_bsdf *b, size_t count) {
  return shade_mdf_eval_batch(b, count, in[NX], in[NY], in[NZ], in[IX], in[IY], in[IZ], out[0]);
}
static unsigned call_mdff(const shade_bsdf *b, size_t count) {
  return shade_mdf_eval_batchf(b, count, inf[NX], inf[NY], inf[NZ], inf[IX], inf[IY], inf[IZ],
                               outf[0]);
}
/* what a draw may find no direction for says nothing here */
static unsigned call_sample(const shade_bsdf *b, size_t count) {
  const shade_sample_lanes lanes = {.size = sizeof lanes,
                                    .nx = in[NX],
                                    .ny = in[NY],
                                    .nz = in[NZ],
                                    .wox = in[OX],
                                    .woy = in[OY],
                                    .woz = in[OZ],
                                    .u1 = in[U1],
                                    .u2 = in[U2]};
  const shade_sample_result result = {sizeof result, out[0], out[1], out[2], out[3],
                                      out[4],        out[5], out[6], out[7]};
  return shade_bsdf_sample_batch(b, count, &lanes, &result) & ~(unsigned)SHADE_NO_SAMPLE;
}
static unsigned call_samplef(const shade_bsdf *b, size_t count) {
  const shade_sample_lanesf lanes = {.size = sizeof lanes,
                                     .nx = inf[NX],
                                     .ny = inf[NY],
                                     .nz = inf[NZ],
                                     .wox = inf[OX],
                                     .woy = inf[OY],
                                     .woz = inf[OZ],
                                     .u1 = inf[U1],
                                     .u2 = inf[U2]};
  const shade_sample_resultf result = {sizeof result, outf[0], outf[1], outf[2], outf[3],
                                       outf[4],       outf[5], outf[6], outf[7]};
  return shade_bsdf_sample_batchf(b, count, &lanes, &result) & ~(unsigned)SHADE_NO_SAMPLE;
}
static call *const calls[] = {call_eval, call_evalf, call_pdf,    call_pdff,
                              call_mdf,  call_mdff,  call_sample, call_samplef};
enum { CALLS = sizeof calls / sizeof calls[0] };

static void narrow(void) {
  for (int k = 0; k < INPUTS; k++)
    for (int i = 0; i < COUNT; i++)
      inf[k][i] = (float)in[k][i];
}

/* Lanes that differ from what they were; -1: more than one. */
static int changed(double before[ARRAYS][COUNT], float beforef[ARRAYS][COUNT]) {
  int lane = COUNT;
  for (int k = 0; k < ARRAYS; k++)
    for (int i = 0; i < COUNT; i++)
      if (memcmp(&before[k][i], &out[k][i], sizeof out[k][i]) ||
          memcmp(&beforef[k][i], &outf[k][i], sizeof outf[k][i])) {
        if (lane != COUNT && lane != i)
          return -1;
        lane = i;
      }
  return lane;
}

static void a_bad_lane_is_told(void **state) {
  (void)state;
  static double before[ARRAYS][COUNT];
  static float beforef[ARRAYS][COUNT];
  for (int brdf = 0; brdf < 2; brdf++) {
    shade_params p;
    shade_params_init(&p);
    shade_params_set_exponents(&p, 40, 10);
    p.brdf = brdf ? SHADE_BRDF_MICROFACET : SHADE_BRDF_ASHIKHMIN_SHIRLEY;
    p.mdf = brdf ? SHADE_MDF_GGX : SHADE_MDF_ASHIKHMIN_SHIRLEY;
    p.horizon = brdf ? SHADE_HORIZON_VALID_ESTEVEZ : SHADE_HORIZON_HARD;
    shade_bsdf b;
    shade_bsdf_setup(&b, &p);
    for (int c = 0; c < CALLS; c++) {
      fill(in);
      narrow();
      memset(out, 0, sizeof out);
      memset(outf, 0, sizeof outf);
      assert_int_equal(calls[c](&b, COUNT), SHADE_OK);
      memcpy(before, out, sizeof out);
      memcpy(beforef, outf, sizeof outf);
      for (int at = 0; at < PLACES; at++) {
        const int i = places[at], other = places[PLACES - 1 - at];
        fill(in);
        in[NZ][i] = -0.4; /* points inwards */
        narrow();
        assert_int_equal(calls[c](&b, COUNT), SHADE_CLAMPED_NORMAL);
        const int one = changed(before, beforef);
        assert_true(one == i || one == COUNT); /* COUNT: 0 before and after */
        fill(in);
        in[NY][i] = NAN;
        narrow();
        assert_int_equal(calls[c](&b, COUNT) & SHADE_BAD_INPUT, SHADE_BAD_INPUT);
        const int only = changed(before, beforef);
        assert_true(only == i || (only == COUNT && c >= CALLS - 2)); /* a draw may be 0 already */
        if (i == other)
          continue;
        fill(in);
        in[NZ][i] = -0.4;
        in[NX][other] = INFINITY; /* two kinds, each must be told */
        narrow();
        assert_int_equal(calls[c](&b, COUNT) & (SHADE_CLAMPED_NORMAL | SHADE_BAD_INPUT),
                         SHADE_CLAMPED_NORMAL | SHADE_BAD_INPUT);
      }
    }
  }
}

static void bits_are_added_to_those_of_the_caller(void **state) {
  (void)state;
  const shade_bsdf b = make_bsdf(SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, 40, 10);
  const double n[3] = {0, 0.6, -0.8}, up[3] = {0, 0, 1}, bad[3] = {NAN, 0, 1};
  const float nf[3] = {0, 0.6f, -0.8f}, upf[3] = {0, 0, 1}, badf[3] = {NAN, 0, 1};
  for (unsigned bits = 0; bits < 32; bits++) {
    unsigned status = bits;
    shade_bsdf_pdf(&b, up, up, up, &status);
    assert_int_equal(status, bits);
    shade_bsdf_pdf(&b, n, up, up, &status);
    assert_int_equal(status, bits | SHADE_CLAMPED_NORMAL);
    shade_bsdf_pdf(&b, bad, up, up, &status);
    assert_int_equal(status, bits | SHADE_CLAMPED_NORMAL | SHADE_BAD_INPUT);
    status = bits;
    shade_bsdf_pdff(&b, upf, upf, upf, &status);
    assert_int_equal(status, bits);
    shade_bsdf_pdff(&b, nf, upf, upf, &status);
    assert_int_equal(status, bits | SHADE_CLAMPED_NORMAL);
    shade_bsdf_pdff(&b, badf, upf, upf, &status);
    assert_int_equal(status, bits | SHADE_CLAMPED_NORMAL | SHADE_BAD_INPUT);
    status = bits;
    shade_mdf_eval(&b, up, up, &status);
    assert_int_equal(status, bits);
    shade_mdf_eval(&b, n, up, &status);
    assert_int_equal(status, bits | SHADE_CLAMPED_NORMAL);
    status = bits;
    shade_mdf_evalf(&b, upf, upf, &status);
    assert_int_equal(status, bits);
    shade_mdf_evalf(&b, nf, upf, &status);
    assert_int_equal(status, bits | SHADE_CLAMPED_NORMAL);
  }
  /* and the calls that set things up add to what is there */
  shade_weave_params w;
  shade_weave_params_init(&w);
  shade_draft *draft = shade_draft_named("plain");
  unsigned status = 16;
  w.warp.curve = 7;
  shade_weave *weave = shade_weave_create(draft, &w, &status);
  assert_int_equal(status, 16 | SHADE_CLAMPED_PARAMETER);
  shade_fabric_params p;
  shade_fabric_params_init(&p);
  p.mdf = (shade_mdf)99;
  shade_fabric_free(shade_fabric_create(weave, &p, &status));
  assert_int_equal(status, 16 | SHADE_CLAMPED_PARAMETER | SHADE_BAD_CHOICE);
  shade_weave_free(weave);
  shade_draft_free(draft);
}

static void bad_points_of_cloth_are_told(void **state) {
  (void)state;
  shade_draft *draft = shade_draft_named("twill_2_1");
  shade_weave *weave = shade_weave_create(draft, NULL, NULL);
  shade_fabric *fabric = shade_fabric_create(weave, NULL, NULL);
  const double wi[3] = {0.3, 0.2, sqrt(0.87)}, wo[3] = {-0.5, 0.1, sqrt(0.74)};
  static double u[COUNT], v[COUNT], tilt[COUNT], rgb[3][COUNT], before[COUNT];
  for (int at = -1; at < PLACES; at++) {
    for (int i = 0; i < COUNT; i++) {
      u[i] = 0.37 * i;
      v[i] = 0.61 * i;
    }
    shade_crossings crossings;
    memset(&crossings, 0, sizeof crossings);
    crossings.size = sizeof crossings;
    crossings.tx = tilt;
    if (at >= 0)
      u[places[at]] = NAN;
    assert_int_equal(shade_weave_lookup_batch(weave, COUNT, u, v, &crossings),
                     at < 0 ? SHADE_OK : SHADE_BAD_INPUT);
    for (int i = 0; i < COUNT; i++) {
      double s[3];
      const double uv[2] = {u[i], v[i]};
      const unsigned status = shade_fabric_eval(fabric, uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, s);
      assert_int_equal(status, at >= 0 && i == places[at] ? SHADE_BAD_INPUT : SHADE_OK);
      rgb[0][i] = s[0];
      if (at < 0)
        before[i] = s[0];
      else
        assert_true(rgb[0][i] == (i == places[at] ? 0 : before[i]));
    }
  }
  shade_fabric_free(fabric);
  shade_weave_free(weave);
  shade_draft_free(draft);
}

/* z <= 0 becomes 1e-4 and the rest keeps its proportions: against the reference, at that normal. */
static void inward_normals_get_that_z(void **state) {
  (void)state;
  static const double normals[][3] = {
      {0.8, 0.6, 0}, {0.6, -0.64, -0.48}, {-3, 4, -1}, {0, 1e-3, 0}};
  static const shade_detail details[] = {SHADE_DETAIL_PERTURB, SHADE_DETAIL_GRAM_SCHMIDT,
                                         SHADE_DETAIL_ROTATE, SHADE_DETAIL_SHORTEST_ARC};
  for (size_t d = 0; d < sizeof details / sizeof details[0]; d++)
    for (size_t k = 0; k < sizeof normals / sizeof normals[0]; k++) {
      shade_params p;
      shade_params_init(&p);
      shade_params_set_exponents(&p, 300, 30);
      p.detail = details[d];
      p.horizon = SHADE_HORIZON_HARD;
      shade_bsdf b;
      shade_bsdf_setup(&b, &p);
      const double l = sqrt(normals[k][0] * normals[k][0] + normals[k][1] * normals[k][1] +
                            normals[k][2] * normals[k][2]);
      const double x = normals[k][0] / l, y = normals[k][1] / l, z = 1e-4;
      const double r = sqrt(x * x + y * y + z * z);
      const double mended[3] = {x / r, y / r, z / r}, flat = hypot(x, y);
      /* to either side of the direction that the normal leans to, low */
      double wi[3], wo[3], f[3], cosine, want[3], want_cosine;
      const double turn = atan2(y / flat, x / flat);
      spherical(1.5, turn + 0.1, wi);
      spherical(1.52, turn - 0.2, wo);
      shade_ref_f(&p, mended, wi, wo, want, &want_cosine);
      assert_true(want[0] > 1e-3);
      assert_int_equal(shade_bsdf_eval(&b, normals[k], wi, wo, f, &cosine), SHADE_CLAMPED_NORMAL);
      assert_near(f[0] / want[0], 1, 1e-9);
      assert_near(cosine, want_cosine, 1e-12);
      const float nf[3] = {(float)normals[k][0], (float)normals[k][1], (float)normals[k][2]};
      const float wif[3] = {(float)wi[0], (float)wi[1], (float)wi[2]};
      const float wof[3] = {(float)wo[0], (float)wo[1], (float)wo[2]};
      float ff[3], cosinef;
      assert_int_equal(shade_bsdf_evalf(&b, nf, wif, wof, ff, &cosinef), SHADE_CLAMPED_NORMAL);
      assert_near((double)ff[0] / want[0], 1, 2e-4);
      in[NX][0] = normals[k][0], in[NY][0] = normals[k][1], in[NZ][0] = normals[k][2];
      for (int c = 0; c < 3; c++) {
        in[IX + c][0] = wi[c];
        in[OX + c][0] = wo[c];
      }
      narrow();
      assert_int_equal(call_eval(&b, 1) | call_evalf(&b, 1), SHADE_CLAMPED_NORMAL);
      assert_near(out[0][0] / want[0], 1, 1e-9);
      assert_near((double)outf[0][0] / want[0], 1, 2e-4);
      /* that this can tell 1e-4 from its neighbours */
      const double off[3] = {mended[0], mended[1], 1e-3};
      shade_ref_f(&p, off, wi, wo, f, &cosine);
      assert_true(fabs(f[0] / want[0] - 1) > 1e-3 || fabs(cosine - want_cosine) > 1e-5);
    }
}

static void random_numbers_beyond_their_range(void **state) {
  (void)state;
  const double below = nextafter(1, 0);
  const float belowf = nextafterf(1, 0);
  const double given[][2] = {{1, 0.5},  {0.5, 1},    {1, 1},  {1e9, 3},
                             {-1, 0.3}, {0.3, -0.0}, {-7, -7}};
  const double n[3] = {0.1, -0.2, sqrt(0.95)}, wo[3] = {0.5, 0.1, sqrt(0.74)};
  const float nf[3] = {(float)n[0], (float)n[1], (float)n[2]},
              wof[3] = {(float)wo[0], (float)wo[1], (float)wo[2]};
  int drawn = 0;
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int detail = 0; detail < SHADE_DETAIL_COUNT; detail++)
      for (int matt = 0; matt < 3; matt++) {
        shade_params p;
        shade_params_init(&p);
        shade_params_set_exponents(&p, 60, 15);
        p.mdf = (shade_mdf)mdf;
        p.detail = (shade_detail)detail;
        p.brdf = detail % 2 ? SHADE_BRDF_MICROFACET : SHADE_BRDF_ASHIKHMIN_SHIRLEY;
        p.horizon = (shade_horizon)(detail % SHADE_HORIZON_COUNT);
        p.diffuse = matt == 2 ? SHADE_DIFFUSE_FIBRE : SHADE_DIFFUSE_LAMBERT;
        for (int c = 0; c < 3; c++)
          p.kd[c] = 0.35 * matt;
        shade_bsdf b;
        shade_bsdf_setup(&b, &p);
        for (size_t k = 0; k < sizeof given / sizeof given[0]; k++) {
          double within[2], wi[2][3], f[2][3], pdf[2], cosine[2];
          float givenf[2], withinf[2], wif[2][3], ff[2][3], pdff[2], cosinef[2];
          for (int j = 0; j < 2; j++) {
            within[j] = fmin(fmax(given[k][j], 0), below);
            givenf[j] = (float)given[k][j];
            withinf[j] = fminf(fmaxf(givenf[j], 0), belowf);
          }
          const unsigned status =
              shade_bsdf_sample(&b, n, wo, given[k], wi[0], f[0], &pdf[0], &cosine[0]);
          assert_int_equal(status,
                           shade_bsdf_sample(&b, n, wo, within, wi[1], f[1], &pdf[1], &cosine[1]));
          assert_memory_equal(wi[0], wi[1], sizeof wi[0]);
          assert_true(pdf[0] == pdf[1] && isfinite(pdf[0]));
          const unsigned statusf =
              shade_bsdf_samplef(&b, nf, wof, givenf, wif[0], ff[0], &pdff[0], &cosinef[0]);
          assert_int_equal(statusf, shade_bsdf_samplef(&b, nf, wof, withinf, wif[1], ff[1],
                                                       &pdff[1], &cosinef[1]));
          assert_memory_equal(wif[0], wif[1], sizeof wif[0]);
          assert_true(pdff[0] == pdff[1] && isfinite(pdff[0]));
          assert_int_equal((status | statusf) & ~(unsigned)SHADE_NO_SAMPLE, SHADE_OK);
          if (status == SHADE_OK) {
            drawn++;
            assert_true(pdf[0] > 0);
            assert_near(wi[0][0] * wi[0][0] + wi[0][1] * wi[0][1] + wi[0][2] * wi[0][2], 1, 1e-12);
          }
          if (statusf == SHADE_OK) {
            assert_true(pdff[0] > 0);
            double l = 0;
            for (int c = 0; c < 3; c++)
              l += (double)wif[0][c] * (double)wif[0][c];
            assert_near(l, 1, 2e-6);
          }
        }
      }
  assert_true(drawn > 300);
}

/* Two structures of parameters make the same of themselves. */
static double made_of(const shade_params *p, unsigned *status) {
  const double n[3] = {0.28, 0, 0.96}, wi[3] = {0.6, 0, 0.8}, wo[3] = {0, 0.6, 0.8};
  shade_bsdf b;
  double f[3];
  *status = shade_bsdf_setup(&b, p);
  shade_bsdf_eval(&b, n, wi, wo, f, NULL);
  return f[0];
}

/* Parameters that nobody initialised, as in `= {0}`, are told, not silently another material; NULL
 * is the defaults. */
static void parameters_without_a_size(void **state) {
  (void)state;
  unsigned status, want = SHADE_BAD_INPUT;
  shade_params initial, empty;
  shade_params_init(&initial);
  memset(&empty, 0, sizeof empty);
  empty.ax = empty.ay = 0.3;
  const double usual = made_of(&initial, &status);
  assert_int_equal(status, SHADE_OK);
  assert_true(made_of(NULL, &status) == usual && status == SHADE_OK && usual > 0);
  for (empty.size = 0; empty.size < sizeof(size_t); empty.size++) {
    assert_true(made_of(&empty, &status) == usual);
    assert_int_equal(status, want);
  }
  empty.size = 0;
  const double covariance[3] = {0.01, 0, 0.02};
  double angle;
  shade_params wide, right;
  assert_int_equal(shade_params_widen(&empty, NULL, covariance, &wide, &angle), want);
  assert_int_equal(shade_params_widen(NULL, NULL, covariance, &right, &angle), SHADE_OK);
  assert_memory_equal(&wide, &right, sizeof wide);

  shade_bsdf_albedo *albedo = shade_bsdf_albedo_create(&empty, &status);
  assert_true(albedo && status == want);
  shade_bsdf_albedo_free(albedo);
  albedo = shade_bsdf_albedo_create(NULL, &status);
  assert_true(albedo && status == SHADE_OK);
  shade_bsdf_albedo_free(albedo);

  shade_draft *draft = shade_draft_named("plain");
  static const shade_weave_params yarns; /* zeros */
  static const shade_fabric_params cloth;
  status = 0;
  shade_weave *weave = shade_weave_create(draft, &yarns, &status);
  assert_true(weave && status == want);
  status = 0;
  shade_fabric *fabric = shade_fabric_create(weave, &cloth, &status);
  assert_true(fabric && status == want);
  shade_fabric_free(fabric);
  shade_weave_free(weave);
  shade_draft_free(draft);

  static const shade_scratch_params scratches;
  for (int given = 0; given < 2; given++) {
    shade_scratch_field *field = shade_scratch_create(given ? &scratches : NULL, &status);
    assert_non_null(field);
    assert_int_equal(status, given ? want : SHADE_OK);
    shade_scratch_free(field);
  }
  static const shade_slope_options options;
  const float pixels[3] = {0.8F, 0.5F, 0.9F};
  for (int given = 0; given < 2; given++) {
    shade_slope_map *map =
        shade_slope_map_create(pixels, 1, 1, 3, given ? &options : NULL, &status);
    shade_slopes s;
    assert_non_null(map);
    assert_int_equal(status, given ? want : SHADE_OK);
    shade_slope_lookup(map, 0, 0, NULL, &s);
    assert_near(s.mean[0], -0.75, 1e-6); /* (0.6, 0, 0.8): at its full strength */
    shade_slope_map_free(map);
  }
}

/* The same of what is not made ready: nothing is set, nothing written. */
static void structures_without_a_size(void **state) {
  (void)state;
  const unsigned want = SHADE_BAD_INPUT;
  static shade_params p, p_before; /* zeros */
  double roughness = 0, anisotropy = 0;
  int turned = 0;
  for (p.size = 0; p.size < sizeof(size_t); p.size++) {
    p_before = p;
    assert_int_equal(shade_params_set_exponents(&p, 20, 30), want);
    assert_int_equal(shade_params_set_alphas(&p, 0.2, 0.3), want);
    assert_int_equal(shade_params_set_roughness(&p, SHADE_ROUGHNESS_GLTF, 0.2, 0.3), want);
    assert_int_equal(shade_params_set_choice(&p, SHADE_LIST_MDF, SHADE_MDF_GGX), want);
    assert_int_equal(shade_params_set(&p, shade_param_find("ax"), &roughness), want);
    assert_false(shade_params_set_metal(&p, "gold"));
    assert_memory_equal(&p, &p_before, sizeof p);
    assert_true(
        shade_params_get_roughness(&p, SHADE_ROUGHNESS_GLTF, &roughness, &anisotropy, &turned) &
        want);
    assert_true(roughness > 0);
  }
  static shade_weave_params yarns;
  static const shade_weave_params zeros;
  shade_draft *draft = shade_draft_named("plain");
  draft->warp->thickness = draft->weft->thickness = draft->warp->spacing = draft->weft->spacing =
      0.1;
  assert_int_equal(shade_weave_params_set_twist(&yarns, SHADE_TOP_WARP, 'S', 0.5, 2, 0), want);
  assert_false(shade_weave_params_from_draft(&yarns, draft));
  assert_memory_equal(&yarns, &zeros, sizeof yarns);
  shade_weave_params_init(&yarns);
  assert_true(shade_weave_params_from_draft(&yarns, draft));
  shade_draft_free(draft);

  /* batches, of structures that are not there, too */
  shade_bsdf b = make_bsdf(SHADE_DETAIL_ROTATE, SHADE_GROOVE_AUTO, 200, 10);
  static const shade_lanes lanes;
  static const shade_lanesf lanesf;
  static const shade_result result;
  static const shade_sample_lanes draws;
  static const shade_sample_result drawn;
  static const shade_fabric_lanes cloth;
  static const shade_fabric_result seen;
  static const shade_albedo_lanesf below;
  static const shade_albedo_resultf albedos;
  static const shade_crossings crossings;
  static shade_fabric_point nowhere, here;
  static shade_fabric_pointf nowheref;
  shade_bsdf out;
  double pdf = -7, s[2][3];
  shade_bsdf_albedo *albedo = shade_bsdf_albedo_create(NULL, NULL);
  shade_preset preset;
  assert_true(shade_preset_find("denim", &preset));
  shade_weave *weave;
  shade_fabric *f = shade_preset_fabric(&preset, &weave, NULL);
  for (int there = 0; there < 2; there++) {
    assert_int_equal(shade_bsdf_eval_batch(&b, 1, there ? &lanes : NULL, there ? &result : NULL),
                     want);
    assert_int_equal(shade_bsdf_pdf_batch(&b, 1, there ? &lanes : NULL, &pdf), want);
    assert_int_equal(shade_bsdf_sample_batch(&b, 1, there ? &draws : NULL, there ? &drawn : NULL),
                     want);
    assert_int_equal(shade_bsdf_vary(&b, there ? &lanes : NULL, 0, &out), want);
    assert_int_equal(shade_bsdf_varyf(&b, there ? &lanesf : NULL, 0, &out), want);
    assert_int_equal(
        shade_bsdf_albedo_batchf(albedo, 1, there ? &below : NULL, there ? &albedos : NULL), want);
    assert_int_equal(
        shade_fabric_eval_batch(f, 1, there ? &cloth : NULL, SHADE_TIER_AUTO, there ? &seen : NULL),
        want);
    assert_int_equal(shade_fabric_sample_batch(f, 1, there ? &cloth : NULL, SHADE_TIER_AUTO,
                                               there ? &seen : NULL),
                     want);
    assert_int_equal(
        shade_fabric_prepare_batch(f, 1, there ? &cloth : NULL, SHADE_TIER_AUTO, s, NULL), want);
    assert_int_equal(shade_weave_lookup_batch(weave, 1, &pdf, &pdf, there ? &crossings : NULL),
                     want);
  }
  assert_true(pdf == -7);
  shade_bsdf_albedo_free(albedo);

  /* a point that nobody filled is that of the cloth's own numbers, and told; its weave may go */
  const double wo[3] = {0.1, 0.3, 0.95}, wi[3] = {0.3, -0.2, 0.93};
  const float wof[3] = {0.1F, 0.3F, 0.95F};
  shade_fabric_hit hit;
  shade_fabric_hitf hitf;
  shade_fabric_point_init(f, &here);
  assert_int_equal(shade_fabric_prepare(f, &here, wo, SHADE_TIER_AUTO, &hit, NULL), SHADE_OK);
  shade_fabric_hit_eval(f, &hit, wi, s[0]);
  shade_weave_free(weave);
  assert_int_equal(shade_fabric_prepare(f, &nowhere, wo, SHADE_TIER_AUTO, &hit, NULL), want);
  shade_fabric_hit_eval(f, &hit, wi, s[1]);
  assert_true(s[0][2] > 0);
  assert_memory_equal(s[0], s[1], sizeof s[0]);
  assert_int_equal(shade_fabric_preparef(f, &nowheref, wof, SHADE_TIER_AUTO, &hitf, NULL), want);
  shade_fabric_free(f);
  f = shade_preset_fabric(&preset, NULL, NULL);
  shade_fabric_prepare(f, NULL, wo, SHADE_TIER_AUTO, &hit, NULL);
  shade_fabric_hit_eval(f, &hit, wi, s[1]);
  assert_memory_equal(s[0], s[1], sizeof s[0]);
  shade_fabric_free(f);
}

static void in_words(void **state) {
  (void)state;
  const struct {
    unsigned bits;
    const char *text;
  } said[] = {{SHADE_OK, "ok"},
              {SHADE_CLAMPED_PARAMETER, "parameter clamped"},
              {SHADE_CLAMPED_NORMAL, "normal clamped"},
              {SHADE_BAD_INPUT, "bad input"},
              {SHADE_BAD_CHOICE, "unknown choice"},
              {SHADE_NO_SAMPLE, "no sample found"},
              {SHADE_CLAMPED_PARAMETER | SHADE_BAD_CHOICE, "parameter clamped, unknown choice"},
              {31, "parameter clamped, normal clamped, bad input, unknown choice, no sample found"},
              {32, "unknown bits"},
              {33, "parameter clamped, unknown bits"},
              {~0U,
               "parameter clamped, normal clamped, bad input, unknown choice, no sample found, "
               "unknown bits"}};
  for (size_t k = 0; k < sizeof said / sizeof said[0]; k++)
    assert_string_equal(shade_status_text(said[k].bits), said[k].text);
  char numbers[40];
  snprintf(numbers, sizeof numbers, "%d.%d.%d", SHADE_VERSION_MAJOR, SHADE_VERSION_MINOR,
           SHADE_VERSION_PATCH);
  assert_string_equal(shade_version(), SHADE_VERSION);
  assert_string_equal(numbers, SHADE_VERSION);
}

/* NULL where there is nothing to make something of, and where only the answer counts. */
static void nothing_given(void **state) {
  (void)state;
  unsigned status = 0;
  shade_weave *weave;
  assert_null(shade_slope_map_create(NULL, 1, 1, 3, NULL, &status));
  assert_int_equal(status, SHADE_BAD_INPUT);
  assert_null(shade_draft_from_matrix(2, 2, NULL));
  assert_null(shade_preset_fabric(NULL, &weave, NULL));
  assert_null(weave);
  assert_true(shade_preset_find("denim", NULL) && !shade_preset_find("denimm", NULL));
  assert_true(shade_param_row(0, NULL) && !shade_param_row(-1, NULL));
  assert_true(shade_metal_row(0, NULL) && !shade_metal_row(1000, NULL));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bad_lane_is_told),
      cmocka_unit_test(bits_are_added_to_those_of_the_caller),
      cmocka_unit_test(bad_points_of_cloth_are_told),
      cmocka_unit_test(inward_normals_get_that_z),
      cmocka_unit_test(random_numbers_beyond_their_range),
      cmocka_unit_test(parameters_without_a_size),
      cmocka_unit_test(structures_without_a_size),
      cmocka_unit_test(in_words),
      cmocka_unit_test(nothing_given),
  };
  return cmocka_run_group_tests_name("status", tests, NULL, NULL);
}
