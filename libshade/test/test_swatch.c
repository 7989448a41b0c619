/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.4 */
/* The scene of shade swatch: its lights add up to what they are said to be, its places follow the
 * cloth, and a pixel is the sum over its lights written out here. */
#include "support.h"

/* What the swatch asks its scratches, without strokes. */
#define shade_scratch_eval asked_of_scratches
#define tool_write_pictures asked_to_write
#include "../tool/swatch.c"
#undef shade_scratch_eval
#undef tool_write_pictures

static struct { double u, v, footprint[4]; } asked;
unsigned asked_of_scratches(const shade_scratch_field *f, double u, double v,
                            const double footprint[4], double *height, shade_slopes *slopes) {
  (void)f, (void)height;
  asked.u = u;
  asked.v = v;
  memcpy(asked.footprint, footprint, sizeof asked.footprint);
  *slopes = (shade_slopes){.normal = {0, 0, 1}};
  return SHADE_OK;
}

/* What would be written, of which nothing is drawn. */
static struct {
  char path[16], note[32];
  shade_image_spec spec;
  int count, threads;
} written;
int asked_to_write(const char *title, const tool_picture *pictures, int count, int threads,
                   tool_fill *fill, void *context) {
  assert_string_equal(title, "swatch");
  assert_true(fill == fill_rows && context);
  written.spec = pictures->spec;
  snprintf(written.path, sizeof written.path, "%s", pictures->path);
  snprintf(written.note, sizeof written.note, "%s", pictures->spec.note);
  written.count = count;
  written.threads = threads;
  return TOOL_DONE;
}

/* pi over the sky's irradiance on a sheet that faces the eye, by quadrature over height and turn.
 */
static double scale_by_quadrature(void) {
  enum { N = 400 };
  double total = 0;
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      /* z^2 evenly: directions weighted by their cosine */
      const double z = sqrt((i + .5) / N), r = sqrt(1 - z * z), turned = 2 * PI * (j + .5) / N;
      const double d[3] = {r * cos(turned), r * sin(turned), z};
      total += sky(d) / (N * N);
    }
  return 1 / total;
}

/* What a white Lambert sheet that faces `to` throws back: 1 is white. */
static double radiosity(const light *lights, int count, const double to[3]) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    const double *d = lights[i].to;
    assert_near(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1, 1e-12);
    sum += lights[i].power * (d[0] * to[0] + d[1] * to[1] + d[2] * to[2]) / PI;
  }
  return sum;
}

static void the_sky_adds_up(void **state) {
  (void)state;
  enum { MANY = 40000 };
  light *lights = malloc(MANY * sizeof *lights);
  assert_non_null(lights);
  const double eye[3] = {0, 0, 1}, scale = sky_scale();
  assert_near(scale / scale_by_quadrature(), 1, 4e-3); /* 512 directions: .0029 off */
  place_sky(.4 * scale, MANY, lights);
  assert_near(radiosity(lights, MANY, eye), .4, 1e-3);
  /* the few that a swatch takes: 12 directions for a hemisphere */
  place_sky(.4 * scale, SKY, lights);
  assert_near(radiosity(lights, SKY, eye), .4, .08);
  free(lights);
}

static void the_key_is_a_disc(void **state) {
  (void)state;
  for (int k = -2; k <= 2; k++) {
    light lights[KEY_POINTS];
    const double azimuth = .5 * k, axis[3] = {sin(azimuth) / hypot(1, .4), .4 / hypot(1, .4),
                                              cos(azimuth) / hypot(1, .4)};
    place_key(azimuth, 1.5, KEY_POINTS, lights);
    /* seen face on, but for the cosines over a disc of radius .16: 1 - .16^2/4 */
    assert_near(radiosity(lights, KEY_POINTS, axis), 1.5 * (1 - .0064), 1.5 * 2e-4);
    double widest = 0, mean[3] = {0, 0, 0};
    for (int i = 0; i < KEY_POINTS; i++) {
      const double *d = lights[i].to;
      widest = fmax(widest, acos(fmin(d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2], 1)));
      for (int c = 0; c < 3; c++)
        mean[c] += d[c] / KEY_POINTS;
    }
    assert_true(widest > .15 && widest < atan(.16));
    for (int c = 0; c < 3; c++)
      assert_near(mean[c], axis[c] * (1 - .0064), 2e-3);
  }
}

/* Frames are square; the point is on the cylinder; the cloth's length over the picture's is the
 * stretch. */
static void places_follow_the_cloth(void **state) {
  (void)state;
  uint64_t seed = 3;
  int beside = 0, on = 0;
  double leans[2] = {0, 0};
  for (int i = 0; i < 20000; i++) {
    const tile t = {.cylinder = i % 2};
    const double x = 2 * uniform(&seed) - 1, y = 2 * uniform(&seed) - 1, h = 1e-6;
    spot s, before, after;
    if (!find_spot(&t, x, y, i % 3 > 0, &s)) {
      assert_true(fabs(y) >= .98 || fabs(x) >= (t.cylinder ? CYLINDER : .98));
      beside++;
      continue;
    }
    on++;
    double cross[3] = {s.x[1] * s.y[2] - s.x[2] * s.y[1], s.x[2] * s.y[0] - s.x[0] * s.y[2],
                       s.x[0] * s.y[1] - s.x[1] * s.y[0]};
    for (int c = 0; c < 3; c++)
      assert_near(cross[c], s.z[c], 1e-12);
    assert_near(s.n[0] * s.n[0] + s.n[1] * s.n[1] + s.n[2] * s.n[2], 1, 1e-12);
    assert_true(s.n[2] > 0 && s.z[2] > 0 && s.at[1] == y);
    assert_near(s.z[0], t.cylinder ? x / CYLINDER : 0, 1e-12);
    if (!find_spot(&t, x - h, y, 1, &before) || !find_spot(&t, x + h, y, 1, &after))
      continue;
    if (t.cylinder && i % 3 && y >= .6) /* folds begin below, and open downwards */
      assert_near(s.n[0], 0, 1e-12);
    if (t.cylinder && i % 3)
      leans[y < -.2] = fmax(leans[y < -.2], fabs(s.n[0]));
    if (s.z[2] > .05)
      assert_near((after.at[0] - before.at[0]) / (2 * h) / s.stretch, 1, 1e-5);
    assert_near(s.stretch, 1 / fmax(s.z[2], .02), 1e-9);
  }
  assert_true(on > 15000 && beside > 500);
  assert_true(leans[0] > .1 && leans[1] > 1.5 * leans[0]);
}

/* The pixel as the text above find_spot and the constants say it: every light by itself, the
 * footprint from where the cloth is half a pixel to the left and to the right. */
static void expected_pixel(const material *m, const tile *t, double scale_of_sky, double x,
                           double y, double size, double rgb[3]) {
  light lights[LIGHTS];
  place_key(t->azimuth, 1.5, 13, lights);
  for (int i = 0; i < 12; i++) {
    /* the hemisphere in 12 bands of equal area, a golden angle from one to the next */
    const double z = (i + .5) / 12, r = sqrt(1 - z * z), turned = i * PI * (3 - sqrt(5));
    light *l = &lights[13 + i];
    l->to[0] = r * cos(turned);
    l->to[1] = r * sin(turned);
    l->to[2] = z;
    l->power = .4 * scale_of_sky * sky(l->to) * 2 * PI / 12;
  }
  spot s, left, right;
  assert_true(find_spot(t, x, y, 1, &s));
  const double h = 1e-6, pixel = 2 / size;
  assert_true(find_spot(t, x - h, y, 1, &left) && find_spot(t, x + h, y, 1, &right));
  const double half_cm = t->far ? 8 : 14 / m->preset.ends_per_cm;
  const double ends = half_cm * m->preset.ends_per_cm, picks = half_cm * m->preset.picks_per_cm;
  const double uv[2] = {s.at[0] * ends + 4096, y * picks + 4096};
  const double footprint[2] = {(right.at[0] - left.at[0]) / (2 * h) * pixel * ends, pixel * picks};
  double eye[3] = {t->cylinder ? 0 : -x, -y, 3.2}, wo[3];
  unit(eye);
  local(&s, eye, wo);
  rgb[0] = rgb[1] = rgb[2] = 0;
  for (int i = 0; i < LIGHTS; i++) {
    double wi[3], f[3];
    local(&s, lights[i].to, wi);
    shade_fabric_eval(m->fabric, uv, footprint, s.n, wi, wo, SHADE_TIER_AUTO, f);
    for (int c = 0; c < 3; c++)
      rgb[c] += f[c] * lights[i].power;
  }
}

static void a_pixel_of_cloth(void **state) {
  (void)state;
  static const char *const words[] = {"denim", "silk_charmeuse"};
  for (int k = 0; k < 2; k++) {
    material m = {.shared = 0};
    assert_true(shade_preset_find(words[k], &m.preset));
    assert_true(set_material(&m, 0));
    uint64_t seed = 17;
    double worst = 0, stretched = 0;
    for (int i = 0; i < 600; i++) {
      tile t = {.cylinder = i % 2, .far = i / 2 % 3 == 0, .azimuth = uniform(&seed) - .5};
      sheet sh = {.size = i % 5 ? 24 : 200, .sky = sky_scale(), .materials = &m, .tiles = &t};
      const double x = 1.7 * uniform(&seed) - .85, y = 1.9 * uniform(&seed) - .95;
      light lights[MOST_LIGHTS];
      place_key(t.azimuth, CLOTH_KEY, KEY, lights);
      place_sky(CLOTH_SKY * sh.sky, SKY, lights + KEY);
      float got[3];
      double want[3];
      draw_pixel(&sh, &t, lights, x, y, got);
      expected_pixel(&m, &t, sh.sky, x, y, sh.size, want);
      for (int c = 0; c < 3; c++)
        worst = fmax(worst, fabs((double)got[c] / want[c] - 1));
      stretched += t.cylinder && fabs(x) > .6;
    }
    print_message("%s: a pixel %.2g off\n", words[k], worst);
    assert_true(worst <= 1e-5 && stretched > 50);
    shade_fabric_free(m.fabric);
    shade_weave_free(m.weave);
  }
}

/* One step from a to b in the tile of strokes, the shorter way round. */
static double way(double a, double b) {
  return b - a - floor(b - a + .5);
}

/* The footprint of a pixel of metal is what the place in its strokes moves by from pixel to pixel;
 * of a turned one round the middle and away from it. */
static void a_pixel_of_metal(void **state) {
  (void)state;
  static const char *const words[] = {"brushed_steel", "turned_steel", "scratched_steel"};
  uint64_t seed = 23;
  light lights[MOST_LIGHTS];
  place_key(.2, METAL_KEY, KEY_POINTS, lights);
  for (int k = 0; k < 3; k++) {
    material m = {.shared = 0};
    assert_true(shade_preset_find(words[k], &m.preset));
    for (int i = 0; i < 200; i++) {
      tile t = {.cylinder = i % 2, .far = i / 2 % 2};
      const int turned = m.preset.turned && !t.cylinder;
      const double x = 1.7 * uniform(&seed) - .85, y = 1.7 * uniform(&seed) - .85;
      const double size = i % 3 ? 200 : 48, h = 1e-6, pixel = 2 / size, r = hypot(x, y);
      if (t.cylinder ? fabs(x) > .8 * CYLINDER : r < .2)
        continue;
      const sheet sh = {.size = (int)size, .sky = sky_scale(), .materials = &m, .tiles = &t};
      /* the directions of the footprint's sides, then a little along each of them */
      const double along[2][2] = {{turned ? -y / r : 1, turned ? x / r : 0},
                                  {turned ? x / r : 0, turned ? y / r : 1}};
      double moved[2][2], footprint[4];
      float rgb[3];
      for (int side = 0; side < 2; side++) {
        draw_pixel(&sh, &t, lights, x, y, rgb);
        memcpy(footprint, asked.footprint, sizeof footprint);
        const double from[2] = {asked.u, asked.v};
        draw_pixel(&sh, &t, lights, x + h * along[side][0], y + h * along[side][1], rgb);
        moved[side][0] = way(from[0], asked.u) / h * pixel;
        moved[side][1] = way(from[1], asked.v) / h * pixel;
      }
      for (int side = 0; side < 2; side++)
        for (int c = 0; c < 2; c++) {
          const double want = side == 0 && c == 0 ? fmin(fabs(moved[0][0]), turned ? 1 : 1e9)
                                                  : fabs(moved[side][c]);
          assert_near(fabs(footprint[2 * side + c]), want, 1e-4 * fabs(moved[0][0]) + 1e-6);
        }
      /* a tile shows so many centimetres */
      assert_near(fabs(moved[1][1]) * size * m.preset.scratch_cm, t.far ? 16.0 : 2.0, 1e-3);
      for (int c = 0; c < 3; c++)
        assert_true(rgb[c] > 0 && rgb[c] < 1e3f);
    }
  }
}

/* What --help says of the sheets: rows flat near, flat far, hung near, hung far, the light from
 * left to right; of all presets each flat near and hung far, in their order, what is left over
 * empty. */
static void sheets(void **state) {
  (void)state;
  const options one = {.word = "denim"};
  sheet sh = {0};
  assert_true(lay_out(&sh, &one, 1));
  assert_int_equal(sh.across, 4);
  assert_int_equal(sh.down, 4);
  static const int hung[4] = {0, 0, 1, 1}, far[4] = {0, 1, 0, 1}, degrees[4] = {-60, -20, 20, 60};
  for (int i = 0; i < 16; i++) {
    const tile *t = &sh.tiles[i];
    assert_int_equal(t->cylinder, hung[i / 4]);
    assert_int_equal(t->far, far[i / 4]);
    assert_int_equal(t->preset, 0);
    assert_near(t->azimuth * 180 / PI, degrees[i % 4], 1e-9);
  }
  free(sh.tiles);
  /* presets, how many across were asked for, what is made of it */
  static const struct {
    int count, asked, across, down;
  } all[] = {{27, 5, 5, 6}, {27, 9, 9, 3}, {4, 16, 4, 1}, {5, 1, 1, 5}};
  for (int k = 0; k < 4; k++) {
    const options o = {.all = 1, .across = all[k].asked};
    assert_true(lay_out(&sh, &o, all[k].count));
    assert_int_equal(sh.across, 2 * all[k].across);
    assert_int_equal(sh.down, all[k].down);
    for (int i = 0; i < sh.across * sh.down; i++) {
      const tile *t = &sh.tiles[i];
      assert_int_equal(t->preset, i / 2 < all[k].count ? i / 2 : -1);
      assert_int_equal(t->cylinder, i % 2);
      assert_int_equal(t->far, i % 2);
      assert_near(t->azimuth * 180 / PI, i % 2 ? 25 : -25, 1e-9);
    }
    free(sh.tiles);
  }
}

/* What --help says of sizes, of how many are in a row, and of kinds of files. */
static void what_is_written(void **state) {
  (void)state;
  static const struct {
    const char *words[8];
    int width, height, threads; /* tiles are 8 apart, names below; 0: one thread a processor */
    int type;
    const char *note;
  } calls[] = {
      {{"denim", "-o", "x.exr"}, 4 * 264 + 8, 4 * 264 + 8, 0, SHADE_IMAGE_HALF, "Cotton denim"},
      {{"-o", "x.png", "DENIM", "--size", "16", "--threads", "7"},
       4 * 24 + 8,
       4 * 24 + 8,
       7,
       SHADE_IMAGE_U8,
       "Cotton denim"},
      {{"--all", "-o", "x.png"},
       10 * 200 + 8,
       6 * (200 + 11) + 8,
       0,
       SHADE_IMAGE_U8,
       "shade swatch --all"}};
  for (int k = 0; k < 3; k++) {
    char words[9][16] = {"swatch"}, *argv[9] = {words[0]};
    int argc = 1;
    for (; calls[k].words[argc - 1]; argc++) {
      snprintf(words[argc], sizeof words[argc], "%s", calls[k].words[argc - 1]);
      argv[argc] = words[argc];
    }
    assert_int_equal(shade_cmd_swatch(argc, argv), TOOL_DONE);
    assert_int_equal(written.spec.width, calls[k].width);
    assert_int_equal(written.spec.height, calls[k].height);
    assert_int_equal(written.spec.channels, 3);
    assert_int_equal(written.spec.type, calls[k].type);
    assert_true(written.spec.srgb);
    assert_int_equal(written.count, 1);
    assert_int_equal(written.threads, calls[k].threads ? calls[k].threads : tool_threads());
    assert_string_equal(written.path, calls[k].type == SHADE_IMAGE_HALF ? "x.exr" : "x.png");
    assert_string_equal(written.note, calls[k].note);
  }
}

/* A row of a tile has the light that --help says: cloths 1.5 of the key and 0.4 of the sky, metals
 * 0.4 and 0.55; beside it there is ground. */
static void a_row_has_the_light_of_its_material(void **state) {
  (void)state;
  static const char *const words[] = {"linen", "scratched_steel"};
  for (int k = 0; k < 2; k++) {
    material m = {.shared = 0};
    assert_true(shade_preset_find(words[k], &m.preset));
    assert_true(set_material(&m, 0));
    tile t = {.azimuth = .3};
    const sheet sh = {.size = 24, .sky = sky_scale(), .materials = &m, .tiles = &t};
    float row[3 * 24];
    draw_row(&sh, &t, 9, row);
    for (int column = 4; column < 20; column++) {
      const double x = 2 * (column + .5) / 24 - 1, y = 1 - 2 * (9 + .5) / 24;
      double want[3] = {0, 0, 0};
      if (k == 0) {
        expected_pixel(&m, &t, sh.sky, x, y, 24, want);
      } else {
        light lights[MOST_LIGHTS];
        double eye[3] = {-x, -y, 3.2};
        spot s;
        place_key(.3, .4, 64, lights);
        assert_true(find_spot(&t, x, y, 0, &s));
        unit(eye);
        draw_metal(&m, &t, lights, .55 * sh.sky, &s, eye, 2. / 24, want);
      }
      for (int c = 0; c < 3; c++)
        assert_near((double)row[3 * column + c] / want[c], 1, k ? 1e-5 : .03); /* at an edge */
    }
    t.cylinder = 1;
    draw_row(&sh, &t, 9, row);
    assert_near((double)row[0], .02, 1e-7);
    shade_fabric_free(m.fabric);
    shade_weave_free(m.weave);
    shade_scratch_free(m.scratches);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sheets),
      cmocka_unit_test(what_is_written),
      cmocka_unit_test(a_row_has_the_light_of_its_material),
      cmocka_unit_test(the_sky_adds_up),
      cmocka_unit_test(the_key_is_a_disc),
      cmocka_unit_test(places_follow_the_cloth),
      cmocka_unit_test(a_pixel_of_cloth),
      cmocka_unit_test(a_pixel_of_metal),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
