/* SPDX-License-Identifier: Apache-2.0 */
/* Draws over the upper hemisphere against their density: bins, and Pearson's chi-square. */
#ifndef SHADE_TEST_CHI2_H
#define SHADE_TEST_CHI2_H

#include <math.h>

#include "support.h"

enum { RINGS = 20, SECTORS = 40, BINS = RINGS * SECTORS };

/* Upper tail of the chi-square distribution: Q(dof/2, x/2) by series or continued fraction. */
static inline double chi2_tail(double x, int dof) {
  double a = 0.5 * dof, y = 0.5 * x, scale = exp(a * log(y) - y - lgamma(a));
  if (y < a + 1) {
    double term = 1 / a, sum = term;
    for (int k = 1; k < 10000 && term > sum * 1e-16; k++)
      sum += term *= y / (a + k);
    return 1 - scale * sum;
  }
  double b = y + 1 - a, c = 1e300, d = 1 / b, h = d;
  for (int k = 1; k < 10000; k++) {
    double an = -k * (k - a), delta;
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    h *= delta = c * d;
    if (fabs(delta - 1) < 1e-16)
      break;
  }
  return scale * h;
}

/* Point k of fine x fine of a bin, even in cos theta and phi; bin_of is the way back. */
static inline void bin_point(int bin, int k, int fine, double w[3]) {
  enum { FINEST = 40 };
  static double turned[SECTORS * FINEST][2];
  static int made; /* for so fine */
  for (int i = 0; made != fine && i < SECTORS * fine; i++) {
    const double phi = 2 * PI * (i + 0.5) / (SECTORS * fine);
    turned[i][0] = cos(phi);
    turned[i][1] = sin(phi);
  }
  made = fine;
  const double z = (bin / SECTORS + (k / fine + 0.5) / fine) / RINGS;
  const double s = sqrt((1 - z) * (1 + z)), *v = turned[bin % SECTORS * fine + k % fine];
  w[0] = s * v[0];
  w[1] = s * v[1];
  w[2] = z;
}

static inline int bin_of(double x, double y, double z) {
  const int ring = (int)fmin(z * RINGS, RINGS - 1);
  return ring * SECTORS + sector_of(x, y, SECTORS);
}

/*
 * p-value of `counts` of so many draws, `lost` of which found no direction, where bins hold
 * `expected` of the density. Bins that expect fewer than 10 draws are pooled, lost draws are a bin.
 */
static inline double chi2(long draws, const double expected[BINS], const long counts[BINS],
                          long lost) {
  double pool_e = 0, pool_c = 0, x = 0, whole = 0;
  int dof = 0;
  for (int i = 0; i < BINS; i++)
    whole += expected[i];
  for (int i = 0; i <= BINS; i++) {
    double e = (double)draws * (i < BINS ? expected[i] : fmax(1 - whole, 0));
    double c = (double)(i < BINS ? counts[i] : lost);
    if (e < 10) {
      pool_e += e;
      pool_c += c;
    } else {
      x += (c - e) * (c - e) / e;
      dof++;
    }
  }
  if (pool_e >= 10 || pool_c > 10 + 6 * sqrt(pool_e)) {
    x += (pool_c - pool_e) * (pool_c - pool_e) / fmax(pool_e, 1e-3);
    dof++;
  }
  return chi2_tail(x, dof - 1);
}

#endif
