/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Cloths and metals by name, as a draper or a machinist would ask for them. Each is a set
 * of plain numbers that may be changed before use, with the sources they come from; what no
 * source gives, such as a dye, was chosen by eye and is said to be.
 */
#ifndef SHADE_PRESETS_H
#define SHADE_PRESETS_H

#include "shade/fabric.h"
#include "shade/maps.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum shade_preset_kind { SHADE_PRESET_FABRIC, SHADE_PRESET_METAL } shade_preset_kind;

typedef struct shade_preset {
  shade_preset_kind kind;
  const char *word, *label;
  const char *help;         /* what it is */
  const char *source;       /* where the shape of the lobes comes from; keys of REFERENCES.bib */
  const char *color_source; /* and the colour */

  /* A fabric: shade_draft_named(weave), the shape of its yarns, their material. */
  const char *weave;
  double ends_per_cm, picks_per_cm; /* crossings per cm along u and v */
  shade_weave_params yarns;
  shade_fabric_params fabric;

  /* A metal: for shade_bsdf_setup. Its grain is a field of scratches whose tile is
   * scratch_cm wide and repeats; from afar it widens the lobe (shade_slopes). */
  shade_params metal;
  shade_scratch_params scratches;
  double scratch_cm;
  int turned; /* 1: strokes in circles about the middle of the part; 0: along the tangent */
} shade_preset;

/*
 * Row 0, 1, … of the table; returns 1 and fills *preset, 0 past the end. Words
 * stay; rows may come between. shade_preset_find takes the word (- and _ alike, without regard to
 * case) and returns 0, changing nothing, for one that is not in the table; its preset may be NULL.
 */
SHADE_API int shade_preset_row(int row, shade_preset *preset);
SHADE_API int shade_preset_find(const char *word, shade_preset *preset);

/*
 * The fabric of a preset (kind SHADE_PRESET_FABRIC), ready for shade_fabric_eval, and, unless
 * `weave` is NULL, its weave in *weave: free the fabric with shade_fabric_free, the weave with
 * shade_weave_free. Status bits are or-ed into *status unless it is NULL. NULL, and *weave
 * NULL, for a metal, no preset, an unknown weave or out of memory.
 */
SHADE_API shade_fabric *shade_preset_fabric(const shade_preset *preset, shade_weave **weave,
                                            unsigned *status);

#ifdef __cplusplus
}
#endif
#endif
