/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The quicker form of Ashikhmin-Shirley, float only: peak * d^e from the cosine d itself,
 * which loses e roundings. n and h are unit. Relative errors against the reference: fast_1e3 and
 * fast_1e5 of its traits. e is in LOG2_UNIT, as log2_1p.
 */
LEAF float fast_power(float d, float e) {
  /* k so that d / 2^k lies between sqrt(1/2) and sqrt(2) */
  uint32_t k = (to_bitsf(d) - 0x3f3504f3u) & 0xff800000u;
  float f = d * from_bitsf(0x3f800000u - k) - 1;
  float log = (float)(int32_t)k + f * SHADE_LOG2_FAST(f);
  float a = -e * log;
  /* to 0 (d may pass 1 by a rounding) and 124, as in exp2_negative */
  int32_t bits = (int32_t)to_bitsf(a), most = (int32_t)to_bitsf(124);
  bits = bits < most ? bits : most;
  float y = from_bitsf((uint32_t)(bits > 0 ? bits : 0));
  const float magic = 12582912;
  float shifted = magic - y;
  float r = (magic - shifted) - y;
  float p = 1 + r * SHADE_EXP2_FAST(r);
  float value = from_bitsf(to_bitsf(p) + (to_bitsf(shifted) << 23));
  return a <= 124 ? value : 0;
}

/* d = n.h; xx and yy squares of the azimuth's components to any common scale. */
LEAF float fast_value(float d, float xx, float yy, float kx, float ky, float peak) {
  float x = LOG2_UNIT * kx, y = LOG2_UNIT * ky;
  float e = (x * xx + (y * yy + 0.5f * TINY * (x + y))) / (xx + (yy + TINY));
  /* the bits of a negative d are a negative number */
  int32_t bits = (int32_t)to_bitsf(d), least = (int32_t)to_bitsf(1e-30f);
  float value = peak * fast_power(from_bitsf((uint32_t)(bits > least ? bits : least)), e);
  return d > 0 ? value : 0;
}

LEAF float fast_none(float nx, float ny, float nz, float hx, float hy, float hz, float kx, float ky,
                     float peak) {
  (void)nx, (void)ny, (void)nz;
  return fast_value(hz, hx * hx, hy * hy, kx, ky, peak);
}

LEAF float fast_perturb_ratio(float nx, float ny, float nz, float hx, float hy, float hz, float kx,
                              float ky, float peak) {
  return fast_value(dotf(nx, ny, nz, hx, hy, hz), hx * hx, hy * hy, kx, ky, peak);
}

/* method 2, as printed once its sign is mended: x and y short by L, which the ratio ignores */
LEAF float fast_rotate_ratio(float nx, float ny, float nz, float hx, float hy, float hz, float kx,
                             float ky, float peak) {
  float d = dotf(nx, ny, nz, hx, hy, hz);
  float x = differencef(nz, hx, nx, hz), y = multiply_addf(-ny, d, hy);
  return fast_value(d, x * x, y * y, kx, ky, peak);
}
