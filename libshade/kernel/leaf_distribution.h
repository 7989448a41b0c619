/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Points of the lobe to D. kx and ky are the exponents for Ashikhmin-Shirley and
 * 1/alpha^2 for the others; peak is D at the pole: sqrt((ex+1)(ey+1))/(2 pi), or
 * 1/(pi ax ay).
 *
 * Below the horizon t is -1, and its size does as well as 0: the result is 0 there. (A maximum
 * would be one more condition on t for compilers to split the computation at; see TINY.)
 *
 * Errors, all distributions, against the reference on the same inputs, D > 1e-12 of the
 * peak, z >= 0.05, tilts to 89.9 degrees, e standing for 2/alpha^2 - 2: float 2e-5 at e
 * to 1e3, 2e-4 to 1e5; double 1e-12 to 1e4. Worst where D is smallest and e largest.
 */

/*
 * Ashikhmin-Shirley: peak * cos^e, e = (ex xx + ey yy)/(xx + yy), with the power
 * as 2^(-e/2 log2(1 + tan^2)): pow(cos, e) would lose e roundings. Integrates
 * to 1 over the hemisphere without a cosine. [AshikhminShirley2000 Eq. 4; CONVENTIONS.md, Detail]
 */
LEAF real FN(ashikhmin_shirley)(FN(lobe_ratio) p, real kx, real ky, real peak) {
  real x = R(0.5) * LOG2_UNIT * kx, y = R(0.5) * LOG2_UNIT * ky;
  real mean = R(0.5) * TINY * (x + y); /* where there is no azimuth */
  real e = (x * p.xx + (y * p.yy + mean)) / (p.xx + (p.yy + TINY));
  real value = peak * FN(exp2_negative)(e * FN(log2_1p)(p.ss, p.zz + TINY));
  return p.above ? value : 0;
}

/*
 * Ward: a Gaussian of the slope. Close to normalised without a cosine for small alpha
 * only: 0.888 at alpha 0.3. [Ward1992 Eq. 4, with the squares]
 */
LEAF real FN(ward)(FN(lobe_point) p, real kx, real ky, real peak) {
  real value = peak * FN(exp_negative)(kx * p.xx + ky * p.yy);
  return p.t >= 0 ? value : 0;
}

/*
 * Ward's cheap form, exp(-2 ((x/ax)^2 + (y/ay)^2)/(1 + z)); sin^2/(1 + cos) from tangents
 * is tan^2/(u + sqrt u), u = 1 + tan^2. Round lobes integrate to 1 - exp(-2/alpha^2)
 * without a cosine. [Ward1992 Eq. 5b]
 */
LEAF real FN(ward_half)(FN(lobe_point) p, real kx, real ky, real peak) {
  real u = 1 + FN(absolute)(p.t);
  real value = peak * FN(exp_negative)(2 * (kx * p.xx + ky * p.yy) / (u + FN(root)(u)));
  return p.t >= 0 ? value : 0;
}

/*
 * Beckmann. Integrates to 1 over the hemisphere with the cosine. Above the cap of u,
 * alpha = 10, the broadest, is below 1e-420 of its peak; the cap keeps u^2 finite and D
 * under 4e17. [CookTorrance1982 Eq. 14; Heitz2014 Eq. 46]
 */
LEAF real FN(beckmann)(FN(lobe_point) p, real kx, real ky, real peak) {
  real u = FN(minimum)(1 + FN(absolute)(p.t), R(1e5));
  real value = peak * (u * u) * FN(exp_negative)(kx * p.xx + ky * p.yy);
  return p.t >= 0 ? value : 0;
}

/*
 * GGX (Trowbridge-Reitz). Integrates to 1 over the hemisphere with the cosine. The ratio's
 * cap of 1e5 binds only where rotate_approximate's slopes vanish while t does not; it keeps D
 * under 4e17. [Walter2007 Eq. 33; Heitz2014 Eq. 85]
 */
LEAF real FN(ggx)(FN(lobe_point) p, real kx, real ky, real peak) {
  real t = FN(absolute)(p.t);
  real ratio = (1 + t) / FN(maximum)(1 + (kx * p.xx + ky * p.yy), R(1e-5) * (1 + t));
  real value = peak * (ratio * ratio);
  return p.t >= 0 ? value : 0;
}
