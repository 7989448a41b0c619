/* SPDX-License-Identifier: Apache-2.0 */
/* The batches of fabric.h in one precision, after fabric_eval.h. */

/* A block of prepared lanes, of which a caller's storage holds many. */
typedef struct FN(prepared) {
  int flat;
  real rows[CLOTH_ROWS * LANES];
  unsigned char kind[LANES];
} FN(prepared);

static FN(cloth) FN(block_of)(const FN(prepared) * block, size_t count) {
  FN(prepared) *b = (FN(prepared) *)(uintptr_t)block;
  FN(cloth) c = {count, LANES, b->flat, b->kind, b->rows};
  return c;
}

/* Copies that hold NULL beyond the caller's size. */
static FN(shade_fabric_lanes) FN(known_lanes)(const FN(shade_fabric_lanes) * in) {
  FN(shade_fabric_lanes) known;
  if (in)
    shade_copy_lanes(in, &known, sizeof known);
  else
    memset(&known, 0, sizeof known);
  return known;
}
static FN(shade_fabric_result) FN(known_result)(const FN(shade_fabric_result) * out) {
  FN(shade_fabric_result) known;
  if (out)
    shade_copy_lanes(out, &known, sizeof known);
  else
    memset(&known, 0, sizeof known);
  return known;
}

/* What a batch is to do. */
typedef enum FN(job) { FN(JOB_EVAL), FN(JOB_PDF), FN(JOB_SAMPLE) } FN(job);

static int FN(is_complete)(FN(job) job, const FN(shade_fabric_lanes) * in,
                           const FN(shade_fabric_result) * out, int prepared) {
  if (!prepared && !(in->u && in->v && in->wox && in->woy && in->woz))
    return 0;
  if (job == FN(JOB_SAMPLE) ? !(in->u1 && in->u2 && in->u3 && out->wix && out->wiy && out->wiz)
                            : !(in->wix && in->wiy && in->wiz))
    return 0;
  return (job == FN(JOB_PDF) || (out->r && out->g && out->b)) && (job == FN(JOB_EVAL) || out->pdf);
}

/* The job over one prepared block, whose first lane is `start` of the arrays. */
static unsigned FN(run_block)(const shade_fabric *f, const FN(cloth) * c, FN(job) job, size_t start,
                              const FN(shade_fabric_lanes) * in,
                              const FN(shade_fabric_result) * out) {
  const shade_isa_table *isa = shade_isa_tables[f->isa];
  const real *wi[3];
  unsigned status = SHADE_OK;
  if (job == FN(JOB_SAMPLE)) {
    const real *const u[3] = {in->u1 + start, in->u2 + start, in->u3 + start};
    real *const to[3] = {out->wix + start, out->wiy + start, out->wiz + start};
    status |= isa->FN(cloth_draw)(f, c, u, to);
    for (int a = 0; a < 3; a++)
      wi[a] = to[a];
  } else {
    wi[0] = in->wix + start;
    wi[1] = in->wiy + start;
    wi[2] = in->wiz + start;
  }
  real room[LANES];
  const real *w[3] = {wi[0], wi[1], wi[2]};
  if (job == FN(JOB_SAMPLE)) { /* a draw that found nothing is no direction */
    for (size_t i = 0; i < c->count; i++)
      room[i] = wi[0][i] == 0 && wi[1][i] == 0 && wi[2][i] == 0 ? R(1.0) : wi[2][i];
    w[2] = room;
  }
  real *const rgb[3] = {out->r ? out->r + start : NULL, out->g ? out->g + start : NULL,
                        out->b ? out->b + start : NULL};
  real *pdf = out->pdf ? out->pdf + start : NULL;
  status |= isa->FN(cloth)(f, c, w, job == FN(JOB_PDF) ? NULL : rgb, pdf);
  if (job == FN(JOB_SAMPLE))
    for (size_t i = start; i < start + c->count; i++)
      if (!(out->pdf[i] > 0) || (out->wix[i] == 0 && out->wiy[i] == 0 && out->wiz[i] == 0)) {
        out->wix[i] = out->wiy[i] = out->wiz[i] = 0;
        out->r[i] = out->g[i] = out->b[i] = out->pdf[i] = 0;
        status |= SHADE_NO_SAMPLE;
      }
  return status;
}

/* Lanes [start, end) one at a time, those without a random number as all terms of the footprint. */
static unsigned FN(run_terms)(const shade_fabric *f, size_t start, size_t end, FN(job) job,
                              const FN(shade_fabric_lanes) * in, shade_fabric_tier tier,
                              const FN(shade_fabric_result) * out) {
  unsigned status = SHADE_OK;
  for (size_t i = start; i < end; i++) {
    FN(shade_fabric_hit) hit;
    FN(any_lanes) lane = {.lanes = *in};
    real wi[3], s[3], pdf;
    for (int k = 0; k < FN(ARRAYS); k++)
      lane.in.array[k] += lane.in.array[k] ? i : 0;
    status |= FN(prepare)(f, &lane.lanes, tier, &hit);
    if (job == FN(JOB_SAMPLE)) {
      const real u[3] = {in->u1[i], in->u2[i], in->u3[i]};
      status |= FN(shade_fabric_hit_sample)(f, &hit, u, wi, s, &pdf);
      out->wix[i] = wi[0];
      out->wiy[i] = wi[1];
      out->wiz[i] = wi[2];
      out->pdf[i] = pdf;
    } else {
      wi[0] = in->wix[i];
      wi[1] = in->wiy[i];
      wi[2] = in->wiz[i];
      if (job == FN(JOB_EVAL))
        status |= FN(shade_fabric_hit_eval)(f, &hit, wi, s);
      if (out->pdf)
        out->pdf[i] = FN(shade_fabric_hit_pdf)(f, &hit, wi, &status);
    }
    if (job != FN(JOB_PDF)) {
      out->r[i] = s[0];
      out->g[i] = s[1];
      out->b[i] = s[2];
    }
    if (out->coverage)
      out->coverage[i] = FN(coverage_of)(&hit);
  }
  return status;
}

static int FN(needs_terms)(const FN(shade_fabric_lanes) * in, shade_fabric_tier tier) {
  return tier == SHADE_TIER_AUTO && in->du && in->dv && !in->random;
}

/* Whether a lane of [start, end) asks for all terms where others may have a random number. */
static int FN(some_need_terms)(const FN(shade_fabric_lanes) * in, shade_fabric_tier tier,
                               size_t start, size_t end) {
  if (tier != SHADE_TIER_AUTO || !in->du || !in->dv || !in->random)
    return 0;
  int some = 0;
  for (size_t i = start; i < end; i++)
    some |= in->random[i] < 0;
  return some;
}

static void FN(copy_coverage)(const FN(cloth) * c, size_t start,
                              const FN(shade_fabric_result) * out) {
  if (out->coverage)
    memcpy(out->coverage + start, FN(cloth_row)(c, CLOTH_COVERAGE), c->count * sizeof(real));
}

static unsigned FN(run_batch)(const shade_fabric *f, size_t count, FN(job) job,
                              const FN(shade_fabric_lanes) * given, shade_fabric_tier tier,
                              const FN(shade_fabric_result) * result) {
  const FN(shade_fabric_lanes) in = FN(known_lanes)(given);
  const FN(shade_fabric_result) out = FN(known_result)(result);
  if (!count)
    return SHADE_OK;
  if (!FN(is_complete)(job, &in, &out, 0))
    return SHADE_BAD_INPUT;
  unsigned status = FN(valid_tier)(&tier);
  if (FN(needs_terms)(&in, tier))
    return status | FN(run_terms)(f, 0, count, job, &in, tier, &out);
  FN(prepared) block;
  block.flat = 0;
  for (size_t start = 0; start < count; start += LANES) {
    const size_t size = count - start < LANES ? count - start : LANES;
    if (FN(some_need_terms)(&in, tier, start, start + size)) {
      status |= FN(run_terms)(f, start, start + size, job, &in, tier, &out);
      continue;
    }
    FN(cloth) c = FN(block_of)(&block, size);
    status |= shade_isa_tables[f->isa]->FN(cloth_prepare)(f, &in, start, tier, &c);
    FN(copy_coverage)(&c, start, &out);
    status |= FN(run_block)(f, &c, job, start, &in, &out);
  }
  return status;
}

static unsigned FN(run_prepared)(const shade_fabric *f, size_t count, const void *hits, FN(job) job,
                                 const FN(shade_fabric_lanes) * given,
                                 const FN(shade_fabric_result) * result) {
  const FN(shade_fabric_lanes) in = FN(known_lanes)(given);
  const FN(shade_fabric_result) out = FN(known_result)(result);
  const FN(prepared) *blocks = hits;
  unsigned status = SHADE_OK;
  if (!count)
    return SHADE_OK;
  if (!FN(is_complete)(job, &in, &out, 1))
    return SHADE_BAD_INPUT;
  for (size_t start = 0; start < count; start += LANES) {
    const FN(cloth) c =
        FN(block_of)(blocks + start / LANES, count - start < LANES ? count - start : LANES);
    FN(copy_coverage)(&c, start, &out);
    status |= FN(run_block)(f, &c, job, start, &in, &out);
  }
  return status;
}

unsigned FN(shade_fabric_eval_batch)(const shade_fabric *f, size_t count,
                                     const FN(shade_fabric_lanes) * in, shade_fabric_tier tier,
                                     const FN(shade_fabric_result) * out) {
  return FN(run_batch)(f, count, FN(JOB_EVAL), in, tier, out);
}

unsigned FN(shade_fabric_pdf_batch)(const shade_fabric *f, size_t count,
                                    const FN(shade_fabric_lanes) * in, shade_fabric_tier tier,
                                    const FN(shade_fabric_result) * out) {
  return FN(run_batch)(f, count, FN(JOB_PDF), in, tier, out);
}

unsigned FN(shade_fabric_sample_batch)(const shade_fabric *f, size_t count,
                                       const FN(shade_fabric_lanes) * in, shade_fabric_tier tier,
                                       const FN(shade_fabric_result) * out) {
  return FN(run_batch)(f, count, FN(JOB_SAMPLE), in, tier, out);
}

size_t FN(shade_fabric_hits_size)(size_t count) {
  return (count + LANES - 1) / LANES * sizeof(FN(prepared));
}

unsigned FN(shade_fabric_prepare_batch)(const shade_fabric *f, size_t count,
                                        const FN(shade_fabric_lanes) * given,
                                        shade_fabric_tier tier, void *hits,
                                        const FN(shade_fabric_result) * result) {
  const FN(shade_fabric_lanes) in = FN(known_lanes)(given);
  const FN(shade_fabric_result) out = FN(known_result)(result);
  FN(prepared) *blocks = hits;
  if (!count)
    return SHADE_OK;
  unsigned status = FN(valid_tier)(&tier);
  if (!in.u || !in.v || !in.wox || !in.woy || !in.woz || FN(needs_terms)(&in, tier))
    return status | SHADE_BAD_INPUT;
  if (FN(some_need_terms)(&in, tier, 0, count))
    status |= SHADE_BAD_INPUT;
  for (size_t start = 0; start < count; start += LANES) {
    FN(cloth)
    c = FN(block_of)(blocks + start / LANES, count - start < LANES ? count - start : LANES);
    status |= shade_isa_tables[f->isa]->FN(cloth_prepare)(f, &in, start, tier, &c);
    blocks[start / LANES].flat = c.flat;
    FN(copy_coverage)(&c, start, &out);
  }
  return status;
}

unsigned FN(shade_fabric_hits_eval)(const shade_fabric *f, size_t count, const void *hits,
                                    const FN(shade_fabric_lanes) * in,
                                    const FN(shade_fabric_result) * out) {
  return FN(run_prepared)(f, count, hits, FN(JOB_EVAL), in, out);
}

unsigned FN(shade_fabric_hits_pdf)(const shade_fabric *f, size_t count, const void *hits,
                                   const FN(shade_fabric_lanes) * in,
                                   const FN(shade_fabric_result) * out) {
  return FN(run_prepared)(f, count, hits, FN(JOB_PDF), in, out);
}

unsigned FN(shade_fabric_hits_sample)(const shade_fabric *f, size_t count, const void *hits,
                                      const FN(shade_fabric_lanes) * in,
                                      const FN(shade_fabric_result) * out) {
  return FN(run_prepared)(f, count, hits, FN(JOB_SAMPLE), in, out);
}
