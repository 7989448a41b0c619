/* SPDX-License-Identifier: Apache-2.0 */
/* D of a rotated lobe as one writes it in plain C: a sample after the other, libm's functions,
 * -O2. What the library's vectorised forms are timed beside (study_speed.py); the formulas are
 * those of docs/theory/bumps.md. */
#include <math.h>
#include <stddef.h>

typedef struct vector {
  float x, y, z;
} vector;

/* what a lobe keeps: its peak, and the factors of x² and y² */
typedef struct lobe {
  float peak, x, y;
} lobe;

/* h in the frame of n whose x axis lies along dP/du = (nz, 0, -nx) */
static inline vector carried(vector n, vector h) {
  const float length2 = n.x * n.x + n.z * n.z, inverse = 1 / sqrtf(length2);
  const float along = n.x * h.x + n.z * h.z;
  return (vector){(n.z * h.x - n.x * h.z) * inverse, (h.y * length2 - n.y * along) * inverse,
                  along + n.y * h.y};
}

static inline float squares(lobe l, vector h) {
  return h.x * h.x * l.x + h.y * h.y * l.y;
}

static inline float ashikhmin_shirley(lobe l, vector h) {
  const float side = h.x * h.x + h.y * h.y;
  return l.peak * powf(h.z, side > 0 ? squares(l, h) / side : 0);
}

static inline float ward(lobe l, vector h) {
  return l.peak * expf(-squares(l, h) / (h.z * h.z));
}

static inline float ward_half(lobe l, vector h) {
  return l.peak * expf(-2 * squares(l, h) / (1 + h.z));
}

static inline float beckmann(lobe l, vector h) {
  const float z2 = h.z * h.z;
  return l.peak * expf(-squares(l, h) / z2) / (z2 * z2);
}

static inline float ggx(lobe l, vector h) {
  const float sum = h.z * h.z + squares(l, h);
  return l.peak / (sum * sum);
}

#define FOR_ALL(f)                                                                                 \
  for (size_t i = 0; i < count; i++) {                                                             \
    const vector local = carried(n[i], h[i]);                                                      \
    D[i] = local.z > 0 ? f(l, local) : 0;                                                          \
  }                                                                                                \
  break

/* n and h: count triples; mdf: the place of a distribution in study_speed.MDFS */
void plain_D(int mdf, size_t count, float ex, float ey, const vector *n, const vector *h,
             float *D) {
  const float pi = 3.14159265f;
  const lobe powers = {sqrtf((ex + 1) * (ey + 1)) / (2 * pi), ex, ey};
  const lobe slopes = {sqrtf((ex + 2) * (ey + 2)) / (2 * pi), (ex + 2) / 2, (ey + 2) / 2};
  const lobe l = mdf == 0 ? powers : slopes;
  switch (mdf) {
  case 0:
    FOR_ALL(ashikhmin_shirley);
  case 1:
    FOR_ALL(ward);
  case 2:
    FOR_ALL(ward_half);
  case 3:
    FOR_ALL(beckmann);
  default:
    FOR_ALL(ggx);
  }
}
