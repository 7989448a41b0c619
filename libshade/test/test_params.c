/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/* Names, ranges, conversions and the JSON of a material. */
#include <string.h>

#include "support.h"
#include "shade/maps.h"

static void names(void **state) {
  (void)state;
  assert_int_equal(shade_list_find(SHADE_LIST_MDF, "ashikhmin-shirley"),
                   SHADE_MDF_ASHIKHMIN_SHIRLEY);
  assert_int_equal(shade_list_find(SHADE_LIST_MDF, "Ashikhmin_Shirley"),
                   SHADE_MDF_ASHIKHMIN_SHIRLEY);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, "GRAM_SCHMIDT"), SHADE_DETAIL_GRAM_SCHMIDT);
  assert_int_equal(shade_list_find(SHADE_LIST_GROOVE, "x"), SHADE_GROOVE_X);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, "rotat"), -1);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, "rotates"), -1);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, ""), -1);
  assert_int_equal(shade_list_find(SHADE_LIST_DETAIL, NULL), -1);
  assert_int_equal(shade_list_find(SHADE_LIST_COUNT, "x"), -1);
  for (int list = 0; list < SHADE_LIST_COUNT; list++) {
    const char *word, *label, *help;
    int value, row = 0;
    for (; shade_list_row((shade_list)list, row, &value, &word, &label, &help); row++) {
      assert_int_equal(shade_list_find((shade_list)list, word), value);
      assert_string_equal(shade_list_word((shade_list)list, value), word);
      assert_true(*label && *help);
    }
    assert_true(row > 0);
  }
  assert_null(shade_list_word(SHADE_LIST_DETAIL, 99));
  assert_null(shade_list_name(SHADE_LIST_COUNT));
}

static void exponents_and_alphas(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++) {
    const double *member = NULL;
    if (!strcmp(info.word, "ax"))
      member = &p.ax;
    if (!strcmp(info.word, "ay"))
      member = &p.ay;
    if (member) /* the table's alphas are those of its exponents */
      assert_near(*member, info.initial, 1e-8);
  }
  assert_int_equal(shade_params_set_alphas(&p, .1, 1.5), SHADE_OK);
  assert_near(p.ex, 198, 1e-10);
  assert_true(p.ey == 0);
  assert_int_equal(shade_params_set_exponents(&p, 6170.84, 7.876543), SHADE_OK);
  assert_near(p.ax, sqrt(2 / 6172.84), 1e-15);
  /* there and back, to the bounds that shade.h states */
  double worst = 0, worst_back = 0;
  for (double a = 1.42e-3; a <= 1; a *= 1.0001) {
    shade_params_set_alphas(&p, a, a);
    shade_params_set_exponents(&p, p.ex, p.ey);
    worst = fmax(worst, fabs(p.ax / a - 1));
    double e = 2 / (a * a) - 2;
    shade_params_set_exponents(&p, e, e);
    shade_params_set_alphas(&p, p.ax, p.ay);
    worst_back = fmax(worst_back, fabs(p.ey - e) / (e + 2));
  }
  print_message("alpha there and back: %.1e; exponent: %.1e of e + 2\n", worst, worst_back);
  assert_true(worst <= 5e-16 && worst_back <= 1e-15);
  assert_int_equal(shade_params_set_exponents(&p, -1, NAN), SHADE_CLAMPED_PARAMETER);
  assert_true(p.ex == 0 && p.ey == 10);
  assert_int_equal(shade_params_set_alphas(&p, INFINITY, 0), SHADE_CLAMPED_PARAMETER);
  assert_true(p.ax == 10 && p.ay == 1e-4 && p.ey == 1e6);
}

static void setup_clamps(void **state) {
  (void)state;
  shade_params p;
  shade_bsdf b;
  shade_params_init(&p);
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  p.ex = 2e6;
  p.f0[1] = -.5;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_CLAMPED_PARAMETER);
  assert_true(bsdf_of(&b)->numbers.kx == 1e6 && bsdf_of(&b)->numbers.f0[1] == 0);
  shade_params_init(&p);
  p.detail = (shade_detail)77;
  p.mdf = (shade_mdf)-3;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_BAD_CHOICE);
  assert_true(bsdf_of(&b)->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY &&
              bsdf_of(&b)->detail == SHADE_DETAIL_NONE);
}

/* Every parameter and component of the table, past either end and not a number: clamped, with
 * the status, and so is every list's value outside it. */
static void every_parameter_clamps(void **state) {
  (void)state;
  shade_params p;
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++) {
    double *member = (double *)(void *)((char *)&p + info.offset);
    for (int c = 0; c < info.components; c++) {
      const double inside[] = {info.minimum, info.maximum, info.initial};
      const double outside[] = {
          info.minimum - 1, info.minimum - 1e-9, 2 * info.maximum, 1e300, -INFINITY, INFINITY, NAN};
      const double mended[] = {info.minimum, info.minimum, info.maximum, info.maximum,
                               info.minimum, info.maximum, info.initial};
      shade_bsdf b, want;
      for (size_t k = 0; k < sizeof inside / sizeof inside[0]; k++) {
        shade_params_init(&p);
        member[c] = inside[k];
        assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
      }
      for (size_t k = 0; k < sizeof outside / sizeof outside[0]; k++) {
        shade_params_init(&p);
        p.mdf = k & 1 ? SHADE_MDF_GGX : SHADE_MDF_ASHIKHMIN_SHIRLEY;
        p.fresnel = k & 2 ? SHADE_FRESNEL_CONDUCTOR : SHADE_FRESNEL_F82;
        member[c] = mended[k];
        assert_int_equal(shade_bsdf_setup(&want, &p), SHADE_OK);
        member[c] = outside[k];
        assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_CLAMPED_PARAMETER);
        assert_memory_equal(&b, &want, sizeof b);
      }
    }
  }

  for (int bad = -1; bad <= 1000; bad += 1001)
    for (int list = 0; list < SHADE_LIST_COUNT; list++) {
      shade_bsdf b, want;
      for (int wrong = 0; wrong < 2; wrong++) {
        shade_list_info about;
        shade_params_init(&p);
        shade_list_about((shade_list)list, &about);
        *(int *)(void *)((char *)&p + about.offset) = wrong ? bad : 0;
        assert_int_equal(shade_bsdf_setup(wrong ? &b : &want, &p),
                         wrong ? SHADE_BAD_CHOICE : SHADE_OK);
      }
      assert_memory_equal(&b, &want, sizeof b);
    }
}

/* Bytes in which two materials differ, all of them within `size` bytes at `place`. */
static int differ_only(const shade_params *a, const shade_params *b, const void *place,
                       size_t size) {
  const char *x = (const char *)a, *y = (const char *)b;
  const size_t begin = (size_t)((const char *)place - x);
  int differ = 0;
  for (size_t i = 0; i < sizeof *a; i++)
    if (x[i] != y[i]) {
      if (i < begin || i >= begin + size)
        return -1;
      differ++;
    }
  return differ;
}

/* Each list and each row is the member of its name, and setting it changes that alone; but for
 * an exponent and the alpha of its axis. */
static void by_row(void **state) {
  (void)state;
  static shade_params p, was; /* static: no stray bytes between members */
  const struct {
    shade_list list;
    const char *word;
    void *member;
    int initial, older;
  } lists[] = {
      {SHADE_LIST_MDF, "mdf", &p.mdf, 0, 0},
      {SHADE_LIST_BRDF, "brdf", &p.brdf, SHADE_BRDF_AUTO, 0},
      {SHADE_LIST_DETAIL, "detail", &p.detail, SHADE_DETAIL_ROTATE, SHADE_DETAIL_ROTATE},
      {SHADE_LIST_GROOVE, "groove", &p.groove, 0, 0},
      {SHADE_LIST_FRESNEL, "fresnel", &p.fresnel, SHADE_FRESNEL_SCHLICK, SHADE_FRESNEL_SCHLICK},
      {SHADE_LIST_DIFFUSE, "diffuse", &p.diffuse, 0, 0},
      {SHADE_LIST_HORIZON, "horizon", &p.horizon, SHADE_HORIZON_VALID_ESTEVEZ, SHADE_HORIZON_HARD},
      {SHADE_LIST_MULTISCATTER, "multiscatter", &p.multiscatter, 0, 0}};
  assert_int_equal(SHADE_LIST_COUNT, sizeof lists / sizeof lists[0]);
  for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
    const shade_list list = lists[i].list;
    shade_list_info about;
    int value;
    assert_int_equal(shade_list_about(list, &about), 1);
    assert_string_equal(about.word, lists[i].word);
    assert_string_equal(shade_list_name(list), lists[i].word);
    assert_int_equal(about.initial, lists[i].initial);
    assert_int_equal(about.older, lists[i].older);
    assert_int_equal(about.in_every_dump,
                     list != SHADE_LIST_HORIZON && list != SHADE_LIST_MULTISCATTER);
    assert_ptr_equal((char *)&p + about.offset, lists[i].member);
    shade_params_init(&p);
    assert_int_equal(shade_params_get_choice(&p, list), lists[i].initial);
    for (int row = 0; shade_list_row(list, row, &value, NULL, NULL, NULL); row++) {
      shade_params_init(&p);
      was = p;
      assert_int_equal(shade_params_set_choice(&p, list, value), SHADE_OK);
      assert_int_equal(differ_only(&p, &was, lists[i].member, sizeof(int)), value != about.initial);
      assert_int_equal(*(int *)lists[i].member, value);
      assert_int_equal(shade_params_get_choice(&p, list), value);
    }
    assert_int_equal(shade_params_set_choice(&p, list, 1000), SHADE_BAD_CHOICE);
    assert_int_equal(shade_params_get_choice(&p, list), 0);
    *(int *)lists[i].member = -7; /* got as it stands */
    assert_int_equal(shade_params_get_choice(&p, list), -7);
  }
  const struct {
    const char *word;
    double *member;
    int components;
  } rows[] = {{"ex", &p.ex, 1}, {"ey", &p.ey, 1},  {"ax", &p.ax, 1},
              {"ay", &p.ay, 1}, {"f0", p.f0, 3},   {"f82", p.f82, 3},
              {"kd", p.kd, 3},  {"eta", p.eta, 3}, {"k", p.k, 3}};
  shade_param_info info;
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    const int row = shade_param_find(rows[i].word), count = rows[i].components;
    const double v[3] = {.25, .5, .75};
    double got[3] = {-1, -1, -1};
    assert_int_equal(shade_param_row(row, &info), 1);
    assert_string_equal(info.word, rows[i].word);
    assert_int_equal(info.components, count);
    assert_ptr_equal((char *)&p + info.offset, rows[i].member);
    shade_params_init(&p);
    was = p;
    assert_int_equal(shade_params_set(&p, row, v), SHADE_OK);
    const int pair = info.list == SHADE_LIST_MDF;
    if (!pair)
      assert_true(differ_only(&p, &was, rows[i].member, (size_t)count * sizeof *v) > 0);
    assert_int_equal(shade_params_get(&p, row, got), SHADE_OK);
    for (int c = 0; c < 3; c++) {
      assert_true(got[c] == (c < count ? v[c] : -1));
      assert_true(c >= count || rows[i].member[c] == v[c]);
    }
    const double wrong[3] = {-1, INFINITY, NAN};
    assert_int_equal(shade_params_set(&p, row, wrong), SHADE_CLAMPED_PARAMETER);
    assert_true(rows[i].member[0] == info.minimum);
    if (count == 3)
      assert_true(rows[i].member[1] == info.maximum && rows[i].member[2] == info.initial);
    rows[i].member[0] = -5;
    assert_int_equal(shade_params_get(&p, row, got), SHADE_OK);
    assert_true(got[0] == -5);
  }
  int count = 0;
  while (shade_param_row(count, &info))
    count++;
  assert_int_equal(count, sizeof rows / sizeof rows[0]);
  /* an axis' exponent and alpha go together: e = 2/alpha^2 - 2 */
  const double alpha = .1, exponent = 48;
  shade_params_init(&p);
  const double ex = p.ex, ax = p.ax;
  shade_params_set(&p, shade_param_find("AY"), &alpha);
  assert_near(p.ey, 198, 1e-10);
  assert_true(p.ay == alpha && p.ex == ex && p.ax == ax);
  shade_params_set(&p, shade_param_find("ex"), &exponent);
  assert_near(p.ax, .2, 1e-15);
  assert_true(p.ex == exponent && p.ay == alpha);
}

/* What does not exist, or lies beyond the caller's structure, is neither set nor got. */
static void by_row_out_of_reach(void **state) {
  (void)state;
  static shade_params p, was;
  const double v[3] = {.25, .5, .75};
  double got[3] = {7, 7, 7};
  shade_list_info about;
  shade_params_init(&p);
  p.size = offsetof(shade_params, k); /* holds eta, not k, not horizon */
  was = p;
  assert_int_equal(shade_params_set(&p, -1, v), SHADE_BAD_INPUT);
  assert_int_equal(shade_params_set(&p, 9, v), SHADE_BAD_INPUT);
  assert_int_equal(shade_params_set(&p, shade_param_find("k"), v), SHADE_BAD_INPUT);
  assert_int_equal(shade_params_set_choice(&p, SHADE_LIST_HORIZON, 0), SHADE_BAD_INPUT);
  assert_int_equal(shade_params_set_choice(&p, SHADE_LIST_COUNT, 0), SHADE_BAD_INPUT);
  assert_int_equal(shade_params_set_choice(&p, (shade_list)-1, 0), SHADE_BAD_INPUT);
  assert_memory_equal(&p, &was, sizeof p);
  assert_int_equal(shade_params_get(&p, -1, got), SHADE_BAD_INPUT);
  assert_int_equal(shade_params_get(&p, shade_param_find("k"), got), SHADE_BAD_INPUT);
  assert_true(got[0] == 7 && got[2] == 7);
  assert_int_equal(shade_params_get_choice(&p, SHADE_LIST_HORIZON), -1);
  assert_int_equal(shade_params_get_choice(&p, SHADE_LIST_COUNT), -1);
  assert_int_equal(shade_params_set(&p, shade_param_find("eta"), v), SHADE_OK);
  assert_true(p.eta[2] == .75);
  assert_int_equal(shade_param_find("e"), -1);
  assert_int_equal(shade_param_find("exx"), -1);
  assert_int_equal(shade_param_find(NULL), -1);
  assert_int_equal(shade_list_about(SHADE_LIST_COUNT, &about), 0);
}

/* Which choices read a number. */
static void readers(void **state) {
  (void)state;
  const struct {
    const char *word;
    shade_list list;
    unsigned choices; /* of the values that there are */
  } want[] = {{"ex", SHADE_LIST_MDF, 1},       {"ey", SHADE_LIST_MDF, 1},
              {"ax", SHADE_LIST_MDF, 0x1e},    {"ay", SHADE_LIST_MDF, 0x1e},
              {"f0", SHADE_LIST_COUNT, 0},     {"f82", SHADE_LIST_FRESNEL, 4},
              {"eta", SHADE_LIST_FRESNEL, 8},  {"k", SHADE_LIST_FRESNEL, 8},
              {"kd", SHADE_LIST_DIFFUSE, 0x3f}};
  const unsigned there[SHADE_LIST_COUNT] = {
      [SHADE_LIST_MDF] = 0x1f, [SHADE_LIST_FRESNEL] = 0xf, [SHADE_LIST_DIFFUSE] = 0x3f};
  shade_param_info info;
  for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
    assert_int_equal(shade_param_row(shade_param_find(want[i].word), &info), 1);
    assert_int_equal(info.list, want[i].list);
    if (info.list != SHADE_LIST_COUNT)
      assert_int_equal(info.choices & there[info.list], want[i].choices);
  }
}

static void json(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  shade_params_set_exponents(&p, 198, 6);
  char text[512], cut[20];
  int length = shade_params_json(&p, 3, "a \"b\"\\\n", text, sizeof text);
  assert_int_equal(length, (int)strlen(text));
  assert_string_equal(
      text, "{\"id\": 3, \"name\": \"a \\\"b\\\"\\\\\\u000a\", \"mdf\": \"ashikhmin_shirley\", "
            "\"brdf\": \"auto\", \"detail\": \"rotate\", \"groove\": \"auto\", "
            "\"fresnel\": \"schlick\", \"diffuse\": \"lambert\", \"horizon\": "
            "\"valid_estevez\", \"multiscatter\": \"off\", \"ex\": 198, \"ey\": 6, \"ax\": "
            "0.10000000000000001, "
            "\"ay\": 0.5, \"f0\": [1, 1, 1], \"f82\": [1, 1, 1], \"eta\": [0.5, 0.5, 0.5], "
            "\"k\": [3, 3, 3], \"kd\": [0, 0, 0]}");
  assert_int_equal(shade_params_json(&p, 3, "a \"b\"\\\n", cut, sizeof cut), length);
  assert_memory_equal(cut, text, sizeof cut - 1);
  assert_true(cut[sizeof cut - 1] == 0);
  assert_int_equal(shade_params_json(&p, 3, "a \"b\"\\\n", NULL, 0), length);
}

/* Of a map: given, and taken; a person's. */
static void slopes(void **state) {
  (void)state;
  const struct {
    double given[5], taken[5];
    unsigned status;
  } cases[] = {
      {{.1, -.2, .25, -.1, .16}, {.1, -.2, .25, -.1, .16}, SHADE_OK},
      {{0, 0, .25, -5, .16}, {0, 0, .25, -.2, .16}, SHADE_CLAMPED_PARAMETER},
      {{0, 0, .25, 5, .16}, {0, 0, .25, .2, .16}, SHADE_CLAMPED_PARAMETER},
      {{-2e3, 2e3, 2e6, 0, -1}, {-1e3, 1e3, 1e6, 0, 0}, SHADE_CLAMPED_PARAMETER},
      {{NAN, NAN, .25, NAN, .16}, {0, 0, .25, 0, .16}, SHADE_CLAMPED_PARAMETER},
      {{0, 0, NAN, .1, .16}, {0, 0, 0, 0, .16}, SHADE_CLAMPED_PARAMETER},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    shade_params p;
    double got[5];
    char text[1024], wanted[64];
    shade_params_init(&p);
    assert_int_equal(shade_params_set_slopes(&p, cases[i].given), cases[i].status);
    assert_int_equal(shade_params_get_slopes(&p, got), SHADE_OK);
    for (int c = 0; c < 5; c++)
      assert_near(got[c], cases[i].taken[c], 1e-15);
    shade_params_json(&p, 0, "", text, sizeof text);
    snprintf(wanted, sizeof wanted, ", %.17g]}", got[4]);
    assert_true(strstr(text, "\"slopes\": [") && strstr(text, wanted));
  }
  shade_params p;
  const double of_ridges[5] = {0, 0, 0, 0, .5}, none[5] = {.5, 0, 0, 0, 0};
  char text[1024];
  shade_params_init(&p);
  shade_params_set_slopes(&p, of_ridges); /* ridges lie along x alone */
  shade_params_json(&p, 0, "", text, sizeof text);
  assert_non_null(strstr(text, ", \"slopes\": [0, 0, 0, 0, 0.5]}"));
  shade_params_set_slopes(&p, none);
  shade_params_json(&p, 0, "", text, sizeof text);
  assert_null(strstr(text, "slopes"));
}

/* Other programs' roughness .5 and anisotropy .4, by their formulas worked out by hand. */
static void roughness(void **state) {
  (void)state;
  static const struct {
    shade_roughness from;
    double anisotropy, ax, ay;
  } cases[] = {
      {SHADE_ROUGHNESS_BLENDER_PRINCIPLED, .4, .25 / .8, .25 * .8},
      {SHADE_ROUGHNESS_BLENDER_GLOSSY, .4, .25 * .6, .25 / .6},
      {SHADE_ROUGHNESS_BLENDER_GLOSSY, -.4, .25 / .6, .25 * .6},
      {SHADE_ROUGHNESS_BLENDER_GLOSSY_2_79, .4, .5 * .6, .5 / .6},
      {SHADE_ROUGHNESS_GLTF, .4, .25 + .75 * .16, .25},
      {SHADE_ROUGHNESS_MATERIALX, .4, .3227486121839514, .19364916731037085},
      {SHADE_ROUGHNESS_OPENPBR, .4, .30316953129541624, .18190171877724973},
      {SHADE_ROUGHNESS_OPENPBR, 0, .25, .25},
  };
  shade_params p;
  shade_params_init(&p);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    assert_int_equal(shade_params_set_roughness(&p, cases[i].from, .5, cases[i].anisotropy), 0);
    assert_near(p.ax, cases[i].ax, 1e-14);
    assert_near(p.ay, cases[i].ay, 1e-14);
    assert_near(p.ex, fmax(0, 2 / (p.ax * p.ax) - 2), 1e-9);
  }
  assert_int_equal(shade_params_set_roughness(&p, SHADE_ROUGHNESS_MATERIALX, 1, 1), 0);
  assert_near(p.ax, 1, 1e-15);
  assert_int_equal(shade_params_set_roughness(&p, SHADE_ROUGHNESS_OPENPBR, 0, 1), 0);
  assert_true(p.ax == 1e-4 && p.ay == 1e-4);
  assert_int_equal(shade_params_set_roughness(&p, SHADE_ROUGHNESS_GLTF, 2, NAN),
                   SHADE_CLAMPED_PARAMETER);
  assert_true(p.ax == 1 && p.ay == 1);
  assert_int_equal(shade_params_set_roughness(&p, SHADE_ROUGHNESS_OPENPBR, NAN, 0),
                   SHADE_CLAMPED_PARAMETER);
  assert_true(p.ax == 1e-4 && p.ay == 1e-4);
  assert_int_equal(shade_params_set_roughness(&p, (shade_roughness)-1, 1, 0), SHADE_BAD_CHOICE);
  const char *word;
  int value, rows = 0;
  while (shade_roughness_row(rows, &value, &word, NULL, NULL))
    assert_int_equal(value, rows++);
  assert_int_equal(rows, SHADE_ROUGHNESS_COUNT);
}

/* What other programs' settings come to, they are read back from; what they cannot say is flagged.
 */
static void roughness_back(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  for (int from = 0; from < SHADE_ROUGHNESS_COUNT; from++) {
    const shade_roughness convention = (shade_roughness)from;
    const int glossy = convention == SHADE_ROUGHNESS_BLENDER_GLOSSY ||
                       convention == SHADE_ROUGHNESS_BLENDER_GLOSSY_2_79;
    double r, a;
    int turned;
    for (int i = 1; i < 10; i++)
      for (int j = glossy ? -9 : 0; j < 10; j++) {
        const double r_given = .05 + i / 11., a_given = j / 10.;
        assert_int_equal(shade_params_set_roughness(&p, convention, r_given, a_given), 0);
        if (p.ax >= 1 || p.ay >= 1)
          continue; /* glTF's 1, or a clamp */
        assert_int_equal(shade_params_get_roughness(&p, convention, &r, &a, &turned), 0);
        assert_near(r, r_given, 1e-9);
        assert_near(a, a_given, 1e-7); /* a square root of a difference for glTF */
        assert_int_equal(turned, 0);
        if (glossy)
          continue;
        shade_params_set_alphas(&p, p.ay, p.ax);
        assert_int_equal(shade_params_get_roughness(&p, convention, &r, &a, &turned), 0);
        assert_near(r, r_given, 1e-9);
        assert_near(a, a_given, 1e-7);
        assert_int_equal(turned, j > 0);
      }
    /* 1 to 1e5, and rougher than any of them goes */
    shade_params_set_alphas(&p, 10, 1e-4);
    assert_int_equal(shade_params_get_roughness(&p, convention, &r, &a, &turned),
                     SHADE_CLAMPED_PARAMETER);
    assert_true(r >= 0 && r <= 1 && fabs(a) <= 1 && turned == 0);
    p.ax = NAN;
    assert_int_equal(shade_params_get_roughness(&p, convention, &r, &a, &turned) &
                         SHADE_CLAMPED_PARAMETER,
                     SHADE_CLAMPED_PARAMETER);
    assert_true(r >= 0 && r <= 1 && fabs(a) <= 1);
  }
  double r, a;
  int turned;
  shade_params_set_alphas(&p, .25, .25);
  assert_int_equal(shade_params_get_roughness(&p, (shade_roughness)99, &r, &a, &turned),
                   SHADE_BAD_CHOICE);
  assert_true(r == .5 && a == 0 && turned == 0);
}

/* Gold is yellow, silver bright, and all of them metals. */
static void metal_table(void **state) {
  (void)state;
  shade_params p;
  shade_metal m;
  shade_params_init(&p);
  for (int row = 0; shade_metal_row(row, &m); row++) {
    assert_int_equal(shade_params_set_metal(&p, m.word), 1);
    assert_int_equal(p.fresnel, SHADE_FRESNEL_CONDUCTOR);
    for (int c = 0; c < 3; c++) {
      assert_true(p.eta[c] == m.eta[c] && p.k[c] == m.k[c]);
      assert_true(p.f0[c] > .35 && p.f0[c] < 1); /* least: gold's blue, .364 */
    }
  }
  assert_int_equal(shade_params_set_metal(&p, "Gold"), 1);
  assert_near(p.f0[0], .99964, 1e-5); /* |(m - 1)/(m + 1)|^2 of .01702 + 13.77 i */
  assert_near(p.f0[2], .36451, 1e-5);
  assert_int_equal(shade_params_set_metal(&p, "mithril"), 0);
  assert_int_equal(shade_params_set_metal(&p, NULL), 0);
  assert_near(p.f0[2], .36451, 1e-5);
}

/* A caller built against an older header knows fewer members. */
static void older_caller(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  p.size = offsetof(shade_params, f82);
  p.kd[0] = p.kd[1] = p.kd[2] = 7; /* beyond what that caller set */
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  assert_true(bsdf_of(&b)->numbers.kd[0] == 0);
  /* before the choice of horizon there was `hard` */
  assert_int_equal(bsdf_of(&b)->horizon, SHADE_HORIZON_HARD);
  p.size = offsetof(shade_params, horizon);
  shade_params wide;
  const double z[3] = {0, 0, 1}, covariance[3] = {.01, 0, .01};
  double angle;
  shade_params_widen(&p, z, covariance, &wide, &angle);
  assert_int_equal(wide.horizon, SHADE_HORIZON_HARD);
  assert_int_equal(wide.size, sizeof wide);
  p.size = sizeof p;
  shade_params_widen(&p, z, covariance, &wide, &angle);
  assert_int_equal(wide.horizon, SHADE_HORIZON_VALID_ESTEVEZ);
}

/* What shade.h says that a material is which its author has not touched. */
static void defaults(void **state) {
  (void)state;
  shade_params p;
  shade_params_init(&p);
  shade_bsdf b;
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  assert_int_equal(bsdf_of(&b)->mdf, SHADE_MDF_ASHIKHMIN_SHIRLEY);
  assert_int_equal(bsdf_of(&b)->brdf, SHADE_BRDF_ASHIKHMIN_SHIRLEY);
  assert_int_equal(bsdf_of(&b)->detail, SHADE_DETAIL_ROTATE);
  assert_int_equal(bsdf_of(&b)->fresnel, SHADE_FRESNEL_SCHLICK);
  assert_int_equal(bsdf_of(&b)->diffuse, SHADE_DIFFUSE_LAMBERT);
  assert_int_equal(bsdf_of(&b)->horizon, SHADE_HORIZON_VALID_ESTEVEZ);
  p.detail = SHADE_DETAIL_NONE; /* without n there is nothing to be kinder to */
  assert_int_equal(shade_bsdf_setup(&b, &p), SHADE_OK);
  assert_int_equal(bsdf_of(&b)->horizon, SHADE_HORIZON_HARD);
}

/* Numbers that JSON has no word for never reach it. */
static void json_stays_finite(void **state) {
  (void)state;
  shade_params p;
  char text[2048];
  shade_params_init(&p);
  p.ex = INFINITY;
  p.f0[0] = NAN;
  assert_true(shade_params_json(&p, 0, NULL, text, sizeof text) < (int)sizeof text);
  assert_null(strstr(text, "inf"));
  assert_null(strstr(text, "nan"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(names),
      cmocka_unit_test(exponents_and_alphas),
      cmocka_unit_test(setup_clamps),
      cmocka_unit_test(every_parameter_clamps),
      cmocka_unit_test(json),
      cmocka_unit_test(older_caller),
      cmocka_unit_test(defaults),
      cmocka_unit_test(json_stays_finite),
      cmocka_unit_test(slopes),
      cmocka_unit_test(roughness),
      cmocka_unit_test(roughness_back),
      cmocka_unit_test(metal_table),
      cmocka_unit_test(by_row),
      cmocka_unit_test(readers),
      cmocka_unit_test(by_row_out_of_reach),
  };
  return cmocka_run_group_tests_name("params", tests, NULL, NULL);
}
