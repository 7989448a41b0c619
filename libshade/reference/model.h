/* SPDX-License-Identifier: Apache-2.0 */
/* What the files of the reference use of one another. n, wi, wo and h are unit. */
#ifndef SHADE_REFERENCE_MODEL_H
#define SHADE_REFERENCE_MODEL_H

#include "reference.h"
#include "vec.h"

/* ---- detail.c ---- */

int ref_grooves_along_y(const shade_params *p);

/* What `auto` stands for. */
shade_detail ref_method_of(const shade_params *p);

int ref_conserves(shade_detail detail);
int ref_is_warp(shade_detail detail);

/* h as the warp of the unit disc moves it; z = 0 stands for outside. */
vec ref_warped(shade_detail detail, vec n, vec h);

/* How much that warp stretches areas of the disc at h. */
real ref_stretch(shade_detail detail, vec n, vec h);

/* T^-1 h: h as the unmoved distribution sees it, by a method or by the material's own. */
vec ref_carried_by(shade_detail detail, const shade_params *p, vec n, vec h);
vec ref_carried(const shade_params *p, vec n, vec h);

/* A vector as the warps take it: as it is where it is nearly unit. */
vec ref_as_given(const shade_params *p, const double v[3], vec made_unit);

/* ---- lobe.c ---- */

real ref_distribution(const shade_params *p, vec n, vec h);
/* What `auto` stands for, or p's own. */
shade_brdf ref_brdf_of(const shade_params *p);
/* Smith's Lambda. */
real ref_lambda(const shade_params *p, vec n, vec w);
/* f of the lobe but for Fresnel; cosi and coso are those about n, d is D'(h). */
real ref_brdf(const shade_params *p, vec n, vec wi, vec wo, real cosi, real coso, real d);
/* Channel c of Fresnel's reflectance. */
real ref_fresnel(const shade_params *p, int c, real cosine);

/* ---- multiscatter.c ---- */

/* The mean of a channel's reflectance over the hemisphere, by the cosine: three points, as the
 * library's. */
real ref_mean_fresnel(const shade_params *p, int channel);
/* What channel c of the lobe is multiplied by for light that facets reflect more than once. */
real ref_multiscatter(const shade_params *p, int c, vec n, vec wo);

/* ---- diffuse.c ---- */

/* Channel c of the diffuse part times the cosine. */
real ref_diffuse_part(const shade_params *p, int c, vec n, vec wi, vec wo);

/* ---- horizon.c ---- */

/* n turned until the mirror image of wo is above the surface, and whether a horizon does that. */
vec ref_bent(vec n, vec wo);
int ref_bends(shade_horizon horizon);

/* Facets of a surface that is flat as a whole: the bumped one and the upright one. */
typedef struct facets {
  vec normal[2];
  real area[2]; /* a patch of unit area has the sum of area * normal = z */
} facets;
enum { BUMPED, UPRIGHT };

facets ref_facets_of(vec n);
/* Share of the projected surface that a facet takes up, seen from w. */
real ref_facet_share(const facets *s, int facet, vec w);
/* How much of a facet is not hidden from w. */
real ref_unhidden(const facets *s, int facet, vec w);

/* What is left of the light, by horizon. */
real ref_shadow(shade_horizon horizon, vec n, vec wi);

/* ---- pdf.c ---- */

/* One lobe of half vectors: two exponents for Ashikhmin-Shirley and Ward, else two alphas. */
typedef struct proposal {
  real x, y, weight;
} proposal;
/* The lobes that the method draws from under n: how many, at most three. */
int ref_proposals(const shade_params *p, vec n, proposal q[3]);
/* The method whose frame they are drawn in, and whether as the eye sees them. */
shade_detail ref_drawn_in(const shade_params *p);
int ref_draws_visible(const shade_params *p);
/* Density of wi about n by the lobe; wi and wo are above n's horizon. */
real ref_lobe_density(const shade_params *p, vec n, vec wi, vec wo);
/* The lobe's density beside that of the diffuse part about n. */
real ref_with_matt(const shade_params *p, vec n, vec wi, vec wo, real density);

/* ---- mutual.c ---- */

/* Whether the material has slopes for bumps to shade each other by. */
int ref_has_bumps(const shade_params *p);
void ref_mutual_f(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo, real f[3]);
real ref_mutual_density(const shade_params *p, vec n, vec lobe_n, vec wi, vec wo);

#endif
