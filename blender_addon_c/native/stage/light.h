/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Light samples and shadow rays. e is the irradiance as a part of the light's colour. */
#include "batch/leaf.h"

/* Points of the unit disc. */
static void stage_disc(size_t count, const uint32_t *restrict lane, const uint32_t *restrict hash,
                       const uint32_t *restrict point_x, const uint32_t *restrict point_y,
                       uint32_t salt, uint32_t scramble, float *restrict a, float *restrict b) {
  for (size_t i = 0; i < count; i++) {
    uint32_t h = mix(hash[lane[i]] + salt);
    float radius = sqrtf(unit_float(point_x[lane[i]] ^ (h & scramble)));
    float s, c;
    turn(unit_float(point_y[lane[i]] ^ (mix(h) & scramble)), &s, &c);
    a[i] = radius * c;
    b[i] = radius * s;
  }
}

static void stage_sun(size_t count, const light *light, const float *restrict a,
                      const float *restrict b, const float *restrict px, const float *restrict py,
                      const float *restrict pz, float *restrict lx, float *restrict ly,
                      float *restrict lz, float *restrict e, float *restrict tfar) {
  (void)px, (void)py, (void)pz; /* it is as far from every hit */
  const float vx = light->vector[0], vy = light->vector[1], vz = light->vector[2];
  const float ax = light->axis[0][0], ay = light->axis[0][1], az = light->axis[0][2];
  const float bx = light->axis[1][0], by = light->axis[1][1], bz = light->axis[1][2];
  for (size_t i = 0; i < count; i++) {
    float x = vx + a[i] * ax + b[i] * bx;
    float y = vy + a[i] * ay + b[i] * by;
    float z = vz + a[i] * az + b[i] * bz;
    float inverse = 1.0f / sqrtf(x * x + y * y + z * z);
    lx[i] = x * inverse;
    ly[i] = y * inverse;
    lz[i] = z * inverse;
    e[i] = 1.0f;
    tfar[i] = INFINITY;
  }
}

/* A disc that faces the shaded point: what it sees of a sphere, but for a rim. */
static void stage_point(size_t count, const light *light, const float *restrict a,
                        const float *restrict b, const float *restrict px, const float *restrict py,
                        const float *restrict pz, float *restrict lx, float *restrict ly,
                        float *restrict lz, float *restrict e, float *restrict tfar) {
  const float vx = light->vector[0], vy = light->vector[1], vz = light->vector[2];
  const float radius = light->radius;
  for (size_t i = 0; i < count; i++) {
    float x = vx - px[i], y = vy - py[i], z = vz - pz[i];
    float d2 = x * x + y * y + z * z;
    float inverse = 1.0f / sqrtf(d2 > 1e-30f ? d2 : 1e-30f);
    float wx = x * inverse, wy = y * inverse, wz = z * inverse;
    /* two axes across it [Duff2017] */
    float sign = wz < 0.0f ? -1.0f : 1.0f;
    float q = -1.0f / (sign + wz), r = wx * wy * q;
    float ra = radius * a[i], rb = radius * b[i];
    x += ra * (1.0f + sign * wx * wx * q) + rb * r;
    y += ra * sign * r + rb * (sign + wy * wy * q);
    z -= ra * sign * wx + rb * wy;
    d2 = x * x + y * y + z * z;
    bool apart = d2 > 1e-30f; /* a light on the surface itself gives none */
    float d = sqrtf(apart ? d2 : 1.0f);
    inverse = 1.0f / d;
    lx[i] = x * inverse;
    ly[i] = y * inverse;
    lz[i] = apart ? z * inverse : 1.0f;
    e[i] = apart ? inverse * inverse : 0.0f;
    tfar[i] = d;
  }
}

/*
 * The light in the shading frame, and the shadow ray. Light counts that falls on the side of the
 * facet that is seen, and only where the smooth normal sees it too; all else casts no ray.
 */
static void stage_lit(size_t count, const float *restrict lx, const float *restrict ly,
                      const float *restrict lz, const float *restrict px, const float *restrict py,
                      const float *restrict pz, const float *restrict gx, const float *restrict gy,
                      const float *restrict gz, const float *restrict nx, const float *restrict ny,
                      const float *restrict nz, const float *restrict tx, const float *restrict ty,
                      const float *restrict tz, const float *restrict bx, const float *restrict by,
                      const float *restrict bz, float *restrict wix, float *restrict wiy,
                      float *restrict wiz, float *restrict ox, float *restrict oy,
                      float *restrict oz, float *restrict tfar) {
  for (size_t i = 0; i < count; i++) {
    float x = lx[i], y = ly[i], z = lz[i];
    float height = x * nx[i] + y * ny[i] + z * nz[i];
    float above = x * gx[i] + y * gy[i] + z * gz[i];
    wix[i] = x * tx[i] + y * ty[i] + z * tz[i];
    wiy[i] = x * bx[i] + y * by[i] + z * bz[i];
    wiz[i] = height;
    ox[i] = px[i] + gx[i];
    oy[i] = py[i] + gy[i];
    oz[i] = pz[i] + gz[i];
    tfar[i] = ((height > 0.0f) & (above > 0.0f)) ? tfar[i] : -1.0f;
  }
}

static size_t stage_shadow(size_t count, const float *restrict tfar, float *restrict e) {
  uint32_t lit = 0;
  for (size_t i = 0; i < count; i++) {
    bool sees = tfar[i] > 0.0f;
    e[i] = sees ? e[i] : 0.0f;
    lit += sees ? 1u : 0u;
  }
  return lit;
}
