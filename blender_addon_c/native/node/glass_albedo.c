/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "node/glass_albedo.h"

#include "system/threads.h"

static pthread_once_t once[2] = {PTHREAD_ONCE_INIT, PTHREAD_ONCE_INIT};
static float made[2][GLASS_TABLE + 2 * GLASS_MEANS];

/* Of directions in the frame of the normal, along z. */
static double lambda(double z, double alpha) {
  double tan2 = fmax(1 - z * z, 0) / fmax(z * z, 1e-12);
  return 0.5 * (sqrt(1 + alpha * alpha * tan2) - 1);
}

/* What is left of what arrives at a facet, on the way from z to the eye. */
static double unshadowed(double z, double seen, double alpha, bool joint) {
  double out = lambda(z, alpha);
  return joint ? (1 + seen) / (1 + seen + out) : 1 / (1 + out);
}

/* The mean over the facets that the eye sees [Heitz2018], halves of an azimuth alike. */
static double albedo(double cosine, double alpha, double eta, bool joint) {
  enum { RINGS = 24, SECTORS = 16 };
  double sine = sqrt(1 - cosine * cosine), seen = lambda(cosine, alpha), sum = 0;
  double wx = alpha * sine, w = sqrt(wx * wx + cosine * cosine);
  wx /= w;
  double wz = cosine / w;
  for (int j = 0; j < RINGS; j++)
    for (int k = 0; k < SECTORS; k++) {
      double z = (1 - (j + 0.5) / RINGS) * (1 + wz) - wz, r = sqrt(fmax(1 - z * z, 0));
      double turn = 3.141592653589793 * (k + 0.5) / SECTORS;
      double x = alpha * (r * cos(turn) + wx), y = alpha * r * sin(turn), up = fmax(z + wz, 0);
      double length = sqrt(x * x + y * y + up * up);
      if (!(length > 0))
        continue;
      double hx = x / length, hz = up / length, ho = hx * sine + hz * cosine;
      if (!(ho > 0))
        continue;
      float t;
      double fresnel = (double)dielectric_fresnel((float)ho, (float)eta, &t);
      double mirrored = 2 * ho * hz - cosine;
      if (mirrored > 0)
        sum += fresnel * unshadowed(mirrored, seen, alpha, joint);
      double bent = (ho / eta - (double)t) * hz - cosine / eta;
      if (fresnel < 1 && bent < 0)
        sum += (1 - fresnel) * unshadowed(-bent, seen, alpha, joint);
    }
  return sum / (RINGS * SECTORS);
}

static void make(bool joint) {
  float *to = made[joint], *mean = to + GLASS_TABLE;
  for (int side = 0; side < 2; side++)
    for (int plane = 0; plane < GLASS_ETA; plane++) {
      double s = (side ? -1 : 1) * (double)GLASS_MOST_ETA * plane / (GLASS_ETA - 1);
      double eta = plane ? (1 + s) / (1 - s) : side ? 0.9999 : 1.0001;
      for (int row = 0; row < GLASS_ROUGH; row++) {
        double root = row / (double)(GLASS_ROUGH - 1), sum = 0;
        for (int eye = 0; eye < GLASS_EYE; eye++) {
          double cosine = eye / (double)(GLASS_EYE - 1), ends = eye % (GLASS_EYE - 1) ? 1 : 0.5;
          double one = albedo(fmax(cosine, 2e-3), fmax(root * root, 1e-4), eta, joint);
          *to++ = (float)one;
          sum += 2 * ends * cosine * one / (GLASS_EYE - 1);
        }
        *mean++ = (float)sum;
      }
    }
}

static void make_apart(void) {
  make(false);
}
static void make_joint(void) {
  make(true);
}

const float *glass_albedo_table(bool joint) {
  pthread_once(&once[joint], joint ? make_joint : make_apart);
  return made[joint];
}
