/* SPDX-License-Identifier: Apache-2.0 */
/* The entries of fabric.h in one precision: included twice by fabric_eval.c. */
#include "../kernel/real.h"

#include "../kernel/elementary.h"
#include "../kernel/leaf_repair.h"
#include "../kernel/leaf_horizon.h"
#include "../kernel/cloth.h"

#undef BELOW_ONE
#define BELOW_ONE (SHADE_FLOAT ? R(0x1.fffffep-1) : R(0x1.fffffffffffffp-1))

/* A point as it was given, mended, and what stands for the fabric's own numbers. */
typedef struct FN(place) {
  double uv[2], extent[2];
  real random; /* < 0: all terms */
  real given[3], n[3], wo[3];
  real kd[2][3], gloss[2], nap; /* by shade_top */
} FN(place);

/* ---- one lane --------------------------------------------------------------- */

static void FN(put)(const FN(cloth) * c, size_t i, int row, real x) {
  c->rows[(size_t)row * c->stride + i] = x;
}

/* What all kinds share; the rest is 0. */
static void FN(put_place)(const shade_fabric *f, const FN(cloth) * c, size_t i, const FN(place) * p,
                          real part) {
  for (int row = 0; row < CLOTH_ROWS; row++)
    FN(put)(c, i, row, 0);
  for (int a = 0; a < 3; a++) {
    FN(put)(c, i, CLOTH_N + a, p->n[a]);
    FN(put)(c, i, CLOTH_GIVEN + a, p->given[a]);
    FN(put)(c, i, CLOTH_WO + a, p->wo[a]);
  }
  FN(put)(c, i, CLOTH_GLOSS, p->gloss[0]);
  FN(put)(c, i, CLOTH_GLOSS + 1, p->gloss[1]);
  FN(put)(c, i, CLOTH_NAP, p->nap);
  FN(put)(c, i, CLOTH_PART, part);
  (void)f;
}

/* A share `open` of the lane is not covered but by the nap. */
static void FN(put_coverage)(const FN(cloth) * c, size_t i, const FN(place) * p, double open) {
  const real co = p->n[0] * p->wo[0] + p->n[1] * p->wo[1] + p->n[2] * p->wo[2];
  const double way = p->nap > 0 ? 0.5 * (double)p->nap / fmax((double)co, 1e-9) : 0;
  FN(put)(c, i, CLOTH_COVERAGE, (real)(1 - open * exp(-way)));
}

/* Reflectances of what has been seen: kd no more than white, and what is let through no more
 * than kd leaves. `seen` is what both are a share of. */
static void FN(put_matt)(const shade_fabric *f, const FN(cloth) * c, size_t i, int k, int channel,
                         double kd, double kt, double seen) {
  const fabric_side *s = &f->side[k];
  const double reflected = fmin(kd, seen), passed = fmin(kt, seen - reflected);
  FN(put)(c, i, CLOTH_KD + 3 * k + channel, (real)(reflected * s->leaves[channel]));
  FN(put)(c, i, CLOTH_KT + 3 * k + channel, (real)(passed * s->leaves[channel]));
}

static void FN(put_near)(const shade_fabric *f, const FN(cloth) * c, size_t i, const FN(place) * p,
                         const double uv[2], real part) {
  shade_crossing at;
  shade_weave_lookup(f->weave, uv[0], uv[1], &at);
  const int k = at.swap;
  FN(put_place)(f, c, i, p, part);
  if (at.top == SHADE_TOP_GAP) {
    c->kind[i] = CLOTH_GAP;
    for (int a = 0; a < 3; a++) {
      const double kd = (double)p->kd[k][a] * fabric_own(f, k, at.yarn, a);
      FN(put)
      (c, i, CLOTH_FLAT + a,
       (real)(at.occlusion * (f->backing[a] + at.fuzz * (kd - f->backing[a]))));
    }
    FN(put_coverage)(c, i, p, f->backed ? 0 : 1 - at.fuzz);
    return;
  }
  c->kind[i] = (unsigned char)(k ? CLOTH_WARP : CLOTH_WEFT);
  FN(put)(c, i, CLOTH_TILT, (real)(at.tx * at.dx + at.ty * at.dy));
  FN(put)(c, i, CLOTH_TILT + 1, (real)(at.tx * at.dy - at.ty * at.dx));
  FN(put)(c, i, CLOTH_TILT + 2, (real)sqrt(1 - at.dx * at.dx - at.dy * at.dy));
  FN(put)(c, i, CLOTH_FIBRE, (real)at.tx);
  FN(put)(c, i, CLOTH_FIBRE + 1, (real)at.ty);
  FN(put)(c, i, CLOTH_WEIGHT + k, (real)at.occlusion);
  for (int a = 0; a < 3; a++) {
    const double own = at.occlusion * at.brightness * fabric_own(f, k, at.yarn, a);
    FN(put_matt)
    (f, c, i, k, a, own * (double)p->kd[k][a], own * f->side[k].transmit[a], at.occlusion);
  }
  FN(put_coverage)(c, i, p, 0);
}

static void FN(put_far)(const shade_fabric *f, const FN(cloth) * c, size_t i, const FN(place) * p,
                        const double *column, int kind, real part) {
  FN(put_place)(f, c, i, p, part);
  c->kind[i] = (unsigned char)kind;
  for (int k = 0; k < 2; k++)
    FN(put)(c, i, CLOTH_WEIGHT + k, (real)column[COLUMN_SEEN + k]);
  for (int a = 0; a < 3; a++) {
    double flat = column[COLUMN_GAP] * f->backing[a];
    for (int k = 0; k < 2; k++) {
      const double own = column[COLUMN_MATT + 3 * k + a], kd = (double)p->kd[k][a];
      FN(put_matt)
      (f, c, i, k, a, own * kd, column[COLUMN_PASS + 3 * k + a], column[COLUMN_SEEN + k]);
      flat += column[COLUMN_FUZZ + 3 * k + a] * kd;
    }
    FN(put)(c, i, CLOTH_FLAT + a, (real)flat);
  }
  FN(put_coverage)(c, i, p, f->backed ? 0 : column[COLUMN_OPEN]);
}

/* The one term that p->random picks, into lane i. */
static void FN(put_one)(const shade_fabric *f, const FN(cloth) * c, size_t i, const FN(place) * p,
                        shade_fabric_tier tier) {
  const double longer = fmax(p->extent[0], p->extent[1]);
  const double share = tier == SHADE_TIER_AUTO ? far_share(longer) : tier != SHADE_TIER_NEAR;
  const double r = fmin(fmax((double)p->random, 0), 0x1.fffffffffffffp-1);
  if (tier == SHADE_TIER_SINGLE) {
    FN(put_far)(f, c, i, p, f->mean, CLOTH_SINGLE, 1);
  } else if (share >= 1 || r < share) {
    double column[COLUMNS];
    fabric_column(f, p->uv, p->extent, column);
    FN(put_far)(f, c, i, p, column, CLOTH_FAR, 1);
  } else if (!(longer > 0) || tier == SHADE_TIER_NEAR) {
    FN(put_near)(f, c, i, p, p->uv, 1);
  } else {
    const double left = fmax(r - share, 0) / (1 - share);
    const int k = (int)fmin(floor(FABRIC_POINTS * left), FABRIC_POINTS - 1);
    double at[2];
    point_of(p->uv, p->extent, k, at);
    FN(put_near)(f, c, i, p, at, 1);
  }
}

/* All terms of a footprint; c has room for TERMS. */
static void FN(put_all)(const shade_fabric *f, FN(cloth) * c, const FN(place) * p,
                        shade_fabric_tier tier) {
  const double longer = fmax(p->extent[0], p->extent[1]);
  const double share = tier == SHADE_TIER_AUTO ? far_share(longer) : 1;
  c->count = 1;
  if (p->random >= 0 || tier != SHADE_TIER_AUTO || share >= 1 || !(longer > 0)) {
    FN(put_one)(f, c, 0, p, tier);
    return;
  }
  for (int k = 0; k < FABRIC_POINTS; k++) {
    double at[2];
    point_of(p->uv, p->extent, k, at);
    FN(put_near)(f, c, (size_t)k, p, at, (real)((1 - share) / FABRIC_POINTS));
  }
  c->count = FABRIC_POINTS;
  if (share > 0) {
    double column[COLUMNS];
    fabric_column(f, p->uv, p->extent, column);
    FN(put_far)(f, c, c->count++, p, column, CLOTH_FAR, (real)share);
  }
}

static void FN(put_void)(const shade_fabric *f, const FN(cloth) * c, size_t i) {
  FN(place) p;
  memset(&p, 0, sizeof p);
  p.n[2] = p.given[2] = p.wo[2] = 1;
  FN(put_place)(f, c, i, &p, 1);
  c->kind[i] = CLOTH_VOID;
}

/* Mend a place; p has what was given. Returns status bits; with SHADE_BAD_INPUT in *empty there
 * is nothing to shade. */
static unsigned FN(mend_place)(const shade_fabric *f, FN(place) * p, const real footprint[2],
                               int *empty) {
  unsigned status = FN(mend_if_needed)(p->given, 1) | FN(mend_if_needed)(p->wo, 0);
  if (!isfinite(p->uv[0]) || !isfinite(p->uv[1]))
    status |= SHADE_BAD_INPUT;
  *empty = (status & SHADE_BAD_INPUT) != 0;
  memcpy(p->n, p->given, sizeof p->n);
  if (f->horizon == SHADE_HORIZON_VALID_REFLECTION || f->horizon == SHADE_HORIZON_VALID_ESTEVEZ) {
    const FN(normal) n = FN(bend)(p->n[0], p->n[1], p->n[2], p->wo[0], p->wo[1], p->wo[2]);
    p->n[0] = n.x;
    p->n[1] = n.y;
    p->n[2] = n.z;
  }
  for (int a = 0; a < 2; a++) {
    p->extent[a] = footprint[a] > 0 ? fmin((double)footprint[a], 1e9) : 0;
    if (!(footprint[a] >= 0))
      status |= SHADE_BAD_INPUT;
  }
  if (p->random != p->random)
    p->random = 0, status |= SHADE_BAD_INPUT;
  real *numbers[] = {p->kd[0],     p->kd[0] + 1, p->kd[0] + 2, p->kd[1],
                     p->kd[1] + 1, p->kd[1] + 2, p->gloss,     p->gloss + 1};
  for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
    const real x = FN(minimum)(FN(maximum)(*numbers[k], 0), 1); /* NaN: 0 */
    if (!(x == *numbers[k]))
      status |= SHADE_CLAMPED_PARAMETER;
    *numbers[k] = x;
  }
  const real nap = FN(minimum)(FN(maximum)(p->nap, 0), 10);
  if (!(nap == p->nap))
    status |= SHADE_CLAMPED_PARAMETER;
  p->nap = nap;
  return status;
}

static void FN(own_numbers)(const shade_fabric *f, FN(place) * p) {
  for (int k = 0; k < 2; k++) {
    p->gloss[k] = 1;
    for (int a = 0; a < 3; a++)
      p->kd[k][a] = (real)f->side[k].kd[a];
  }
  p->nap = (real)f->nap;
  p->given[0] = p->given[1] = 0;
  p->given[2] = 1;
  p->random = -1;
}

static unsigned FN(valid_tier)(shade_fabric_tier *tier) {
  if ((unsigned)*tier <= SHADE_TIER_SINGLE)
    return SHADE_OK;
  *tier = SHADE_TIER_AUTO;
  return SHADE_BAD_CHOICE;
}

/* ---- one hit ---------------------------------------------------------------- */

typedef struct MAY_ALIAS FN(terms) {
  size_t count;
  real rows[CLOTH_ROWS * TERMS];
  unsigned char kind[TERMS];
} FN(terms);
_Static_assert(sizeof(FN(terms)) <= sizeof(FN(shade_fabric_hit)), "a hit is too small");

static FN(cloth) FN(terms_of)(const FN(shade_fabric_hit) * hit) {
  FN(terms) *h = (FN(terms) *)(uintptr_t)hit->private_.bytes;
  FN(cloth) c = {h->count, TERMS, h->kind, h->rows};
  return c;
}

static unsigned FN(prepare)(const shade_fabric *f, FN(place) * p, const real footprint[2],
                            shade_fabric_tier tier, FN(shade_fabric_hit) * hit) {
  FN(terms) *room = (FN(terms) *)(void *)hit->private_.bytes;
  room->count = 0;
  FN(cloth) c = FN(terms_of)(hit);
  int empty;
  unsigned status = FN(mend_place)(f, p, footprint, &empty) | FN(valid_tier)(&tier);
  if (empty) {
    c.count = 1;
    FN(put_void)(f, &c, 0);
  } else {
    FN(put_all)(f, &c, p, tier);
  }
  room->count = c.count;
  return status;
}

void FN(shade_fabric_point_init)(const shade_fabric *f, FN(shade_fabric_point) * point) {
  FN(place) p;
  FN(own_numbers)(f, &p);
  memset(point, 0, sizeof *point);
  point->size = sizeof *point;
  point->n[2] = 1;
  point->random = -1;
  memcpy(point->weft_kd, p.kd[SHADE_TOP_WEFT], sizeof point->weft_kd);
  memcpy(point->warp_kd, p.kd[SHADE_TOP_WARP], sizeof point->warp_kd);
  point->warp_gloss = point->weft_gloss = 1;
  point->nap = p.nap;
}

unsigned FN(shade_fabric_prepare)(const shade_fabric *f, const FN(shade_fabric_point) * given,
                                  const real wo[3], shade_fabric_tier tier,
                                  FN(shade_fabric_hit) * hit, real *coverage) {
  FN(shade_fabric_point) point;
  FN(place) p;
  FN(shade_fabric_point_init)(f, &point);
  if (given)
    memcpy(&point, given, given->size < sizeof point ? given->size : sizeof point);
  for (int a = 0; a < 3; a++) {
    p.given[a] = point.n[a];
    p.wo[a] = wo[a];
    p.kd[SHADE_TOP_WEFT][a] = point.weft_kd[a];
    p.kd[SHADE_TOP_WARP][a] = point.warp_kd[a];
  }
  p.uv[0] = (double)point.uv[0];
  p.uv[1] = (double)point.uv[1];
  p.gloss[SHADE_TOP_WEFT] = point.weft_gloss;
  p.gloss[SHADE_TOP_WARP] = point.warp_gloss;
  p.nap = point.nap;
  p.random = point.random;
  const unsigned status = FN(prepare)(f, &p, point.footprint, tier, hit);
  if (coverage) {
    const FN(cloth) c = FN(terms_of)(hit);
    const real *part = FN(cloth_row)(&c, CLOTH_PART), *share = FN(cloth_row)(&c, CLOTH_COVERAGE);
    *coverage = 0;
    for (size_t i = 0; i < c.count; i++)
      *coverage += part[i] * share[i];
  }
  return status;
}

/* The same direction for all terms. */
static void FN(spread)(const real w[3], size_t count, real room[3][TERMS], const real *to[3]) {
  for (int a = 0; a < 3; a++) {
    for (size_t i = 0; i < count; i++)
      room[a][i] = w[a];
    to[a] = room[a];
  }
}

unsigned FN(shade_fabric_hit_eval)(const shade_fabric *f, const FN(shade_fabric_hit) * hit,
                                   const real wi[3], real s[3]) {
  const FN(cloth) c = FN(terms_of)(hit);
  const real *part = FN(cloth_row)(&c, CLOTH_PART), *w[3];
  real room[3][TERMS], rgb[3][TERMS];
  FN(spread)(wi, c.count, room, w);
  real *const to[3] = {rgb[0], rgb[1], rgb[2]};
  const unsigned status = shade_isa_pick(0)->FN(cloth)(f, &c, w, to);
  for (int a = 0; a < 3; a++) {
    s[a] = 0;
    for (size_t i = 0; i < c.count; i++)
      s[a] += part[i] * rgb[a][i];
  }
  return status;
}

real FN(shade_fabric_hit_pdf)(const shade_fabric *f, const FN(shade_fabric_hit) * hit,
                              const real wi[3], unsigned *status) {
  const FN(cloth) c = FN(terms_of)(hit);
  const real *part = FN(cloth_row)(&c, CLOTH_PART), *w[3];
  real room[3][TERMS], pdf[TERMS], sum = 0;
  FN(spread)(wi, c.count, room, w);
  const unsigned bits = shade_isa_pick(0)->FN(cloth_pdf)(f, &c, w, pdf);
  for (size_t i = 0; i < c.count; i++)
    sum += part[i] * pdf[i];
  if (status)
    *status |= bits;
  return sum;
}

unsigned FN(shade_fabric_hit_sample)(const shade_fabric *f, const FN(shade_fabric_hit) * hit,
                                     const real u_in[3], real wi[3], real s[3], real *pdf) {
  FN(cloth) c = FN(terms_of)(hit);
  const real *part = FN(cloth_row)(&c, CLOTH_PART);
  real u[3] = {u_in[0], u_in[1], u_in[2]};
  size_t term = 0;
  /* which term; what is left of the number goes on choosing */
  if (u[2] == u[2]) {
    u[2] = FN(minimum)(FN(maximum)(u[2], 0), BELOW_ONE);
    while (term + 1 < c.count && u[2] >= part[term])
      u[2] -= part[term++];
    u[2] = FN(minimum)(u[2] / FN(maximum)(part[term], R(1e-20)), BELOW_ONE);
  }
  const FN(cloth) one = {1, c.stride, c.kind + term, c.rows + term};
  const real *const numbers[3] = {u, u + 1, u + 2};
  real *const to[3] = {wi, wi + 1, wi + 2};
  unsigned status = shade_isa_pick(0)->FN(cloth_draw)(f, &one, numbers, to);
  *pdf = s[0] = s[1] = s[2] = 0;
  if (wi[0] != 0 || wi[1] != 0 || wi[2] != 0) {
    *pdf = FN(shade_fabric_hit_pdf)(f, hit, wi, NULL);
    FN(shade_fabric_hit_eval)(f, hit, wi, s);
  }
  if (*pdf > 0)
    return status;
  wi[0] = wi[1] = wi[2] = s[0] = s[1] = s[2] = 0;
  return status | SHADE_NO_SAMPLE;
}

unsigned FN(shade_fabric_eval)(const shade_fabric *f, const real uv[2], const real footprint[2],
                               const real n[3], const real wi[3], const real wo[3],
                               shade_fabric_tier tier, real s[3]) {
  FN(shade_fabric_hit) hit;
  FN(place) p;
  const real none[2] = {0, 0};
  FN(own_numbers)(f, &p);
  p.uv[0] = (double)uv[0];
  p.uv[1] = (double)uv[1];
  if (n)
    memcpy(p.given, n, sizeof p.given);
  memcpy(p.wo, wo, sizeof p.wo);
  const unsigned status = FN(prepare)(f, &p, footprint ? footprint : none, tier, &hit);
  return status | FN(shade_fabric_hit_eval)(f, &hit, wi, s);
}

real FN(shade_fabric_pdf)(const shade_fabric *f, const FN(shade_fabric_point) * point,
                          const real wi[3], const real wo[3], shade_fabric_tier tier,
                          unsigned *status) {
  FN(shade_fabric_hit) hit;
  const unsigned bits = FN(shade_fabric_prepare)(f, point, wo, tier, &hit, NULL);
  if (status)
    *status |= bits;
  return FN(shade_fabric_hit_pdf)(f, &hit, wi, status);
}

unsigned FN(shade_fabric_sample)(const shade_fabric *f, const FN(shade_fabric_point) * point,
                                 const real wo[3], shade_fabric_tier tier, const real u[3],
                                 real wi[3], real s[3], real *pdf) {
  FN(shade_fabric_hit) hit;
  const unsigned status = FN(shade_fabric_prepare)(f, point, wo, tier, &hit, NULL);
  return status | FN(shade_fabric_hit_sample)(f, &hit, u, wi, s, pdf);
}
