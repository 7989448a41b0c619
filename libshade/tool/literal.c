/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "tool/literal.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

typedef struct vec {
  float x, y, z;
} vec;

static vec cross(vec a, vec b) {
  return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static float dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static vec normalised(vec a) {
  float length = sqrtf(dot(a, a));
  return (vec){a.x / length, a.y / length, a.z / length};
}

/* [KangCho Eq. 4, 6 and 7] */
void JOIN(literal_, ISA)(size_t count, float ex, float ey, const float *nx, const float *ny,
                         const float *nz, const float *hx, const float *hy, const float *hz,
                         float *d) {
  const float peak = sqrtf((ex + 1) * (ey + 1)) / (2 * 3.14159265f);
  for (size_t i = 0; i < count; i++) {
    vec w = normalised((vec){nx[i], ny[i], nz[i]}), h = normalised((vec){hx[i], hy[i], hz[i]});
    vec v = normalised(cross(w, cross((vec){0, 1, 0}, w)));
    vec u = normalised(cross(v, w));
    float x = dot(u, h), y = dot(v, h), z = dot(w, h);
    float phi = atan2f(y, x);
    float e = ex * cosf(phi) * cosf(phi) + ey * sinf(phi) * sinf(phi);
    d[i] = z > 0 ? peak * powf(z, e) : 0;
  }
}

#define STREAM(name, real)                                                                         \
  static void name##_distribution(size_t count, const real *restrict a, const real *restrict b,    \
                                  const real *restrict c, const real *restrict d,                  \
                                  const real *restrict e, const real *restrict f,                  \
                                  real *restrict out) {                                            \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) out[i] =                                \
        ((a[i] + b[i]) + (c[i] + d[i])) + (e[i] + f[i]);                                           \
  }                                                                                                \
  static void name##_brdf(size_t count, const real *restrict a, const real *restrict b,            \
                          const real *restrict c, const real *restrict d, const real *restrict e,  \
                          const real *restrict f, const real *restrict g, const real *restrict h,  \
                          const real *restrict j, real *restrict red, real *restrict green,        \
                          real *restrict blue, real *restrict cosine) {                            \
    _Pragma("omp simd") for (size_t i = 0; i < count; i++) {                                       \
      red[i] = a[i] + b[i];                                                                        \
      green[i] = c[i] + d[i];                                                                      \
      blue[i] = e[i] + f[i];                                                                       \
      cosine[i] = (g[i] + h[i]) + j[i];                                                            \
    }                                                                                              \
  }                                                                                                \
  void JOIN(name##_, ISA)(int whole, size_t count, real *const *a) {                               \
    if (whole)                                                                                     \
      name##_brdf(count, a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9], a[10], a[11], \
                  a[12]);                                                                          \
    else                                                                                           \
      name##_distribution(count, a[0], a[1], a[2], a[3], a[4], a[5], a[9]);                        \
  }
STREAM(stream_single, float)
STREAM(stream_twice, double)
