/* SPDX-License-Identifier: Apache-2.0 */
/* Drafts: made by hand, from a pattern's three numbers, or by name. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "names.h"
#include "shade/weave.h"

shade_draft *shade_draft_create(int ends, int picks) {
  if (ends < 1 || picks < 1 || ends > SHADE_DRAFT_MAX_SIDE || picks > SHADE_DRAFT_MAX_SIDE ||
      ends > SHADE_DRAFT_MAX_CELLS / picks)
    return NULL;
  shade_draft *d = calloc(1, sizeof *d);
  if (!d)
    return NULL;
  d->ends = ends;
  d->picks = picks;
  d->warp_up = calloc((size_t)ends * (size_t)picks, 1);
  d->warp = calloc((size_t)ends, sizeof *d->warp);
  d->weft = calloc((size_t)picks, sizeof *d->weft);
  if (!d->warp_up || !d->warp || !d->weft) {
    shade_draft_free(d);
    return NULL;
  }
  for (int i = 0; i < ends; i++)
    d->warp[i].color[0] = d->warp[i].color[1] = d->warp[i].color[2] = 1;
  for (int i = 0; i < picks; i++)
    d->weft[i].color[0] = d->weft[i].color[1] = d->weft[i].color[2] = 1;
  return d;
}

void shade_draft_free(shade_draft *draft) {
  if (!draft)
    return;
  free(draft->warp_up);
  free(draft->warp);
  free(draft->weft);
  free(draft);
}

shade_draft *shade_draft_from_matrix(int ends, int picks, const unsigned char *warp_up) {
  shade_draft *d = warp_up ? shade_draft_create(ends, picks) : NULL;
  for (size_t i = 0; d && i < (size_t)ends * (size_t)picks; i++)
    d->warp_up[i] = warp_up[i] != 0;
  return d;
}

static int remainder_of(long long a, int n) {
  int r = (int)(a % n);
  return r < 0 ? r + n : r;
}

shade_draft *shade_draft_from_pattern(int n_w, int n_p, int n_s) {
  if (n_w == SHADE_WEFT_ONLY)
    return n_p < 0 ? NULL : shade_draft_create(1, 1);
  if (n_w < 1 || n_p < 0 || n_w > SHADE_PATTERN_MAX || n_p > SHADE_PATTERN_MAX - n_w)
    return NULL;
  const int ends = n_w + n_p, shift = remainder_of(n_s, ends);
  int picks = 1;
  while (remainder_of((long long)shift * picks, ends))
    picks++;
  shade_draft *d = shade_draft_create(ends, picks);
  for (int j = 0; d && j < picks; j++)
    for (int i = 0; i < ends; i++)
      d->warp_up[j * ends + i] = remainder_of(i + (long long)shift * j, ends) >= n_w;
  return d;
}

#define NAME_ROW(word, label, help) {#word, label, help},
static const struct { const char *word, *label, *help; } names[] = {SHADE_TABLE_WEAVES(NAME_ROW)};
#define NAME_INDEX(word, label, help) NAME_##word,
enum { SHADE_TABLE_WEAVES(NAME_INDEX) NAME_COUNT };

static shade_draft *herringbone(void) {
  shade_draft *d = shade_draft_create(16, 4);
  /* Two under, two over, rising to the right over eight ends, then to the left. At either
   * turn the neighbours are each other's opposite: the break that keeps it from a zigzag. */
  for (int j = 0; d && j < 4; j++)
    for (int i = 0; i < 16; i++)
      d->warp_up[j * 16 + i] = (i < 8 ? remainder_of(j - i, 4) : remainder_of(j + i + 3, 4)) < 2;
  return d;
}

static shade_draft *basket(void) {
  shade_draft *d = shade_draft_create(4, 4);
  for (int j = 0; d && j < 4; j++)
    for (int i = 0; i < 4; i++)
      d->warp_up[j * 4 + i] = (unsigned char)((i / 2 + j / 2) % 2);
  return d;
}

shade_draft *shade_draft_named(const char *word) {
  int k = 0;
  while (word && k < NAME_COUNT && !same_word(word, names[k].word))
    k++;
  if (!word)
    return NULL;
  /* a shift of all but one is one to the right */
  switch (k) {
  case NAME_plain:
    return shade_draft_from_pattern(1, 1, 1);
  case NAME_twill_2_1:
    return shade_draft_from_pattern(1, 2, -1);
  case NAME_twill_1_2:
    return shade_draft_from_pattern(2, 1, -1);
  case NAME_twill_3_1:
    return shade_draft_from_pattern(1, 3, -1);
  case NAME_twill_1_3:
    return shade_draft_from_pattern(3, 1, -1);
  case NAME_twill_2_2:
    return shade_draft_from_pattern(2, 2, -1);
  case NAME_herringbone:
    return herringbone();
  case NAME_satin_5:
    return shade_draft_from_pattern(1, 4, -2);
  case NAME_satin_8:
    return shade_draft_from_pattern(1, 7, -3);
  case NAME_sateen_5:
    return shade_draft_from_pattern(4, 1, -2);
  case NAME_sateen_8:
    return shade_draft_from_pattern(7, 1, -3);
  case NAME_basket:
    return basket();
  default:
    return NULL;
  }
}

int shade_weave_row(int row, const char **word, const char **label, const char **help) {
  if (row < 0 || row >= NAME_COUNT)
    return 0;
  if (word)
    *word = names[row].word;
  if (label)
    *label = names[row].label;
  if (help)
    *help = names[row].help;
  return 1;
}

static int same_threads(const shade_thread *a, const shade_thread *b, int count) {
  for (int i = 0; i < count; i++)
    if (a[i].color[0] != b[i].color[0] || a[i].color[1] != b[i].color[1] ||
        a[i].color[2] != b[i].color[2] || a[i].thickness != b[i].thickness ||
        a[i].spacing != b[i].spacing)
      return 0;
  return 1;
}

int shade_draft_equal(const shade_draft *a, const shade_draft *b) {
  return a->ends == b->ends && a->picks == b->picks &&
         !memcmp(a->warp_up, b->warp_up, (size_t)a->ends * (size_t)a->picks) &&
         same_threads(a->warp, b->warp, a->ends) && same_threads(a->weft, b->weft, a->picks);
}

/* Position in cm to a count of yarns. */
static double count_yarns(const shade_thread *threads, int count, double spacing, double x) {
  double stated = 0, repeat = 0;
  int number = 0;
  for (int i = 0; i < count; i++)
    if (threads[i].spacing > 0) {
      stated += threads[i].spacing;
      number++;
    }
  const double usual = number ? stated / number : spacing > 0 ? spacing : .1;
  for (int i = 0; i < count; i++)
    repeat += threads[i].spacing > 0 ? threads[i].spacing : usual;
  if (!isfinite(x) || !isfinite(repeat))
    return 0;
  const double turns = floor(x / repeat);
  double rest = x - turns * repeat;
  for (int i = 0; i < count; i++) {
    const double own = threads[i].spacing > 0 ? threads[i].spacing : usual;
    if (rest < own || i == count - 1)
      return turns * count + i + fmin(fmax(rest / own, 0), 1);
    rest -= own;
  }
  return 0;
}

void shade_draft_cells(const shade_draft *draft, double spacing, double x, double y, double *u,
                       double *v) {
  *u = count_yarns(draft->warp, draft->ends, spacing, x);
  *v = count_yarns(draft->weft, draft->picks, spacing, y);
}
