/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.3 */
/*
 * What programs built against the library rely on, as numbers written out: values of enums, their
 * words, ranges and defaults, tables of other people's measurements. Rows may be appended; a
 * number here changes only with the interface.
 */
#include <string.h>

#include "support.h"
#include "shade/albedo.h"
#include "shade/fabric.h"
#include "shade/maps.h"
#include "shade/weave.h"

static void choices(void **state) {
  (void)state;
  static const struct {
    shade_list list;
    int constant;
    const char *word;
    int value;
  } rows[] = {
      {SHADE_LIST_MDF, SHADE_MDF_ASHIKHMIN_SHIRLEY, "ashikhmin_shirley", 0},
      {SHADE_LIST_MDF, SHADE_MDF_WARD, "ward", 1},
      {SHADE_LIST_MDF, SHADE_MDF_WARD_HALF, "ward_half", 2},
      {SHADE_LIST_MDF, SHADE_MDF_BECKMANN, "beckmann", 3},
      {SHADE_LIST_MDF, SHADE_MDF_GGX, "ggx", 4},
      {SHADE_LIST_BRDF, SHADE_BRDF_ASHIKHMIN_SHIRLEY, "ashikhmin_shirley", 0},
      {SHADE_LIST_BRDF, SHADE_BRDF_WARD_1992, "ward_1992", 1},
      {SHADE_LIST_BRDF, SHADE_BRDF_WARD_DUR, "ward_dur", 2},
      {SHADE_LIST_BRDF, SHADE_BRDF_WARD_BOUNDED, "ward_bounded", 3},
      {SHADE_LIST_BRDF, SHADE_BRDF_MICROFACET, "microfacet", 4},
      {SHADE_LIST_BRDF, SHADE_BRDF_AUTO, "auto", 5},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_NONE, "none", 0},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_PERTURB, "perturb", 1},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_GRAM_SCHMIDT, "gram_schmidt", 2},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_ROTATE, "rotate", 3},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_SHORTEST_ARC, "shortest_arc", 4},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_ROTATE_APPROXIMATE, "rotate_approximate", 5},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_DEFORM_LINEAR, "deform_linear", 6},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_DEFORM_SMOOTH, "deform_smooth", 7},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_AUTO, "auto", 8},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_DEFORM_LINEAR_CONSERVING, "deform_linear_conserving", 9},
      {SHADE_LIST_DETAIL, SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING, "deform_smooth_conserving", 10},
      {SHADE_LIST_GROOVE, SHADE_GROOVE_AUTO, "auto", 0},
      {SHADE_LIST_GROOVE, SHADE_GROOVE_X, "x", 1},
      {SHADE_LIST_GROOVE, SHADE_GROOVE_Y, "y", 2},
      {SHADE_LIST_FRESNEL, SHADE_FRESNEL_NONE, "none", 0},
      {SHADE_LIST_FRESNEL, SHADE_FRESNEL_SCHLICK, "schlick", 1},
      {SHADE_LIST_FRESNEL, SHADE_FRESNEL_F82, "f82", 2},
      {SHADE_LIST_FRESNEL, SHADE_FRESNEL_CONDUCTOR, "conductor", 3},
      {SHADE_LIST_DIFFUSE, SHADE_DIFFUSE_LAMBERT, "lambert", 0},
      {SHADE_LIST_DIFFUSE, SHADE_DIFFUSE_MAX_NORMAL, "max_normal", 1},
      {SHADE_LIST_DIFFUSE, SHADE_DIFFUSE_FIBRE, "fibre", 2},
      {SHADE_LIST_DIFFUSE, SHADE_DIFFUSE_FIBRE_VIEW, "fibre_view", 3},
      {SHADE_LIST_DIFFUSE, SHADE_DIFFUSE_POULIN_FOURNIER, "poulin_fournier", 4},
      {SHADE_LIST_DIFFUSE, SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY, "ashikhmin_shirley", 5},
      {SHADE_LIST_HORIZON, SHADE_HORIZON_HARD, "hard", 0},
      {SHADE_LIST_HORIZON, SHADE_HORIZON_VALID_REFLECTION, "valid_reflection", 1},
      {SHADE_LIST_HORIZON, SHADE_HORIZON_ESTEVEZ, "estevez", 2},
      {SHADE_LIST_HORIZON, SHADE_HORIZON_CHIANG, "chiang", 3},
      {SHADE_LIST_HORIZON, SHADE_HORIZON_SCHUESSLER, "schuessler", 4},
      {SHADE_LIST_HORIZON, SHADE_HORIZON_VALID_ESTEVEZ, "valid_estevez", 5},
      {SHADE_LIST_HORIZON, SHADE_HORIZON_MUTUAL, "mutual", 6},
      {SHADE_LIST_MULTISCATTER, SHADE_MULTISCATTER_OFF, "off", 0},
      {SHADE_LIST_MULTISCATTER, SHADE_MULTISCATTER_ON, "on", 1},
  };
  int seen[SHADE_LIST_COUNT] = {0};
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    assert_int_equal(rows[i].constant, rows[i].value);
    assert_int_equal(shade_list_find(rows[i].list, rows[i].word), rows[i].value);
    assert_string_equal(shade_list_word(rows[i].list, rows[i].value), rows[i].word);
    seen[rows[i].list]++;
  }
  for (int list = 0; list < SHADE_LIST_COUNT; list++) {
    int rows_in = 0;
    while (shade_list_row((shade_list)list, rows_in, NULL, NULL, NULL, NULL))
      rows_in++;
    assert_int_equal(seen[list], rows_in); /* a row that is appended is appended here too */
  }
}

typedef struct word_value {
  int constant;
  const char *word;
  int value;
} word_value;

static void other_choices(void **state) {
  (void)state;
  static const word_value occlusions[] = {
      {SHADE_OCCLUSION_NONE, "none", 0},
      {SHADE_OCCLUSION_TILT, "tilt", 1},
      {SHADE_OCCLUSION_SKY, "sky", 2},
  };
  static const word_value conventions[] = {
      {SHADE_ROUGHNESS_BLENDER_PRINCIPLED, "blender_principled", 0},
      {SHADE_ROUGHNESS_BLENDER_GLOSSY, "blender_glossy", 1},
      {SHADE_ROUGHNESS_BLENDER_GLOSSY_2_79, "blender_glossy_2_79", 2},
      {SHADE_ROUGHNESS_GLTF, "gltf", 3},
      {SHADE_ROUGHNESS_MATERIALX, "materialx", 4},
      {SHADE_ROUGHNESS_OPENPBR, "openpbr", 5},
  };
  const char *word;
  int value;
  for (int i = 0; i < SHADE_OCCLUSION_COUNT; i++) {
    assert_true(i < (int)(sizeof occlusions / sizeof occlusions[0]));
    assert_true(shade_occlusion_row(i, &value, &word, NULL, NULL));
    assert_int_equal(value, occlusions[i].value);
    assert_int_equal(occlusions[i].constant, occlusions[i].value);
    assert_string_equal(word, occlusions[i].word);
  }
  for (int i = 0; i < SHADE_ROUGHNESS_COUNT; i++) {
    assert_true(i < (int)(sizeof conventions / sizeof conventions[0]));
    assert_true(shade_roughness_row(i, &value, &word, NULL, NULL));
    assert_int_equal(value, conventions[i].value);
    assert_int_equal(conventions[i].constant, conventions[i].value);
    assert_string_equal(word, conventions[i].word);
  }
}

static void constants(void **state) {
  (void)state;
  const int pairs[][2] = {
      {SHADE_OK, 0},
      {SHADE_CLAMPED_PARAMETER, 1},
      {SHADE_CLAMPED_NORMAL, 2},
      {SHADE_BAD_INPUT, 4},
      {SHADE_BAD_CHOICE, 8},
      {SHADE_NO_SAMPLE, 16},
      {SHADE_TIER_AUTO, 0},
      {SHADE_TIER_NEAR, 1},
      {SHADE_TIER_FAR, 2},
      {SHADE_TIER_SINGLE, 3},
      {SHADE_TOP_WEFT, 0},
      {SHADE_TOP_WARP, 1},
      {SHADE_TOP_GAP, 2},
      {SHADE_WRAP_REPEAT, 0},
      {SHADE_WRAP_CLAMP, 1},
      {SHADE_WRAP_MIRROR, 2},
      {SHADE_WEFT_ONLY, 0x7fffffff},
      {SHADE_DRAFT_MAX_SIDE, 16384},
      {SHADE_DRAFT_MAX_CELLS, 16777216},
      {SHADE_PATTERN_MAX, 4096},
      {SHADE_SCRATCH_LAYERS, 8},
      {SHADE_SCRATCH_MAX_PITS, 4000000},
      {SHADE_SLOPE_MAX_SIDE, 65536},
      {SHADE_SLOPE_LOBES, 8},
  };
  for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++)
    assert_int_equal(pairs[i][0], pairs[i][1]);
  assert_int_equal(sizeof(shade_bsdf), 1024);
}

typedef struct range {
  const char *word;
  int components;
  double minimum, maximum, initial;
} range;

static void is_range(const shade_param_info *info, const range *r) {
  assert_string_equal(info->word, r->word);
  assert_int_equal(info->components, r->components);
  assert_true(info->minimum == r->minimum && info->maximum == r->maximum);
  assert_near(info->initial, r->initial, 1e-12 * fabs(r->initial));
}

static void ranges(void **state) {
  (void)state;
  static const range params[] = {
      {"ex", 1, 0.0, 1e6, 200.0},         {"ey", 1, 0.0, 1e6, 10.0},
      {"ax", 1, 1e-4, 10.0, 0.099503719}, {"ay", 1, 1e-4, 10.0, 0.40824829},
      {"f0", 3, 0.0, 1.0, 1.0},           {"f82", 3, 0.0, 1.0, 1.0},
      {"eta", 3, 1e-3, 100.0, 0.5},       {"k", 3, 0.0, 100.0, 3.0},
      {"kd", 3, 0.0, 1.0, 0.0},
  };
  static const range yarn[] = {
      {"width", 1, 1e-6, 1e6, 1.0},
      {"gap", 1, 0.0, 1e6, 0.0},
      {"curve", 1, 0.0, 0.98, 0.5},
      {"ridge", 1, 0.0, 0.98, 0.2},
      {"slant", 1, -100.0, 100.0, 0.25},
      {"segments", 1, 0.0, 1000.0, 1.0},
      {"fibre", 1, -1.5707963267948966, 1.5707963267948966, 0.0},
      {"crimp", 1, 0.0, 0.98, 0.0},
      {"crimp_length", 1, 0.01, 16.0, 0.5},
      {"vary_brightness", 1, 0.0, 1.0, 0.0},
      {"vary_tilt", 1, 0.0, 1.0, 0.0},
      {"along_brightness", 1, 0.0, 1.0, 0.0},
      {"along_tilt", 1, 0.0, 1.0, 0.0},
      {"slub", 1, 0.0, 1.0, 0.0},
      {"along_length", 1, 0.01, 1e6, 4.0},
      {"fuzz", 1, 0.0, 1.0, 0.0},
  };
  static const range fibres[] = {
      {"along", 1, 0.0, 1e6, 100.0},
      {"across", 1, 0.0, 1e6, 10.0},
      {"f0", 3, 0.0, 1.0, 0.04},
      {"kd", 3, 0.0, 1.0, 0.5},
  };
  static const range cloth[] = {
      {"backing", 3, 0.0, 1.0, 0.0},       {"nap", 1, 0.0, 10.0, 0.0},
      {"nap_color", 3, 0.0, 1.0, 0.5},     {"warp_transmit", 3, 0.0, 1.0, 0.0},
      {"weft_transmit", 3, 0.0, 1.0, 0.0},
  };
  shade_param_info info;
  shade_fabric_params f;
  shade_fabric_params_init(&f);
  for (int i = 0; i < (int)(sizeof fibres / sizeof fibres[0]); i++) {
    assert_non_null(shade_fabric_yarn_number(&f.warp, i, &info));
    is_range(&info, &fibres[i]);
  }
  for (int i = 0; i < (int)(sizeof cloth / sizeof cloth[0]); i++) {
    const double *number = shade_fabric_number(&f, i, &info);
    assert_non_null(number);
    is_range(&info, &cloth[i]);
    for (int c = 0; c < cloth[i].components; c++)
      assert_true(number[c] == cloth[i].initial);
  }
  for (int i = 0; i < (int)(sizeof params / sizeof params[0]); i++) {
    assert_true(shade_param_row(i, &info));
    is_range(&info, &params[i]);
  }
  for (int i = 0; i < (int)(sizeof yarn / sizeof yarn[0]); i++) {
    assert_true(shade_yarn_param_row(i, &info));
    is_range(&info, &yarn[i]);
  }
}

/* What the structures hold when they are new. */
static void defaults(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  assert_true(p.ex == 200 && p.ey == 10);
  assert_near(p.ax, sqrt(2 / 202.), 1e-9);
  assert_near(p.ay, sqrt(2 / 12.), 1e-9);
  for (int c = 0; c < 3; c++)
    assert_true(p.f0[c] == 1 && p.f82[c] == 1 && p.kd[c] == 0 && p.eta[c] == 0.5 && p.k[c] == 3);
  assert_int_equal(p.mdf, 0);
  assert_int_equal(p.brdf, SHADE_BRDF_AUTO);
  assert_int_equal(p.defaults, 1);
  assert_int_equal(p.detail, 3);
  assert_int_equal(p.groove, 0);
  assert_int_equal(p.fresnel, 1);
  assert_int_equal(p.diffuse, 0);
  assert_int_equal(p.horizon, 5);
  assert_int_equal(p.multiscatter, 0);
  assert_int_equal(p.fast, 0);

  shade_fabric_params f;
  shade_fabric_params_init(&f);
  assert_int_equal(f.mdf, 0);
  assert_int_equal(f.brdf, SHADE_BRDF_AUTO);
  assert_int_equal(f.defaults, 1);
  assert_int_equal(f.detail, 3);
  assert_int_equal(f.draft_colors, 0);
  assert_true(f.nap == 0);
  assert_int_equal(f.shadows, 1);
  const shade_yarn *yarns[2] = {&f.warp, &f.weft};
  for (int k = 0; k < 2; k++) {
    assert_true(yarns[k]->along == 100 && yarns[k]->across == 10);
    assert_int_equal(yarns[k]->diffuse, 2);
    for (int c = 0; c < 3; c++)
      assert_true(yarns[k]->f0[c] == 0.04 && yarns[k]->kd[c] == 0.5 && f.backing[c] == 0);
  }

  shade_weave_params w;
  shade_weave_params_init(&w);
  const shade_yarn_params *shapes[2] = {&w.warp, &w.weft};
  for (int k = 0; k < 2; k++) {
    const shade_yarn_params *y = shapes[k];
    assert_true(y->width == 1 && y->gap == 0 && y->curve == 0.5 && y->ridge == 0.2);
    assert_true(y->slant == 0.25 && y->segments == 1 && y->fibre == 0 && y->crimp == 0);
    assert_true(y->crimp_length == 0.5 && y->vary_brightness == 0 && y->vary_tilt == 0);
    assert_true(y->along_brightness == 0 && y->along_tilt == 0 && y->slub == 0);
    assert_true(y->along_length == 4 && y->fuzz == 0);
  }

  shade_slope_options o;
  shade_slope_options_init(&o);
  assert_int_equal(o.wrap, 0);
  assert_int_equal(o.directx, 0);
  assert_true(o.strength == 1);
}

/* Complex indices of refraction; test_metal_colours.py says whose they are. */
static void metals(void **state) {
  (void)state;
  static const struct {
    const char *word;
    double eta[3], k[3];
  } rows[] = {
      {"silver", {0.05693, 0.05512, 0.0432}, {4.504, 3.552, 2.592}},
      {"gold", {0.01702, 0.4955, 1.477}, {13.77, 2.252, 1.778}},
      {"copper", {0.2347, 1.045, 1.297}, {3.483, 2.626, 2.363}},
      {"aluminium", {1.502, 0.9853, 0.606}, {7.654, 6.549, 5.35}},
      {"iron", {2.923, 2.92, 2.547}, {3.077, 2.937, 2.75}},
      {"chromium", {3.246, 3.116, 2.286}, {3.286, 3.336, 3.117}},
      {"titanium", {2.753, 2.508, 2.241}, {3.845, 3.397, 3.015}},
      {"stainless_steel", {2.191, 1.889, 1.469}, {3.461, 3.152, 2.739}},
      {"brass", {0.4777, 0.5235, 1.128}, {4.342, 2.67, 1.812}},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    shade_params p;
    shade_params_init(&p);
    assert_true(shade_params_set_metal(&p, rows[i].word));
    for (int c = 0; c < 3; c++)
      assert_true(p.eta[c] == rows[i].eta[c] && p.k[c] == rows[i].k[c]);
  }
}

/* MaterialX takes no anisotropy above .98: aspect = sqrt(1 - .98), alphas r^2/aspect, r^2 aspect.
 */
static void materialx_clamp(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  for (double a = 0.98; a <= 1; a += 0.01) {
    shade_params_set_roughness(&p, SHADE_ROUGHNESS_MATERIALX, 0.2, a);
    assert_near(p.ax, 0.04 / sqrt(0.02), 1e-12);
    assert_near(p.ay, 0.04 * sqrt(0.02), 1e-12);
  }
  shade_params_set_roughness(&p, SHADE_ROUGHNESS_MATERIALX, 0.2, 0.97);
  assert_near(p.ax, 0.04 / sqrt(0.03), 1e-12);
}

/*
 * A caller built against an older header: what lies beyond the size it states is not its
 * structure any more. Bytes there that would be read as numbers far out of range, and what the
 * library takes instead: its default, or what stood there before there was that choice.
 */
enum { GARBAGE = 0x7b };

#define BYTES_FROM(p, member)                                                                      \
  do {                                                                                             \
    (p).size = offsetof(__typeof__(p), member);                                                    \
    memset((char *)&(p) + (p).size, GARBAGE, sizeof(p) - (p).size);                                \
  } while (0)

static void other_params(shade_params *p) {
  shade_params_init(p);
  p->fast = 1;
  p->mdf = SHADE_MDF_GGX;
  p->brdf = SHADE_BRDF_MICROFACET;
  p->detail = SHADE_DETAIL_PERTURB;
  p->groove = SHADE_GROOVE_Y;
  p->fresnel = SHADE_FRESNEL_CONDUCTOR;
  p->ex = 33;
  p->ey = 44;
  p->ax = 0.11;
  p->ay = 0.22;
  for (int c = 0; c < 3; c++) {
    p->f0[c] = 0.3;
    p->f82[c] = 0.4;
    p->kd[c] = 0.5;
    p->eta[c] = 0.6;
    p->k[c] = 0.7;
  }
  p->diffuse = SHADE_DIFFUSE_FIBRE;
  p->horizon = SHADE_HORIZON_CHIANG;
  p->multiscatter = SHADE_MULTISCATTER_ON;
}

/* What older callers set for D in float that was quicker and less accurate. */
static void fast_is_float(void **state) {
  (void)state;
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int detail = 0; detail < SHADE_DETAIL_COUNT; detail++) {
      shade_params p;
      shade_bsdf b[2];
      const float n[3] = {0, 0.28F, 0.96F}, h[3] = {0.36F, 0.48F, 0.8F};
      float d[2];
      memset(b, 0, sizeof b);
      for (int fast = 0; fast < 2; fast++) {
        shade_params_init(&p);
        p.mdf = (shade_mdf)mdf;
        p.detail = (shade_detail)detail;
        p.fast = fast;
        assert_int_equal(shade_bsdf_setup(&b[fast], &p), SHADE_OK);
        d[fast] = shade_mdf_evalf(&b[fast], n, h, NULL);
      }
      assert_memory_equal(&b[0], &b[1], sizeof b[0]);
      assert_true(d[0] > 0 && d[0] == d[1]);
    }
}

static void short_params(void **state) {
  (void)state;
  /* what a caller that knows only the members before this one has set */
#define SHORT_PARAMS(member)                                                                       \
  do {                                                                                             \
    shade_params p, want;                                                                          \
    shade_bsdf b, b_want;                                                                          \
    other_params(&p);                                                                              \
    shade_params_init(&want);                                                                      \
    want.horizon = SHADE_HORIZON_HARD;                                                             \
    if (offsetof(shade_params, member) <= offsetof(shade_params, defaults))                        \
      want.brdf = SHADE_BRDF_ASHIKHMIN_SHIRLEY;                                                    \
    memcpy((char *)&want + sizeof p.size, (char *)&p + sizeof p.size,                              \
           offsetof(shade_params, member) - sizeof p.size);                                        \
    BYTES_FROM(p, member);                                                                         \
    memset(&b, 0, sizeof b);                                                                       \
    memset(&b_want, 0, sizeof b_want);                                                             \
    assert_int_equal(shade_bsdf_setup(&b_want, &want), SHADE_OK);                                  \
    assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);                                          \
    assert_memory_equal(&b, &b_want, sizeof b);                                                    \
  } while (0)
  SHORT_PARAMS(fast);
  SHORT_PARAMS(mdf);
  SHORT_PARAMS(brdf);
  SHORT_PARAMS(detail);
  SHORT_PARAMS(groove);
  SHORT_PARAMS(fresnel);
  SHORT_PARAMS(ex);
  SHORT_PARAMS(ey);
  SHORT_PARAMS(ax);
  SHORT_PARAMS(ay);
  SHORT_PARAMS(f0);
  SHORT_PARAMS(f82);
  SHORT_PARAMS(diffuse);
  SHORT_PARAMS(kd);
  SHORT_PARAMS(eta);
  SHORT_PARAMS(k);
  SHORT_PARAMS(horizon);
  SHORT_PARAMS(defaults);
  SHORT_PARAMS(multiscatter);
}

/* The BRDF that goes with each distribution, by hand, and what it was before there was `auto`. */
static void brdf_auto(void **state) {
  (void)state;
  const shade_brdf own[SHADE_MDF_COUNT] = {[SHADE_MDF_ASHIKHMIN_SHIRLEY] =
                                               SHADE_BRDF_ASHIKHMIN_SHIRLEY,
                                           [SHADE_MDF_WARD] = SHADE_BRDF_WARD_BOUNDED,
                                           [SHADE_MDF_WARD_HALF] = SHADE_BRDF_WARD_BOUNDED,
                                           [SHADE_MDF_BECKMANN] = SHADE_BRDF_MICROFACET,
                                           [SHADE_MDF_GGX] = SHADE_BRDF_MICROFACET};
  shade_params p, want;
  shade_bsdf b, b_want;
  for (int mdf = 0; mdf < SHADE_MDF_COUNT; mdf++)
    for (int old = 0; old < 4; old++) {
      /* new; said by hand; filled with the older defaults; of the size before */
      if (old == 2)
        shade_params_init_as(&p, 0);
      else
        shade_params_init(&p);
      want = p;
      if (old == 1)
        p.brdf = SHADE_BRDF_AUTO;
      p.mdf = want.mdf = (shade_mdf)mdf;
      want.brdf = old < 2 ? own[mdf] : SHADE_BRDF_ASHIKHMIN_SHIRLEY;
      if (old == 3)
        BYTES_FROM(p, defaults);
      assert_int_equal(shade_params_brdf(&p), want.brdf);
      memset(&b, 0, sizeof b);
      memset(&b_want, 0, sizeof b_want);
      assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
      assert_int_equal(shade_bsdf_setup(&b_want, &want), SHADE_OK);
      assert_memory_equal(&b, &b_want, sizeof b);
    }
  assert_int_equal(shade_params_brdf(NULL), SHADE_BRDF_ASHIKHMIN_SHIRLEY);

  /* what a white GGX reflects of an even sky, the eye at 20 degrees: quadratures of the two
   * formulas, .87156 and .74065 */
  const double eye[3] = {sin(PI / 9), 0, cos(PI / 9)};
  for (int defaults = 0; defaults < 2; defaults++) {
    double rgb[3];
    shade_params_init_as(&p, defaults);
    p.mdf = SHADE_MDF_GGX;
    p.fresnel = SHADE_FRESNEL_NONE;
    shade_params_set_alphas(&p, .3, .3);
    shade_bsdf_albedo *a = shade_bsdf_albedo_create(&p, NULL);
    shade_bsdf_albedo_eval(a, NULL, eye, rgb, NULL);
    assert_near(rgb[1], defaults ? .87156 : .74065, 5e-3);
    shade_bsdf_albedo_free(a);
  }
}

/* Defaults by version: 0 is what libshade 0.2 had, above and below count as the nearest. */
static void versions_of_defaults(void **state) {
  (void)state;
  const int brdf[] = {SHADE_BRDF_ASHIKHMIN_SHIRLEY, SHADE_BRDF_ASHIKHMIN_SHIRLEY, SHADE_BRDF_AUTO,
                      SHADE_BRDF_AUTO};
  assert_int_equal(SHADE_DEFAULTS, 1);
  for (int version = -1; version <= 2; version++) {
    shade_params p, want;
    memset(&p, 0, sizeof p);
    memset(&want, 0, sizeof want);
    shade_params_init(&want);
    shade_params_init_as(&p, version);
    want.brdf = (shade_brdf)brdf[version + 1];
    want.defaults = version < 1 ? 0 : 1;
    assert_memory_equal(&p, &want, sizeof p);
    for (int list = 0; list < SHADE_LIST_COUNT; list++)
      assert_int_equal(shade_list_default((shade_list)list, version),
                       shade_params_get_choice(&want, (shade_list)list));
  }
  assert_int_equal(shade_list_default(SHADE_LIST_COUNT, 1), -1);
}

static void short_fabric(void **state) {
  (void)state;
  shade_draft *draft = shade_draft_named("twill_2_1");
  shade_weave *weave = shade_weave_create(draft, NULL, NULL);
  assert_non_null(weave);
  const double wi[3] = {0.3, 0.2, sqrt(0.87)}, wo[3] = {-0.5, 0.1, sqrt(0.74)};
#define SHORT_FABRIC(member)                                                                       \
  do {                                                                                             \
    shade_fabric_params p, want;                                                                   \
    shade_fabric_params_init(&p);                                                                  \
    p.mdf = SHADE_MDF_BECKMANN;                                                                    \
    p.brdf = SHADE_BRDF_MICROFACET;                                                                \
    p.detail = SHADE_DETAIL_PERTURB;                                                               \
    p.warp.along = 20;                                                                             \
    p.weft.f0[1] = 0.3;                                                                            \
    p.draft_colors = 1;                                                                            \
    p.backing[1] = 0.5;                                                                            \
    p.nap = 0.7;                                                                                   \
    p.nap_color[2] = 0.9;                                                                          \
    shade_fabric_params_init(&want);                                                               \
    want.brdf = SHADE_BRDF_ASHIKHMIN_SHIRLEY;                                                      \
    want.shadows = 0;                                                                              \
    memcpy((char *)&want + sizeof p.size, (char *)&p + sizeof p.size,                              \
           offsetof(shade_fabric_params, member) - sizeof p.size);                                 \
    BYTES_FROM(p, member);                                                                         \
    unsigned status = 0;                                                                           \
    shade_fabric *f = shade_fabric_create(weave, &p, &status),                                     \
                 *f_want = shade_fabric_create(weave, &want, NULL);                                \
    assert_int_equal(status, SHADE_OK);                                                            \
    for (int k = 0; k < 20; k++) {                                                                 \
      const double uv[2] = {k * 0.37, k * 0.61};                                                   \
      double s[3], s_want[3];                                                                      \
      shade_fabric_eval(f, uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, s);                            \
      shade_fabric_eval(f_want, uv, NULL, NULL, wi, wo, SHADE_TIER_NEAR, s_want);                  \
      assert_memory_equal(s, s_want, sizeof s);                                                    \
    }                                                                                              \
    shade_fabric_free(f);                                                                          \
    shade_fabric_free(f_want);                                                                     \
    char text[4096]; /* as a dump's header says it */                                              \
    assert_in_range(shade_fabric_params_json(&p, text, sizeof text), 1, sizeof text - 1);          \
    assert_non_null(strstr(text, "\"shadows\": false"));                                           \
  } while (0)
  SHORT_FABRIC(mdf);
  SHORT_FABRIC(brdf);
  SHORT_FABRIC(detail);
  SHORT_FABRIC(warp);
  SHORT_FABRIC(weft);
  SHORT_FABRIC(draft_colors);
  SHORT_FABRIC(backing);
  SHORT_FABRIC(nap);
  SHORT_FABRIC(nap_color);
  SHORT_FABRIC(shadows);
  {
    /* the size before `auto`: what its init wrote is what it shaded with then */
    shade_fabric_params p;
    char text[4096];
    for (int old = 0; old < 2; old++) {
      shade_fabric_params_init(&p);
      p.mdf = SHADE_MDF_GGX;
      if (old)
        BYTES_FROM(p, defaults);
      shade_fabric_params_json(&p, text, sizeof text);
      assert_non_null(strstr(text, old ? "\"brdf\": \"ashikhmin_shirley\"" : "\"brdf\": \"auto\""));
    }
  }
  shade_weave_free(weave);
  shade_draft_free(draft);
}

static void short_weave(void **state) {
  (void)state;
  shade_draft *draft = shade_draft_named("twill_2_1");
#define SHORT_WEAVE(member)                                                                        \
  do {                                                                                             \
    shade_weave_params p, want;                                                                    \
    shade_weave_params_init(&p);                                                                   \
    p.warp.gap = 0.2;                                                                              \
    p.warp.vary_brightness = p.weft.vary_brightness = 0.5;                                         \
    p.weft.curve = 0.7;                                                                            \
    p.occlusion = SHADE_OCCLUSION_NONE;                                                            \
    p.seed = 77;                                                                                   \
    shade_weave_params_init(&want);                                                                \
    memcpy((char *)&want + sizeof p.size, (char *)&p + sizeof p.size,                              \
           offsetof(shade_weave_params, member) - sizeof p.size);                                  \
    BYTES_FROM(p, member);                                                                         \
    unsigned status = 0;                                                                           \
    shade_weave *w = shade_weave_create(draft, &p, &status),                                       \
                *w_want = shade_weave_create(draft, &want, NULL);                                  \
    assert_int_equal(status, SHADE_OK);                                                            \
    for (int k = 0; k < 50; k++) {                                                                 \
      shade_crossing at = {0}, at_want = {0};                                                      \
      shade_weave_lookup(w, k * 0.37, k * 0.61, &at);                                              \
      shade_weave_lookup(w_want, k * 0.37, k * 0.61, &at_want);                                    \
      assert_memory_equal(&at, &at_want, sizeof at);                                               \
    }                                                                                              \
    shade_weave_free(w);                                                                           \
    shade_weave_free(w_want);                                                                      \
  } while (0)
  SHORT_WEAVE(warp);
  SHORT_WEAVE(weft);
  SHORT_WEAVE(occlusion);
  SHORT_WEAVE(seed);
  shade_draft_free(draft);
}

static void short_scratches(void **state) {
  (void)state;
#define SHORT_SCRATCH(member)                                                                      \
  do {                                                                                             \
    shade_scratch_params p, want;                                                                  \
    shade_scratch_params_init(&p);                                                                 \
    p.seed = 9;                                                                                    \
    p.aspect = 0.5;                                                                                \
    p.cells = 16;                                                                                  \
    p.layers = 2;                                                                                  \
    for (int l = 0; l < SHADE_SCRATCH_LAYERS; l++)                                                 \
      p.layer[l].pits = 300;                                                                       \
    shade_scratch_params_init(&want);                                                              \
    memcpy((char *)&want + sizeof p.size, (char *)&p + sizeof p.size,                              \
           offsetof(shade_scratch_params, member) - sizeof p.size);                                \
    BYTES_FROM(p, member);                                                                         \
    unsigned status = 0;                                                                           \
    shade_scratch_field *f = shade_scratch_create(&p, &status),                                    \
                        *f_want = shade_scratch_create(&want, NULL);                               \
    assert_int_equal(status, SHADE_OK);                                                            \
    for (int k = 0; k < 400; k++) {                                                                \
      double height[2] = {0, 0};                                                                   \
      shade_slopes s = {0}, s_want = {0};                                                          \
      shade_scratch_eval(f, k * 0.37, k * 0.61, NULL, &height[0], &s);                             \
      shade_scratch_eval(f_want, k * 0.37, k * 0.61, NULL, &height[1], &s_want);                   \
      assert_true(height[0] == height[1]);                                                         \
      assert_memory_equal(&s, &s_want, sizeof s);                                                  \
    }                                                                                              \
    shade_scratch_free(f);                                                                         \
    shade_scratch_free(f_want);                                                                    \
  } while (0)
  SHORT_SCRATCH(seed);
  SHORT_SCRATCH(aspect);
  SHORT_SCRATCH(cells);
  SHORT_SCRATCH(layers);
  SHORT_SCRATCH(layer);
}

static void short_slopes(void **state) {
  (void)state;
  const float pixels[] = {.7f, .6f, .9f, .4f, .5f, .8f, .5f, .3f, .9f, .6f, .2f, .7f};
#define SHORT_SLOPES(member)                                                                       \
  do {                                                                                             \
    shade_slope_options o, want;                                                                   \
    shade_slope_options_init(&o);                                                                  \
    o.normals = (shade_normals)1;                                                                  \
    o.wrap = SHADE_WRAP_CLAMP;                                                                     \
    o.directx = 1;                                                                                 \
    o.strength = 0.5;                                                                              \
    shade_slope_options_init(&want);                                                               \
    memcpy((char *)&want + sizeof o.size, (char *)&o + sizeof o.size,                              \
           offsetof(shade_slope_options, member) - sizeof o.size);                                 \
    BYTES_FROM(o, member);                                                                         \
    unsigned status = 0;                                                                           \
    shade_slope_map *m = shade_slope_map_create(pixels, 2, 2, 3, &o, &status),                     \
                    *m_want = shade_slope_map_create(pixels, 2, 2, 3, &want, NULL);                \
    assert_int_equal(status, SHADE_OK);                                                            \
    for (int k = 0; k < 20; k++) {                                                                 \
      shade_slopes s = {0}, s_want = {0};                                                          \
      shade_slope_lookup(m, k * 0.37, k * 0.61, NULL, &s);                                         \
      shade_slope_lookup(m_want, k * 0.37, k * 0.61, NULL, &s_want);                               \
      assert_memory_equal(&s, &s_want, sizeof s);                                                  \
    }                                                                                              \
    shade_slope_map_free(m);                                                                       \
    shade_slope_map_free(m_want);                                                                  \
  } while (0)
  SHORT_SLOPES(normals);
  SHORT_SLOPES(wrap);
  SHORT_SLOPES(directx);
  SHORT_SLOPES(strength);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(choices),
      cmocka_unit_test(other_choices),
      cmocka_unit_test(constants),
      cmocka_unit_test(ranges),
      cmocka_unit_test(defaults),
      cmocka_unit_test(metals),
      cmocka_unit_test(materialx_clamp),
      cmocka_unit_test(fast_is_float),
      cmocka_unit_test(short_params),
      cmocka_unit_test(short_fabric),
      cmocka_unit_test(short_weave),
      cmocka_unit_test(short_scratches),
      cmocka_unit_test(short_slopes),
      cmocka_unit_test(brdf_auto),
      cmocka_unit_test(versions_of_defaults),
  };
  return cmocka_run_group_tests_name("values", tests, NULL, NULL);
}
