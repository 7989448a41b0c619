/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fit of [Preetham1999]: chromaticity and luminance by Perez's five coefficients, as their
 * appendix A.2 has them. Blender takes .06 of the luminance in kcd/m². */
#include <math.h>

#include "scene/atmosphere.h"

enum { COLUMNS = ATMOSPHERE_HALF };

/* Each a times turbidity and b, for Y, x and y. */
static const double PEREZ[3][5][2] = {
    {{0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}},
    {{-0.0193, -0.2592},
     {-0.0665, 0.0008},
     {-0.0004, 0.2125},
     {-0.0641, -0.8989},
     {-0.0033, 0.0452}},
    {{-0.0167, -0.2608},
     {-0.0950, 0.0092},
     {-0.0079, 0.2102},
     {-0.0441, -1.6537},
     {-0.0109, 0.0529}}};

/* At the zenith: by powers of turbidity, 2 to 0, and of the sun's distance from it, 3 to 0. */
static const double ZENITH[2][3][4] = {{{0.00166, -0.00375, 0.00209, 0},
                                        {-0.02903, 0.06377, -0.03202, 0.00394},
                                        {0.11693, -0.21196, 0.06052, 0.25886}},
                                       {{0.00275, -0.00610, 0.00317, 0},
                                        {-0.04214, 0.08970, -0.04153, 0.00516},
                                        {0.15346, -0.26756, 0.06670, 0.26688}}};

static double perez(int of, double turbidity, double cosine, double angle) {
  double c[5];
  for (int k = 0; k < 5; k++)
    c[k] = PEREZ[of][k][0] * turbidity + PEREZ[of][k][1];
  return (1 + c[0] * exp(c[1] / cosine)) *
         (1 + c[2] * exp(c[3] * angle) + c[4] * cos(angle) * cos(angle));
}

static double at_zenith(int of, double turbidity, double sun) {
  if (of == 0) {
    double chi = (4.0 / 9 - turbidity / 120) * (3.141592653589793 - 2 * sun);
    return 0.06 * ((4.0453 * turbidity - 4.9710) * tan(chi) - 0.2155 * turbidity + 2.4192);
  }
  double sum = 0;
  for (int k = 0; k < 3; k++) {
    const double *c = ZENITH[of - 1][k];
    sum = sum * turbidity + ((c[0] * sun + c[1]) * sun + c[2]) * sun + c[3];
  }
  return sum;
}

/* Below the horizon directions count as at it, but for their angle from the sun. */
void preetham_row(const atmosphere *a, int row, atmosphere_half out) {
  const double right = 1.5707963267948966;
  double part = (row + 0.5) / ATMOSPHERE_HORIZON - 1, rise = right * part * fabs(part);
  double sun = right - (double)a->elevation, turbidity = (double)a->turbidity;
  double cosine = sin(rise > 0.001 ? rise : 0.001), factor[3];
  for (int k = 0; k < 3; k++)
    factor[k] = at_zenith(k, turbidity, sun) / perez(k, turbidity, 1, sun);
  for (int i = 0; i < COLUMNS; i++) {
    double turn = right * (2 - (2.0 * i + 1) / COLUMNS), c[3];
    double mu = cos(rise) * cos(turn) * sin(sun) + sin(rise) * cos(sun);
    for (int k = 0; k < 3; k++)
      c[k] = factor[k] * perez(k, turbidity, cosine, acos(fmin(fmax(mu, -1), 1)));
    out[0][i] = (float)(c[1] / c[2] * c[0]);
    out[1][i] = (float)c[0];
    out[2][i] = (float)((1 - c[1] - c[2]) / c[2] * c[0]);
  }
}
