/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The yarns of many footprints side by side, in numbers of a kind: column_yarns.h includes it
 * twice, for in float twice as many fill a vector.
 */

/*
 * What column_look finds, of all lanes of a group. Float holds all noise exactly; places count from
 * the yarn where the footprint begins, however far that is from 0.
 */
typedef struct OF(column_streak) {
  NUMBER low[STREAK_LANES], high[STREAK_LANES]; /* from the first yarn */
  NUMBER vary[STREAK_LANES], varies[STREAK_LANES], fade_along[STREAK_LANES];
  uint32_t number[STREAK_LANES], knot[STREAK_LANES];
  NUMBER ease[STREAK_PLACES][STREAK_LANES];
  int step[STREAK_PLACES][STREAK_LANES]; /* from the first place's knot */
  NUMBER shown[STREAK_YARNS][STREAK_LANES];
  NUMBER parts[STREAK_LANES], light[STREAK_LANES], filled[STREAK_LANES];
  int yarns, steps; /* at most; steps: knots from the first one to a place's */
  int along;        /* whether some lane has noise along its yarns */
} OF(column_streak);

static void OF(column_streak_set)(const shade_fabric *f, int side, const column_group *g,
                                  const column_axis *beside, OF(column_streak) * s) {
  const weave_yarn *y = &f->weave->yarn[side];
  const double frequency = y->along_frequency, vary = y->vary_brightness;
  const double vary_along = y->along_brightness;
  const double *across = g->extent[side], *along = g->extent[1 - side];
  const double *centre = g->centre[side], *place = g->centre[1 - side];
  double first[STREAK_LANES], spread[STREAK_LANES];
  int count[STREAK_LANES], yarns = 0, steps = 0, any = 0;
#pragma omp simd reduction(max : yarns) reduction(| : any)
  for (size_t i = 0; i < g->count; i++) {
    const double wide = across[i] > 0.01 ? across[i] : 0.01;
    const double fade = column_fade(across[i], STREAKS_FADE, STREAKS_END);
    const double fade_along = fade * column_fade(along[i] * frequency, 2, 4);
    const double low = centre[i] - 0.5 * wide, high = low + wide, from = weave_floor(low);
    const int number = fade > 0 ? (int)(weave_floor(high) - from) + 1 : 0;
    s->fade_along[i] = (NUMBER)fade_along;
    s->vary[i] = (NUMBER)(vary * fade);
    s->varies[i] = (NUMBER)(vary_along * fade_along);
    s->low[i] = (NUMBER)(low - from);
    s->high[i] = (NUMBER)(high - from);
    s->number[i] = weave_low_bits(from);
    s->parts[i] = s->light[i] = s->filled[i] = 0;
    first[i] = from;
    count[i] = number;
    yarns = number > yarns ? number : yarns;
    /* where noise along the yarns has faded out any knot will do */
    spread[i] = fade_along > 0 ? along[i] : 0;
    any |= fade_along > 0;
  }
  for (int k = 0; k < STREAK_PLACES; k++) {
    const double part = (k + 0.5) / STREAK_PLACES - 0.5;
#pragma omp simd reduction(max : steps)
    for (size_t i = 0; i < g->count; i++) {
      uint32_t knot;
      double ease;
      weave_knot((place[i] + spread[i] * part) * frequency, &knot, &ease);
      const uint32_t before = k ? s->knot[i] : knot;
      const int step = (int)(knot - before);
      s->ease[k][i] = (NUMBER)ease;
      s->knot[i] = before;
      s->step[k][i] = step;
      steps = step > steps ? step : steps;
    }
  }
  s->yarns = yarns;
  s->steps = steps;
  s->along = any;
  for (size_t i = 0; i < g->count; i++) {
    double shown[STREAK_YARNS];
    column_shown(f, side, first[i], count[i], beside, g->lane[i], shown);
    for (int j = 0; j < yarns; j++)
      s->shown[j][i] = j < count[i] ? (NUMBER)shown[j] : 0;
  }
}

/* Of yarn j of each lane, the noise of a channel at so many knots from the first on. */
LEAF void OF(column_noise)(uint32_t seed, uint32_t channel, uint32_t yarn, size_t count, int knots,
                           const OF(column_streak) * s, NUMBER (*restrict to)[STREAK_LANES]) {
  uint32_t hash[STREAK_LANES];
#pragma omp simd
  for (size_t i = 0; i < count; i++)
    hash[i] = weave_hash_of_yarn(seed, channel, s->number[i] + yarn);
  for (int m = 0; m < knots; m++) {
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      to[m][i] = OF(weave_random_of)(weave_hash_at(hash[i], s->knot[i] + (uint32_t)m));
  }
}

/* Noise of lane i between the knots about a place, of which so many come before it, at most `most`.
 * Chosen row by row: to gather takes longer. */
LEAF NUMBER OF(column_between)(const NUMBER (*noise)[STREAK_LANES], size_t i, int most, int step,
                               NUMBER ease) {
  NUMBER low = noise[0][i],
         high = noise[1][i]; /* no loop: clang would leave that around it scalar */
  if (most >= 1) {
    low = step < 1 ? low : noise[1][i];
    high = step < 1 ? high : noise[2][i];
  }
  if (most >= 2) {
    low = step < 2 ? low : noise[2][i];
    high = step < 2 ? high : noise[3][i];
  }
  if (most >= 3) {
    low = step < 3 ? low : noise[3][i];
    high = step < 3 ? high : noise[4][i];
  }
  return low + (high - low) * ease;
}

/* Adds a yarn of each lane at place k. slub: 0 where no yarn has any; steps: those of the lanes at
 * most. */
LEAF void OF(column_streak_add)(size_t count, int k, int steps, NUMBER share, NUMBER slub,
                                NUMBER per_usual, const NUMBER (*brighter)[STREAK_LANES],
                                const NUMBER (*thicker)[STREAK_LANES], const NUMBER *part,
                                const NUMBER *own, OF(column_streak) *restrict s) {
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    const int step = s->step[k][i];
    const NUMBER ease = s->ease[k][i];
    NUMBER seen = part[i];
    if (slub > 0) {
      const NUMBER slubs = OF(column_between)(thicker, i, steps, step, ease);
      const NUMBER size =
          OF(minimum)(OF(maximum)(share * (1 + slub * slubs), share * (NUMBER)0.05), 1);
      seen *= 1 + s->fade_along[i] * (size * per_usual - 1);
    }
    const NUMBER noise = OF(column_between)(brighter, i, steps, step, ease);
    s->light[i] += seen * OF(maximum)(own[i] + s->varies[i] * noise, 0);
    s->filled[i] += seen;
  }
}

/* Adds yarn j of each lane, of which part is seen and whose brightness is own, at all places. */
static void OF(column_streak_along)(const column_kind *y, uint32_t j, size_t count,
                                    const NUMBER *part, const NUMBER *own, OF(column_streak) * s) {
  NUMBER brighter[STREAK_KNOTS][STREAK_LANES], thicker[STREAK_KNOTS][STREAK_LANES];
  const NUMBER share = (NUMBER)y->share, slub = (NUMBER)y->slub;
  const NUMBER per_usual = (NUMBER)y->per_usual;
  const int knots = s->steps + 2;
  if (y->brighter)
    OF(column_noise)(y->seed, y->channel + WEAVE_ALONG_BRIGHTNESS, j, count, knots, s, brighter);
  else
    memset(brighter, 0, sizeof brighter);
  if (slub > 0)
    OF(column_noise)(y->seed, y->channel + WEAVE_SLUB, j, count, knots, s, thicker);
#define ADD(steps, slub)                                                                           \
  OF(column_streak_add)(count, k, steps, share, slub, per_usual, brighter, thicker, part, own, s)
  for (int k = 0; k < STREAK_PLACES; k++)
    if (slub > 0 && knots == 2)
      ADD(0, slub);
    else if (slub > 0 && knots == 3)
      ADD(1, slub);
    else if (slub > 0)
      ADD(STREAK_KNOTS - 2, slub);
    else if (knots == 2)
      ADD(0, 0);
    else
      ADD(STREAK_KNOTS - 2, 0);
#undef ADD
}

static void OF(column_look_all)(const shade_fabric *f, int side, const column_axis *beside,
                                column_group *g) {
  const weave_yarn *y = &f->weave->yarn[side];
  const double usual = f->fills[side];
  const column_kind kind = {f->weave->params.seed,           (uint32_t)side * WEAVE_CHANNELS,
                            f->weave->thread[side][0].share, usual > 0 ? y->slub : 0,
                            usual > 0 ? 1 / usual : 0,       y->along_brightness > 0};
  const size_t count = g->count;
  NUMBER part[STREAK_LANES], own[STREAK_LANES];
  OF(column_streak) s;
  for (size_t i = 0; i < count; i++)
    g->yarns[side][i] = (column_yarns){1, 1};
  if (!(y->vary_brightness > 0 || kind.brighter || kind.slub > 0))
    return;
  OF(column_streak_set)(f, side, g, beside, &s);
  const int along = s.along && (kind.brighter || kind.slub > 0);
  for (int j = 0; j < s.yarns; j++) {
    const NUMBER from = (NUMBER)j;
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
      const NUMBER begin = OF(maximum)(from, s.low[i]), end = OF(minimum)(from + 1, s.high[i]);
      part[i] = s.shown[j][i] * OF(maximum)(end - begin, 0);
      s.parts[i] += part[i];
      own[i] = 1 + s.vary[i] * OF(weave_random)(kind.seed, kind.channel + WEAVE_VARY_BRIGHTNESS,
                                                s.number[i] + (uint32_t)j, 0);
    }
    if (along) {
      OF(column_streak_along)(&kind, (uint32_t)j, count, part, own, &s);
      continue;
    }
#pragma omp simd
    for (size_t i = 0; i < count; i++)
      s.light[i] += part[i] * OF(maximum)(own[i], 0);
  }
  for (size_t i = 0; i < count; i++) {
    const double parts = (double)s.parts[i], filled = along ? (double)s.filled[i] : parts;
    if (filled > 0)
      g->yarns[side][i] =
          (column_yarns){(double)s.light[i] / filled, along ? filled / (STREAK_PLACES * parts) : 1};
  }
}
