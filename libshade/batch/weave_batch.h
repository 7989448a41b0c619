/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Look-ups into a weave, a block at a time; the rules are those of weave.h. Each term of the noise
 * has a loop of its own, so that a weave pays for what it has. Loops run over whole vectors,
 * whose last lanes may be void: so a single look-up gives the same bits as one in a batch.
 */
#ifndef SHADE_BATCH_WEAVE_BATCH_H
#define SHADE_BATCH_WEAVE_BATCH_H

#include "../model/public.h"
#include "../model/weave.h"
#include "../model/weave_private.h"
#include "arrays.h"
#include "vec.h"

enum { WEAVE_BLOCK = 128 }; /* look-ups a pass: its scratch stays in the first-level cache */

/* Numbers of crossings up to here are whole in float and in int. */
#define WEAVE_NEAR 4194304

typedef SUFFIX(weave_yarn) yarn_numbers;

/* Pairs are by axis, u and v, or by shade_top, weft and warp: weft runs along u, warp along v. */
typedef struct weave_room {
  real whole[2][WEAVE_BLOCK], part[2][WEAVE_BLOCK]; /* by axis: crossings, and within one */
  real ease[2][WEAVE_BLOCK];                        /* from knot to knot of the noise along it */
  real share[2][WEAVE_BLOCK], sigma[2][WEAVE_BLOCK];
  real along[WEAVE_BLOCK], across[WEAVE_BLOCK]; /* tilt of what is seen */
  real brightness[WEAVE_BLOCK], occlusion[WEAVE_BLOCK];
  uint32_t number[2][WEAVE_BLOCK], knot[2][WEAVE_BLOCK]; /* of the yarn, counted on over repeats */
  int32_t index[2][WEAVE_BLOCK];                         /* by axis: end and pick in the draft */
  int32_t upper[WEAVE_BLOCK], seen[WEAVE_BLOCK], hit[WEAVE_BLOCK], below[WEAVE_BLOCK];
  int32_t before[WEAVE_BLOCK], after[WEAVE_BLOCK]; /* cells to the float's ends */
} weave_room;

/* One coordinate into crossings, what is left, and the index in the draft. */
static unsigned pass_weave_split(size_t count, int size, const real *restrict x,
                                 real *restrict whole, real *restrict part,
                                 int32_t *restrict index) {
  const real per_size = 1 / (real)size, limit = R(4e18);
#if SHADE_FLOAT
  const real most = 3.40282347e38f;
#else
  const real most = 1.7976931348623157e308;
#endif
  int bad = 0, far = 0;
#pragma omp simd reduction(| : bad, far)
  for (size_t i = 0; i < count; i++) {
    const int finite = absolute(x[i]) <= most;
    const real a = finite ? x[i] : 0, k = weave_floor(a);
    const real held = minimum(maximum(k, -limit), limit);
    const int beyond = absolute(k) > WEAVE_NEAR;
    const real near = beyond ? 0 : k;
    /* the quotient may be off by one */
    int32_t rest = (int32_t)near - (int32_t)weave_floor(near * per_size) * size;
    rest += rest < 0 ? size : 0;
    rest -= rest >= size ? size : 0;
    index[i] = rest;
    whole[i] = held;
    part[i] = a - k;
    bad |= !finite;
    far |= beyond;
  }
  for (size_t i = 0; far && i < count; i++)
    index[i] = (int32_t)(((int64_t)whole[i] % size + size) % size);
  return bad ? SHADE_BAD_INPUT : SHADE_OK;
}

/* What the draft has there, and the yarns' widths. */
static void pass_weave_draft(const shade_weave *w, size_t count, weave_room *room) {
  const uint32_t *cells = w->cells;
  const int ends = w->draft->ends;
  int32_t *upper = room->upper;
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    upper[i] = (int32_t)cells[room->index[1][i] * ends + room->index[0][i]];
  for (int k = 0; k < 2; k++) {
    const weave_thread *thread = w->thread[k];
    const int32_t *index = room->index[!k];
    real *share = room->share[k];
    const int stride = (int)(sizeof *thread / sizeof(real));
    const real *shares = &thread->SUFFIX(share);
    const real first = *shares;
    if (w->uniform[k])
#pragma omp simd
      for (size_t i = 0; i < count; i++)
        share[i] = first;
    else
#pragma omp simd
      for (size_t i = 0; i < count; i++)
        share[i] = shares[index[i] * stride];
  }
}

/* The lattice of the noise: number of the yarn, knot along it. Slubs vary its width. */
static void pass_weave_knots(const shade_weave *w, size_t count, int kind, weave_room *room) {
  const real frequency = w->SUFFIX(yarn)[kind].along_frequency;
  const real *whole = room->whole[kind], *part = room->part[kind], *side = room->whole[!kind];
  uint32_t *number = room->number[kind], *knot = room->knot[kind];
  real *ease = room->ease[kind];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    number[i] = weave_low_bits(side[i]);
    weave_knot((whole[i] + part[i]) * frequency, &knot[i], &ease[i]);
  }
}

static void pass_weave_slub(const shade_weave *w, size_t count, int kind, weave_room *room) {
  const real slub = w->SUFFIX(yarn)[kind].slub;
  const uint32_t seed = w->params.seed, channel = (uint32_t)kind * WEAVE_CHANNELS + WEAVE_SLUB;
  const uint32_t *number = room->number[kind], *knot = room->knot[kind];
  real *share = room->share[kind], *ease = room->ease[kind];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const real r = weave_along(seed, channel, number[i], knot[i], ease[i]);
    const real width = share[i] * (1 + slub * r);
    share[i] = minimum(maximum(width, share[i] * R(0.05)), 1);
  }
}

/* Which of the two is seen, with its numbers in the first of each pair; tilt from its shape. */
static void pass_weave_choose(const shade_weave *w, size_t count, weave_room *room) {
  const real curve[2] = {w->SUFFIX(yarn)[0].curve, w->SUFFIX(yarn)[1].curve};
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const uint32_t cell = (uint32_t)room->upper[i];
    const int upper = (int)(cell & 1);
    const real weft = (2 * room->part[1][i] - 1) / room->share[0][i];
    const real warp = (2 * room->part[0][i] - 1) / room->share[1][i];
    const int on_weft = (weft >= -1) & (weft <= 1), on_warp = (warp >= -1) & (warp <= 1);
    const int on_upper = upper ? on_warp : on_weft, on_lower = upper ? on_weft : on_warp;
    const int seen = (on_upper | !on_lower) ? upper : !upper;
    const uint32_t floats = seen ? cell >> 15 : cell >> 1;
    room->sigma[0][i] = weft;
    room->sigma[1][i] = warp;
    room->upper[i] = upper;
    room->seen[i] = seen;
    room->below[i] = !on_upper;
    room->hit[i] = on_upper | on_lower;
    room->before[i] = (int32_t)(floats & WEAVE_FAR);
    room->after[i] = (int32_t)(floats >> 7 & WEAVE_FAR);
    room->along[i] = 0;
    room->across[i] = (seen ? curve[1] : curve[0]) * (seen ? warp : weft);
    room->brightness[i] = 1;
  }
}

static void pass_weave_ridge(const shade_weave *w, size_t count, weave_room *room) {
  const yarn_numbers weft = w->SUFFIX(yarn)[0], warp = w->SUFFIX(yarn)[1];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int seen = room->seen[i];
    const real s = seen ? room->part[1][i] : room->part[0][i];
    const real sigma = seen ? room->sigma[1][i] : room->sigma[0][i];
    const real segments = seen ? warp.segments : weft.segments;
    const real slant = seen ? warp.slant : weft.slant, ridge = seen ? warp.ridge : weft.ridge;
    const real tilt = ridge * weave_ridge(segments, slant, s, sigma);
    room->along[i] = segments > 0 ? tilt : 0;
  }
}

static void pass_weave_crimp(const shade_weave *w, size_t count, weave_room *room) {
  const yarn_numbers weft = w->SUFFIX(yarn)[0], warp = w->SUFFIX(yarn)[1];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int seen = room->seen[i];
    const real s = seen ? room->part[1][i] : room->part[0][i];
    const real crimp = seen ? warp.crimp : weft.crimp;
    const real given = seen ? warp.per_crimp_length : weft.per_crimp_length;
    const real before = (real)room->before[i], after = (real)room->after[i];
    /* beyond the float's other end the slope there would not be met from the other side */
    const real per_length = maximum(given, 1 / (before + after + 1));
    const real tilt =
        crimp * (weave_dive(after + 1 - s, per_length) - weave_dive(before + s, per_length));
    room->along[i] += seen == room->upper[i] ? tilt : -tilt;
  }
}

/* Noise per yarn (knot 0) or along it, of one channel, added to `to`. */
static void pass_weave_vary(const shade_weave *w, size_t count, uint32_t channel,
                            const real amplitude[2], const weave_room *room, real *restrict to) {
  const uint32_t seed = w->params.seed;
  const real weft = amplitude[0], warp = amplitude[1];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int seen = room->seen[i];
    const uint32_t number = seen ? room->number[1][i] : room->number[0][i];
    const uint32_t base = seen ? WEAVE_CHANNELS : 0;
    to[i] += (seen ? warp : weft) * weave_random(seed, base + channel, number, 0);
  }
}

static void pass_weave_vary_along(const shade_weave *w, size_t count, uint32_t channel,
                                  const real amplitude[2], const weave_room *room,
                                  real *restrict to) {
  const uint32_t seed = w->params.seed;
  const real weft = amplitude[0], warp = amplitude[1];
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int seen = room->seen[i];
    const uint32_t number = seen ? room->number[1][i] : room->number[0][i];
    const uint32_t knot = seen ? room->knot[1][i] : room->knot[0][i];
    const real ease = seen ? room->ease[1][i] : room->ease[0][i];
    const uint32_t base = seen ? WEAVE_CHANNELS : 0;
    to[i] += (seen ? warp : weft) * weave_along(seed, base + channel, number, knot, ease);
  }
}

static void pass_weave_noise(const shade_weave *w, size_t count, weave_room *room) {
  const yarn_numbers *y = w->SUFFIX(yarn);
  const struct {
    real amplitude[2];
    uint32_t channel;
    int along;
    real *to;
  } terms[] = {
      {{y[0].vary_tilt, y[1].vary_tilt}, WEAVE_VARY_TILT_ALONG, 0, room->along},
      {{y[0].vary_tilt, y[1].vary_tilt}, WEAVE_VARY_TILT_ACROSS, 0, room->across},
      {{y[0].vary_brightness, y[1].vary_brightness}, WEAVE_VARY_BRIGHTNESS, 0, room->brightness},
      {{y[0].along_tilt, y[1].along_tilt}, WEAVE_ALONG_TILT_ALONG, 1, room->along},
      {{y[0].along_tilt, y[1].along_tilt}, WEAVE_ALONG_TILT_ACROSS, 1, room->across},
      {{y[0].along_brightness, y[1].along_brightness}, WEAVE_ALONG_BRIGHTNESS, 1, room->brightness},
  };
  for (size_t k = 0; k < sizeof terms / sizeof terms[0]; k++)
    if (terms[k].amplitude[0] > 0 || terms[k].amplitude[1] > 0)
      (terms[k].along ? pass_weave_vary_along : pass_weave_vary)(
          w, count, terms[k].channel, terms[k].amplitude, room, terms[k].to);
}

/* Gaps are level; no tilt is longer than .98; occlusion by the tilt. */
static void pass_weave_level(size_t count, real by_tilt, weave_room *room) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int hit = room->hit[i];
    real along = hit ? room->along[i] : 0, across = hit ? room->across[i] : 0;
    weave_clamp(&along, &across);
    const real light = maximum(room->brightness[i], 0);
    room->along[i] = along;
    room->across[i] = across;
    room->brightness[i] = hit ? light : 1;
    room->occlusion[i] = 1 - by_tilt * root(along * along + across * across);
  }
}

static void pass_weave_sky(const shade_weave *w, size_t count, weave_room *room) {
  const real curve[2] = {w->SUFFIX(yarn)[0].curve, w->SUFFIX(yarn)[1].curve};
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int seen = room->seen[i], hit = room->hit[i], upper = room->upper[i];
    const real weft = room->sigma[0][i], warp = room->sigma[1][i];
    const real share0 = room->share[0][i], share1 = room->share[1][i];
    const real sigma = seen ? warp : weft;
    const real yarn =
        weave_sky(seen ? curve[1] : curve[0], seen ? share1 : share0, hit ? sigma : 0);
    const real below = weave_sky_gap(upper ? share0 : share1, upper ? weft : warp);
    const real above = weave_sky_gap(upper ? share1 : share0, upper ? warp : weft);
    room->occlusion[i] = (hit ? yarn : below) * (room->below[i] ? above : 1);
  }
}

/* What is asked for, `count` long. */
static void weave_write(const shade_weave *w, size_t count, const weave_room *room,
                        const crossings *out, size_t start) {
  const yarn_numbers *y = w->SUFFIX(yarn);
  const real fuzz = (real)w->fuzz;
  const int32_t *seen = room->seen, *hit = room->hit;
  const struct {
    real *to;
    const real *pair[2];
  } chosen[] = {
      {out->sigma, {room->sigma[0], room->sigma[1]}},
      {out->along, {room->part[0], room->part[1]}},
      {out->dx, {room->along, room->across}},
      {out->dy, {room->across, room->along}},
  };
  for (size_t k = 0; k < sizeof chosen / sizeof chosen[0]; k++) {
    real *restrict to = chosen[k].to + start;
    const real *weft = chosen[k].pair[0], *warp = chosen[k].pair[1];
    if (chosen[k].to)
#pragma omp simd
      for (size_t i = 0; i < count; i++)
        to[i] = seen[i] ? warp[i] : weft[i];
  }
  for (int k = 0; k < 2; k++) {
    real *restrict to = (k ? out->ty : out->tx) + start;
    /* along the yarn's axis on a gap */
    const real weft = k ? y[0].fibre_sin : y[0].fibre_cos, axis0 = k ? 0 : 1;
    const real warp = k ? y[1].fibre_cos : -y[1].fibre_sin, axis1 = k ? 1 : 0;
    if (k ? out->ty : out->tx)
#pragma omp simd
      for (size_t i = 0; i < count; i++)
        to[i] = hit[i] ? (seen[i] ? warp : weft) : (seen[i] ? axis1 : axis0);
  }
  if (out->top)
    for (size_t i = 0; i < count; i++)
      out->top[start + i] = hit[i] ? seen[i] : SHADE_TOP_GAP;
  if (out->swap)
    memcpy(out->swap + start, seen, count * sizeof(int));
  if (out->below)
    memcpy(out->below + start, room->below, count * sizeof(int));
  if (out->yarn)
    for (size_t i = 0; i < count; i++)
      out->yarn[start + i] = seen[i] ? room->index[0][i] : room->index[1][i];
  if (out->occlusion)
    memcpy(out->occlusion + start, room->occlusion, count * sizeof(real));
  if (out->brightness)
    memcpy(out->brightness + start, room->brightness, count * sizeof(real));
  if (out->fuzz)
    for (size_t i = 0; i < count; i++)
      out->fuzz[start + i] = hit[i] ? 0 : fuzz;
  const weave_thread *threads = w->thread[0];
  const int picks = w->draft->picks, stride = (int)(sizeof *threads / sizeof(real));
  real *const rgb[3] = {out->r, out->g, out->b};
  for (int c = 0; c < 3; c++) {
    real *restrict to = rgb[c] + start;
    const real *colors = &threads->SUFFIX(rgb)[c];
    if (rgb[c])
#pragma omp simd
      for (size_t i = 0; i < count; i++) {
        const int thread = seen[i] ? picks + room->index[0][i] : room->index[1][i];
        const real color = colors[thread * stride];
        to[i] = hit[i] ? color : 0;
      }
  }
}

/* Any number of whole vectors, up to a block. */
static unsigned weave_block(const shade_weave *w, size_t count, const real *u, const real *v,
                            weave_room *room) {
  const yarn_numbers *y = w->SUFFIX(yarn);
  const shade_draft *d = w->draft;
  unsigned status =
      pass_weave_split(count, d->ends, u, room->whole[0], room->part[0], room->index[0]);
  status |= pass_weave_split(count, d->picks, v, room->whole[1], room->part[1], room->index[1]);
  pass_weave_draft(w, count, room);
  for (int k = 0; k < 2 && w->noisy; k++) {
    pass_weave_knots(w, count, k, room);
    if (y[k].slub > 0)
      pass_weave_slub(w, count, k, room);
  }
  pass_weave_choose(w, count, room);
  if (y[0].segments > 0 || y[1].segments > 0)
    pass_weave_ridge(w, count, room);
  if (y[0].crimp > 0 || y[1].crimp > 0)
    pass_weave_crimp(w, count, room);
  if (w->noisy)
    pass_weave_noise(w, count, room);
  pass_weave_level(count, w->params.occlusion == SHADE_OCCLUSION_TILT, room);
  if (w->params.occlusion == SHADE_OCCLUSION_SKY)
    pass_weave_sky(w, count, room);
  return status;
}

/* The entries of the instruction set; `given` is as long as the caller's header has it. */
static unsigned entry_weave_batch(const shade_weave *w, size_t total, const real *u, const real *v,
                                  const crossings *given) {
  crossings out;
  if (!shade_copy_lanes(given, &out, sizeof out))
    return SHADE_BAD_INPUT;
  weave_room room;
  real held[2][WEAVE_BLOCK];
  unsigned status = SHADE_OK;
  for (size_t start = 0; start < total; start += WEAVE_BLOCK) {
    const size_t size = total - start < WEAVE_BLOCK ? total - start : WEAVE_BLOCK;
    const size_t lanes = VECTOR_BYTES / sizeof(real), count = (size + lanes - 1) / lanes * lanes;
    const real *at[2] = {u + start, v + start};
    for (int k = 0; k < 2 && count > size; k++) {
      memcpy(held[k], at[k], size * sizeof(real));
      memset(&held[k][size], 0, (count - size) * sizeof(real));
      at[k] = held[k];
    }
    status |= weave_block(w, count, at[0], at[1], &room);
    weave_write(w, size, &room, &out, start);
  }
  return status;
}

static unsigned entry_weave(const shade_weave *w, real u, real v, crossing *out) {
  weave_room room;
  const real at[2][VECTOR_BYTES / sizeof(real)] = {{u}, {v}};
  unsigned status = weave_block(w, VECTOR_BYTES / sizeof(real), at[0], at[1], &room);
  const int k = room.seen[0], hit = room.hit[0], yarn = room.index[!k][0];
  const yarn_numbers *y = &w->SUFFIX(yarn)[k];
  const real cosine = hit ? y->fibre_cos : 1, sine = hit ? y->fibre_sin : 0;
  out->top = hit ? (shade_top)k : SHADE_TOP_GAP;
  out->swap = k;
  out->below = room.below[0];
  out->yarn = yarn;
  out->sigma = room.sigma[k][0];
  out->along = room.part[k][0];
  out->dx = k ? room.across[0] : room.along[0];
  out->dy = k ? room.along[0] : room.across[0];
  out->tx = k ? -sine : cosine;
  out->ty = k ? cosine : sine;
  out->occlusion = room.occlusion[0];
  out->brightness = room.brightness[0];
  out->fuzz = hit ? 0 : (real)w->fuzz;
  for (int c = 0; c < 3; c++)
    out->color[c] = hit ? w->thread[k][yarn].SUFFIX(rgb)[c] : 0;
  return status;
}

#endif
