/* SPDX-License-Identifier: Apache-2.0 */
/* Evaluation of a fabric in one precision: included twice by fabric_eval.c. */
#include "../kernel/real.h"

#include "../kernel/elementary.h"
#include "../kernel/leaf_repair.h"

/* Light and eye in a frame of the cloth. */
typedef struct FN(pair) {
  real wi[3], wo[3];
} FN(pair);

/* Up to `capacity` lobes with light and eye of each. */
typedef struct FN(lobes) {
  size_t count;
  real n[3][FABRIC_NODES], wi[3][FABRIC_NODES], wo[3][FABRIC_NODES];
} FN(lobes);

static inline real FN(dot3)(const real a[3], const real b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/*
 * wi and wo in the frame that groove transport makes of n for yarns along axis (0: x, 1: y):
 * that axis keeps its plane, as dP/du and dP/dv do when the surface is displaced.
 */
static FN(pair) FN(carried)(const FN(pair) * p, const real n[3], int axis) {
  const int other = 1 - axis;
  real size = FN(root)(n[axis] * n[axis] + n[2] * n[2]);
  real t[3] = {0, 0, 0}, b[3];
  t[axis] = size > 0 ? n[2] / size : 1; /* n along the other axis: any direction across it */
  t[2] = size > 0 ? -n[axis] / size : 0;
  /* b = n x t or t x n: right-handed */
  const real sign = axis ? (real)-1 : (real)1;
  b[0] = sign * (n[1] * t[2] - n[2] * t[1]);
  b[1] = sign * (n[2] * t[0] - n[0] * t[2]);
  b[2] = sign * (n[0] * t[1] - n[1] * t[0]);
  FN(pair) q;
  q.wi[axis] = FN(dot3)(p->wi, t);
  q.wo[axis] = FN(dot3)(p->wo, t);
  q.wi[other] = FN(dot3)(p->wi, b);
  q.wo[other] = FN(dot3)(p->wo, b);
  q.wi[2] = FN(dot3)(p->wi, n);
  q.wo[2] = FN(dot3)(p->wo, n);
  return q;
}

/* The same turned about z so that x runs along (tx, ty). */
static FN(pair) FN(turned)(const FN(pair) * p, real tx, real ty) {
  FN(pair)
  q = {{tx * p->wi[0] + ty * p->wi[1], tx * p->wi[1] - ty * p->wi[0], p->wi[2]},
       {tx * p->wo[0] + ty * p->wo[1], tx * p->wo[1] - ty * p->wo[0], p->wo[2]}};
  return q;
}

static void FN(run_lobes)(const shade_bsdf *b, const FN(lobes) * l, real *spec, real *matt) {
  const FN(shade_lanes) in = {sizeof in, l->n[0],  l->n[1],  l->n[2], l->wi[0], l->wi[1], l->wi[2],
                              l->wo[0],  l->wo[1], l->wo[2], NULL,    NULL,     NULL};
  shade_isa_pick(0)->FN(yarn)(b, l->count, &in, spec, matt);
}

/* Schlick's white share at the cosine between wi and h. */
static real FN(white_share)(const FN(pair) * p) {
  real h[3] = {p->wi[0] + p->wo[0], p->wi[1] + p->wo[1], p->wi[2] + p->wo[2]};
  real c = (real)0.5 * FN(root)(FN(dot3)(h, h));
  real m = c < 1 ? 1 - c : 0, m2 = m * m;
  return m2 * m2 * m;
}

/*
 * What share of tilts, even about their mean n, faces w: the single lobe's stand-in for the
 * horizons of the yarns that turn away.
 */
static real FN(facing)(const fabric_side *side, const real w[3]) {
  const real n[3] = {side->one.FN(x)[0], side->one.FN(y)[0], side->one.FN(z)[0]};
  const real v = (real)side->spread[0] * w[0] * w[0] + (real)side->spread[1] * w[1] * w[1];
  const real reach = FN(root)(3 * v), c = FN(dot3)(n, w);
  return c >= reach ? 1 : FN(maximum)((real)0.5 * (1 + c / reach), 0);
}

/* A mixture: its mean over the nodes of the lobe and of the diffuse part. */
static void FN(mixture)(const fabric_side *side, const shade_bsdf *b, const fabric_nodes *nodes,
                        const FN(pair) * p, real *spec, real *matt) {
  FN(lobes) l;
  real s[FABRIC_NODES], m[FABRIC_NODES];
  const FN(pair) q = FN(turned)(p, (real)side->tx, (real)side->ty);
  l.count = (size_t)nodes->count;
  memcpy(l.n[0], nodes->FN(x), l.count * sizeof(real));
  memcpy(l.n[1], nodes->FN(y), l.count * sizeof(real));
  memcpy(l.n[2], nodes->FN(z), l.count * sizeof(real));
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < l.count; i++) {
      l.wi[k][i] = q.wi[k];
      l.wo[k][i] = q.wo[k];
    }
  FN(run_lobes)(b, &l, s, m);
  const real *weight = nodes->FN(weight);
  real sum = 0, diffuse = 0;
#pragma omp simd reduction(+ : sum, diffuse)
  for (size_t i = 0; i < l.count; i++) {
    sum += weight[i] * s[i];
    diffuse += weight[i] * m[i];
  }
  *spec = sum;
  *matt = diffuse;
}

/* Mixtures (or single lobes) of both sides in the shares of `column`, and what the gaps show. */
static void FN(shade_far)(const shade_fabric *f, const double *column, int single,
                          const FN(pair) sides[2], real cosine, real s[3]) {
  for (int c = 0; c < 3; c++)
    s[c] = (real)column[COLUMN_GAP + c] * cosine * (real)INVERSE_PI;
  for (int k = 0; k < 2; k++) {
    const fabric_side *side = &f->side[k];
    const real share = (real)column[COLUMN_WEFT + k];
    const double *kd = column + (k ? COLUMN_WARP_MATT : COLUMN_WEFT_MATT);
    if (!(share > 0))
      continue;
    real spec, matt, white = FN(white_share)(&sides[k]);
    FN(mixture)
    (side, single ? &side->single : &side->far, single ? &side->one : &side->nodes, &sides[k],
     &spec, &matt);
    if (single) {
      const FN(pair) q = FN(turned)(&sides[k], (real)side->tx, (real)side->ty);
      const real seen = FN(facing)(side, q.wi) * FN(facing)(side, q.wo);
      spec *= seen;
      matt *= seen;
    }
    for (int c = 0; c < 3; c++) {
      real f0 = (real)side->f0[c];
      s[c] += share * spec * (f0 + (1 - f0) * white);
      s[c] += (real)(kd[c] * side->leaves[c]) * matt;
    }
  }
}

/* The mean of the near model over columns x rows points of the footprint. */
static void FN(shade_near)(const shade_fabric *f, const double uv[2], const double extent[2],
                           int columns, int rows, const FN(pair) sides[2], real cosine, real s[3]) {
  FN(lobes) l[2];
  real kd[2][FABRIC_POINTS][3], occlusion[2][FABRIC_POINTS];
  const real part = 1 / (real)(columns * rows);
  s[0] = s[1] = s[2] = 0;
  l[0].count = l[1].count = 0;
  for (int j = 0; j < rows; j++)
    for (int i = 0; i < columns; i++) {
      shade_crossing at;
      shade_weave_lookup(f->weave, uv[0] + extent[0] * ((i + 0.5) / columns - 0.5),
                         uv[1] + extent[1] * ((j + 0.5) / rows - 0.5), &at);
      double matt[3];
      fabric_matt(f, &at, matt);
      if (at.top == SHADE_TOP_GAP) {
        for (int c = 0; c < 3; c++)
          s[c] += (real)matt[c] * part * cosine * (real)INVERSE_PI;
        continue;
      }
      const int k = at.top == SHADE_TOP_WARP;
      const size_t m = l[k].count++;
      const FN(pair) q = FN(turned)(&sides[k], (real)at.tx, (real)at.ty);
      const double z2 = 1 - at.dx * at.dx - at.dy * at.dy;
      l[k].n[0][m] = (real)(at.tx * at.dx + at.ty * at.dy);
      l[k].n[1][m] = (real)(at.tx * at.dy - at.ty * at.dx);
      l[k].n[2][m] = (real)sqrt(z2);
      for (int c = 0; c < 3; c++) {
        l[k].wi[c][m] = q.wi[c];
        l[k].wo[c][m] = q.wo[c];
        kd[k][m][c] = (real)(matt[c] * f->side[k].leaves[c]) * part;
      }
      occlusion[k][m] = (real)at.occlusion * part;
    }
  for (int k = 0; k < 2; k++) {
    if (!l[k].count)
      continue;
    real spec[FABRIC_POINTS], matt[FABRIC_POINTS], sum = 0, white = FN(white_share)(&sides[k]);
    FN(run_lobes)(&f->side[k].near, &l[k], spec, matt);
    for (size_t m = 0; m < l[k].count; m++) {
      sum += occlusion[k][m] * spec[m];
      for (int c = 0; c < 3; c++)
        s[c] += kd[k][m][c] * matt[m];
    }
    for (int c = 0; c < 3; c++) {
      real f0 = (real)f->side[k].f0[c];
      s[c] += sum * (f0 + (1 - f0) * white);
    }
  }
}

/*
 * A nap of optical depth t over the cloth: light scattered once, alike in all directions, and
 * what gets through both ways; of the light that a fibre scatters half goes on downwards, so
 * that t counts half there. [Chandrasekhar1960 Sect. 3; KoenderinkPont2003]
 */
static void FN(nap)(const shade_fabric *f, real ci, real co, real s[3]) {
  const real t = (real)f->nap, way = 1 / ci + 1 / co;
  const real through = FN(exp_negative)((real)0.5 * t * way);
  const real back = ci / (ci + co) * (1 - through * through) * (real)(0.25 * INVERSE_PI);
  for (int c = 0; c < 3; c++)
    s[c] = s[c] * through + (real)f->nap_color[c] * back;
}

/* How many of the 16 points lie along u: more along the longer side of the footprint. */
static int FN(point_columns)(const double extent[2]) {
  int columns = 4;
  for (; columns < FABRIC_POINTS && extent[0] * 4 > extent[1] * columns * 2; columns *= 2)
    ;
  for (; columns > 1 && extent[1] * columns > extent[0] * 4 * 2; columns /= 2)
    ;
  return columns;
}

/* The tier that the footprint asks for; both horizons are clear. */
static void FN(shade_point)(const shade_fabric *f, const double uv[2], const double extent[2],
                            const FN(pair) sides[2], real cosine, shade_fabric_tier tier,
                            real s[3]) {
  const double longer = fmax(extent[0], extent[1]);
  const double share = tier == SHADE_TIER_AUTO ? fabric_far_share(longer) : tier != SHADE_TIER_NEAR;
  real near[3] = {0, 0, 0}, far[3] = {0, 0, 0};
  if (share < 1) {
    const int columns = FN(point_columns)(extent), one = !(longer > 0) || tier == SHADE_TIER_NEAR;
    FN(shade_near)
    (f, uv, extent, one ? 1 : columns, one ? 1 : FABRIC_POINTS / columns, sides, cosine, near);
  }
  if (share > 0) {
    double column[COLUMNS];
    if (tier == SHADE_TIER_SINGLE)
      memcpy(column, f->mean, sizeof column);
    else
      fabric_column(f, uv, extent, column);
    if (tier != SHADE_TIER_SINGLE && f->uneven && longer > 0 && longer < 16)
      fabric_streaks(f, uv, extent, longer, column);
    FN(shade_far)(f, column, tier == SHADE_TIER_SINGLE, sides, cosine, far);
  }
  for (int c = 0; c < 3; c++)
    s[c] = near[c] + (real)share * (far[c] - near[c]);
}

unsigned FN(shade_fabric_eval)(const shade_fabric *f, const real uv_in[2], const real footprint[2],
                               const real n_in[3], const real wi[3], const real wo[3],
                               shade_fabric_tier tier, real s[3]) {
  FN(pair) p, sides[2];
  real n[3] = {0, 0, 1};
  memcpy(p.wi, wi, sizeof p.wi);
  memcpy(p.wo, wo, sizeof p.wo);
  if (n_in)
    memcpy(n, n_in, sizeof n);
  unsigned status =
      FN(mend_if_needed)(n, 1) | FN(mend_if_needed)(p.wi, 0) | FN(mend_if_needed)(p.wo, 0);
  double uv[2] = {(double)uv_in[0], (double)uv_in[1]}, extent[2] = {0, 0};
  if (!isfinite(uv[0]) || !isfinite(uv[1]))
    status |= SHADE_BAD_INPUT;
  real h2 = 2 + 2 * FN(dot3)(p.wi, p.wo);
  if (!(h2 > (real)1e-30))
    status |= SHADE_BAD_INPUT;
  s[0] = s[1] = s[2] = 0;
  real ci = FN(dot3)(n, p.wi), co = FN(dot3)(n, p.wo);
  if (status & SHADE_BAD_INPUT || !(ci > 0 && co > 0 && p.wi[2] > 0 && p.wo[2] > 0))
    return status;
  for (int k = 0; k < 2 && footprint; k++) {
    if (footprint[k] > 0)
      extent[k] = fmin((double)footprint[k], 1e9);
    else if (!(footprint[k] == 0))
      status |= SHADE_BAD_INPUT;
  }
  sides[0] = sides[1] = p;
  if (n[0] != 0 || n[1] != 0)
    for (int k = 0; k < 2; k++)
      sides[k] = FN(carried)(&p, n, k);
  if ((unsigned)tier > SHADE_TIER_SINGLE) {
    status |= SHADE_BAD_CHOICE;
    tier = SHADE_TIER_AUTO;
  }
  FN(shade_point)(f, uv, extent, sides, ci, tier, s);
  if (f->nap > 0)
    FN(nap)(f, ci, co, s);
  return status;
}

unsigned FN(shade_fabric_eval_batch)(const shade_fabric *f, size_t count,
                                     const FN(shade_fabric_lanes) * in, shade_fabric_tier tier,
                                     real *r, real *g, real *b) {
  unsigned status = SHADE_OK;
  for (size_t i = 0; i < count; i++) {
    const real uv[2] = {in->u[i], in->v[i]};
    const real footprint[2] = {in->du ? in->du[i] : 0, in->dv ? in->dv[i] : 0};
    const real n[3] = {in->nx ? in->nx[i] : 0, in->nx ? in->ny[i] : 0, in->nx ? in->nz[i] : 1};
    const real wi[3] = {in->wix[i], in->wiy[i], in->wiz[i]};
    const real wo[3] = {in->wox[i], in->woy[i], in->woz[i]};
    real s[3];
    status |= FN(shade_fabric_eval)(f, uv, footprint, n, wi, wo, tier, s);
    r[i] = s[0];
    g[i] = s[1];
    b[i] = s[2];
  }
  return status;
}
