/* SPDX-License-Identifier: Apache-2.0 */
/* Evaluation of a fabric: near, far and between; the entries of fabric.h. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "fabric.h"
#include "isa.h"
#include "lanes.h"
#include "../kernel/coefficients.h"

enum { LANES = 256, TERMS = FABRIC_POINTS + 1 };

#define SHADE_FLOAT 1
#include "fabric_eval.h"
#include "fabric_batch.h"
#undef SHADE_FLOAT
#define SHADE_FLOAT 0
#include "fabric_eval.h"
#include "fabric_batch.h"
