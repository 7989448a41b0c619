/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Light that air and dust scatter once on its way from the sun, at 21 wavelengths [Nishita1993].
 * Air thins out by height as exp(-h / 8 km), dust as exp(-h / 1.2 km), ozone is a tent about 25 km.
 * Lengths are in km.
 */
#include <math.h>
#include <string.h>

#include "batch/leaf.h"
#include "scene/atmosphere.h"

enum { WAVES = 21, STEPS = 32, COLUMNS = ATMOSPHERE_HALF };

static const double EARTH = 6360, EDGE = 6420; /* radii */
static const double FIRST_WAVE = 380, WAVE_STEP = 20;
static const double DUST_SCATTERS = 2e-2, DUST_STOPS = 1.11 * 2e-2; /* 1/km */
static const double DUST_G = 0.76;
static const float LOG2_E = 1.44269504f;

/* Absorption by ozone, 1/km: its cross sections times its density, as in Blender. */
static const double OZONE_STOPS[WAVES] = {
    3.25126849861e-6, 5.85395365047e-6, 1.97719115509e-5, 7.30956876291e-5, 2.00845615143e-4,
    4.03839580962e-4, 6.35513359124e-4, 9.67070411810e-4, 1.54797400424e-3, 2.09038647223e-3,
    2.46128056165e-3, 2.73551299462e-3, 2.15125863129e-3, 1.59051840792e-3, 1.12356197980e-3,
    7.35275514876e-4, 4.64501303578e-4, 3.30960799210e-4, 2.25126122927e-4, 1.48791292665e-4,
    1.68286233642e-4};

/* The standard observer of 1931 [CIE15]. */
static const double OBSERVER[WAVES][3] = {
    {0.001368, 0.000039, 0.006450}, {0.014310, 0.000396, 0.067850}, {0.134380, 0.004000, 0.645600},
    {0.348280, 0.023000, 1.747060}, {0.290800, 0.060000, 1.669200}, {0.095640, 0.139020, 0.812950},
    {0.004900, 0.323000, 0.272000}, {0.063270, 0.710000, 0.078250}, {0.290400, 0.954000, 0.020300},
    {0.594500, 0.995000, 0.003900}, {0.916300, 0.870000, 0.001650}, {1.062200, 0.631000, 0.000800},
    {0.854450, 0.381000, 0.000190}, {0.447900, 0.175000, 0.000020}, {0.164900, 0.061000, 0},
    {0.046770, 0.017000, 0},        {0.011359, 0.004102, 0},        {0.002899, 0.001047, 0},
    {0.000690, 0.000249, 0},        {0.000166, 0.000060, 0},        {0.0000415, 0.000015, 0}};

/* Gauss and Laguerre's points over 25, and their weights times e^x over 25. As an array they would
 * keep clang from working for many columns at once. */
#define POINTS(POINT)                                                                              \
  POINT(0.006811185292, 0.01750893642)                                                             \
  POINT(0.03614807107, 0.04135477391)                                                              \
  POINT(0.09004346519, 0.06678839063)                                                              \
  POINT(0.1706680068, 0.09507698807)                                                               \
  POINT(0.2818362161, 0.1283416365)                                                                \
  POINT(0.4303406404, 0.1707430204)                                                                \
  POINT(0.6296271457, 0.2327233347)                                                                \
  POINT(0.9145252695, 0.3562490486)

/* By wavelength: the sun's light, W/(m² nm), a black body of 5778 K; what air scatters, 1/km; and
 * what stops light for each part. */
typedef struct spectrum {
  double sun[WAVES], air[WAVES];
  float stops[WAVES][3]; /* air, dust, ozone */
} spectrum;

static spectrum spectrum_make(void) {
  spectrum s;
  for (int k = 0; k < WAVES; k++) {
    double nm = FIRST_WAVE + WAVE_STEP * k, um = 1e-3 * nm;
    s.sun[k] = 6.79017e-5 * 1.191042972e20 / pow(nm, 5) / expm1(14387768.77 / (nm * 5778));
    s.air[k] = 1.1311425e-3 / (um * um * um * um);
    s.stops[k][0] = (float)s.air[k];
    s.stops[k][1] = (float)DUST_STOPS;
    s.stops[k][2] = (float)OZONE_STOPS[k];
  }
  return s;
}

/* How much there is of each part, or was on a way. */
typedef struct parts {
  float air, dust, ozone;
} parts;

LEAF parts density(float height) {
  float tent = 1.0f - fabsf(height - 25.0f) * (1.0f / 15.0f);
  return (parts){.air = exponential2(height * (-LOG2_E / 8.0f)),
                 .dust = exponential2(height * (-LOG2_E / 1.2f)),
                 .ozone = tent > 0.0f ? tent : 0.0f};
}

LEAF parts sum(parts a, float by, parts b) {
  return (parts){a.air + by * b.air, a.dust + by * b.dust, a.ozone + by * b.ozone};
}

/* From height h, whose radius times the cosine of the way up is b, to the atmosphere's edge: the
 * way, and what is on it. Heights are differences of squares, which floats can hold. */
LEAF float way_out(float h, float b) {
  const float earth = (float)EARTH, edge = (float)EDGE;
  return sqrtf(b * b + (edge - earth - h) * (edge + earth + h)) - b;
}

LEAF parts depth_at(float h, float b, float t, float weight, parts so_far) {
  const float earth = (float)EARTH;
  float over = h * (2.0f * earth + h) + t * (2.0f * b + t);
  return sum(so_far, weight, density(over / (earth + sqrtf(earth * earth + over))));
}

LEAF parts depth_out(float h, float b) {
  float far = way_out(h, b);
  parts all = {0, 0, 0};
#define POINT(t, weight) all = depth_at(h, b, (float)t * far, (float)weight * far, all);
  POINTS(POINT)
#undef POINT
  return all;
}

static float phase_air(float mu) {
  return 3.0f / (16.0f * 3.14159265f) * (1.0f + mu * mu);
}

/* Of Cornette and Shanks. */
static float phase_dust(float mu) {
  const float g = (float)DUST_G, g2 = g * g, base = 1.0f + g2 - 2.0f * g * mu;
  return 3.0f * (1.0f - g2) * (1.0f + mu * mu) /
         (8.0f * 3.14159265f * (2.0f + g2) * base * sqrtf(base));
}

/* One step of the way through the atmosphere, for all columns: what is added to each wavelength. */
typedef struct single_step {
  float height, length, far; /* of the step's middle; the step; from the eye */
  float eye, up;             /* the eye's radius; z of the way to the sun */
  parts there, before;       /* what there is, and was on the way from the eye, */
  parts amount;              /* so many times as much as usual */
} single_step;

static void add_step(const single_step *s, const spectrum *by, const float mu[COLUMNS],
                     const float air[COLUMNS], const float dust[COLUMNS],
                     float out[WAVES][COLUMNS]) {
  const single_step own = *s;
  float by_air[COLUMNS], by_dust[COLUMNS], by_ozone[COLUMNS], lit[COLUMNS];
#pragma omp simd
  for (int i = 0; i < COLUMNS; i++) {
    float b = own.eye * own.up + own.far * mu[i];
    parts depth = depth_out(own.height, b);
    by_air[i] = own.before.air + own.amount.air * depth.air;
    by_dust[i] = own.before.dust + own.amount.dust * depth.dust;
    by_ozone[i] = own.before.ozone + own.amount.ozone * depth.ozone;
    /* does the Earth stop the sun's light? */
    float clear = own.height * (2.0f * (float)EARTH + own.height) - b * b;
    bool seen = (own.up >= 0.0f) | (clear > 0.0f);
    lit[i] = seen ? own.length : 0.0f;
  }
  for (int w = 0; w < WAVES; w++) {
    const float a = by->stops[w][0], d = by->stops[w][1], o = by->stops[w][2];
    const float from_air = (float)by->air[w] * own.there.air;
    const float from_dust = (float)DUST_SCATTERS * own.there.dust;
#pragma omp simd
    for (int i = 0; i < COLUMNS; i++) {
      float passes = exponential2(-LOG2_E * (a * by_air[i] + d * by_dust[i] + o * by_ozone[i]));
      float more = lit[i] * passes * (from_air * air[i] + from_dust * dust[i]);
      out[w][i] += lit[i] > 0.0f ? more : 0.0f; /* below the ground depths may be no numbers */
    }
  }
}

/* Column i is looked up half a texel beside where it is worked out, and so are rows, as in Blender.
 */
void single_row(const atmosphere *a, int row, atmosphere_half out) {
  const double right = 1.5707963267948966;
  double part = (double)(row - ATMOSPHERE_HORIZON) / ATMOSPHERE_HORIZON;
  double rise = right * (a->later ? 1 : 257.0 / 256) * part * part, sun = (double)a->elevation;
  const spectrum by = spectrum_make();
  float mu[COLUMNS], air[COLUMNS], dust[COLUMNS], waves[WAVES][COLUMNS];
  for (int i = 0; i < COLUMNS; i++) {
    double turn = right * (2 - 2.0 * i / COLUMNS);
    mu[i] = (float)(cos(rise) * cos(turn) * cos(sun) + sin(rise) * sin(sun));
    air[i] = phase_air(mu[i]);
    dust[i] = phase_dust(mu[i]);
  }
  memset(waves, 0, sizeof waves);
  double h = 1e-3 * fmin(fmax((double)a->altitude, 1), 59999), eye = EARTH + h;
  double up = eye * sin(rise);
  single_step s = {.eye = (float)eye,
                   .up = (float)sin(sun),
                   .amount = {a->air, a->dust, a->ozone},
                   .length = way_out((float)h, (float)up) / STEPS};
  for (int i = 0; i < STEPS; i++) {
    double t = (i + 0.5) * (double)s.length, over = h * (2 * EARTH + h) + t * (2 * up + t);
    s.far = (float)t;
    s.height = (float)(over / (EARTH + sqrt(EARTH * EARTH + over)));
    parts there = density(s.height);
    s.there = (parts){there.air * a->air, there.dust * a->dust, there.ozone * a->ozone};
    s.before = sum(s.before, s.length, s.there);
    add_step(&s, &by, mu, air, dust, waves);
  }
  memset(out, 0, sizeof(atmosphere_half));
  for (int w = 0; w < WAVES; w++)
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < COLUMNS; i++)
        out[k][i] += (float)(WAVE_STEP * by.sun[w] * OBSERVER[w][k]) * waves[w][i];
}

void single_sun(const atmosphere *a, double elevation, double xyz[3]) {
  const spectrum by = spectrum_make();
  double h = 1e-3 * fmin(fmax((double)a->altitude, 1), 59999);
  parts depth = depth_out((float)h, (float)((EARTH + h) * sin(elevation)));
  xyz[0] = xyz[1] = xyz[2] = 0;
  for (int w = 0; w < WAVES; w++) /* without ozone, as there */
    for (int k = 0; k < 3; k++)
      xyz[k] += WAVE_STEP * by.sun[w] * OBSERVER[w][k] *
                exp(-(double)(by.stops[w][0] * a->air * depth.air +
                              by.stops[w][1] * a->dust * depth.dust));
}
