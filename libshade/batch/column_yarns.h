/* SPDX-License-Identifier: Apache-2.0 */
/* Streaks of uneven yarns in what a footprint holds: after weave.h, in double alone. */
#ifndef SHADE_BATCH_COLUMN_YARNS_H
#define SHADE_BATCH_COLUMN_YARNS_H

#include "../model/weave.h"
#include "column.h"

/*
 * Yarns that are brighter, darker, thicker or thinner than others show as streaks long after the
 * weave is too fine to see. Of one direction's yarns, of which a footprint crosses `across` and
 * goes `along` each, by what is seen of each: their mean brightness, and the share of their
 * crossings that they fill over what they do everywhere. All of them fade out from 12 to 16 yarns,
 * noise along them also from 2 to 4 of its knots; what is left of the streaks there is small.
 */
enum { STREAK_YARNS = FABRIC_RUN, STREAK_PLACES = 4 }; /* 17 yarns at most; along them */

#define NOISE_FADE 2.0
#define NOISE_END 4.0

/* 1 up to `from`, 0 from `to` on. */
LEAF double column_fade(double extent, double from, double to) {
  const double x = maximum(extent - from, 0) / (to - from);
  return x < 1 ? 1 - x * x * (3 - 2 * x) : 0;
}

/* Of so many yarns from `number` on, the noise of a channel at a knot and at the next. */
LEAF void column_knots(uint32_t seed, uint32_t channel, uint32_t number, uint32_t knot, int count,
                       double (*restrict to)[STREAK_YARNS]) {
#pragma omp simd
  for (int j = 0; j < count; j++) {
    to[0][j] = weave_random(seed, channel, number + (uint32_t)j, knot);
    to[1][j] = weave_random(seed, channel, number + (uint32_t)j, knot + 1u);
  }
}

enum { STREAK_FEW = 4 }; /* lanes that are looked at one by one */

/* What a side's yarns share. */
typedef struct column_kind {
  uint32_t seed, channel;
  double share, slub, per_usual;
  int brighter; /* whether their brightness varies along them */
} column_kind;

static column_kind column_kind_of(const shade_fabric *f, int side) {
  const weave_yarn *y = &f->weave->yarn[side];
  const double usual = f->fills[side];
  return (column_kind){f->weave->params.seed,           (uint32_t)side * WEAVE_CHANNELS,
                       f->weave->thread[side][0].share, usual > 0 ? y->slub : 0,
                       usual > 0 ? 1 / usual : 0,       y->along_brightness > 0};
}

/* Whether they differ at all. */
static int column_varies(const shade_fabric *f, int side) {
  const weave_yarn *y = &f->weave->yarn[side];
  return y->vary_brightness > 0 || y->along_brightness > 0 || (f->fills[side] > 0 && y->slub > 0);
}

/* Those of double in float. */
LEAF float column_mostf(float a, float b) {
  return a > b ? a : b;
}
LEAF float column_leastf(float a, float b) {
  return a < b ? a : b;
}
LEAF float column_random_off(uint32_t hash) {
  return (float)(int32_t)(hash >> 8) * 0x1p-23f - 1;
}
LEAF double column_random_of(uint32_t hash) {
  return weave_random_of(hash);
}

/* column_look of all lanes of a group, column_look_all, in float and in double. */
#define NUMBER float
#define OF(name) name##f
#include "column_streak.h"
#undef NUMBER
#undef OF
#define NUMBER double
#define OF(name) name
#include "column_streak.h"
#undef NUMBER
#undef OF

/* The yarns of one side in the footprint of one lane. */
static column_yarns column_look(const shade_fabric *f, int side, double centre, double across,
                                double place, double along, const column_axis *beside,
                                size_t lane) {
  enum { VECTOR = VECTOR_BYTES / sizeof(double) };
  const weave_yarn *y = &f->weave->yarn[side];
  const uint32_t seed = f->weave->params.seed, channel = (uint32_t)side * WEAVE_CHANNELS;
  const double wide = across > 0.01 ? across : 0.01;
  const double fade = column_fade(across, STREAKS_FADE, STREAKS_END);
  const double fade_along = fade * column_fade(along * y->along_frequency, NOISE_FADE, NOISE_END);
  const double vary = y->vary_brightness * fade, varies = y->along_brightness * fade_along;
  const double usual = f->fills[side], slub = usual > 0 ? y->slub : 0;
  const double per_usual = usual > 0 ? 1 / usual : 0;
  const double share = f->weave->thread[side][0].share;
  column_yarns all = {1, 1};
  if (!(fade > 0) || !(y->vary_brightness > 0 || varies > 0 || slub > 0))
    return all;
  const double low = centre - 0.5 * wide, high = low + wide, first = floor(low);
  const uint32_t number = weave_low_bits(first);
  /* no yarn of its own after the last vector: those beyond have no part */
  const int count = ((int)(floor(high) - first) + VECTOR) / VECTOR * VECTOR;
  double part[STREAK_YARNS], own[STREAK_YARNS], shown[STREAK_YARNS], parts = 0;
  const double size = side == SHADE_TOP_WEFT ? f->height : f->width;
  const double yarn = first - floor(first / size) * size;
  column_shown(f, side, (size_t)minimum(maximum(yarn, 0), size - 1), count, beside, lane, shown);
  double brighter[2][STREAK_YARNS] = {{0}}, thicker[2][STREAK_YARNS] = {{0}};
#pragma omp simd reduction(+ : parts)
  for (int j = 0; j < count; j++) {
    part[j] = shown[j] * maximum(minimum(first + j + 1, high) - maximum(first + j, low), 0);
    parts += part[j];
    own[j] =
        1 + vary * weave_random(seed, channel + WEAVE_VARY_BRIGHTNESS, number + (uint32_t)j, 0);
  }
  double light = 0, filled = 0;
  uint32_t before = 0;
  for (int k = 0; k < STREAK_PLACES; k++) {
    uint32_t knot;
    double ease;
    weave_knot((place + along * ((k + 0.5) / STREAK_PLACES - 0.5)) * y->along_frequency, &knot,
               &ease);
    if (varies > 0 && (k == 0 || knot != before))
      column_knots(seed, channel + WEAVE_ALONG_BRIGHTNESS, number, knot, count, brighter);
    if (slub > 0 && (k == 0 || knot != before))
      column_knots(seed, channel + WEAVE_SLUB, number, knot, count, thicker);
    before = knot;
#pragma omp simd reduction(+ : light, filled)
    for (int j = 0; j < count; j++) {
      const double noise = brighter[0][j] + (brighter[1][j] - brighter[0][j]) * ease;
      const double slubs = thicker[0][j] + (thicker[1][j] - thicker[0][j]) * ease;
      const double size = minimum(maximum(share * (1 + slub * slubs), share * 0.05), 1);
      const double fill = slub > 0 ? 1 + fade_along * (size * per_usual - 1) : 1;
      light += part[j] * fill * maximum(own[j] + varies * noise, 0);
      filled += part[j] * fill;
    }
  }
  if (filled > 0) { /* or none is seen; so far off there is no double between the ends */
    all.brightness = light / filled;
    all.fill = filled / (STREAK_PLACES * parts);
  }
  return all;
}

/* The yarns of all lanes of a group, each by itself. Few of them one by one: their yarns side by
 * side. narrow: in float. */
static void column_look_group(const shade_fabric *f, const column_axis *x, const column_axis *y,
                              int narrow, column_group *g) {
  for (int side = 0; side < 2; side++) {
    const column_axis *beside = side == SHADE_TOP_WEFT ? x : y;
    if (g->count > STREAK_FEW) {
      (narrow ? column_look_allf : column_look_all)(f, side, beside, g);
      continue;
    }
    for (size_t i = 0; i < g->count; i++) {
      const column_yarns found =
          column_look(f, side, g->centre[side][i], g->extent[side][i], g->centre[1 - side][i],
                      g->extent[1 - side][i], beside, g->begin + i);
      g->brightness[side][i] = found.brightness;
      g->fill[side][i] = found.fill;
    }
  }
}

#endif
