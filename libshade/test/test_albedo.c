/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 1.0 */
/* Directional albedos against a quadrature of the reference, for every choice. */
#include "support.h"

#include <string.h>

#include "reference/reference.h"
#include "shade/albedo.h"

/* Half vectors laid over the slopes, where every lobe has its size: dwi = 4 (h.wo) dh. */
#ifdef SANITIZED
enum { EVERY = 5 }; /* combinations; each of the lists' entries comes all the same */
#else
enum { EVERY = 1 };
#endif
enum { RINGS = 80, SPOKES = 64 };

static void specular_of(const shade_params *p, const double wo[3], double rgb[3]) {
  const double n[3] = {0, 0, 1};
  shade_params q = *p;
  q.kd[0] = q.kd[1] = q.kd[2] = 0;
  rgb[0] = rgb[1] = rgb[2] = 0;
  for (int i = 0; i < RINGS * SPOKES; i++) {
    const double s = (i / SPOKES + 0.5) / RINGS, phi = 2 * PI * (i % SPOKES + 0.5) / SPOKES;
    const double r = s / (1 - s), dr = 1 / ((1 - s) * (1 - s)) / RINGS;
    const double sx = q.ax * r * cos(phi), sy = q.ay * r * sin(phi);
    const double z = 1 / sqrt(1 + sx * sx + sy * sy);
    const double dh = z * z * z * q.ax * q.ay * r * dr * 2 * PI / SPOKES;
    const double h[3] = {sx * z, sy * z, z};
    const double d = h[0] * wo[0] + h[1] * wo[1] + h[2] * wo[2];
    if (!(d > 0))
      continue;
    const double wi[3] = {2 * d * h[0] - wo[0], 2 * d * h[1] - wo[1], 2 * d * h[2] - wo[2]};
    double f[3], cosine;
    shade_ref_f(&q, n, wi, wo, f, &cosine);
    for (int c = 0; c < 3; c++)
      rgb[c] += f[c] * cosine * 4 * d * dh;
  }
}

static void diffuse_of(const shade_params *p, const double wo[3], double rgb[3]) {
  enum { Z = 24, PHI = 48 };
  const double n[3] = {0, 0, 1};
  shade_params q = *p;
  q.fresnel = SHADE_FRESNEL_NONE;
  rgb[0] = rgb[1] = rgb[2] = 0;
  for (int i = 0; i < Z * PHI; i++) {
    const double z = (i / PHI + 0.5) / Z, phi = 2 * PI * (i % PHI + 0.37) / PHI;
    const double wi[3] = {sqrt(1 - z * z) * cos(phi), sqrt(1 - z * z) * sin(phi), z};
    double with[3], without[3], cosine;
    shade_params lobe = q;
    lobe.kd[0] = lobe.kd[1] = lobe.kd[2] = 0;
    shade_ref_f(&q, n, wi, wo, with, &cosine);
    shade_ref_f(&lobe, n, wi, wo, without, &cosine);
    for (int c = 0; c < 3; c++)
      rgb[c] += (with[c] - without[c]) * cosine * 2 * PI / (Z * PHI);
  }
}

static void direction(double cosine, double azimuth, double wo[3]) {
  wo[0] = sqrt(1 - cosine * cosine) * cos(azimuth);
  wo[1] = sqrt(1 - cosine * cosine) * sin(azimuth);
  wo[2] = cosine;
}

static shade_bsdf_albedo *create(const shade_params *p) {
  unsigned status = 99;
  shade_bsdf_albedo *a = shade_bsdf_albedo_create(p, &status);
  assert_non_null(a);
  assert_int_equal(status, SHADE_OK);
  return a;
}

static void every_lobe(void **state) {
  (void)state;
  const double places[][2] = {{0.93, 0.4}, {0.41, 1.3}, {0.13, 2.6}, {0.05, -0.8}};
  const double alphas[][2] = {{0.3, 0.3}, {0.5, 0.12}, {0.05, 0.15}};
  double worst = 0;
  int turn = 0;
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int brdf = 0; brdf < SHADE_BRDF_AUTO; brdf++)
      for (int fresnel = 0; fresnel < SHADE_FRESNEL_COUNT; fresnel++, turn++) {
        if ((mdf + brdf + fresnel) % EVERY)
          continue;
        shade_params p;
        shade_params_init(&p);
        p.mdf = (shade_mdf)mdf;
        p.brdf = (shade_brdf)brdf;
        p.fresnel = (shade_fresnel)fresnel;
        shade_params_set_alphas(&p, alphas[turn % 3][0], alphas[turn % 3][1]);
        for (int c = 0; c < 3; c++) {
          p.f0[c] = (double[]){0.04, 0.5, 1}[c];
          p.f82[c] = (double[]){0.3, 0.9, 1}[c];
          p.eta[c] = (double[]){1.5, 0.2, 2.8}[c];
          p.k[c] = (double[]){0, 3.4, 1.5}[c];
          p.kd[c] = 0.3;
        }
        shade_bsdf_albedo *a = create(&p);
        double wo[3], want[3], got[3];
        const int i = (turn + brdf) % 4;
        direction(places[i][0], places[i][1], wo);
        specular_of(&p, wo, want);
        assert_int_equal(shade_bsdf_albedo_eval(a, NULL, wo, got, NULL), SHADE_OK);
        for (int c = 0; c < 3; c++) {
          const double off = fabs(got[c] - want[c]) / (want[c] < 1.2 ? 0.02 : 0.15 * want[c]);
          if (off > 1)
            print_message("mdf %d brdf %d fresnel %d alphas %g %g place %d channel %d: %.4f for "
                          "%.4f\n",
                          mdf, brdf, fresnel, p.ax, p.ay, i, c, got[c], want[c]);
          worst = fmax(worst, off);
        }
        shade_bsdf_albedo_free(a);
      }
  print_message("specular: %.2f of the bound\n", worst);
  assert_true(worst <= 1);
}

static void every_diffuse_model(void **state) {
  (void)state;
  const double places[][2] = {{0.9, 0.4}, {0.35, 1.3}, {0.06, -0.7}};
  double worst = 0;
  for (int diffuse = 0; diffuse < SHADE_DIFFUSE_COUNT; diffuse++) {
    if (diffuse == SHADE_DIFFUSE_POULIN_FOURNIER)
      continue; /* the kernel gives fibre_view for it; the reference does not */
    for (int groove = SHADE_GROOVE_AUTO; groove < SHADE_GROOVE_COUNT; groove++) {
      shade_params p;
      shade_params_init(&p);
      p.diffuse = (shade_diffuse)diffuse;
      p.groove = (shade_groove)groove;
      shade_params_set_exponents(&p, 30, 3);
      for (int c = 0; c < 3; c++) {
        p.kd[c] = (double[]){1, 0.4, 0}[c];
        p.f0[c] = (double[]){0.1, 0.5, 0.2}[c];
      }
      shade_bsdf_albedo *a = create(&p);
      for (int i = 0; i < 3; i++) {
        double wo[3], want[3], got[3];
        direction(places[i][0], places[i][1], wo);
        diffuse_of(&p, wo, want);
        shade_bsdf_albedo_eval(a, NULL, wo, NULL, got);
        for (int c = 0; c < 3; c++) {
          const double off = fabs(got[c] - want[c]);
          if (off > 0.005)
            print_message("diffuse %d groove %d place %d channel %d: %.4f for %.4f\n", diffuse,
                          groove, i, c, got[c], want[c]);
          worst = fmax(worst, off);
        }
      }
      shade_bsdf_albedo_free(a);
    }
  }
  print_message("diffuse: %.4f off\n", worst);
  assert_true(worst <= 0.005);
}

/* Where Duer's lobe grows without end: exact at the first ring, which is all that is below it. */
static void grazing(void **state) {
  (void)state;
  const double rings[] = {0.01, 0.02, 1 / 31.0}; /* of the root of wo.z */
  shade_params p;
  shade_params_init(&p);
  p.brdf = SHADE_BRDF_WARD_DUR;
  p.fresnel = SHADE_FRESNEL_NONE;
  shade_params_set_alphas(&p, 0.3, 0.3);
  shade_bsdf_albedo *a = create(&p);
  for (int i = 0; i < 3; i++) {
    const double root = fmax(rings[i], 0.02);
    double wo[3], want[3], got[3];
    direction(root * root, 0.4, wo);
    specular_of(&p, wo, want);
    direction(rings[i] * rings[i], 0.4, wo);
    shade_bsdf_albedo_eval(a, NULL, wo, got, NULL);
    assert_near(got[0], want[0], 0.01 * want[0]);
  }
  shade_bsdf_albedo_free(a);
}

/* What the white furnace promises: a microfacet lobe gives back no more than it gets. */
static void white_furnace(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    shade_params p;
    shade_params_init(&p);
    p.mdf = k % 2 ? SHADE_MDF_GGX : SHADE_MDF_BECKMANN;
    p.brdf = SHADE_BRDF_MICROFACET;
    p.fresnel = SHADE_FRESNEL_NONE;
    shade_params_set_alphas(&p, 0.4, k < 2 ? 0.4 : 0.1);
    p.f0[0] = p.f0[1] = p.f0[2] = 1;
    shade_bsdf_albedo *a = create(&p);
    double least = 2;
    for (double z = 0.001; z <= 1; z += 0.0093)
      for (double phi = 0; phi < 6.3; phi += 0.21) {
        double wo[3], s[3], d[3];
        direction(z, phi, wo);
        shade_bsdf_albedo_eval(a, NULL, wo, s, d);
        assert_true(s[0] <= 1 + 1e-3 && s[0] == s[1] && d[0] == 0);
        least = fmin(least, s[0]);
      }
    assert_true(least > 0.5);
    shade_bsdf_albedo_free(a);
  }
}

/* A bump that stands alone has the albedo of the plate seen in its frame. */
static void normals(void **state) {
  (void)state;
  for (int groove = SHADE_GROOVE_X; groove <= SHADE_GROOVE_Y; groove++) {
    shade_params p;
    shade_params_init(&p);
    p.groove = (shade_groove)groove;
    p.brdf = SHADE_BRDF_MICROFACET;
    p.mdf = SHADE_MDF_GGX;
    p.fresnel = SHADE_FRESNEL_NONE;
    shade_params_set_alphas(&p, 0.1, 0.8);
    shade_bsdf_albedo *a = create(&p);
    uint64_t seed = 3;
    for (int i = 0; i < 300; i++) {
      const double tilt = uniform(&seed), phi = 6.3 * uniform(&seed);
      const double n[3] = {2 * sin(tilt) * cos(phi), 2 * sin(tilt) * sin(phi), 2 * cos(tilt)};
      double wo[3], carried[3], got[3], want[3];
      direction(0.1 + 0.9 * uniform(&seed), 6.3 * uniform(&seed), wo);
      shade_params rotate = p;
      rotate.detail = SHADE_DETAIL_ROTATE;
      shade_ref_carried(&rotate, n, wo, carried);
      shade_bsdf_albedo_eval(a, n, wo, got, NULL);
      shade_bsdf_albedo_eval(a, NULL, carried, want, NULL);
      for (int c = 0; c < 3; c++)
        assert_near(got[c], want[c], 1e-9);
      /* one from behind is raised to where it grazes */
      const double behind[3] = {sin(tilt) * cos(phi), sin(tilt) * sin(phi), -cos(tilt)};
      const double raised[3] = {behind[0], behind[1], 1e-4};
      assert_int_equal(shade_bsdf_albedo_eval(a, behind, wo, got, NULL), SHADE_CLAMPED_NORMAL);
      shade_bsdf_albedo_eval(a, raised, wo, want, NULL);
      for (int c = 0; c < 3; c++)
        assert_near(got[c], want[c], 1e-9);
      /* nearly unit is made unit, too */
      const double longer[3] = {1.003 * wo[0], 1.003 * wo[1], 1.003 * wo[2]};
      shade_bsdf_albedo_eval(a, NULL, longer, got, NULL);
      shade_bsdf_albedo_eval(a, NULL, wo, want, NULL);
      for (int c = 0; c < 3; c++)
        assert_near(got[c], want[c], 1e-12);
    }
    shade_bsdf_albedo_free(a);
  }
}

static void batches_and_bad_input(void **state) {
  (void)state;
  enum { LANES = 37 };
  shade_params p;
  shade_params_init(&p);
  p.kd[0] = 0.5;
  p.diffuse = SHADE_DIFFUSE_FIBRE_VIEW;
  shade_bsdf_albedo *a = create(&p);
  const double bad[] = {NAN, INFINITY, -INFINITY, 0, -1, 1e300, 1e-300};
  float in[6][LANES], out[6][LANES];
  uint64_t seed = 7;
  for (int i = 0; i < LANES; i++)
    for (int k = 0; k < 6; k++)
      in[k][i] = (float)(uniform(&seed) - (k % 3 == 2 ? 0 : 0.5));
  const shade_albedo_lanesf lanes = {sizeof lanes, in[0], in[1], in[2], in[3], in[4], in[5]};
  const shade_albedo_resultf result = {sizeof result, out[0], out[1], out[2],
                                       out[3],        out[4], out[5]};
  assert_int_equal(shade_bsdf_albedo_batchf(a, LANES, &lanes, &result), SHADE_OK);
  for (int i = 0; i < LANES; i++) {
    const double wo[3] = {(double)in[0][i], (double)in[1][i], (double)in[2][i]};
    const double n[3] = {(double)in[3][i], (double)in[4][i], (double)in[5][i]};
    double part[2][3];
    shade_bsdf_albedo_eval(a, n, wo, part[0], part[1]);
    for (int k = 0; k < 6; k++)
      assert_true(out[k][i] == (float)part[k / 3][k % 3]);
  }
  for (int k = 0; k < 7; k++)
    for (int c = 0; c < 6; c++) {
      double v[6] = {0.1, 0.2, 0.7, 0.1, -0.1, 0.9}, part[2][3];
      v[c] = bad[k];
      const unsigned status = shade_bsdf_albedo_eval(a, v + 3, v, part[0], part[1]);
      assert_int_equal(status & SHADE_BAD_INPUT, isfinite(bad[k]) ? 0 : SHADE_BAD_INPUT);
      if (c == 5 && bad[k] <= 0 && isfinite(bad[k]))
        assert_int_equal(status, SHADE_CLAMPED_NORMAL);
      for (int i = 0; i < 6; i++)
        assert_true(part[i / 3][i % 3] >= 0 && part[i / 3][i % 3] <= 2);
      if (status & SHADE_BAD_INPUT)
        assert_true(part[0][0] == 0 && part[1][0] == 0);
    }
  const double zero[3] = {0, 0, 0}, below[3] = {0.3, 0.1, -0.5};
  double s[3] = {1, 1, 1};
  assert_int_equal(shade_bsdf_albedo_eval(a, NULL, zero, s, NULL), SHADE_BAD_INPUT);
  assert_int_equal(shade_bsdf_albedo_eval(a, NULL, below, s, NULL), SHADE_OK);
  assert_true(s[0] == 0);
  shade_albedo_lanesf missing = lanes;
  missing.ny = NULL;
  assert_int_equal(shade_bsdf_albedo_batchf(a, LANES, &missing, &result), SHADE_BAD_INPUT);
  missing = lanes;
  missing.size = offsetof(shade_albedo_lanesf, woz);
  assert_int_equal(shade_bsdf_albedo_batchf(a, LANES, &missing, &result), SHADE_BAD_INPUT);
  shade_albedo_resultf half = result;
  half.diffuse_g = NULL;
  assert_int_equal(shade_bsdf_albedo_batchf(a, LANES, &lanes, &half), SHADE_BAD_INPUT);
  shade_bsdf_albedo_free(a);
  shade_bsdf_albedo_free(NULL);
  p.ex = NAN;
  p.mdf = (shade_mdf)77;
  unsigned status;
  a = shade_bsdf_albedo_create(&p, &status);
  assert_int_equal(status, SHADE_CLAMPED_PARAMETER | SHADE_BAD_CHOICE);
  shade_bsdf_albedo_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_lobe), cmocka_unit_test(every_diffuse_model),
      cmocka_unit_test(grazing),    cmocka_unit_test(white_furnace),
      cmocka_unit_test(normals),    cmocka_unit_test(batches_and_bad_input)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
