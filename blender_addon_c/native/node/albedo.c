/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "node/albedo.h"

#include <math.h>

static pthread_mutex_t making = PTHREAD_MUTEX_INITIALIZER;
static float made[ALBEDO_LOBES][2 * ALBEDO_ROUGH * ALBEDO_EYE + ALBEDO_ROUGH];
static bool whole[ALBEDO_LOBES];

/* A row of the table; `clear`: with a clear body's Fresnel. */
static bool fill(albedo_lobe lobe, double alpha, bool clear, float *row) {
  shade_params p;
  shade_params_init(&p);
  p.mdf = lobe == ALBEDO_GGX        ? SHADE_MDF_GGX
          : lobe == ALBEDO_BECKMANN ? SHADE_MDF_BECKMANN
                                    : SHADE_MDF_ASHIKHMIN_SHIRLEY;
  p.brdf = lobe == ALBEDO_COSINES ? SHADE_BRDF_ASHIKHMIN_SHIRLEY : SHADE_BRDF_MICROFACET;
  p.fresnel = clear ? SHADE_FRESNEL_CONDUCTOR : SHADE_FRESNEL_NONE;
  p.ax = p.ay = fmax(alpha, 1e-3);
  p.ex = p.ey = fmax(2 / (p.ax * p.ax) - 2, 0);
  for (int k = 0; k < 3; k++) {
    p.eta[k] = 1.5;
    p.k[k] = 0.0;
    p.f0[k] = 1.0;
  }
  shade_bsdf_albedo *a = shade_bsdf_albedo_create(&p, NULL);
  if (!a)
    return false;
  for (int k = 0; k < ALBEDO_EYE; k++) {
    double cosine = fmax(k / (double)(ALBEDO_EYE - 1), 2e-3), specular[3];
    shade_bsdf_albedo_eval(a, NULL, (double[]){sqrt(1 - cosine * cosine), 0, cosine}, specular,
                           NULL);
    row[k] = (float)specular[0];
  }
  shade_bsdf_albedo_free(a);
  return true;
}

static bool make(albedo_lobe lobe) {
  const double head_on = 0.04; /* of index 1.5 */
  float *ones = made[lobe], *clear = ones + ALBEDO_ROUGH * ALBEDO_EYE;
  float *mean = clear + ALBEDO_ROUGH * ALBEDO_EYE;
  for (int j = 0; j < ALBEDO_ROUGH; j++) {
    double root = j / (double)(ALBEDO_ROUGH - 1), sum = 0;
    float *one = ones + j * ALBEDO_EYE, *other = clear + j * ALBEDO_EYE;
    if (!fill(lobe, root * root, false, one) ||
        (lobe == ALBEDO_GGX && !fill(lobe, root * root, true, other)))
      return false;
    for (int k = 0; k < ALBEDO_EYE; k++) {
      other[k] = (float)(((double)other[k] - head_on * (double)one[k]) / (1 - head_on));
      double cosine = k / (double)(ALBEDO_EYE - 1), ends = k % (ALBEDO_EYE - 1) ? 1 : 0.5;
      sum += 2 * ends * cosine * (double)one[k] / (ALBEDO_EYE - 1);
    }
    mean[j] = (float)sum;
  }
  return true;
}

bool albedo_table_make(albedo_lobe lobe, const float **table) {
  pthread_mutex_lock(&making);
  whole[lobe] = whole[lobe] || make(lobe);
  pthread_mutex_unlock(&making);
  *table = made[lobe];
  return whole[lobe];
}
