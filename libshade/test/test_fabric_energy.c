/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 3.0 */
/*
 * White furnace: no fabric reflects more than it receives, near, between and far, in its own
 * colours and made as white as parameters allow.
 */
#include "support.h"

#include "shade/presets.h"

/* The integral of s over wi for the channel that reflects most. */
static double albedo(const shade_fabric *f, const double uv[2], const double footprint[2],
                     shade_fabric_tier tier, const double wo[3]) {
  enum { RINGS = 32, SPOKES = 64 };
  double sum[3] = {0, 0, 0};
  shade_fabric_point p;
  shade_fabric_hit hit;
  shade_fabric_point_init(f, &p);
  for (int c = 0; c < 2; c++) {
    p.uv[c] = uv[c];
    p.footprint[c] = footprint[c];
  }
  shade_fabric_prepare(f, &p, wo, tier, &hit, NULL);
  for (int i = 0; i < RINGS; i++)
    for (int j = 0; j < SPOKES; j++) {
      double z = (i + 0.5) / RINGS, phi = 2 * PI * (j + 0.5 * (i % 2)) / SPOKES, wi[3], s[3];
      spherical(acos(z), phi, wi);
      shade_fabric_hit_eval(f, &hit, wi, s);
      for (int c = 0; c < 3; c++)
        sum[c] += s[c] * 2 * PI / (RINGS * SPOKES);
    }
  return fmax(sum[0], fmax(sum[1], sum[2]));
}

typedef struct largest {
  double near, between, far, single;
} largest;

static largest furnace(const shade_fabric *f) {
  const double none[2] = {0, 0}, some[2] = {1.1, 1.1}, all[2] = {1e6, 1e6};
  const double theta[] = {0, 35, 60, 75, 84, 88};
  largest most = {0, 0, 0, 0};
  for (int k = 0; k < 6 * 3; k += 2 * FEWER - 1) { /* 5 has no factor of 6: every theta */
    double wo[3];
    spherical(theta[k % 6] * PI / 180, (k / 6 + 0.1) * PI / 3, wo);
    for (int p = 0; p < 4; p++) {
      const double uv[2] = {0.37 * (k + 7 * p), 0.59 * (k + 5 * p)};
      most.near = fmax(most.near, albedo(f, uv, none, SHADE_TIER_NEAR, wo));
      if (p == 0)
        most.between = fmax(most.between, albedo(f, uv, some, SHADE_TIER_AUTO, wo));
    }
    most.far = fmax(most.far, albedo(f, none, all, SHADE_TIER_FAR, wo));
    most.single = fmax(most.single, albedo(f, none, all, SHADE_TIER_SINGLE, wo));
  }
  return most;
}

static void set_yarn(shade_yarn *y, double f0, double kd) {
  for (int c = 0; c < 3; c++) {
    y->f0[c] = f0;
    y->kd[c] = kd;
  }
}

static void check(const shade_preset *p, const char *what) {
  shade_weave *weave;
  unsigned status = SHADE_OK;
  shade_fabric *f = shade_preset_fabric(p, &weave, &status);
  assert_non_null(f);
  largest m = furnace(f);
  print_message("%-18s %-14s near %.3f between %.3f far %.3f single %.3f\n", p->word, what, m.near,
                m.between, m.far, m.single);
  assert_true(m.near <= 1 + 1e-3 && m.between <= 1 + 1e-3);
  assert_true(m.far <= 1 + 1e-3 && m.single <= 1 + 1e-3);
  assert_true(m.near > 0.02);
  shade_fabric_free(f);
  shade_weave_free(weave);
}

static void presets(void **state) {
  (void)state;
  shade_preset p;
  for (int row = 0, cloths = 0; shade_preset_row(row, &p); row++)
    if (p.kind == SHADE_PRESET_FABRIC && cloths++ % FEWER == 0)
      check(&p, "as it is");
}

static void white(void **state) {
  (void)state;
  static const struct {
    const char *what;
    double f0, kd, nap;
  } whites[] = {{"white, matt", 0, 1, 0},
                {"white, f0 .04", 0.04, 1, 0},
                {"white, f0 .5", 0.5, 1, 0},
                {"white, nap", 0.04, 1, 0.5},
                {"mirror", 1, 1, 0}};
  const char *words[] = {"linen", "silk_charmeuse"};
  for (int w = 0; w < 2; w += FEWER)
    for (size_t k = 0; k < sizeof whites / sizeof whites[0]; k++) {
      shade_preset p;
      assert_true(shade_preset_find(words[w], &p));
      set_yarn(&p.fabric.warp, whites[k].f0, whites[k].kd);
      set_yarn(&p.fabric.weft, whites[k].f0, whites[k].kd);
      p.yarns.occlusion = SHADE_OCCLUSION_NONE;
      p.fabric.nap = whites[k].nap;
      for (int c = 0; c < 3; c++)
        p.fabric.backing[c] = p.fabric.nap_color[c] = 1;
      check(&p, whites[k].what);
      for (int d = SHADE_DIFFUSE_LAMBERT; k == 0 && d < SHADE_DIFFUSE_COUNT; d++) {
        if (d == SHADE_DIFFUSE_MAX_NORMAL) /* brighter than energy allows, as it is documented */
          continue;
        p.fabric.warp.diffuse = p.fabric.weft.diffuse = (shade_diffuse)d;
        check(&p, shade_list_word(SHADE_LIST_DIFFUSE, d));
      }
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(presets), cmocka_unit_test(white)};
  return cmocka_run_group_tests_name("fabric energy", tests, NULL, NULL);
}
