/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 1 */
/* The same in float. */
#define SHADE_FLOAT 1
#include "test_elementary.c"
