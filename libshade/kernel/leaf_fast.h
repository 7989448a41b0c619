/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The quicker form of Ashikhmin-Shirley, float only: peak * d^e from the cosine d itself,
 * which loses e roundings. n and h are unit. Relative error against the reference, D > 1e-12
 * of the peak, z >= 0.05, tilts to 89.9 degrees: 2e-4 at exponents to 1e3, 2e-2 to 1e5.
 */
LEAF float fast_power(float d, float e) {
  /* the floor of the exponent over sqrt(1/2), biased so that the shift sees no sign */
  uint32_t k = (to_bitsf(d) - 0x3f3504f3u + (127u << 23)) >> 23;
  float f = d * from_bitsf((254u - k) << 23) - 1;
  float log = (float)((int32_t)k - 127) * 0.693147181f + f * SHADE_LOG_FAST(f);
  float a = maximumf(-e * log, 0); /* d may pass 1 by a rounding */
  float y = a < 86 ? a : 86;
  const float magic = 12582912; /* as in exp_negative */
  float shifted = magic - y * SHADE_LOG2E_F;
  float r = -y - (shifted - magic) * 0.693147181f;
  float p = 1 + (r + r * r * SHADE_EXP_FAST(r));
  float value = from_bitsf(to_bitsf(p) + (to_bitsf(shifted) << 23));
  return a <= 86 ? value : 0;
}

/* d = n.h; xx and yy squares of the azimuth's components to any common scale. */
LEAF float fast_value(float d, float xx, float yy, float kx, float ky, float peak) {
  float e = (kx * xx + ky * yy + 0.5f * TINY * (kx + ky)) / (xx + yy + TINY);
  float value = peak * fast_power(maximumf(d, 1e-30f), e);
  return d > 0 ? value : 0;
}

LEAF float fast_none(float nx, float ny, float nz, float hx, float hy, float hz, float kx, float ky,
                     float peak) {
  (void)nx, (void)ny, (void)nz;
  return fast_value(hz, hx * hx, hy * hy, kx, ky, peak);
}

LEAF float fast_perturb(float nx, float ny, float nz, float hx, float hy, float hz, float kx,
                        float ky, float peak) {
  return fast_value(nx * hx + ny * hy + nz * hz, hx * hx, hy * hy, kx, ky, peak);
}

/* method 2, as printed once its sign is mended: x and y short by L, which the ratio ignores */
LEAF float fast_rotate(float nx, float ny, float nz, float hx, float hy, float hz, float kx,
                       float ky, float peak) {
  float d = nx * hx + ny * hy + nz * hz;
  float x = nz * hx - nx * hz, y = hy - ny * d;
  return fast_value(d, x * x, y * y, kx, ky, peak);
}
