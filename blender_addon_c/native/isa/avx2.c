/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "isa/stages.h"

STAGE_TABLE(avx2);
