/* SPDX-License-Identifier: Apache-2.0 */

/* wi + wo of opposite directions. */
LEAF int FN(no_direction)(real hx, real hy, real hz) {
  return !(hx * hx + hy * hy + hz * hz > R(1e-30));
}

/* Only the warps need a unit h. */
LEAF real FN(scale_to_unit)(real hx, real hy, real hz) {
  return 1 / FN(root)(FN(maximum)(hx * hx + hy * hy + hz * hz, TINY));
}

/* Half of |wi + wo| is the cosine h.wo: no cancellation, no normalised h. */
LEAF real FN(half_cosine)(real hx, real hy, real hz) {
  return FN(minimum)(R(0.5) * FN(root)(hx * hx + hy * hy + hz * hz), 1);
}

/*
 * Ashikhmin-Shirley's specular term without Fresnel: D / (4 (h.wo) max(n.wi, n.wo)).
 * The floor keeps it finite at grazing; the reference has the same one.
 * [AshikhminShirley2000 Eq. 4]
 */
LEAF real FN(brdf_ashikhmin_shirley)(real d, real hwo, real cosi, real coso) {
  real denominator = 4 * hwo * FN(maximum)(cosi, coso);
  return d / FN(maximum)(denominator, R(1e-20));
}

/* (1 - cos)^5, the share of white in Schlick's Fresnel. [Schlick1994 Eq. 15] */
LEAF real FN(schlick_weight)(real hwo) {
  real m = 1 - hwo;
  real m2 = m * m;
  return m2 * m2 * m;
}
