/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stages.h"

STAGE_TABLE(scalar);
