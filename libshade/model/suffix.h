/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A unit has one precision: float where it is compiled with SHADE_FLOAT 1, else double. What is
 * static in it needs no suffix; what others see, and what they hold in both precisions, ends in f
 * in float: SUFFIX(shade_lanes) is shade_lanes or shade_lanesf.
 */
#ifndef SHADE_MODEL_SUFFIX_H
#define SHADE_MODEL_SUFFIX_H

#ifndef SHADE_FLOAT
#define SHADE_FLOAT 0
#endif

#if SHADE_FLOAT
#define SUFFIX(name) name##f
#else
#define SUFFIX(name) name
#endif

#endif
