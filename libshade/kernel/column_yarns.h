/* SPDX-License-Identifier: Apache-2.0 */
/* Streaks of uneven yarns in what a footprint holds: after leaf_weave.h, in double alone. */

/*
 * Yarns that are brighter, darker, thicker or thinner than others show as streaks long after the
 * weave is too fine to see. Of one direction's yarns, of which a footprint crosses `across` and
 * goes `along` each, by what is seen of each: their mean brightness, and the share of their
 * crossings that they fill over what they do everywhere. All of them fade out from 12 to 16 yarns,
 * noise along them also from 2 to 4 of its knots; what is left of the streaks there is small.
 */
enum { STREAK_YARNS = FABRIC_RUN, STREAK_PLACES = 4 }; /* 17 yarns at most; along them */

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

/*
 * How much of each of `count` yarns from `first` on is seen between the ends of the footprint along
 * them, `beside`, by the draft and in a unit of its own: where that is narrow some are hidden.
 */
static void column_shown(const shade_fabric *f, int side, double first, int count,
                         const column_axis *beside, size_t lane, double *restrict shown) {
  const int weft = side == SHADE_TOP_WEFT;
  const double size = weft ? f->height : f->width;
  const double *strip = f->strip[side];
  if (!strip) { /* several share a block */
    for (int j = 0; j < count; j++)
      shown[j] = 1;
    return;
  }
  const size_t yarn = (size_t)minimum(maximum(first - floor(first / size) * size, 0), size - 1);
  const size_t line = (size_t)size + STREAK_YARNS;
  const double *low = strip + (size_t)beside->low[lane] * line + yarn;
  const double *high = strip + (size_t)beside->high[lane] * line + yarn;
  const double *after_low = low + line, *after_high = high + line;
  const double *end = strip + (size_t)(weft ? f->columns : f->rows) * line + yarn;
  const double w0 = beside->before_low[lane], w1 = beside->after_low[lane];
  const double w2 = beside->before_high[lane], w3 = beside->after_high[lane];
  const double w4 = beside->repeats[lane];
#pragma omp simd
  for (int j = 0; j < count; j++) {
    const double all =
        w0 * low[j] + w1 * after_low[j] + w2 * high[j] + w3 * after_high[j] + w4 * end[j];
    shown[j] = all > 0 ? all : 0;
  }
}

static column_yarns column_look(const shade_fabric *f, int side, double centre, double across,
                                double place, double along, const column_axis *beside,
                                size_t lane) {
  enum { VECTOR = VECTOR_BYTES / sizeof(double) };
  const weave_yarn *y = &f->weave->yarn[side];
  const uint32_t seed = f->weave->params.seed, channel = (uint32_t)side * WEAVE_CHANNELS;
  const double wide = across > 0.01 ? across : 0.01;
  const double fade = column_fade(across, STREAKS_FADE, STREAKS_END);
  const double fade_along = fade * column_fade(along * y->along_frequency, 2, 4);
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
  column_shown(f, side, first, count, beside, lane, shown);
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

/* Knots that four places are about: where a footprint is longer, noise along yarns has faded out.
 * Lanes that are looked at one by one. */
enum { STREAK_KNOTS = 5, STREAK_FEW = 4 };

/* What a side's yarns share. */
typedef struct column_kind {
  uint32_t seed, channel;
  double share, slub, per_usual;
  int brighter; /* whether their brightness varies along them */
} column_kind;

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

/*
 * What of weft, warp and gaps a footprint shows if their yarns fill a and b times what they do
 * everywhere, over what it shows if they do not. Where a share p of the crossings has the weft on
 * top it covers A of those, and of the others what the warp leaves: A (p + (1 - p) (1 - B)).
 */
static void column_filled(const shade_fabric *f, const double *column, const column_yarns yarns[2],
                          double factor[3]) {
  const double A = f->fills[0], B = f->fills[1];
  const double seen = column[COLUMN_SEEN] + column[COLUMN_SEEN + 1];
  factor[0] = factor[1] = factor[2] = 1;
  if (!(A > 0 && B > 0 && seen > 0) || (yarns[0].fill == 1 && yarns[1].fill == 1))
    return;
  const double whole = 1 - 4e-6; /* by a sum in float: else a hidden yarn would have a share left */
  const double a = A * yarns[0].fill < whole ? A * yarns[0].fill : 1;
  const double b = B * yarns[1].fill < whole ? B * yarns[1].fill : 1;
  const double weft = column[COLUMN_SEEN] / seen * (A + B - A * B); /* of the area */
  const double p = minimum(maximum((weft - A + A * B) / (A * B), 0), 1);
  factor[0] = a * (1 - (1 - p) * b) / maximum(A * (1 - (1 - p) * B), 1e-6);
  factor[1] = b * (1 - p * a) / maximum(B * (1 - p * A), 1e-6);
  factor[2] = (1 - a) * (1 - b) / maximum((1 - A) * (1 - B), 1e-6);
  for (int side = 0; side < 2; side++) /* a footprint within one yarn is filled already */
    factor[side] = minimum(factor[side], maximum(1 / seen, 1));
}

/* The columns of a lane with the streaks of its yarns. */
static void column_streaked(const shade_fabric *f, const column_yarns yarns[2],
                            double column[COLUMNS]) {
  double factor[3];
  column_filled(f, column, yarns, factor);
  column[COLUMN_GAP] *= factor[2];
  column[COLUMN_OPEN] = minimum(column[COLUMN_OPEN] * factor[2], 1);
  for (int side = 0; side < 2; side++) {
    const double bright = factor[side] * yarns[side].brightness;
    column[COLUMN_SEEN + side] *= factor[side];
    for (int a = 0; a < (f->alike ? 1 : 3); a++) {
      column[COLUMN_MATT + side + COLUMN_CHANNEL * a] *= bright;
      column[COLUMN_FUZZ + side + COLUMN_CHANNEL * a] *= factor[2];
    }
    for (int a = 0; a < 3 && f->transmits; a++)
      column[COLUMN_PASS + 3 * side + a] *= bright;
  }
}

/* The yarns of all lanes of a group. Few of them, and all in vectors of two numbers, one by one:
 * their yarns side by side. narrow: in float. */
static void column_look_group(const shade_fabric *f, const column_axis *x, const column_axis *y,
                              int narrow, column_group *g) {
  if (VECTOR_BYTES >= 32 && g->count > STREAK_FEW) {
    (narrow ? column_look_allf : column_look_all)(f, SHADE_TOP_WEFT, x, g);
    (narrow ? column_look_allf : column_look_all)(f, SHADE_TOP_WARP, y, g);
    return;
  }
  for (size_t i = 0; i < g->count; i++)
    for (int side = 0; side < 2; side++)
      g->yarns[side][i] =
          column_look(f, side, g->centre[side][i], g->extent[side][i], g->centre[1 - side][i],
                      g->extent[1 - side][i], side == SHADE_TOP_WEFT ? x : y, g->lane[i]);
}

/* Another lane of a group. */
static void column_group_add(column_group *g, size_t lane, double u, double v, double du,
                             double dv) {
  const double limit = 4e18; /* as look-ups have it */
  const size_t i = g->count++;
  g->lane[i] = lane;
  g->centre[SHADE_TOP_WARP][i] = minimum(maximum(u, -limit), limit);
  g->centre[SHADE_TOP_WEFT][i] = minimum(maximum(v, -limit), limit);
  g->extent[SHADE_TOP_WARP][i] = du;
  g->extent[SHADE_TOP_WEFT][i] = dv;
}
