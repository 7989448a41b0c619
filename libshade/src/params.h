/* SPDX-License-Identifier: Apache-2.0 */
/* A caller's parameters, whichever header it was built against, and the lists they choose from.
 * Private to src/. */
#ifndef SHADE_SRC_PARAMS_H
#define SHADE_SRC_PARAMS_H

#include "shade/fabric.h"
#include "shade/shade.h"

/* Whether somebody set the size that a structure begins with. */
static inline int shade_size_is_set(size_t size) {
  return size >= sizeof size;
}

/*
 * *given, with the defaults for members beyond given->size; but `hard` for the horizon, which
 * was the rule before there was a choice, and the defaults of version 0 where it ends before
 * `defaults`. All defaults where given is NULL or nobody set its size.
 */
shade_params shade_whole_params(const shade_params *given);

/* The same with every choice and number within its list and range; or-s into *status, a size that
 * nobody set too. */
shade_params shade_params_within_ranges(const shade_params *given, unsigned *status);

/* Of structures that end before `defaults`: `auto`, which did not exist, is what was the default.
 */
shade_brdf shade_brdf_before_auto(shade_brdf brdf);

/* As shade_whole_params, of a cloth; `hard` and no shadows where it ends before them. *given has a
 * size. */
shade_fabric_params shade_whole_fabric(const shade_fabric_params *given);

/* One row of a list of words, and the same as a row macro of table.h. */
typedef struct shade_list_entry {
  int value;
  const char *word, *label, *help;
} shade_list_entry;
#define SHADE_LIST_ENTRY(NAME, word, value, label, help) {value, #word, label, help},

/* Row `row` of `count` into what is not NULL; 0 past the end. */
int shade_fill_row(const shade_list_entry *rows, int count, int row, int *value, const char **word,
                   const char **label, const char **help);

#endif
