/* SPDX-License-Identifier: Apache-2.0 */
#define ISA scalar
#include "isa_body.h"
