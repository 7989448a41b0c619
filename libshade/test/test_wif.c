/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.1 */
/* Weaving Information Files: what is read, what is refused and where, and the way back. */
#define _POSIX_C_SOURCE 200809L
#include <string.h>

#include "shade/weave.h"
#include "support.h"
#include "test/posix.h"

/* What is read with exactly this warning; "" is none. */
static shade_draft *parse_warned(const char *text, const char *warning) {
  char message[2048] = "unset";
  shade_draft *d = shade_wif_parse(text, strlen(text), "cloth.wif", message, sizeof message);
  if (!d || strcmp(message, warning))
    print_message("expected: %s\ngot:      %s\n", warning, message);
  assert_non_null(d);
  assert_string_equal(message, warning);
  return d;
}

static shade_draft *parse(const char *text) {
  return parse_warned(text, "");
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
  d = parse_warned(LOOM STRAIGHT TIED TROD "[LIFTPLAN]\n1=4\n2=4\n3=4\n4=4\n",
                   "cloth.wif: mended: line 24: [LIFTPLAN] says otherwise than [TREADLING]: left "
                   "out");
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
  shade_draft *d = parse_warned(
      "\xef\xbb\xbf; a comment\r\nno section yet\r\n[ treadling ] ; here\r\n 1 = 1 \r\n"
      "2=\t2;second\r3=3\n\n4=+4\n[NOTES]\n1=anything [goes], even = and ;\nor nothing\n"
      "[Private Some Program 3]\nno=sense,at,all\nnor equals\n"
      "[threading]\n# odd\n4=4\n3=3\n2=2.0\n1=1,\n"
      "[TieUp]\n1= 1 , 2\n2=2,,3\n3=3,4,0\n4=4,1\n4=1,4\n"
      "[Weaving]\nRISING  SHED = On\nshafts=4;\nProfile=no\nTreadles=\n"
      "[WARP]\nTHREADS=4\nColor=2,0,0,255\nUnits=Inches\nSpacing=0,1\nThickness=\n"
      "[weft]\nthreads=4\ncolor=1\nunits=decipoints\nspacing=7.2\nthickness=3.6e0\n"
      "[Weft Colors]\n3=2\n9=1\n[warp thickness]\n2=.05\n[WARP SPACING]\n1=0\n"
      "[COLOR TABLE]\n2=999,0,111\n1=0,0,0\n[color palette]\nRange=0, 999\nForm=rgb\n"
      "Entries=2\n\x1a[NONSENSE\n",
      "cloth.wif: mended: line 26: row 4 of [TIEUP] once more: the last holds; "
      "line 46: row 9 of [WEFT COLORS], where there are 4: left out");
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
  refused("[THREADING]\n0=1\n", "cloth.wif: expected [TIEUP] and [TREADLING], or [LIFTPLAN]");
  refused("[THREADING]\n-1=1\n",
          "cloth.wif, line 2: '-1' in [THREADING]: expected a number of 1 to 16384 before the =");
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
  refused("[WARP]\nUnits=ells\nSpacing=1\n" STRAIGHT TIED TROD,
          "cloth.wif, line 2: Units=ells: expected decipoints, inches or centimeters");
  refused("[WEFT]\nSpacing=-.1\n", "cloth.wif, line 2: Spacing=-.1: expected a length of 0 to 1e6");
  refused("[WEFT]\nThickness=nan\n",
          "cloth.wif, line 2: Thickness=nan: expected a length of 0 to 1e6");
  refused("[WEFT SPACING]\n3=1e99\n",
          "cloth.wif, line 2: '1e99' in [WEFT SPACING]: expected a length of 0 to 1e6");
  refused("[WEAVING]\nRising Shed=up\n", "cloth.wif, line 2: Rising Shed=up: expected yes or no");
  refused("[COLOR PALETTE]\nRange=255,0\n",
          "cloth.wif, line 2: Range=255,0: expected two whole numbers, the lower first");
  refused(LOOM STRAIGHT TIED "[TREADLING]\n2=16385\n",
          "cloth.wif, line 20: treadle 16385 in [TREADLING]: expected at most 16384");
  refused("[THREADING]\n1=16385\n[LIFTPLAN]\n1=1\n",
          "cloth.wif, line 2: shaft 16385 in [THREADING]: expected at most 16384");
  refused("[COLOR PALETTE]\nRange=0,1,2\n",
          "cloth.wif, line 2: Range=0,1,2: expected two whole numbers, the lower first");
  refused("[COLOR PALETTE]\nRange=255 bits\n",
          "cloth.wif, line 2: Range=255 bits: expected two whole numbers, the lower first");
  refused("[WARP]\nSpacing=2 ells\n",
          "cloth.wif, line 2: Spacing=2 ells: expected a length of 0 to 1e6");
  refused(TIED TROD,
          "cloth.wif: no [THREADING]: expected the sections of a Weaving Information File");
  refused("[WARP]\nThreads=16384\n[WEFT]\nThreads=16384\n" STRAIGHT TIED TROD,
          "cloth.wif, line 2: 16384 ends x 16384 picks: expected at most 16777216 crossings");
  char error[256];
  assert_null(shade_wif_read("no/such/cloth.wif", error, sizeof error));
  assert_string_equal(error, "no/such/cloth.wif: No such file or directory");
  const int file = next_file();
  assert_null(shade_wif_read(".", error, sizeof error));
  assert_string_equal(error, ".: Is a directory");
  assert_int_equal(next_file(), file);
}

/* Where the file disagrees with itself about how many there are, what is listed decides of shafts
 * and treadles, what is announced of ends and picks. */
static void wrong_counts(void **state) {
  (void)state;
  shade_draft *d =
      parse_warned("[WEAVING]\nShafts=4\nTreadles=4\n" STRAIGHT TIED "5=1,3\n6=2,4\n" TROD,
                   "cloth.wif: mended: line 9: [TIEUP] has 6 treadles, the file announces 4");
  holds(d, TWILL);
  shade_draft_free(d);
  /* and the fifth is pressed */
  d = parse_warned("[WEAVING]\nShafts=4\nTreadles=4\n" STRAIGHT TIED "5=1,3\n" TROD "5=5\n",
                   "cloth.wif: mended: line 9: [TIEUP] has 5 treadles, the file announces 4");
  holds(d, TWILL "\nX.X.");
  shade_draft_free(d);
  d = parse_warned(LOOM STRAIGHT "5=1\n6=2\n" TIED TROD,
                   "cloth.wif: mended: line 14: row 5 of [THREADING], where there are 4: left out "
                   "(and 1 more)");
  holds(d, TWILL);
  shade_draft_free(d);
  d = parse_warned(LOOM STRAIGHT "[LIFTPLAN]\n1=1\n9=2\n",
                   "cloth.wif: mended: line 16: row 9 of [LIFTPLAN], where there are 4: left out");
  holds(d, "X...\n....\n....\n....");
  shade_draft_free(d);
  d = parse_warned(LOOM TIED TROD "[THREADING]\n1=1\n2=2\n3=3\n4=5\n",
                   "cloth.wif: mended: line 23: shaft 5 in [THREADING], the file announces 4: "
                   "read as it is");
  holds(d, "XX..\n.XX.\n..X.\nX...");
  shade_draft_free(d);
  d = parse_warned(LOOM STRAIGHT TIED "[TREADLING]\n1=1\n2=5,2\n3=3\n4=6\n",
                   "cloth.wif: mended: line 21: treadle 5 in [TREADLING] is not in [TIEUP]: lifts "
                   "nothing (and 1 more)");
  holds(d, "XX..\n.XX.\n..XX\n....");
  shade_draft_free(d);
  d = parse_warned("[WARP]\nThreads=6\n" STRAIGHT TIED TROD,
                   "cloth.wif: mended: line 2: Threads=6, but [THREADING] ends with 4: the others "
                   "have no shaft");
  holds(d, "XX....\n.XX...\n..XX..\nX..X..");
  shade_draft_free(d);
  d = parse_warned("[WEFT]\nThreads=5\n[WEAVING]\nRising Shed=no\n" STRAIGHT TIED TROD,
                   "cloth.wif: mended: line 2: Threads=5, but [TREADLING] ends with 4: the others "
                   "lift nothing");
  holds(d, "..XX\nX..X\nXX..\n.XX.\nXXXX");
  shade_draft_free(d);
  /* picks at a liftplan's end may lift nothing; counts of 0 and none at all announce nothing */
  d = parse("[WEFT]\nThreads=3\n" STRAIGHT "[LIFTPLAN]\n1=1\n2=2,3\n");
  holds(d, "X...\n.XX.\n....");
  shade_draft_free(d);
  d = parse("[WEAVING]\nShafts=0\nTreadles=0\n[WARP]\nThreads=0\n" STRAIGHT TIED TROD);
  holds(d, TWILL);
  shade_draft_free(d);
}

#define KEYS_0 "0=1\n1=2\n2=3\n3=4\n"
static void counting_from_0(void **state) {
  (void)state;
  /* keys alone, of some sections */
  shade_draft *d =
      parse_warned(LOOM "[THREADING]\n" KEYS_0 TIED "[TREADLING]\n" KEYS_0,
                   "cloth.wif: mended: line 10: [THREADING] counts from 0 (and 1 more)");
  holds(d, TWILL);
  shade_draft_free(d);
  d = parse_warned("[THREADING]\n" KEYS_0 TIED TROD,
                   "cloth.wif: mended: line 2: [THREADING] counts from 0");
  holds(d, TWILL);
  shade_draft_free(d);
  /* everything: ends, picks, shafts, treadles, colours */
  d = parse_warned(
      LOOM "[THREADING]\n0=0\n1=1\n2=2\n3=3\n[TIEUP]\n0=0,1\n1=1,2\n2=2,3\n3=0,3\n"
           "[TREADLING]\n0=0\n1=1\n2=2\n3=3\n[COLOR TABLE]\n0=255,0,0\n1=0,255,0\n2=0,0,255\n"
           "[WARP COLORS]\n0=0\n1=1\n2=2\n3=1\n[WARP SPACING]\n0=2\n3=3\n",
      "cloth.wif: mended: line 9: shafts count from 0; "
      "line 10: [THREADING] counts from 0 (and 5 more); line 19: treadles count from 0");
  holds(d, TWILL);
  assert_true(d->warp[0].color[0] == 1 && d->warp[0].color[1] == 0);
  assert_true(d->warp[1].color[1] == 1 && d->warp[2].color[2] == 1 && d->warp[3].color[1] == 1);
  assert_true(d->warp[0].spacing == 2 && d->warp[1].spacing == 0 && d->warp[3].spacing == 3);
  shade_draft_free(d);
  /* shafts alone: 0 is threaded, lifted beside others, and 4 of 4 is not there */
  d = parse_warned(LOOM
                   "[THREADING]\n1=0\n2=1\n3=2\n4=3\n[TIEUP]\n1=0,1\n2=1,2\n3=2,3\n4=0,3\n" TROD,
                   "cloth.wif: mended: line 9: shafts count from 0");
  holds(d, TWILL);
  shade_draft_free(d);
  /* the same with 4 in use: shaft 0 is none */
  d = parse(LOOM "[THREADING]\n1=0\n2=1\n3=2\n4=4\n[TIEUP]\n1=0,1\n2=1,2\n3=2,4\n4=0,4\n" TROD);
  holds(d, ".X..\n.XX.\n..XX\n...X");
  shade_draft_free(d);
  /* an empty heddle, an empty treadle and a shaft without ends are no such thing */
  d = parse(LOOM "[THREADING]\n1=0\n2=1\n3=2\n4=3\n[TIEUP]\n1=0\n2=1,2\n3=2,3\n4=3\n" TROD);
  holds(d, "....\n.XX.\n..XX\n...X");
  shade_draft_free(d);
  d = parse("[WEAVING]\nShafts=9\n[THREADING]\n1=0\n2=1\n3=2\n4=3\n"
            "[TIEUP]\n1=0,1\n2=1,2\n3=2,3\n4=0,3\n" TROD);
  holds(d, ".X..\n.XX.\n..XX\n...X");
  shade_draft_free(d);
  /* the tie-up's rows from 0 where treadles are counted from 1 */
  d = parse_warned(STRAIGHT "[TIEUP]\n0=1,2\n1=2,3\n2=3,4\n3=1,4\n" TROD,
                   "cloth.wif: mended: line 7: [TIEUP] counts from 0");
  holds(d, TWILL);
  shade_draft_free(d);
  /* a row 0 too many */
  d = parse_warned(LOOM "[THREADING]\n0=3\n1=1\n2=2\n3=3\n4=4\n" TIED TROD,
                   "cloth.wif: mended: line 10: row 0 of [THREADING], which counts from 1: left "
                   "out");
  holds(d, TWILL);
  shade_draft_free(d);
  /* each hook its own end, from 0 */
  d = parse_warned("[WEAVING]\nShafts=3\n[LIFTPLAN]\n0=0,1\n1=1,2\n2=2\n",
                   "cloth.wif: mended: no [THREADING]: end n is on shaft n; shafts count from 0; "
                   "line 4: [LIFTPLAN] counts from 0");
  holds(d, "XX.\n.XX\n..X");
  shade_draft_free(d);
  /* colours of yarns from 0, the table from 1 */
  d = parse_warned(
      "[WARP]\nColor=0\n[WEFT]\nColor=1\n[COLOR TABLE]\n1=255,0,0\n2=0,255,0\n" STRAIGHT TIED TROD,
      "cloth.wif: mended: line 5: the colours of yarns count from 0");
  assert_true(d->warp[0].color[0] == 1 && d->weft[0].color[1] == 1 && d->weft[0].color[0] == 0);
  shade_draft_free(d);
  d = parse_warned("[WARP COLORS]\n1=0\n[WEFT COLORS]\n1=1\n2=0\n"
                   "[COLOR TABLE]\n1=255,0,0\n2=0,255,0\n" STRAIGHT TIED TROD,
                   "cloth.wif: mended: line 6: the colours of yarns count from 0");
  assert_true(d->warp[0].color[1] == 0 && d->weft[0].color[0] == 0 && d->weft[1].color[1] == 0);
  shade_draft_free(d);
  /* colour 0 is none where the table has more */
  d = parse("[WARP]\nColor=0\n[WEFT]\nColor=1\n[COLOR TABLE]\n1=255,0,0\n2=0,255,0\n"
            "3=0,0,255\n" STRAIGHT TIED TROD);
  assert_true(d->warp[0].color[1] == 1 && d->warp[0].color[2] == 1 && d->weft[0].color[1] == 0);
  shade_draft_free(d);
  /* a colour that is not all there beside its number is none, as where there is no table */
  d = parse("[WARP]\nColor=1,10,20\n[WEFT]\nColor=2,10\n" STRAIGHT TIED TROD);
  for (int c = 0; c < 3; c++)
    assert_true(d->warp[0].color[c] == 1 && d->weft[0].color[c] == 1);
  shade_draft_free(d);
  /* the table from 0, those of yarns from 1 */
  d = parse_warned(
      "[WARP]\nColor=1\n[WEFT]\nColor=2\n[COLOR TABLE]\n0=255,0,0\n1=0,255,0\n" STRAIGHT TIED TROD,
      "cloth.wif: mended: line 6: [COLOR TABLE] counts from 0");
  assert_true(d->warp[0].color[0] == 1 && d->weft[0].color[1] == 1 && d->weft[0].color[0] == 0);
  shade_draft_free(d);
}

static void plans(void **state) {
  (void)state;
  shade_draft *d =
      parse_warned(STRAIGHT TROD, "cloth.wif: mended: no [TIEUP]: treadle n lifts shaft n");
  holds(d, "X...\n.X..\n..X.\n...X");
  shade_draft_free(d);
  d = parse_warned("[WARP]\nThreads=3\n[LIFTPLAN]\n1=1,3\n2=2\n",
                   "cloth.wif: mended: no [THREADING]: end n is on shaft n");
  holds(d, "X.X\n.X.");
  shade_draft_free(d);
  d = parse_warned("[LIFTPLAN]\n1=2\n2=0\n",
                   "cloth.wif: mended: no [THREADING]: end n is on shaft n");
  holds(d, ".X\n..");
  shade_draft_free(d);
  /* both, and they agree: the whole file is right */
#define LIFTED "[LIFTPLAN]\n1=1,2\n2=2,3\n3=3,4\n4=4,1\n"
  d = parse(LOOM STRAIGHT TIED TROD LIFTED);
  holds(d, TWILL);
  shade_draft_free(d);
  /* what is wrong in the one that is not used is not worth a word */
  d = parse(LOOM STRAIGHT TIED TROD LIFTED "4=1,4\n9=1\n");
  holds(d, TWILL);
  shade_draft_free(d);
  /* they do not: the contents may say which one the file means */
#define OTHERWISE "[LIFTPLAN]\n1=1\n2=2\n3=3\n4=4\n"
  d = parse_warned("[CONTENTS]\nTIEUP=false\nLIFTPLAN=true\n" STRAIGHT TIED TROD OTHERWISE,
                   "cloth.wif: mended: line 2: [CONTENTS] denies [TIEUP]: read all the same; "
                   "line 14: [TREADLING] says otherwise than [LIFTPLAN]: left out");
  holds(d, "X...\n.X..\n..X.\n...X");
  shade_draft_free(d);
  d = parse_warned("[CONTENTS]\nLIFTPLAN=0\n" STRAIGHT OTHERWISE TIED TROD,
                   "cloth.wif: mended: line 2: [CONTENTS] denies [LIFTPLAN]: read all the same; "
                   "line 8: [LIFTPLAN] says otherwise than [TREADLING]: left out");
  holds(d, TWILL);
  shade_draft_free(d);
  /* half a tie-up is no plan beside a liftplan */
  d = parse(LOOM STRAIGHT TIED LIFTED);
  holds(d, TWILL);
  shade_draft_free(d);
}

static void contents(void **state) {
  (void)state;
  shade_draft *d = parse_warned(
      "[Contents]\nThreading=no\nTIEUP = off\nTREADLING=true\nWARP SPACING=yes\nWEFT COLORS=1\n"
      "PRIVATE THING=true\nnothing\nCOLOR TABLE=perhaps\n" STRAIGHT TIED TROD "[WARP SPACING]\n",
      "cloth.wif: mended: line 2: [CONTENTS] denies [THREADING]: read all the same (and 2 more)");
  holds(d, TWILL);
  shade_draft_free(d);
  d = parse_warned(
      "[CONTENTS]\nWEFT COLORS=true\nTHREADING=on\nTIEUP=T\nTREADLING=Y\n" STRAIGHT TIED TROD,
      "cloth.wif: mended: line 2: [CONTENTS] announces [WEFT COLORS]: not there");
  shade_draft_free(d);
}

static void has_color(const double c[3], double r, double g, double b) {
  assert_near(c[0], r, 1e-15);
  assert_near(c[1], g, 1e-15);
  assert_near(c[2], b, 1e-15);
}

#define CLOTH STRAIGHT TIED TROD
static void colors(void **state) {
  (void)state;
  /* a low end that is not 0, an end that is */
  shade_draft *d =
      parse("[COLOR PALETTE]\nRange=100,500\n[COLOR TABLE]\n1=100,300,500\n2=200,100,110\n"
            "[WARP]\nColor=1\n[WEFT]\nColor=2\n" CLOTH);
  has_color(d->warp[0].color, 0, .5, 1);
  has_color(d->weft[0].color, .25, 0, .025);
  shade_draft_free(d);
  d = parse("[COLOR PALETTE]\nRange=999\nForm=RGB\n[COLOR TABLE]\n1=999,0,333;red\n2=1 2 3,blue\n"
            "[WARP]\nColor=1\n[WEFT]\nColor=2\n" CLOTH);
  has_color(d->warp[0].color, 1, 0, 1. / 3);
  has_color(d->weft[0].color, 1. / 999, 2. / 999, 3. / 999);
  shade_draft_free(d);
  /* inks: (1 - cyan) (1 - black), … */
  d = parse("[COLOR PALETTE]\nForm=CMYK\nRange=0,100\n[COLOR TABLE]\n1=20,0,100,50\n2=0,0,0,0\n"
            "[WARP]\nColor=1\n[WEFT]\nColor=2\n" CLOTH);
  has_color(d->warp[0].color, .4, .5, 0);
  has_color(d->weft[0].color, 1, 1, 1);
  shade_draft_free(d);
  d = parse_warned("[COLOR TABLE]\n1=20,0,100,50\n2=10,100,0\n[COLOR PALETTE]\nForm=cmyk\n"
                   "[WARP]\nColor=1\n[WEFT]\nColor=2\n" CLOTH,
                   "cloth.wif: mended: line 1: [COLOR TABLE] has 100, and there is no Range: taken "
                   "as Range=0,100; line 3: colour 2 has 3 numbers, expected 4: no black");
  has_color(d->warp[0].color, .4, .5, 0);
  has_color(d->weft[0].color, .9, 0, 1);
  shade_draft_free(d);
  d = parse_warned("[COLOR PALETTE]\nForm=Lab\n[COLOR TABLE]\n1=20,0,100\n[WARP]\nColor=1\n" CLOTH,
                   "cloth.wif: mended: line 2: Form=Lab, neither RGB nor CMYK: colours left out");
  has_color(d->warp[0].color, 1, 1, 1);
  shade_draft_free(d);
  d = parse_warned("[COLOR TABLE]\n1=51,0,102,255\n[WARP]\nColor=1\n" CLOTH,
                   "cloth.wif: mended: line 2: colour 1 has 4 numbers, expected 3: the others left "
                   "out");
  has_color(d->warp[0].color, .2, 0, .4);
  shade_draft_free(d);
  /* which is nothing to guess a Range by; inks beyond 100 are of 255 */
  d = parse_warned("[COLOR TABLE]\n1=51,0,102,900\n[WARP]\nColor=1\n" CLOTH,
                   "cloth.wif: mended: line 2: colour 1 has 4 numbers, expected 3: the others left "
                   "out");
  has_color(d->warp[0].color, .2, 0, .4);
  shade_draft_free(d);
  d = parse("[COLOR PALETTE]\nForm=CMYK\n[COLOR TABLE]\n1=0,51,0,101\n[WARP]\nColor=1\n" CLOTH);
  has_color(d->warp[0].color, 1 - 101. / 255, .8 * (1 - 101. / 255), 1 - 101. / 255);
  shade_draft_free(d);
  /* of dark ones, too */
  d = parse("[COLOR TABLE]\n1=51,0,100\n[WARP]\nColor=1\n" CLOTH);
  has_color(d->warp[0].color, .2, 0, 100. / 255);
  shade_draft_free(d);
  /* no Range: by the largest number */
  static const struct {
    int largest, range;
  } guesses[] = {{256, 999}, {999, 999}, {1000, 65535}, {65535, 65535}, {70000, 70000}};
  for (int k = 0; k < 5; k++) {
    char text[512], warning[256];
    snprintf(text, sizeof text, "[COLOR TABLE]\n1=%d,0,9\n[WEFT]\nColor=1\n" CLOTH,
             guesses[k].largest);
    snprintf(warning, sizeof warning,
             "cloth.wif: mended: line 1: [COLOR TABLE] has %d, and there is no Range: taken as "
             "Range=0,%d",
             guesses[k].largest, guesses[k].range);
    d = parse_warned(text, warning);
    has_color(d->weft[0].color, (double)guesses[k].largest / guesses[k].range, 0,
              9. / guesses[k].range);
    shade_draft_free(d);
  }
  /* what leaves its Range is its end */
  d = parse_warned(
      "[WEFT COLORS]\n2=1\n[COLOR TABLE]\n1=0,256,9\n[COLOR PALETTE]\nRange=10,255\n" CLOTH,
      "cloth.wif: mended: line 4: colour 1: 0 is not within Range=10,255: taken as 10 "
      "(and 2 more)");
  has_color(d->weft[1].color, 0, 1, 0);
  has_color(d->weft[0].color, 1, 1, 1);
  shade_draft_free(d);
  /* not in the table: the section's colour, or white; no table: white */
  d = parse_warned("[WARP]\nColor=3\n[WEFT]\nColor=1\n[WEFT COLORS]\n2=7\n3=2\n"
                   "[COLOR TABLE]\n1=255,0,0\n2=0,0,0\n" CLOTH,
                   "cloth.wif: mended: line 2: colour 3 is not in [COLOR TABLE]: the default "
                   "(and 1 more)");
  has_color(d->warp[0].color, 1, 1, 1);
  has_color(d->weft[1].color, 1, 0, 0);
  has_color(d->weft[2].color, 0, 0, 0);
  shade_draft_free(d);
  d = parse("[WARP]\nColor=3\n[WEFT]\n" CLOTH);
  has_color(d->warp[0].color, 1, 1, 1);
  shade_draft_free(d);
  /* version 1.0 has the colour beside its number; the table goes before it */
  d = parse(
      "[WARP]\nColor=1,255,0,51\n[WEFT]\nColor=2,0,0,0\n[WEFT COLORS]\n2=1,9,9,9\n3=4,0,255,0\n"
      "[COLOR TABLE]\n1=0,0,255\n2=255,255,0\n" CLOTH);
  has_color(d->warp[0].color, 0, 0, 1);
  has_color(d->weft[0].color, 1, 1, 0);
  has_color(d->weft[1].color, 0, 0, 1);
  has_color(d->weft[2].color, 0, 1, 0);
  shade_draft_free(d);
  d = parse_warned("[COLOR TABLE]\n1=0,0,255\n[WEFT COLORS]\n2=9,255,0\n3=9,0,0,255\n" CLOTH,
                   "cloth.wif: mended: line 4: colour 9 is not in [COLOR TABLE]: the default");
  has_color(d->weft[1].color, 1, 1, 1);
  has_color(d->weft[2].color, 0, 0, 1);
  shade_draft_free(d);
  /* rows that are no colours: what can be told is taken, the others are left out */
  d = parse_warned(
      "[COLOR PALETTE]\nEntries=4\nRange=0,999\n[COLOR TABLE]\n1=#C83232\n2=\"#0f0\" ; "
      "green\n3=1,2\n"
      "4=red\nblue=0,0,999\nno row\n5=#12345g\n6=0,999,0 "
      "#c83232\n[WARP]\nColor=1\n[WEFT]\nColor=3\n"
      "[WEFT COLORS]\n2=2\n3=6\n" CLOTH,
      "cloth.wif: mended: line 2: Entries=4, but [COLOR TABLE] has 3; line 5: colour 1 is #C83232: "
      "taken as 200,50,50 of 255 (and 1 more); line 7: colour 3 is '1,2', not three numbers, red, "
      "green and blue: left out (and 4 more); line 16: colour 3 is not in [COLOR TABLE]: the "
      "default");
  has_color(d->warp[0].color, 200. / 255, 50. / 255, 50. / 255);
  has_color(d->weft[0].color, 1, 1, 1);
  has_color(d->weft[1].color, 0, 1, 0);
  has_color(d->weft[2].color, 0, 1, 0);
  shade_draft_free(d);
  d = parse("[WARP]\nColor=1,255,0,51\n[WEFT COLORS]\n3=4,0,255,0\n" CLOTH);
  has_color(d->warp[0].color, 1, 0, .2);
  has_color(d->weft[2].color, 0, 1, 0);
  shade_draft_free(d);
}

/* Ways of writing what the format writes in one. */
static void spellings(void **state) {
  (void)state;
  /* CR alone; non-breaking blanks of Latin-1 and UTF-8; quotation marks; blanks for commas */
  shade_draft *d = parse("[Threading]\r1\xa0=\xa0"
                         "1\r2 = \xc2\xa0"
                         "2\r3=\"3\"\r4=4 # last\r[TIE-UP]\r1=1 2\r2=2\t3\r"
                         "3=3 , 4\r4=,1,4,\r[Treadling]\r001=1\r2=2.\r3=3\r4=4\r");
  holds(d, TWILL);
  shade_draft_free(d);
  /* words for yes and no, of which -1 is Visual Basic's true */
  static const char *const yes[] = {"true", "ON", "Yes", "1", "y", "T", "-1", "\"true\""};
  static const char *const no[] = {"FALSE", "off", "no", "0", "N", "f"};
  for (int k = 0; k < 8; k++) {
    char text[512];
    snprintf(text, sizeof text, "[weaving]\nRising Shed = %s\n" CLOTH, yes[k]);
    d = parse(text);
    holds(d, TWILL);
    shade_draft_free(d);
    snprintf(text, sizeof text, "[weaving]\nrising_shed=%s ; so\n" CLOTH, no[k % 6]);
    d = parse(text);
    holds(d, "..XX\nX..X\nXX..\n.XX.");
    shade_draft_free(d);
  }
  /* COLOUR, lengths with their own units; a Latin-1 name; text that looks like a section */
  d = parse("[TEXT]\nTitle=Gr\xfcner K\xf6per\n[Note that this does not close\n"
            "[WARP]\nColour=2\nUnits=mm\nSpacing=2\nThickness=.1 "
            "in\n[WEFT]\nThickness=3mm\nSpacing=\"1\"\"\n"
            "[WARP THICKNESS]\n2=2\n3=1 cm\n[Colour Table]\n2=0,255,0\n" CLOTH);
  has_color(d->warp[0].color, 0, 1, 0);
  assert_near(d->warp[0].spacing, .2, 1e-16);
  assert_near(d->warp[0].thickness, .254, 1e-16);
  assert_near(d->warp[1].thickness, .2, 1e-16);
  assert_near(d->warp[2].thickness, 1, 1e-16);
  assert_near(d->weft[0].thickness, .3, 1e-15);
  assert_near(d->weft[0].spacing, 2.54, 1e-16);
  shade_draft_free(d);
  d = parse_warned("[WARP]\nUnits=EPI\n[WEFT]\nUnits=Sett\n[THREADING]\n1=1\n2\n[LIFTPLAN]\n1=1\n"
                   "[THREADING]\n3=1\n[LIFTPLAN]\n2=0\n",
                   "cloth.wif: mended: line 2: Units=EPI, of no length: passed over (and 1 more); "
                   "line 7: '2' in [THREADING] without =: an empty row; "
                   "line 10: [THREADING] once more: read as one (and 1 more)");
  holds(d, "X.X\n...");
  shade_draft_free(d);
  /* the same row twice is no matter if it says the same */
  d = parse_warned("[THREADING]\n1=1\n1=1\n2=2\n2=1\n[LIFTPLAN]\n1=1\n",
                   "cloth.wif: mended: line 5: row 2 of [THREADING] once more: the last holds");
  holds(d, "XX");
  shade_draft_free(d);
  /* UTF-16 without its mark */
  const char *text = CLOTH;
  const size_t length = strlen(text);
  for (int big = 0; big < 2; big++) {
    char wide[1024] = "", message[256];
    for (size_t i = 0; i < length; i++)
      wide[2 * i + (size_t)big] = text[i];
    d = shade_wif_parse(wide, 2 * length, "wide.wif", message, sizeof message);
    assert_string_equal(message, "");
    holds(d, TWILL);
    shade_draft_free(d);
  }
}

/* UTF-16 beyond ASCII: characters whose half is a line's end, a bracket or a digit are none of
 * these, a blank that does not break is a blank; what is shown of such words, and of long ones. */
static void wide_words(void **state) {
  (void)state;
  static const struct {
    unsigned code; /* what stands for ~ */
    const char *text, *message;
  } cases[] = {
      {0x010a, "[TEXT]\nTitle=~[~]~3=9\n" CLOTH, ""},
      {0x015d, "[TEXT]\n[~\n" CLOTH, ""},
      {0x00a0, "[~THREADING~]\n1~=~1\n2=2~\n3=3\n~4=4\n" TIED TROD, ""},
      {0x0131, "[THREADING]\n1=~\n",
       "wide.wif, line 2: '?' in [THREADING]: expected whole numbers from 0 on, comma separated"},
      {0x00e9, "[WEAVING]\nRising Shed=oui, tous les cadres l~vent ensemble, oui\n",
       "wide.wif, line 2: Rising Shed=oui, tous les cadres l?vent ensemble, ou...: expected yes or "
       "no"},
      {0x00e9, "[WEAVING]\nRising Shed=forty of them, no more: are shown whole~\n",
       "wide.wif, line 2: Rising Shed=forty of them, no more: are shown whole?: expected yes or "
       "no"},
  };
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++)
    for (int big = 0; big < 2; big++) {
      char wide[1024] = {big ? '\xfe' : '\xff', big ? '\xff' : '\xfe'}, message[256] = "";
      const size_t length = strlen(cases[k].text);
      for (size_t i = 0; i < length; i++) {
        const unsigned code =
            cases[k].text[i] == '~' ? cases[k].code : (unsigned char)cases[k].text[i];
        wide[2 + 2 * i + (size_t)big] = (char)(code & 255);
        wide[2 + 2 * i + (size_t)!big] = (char)(code >> 8);
      }
      shade_draft *d = shade_wif_parse(wide, 2 + 2 * length, "wide.wif", message, sizeof message);
      assert_string_equal(message, cases[k].message);
      if (*message)
        assert_null(d);
      else
        holds(d, TWILL);
      shade_draft_free(d);
    }
}

/* A message that is too long is cut; without a place for it nothing is written. */
static void short_messages(void **state) {
  (void)state;
  const char *text = LOOM STRAIGHT "5=1\n" TIED "5=1\n" TROD;
  char whole[512], part[512];
  shade_draft_free(shade_wif_parse(text, strlen(text), "c.wif", whole, sizeof whole));
  const size_t length = strlen(whole);
  assert_true(length > 100 && length < sizeof whole);
  for (size_t n = 0; n <= length + 1; n++) {
    memset(part, '~', sizeof part);
    shade_draft *d = shade_wif_parse(text, strlen(text), "c.wif", n ? part : NULL, n);
    assert_non_null(d);
    shade_draft_free(d);
    assert_true(part[n] == '~');
    if (n) {
      assert_int_equal(strlen(part), n - 1);
      assert_memory_equal(part, whole, n - 1);
    }
  }
}

/* As many lines as a draft can hold, and colours that no yarn has. */
static void long_files(void **state) {
  (void)state;
  const int side = SHADE_DRAFT_MAX_SIDE;
  char *text = malloc((size_t)side * 64), *at = text;
  assert_non_null(text);
  at += sprintf(at, "[LIFTPLAN]\n1=1\n[THREADING]\n");
  for (int i = 1; i <= side; i++)
    at += sprintf(at, "%d=%d ; end\n", i, i % 3);
  at += sprintf(at, "[COLOR TABLE]\n");
  for (int i = 1; i <= side; i++)
    at += sprintf(at, "%d=%d,0,0\n", i, i % 256);
  at += sprintf(at, "[WARP COLORS]\n");
  for (int i = 1; i <= side; i++)
    at += sprintf(at, "%d=%d\n", i, side + 1 - i);
  shade_draft *d = parse(text);
  assert_int_equal(d->ends, side);
  for (int i = 0; i < side; i++) {
    assert_int_equal(d->warp_up[i], (i + 1) % 3 == 1);
    assert_true(d->warp[i].color[0] == (side - i) % 256 / 255.);
  }
  shade_draft_free(d);
  free(text);
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

/* Centimetres of a unit's each spelling, for lengths with one of their own and without. */
static void units(void **state) {
  static const struct {
    const char *word;
    double cm;
  } said[] = {{"centimeters", 1},
              {"Centimetres", 1},
              {"centimeter", 1},
              {"CENTIMETRE", 1},
              {"cm", 1},
              {"inches", 2.54},
              {"Inch", 2.54},
              {"in", 2.54},
              {"millimeters", .1},
              {"Millimetres", .1},
              {"mm", .1},
              {"decipoints", .00352777777777777778},
              {"Decipoint", .00352777777777777778}};
  (void)state;
  for (size_t k = 0; k < sizeof said / sizeof said[0]; k++) {
    char text[400];
    snprintf(text, sizeof text,
             "[WARP]\nUnits=%s # so\nSpacing=2 ; a half\n[WEFT]\nThickness=3 %s\n" LOOM STRAIGHT
                 TIED TROD,
             said[k].word, said[k].word);
    char message[512];
    shade_draft *d = shade_wif_parse(text, strlen(text), "cloth.wif", message, sizeof message);
    assert_non_null(d);
    assert_near(d->warp[0].spacing, 2 * said[k].cm, 1e-14);
    assert_near(d->weft[0].thickness, 3 * said[k].cm, 1e-14);
    shade_draft_free(d);
  }
}

/* Drafts are the same if all that they hold is. */
static void equal_drafts(void **state) {
  (void)state;
  shade_draft *a = shade_draft_named("twill_2_2"), *b = shade_draft_named("twill_2_2");
  assert_true(shade_draft_equal(a, b));
  for (int weft = 0; weft < 2; weft++) {
    shade_thread *t = weft ? &b->weft[3] : &b->warp[3];
    double *const numbers[] = {&t->color[0], &t->color[1], &t->color[2], &t->thickness,
                               &t->spacing};
    for (int k = 0; k < 5; k++) {
      const double was = *numbers[k];
      *numbers[k] = was + .125;
      assert_false(shade_draft_equal(a, b));
      *numbers[k] = was;
    }
  }
  b->warp_up[5] ^= 1;
  assert_false(shade_draft_equal(a, b));
  static const unsigned char plain[] = {0, 1, 1, 0, 0, 1, 1, 0};
  for (int picks = 1; picks < 4; picks += 2) { /* more of the same */
    shade_draft *small = shade_draft_from_matrix(2, picks, plain),
                *large = shade_draft_from_matrix(2, picks + 1, plain);
    assert_false(shade_draft_equal(small, large) || shade_draft_equal(large, small));
    shade_draft_free(small);
    shade_draft_free(large);
  }
  shade_draft_free(a);
  shade_draft_free(b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(units),           cmocka_unit_test(equal_drafts),
      cmocka_unit_test(plain_reading),   cmocka_unit_test(messy),
      cmocka_unit_test(refusals),        cmocka_unit_test(wrong_counts),
      cmocka_unit_test(counting_from_0), cmocka_unit_test(plans),
      cmocka_unit_test(contents),        cmocka_unit_test(colors),
      cmocka_unit_test(spellings),       cmocka_unit_test(wide_words),
      cmocka_unit_test(short_messages),  cmocka_unit_test(long_files),
      cmocka_unit_test(round_trip),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
