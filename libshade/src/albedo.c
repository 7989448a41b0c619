/* SPDX-License-Identifier: Apache-2.0 */
/* Directional albedos: a table over wo, by quadrature of the library's own BRDF. */
#include "shade/albedo.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "src/params.h"
#include "../model/mdf.h"
#include "../model/methods.h"
#include "../batch/arrays.h"

#define PI 3.14159265358979323846

/*
 * wo.z = t^2 at ring t (RINGS - 1): closest where it grazes; spoke s has its x and y as 1 - s to
 * s, from x to y in one quarter, of which the others are mirrors.
 */
enum { RINGS = 32, SPOKES = 9 };
#define LEAST 0.02 /* t of the first ring */

enum { SPECULAR, DIFFUSE, PARTS };

struct shade_bsdf_albedo {
  int spokes, groove_y;
  float rgb[SPOKES][RINGS][PARTS][3];
};

static void direction(int spoke, int ring, float wo[3]) {
  const double t = fmax((double)ring / (RINGS - 1), LEAST), z = t * t;
  const double s = (double)spoke / (SPOKES - 1), length = hypot(1 - s, s);
  const double across = sqrt(fmax(1 - z * z, 0)) / length;
  wo[0] = (float)(across * (1 - s));
  wo[1] = (float)(across * s);
  wo[2] = (float)z;
}

/* ---- making it ------------------------------------------------------------------------------- */

/* Half vectors a side; directions a side, twice as many round. */
enum { HALVES = 56, GRID = 16, ROOM = HALVES * HALVES, LANES = 8 };
_Static_assert(ROOM % LANES == 0, "specular_of sums so many at a time");

typedef struct work {
  float in[9][ROOM], out[4][ROOM];
  float h[4][ROOM]; /* half vectors, and 4 dh */
} work;

/* Half vectors over the slopes, in units of the lobe: slope alpha r, r = s/(1 - s), covers all. */
static void lay_halves(work *w, double ax, double ay) {
  for (int i = 0; i < ROOM; i++) {
    const double s = (i / HALVES + 0.5) / HALVES, phi = 2 * PI * (i % HALVES + 0.5) / HALVES;
    const double r = s / (1 - s), dr = 1 / ((1 - s) * (1 - s)) / HALVES;
    const double x = ax * r * cos(phi), y = ay * r * sin(phi), z = 1 / sqrt(1 + x * x + y * y);
    w->h[0][i] = (float)(x * z);
    w->h[1][i] = (float)(y * z);
    w->h[2][i] = (float)z;
    w->h[3][i] = (float)(4 * z * z * z * ax * ay * r * dr * 2 * PI / HALVES);
  }
}

static void fill(float *array, size_t count, float value) {
  for (size_t i = 0; i < count; i++)
    array[i] = value;
}

/* f and the cosine of the first `count` wi; n are laid already. */
static void evaluate(work *w, const shade_bsdf *b, size_t count, const float wo[3]) {
  for (int c = 0; c < 3; c++)
    fill(w->in[6 + c], count, wo[c]);
  shade_lanesf in;
  memset(&in, 0, sizeof in);
  in.size = sizeof in;
  const float **const arrays[9] = {&in.nx,  &in.ny,  &in.nz,  &in.wix, &in.wiy,
                                   &in.wiz, &in.wox, &in.woy, &in.woz};
  for (int k = 0; k < 9; k++)
    *arrays[k] = w->in[k];
  const shade_resultf out = {sizeof out, w->out[0], w->out[1], w->out[2], w->out[3]};
  shade_bsdf_eval_batchf(b, count, &in, &out);
}

/* The integral of f cos over half vectors: dwi = 4 (h.wo) dh. */
static void specular_of(work *w, const shade_bsdf *b, const float wo[3], float rgb[3]) {
  const float *const x = w->h[0], *const y = w->h[1], *const z = w->h[2];
  const float vx = wo[0], vy = wo[1], vz = wo[2];
  float d[ROOM], weight[ROOM];
  for (int i = 0; i < ROOM; i++)
    d[i] = x[i] * vx + y[i] * vy + z[i] * vz;
  for (int i = 0; i < ROOM; i++)
    weight[i] = (d[i] > 0 ? d[i] : 0) * w->h[3][i];
  for (int c = 0; c < 3; c++) {
    const float v = wo[c];
    for (int i = 0; i < ROOM; i++)
      w->in[3 + c][i] = 2 * d[i] * w->h[c][i] - v;
  }
  evaluate(w, b, ROOM, wo);
  for (int i = 0; i < ROOM; i++)
    weight[i] *= w->out[3][i];
  for (int c = 0; c < 3; c++) {
    double sum[LANES] = {0}; /* side by side: one after the other each would wait for the last */
    for (int i = 0; i < ROOM; i += LANES)
      for (int k = 0; k < LANES; k++)
        sum[k] += (double)(weight[i + k] * w->out[c][i + k]);
    for (int k = 1; k < LANES; k++)
      sum[0] += sum[k];
    rgb[c] = (float)sum[0];
  }
}

/* The same over an even grid of wi, of one channel. */
static double diffuse_of(work *w, const shade_bsdf *b, const float wo[3]) {
  const int count = 2 * GRID * GRID;
  for (int i = 0; i < count; i++) {
    const double z = (i / (2 * GRID) + 0.5) / GRID, phi = PI * (i % (2 * GRID) + 0.5) / GRID;
    const double across = sqrt(1 - z * z);
    w->in[3][i] = (float)(across * cos(phi));
    w->in[4][i] = (float)(across * sin(phi));
    w->in[5][i] = (float)z;
  }
  evaluate(w, b, (size_t)count, wo);
  double sum = 0;
  for (int i = 0; i < count; i++)
    sum += (double)(w->out[0][i] * w->out[3][i]);
  return sum * PI / (GRID * GRID);
}

shade_bsdf_albedo *shade_bsdf_albedo_create(const shade_params *given, unsigned *status) {
  unsigned found = SHADE_OK;
  const shade_params p = shade_params_within_ranges(given, &found);
  if (status)
    *status = found;
  shade_bsdf_albedo *a = calloc(1, sizeof *a);
  work *w = malloc(sizeof *w);
  if (!a || !w) {
    free(a);
    free(w);
    return NULL;
  }
  const int exponents = shade_mdf_reads_exponents(p.mdf);
  const double x = exponents ? p.ey : p.ax, y = exponents ? p.ex : p.ay;
  const int plain = p.diffuse == SHADE_DIFFUSE_LAMBERT;
  const int of_wo = shade_diffuse_is(p.diffuse).sees;
  a->spokes = x == y && !of_wo ? 1 : SPOKES;
  a->groove_y = p.groove == SHADE_GROOVE_Y || (p.groove != SHADE_GROOVE_X && y < x);

  shade_params lobe = p, matt = p;
  double kd[3];
  lobe.detail = matt.detail = SHADE_DETAIL_NONE; /* the groove stays: fibres run along it */
  lobe.horizon = matt.horizon = SHADE_HORIZON_HARD;
  matt.fresnel = SHADE_FRESNEL_NONE;
  for (int c = 0; c < 3; c++) {
    /* Ashikhmin and Shirley give the diffuse part what f0 leaves */
    kd[c] = p.kd[c] * (p.diffuse == SHADE_DIFFUSE_ASHIKHMIN_SHIRLEY ? 1 - p.f0[c] : 1);
    lobe.kd[c] = 0;
    matt.f0[c] = 0;
    matt.kd[c] = 1;
  }
  shade_bsdf specular, diffuse;
  shade_bsdf_setup(&specular, &lobe);
  shade_bsdf_setup(&diffuse, &matt);
  lay_halves(w, p.ax, p.ay);
  for (int c = 0; c < 3; c++)
    fill(w->in[c], ROOM, c == 2);
  const int has_diffuse = kd[0] > 0 || kd[1] > 0 || kd[2] > 0;
  double same = plain ? 1 : -1; /* where it does not depend on wo */
  for (int s = 0; s < a->spokes; s++)
    for (int r = 0; r < RINGS; r++) {
      float wo[3];
      direction(s, r, wo);
      specular_of(w, &specular, wo, a->rgb[s][r][SPECULAR]);
      const double part = !has_diffuse ? 0 : of_wo || same < 0 ? diffuse_of(w, &diffuse, wo) : same;
      same = of_wo || !has_diffuse ? same : part;
      for (int c = 0; c < 3; c++)
        a->rgb[s][r][DIFFUSE][c] = (float)(kd[c] * part);
    }
  free(w);
  return a;
}

void shade_bsdf_albedo_free(shade_bsdf_albedo *a) {
  free(a);
}

/* ---- looking it up ----------------------------------------------------------------------------
 */

/* Unit, and its length's status. What is unit already, nearly all, stays as it is. */
static inline unsigned make_unit(const double in[3], double out[3]) {
  const double square = in[0] * in[0] + in[1] * in[1] + in[2] * in[2];
  if (fabs(square - 1) < 1e-14) {
    memcpy(out, in, 3 * sizeof *out);
    return SHADE_OK;
  }
  const double most = fmax(fabs(in[0]), fmax(fabs(in[1]), fabs(in[2])));
  if (!isfinite(in[0]) || !isfinite(in[1]) || !isfinite(in[2]) || !(most > 0))
    return SHADE_BAD_INPUT;
  const double x = in[0] / most, y = in[1] / most, z = in[2] / most;
  const double length = sqrt(x * x + y * y + z * z);
  out[0] = x / length;
  out[1] = y / length;
  out[2] = z / length;
  return SHADE_OK;
}

/* wo in the frame of the displaced surface whose normal is n. */
static inline void carry(const double n[3], int groove_y, double wo[3]) {
  /* along the axis of the grooves, and along the other */
  const double nx = groove_y ? n[1] : n[0], ny = groove_y ? n[0] : n[1], nz = n[2];
  double x = groove_y ? wo[1] : wo[0], y = groove_y ? wo[0] : wo[1];
  const double square = nx * nx + nz * nz, slanted = nx * x + nz * wo[2];
  if (square > 0) {
    const double inverse = 1 / sqrt(square);
    x = (nz * x - nx * wo[2]) * inverse;
    /* n cross the carried axis, up to a sign, which the table does not see */
    wo[groove_y ? 0 : 1] = (y * square - ny * slanted) * inverse;
    wo[groove_y ? 1 : 0] = x;
  }
  wo[2] = slanted + ny * y;
}

unsigned shade_bsdf_albedo_eval(const shade_bsdf_albedo *a, const double n_in[3],
                                const double wo_in[3], double specular[3], double diffuse[3]) {
  double *const out[PARTS] = {specular, diffuse};
  double wo[3], n[3];
  for (int k = 0; k < PARTS; k++)
    if (out[k])
      out[k][0] = out[k][1] = out[k][2] = 0;
  unsigned status = make_unit(wo_in, wo);
  if (n_in)
    status |= make_unit(n_in, n);
  if (status || !(wo[2] > 0))
    return status;
  if (n_in) {
    if (!(n[2] > 0)) {
      n[2] = 1e-4;
      const double raised[3] = {n[0], n[1], n[2]};
      make_unit(raised, n);
      status = SHADE_CLAMPED_NORMAL;
    }
    carry(n, a->groove_y, wo);
    if (!(wo[2] > 0))
      return status;
  }
  const double t = (wo[2] < 1 ? sqrt(wo[2]) : 1) * (RINGS - 1);
  const double x = fabs(wo[0]), y = fabs(wo[1]);
  const double s = a->spokes > 1 && x + y > 0 ? y / (x + y) * (SPOKES - 1) : 0;
  const int ring = t < RINGS - 2 ? (int)t : RINGS - 2;
  const int spoke = s < SPOKES - 2 ? (int)s : SPOKES - 2;
  const int next = a->spokes > 1 ? spoke + 1 : 0;
  const double first = LEAST * (RINGS - 1); /* where the first ring is */
  const double up = ring > 0 ? t - ring : t > first ? (t - first) / (1 - first) : 0;
  const double turn = s - spoke;
  for (int k = 0; k < PARTS; k++) {
    if (!out[k])
      continue;
    const float *const p = a->rgb[spoke][ring][k], *const q = a->rgb[spoke][ring + 1][k];
    const float *const v = a->rgb[next][ring][k], *const w = a->rgb[next][ring + 1][k];
    for (int c = 0; c < 3; c++) {
      const double low = (double)p[c], high = (double)v[c];
      const double here = low + up * ((double)q[c] - low);
      const double there = high + up * ((double)w[c] - high);
      out[k][c] = here + turn * (there - here);
    }
  }
  return status;
}

unsigned shade_bsdf_albedo_batchf(const shade_bsdf_albedo *a, size_t count,
                                  const shade_albedo_lanesf *given,
                                  const shade_albedo_resultf *to) {
  shade_albedo_lanesf in;
  shade_albedo_resultf out;
  if (!shade_copy_lanes(given, &in, sizeof in) || !shade_copy_lanes(to, &out, sizeof out))
    return SHADE_BAD_INPUT;
  float *const rgb[PARTS][3] = {{out.specular_r, out.specular_g, out.specular_b},
                                {out.diffuse_r, out.diffuse_g, out.diffuse_b}};
  const int normals = !!in.nx + !!in.ny + !!in.nz;
  int missing = !in.wox || !in.woy || !in.woz || normals % 3;
  for (int k = 0; k < PARTS; k++)
    missing |= (!!rgb[k][0] + !!rgb[k][1] + !!rgb[k][2]) % 3;
  if (missing)
    return SHADE_BAD_INPUT;
  unsigned status = SHADE_OK;
  for (size_t i = 0; i < count; i++) {
    const double wo[3] = {(double)in.wox[i], (double)in.woy[i], (double)in.woz[i]};
    double n[3] = {0, 0, 1}, part[PARTS][3];
    if (normals) {
      n[0] = (double)in.nx[i];
      n[1] = (double)in.ny[i];
      n[2] = (double)in.nz[i];
    }
    status |= shade_bsdf_albedo_eval(a, normals ? n : NULL, wo, part[SPECULAR], part[DIFFUSE]);
    for (int k = 0; k < PARTS; k++)
      for (int c = 0; c < 3 && rgb[k][0]; c++)
        rgb[k][c][i] = (float)part[k][c];
  }
  return status;
}
