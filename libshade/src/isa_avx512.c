/* SPDX-License-Identifier: Apache-2.0 */
#define ISA avx512
#include "isa_body.h"
