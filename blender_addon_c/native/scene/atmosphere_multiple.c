/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Light at four wavelengths (630, 560, 490, 430 nm), with a fit of what is scattered more than once
 * and of what the ground gives back [GarciaLinan2024]; the constants are those of Earth and the air
 * of a city, as in Blender 5.0. Lengths are in km.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/atmosphere.h"
#include "system/parallel.h"

enum { WAVES = 4, STEPS = 64, COLUMNS = ATMOSPHERE_HALF };
enum { ANGLES = 256, HEIGHTS = 64 }; /* of the table */

static const double EARTH = 6371, HIGH = 100;
static const double SUN[WAVES] = {1.679, 1.828, 1.986, 1.307}; /* W/(m² nm) */
static const double AIR[WAVES] = {6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2};
static const double OZONE[WAVES] = {3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27};
static const double DUST_STOPS[WAVES] = {2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23};
static const double DUST_SCATTERS[WAVES] = {1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22};
static const double DUST_G = 0.8, GROUND = 0.3;
static const double AGAIN[WAVES] = {0.217, 0.347, 0.594,
                                    1}; /* light scattered again, at the ground */
static const double XYZ[WAVES][3] = {{53.386917738564668, 22.981337506691025, 0},
                                     {43.904844466369358, 71.347795700053394, 0.10250686796574131},
                                     {1.6137278251608962, 18.422960591455485, 31.742921188390806},
                                     {20.762668673810577, 2.3614213523314369, 110.48009643252140}};

/* What passes from a height to the sun, by the cosine of its angle and by height. */
struct multiple_table {
  float passes[HEIGHTS][ANGLES][WAVES];
};

/* 1/km: what air and dust scatter, and all that light loses. */
typedef struct matter {
  double air[WAVES], dust[WAVES], loses[WAVES];
} matter;

static matter matter_at(const atmosphere *a, double height) {
  matter m;
  double thin = exp(-0.07771971 * pow(height, 1.16364243)), log_h = log(fmax(height, 1e-4));
  double tent = exp(-(log_h - 3.22261) * (log_h - 3.22261) * 5.55555555 - log_h);
  double dust = 1.3681e20 * exp(-height / 0.73) + 2e6;
  for (int w = 0; w < WAVES; w++) {
    m.air[w] = AIR[w] * thin * (double)a->air;
    m.dust[w] = DUST_SCATTERS[w] * dust * (double)a->dust;
    m.loses[w] = m.air[w] + m.dust[w] + DUST_STOPS[w] * dust * (double)a->dust +
                 OZONE[w] * 334.5 * 3.78547397e20 * tent * (double)a->ozone;
  }
  return m;
}

/* From radius r, where `up` is the cosine of the way, to a sphere: < 0 where it is not met. */
static double way_to(double r, double up, double sphere) {
  double b = r * up, c = (r - sphere) * (r + sphere), d = b * b - c;
  if ((c > 0 && b > 0) || d < 0)
    return -1;
  return c <= 0 ? sqrt(d) - b : -b - sqrt(d);
}

static double height_after(double r, double up, double t) {
  double far = sqrt(r * r + t * (2 * r * up + t)) - EARTH;
  return far > 0 ? far : 0;
}

static void passes_to_sun(const atmosphere *a, double up, double height, double out[WAVES]) {
  double r = EARTH + height, step = way_to(r, up, EARTH + HIGH) / STEPS, depth[WAVES] = {0};
  for (int i = 0; i < STEPS; i++) {
    matter m = matter_at(a, height_after(r, up, (i + 0.5) * step));
    for (int w = 0; w < WAVES; w++)
      depth[w] += m.loses[w] * step;
  }
  for (int w = 0; w < WAVES; w++)
    out[w] = exp(-depth[w]);
}

static void fill_height(void *context, size_t line) {
  const atmosphere *a = context;
  for (int k = 0; k < ANGLES; k++) {
    double out[WAVES];
    passes_to_sun(a, 2.0 * k / (ANGLES - 1) - 1, HIGH * (double)line / (HEIGHTS - 1), out);
    for (int w = 0; w < WAVES; w++)
      a->table->passes[line][k][w] = (float)out[w];
  }
}

bool multiple_prepare(atmosphere *a, int threads) {
  a->table = malloc(sizeof *a->table);
  if (a->table)
    parallel_for(threads, HEIGHTS, fill_height, a);
  return a->table;
}

/* Between the table's angles, at one of its heights. */
static void at_angle(const struct multiple_table *t, int line, double up, double out[WAVES]) {
  double x = (ANGLES - 1) * fmin(fmax(0.5 * up + 0.5, 0), 1);
  int one = (int)x, two = one < ANGLES - 1 ? one + 1 : one;
  for (int w = 0; w < WAVES; w++) {
    double a = (double)t->passes[line][one][w], b = (double)t->passes[line][two][w];
    out[w] = a + (x - one) * (b - a);
  }
}

static void looked_up(const struct multiple_table *t, double up, double height, double out[WAVES]) {
  double y = (HEIGHTS - 1) * fmin(fmax(height / HIGH, 0), 1), above[WAVES];
  int one = (int)y, two = one < HEIGHTS - 1 ? one + 1 : one;
  at_angle(t, one, up, out);
  at_angle(t, two, up, above);
  for (int w = 0; w < WAVES; w++)
    out[w] += (y - one) * (above[w] - out[w]);
}

/* What comes to a point from elsewhere than the sun, over what the sun gives outside. */
static void light_around(const struct multiple_table *t, double up, double height,
                         double out[WAVES]) {
  const double pi = 3.141592653589793;
  double near = EARTH / (EARTH + height), at_ground[WAVES], low[WAVES], here[WAVES];
  double part = 0.5 * (1 - sqrt(1 - near * near)); /* of all directions, those to the ground */
  at_angle(t, 0, up, at_ground);
  looked_up(t, 1, 0, low);
  looked_up(t, 1, height, here);
  double day = 0.02 / (1 + 5 * exp(-17.92 * up));
  for (int w = 0; w < WAVES; w++)
    out[w] = AGAIN[w] * day + part * GROUND / pi * at_ground[w] * low[w] / here[w] * up;
}

static double phase_air(double mu) {
  return 3.0 / (16 * 3.141592653589793) * (1 + mu * mu);
}

/* [HenyeyGreenstein1941] */
static double phase_dust(double mu) {
  double base = 1 + DUST_G * DUST_G - 2 * DUST_G * mu;
  return (1 - DUST_G * DUST_G) / (4 * 3.141592653589793 * base * sqrt(base));
}

static double eye_height(const atmosphere *a) {
  return 1e-3 * fmin(fmax((double)a->altitude, 1), 99999);
}

static void one_way(const atmosphere *a, double r, double rise, double far, double turn,
                    const matter step[STEPS], double out[WAVES]) {
  double sun = (double)a->elevation;
  double mu = cos(rise) * cos(turn) * cos(sun) + sin(rise) * sin(sun);
  double by_air = phase_air(mu), by_dust = phase_dust(mu), dt = far / STEPS;
  double left[WAVES] = {1, 1, 1, 1};
  memset(out, 0, WAVES * sizeof *out);
  for (int i = 0; i < STEPS; i++) {
    double t = (i + 0.5) * dt, height = height_after(r, sin(rise), t);
    double up = (r * sin(sun) + t * mu) / sqrt(r * r + t * (2 * r * sin(rise) + t));
    double direct[WAVES], around[WAVES];
    looked_up(a->table, up, height, direct);
    light_around(a->table, up, height, around);
    for (int w = 0; w < WAVES; w++) {
      double lit = SUN[w] * (step[i].air[w] * (by_air * direct[w] + around[w]) +
                             step[i].dust[w] * (by_dust * direct[w] + around[w]));
      double loses = step[i].loses[w], passes = exp(-dt * loses);
      out[w] += left[w] * lit * (1 - passes) / fmax(loses, 1e-7);
      left[w] *= passes;
    }
  }
}

void multiple_row(const atmosphere *a, int row, atmosphere_half out) {
  const double right = 1.5707963267948966;
  double part = (row + 0.5) / ATMOSPHERE_HORIZON - 1, rise = right * part * fabs(part);
  double r = EARTH + eye_height(a), ground = way_to(r, sin(rise), EARTH);
  double far = ground < 0 ? way_to(r, sin(rise), EARTH + HIGH) : ground;
  matter step[STEPS];
  for (int i = 0; i < STEPS; i++)
    step[i] = matter_at(a, height_after(r, sin(rise), (i + 0.5) * far / STEPS));
  for (int i = 0; i < COLUMNS; i++) {
    double waves[WAVES];
    one_way(a, r, rise, far, right * (2 - (2.0 * i + 1) / COLUMNS), step, waves);
    for (int k = 0; k < 3; k++) {
      double sum = 0;
      for (int w = 0; w < WAVES; w++)
        sum += XYZ[w][k] * waves[w];
      out[k][i] = (float)sum;
    }
  }
}

void multiple_sun(const atmosphere *a, double elevation, double xyz[3]) {
  double passes[WAVES];
  passes_to_sun(a, sin(elevation), eye_height(a), passes);
  for (int k = 0; k < 3; k++) {
    xyz[k] = 0;
    for (int w = 0; w < WAVES; w++)
      xyz[k] += XYZ[w][k] * SUN[w] * passes[w];
  }
}

double multiple_dip(const atmosphere *a) {
  return acos(EARTH / (EARTH + 1e-3 * (double)a->altitude));
}
