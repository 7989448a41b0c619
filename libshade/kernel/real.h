/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The number type of this instantiation. kernel.h is included once with
 * SHADE_FLOAT 1 and once with SHADE_FLOAT 0, hence no include guard.
 * FN(name) ends float functions in f, R(1.5) writes a constant of the type.
 */
#ifndef LEAF
/* One call that is not inlined and the loop around it stays scalar. */
#if defined(__GNUC__)
#define LEAF static inline __attribute__((always_inline))
#else
#define LEAF static inline
#endif
#endif

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
#define TINY 1e-29f /* floor of squared cosines: 1e8 / TINY is still finite */
#else
#define real double
#define real_bits uint64_t
#define FN(name) name
#define R(x) x
#define TINY 1e-290
#endif
