/* SPDX-License-Identifier: Apache-2.0 */
/* Directional albedo of a cloth from afar: a table over the eye's direction. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "../model/fabric.h"

enum { ELEVATIONS = 20, AZIMUTHS = 32, RINGS = 48, SPOKES = 96, LIGHTS = 2 * RINGS * SPOKES };

/* wo.z = (row/(ELEVATIONS - 1))^2, but LEAST in row 0, so that nodes lie close where it grazes. */
#define LEAST 1e-3
#define TURN 6.28318530717958647693

struct shade_fabric_albedo {
  double rgb[ELEVATIONS][AZIMUTHS][3];
};

typedef struct room {
  float in[7][LIGHTS], wi[3][LIGHTS], rgb[3][LIGHTS];
} room;

/* Lights in cells of equal solid angle, from above first. */
static void set_lights(room *r) {
  for (int i = 0; i < LIGHTS; i++) {
    const int k = i % (RINGS * SPOKES);
    const double z = (k / SPOKES + 0.5) / RINGS, side = sqrt(1 - z * z);
    const double turn = TURN * (k % SPOKES + 0.5 * (k / SPOKES % 2)) / SPOKES;
    r->wi[0][i] = (float)(side * cos(turn));
    r->wi[1][i] = (float)(side * sin(turn));
    r->wi[2][i] = (float)(i < RINGS * SPOKES ? z : -z);
    r->in[0][i] = r->in[1][i] = 0;
    r->in[2][i] = r->in[3][i] = 1e9f;
  }
}

/* The integral of s over the lights that reach wo. */
static void measure(const shade_fabric *f, const double wo[3], room *r, double rgb[3]) {
  const size_t count = f->transmits ? LIGHTS : LIGHTS / 2;
  const shade_fabric_lanesf in = {.size = sizeof in,
                                  .u = r->in[0],
                                  .v = r->in[1],
                                  .du = r->in[2],
                                  .dv = r->in[3],
                                  .wix = r->wi[0],
                                  .wiy = r->wi[1],
                                  .wiz = r->wi[2],
                                  .wox = r->in[4],
                                  .woy = r->in[5],
                                  .woz = r->in[6]};
  const shade_fabric_resultf out = {
      .size = sizeof out, .r = r->rgb[0], .g = r->rgb[1], .b = r->rgb[2]};
  for (int a = 0; a < 3; a++)
    for (size_t i = 0; i < count; i++)
      r->in[4 + a][i] = (float)wo[a];
  shade_fabric_eval_batchf(f, count, &in, SHADE_TIER_FAR, &out);
  for (int a = 0; a < 3; a++) {
    rgb[a] = 0;
    for (size_t i = 0; i < count; i++)
      rgb[a] += (double)r->rgb[a][i] * TURN / (RINGS * SPOKES);
  }
}

shade_fabric_albedo *shade_fabric_albedo_create(const shade_fabric *f) {
  shade_fabric_albedo *table = f ? malloc(sizeof *table) : NULL;
  room *r = malloc(sizeof *r);
  if (!table || !r) {
    free(table);
    free(r);
    return NULL;
  }
  set_lights(r);
  for (int i = 0; i < ELEVATIONS; i++)
    for (int j = 0; j < AZIMUTHS; j++) {
      const double t = (double)i / (ELEVATIONS - 1), z = fmax(t * t, LEAST), side = sqrt(1 - z * z);
      const double wo[3] = {side * cos(TURN * j / AZIMUTHS), side * sin(TURN * j / AZIMUTHS), z};
      if (i + 1 < ELEVATIONS || j == 0)
        measure(f, wo, r, table->rgb[i][j]);
      else /* all azimuths are one at the pole */
        memcpy(table->rgb[i][j], table->rgb[i][0], sizeof table->rgb[i][j]);
    }
  free(r);
  return table;
}

void shade_fabric_albedo_free(shade_fabric_albedo *table) {
  free(table);
}

/* wo of length 1, if it has a direction. */
static bool set_length(const double wo[3], double out[3]) {
  const double size = hypot(hypot(wo[0], wo[1]), wo[2]);
  for (int a = 0; a < 3; a++)
    out[a] = wo[a] / size;
  return isfinite(size) && size > 0;
}

unsigned shade_fabric_albedo_eval(const shade_fabric_albedo *table, const double wo[3],
                                  double rgb[3]) {
  double unit[3];
  memset(rgb, 0, 3 * sizeof *rgb);
  if (!set_length(wo, unit))
    return SHADE_BAD_INPUT;
  if (!(unit[2] > 0))
    return SHADE_OK;
  const double row = sqrt(fmin(unit[2], 1)) * (ELEVATIONS - 1);
  double turn = atan2(unit[1], unit[0]) / TURN;
  turn = (turn - floor(turn)) * AZIMUTHS;
  const int i = (int)fmin(row, ELEVATIONS - 2), j = (int)fmin(turn, AZIMUTHS - 1);
  const double a = row - i, b = turn - j;
  for (int c = 0; c < 3; c++) {
    const double(*low)[3] = table->rgb[i], (*high)[3] = table->rgb[i + 1];
    const int next = (j + 1) % AZIMUTHS;
    rgb[c] = (1 - a) * ((1 - b) * low[j][c] + b * low[next][c]) +
             a * ((1 - b) * high[j][c] + b * high[next][c]);
  }
  return SHADE_OK;
}

unsigned shade_fabric_albedo_towards(const shade_fabric *f, const double wo[3], double rgb[3]) {
  double unit[3];
  room *r = malloc(sizeof *r);
  const bool good = r && f && set_length(wo, unit);
  memset(rgb, 0, 3 * sizeof *rgb);
  if (good && unit[2] > 0) {
    set_lights(r);
    measure(f, unit, r, rgb);
  }
  free(r);
  return good ? SHADE_OK : SHADE_BAD_INPUT;
}
