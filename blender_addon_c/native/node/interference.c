/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "node/interference.h"

#include <pthread.h>
#include <stdlib.h>

static pthread_once_t once = PTHREAD_ONCE_INIT;
static float made[6 * FILM_WAYS];

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
static void make(void) {
  static const double rgb[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                   {-0.9692660, 1.8760108, 0.0415560},
                                   {0.0556434, -0.2040259, 1.0572252}};
  enum { FIRST = 360, LAST = 830, STEPS = 2 * (LAST - FIRST) };
  double *sum = calloc(6 * FILM_WAYS, sizeof *sum);
  if (!sum) { /* as if all films were thick */
    made[0] = made[2 * FILM_WAYS] = made[4 * FILM_WAYS] = 1.0f;
    return;
  }
  for (int step = 0; step < STEPS; step++) {
    double nm = FIRST + (step + 0.5) / 2, xyz[3], turn = 6.283185307179586 * (double)FILM_STEP / nm;
    double c = 1, s = 0, by_c = cos(turn), by_s = sin(turn);
    observer(nm, xyz);
    for (int way = 0; way < FILM_WAYS - 1; way++) {
      for (int color = 0; color < 3; color++) {
        double value = rgb[color][0] * xyz[0] + rgb[color][1] * xyz[1] + rgb[color][2] * xyz[2];
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
      made[2 * color * FILM_WAYS + way] =
          (float)(sum[2 * color * FILM_WAYS + way] / sum[2 * color * FILM_WAYS]);
  free(sum);
}

const float *thin_film_table(void) {
  pthread_once(&once, make);
  return made;
}
