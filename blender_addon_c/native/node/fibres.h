/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Of a surface of upright fibres, `roughness`, one operand, about `normal`: what closure SHEEN of
 * model FIBRES takes. Writes `out`, three numbers: a, b, and the share of even light that the eye
 * gets.
 *
 * The model is Zeltner's [Zeltner2022]; the numbers are polynomials in the root of the eye's cosine
 * and in the roughness, from its -2nd power on, fitted to what Cycles 5.0's Sheen BSDF was seen to
 * reflect of an even sky and of four suns, from 13 sides and of 60 roughnesses. The worst errors
 * are .007 of the albedo (its mean is .6 %), 3 % of a and .012 of b, where the albedo is above .05.
 */
#ifndef LIBSHADE_NODE_FIBRES_H
#define LIBSHADE_NODE_FIBRES_H

#include "node/common.h"

enum { SHEEN_EYE = 5, SHEEN_ROUGH = 6 };

typedef struct node_fibres {
  operand roughness;
  int normal[3], out[3];
} node_fibres;

static inline bool node_fibres_read(reader *r, node_fibres *n, graph *g) {
  return graph_normal(r, g, n->normal) && graph_operands(r, g, "roughness", 1, &n->roughness) &&
         graph_outputs(r, g, "out", 3, n->out);
}

/* Logarithms of the albedo and of a, and b: by powers of the cosine's root, and of the roughness.
 */
static const float sheen_fit[3][SHEEN_EYE * SHEEN_ROUGH] = {
    /* albedo */
    {-0.0794006f, 0.626778f, -0.630881f, -3.17456f, 5.1495f,   -2.15431f, 1.24613f,  -11.9187f,
     21.8953f,    4.38912f,  -35.7461f,  19.8762f,  -6.71805f, 72.058f,   -192.026f, 160.113f,
     12.2801f,    -45.4869f, 13.2479f,   -168.922f, 552.224f,  -733.769f, 400.338f,  -64.8699f,
     -7.81469f,   111.008f,  -411.375f,  639.395f,  -443.465f, 113.259f},
    /* a */
    {0.00110945f, -0.018043f, -4.63407f, 9.71306f,  -8.51077f, 3.13571f,  -0.220293f, 4.33738f,
     -17.9731f,   27.7623f,   -10.978f,  -2.88776f, 1.54723f,  -35.2334f, 221.199f,   -508.715f,
     491.915f,    -170.139f,  -2.20507f, 57.3534f,  -401.24f,  998.002f,  -1037.79f,  385.466f,
     0.635172f,   -23.3204f,  188.788f,  -502.872f, 547.145f,  -210.393f},
    /* b */
    {-0.00812495f, 0.217491f, -2.16925f, 6.80289f,  -9.09683f,  4.28519f,  0.0668163f, -1.57912f,
     16.1093f,     -61.081f,  84.7014f,  -38.5441f, -0.216984f, 4.23894f,  -32.1992f,  130.714f,
     -193.136f,    91.5862f,  0.305921f, -8.99115f, 48.8802f,   -155.205f, 210.729f,   -96.8882f,
     0.369928f,    2.20645f,  -19.2052f, 62.5534f,  -82.0666f,  36.6217f}};

LEAF float sheen_power(const float *k, float y) {
  return k[0] + y * (k[1] + y * (k[2] + y * (k[3] + y * (k[4] + y * k[5]))));
}

LEAF float sheen_fitted(const float *k, float x, float y) {
  float p0 = sheen_power(k, y), p1 = sheen_power(k + 6, y), p2 = sheen_power(k + 12, y);
  float p3 = sheen_power(k + 18, y), p4 = sheen_power(k + 24, y);
  return (p0 + x * (p1 + x * (p2 + x * (p3 + x * p4)))) / (y * y);
}

LEAF void node_fibres_run(const node_fibres *n, lane_run g, const corners *corner,
                          const surfaces *restrict point, inputs *at) {
  const float *rough = lane_of(at, n->roughness, 0, g);
  const float *nx = at->at[n->normal[0]], *ny = at->at[n->normal[1]], *nz = at->at[n->normal[2]];
  float *a = at->at[n->out[0]], *b = at->at[n->out[1]], *albedo = at->at[n->out[2]];
  (void)corner;
#pragma omp simd
  for (size_t i = g.begin; i < g.end; i++) {
    vec3 v = load(&point->wo, i);
    float x = sqrtf(clampf(nx[i] * v.x + ny[i] * v.y + nz[i] * v.z, 0.02f, 1.0f));
    float y = clampf(rough[i], 0.07f, 1.0f);
    albedo[i] = clampf(exponential2(1.44269504f * sheen_fitted(sheen_fit[0], x, y)), 0.0f, 1.0f);
    a[i] = clampf(exponential2(1.44269504f * sheen_fitted(sheen_fit[1], x, y)), 0.02f, 1.0f);
    b[i] = clampf(sheen_fitted(sheen_fit[2], x, y), -0.2f, 0.02f);
  }
}

#endif
