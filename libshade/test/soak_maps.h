/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Soak of the look-ups of maps.h and the batches of albedo.h: floats of every kind. Answers are
 * finite and within what the headers promise, and a status says what was wrong.
 */
#ifndef SHADE_SOAK_MAPS_H
#define SHADE_SOAK_MAPS_H

#include "shade/albedo.h"
#include "shade/maps.h"

enum { SOAK_LANES = 512 };

/* Ordinary numbers mostly; zeros, denormals, whole numbers, huge ones; NaN and infinity at times.
 */
static float soak_float(uint64_t *seed, double size, int finite) {
  static const float odd[] = {0, -0.0F, 1e-40F, 1, -1, 0.5F, 1e9F, -3e38F, 1e30F, 2e-20F};
  const double kind = uniform(seed), x = (2 * uniform(seed) - 1) * size;
  if (kind < 0.03 && !finite)
    return kind < 0.01 ? NAN : kind < 0.02 ? INFINITY : -INFINITY;
  if (kind < 0.1)
    return odd[(int)(uniform(seed) * 10)];
  return (float)(kind < 0.5 ? x * pow(10, -6 * uniform(seed)) : x);
}

static const char *soak_slopes(const shade_slope_map *m, uint64_t *seed) {
  const double size = pow(10, 4 * uniform(seed) - 3);
  const int finite = uniform(seed) < 0.5, sides = uniform(seed) < 0.9;
  for (int i = 0; i < SOAK_LANES; i++) {
    double in[6];
    int bad = 0;
    for (int k = 0; k < 6; k++) {
      in[k] = (double)soak_float(seed, k < 2 ? 3 : size, finite);
      bad |= (k < 2 || sides) && !isfinite(in[k]);
    }
    shade_slopes s;
    if (shade_slope_lookup(m, in[0], in[1], sides ? in + 2 : NULL, &s) !=
        (bad ? SHADE_BAD_INPUT : SHADE_OK))
      return "the status of a look-up";
    const double *n = s.normal, *c = s.covariance;
    if (!(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-12 && n[2] > 0.019))
      return "a normal";
    if (!(c[0] >= 0 && c[2] >= 0 && c[0] < 2501 && c[2] < 2501 &&
          c[1] * c[1] <= c[0] * c[2] * (1 + 1e-12) + 1e-300))
      return "a covariance";
  }
  return NULL;
}

static const char *soak_widen(uint64_t *seed) {
  const double size = pow(10, 6 * uniform(seed) - 5);
  const int finite = uniform(seed) < 0.5;
  for (int i = 0; i < SOAK_LANES; i++) {
    double in[8], angle;
    for (int k = 0; k < 8; k++)
      in[k] = (double)soak_float(seed, k < 3 ? 1 : k < 6 ? size : 10, finite);
    shade_params p, wide;
    shade_params_init(&p);
    p.mdf = (shade_mdf)(uniform(seed) * SHADE_MDF_COUNT);
    p.groove = (shade_groove)(uniform(seed) * SHADE_GROOVE_COUNT);
    p.ax = p.ex = in[6];
    p.ay = p.ey = in[7];
    if (shade_params_widen(&p, in, in + 3, &wide, &angle) &
        ~(unsigned)(SHADE_BAD_INPUT | SHADE_CLAMPED_PARAMETER))
      return "the status of a widening";
    if (!(wide.ax >= 1e-4 && wide.ax <= 10 && wide.ay >= 1e-4 && wide.ay <= 10 && wide.ex >= 0 &&
          wide.ex <= 1e6 && wide.ey >= 0 && wide.ey <= 1e6))
      return "a width";
    if (!(fabs(angle) <= PI / 4 + 1e-12))
      return "an angle";
  }
  return NULL;
}

static const char *soak_albedo(const shade_bsdf_albedo *a, uint64_t *seed) {
  static float in[6][SOAK_LANES], out[6][SOAK_LANES];
  for (int i = 0; i < SOAK_LANES; i++)
    for (int k = 0; k < 6; k++)
      in[k][i] = soak_float(seed, 1, 0);
  const shade_albedo_lanesf lanes = {sizeof lanes, in[0], in[1], in[2], in[3], in[4], in[5]};
  const shade_albedo_resultf result = {sizeof result, out[0], out[1], out[2],
                                       out[3],        out[4], out[5]};
  if (shade_bsdf_albedo_batchf(a, SOAK_LANES, &lanes, &result) &
      ~(unsigned)(SHADE_BAD_INPUT | SHADE_CLAMPED_NORMAL))
    return "the status of an albedo";
  for (int i = 0; i < SOAK_LANES; i++)
    for (int k = 0; k < 6; k++)
      if (!(out[k][i] >= 0 && out[k][i] <= 1.01F))
        return "an albedo";
  return NULL;
}

/* About `lanes` lanes. What was wrong, or NULL; *seed then repeats it. */
static const char *soak_maps(uint64_t lanes, uint64_t *seed) {
  const char *wrong = NULL;
  for (uint64_t done = 0; done < lanes && !wrong;) {
    const uint64_t began = *seed;
    const int width = 1 + (int)(pow(150, uniform(seed))),
              height = 1 + (int)(pow(150, uniform(seed)));
    float *pixels = malloc((size_t)(width * height) * 2 * sizeof *pixels);
    for (int i = 0; i < 2 * width * height; i++)
      pixels[i] = soak_float(seed, 3, 1);
    shade_slope_options o;
    shade_slope_options_init(&o);
    o.normals = SHADE_NORMALS_SLOPE;
    o.wrap = (shade_wrap)(uniform(seed) * 3);
    shade_slope_map *m = shade_slope_map_create(pixels, width, height, 2, &o, NULL);
    free(pixels);
    shade_params p;
    shade_params_init(&p);
    p.mdf = SHADE_MDF_GGX;
    p.brdf = SHADE_BRDF_MICROFACET;
    p.kd[0] = 0.5;
    shade_bsdf_albedo *a = shade_bsdf_albedo_create(&p, NULL);
    for (int k = 0; k < 20 && m && a && !wrong; k++) {
      wrong = soak_slopes(m, seed);
      wrong = wrong ? wrong : soak_widen(seed);
      wrong = wrong ? wrong : soak_albedo(a, seed);
      done += SOAK_LANES;
    }
    shade_bsdf_albedo_free(a);
    shade_slope_map_free(m);
    if (wrong || !m || !a) {
      *seed = began;
      wrong = wrong ? wrong : "memory";
    }
  }
  return wrong;
}

#endif
