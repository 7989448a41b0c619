/* SPDX-License-Identifier: Apache-2.0 */
/* What a cloth does with what its yarns send: a nap over it, shadows of yarns on one another. */
#ifndef SHADE_MODEL_CLOTH_SHADE_H
#define SHADE_MODEL_CLOTH_SHADE_H

#include "yarn.h"

/*
 * A nap of optical depth t over the cloth: light scattered once, alike in all directions, and
 * what gets through both ways; of the light that a fibre scatters half goes on downwards, so
 * that t counts half there. Light from behind passes it once. [Chandrasekhar1960 Sect. 3;
 * KoenderinkPont2003]
 */
typedef struct napped {
  real through, back;
} napped;

LEAF napped napped_of(real nap, real ci, real co, real side) {
  int lit = side > 0;
  real in = lit ? ci : 1, out = side != 0 ? co : 1;
  real way = (lit ? 1 / (in + TINY) : 0) + 1 / (out + TINY);
  real through = exp_negative(R(0.5) * nap * way);
  real back = in / (in + out) * (1 - through * through) * (R(0.25) * INVERSE_PI);
  return (napped){through, lit ? back : 0};
}

/*
 * Shadows of the yarns on one another. Of yarns whose m.w is even about its mean c, within reach
 * of it, the mean of the positive part; times their share.
 */
typedef struct leaning {
  real share, x, y, z, xx, xy, yy;
} leaning;

LEAF leaning leaning_of(const fabric_lean *l) {
  return (leaning){(real)l->share, (real)l->mean[0], (real)l->mean[1], (real)l->mean[2],
                   (real)l->xx,    (real)l->xy,      (real)l->yy};
}

LEAF real yarns_take(leaning l, real x, real y, real z) {
  real c = l.x * x + l.y * y + l.z * z;
  real spread = l.xx * x * x + 2 * l.xy * x * y + l.yy * y * y;
  real reach = root(3 * maximum(spread, R(1e-12)));
  real over = maximum(c + reach, 0);
  return l.share * (c >= reach ? c : over * over / (4 * reach));
}

/* The part of it that falls on the cloth: w lit from above, in the frame of weft yarns. */
LEAF real shadowed(leaning weft, leaning warp, real level, real x, real y, real z) {
  real falls = maximum(z, R(1e-20));
  real taken = yarns_take(weft, x, y, z) + yarns_take(warp, x, y, z) + level * z;
  return taken > falls ? falls / taken : 1;
}

#endif
