/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Where the half vector lies in the carried distribution. Each leaf turns
 * (n, h) into what every distribution needs:
 *   t       tan^2 of the angle between h and the carried pole; -1 when h is
 *           on or below its horizon, where D' = 0
 *   xx, yy  squares of the slope of h along x and y; xx + yy = t
 * h need not be unit: only its direction counts. The tangents come from cross
 * products, because 1 - (n.h)^2 and h_y - n_y (n.h) cancel (method 2.8).
 */
typedef struct FN(lobe_point) {
  real t, xx, yy;
} FN(lobe_point);

/* From squared sines along x and y and a squared cosine, to any common scale. */
LEAF FN(lobe_point) FN(lobe_at)(real xx, real yy, real zz, int above) {
  real inverse = 1 / FN(maximum)(zz, TINY);
  FN(lobe_point) p = {-1, xx * inverse, yy * inverse};
  p.t = above ? p.xx + p.yy : -1;
  return p;
}

/* The perturbed normal is ignored. */
LEAF FN(lobe_point) FN(detail_none)(real hx, real hy, real hz) {
  return FN(lobe_at)(hx * hx, hy * hy, hz * hz, hz > 0);
}

/*
 * Plain normal mapping: the polar angle from n, the azimuth from the unperturbed
 * frame. This form is for Ashikhmin-Shirley, which reads only the ratio of xx and yy
 * and takes cos^2 = 1/2 where both are 0: they are not the slopes here.
 */
LEAF FN(lobe_point) FN(detail_perturb_ratio)(real nx, real ny, real nz, real hx, real hy, real hz) {
  FN(lobe_point) p;
  real cx = ny * hz - nz * hy;
  real cy = nz * hx - nx * hz;
  real cz = nx * hy - ny * hx;
  real d = nx * hx + ny * hy + nz * hz;
  real t = (cx * cx + cy * cy + cz * cz) / FN(maximum)(d * d, TINY);
  p.xx = hx * hx;
  p.yy = hy * hy;
  p.t = d > 0 ? t : -1;
  return p;
}

/*
 * The same with slopes. Over the unperturbed pole the azimuth is undefined and cos^2 = 1/2
 * stands for it.
 */
LEAF FN(lobe_point) FN(detail_perturb)(real nx, real ny, real nz, real hx, real hy, real hz) {
  FN(lobe_point) p = FN(detail_perturb_ratio)(nx, ny, nz, hx, hy, hz);
  real radius = p.xx + p.yy;
  int pole = !(radius > TINY);
  real scale = FN(maximum)(p.t, 0) / (pole ? 1 : radius);
  p.xx = (pole ? R(0.5) : p.xx) * scale;
  p.yy = (pole ? R(0.5) : p.yy) * scale;
  return p;
}

/*
 * Groove transport: the frame whose x' = (nz, 0, -nx)/L is dP/du of the height
 * field with normal n, L^2 = nx^2 + nz^2. [KangCho Eq. 9, sign corrected: method 2.1]
 * Grooves along y, and Gram-Schmidt, are this with x and y exchanged.
 */
LEAF FN(lobe_point) FN(detail_rotate)(real nx, real ny, real nz, real hx, real hy, real hz) {
  /* Near L = 0 the squares below would underflow; only the ratio nx : nz matters. */
#if SHADE_FLOAT
  const real small = 0x1p-40f, step = 0x1p40f;
#else
  const real small = 0x1p-300, step = 0x1p300;
#endif
  real size = FN(maximum)(nx < 0 ? -nx : nx, nz);
  real scale = size < small ? step : 1;
  scale = size * scale < small ? scale * step : scale;
  real a = nx * scale, c = nz * scale;
  real x = c * hx - a * hz;
  real y = a * (nx * hy - ny * hx) + c * (nz * hy - ny * hz);
  real d = nx * hx + ny * hy + nz * hz;
  return FN(lobe_at)(x * x, y * y, (a * a + c * c) * (d * d), d > 0);
}
