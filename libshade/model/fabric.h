/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of a shade_fabric: what is set up once, and read by every evaluation. */
#ifndef SHADE_MODEL_FABRIC_H
#define SHADE_MODEL_FABRIC_H

#include <math.h>

#include "shade/fabric.h"
#include "bsdf.h"
#include "fabric_table.h"
#include "weave_private.h"

enum {
  FABRIC_NODES = 128, /* lobes of a mixture, at most */
  FABRIC_COARSE = 16, /* lobes that stand for it where directions are drawn, at most */
  FABRIC_POINTS = 16, /* of the near model in a footprint */
  FABRIC_RUN = 24     /* yarns that are looked at together, at most, in whole vectors */
};

/*
 * Columns of the table of the repeat, each an integral from (0, 0). Matt ones are for kd = 1:
 * occlusion, noise and the yarn's own colour, 3 channels; by shade_top: weft, warp. All are kept
 * and added up, but what is let through only where something is, and of yarns that are alike in
 * all channels the first.
 */
enum {
  COLUMN_SEEN,                   /* seen and not occluded: what the lobe gets; 2 */
  COLUMN_GAP = COLUMN_SEEN + 2,  /* the backing, for a reflectance of 1 */
  COLUMN_OPEN,                   /* share of the area that nothing covers */
  COLUMN_MATT,                   /* the diffuse part; 2 */
  COLUMN_FUZZ = COLUMN_MATT + 2, /* loose fibres of that yarn in gaps; 2 */
  COLUMN_CHANNEL = 4,            /* from one channel of those to the next */
  COLUMNS_ALIKE = COLUMN_MATT + COLUMN_CHANNEL,
  /* what yarns let through, 2 x 3: a yarn's channels side by side; only if some do */
  COLUMN_PASS = COLUMN_MATT + 3 * COLUMN_CHANNEL,
  COLUMNS = COLUMN_PASS + 6,
  COLUMNS_OPAQUE = COLUMN_PASS,
  COLUMNS_STEP = 24 /* from one block of the table to the next: whole cache lines */
};

/* Lobes in the frame of the fibres: x along them, z out of the cloth. Weights add up to 1. Some
 * more of weight 0 fill vectors: FABRIC_WHOLE(count) in all. */
#define FABRIC_WHOLE(count) (((count) + 15) / 16 * 16)
typedef struct fabric_nodes {
  int count;
  double x[FABRIC_NODES], y[FABRIC_NODES], z[FABRIC_NODES], weight[FABRIC_NODES];
  float xf[FABRIC_NODES], yf[FABRIC_NODES], zf[FABRIC_NODES], weightf[FABRIC_NODES];
} fabric_nodes;

/* Lobes of a side: the yarn's own; as wide as a node, all nodes, a coarse node or one of the
 * table's need it. */
typedef enum fabric_lobe {
  FABRIC_NEAR,
  FABRIC_FAR,
  FABRIC_SINGLE,
  FABRIC_DRAW,
  FABRIC_TABLED,
  FABRIC_LOBES
} fabric_lobe;

/* The yarns of one direction. */
typedef struct fabric_side {
  double f0[3], kd[3], transmit[3];
  double leaves[3]; /* (1 - f0)^2: the white share of what the surface lets in and out */
  shade_bsdf lobe[FABRIC_LOBES];
  shade_params made_of[FABRIC_LOBES];
  fabric_nodes nodes, one, coarse;
  int draws_one;       /* directions are drawn from the single lobe, not from the coarse nodes */
  double spread[2];    /* variance of the tilt, along and across */
  double tx, ty;       /* the mean direction of the fibres */
  fabric_table *table; /* of more nodes than those; NULL: those, one by one */
} fabric_side;

/*
 * The normals m of one side as the light meets them, gaps left out: their share of the cloth, and
 * of those the mean and the covariance in x and y, in the frame of the cloth.
 */
typedef struct fabric_lean {
  double share, mean[3], xx, xy, yy;
} fabric_lean;

struct shade_fabric {
  int isa; /* of shade_isa_tables: what it runs on */
  shade_weave *weave;
  fabric_side side[2]; /* by shade_top: weft, warp */
  double backing[3];
  int draft_colors, uneven; /* uneven: the brightness or width of the yarns varies */
  double fills[2];          /* the share of their crossings, by shade_top; 0: not alike */
  int alike;                /* the columns of all channels are the same */
  int backed, transmits;    /* the gaps show something; some yarn lets light through */
  double nap, nap_color[3];
  shade_horizon horizon;
  int columns, rows;    /* of the table: blocks of the repeat */
  double width, height; /* of the repeat, in crossings */
  double *table;        /* (rows + 1) x (columns + 1) x COLUMNS_STEP */
  double mean[COLUMNS];
  /* What the draft shows of each yarn up to each block along it, by shade_top: FABRIC_RUN yarns
   * more than the repeat has, side by side. NULL: all yarns are alike, or several share a block. */
  double *strip[2];
  int shadows; /* of yarns on one another, from the next two */
  fabric_lean lean[2];
  double level;         /* share of the cloth that is gap: as level as the cloth */
  double shadows_below; /* cosine of light: none where it is higher */
};

/* One look at a yarn: tilt in the frame of its fibres, angles; weight is its occlusion. */
typedef struct fabric_look {
  float x, y, weight;
} fabric_look;

/* Lobes of one side from its looks, whose order changes. fabric_nodes.c */
void shade_fabric_set_side(fabric_side *side, const shade_fabric_params *p, const shade_yarn *yarn,
                           fabric_look *looks, size_t count, unsigned *status);

/* What the shadows of yarns depend on. fabric_shadow.c */
void shade_fabric_set_shadows(shade_fabric *f);

/* The far model's share of a footprint: none up to so many crossings, all from so many. */
#define FABRIC_NEAR_TO 0.75
#define FABRIC_FAR_FROM 2.0
static inline double fabric_far_share(double extent) {
  if (!(extent > FABRIC_NEAR_TO))
    return 0;
  double x = log2(extent / FABRIC_NEAR_TO) / log2(FABRIC_FAR_FROM / FABRIC_NEAR_TO);
  return x < 1 ? x * x * (3 - 2 * x) : 1;
}

/* The yarn's own colour at a crossing: that of the draft, or white. */
static inline double fabric_own(const shade_fabric *f, int side, int yarn, int channel) {
  return f->draft_colors ? f->weave->thread[side][yarn].rgb[channel] : 1;
}

#endif
