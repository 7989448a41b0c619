/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of a shade_fabric: what fabric.c sets up and fabric_eval.c reads. */
#ifndef SHADE_SRC_FABRIC_H
#define SHADE_SRC_FABRIC_H

#include <math.h>

#include "shade/fabric.h"
#include "bsdf.h"
#include "weave_private.h"

enum {
  FABRIC_NODES = 128, /* lobes of a mixture, at most */
  FABRIC_POINTS = 16  /* of the near model in a footprint */
};

/* Columns of the table of the repeat, each an integral from (0, 0); matt is occlusion times kd. */
enum {
  COLUMN_WEFT, /* seen and not occluded: what the lobe gets */
  COLUMN_WARP,
  COLUMN_WEFT_MATT, /* and the diffuse part, 3 channels */
  COLUMN_WARP_MATT = COLUMN_WEFT_MATT + 3,
  COLUMN_GAP = COLUMN_WARP_MATT + 3, /* backing and loose fibres, 3 channels */
  COLUMNS = COLUMN_GAP + 3
};

/* Lobes in the frame of the fibres: x along them, z out of the cloth. Weights add up to 1. */
typedef struct fabric_nodes {
  int count;
  double x[FABRIC_NODES], y[FABRIC_NODES], z[FABRIC_NODES], weight[FABRIC_NODES];
  float xf[FABRIC_NODES], yf[FABRIC_NODES], zf[FABRIC_NODES], weightf[FABRIC_NODES];
} fabric_nodes;

/* The yarns of one direction. */
typedef struct fabric_side {
  double f0[3], kd[3];
  double leaves[3];       /* (1 - f0)^2: the white share of what the surface lets in and out */
  shade_bsdf near;        /* the yarn's own lobe */
  shade_bsdf far, single; /* widened by the tilts that one node stands for */
  fabric_nodes nodes, one;
  double spread[2]; /* variance of the tilt, along and across */
  double tx, ty;    /* the mean direction of the fibres */
} fabric_side;

struct shade_fabric {
  const shade_weave *weave;
  fabric_side side[2]; /* by shade_top: weft, warp */
  double backing[3];
  int draft_colors, uneven; /* uneven: the brightness of the yarns varies */
  double nap, nap_color[3];
  int columns, rows;    /* of the table: blocks of the repeat */
  double width, height; /* of the repeat, in crossings */
  double *table;        /* (rows + 1) x (columns + 1) x COLUMNS */
  double mean[COLUMNS];
};

/* Diffuse reflectance at a point, occlusion and noise included: of the yarn, or of what a gap
 * shows. A noisy yarn reflects no more than a white one. */
static inline void fabric_matt(const shade_fabric *f, const shade_crossing *at, double matt[3]) {
  const int top = at->swap ? SHADE_TOP_WARP : SHADE_TOP_WEFT;
  const double *own = f->draft_colors ? f->weave->thread[top][at->yarn].rgb : NULL;
  for (int c = 0; c < 3; c++) {
    double kd = f->side[top].kd[c] * (own ? own[c] : 1);
    matt[c] =
        at->occlusion * (at->top == SHADE_TOP_GAP ? f->backing[c] + at->fuzz * (kd - f->backing[c])
                                                  : fmin(kd * at->brightness, 1));
  }
}

#endif
