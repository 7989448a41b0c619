/* SPDX-License-Identifier: Apache-2.0 */
#include "reference.h"

#include <math.h>

typedef long double real;
typedef struct vec {
  real x, y, z;
} vec;

static const real pi = 3.14159265358979323846264338327950288L;

static real dot(vec a, vec b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static vec cross(vec a, vec b) {
  return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static vec scale(vec a, real s) {
  return (vec){a.x * s, a.y * s, a.z * s};
}
static vec minus(vec a, vec b) {
  return (vec){a.x - b.x, a.y - b.y, a.z - b.z};
}
static vec plus(vec a, vec b) {
  return (vec){a.x + b.x, a.y + b.y, a.z + b.z};
}
static real length(vec a) {
  return hypotl(hypotl(a.x, a.y), a.z);
}
static vec unit(vec a) {
  return scale(a, 1 / length(a));
}

/* 1 when v can be made unit. */
static int usable(const double v[3]) {
  return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) &&
         (v[0] != 0 || v[1] != 0 || v[2] != 0);
}

static vec direction(const double v[3]) {
  return unit((vec){v[0], v[1], v[2]});
}

/* The perturbed normal; below the horizon it is lifted to z = 1e-4. */
static vec normal(const double v[3]) {
  vec n = direction(v);
  if (n.z <= 0) {
    n.z = 1e-4L;
    n = unit(n);
  }
  return n;
}

static real within(real x, real low, real high) {
  return x < low ? low : x > high ? high : x;
}

/* h in spherical coordinates about a pole: theta from it, phi from the frame's x. */
typedef struct angles {
  real theta, phi;
} angles;

static angles in_frame(vec x, vec y, vec z, vec h) {
  real hx = dot(x, h), hy = dot(y, h), hz = dot(z, h);
  return (angles){atan2l(hypotl(hx, hy), hz), atan2l(hy, hx)};
}

static angles carried(const shade_params *p, vec n, vec h) {
  const vec ex = {1, 0, 0}, ey = {0, 1, 0}, ez = {0, 0, 1};
  switch (p->detail) {
  case SHADE_DETAIL_NONE:
    return in_frame(ex, ey, ez, h);
  case SHADE_DETAIL_PERTURB: {
    /* the angle to n from its sine and cosine: acos would lose digits near 0 */
    angles a = {atan2l(length(cross(n, h)), dot(n, h)), atan2l(h.y, h.x)};
    if (h.x == 0 && h.y == 0)
      a.phi = pi / 4;
    return a;
  }
  case SHADE_DETAIL_GRAM_SCHMIDT: {
    vec x = unit(minus(ex, scale(n, n.x)));
    return in_frame(x, cross(n, x), n, h);
  }
  case SHADE_DETAIL_ROTATE:
  default: {
    int along_y = p->groove == SHADE_GROOVE_Y || (p->groove == SHADE_GROOVE_AUTO && p->ey > p->ex);
    if (along_y) { /* y' = dP/dv of the height field */
      vec y = unit((vec){0, n.z, -n.y});
      return in_frame(cross(y, n), y, n, h);
    }
    vec x = unit((vec){n.z, 0, -n.x}); /* x' = dP/du */
    return in_frame(x, cross(n, x), n, h);
  }
  }
}

static real ashikhmin_shirley(real ex, real ey, angles a) {
  if (a.theta >= pi / 2)
    return 0;
  real c = cosl(a.phi), s = sinl(a.phi);
  real exponent = ex * c * c + ey * s * s;
  return sqrtl((ex + 1) * (ey + 1)) / (2 * pi) * powl(cosl(a.theta), exponent);
}

static real distribution(const shade_params *p, vec n, vec h) {
  real ex = within(p->ex, 0, 1e6L), ey = within(p->ey, 0, 1e6L);
  return ashikhmin_shirley(ex, ey, carried(p, n, h));
}

double shade_ref_mdf(const shade_params *p, const double n[3], const double h[3]) {
  if (!usable(n) || !usable(h))
    return 0;
  return (double)distribution(p, normal(n), direction(h));
}

unsigned shade_ref_f(const shade_params *p, const double n_in[3], const double wi_in[3],
                     const double wo_in[3], double f[3], double *cosine) {
  f[0] = f[1] = f[2] = 0;
  if (cosine)
    *cosine = 0;
  if (!usable(n_in) || !usable(wi_in) || !usable(wo_in))
    return SHADE_BAD_INPUT;
  vec n = normal(n_in), wi = direction(wi_in), wo = direction(wo_in);
  unsigned status = n_in[2] <= 0 ? SHADE_CLAMPED_NORMAL : SHADE_OK;
  vec pole = p->detail == SHADE_DETAIL_NONE ? (vec){0, 0, 1} : n;
  real cosi = dot(pole, wi), coso = dot(pole, wo);
  if (cosine && cosi > 0)
    *cosine = (double)cosi;
  if (length(plus(wi, wo)) <= 1e-15L)
    status |= SHADE_BAD_INPUT;
  if (cosi <= 0 || coso <= 0 || wi.z <= 0 || wo.z <= 0)
    return status;
  vec h = unit(plus(wi, wo));
  real hwo = dot(h, wo);
  real denominator = 4 * hwo * (cosi > coso ? cosi : coso);
  real lobe = distribution(p, n, h) / (denominator > 1e-20L ? denominator : 1e-20L);
  for (int i = 0; i < 3; i++) {
    real f0 = within(p->f0[i], 0, 1);
    real fresnel = f0;
    if (p->fresnel == SHADE_FRESNEL_SCHLICK)
      fresnel += (1 - f0) * powl(1 - hwo, 5);
    f[i] = (double)(fresnel * lobe);
  }
  return status;
}
