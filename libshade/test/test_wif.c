/* SPDX-License-Identifier: Apache-2.0 */
/* Weaving Information Files: what is read, what is refused and where, and the way back. */
#include <string.h>

#include "shade/weave.h"
#include "support.h"

static shade_draft *parse(const char *text) {
  char error[512] = "";
  shade_draft *d = shade_wif_parse(text, strlen(text), "cloth.wif", error, sizeof error);
  if (!d)
    print_message("%s\n", error);
  assert_int_equal(d == NULL, *error != 0);
  return d;
}

static void holds(const shade_draft *d, const char *matrix) {
  assert_non_null(d);
  const char *at = matrix;
  for (int j = 0; j < d->picks; j++, at++)
    for (int i = 0; i < d->ends; i++, at++)
      assert_int_equal(d->warp_up[j * d->ends + i], *at == 'X');
  assert_int_equal(at - matrix, strlen(matrix) + 1);
}

static void refused(const char *text, const char *message) {
  char error[512] = "";
  shade_draft *d = shade_wif_parse(text, strlen(text), "cloth.wif", error, sizeof error);
  if (d || strcmp(error, message))
    print_message("expected: %s\ngot:      %s\n", message, error);
  assert_null(d);
  assert_string_equal(error, message);
}

#define LOOM                                                                                       \
  "[WEAVING]\nShafts=4\nTreadles=4\nRising Shed=yes\n[WARP]\nThreads=4\n[WEFT]\nThreads=4\n"
#define STRAIGHT "[THREADING]\n1=1\n2=2\n3=3\n4=4\n"
#define TIED "[TIEUP]\n1=1,2\n2=2,3\n3=3,4\n4=1,4\n"
#define TROD "[TREADLING]\n1=1\n2=2\n3=3\n4=4\n"
#define TWILL "XX..\n.XX.\n..XX\nX..X"

static void plain_reading(void **state) {
  (void)state;
  shade_draft *d = parse(LOOM STRAIGHT TIED TROD);
  holds(d, TWILL);
  assert_true(d->warp[3].color[0] == 1 && d->warp[3].spacing == 0 && d->weft[0].thickness == 0);
  shade_draft_free(d);
  d = parse("[WEAVING]\nRising Shed=false\n" STRAIGHT TIED TROD); /* no Threads either */
  holds(d, "..XX\nX..X\nXX..\n.XX.");
  shade_draft_free(d);
  d = parse(STRAIGHT "[LIFTPLAN]\n1=1,2,3\n3=4\n");
  holds(d, "XXX.\n....\n...X");
  shade_draft_free(d);
  /* tie-up and treadling before a liftplan that says otherwise */
  d = parse(LOOM STRAIGHT TIED TROD "[LIFTPLAN]\n1=4\n2=4\n3=4\n4=4\n");
  holds(d, TWILL);
  shade_draft_free(d);
  /* several treadles, several shafts an end, an end and a pick without */
  d = parse("[THREADING]\n1=1\n2=2,3\n4=3\n" TIED "[TREADLING]\n1=1,3\n2=2,2,0\n4=4\n");
  holds(d, "XX.X\n.X.X\n....\nX...");
  shade_draft_free(d);
  d = parse("[WEAVING]\nRising Shed=0\n[THREADING]\n1=1\n2=2,3\n4=3\n[LIFTPLAN]\n1=1\n2=3\n3=\n");
  holds(d, ".X.X\nX...\nXX.X");
  shade_draft_free(d);
}

static void messy(void **state) {
  (void)state;
  /* any order, capitals, blanks, comments, all line ends, a mark of UTF-8, DOS's end of file */
  shade_draft *d =
      parse("\xef\xbb\xbf; a comment\r\nno section yet\r\n[ treadling ] ; here\r\n 1 = 1 \r\n"
            "2=\t2;second\r3=3\n\n4=+4\n[NOTES]\n1=anything [goes], even = and ;\nor nothing\n"
            "[Private Some Program 3]\nno=sense,at,all\nnor equals\n"
            "[threading]\n# odd\n4=4\n3=3\n2=2.0\n1=1,\n"
            "[TieUp]\n1= 1 , 2\n2=2,,3\n3=3,4,0\n4=4,1\n4=1,4\n"
            "[Weaving]\nRISING  SHED = On\nshafts=4;\nProfile=no\nTreadles=\n"
            "[WARP]\nTHREADS=4\nColor=2,0,0,255\nUnits=Inches\nSpacing=0,1\nThickness=\n"
            "[weft]\nthreads=4\ncolor=1\nunits=decipoints\nspacing=7.2\nthickness=3.6e0\n"
            "[Weft Colors]\n3=2\n9=1\n[warp thickness]\n2=.05\n[WARP SPACING]\n1=0\n"
            "[COLOR TABLE]\n2=999,0,111\n1=0,0,0\n[color palette]\nRange=0, 999\nForm=rgb\n"
            "Entries=2\n\x1a[NONSENSE\n");
  holds(d, TWILL);
  assert_true(d->warp[0].color[0] == 1 && d->warp[0].color[1] == 0 &&
              d->warp[0].color[2] == 111. / 999);
  assert_true(d->weft[0].color[0] == 0 && d->weft[2].color[0] == 1);
  assert_near(d->warp[1].spacing, .254, 1e-16);
  assert_true(d->warp[0].spacing == 0 && d->warp[0].thickness == 0);
  assert_near(d->warp[1].thickness, .127, 1e-16);
  assert_near(d->weft[3].spacing, .0254, 1e-16);
  assert_near(d->weft[3].thickness, .0127, 1e-16);
  shade_draft_free(d);

  /* UTF-16 of either order */
  const char *text = STRAIGHT TIED TROD;
  const size_t length = strlen(text);
  for (int big = 0; big < 2; big++) {
    char wide[1024] = {big ? '\xfe' : '\xff', big ? '\xff' : '\xfe'}, error[256] = "";
    for (size_t i = 0; i < length; i++)
      wide[2 + 2 * i + (size_t)big] = text[i];
    d = shade_wif_parse(wide, 2 + 2 * length, "wide.wif", error, sizeof error);
    assert_string_equal(error, "");
    holds(d, TWILL);
    shade_draft_free(d);
  }
}

static void refusals(void **state) {
  (void)state;
  refused("", "cloth.wif: no [THREADING]: expected the sections of a Weaving Information File");
  refused(STRAIGHT, "cloth.wif: expected [TIEUP] and [TREADLING], or [LIFTPLAN]");
  refused(STRAIGHT TIED, "cloth.wif: expected [TIEUP] and [TREADLING], or [LIFTPLAN]");
  refused("[WIF]\n\n[THREADING\n1=1\n",
          "cloth.wif, line 3: '[THREADING': expected ] after the section's name");
  refused("[THREADING]\n1=1\nend two on two\n",
          "cloth.wif, line 3: 'end two on two' in [THREADING]: expected key=value");
  refused("[THREADING]\n0=1\n",
          "cloth.wif, line 2: '0' in [THREADING]: expected a number of 1 to 16384 before the =");
  refused(
      "[THREADING]\r\n\r\n16385=1\r\n",
      "cloth.wif, line 3: '16385' in [THREADING]: expected a number of 1 to 16384 before the =");
  refused("[LIFTPLAN]\n1=1,x\n", "cloth.wif, line 2: 'x' in [LIFTPLAN]: expected whole numbers "
                                 "from 0 on, comma separated");
  refused("[LIFTPLAN]\n1=-1\n", "cloth.wif, line 2: '-1' in [LIFTPLAN]: expected whole numbers "
                                "from 0 on, comma separated");
  refused("[LIFTPLAN]\n1=99999999999999999999\n",
          "cloth.wif, line 2: '99999999999999999999' in [LIFTPLAN]: expected whole numbers from 0 "
          "on, comma separated");
  refused("[WARP]\nThreads=many\n",
          "cloth.wif, line 2: Threads=many: expected a whole number of 0 to 16384");
  refused("[WARP]\nUnits=ells\n",
          "cloth.wif, line 2: Units=ells: expected decipoints, inches or centimeters");
  refused("[WEFT]\nSpacing=-.1\n", "cloth.wif, line 2: Spacing=-.1: expected a length of 0 to 1e6");
  refused("[WEFT]\nThickness=nan\n",
          "cloth.wif, line 2: Thickness=nan: expected a length of 0 to 1e6");
  refused("[WEFT SPACING]\n3=1e99\n",
          "cloth.wif, line 2: '1e99' in [WEFT SPACING]: expected a length of 0 to 1e6");
  refused("[WEAVING]\nRising Shed=up\n", "cloth.wif, line 2: Rising Shed=up: expected yes or no");
  refused("[COLOR PALETTE]\nRange=255,0\n",
          "cloth.wif, line 2: Range=255,0: expected two whole numbers, the lower first");
  refused("[COLOR PALETTE]\nForm=CMYK\n", "cloth.wif, line 2: Form=CMYK: expected RGB");
  refused("[COLOR TABLE]\n1=0,0\n",
          "cloth.wif, line 2: colour 1: expected three numbers: red, green, blue");
  refused(LOOM STRAIGHT "5=1\n" TIED TROD,
          "cloth.wif, line 14: end 5 in [THREADING]: the file announces 4");
  refused(LOOM TIED TROD "[THREADING]\n1=5\n",
          "cloth.wif, line 20: shaft 5 in [THREADING]: expected at most 4");
  refused(LOOM STRAIGHT TIED "[TREADLING]\n2=5\n",
          "cloth.wif, line 20: treadle 5 in [TREADLING]: expected at most 4");
  refused(LOOM STRAIGHT "[LIFTPLAN]\n9=1\n",
          "cloth.wif, line 15: pick 9 in [LIFTPLAN]: the file announces 4");
  refused("[WARP]\nColor=3\n[COLOR TABLE]\n1=0,0,0\n" STRAIGHT TIED TROD,
          "cloth.wif, line 2: colour 3: not in [COLOR TABLE]");
  refused("[WEFT COLORS]\n2=1\n[COLOR TABLE]\n1=0,256,0\n" STRAIGHT TIED TROD,
          "cloth.wif, line 4: colour 1: 256 is not within Range=0,255");
  refused("[WARP]\nThreads=16384\n[WEFT]\nThreads=16384\n" STRAIGHT TIED TROD,
          "cloth.wif, line 2: 16384 ends x 16384 picks: expected at most 16777216 crossings");
  char error[256];
  assert_null(shade_wif_read("no/such/cloth.wif", error, sizeof error));
  assert_string_equal(error, "no/such/cloth.wif: No such file or directory");
  assert_null(shade_wif_read(".", error, sizeof error));
  assert_string_equal(error, ".: Is a directory");
}

static void returns_equal(const shade_draft *d) {
  char *text = shade_wif_text(d);
  assert_non_null(text);
  shade_draft *back = parse(text);
  assert_true(shade_draft_equal(d, back));
  shade_draft_free(back);
  free(text);
}

static void round_trip(void **state) {
  (void)state;
  const char *word;
  for (int row = 0; shade_weave_row(row, &word, NULL, NULL); row++) {
    shade_draft *d = shade_draft_named(word);
    returns_equal(d);
    shade_draft_free(d);
  }
  uint64_t seed = 5;
  const int ranges[] = {255, 65535, 999, 100, 12345};
  for (int turn = 0; turn < 60; turn++) {
    const int range = ranges[turn % 5];
    shade_draft *d =
        shade_draft_create(1 + (int)(uniform(&seed) * 90), 1 + (int)(uniform(&seed) * 90));
    const double density = turn % 7 ? uniform(&seed) : turn % 2;
    for (int i = 0; i < d->ends * d->picks; i++)
      d->warp_up[i] = uniform(&seed) < density;
    for (int i = 0; i < d->ends + d->picks; i++) {
      shade_thread *t = i < d->ends ? &d->warp[i] : &d->weft[i - d->ends];
      for (int c = 0; c < 3 && turn % 3; c++)
        t->color[c] = floor(uniform(&seed) * (range + 1)) / range;
      if (turn % 4 == 1)
        t->spacing = uniform(&seed) < .3 ? 0 : uniform(&seed);
      if (turn % 4 >= 1)
        t->thickness = 2.54 * uniform(&seed);
    }
    returns_equal(d);
    shade_draft_free(d);
  }
  /* what no table of whole numbers holds exactly comes back rounded */
  shade_draft *d = shade_draft_create(1, 1);
  d->warp[0].color[0] = sqrt(.5);
  d->warp[0].color[1] = NAN;
  d->warp[0].spacing = -1;
  char *text = shade_wif_text(d);
  shade_draft *back = parse(text);
  assert_near(back->warp[0].color[0], sqrt(.5), .5 / 16777215);
  assert_true(back->warp[0].color[1] == 0 && back->warp[0].spacing == 0);
  shade_draft_free(back);
  shade_draft_free(d);
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(plain_reading),
      cmocka_unit_test(messy),
      cmocka_unit_test(refusals),
      cmocka_unit_test(round_trip),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
