/* SPDX-License-Identifier: Apache-2.0 */
/* Evaluation of a fabric: near, far and between; the entries of fabric.h. Compiled once for each
 * precision. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "../batch/cloth.h"
#include "../model/elementary.h"
#include "../model/random.h"
#include "../model/public.h"
#include "../model/fabric.h"
#include "../batch/isa.h"
#include "../batch/arrays.h"

#define shade_fabric_eval SUFFIX(shade_fabric_eval)
#define shade_fabric_eval_batch SUFFIX(shade_fabric_eval_batch)
#define shade_fabric_hit_eval SUFFIX(shade_fabric_hit_eval)
#define shade_fabric_hit_pdf SUFFIX(shade_fabric_hit_pdf)
#define shade_fabric_hit_sample SUFFIX(shade_fabric_hit_sample)
#define shade_fabric_hits_eval SUFFIX(shade_fabric_hits_eval)
#define shade_fabric_hits_pdf SUFFIX(shade_fabric_hits_pdf)
#define shade_fabric_hits_sample SUFFIX(shade_fabric_hits_sample)
#define shade_fabric_hits_size SUFFIX(shade_fabric_hits_size)
#define shade_fabric_pdf SUFFIX(shade_fabric_pdf)
#define shade_fabric_pdf_batch SUFFIX(shade_fabric_pdf_batch)
#define shade_fabric_point_init SUFFIX(shade_fabric_point_init)
#define shade_fabric_prepare SUFFIX(shade_fabric_prepare)
#define shade_fabric_prepare_batch SUFFIX(shade_fabric_prepare_batch)
#define shade_fabric_sample SUFFIX(shade_fabric_sample)
#define shade_fabric_sample_batch SUFFIX(shade_fabric_sample_batch)

enum { LANES = 256, TERMS = FABRIC_POINTS + 1 };

static inline const SUFFIX(shade_entries) * entries_of(const shade_fabric *f) {
  return SUFFIX(shade_isa_entries)[f->isa];
}

static unsigned valid_tier(shade_fabric_tier *tier) {
  if ((unsigned)*tier <= SHADE_TIER_SINGLE)
    return SHADE_OK;
  *tier = SHADE_TIER_AUTO;
  return SHADE_BAD_CHOICE;
}

/* ---- one hit ---------------------------------------------------------------- */

typedef struct MAY_ALIAS terms {
  size_t count;
  real rows[CLOTH_ROWS * TERMS];
  unsigned char kind[TERMS];
} terms;
_Static_assert(sizeof(terms) <= sizeof(fabric_hit), "a hit is too small");

static cloth terms_of(const fabric_hit *hit) {
  terms *h = (terms *)(uintptr_t)hit->private_.bytes;
  return (cloth){h->count, TERMS, h->kind, h->rows};
}

/* The mean over the terms. */
static real coverage_of(const fabric_hit *hit) {
  const cloth c = terms_of(hit);
  const real *part = cloth_row(&c, CLOTH_PART), *share = cloth_row(&c, CLOTH_COVERAGE);
  real sum = 0;
  for (size_t i = 0; i < c.count; i++)
    sum += part[i] * share[i];
  return sum < 1 ? sum : 1; /* parts may add up to a rounding more */
}

/* The members of a shade_fabric_lanes after its size, all of them arrays but the last. */
enum { ARRAYS = (offsetof(fabric_lanes, neighbours) - sizeof(size_t)) / sizeof(const real *) };
typedef union any_lanes {
  fabric_lanes lanes;
  struct {
    size_t size;
    const real *array[ARRAYS];
  } in;
} any_lanes;

/*
 * Prepare a hit from the first lane of *in: the one term that the random number picks, or without
 * one all terms of its footprint, each picked by a number of its own.
 */
static unsigned prepare(const shade_fabric *f, const fabric_lanes *in, shade_fabric_tier tier,
                        fabric_hit *hit) {
  terms *room = (terms *)(void *)hit->private_.bytes;
  room->count = 1;
  cloth c = terms_of(hit);
  real *part = cloth_row(&c, CLOTH_PART);
  const unsigned status = valid_tier(&tier);
  double longer = 0;
  if (in->du && in->dv)
    longer = fmax(fmax((double)in->du[0], (double)in->dv[0]), 0);
  const double share = fabric_far_share(longer);
  part[0] = 1;
  if ((in->random && !(in->random[0] < 0)) || tier != SHADE_TIER_AUTO || share >= 1 ||
      !(longer > 0))
    return status | entries_of(f)->cloth_prepare(f, in, 0, tier, &c);
  real all[ARRAYS][TERMS], random[TERMS];
  any_lanes one = {.lanes = *in};
  room->count = c.count = share > 0 ? TERMS : FABRIC_POINTS;
  for (int k = 0; k < ARRAYS; k++)
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
  return status | entries_of(f)->cloth_prepare(f, &one.lanes, 0, tier, &c);
}

void shade_fabric_point_init(const shade_fabric *f, fabric_point *point) {
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

unsigned shade_fabric_prepare(const shade_fabric *f, const fabric_point *given, const real wo[3],
                              shade_fabric_tier tier, fabric_hit *hit, real *coverage) {
  fabric_point p;
  shade_fabric_point_init(f, &p);
  const int known = !given || given->size >= sizeof given->size;
  if (given && known)
    memcpy(&p, given, given->size < sizeof p ? given->size : sizeof p);
  const fabric_lanes in = {.size = sizeof in,
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
  const unsigned status =
      prepare(f, &in, tier, hit) | (known ? SHADE_OK : (unsigned)SHADE_BAD_INPUT);
  if (coverage)
    *coverage = coverage_of(hit);
  return status;
}

unsigned shade_fabric_hit_eval(const shade_fabric *f, const fabric_hit *hit, const real wi[3],
                               real s[3]) {
  const cloth c = terms_of(hit);
  return entries_of(f)->cloth_hit(f, &c, wi, s, NULL);
}

real shade_fabric_hit_pdf(const shade_fabric *f, const fabric_hit *hit, const real wi[3],
                          unsigned *status) {
  const cloth c = terms_of(hit);
  real pdf;
  const unsigned bits = entries_of(f)->cloth_hit(f, &c, wi, NULL, &pdf);
  if (status)
    *status |= bits;
  return pdf;
}

unsigned shade_fabric_hit_sample(const shade_fabric *f, const fabric_hit *hit, const real u_in[3],
                                 real wi[3], real s[3], real *pdf) {
  const cloth c = terms_of(hit);
  const real *part = cloth_row(&c, CLOTH_PART);
  real u[3] = {u_in[0], u_in[1], u_in[2]};
  size_t term = 0;
  /* which term; what is left of the number goes on choosing */
  if (u[2] == u[2]) {
    u[2] = minimum(maximum(u[2], 0), BELOW_ONE);
    while (term + 1 < c.count && u[2] >= part[term])
      u[2] -= part[term++];
    u[2] = minimum(u[2] / maximum(part[term], R(1e-20)), BELOW_ONE);
  }
  const cloth one = cloth_lane(&c, term);
  const unsigned status = entries_of(f)->cloth_draw_one(f, &one, u, wi);
  *pdf = 0;
  if (wi[0] != 0 || wi[1] != 0 || wi[2] != 0)
    entries_of(f)->cloth_hit(f, &c, wi, s, pdf);
  if (*pdf > 0)
    return status;
  wi[0] = wi[1] = wi[2] = s[0] = s[1] = s[2] = 0;
  return status | SHADE_NO_SAMPLE;
}

unsigned shade_fabric_eval(const shade_fabric *f, const real uv[2], const real footprint[2],
                           const real n[3], const real wi[3], const real wo[3],
                           shade_fabric_tier tier, real s[3]) {
  fabric_hit hit;
  fabric_lanes in = {
      .size = sizeof in, .u = uv, .v = uv + 1, .wox = wo, .woy = wo + 1, .woz = wo + 2};
  if (footprint) {
    in.du = footprint;
    in.dv = footprint + 1;
  }
  if (n) {
    in.nx = n;
    in.ny = n + 1;
    in.nz = n + 2;
  }
  const unsigned status = prepare(f, &in, tier, &hit);
  return status | shade_fabric_hit_eval(f, &hit, wi, s);
}

real shade_fabric_pdf(const shade_fabric *f, const fabric_point *point, const real wi[3],
                      const real wo[3], shade_fabric_tier tier, unsigned *status) {
  fabric_hit hit;
  const unsigned bits = shade_fabric_prepare(f, point, wo, tier, &hit, NULL);
  if (status)
    *status |= bits;
  return shade_fabric_hit_pdf(f, &hit, wi, status);
}

unsigned shade_fabric_sample(const shade_fabric *f, const fabric_point *point, const real wo[3],
                             shade_fabric_tier tier, const real u[3], real wi[3], real s[3],
                             real *pdf) {
  fabric_hit hit;
  const unsigned status = shade_fabric_prepare(f, point, wo, tier, &hit, NULL);
  return status | shade_fabric_hit_sample(f, &hit, u, wi, s, pdf);
}

/* A block of prepared lanes, of which a caller's storage holds many. */
typedef struct prepared {
  real rows[CLOTH_ROWS * LANES];
  unsigned char kind[LANES];
} prepared;

static cloth block_of(const prepared *block, size_t count) {
  prepared *b = (prepared *)(uintptr_t)block;
  return (cloth){count, LANES, b->kind, b->rows};
}

/* Copies that hold NULL beyond the caller's size. */
static fabric_lanes known_lanes(const fabric_lanes *in) {
  fabric_lanes known;
  shade_copy_lanes(in, &known, sizeof known);
  return known;
}
static fabric_result known_result(const fabric_result *out) {
  fabric_result known;
  shade_copy_lanes(out, &known, sizeof known);
  return known;
}

/* What a batch is to do. */
typedef enum job { JOB_EVAL, JOB_PDF, JOB_SAMPLE } job;

static int is_complete(job job, const fabric_lanes *in, const fabric_result *out, int prepared) {
  if (!prepared && !(in->u && in->v && in->wox && in->woy && in->woz))
    return 0;
  if (job == JOB_SAMPLE ? !(in->u1 && in->u2 && in->u3 && out->wix && out->wiy && out->wiz)
                        : !(in->wix && in->wiy && in->wiz))
    return 0;
  return (job == JOB_PDF || (out->r && out->g && out->b)) && (job == JOB_EVAL || out->pdf);
}

/* The job over one prepared block, whose first lane is `start` of the arrays. */
static unsigned run_block(const shade_fabric *f, const cloth *c, job job, size_t start,
                          const fabric_lanes *in, const fabric_result *out) {
  const SUFFIX(shade_entries) *entries = entries_of(f);
  const real *wi[3];
  unsigned status = SHADE_OK;
  if (job == JOB_SAMPLE) {
    const real *const u[3] = {in->u1 + start, in->u2 + start, in->u3 + start};
    real *const to[3] = {out->wix + start, out->wiy + start, out->wiz + start};
    status |= entries->cloth_draw(f, c, u, to);
    for (int a = 0; a < 3; a++)
      wi[a] = to[a];
  } else {
    wi[0] = in->wix + start;
    wi[1] = in->wiy + start;
    wi[2] = in->wiz + start;
  }
  real room[LANES];
  const real *w[3] = {wi[0], wi[1], wi[2]};
  if (job == JOB_SAMPLE) { /* a draw that found nothing is no direction */
    for (size_t i = 0; i < c->count; i++)
      room[i] = wi[0][i] == 0 && wi[1][i] == 0 && wi[2][i] == 0 ? R(1.0) : wi[2][i];
    w[2] = room;
  }
  real *const rgb[3] = {out->r ? out->r + start : NULL, out->g ? out->g + start : NULL,
                        out->b ? out->b + start : NULL};
  real *pdf = out->pdf ? out->pdf + start : NULL;
  status |= entries->cloth(f, c, w, job == JOB_PDF ? NULL : rgb, pdf);
  if (job == JOB_SAMPLE)
    for (size_t i = start; i < start + c->count; i++)
      if (!(out->pdf[i] > 0) || (out->wix[i] == 0 && out->wiy[i] == 0 && out->wiz[i] == 0)) {
        out->wix[i] = out->wiy[i] = out->wiz[i] = 0;
        out->r[i] = out->g[i] = out->b[i] = out->pdf[i] = 0;
        status |= SHADE_NO_SAMPLE;
      }
  return status;
}

/* Lanes [start, end) one at a time, those without a random number as all terms of the footprint. */
static unsigned run_terms(const shade_fabric *f, size_t start, size_t end, job job,
                          const fabric_lanes *in, shade_fabric_tier tier,
                          const fabric_result *out) {
  unsigned status = SHADE_OK;
  for (size_t i = start; i < end; i++) {
    fabric_hit hit;
    any_lanes lane = {.lanes = *in};
    real wi[3], s[3], pdf;
    for (int k = 0; k < ARRAYS; k++)
      lane.in.array[k] += lane.in.array[k] ? i : 0;
    status |= prepare(f, &lane.lanes, tier, &hit);
    if (job == JOB_SAMPLE) {
      const real u[3] = {in->u1[i], in->u2[i], in->u3[i]};
      status |= shade_fabric_hit_sample(f, &hit, u, wi, s, &pdf);
      out->wix[i] = wi[0];
      out->wiy[i] = wi[1];
      out->wiz[i] = wi[2];
      out->pdf[i] = pdf;
    } else {
      wi[0] = in->wix[i];
      wi[1] = in->wiy[i];
      wi[2] = in->wiz[i];
      if (job == JOB_EVAL)
        status |= shade_fabric_hit_eval(f, &hit, wi, s);
      if (out->pdf)
        out->pdf[i] = shade_fabric_hit_pdf(f, &hit, wi, &status);
    }
    if (job != JOB_PDF) {
      out->r[i] = s[0];
      out->g[i] = s[1];
      out->b[i] = s[2];
    }
    if (out->coverage)
      out->coverage[i] = coverage_of(&hit);
  }
  return status;
}

static int needs_terms(const fabric_lanes *in, shade_fabric_tier tier) {
  return tier == SHADE_TIER_AUTO && in->du && in->dv && !in->random;
}

/* Whether a lane of [start, end) asks for all terms where others may have a random number. */
static int some_need_terms(const fabric_lanes *in, shade_fabric_tier tier, size_t start,
                           size_t end) {
  if (tier != SHADE_TIER_AUTO || !in->du || !in->dv || !in->random)
    return 0;
  int some = 0;
  for (size_t i = start; i < end; i++)
    some |= in->random[i] < 0;
  return some;
}

static void copy_coverage(const cloth *c, size_t start, const fabric_result *out) {
  if (out->coverage)
    memcpy(out->coverage + start, cloth_row(c, CLOTH_COVERAGE), c->count * sizeof(real));
}

static unsigned run_batch(const shade_fabric *f, size_t count, job job, const fabric_lanes *given,
                          shade_fabric_tier tier, const fabric_result *result) {
  const fabric_lanes in = known_lanes(given);
  const fabric_result out = known_result(result);
  if (!count)
    return SHADE_OK;
  if (!is_complete(job, &in, &out, 0))
    return SHADE_BAD_INPUT;
  unsigned status = valid_tier(&tier);
  if (needs_terms(&in, tier))
    return status | run_terms(f, 0, count, job, &in, tier, &out);
  prepared block;
  for (size_t start = 0; start < count; start += LANES) {
    const size_t size = count - start < LANES ? count - start : LANES;
    if (some_need_terms(&in, tier, start, start + size)) {
      status |= run_terms(f, start, start + size, job, &in, tier, &out);
      continue;
    }
    cloth c = block_of(&block, size);
    status |= entries_of(f)->cloth_prepare(f, &in, start, tier, &c);
    copy_coverage(&c, start, &out);
    status |= run_block(f, &c, job, start, &in, &out);
  }
  return status;
}

static unsigned run_prepared(const shade_fabric *f, size_t count, const void *hits, job job,
                             const fabric_lanes *given, const fabric_result *result) {
  const fabric_lanes in = known_lanes(given);
  const fabric_result out = known_result(result);
  const prepared *blocks = hits;
  unsigned status = SHADE_OK;
  if (!count)
    return SHADE_OK;
  if (!is_complete(job, &in, &out, 1))
    return SHADE_BAD_INPUT;
  for (size_t start = 0; start < count; start += LANES) {
    const cloth c = block_of(blocks + start / LANES, count - start < LANES ? count - start : LANES);
    copy_coverage(&c, start, &out);
    status |= run_block(f, &c, job, start, &in, &out);
  }
  return status;
}

unsigned shade_fabric_eval_batch(const shade_fabric *f, size_t count, const fabric_lanes *in,
                                 shade_fabric_tier tier, const fabric_result *out) {
  return run_batch(f, count, JOB_EVAL, in, tier, out);
}

unsigned shade_fabric_pdf_batch(const shade_fabric *f, size_t count, const fabric_lanes *in,
                                shade_fabric_tier tier, const fabric_result *out) {
  return run_batch(f, count, JOB_PDF, in, tier, out);
}

unsigned shade_fabric_sample_batch(const shade_fabric *f, size_t count, const fabric_lanes *in,
                                   shade_fabric_tier tier, const fabric_result *out) {
  return run_batch(f, count, JOB_SAMPLE, in, tier, out);
}

size_t shade_fabric_hits_size(size_t count) {
  return (count + LANES - 1) / LANES * sizeof(prepared);
}

unsigned shade_fabric_prepare_batch(const shade_fabric *f, size_t count, const fabric_lanes *given,
                                    shade_fabric_tier tier, void *hits,
                                    const fabric_result *result) {
  const fabric_lanes in = known_lanes(given);
  const fabric_result out = known_result(result);
  prepared *blocks = hits;
  if (!count)
    return SHADE_OK;
  unsigned status = valid_tier(&tier);
  if (!in.u || !in.v || !in.wox || !in.woy || !in.woz || needs_terms(&in, tier))
    return status | SHADE_BAD_INPUT;
  if (some_need_terms(&in, tier, 0, count))
    status |= SHADE_BAD_INPUT;
  for (size_t start = 0; start < count; start += LANES) {
    cloth c = block_of(blocks + start / LANES, count - start < LANES ? count - start : LANES);
    status |= entries_of(f)->cloth_prepare(f, &in, start, tier, &c);
    copy_coverage(&c, start, &out);
  }
  return status;
}

unsigned shade_fabric_hits_eval(const shade_fabric *f, size_t count, const void *hits,
                                const fabric_lanes *in, const fabric_result *out) {
  return run_prepared(f, count, hits, JOB_EVAL, in, out);
}

unsigned shade_fabric_hits_pdf(const shade_fabric *f, size_t count, const void *hits,
                               const fabric_lanes *in, const fabric_result *out) {
  return run_prepared(f, count, hits, JOB_PDF, in, out);
}

unsigned shade_fabric_hits_sample(const shade_fabric *f, size_t count, const void *hits,
                                  const fabric_lanes *in, const fabric_result *out) {
  return run_prepared(f, count, hits, JOB_SAMPLE, in, out);
}
