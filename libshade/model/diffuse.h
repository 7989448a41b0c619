/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Diffuse reflection of a fibre: Phi, where f cos = kd Phi/pi and Lambert's Phi is n.l.
 * Each leaf takes the components of light and eye across the fibre (ly, vy) and along the
 * normal (lz, vz); what lies along the fibre never enters, so l parallel to it is no special
 * case. lz and vz are > 0. Absolute errors against quadrature: float 5e-7, double 2e-15.
 */
#ifndef SHADE_MODEL_DIFFUSE_H
#define SHADE_MODEL_DIFFUSE_H

#include "bsdf.h"
#include "fresnel.h"

LEAF real diffuse_lambert(real ly, real lz, real vy, real vz) {
  (void)ly, (void)vy, (void)vz;
  return lz;
}

/* l.n_max = sqrt(1 - (l.t)^2), n_max the normal of the fibre nearest to the light. */
LEAF real diffuse_max_normal(real ly, real lz, real vy, real vz) {
  (void)vy, (void)vz;
  return root(ly * ly + lz * lz);
}

/*
 * The mean of max(n'.l, 0) over the fibre's upper half. The printed form,
 * (l.n_max)(1 - n_min.b), takes the wrong sign for l.t < 0 and is 0/0 at l.t = 0 and at
 * l parallel to t. [Hast2004; method 3]
 */
LEAF real diffuse_fibre(real ly, real lz, real vy, real vz) {
  (void)vy, (void)vz;
  return (root(ly * ly + lz * lz) + lz) * R(0.31830988618379067154);
}

/*
 * The integral of (n'.l)(n'.v) over the lit and visible arc, by that of n'.v over the
 * visible one. psi is the angle missing from the half circle: where light and eye are on
 * different sides, that between them; else that of the lower one. v parallel to the fibre
 * counts as v = n. [PoulinFournier1990 without neighbours; method 3]
 */
LEAF real diffuse_fibre_view(real ly, real lz, real vy, real vz) {
  int blind = vy * vy + vz * vz < TINY;
  vy = blind ? 0 : vy;
  vz = blind ? 1 : vz;
  real al = absolute(ly), av = absolute(vy);
  real c = ly * vy + lz * vz;
  real across = ly * vz - lz * vy;
  int apart = ly * vy < 0, light = al * vz >= av * lz;
  real s = apart ? absolute(across) : light ? al * vz : av * lz;
  real y = apart ? s : light ? al : av, x = apart ? c : light ? lz : vz;
  real open = R(3.14159265358979323846) - angle_of(y, x);
  real seen = root(vy * vy + vz * vz) + vz;
  return maximum(open * c + s, 0) / (2 * seen);
}

/* The reference's alone, by quadrature; here without the neighbours' shadows. */
LEAF real diffuse_poulin_fournier(real ly, real lz, real vy, real vz) {
  return diffuse_fibre_view(ly, lz, vy, vz);
}

/* (28/23)(1 - (1 - l.n/2)^5)(1 - (1 - v.n/2)^5) n.l; the factor 1 - f0 is the caller's.
   [AshikhminShirley2000 Eq. 5] */
LEAF real diffuse_ashikhmin_shirley(real ly, real lz, real vy, real vz) {
  (void)ly, (void)vy;
  real white = (1 - schlick_weight(R(0.5) * lz)) * (1 - schlick_weight(R(0.5) * vz));
  return R(28.0) / R(23.0) * white * lz;
}

/*
 * y' . w, the component across fibres along the x' of groove transport. At L = 0, where x'
 * is anything, 0. Grooves along y: the same with x and y exchanged. Absolute error, tilts to
 * 89.9 degrees: float 3e-7, double 6e-16, worst at the largest tilt.
 */
LEAF real over_fibre(real nx, real ny, real nz, real wx, real wy, real wz) {
  /* L times that */
  return dot2(nx, nz, difference(nx, wy, ny, wx), difference(nz, wy, ny, wz));
}
LEAF real fibre_length(real nx, real nz) {
  return root(nx * nx + nz * nz) + TINY;
}
LEAF real across_fibre(real nx, real ny, real nz, real wx, real wy, real wz) {
  return over_fibre(nx, ny, nz, wx, wy, wz) / fibre_length(nx, nz);
}

/* What Schlick's white share leaves of the light that enters and leaves by cosines ci and co. */
LEAF real let_in_and_out(real ci, real co) {
  const real enter = 1 - schlick_weight(minimum(ci, 1)), leave = 1 - schlick_weight(minimum(co, 1));
  return enter * leave;
}

/* Phi of a model; an unknown one is the first. */
LEAF real diffuse_phi(shade_diffuse model, real ly, real lz, real vy, real vz) {
  switch (model) {
#define DIFFUSE_CASE(NAME, word, value, label, help)                                               \
  case SHADE_DIFFUSE_##NAME:                                                                       \
    return diffuse_##word(ly, lz, vy, vz);
    SHADE_TABLE_DIFFUSE(DIFFUSE_CASE)
#undef DIFFUSE_CASE
  case SHADE_DIFFUSE_COUNT:
    break;
  }
  return diffuse_lambert(ly, lz, vy, vz);
}

/* kd of channel c, less what Ashikhmin and Shirley give to the specular part. */
static inline real diffuse_scale(const bsdf *b, int c) {
  return shade_diffuse_is(b->diffuse).less_f0 ? numbers_of(b)->kd[c] * (1 - numbers_of(b)->f0[c])
                                              : numbers_of(b)->kd[c];
}

#endif
