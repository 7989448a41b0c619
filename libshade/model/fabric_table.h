/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What stands for a mixture of up to 256 lobes of a yarn: tables, looked up once for each pair of
 * light and eye, in place of every lobe in turn. All directions are unit and in the frame of the
 * lobes: x along the fibres, z out of the cloth.
 *
 * The specular part is D(h) / (4 (h.wo)) times the mean, over the lobes that share h, of
 * min(1, n.wi / n.wo) within both horizons. Since n.wi = n.h' + n.d and n.wo = n.h' - n.d, where h'
 * and d are half the sum and difference of wi and wo, that factor depends on t = n.d / n.h' alone.
 *
 * The lobes are sorted into strips by their tilt across the fibres, where they spread most for
 * their width. D is tabled over h for each strip, and so are, for all of them, mean and variance of
 * the normal's sine along the fibres (h fixes it nearly, where the lobe is narrow). Within a
 * strip t is taken as spread evenly, with the mean and variance that follow, for which the mean of
 * the factor has a closed form.
 *
 * Where wi and wo are far apart that factor asks how the lobes are spread rather than how far: the
 * specular part of the mixture itself is used below FABRIC_APART, across a fade.
 *
 * The diffuse part is a sum over lobes of products of a function of wi and one of wo: its best
 * approximation by FABRIC_RANK such products, each factor tabled.
 *
 * Tables are over the half angles' tangents X = x / (1 + L), Y = y / (z + L), L = hypot(y, z), both
 * in [-1, 1] for the upper half: lobes are narrow in X or Y alone, and nothing is singular but
 * X = +-1. Read by any number of threads.
 */
#ifndef SHADE_MODEL_FABRIC_TABLE_H
#define SHADE_MODEL_FABRIC_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "shade/shade.h"

/* wi.wo where the tables begin to count, and where they are all: 104 and 90 degrees. */
#define FABRIC_APART (-0.25)
#define FABRIC_NEARBY 0.0

enum {
  FABRIC_FINE = 256,       /* lobes of the specular part, at most */
  FABRIC_MATT_LOBES = 128, /* and of the diffuse part */
  FABRIC_STRIPS = 6,
  FABRIC_ALONG = FABRIC_STRIPS, /* the mean sine of the tilt along the fibres, from -1 */
  FABRIC_VARIANCE,              /* and its variance */
  FABRIC_FIELDS,                /* of a vertex, after D of each strip; in units of their own */
  FABRIC_RANK = 4,
  FABRIC_MATT_SIDE = 33, /* vertices of a diffuse table along a side */
  FABRIC_LEAST_SIDE = 61,
  FABRIC_MOST_SIDE = 471 /* and of D's, by the width of the lobe */
};

typedef struct fabric_table {
  int columns, rows; /* vertices of D along X and Y */
  uint16_t *spec;    /* FABRIC_FIELDS a vertex */
  float unit[FABRIC_FIELDS];
  /* of each strip: mean and variance of the tangent of the tilt across the fibres, what D counts;
   * 0 for fields that are no strips */
  float tilt[FABRIC_FIELDS], spread[FABRIC_FIELDS], scale[FABRIC_FIELDS];
  int16_t *matt[2]; /* of wi, of wo: FABRIC_RANK factors a vertex */
  float matt_unit[FABRIC_RANK];
  size_t bytes; /* of all tables */
} fabric_table;

/* A mixture: `count` lobes alike with normals n (x, y, z), whose weights add up to 1. */
typedef struct fabric_lobes {
  const shade_bsdf *bsdf;
  size_t count;
  const double *n[3], *weight;
} fabric_lobes;

/*
 * Whether tables model lobes like this: of Ashikhmin and Shirley's BRDF with a detail method other
 * than none and perturb, a diffuse model that does not see both directions at once, and not too
 * narrow for FABRIC_MOST_SIDE (exponents to some 1100).
 */
int shade_fabric_table_models(const shade_bsdf *lobe);

/*
 * Tables of two mixtures of the same yarn: that of `spec` may be finer, to FABRIC_FINE lobes,
 * than that of `matt`, to FABRIC_MATT_LOBES. NULL for what they do not model (the mixture itself
 * is to be used), or out of memory.
 */
fabric_table *shade_fabric_table_create(const fabric_lobes *spec, const fabric_lobes *matt);
void shade_fabric_table_free(fabric_table *table); /* NULL is fine */

#endif
