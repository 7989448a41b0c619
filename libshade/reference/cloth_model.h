/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of the cloth reference use of one another. */
#ifndef SHADE_REFERENCE_CLOTH_MODEL_H
#define SHADE_REFERENCE_CLOTH_MODEL_H

#include "cloth.h"
#include "vec.h"

/* shade_crossing in long double; kind: the yarn on top, in a gap the one that the draft has there.
 */
typedef struct ref_point {
  int kind, gap, below, yarn;
  real sigma, along, dx, dy, tx, ty, occlusion, brightness, fuzz;
} ref_point;

/* x within [low, high]; NaN is `initial`. */
double ref_number(double x, double low, double high, double initial);

void ref_mend_weave(shade_ref_cloth *c);

ref_point ref_look(const shade_ref_cloth *c, double u, double v);

/* The linear colour that the draft gives a yarn. */
void ref_draft_color(const shade_ref_cloth *c, int kind, int index, real color[3]);

/* v in the frame of a cloth bent to n, as the yarns of one kind follow it; in that of fibres. */
vec ref_in_cloth(int kind, vec n, vec v);
vec ref_along_fibres(real tx, real ty, vec v);

/* The lobe of a yarn whose fibres run along x, kd 1. */
shade_params ref_yarn_lobe(const shade_fabric_params *p, const shade_yarn *yarn);

/* What a yarn of normal n sends on: of its surface, and of its inside for a kd of 1; f cos. */
void ref_yarn(const shade_params *lobe, vec n, vec wi, vec wo, real glossy[3], real matt[3]);

/* The diffuse reflectance there, without occlusion: of the yarn, of what a gap shows. */
void ref_point_color(const shade_ref_cloth *c, const ref_point *at, real color[3]);

/* What a nap makes of s; ci and co: about the cloth's normal. */
void ref_nap(const shade_fabric_params *p, real ci, real co, real s[3]);

/* How the yarns lean, over 4096 points. */
void ref_find_leans(shade_ref_cloth *c);

/* s times what the yarns leave one another of the light from wi. n: of the fold, as for
 * ref_in_cloth. */
void ref_shade_by_yarns(const shade_ref_cloth *c, vec n, vec wi, real s[3]);

/* A hit, and what it sends on by the rule of `hard`. */
typedef struct ref_hit {
  const shade_ref_cloth *cloth;
  const ref_point *at;        /* of the near model */
  const shade_ref_seen *seen; /* of the single lobes */
  void (*by)(const struct ref_hit *hit, vec n, vec wi, vec wo, real s[3]);
} ref_hit;

/* s with the cloth's horizon. Status bits. */
unsigned ref_cloth_s(const ref_hit *hit, const double n[3], const double wi[3], const double wo[3],
                     double s[3]);

#endif
