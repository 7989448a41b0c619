/* SPDX-License-Identifier: Apache-2.0 */
#define ISA sse2
#include "isa_body.h"
