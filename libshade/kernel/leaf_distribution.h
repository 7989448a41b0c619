/* SPDX-License-Identifier: Apache-2.0 */

/*
 * Ashikhmin-Shirley: peak * cos^e, e = (ex xx + ey yy)/(xx + yy), with the power
 * as exp(-e/2 log(1 + tan^2)): pow(cos, e) would lose e roundings. Integrates
 * to 1 over the hemisphere without a cosine. [AshikhminShirley2000 Eq. 4; method 2.8]
 *
 * Float, against the reference on the same float inputs, D > 1e-12 of the peak, z >= 0.05,
 * tilts to 89.9 degrees: 2e-5 at exponents to 1e3, 2e-4 to 1e5. Double: 1e-12 to 1e4.
 */
static inline real FN(ashikhmin_shirley)(FN(lobe_point) p, real ex, real ey, real peak) {
  real radius = p.xx + p.yy;
  real weight = radius > 0 ? radius : 1;
  real e = radius > 0 ? (ex * p.xx + ey * p.yy) / weight : R(0.5) * (ex + ey);
  real t = FN(maximum)(p.t, 0);
  real value = peak * FN(exp_negative)(R(0.5) * e * FN(log1p_positive)(t));
  return p.t >= 0 ? value : 0;
}
