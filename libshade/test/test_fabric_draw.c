/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 24.4 */
/*
 * Draws of cloth against their density: chi-square over the whole sphere, lost draws included, for
 * tilted yarns, gaps, mixtures and single lobes, with and without folds, for every horizon; and
 * s / pdf, whose average is the albedo by quadrature and whose largest is bounded.
 */
#include "support.h"

#include <string.h>

#include "shade/presets.h"

#ifdef SANITIZED
enum { ROUNDS = 16, FINE = 8 };
#else
enum { ROUNDS = 240, FINE = 20 }; /* of BATCH draws: a million */
#endif
enum { BATCH = 4096, RINGS = 28, SPOKES = 36, CELLS = RINGS * SPOKES };

typedef struct arrays {
  double in[12][BATCH], wi[3][BATCH], rgb[3][BATCH], pdf[BATCH];
  float inf[12][BATCH], wif[3][BATCH], rgbf[3][BATCH], pdff[BATCH];
} arrays;

typedef struct example {
  const char *preset;
  shade_fabric_tier tier;
  shade_horizon horizon;
  double n[3], wo[2]; /* wo: theta, phi in degrees */
  double uv[2], footprint, random;
  double nap, transmit, gloss, backing;
  int mdf;
} example;

#define FLAT                                                                                       \
  { 0, 0, 1 }
#define FOLD                                                                                       \
  { -0.36, 0.48, 0.8 }
#define STEEP                                                                                      \
  { 0.6, -0.64, 0.48 }

static const example examples[] = {
    /* near: weft, warp and gap of the drafts (asserted below by kind of answer, not by place) */
    {"silk_charmeuse",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_HARD,
     FLAT,
     {30, 40},
     {0.3, 0.8},
     0,
     -1,
     0,
     0,
     1,
     0,
     0},
    {"silk_charmeuse",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_HARD,
     FOLD,
     {50, 100},
     {5.9, 2.1},
     0,
     -1,
     0,
     0.3,
     1,
     0,
     0},
    {"denim",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_VALID_ESTEVEZ,
     FOLD,
     {60, 120},
     {1.2, 0.4},
     0,
     -1,
     0,
     0,
     1,
     0,
     0},
    {"denim",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_SCHUESSLER,
     STEEP,
     {40, 120},
     {2.7, 1.6},
     0,
     -1,
     0,
     0.2,
     1,
     0,
     0},
    {"linen",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_VALID_ESTEVEZ,
     FOLD,
     {20, 10},
     {0.98, 0.97},
     0,
     -1,
     0,
     0,
     1,
     0.7,
     0},
    {"shot_taffeta",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_CHIANG,
     FOLD,
     {70, 210},
     {0.1, 0.5},
     0,
     -1,
     0,
     0,
     0.3,
     0,
     0},
    {"shot_taffeta",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_HARD,
     FLAT,
     {75, 15},
     {0.5, 0.2},
     0,
     -1,
     0.4,
     0.4,
     1,
     0,
     0},
    {"wool_flannel",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_VALID_REFLECTION,
     STEEP,
     {55, 200},
     {0.4, 0.3},
     0,
     -1,
     0,
     0,
     1,
     0,
     SHADE_MDF_GGX},
    {"wool_flannel",
     SHADE_TIER_NEAR,
     SHADE_HORIZON_SCHUESSLER,
     FOLD,
     {65, 330},
     {0.6, 0.7},
     0,
     -1,
     0,
     0,
     1,
     0,
     SHADE_MDF_BECKMANN},
    /* far */
    {"silk_charmeuse",
     SHADE_TIER_FAR,
     SHADE_HORIZON_HARD,
     FLAT,
     {30, 40},
     {0, 0},
     1e6,
     -1,
     0,
     0,
     1,
     0,
     0},
    {"silk_shantung",
     SHADE_TIER_FAR,
     SHADE_HORIZON_VALID_ESTEVEZ,
     FOLD,
     {50, 170},
     {3, 4},
     3,
     -1,
     0,
     0.3,
     1,
     0,
     0},
    {"polyester_lining",
     SHADE_TIER_FAR,
     SHADE_HORIZON_VALID_ESTEVEZ,
     STEEP,
     {45, 260},
     {0, 0},
     1e6,
     -1,
     0,
     0,
     1,
     0,
     0},
    {"polyester_lining",
     SHADE_TIER_FAR,
     SHADE_HORIZON_HARD,
     FLAT,
     {75, 70},
     {0, 0},
     1e6,
     -1,
     0,
     0,
     1,
     0,
     0},
    {"denim",
     SHADE_TIER_FAR,
     SHADE_HORIZON_SCHUESSLER,
     FOLD,
     {60, 20},
     {0, 0},
     5,
     -1,
     0,
     0.2,
     1,
     0,
     0},
    {"linen",
     SHADE_TIER_FAR,
     SHADE_HORIZON_CHIANG,
     FOLD,
     {35, 300},
     {0, 0},
     1e6,
     -1,
     0.5,
     0,
     0.4,
     0.3,
     0},
    {"herringbone_tweed",
     SHADE_TIER_FAR,
     SHADE_HORIZON_VALID_REFLECTION,
     FOLD,
     {60, 100},
     {1, 7},
     20,
     -1,
     0,
     0,
     1,
     0,
     SHADE_MDF_GGX},
    /* one lobe a side; what the random number picks; all terms of a footprint */
    {"gabardine",
     SHADE_TIER_SINGLE,
     SHADE_HORIZON_VALID_ESTEVEZ,
     FOLD,
     {40, 50},
     {0, 0},
     0,
     -1,
     0,
     0.1,
     1,
     0,
     0},
    {"shot_taffeta",
     SHADE_TIER_SINGLE,
     SHADE_HORIZON_HARD,
     FLAT,
     {65, 280},
     {0, 0},
     0,
     -1,
     0,
     0,
     0.5,
     0,
     0},
    {"gabardine",
     SHADE_TIER_AUTO,
     SHADE_HORIZON_VALID_ESTEVEZ,
     FOLD,
     {40, 50},
     {0.4, 0.9},
     1.2,
     0.1,
     0,
     0,
     1,
     0,
     0},
    {"gabardine",
     SHADE_TIER_AUTO,
     SHADE_HORIZON_VALID_ESTEVEZ,
     FOLD,
     {40, 50},
     {0.4, 0.9},
     1.2,
     0.9,
     0,
     0,
     1,
     0,
     0},
    {"denim",
     SHADE_TIER_AUTO,
     SHADE_HORIZON_VALID_ESTEVEZ,
     FOLD,
     {30, 150},
     {0.4, 0.9},
     1.2,
     -1,
     0.1,
     0.2,
     1,
     0,
     0},
};
enum { EXAMPLES = sizeof examples / sizeof examples[0] };

typedef struct cloth {
  shade_weave *weave;
  shade_fabric *fabric;
} cloth;

static cloth open_cloth(const example *e) {
  shade_preset p;
  cloth c;
  unsigned status = SHADE_OK;
  assert_true(shade_preset_find(e->preset, &p));
  p.fabric.horizon = e->horizon;
  p.fabric.nap = e->nap;
  for (int a = 0; a < 3; a++) {
    p.fabric.warp_transmit[a] = p.fabric.weft_transmit[a] = e->transmit * (1 - 0.2 * a);
    p.fabric.backing[a] = e->backing;
  }
  if (e->mdf) {
    p.fabric.mdf = (shade_mdf)e->mdf;
    p.fabric.brdf = SHADE_BRDF_MICROFACET;
  }
  c.fabric = shade_preset_fabric(&p, &c.weave, &status);
  assert_non_null(c.fabric);
  assert_int_equal(status, SHADE_OK);
  return c;
}

static shade_fabric_lanes lanes_of(const arrays *m, const example *e) {
  shade_fabric_lanes in = {.size = sizeof in,
                           .u = m->in[0],
                           .v = m->in[1],
                           .du = m->in[2],
                           .dv = m->in[2],
                           .nx = m->in[3],
                           .ny = m->in[4],
                           .nz = m->in[5],
                           .wix = m->wi[0],
                           .wiy = m->wi[1],
                           .wiz = m->wi[2],
                           .wox = m->in[6],
                           .woy = m->in[7],
                           .woz = m->in[8],
                           .u1 = m->in[9],
                           .u2 = m->in[10],
                           .u3 = m->in[11]};
  static double random[BATCH], gloss[BATCH];
  for (int i = 0; i < BATCH; i++) {
    random[i] = e->random;
    gloss[i] = e->gloss;
  }
  in.random = e->random < 0 ? NULL : random;
  in.warp_gloss = in.weft_gloss = gloss;
  return in;
}

static shade_fabric_lanesf lanes_off(const arrays *m, const example *e) {
  shade_fabric_lanesf in = {.size = sizeof in,
                            .u = m->inf[0],
                            .v = m->inf[1],
                            .du = m->inf[2],
                            .dv = m->inf[2],
                            .nx = m->inf[3],
                            .ny = m->inf[4],
                            .nz = m->inf[5],
                            .wix = m->wif[0],
                            .wiy = m->wif[1],
                            .wiz = m->wif[2],
                            .wox = m->inf[6],
                            .woy = m->inf[7],
                            .woz = m->inf[8],
                            .u1 = m->inf[9],
                            .u2 = m->inf[10],
                            .u3 = m->inf[11]};
  static float random[BATCH], gloss[BATCH];
  for (int i = 0; i < BATCH; i++) {
    random[i] = (float)e->random;
    gloss[i] = (float)e->gloss;
  }
  in.random = e->random < 0 ? NULL : random;
  in.warp_gloss = in.weft_gloss = gloss;
  return in;
}

static void set_place(arrays *m, const example *e) {
  double wo[3];
  spherical(e->wo[0] * PI / 180, e->wo[1] * PI / 180, wo);
  const double of[9] = {e->uv[0], e->uv[1], e->footprint, e->n[0], e->n[1],
                        e->n[2],  wo[0],    wo[1],        wo[2]};
  for (int k = 0; k < 9; k++)
    for (int i = 0; i < BATCH; i++)
      m->inf[k][i] = (float)(m->in[k][i] = of[k]);
}

/* BATCH draws, in double or float; all as doubles in wi, rgb, pdf. */
static void draw(const cloth *c, const example *e, arrays *m, int single, uint64_t *seed) {
  for (int k = 9; k < 12; k++)
    for (int i = 0; i < BATCH; i++)
      m->inf[k][i] = (float)(m->in[k][i] = uniform(seed));
  if (!single) {
    const shade_fabric_lanes in = lanes_of(m, e);
    const shade_fabric_result out = {.size = sizeof out,
                                     .r = m->rgb[0],
                                     .g = m->rgb[1],
                                     .b = m->rgb[2],
                                     .pdf = m->pdf,
                                     .wix = m->wi[0],
                                     .wiy = m->wi[1],
                                     .wiz = m->wi[2]};
    shade_fabric_sample_batch(c->fabric, BATCH, &in, e->tier, &out);
    return;
  }
  const shade_fabric_lanesf in = lanes_off(m, e);
  const shade_fabric_resultf out = {.size = sizeof out,
                                    .r = m->rgbf[0],
                                    .g = m->rgbf[1],
                                    .b = m->rgbf[2],
                                    .pdf = m->pdff,
                                    .wix = m->wif[0],
                                    .wiy = m->wif[1],
                                    .wiz = m->wif[2]};
  shade_fabric_sample_batchf(c->fabric, BATCH, &in, e->tier, &out);
  for (int i = 0; i < BATCH; i++) {
    m->pdf[i] = (double)m->pdff[i];
    for (int a = 0; a < 3; a++) {
      m->wi[a][i] = (double)m->wif[a][i];
      m->rgb[a][i] = (double)m->rgbf[a][i];
    }
  }
}

/* The integrals of the density over every cell, and of s (largest channel) over the sphere. */
static double integrals(const cloth *c, const example *e, arrays *m, double *cell,
                        double albedo[3]) {
  double all = 0;
  memset(cell, 0, CELLS * sizeof *cell);
  memset(albedo, 0, 3 * sizeof *albedo);
  const shade_fabric_lanes in = lanes_of(m, e);
  const shade_fabric_result out = {
      .size = sizeof out, .r = m->rgb[0], .g = m->rgb[1], .b = m->rgb[2], .pdf = m->pdf};
  const int total = CELLS * FINE * FINE;
  static int of[BATCH];
  for (int start = 0; start < total; start += BATCH) {
    const int count = total - start < BATCH ? total - start : BATCH;
    for (int i = 0; i < count; i++) {
      const int k = start + i, j = k % (FINE * FINE);
      of[i] = k / (FINE * FINE);
      const double z = -1 + 2 * (of[i] / SPOKES + (j / FINE + 0.5) / FINE) / RINGS;
      const double phi = 2 * PI * (of[i] % SPOKES + (j % FINE + 0.5) / FINE) / SPOKES;
      m->wi[0][i] = sqrt(1 - z * z) * cos(phi);
      m->wi[1][i] = sqrt(1 - z * z) * sin(phi);
      m->wi[2][i] = z;
    }
    shade_fabric_eval_batch(c->fabric, (size_t)count, &in, e->tier, &out);
    const double part = 4 * PI / total;
    for (int i = 0; i < count; i++) {
      cell[of[i]] += m->pdf[i] * part;
      all += m->pdf[i] * part;
      for (int a = 0; a < 3; a++)
        albedo[a] += m->rgb[a][i] * part;
    }
  }
  return all;
}

static int cell_of(double x, double y, double z) {
  const int ring = (int)fmin((z + 1) / 2 * RINGS, RINGS - 1);
  return ring * SPOKES + sector_of(x, y, SPOKES);
}

/* z of the chi-square; cells that expect less than 10 count together. */
static double chi_square(const long *seen, const double *expected, int count, double *dof) {
  double x = 0, rest = 0, rest_seen = 0;
  *dof = -1;
  for (int i = 0; i < count; i++) {
    if (expected[i] < 10) {
      rest += expected[i];
      rest_seen += (double)seen[i];
      continue;
    }
    x += ((double)seen[i] - expected[i]) * ((double)seen[i] - expected[i]) / expected[i];
    ++*dof;
  }
  if (rest >= 10) {
    x += (rest_seen - rest) * (rest_seen - rest) / rest;
    ++*dof;
  } else {
    assert_true(rest_seen <= rest + 6 * sqrt(rest) + 12);
  }
  const double w = 2 / (9 * *dof);
  return (cbrt(x / *dof) - (1 - w)) / sqrt(w);
}

static void draws_have_their_density(void **state) {
  (void)state;
  static arrays m;
  static double cell[CELLS + 1], expected[CELLS + 1];
  static long seen[CELLS + 1];
  uint64_t seed = 1;
  double largest_weight = 0;
  /* Sidak: 1 - (1 - .01)^(1/N) of the normal's tail; N is 42 here, so 2.4e-4 one-sided: 3.5 */
  const double limit = 3.5;
  for (int k = 0; k < EXAMPLES; k += FEWER) {
    const example *e = &examples[k];
    cloth c = open_cloth(e);
    double albedo[3];
    set_place(&m, e);
    const double whole = integrals(&c, e, &m, cell, albedo);
    assert_true(whole <= 1 + 2e-3);
    assert_true(whole > 0.05);
    for (int single = 0; single < 2; single++) {
      const int rounds = ROUNDS;
      double mean[3] = {0, 0, 0}, square[3] = {0, 0, 0}, most = 0;
      memset(seen, 0, sizeof seen);
      for (int round = 0; round < rounds; round++) {
        draw(&c, e, &m, single, &seed);
        for (int i = 0; i < BATCH; i++) {
          if (!(m.pdf[i] > 0)) {
            seen[CELLS]++;
            assert_true(m.wi[0][i] == 0 && m.wi[2][i] == 0 && m.rgb[1][i] == 0);
            continue;
          }
          seen[cell_of(m.wi[0][i], m.wi[1][i], m.wi[2][i])]++;
          for (int a = 0; a < 3; a++) {
            const double weight = m.rgb[a][i] / m.pdf[i];
            mean[a] += weight;
            square[a] += weight * weight;
            most = fmax(most, weight);
          }
        }
      }
      const double draws = (double)rounds * BATCH;
      for (int i = 0; i < CELLS; i++)
        expected[i] = cell[i] * draws;
      expected[CELLS] = fmax(1 - whole, 0) * draws;
      double dof;
      const double z = chi_square(seen, expected, CELLS + 1, &dof);
      double off = 0;
      for (int a = 0; a < 3; a++) {
        mean[a] /= draws;
        const double error = sqrt(fmax(square[a] / draws - mean[a] * mean[a], 0) / draws);
        off = fmax(off, fabs(mean[a] - albedo[a]) / (5 * error + 2e-3 * albedo[a]));
      }
      print_message("%-17s %-6s horizon %d: chi-square z %5.2f (%.0f), pdf %.4f, albedo %.4f, "
                    "weight %.2f\n",
                    e->preset, single ? "float" : "double", (int)e->horizon, z, dof, whole,
                    albedo[1], most);
      largest_weight = fmax(largest_weight, most);
      if (z > limit || off > 1)
        fail_msg("example %d: z %.2f, mean of s/pdf off by %.2f of what it may be", k, z, off);
    }
    shade_fabric_free(c.fabric);
    shade_weave_free(c.weave);
  }
  print_message("largest s / pdf %.2f\n", largest_weight);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(draws_have_their_density)};
  return cmocka_run_group_tests_name("fabric draw", tests, NULL, NULL);
}
