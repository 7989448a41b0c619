/* SPDX-License-Identifier: Apache-2.0 */
/* Where a detail method lets the distribution see a half vector, and what that stretches. */
#include "model.h"

#include <complex.h>
#include <math.h>

int ref_grooves_along_y(const shade_params *p) {
  if (p->groove != SHADE_GROOVE_AUTO)
    return p->groove == SHADE_GROOVE_Y;
  return p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY ? p->ey > p->ex : p->ay < p->ax;
}

shade_detail ref_method_of(const shade_params *p) {
  if (p->detail != SHADE_DETAIL_AUTO)
    return p->detail;
  int round = p->mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY ? p->ex == p->ey : p->ax == p->ay;
  return round ? SHADE_DETAIL_PERTURB : SHADE_DETAIL_ROTATE;
}

int ref_conserves(shade_detail detail) {
  return detail == SHADE_DETAIL_DEFORM_LINEAR_CONSERVING ||
         detail == SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING;
}

int ref_is_warp(shade_detail detail) {
  return detail == SHADE_DETAIL_DEFORM_LINEAR || detail == SHADE_DETAIL_DEFORM_SMOOTH ||
         ref_conserves(detail);
}

/*
 * The warp of the unit disc; z = 0 stands for outside. With delta and p' the projections
 * of n and h, w = |R - p'|/|R - C'| where R is the rim point on the ray from C' = delta
 * through p'.
 */
vec ref_warped(shade_detail detail, vec n, vec h) {
  vec delta = {n.x, n.y, 0}, away = {h.x - n.x, h.y - n.y, 0};
  real a = dot(away, away), b = dot(delta, away), c = n.z * n.z;
  real w = 1 - (b + sqrtl(b * b + a * c)) / c;
  if (w < 0)
    w = 0;
  int linear =
      detail == SHADE_DETAIL_DEFORM_LINEAR || detail == SHADE_DETAIL_DEFORM_LINEAR_CONSERVING;
  real shift = linear ? w : sqrtl(w);
  vec p = {h.x - shift * n.x, h.y - shift * n.y, 0};
  real zz = 1 - dot(p, p);
  if (h.z <= 0 || zz <= 0 || w <= 0)
    return p;
  p.z = sqrtl(zz);
  return p;
}

/* T^-1 h: h as the unmoved distribution sees it. */
vec ref_carried_by(shade_detail detail, const shade_params *p, vec n, vec h) {
  const vec ex = {1, 0, 0}, ey = {0, 1, 0}, ez = {0, 0, 1};
  switch (detail) {
  case SHADE_DETAIL_PERTURB: {
    /* the angle to n from its sine and cosine: acos would lose digits near 0 */
    real theta = atan2l(length(cross(n, h)), dot(n, h));
    real phi = h.x == 0 && h.y == 0 ? pi / 4 : atan2l(h.y, h.x);
    return (vec){sinl(theta) * cosl(phi), sinl(theta) * sinl(phi), cosl(theta)};
  }
  case SHADE_DETAIL_GRAM_SCHMIDT: {
    vec x = unit(minus(ex, scale(n, n.x)));
    return in_frame(x, cross(n, x), n, h);
  }
  case SHADE_DETAIL_SHORTEST_ARC: { /* the rotation from z to n is that about z x n */
    vec axis = cross(ez, n);
    real s = length(axis);
    if (s == 0)
      return h;
    vec u = scale(axis, 1 / s), v = cross(ez, u); /* u, v, z turn into u, n x u, n */
    vec turned = in_frame(u, cross(n, u), n, h);
    return plus(plus(scale(u, turned.x), scale(v, turned.y)), scale(ez, turned.z));
  }
  case SHADE_DETAIL_ROTATE_APPROXIMATE:
    if (ref_grooves_along_y(p))
      return (vec){h.x - n.x * dot(n, h), n.z * h.y - n.y * h.z, dot(n, h)};
    return (vec){n.z * h.x - n.x * h.z, h.y - n.y * dot(n, h), dot(n, h)};
  case SHADE_DETAIL_DEFORM_LINEAR:
  case SHADE_DETAIL_DEFORM_SMOOTH:
  case SHADE_DETAIL_DEFORM_LINEAR_CONSERVING:
  case SHADE_DETAIL_DEFORM_SMOOTH_CONSERVING:
    return ref_warped(detail, n, h);
  case SHADE_DETAIL_ROTATE:
  case SHADE_DETAIL_AUTO:         /* of a lobe that is not round; ref_method_of */
    if (ref_grooves_along_y(p)) { /* y' = dP/dv of the height field */
      vec y = unit((vec){0, n.z, -n.y});
      return in_frame(cross(y, n), y, n, h);
    }
    vec x = unit((vec){n.z, 0, -n.x}); /* x' = dP/du */
    return in_frame(x, cross(n, x), n, h);
  case SHADE_DETAIL_NONE:
  case SHADE_DETAIL_COUNT:
    break;
  }
  return in_frame(ex, ey, ez, h);
}

vec ref_carried(const shade_params *p, vec n, vec h) {
  return ref_carried_by(ref_method_of(p), p, n, h);
}

/*
 * How much the warp stretches areas of the disc at h, by complex steps: moving x (or y) by i
 * times an amount that no sum notices leaves the derivative, to the last digit, in the
 * imaginary part of every analytic expression; nothing is subtracted.
 */
real ref_stretch(shade_detail detail, vec n, vec h) {
  const real step = 1e-40L;
  int linear =
      detail == SHADE_DETAIL_DEFORM_LINEAR || detail == SHADE_DETAIL_DEFORM_LINEAR_CONSERVING;
  real slope[2][2];
  for (int along = 0; along < 2; along++) {
    long double complex x = h.x, y = h.y;
    if (along == 0)
      x += I * step;
    else
      y += I * step;
    long double complex awayx = x - n.x, awayy = y - n.y;
    long double complex a = awayx * awayx + awayy * awayy, b = n.x * awayx + n.y * awayy;
    long double complex w = 1 - (b + csqrtl(b * b + a * n.z * n.z)) / (n.z * n.z);
    long double complex shift = linear ? w : csqrtl(w);
    slope[along][0] = cimagl(x - shift * n.x) / step;
    slope[along][1] = cimagl(y - shift * n.y) / step;
  }
  return slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0];
}

/* The warps take directions as they are where these are nearly unit. */
vec ref_as_given(const shade_params *p, const double v[3], vec made_unit) {
  vec raw = {v[0], v[1], v[2]};
  return ref_is_warp(p->detail) && fabsl(dot(raw, raw) - 1) < 1e-3L && v[2] > 0 ? raw : made_unit;
}

void shade_ref_carried(const shade_params *p, const double n[3], const double h[3], double m[3]) {
  vec v = ref_carried(p, ref_as_given(p, n, normal(n)), ref_as_given(p, h, direction(h)));
  m[0] = (double)v.x;
  m[1] = (double)v.y;
  m[2] = (double)v.z;
}

void shade_ref_turned(double angle, const double v[3], double out[3]) {
  vec x = {cosl(angle), sinl(angle), 0}, y = {-sinl(angle), cosl(angle), 0}, z = {0, 0, 1};
  vec turned = in_frame(x, y, z, (vec){v[0], v[1], v[2]});
  out[0] = (double)turned.x;
  out[1] = (double)turned.y;
  out[2] = (double)turned.z;
}

/* Of the second moment by its turned sides: R S R^T. */
void shade_ref_turned_slopes(double angle, const double v[5], double out[5]) {
  const real r[2][2] = {{cosl(angle), sinl(angle)}, {-sinl(angle), cosl(angle)}};
  const real s[2][2] = {{v[2], v[3]}, {v[3], v[4]}}, m[2] = {v[0], v[1]};
  real mean[2] = {0, 0}, to[2][2] = {{0, 0}, {0, 0}};
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2; k++) {
      mean[i] += r[i][k] * m[k];
      for (int j = 0; j < 2; j++)
        for (int l = 0; l < 2; l++)
          to[i][j] += r[i][k] * s[k][l] * r[j][l];
    }
  const real all[5] = {mean[0], mean[1], to[0][0], to[0][1], to[1][1]};
  for (int i = 0; i < 5; i++)
    out[i] = (double)all[i];
}
