/* SPDX-License-Identifier: Apache-2.0 */
/* The cloth over a footprint: the mean of the near model over points of it. */
#include "cloth_model.h"

double shade_ref_far_share(const double footprint[2]) {
  real longer = footprint[0] > footprint[1] ? footprint[0] : footprint[1];
  if (longer <= 0.75L)
    return 0;
  real x = logl(longer / 0.75L) / logl(2 / 0.75L);
  return x < 1 ? (double)(x * x * (3 - 2 * x)) : 1;
}

/* Columns of 16 points: twice as many, or half, until they suit the longer side. */
static int columns_of(const double footprint[2]) {
  int columns = 4;
  while (columns < 16 && footprint[0] / columns > footprint[1] / 2)
    columns *= 2;
  while (columns > 1 && footprint[0] / columns < footprint[1] / 8)
    columns /= 2;
  return columns;
}

unsigned shade_ref_cloth_points(const shade_ref_cloth *c, const double uv[2],
                                const double footprint[2], const double n[3], const double wi[3],
                                const double wo[3], double s[3]) {
  if (!(footprint[0] > 0 || footprint[1] > 0))
    return shade_ref_cloth_near(c, uv, n, wi, wo, s);
  const int columns = columns_of(footprint), rows = 16 / columns;
  unsigned status = SHADE_OK;
  s[0] = s[1] = s[2] = 0;
  for (int k = 0; k < 16; k++) {
    const double at[2] = {uv[0] + footprint[0] * ((k % columns + 0.5) / columns - 0.5),
                          uv[1] + footprint[1] * ((k / columns + 0.5) / rows - 0.5)};
    double one[3];
    status |= shade_ref_cloth_near(c, at, n, wi, wo, one);
    for (int i = 0; i < 3; i++)
      s[i] += one[i] / 16;
  }
  return status;
}

unsigned shade_ref_cloth_mean(const shade_ref_cloth *c, const double uv[2],
                              const double footprint[2], int points, const double n[3],
                              const double wi[3], const double wo[3], double s[3],
                              double error[3]) {
  unsigned status = SHADE_OK;
  real sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
  for (int k = 0; k < points; k++) {
    /* the same part of the draft in any of its repeats: noise goes on */
    const double across = c->draft->ends * (double)(k * 7919L % 65537 - 32768);
    const double up = c->draft->picks * (double)(k * 6007L % 65537 - 32768);
    const double at[2] = {
        uv[0] + across + fmin(footprint[0], 65536) * (fmod(0.5 + k * 0.7548776662466927, 1) - 0.5),
        uv[1] + up + fmin(footprint[1], 65536) * (fmod(0.5 + k * 0.5698402909980532, 1) - 0.5)};
    double one[3];
    status |= shade_ref_cloth_near(c, at, n, wi, wo, one);
    for (int i = 0; i < 3; i++) {
      sum[i] += one[i] / (real)points;
      squares[i] += square(one[i]) / points;
    }
  }
  for (int i = 0; i < 3; i++) {
    real variance = squares[i] - square(sum[i]);
    s[i] = (double)sum[i];
    error[i] = variance > 0 ? (double)sqrtl(variance / points) : 0;
  }
  return status;
}
