/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The yarns of many footprints, in numbers of a kind: column_yarns.h includes it twice, for in
 * float twice as many fill a vector.
 */

/*
 * How much of each of `count` yarns from `yarn` on is seen between the ends of the footprint along
 * them, `beside`, by the draft and in a unit of its own: where that is narrow some are hidden.
 * count: whole vectors of doubles.
 */
static void OF(column_shown)(const shade_fabric *f, int side, size_t yarn, int count,
                             const column_axis *beside, size_t lane, NUMBER *restrict shown) {
  enum { V = VECTOR_BYTES / sizeof(double) };
  const int weft = side == SHADE_TOP_WEFT;
  const double *strip = f->strip[side];
  if (!strip) { /* several share a block */
    for (int j = 0; j < count; j++)
      shown[j] = 1;
    return;
  }
  const size_t line = (size_t)(weft ? f->height : f->width) + STREAK_YARNS;
  const double *low = strip + (size_t)beside->low[lane] * line + yarn;
  const double *high = strip + (size_t)beside->high[lane] * line + yarn;
  const double *end = strip + (size_t)(weft ? f->columns : f->rows) * line + yarn;
  const double w0 = beside->before_low[lane], w1 = beside->after_low[lane];
  const double w2 = beside->before_high[lane], w3 = beside->after_high[lane];
  const double w4 = beside->repeats[lane];
  for (int c = 0; c < count; c += V) {
#pragma omp simd
    for (int j = c; j < c + V; j++) {
      const double all = (w0 * low[j] + w1 * low[line + (size_t)j]) + w4 * end[j] +
                         (w2 * high[j] + w3 * high[line + (size_t)j]);
      shown[j] = (NUMBER)(all > 0 ? all : 0);
    }
  }
}

/*
 * What column_look finds, of all lanes of a group. Float holds all noise exactly; places count from
 * the yarn where the footprint begins, however far that is from 0.
 */
typedef struct OF(column_streak) {
  int yarn[STREAK_LANES];                       /* the first one, in the repeat */
  NUMBER low[STREAK_LANES], high[STREAK_LANES]; /* from the first yarn */
  NUMBER vary[STREAK_LANES], varies[STREAK_LANES], fade_along[STREAK_LANES];
  uint32_t number[STREAK_LANES], knot[STREAK_LANES]; /* of the first yarn; the first place's */
  int count[STREAK_LANES];                           /* yarns; 0 where streaks have faded out */
  int along[STREAK_LANES];                           /* whether there is noise along them */
  NUMBER ease[STREAK_PLACES][STREAK_LANES];
  int step[STREAK_PLACES][STREAK_LANES]; /* from the first place's knot */
} OF(column_streak);

static void OF(column_streak_set)(const shade_fabric *f, int side, const column_group *g,
                                  OF(column_streak) * s) {
  const weave_yarn *y = &f->weave->yarn[side];
  const double size = side == SHADE_TOP_WEFT ? f->height : f->width, per_size = 1 / size;
  const double frequency = y->along_frequency, vary = y->vary_brightness;
  const double vary_along = y->along_brightness;
  const double *across = g->extent[side], *along = g->extent[1 - side];
  const double *centre = g->centre[side], *place = g->centre[1 - side];
  double spread[STREAK_LANES];
#pragma omp simd
  for (size_t i = 0; i < g->count; i++) {
    const double wide = across[i] > 0.01 ? across[i] : 0.01;
    const double fade = column_fade(across[i], STREAKS_FADE, STREAKS_END);
    const double fade_along = fade * column_fade(along[i] * frequency, NOISE_FADE, NOISE_END);
    const double low = centre[i] - 0.5 * wide, high = low + wide, from = weave_floor(low);
    /* too far off to be told, any will do */
    const double yarn = from - weave_floor((from + 0.5) * per_size) * size;
    s->yarn[i] = (int)(yarn < 0 ? 0 : yarn < size - 1 ? yarn : size - 1);
    s->fade_along[i] = (NUMBER)fade_along;
    s->vary[i] = (NUMBER)(vary * fade);
    s->varies[i] = (NUMBER)(vary_along * fade_along);
    s->low[i] = (NUMBER)(low - from);
    s->high[i] = (NUMBER)(high - from);
    s->number[i] = weave_low_bits(from);
    s->count[i] = fade > 0 ? (int)(weave_floor(high) - from) + 1 : 0;
    /* where noise along the yarns has faded out any knot will do */
    spread[i] = fade_along > 0 ? along[i] : 0;
    s->along[i] = fade_along > 0;
  }
  for (int k = 0; k < STREAK_PLACES; k++) {
    const double part = (k + 0.5) / STREAK_PLACES - 0.5;
#pragma omp simd
    for (size_t i = 0; i < g->count; i++) {
      uint32_t knot;
      double ease;
      weave_knot((place[i] + spread[i] * part) * frequency, &knot, &ease);
      const uint32_t before = k ? s->knot[i] : knot;
      s->ease[k][i] = (NUMBER)ease;
      s->knot[i] = before;
      s->step[k][i] = (int)(knot - before);
    }
  }
}

/*
 * Noise of yarns and knots in a row, which lanes side by side have in common: those of a pixel,
 * most of them. Along the yarns, at knots and from there to the next; of slubs, the width that they
 * give.
 */
enum {
  OF(LATTICE_VECTOR) = VECTOR_BYTES / sizeof(NUMBER),
  OF(LATTICE_YARNS) = sizeof(NUMBER) < sizeof(double) ? 96 : 64,
  OF(LATTICE_KNOTS) = sizeof(NUMBER) < sizeof(double) ? 20 : 8
};
typedef struct OF(column_lattice) {
  int yarn, yarns, knot, knots; /* the first of them, from those of the run's first lane */
#define ROW [OF(LATTICE_YARNS) + OF(LATTICE_VECTOR)]
  NUMBER own ROW;
  NUMBER bright[OF(LATTICE_KNOTS)] ROW, rise[OF(LATTICE_KNOTS)] ROW;
  NUMBER size[OF(LATTICE_KNOTS)] ROW, grow[OF(LATTICE_KNOTS)] ROW;
#undef ROW
} OF(column_lattice);

/* Whether all lanes fit into one lattice. */
static int OF(column_fits)(const OF(column_streak) * s, size_t count, OF(column_lattice) * to) {
  const uint32_t number = s->number[0], mark = s->knot[0];
  int low = 0, high = 0, first = 0, last = 0, along = 0, far = 0;
#pragma omp simd reduction(min : low, first) reduction(max : high, last) reduction(| : along, far)
  for (size_t i = 0; i < count; i++) {
    const int yarn = (int)(s->number[i] - number), knot = (int)(s->knot[i] - mark);
    const int used = -(s->count[i] > 0), noisy = used & -s->along[i];
    const int away = -((yarn < -OF(LATTICE_YARNS)) | (yarn > OF(LATTICE_YARNS)));
    const int past = -((knot < -OF(LATTICE_KNOTS)) | (knot > OF(LATTICE_KNOTS)));
    far |= (used & away) | (noisy & past);
    const int own = yarn & used & ~away, from = knot & noisy & ~past;
    const int own_end = own + s->count[i],
              end = from + ((s->step[STREAK_PLACES - 1][i] + 1) & noisy);
    low = own < low ? own : low;
    high = own_end > high ? own_end : high;
    first = from < first ? from : first;
    last = end > last ? end : last;
    along |= noisy;
  }
  to->yarn = low;
  to->yarns = high - low;
  to->knot = first;
  to->knots = along ? last - first + 1 : 0;
  return !far && high - low <= OF(LATTICE_YARNS) && last - first < OF(LATTICE_KNOTS);
}

/* The lanes from `begin` on that fit, up to the one returned. */
static size_t OF(column_run)(const OF(column_streak) * s, size_t begin, size_t count,
                             OF(column_lattice) * to) {
  int low = 0, high = 0, first = 0, last = 0, along = 0;
  size_t i = begin;
  for (; i < count; i++) {
    const int yarn = (int)(s->number[i] - s->number[begin]);
    const int knot = (int)(s->knot[i] - s->knot[begin]);
    if (!s->count[i])
      continue;
    if (yarn < -OF(LATTICE_YARNS) || yarn > OF(LATTICE_YARNS))
      break;
    const int new_low = yarn < low ? yarn : low;
    const int new_high = yarn + s->count[i] > high ? yarn + s->count[i] : high;
    if (new_high - new_low > OF(LATTICE_YARNS))
      break;
    if (s->along[i]) {
      if (knot < -OF(LATTICE_KNOTS) || knot > OF(LATTICE_KNOTS))
        break;
      const int end = knot + s->step[STREAK_PLACES - 1][i] + 1;
      const int new_first = along && first < knot ? first : knot;
      const int new_last = along && last > end ? last : end;
      if (new_last - new_first >= OF(LATTICE_KNOTS))
        break;
      first = new_first;
      last = new_last;
      along = 1;
    }
    low = new_low;
    high = new_high;
  }
  to->yarn = low;
  to->yarns = high - low;
  to->knot = first;
  to->knots = along ? last - first + 1 : 0;
  return i;
}

/* Of all yarns, the noise of a channel at so many knots, scaled, and from each to the next. */
LEAF void OF(column_noise)(const column_kind *y, uint32_t channel, uint32_t yarn, uint32_t knot,
                           int knots, int width, NUMBER base, NUMBER scale,
                           NUMBER (*restrict at)[OF(LATTICE_YARNS) + OF(LATTICE_VECTOR)],
                           NUMBER (*restrict on)[OF(LATTICE_YARNS) + OF(LATTICE_VECTOR)]) {
  uint32_t hash[OF(LATTICE_YARNS)];
#pragma omp simd
  for (int j = 0; j < width; j++)
    hash[j] = weave_hash_of_yarn(y->seed, y->channel + channel, yarn + (uint32_t)j);
  for (int m = 0; m < knots; m++) {
    NUMBER *restrict row = at[m];
#pragma omp simd
    for (int j = 0; j < width; j++)
      row[j] = base + scale * OF(column_random_of)(weave_hash_at(hash[j], knot + (uint32_t)m));
    for (int j = 0; j < OF(LATTICE_VECTOR); j++) /* read, and of no weight */
      row[width + j] = 0;
  }
  for (int m = 0; m + 1 < knots; m++) {
    NUMBER *restrict row = on[m];
    const NUMBER *restrict here = at[m], *restrict next = at[m + 1];
#pragma omp simd
    for (int j = 0; j < width + OF(LATTICE_VECTOR); j++)
      row[j] = next[j] - here[j];
  }
}

static void OF(column_lattice_fill)(const column_kind *y, uint32_t number, uint32_t knot,
                                    OF(column_lattice) * to) {
  enum { V = OF(LATTICE_VECTOR) };
  const int width = (to->yarns + V - 1) / V * V;
  const uint32_t yarn = number + (uint32_t)to->yarn;
  knot += (uint32_t)to->knot;
#pragma omp simd
  for (int j = 0; j < width; j++)
    to->own[j] = OF(column_random_of)(
        weave_hash(y->seed, y->channel + WEAVE_VARY_BRIGHTNESS, yarn + (uint32_t)j, 0));
  for (int j = 0; j < V; j++)
    to->own[width + j] = 0;
  OF(column_noise)
  (y, WEAVE_ALONG_BRIGHTNESS, yarn, knot, y->brighter ? to->knots : 0, width, 0, 1, to->bright,
   to->rise);
  OF(column_noise)
  (y, WEAVE_SLUB, yarn, knot, y->slub > 0 ? to->knots : 0, width, (NUMBER)y->share,
   (NUMBER)(y->share * y->slub), to->size, to->grow);
}

/* Sums over the yarns of each lane, in parts that are folded later. */
typedef struct OF(column_sums) {
  NUMBER light[STREAK_LANES][OF(LATTICE_VECTOR)], filled[STREAK_LANES][OF(LATTICE_VECTOR)];
  NUMBER parts[STREAK_LANES][OF(LATTICE_VECTOR)];
} OF(column_sums);

/*
 * Lane i, whose first yarn is so far into the lattice, and whose first knot so many rows: into sums
 * or, `each`, yarn by yarn. slubs, brighter: whether along its yarns their width varies, and their
 * brightness; if neither does one place is as good as all.
 */
LEAF void OF(column_lane)(const column_kind *y, const OF(column_lattice) * l,
                          const OF(column_streak) * s, size_t i, int yarn, int row, int slubs,
                          int brighter, int each, const NUMBER *restrict shown,
                          NUMBER *restrict light, NUMBER *restrict filled, NUMBER *restrict parts) {
  enum { V = OF(LATTICE_VECTOR) };
  const NUMBER low = s->low[i], high = s->high[i], vary = s->vary[i], varies = s->varies[i];
  const NUMBER fade = s->fade_along[i], rest = 1 - fade, per = fade * (NUMBER)y->per_usual;
  const NUMBER least = (NUMBER)(y->share * 0.05);
  const NUMBER *restrict own = l->own + yarn;
  /* of the knot before each place */
#define ROW(name, k)                                                                               \
  *restrict name##k = l->name[row + (slubs || brighter ? s->step[k][i] : 0)] + yarn
  const NUMBER ROW(size, 0), ROW(size, 1), ROW(size, 2), ROW(size, 3);
  const NUMBER ROW(grow, 0), ROW(grow, 1), ROW(grow, 2), ROW(grow, 3);
  const NUMBER ROW(bright, 0), ROW(bright, 1), ROW(bright, 2), ROW(bright, 3);
  const NUMBER ROW(rise, 0), ROW(rise, 1), ROW(rise, 2), ROW(rise, 3);
#undef ROW
  const NUMBER ease0 = s->ease[0][i], ease1 = s->ease[1][i], ease2 = s->ease[2][i],
               ease3 = s->ease[3][i];
  for (int c = 0; c < s->count[i]; c += V) {
    const NUMBER from = (NUMBER)c;
#pragma omp simd
    for (int v = 0; v < V; v++) {
      const int j = c + v;
      const NUMBER at = from + (NUMBER)v;
      const NUMBER begin = OF(column_most)(at, low), end = OF(column_least)(at + 1, high);
      const NUMBER part = shown[j] * OF(column_most)(end - begin, 0);
      const NUMBER mean = 1 + vary * own[j];
      NUMBER lit = 0, fills = 0;
#define PLACE(k)                                                                                   \
  do {                                                                                             \
    NUMBER fill = 1, look = mean;                                                                  \
    if (slubs) {                                                                                   \
      const NUMBER wide = OF(column_most)(size##k[j] + ease##k * grow##k[j], least);               \
      fill = rest + per * OF(column_least)(wide, 1);                                               \
    }                                                                                              \
    if (brighter)                                                                                  \
      look = mean + varies * (bright##k[j] + ease##k * rise##k[j]);                                \
    look = OF(column_most)(look, 0);                                                               \
    fills += fill;                                                                                 \
    lit += fill * look;                                                                            \
  } while (0)
      PLACE(0);
      if (slubs || brighter) {
        PLACE(1);
        PLACE(2);
        PLACE(3);
      }
#undef PLACE
      const int to = each ? j : v;
      parts[to] = (c && !each ? parts[v] : 0) + part;
      filled[to] = (c && !each ? filled[v] : 0) + part * fills;
      light[to] = (c && !each ? light[v] : 0) + part * lit;
    }
  }
}

/* Each lane's sum, in place: neighbours of all lanes are added at once. */
static void OF(column_fold)(size_t count, NUMBER *sums) {
  for (size_t n = count * OF(LATTICE_VECTOR); n > count; n /= 2)
#pragma omp simd
    for (size_t i = 0; i < n / 2; i++)
      sums[i] = sums[2 * i] + sums[2 * i + 1];
}

/* column_lane as its yarns need it. along: whether there is noise along them. */
LEAF void OF(column_lane_of)(const column_kind *y, const OF(column_lattice) * l,
                             const OF(column_streak) * s, size_t i, int yarn, int row, int along,
                             int each, const NUMBER *restrict shown, NUMBER *restrict light,
                             NUMBER *restrict filled, NUMBER *restrict parts) {
  if (along && y->slub > 0 && y->brighter)
    OF(column_lane)(y, l, s, i, yarn, row, 1, 1, each, shown, light, filled, parts);
  else if (along && y->slub > 0)
    OF(column_lane)(y, l, s, i, yarn, row, 1, 0, each, shown, light, filled, parts);
  else if (along)
    OF(column_lane)(y, l, s, i, yarn, row, 0, 1, each, shown, light, filled, parts);
  else
    OF(column_lane)(y, l, s, i, yarn, 0, 0, 0, each, shown, light, filled, parts);
}

/* What lanes find, from their sums. */
static void OF(column_settle)(const OF(column_sums) * sums, const double *restrict per_place,
                              int side, column_group *g) {
  double *restrict brightness = g->brightness[side], *restrict fill = g->fill[side];
  const NUMBER *restrict light = sums->light[0], *restrict filled = sums->filled[0];
  const NUMBER *restrict parts = sums->parts[0];
#pragma omp simd
  for (size_t i = 0; i < g->count; i++) {
    const int any = filled[i] > 0; /* or none is seen, or streaks have faded out */
    const NUMBER all = any ? filled[i] : 1, seen = any ? parts[i] : 1;
    brightness[i] = any ? (double)(light[i] / all) : 1;
    fill[i] = any ? per_place[i] * (double)(all / seen) : 1;
  }
}

static void OF(column_look_all)(const shade_fabric *f, int side, const column_axis *beside,
                                column_group *g) {
  enum { V = OF(LATTICE_VECTOR), WHOLE = VECTOR_BYTES / sizeof(double) };
  const column_kind kind = column_kind_of(f, side);
  double *restrict brightness = g->brightness[side], *restrict fill = g->fill[side];
  for (size_t i = 0; i < g->count; i++)
    brightness[i] = fill[i] = 1;
  if (!g->count || !column_varies(f, side))
    return;
  OF(column_streak) s;
  OF(column_lattice) l;
  OF(column_sums) sums;
  double per_place[STREAK_LANES];
  OF(column_streak_set)(f, side, g, &s);
  const int whole = OF(column_fits)(&s, g->count, &l);
  for (size_t begin = 0, end; begin < g->count; begin = end) {
    end = whole ? g->count : OF(column_run)(&s, begin, g->count, &l);
    OF(column_lattice_fill)(&kind, s.number[begin], s.knot[begin], &l);
    for (size_t i = begin; i < end; i++) {
      NUMBER shown[STREAK_YARNS + V];
      const int count = (s.count[i] + WHOLE - 1) / WHOLE * WHOLE;
      const int along = s.along[i] && (kind.slub > 0 || kind.brighter);
      per_place[i] = along ? 1.0 / STREAK_PLACES : 1;
      if (!count) {
        for (int v = 0; v < V; v++)
          sums.light[i][v] = sums.filled[i][v] = sums.parts[i][v] = 0;
        continue;
      }
      OF(column_shown)(f, side, (size_t)s.yarn[i], count, beside, g->begin + i, shown);
      for (int v = 0; v < V; v++)
        shown[count + v] = 0;
      const int yarn = (int)(s.number[i] - s.number[begin]) - l.yarn;
      const int row = along ? (int)(s.knot[i] - s.knot[begin]) - l.knot : 0;
      OF(column_lane_of)
      (&kind, &l, &s, i, yarn, row, along, 0, shown, sums.light[i], sums.filled[i], sums.parts[i]);
    }
  }
  OF(column_fold)(g->count, sums.light[0]);
  OF(column_fold)(g->count, sums.filled[0]);
  OF(column_fold)(g->count, sums.parts[0]);
  OF(column_settle)(&sums, per_place, side, g);
}
