/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The reference: every formula long-hand, with trigonometry, normalised frames and
 * long double, and nothing shared with model/, batch/ or src/. It is what they are
 * checked against; nobody should render with it.
 */
#ifndef SHADE_REFERENCE_H
#define SHADE_REFERENCE_H

#include "shade/shade.h"

/*
 * D'(h) in 1/sr. n and h are normalised in long double first; n.z <= 0 becomes 1e-4
 * and n is renormalised. Parameters are clamped to the table's ranges. 0 for
 * non-finite or zero vectors.
 */
double shade_ref_mdf(const shade_params *p, const double n[3], const double h[3]);

/*
 * T^-1 h: where the unmoved distribution sees h. Unit, except that rotate_approximate
 * leaves x and y short by L; z <= 0 where D' = 0. n and h must be usable directions.
 */
void shade_ref_carried(const shade_params *p, const double n[3], const double h[3], double m[3]);

/* f and its cosine, by the contract of shade_bsdf_eval. */
unsigned shade_ref_f(const shade_params *p, const double n[3], const double wi[3],
                     const double wo[3], double f[3], double *cosine);

/* The density of wi by the contract of shade_bsdf_pdf. */
double shade_ref_pdf(const shade_params *p, const double n[3], const double wi[3],
                     const double wo[3]);

/*
 * For horizon `mutual`: the share of the light that other bumps keep back, as f has it, or by an
 * integral of so many steps of the height.
 */
double shade_ref_kept_back(const shade_params *p, const double n[3], const double wo[3], int steps);

/*
 * The normal whose lobe and horizon f has under p->horizon: n, made unit and lifted as above,
 * and for valid_reflection and valid_estevez bent by wo. n and wo must be usable directions.
 */
void shade_ref_normal(const shade_params *p, const double n[3], const double wo[3], double out[3]);

/*
 * v as it is seen from a frame whose x axis is turned about z by `angle`, anticlockwise: a sample
 * whose grooves run another way is shaded with n, wi and wo turned so. v and out may be the same.
 */
void shade_ref_turned(double angle, const double v[3], double out[3]);
/* The same of slopes, as shade_params has them. */
void shade_ref_turned_slopes(double angle, const double v[5], double out[5]);

/*
 * Phi by the contract of shade_diffuse_eval, the fibre models by quadrature.
 * poulin_fournier is the real one: a layer of touching fibres that shade and hide each other.
 */
double shade_ref_diffuse(shade_diffuse model, const double l[3], const double v[3]);

#endif
