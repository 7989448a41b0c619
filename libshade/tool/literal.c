/* SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "tool/literal.h"

#define NAME_(isa) literal_##isa
#define NAME(isa) NAME_(isa)

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
void NAME(ISA)(size_t count, float ex, float ey, const float *nx, const float *ny, const float *nz,
               const float *hx, const float *hy, const float *hz, float *d) {
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
