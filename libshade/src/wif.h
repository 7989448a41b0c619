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
 *   CONTENTS       section=yes/no: what the file holds
 * Shaft, treadle and colour 0 mean none. The warp is over the weft where one of the end's
 * shafts is raised by one of the pick's treadles. All other sections are passed over.
 *
 * That is the format; files differ. What they get wrong without hiding what they mean is mended
 * (`mending`) and said in one warning; what can mean nothing is refused.
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
  CONTENTS,
  SECTIONS,
  OTHER = SECTIONS
} section;

/* In capitals, as the format has them. */
extern const char *const shade_wif_section_names[SECTIONS];

/* What is mended, and said once for each. */
typedef enum mending {
  THREADING_MISSING,
  TIEUP_MISSING,
  SECTION_TWICE,
  ROW_TWICE,
  NO_EQUALS,
  CONTENTS_WRONG,
  KEYS_FROM_0,
  SHAFTS_FROM_0,
  TREADLES_FROM_0,
  COLORS_FROM_0,
  ROW_BEYOND,
  FEWER_ROWS,
  SHAFT_BEYOND,
  TIEUP_BEYOND,
  NOT_TIED,
  TWO_PLANS,
  UNITS_UNKNOWN,
  FORM_UNKNOWN,
  CHANNELS,
  RANGE_GUESSED,
  RANGE_LEFT,
  COLOR_MISSING,
  COLOR_HEX,
  COLOR_NONE,
  ENTRIES_WRONG,
  MENDINGS
} mending;

typedef struct mended {
  long line; /* of the first; 0: of no line */
  int count;
  char text[160];
} mended;

typedef struct length {
  double value, unit; /* cm; 0: the section's */
} length;

/* key=values on one line: `count` whole numbers from `first` on in the pool, or a length. */
typedef struct row {
  int key, first, count, hex; /* hex: of 255, whatever the Range */
  long line;
  length length;
} row;

typedef struct rows {
  row *data;
  size_t count, capacity;
  int largest;    /* key */
  long zero_line; /* of key 0; 0: none */
} rows;

/* [WARP] or [WEFT]. */
typedef struct direction {
  int threads, color, rgb[3]; /* rgb[0] < 0: the colour is not spelled out beside its number */
  long threads_line, color_line, units_line;
  double unit; /* cm; 0: an unknown word, `units` */
  char units[44];
  length spacing, thickness;
} direction;

typedef enum color_form { FORM_RGB, FORM_CMYK, FORM_OTHER } color_form;

/* All that was read of one file. */
typedef struct wif {
  const char *name;
  long line;
  char *message;
  size_t message_size;
  long seen[SECTIONS];                        /* line of the section's name; 0: not there */
  long announced[SECTIONS], denied[SECTIONS]; /* line of CONTENTS that says so, or 0 */
  rows rows[ROWS];
  int *pool;
  size_t pool_count, pool_capacity;
  int shafts, treadles, sinking;
  direction way[2]; /* warp, weft */
  double range[2];
  int has_range;
  color_form form;
  int entries; /* announced; 0: not */
  long entries_line;
  mended mended[MENDINGS];
  char point; /* the locale's decimal point */
} wif;

/* A stretch of one line, without the blanks around it. */
typedef struct span {
  const char *at, *end;
} span;

/* --- wif_words.c --- */

/* "NAME, line N: …" (0: no line) as the message. Returns -1. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int shade_wif_fail(const wif *w, long line, const char *format, ...);

/* Note what was mended; of each kind the first is kept and the others counted. */
#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
void shade_wif_mend(wif *w, mending kind, long line, const char *format, ...);

/* The message of a draft that was read: "NAME: mended: line N: …; line M: …", or nothing. */
void shade_wif_say_mended(const wif *w);

span shade_wif_trim(const char *at, const char *end);

/* Whether the span is the word (in capitals), whatever blanks, - and _ it has; COLOUR is COLOR. */
int shade_wif_is_word(span s, const char *word);

/* 1 yes, 0 no, -1 neither. */
int shade_wif_is_yes(span s);

/* What stands before a comment, without quotation marks around it. */
span shade_wif_value(span s);

/* For messages: at most 40 characters, what cannot be shown as '?'. */
typedef struct shown {
  char text[44];
} shown;
shown shade_wif_show(span s);

/* The next of the items that commas or blanks separate, taken from *s; empty: there is none. */
span shade_wif_item(span *s);

/* A whole number of 0 to MAX_NUMBER that is the whole span; "3.0" passes as 3. -1 otherwise. */
int shade_wif_whole(span s);

/* Centimetres of the unit that the word names; 0: not known. */
double shade_wif_unit(span s);

/*
 * 0 and a length of 0 to 1e6, with or without its unit, that is the whole span, or -1. A lone
 * comma passes as the decimal point.
 */
int shade_wif_length(const wif *w, span s, length *to);

/*
 * From *text on, *length bytes without a byte order mark: of UTF-16 what is not ASCII becomes '?'.
 * *made is what to free, or NULL. -1 when out of memory.
 */
int shade_wif_as_bytes(const char **text, size_t *length, char **made);

/* --- wif_draft.c --- */

/* The draft of what was read; NULL with an error as the message. */
shade_draft *shade_wif_draft(wif *w);

#endif
