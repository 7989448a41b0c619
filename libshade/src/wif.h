/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Weaving Information Files 1.1 [Wif1997]. The format, as far as a draft needs it:
 *
 * A text of sections, "[NAME]", each followed by lines "key=value"; a line that begins with ;
 * is a comment, and so is what follows a ; behind a number. In the sections of rows the key is
 * the number of an end, pick, treadle or colour, from 1, and rows that are left out have the
 * default.
 *   WEAVING        Shafts, Treadles, Rising Shed (yes/no): whether named shafts rise or sink
 *   WARP, WEFT     Threads (how many), Color (row of the colour table), Units (decipoints,
 *                  inches, centimeters), Spacing, Thickness
 *   COLOR PALETTE  Entries, Form (RGB), Range=lowest,highest    COLOR TABLE  colour=r,g,b
 *   THREADING      end=shaft          TIEUP     treadle=shafts, comma separated
 *   TREADLING      pick=treadles      LIFTPLAN  pick=shafts
 *   WARP COLORS, WARP SPACING, WARP THICKNESS and the same of WEFT: overrides by end and pick
 * Shaft, treadle and colour 0 mean none. The warp is over the weft where one of the end's
 * shafts is raised by one of the pick's treadles. All other sections are passed over, and so
 * is CONTENTS: the list of sections that many programs write does not always hold.
 *
 * wif_words.c: words, numbers, encodings. wif_read.c: lines to rows. wif_draft.c: rows to a
 * draft. wif_write.c: a draft to text. Private to src/.
 */
#ifndef SHADE_SRC_WIF_H
#define SHADE_SRC_WIF_H

#include <stddef.h>

#include "shade/weave.h"

enum {
  MAX_FILE = 1 << 27,
  MAX_NUMBER = 1 << 24, /* of any whole number in a row */
  MAX_COLORS = 1 << 20,
  MAX_ROWS = 1 << 20
};

/* Sections of rows of whole numbers, of rows of lengths, and of named values. */
typedef enum section {
  THREADING,
  TIEUP,
  TREADLING,
  LIFTPLAN,
  WARP_COLORS,
  WEFT_COLORS,
  COLOR_TABLE,
  WHOLE_ROWS,
  WARP_SPACING = WHOLE_ROWS,
  WEFT_SPACING,
  WARP_THICKNESS,
  WEFT_THICKNESS,
  ROWS,
  WEAVING = ROWS,
  WARP,
  WEFT,
  COLOR_PALETTE,
  SECTIONS,
  OTHER = SECTIONS
} section;

/* In capitals, as the files have them. */
extern const char *const wif_section_names[SECTIONS];

/* key=values on one line: `count` whole numbers from `first` on in the pool, or a length. */
typedef struct row {
  int key, first, count;
  long line;
  double length;
} row;

typedef struct rows {
  row *data;
  size_t count, capacity;
  int largest; /* key */
} rows;

/* [WARP] or [WEFT]. */
typedef struct direction {
  int threads, color;
  long threads_line, color_line;
  double unit, spacing, thickness; /* cm; the values in that unit */
} direction;

/* All that was read of one file. */
typedef struct wif {
  const char *name;
  long line;
  char *error;
  size_t error_size;
  rows rows[ROWS];
  int *pool;
  size_t pool_count, pool_capacity;
  int shafts, treadles, sinking;
  direction way[2]; /* warp, weft */
  double range[2];
  char point; /* the locale's decimal point */
} wif;

/* A stretch of one line, without the blanks around it. */
typedef struct span {
  const char *at, *end;
} span;

/* --- wif_words.c --- */

/* "NAME, line N: …" (0: no line) to the error buffer. Returns -1. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int wif_fail(const wif *w, long line, const char *format, ...);

span wif_trim(const char *at, const char *end);

/* Whether the span is the word (in capitals); any blanks stand for the word's one. */
int wif_is_word(span s, const char *word);

/* What stands before a comment. */
span wif_without_comment(span s);

/* For messages: at most 40 characters, what cannot be shown as '?'. */
typedef struct shown {
  char text[44];
} shown;
shown wif_show(span s);

/* A whole number of 0 to MAX_NUMBER that is the whole span; "3.0" passes as 3. -1 otherwise. */
int wif_whole(span s);

/* 0 and a finite number that is the whole span, or -1; a lone comma passes as the decimal point. */
int wif_real(const wif *w, span s, double *value);

/*
 * From *text on, *length bytes without a byte order mark: of UTF-16 what is not ASCII becomes '?'.
 * *made is what to free, or NULL. -1 when out of memory.
 */
int wif_as_bytes(const char **text, size_t *length, char **made);

/* --- wif_draft.c --- */

/* The draft of what was read; NULL with an error written. */
shade_draft *wif_draft(const wif *w);

#endif
