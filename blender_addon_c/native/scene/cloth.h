/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cloths of a scene: libshade's presets, each with its own colours, made once for all materials
 * that take it. */
#ifndef LIBSHADE_CLOTH_H
#define LIBSHADE_CLOTH_H

#include "batch/lanes.h"
#include "scene/reader.h"
#include "shade/presets.h"

typedef struct cloth {
  shade_preset preset;    /* as the scene changed it */
  shade_draft *draft;     /* in place of its weave, or NULL */
  shade_fabric_tier tier; /* how it is looked at */
  float per_u, per_v;     /* crossings in one unit of the UV map */
  float bright;           /* of all that it reflects, roughly */
  bool through;           /* light from behind reaches the eye */
  shade_weave *weave;     /* made by cloth_build */
  shade_fabric *fabric;
} cloth;

/*
 * A cloth is a dictionary. `preset` is a word, and `size` the metres of cloth in one unit of the UV
 * map. `transmit` is the share of what is matt that leaves on the other side. With `open` nothing
 * is behind the gaps. These count if they are there:
 *
 *   warp, weft            colours in place of the preset's; what goes with them (backing, coloured
 *                         highlights) changes alike
 *   gloss, nap            what the yarns' exponents are multiplied by; the nap's optical depth
 *   tier                  auto, near or far, whatever the footprint
 *   weave                 a word, or
 *   draft, draft_name     the text of a WIF and what messages call it
 *   draft_colors          its yarns' colours are multiplied by theirs in the draft
 *   counts                ends and picks per cm
 *   repeats               of the draft in one unit of the UV map, along u and v, in place of `size`
 *   warp_yarn, weft_yarn  dictionaries: numbers of shade_yarn_param_row; of the yarn's material
 *                         `along` and `across`; `twist`, radians to the yarn's axis, S above 0, Z
 *                         below; with `plied` the fibres run along the axis
 *
 * Where something is out of range, the message says what is expected.
 */
bool cloth_read(reader *r, void *out, void *context);
/* False when out of memory. */
bool cloth_build(cloth *c);

/*
 * Pictures of one repeat, for renderers that know no yarns. They are width x height texels of four
 * floats, of which the last is 1, with rows from the bottom. Each texel is the mean of some points,
 * without what varies from yarn to yarn and along them. What is -1 to 1 is kept as 0 to 1.
 *
 *   tilt   along u and along v, 0 in gaps; occlusion
 *   yarns  shares of the warp and of the weft on top; 0
 *   tint   the yarn's colour in the draft, as a display shows it (sRGB); or NULL
 *
 * cloth_texels: how large they should be; texels a crossing divide 32, all at most 2048 a side.
 * False when out of memory.
 */
enum { CLOTH_TEXELS = 32, CLOTH_MOST_TEXELS = 2048 };
bool cloth_texels(const cloth *c, int *width, int *height, bool *tinted);
bool cloth_picture(const cloth *c, int width, int height, float *tilt, float *yarns, float *tint);
/* Has a yarn of the draft another colour than white? */
bool cloth_draft_tinted(const shade_draft *d);
double cloth_shown(double light); /* as sRGB */
/* Of what yarns would take of even light, each alone, the share that they leave one another; below
 * 0 when out of memory. */
double cloth_lit(const cloth *c);
void cloth_free(cloth *c);

/* Room for the hits of a batch that are prepared for several lights and a draw. */
enum { CLOTH_RUNS = 8 };
typedef struct cloth_room {
  unsigned char *bytes;
  size_t size, used;
  size_t runs;
  bool between, mixed; /* some hits, some of the last batch that the camera sees, are between the
                          near model and the far one */
  struct {
    size_t begin, end; /* which lanes, */
    int place;         /* and by which register they are known */
    void *hits;
  } run[CLOTH_RUNS];
} cloth_room;

/* False when out of memory. */
bool cloth_room_init(cloth_room *room);
void cloth_room_free(cloth_room *room);

/* A run's hits, or NULL where they were not prepared. */
static inline const void *cloth_hits(const cloth_room *room, lane_run run, int place) {
  for (size_t k = 0; room && k < room->runs; k++)
    if (room->run[k].begin == run.begin && room->run[k].end == run.end &&
        room->run[k].place == place)
      return room->run[k].hits;
  return NULL;
}

#endif
