/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The interface between air and a clear body. */
#ifndef LIBSHADE_NODE_DIELECTRIC_H
#define LIBSHADE_NODE_DIELECTRIC_H

#include "batch/leaf.h"

/* Index beyond the surface over that before it; never 1, where nothing would be refracted and no
 * microfacet said which way. */
LEAF float dielectric_eta(float ior, float side) {
  ior = clampf(ior, 1e-3f, 1e3f);
  float eta = side < 0.0f ? 1.0f / ior : ior;
  return eta < 1.0f ? (eta < 0.9999f ? eta : 0.9999f) : (eta > 1.0001f ? eta : 1.0001f);
}

/* Reflectance; 1 where all is reflected. *t: cosine beyond. */
LEAF float dielectric_fresnel(float cosine, float eta, float *t) {
  float square = 1.0f - (1.0f - cosine * cosine) / (eta * eta);
  float g = sqrtf(square > 0.0f ? square : 0.0f);
  float s = (cosine - eta * g) / (cosine + eta * g), p = (eta * cosine - g) / (eta * cosine + g);
  *t = g;
  return square > 0.0f ? 0.5f * (s * s + p * p) : 1.0f;
}

#endif
