/* SPDX-License-Identifier: Apache-2.0 */
/* Weaving Information Files: a draft as text. */
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shade/weave.h"

enum { MAX_TREADLES_WRITTEN = 64 };

typedef struct writer {
  char *text;
  size_t length, capacity;
  int failed;
} writer;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void
put(writer *w, const char *format, ...) {
  char piece[512];
  va_list args;
  va_start(args, format);
  const int got = vsnprintf(piece, sizeof piece, format, args);
  va_end(args);
  if (got < 0 || (size_t)got >= sizeof piece)
    w->failed = 1;
  while (!w->failed && w->capacity - w->length <= (size_t)got) {
    size_t capacity = w->capacity ? 2 * w->capacity : 4096;
    char *text = realloc(w->text, capacity);
    w->failed = !text;
    w->text = text ? text : w->text;
    w->capacity = text ? capacity : w->capacity;
  }
  if (w->failed)
    return;
  memcpy(w->text + w->length, piece, (size_t)got + 1);
  w->length += (size_t)got;
}

/* A number that reads back the same, with a point in any locale. */
static void put_length(writer *w, const char *key, double x) {
  char text[40];
  x = x > 0 ? fmin(x, 1e6) : 0;
  snprintf(text, sizeof text, "%.15g", x);
  if (strtod(text, NULL) != x)
    snprintf(text, sizeof text, "%.17g", x);
  for (char *c = text; *c; c++)
    if (*c == ',')
      *c = '.';
  put(w, "%s=%s\n", key, text);
}

/* Which of the lines of `size` bytes, `count` of them, are the same: each one's class, from
 * 0 in the order of first appearance. Returns the number of classes. */
static int classify(const unsigned char *lines, int count, size_t size, int *classes, int *first) {
  /* open addressing over twice as many places as there can be classes */
  const uint32_t places = 4 * SHADE_DRAFT_MAX_SIDE;
  int *table = calloc(places, sizeof *table), number = 0;
  if (!table)
    return -1;
  for (int i = 0; i < count; i++) {
    const unsigned char *line = lines + (size_t)i * size;
    uint32_t hash = 2166136261u;
    for (size_t k = 0; k < size; k++)
      hash = (hash ^ line[k]) * 16777619u;
    uint32_t place = (hash ^ hash >> 15) % places;
    while (table[place] && memcmp(lines + (size_t)first[table[place] - 1] * size, line, size))
      place = (place + 1) % places;
    if (!table[place]) {
      first[number++] = i;
      table[place] = number;
    }
    classes[i] = table[place] - 1;
  }
  free(table);
  return number;
}

/* The smallest N that all colours are whole numbers of 1/N of, the usual ones first. */
static int color_range(const unsigned char *colors, const int *first, int count) {
  static const int usual[] = {255, 65535, 999};
  for (int k = -3; k <= 65535; k++) {
    const int n = k < 0 ? usual[k + 3] : k;
    int exact = n > 0;
    for (int i = 0; exact && i < count; i++) {
      double c[3];
      memcpy(c, colors + (size_t)first[i] * sizeof c, sizeof c);
      for (int channel = 0; channel < 3; channel++)
        exact &= floor(c[channel] * n + .5) / n == c[channel];
    }
    if (exact)
      return n;
  }
  return 16777215;
}

static void put_threads(writer *w, const char *name, const shade_thread *threads, int count,
                        const int *colors) {
  put(w, "\n[%s]\nThreads=%d\nColor=%d\nUnits=centimeters\n", name, count, colors[0] + 1);
  if (threads[0].spacing > 0)
    put_length(w, "Spacing", threads[0].spacing);
  if (threads[0].thickness > 0)
    put_length(w, "Thickness", threads[0].thickness);
}

/* The rows that differ from the first, which is the default. */
static void put_overrides(writer *w, const char *name, const shade_thread *threads, int count,
                          const int *colors, int contents) {
  int differ[3] = {0, 0, 0};
  static const char *const what[] = {"COLORS", "SPACING", "THICKNESS"};
  for (int i = 0; i < count; i++) {
    differ[0] |= colors[i] != colors[0];
    differ[1] |= threads[i].spacing != threads[0].spacing;
    differ[2] |= threads[i].thickness != threads[0].thickness;
  }
  for (int k = 0; k < 3; k++) {
    if (!differ[k])
      continue;
    if (contents) {
      put(w, "%s %s=true\n", name, what[k]);
      continue;
    }
    put(w, "\n[%s %s]\n", name, what[k]);
    for (int i = 0; i < count; i++) {
      char key[16];
      snprintf(key, sizeof key, "%d", i + 1);
      if (k == 0 && colors[i] != colors[0])
        put(w, "%d=%d\n", i + 1, colors[i] + 1);
      if (k == 1 && threads[i].spacing != threads[0].spacing)
        put_length(w, key, threads[i].spacing);
      if (k == 2 && threads[i].thickness != threads[0].thickness)
        put_length(w, key, threads[i].thickness);
    }
  }
}

/* The shafts that pick j raises, after "key=". */
static void put_shafts(writer *w, const shade_draft *d, int key, int j, const int *first_end,
                       int shafts) {
  put(w, "%d=", key);
  const char *comma = "";
  for (int s = 0; s < shafts; s++)
    if (d->warp_up[(size_t)j * (size_t)d->ends + (size_t)first_end[s]]) {
      put(w, "%s%d", comma, s + 1);
      comma = ",";
    }
  put(w, "%s\n", *comma ? "" : "0");
}

char *shade_wif_text(const shade_draft *d) {
  const size_t ends = (size_t)d->ends, picks = (size_t)d->picks, both = ends + picks;
  unsigned char *columns = malloc(ends * picks), *rows = malloc(ends * picks);
  double(*colors)[3] = malloc(both * sizeof *colors);
  int *shaft = calloc(2 * ends, sizeof *shaft), *treadle = calloc(2 * picks, sizeof *treadle);
  int *color = calloc(2 * both, sizeof *color);
  writer w = {0};
  w.failed = !columns || !rows || !colors || !shaft || !treadle || !color;
  int shafts = -1, treadles = -1, table = -1;
  if (!w.failed) {
    for (size_t j = 0; j < picks; j++)
      for (size_t i = 0; i < ends; i++)
        columns[i * picks + j] = rows[j * ends + i] = d->warp_up[j * ends + i] != 0;
    for (size_t i = 0; i < both; i++)
      for (int c = 0; c < 3; c++) {
        const double x = i < ends ? d->warp[i].color[c] : d->weft[i - ends].color[c];
        colors[i][c] = x > 0 ? fmin(x, 1) : 0; /* a NaN too, and -0 */
      }
    shafts = classify(columns, d->ends, picks, shaft, shaft + ends);
    treadles = classify(rows, d->picks, ends, treadle, treadle + picks);
    table = classify((unsigned char *)colors, (int)both, sizeof *colors, color, color + both);
  }
  if (shafts < 0 || treadles < 0 || table < 0) {
    w.failed = 1;
  } else {
    const int lift = treadles > MAX_TREADLES_WRITTEN;
    const int range = color_range((unsigned char *)colors, color + both, table);
    put(&w,
        "[WIF]\nVersion=1.1\nDate=April 20, 1997\nDevelopers=wif@mhsoft.com\n"
        "Source Program=libshade\nSource Version=%s\n\n[CONTENTS]\nCOLOR PALETTE=true\n"
        "WEAVING=true\nWARP=true\nWEFT=true\n%sCOLOR TABLE=true\nTHREADING=true\n%s=true\n",
        SHADE_VERSION, lift ? "" : "TIEUP=true\n", lift ? "LIFTPLAN" : "TREADLING");
    put_overrides(&w, "WARP", d->warp, d->ends, color, 1);
    put_overrides(&w, "WEFT", d->weft, d->picks, color + ends, 1);
    put(&w, "\n[WEAVING]\nShafts=%d\nTreadles=%d\nRising Shed=true\n", shafts,
        lift ? shafts : treadles);
    put_threads(&w, "WARP", d->warp, d->ends, color);
    put_threads(&w, "WEFT", d->weft, d->picks, color + ends);
    put(&w, "\n[COLOR PALETTE]\nEntries=%d\nForm=RGB\nRange=0,%d\n\n[COLOR TABLE]\n", table, range);
    for (int i = 0; i < table; i++) {
      const double *c = colors[color[both + (size_t)i]];
      put(&w, "%d=%.0f,%.0f,%.0f\n", i + 1, floor(c[0] * range + .5), floor(c[1] * range + .5),
          floor(c[2] * range + .5));
    }
    put(&w, "\n[THREADING]\n");
    for (int i = 0; i < d->ends; i++)
      put(&w, "%d=%d\n", i + 1, shaft[i] + 1);
    put(&w, lift ? "\n[LIFTPLAN]\n" : "\n[TIEUP]\n");
    for (int i = 0; i < (lift ? d->picks : treadles); i++)
      put_shafts(&w, d, i + 1, lift ? i : treadle[picks + (size_t)i], shaft + ends, shafts);
    if (!lift) {
      put(&w, "\n[TREADLING]\n");
      for (int i = 0; i < d->picks; i++)
        put(&w, "%d=%d\n", i + 1, treadle[i] + 1);
    }
    put_overrides(&w, "WARP", d->warp, d->ends, color, 0);
    put_overrides(&w, "WEFT", d->weft, d->picks, color + ends, 0);
  }
  free(columns);
  free(rows);
  free(colors);
  free(shaft);
  free(treadle);
  free(color);
  if (w.failed) {
    free(w.text);
    return NULL;
  }
  return w.text;
}
