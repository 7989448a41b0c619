/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.6 */
/* Drafts by name and pattern against matrices written by hand, and look-ups against the rules. */
#include <string.h>

#include "shade/weave.h"
#include "support.h"

/* 'X' where the warp is on top, the first line the first pick. */
static void holds(shade_draft *d, const char *matrix) {
  assert_non_null(d);
  const char *at = matrix;
  for (int j = 0; j < d->picks; j++, at++)
    for (int i = 0; i < d->ends; i++, at++)
      assert_int_equal(d->warp_up[j * d->ends + i], *at == 'X');
  assert_int_equal(at - matrix, strlen(matrix) + 1);
  shade_draft_free(d);
}

static void named(void **state) {
  (void)state;
  holds(shade_draft_named("plain"), ".X\n"
                                    "X.");
  holds(shade_draft_named("Twill-2-1"), ".XX\n"
                                        "X.X\n"
                                        "XX.");
  holds(shade_draft_named("twill_1_2"), "..X\n"
                                        "X..\n"
                                        ".X.");
  holds(shade_draft_named("twill_3_1"), ".XXX\n"
                                        "X.XX\n"
                                        "XX.X\n"
                                        "XXX.");
  holds(shade_draft_named("twill_1_3"), "...X\n"
                                        "X...\n"
                                        ".X..\n"
                                        "..X.");
  holds(shade_draft_named("twill_2_2"), "..XX\n"
                                        "X..X\n"
                                        "XX..\n"
                                        ".XX.");
  holds(shade_draft_named("satin_5"), ".XXXX\n"
                                      "XX.XX\n"
                                      "XXXX.\n"
                                      "X.XXX\n"
                                      "XXX.X");
  holds(shade_draft_named("sateen_5"), "....X\n"
                                       ".X...\n"
                                       "...X.\n"
                                       "X....\n"
                                       "..X..");
  holds(shade_draft_named("satin_8"), ".XXXXXXX\n"
                                      "XXX.XXXX\n"
                                      "XXXXXX.X\n"
                                      "X.XXXXXX\n"
                                      "XXXX.XXX\n"
                                      "XXXXXXX.\n"
                                      "XX.XXXXX\n"
                                      "XXXXX.XX");
  holds(shade_draft_named("sateen_8"), ".......X\n"
                                       "..X.....\n"
                                       ".....X..\n"
                                       "X.......\n"
                                       "...X....\n"
                                       "......X.\n"
                                       ".X......\n"
                                       "....X...");
  holds(shade_draft_named("basket"), "..XX\n"
                                     "..XX\n"
                                     "XX..\n"
                                     "XX..");
  holds(shade_draft_named("herringbone"), "X..XX..X.XX..XX.\n"
                                          "XX..XX..XX..XX..\n"
                                          ".XX..XX.X..XX..X\n"
                                          "..XX..XX..XX..XX");
  assert_null(shade_draft_named("twill"));
  assert_null(shade_draft_named(NULL));
  const char *word, *label, *help;
  int row = 0;
  for (; shade_weave_row(row, &word, &label, &help); row++) {
    shade_draft *d = shade_draft_named(word);
    assert_non_null(d);
    assert_true(*label && *help);
    shade_draft_free(d);
  }
  assert_int_equal(row, 12);
}

static void patterns(void **state) {
  (void)state;
  holds(shade_draft_from_pattern(2, 1, 1), "..X\n"
                                           ".X.\n"
                                           "X..");
  holds(shade_draft_from_pattern(2, 1, -1), "..X\n"
                                            "X..\n"
                                            ".X.");
  holds(shade_draft_from_pattern(1, 3, 2), ".XXX\n"
                                           "XX.X");
  holds(shade_draft_from_pattern(1, 1, 0), ".X");
  holds(shade_draft_from_pattern(3, 0, 5), "...\n"
                                           "...\n"
                                           "...");
  holds(shade_draft_from_pattern(SHADE_WEFT_ONLY, 3, 7), ".");
  assert_null(shade_draft_from_pattern(0, 1, 1));
  assert_null(shade_draft_from_pattern(0, 0, 1));
  assert_null(shade_draft_from_pattern(-1, 3, 1));
  assert_null(shade_draft_from_pattern(3, -1, 1));
  assert_null(shade_draft_from_pattern(SHADE_WEFT_ONLY, -1, 0));
  assert_null(shade_draft_from_pattern(4000, 97, 1));
  shade_draft_free(shade_draft_from_pattern(4000, 96, 1));
  holds(shade_draft_from_pattern(1, 2, -2147483647 - 1), ".XX\n" /* -2^31 mod 3 = 1 */
                                                         "XX.\n"
                                                         "X.X");
  holds(shade_draft_from_matrix(3, 2, (const unsigned char[]){0, 1, 0, 9, 0, 255}), ".X.\n"
                                                                                    "X.X");
  assert_null(shade_draft_from_matrix(-1, 2, (const unsigned char[]){0}));
  assert_null(shade_draft_create(0, 1));
  assert_null(shade_draft_create(1, SHADE_DRAFT_MAX_SIDE + 1));
  assert_null(shade_draft_create(SHADE_DRAFT_MAX_SIDE, 1025));
}

/* ---- look-ups ---- */

static shade_weave *make(const char *name, const shade_weave_params *p) {
  shade_draft *d = shade_draft_named(name);
  unsigned status = SHADE_OK;
  shade_weave *w = shade_weave_create(d, p, &status);
  shade_draft_free(d);
  assert_non_null(w);
  assert_int_equal(status, SHADE_OK);
  return w;
}

static void defaults(void **state) {
  (void)state;
  shade_weave_params p;
  shade_weave_params_init(&p);
  assert_true(p.warp.width == 1 && p.weft.gap == 0 && p.weft.curve == .5 && p.warp.ridge == .2);
  assert_true(p.warp.crimp == 0 && p.weft.vary_tilt == 0 && p.occlusion == SHADE_OCCLUSION_TILT);
  shade_param_info info;
  int row = 0;
  for (; shade_yarn_param_row(row, &info); row++) {
    double *number = shade_yarn_param(&p.weft, info.word);
    assert_non_null(number);
    assert_true(*number == info.initial && info.components == 1);
    assert_true(info.minimum <= info.initial && info.initial <= info.maximum && *info.help);
    *number = (double)row + 1000;
  }
  /* each number has a place of its own, and they fill the struct */
  assert_int_equal((size_t)row * sizeof(double), sizeof(shade_yarn_params));
  for (int k = 0; shade_yarn_param_row(k, &info); k++)
    assert_true(*shade_yarn_param(&p.weft, info.word) == k + 1000);
  assert_null(shade_yarn_param(&p.weft, "wid"));
  assert_null(shade_yarn_param(&p.weft, NULL));
}

static void out_of_range(void **state) {
  (void)state;
  shade_draft *d = shade_draft_named("plain");
  shade_weave_params p;
  unsigned status = SHADE_OK;
  shade_weave_params_init(&p);
  p.weft.width = -3;
  p.weft.curve = NAN;
  p.warp.crimp = INFINITY;
  p.occlusion = (shade_occlusion)77;
  shade_weave *w = shade_weave_create(d, &p, &status);
  assert_int_equal(status, SHADE_CLAMPED_PARAMETER | SHADE_BAD_CHOICE);
  const shade_weave_params *used = shade_weave_get_params(w);
  assert_true(used->weft.width == 1e-6 && used->weft.curve == .5 && used->warp.crimp == .98);
  assert_int_equal(used->occlusion, SHADE_OCCLUSION_NONE);
  shade_weave_free(w);
  /* a caller built when the struct ended before the occlusion */
  shade_weave_params_init(&p);
  p.size = offsetof(shade_weave_params, occlusion);
  p.warp.curve = .25;
  p.occlusion = SHADE_OCCLUSION_SKY;
  w = shade_weave_create(d, &p, NULL);
  assert_true(shade_weave_get_params(w)->warp.curve == .25);
  assert_int_equal(shade_weave_get_params(w)->occlusion, SHADE_OCCLUSION_TILT);
  assert_true(shade_draft_equal(shade_weave_draft(w), d));
  shade_crossing c;
  assert_int_equal(shade_weave_lookup(w, NAN, .25, &c), SHADE_BAD_INPUT);
  assert_true(c.top == SHADE_TOP_WEFT && c.sigma == -.5);
  assert_int_equal(shade_weave_lookup(w, .5, -INFINITY, &c), SHADE_BAD_INPUT);
  shade_weave_free(w);
  shade_draft_free(d);
  assert_null(shade_weave_create(NULL, NULL, NULL));
}

/* All that can vary does, and nothing leaves its range; float and batches follow. */
static void ranges(void **state) {
  (void)state;
  enum { COUNT = 4000 };
  static double u[COUNT], v[COUNT], sigma[COUNT], dx[COUNT], dy[COUNT], light[COUNT], red[COUNT];
  static float uf[COUNT], vf[COUNT], dxf[COUNT];
  static int top[COUNT], yarn[COUNT], topf[COUNT];
  uint64_t seed = 11;
  const char *word;
  double worst[2] = {0, 0}; /* with noise along the yarns, and without */
  for (int row = 0; shade_weave_row(row, &word, NULL, NULL); row++) {
    shade_weave_params p;
    shade_param_info info;
    shade_weave_params_init(&p);
    for (int k = 0; shade_yarn_param_row(k, &info); k++)
      for (int warp = 0; warp < 2; warp++)
        *shade_yarn_param(warp ? &p.warp : &p.weft, info.word) =
            info.minimum + (fmin(info.maximum, 5) - info.minimum) * uniform(&seed);
    p.warp.segments = p.weft.segments = 0; /* its jumps land elsewhere in float */
    if (row % 2)
      p.warp.slub = p.weft.slub = p.warp.along_tilt = p.weft.along_tilt = 0;
    p.occlusion = (shade_occlusion)(row / 2 % SHADE_OCCLUSION_COUNT);
    shade_weave *w = make(word, &p);
    for (int i = 0; i < COUNT; i++) {
      u[i] = uf[i] = (float)(200 * uniform(&seed) - 100);
      v[i] = vf[i] = (float)(200 * uniform(&seed) - 100);
    }
    const shade_crossings out = {.size = sizeof out,
                                 .top = top,
                                 .yarn = yarn,
                                 .sigma = sigma,
                                 .dx = dx,
                                 .dy = dy,
                                 .occlusion = light,
                                 .r = red};
    const shade_crossingsf outf = {.size = sizeof outf, .top = topf, .dx = dxf};
    assert_int_equal(shade_weave_lookup_batch(w, COUNT, u, v, &out), SHADE_OK);
    assert_int_equal(shade_weave_lookup_batchf(w, COUNT, uf, vf, &outf), SHADE_OK);
    for (int i = 0; i < COUNT; i++) {
      shade_crossing c;
      shade_crossingf f;
      assert_int_equal(shade_weave_lookup(w, u[i], v[i], &c), SHADE_OK);
      assert_int_equal(shade_weave_lookupf(w, uf[i], vf[i], &f), SHADE_OK);
      assert_true(c.top == (shade_top)top[i] && c.yarn == yarn[i] && c.sigma == sigma[i] &&
                  c.dx == dx[i] && c.dy == dy[i] && c.occlusion == light[i] &&
                  c.color[0] == red[i] && f.dx == dxf[i] && f.top == (shade_top)topf[i]);
      assert_true(hypot(c.dx, c.dy) <= .98 + 1e-15 && c.occlusion >= 0 && c.occlusion <= 1);
      assert_true(c.brightness >= 0 && c.fuzz >= 0 && c.fuzz <= 1);
      assert_near(hypot(c.tx, c.ty), 1, 1e-15);
      assert_true((fabs(c.sigma) <= 1) == (c.top != SHADE_TOP_GAP));
      assert_true(c.along >= 0 && c.along <= 1);
      if (c.top == SHADE_TOP_GAP)
        assert_true(c.dx == 0 && c.dy == 0 && c.below);
      if (c.top != f.top)
        continue; /* at the very edge of a yarn */
      double *w2 = &worst[row % 2];
      *w2 = fmax(*w2, fmax(fabs(c.dx - (double)f.dx), fabs(c.dy - (double)f.dy)));
      *w2 = fmax(*w2, fabs(c.occlusion - (double)f.occlusion));
    }
    shade_weave_free(w);
  }
  print_message("float against double: %.2g, without noise along the yarns %.2g\n", worst[0],
                worst[1]);
  assert_true(worst[0] < 4e-4 && worst[1] < 1e-6);
}

/* Noise: mean 0, variance 1/3, no two channels, yarns or knots alike; the lattice as far as 2^32.
 */
static void noise(void **state) {
  (void)state;
  shade_weave_params p;
  shade_weave_params_init(&p);
  p.weft.ridge = p.weft.curve = p.weft.segments = 0;
  p.weft.vary_tilt = .5;
  p.weft.vary_brightness = 1;
  shade_draft *d = shade_draft_from_pattern(SHADE_WEFT_ONLY, 1, 1);
  shade_weave *w = shade_weave_create(d, &p, NULL);
  double sum[3] = {0}, square[6] = {0}, last = 0, step = 0;
  const int count = 200000;
  for (int j = 0; j < count; j++) {
    shade_crossing c;
    shade_weave_lookup(w, .3, j - 1000 + .5, &c);
    const double r[3] = {c.brightness - 1, c.dx / .5, c.dy / .5};
    for (int k = 0; k < 3; k++) {
      sum[k] += r[k];
      square[k] += r[k] * r[k];
      square[3 + k] += r[k] * r[(k + 1) % 3];
    }
    step += r[0] * last;
    last = r[0];
  }
  /* standard errors: 1/sqrt(3 n) of a mean, about as much of a covariance; five of them */
  const double error = 5 / sqrt(3. * count);
  for (int k = 0; k < 3; k++) {
    assert_near(sum[k] / count, 0, error);
    assert_near(square[k] / count, 1. / 3, error);
    assert_near(square[3 + k] / count, 0, error);
  }
  assert_near(step / count, 0, error);
  shade_weave_free(w);
  /* along the yarn it is continuous, and has no jump in slope at the knots */
  p.weft.vary_tilt = p.weft.vary_brightness = 0;
  p.weft.along_brightness = 1;
  p.weft.along_length = 2.5;
  w = shade_weave_create(d, &p, NULL);
  double before[3] = {NAN, NAN, NAN};
  for (int i = 0; i < 20000; i++) {
    shade_crossing c;
    shade_weave_lookup(w, i * .001 - 5, .5, &c);
    if (i >= 3) {
      /* two cubics of height 2: |slope| <= 1.5 * 2/2.5, |bend| <= 6 * 2/2.5^2 */
      assert_true(fabs(c.brightness - before[0]) <= 1.2 * .001 + 1e-9);
      assert_true(fabs(c.brightness - 2 * before[0] + before[1]) <= 1.92e-6 + 1e-9);
    }
    before[1] = before[0];
    before[0] = c.brightness;
  }
  shade_weave_free(w);
  shade_draft_free(d);
}

/* Cosine-weighted share of the sky over a row of arcs, by rays: the truth for `sky`. */
static double sky_by_rays(double curve, double share, double sigma) {
  /* arcs of radius R, width 2, neighbours 2/share apart */
  const double radius = 1 / curve, tilt = asin(curve * sigma);
  const double x = sigma, z = sqrt(radius * radius - sigma * sigma);
  const int rays = 200000;
  double sum = 0;
  for (int i = 0; i < rays; i++) {
    const double angle = ((i + .5) / rays - .5) * PI; /* from the normal, towards +sigma */
    const double a = tilt + angle, rx = sin(a), rz = cos(a);
    int blocked = rz <= 0; /* down into the gap, if not onto an arc */
    for (int k = -3; k <= 3; k++) {
      if (k == 0)
        continue;
      /* nearest approach to the circle's centre, ahead of the start; only the arc is there */
      const double cx = 2 / share * k - x, cz = -z, t = cx * rx + cz * rz;
      const double gap2 = cx * cx + cz * cz - t * t;
      if (t <= 0 || gap2 >= radius * radius)
        continue;
      const double hit = t - sqrt(radius * radius - gap2);
      const double across = hit * rx - cx, height = hit * rz - cz;
      blocked |= fabs(across) <= 1 && height > 0;
    }
    if (!blocked)
      sum += cos(angle);
  }
  return sum / rays * PI / 2;
}

static void sky(void **state) {
  (void)state;
  double worst = 0;
  const double curves[] = {.2, .5, .9}, gaps[] = {0, .3, 1};
  for (int a = 0; a < 3; a++)
    for (int g = 0; g < 3; g++) {
      shade_weave_params p;
      shade_weave_params_init(&p);
      p.weft.curve = curves[a];
      p.weft.gap = gaps[g];
      p.weft.ridge = 0;
      p.occlusion = SHADE_OCCLUSION_SKY;
      shade_draft *d = shade_draft_from_pattern(SHADE_WEFT_ONLY, 1, 1);
      shade_weave *w = shade_weave_create(d, &p, NULL);
      const double share = 1 / (1 + gaps[g]);
      for (double sigma = -.95; sigma < 1; sigma += .19) {
        shade_crossing c;
        shade_weave_lookup(w, .5, .5 + .5 * sigma * share, &c);
        assert_near(c.sigma, sigma, 1e-12);
        worst = fmax(worst, fabs(c.occlusion - sky_by_rays(curves[a], share, sigma)));
      }
      shade_weave_free(w);
      shade_draft_free(d);
    }
  print_message("sky against rays: %.2g\n", worst);
  assert_true(worst < 2e-5);
}

static void colors_and_lengths(void **state) {
  (void)state;
  shade_draft *d = shade_draft_create(3, 2);
  d->warp_up[0] = d->warp_up[4] = 7; /* whatever is not 0 */
  d->warp[0].color[0] = .5;
  d->warp[0].color[1] = .04;
  d->warp[0].color[2] = 2;
  d->warp[0].spacing = .2;
  d->warp[1].spacing = .1;
  d->weft[0].thickness = 3;
  d->weft[1].thickness = 1;
  shade_weave *w = shade_weave_create(d, NULL, NULL);
  shade_crossing c;
  shade_weave_lookup(w, 3.5, .5, &c);
  assert_true(c.top == SHADE_TOP_WARP && c.yarn == 0 && c.swap);
  assert_near(c.color[0], pow(1.11 / 2.11, 2.4), 1e-15);
  assert_near(c.color[1], .04 / 12.92, 1e-16);
  assert_true(c.color[2] == 1);
  /* mean thickness 2: the thin pick fills half its crossing */
  shade_weave_lookup(w, .5, 1.7, &c);
  assert_true(c.top == SHADE_TOP_WEFT && c.yarn == 1);
  assert_near(c.sigma, .8, 1e-12);
  shade_weave_lookup(w, .5, 1.8, &c); /* beside it the end below */
  assert_true(c.top == SHADE_TOP_WARP && c.below && c.yarn == 0);
  shade_weave_lookup(w, 1.5, .9, &c); /* the thick one no more than its own */
  assert_true(c.top == SHADE_TOP_WEFT && c.yarn == 0);
  assert_near(c.sigma, .8, 1e-12);
  shade_weave_free(w);
  /* the third end takes the mean of what is stated, .15: a repeat is .45 cm */
  double u, v;
  shade_draft_cells(d, 1, .2 + .05, .25, &u, &v);
  assert_near(u, 1.5, 1e-12);
  assert_near(v, .25, 1e-12);
  shade_draft_cells(d, 0, -.075, -.05, &u, &v);
  assert_near(u, -.5, 1e-12);
  assert_near(v, -.5, 1e-12);
  shade_draft_cells(d, 1, 4.5 + .1, INFINITY, &u, &v);
  assert_near(u, 30.5, 1e-11);
  assert_true(v == 0);
  shade_weave_params p;
  shade_weave_params_init(&p);
  assert_int_equal(shade_weave_params_from_draft(&p, d), 0);
  assert_true(p.warp.width == 1);
  d->warp[1].thickness = .06;
  assert_int_equal(shade_weave_params_from_draft(&p, d), 1);
  assert_near(p.warp.width, .06, 1e-15);
  assert_near(p.warp.gap, .09, 1e-15);
  assert_near(p.weft.width, .06, 1e-15);
  /* as dense as its spacing says; without, square by the thicker yarns; else as the cloth, evenly
   */
  double per_cm[2] = {120, 45};
  d->weft[0].spacing = 1e10; /* no length of a yarn's */
  assert_int_equal(shade_draft_sett(d, per_cm), SHADE_SETT_SPACING);
  assert_near(per_cm[0], 1 / .15, 1e-12);
  assert_near(per_cm[1], 1 / .15, 1e-12);
  shade_draft_free(d);
  d = shade_draft_named("twill_2_2");
  per_cm[0] = 80;
  per_cm[1] = 45;
  assert_int_equal(shade_draft_sett(d, per_cm), SHADE_SETT_EVEN);
  assert_near(per_cm[0], 60, 1e-12);
  assert_near(per_cm[1], 60, 1e-12);
  static const double odd[] = {0, -4, NAN, INFINITY};
  for (int k = 0; k < 4; k++) {
    double none[2] = {odd[k], 9};
    assert_int_equal(shade_draft_sett(d, none), SHADE_SETT_EVEN);
    assert_true(none[0] == 1 && none[1] == 1);
  }
  d->weft[1].thickness = .05;
  d->warp[0].thickness = .02;
  assert_int_equal(shade_draft_sett(d, per_cm), SHADE_SETT_THICKNESS);
  assert_near(per_cm[0], 20, 1e-12);
  assert_near(per_cm[1], 20, 1e-12);
  assert_int_equal(shade_weave_params_from_draft(&p, d), 1);
  assert_near(p.warp.width, .02, 1e-15);
  assert_near(p.warp.gap, .03, 1e-15);
  assert_near(p.weft.width, .05, 1e-15);
  assert_near(p.weft.gap, 0, 1e-15);
  shade_draft_free(d);
}

/*
 * Strands at an angle to the yarn's axis stand at theta to the line across it, tan theta =
 * 1/tan angle = 2 slant crossing/width; S leans one way on the weft and, mirrored, the other on
 * the warp. Fibres of single yarn lie along its strands.
 */
static void twist(void **state) {
  (void)state;
  for (int warp = 0; warp < 2; warp++)
    for (int z = 0; z < 2; z++)
      for (int plied = 0; plied < 2; plied++) {
        shade_weave_params p;
        shade_weave_params_init(&p);
        p.warp.width = 0.8, p.warp.gap = 0.3;
        p.weft.width = 0.5, p.weft.gap = 0.1;
        const double angle = 0.6, width = warp ? 0.8 : 0.5, crossing = warp ? 0.6 : 1.1;
        assert_int_equal(shade_weave_params_set_twist(&p, warp ? SHADE_TOP_WARP : SHADE_TOP_WEFT,
                                                      z ? 'Z' : 's', angle, 3, plied),
                         SHADE_OK);
        const shade_yarn_params *yarn = warp ? &p.warp : &p.weft, *other = warp ? &p.weft : &p.warp;
        const double sign = z ? -1 : 1;
        assert_true(yarn->segments == 3 && other->segments == 1);
        assert_near(yarn->fibre, plied ? 0 : sign * angle, 1e-15);
        assert_near(2 * yarn->slant * crossing / width, (warp ? -sign : sign) / tan(angle), 1e-12);
        assert_true(other->slant == 0.25 && other->fibre == 0);
        assert_int_equal(shade_weave_params_set_twist(&p, warp ? SHADE_TOP_WARP : SHADE_TOP_WEFT, 0,
                                                      angle, 3, plied),
                         SHADE_OK);
        assert_true(yarn->segments == 0 && yarn->slant == 0 && yarn->fibre == 0);
      }
  /* a hand that there is not is none; what is out of range is the nearest, what is no number usual
   */
  const struct {
    int hand;
    double angle, strands, fibre, segments;
    unsigned status;
  } cases[] = {{'X', .6, 3, 0, 0, SHADE_BAD_CHOICE},
               {'Z', NAN, 3, -.5, 3, SHADE_CLAMPED_PARAMETER},
               {'S', .6, NAN, .6, 1, SHADE_CLAMPED_PARAMETER},
               {'z', 0, 2000, -.01, 1000, SHADE_CLAMPED_PARAMETER},
               {'S', 2, -1, PI / 2, 0, SHADE_CLAMPED_PARAMETER}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    shade_weave_params p;
    shade_weave_params_init(&p);
    assert_int_equal(shade_weave_params_set_twist(&p, SHADE_TOP_WEFT, cases[i].hand, cases[i].angle,
                                                  cases[i].strands, 0),
                     cases[i].status);
    assert_near(p.weft.fibre, cases[i].fibre, 1e-15);
    assert_true(p.weft.segments == cases[i].segments && fabs(p.weft.slant) <= 100);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(twist),
      cmocka_unit_test(named),
      cmocka_unit_test(patterns),
      cmocka_unit_test(defaults),
      cmocka_unit_test(out_of_range),
      cmocka_unit_test(ranges),
      cmocka_unit_test(noise),
      cmocka_unit_test(sky),
      cmocka_unit_test(colors_and_lengths),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
