/* SPDX-License-Identifier: Apache-2.0 */
/* The entries of fabric.h in one precision: included twice by fabric_eval.c. */
#include "../kernel/real.h"

#include "../kernel/elementary.h"
#include "../kernel/cloth.h"

#undef BELOW_ONE
#define BELOW_ONE (SHADE_FLOAT ? R(0x1.fffffep-1) : R(0x1.fffffffffffffp-1))

static unsigned FN(valid_tier)(shade_fabric_tier *tier) {
  if ((unsigned)*tier <= SHADE_TIER_SINGLE)
    return SHADE_OK;
  *tier = SHADE_TIER_AUTO;
  return SHADE_BAD_CHOICE;
}

/* ---- one hit ---------------------------------------------------------------- */

typedef struct MAY_ALIAS FN(terms) {
  size_t count;
  int flat;
  real rows[CLOTH_ROWS * TERMS];
  unsigned char kind[TERMS];
} FN(terms);
_Static_assert(sizeof(FN(terms)) <= sizeof(FN(shade_fabric_hit)), "a hit is too small");

static FN(cloth) FN(terms_of)(const FN(shade_fabric_hit) * hit) {
  FN(terms) *h = (FN(terms) *)(uintptr_t)hit->private_.bytes;
  FN(cloth) c = {h->count, TERMS, h->flat, h->kind, h->rows};
  return c;
}

/* The mean over the terms. */
static real FN(coverage_of)(const FN(shade_fabric_hit) * hit) {
  const FN(cloth) c = FN(terms_of)(hit);
  const real *part = FN(cloth_row)(&c, CLOTH_PART), *share = FN(cloth_row)(&c, CLOTH_COVERAGE);
  real sum = 0;
  for (size_t i = 0; i < c.count; i++)
    sum += part[i] * share[i];
  return sum < 1 ? sum : 1; /* parts may add up to a rounding more */
}

/* The members of a shade_fabric_lanes after its size, all of them arrays but the last. */
enum {
  FN(ARRAYS) =
      (offsetof(FN(shade_fabric_lanes), neighbours) - sizeof(size_t)) / sizeof(const real *)
};
typedef union FN(any_lanes) {
  FN(shade_fabric_lanes) lanes;
  struct {
    size_t size;
    const real *array[FN(ARRAYS)];
  } in;
} FN(any_lanes);

static unsigned FN(prepare_terms)(const shade_fabric *f, const FN(shade_fabric_lanes) * in,
                                  shade_fabric_tier tier, FN(cloth) * c, FN(terms) * room) {
  const unsigned status = shade_isa_tables[f->isa]->FN(cloth_prepare)(f, in, 0, tier, c);
  room->flat = c->flat;
  return status;
}

/*
 * Prepare a hit from the first lane of *in: the one term that the random number picks, or without
 * one all terms of its footprint, each picked by a number of its own.
 */
static unsigned FN(prepare)(const shade_fabric *f, const FN(shade_fabric_lanes) * in,
                            shade_fabric_tier tier, FN(shade_fabric_hit) * hit) {
  FN(terms) *room = (FN(terms) *)(void *)hit->private_.bytes;
  room->count = 1;
  room->flat = 0;
  FN(cloth) c = FN(terms_of)(hit);
  real *part = FN(cloth_row)(&c, CLOTH_PART);
  const unsigned status = FN(valid_tier)(&tier);
  double longer = 0;
  if (in->du && in->dv)
    longer = fmax(fmax((double)in->du[0], (double)in->dv[0]), 0);
  const double share = fabric_far_share(longer);
  part[0] = 1;
  if ((in->random && !(in->random[0] < 0)) || tier != SHADE_TIER_AUTO || share >= 1 ||
      !(longer > 0))
    return status | FN(prepare_terms)(f, in, tier, &c, room);
  real all[FN(ARRAYS)][TERMS], random[TERMS];
  FN(any_lanes) one = {.lanes = *in};
  room->count = c.count = share > 0 ? TERMS : FABRIC_POINTS;
  for (int k = 0; k < FN(ARRAYS); k++)
    if (one.in.array[k]) {
      for (size_t i = 0; i < c.count; i++)
        all[k][i] = one.in.array[k][0];
      one.in.array[k] = all[k];
    }
  for (size_t i = 0; i < c.count; i++) {
    const int far = i == FABRIC_POINTS;
    part[i] = (real)(far ? share : (1 - share) / FABRIC_POINTS);
    random[i] = (real)(far ? 0.5 * share : share + (1 - share) * ((double)i + 0.5) / FABRIC_POINTS);
  }
  one.lanes.random = random;
  return status | FN(prepare_terms)(f, &one.lanes, tier, &c, room);
}

void FN(shade_fabric_point_init)(const shade_fabric *f, FN(shade_fabric_point) * point) {
  memset(point, 0, sizeof *point);
  point->size = sizeof *point;
  point->n[2] = 1;
  point->random = -1;
  for (int a = 0; a < 3; a++) {
    point->weft_kd[a] = (real)f->side[SHADE_TOP_WEFT].kd[a];
    point->warp_kd[a] = (real)f->side[SHADE_TOP_WARP].kd[a];
  }
  point->warp_gloss = point->weft_gloss = 1;
  point->nap = (real)f->nap;
}

unsigned FN(shade_fabric_prepare)(const shade_fabric *f, const FN(shade_fabric_point) * given,
                                  const real wo[3], shade_fabric_tier tier,
                                  FN(shade_fabric_hit) * hit, real *coverage) {
  FN(shade_fabric_point) p;
  FN(shade_fabric_point_init)(f, &p);
  if (given)
    memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  const FN(shade_fabric_lanes) in = {.size = sizeof in,
                                     .u = p.uv,
                                     .v = p.uv + 1,
                                     .du = p.footprint,
                                     .dv = p.footprint + 1,
                                     .nx = p.n,
                                     .ny = p.n + 1,
                                     .nz = p.n + 2,
                                     .wox = wo,
                                     .woy = wo + 1,
                                     .woz = wo + 2,
                                     .random = &p.random,
                                     .warp_r = p.warp_kd,
                                     .warp_g = p.warp_kd + 1,
                                     .warp_b = p.warp_kd + 2,
                                     .weft_r = p.weft_kd,
                                     .weft_g = p.weft_kd + 1,
                                     .weft_b = p.weft_kd + 2,
                                     .warp_gloss = &p.warp_gloss,
                                     .weft_gloss = &p.weft_gloss,
                                     .nap = &p.nap};
  const unsigned status = FN(prepare)(f, &in, tier, hit);
  if (coverage)
    *coverage = FN(coverage_of)(hit);
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
  return shade_isa_tables[f->isa]->FN(cloth_hit)(f, &c, wi, s);
}

real FN(shade_fabric_hit_pdf)(const shade_fabric *f, const FN(shade_fabric_hit) * hit,
                              const real wi[3], unsigned *status) {
  const FN(cloth) c = FN(terms_of)(hit);
  const real *part = FN(cloth_row)(&c, CLOTH_PART), *w[3];
  real room[3][TERMS], pdf[TERMS], sum = 0;
  FN(spread)(wi, c.count, room, w);
  const unsigned bits = shade_isa_tables[f->isa]->FN(cloth)(f, &c, w, NULL, pdf);
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
  const FN(cloth) one = {1, c.stride, c.flat, c.kind + term, c.rows + term};
  const real *const numbers[3] = {u, u + 1, u + 2};
  real *const to[3] = {wi, wi + 1, wi + 2};
  unsigned status = shade_isa_tables[f->isa]->FN(cloth_draw)(f, &one, numbers, to);
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
  FN(shade_fabric_lanes)
  in = {.size = sizeof in, .u = uv, .v = uv + 1, .wox = wo, .woy = wo + 1, .woz = wo + 2};
  if (footprint) {
    in.du = footprint;
    in.dv = footprint + 1;
  }
  if (n) {
    in.nx = n;
    in.ny = n + 1;
    in.nz = n + 2;
  }
  const unsigned status = FN(prepare)(f, &in, tier, &hit);
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
