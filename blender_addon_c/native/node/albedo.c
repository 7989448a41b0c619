/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "node/albedo.h"

#include <math.h>

static pthread_mutex_t making = PTHREAD_MUTEX_INITIALIZER;
static float made[ALBEDO_LOBES][2 * ALBEDO_ROUGH * ALBEDO_EYE + ALBEDO_ROUGH];
static bool whole[ALBEDO_LOBES];

/* A lobe, its BRDF the distribution's own, that reflects all. */
static shade_params ones_of(shade_mdf mdf) {
  shade_params p;
  shade_params_init(&p);
  p.mdf = mdf;
  p.fresnel = SHADE_FRESNEL_NONE;
  for (int k = 0; k < 3; k++)
    p.f0[k] = 1.0;
  return p;
}

/* A row of the table; `clear`: with a clear body's Fresnel. */
static bool fill(albedo_lobe lobe, double alpha, bool clear, float *row) {
  static const shade_mdf mdfs[] = {SHADE_MDF_GGX, SHADE_MDF_BECKMANN, SHADE_MDF_ASHIKHMIN_SHIRLEY};
  shade_params p = ones_of(mdfs[lobe]);
  p.fresnel = clear ? SHADE_FRESNEL_CONDUCTOR : SHADE_FRESNEL_NONE;
  p.ax = p.ay = fmax(alpha, 1e-3);
  p.ex = p.ey = fmax(2 / (p.ax * p.ax) - 2, 0);
  for (int k = 0; k < 3; k++) {
    p.eta[k] = 1.5;
    p.k[k] = 0.0;
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

static float pairs[PAIR_ROUGH * PAIR_ROUGH * (PAIR_ROW + 1)];
static bool has_pairs;

/* What a lobe whose Fresnel is 1 reflects of even light towards v: the mean weight of its draws. */
static double drawn_out(const shade_bsdf *b, const double v[3]) {
  enum { DRAWS = 256 };
  float flat[DRAWS] = {0}, up[DRAWS], eye[3][DRAWS], u[2][DRAWS], out[8][DRAWS];
  for (int k = 0; k < DRAWS; k++) {
    up[k] = 1.0f;
    for (int c = 0; c < 3; c++)
      eye[c][k] = (float)v[c];
    u[0][k] = (float)fmod(k * 0.6180339887498949, 1);
    u[1][k] = ((float)k + 0.5f) / DRAWS;
  }
  const shade_sample_lanesf in = {.size = sizeof in,
                                  .nx = flat,
                                  .ny = flat,
                                  .nz = up,
                                  .wox = eye[0],
                                  .woy = eye[1],
                                  .woz = eye[2],
                                  .u1 = u[0],
                                  .u2 = u[1]};
  const shade_sample_resultf to = {sizeof to, out[0], out[1], out[2], out[3],
                                   out[4],    out[5], out[6], out[7]};
  shade_bsdf_sample_batchf(b, DRAWS, &in, &to);
  double sum = 0;
  for (int k = 0; k < DRAWS; k++)
    if (to.pdf[k] > 0) /* else none was found, which counts as 0 */
      sum += (double)(to.r[k] * to.cosine[k] / to.pdf[k]);
  return sum / DRAWS;
}

static void make_pair(int i, int j) {
  const double x = i / (double)(PAIR_ROUGH - 1), y = j / (double)(PAIR_ROUGH - 1);
  float *row = pairs + (i * PAIR_ROUGH + j) * PAIR_ROW;
  double sum = 0, weights = 0;
  shade_bsdf b;
  shade_params p = ones_of(SHADE_MDF_GGX);
  p.ax = fmax(x * x, 1e-3);
  p.ay = fmax(y * y, 1e-3);
  shade_bsdf_setup(&b, &p);
  for (int k = 0; k < PAIR_EYE; k++)
    for (int l = 0; l < PAIR_TURN; l++) {
      double root = k / (double)(PAIR_EYE - 1), z = fmax(root * root, 2e-3), s = sqrt(1 - z * z);
      double turn = 1.5707963267948966 * l / (PAIR_TURN - 1);
      double one = drawn_out(&b, (double[]){s * cos(turn), s * sin(turn), z});
      double weight = (k % (PAIR_EYE - 1) ? 1 : 0.5) * (l % (PAIR_TURN - 1) ? 1 : 0.5) * z * root;
      row[k * PAIR_TURN + l] = (float)one;
      sum += weight * one;
      weights += weight;
    }
  pairs[PAIR_ROUGH * PAIR_ROUGH * PAIR_ROW + i * PAIR_ROUGH + j] = (float)(sum / weights);
}

/* Of two alphas those that are less first; the others mirror them. */
static void make_pairs(void) {
  for (int i = 0; i < PAIR_ROUGH; i++)
    for (int j = 0; j <= i; j++) {
      make_pair(i, j);
      const float *from = pairs + (i * PAIR_ROUGH + j) * PAIR_ROW;
      float *to = pairs + (j * PAIR_ROUGH + i) * PAIR_ROW;
      for (int k = 0; i != j && k < PAIR_ROW; k++)
        to[k] = from[k / PAIR_TURN * PAIR_TURN + PAIR_TURN - 1 - k % PAIR_TURN];
      float *means = pairs + PAIR_ROUGH * PAIR_ROUGH * PAIR_ROW;
      means[j * PAIR_ROUGH + i] = means[i * PAIR_ROUGH + j];
    }
}

const float *albedo_pairs_make(void) {
  pthread_mutex_lock(&making);
  if (!has_pairs)
    make_pairs();
  has_pairs = true;
  pthread_mutex_unlock(&making);
  return pairs;
}
