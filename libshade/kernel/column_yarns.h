/* SPDX-License-Identifier: Apache-2.0 */
/* Streaks of uneven yarns in what a footprint holds: after leaf_weave.h, in double alone. */

/*
 * Yarns that are brighter, darker, thicker or thinner than others show as streaks long after the
 * weave is too fine to see. Of one direction's yarns, of which a footprint crosses `across` and
 * goes `along` each, by what is seen of each: their mean brightness, and the share of their
 * crossings that they fill over what they do everywhere. All of them fade out from 12 to 16 yarns,
 * noise along them also from 2 to 4 of its knots; what is left of the streaks there is small.
 */
enum { STREAK_YARNS = 24, STREAK_PLACES = 4 }; /* 17 yarns at most, in whole vectors; along them */

/* 1 up to `from`, 0 from `to` on. */
static double column_fade(double extent, double from, double to) {
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
                         const column_axis *beside, size_t lane, double *shown) {
  const int weft = side == SHADE_TOP_WEFT, yarns = weft ? f->rows : f->columns;
  const double size = weft ? f->height : f->width;
  const size_t line = (size_t)(f->columns + 1) * COLUMNS_STEP;
  const size_t next = weft ? line : COLUMNS_STEP, step = weft ? COLUMNS_STEP : line;
  const size_t low = (size_t)beside->low[lane] * step, high = (size_t)beside->high[lane] * step;
  const size_t end = (size_t)(weft ? f->columns : f->rows) * step;
  const double w0 = beside->before_low[lane], w1 = beside->after_low[lane];
  const double w2 = beside->before_high[lane], w3 = beside->after_high[lane];
  const double w4 = beside->repeats[lane];
  int yarn = (int)minimum(maximum(first - floor(first / size) * size, 0), size - 1);
  double before = 0;
  for (int j = 0; j < count && yarns != (int)size; j++)
    shown[j] = 1; /* some share a block of the table */
  for (int j = -1; j < count && yarns == (int)size; j++) {
    const double *t = f->table + (size_t)(yarn + (j >= 0)) * next + COLUMN_SEEN + side;
    const double all =
        w0 * t[low] + w1 * t[low + step] + w2 * t[high] + w3 * t[high + step] + w4 * t[end];
    if (j >= 0) {
      shown[j] = maximum(all - before, 0);
      yarn++;
    }
    const int last = yarn == yarns;
    before = last ? 0 : all; /* the table's first line is 0 */
    yarn = last ? 0 : yarn;
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

/* What column_look finds, of all lanes of a group; few_knots: no more than two about any of them.
 */
typedef struct column_streak {
  double low[STREAK_LANES], high[STREAK_LANES], first[STREAK_LANES];
  double vary[STREAK_LANES], varies[STREAK_LANES], fade_along[STREAK_LANES];
  uint32_t number[STREAK_LANES], knot[STREAK_LANES];
  double ease[STREAK_PLACES][STREAK_LANES];
  int step[STREAK_PLACES][STREAK_LANES]; /* from the first place's knot */
  double shown[STREAK_YARNS][STREAK_LANES];
  double parts[STREAK_LANES], light[STREAK_LANES], filled[STREAK_LANES];
  int yarns, steps; /* at most */
} column_streak;

static void column_streak_set(const shade_fabric *f, int side, const column_group *g,
                              const column_axis *beside, column_streak *s) {
  const weave_yarn *y = &f->weave->yarn[side];
  double count[STREAK_LANES];
  memset(s->shown, 0, sizeof s->shown);
  s->yarns = s->steps = 0;
  for (size_t i = 0; i < g->count; i++) {
    const double across = g->extent[side][i], along = g->extent[1 - side][i];
    const double wide = across > 0.01 ? across : 0.01;
    const double fade = column_fade(across, STREAKS_FADE, STREAKS_END);
    s->fade_along[i] = fade * column_fade(along * y->along_frequency, 2, 4);
    s->vary[i] = y->vary_brightness * fade;
    s->varies[i] = y->along_brightness * s->fade_along[i];
    s->low[i] = g->centre[side][i] - 0.5 * wide;
    s->high[i] = s->low[i] + wide;
    s->first[i] = weave_floor(s->low[i]);
    s->number[i] = weave_low_bits(s->first[i]);
    count[i] = fade > 0 ? weave_floor(s->high[i]) - s->first[i] + 1 : 0;
    s->parts[i] = s->light[i] = s->filled[i] = 0;
    /* where noise along the yarns has faded out any knot will do */
    const double spread = s->fade_along[i] > 0 ? along : 0;
    for (int k = 0; k < STREAK_PLACES; k++) {
      const double offset = spread * ((k + 0.5) / STREAK_PLACES - 0.5);
      uint32_t knot;
      weave_knot((g->centre[1 - side][i] + offset) * y->along_frequency, &knot, &s->ease[k][i]);
      s->knot[i] = k ? s->knot[i] : knot;
      s->step[k][i] = (int)(knot - s->knot[i]);
      s->steps = s->step[k][i] > s->steps ? s->step[k][i] : s->steps;
    }
  }
  for (size_t i = 0; i < g->count; i++) {
    double shown[STREAK_YARNS];
    const int yarns = (int)count[i];
    s->yarns = yarns > s->yarns ? yarns : s->yarns;
    column_shown(f, side, s->first[i], yarns, beside, g->lane[i], shown);
    for (int j = 0; j < yarns; j++)
      s->shown[j][i] = shown[j];
  }
}

/* Of yarn j of each lane, the noise of a channel at so many knots from the first on. */
LEAF void column_noise(uint32_t seed, uint32_t channel, uint32_t yarn, size_t count, int knots,
                       const column_streak *s, double (*restrict to)[STREAK_LANES]) {
  for (int m = 0; m < knots; m++) {
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      to[m][i] = weave_random(seed, channel, s->number[i] + yarn, s->knot[i] + (uint32_t)m);
  }
}

/* Noise of lane i between the knots about a place, of which so many come before it. Chosen row by
 * row: to gather takes longer. */
LEAF double column_between(const double (*noise)[STREAK_LANES], size_t i, int step, double ease) {
  const double a = noise[0][i], b = noise[1][i], c = noise[2][i], d = noise[3][i];
  const double low = step < 1 ? a : step < 2 ? b : step < 3 ? c : d;
  const double high = step < 1 ? b : step < 2 ? c : step < 3 ? d : noise[4][i];
  return low + (high - low) * ease;
}

/* Adds a yarn of each lane at place k. slub: 0 where no yarn has any. */
LEAF void column_streak_add(size_t count, int k, double share, double slub, double per_usual,
                            const double (*brighter)[STREAK_LANES],
                            const double (*thicker)[STREAK_LANES], const double *part,
                            const double *own, column_streak *restrict s) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    double seen = part[i];
    if (slub > 0) {
      const double slubs = column_between(thicker, i, s->step[k][i], s->ease[k][i]);
      const double size = minimum(maximum(share * (1 + slub * slubs), share * 0.05), 1);
      seen *= 1 + s->fade_along[i] * (size * per_usual - 1);
    }
    const double noise = column_between(brighter, i, s->step[k][i], s->ease[k][i]);
    s->light[i] += seen * maximum(own[i] + s->varies[i] * noise, 0);
    s->filled[i] += seen;
  }
}

static void column_look_all(const shade_fabric *f, int side, const column_axis *beside,
                            column_group *g) {
  const weave_yarn *y = &f->weave->yarn[side];
  const uint32_t seed = f->weave->params.seed, channel = (uint32_t)side * WEAVE_CHANNELS;
  const double usual = f->fills[side], slub = usual > 0 ? y->slub : 0;
  const double per_usual = usual > 0 ? 1 / usual : 0, share = f->weave->thread[side][0].share;
  double brighter[STREAK_KNOTS][STREAK_LANES], thicker[STREAK_KNOTS][STREAK_LANES];
  double part[STREAK_LANES], own[STREAK_LANES];
  const int places = y->along_brightness > 0 || slub > 0 ? STREAK_PLACES : 1; /* else all alike */
  column_streak s;
  for (size_t i = 0; i < g->count; i++)
    g->yarns[side][i] = (column_yarns){1, 1};
  if (!(y->vary_brightness > 0 || y->along_brightness > 0 || slub > 0))
    return;
  column_streak_set(f, side, g, beside, &s);
  memset(brighter, 0, sizeof brighter);
  memset(thicker, 0, sizeof thicker);
  for (int j = 0; j < s.yarns; j++) {
#pragma omp simd
    for (size_t i = 0; i < g->count; i++) {
      const double from = s.first[i] + j;
      part[i] = s.shown[j][i] * maximum(minimum(from + 1, s.high[i]) - maximum(from, s.low[i]), 0);
      s.parts[i] += part[i];
      own[i] = 1 + s.vary[i] * weave_random(seed, channel + WEAVE_VARY_BRIGHTNESS,
                                            s.number[i] + (uint32_t)j, 0);
    }
    if (y->along_brightness > 0)
      column_noise(seed, channel + WEAVE_ALONG_BRIGHTNESS, (uint32_t)j, g->count, s.steps + 2, &s,
                   brighter);
    if (slub > 0)
      column_noise(seed, channel + WEAVE_SLUB, (uint32_t)j, g->count, s.steps + 2, &s, thicker);
    for (int k = 0; k < places; k++)
      if (slub > 0)
        column_streak_add(g->count, k, share, slub, per_usual, brighter, thicker, part, own, &s);
      else
        column_streak_add(g->count, k, share, 0, per_usual, brighter, thicker, part, own, &s);
  }
  for (size_t i = 0; i < g->count; i++)
    if (s.filled[i] > 0)
      g->yarns[side][i] =
          (column_yarns){s.light[i] / s.filled[i], s.filled[i] / (places * s.parts[i])};
}

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
  const double a = minimum(A * yarns[0].fill, 1), b = minimum(B * yarns[1].fill, 1);
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
 * their yarns side by side. */
static void column_look_group(const shade_fabric *f, const column_axis *x, const column_axis *y,
                              column_group *g) {
  if (VECTOR_BYTES >= 32 && g->count > STREAK_FEW) {
    column_look_all(f, SHADE_TOP_WEFT, x, g);
    column_look_all(f, SHADE_TOP_WARP, y, g);
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
