/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Parameters of each sample: a lane is worth what a material set up with its parameters gives,
 * for f, density and draws, in the frame of its groove.
 */
#include <string.h>

#include "support.h"

enum { COUNT = 300, INPUTS = 9 };

typedef struct arrays {
  double in[INPUTS][COUNT], u[2][COUNT], out[8][COUNT];
  double ax[COUNT], ay[COUNT], f0[3][COUNT], f82[3][COUNT], eta[3][COUNT], k[3][COUNT],
      kd[3][COUNT], gx[COUNT], gy[COUNT];
} arrays;

static double between(uint64_t *seed, double low, double high) {
  return low * pow(high / low, uniform(seed));
}

static void fill(uint64_t *seed, arrays *a) {
  for (int i = 0; i < COUNT; i++) {
    double v[3];
    for (int k = 0; k < 3; k++) {
      spherical((k ? 1.3 : 0.9) * uniform(seed), 2 * PI * uniform(seed), v);
      for (int c = 0; c < 3; c++)
        a->in[3 * k + c][i] = v[c];
    }
    a->u[0][i] = uniform(seed);
    a->u[1][i] = uniform(seed);
    a->ax[i] = between(seed, 0.05, 1);
    a->ay[i] = between(seed, 0.05, 1);
    for (int c = 0; c < 3; c++) {
      a->f0[c][i] = uniform(seed);
      a->f82[c][i] = uniform(seed);
      a->eta[c][i] = between(seed, 0.1, 5);
      a->k[c][i] = 5 * uniform(seed);
      a->kd[c][i] = i % 7 ? uniform(seed) : 0;
    }
    const double angle = 2 * PI * uniform(seed), size = between(seed, 1e-3, 1e3);
    a->gx[i] = size * cos(angle);
    a->gy[i] = size * sin(angle);
  }
}

static shade_lanes lanes_of(const arrays *a) {
  shade_lanes in = {.size = sizeof in,
                    .nx = a->in[0],
                    .ny = a->in[1],
                    .nz = a->in[2],
                    .wix = a->in[3],
                    .wiy = a->in[4],
                    .wiz = a->in[5],
                    .wox = a->in[6],
                    .woy = a->in[7],
                    .woz = a->in[8]};
  return in;
}

/* The lane's own material. */
static shade_bsdf own(const shade_params *base, const arrays *a, int i, int colours) {
  shade_params p = *base;
  shade_bsdf b;
  shade_params_set_alphas(&p, a->ax[i], a->ay[i]);
  for (int c = 0; c < 3 && colours; c++) {
    p.f0[c] = a->f0[c][i];
    p.f82[c] = a->f82[c][i];
    p.eta[c] = a->eta[c][i];
    p.k[c] = a->k[c][i];
    p.kd[c] = a->kd[c][i];
  }
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  return b;
}

/* Direction k of lane i in the frame whose x is the lane's groove. */
static void turned(const arrays *a, int k, int i, double v[3]) {
  const double size = hypot(a->gx[i], a->gy[i]), c = a->gx[i] / size, s = a->gy[i] / size;
  const double x = a->in[3 * k][i], y = a->in[3 * k + 1][i];
  v[0] = c * x + s * y;
  v[1] = c * y - s * x;
  v[2] = a->in[3 * k + 2][i];
}

static int same(double got, double want, double scale) {
  return fabs(got - want) <= 1e-12 * (fabs(want) + scale);
}

static shade_params some_params(uint64_t *seed, int mdf, int k) {
  shade_params p;
  shade_params_init(&p);
  p.mdf = (shade_mdf)mdf;
  p.brdf = (shade_brdf)(uniform(seed) * SHADE_BRDF_COUNT);
  p.detail = (shade_detail)(k % SHADE_DETAIL_COUNT);
  p.groove = (shade_groove)(uniform(seed) * SHADE_GROOVE_COUNT);
  p.fresnel = (shade_fresnel)(uniform(seed) * SHADE_FRESNEL_COUNT);
  p.diffuse = (shade_diffuse)(uniform(seed) * SHADE_DIFFUSE_COUNT);
  p.horizon = (shade_horizon)(uniform(seed) * SHADE_HORIZON_COUNT);
  /* fibres of gram_schmidt keep the material's own axis */
  if (p.detail == SHADE_DETAIL_GRAM_SCHMIDT && p.groove == SHADE_GROOVE_AUTO)
    p.groove = SHADE_GROOVE_X;
  if (uniform(seed) < 0.3)
    shade_params_set_alphas(&p, 0.2, 0.2);
  return p;
}

/* f, the density of wi, and draws: their f and density are those of the direction that came. */
static void each_lane_is_a_material(void **state) {
  (void)state;
  static arrays a;
  uint64_t seed = 11;
  double worst = 0;
  int drawn = 0;
  for (int k = 0; k < 330; k++) {
    fill(&seed, &a);
    const shade_params p = some_params(&seed, k % SHADE_MDF_COUNT, k / SHADE_MDF_COUNT);
    const int colours = k % 3 != 0;
    shade_bsdf b;
    assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
    shade_lanes in = lanes_of(&a);
    in.ax = a.ax, in.ay = a.ay, in.groove_x = a.gx, in.groove_y = a.gy;
    if (colours) {
      in.f0r = a.f0[0], in.f0g = a.f0[1], in.f0b = a.f0[2];
      in.f82r = a.f82[0], in.f82g = a.f82[1], in.f82b = a.f82[2];
      in.etar = a.eta[0], in.etag = a.eta[1], in.etab = a.eta[2];
      in.kr = a.k[0], in.kg = a.k[1], in.kb = a.k[2];
      in.kdr = a.kd[0], in.kdg = a.kd[1], in.kdb = a.kd[2];
    }
    shade_result out = {sizeof out, a.out[0], a.out[1], a.out[2], a.out[3]};
    assert_int_equal(shade_bsdf_eval_batch(&b, COUNT, &in, &out), SHADE_OK);
    assert_int_equal(shade_bsdf_pdf_batch(&b, COUNT, &in, a.out[4]), SHADE_OK);
    for (int i = 0; i < COUNT; i++) {
      const shade_bsdf one = own(&p, &a, i, colours);
      double n[3], wi[3], wo[3], f[3], cosine;
      turned(&a, 0, i, n);
      turned(&a, 1, i, wi);
      turned(&a, 2, i, wo);
      shade_bsdf_eval(&one, n, wi, wo, f, &cosine);
      const double pdf = shade_bsdf_pdf(&one, n, wi, wo, NULL);
      /* narrow lobes: a rounding of h counts kx times (1e-12 of f at kx = 400, seen) */
      for (int c = 0; c < 3; c++) {
        assert_true(same(a.out[c][i], f[c], 1));
        worst = fmax(worst, fabs(a.out[c][i] - f[c]) / (f[c] + 1));
      }
      assert_true(same(a.out[3][i], cosine, 1) && same(a.out[4][i], pdf, 1));
    }
    /* draws */
    shade_sample_lanes from = {.size = sizeof from,
                               .nx = in.nx,
                               .ny = in.ny,
                               .nz = in.nz,
                               .wox = in.wox,
                               .woy = in.woy,
                               .woz = in.woz,
                               .u1 = a.u[0],
                               .u2 = a.u[1]};
    memcpy(&from.f0r, &in.f0r, sizeof in - offsetof(shade_lanes, f0r));
    shade_sample_result to = {sizeof to, a.in[3],  a.in[4],  a.in[5], a.out[0],
                              a.out[1],  a.out[2], a.out[4], a.out[3]};
    shade_bsdf_sample_batch(&b, COUNT, &from, &to);
    for (int i = 0; i < COUNT; i++) {
      if (!(a.out[4][i] > 0))
        continue;
      drawn++;
      const shade_bsdf one = own(&p, &a, i, colours);
      double n[3], wi[3], wo[3], f[3], cosine;
      turned(&a, 0, i, n);
      turned(&a, 1, i, wi);
      turned(&a, 2, i, wo);
      shade_bsdf_eval(&one, n, wi, wo, f, &cosine);
      const double pdf = shade_bsdf_pdf(&one, n, wi, wo, NULL);
      const double lobe = 1e-9; /* the direction was rounded once more; narrow lobes see it */
      for (int c = 0; c < 3; c++)
        assert_true(fabs(a.out[c][i] - f[c]) <= lobe * (f[c] + 1));
      assert_true(fabs(a.out[4][i] - pdf) <= lobe * (pdf + 1));
    }
  }
  print_message("worst f: %.1e; %d draws\n", worst, drawn);
  assert_true(drawn > 40000);
}

/* Out of range is clamped, NaN the material's own, and the status tells. */
static void out_of_range(void **state) {
  (void)state;
  static arrays a;
  uint64_t seed = 5;
  fill(&seed, &a);
  shade_params p;
  shade_bsdf b;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_GGX;
  shade_params_set_alphas(&p, 0.3, 0.1);
  shade_bsdf_setup(&b, &p);
  const double odd[] = {-1, 0, 100, INFINITY, -INFINITY, NAN, 1e300};
  for (size_t k = 0; k < sizeof odd / sizeof odd[0]; k++) {
    double want[3], f[3], unused;
    shade_params q = p;
    shade_bsdf own_lane;
    if (!isnan(odd[k]))
      shade_params_set_alphas(&q, odd[k], 0.1);
    shade_bsdf_setup(&own_lane, &q);
    const double n[3] = {0.1, 0.2, sqrt(0.95)}, wi[3] = {0.28, 0, 0.96}, wo[3] = {0, 0.6, 0.8};
    shade_bsdf_eval(&own_lane, n, wi, wo, want, NULL);
    shade_lanes in = {.size = sizeof in,
                      .nx = n,
                      .ny = n + 1,
                      .nz = n + 2,
                      .wix = wi,
                      .wiy = wi + 1,
                      .wiz = wi + 2,
                      .wox = wo,
                      .woy = wo + 1,
                      .woz = wo + 2,
                      .ax = odd + k};
    const shade_result out = {sizeof out, f, f + 1, f + 2, &unused};
    assert_int_equal(shade_bsdf_eval_batch(&b, 1, &in, &out), SHADE_CLAMPED_PARAMETER);
    assert_true(same(f[0], want[0], 1e-12));
    in.ax = NULL;
    in.kdr = odd + k;
    const double kd = odd[k] > 1 ? 1 : 0;
    q = p;
    q.kd[0] = kd;
    shade_bsdf_setup(&own_lane, &q);
    shade_bsdf_eval(&own_lane, n, wi, wo, want, NULL);
    assert_int_equal(shade_bsdf_eval_batch(&b, 1, &in, &out),
                     odd[k] == 0 ? SHADE_OK : SHADE_CLAMPED_PARAMETER);
    assert_true(same(f[0], want[0], 1e-12) && same(f[1], want[1], 1e-12));
  }
}

/* One part alone: the parts of f add up, and draws of each have its density. */
static void parts(void **state) {
  (void)state;
  static arrays a;
  uint64_t seed = 6;
  fill(&seed, &a);
  shade_params p;
  shade_bsdf b, lobe;
  shade_params_init(&p);
  p.mdf = SHADE_MDF_BECKMANN;
  p.brdf = SHADE_BRDF_MICROFACET;
  p.kd[0] = p.kd[1] = p.kd[2] = 0.5;
  shade_bsdf_setup(&b, &p);
  p.kd[0] = p.kd[1] = p.kd[2] = 0;
  shade_bsdf_setup(&lobe, &p);
  shade_lanes in = lanes_of(&a);
  double sum[COUNT] = {0}, whole[COUNT], pdf[COUNT];
  for (size_t part = 0; part <= SHADE_PART_DIFFUSE; part++) {
    in.parts = part;
    const shade_result out = {sizeof out, a.out[0], a.out[1], a.out[2], a.out[3]};
    assert_int_equal(shade_bsdf_eval_batch(&b, COUNT, &in, &out), SHADE_OK);
    assert_int_equal(shade_bsdf_pdf_batch(&b, COUNT, &in, pdf), SHADE_OK);
    for (int i = 0; i < COUNT; i++) {
      const double n[3] = {a.in[0][i], a.in[1][i], a.in[2][i]},
                   wi[3] = {a.in[3][i], a.in[4][i], a.in[5][i]},
                   wo[3] = {a.in[6][i], a.in[7][i], a.in[8][i]};
      if (part == 0)
        whole[i] = a.out[0][i];
      else
        sum[i] += a.out[0][i];
      if (part == SHADE_PART_SPECULAR)
        assert_true(same(pdf[i], shade_bsdf_pdf(&lobe, n, wi, wo, NULL), 1));
    }
  }
  for (int i = 0; i < COUNT; i++)
    assert_true(same(sum[i], whole[i], 1));
  in.parts = 4;
  const shade_result out = {sizeof out, a.out[0], a.out[1], a.out[2], a.out[3]};
  assert_int_equal(shade_bsdf_eval_batch(&b, COUNT, &in, &out), SHADE_BAD_CHOICE);
  assert_true(a.out[0][7] == whole[7]);
}

/* Nothing specular: every draw is a diffuse one, and Lambert's weight is kd itself. */
static void no_specular_part(void **state) {
  (void)state;
  uint64_t seed = 8;
  shade_params p;
  shade_bsdf b;
  shade_params_init(&p);
  p.fresnel = SHADE_FRESNEL_NONE;
  p.f0[0] = p.f0[1] = p.f0[2] = 0;
  p.kd[0] = p.kd[1] = p.kd[2] = 0.5;
  shade_bsdf_setup(&b, &p);
  const double z[3] = {0, 0, 1}, wo[3] = {0.6, 0, 0.8};
  for (int i = 0; i < 2000; i++) {
    const double u[2] = {uniform(&seed), uniform(&seed)};
    double wi[3], f[3], pdf, cosine;
    assert_int_equal(shade_bsdf_sample(&b, z, wo, u, wi, f, &pdf, &cosine), SHADE_OK);
    assert_true(same(f[1] * cosine / pdf, 0.5, 0));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(each_lane_is_a_material),
                                     cmocka_unit_test(out_of_range), cmocka_unit_test(parts),
                                     cmocka_unit_test(no_specular_part)};
  return cmocka_run_group_tests_name("varied", tests, NULL, NULL);
}
