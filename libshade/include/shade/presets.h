/* SPDX-License-Identifier: Apache-2.0 */
/**
 * Cloths and metals by name, as a draper or a machinist would ask for them.
 *
 * Each is a set of plain numbers that may be changed before use, with the sources they come from.
 * What no source gives, such as a dye, was chosen by eye and is said to be.
 *
 * Threads. Every function here is reentrant and free of global state. Only shade_preset_fabric
 * allocates.
 */
#ifndef SHADE_PRESETS_H /* read once */
#define SHADE_PRESETS_H

#include "shade/fabric.h"
#include "shade/maps.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a preset is. */
typedef enum shade_preset_kind { SHADE_PRESET_FABRIC, SHADE_PRESET_METAL } shade_preset_kind;

/** A cloth or a metal, with its sources. */
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

/**
 * A row of the table of presets. Words stay; rows may come between.
 *
 * @param row     0, 1, ...
 * @param preset  out: the preset
 * @return 1, or 0 past the end
 */
SHADE_API int shade_preset_row(int row, shade_preset *preset);

/**
 * A preset by its name.
 *
 * @param word    the name, read with - and _ alike and without regard to case
 * @param preset  out, or NULL: the preset
 * @return 1; or 0, and nothing changes, for a word that is not in the table
 */
SHADE_API int shade_preset_find(const char *word, shade_preset *preset);

/**
 * The fabric of a preset, ready for shade_fabric_eval.
 *
 * Threads: the call allocates, and reads the environment as shade_bsdf_setup does.
 *
 * @param preset  a preset of the kind SHADE_PRESET_FABRIC
 * @param weave   NULL, or out: its weave, to be freed with shade_weave_free
 * @param status  NULL, or where status bits are or-ed into
 * @return the fabric, to be freed with shade_fabric_free; NULL, and *weave NULL, for a metal, no
 *         preset, an unknown weave or when out of memory
 */
SHADE_API shade_fabric *shade_preset_fabric(const shade_preset *preset, shade_weave **weave,
                                            unsigned *status);

#ifdef __cplusplus
}
#endif
#endif
