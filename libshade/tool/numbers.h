/* SPDX-License-Identifier: Apache-2.0 */
/* Sets of numbers of a material: a bit for each row of the table. */
#ifndef SHADE_TOOL_NUMBERS_H
#define SHADE_TOOL_NUMBERS_H

#include <stdio.h>

#include "shade/shade.h"

/* Those that a choice of a list reads, and choices of other lists do not. */
unsigned tool_numbers_of(shade_list list, int value);

/* All that some choice of the list reads. */
unsigned tool_numbers_of_any(shade_list list);

/* The choice that is stated by these numbers and no others, or -1; of several the table's own. */
int tool_choice_stated(shade_list list, unsigned rows);

/* Their options, as in a sentence. */
void tool_print_numbers(FILE *to, unsigned rows);

/* The sets that state a choice of the list, each once. */
void tool_print_statements(FILE *to, shade_list list);

/*
 * The lobe is stated by one set of numbers, whole; any distribution takes any of them. TOOL_DONE,
 * or TOOL_BAD_USAGE after saying what is wrong with those that were given.
 */
int tool_whole_lobe(const char *command, unsigned given);

#endif
