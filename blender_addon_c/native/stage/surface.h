/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hits to surface points: position, frame, direction to the eye. */
#include "batch/leaf.h"

/*
 * How far a shadow ray starts off the surface, as a part of the numbers that went
 * into the hit: some 30 roundings. Less shadows itself, more leaks.
 */
#define SURFACE_OFFSET 2e-6f

/* One corner of a triangle, or the interpolated one. */
typedef float row8 __attribute__((vector_size(32), aligned(4), may_alias));

/*
 * By rows, not by lanes: three loads of a row a hit, where sixteen lanes would gather 24 numbers
 * each from all over memory.
 */
static void stage_corner(size_t count, const triangle *restrict triangles,
                         const uint32_t *restrict record, const float *restrict u,
                         const float *restrict v, float *restrict row, float *restrict handed,
                         float *restrict reach) {
  for (size_t i = 0; i < count; i++) {
    const triangle *t = &triangles[record[i]];
    const row8 *corner = (const row8 *)t->corner;
    *(row8 *)(row + 8 * i) = (1.0f - u[i] - v[i]) * corner[0] + u[i] * corner[1] + v[i] * corner[2];
    handed[i] = t->handed;
    reach[i] = t->reach;
  }
}

static void
stage_surface(size_t count, const float *restrict row, const float *restrict reach,
              const float *restrict ox, const float *restrict oy, const float *restrict oz,
              const float *restrict dx, const float *restrict dy, const float *restrict dz,
              const float *restrict t, float *restrict gx, float *restrict gy, float *restrict gz,
              float *restrict px, float *restrict py, float *restrict pz, float *restrict nx,
              float *restrict ny, float *restrict nz, float *restrict tx, float *restrict ty,
              float *restrict tz, float *restrict bx, float *restrict by, float *restrict bz,
              float *restrict wox, float *restrict woy, float *restrict woz, float *restrict uv_u,
              float *restrict uv_v, float *restrict side) {
  for (size_t i = 0; i < count; i++) {
    px[i] = ox[i] + t[i] * dx[i];
    py[i] = oy[i] + t[i] * dy[i];
    pz[i] = oz[i] + t[i] * dz[i];

    /* geometric normal, towards the eye, as long as the offset of shadow rays */
    float g = gx[i] * gx[i] + gy[i] * gy[i] + gz[i] * gz[i];
    float back = gx[i] * dx[i] + gy[i] * dy[i] + gz[i] * dz[i] > 0.0f ? -1.0f : 1.0f;
    float scale = back / sqrtf(g > 1e-36f ? g : 1e-36f);
    float ux = gx[i] * scale, uy = gy[i] * scale, uz = gz[i] * scale;
    float offset = SURFACE_OFFSET * (reach[i] + fabsf(ox[i]) + fabsf(oy[i]) + fabsf(oz[i]) + t[i]);
    gx[i] = ux * offset;
    gy[i] = uy * offset;
    gz[i] = uz * offset;

    /* interpolated normal, facing the eye; opposite corner normals may cancel */
    const float *r = &row[8 * i];
    float x = r[0], y = r[1], z = r[2];
    float n = x * x + y * y + z * z;
    bool good = n > 1e-12f;
    x = good ? x : ux;
    y = good ? y : uy;
    z = good ? z : uz;
    float facing = x * dx[i] + y * dy[i] + z * dz[i] > 0.0f ? -1.0f : 1.0f;
    float to_unit = facing / sqrtf(good ? n : 1.0f);
    x *= to_unit;
    y *= to_unit;
    z *= to_unit;
    side[i] = facing;
    nx[i] = x;
    ny[i] = y;
    nz[i] = z;

    /* tangent, orthogonal to it; where there is none, any [Duff2017] */
    float along = r[3] * x + r[4] * y + r[5] * z;
    float ax = r[3] - along * x, ay = r[4] - along * y, az = r[5] - along * z;
    float a = ax * ax + ay * ay + az * az;
    bool usable = a > 1e-12f;
    float sign = z < 0.0f ? -1.0f : 1.0f;
    float q = -1.0f / (sign + z);
    ax = usable ? ax : 1.0f + sign * x * x * q;
    ay = usable ? ay : sign * x * y * q;
    az = usable ? az : -sign * x;
    float inverse = 1.0f / sqrtf(usable ? a : 1.0f);
    ax *= inverse;
    ay *= inverse;
    az *= inverse;
    float cx = y * az - z * ay, cy = z * ax - x * az, cz = x * ay - y * ax;
    tx[i] = ax;
    ty[i] = ay;
    tz[i] = az;
    bx[i] = cx;
    by[i] = cy;
    bz[i] = cz;
    wox[i] = -(dx[i] * ax + dy[i] * ay + dz[i] * az);
    woy[i] = -(dx[i] * cx + dy[i] * cy + dz[i] * cz);
    woz[i] = -(dx[i] * x + dy[i] * y + dz[i] * z);
    uv_u[i] = r[6];
    uv_v[i] = r[7];
  }
}
