/* SPDX-License-Identifier: Apache-2.0 */
/* The cloth over a footprint: the mean of the near model over points of it. */
#include "cloth_model.h"

#include <stdint.h>
#include <string.h>

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

/* [0, 1), from a counter that goes on by an odd constant, mixed (splitmix64). */
static double next_random(uint64_t *counter) {
  uint64_t x = *counter += UINT64_C(0x9e3779b97f4a7c15);
  x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
  return (double)((x ^ x >> 31) >> 11) / 9007199254740992.0;
}

/*
 * One point in each cell of a square grid, wherever in it, and those that are left anywhere. Any
 * sequence that is spread more evenly has steps that some footprint makes whole crossings.
 */
unsigned shade_ref_cloth_mean(const shade_ref_cloth *c, const double uv[2],
                              const double footprint[2], int points, const double n[3],
                              const double wi[3], const double wo[3], double s[3],
                              double error[3]) {
  const int side = (int)sqrt(points);
  unsigned status = SHADE_OK;
  real sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0};
  uint64_t place[2];
  memcpy(place, uv, sizeof place);
  uint64_t counter = place[0] ^ place[1] * 3;
  for (int k = 0; k < points; k++) {
    const int in_cell = k < side * side;
    double at[2], one[3];
    for (int a = 0; a < 2; a++) {
      const double r = next_random(&counter);
      const double part = in_cell ? ((a ? k / side : k % side) + r) / side : r;
      at[a] = uv[a] + fmin(footprint[a], 65536) * (part - 0.5);
    }
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
