/* SPDX-License-Identifier: Apache-2.0 */
/* COST = 0.4 */
/*
 * Look-ups of every instruction set, in both precisions, against the rules of weave.h written out
 * for one point; awkward places; short structures.
 */
#include <float.h>
#include <string.h>

#include "shade/weave.h"
#include "support.h"

enum { COUNT = 1000 };

/* ---- long-hand ---- */

static double random_of(uint32_t seed, uint32_t channel, uint32_t yarn, uint32_t knot) {
  uint32_t h = seed * 0x9e3779b1u + channel;
  const uint32_t words[] = {yarn, knot, 0x27d4eb2fu};
  for (int i = 0; i < 3; i++) {
    h ^= words[i];
    h *= 0x85ebca6bu;
    h ^= h >> 15;
    h *= 0xc2b2ae35u;
    h ^= h >> 13;
  }
  return (h >> 8) / 8388608. - 1;
}

/* A whole number modulo 2^32, beyond 4e18 held there. */
static uint32_t low(double whole) {
  return (uint32_t)(int64_t)fmin(fmax(whole, -4e18), 4e18);
}

static double random_along(uint32_t seed, uint32_t channel, uint32_t yarn, double place) {
  const double t = place - floor(place);
  const double a = random_of(seed, channel, yarn, low(floor(place)));
  const double b = random_of(seed, channel, yarn, low(floor(place)) + 1);
  return a + (b - a) * t * t * (3 - 2 * t);
}

/* One of the two yarns at (u, v). */
typedef struct strand {
  const shade_yarn_params *p;
  uint32_t number, base;
  double s, place; /* along it: in the crossing, in knots */
  double share, sigma;
} strand;

static strand strand_at(const shade_weave *w, int warp, double u, double v) {
  const shade_weave_params *p = shade_weave_get_params(w);
  const double along = warp ? v : u, across = warp ? u : v;
  strand y = {.p = warp ? &p->warp : &p->weft, .number = low(floor(across)), .base = warp ? 7 : 0};
  y.s = along - floor(along);
  y.place = along * (1 / y.p->along_length);
  y.share = y.p->width / (y.p->width + y.p->gap);
  y.share *= 1 + y.p->slub * random_along(p->seed, y.base + 6, y.number, y.place);
  y.share = fmin(fmax(y.share, .05 * y.p->width / (y.p->width + y.p->gap)), 1);
  y.sigma = (2 * (across - floor(across)) - 1) / y.share;
  return y;
}

static int cell_of(double x, int size) {
  return (int)(((int64_t)fmin(fmax(floor(x), -4e18), 4e18) % size + size) % size);
}

/* Crossings from (end, pick) in steps along the yarn until the other yarn is up; 99: never. */
static int float_length(const shade_draft *d, int end, int pick, int warp, int step) {
  const int up = d->warp_up[pick * d->ends + end];
  for (int k = 1; k < 99; k++) {
    end = warp ? end : (end + step + d->ends) % d->ends;
    pick = warp ? (pick + step + d->picks) % d->picks : pick;
    if (d->warp_up[pick * d->ends + end] != up)
      return k - 1;
  }
  return 99;
}

static double dive(double d, double length) {
  const double t = fmin(d / length, 1);
  return (1 - t) * (1 - t) * (1 + 2 * t);
}

static double gap_sky(double share, double sigma) {
  const double near = fmax(fabs(sigma) - 1, 0), far = fmax(2 / share - 2 - near, 0);
  return .5 * sin(atan(near)) + .5 * sin(atan(far));
}

/* (1 + cos(tilt + elevation of the tangent to the neighbour))/2 [weave.h, occlusion sky] */
static double yarn_sky(double curve, double share, double sigma) {
  const double tilt = asin(curve * fabs(sigma)), away = 2 * curve / share;
  const double x = away - sin(tilt), z = cos(tilt), distance = hypot(x, z);
  const double elevation = asin(fmin(1 / distance, 1)) - atan2(z, x);
  return .5 + .5 * cos(tilt + elevation);
}

/* 0 where the ridge jumps or the point is at a yarn's edge: there a rounding decides. */
static int long_hand(const shade_weave *w, double u, double v, shade_crossing *c) {
  const shade_weave_params *p = shade_weave_get_params(w);
  const shade_draft *d = shade_weave_draft(w);
  const int end = cell_of(u, d->ends), pick = cell_of(v, d->picks);
  const int upper = d->warp_up[pick * d->ends + end];
  const strand both[2] = {strand_at(w, 0, u, v), strand_at(w, 1, u, v)};
  const int hit[2] = {fabs(both[0].sigma) <= 1, fabs(both[1].sigma) <= 1};
  const int seen = hit[upper] || !hit[!upper] ? upper : !upper, gap = !hit[seen];
  const strand *y = &both[seen];
  memset(c, 0, sizeof *c);
  c->top = gap ? SHADE_TOP_GAP : (shade_top)seen;
  c->swap = seen;
  c->below = !hit[upper];
  c->yarn = seen ? end : pick;
  c->sigma = y->sigma;
  c->along = y->s;
  c->brightness = 1;
  c->fuzz = gap ? 1 - (1 - p->warp.fuzz) * (1 - p->weft.fuzz) : 0;
  const double fibre = gap ? 0 : y->p->fibre;
  c->tx = seen ? -sin(fibre) : cos(fibre);
  c->ty = seen ? cos(fibre) : sin(fibre);
  double along = 0, across = 0, jump = 1;
  if (!gap) {
    across = y->p->curve * y->sigma;
    if (y->p->segments > 0 && y->p->ridge > 0) {
      const double turn = y->p->segments * (y->s - y->p->slant * y->sigma);
      along += y->p->ridge * (2 * (turn - floor(turn)) - 1);
      jump = fabs(turn - nearbyint(turn));
    }
    const int before = float_length(d, end, pick, seen, -1);
    const int after = float_length(d, end, pick, seen, 1);
    const double length = fmin(y->p->crimp_length, before + after + 1);
    along += (seen == upper ? 1 : -1) * y->p->crimp *
             (dive(after + 1 - y->s, length) - dive(before + y->s, length));
    double r[6];
    for (uint32_t k = 0; k < 6; k++)
      r[k] = k < 3 ? random_of(p->seed, y->base + k, y->number, 0)
                   : random_along(p->seed, y->base + k, y->number, y->place);
    c->brightness += y->p->vary_brightness * r[0] + y->p->along_brightness * r[3];
    along += y->p->vary_tilt * r[1] + y->p->along_tilt * r[4];
    across += y->p->vary_tilt * r[2] + y->p->along_tilt * r[5];
    const double length2 = hypot(along, across);
    along *= length2 > .98 ? .98 / length2 : 1;
    across *= length2 > .98 ? .98 / length2 : 1;
    c->brightness = fmax(c->brightness, 0);
    const double *color = seen ? d->warp[end].color : d->weft[pick].color;
    for (int k = 0; k < 3; k++)
      c->color[k] = color[k] <= .04045 ? color[k] / 12.92 : pow((color[k] + .055) / 1.055, 2.4);
  }
  c->dx = seen ? across : along;
  c->dy = seen ? along : across;
  c->occlusion = 1;
  if (p->occlusion == SHADE_OCCLUSION_TILT)
    c->occlusion = 1 - hypot(along, across);
  if (p->occlusion == SHADE_OCCLUSION_SKY) {
    c->occlusion = gap ? gap_sky(both[!upper].share, both[!upper].sigma)
                       : yarn_sky(y->p->curve, y->share, y->sigma);
    if (!hit[upper])
      c->occlusion *= gap_sky(both[upper].share, both[upper].sigma);
  }
  return jump > 1e-9 && fabs(fabs(both[0].sigma) - 1) > 1e-9 &&
         fabs(fabs(both[1].sigma) - 1) > 1e-9;
}

/* ---- what is compared ---- */

enum { WHOLE = 4, NUMBERS = 12 };
static int whole[WHOLE][COUNT];
static double number[NUMBERS][COUNT];
static float numberf[NUMBERS][COUNT];

static void run(const shade_isa_table *isa, const shade_weave *w, const double *u,
                const double *v) {
  double(*n)[COUNT] = number;
  const shade_crossings out = {sizeof out, whole[0], whole[1], whole[2], whole[3], n[0],
                               n[1],       n[2],     n[3],     n[4],     n[5],     n[6],
                               n[7],       n[8],     n[9],     n[10],    n[11]};
  assert_int_equal(isa->entries->weave_batch(w, COUNT, u, v, &out), SHADE_OK);
}

static void runf(const shade_isa_table *isa, const shade_weave *w, const float *u, const float *v) {
  float(*n)[COUNT] = numberf;
  const shade_crossingsf out = {sizeof out, whole[0], whole[1], whole[2], whole[3], n[0],
                                n[1],       n[2],     n[3],     n[4],     n[5],     n[6],
                                n[7],       n[8],     n[9],     n[10],    n[11]};
  assert_int_equal(isa->entriesf->weave_batch(w, COUNT, u, v, &out), SHADE_OK);
}

/* The largest difference of lane i; the whole numbers must agree. */
static double apart(const shade_crossing *c, size_t i, int single) {
  const int whole_want[WHOLE] = {(int)c->top, c->swap, c->below, c->yarn};
  const double want[NUMBERS] = {c->sigma, c->along,    c->dx,        c->dy,
                                c->tx,    c->ty,       c->occlusion, c->brightness,
                                c->fuzz,  c->color[0], c->color[1],  c->color[2]};
  double worst = 0;
  for (int k = 0; k < WHOLE; k++)
    assert_int_equal(whole[k][i], whole_want[k]);
  for (int k = 0; k < NUMBERS; k++)
    worst = fmax(worst, fabs((single ? (double)numberf[k][i] : number[k][i]) - want[k]) /
                            fmax(fabs(want[k]), 1));
  return worst;
}

/*
 * A weave of its own for each round: any draft, any noise, or none. For float, ridges or slubs: a
 * slant multiplies what a slub rounds to.
 */
static shade_weave *any_weave(int round, int single, uint64_t *seed) {
  shade_draft *d = shade_draft_create(1 + (int)(19 * uniform(seed)), 1 + (int)(23 * uniform(seed)));
  for (int i = 0; i < d->ends * d->picks; i++)
    d->warp_up[i] = uniform(seed) < .5;
  for (int i = 0; i < d->ends + d->picks; i++)
    for (int c = 0; c < 3; c++)
      (i < d->ends ? &d->warp[i] : &d->weft[i - d->ends])->color[c] = uniform(seed);
  shade_weave_params p;
  shade_param_info info;
  shade_weave_params_init(&p);
  for (int k = 0; shade_yarn_param_row(k, &info); k++)
    for (int warp = 0; warp < 2; warp++)
      if (uniform(seed) < (round % 3 ? .7 : .3))
        *shade_yarn_param(warp ? &p.warp : &p.weft, info.word) =
            info.minimum + (fmin(info.maximum, 3) - info.minimum) * uniform(seed);
  p.warp.curve = fmax(p.warp.curve, .05); /* of a flat yarn the long-hand sky is 0/0 */
  p.weft.curve = fmax(p.weft.curve, .05);
  if (single && round % 2)
    p.warp.slub = p.weft.slub = 0;
  else if (single)
    p.warp.segments = p.weft.segments = 0;
  p.occlusion = (shade_occlusion)(round / 2 % SHADE_OCCLUSION_COUNT);
  p.seed = (uint32_t)(4e9 * uniform(seed));
  shade_weave *w = shade_weave_create(d, &p, NULL);
  shade_draft_free(d);
  assert_non_null(w);
  return w;
}

/* Of this CPU: each is to have been tried at as many places. */
static int instruction_sets(void) {
  int count = 0;
  while (shade_isa_pick(count))
    count++;
  return count;
}

static void rules(void **state) {
  (void)state;
  static double u[COUNT], v[COUNT];
  uint64_t seed = 5;
  double worst = 0;
  int checked = 0;
  for (int round = 0; round < 60; round++) {
    shade_weave *w = any_weave(round, 0, &seed);
    const double reach = round % 5 ? 1000 : 1e7;
    for (int i = 0; i < COUNT; i++) {
      u[i] = reach * (2 * uniform(&seed) - 1);
      v[i] = reach * (2 * uniform(&seed) - 1);
    }
    const shade_isa_table *isa;
    for (int row = 0; (isa = shade_isa_pick(row)); row++) {
      run(isa, w, u, v);
      for (size_t i = 0; i < COUNT; i++) {
        shade_crossing c;
        if (!long_hand(w, u[i], v[i], &c))
          continue;
        /* segments and slant multiply what the place rounds to */
        worst = fmax(worst, apart(&c, i, 0) * 1e3 / reach);
        checked++;
      }
    }
    shade_weave_free(w);
  }
  print_message("look-ups against long-hand: %.2g (%d places)\n", worst, checked);
  assert_true(worst < 1e-12 && checked > 50000 * instruction_sets());
}

/* Float of every instruction set: the rules within 4e-4 (model/weave.h). */
static void rules_in_float(void **state) {
  (void)state;
  static float u[COUNT], v[COUNT];
  uint64_t seed = 6;
  double worst = 0;
  int checked = 0;
  for (int round = 0; round < 60; round++) {
    shade_weave *w = any_weave(round, 1, &seed);
    for (int i = 0; i < COUNT; i++) {
      u[i] = (float)(200 * uniform(&seed) - 100);
      v[i] = (float)(200 * uniform(&seed) - 100);
    }
    const shade_isa_table *isa;
    for (int row = 0; (isa = shade_isa_pick(row)); row++) {
      runf(isa, w, u, v);
      for (size_t i = 0; i < COUNT; i++) {
        shade_crossing c, beside;
        const double x = (double)u[i], y = (double)v[i];
        /* at an edge or a jump within float's reach of it a rounding decides */
        if (!long_hand(w, x, y, &c) || !long_hand(w, x + 2e-4, y - 2e-4, &beside) ||
            c.top != beside.top || fabs(c.dx - beside.dx) + fabs(c.dy - beside.dy) > .1 ||
            fabs(c.sigma) > 1e3)
          continue;
        worst = fmax(worst, apart(&c, i, 1));
        checked++;
      }
    }
    shade_weave_free(w);
  }
  print_message("in float: %.2g (%d places)\n", worst, checked);
  assert_true(worst < 4e-4 && checked > 50000 * instruction_sets());
}

/* Whole numbers, beyond 2^22, 2^31, 2^53 and 4e18: index and noise go on as for all others. */
static void far_away(void **state) {
  (void)state;
  static double u[COUNT], v[COUNT];
  static float uf[COUNT], vf[COUNT];
  uint64_t seed = 7;
  double worst = 0;
  int compared = 0;
  for (int round = 0; round < 30; round++) {
    shade_weave *w = any_weave(round, 0, &seed);
    for (int i = 0; i < COUNT; i++) {
      const double size = exp2(10 + 58 * uniform(&seed));
      u[i] = size * (2 * uniform(&seed) - 1);
      v[i] = i % 3 ? nearbyint(size * uniform(&seed) - size / 2) : ldexp(1, i % 70);
      v[i] = i % 11 ? v[i] : DBL_MAX * (i % 2 ? 1 : -1);
      uf[i] = (float)u[i];
      vf[i] = (float)v[i] > FLT_MAX ? FLT_MAX : (float)v[i] < -FLT_MAX ? -FLT_MAX : (float)v[i];
    }
    const shade_isa_table *isa;
    for (int row = 0; (isa = shade_isa_pick(row)); row++)
      for (int single = 0; single < 2; single++) {
        single ? runf(isa, w, uf, vf) : run(isa, w, u, v);
        for (size_t i = 0; i < COUNT; i++) {
          shade_crossing c;
          const double x = single ? (double)uf[i] : u[i], y = single ? (double)vf[i] : v[i];
          for (int k = 0; k < NUMBERS; k++)
            assert_true(isfinite(single ? (double)numberf[k][i] : number[k][i]));
          /* the last number of a crossing is another in float */
          if (!long_hand(w, x, y, &c) || (single && fmax(fabs(x), fabs(y)) > 3.9e18))
            continue;
          const shade_draft *d = shade_weave_draft(w);
          assert_int_equal(whole[3][i], whole[1][i] ? cell_of(x, d->ends) : cell_of(y, d->picks));
          /* knots end at 4e18; in float the place along a slub rounds, and so the width */
          const shade_weave_params *p = shade_weave_get_params(w);
          if (fmax(fabs(x), fabs(y)) > 3.9e16 || (single && fmax(p->warp.slub, p->weft.slub) > 0))
            continue;
          assert_int_equal(c.yarn, whole[3][i]);
          compared++;
          worst = fmax(worst, single ? fabs((double)numberf[0][i] - c.sigma) / (1 + fabs(c.sigma))
                                     : apart(&c, i, 0));
        }
      }
    shade_weave_free(w);
  }
  print_message("far away: %.2g (%d places)\n", worst, compared);
  assert_true(worst < 1e-6 && compared > 13000 * instruction_sets());
}

/* Not finite counts as 0; a call for one and a batch of any length are the same bits. */
static void singles(void **state) {
  (void)state;
  enum { MOST = 300 };
  static double u[MOST], v[MOST], dx[MOST], light[MOST];
  static float uf[MOST], vf[MOST], dxf[MOST];
  static int top[MOST];
  const double odd[] = {NAN, INFINITY, -INFINITY, -0., 0, -1e-30, 1 - 1e-17, -1, 4194304, -4194305};
  uint64_t seed = 8;
  for (int round = 0; round < 60; round++) {
    shade_weave *w = any_weave(round, 0, &seed);
    const size_t count = round < 40 ? (size_t)round : (size_t)(MOST * uniform(&seed));
    unsigned want = SHADE_OK;
    for (size_t i = 0; i < count; i++) {
      u[i] = i % 7 ? 100 * uniform(&seed) - 50 : odd[i / 7 % 10];
      v[i] = i % 5 ? 100 * uniform(&seed) - 50 : odd[i / 5 % 10];
      uf[i] = (float)u[i];
      vf[i] = (float)v[i];
      want |= isfinite(u[i]) && isfinite(v[i]) ? SHADE_OK : SHADE_BAD_INPUT;
      dx[i] = NAN;
    }
    const shade_crossings out = {.size = sizeof out, .top = top, .dx = dx, .occlusion = light};
    const shade_crossingsf outf = {.size = sizeof outf, .dx = dxf};
    assert_int_equal(shade_weave_lookup_batch(w, count, u, v, &out), want);
    assert_int_equal(shade_weave_lookup_batchf(w, count, uf, vf, &outf), want);
    for (size_t i = 0; i < count; i++) {
      shade_crossing c, zero;
      shade_crossingf f;
      const int fine = isfinite(u[i]) && isfinite(v[i]);
      assert_int_equal(shade_weave_lookup(w, u[i], v[i], &c), fine ? SHADE_OK : SHADE_BAD_INPUT);
      shade_weave_lookupf(w, uf[i], vf[i], &f);
      shade_weave_lookup(w, isfinite(u[i]) ? u[i] : 0, isfinite(v[i]) ? v[i] : 0, &zero);
      assert_true(c.dx == dx[i] && c.occlusion == light[i] && (int)c.top == top[i]);
      assert_true(f.dx == dxf[i] && zero.dx == c.dx && zero.sigma == c.sigma);
    }
    shade_weave_free(w);
  }
}

/* Members beyond `size` count as NULL; a size that does not hold itself writes nothing. */
static void short_size(void **state) {
  (void)state;
  shade_draft *d = shade_draft_named("plain");
  shade_weave *w = shade_weave_create(d, NULL, NULL);
  const double u[2] = {.25, 1.75}, v[2] = {.5, .5};
  double dx[2] = {7, 7}, dy[2] = {7, 7};
  int top[2] = {7, 7};
  shade_crossings out = {.size = offsetof(shade_crossings, dy), .top = top, .dx = dx, .dy = dy};
  assert_int_equal(shade_weave_lookup_batch(w, 2, u, v, &out), SHADE_OK);
  assert_true(top[0] == SHADE_TOP_WEFT && top[1] == SHADE_TOP_WARP);
  assert_true(dx[0] < 1 && dx[1] < 1 && dy[0] == 7 && dy[1] == 7);
  top[0] = 9;
  const size_t sizes[] = {0, sizeof(size_t) - 1};
  for (int k = 0; k < 2; k++) {
    out.size = sizes[k];
    assert_int_equal(shade_weave_lookup_batch(w, 2, u, v, &out), SHADE_BAD_INPUT);
    assert_int_equal(top[0], 9);
  }
  out.size = sizeof(size_t);
  assert_int_equal(shade_weave_lookup_batch(w, 2, u, v, &out), SHADE_OK);
  assert_int_equal(top[0], 9);
  shade_weave_free(w);
  shade_draft_free(d);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rules),   cmocka_unit_test(rules_in_float), cmocka_unit_test(far_away),
      cmocka_unit_test(singles), cmocka_unit_test(short_size),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
