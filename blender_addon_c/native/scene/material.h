/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a surface is made of: closures, and the nodes that say with which numbers. */
#ifndef LIBSHADE_MATERIAL_H
#define LIBSHADE_MATERIAL_H

#include <stdbool.h>
#include <stddef.h>

typedef struct closure closure; /* closure/closure.h */
typedef struct node node;       /* node/node.h */

/* What a closure does. */
enum {
  CLOSURE_SCATTERS = 1u, /* it has f and draws directions */
  CLOSURE_THROUGH = 2u,  /* to and from the side that is not seen, too */
  CLOSURE_PASSES = 4u,   /* its rays go straight on */
  CLOSURE_EMITS = 8u,    /* its weight is radiance */
  CLOSURE_MATT = 16u,    /* its bounces count as diffuse ones */
  CLOSURE_GROOVED = 32u, /* turned about its normal it is another */
  CLOSURE_HOLDS = 64u,   /* its weight is a hole in the picture */
  CLOSURE_CLEAR = 128u,  /* it mirrors on its side and refracts to the other */
  CLOSURE_SHARP = 256u   /* as a mirror: no rougher than can be */
};

typedef struct material {
  int number; /* material.ID of a dump */
  int pass_index;
  float matte; /* what stands for its name */
  char *name;
  unsigned status; /* of its closure's parameters: what had to be clamped */
  size_t closures; /* 1 to CLOSURES_MOST */
  closure *closure;
  unsigned traits; /* of all of them */
  int normal[3];   /* registers of the first one's */
  bool bare;       /* one of them takes the unperturbed normal */
  size_t nodes;    /* in the order in which they run */
  node *node;
  bool turned;  /* no closure's strokes go by its meshes' own tangents */
  bool undrawn; /* whatever it shines with, its triangles are no light: rays alone find them */
  bool shines;  /* evenly, with this radiance: its triangles are a light */
  float radiance[3];
  bool focuses; /* it gathers the light of lamps: aims.h */
} material;

#endif
