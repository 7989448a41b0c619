/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The number type of this instantiation. kernel.h is included once with
 * SHADE_FLOAT 1 and once with SHADE_FLOAT 0, hence no include guard.
 * FN(name) ends float functions in f, R(1.5) writes a constant of the type.
 */
#undef real
#undef real_bits
#undef FN
#undef R
#undef TINY
#if SHADE_FLOAT
#define real float
#define real_bits uint32_t
#define FN(name) name##f
#define R(x) x##f
#define TINY 1e-37f /* floor of divisors: four times its inverse is still finite */
#else
#define real double
#define real_bits uint64_t
#define FN(name) name
#define R(x) x
#define TINY 1e-300
#endif
