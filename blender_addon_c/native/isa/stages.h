/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Each file here is a family of stages: it includes them and names them, STAGES(<file>) = {...}, a
 * part of the stage_table. It is compiled for each instruction set, ISA; choose.c puts a table
 * together of its parts.
 */
#ifndef LIBSHADE_ISA_STAGES_H
#define LIBSHADE_ISA_STAGES_H

#include "stage/stage.h"

#define STAGES(family) STAGES_OF(family, ISA)
#define STAGES_OF(family, isa) STAGES_OF_(family, isa)
#define STAGES_OF_(family, isa) const stage_table stages_##family##_##isa

#endif
