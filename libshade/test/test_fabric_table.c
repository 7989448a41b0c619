/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 1.1 */
/* The tables of a mixture against the mixture itself, lobe by lobe, for every cloth of the presets.
 */
#include <string.h>

#include "shade/presets.h"
#include "model/fabric.h"
#include "model/fabric_table.h"
#include "support.h"

enum { PAIRS = 4000 };

static const shade_bsdf *far_lobe(const fabric_side *side) {
  return &side->lobe[FABRIC_FAR];
}

static fabric_table *table_of(const fabric_side *side) {
  const fabric_nodes *n = &side->nodes;
  const fabric_lobes lobes = {far_lobe(side), (size_t)n->count, {n->x, n->y, n->z}, n->weight};
  return shade_fabric_table_create(&lobes, &lobes);
}

/* Light and eye, evenly by angle and azimuth, to `most` degrees. */
static double from[3][PAIRS], to[3][PAIRS];
static const double *const wi[3] = {from[0], from[1], from[2]};
static const double *const wo[3] = {to[0], to[1], to[2]};

static void aim(double most, uint64_t *seed) {
  for (int i = 0; i < PAIRS; i++)
    for (int k = 0; k < 2; k++) {
      double w[3];
      spherical(most * PI / 180 * sqrt(uniform(seed)), 2 * PI * uniform(seed), w);
      for (int c = 0; c < 3; c++)
        (k ? to : from)[c][i] = w[c];
    }
}

/* The sum over the lobes at pair i. */
static void mixture(const fabric_side *side, int i, double *spec, double *matt) {
  const fabric_nodes *n = &side->nodes;
  double same[6][FABRIC_NODES], s[FABRIC_NODES], m[FABRIC_NODES];
  const size_t count = (size_t)n->count;
  for (size_t k = 0; k < count; k++)
    for (int c = 0; c < 3; c++) {
      same[c][k] = from[c][i];
      same[3 + c][k] = to[c][i];
    }
  shade_lanes in = {.size = sizeof in, .nx = n->x, .ny = n->y, .nz = n->z};
  in.wix = same[0], in.wiy = same[1], in.wiz = same[2];
  in.wox = same[3], in.woy = same[4], in.woz = same[5];
  shade_isa_pick(0)->entries->yarn(far_lobe(side), count, &in, s, m);
  *spec = *matt = 0;
  for (size_t k = 0; k < count; k++) {
    *spec += n->weight[k] * s[k];
    *matt += n->weight[k] * m[k];
  }
}

typedef struct cloth {
  shade_preset preset;
  shade_weave *weave;
  shade_fabric *fabric;
} cloth;

/* The next cloth from row *row on; 0 past the end. */
static int next_cloth(int *row, cloth *c) {
  while (shade_preset_row((*row)++, &c->preset))
    if (c->preset.kind == SHADE_PRESET_FABRIC) {
      c->fabric = shade_preset_fabric(&c->preset, &c->weave, NULL);
      assert_non_null(c->fabric);
      return 1;
    }
  return 0;
}

static void free_cloth(cloth *c) {
  shade_fabric_free(c->fabric);
  shade_weave_free(c->weave);
}

/*
 * Mean error as a share of the mean, and for how many pairs the colour that results (f0 and kd of
 * the preset) is far off. Every instruction set, both precisions.
 */
static void against_lobes(void **state) {
  (void)state;
  static double spec[PAIRS], matt[PAIRS], off[PAIRS];
  static float fromf[3][PAIRS], tof[3][PAIRS], specf[PAIRS], mattf[PAIRS];
  const float *const wif[3] = {fromf[0], fromf[1], fromf[2]};
  const float *const wof[3] = {tof[0], tof[1], tof[2]};
  uint64_t seed = 3;
  aim(80, &seed);
  for (int c = 0; c < 3; c++)
    for (int i = 0; i < PAIRS; i++) {
      fromf[c][i] = (float)from[c][i];
      tof[c][i] = (float)to[c][i];
    }
  double worst[3] = {0}, apart = 0;
  cloth cl;
  int cloths = 0;
  for (int row = 0; next_cloth(&row, &cl); cloths++) {
    for (int k = 0; k < 2; k++) {
      const fabric_side *side = &cl.fabric->side[k];
      fabric_table *t = table_of(side);
      assert_non_null(t);
      assert_true(t->bytes < 1 << 19);
      shade_isa_pick(0)->entries->table(t, PAIRS, wi, wo, spec, matt);
      double sum[2] = {0}, error[2] = {0};
      for (int i = 0; i < PAIRS; i++) {
        double s, m;
        mixture(side, i, &s, &m);
        sum[0] += s;
        sum[1] += m;
        error[0] += fabs(spec[i] - s);
        error[1] += fabs(matt[i] - m);
        const double f0 = side->f0[1], kd = side->kd[1], whole = f0 * s + kd * m;
        off[i] = fabs(f0 * (spec[i] - s) + kd * (matt[i] - m)) / (whole + 1e-4);
      }
      int beyond = 0;
      for (int i = 0; i < PAIRS; i++)
        beyond += off[i] > 0.02;
      print_message("%-18s %s specular %.4f diffuse %.4f beyond 2 %%: %.4f; %zu KiB\n",
                    cl.preset.word, k ? "warp" : "weft", error[0] / sum[0], error[1] / sum[1],
                    (double)beyond / PAIRS, t->bytes >> 10);
      worst[0] = fmax(worst[0], error[0] / sum[0]);
      worst[1] = fmax(worst[1], error[1] / sum[1]);
      worst[2] = fmax(worst[2], (double)beyond / PAIRS);
      const shade_isa_table *isa;
      for (int set = 0; (isa = shade_isa_pick(set)); set++) {
        isa->entriesf->table(t, PAIRS, wif, wof, specf, mattf);
        for (int i = 0; i < PAIRS; i++) {
          apart = fmax(apart, fabs((double)specf[i] - spec[i]) / (spec[i] + 0.01));
          apart = fmax(apart, fabs((double)mattf[i] - matt[i]) / (matt[i] + 0.01));
        }
      }
      shade_fabric_table_free(t);
    }
    free_cloth(&cl);
  }
  print_message("%d cloths: specular %.2g, diffuse %.2g of the mean; colour off by more than 2 %%: "
                "%.2g of pairs; float against double %.2g\n",
                cloths, worst[0], worst[1], worst[2], apart);
  assert_true(cloths >= 9 && worst[0] < 0.014 && worst[1] < 0.004 && worst[2] < 0.03);
  assert_true(apart < 2e-4);
}

/* What arrives from an even sky: as of the mixture, and no more than 1. */
static void energy(void **state) {
  (void)state;
  static double spec[PAIRS], matt[PAIRS];
  uint64_t seed = 4;
  double worst[2] = {0};
  cloth cl;
  for (int row = 0; next_cloth(&row, &cl);) {
    for (int k = 0; k < 2; k++) {
      const fabric_side *side = &cl.fabric->side[k];
      fabric_table *t = table_of(side);
      for (int light = 0; light < 4; light++) {
        double w[3], sum[4] = {0};
        spherical((10 + 22 * light) * PI / 180, 2 * PI * uniform(&seed), w);
        for (int i = 0; i < PAIRS; i++) {
          double v[3];
          const double z = (i + .5) / PAIRS; /* an even sky */
          spherical(acos(z), i * 2.399963229728653, v);
          for (int c = 0; c < 3; c++) {
            to[c][i] = w[c];
            from[c][i] = v[c];
          }
        }
        shade_isa_pick(0)->entries->table(t, PAIRS, wi, wo, spec, matt);
        for (int i = 0; i < PAIRS; i++) {
          double s, m;
          mixture(side, i, &s, &m);
          sum[0] += s / PAIRS * 2 * PI;
          sum[1] += m / PAIRS * 2 * PI;
          sum[2] += spec[i] / PAIRS * 2 * PI;
          sum[3] += matt[i] / PAIRS * 2 * PI;
        }
        assert_true(sum[2] <= 1 && sum[3] <= 1);
        worst[0] = fmax(worst[0], fabs(sum[2] - sum[0]));
        worst[1] = fmax(worst[1], fabs(sum[3] - sum[1]));
      }
      shade_fabric_table_free(t);
    }
    free_cloth(&cl);
  }
  print_message("albedo off by %.3g, diffuse %.2g\n", worst[0], worst[1]);
  assert_true(worst[0] < 0.02 && worst[1] < 0.005);
}

/* Level, along both axes, opposite, equal, at the rim, below, not numbers: nothing but numbers, and
 * those of one lane by itself. */
static void awkward(void **state) {
  (void)state;
  const double odd[][3] = {{0, 0, 1},      {1, 0, 0},     {-1, 0, 1e-300},  {0, 1, 0},
                           {0, -1, 1e-20}, {.6, 0, .8},   {-.6, 0, .8},     {0, .8, -.6},
                           {1e-30, 0, 1},  {NAN, 0, 1},   {0, INFINITY, 1}, {0, 0, 0},
                           {1, 0, 1e-8},   {.8, .6, 1e-9}};
  enum { ODD = sizeof odd / sizeof odd[0] };
  double a[3][ODD * ODD], b[3][ODD * ODD], spec[ODD * ODD], matt[ODD * ODD];
  float af[3][ODD * ODD], bf[3][ODD * ODD], specf[ODD * ODD], mattf[ODD * ODD];
  for (int i = 0; i < ODD * ODD; i++)
    for (int c = 0; c < 3; c++) {
      af[c][i] = (float)(a[c][i] = odd[i / ODD][c]);
      bf[c][i] = (float)(b[c][i] = odd[i % ODD][c]);
    }
  const double *const x[3] = {a[0], a[1], a[2]}, *const y[3] = {b[0], b[1], b[2]};
  const float *const xf[3] = {af[0], af[1], af[2]}, *const yf[3] = {bf[0], bf[1], bf[2]};
  cloth cl;
  int row = 0;
  assert_true(next_cloth(&row, &cl));
  fabric_table *t = table_of(&cl.fabric->side[1]);
  const shade_isa_table *isa;
  for (int set = 0; (isa = shade_isa_pick(set)); set++) {
    isa->entries->table(t, ODD * ODD, x, y, spec, matt);
    isa->entriesf->table(t, ODD * ODD, xf, yf, specf, mattf);
    for (int i = 0; i < ODD * ODD; i++) {
      int bad = 0;
      for (int c = 0; c < 3; c++)
        bad |= !isfinite(a[c][i]) || !isfinite(b[c][i]);
      const double *const one[2][3] = {{&a[0][i], &a[1][i], &a[2][i]},
                                       {&b[0][i], &b[1][i], &b[2][i]}};
      const float *const onef[2][3] = {{&af[0][i], &af[1][i], &af[2][i]},
                                       {&bf[0][i], &bf[1][i], &bf[2][i]}};
      double s, m;
      float sf, mf;
      isa->entries->table(t, 1, one[0], one[1], &s, &m);
      isa->entriesf->table(t, 1, onef[0], onef[1], &sf, &mf);
      if (!bad) {
        assert_near(s, spec[i], 1e-9 * (1 + spec[i]));
        assert_near(m, matt[i], 1e-9 * (1 + matt[i]));
        assert_near((double)sf, (double)specf[i], 1e-4 * (1 + spec[i]));
        assert_near((double)mf, (double)mattf[i], 1e-4 * (1 + matt[i]));
      }
      const int below = !(a[2][i] > 0 && b[2][i] > 0);
      if (below)
        assert_true(spec[i] == 0 && matt[i] == 0 && specf[i] == 0 && mattf[i] == 0);
      else if (!bad)
        assert_true(spec[i] >= 0 && matt[i] >= 0 && specf[i] >= 0 && mattf[i] >= 0 &&
                    isfinite(spec[i]) && isfinite(specf[i]) && matt[i] < 1 && mattf[i] < 1);
    }
  }
  shade_fabric_table_free(t);
  shade_fabric_table_free(NULL);
  free_cloth(&cl);
}

/* What is not modelled is refused. */
static void refusals(void **state) {
  (void)state;
  const double x = 0, z = 1, weight = 1;
  for (int k = 0; k < 6; k++) {
    shade_params p;
    shade_bsdf b;
    shade_params_init(&p);
    shade_params_set_exponents(&p, k == 1 ? 2000 : 100, 10);
    p.detail = k == 2 ? SHADE_DETAIL_NONE : SHADE_DETAIL_ROTATE;
    p.brdf = k == 3 ? SHADE_BRDF_WARD_BOUNDED : SHADE_BRDF_ASHIKHMIN_SHIRLEY;
    p.diffuse = k == 4   ? SHADE_DIFFUSE_FIBRE_VIEW
                : k == 5 ? SHADE_DIFFUSE_POULIN_FOURNIER
                         : SHADE_DIFFUSE_FIBRE;
    shade_bsdf_setup(&b, &p);
    const fabric_lobes one = {&b, 1, {&x, &x, &z}, &weight};
    fabric_table *t = shade_fabric_table_create(&one, &one);
    assert_true(k ? !t : !!t);
    shade_fabric_table_free(t);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(against_lobes),
      cmocka_unit_test(energy),
      cmocka_unit_test(awkward),
      cmocka_unit_test(refusals),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
