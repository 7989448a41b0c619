/* SPDX-License-Identifier: Apache-2.0 */
#define ISA avx2
#include "isa_body.h"
