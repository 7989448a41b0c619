/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The lobes alone. How far D' of a method is from the lobe of a displaced surface, as the total
 * variation half the integral of |D' - D_true| over all directions of h.
 *
 * D_true is written down here from the definitions, in the displaced surface's own axes: none of
 * the library's formulas is in it. Where a distribution is normalised with a cosine (Beckmann,
 * GGX) the measure is that of n.h.
 */
#include "program.h"

#include <stdlib.h>

/* From [AshikhminShirley2000 Eq. 4], [Ward1992], [Walter2007]; h in the lobe's own frame. */
static double distribution(shade_mdf mdf, double first, double second, vec h) {
  if (h.z <= 0)
    return 0;
  const double r2 = h.x * h.x + h.y * h.y, a = first * second;
  const double tan2 = (h.x * h.x / (first * first) + h.y * h.y / (second * second)) / (h.z * h.z);
  switch (mdf) {
  case SHADE_MDF_ASHIKHMIN_SHIRLEY: {
    const double e = r2 > 0 ? (first * h.x * h.x + second * h.y * h.y) / r2 : 0;
    return sqrt((first + 1) * (second + 1)) / (2 * PI) * pow(h.z, e);
  }
  case SHADE_MDF_WARD:
    return exp(-tan2) / (PI * a);
  case SHADE_MDF_WARD_HALF:
    return exp(-2 * (h.x * h.x / (first * first) + h.y * h.y / (second * second)) / (1 + h.z)) /
           (PI * a);
  case SHADE_MDF_BECKMANN:
    return exp(-tan2) / (PI * a * pow(h.z, 4));
  default: /* GGX */
    return 1 / (PI * a * pow(h.z, 4) * (1 + tan2) * (1 + tan2));
  }
}

static int with_cosine(shade_mdf mdf) {
  return mdf == SHADE_MDF_BECKMANN || mdf == SHADE_MDF_GGX;
}

/* Axes of the displaced surface above the tilted normal n: the slope's own tangents. */
static void axes(vec n, int along_y, vec *x, vec *y) {
  const vec du = {1, 0, -n.x / n.z}, dv = {0, 1, -n.y / n.z};
  if (along_y) {
    *y = unit(dv);
    *x = cross(*y, n);
  } else {
    *x = unit(du);
    *y = cross(n, *x);
  }
}

enum { THETAS = 360, PHIS = 720 }; /* of h: half degrees, a tenth of the narrowest lobe here */

int displaced_lobes(const scene *sc, double tilt, int azimuths, const char *csv) {
  const size_t count = PHIS;
  double *column = malloc(8 * count * sizeof *column), *d = column + 6 * count;
  double total[SHADE_DETAIL_COUNT] = {0}, energy[SHADE_DETAIL_COUNT] = {0}, mass = 0;
  if (!column) {
    fputs("displaced: out of memory\n", stderr);
    return 1;
  }
  const double step = PI / THETAS, s = sin(tilt * PI / 180), c = cos(tilt * PI / 180);
  for (int k = 0; k < azimuths; k++) {
    const double a = 2 * PI * (k + 0.5) / azimuths;
    const vec n = {s * cos(a), s * sin(a), c};
    vec x, y;
    axes(n, sc->along_y, &x, &y);
    for (int i = 0; i < THETAS; i++) {
      const double theta = (i + 0.5) * step, around = step * 2 * PI / PHIS * sin(theta) / azimuths;
      double *truth = column + 7 * count;
      for (size_t j = 0; j < count; j++) {
        const double phi = 2 * PI * ((double)j + 0.5) / PHIS;
        const vec h = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
        const double measure = with_cosine(sc->params.mdf) ? fmax(dot(n, h), 0) : 1;
        const double in[6] = {n.x, n.y, n.z, h.x, h.y, h.z};
        for (int q = 0; q < 6; q++)
          column[(size_t)q * count + j] = in[q];
        const vec own = {dot(x, h), dot(y, h), dot(n, h)};
        truth[j] = distribution(sc->params.mdf, sc->first, sc->second, own) * measure;
        mass += around * truth[j];
      }
      for (int m = 0; m < sc->methods; m++) {
        shade_mdf_eval_batch(&sc->bsdf[m], count, column, column + count, column + 2 * count,
                             column + 3 * count, column + 4 * count, column + 5 * count, d);
        for (size_t j = 0; j < count; j++) {
          const double *h = column + 3 * count + j;
          const double up = n.x * h[0] + n.y * h[count] + n.z * h[2 * count];
          const double mine = d[j] * (with_cosine(sc->params.mdf) ? fmax(up, 0) : 1);
          total[m] += 0.5 * around * fabs(mine - truth[j]);
          energy[m] += around * (h[2 * count] > 0 ? mine : 0);
        }
      }
    }
  }
  free(column);
  text out = {0};
  text_line(&out, "tilt,distribution,first,second,method,variation,energy,mass\n");
  for (int m = 0; m < sc->methods; m++)
    text_line(&out, "%.9g,%s,%.9g,%.9g,%s,%.9g,%.9g,%.9g\n", tilt,
              shade_list_word(SHADE_LIST_MDF, (int)sc->params.mdf), sc->first, sc->second,
              shade_list_word(SHADE_LIST_DETAIL, sc->method[m]), total[m], energy[m], mass);
  return text_write(&out, csv);
}
