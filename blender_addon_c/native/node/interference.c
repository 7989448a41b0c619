/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "node/interference.h"

#include <stdlib.h>
#include <string.h>

#include "system/threads.h"

/* One for each working space that was ever asked for. */
typedef struct film_table {
  double rgb[9];
  float part[6 * FILM_WAYS];
  struct film_table *next;
} film_table;
static film_table *made;
static pthread_mutex_t making = PTHREAD_MUTEX_INITIALIZER;

static double lobe(double nm, double middle, double below, double above) {
  double t = (nm - middle) * (nm < middle ? below : above);
  return exp(-0.5 * t * t);
}

/* The CIE's observer of 1931, a fit within 1 % of its peaks [WymanSloanShirley2013]. */
static void observer(double nm, double xyz[3]) {
  xyz[0] = 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) + 1.056 * lobe(nm, 599.8, 0.0264, 0.0323) -
           0.065 * lobe(nm, 501.1, 0.0490, 0.0382);
  xyz[1] = 0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322);
  xyz[2] = 1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725);
}

/* Light that is even over wavelengths is white. */
static film_table *make(const double rgb[9]) {
  enum { FIRST = 360, LAST = 830, STEPS = 2 * (LAST - FIRST) };
  film_table *table = malloc(sizeof *table);
  double *sum = table ? calloc(6 * FILM_WAYS, sizeof *sum) : NULL;
  if (!sum) {
    free(table);
    return NULL;
  }
  for (int step = 0; step < STEPS; step++) {
    double nm = FIRST + (step + 0.5) / 2, xyz[3], turn = 6.283185307179586 * (double)FILM_STEP / nm;
    double c = 1, s = 0, by_c = cos(turn), by_s = sin(turn);
    observer(nm, xyz);
    for (int way = 0; way < FILM_WAYS - 1; way++) {
      for (int color = 0; color < 3; color++) {
        const double *row = rgb + 3 * color;
        double value = row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
        sum[2 * color * FILM_WAYS + way] += value * c;
        sum[(2 * color + 1) * FILM_WAYS + way] += value * s;
      }
      double next = c * by_c - s * by_s;
      s = c * by_s + s * by_c;
      c = next;
    }
  }
  for (int color = 0; color < 3; color++)
    for (int way = 0; way < 2 * FILM_WAYS; way++)
      table->part[2 * color * FILM_WAYS + way] =
          (float)(sum[2 * color * FILM_WAYS + way] / sum[2 * color * FILM_WAYS]);
  free(sum);
  memcpy(table->rgb, rgb, sizeof table->rgb);
  return table;
}

const float *thin_film_table(reader *r) {
  double rgb[9];
  if (!reader_rgb_of_xyz(r, "film_rgb", rgb))
    return NULL;
  pthread_mutex_lock(&making);
  film_table *table = made;
  while (table && memcmp(table->rgb, rgb, sizeof rgb) != 0)
    table = table->next;
  if (!table && (table = make(rgb)) != NULL) {
    table->next = made;
    made = table;
  }
  pthread_mutex_unlock(&making);
  if (!table)
    reader_out_of_memory(r);
  return table ? table->part : NULL;
}
