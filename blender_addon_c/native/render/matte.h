/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Mattes: which objects, materials and assets (an object's topmost parents) each pixel shows, and
 * how much of it, through transparent surfaces too. A pixel has a few slots of each kind, pairs of
 * a number that stands for a name and of a coverage; the largest come first once they are looked
 * at. Cryptomatte's format [FriedmanJones2015]: two slots are the four channels of a layer.
 */
#ifndef LIBSHADE_MATTE_H
#define LIBSHADE_MATTE_H

#include <stdbool.h>
#include <stddef.h>

#define MATTE_TABLE(ROW) ROW(OBJECT) ROW(MATERIAL) ROW(ASSET)
#define MATTE_KIND(KIND) MATTE_##KIND,
typedef enum matte_kind { MATTE_TABLE(MATTE_KIND) MATTE_KINDS } matte_kind;

enum { MATTE_SLOTS_MOST = 16 };

const char *matte_word(matte_kind kind);

/* Where each kind that is wanted begins among a pixel's numbers. */
typedef struct matte_layout {
  unsigned wanted;   /* a bit each */
  size_t slots, all; /* of a kind; numbers of a pixel */
  size_t at[MATTE_KINDS];
} matte_layout;

matte_layout matte_layout_of(unsigned wanted, size_t slots);

/* Coverage for a name. Where all slots have other names the last one gets it. */
void matte_add(float *slots, size_t count, float name, float coverage);
/* All of one pixel's slots of every kind to those of another. */
void matte_merge(const matte_layout *layout, const float *from, float *to);
/* Layer `layer` of a kind: the two slots of that rank, coverages times `scale`. */
void matte_layer(const matte_layout *layout, const float *pixel, matte_kind kind, size_t layer,
                 float scale, float out[4]);

#endif
