/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of a shade_bsdf: what setup.c works out and evaluation reads. Private to libshade/,
 * test/. */
#ifndef SHADE_MODEL_BSDF_H
#define SHADE_MODEL_BSDF_H

#include <string.h>

#include "shade/shade.h"
#include "methods.h"
#include "suffix.h"

/* How h is carried. */
typedef struct shade_carry {
  shade_map map, shadow; /* of h for D; of wi and wo for Smith's Lambda */
  shade_map frame;       /* the rigid frame or warp that h is drawn in */
  int parts;             /* lobes of the proposal */
  int short_by_l;        /* slopes are read from a ratio form: rotate_approximate */
} shade_carry;

/* The caller's room is an array of doubles: not for the compiler to tell apart from this. */
#if defined(__GNUC__)
#define MAY_ALIAS __attribute__((may_alias))
#else
#define MAY_ALIAS
#endif

/* Numbers of a type. */
#define BSDF_NUMBERS(type, f)                                                                      \
  typedef struct bsdf_numbers##f {                                                                 \
    type kx, ky, peak;                /* exponents or 1/alpha^2, and D at the pole */              \
    type gx, gy;                      /* alpha^2 for Lambda */                                     \
    type f0[3], tint[3], k[3], kd[3]; /* tint: f82, or eta */                                      \
    type proposal, per_slope;         /* of the distribution's traits */                           \
    type share_lobe, share_diffuse;   /* mean reflectances */                                      \
    type c, s, side; /* where turned: x' is (c, s), y' the other way at side -1 */                 \
    type slopes[5];  /* of the map, as shade_params has them */                                    \
  } bsdf_numbers##f;
BSDF_NUMBERS(double, )
BSDF_NUMBERS(float, f)

typedef struct MAY_ALIAS bsdf {
  int isa; /* of shade_isa_tables: what it runs on */
  shade_mdf mdf;
  shade_brdf brdf;
  shade_detail detail;
  shade_fresnel fresnel;
  shade_diffuse diffuse;
  shade_horizon horizon;     /* hard where n is ignored */
  shade_carry carry, uneven; /* of this lobe; of lobes that need not be round, where these are */
  shade_map_kind warp;
  int conserve, has_specular, has_diffuse;
  int black; /* its own f0 is, and stays so at grazing: the lobe gives nothing */
  int fibres_along_y, groove_auto, detail_auto;
  int exponents, projected; /* of the distribution's traits */
  int multiscatter;         /* f is multiplied by what multiscatter.h says */
  int visible, draw_even;   /* draws: normals as the eye sees them; half the diffuse part evenly */
  int varied, turned;       /* by shade_bsdf_vary; and directions are in another frame than it */
  bsdf_numbers numbers;
  bsdf_numbersf numbersf;
} bsdf;

_Static_assert(sizeof(bsdf) <= sizeof(shade_bsdf), "shade_bsdf is too small for what it holds");
_Static_assert(_Alignof(bsdf) <= _Alignof(shade_bsdf), "shade_bsdf is less aligned than that");

static inline const bsdf *bsdf_of(const shade_bsdf *b) {
  return (const bsdf *)b;
}

/* Its numbers in the precision of the unit. */
static inline const SUFFIX(bsdf_numbers) * numbers_of(const bsdf *b) {
  return &b->SUFFIX(numbers);
}

/* The same to write to: setup.c's, shade_bsdf_vary's, and that of tests. */
static inline bsdf *bsdf_in(shade_bsdf *b) {
  return (bsdf *)b;
}

/* The numbers of one precision from those of the other. */
enum { BSDF_NUMBERS_EACH = sizeof(bsdf_numbers) / sizeof(double) };
_Static_assert(sizeof(bsdf_numbersf) == BSDF_NUMBERS_EACH * sizeof(float), "nothing but numbers");
#define BSDF_CONVERT(name, from, FROM, to, TO)                                                     \
  static inline void name(bsdf *b) {                                                               \
    FROM given[BSDF_NUMBERS_EACH];                                                                 \
    TO made[BSDF_NUMBERS_EACH];                                                                    \
    memcpy(given, &b->from, sizeof given);                                                         \
    for (int i = 0; i < BSDF_NUMBERS_EACH; i++)                                                    \
      made[i] = (TO)given[i];                                                                      \
    memcpy(&b->to, made, sizeof made);                                                             \
  }
BSDF_CONVERT(narrow_numbers, numbers, double, numbersf, float)
BSDF_CONVERT(widen_numbers, numbersf, float, numbers, double)

#endif
